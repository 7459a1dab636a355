//! Section 5.2: the model with a hidden dense body, as times of frames along a flight.

use std::sync::Arc;

use super::fly::fly;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{
    CHECKED, MISSED, SCENE, SOURCE, by_scene, column, first_of_each, measured, quoted,
};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::timing::median;
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

/// The time of frames along a flight.
pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("frames", "frames", "", 0),
        column("frustum_drawn", "drawn, frustum", "triangles", 0),
        column("culled_drawn", "drawn, obscuration", "triangles", 0),
        column("all_ms", "all drawn", "ms", 2),
        column("frustum_ms", "frustum", "ms", 2),
        column("culled_ms", "obscuration", "ms", 2),
        column("gain_percent", "frame rate gained", "%", 0),
        column("median_gain_percent", "median of frames", "%", 0),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// "20-30%", in frames in which the body is in the view frustum and hidden.
const PAPER_GAIN_PERCENT: &str = "20–30 where it is hidden";

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let flight = fly(scene, &path, setup, progress)?;
    let n = path.views.len() as f64;
    let mean = |way: usize| flight.times.iter().map(|t| t[way]).sum::<f64>() / n;
    let drawn = |way: usize| flight.drawn.iter().map(|d| d[way] as f64).sum::<f64>() / n;
    let each = median(flight.times.iter().map(|t| 100.0 * (t[1] / t[2] - 1.0)).collect());
    let numbers = [n, drawn(1), drawn(2), mean(0), mean(1), mean(2), 100.0 * (mean(1) / mean(2) - 1.0), each];
    let about = about(scene, &path);
    let mut row = measured(&about.name, [], numbers);
    row.extend(flight.checked.cells());
    Ok((vec![row], about))
}

fn paper() -> Vec<Vec<Cell>> {
    let cells = [
        (SOURCE.key, "paper, Pixel-Planes 5".into()),
        (SCENE.key, "submarine, torpedo hidden".into()),
        ("gain_percent", PAPER_GAIN_PERCENT.into()),
    ];
    vec![quoted(SWEEP.columns, cells)]
}

fn plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    let bars = |key: &str, label: &str, role: Role| Series::new(label, role, first_of_each(table, key));
    vec![Plot {
        title: "Time of a frame".into(),
        x_label: String::new(),
        y_label: "ms, mean along the flight".into(),
        shape: Shape::Bars { groups: scenes.iter().map(|(name, _)| name.clone()).collect(), stacked: false },
        series: vec![
            bars("all_ms", "everything drawn", Role::Occluder),
            bars("frustum_ms", "view-frustum culling", Role::Outside),
            bars("culled_ms", "obscuration culling", Role::Visible),
        ],
    }]
}
