//! Table 3: time in visibility processing against the speed of the walker: what temporal coherence saves.
//!
//! The paper's caption calls the speeds multiples of the slowest one, which is walking speed; but its slowest
//! is 0.25. Here 1 is walking speed, as in Tables 1 and 2.

use std::sync::Arc;

use crate::drawing::{Plot, Role, Series, Shape};
use crate::geometry::WALKING_STEP_M;
use crate::measure::columns::{CHECKED, MISSED, SCENE, by_scene, column, points};
use crate::measure::experiment::{Rows, Sweep, World};
use crate::measure::harness::{CHECKING, Checked, Judge, Moment, Stretch, Walk, part, ready, times_of};
use crate::measure::{Cell, Setup, Table, timed};
use crate::method::Run;
use crate::papers::keys::{FRUSTUM, LARGE_OCCLUDERS};
use crate::scene::{Progress, Scene};

pub const SWEEP: Sweep = Sweep {
    columns: &[
        SCENE,
        column("speed_ratio", "speed", "× walking", 2),
        column("cull_ms", "cull", "ms", 3),
        column("no_cache_cull_ms", "no cache", "ms", 3),
        column("frustum_cull_ms", "frustum", "ms", 3),
        column("kept_ratio", "cull", "of no cache", 2),
        column("cull_ratio", "cull", "of 1×", 2),
        column("no_cache_ratio", "no cache", "of 1×", 2),
        column("paper_soda_ms", "Soda", "ms", 0),
        column("paper_soda_ratio", "Soda", "of 1×", 2),
        column("paper_city_ms", "City", "ms", 0),
        column("paper_city_ratio", "City", "of 1×", 2),
        MISSED,
        CHECKED,
    ],
    flat: rows,
    solid: rows,
    paper: Vec::new,
    plots,
};

/// Speed as a multiple of walking, then Soda and City, ms.
const PAPER: [(f64, [f64; 2]); 7] = [
    (0.25, [17.0, 19.0]),
    (0.5, [18.0, 21.0]),
    (1.0, [21.0, 24.0]),
    (2.0, [25.0, 29.0]),
    (4.0, [32.0, 35.0]),
    (8.0, [45.0, 45.0]),
    (16.0, [56.0, 55.0]),
];
/// Where in [`PAPER`] walking speed stands.
const WALKING: usize = 2;

fn rows<S: World>(scene: &Arc<Scene<S>>, setup: &Setup, progress: &dyn Progress) -> Rows {
    let (walk, mut judge) = (Walk::new(scene, setup), Judge::new(scene, setup));
    let mut frustum = ready(scene, FRUSTUM, setup, &[], &part(progress, 0.0, 0.04))?;
    let with_cache = |cache: &str, progress: &dyn Progress| {
        ready(scene, LARGE_OCCLUDERS, setup, &[("cache", cache)], progress)
    };
    let mut kept = with_cache("true", &part(progress, 0.04, 0.1))?;
    let mut fresh = with_cache("false", &part(progress, 0.1, 0.16))?;
    let walks: Vec<Vec<Stretch<S>>> =
        PAPER.iter().map(|(speed, _)| walk.stretches(WALKING_STEP_M * *speed as f32)).collect();
    let all = times_of(&walks, &part(progress, 0.16, 0.86), |moment| {
        let Moment::Frame(view) = moment else {
            kept.forget();
            fresh.forget();
            return [0.0; 3];
        };
        let cull = |run: &mut dyn Run<S>| timed(|| run.cull(view)).1;
        [cull(&mut *kept), cull(&mut *fresh), cull(&mut *frustum)]
    })?;
    let mut measured = Vec::new();
    for (i, (times, stretches)) in all.into_iter().zip(&walks).enumerate() {
        kept.forget();
        let mut checked = Checked::default();
        let step = part(progress, 0.86 + 0.02 * i as f32, 0.88 + 0.02 * i as f32);
        for stretch in stretches {
            checked.join(judge.each(&stretch.frames, &step, CHECKING, |view| kept.cull(view).prims)?);
        }
        measured.push((times, checked));
    }
    let walking = measured[WALKING].0[0];
    let mut rows = Vec::new();
    for (([kept, fresh, frustum], checked), (speed, theirs)) in measured.into_iter().zip(&PAPER) {
        let ratio = |scene: usize| theirs[scene] / PAPER[WALKING].1[scene];
        let ours = [*speed, kept, fresh, frustum, kept / fresh, kept / walking, fresh / walking];
        let numbers = ours.into_iter().chain([theirs[0], ratio(0), theirs[1], ratio(1)]).map(Cell::from);
        let name = [Cell::from(walk.about.name.as_str())];
        rows.push(name.into_iter().chain(numbers).chain(checked.cells()).collect());
    }
    Ok((rows, walk.about))
}

fn plots(table: &Table) -> Vec<Plot> {
    let panel = |(name, rows): (String, Vec<usize>)| {
        let ours = |key: &str| points(table, &rows, "speed_ratio", key);
        let theirs = |scene: usize| {
            PAPER.iter().map(|(speed, t)| (*speed, t[scene] / PAPER[WALKING].1[scene])).collect()
        };
        Plot {
            title: name,
            x_label: "speed, multiples of walking".into(),
            y_label: "time to cull, multiples of that at walking speed".into(),
            shape: Shape::Lines { logarithmic: true, ticks: PAPER.iter().map(|p| p.0).collect() },
            series: vec![
                Series::new("planes kept", Role::Visible, ours("cull_ratio")),
                Series::new("planes made anew every frame", Role::Occluder, ours("no_cache_ratio")),
                Series::new("planes kept, paper, Soda", Role::Hidden, theirs(0)),
                Series::new("planes kept, paper, City", Role::Approximated, theirs(1)),
            ],
        }
    };
    by_scene(table).into_iter().map(panel).collect()
}
