//! Sections 1 and 5.2.3: "very low overhead", "negligible overhead on top of view-frustum culling". The time
//! of the traversal beside that of view-frustum culling with a kD-tree. At a budget of 100 % both draw what
//! is in view, so their difference is what the order costs.

use std::sync::Arc;

use super::{BUDGET, BUDGETS, DELAUNAY, KD_TREE, Most, OCTREE, Way, frame, frustum, ready};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::paper::flight::{about, path};
use crate::measure::paper::walk::{ROUNDS, stop_or_go};
use crate::measure::paper::{
    Measured, PaperError, SCENE, SOURCE, Setup, Sweep, World, by_scene, column, part,
};
use crate::measure::table::{Cell, Table};
use crate::measure::timing::median;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("tessellation", "cells are of", "", 0),
        BUDGET,
        column("drawn_triangles", "drawn", "triangles", 0),
        column("cull_ms", "cull", "ms", 3),
        column("draw_ms", "draw", "ms", 3),
        column("cull_share_percent", "cull", "% of its frame", 1),
        column("overhead_ms", "over frustum culling", "ms", 3),
        column("overhead_percent", "of a frame of it", "%", 1),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

const WAYS: [Way; 3] = [DELAUNAY, OCTREE, KD_TREE];
const BASELINE: &str = "view frustum";
const EACH: usize = BUDGETS.len() + 1;

fn rows<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<(Vec<Vec<Cell>>, Measured), PaperError> {
    let path = path(scene, setup);
    let budgets: Vec<Most> = BUDGETS.into_iter().chain([100.0]).map(Most::Percent).collect();
    let mut runs = vec![frustum(scene, setup, &part(progress, 0.0, 0.05))?];
    for (i, way) in WAYS.into_iter().enumerate() {
        runs.extend(ready(
            scene,
            setup,
            way,
            &budgets,
            &part(progress, 0.05 * (i + 1) as f32, 0.05 * (i + 2) as f32),
        )?);
    }
    let (mut target, n, ways) = (Target::default(), path.views.len(), runs.len());
    let mut rounds = vec![vec![[const { Vec::new() }; 2]; n]; ways];
    let mut drawn = vec![0; ways];
    for round in 0..ROUNDS {
        runs.iter_mut().for_each(|r| r.forget());
        for (k, view) in path.views.iter().enumerate() {
            stop_or_go(progress, 0.2 + 0.8 * (round * n + k) as f32 / (ROUNDS * n) as f32, "timing")?;
            for way in (0..ways).map(|w| (w + k + round) % ways) {
                let (list, times) = frame(scene, &mut *runs[way], view, &mut target);
                (0..2).for_each(|i| rounds[way][k][i].push(times[i]));
                drawn[way] += usize::from(round == 0) * list.len();
            }
        }
    }
    let times: Vec<[f64; 2]> = rounds.into_iter().map(|frames| mean_of_medians(&frames)).collect();
    let about = about(scene, &path);
    let row = |w: usize| {
        let ([cull, draw], [base_cull, base_draw]) = (times[w], times[0]);
        let mut row: Vec<Cell> = vec!["measured".into(), about.name.as_str().into()];
        match w.checked_sub(1) {
            None => row.extend([BASELINE.into(), Cell::Missing]),
            Some(w) => {
                row.extend([WAYS[w / EACH].label.into(), [1.0, 2.0, 5.0, 10.0, 100.0][w % EACH].into()])
            }
        }
        row.extend([drawn[w] as f64 / n as f64, cull, draw, 100.0 * cull / (cull + draw)].map(Cell::from));
        let over = (w > 0).then_some(cull - base_cull);
        row.extend([over.into(), over.map(|o| 100.0 * o / (base_cull + base_draw)).into()]);
        row
    };
    Ok(((0..ways).map(row).collect(), about))
}

/// The mean over the frames of the median of the rounds, of both times.
fn mean_of_medians(frames: &[[Vec<f64>; 2]]) -> [f64; 2] {
    [0, 1].map(|i| super::mean(frames.iter().map(|f| median(f[i].clone()))))
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let base = table.number(rows[0], "cull_ms").unwrap_or_default();
        let mut series = vec![Series::new(BASELINE, Role::Ink, [1.0, 100.0].map(|x| (x, base)).to_vec())];
        for (way, rows) in WAYS.iter().zip(rows[1..].chunks(EACH)) {
            let points = rows
                .iter()
                .filter_map(|&r| Some((table.number(r, BUDGET.key)?, table.number(r, "cull_ms")?)))
                .collect();
            series.push(Series::new(way.label, way.role, points));
        }
        plots.push(Plot {
            title: name,
            x_label: "budget, % of the triangles".into(),
            y_label: "time to cull, ms".into(),
            shape: Shape::Lines { logarithmic: true, ticks: vec![1.0, 2.0, 5.0, 10.0, 100.0] },
            series,
        });
    }
    plots
}
