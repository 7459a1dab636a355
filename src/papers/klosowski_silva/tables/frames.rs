//! Figures 10 and 11, (a) and (b): frame by frame the visible triangles that each budget finds, and the time
//! of a frame.

use std::sync::Arc;

use super::ways::{BUDGETS, BY_CENTROID, FRAME, Most, OURS, PAPERS, RULES, Runs, ready, way};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::harness::{self, Judge, frame, in_turns, mean, part};
use crate::measure::{Cell, ExperimentError, Setup, Table};
use crate::papers::keys::FRUSTUM;
use crate::raster::Target;
use crate::scene::{Progress, Quiet, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        RULES,
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

/// The rules that are compared.
const BOTH: [&str; 2] = [PAPERS, OURS];

/// View-frustum culling, then the method at each budget, by the paper's rules and by ours, with the cells
/// that the settings name.
fn runs<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<Runs<S>, ExperimentError> {
    let mut runs = vec![harness::ready(scene, FRUSTUM, setup, &[], &part(progress, 0.0, 0.1))?];
    let given = setup.settings.0.get("tessellation").map(String::as_str);
    let cells = ["octree", "kd-tree"].into_iter().find(|cells| given == Some(*cells)).unwrap_or("delaunay");
    for (i, rules) in BOTH.into_iter().enumerate() {
        let build = part(progress, 0.1 + 0.45 * i as f32, 0.1 + 0.45 * (i + 1) as f32);
        let way = way("", cells, rules, Role::Ink);
        runs.extend(ready(scene, setup, way, &BUDGETS.map(Most::Percent), &build)?);
    }
    Ok(runs)
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let mut runs = runs(scene, setup, &part(progress, 0.0, 0.19))?;
    // The centroid order is not timed, as in the paper.
    let mut order = ready(scene, setup, BY_CENTROID, &[Most::Percent(10.0)], &part(progress, 0.19, 0.2))?;
    let (mut judge, mut target) = (Judge::new(scene, setup), Target::default());
    // Of each frame by each of the rules what is visible, what each budget finds, what the centroid order
    // finds.
    let mut found = vec![[[0.0; 6]; 2]; path.views.len()];
    let times = in_turns(scene, &mut runs, &path.views, &part(progress, 0.2, 1.0), "flying", |run, turn| {
        if turn.is_first_round && turn.is_first_run {
            judge.pose(turn.scene);
            let visible = judge.look(turn.view).len() as f64;
            order[0].pose(turn.scene, &Quiet);
            let nearest = judge.compare(&order[0].cull(turn.view).prims).found as f64;
            found[turn.frame].iter_mut().for_each(|to| (to[0], to[5]) = (visible, nearest));
        }
        let (list, times) = frame(turn.scene, run, turn.view, &mut target);
        // The first run is that of view-frustum culling, which finds everything.
        if let Some(run) = turn.run.checked_sub(1).filter(|_| turn.is_first_round) {
            let (rules, budget) = (run / BUDGETS.len(), run % BUDGETS.len());
            found[turn.frame][rules][1 + budget] = judge.compare(&list).found as f64;
        }
        [times.iter().sum()]
    })?;
    let about = about(scene, &path);
    let mut rows = Vec::new();
    for (i, rules) in BOTH.into_iter().enumerate() {
        let row = |frame: Cell, found: [f64; 6], times: [f64; 5]| {
            let mut row = measured(&about.name, [rules.into(), frame], found);
            row.extend(times.map(Cell::from));
            row
        };
        let found: Vec<[f64; 6]> = found.iter().map(|both| both[i]).collect();
        let time = |runs: &Vec<[f64; 1]>, c: usize| runs[if c == 0 { 0 } else { BUDGETS.len() * i + c }][0];
        let times: Vec<[f64; 5]> = times.iter().map(|runs| std::array::from_fn(|c| time(runs, c))).collect();
        let mean_found = std::array::from_fn(|c| mean(found.iter().map(|f| f[c])));
        let mean_times = std::array::from_fn(|c| mean(times.iter().map(|t| t[c])));
        rows.push(row("mean".into(), mean_found, mean_times));
        rows.extend(
            found.iter().zip(&times).enumerate().map(|(k, (found, times))| row(k.into(), *found, *times)),
        );
    }
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        for (rules, rows) in ["the paper's rules", "our rules"].into_iter().zip(rows.chunks(rows.len() / 2)) {
            let series = |&(key, label, role): &(&str, &str, Role)| {
                Series::new(label, role, points(table, rows, FRAME.key, key))
            };
            let plot = |what: &str, y_label: &str, of: &[(&str, &str, Role)]| Plot {
                title: format!("{name}, {rules}: {what}"),
                x_label: "frame".into(),
                y_label: y_label.into(),
                shape: Shape::Lines { logarithmic: false, ticks: Vec::new() },
                series: of.iter().map(series).collect(),
            };
            plots.push(plot("what is found", "visible triangles", &FOUND));
            plots.push(plot("time of a frame", "culled and drawn, ms", &TIMES));
        }
    }
    plots
}
