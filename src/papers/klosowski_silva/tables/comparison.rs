//! Figures 12 and 15: frame by frame what four orders find with the same budget, how many pixels are wrong,
//! and how long it takes.

use std::sync::Arc;

use super::ways::{
    BY_CENTROID, DELAUNAY, FRAME, KD_TREE, Most, OCTREE, ORDER, PAPERS_DELAUNAY, PAPERS_OCTREE, RULES, Way,
    ready,
};
use crate::drawing::{Plot, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::harness::{Judge, frame, in_turns, mean, part};
use crate::measure::{Cell, Measured, Setup, Table};
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        ORDER,
        RULES,
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

const WAYS: [Way; COUNT] = [PAPERS_DELAUNAY, PAPERS_OCTREE, DELAUNAY, OCTREE, KD_TREE, BY_CENTROID];
const COUNT: usize = 6;

/// What is found and wrong in a frame, per cent; its times to cull, to draw and in all, ms.
type Numbers = [f64; 5];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let mut runs = Vec::new();
    for (i, way) in WAYS.into_iter().enumerate() {
        runs.extend(ready(
            scene,
            setup,
            way,
            &[Most::AsSet],
            &part(progress, 0.03 * i as f32, 0.03 * (i + 1) as f32),
        )?);
    }
    let (mut judge, mut target) = (Judge::new(scene, setup), Target::default());
    let mut all: Vec<[Numbers; COUNT]> = vec![Default::default(); path.views.len()];
    let times = in_turns(scene, &mut runs, &path.views, &part(progress, 0.2, 1.0), "flying", |run, turn| {
        if turn.is_first_round && turn.is_first_run {
            judge.pose(turn.scene);
            judge.look(turn.view);
        }
        let (list, times) = frame(turn.scene, run, turn.view, &mut target);
        if turn.is_first_round {
            let difference = judge.compare(&list);
            let to = &mut all[turn.frame][turn.run];
            (to[0], to[1]) = (difference.coverage_percent, difference.wrong_percent());
        }
        times
    })?;
    for (to, [cull, draw]) in all.as_flattened_mut().iter_mut().zip(times.into_iter().flatten()) {
        to[2..].copy_from_slice(&[cull, draw, cull + draw]);
    }
    let about = about(scene, &path);
    Ok((table_rows(&about, &all), about))
}

/// First what all frames together say, then each frame.
fn table_rows(about: &Measured, all: &[[Numbers; COUNT]]) -> Vec<Vec<Cell>> {
    let row = |w: usize, frame: Cell, numbers: Numbers| {
        measured(&about.name, WAYS[w].cells().into_iter().chain([frame]), numbers)
    };
    let mut rows = Vec::new();
    for w in 0..WAYS.len() {
        let of = |c: usize| all.iter().map(move |n| n[w][c]);
        rows.push(row(w, "mean".into(), std::array::from_fn(|c| mean(of(c)))));
        let worst =
            |c: usize| if c == 0 { of(c).fold(f64::INFINITY, f64::min) } else { of(c).fold(0.0, f64::max) };
        rows.push(row(w, "worst".into(), std::array::from_fn(worst)));
    }
    for w in 0..WAYS.len() {
        rows.extend(all.iter().enumerate().map(|(k, n)| row(w, k.into(), n[w])));
    }
    rows
}

/// Order, the mean share found, and the most pixels wrong in any frame (Section 5.2.1).
const PAPER: [(Way, f64, f64); 3] =
    [(PAPERS_DELAUNAY, 90.0, 4.0), (PAPERS_OCTREE, 64.0, 9.0), (BY_CENTROID, 30.0, 40.0)];

fn paper() -> Vec<Vec<Cell>> {
    let row = |way: Way, frame: &str, key: &str, percent: f64| {
        let [order, rules] = way.cells();
        quoted(
            SWEEP.columns,
            [
                (SOURCE.key, "paper".into()),
                (SCENE.key, "City".into()),
                (ORDER.key, order),
                (RULES.key, rules),
                (FRAME.key, frame.into()),
                (key, percent.into()),
            ],
        )
    };
    let both = |(way, found, wrong): (Way, f64, f64)| {
        [row(way, "mean", "found_percent", found), row(way, "worst", "wrong_percent", wrong)]
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
            let series = WAYS
                .iter()
                .zip(frames.chunks(each.max(1)))
                .map(|(way, rows)| Series::new(way.name(), way.role, points(table, rows, FRAME.key, key)));
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
