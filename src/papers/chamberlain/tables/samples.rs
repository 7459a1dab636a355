//! Images of several samples a pixel, as all of the paper's have (Section 5), with and without the hierarchy.

use std::sync::Arc;

use crate::geometry::{Space, Vector, View};
use crate::measure::experiment::World;
use crate::measure::harness::ready;
use crate::measure::{ExperimentError, Setup};
use crate::method::{DrawList, Run};
use crate::papers::keys::{COLOR_CUBES, Z_BUFFER};
use crate::raster::{Canvas, Options, Target, averaged};
use crate::scene::{Progress, Scene};

/// Samples of a pixel, across and down.
pub const SAMPLES: u32 = 2;
/// What the images have behind the scene, linear.
const BACKGROUND: [f32; 3] = [1.0; 3];

/// The samples of a view's image with `side` pixels a side, as pixels of a larger one.
pub fn sampled<S: Space>(view: &View<S>, side: u32, samples: u32) -> View<S> {
    let width = side * samples;
    View { width, height: if S::Vector::AXES == 2 { 1 } else { width }, ..*view }
}

/// All of a scene drawn as geometry.
///
/// # Errors
/// It was cancelled.
pub fn geometry<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    progress: &dyn Progress,
) -> Result<Box<dyn Run<S>>, ExperimentError> {
    ready(scene, Z_BUFFER, setup, &[], progress)
}

/// Color cubes with the experiment's settings, and these on top; the threshold is of pixels, not of samples,
/// which are pixels of the views.
///
/// # Errors
/// A setting does not fit, or it was cancelled.
pub fn color_cubes<S: World>(
    scene: &Arc<Scene<S>>,
    setup: &Setup,
    on_top: &[(&str, &str)],
    progress: &dyn Progress,
) -> Result<Box<dyn Run<S>>, ExperimentError> {
    // The method itself says what is wrong with a value.
    let pixels = |value: &String| value.parse().unwrap_or(1.0);
    let pixels: f32 = setup.settings.0.get("pixel-threshold").map_or(1.0, pixels);
    let threshold = (pixels * SAMPLES as f32).to_string();
    let on_top: Vec<_> =
        on_top.iter().copied().chain([("pixel-threshold", &*threshold), ("samples", "1")]).collect();
    ready(scene, COLOR_CUBES, setup, &on_top, progress)
}

/// What a frame is drawn into.
#[derive(Default)]
pub struct Images {
    pub target: Target,
    pub canvas: Canvas,
}

impl Images {
    /// Culls and draws a frame; what was listed.
    pub fn frame<S: World>(
        &mut self,
        run: &mut dyn Run<S>,
        scene: &Scene<S>,
        view: &View<S>,
        options: &Options,
    ) -> DrawList<S> {
        let list = run.cull(view);
        list.draw((&mut self.target, &mut self.canvas), scene, view, options);
        list
    }
    /// The picture of the last frame, of so many samples a pixel: RGBA, sRGB.
    pub fn picture<S: World>(
        &self,
        list: &DrawList<S>,
        scene: &Scene<S>,
        view: &View<S>,
        samples: u32,
    ) -> Vec<u8> {
        // Geometry in the light in which cubes are, so that the light is not what is compared.
        let light = crate::raster::Light::Fixed;
        let rgba = list.picture(scene, view, (&self.target, &self.canvas), (light, BACKGROUND));
        let down = if view.height == 1 { 1 } else { samples };
        averaged(&rgba, view.width as usize, [samples, down].map(|n| n as usize))
    }
}
