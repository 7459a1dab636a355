//! Sections 1 and 5.2.3: "very low overhead", "negligible overhead on top of view-frustum culling". The time
//! of the traversal beside that of view-frustum culling with a kD-tree. At a budget of 100 % both draw what
//! is in view, so their difference is what the order costs.

use std::sync::Arc;

use super::ways::{
    BUDGET, DELAUNAY, KD_TREE, Most, OCTREE, PAPERS_DELAUNAY, PAPERS_OCTREE, RULES, Way, ready,
};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::harness::{self, frame, in_turns, mean, part};
use crate::measure::{Cell, Setup, Table};
use crate::papers::keys::FRUSTUM;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        column("tessellation", "cells are of", "", 0),
        RULES,
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

const WAYS: [Way; 5] = [PAPERS_DELAUNAY, PAPERS_OCTREE, DELAUNAY, OCTREE, KD_TREE];
const BASELINE: &str = "view frustum";
/// Budgets, per cent: at the last all that is in view is drawn.
const ALL_BUDGETS: [f64; 5] = [1.0, 2.0, 5.0, 10.0, 100.0];

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let budgets: Vec<Most> = ALL_BUDGETS.map(Most::Percent).to_vec();
    let mut runs = vec![harness::ready(scene, FRUSTUM, setup, &[], &part(progress, 0.0, 0.05))?];
    for (i, way) in WAYS.into_iter().enumerate() {
        runs.extend(ready(
            scene,
            setup,
            way,
            &budgets,
            &part(progress, 0.05 + 0.03 * i as f32, 0.05 + 0.03 * (i + 1) as f32),
        )?);
    }
    let (mut target, n, ways) = (Target::default(), path.views.len(), runs.len());
    let mut drawn = vec![0; ways];
    let frames =
        in_turns(scene, &mut runs, &path.views, &part(progress, 0.2, 1.0), "timing", |run, turn| {
            let (list, times) = frame(turn.scene, run, turn.view, &mut target);
            drawn[turn.run] += usize::from(turn.is_first_round) * list.len();
            times
        })?;
    // The means over the frames of the times to cull and to draw.
    let times: Vec<[f64; 2]> =
        (0..ways).map(|way| [0, 1].map(|i| mean(frames.iter().map(|f| f[way][i])))).collect();
    let about = about(scene, &path);
    let row = |w: usize| {
        let ([cull, draw], [base_cull, base_draw]) = (times[w], times[0]);
        let names = match w.checked_sub(1) {
            None => [BASELINE.into(), Cell::Missing, Cell::Missing],
            Some(w) => {
                let (way, budget) = (w / ALL_BUDGETS.len(), w % ALL_BUDGETS.len());
                let [label, rules] = WAYS[way].cells();
                [label, rules, ALL_BUDGETS[budget].into()]
            }
        };
        let numbers = [drawn[w] as f64 / n as f64, cull, draw, 100.0 * cull / (cull + draw)];
        let mut row = measured(&about.name, names, numbers);
        let over = (w > 0).then_some(cull - base_cull);
        row.extend([over.into(), over.map(|o| 100.0 * o / (base_cull + base_draw)).into()]);
        row
    };
    Ok(((0..ways).map(row).collect(), about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (name, rows) in by_scene(table) {
        let base = table.number(rows[0], "cull_ms").unwrap_or_default();
        let mut series = vec![Series::new(BASELINE, Role::Ink, [1.0, 100.0].map(|x| (x, base)).to_vec())];
        for (way, rows) in WAYS.iter().zip(rows[1..].chunks(ALL_BUDGETS.len())) {
            series.push(Series::new(way.name(), way.role, points(table, rows, BUDGET.key, "cull_ms")));
        }
        plots.push(Plot {
            title: name,
            x_label: "budget, % of the triangles".into(),
            y_label: "time to cull, ms".into(),
            shape: Shape::Lines { logarithmic: true, ticks: ALL_BUDGETS.to_vec() },
            series,
        });
    }
    plots
}
