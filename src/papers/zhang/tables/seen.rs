//! What a run does along a path, counted and compared with the truth.

use std::sync::Arc;

use crate::geometry::View;
use crate::measure::experiment::{ExperimentError, Setup, World};
use crate::measure::harness::{CHECKING, Judge, checkpoint, part, ready};
use crate::papers::keys::{FRUSTUM, OCCLUSION_MAPS};
use crate::scene::{Motion, Progress, Quiet, Scene};

/// Sums over the frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    frames: usize,
    /// Primitives in view, and of them those that were drawn.
    in_view: u64,
    pub drawn: u64,
    /// Leaves that were occluders, and polygons that were drawn of them.
    pub leaves: u64,
    pub occluders: u64,
    /// Of the frames that were compared: visible primitives that were not drawn, pixels of another color.
    pub checked: usize,
    pub missed: usize,
    pub wrong: usize,
}

impl Seen {
    /// Occlusion maps with these settings on top, at each view.
    ///
    /// # Errors
    /// It was cancelled, or a setting does not fit.
    pub fn along<S: World>(
        scene: &Arc<Scene<S>>,
        setup: &Setup,
        views: &[View<S>],
        on_top: &[(&str, &str)],
        progress: &dyn Progress,
    ) -> Result<Self, ExperimentError> {
        let mut run = ready(scene, OCCLUSION_MAPS, setup, on_top, &part(progress, 0.0, 0.2))?;
        let mut frustum = ready(scene, FRUSTUM, setup, &[], &part(progress, 0.2, 0.25))?;
        let (mut judge, mut motion) = (Judge::new(scene, setup), Motion::new(scene));
        let (mut all, rest) = (Self { frames: views.len(), ..Self::default() }, part(progress, 0.25, 1.0));
        for (i, view) in views.iter().enumerate() {
            checkpoint(&rest, i as f32 / views.len() as f32, CHECKING)?;
            let scene = motion.at(i);
            if !run.pose(&scene, &Quiet) || !frustum.pose(&scene, &Quiet) {
                return Err(ExperimentError::Cancelled);
            }
            let (list, tally) = run.count(view);
            let named = tally.named();
            let count = |name: &str| named.get(name).copied().unwrap_or(0);
            all.drawn += list.prims.len() as u64;
            // Its leaves may be smaller: of a box in view all that it holds counts.
            all.in_view += frustum.cull(view).prims.len().max(list.prims.len()) as u64;
            all.leaves += count("occluders_drawn");
            all.occluders += count("occluder_polygons");
            if setup.check_every > 0 && i.is_multiple_of(setup.check_every) {
                judge.pose(&scene);
                let visible = judge.look(view).len();
                let difference = judge.compare(&list.prims);
                all.checked += 1;
                all.missed += visible - difference.found;
                all.wrong += difference.wrong.iter().filter(|wrong| **wrong).count();
            }
        }
        Ok(all)
    }
    /// A sum by frames.
    pub fn mean(&self, sum: u64) -> f64 {
        sum as f64 / self.frames.max(1) as f64
    }
    /// Of the primitives in view those that were not drawn, per cent.
    pub fn culled_percent(&self) -> f64 {
        100.0 * (1.0 - self.drawn as f64 / self.in_view.max(1) as f64)
    }
}
