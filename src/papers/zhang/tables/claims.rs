//! Sections 1 and 6: what the paper says of its models in numbers, beside ours.

use std::sync::Arc;

use super::fly::{fly, of_model};
use crate::culling::depth::Faces;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{
    CHECKED, MISSED, SCENE, SOURCE, by_scene, column, first_of_each, measured, quoted,
};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("polygons", "polygons", "", 0),
        column("database_polygons", "occluder database", "polygons", 0),
        column("database_percent", "of the model", "%", 1),
        column("culled_percent", "culled, mean", "% of those in view", 1),
        column("model_percent", "not drawn, mean", "% of the model", 1),
        column("most_percent", "not drawn, most", "% of the model", 1),
        column("construction_ms", "maps made", "ms", 3),
        column("deviation_ms", "its deviation", "ms", 3),
        column("speedup_ratio", "faster", "times", 2),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// The stage that averages.
const MAPS: usize = 3;

fn rows<S: World + Faces>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let flight = fly(scene, &path, setup, &[], progress)?;
    let about = about(scene, &path);
    let (all, database) = (about.prims as f64, flight.database as f64);
    let least = flight.frames.iter().map(|f| f.drawn).min().unwrap_or_default();
    // Frames in which it is turned off make none.
    let made: Vec<f64> = flight.frames.iter().filter(|f| f.counted.is_on).map(|f| f.stages[MAPS]).collect();
    let middle = made.iter().sum::<f64>() / made.len().max(1) as f64;
    let variance =
        made.iter().map(|ms| (ms - middle) * (ms - middle)).sum::<f64>() / made.len().max(1) as f64;
    let numbers = [
        all,
        database,
        100.0 * database / all.max(1.0),
        flight.mean(|f| f.culled_percent()),
        flight.mean(|f| of_model(about.prims, f.drawn as f64)),
        of_model(about.prims, least as f64),
        middle,
        variance.sqrt(),
        flight.mean(|f| f.frustum_ms) / flight.mean(|f| f.ms()),
    ];
    let mut row = measured(&about.name, [], numbers);
    row.extend(flight.checked.cells());
    Ok((vec![row], about))
}

fn paper() -> Vec<Vec<Cell>> {
    let row = |source: &str, scene: &str, cells: &[(&'static str, Cell)]| {
        let names = [(SOURCE.key, source.into()), (SCENE.key, scene.into())];
        quoted(SWEEP.columns, names.into_iter().chain(cells.iter().cloned()))
    };
    let city = [
        ("polygons", 312_524usize.into()),
        ("database_percent", 100.0.into()),
        ("construction_ms", 9.0.into()),
        ("deviation_ms", 0.5.into()),
        ("speedup_ratio", 5.0.into()),
    ];
    let room = [
        ("polygons", 632_252usize.into()),
        ("database_polygons", 217_636usize.into()),
        ("database_percent", (100.0 * 217_636.0 / 632_252.0).into()),
        ("construction_ms", 4.0.into()),
        ("deviation_ms", 0.5.into()),
        ("speedup_ratio", 2.0.into()),
    ];
    let swarm = [
        ("polygons", 986_800usize.into()),
        ("database_percent", 100.0.into()),
        ("construction_ms", 4.0.into()),
        ("deviation_ms", 0.5.into()),
        ("speedup_ratio", 5.0.into()),
    ];
    vec![
        row("paper, Max Impact", "city", &city),
        row("paper, InfiniteReality", "machine room", &room),
        row("paper, Figure 1", "machine room", &[("model_percent", 82.7.into())]),
        row("paper, InfiniteReality", "dinosaurs and teapots", &swarm),
        row("paper, Section 1", "any of high depth complexity", &[("most_percent", 95.0.into())]),
    ]
}

/// How much faster, in the order of the paper's models.
const FASTER: [f64; 3] = [5.0, 2.0, 5.0];

fn plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    let groups: Vec<String> = scenes.iter().map(|(name, _)| name.clone()).collect();
    let plot = |y_label: &str, series: Vec<Series>| Plot {
        title: String::new(),
        x_label: String::new(),
        y_label: y_label.into(),
        shape: Shape::Bars { groups: groups.clone(), stacked: false },
        series,
    };
    let ours = |key: &str| Series::new("measured", Role::Visible, first_of_each(table, key));
    let mut faster = vec![ours("speedup_ratio")];
    // Only beside the models that are likened to the paper's.
    if scenes.len() == FASTER.len() {
        let points = FASTER.into_iter().enumerate().map(|(i, times)| (i as f64, times)).collect();
        faster.push(Series::new("paper", Role::Approximated, points));
    }
    vec![plot("faster, times", faster), plot("culled of what is in view, %", vec![ours("culled_percent")])]
}
