//! Section 5.1: how long the preprocess takes, by stage, and what it costs in memory.

use std::sync::{Arc, Mutex};

use super::ways::{DELAUNAY, KD_TREE, OCTREE, Way};
use crate::drawing::words::grouped;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::NodeId;
use crate::measure::columns::{SCENE, SOURCE, column, measured, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{at_rest, path};
use crate::measure::harness::{ROUNDS, part, ready};
use crate::measure::timing::median;
use crate::measure::{Cell, Setup, Stopwatch, Table};
use crate::method::Run;
use crate::papers::keys::LAYERED_PROJECTION;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("triangles", "triangles", "", 0),
        column("tessellation", "cells are of", "", 0),
        column("cells", "cells", "", 0),
        column("references_ratio", "references", "a triangle", 2),
        column("dividing_ms", "dividing", "ms", 0),
        column("triangulating_ms", "triangulating", "ms", 0),
        column("assigning_ms", "assigning", "ms", 0),
        column("total_ms", "total", "ms", 0),
        column("cells_mb", "cells", "MB", 2),
        column("references_mb", "references", "MB", 2),
        column("scene_mb", "scene", "MB", 1),
        column("overhead_percent", "overhead", "% of scene", 1),
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

const WAYS: [Way; 3] = [DELAUNAY, OCTREE, KD_TREE];

/// Names of the stages begin like this.
const STAGES: [&str; 3] = ["dividing", "triangulating", "assigning"];

/// Passes the reports of a work on, and records when each stage begins.
struct Stages<'a> {
    whole: &'a dyn Progress,
    watch: Stopwatch,
    begun: Mutex<Vec<(&'static str, f64)>>,
}

impl<'a> Stages<'a> {
    fn new(whole: &'a dyn Progress) -> Self {
        Self { whole, watch: Stopwatch::start(), begun: Mutex::default() }
    }
    /// Time of each of [`STAGES`], and from the beginning to now, ms.
    fn times(&self) -> [f64; 4] {
        let end = self.watch.elapsed_ms();
        let begun = self.begun.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let mut times = [0.0, 0.0, 0.0, end];
        for (i, (name, start)) in begun.iter().enumerate() {
            if let Some(stage) = STAGES.iter().position(|s| name.starts_with(s)) {
                times[stage] += begun.get(i + 1).map_or(end, |next| next.1) - start;
            }
        }
        times
    }
}

impl Progress for Stages<'_> {
    fn report(&self, fraction: f32, what: &'static str) {
        let mut begun = self.begun.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if begun.last().is_none_or(|(last, _)| *last != what) {
            begun.push((what, self.watch.elapsed_ms()));
        }
        drop(begun);
        self.whole.report(fraction, what);
    }
    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let about = at_rest(scene, &path(scene, setup));
    let all = (WAYS.len() * ROUNDS) as f32;
    let mut times = [const { [const { Vec::new() }; 4] }; WAYS.len()];
    let mut runs: Vec<Option<Box<dyn Run<S>>>> = WAYS.map(|_| None).into();
    for round in 0..ROUNDS {
        for (w, way) in WAYS.into_iter().enumerate() {
            let cells = [("tessellation", way.method.map(|[cells, _]| cells).unwrap_or_default())];
            let begun = (round * WAYS.len() + w) as f32;
            let rest = part(progress, begun / all, (begun + 1.0) / all);
            let stages = Stages::new(&rest);
            let run = ready(scene, LAYERED_PROJECTION, setup, &cells, &stages)?;
            stages.times().into_iter().enumerate().for_each(|(i, ms)| times[w][i].push(ms));
            runs[w] = Some(run);
        }
    }
    let row = |(w, run): (usize, &dyn Run<S>)| {
        let index = run.hierarchy();
        let cells = index.node_count() - 1;
        let references: usize = (1..=cells as u32).map(|n| index.held(NodeId(n))).sum();
        let [dividing, triangulating, assigning, total] = times[w].clone().map(median);
        let mb = |bytes: usize| bytes as f64 / 1e6;
        let (index_mb, references_mb, scene_mb) =
            (mb(index.bytes()), mb(references * size_of::<u32>()), mb(scene.memory_bytes()));
        let mut row = measured(
            &about.name,
            [about.prims.into(), WAYS[w].label.into()],
            [cells as f64, references as f64 / about.prims.max(1) as f64],
        );
        row.extend([dividing, triangulating, assigning, total].map(Cell::from));
        row.extend(
            [index_mb - references_mb, references_mb, scene_mb, 100.0 * index_mb / scene_mb].map(Cell::from),
        );
        row
    };
    Ok((runs.iter().enumerate().filter_map(|(w, r)| Some((w, r.as_deref()?))).map(row).collect(), about))
}

/// Scene, triangles, cells, references a triangle, seconds, MB of cells, of references and of triangles, per
/// cent.
type Quoted = (&'static str, f64, f64, f64, f64, [Option<f64>; 4]);
const PAPER: [Quoted; 2] = [
    ("City", 500_000.0, 25_000.0, 1.80, 70.0, [Some(2.5), Some(3.6), Some(50.0), Some(12.0)]),
    // Of the second only the total of 20 MB is stated, not its cells.
    ("5 Car Body/Engine", 810_000.0, 60_000.0, 2.13, 135.0, [None, Some(14.7), Some(82.0), Some(24.0)]),
];

fn paper() -> Vec<Vec<Cell>> {
    let row = |(scene, triangles, cells, references, seconds, memory): Quoted| {
        let [cells_mb, references_mb, scene_mb, overhead_percent] = memory.map(Cell::from);
        quoted(
            SWEEP.columns,
            [
                (SOURCE.key, "paper".into()),
                (SCENE.key, scene.into()),
                ("triangles", triangles.into()),
                ("tessellation", DELAUNAY.label.into()),
                ("cells", cells.into()),
                ("references_ratio", references.into()),
                ("total_ms", (1000.0 * seconds).into()),
                ("cells_mb", cells_mb),
                ("references_mb", references_mb),
                ("scene_mb", scene_mb),
                ("overhead_percent", overhead_percent),
            ],
        )
    };
    PAPER.map(row).to_vec()
}

fn plots(table: &Table) -> Vec<Plot> {
    let at = |key: &str| table.columns.iter().position(|c| c.key == key).unwrap_or(0);
    let name = |r: usize| {
        let size =
            table.number(r, "triangles").map_or(String::new(), |n| format!("{} k", grouped(n / 1000.0, 0)));
        // A scene of a name that another one has too is called by its size as well.
        let scene = table.shown(r, at("scene"));
        format!(
            "{}, {size}\n{}",
            scene.split(',').next().unwrap_or_default(),
            table.shown(r, at("tessellation"))
        )
    };
    let bars = |key: &str, label: &str, role: Role| {
        let points = (0..table.rows.len()).filter_map(|r| Some((r as f64, table.number(r, key)?))).collect();
        Series::new(label, role, points)
    };
    let plot = |y_label: &str, series: Vec<Series>| Plot {
        title: String::new(),
        x_label: String::new(),
        y_label: y_label.into(),
        shape: Shape::Bars { groups: (0..table.rows.len()).map(name).collect(), stacked: true },
        series,
    };
    vec![plot(
        "preprocess, ms",
        vec![
            bars("dividing_ms", "dividing space", Role::Scene),
            bars("triangulating_ms", "triangulating", Role::Visible),
            bars("assigning_ms", "assigning triangles", Role::Hidden),
        ],
    )]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Quiet;

    #[test]
    fn stages_are_distinguished_by_their_names() {
        let stages = Stages::new(&Quiet);
        for (what, count) in [("dividing space", 2), ("triangulating", 1), ("assigning", 3), ("sorting", 1)] {
            (0..count).for_each(|_| stages.report(0.5, what));
        }
        assert_eq!(stages.begun.lock().expect("a list").len(), 4);
        let [dividing, triangulating, assigning, total] = stages.times();
        assert!(dividing >= 0.0 && triangulating >= 0.0 && assigning >= 0.0);
        assert!(
            dividing + triangulating + assigning <= total,
            "{dividing} {triangulating} {assigning} {total}"
        );
    }
}
