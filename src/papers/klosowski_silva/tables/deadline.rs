//! Budgets in milliseconds (Section 3: "time-critical"): how long frames take that end at a deadline, on a
//! machine that is idle but for them and on one with two busy threads for each core, and how far they
//! overshoot.

use std::sync::Arc;

use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::columns::{SCENE, SOURCE, by_scene, column, measured, points};
use crate::measure::deadline::frame_within;
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::path::{about, path};
use crate::measure::harness::{Judge, checkpoint, part, ready, under_load};
use crate::measure::timing::{median, quantile};
use crate::measure::{Setup, Table};
use crate::papers::keys::LAYERED_PROJECTION;
use crate::raster::Target;
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SOURCE,
        SCENE,
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
    let build = part(progress, 0.0, 0.2);
    let mut run = ready(scene, LAYERED_PROJECTION, setup, &[("budget", "100%")], &build)?;
    let (mut judge, mut image, n) = (Judge::new(scene, setup), Target::default(), path.views.len());
    let about = about(scene, &path);
    let mut rows = Vec::new();
    for (m, machine) in MACHINES.into_iter().enumerate() {
        for (d, deadline) in DEADLINES_MS.into_iter().enumerate() {
            let (mut times, mut found, mut drawn) = (Vec::new(), 0.0, 0);
            for (k, view) in path.views.iter().enumerate() {
                let done = (m * DEADLINES_MS.len() + d) * n + k;
                checkpoint(
                    progress,
                    0.2 + 0.8 * done as f32 / (2 * DEADLINES_MS.len() * n) as f32,
                    "keeping deadlines",
                )?;
                let old_image = std::mem::take(&mut image);
                let within = || frame_within(&mut *run, scene, view, old_image, deadline);
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
            let mut row = measured(&about.name, [machine.into(), deadline.into()], times);
            row.extend([overshoot.into(), (drawn as f64 / n as f64).into(), found.into()]);
            rows.push(row);
        }
    }
    Ok((rows, about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let lines = |(name, rows): (String, Vec<usize>)| {
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
