//! What came out of an experiment, as text and as JSON.

use serde_json::{Map, Value as Json, json};

use super::columns::FRAME;
use super::table::{Cell, Table};
use crate::drawing::Plot;
use crate::drawing::words::grouped;

/// Columns of a terminal that running text takes.
const TEXT_COLUMNS: usize = 100;

/// A scene that was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Short name.
    pub name: String,
    /// As it may be given again.
    pub source: String,
    /// Primitives.
    pub prims: usize,
    /// What they are called.
    pub prim: &'static str,
    /// The path that was walked.
    pub path: String,
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Name of the experiment.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
    /// The rows: ours first, then the paper's.
    pub table: Table,
    /// The charts.
    pub plots: Vec<Plot>,
    /// The scenes.
    pub scenes: Vec<Measured>,
    /// Digital object identifier of the method's paper.
    pub doi: &'static str,
    /// Parameters of the method that the experiment does not vary.
    pub params: Vec<(&'static str, String)>,
    /// Frames a scene, at most.
    pub frames: usize,
    /// What is to be known for reading the table.
    pub notes: Vec<&'static str>,
}

impl Report {
    /// Scenes and parameters in a few sentences, for under a chart.
    pub fn caption(&self) -> String {
        let scene = |m: &Measured| {
            format!("{} ({} {}s, path {})", m.name, grouped(m.prims as f64, 0), m.prim, m.path)
        };
        let scenes = self.scenes.iter().map(scene).collect::<Vec<_>>().join(", ");
        let params = self.params.iter().map(|(k, v)| format!("{k} {v}")).collect::<Vec<_>>().join(", ");
        format!("{scenes}; {params}; {} frames. {}", self.frames, self.notes.join(" "))
    }
    /// Title, table, and what is to be known, for people.
    pub fn text(&self) -> String {
        let mut lines = vec![String::new()];
        for word in self.caption().split(' ') {
            let line = lines.last_mut().filter(|l| l.chars().count() + word.chars().count() < TEXT_COLUMNS);
            match line {
                Some(line) if line.is_empty() => line.push_str(word),
                Some(line) => *line += &format!(" {word}"),
                None => lines.push(word.to_owned()),
            }
        }
        // Single frames are for charts and for other programs.
        let frame = self.table.columns.iter().position(|c| c.key == FRAME);
        let is_frame = |row: &[Cell]| frame.is_some_and(|at| matches!(row[at], Cell::Number(_)));
        let left_out = self.table.rows.iter().filter(|r| is_frame(r)).count();
        let rows = self.table.rows.iter().filter(|r| !is_frame(r)).cloned().collect();
        let table = Table { columns: self.table.columns.clone(), rows };
        if left_out > 0 {
            lines.push(format!(
                "{left_out} rows of single frames are in the formats csv and json, and in the charts."
            ));
        }
        format!("{}\n\n{}\n{}\n", self.title, table.text(), lines.join("\n"))
    }
    /// Everything, with every digit.
    pub fn json(&self) -> Json {
        let columns = self
            .table
            .columns
            .iter()
            .map(|c| json!({"key": c.key, "title": c.title, "unit": c.unit}))
            .collect::<Vec<_>>();
        let scenes = self
            .scenes
            .iter()
            .map(|m| json!({"name": m.name, "source": m.source, "primitives": m.prims, "path": m.path}));
        let params = self.params.iter().map(|(k, v)| ((*k).to_owned(), json!(v))).collect::<Map<_, _>>();
        json!({
            "cullscope": env!("CARGO_PKG_VERSION"),
            "experiment": self.name,
            "title": self.title,
            "paper_doi": self.doi,
            "scenes": scenes.collect::<Vec<_>>(),
            "params": params,
            "frames": self.frames,
            "columns": columns,
            "rows": self.table.json(),
            "notes": self.notes,
        })
    }
}
