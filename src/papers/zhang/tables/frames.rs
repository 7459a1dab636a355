//! Figure 9: frame by frame the time with and without occlusion culling, and what is culled.

use std::sync::Arc;

use super::fly::{FRAME, Flown, fly, of_model};
use crate::culling::depth::Faces;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{CHECKED, MISSED, SCENE, SOURCE, by_scene, column, measured, points, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        FRAME,
        column("in_view_triangles", "in view", "triangles", 0),
        column("occluder_triangles", "occluders", "triangles", 0),
        column("drawn_triangles", "drawn", "triangles", 0),
        column("culled_percent", "culled", "% of those in view", 1),
        column("model_percent", "not drawn", "% of the model", 1),
        column("frustum_ms", "frame without", "ms", 2),
        column("maps_ms", "with", "ms", 2),
        column("speedup_ratio", "faster", "times", 2),
        column("visible_ms", "what shows, drawn alone", "ms", 2),
        column("visible_ratio", "with, of that", "times", 2),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Model, machine, and how much faster its frames are (Figures 11 to 13).
const PAPER: [(&str, &str, f64); 3] = [
    ("city, 312,524", "paper, Max Impact", 5.0),
    ("machine room, 632,252", "paper, InfiniteReality", 2.0),
    ("dinosaurs and teapots, 986,800", "paper, InfiniteReality", 5.0),
];

/// A figure of a frame.
type Figure<'a> = &'a dyn Fn(&Flown) -> f64;

fn rows<S: World + Faces>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let flight = fly(scene, &path, setup, &[], progress)?;
    let about = about(scene, &path);
    let row = |frame: Cell, of: &dyn Fn(Figure<'_>) -> f64| {
        let counts = [
            of(&|f| f.counted.in_view as f64),
            of(&|f| f.counted.occluders as f64),
            of(&|f| f.drawn as f64),
            of(&Flown::culled_percent),
            of(&|f| of_model(about.prims, f.drawn as f64)),
        ];
        let [frustum, maps] = [of(&|f| f.frustum_ms), of(&Flown::ms)];
        let mut row = measured(&about.name, [frame], counts);
        let visible = of(&|f| f.visible_ms);
        row.extend([frustum, maps, frustum / maps, visible, maps / visible].map(Cell::from));
        row
    };
    let mut mean = row("mean".into(), &|of| flight.mean(of));
    mean.extend(flight.checked.cells());
    let mut rows = vec![mean];
    for (k, frame) in flight.frames.iter().enumerate() {
        let mut row = row(k.into(), &|of| of(frame));
        row.extend([Cell::Missing, Cell::Missing]);
        rows.push(row);
    }
    Ok((rows, about))
}

fn paper() -> Vec<Vec<Cell>> {
    let row = |(model, source, faster): (&str, &str, f64)| {
        let cells = [
            (SOURCE.key, source.into()),
            (SCENE.key, model.into()),
            (FRAME.key, "mean".into()),
            ("speedup_ratio", faster.into()),
        ];
        quoted(SWEEP.columns, cells)
    };
    PAPER.map(row).to_vec()
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let series = |(key, label, role): (&str, &str, Role)| {
            Series::new(label, role, points(table, &rows, FRAME.key, key))
        };
        let plot = |what: &str, y_label: &str, series: Vec<Series>| Plot {
            title: format!("{name}: {what}"),
            x_label: "frame".into(),
            y_label: y_label.into(),
            shape: Shape::Lines { logarithmic: false, ticks: Vec::new() },
            series,
        };
        let times = [
            ("frustum_ms", "without occlusion culling", Role::Outside),
            ("maps_ms", "with occlusion culling", Role::Visible),
        ];
        plots.push(plot("time", "frame, ms", times.map(series).to_vec()));
        let culled = [
            ("culled_percent", "culled of what is in view", Role::Hidden),
            ("model_percent", "not drawn, of the whole model", Role::Ink),
        ];
        plots.push(plot("culled", "triangles, %", culled.map(series).to_vec()));
        let counts = [
            ("in_view_triangles", "in view", Role::Outside),
            ("drawn_triangles", "drawn", Role::Visible),
            ("occluder_triangles", "occluders", Role::Occluder),
        ];
        plots.push(plot("counts", "triangles", counts.map(series).to_vec()));
    }
    plots
}
