//! Section 7: what occlusion culling costs where nothing is hidden, with and without turning it off.

use std::sync::Arc;

use super::fly::{Flight, fly};
use crate::culling::depth::Faces;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{CHECKED, MISSED, SCENE, SOURCE, by_scene, column, measured};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::part;
use crate::measure::harness::path::{about, path};
use crate::measure::timing::median;
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("way", "turned off", "", 0),
        column("on_percent", "culling on", "% of frames", 1),
        column("in_view_triangles", "in view", "triangles", 0),
        column("covered_triangles", "culled behind occluders", "triangles", 0),
        column("occluder_triangles", "occluders", "triangles", 0),
        column("tests", "nodes tested", "", 0),
        column("map_reads", "map pixels read", "", 0),
        column("frustum_ms", "frustum culling", "ms", 2),
        column("maps_ms", "occlusion maps", "ms", 2),
        column("over_percent", "time over it", "%", 2),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// Whether it may be turned off.
const WAYS: [(&str, &str); 2] = [("automatically", "true"), ("never", "false")];

fn row(name: &str, way: &str, flight: &Flight) -> Vec<Cell> {
    let over = flight.frames.iter().map(|f| 100.0 * (f.ms() / f.frustum_ms.max(1e-9) - 1.0)).collect();
    let numbers = [
        flight.mean(|f| if f.counted.is_on { 100.0 } else { 0.0 }),
        flight.mean(|f| f.counted.in_view as f64),
        flight.mean(|f| f.counted.covered as f64),
        flight.mean(|f| f.counted.occluders as f64),
        flight.mean(|f| f.counted.depth_tests as f64),
        flight.mean(|f| f.counted.map_reads as f64),
        flight.mean(|f| f.frustum_ms),
        flight.mean(|f| f.ms()),
        median(over),
    ];
    let mut row = measured(name, [way.into()], numbers);
    row.extend(flight.checked.cells());
    row
}

fn rows<S: World + Faces>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let (about, mut rows) = (about(scene, &path), Vec::new());
    for (i, (way, adapts)) in WAYS.into_iter().enumerate() {
        let half = part(progress, 0.5 * i as f32, 0.5 * (i + 1) as f32);
        rows.push(row(&about.name, way, &fly(scene, &path, setup, &[("adapt", adapts)], &half)?));
    }
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let plot = |(name, rows): (String, Vec<usize>)| {
        let bars = |key: &str, label: &str, role: Role| {
            let points = rows.iter().enumerate();
            let points = points.filter_map(|(i, &r)| Some((i as f64, table.number(r, key)?)));
            Series::new(label, role, points.collect())
        };
        Plot {
            title: name,
            x_label: String::new(),
            y_label: "frame, ms".into(),
            shape: Shape::Bars {
                groups: WAYS.map(|(way, _)| format!("turned off {way}")).to_vec(),
                stacked: false,
            },
            series: vec![
                bars("frustum_ms", "view-frustum culling", Role::Outside),
                bars("maps_ms", "occlusion maps", Role::Visible),
            ],
        }
    };
    by_scene(table).into_iter().map(plot).collect()
}
