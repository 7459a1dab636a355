//! A flight along the scene's own path: everything drawn, view-frustum culling and obscuration culling in
//! turn at each frame.

use std::sync::Arc;

use crate::geometry::ViewPath;
use crate::measure::experiment::World;
use crate::measure::harness::{Checked, Judge, frame, in_turns, part, ready};
use crate::measure::{ExperimentError, Setup};
use crate::papers::keys::{FRUSTUM, HIERARCHICAL_Z, Z_BUFFER};
use crate::raster::Target;
use crate::scene::{Progress, Scene};

/// The ways to make a frame, in the order of [`Flight`]'s numbers.
const WAYS: [&str; 3] = [Z_BUFFER, FRUSTUM, HIERARCHICAL_Z];
/// The way whose answers are checked.
const CULLED: usize = 2;

/// What was measured along a path: everything drawn, frustum culling, obscuration culling.
pub struct Flight {
    /// Of each frame and way the time from the view to the finished image, ms.
    pub times: Vec<[f64; 3]>,
    /// Of each frame and way how many triangles were drawn.
    pub drawn: Vec<[usize; 3]>,
    /// The answers of obscuration culling against the truth.
    pub checked: Checked,
}

/// Flies along a path.
pub fn fly<S: World>(
    scene: &Arc<Scene<S>>,
    path: &ViewPath<S>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<Flight, ExperimentError> {
    let mut runs = Vec::new();
    for (i, key) in WAYS.into_iter().enumerate() {
        let step = part(progress, 0.05 * i as f32, 0.05 * (i + 1) as f32);
        runs.push(ready(scene, key, setup, &[], &step)?);
    }
    let mut judge = Judge::new(scene, setup);
    let mut targets = [(); WAYS.len()].map(|()| Target::default());
    let mut drawn = vec![[0; WAYS.len()]; path.views.len()];
    let mut checked = Checked::default();
    let rest = part(progress, 0.15, 1.0);
    let times = in_turns(scene, &mut runs, &path.views, &rest, "flying", |run, turn| {
        let (list, [cull, draw]) = frame(turn.scene, run, turn.view, &mut targets[turn.run]);
        drawn[turn.frame][turn.run] = list.len();
        if turn.run == CULLED && turn.is_first_round {
            judge.pose(turn.scene);
            checked.join(judge.check(turn.frame, turn.view, &list));
        }
        [cull + draw]
    })?;
    let times = times.into_iter().map(|ways| std::array::from_fn(|way| ways[way][0])).collect();
    Ok(Flight { times, drawn, checked })
}
