//! View-frustum culling and occlusion culling, both ready for the same walk.

use std::sync::Arc;

use crate::measure::experiment::World;
use crate::measure::harness::{Judge, Walk, part, ready};
use crate::measure::{ExperimentError, Setup};
use crate::method::Run;
use crate::papers::keys::{FRUSTUM, LARGE_OCCLUDERS};
use crate::scene::{Progress, Scene};

/// A walk with both methods ready on its scene.
pub struct Both<S: World> {
    /// The walk.
    pub walk: Walk<S>,
    /// Who judges the answers.
    pub judge: Judge<S>,
    /// View-frustum culling.
    pub frustum: Box<dyn Run<S>>,
    /// Occlusion culling.
    pub occlusion: Box<dyn Run<S>>,
}

impl<S: World> Both<S> {
    /// Builds what both need; it is `done` of `progress` then.
    pub fn new(
        scene: &Arc<Scene<S>>,
        setup: &Setup,
        progress: &dyn Progress,
        done: f32,
    ) -> Result<Self, ExperimentError> {
        Ok(Self {
            walk: Walk::new(scene, setup),
            judge: Judge::new(scene, setup),
            frustum: ready(scene, FRUSTUM, setup, &[], &part(progress, 0.0, 0.25 * done))?,
            occlusion: ready(scene, LARGE_OCCLUDERS, setup, &[], &part(progress, 0.25 * done, done))?,
        })
    }
}
