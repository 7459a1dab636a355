//! Figures 12 and 15: frame by frame what four orders find with the same budget, how many pixels are wrong,
//! and how long it takes.

use std::sync::Arc;

use super::{BY_CENTROID, DELAUNAY, FRAME, Judge, KD_TREE, Most, OCTREE, ORDER, Way, frame, mean, ready};
use crate::drawing::{Plot, Series, Shape};
use crate::measure::paper::flight::{about, path};
use crate::measure::paper::walk::{ROUNDS, stop_or_go};
use crate::measure::paper::{
    Measured, PaperError, SCENE, SOURCE, Setup, Sweep, World, by_scene, column, part,
};
use crate::measure::table::{Cell, Table};
use crate::measure::timing::median;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        ORDER,
        FRAME,
        column("found_percent", "found", "% of visible", 1),
        column("wrong_percent", "wrong", "% of pixels", 2),
        column("cull_ms", "cull", "ms", 2),
        column("draw_ms", "draw", "ms", 2),
        column("total_ms", "total", "ms", 2),
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

const WAYS: [Way; 4] = [DELAUNAY, OCTREE, KD_TREE, BY_CENTROID];

/// What a way did in a frame.
#[derive(Clone, Debug, Default)]
struct Of {
    found: f64,
    wrong: f64,
    times: [Vec<f64>; 2],
}

impl Of {
    fn numbers(&self) -> [f64; 5] {
        let [cull, draw] = [0, 1].map(|i| median(self.times[i].clone()));
        [self.found, self.wrong, cull, draw, cull + draw]
    }
}

fn rows<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<(Vec<Vec<Cell>>, Measured), PaperError> {
    let path = path(scene, setup);
    let mut runs = Vec::new();
    for (i, way) in WAYS.into_iter().enumerate() {
        runs.extend(ready(
            scene,
            setup,
            way,
            &[Most::AsSet],
            &part(progress, 0.05 * i as f32, 0.05 * (i + 1) as f32),
        )?);
    }
    let (mut judge, mut target) = (Judge::new(scene, setup), Target::default());
    let n = path.views.len();
    let mut all: Vec<[Of; 4]> = vec![Default::default(); n];
    for round in 0..ROUNDS {
        runs.iter_mut().for_each(|r| r.forget());
        for (k, view) in path.views.iter().enumerate() {
            stop_or_go(progress, 0.2 + 0.8 * (round * n + k) as f32 / (ROUNDS * n) as f32, "flying")?;
            if round == 0 {
                judge.look(scene, view);
            }
            for way in (0..4).map(|w| (w + k + round) % 4) {
                let (list, times) = frame(scene, &mut *runs[way], view, &mut target);
                let of = &mut all[k][way];
                (0..2).for_each(|i| of.times[i].push(times[i]));
                if round == 0 {
                    let verdict = judge.judge(scene, view, &list);
                    (of.found, of.wrong) = (judge.coverage_percent(&verdict), verdict.wrong_percent());
                }
            }
        }
    }
    let about = about(scene, &path);
    Ok((table_rows(&about, &all), about))
}

/// First what all frames together say, then each frame.
fn table_rows(about: &Measured, all: &[[Of; 4]]) -> Vec<Vec<Cell>> {
    let row = |w: usize, frame: Cell, numbers: [f64; 5]| {
        let text: [Cell; 4] = ["measured".into(), about.name.as_str().into(), WAYS[w].label.into(), frame];
        text.into_iter().chain(numbers.map(Cell::from)).collect::<Vec<Cell>>()
    };
    let numbers: Vec<[[f64; 5]; 4]> =
        all.iter().map(|ways| [0, 1, 2, 3].map(|w| ways[w].numbers())).collect();
    let mut rows = Vec::new();
    for w in 0..WAYS.len() {
        let of = |c: usize| numbers.iter().map(move |n| n[w][c]);
        rows.push(row(w, "mean".into(), std::array::from_fn(|c| mean(of(c)))));
        let worst =
            |c: usize| if c == 0 { of(c).fold(f64::INFINITY, f64::min) } else { of(c).fold(0.0, f64::max) };
        rows.push(row(w, "worst".into(), std::array::from_fn(worst)));
    }
    for w in 0..WAYS.len() {
        rows.extend(numbers.iter().enumerate().map(|(k, n)| row(w, k.into(), n[w])));
    }
    rows
}

/// Order, the mean share found, and the most pixels wrong in any frame (Section 5.2.1).
const PAPER: [(Way, f64, f64); 3] = [(DELAUNAY, 90.0, 4.0), (OCTREE, 64.0, 9.0), (BY_CENTROID, 30.0, 40.0)];

fn paper() -> Vec<Vec<Cell>> {
    let row = |way: Way, frame: &str, found: Cell, wrong: Cell| {
        let mut row: Vec<Cell> =
            vec!["paper".into(), "City".into(), way.label.into(), frame.into(), found, wrong];
        row.extend([const { Cell::Missing }; 3]);
        row
    };
    let both = |(way, found, wrong): (Way, f64, f64)| {
        [row(way, "mean", found.into(), Cell::Missing), row(way, "worst", Cell::Missing, wrong.into())]
    };
    PAPER.into_iter().flat_map(both).collect()
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        // The rows of each order begin with those of all frames.
        let frames: Vec<usize> = rows.into_iter().filter(|&r| table.number(r, FRAME.key).is_some()).collect();
        let each = frames.len() / WAYS.len();
        for (key, what, y_label) in [
            ("found_percent", "what is found", "visible triangles found, %"),
            ("wrong_percent", "what is wrong", "wrong pixels, % of the image"),
            ("total_ms", "time of a frame", "culled and drawn, ms"),
        ] {
            let series = WAYS.iter().zip(frames.chunks(each.max(1))).map(|(way, rows)| {
                let points = rows
                    .iter()
                    .filter_map(|&r| Some((table.number(r, FRAME.key)?, table.number(r, key)?)))
                    .collect();
                Series::new(way.label, way.role, points)
            });
            plots.push(Plot {
                title: format!("{name}: {what}"),
                x_label: "frame".into(),
                y_label: y_label.into(),
                shape: Shape::Lines { logarithmic: false, ticks: Vec::new() },
                series: series.collect(),
            });
        }
    }
    plots
}
