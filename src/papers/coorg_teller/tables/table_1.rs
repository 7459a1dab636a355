//! Table 1: the percentage of polygons drawn after view-frustum culling, and after occlusion culling as well.

use std::sync::Arc;

use super::both::Both;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{CHECKED, MISSED, SCENE, SOURCE, by_scene, column, first_of_each, measured};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::part;
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("polygons", "polygons", "", 0),
        column("frustum_percent", "frustum", "% drawn", 1),
        column("occlusion_percent", "occlusion", "% drawn", 1),
        column("reduction_ratio", "reduction", "times", 1),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Scene, polygons, percent after frustum culling, percent after occlusion culling.
const PAPER: [(&str, f64, f64, f64); 2] = [("Soda", 134_832.0, 19.7, 2.6), ("City", 108_841.0, 36.9, 5.6)];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let Both { walk, mut judge, mut frustum, mut occlusion } = Both::new(scene, setup, progress, 0.4)?;
    let views = walk.spread();
    let mut drawn = [0; 2];
    let checked = judge.each(&views, &part(progress, 0.4, 1.0), "culling", |view| {
        drawn[0] += frustum.cull(view).prims.len();
        let list = occlusion.cull(view).prims;
        drawn[1] += list.len();
        list
    })?;
    let percent = drawn.map(|n| 100.0 * n as f64 / (views.len() * scene.live().len()) as f64);
    let ratio = (drawn[1] > 0).then(|| percent[0] / percent[1]);
    let polygons = [walk.about.prims.into()];
    let mut row = measured(&walk.about.name, polygons, percent);
    row.push(ratio.into());
    row.extend(checked.cells());
    Ok((vec![row], walk.about))
}

fn paper() -> Vec<Vec<Cell>> {
    let row = |(scene, polygons, frustum, occlusion): (&str, f64, f64, f64)| {
        let ratio = frustum / occlusion;
        vec![
            "paper".into(),
            scene.into(),
            polygons.into(),
            frustum.into(),
            occlusion.into(),
            ratio.into(),
            Cell::Missing,
            Cell::Missing,
        ]
    };
    PAPER.map(row).to_vec()
}

fn plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    let after = scenes.len();
    let theirs = |of: fn(&(&str, f64, f64, f64)) -> f64| {
        PAPER.iter().enumerate().map(|(i, p)| ((after + i) as f64, of(p))).collect()
    };
    let names = scenes.iter().map(|s| s.0.clone());
    let groups = names.chain(PAPER.iter().map(|p| format!("{}\n(paper)", p.0))).collect();
    vec![Plot {
        title: String::new(),
        x_label: String::new(),
        y_label: "polygons drawn, % of the scene".into(),
        shape: Shape::Bars { groups, stacked: false },
        series: vec![
            Series::new("after frustum culling", Role::Scene, first_of_each(table, "frustum_percent")),
            Series::new("after occlusion culling", Role::Visible, first_of_each(table, "occlusion_percent")),
            Series::new("after frustum culling, paper", Role::Approximated, theirs(|p| p.2)),
            Series::new("after occlusion culling, paper", Role::Hidden, theirs(|p| p.3)),
        ],
    }]
}
