//! Figures 10 and 11, (a) and (b): frame by frame the visible triangles that each budget finds, and the time
//! of a frame.

use std::sync::Arc;

use super::{BUDGETS, BY_CENTROID, DELAUNAY, FRAME, Judge, Most, Way, frame, frustum, mean, ready};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::paper::flight::{about, path};
use crate::measure::paper::walk::{ROUNDS, stop_or_go};
use crate::measure::paper::{
    Measured, PaperError, SCENE, SOURCE, Setup, Sweep, World, by_scene, column, part,
};
use crate::measure::table::{Cell, Table};
use crate::measure::timing::median;
use crate::method::Settings;
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
    [super::OCTREE, super::KD_TREE].into_iter().find(|w| w.tessellation == given).unwrap_or(DELAUNAY)
}

fn rows<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<(Vec<Vec<Cell>>, Measured), PaperError> {
    let path = path(scene, setup);
    let mut runs =
        ready(scene, setup, as_set(&setup.settings), &BUDGETS.map(Most::Percent), &part(progress, 0.0, 0.1))?;
    let centroid = ready(scene, setup, BY_CENTROID, &[Most::Percent(10.0)], &part(progress, 0.1, 0.11))?;
    runs.extend(centroid);
    runs.insert(0, frustum(scene, setup, &part(progress, 0.11, 0.2))?);
    let (mut judge, mut target) = (Judge::new(scene, setup), Target::default());
    let n = path.views.len();
    let mut found = vec![Vec::new(); n];
    // The centroid order is not timed, as in the paper.
    let mut times = vec![[const { Vec::new() }; 5]; n];
    for round in 0..ROUNDS {
        runs.iter_mut().for_each(|r| r.forget());
        for (k, view) in path.views.iter().enumerate() {
            stop_or_go(progress, 0.2 + 0.8 * (round * n + k) as f32 / (ROUNDS * n) as f32, "flying")?;
            for way in (0..5).map(|w| (w + k + round) % 5) {
                times[k][way].push(frame(scene, &mut *runs[way], view, &mut target).1.iter().sum());
            }
            if round == 0 {
                judge.look(scene, view);
                found[k].push(judge.visible.len());
                for run in &mut runs[1..] {
                    found[k].push(judge.judge(scene, view, &run.cull(view).prims).found);
                }
            }
        }
    }
    let times: Vec<[f64; 5]> = times.into_iter().map(|ways| ways.map(median)).collect();
    let about = about(scene, &path);
    let row = |frame: Cell, found: Vec<f64>, times: [f64; 5]| {
        let text: [Cell; 3] = ["measured".into(), about.name.as_str().into(), frame];
        text.into_iter().chain(found.into_iter().chain(times).map(Cell::from)).collect::<Vec<Cell>>()
    };
    let means = (0..6).map(|c| mean(found.iter().map(|f| f[c] as f64))).collect();
    let mut rows = vec![row("mean".into(), means, std::array::from_fn(|c| mean(times.iter().map(|t| t[c]))))];
    rows.extend((0..n).map(|k| row(k.into(), found[k].iter().map(|&f| f as f64).collect(), times[k])));
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let series = |&(key, label, role): &(&str, &str, Role)| {
            let points = rows
                .iter()
                .filter_map(|&r| Some((table.number(r, FRAME.key)?, table.number(r, key)?)))
                .collect();
            Series::new(label, role, points)
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
