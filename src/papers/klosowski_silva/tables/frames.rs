//! Figures 10 and 11, (a) and (b): frame by frame the visible triangles that each budget finds, and the time
//! of a frame.

use std::sync::Arc;

use super::ways::{BUDGETS, BY_CENTROID, DELAUNAY, FRAME, KD_TREE, Most, OCTREE, Way, ready};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::harness::{self, Judge, frame, in_turns, mean, part};
use crate::measure::{Cell, Setup, Table};
use crate::method::Settings;
use crate::papers::keys::FRUSTUM;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        FRAME,
        column("visible_triangles", "visible", "triangles", 0),
        column("found_1_triangles", "found, 1 %", "triangles", 0),
        column("found_2_triangles", "2 %", "triangles", 0),
        column("found_5_triangles", "5 %", "triangles", 0),
        column("found_10_triangles", "10 %", "triangles", 0),
        column("centroid_10_triangles", "centroid 10 %", "triangles", 0),
        column("frustum_ms", "frame, all in view", "ms", 2),
        column("budget_1_ms", "1 %", "ms", 2),
        column("budget_2_ms", "2 %", "ms", 2),
        column("budget_5_ms", "5 %", "ms", 2),
        column("budget_10_ms", "10 %", "ms", 2),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// Charts: key, label, role.
const FOUND: [(&str, &str, Role); 6] = [
    ("visible_triangles", "exact", Role::Ink),
    ("found_10_triangles", "10 %", Role::Visible),
    ("found_5_triangles", "5 %", Role::Hidden),
    ("found_2_triangles", "2 %", Role::Partial),
    ("found_1_triangles", "1 %", Role::Approximated),
    ("centroid_10_triangles", "centroid, 10 %", Role::Outside),
];
const TIMES: [(&str, &str, Role); 5] = [
    ("frustum_ms", "all in the view frustum", Role::Ink),
    ("budget_10_ms", "10 %", Role::Visible),
    ("budget_5_ms", "5 %", Role::Hidden),
    ("budget_2_ms", "2 %", Role::Partial),
    ("budget_1_ms", "1 %", Role::Approximated),
];

/// The method with the cells that the settings name.
fn as_set(settings: &Settings) -> Way {
    let given = settings.0.get("tessellation").map(String::as_str);
    [OCTREE, KD_TREE].into_iter().find(|w| w.tessellation == given).unwrap_or(DELAUNAY)
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let build = part(progress, 0.0, 0.1);
    let mut runs = vec![harness::ready(scene, FRUSTUM, setup, &[], &part(progress, 0.11, 0.2))?];
    runs.extend(ready(scene, setup, as_set(&setup.settings), &BUDGETS.map(Most::Percent), &build)?);
    // The centroid order is not timed, as in the paper.
    let mut centroid = ready(scene, setup, BY_CENTROID, &[Most::Percent(10.0)], &part(progress, 0.1, 0.11))?;
    let (mut judge, mut target) = (Judge::new(scene, setup), Target::default());
    // Of each frame what is visible, what each budget finds, what the centroid order finds.
    let mut found = vec![[0.0; 6]; path.views.len()];
    let times = in_turns(&mut runs, &path.views, &part(progress, 0.2, 1.0), "flying", |run, turn| {
        if turn.is_first_round && turn.is_first_run {
            found[turn.frame][0] = judge.look(turn.view).len() as f64;
            found[turn.frame][5] = judge.compare(&centroid[0].cull(turn.view).prims).found as f64;
        }
        let (list, times) = frame(scene, run, turn.view, &mut target);
        // The first run is that of view-frustum culling, which finds everything.
        if turn.is_first_round && turn.run > 0 {
            found[turn.frame][turn.run] = judge.compare(&list).found as f64;
        }
        [times.iter().sum()]
    })?;
    let times: Vec<[f64; 5]> = times.iter().map(|runs| std::array::from_fn(|r| runs[r][0])).collect();
    let about = about(scene, &path);
    let row = |frame: Cell, found: [f64; 6], times: [f64; 5]| {
        let mut row = measured(&about.name, [frame], found);
        row.extend(times.map(Cell::from));
        row
    };
    let mean_found = std::array::from_fn(|c| mean(found.iter().map(|f| f[c])));
    let mean_times = std::array::from_fn(|c| mean(times.iter().map(|t| t[c])));
    let mut rows = vec![row("mean".into(), mean_found, mean_times)];
    rows.extend(
        found.iter().zip(&times).enumerate().map(|(k, (found, times))| row(k.into(), *found, *times)),
    );
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let series = |&(key, label, role): &(&str, &str, Role)| {
            Series::new(label, role, points(table, &rows, FRAME.key, key))
        };
        let plot = |what: &str, y_label: &str, of: &[(&str, &str, Role)]| Plot {
            title: format!("{name}: {what}"),
            x_label: "frame".into(),
            y_label: y_label.into(),
            shape: Shape::Lines { logarithmic: false, ticks: Vec::new() },
            series: of.iter().map(series).collect(),
        };
        plots.push(plot("what is found", "visible triangles", &FOUND));
        plots.push(plot("time of a frame", "culled and drawn, ms", &TIMES));
    }
    plots
}
