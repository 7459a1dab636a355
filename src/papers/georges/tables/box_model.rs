//! Section 5.2: the box model, as frames a second with its objects in sight and behind the box.

use std::sync::Arc;

use super::fly::fly;
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{CHECKED, MISSED, SCENE, SOURCE, by_scene, column, measured, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::{Cell, Setup, Table};
use crate::scene::{Progress, Scene};

/// The box model: with all objects in sight, and behind the box.
pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("situation", "situation", "", 0),
        column("all_drawn", "drawn, all", "triangles", 0),
        column("culled_drawn", "drawn, culled", "triangles", 0),
        column("all_fps", "all drawn", "frames/s", 1),
        column("frustum_fps", "frustum", "frames/s", 1),
        column("culled_fps", "obscuration", "frames/s", 1),
        column("gain_ratio", "gain over frustum", "times", 2),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Where the viewer is: at either end of the path.
const SITUATIONS: [&str; 2] = ["all in sight", "behind the box"];
/// As the paper says it: it prints no other number.
const PAPER_FPS: [&str; 2] = ["about 2–3", "near the monitor's rate"];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let flight = fly(scene, &path, setup, progress)?;
    let about = about(scene, &path);
    // A tenth of the path at either end.
    let n = path.views.len();
    let some = n.div_ceil(10);
    let row = |situation: &str, frames: std::ops::Range<usize>| {
        let mean = |f: &dyn Fn(usize) -> f64| frames.clone().map(f).sum::<f64>() / frames.len() as f64;
        let [all, frustum, culled] = [0, 1, 2].map(|way| 1000.0 / mean(&|k| flight.times[k][way]));
        let drawn = [0, 2].map(|way| mean(&|k| flight.drawn[k][way] as f64));
        let numbers = [drawn[0], drawn[1], all, frustum, culled, culled / frustum];
        let mut row = measured(&about.name, [situation.into()], numbers);
        row.extend(flight.checked.cells());
        row
    };
    let rows = vec![row(SITUATIONS[0], 0..some), row(SITUATIONS[1], n - some..n)];
    Ok((rows, about))
}

fn paper() -> Vec<Vec<Cell>> {
    let row = |situation: &str, fps: &str| {
        quoted(
            SWEEP.columns,
            [
                (SOURCE.key, "paper, Pixel-Planes 5".into()),
                (SCENE.key, "box and objects".into()),
                ("situation", situation.into()),
                ("culled_fps", fps.into()),
            ],
        )
    };
    PAPER_FPS.into_iter().zip(SITUATIONS).map(|(fps, situation)| row(situation, fps)).collect()
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let series = |key: &str, label: &str, role: Role| {
            let points = rows
                .iter()
                .enumerate()
                .filter_map(|(i, &r)| Some((i as f64, table.number(r, key)?)))
                .collect();
            Series::new(label, role, points)
        };
        plots.push(Plot {
            title: name,
            x_label: String::new(),
            y_label: "frames a second".into(),
            shape: Shape::Bars { groups: SITUATIONS.map(String::from).to_vec(), stacked: false },
            series: vec![
                series("all_fps", "everything drawn", Role::Occluder),
                series("frustum_fps", "view-frustum culling", Role::Outside),
                series("culled_fps", "obscuration culling", Role::Visible),
            ],
        });
    }
    plots
}
