//! What the paper leaves open in Section 5: how many occluders. Polygons drawn and time to cull against a
//! fixed number (k of the paper), and against the least marginal gain that an occluder must bring to be
//! taken.

use std::sync::Arc;

use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::WALKING_STEP_M;
use crate::measure::columns::{CHECKED, MISSED, SCENE, by_scene, column, quoted};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::{Judge, Moment, Stretch, Walk, part, ready, times};
use crate::measure::{Cell, ExperimentError, Setup, Table, timed};
use crate::method::Run;
use crate::papers::keys::{FRUSTUM, LARGE_OCCLUDERS};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SCENE,
        column("parameter", "parameter", "", 0),
        column("value", "value", "", 0),
        column("active_occluders", "active", "occluders", 1),
        column("frustum_percent", "frustum", "% drawn", 1),
        column("occlusion_percent", "occlusion", "% drawn", 2),
        column("cull_ms", "cull", "ms", 3),
        column("build_ms", "build", "ms", 0),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper,
    plots,
};

/// Fixed numbers of occluders.
const FIXED: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];
/// Least marginal gains, percent, out of at most 64 occluders.
const GAINS: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];
/// How many values are tried in all, and what they are values of.
const ALL: usize = FIXED.len() + GAINS.len();
const NUMBER: &str = "occluders";
const GAIN: &str = "marginal-gain";
/// The greatest number, which gains are tried with.
const MOST: &str = "64";

fn values() -> impl Iterator<Item = (&'static str, u32)> {
    FIXED.into_iter().map(|v| (NUMBER, v)).chain(GAINS.into_iter().map(|v| (GAIN, v)))
}

/// The paper's number of occluders, and percent drawn for Soda and City (Table 1).
const PAPER: (f64, [(&str, f64); 2]) = (32.0, [("Soda", 2.6), ("City", 5.6)]);

/// The method with one value of the parameter.
struct Tried<S: World> {
    run: Box<dyn Run<S>>,
    build_ms: f64,
    parameter: &'static str,
    value: u32,
}

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let (walk, mut judge) = (Walk::new(scene, setup), Judge::new(scene, setup));
    let mut frustum = ready(scene, FRUSTUM, setup, &[], &part(progress, 0.0, 0.02))?;
    let stretches = walk.stretches(WALKING_STEP_M);
    let views = walk.spread();
    let all = (views.len() * scene.live().len()) as f64;
    let before = 100.0 * views.iter().map(|v| frustum.cull(v).prims.len()).sum::<usize>() as f64 / all;
    let mut tried = Vec::with_capacity(ALL);
    for (i, (parameter, value)) in values().enumerate() {
        let text = value.to_string();
        let settings = if parameter == NUMBER {
            [(NUMBER, &*text), (GAIN, "0")]
        } else {
            [(NUMBER, MOST), (GAIN, &*text)]
        };
        let step = part(progress, 0.02 + i as f32 * 0.02, 0.04 + i as f32 * 0.02);
        let (run, build_ms) = timed(|| ready(scene, LARGE_OCCLUDERS, setup, &settings, &step));
        tried.push(Tried { run: run?, build_ms, parameter, value });
    }
    let cull_ms = time(&mut tried, stretches, &part(progress, 0.3, 0.65))?;
    let mut rows = Vec::new();
    for (i, (one, cull_ms)) in tried.iter_mut().zip(cull_ms).enumerate() {
        let step = part(progress, 0.65 + i as f32 * 0.025, 0.675 + i as f32 * 0.025);
        one.run.forget();
        let (mut drawn, mut active) = (0, 0);
        let checked = judge.each(&views, &step, "culling", |view| {
            let (list, tally) = one.run.count(view);
            drawn += list.prims.len();
            active += tally.named().get("occluders_active").copied().unwrap_or(0);
            list.prims
        })?;
        let percent = 100.0 * drawn as f64 / all;
        let numbers = [
            f64::from(one.value),
            active as f64 / views.len() as f64,
            before,
            percent,
            cull_ms,
            one.build_ms,
        ]
        .map(Cell::from);
        let names = [walk.about.name.as_str().into(), one.parameter.into()];
        rows.push(names.into_iter().chain(numbers).chain(checked.cells()).collect());
    }
    Ok((rows, walk.about))
}

/// All of them, frame by frame in turn.
fn time<S: World>(
    tried: &mut [Tried<S>],
    stretches: Vec<Stretch<S>>,
    progress: &dyn Progress,
) -> Result<[f64; ALL], ExperimentError> {
    times(stretches, progress, |moment| {
        let mut all = [0.0; ALL];
        for (time, one) in all.iter_mut().zip(tried.iter_mut()) {
            match moment {
                Moment::Begin => one.run.forget(),
                Moment::Frame(view) => *time = timed(|| one.run.cull(view)).1,
            }
        }
        all
    })
}

fn paper() -> Vec<Vec<Cell>> {
    let row = |(scene, percent): (&str, f64)| {
        quoted(
            SWEEP.columns,
            [
                (SCENE.key, Cell::Text(format!("{scene} (paper)"))),
                ("parameter", NUMBER.into()),
                ("value", PAPER.0.into()),
                ("occlusion_percent", percent.into()),
            ],
        )
    };
    PAPER.1.map(row).to_vec()
}

fn plots(table: &Table) -> Vec<Plot> {
    let scenes = by_scene(table);
    let named = |row: usize, name: &str| table.rows[row].contains(&Cell::Text(name.into()));
    // Roles for three scenes; with more they repeat.
    let roles =
        [(Role::Visible, Role::Partial), (Role::Eye, Role::Evidence), (Role::Occluder, Role::Outside)];
    let line = |rows: &[usize], parameter: &str, x: &str, y: &str| -> Vec<(f64, f64)> {
        rows.iter()
            .filter(|&&r| named(r, parameter))
            .filter_map(|&r| Some((table.number(r, x)?, table.number(r, y)?)))
            .collect()
    };
    let mut by_number = Vec::new();
    let mut by_time = Vec::new();
    for (i, (name, rows)) in scenes.iter().enumerate() {
        let (fixed, gain) = roles[i % roles.len()];
        by_number.push(Series::new(
            format!("{name}, fixed number"),
            fixed,
            line(rows, NUMBER, "value", "occlusion_percent"),
        ));
        by_time.push(Series::new(
            format!("{name}, fixed number"),
            fixed,
            line(rows, NUMBER, "cull_ms", "occlusion_percent"),
        ));
        by_time.push(Series::new(
            format!("{name}, by marginal gain"),
            gain,
            line(rows, GAIN, "cull_ms", "occlusion_percent"),
        ));
    }
    let quoted = [Role::Hidden, Role::Approximated];
    by_number.extend(
        PAPER
            .1
            .iter()
            .zip(quoted)
            .map(|(p, role)| Series::new(format!("paper, {}", p.0), role, vec![(PAPER.0, p.1)])),
    );
    let plot = |x_label: &str, shape: Shape, series: Vec<Series>| Plot {
        title: String::new(),
        x_label: x_label.into(),
        y_label: "polygons drawn, % of the scene".into(),
        shape,
        series,
    };
    let ticks = FIXED.map(f64::from).to_vec();
    vec![
        plot("occluders for each direction, k", Shape::Lines { logarithmic: true, ticks }, by_number),
        plot("time to cull, ms", Shape::Lines { logarithmic: false, ticks: Vec::new() }, by_time),
    ]
}
