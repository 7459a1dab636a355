//! Budgets in milliseconds (Section 3: "time-critical"): how long frames take that end at a deadline, on a
//! machine that is idle but for them and on one with two busy threads for each core, and how far they
//! overshoot.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use super::{Judge, METHOD, around, settings};
use crate::drawing::{Plot, Role, Series, Shape};
use crate::measure::deadline::frame_within;
use crate::measure::paper::flight::{about, path};
use crate::measure::paper::walk::stop_or_go;
use crate::measure::paper::{
    Measured, PaperError, SCENE, SOURCE, Setup, Sweep, World, by_scene, column, part,
};
use crate::measure::table::{Cell, Table};
use crate::measure::timing::{median, quantile};
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

fn rows<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<(Vec<Vec<Cell>>, Measured), PaperError> {
    let path = path(scene, setup);
    let all = settings::<S>(METHOD, setup, &[("budget", "100%".to_owned())])?;
    let mut run = around(scene, METHOD, &all, None, &part(progress, 0.0, 0.2))?;
    let (mut judge, mut image, n) = (Judge::new(scene, setup), Target::default(), path.views.len());
    let about = about(scene, &path);
    let mut rows = Vec::new();
    for (m, machine) in MACHINES.into_iter().enumerate() {
        for (d, deadline) in DEADLINES_MS.into_iter().enumerate() {
            let (mut times, mut found, mut drawn) = (Vec::new(), 0.0, 0);
            for (k, view) in path.views.iter().enumerate() {
                let done = (m * DEADLINES_MS.len() + d) * n + k;
                stop_or_go(
                    progress,
                    0.2 + 0.8 * done as f32 / (2 * DEADLINES_MS.len() * n) as f32,
                    "keeping deadlines",
                )?;
                let frame = with_load(m == 1, || {
                    frame_within(&mut *run, scene, view, std::mem::take(&mut image), deadline)
                });
                judge.look(scene, view);
                let verdict = judge.judge(scene, view, &frame.list.prims);
                found += judge.coverage_percent(&verdict) / n as f64;
                drawn += frame.list.prims.len();
                times.push(frame.ms);
                image = frame.image;
            }
            let late: Vec<f64> = times.iter().map(|t| t - deadline).filter(|over| *over > 0.0).collect();
            let share = 100.0 * late.len() as f64 / n as f64;
            let overshoot = (!late.is_empty()).then(|| median(late));
            times.sort_unstable_by(f64::total_cmp);
            let worst = times.last().copied().unwrap_or_default();
            let mut row: Vec<Cell> =
                vec!["measured".into(), about.name.as_str().into(), machine.into(), deadline.into()];
            row.extend([quantile(&times, 0.5), quantile(&times, 0.99), worst, share].map(Cell::from));
            row.extend([overshoot.into(), (drawn as f64 / n as f64).into(), found.into()]);
            rows.push(row);
        }
    }
    Ok((rows, about))
}

/// Does some work, perhaps while two threads for each core are busy.
fn with_load<T>(is_loaded: bool, work: impl FnOnce() -> T) -> T {
    if !is_loaded {
        return work();
    }
    let busy = AtomicBool::new(true);
    let count = 2 * thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..count {
            scope.spawn(|| {
                while busy.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let result = work();
        busy.store(false, Ordering::Relaxed);
        result
    })
}

fn plots(table: &Table) -> Vec<Plot> {
    let lines = |(name, rows): (String, Vec<usize>)| {
        let series = |of: usize, key: &str, label: &str, role: Role| {
            let some = rows.iter().skip(of * DEADLINES_MS.len()).take(DEADLINES_MS.len());
            let points = some
                .filter_map(|&r| Some((table.number(r, "deadline_ms")?, table.number(r, key)?)))
                .collect();
            Series::new(label, role, points)
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
