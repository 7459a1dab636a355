//! What came out of an experiment, as text and as JSON.

use serde_json::{Map, Value as Json, json};

use super::columns::FRAME;
use super::table::{Cell, Table};
use crate::drawing::Plot;
use crate::drawing::words::grouped;
use crate::method::departs;

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
    /// Key of the method.
    pub method: &'static str,
    /// Parameters of the method that all runs have alike.
    pub params: Vec<(&'static str, String)>,
    /// The others, with their values.
    pub varied: Vec<(&'static str, Vec<String>)>,
    /// Sections of the paper from which the method departs with these.
    pub departures: Vec<&'static str>,
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
        let with_values = |(k, values): &(_, Vec<_>)| format!("{k} ({})", values.join(", "));
        let varied = match self.varied.iter().map(with_values).collect::<Vec<_>>() {
            none if none.is_empty() => String::new(),
            all => format!("; varied: {}", all.join(", ")),
        };
        let departures = departs(self.method, &self.departures);
        let notes = self.notes.join(" ");
        format!("{scenes}; {params}{varied}; {} frames. {notes}{departures}", self.frames)
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
        let varied = self.varied.iter().map(|(k, v)| ((*k).to_owned(), json!(v))).collect::<Map<_, _>>();
        json!({
            "cullscope": env!("CARGO_PKG_VERSION"),
            "experiment": self.name,
            "title": self.title,
            "paper_doi": self.doi,
            "scenes": scenes.collect::<Vec<_>>(),
            "params": params,
            "varied": varied,
            "departures": self.departures,
            "frames": self.frames,
            "columns": columns,
            "rows": self.table.json(),
            "notes": self.notes,
        })
    }
}
