//! Table 1: the visible coverage ratio at four budgets, for each order; with the worst frame's wrong pixels
//! (Section 5.2).

use std::sync::Arc;

use super::ways::{
    BUDGETS, BY_CENTROID, DELAUNAY, Most, OCTREE, ORDER, PAPERS, PAPERS_DELAUNAY, PAPERS_OCTREE, RULES, Way,
    ready,
};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{at_rest, path};
use crate::measure::harness::{Judge, checkpoint, part};
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        ORDER,
        RULES,
        column("found_1_percent", "found, 1 %", "% of visible", 1),
        column("found_2_percent", "2 %", "%", 1),
        column("found_5_percent", "5 %", "%", 1),
        column("found_10_percent", "10 %", "%", 1),
        column("worst_1_percent", "worst frame, 1 %", "% of pixels", 1),
        column("worst_2_percent", "2 %", "%", 1),
        column("worst_5_percent", "5 %", "%", 1),
        column("worst_10_percent", "10 %", "%", 1),
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

const WAYS: [Way; 5] = [PAPERS_DELAUNAY, PAPERS_OCTREE, DELAUNAY, OCTREE, BY_CENTROID];
const FOUND: [&str; 4] = ["found_1_percent", "found_2_percent", "found_5_percent", "found_10_percent"];

/// Scene, ε at each budget, and the most pixels wrong in any frame, of which the budget is not named.
const PAPER: [(&str, [f64; 4], f64); 2] =
    [("City", [51.0, 66.0, 80.0, 90.0], 4.0), ("5 Car Body/Engine", [44.0, 55.0, 67.0, 76.0], 12.0)];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let budgets = BUDGETS.map(Most::Percent);
    let mut runs = Vec::new();
    for (i, way) in WAYS.into_iter().enumerate() {
        runs.push(ready(
            scene,
            setup,
            way,
            &budgets,
            &part(progress, 0.06 * i as f32, 0.06 * (i + 1) as f32),
        )?);
    }
    let mut judge = Judge::new(scene, setup);
    let n = path.views.len();
    let mut found = [[0.0; 4]; WAYS.len()];
    let mut worst = [[0.0f64; 4]; WAYS.len()];
    for (k, view) in path.views.iter().enumerate() {
        checkpoint(progress, 0.3 + 0.7 * k as f32 / n as f32, "comparing with the exact visible set")?;
        judge.look(view);
        for (w, of_way) in runs.iter_mut().enumerate() {
            for (b, run) in of_way.iter_mut().enumerate() {
                let difference = judge.compare(&run.cull(view).prims);
                found[w][b] += difference.coverage_percent / n as f64;
                worst[w][b] = worst[w][b].max(difference.wrong_percent());
            }
        }
    }
    let about = at_rest(scene, &path);
    let row = |w: usize| {
        let mut row = measured(&about.name, WAYS[w].cells(), found[w]);
        row.extend(worst[w].map(Cell::from));
        row
    };
    Ok(((0..WAYS.len()).map(row).collect(), about))
}

fn paper() -> Vec<Vec<Cell>> {
    let row = |(scene, found, worst): (&str, [f64; 4], f64)| {
        let names = [(SOURCE.key, "paper".into()), (SCENE.key, scene.into())];
        let order = [(ORDER.key, PAPERS_DELAUNAY.label.into()), (RULES.key, PAPERS.into())];
        let found = FOUND.into_iter().zip(found.map(Cell::from)).chain([("worst_10_percent", worst.into())]);
        quoted(SWEEP.columns, names.into_iter().chain(order).chain(found))
    };
    PAPER.map(row).to_vec()
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let mut series: Vec<Series> = Vec::new();
        for (way, &r) in WAYS.iter().zip(&rows) {
            let points = BUDGETS
                .into_iter()
                .zip(FOUND)
                .filter_map(|(b, key)| Some((b, table.number(r, key)?)))
                .collect();
            series.push(Series::new(way.name(), way.role, points));
        }
        for ((scene, found, _), role) in PAPER.into_iter().zip([Role::Ink, Role::Faint]) {
            series.push(Series::new(
                format!("paper, {scene}"),
                role,
                BUDGETS.into_iter().zip(found).collect(),
            ));
        }
        plots.push(Plot {
            title: name,
            x_label: "budget, % of the triangles".into(),
            y_label: "visible triangles found, %".into(),
            shape: Shape::Lines { logarithmic: true, ticks: BUDGETS.to_vec() },
            series,
        });
    }
    plots
}
