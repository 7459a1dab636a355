//! Budgets in milliseconds (Section 3: "time-critical"): how long frames take that end at a deadline, on a
//! machine that is idle but for them and on one with two busy threads for each core, and how far they
//! overshoot.

use std::sync::Arc;

use super::ways::{OURS, PAPERS, RULES};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::View;
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::deadline::frame_within;
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{at_rest, path};
use crate::measure::harness::{Judge, checkpoint, part, ready, under_load};
use crate::measure::timing::{median, quantile};
use crate::measure::{Cell, ExperimentError, Setup, Table};
use crate::method::Run;
use crate::papers::keys::LAYERED_PROJECTION;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
        RULES,
        column("machine", "machine", "", 0),
        column("deadline_ms", "deadline", "ms", 0),
        column("median_ms", "a frame, median", "ms", 2),
        column("p99_ms", "99 of 100 frames", "ms", 2),
        column("worst_ms", "worst frame", "ms", 2),
        column("late_percent", "frames late", "%", 1),
        column("overshoot_ms", "overshoot of the late ones, median", "ms", 2),
        column("drawn_triangles", "drawn", "triangles", 0),
        column("found_percent", "found", "% of visible", 1),
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

const DEADLINES_MS: [f64; 4] = [2.0, 5.0, 10.0, 20.0];
const MACHINES: [&str; 2] = ["idle", "loaded"];
const LOADED: usize = 1;

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let path = path(scene, setup);
    let mut rows = Vec::new();
    for (i, rules) in [PAPERS, OURS].into_iter().enumerate() {
        let whole = part(progress, 0.5 * i as f32, 0.5 * (i + 1) as f32);
        let on_top = [("budget", "100%"), ("rules", rules)];
        let mut run = ready(scene, LAYERED_PROJECTION, setup, &on_top, &part(&whole, 0.0, 0.2))?;
        rows.extend(rows_of(scene, setup, &mut *run, rules, &path.views, &whole)?);
    }
    Ok((rows, at_rest(scene, &path)))
}

/// The rows of one set of rules: each machine at each deadline.
fn rows_of<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    run: &mut dyn Run<S>,
    rules: &str,
    views: &[View<S>],
    progress: &dyn Progress,
) -> Result<Vec<Vec<Cell>>, ExperimentError> {
    let (mut judge, mut image, n) = (Judge::new(scene, setup), Target::default(), views.len());
    let mut rows = Vec::new();
    for (m, machine) in MACHINES.into_iter().enumerate() {
        for (d, deadline) in DEADLINES_MS.into_iter().enumerate() {
            let (mut times, mut found, mut drawn) = (Vec::new(), 0.0, 0);
            for (k, view) in views.iter().enumerate() {
                let done = (m * DEADLINES_MS.len() + d) * n + k;
                checkpoint(
                    progress,
                    0.2 + 0.8 * done as f32 / (2 * DEADLINES_MS.len() * n) as f32,
                    "keeping deadlines",
                )?;
                let old_image = std::mem::take(&mut image);
                let within = || frame_within(run, scene, view, old_image, deadline);
                let frame = if m == LOADED { under_load(within) } else { within() };
                judge.look(view);
                found += judge.compare(&frame.list.prims).coverage_percent / n as f64;
                drawn += frame.list.prims.len();
                times.push(frame.ms);
                image = frame.image;
            }
            let late: Vec<f64> = times.iter().map(|t| t - deadline).filter(|over| *over > 0.0).collect();
            let share = 100.0 * late.len() as f64 / n as f64;
            let overshoot = (!late.is_empty()).then(|| median(late));
            times.sort_unstable_by(f64::total_cmp);
            let worst = times.last().copied().unwrap_or_default();
            let times = [quantile(&times, 0.5), quantile(&times, 0.99), worst, share];
            let mut row = measured(scene.name(), [rules.into(), machine.into(), deadline.into()], times);
            row.extend([overshoot.into(), (drawn as f64 / n as f64).into(), found.into()]);
            rows.push(row);
        }
    }
    Ok(rows)
}

fn plots(table: &Table) -> Vec<Plot> {
    // The chart shows our rules, whose rows come last.
    let lines = |(name, rows): (String, Vec<usize>)| {
        let rows = &rows[rows.len() / 2..];
        let series = |of: usize, key: &str, label: &str, role: Role| {
            let some = rows.chunks(DEADLINES_MS.len()).nth(of).unwrap_or_default();
            Series::new(label, role, points(table, some, "deadline_ms", key))
        };
        Plot {
            title: name,
            x_label: "deadline, ms".into(),
            y_label: "time of a frame, ms".into(),
            shape: Shape::Lines { logarithmic: true, ticks: DEADLINES_MS.to_vec() },
            series: vec![
                Series::new("the deadline", Role::Ink, DEADLINES_MS.map(|d| (d, d)).to_vec()),
                series(0, "median_ms", "idle, median", Role::Visible),
                series(0, "p99_ms", "idle, 99 of 100", Role::Partial),
                series(1, "median_ms", "loaded, median", Role::Hidden),
                series(1, "p99_ms", "loaded, 99 of 100", Role::Outside),
            ],
        }
    };
    by_scene(table).into_iter().map(lines).collect()
}
