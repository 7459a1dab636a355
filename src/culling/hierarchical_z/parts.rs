//! The parts of the method by themselves: an image that is drawn, and boxes and rectangles that are queried.
//! For figures, benchmarks and tests, which all look at the very functions that the method runs.

use std::sync::Arc;

use glam::Vec3;

use super::index::CubeIndex;
use super::{HierarchicalZ, Memory, Params};
use crate::culling::depth::picture::{last_reads, levels};
use crate::culling::depth::{Buffer, DepthNote, Faces, Query, QueryReporter, Step, Tiled};
use crate::drawing::Drawing;
use crate::geometry::{Eye, NodeId, PixelRect, Solid, View};
use crate::method::{DrawList, Frame, Method, Recorder, SettingError, Settings, State, Unobserved, params};
use crate::raster::{Boxes, DepthScale, Options};
use crate::scene::{Parts, Progress, Scene, SceneError};

/// Key of the method whose parts these are.
pub const METHOD: &str = <HierarchicalZ as Method<Solid>>::CARD.key;

/// Occluders of a scene, to be drawn for a view and then asked about boxes.
pub struct Obscurer<S: Faces> {
    scene: Arc<Scene<S>>,
    index: CubeIndex<S>,
    params: Params,
    memory: Memory,
    state: Tiled<S>,
}

impl<S: Faces> Obscurer<S> {
    /// Builds the octree; `Ok(None)` when cancelled.
    ///
    /// # Errors
    /// A setting that does not fit the method.
    pub fn new(
        scene: &Arc<Scene<S>>,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, SettingError> {
        let params = params::<S, HierarchicalZ>(settings)?;
        // It fails only on a saved preprocess, and none is given.
        let index = HierarchicalZ::build(scene, &params, None, progress).unwrap_or_default();
        Ok(index.map(|index| Self {
            scene: scene.clone(),
            index,
            params,
            memory: Memory::default(),
            state: Tiled::default(),
        }))
    }
    /// Draws a frame, with what is remembered of the last one. Returns what the image needs.
    pub fn render(&mut self, view: &View<S>) -> DrawList<S> {
        let mut list = DrawList::default();
        let (index, scene, params) = (&self.index, &*self.scene, &self.params);
        let frame = Frame { index, scene, view, params, limit: None };
        // As a run does it, with nobody listening.
        self.state.begin(&frame);
        HierarchicalZ::cull(&frame, &mut self.memory, &mut self.state, &mut list, &mut Unobserved);
        list
    }
    /// Forgets earlier frames.
    pub fn forget(&mut self) {
        self.memory = Memory::default();
    }
    /// Whether boxes are hidden by what was drawn last, by their planes, in order; `None` if one is out of
    /// view.
    pub fn hides_all(&mut self, boxes: &Boxes) -> Vec<Option<bool>> {
        self.state.hides_all(boxes)
    }
}

/// The levels of the pyramid over all of a scene's image, and if a face is given, as a rectangle of pixels
/// and its nearest depth (world units), the cells that are read for it. Also whether it is hidden.
pub fn pyramid_picture<S: Faces>(
    scene: &Scene<S>,
    view: &View<S>,
    face: Option<(PixelRect, f32)>,
    scale: DepthScale,
) -> (Drawing, bool) {
    let mut buffer = Buffer::default();
    buffer.clear(view);
    buffer.step(Step::Draw { scene, prims: scene.live(), options: Options::default() });
    // No part of the picture is to be hatched as stale.
    buffer.refresh_all();
    let mut recorder: Recorder<DepthNote<S>> = Recorder::new(usize::MAX);
    let mut is_hidden = false;
    if let Some((pixels, depth)) = face {
        // The face is of no node and of no line of the pseudocode; the picture shows neither.
        is_hidden = Query::new(&mut buffer, 1.0 / depth, QueryReporter::new(NodeId(0), None, &mut recorder))
            .rectangle(pixels)
            .is_hidden;
    }
    (levels(&buffer, view, &last_reads(recorder.notes.iter().rev().map(Some)), scale), is_hidden)
}

/// The depths of Figure 1 of Georges 1995, each a square of one pixel that deep, and the straight view of
/// them.
///
/// # Errors
/// None; the scene is valid.
pub fn figure_1() -> Result<(Scene<Solid>, View<Solid>), SceneError> {
    // Level 0 of the figure, row by row from the top.
    let depths = [[4, 9, 8, 8], [4, 5, 1, 3], [6, 2, 2, 4], [2, 2, 2, 4]];
    let (mut points, mut prims) = (Vec::new(), Vec::new());
    for (row, depths) in depths.iter().enumerate() {
        for (column, &depth) in depths.iter().enumerate() {
            let (x, y) = (column as f32 - 2.0, 2.0 - row as f32);
            let first = points.len() as u32;
            // The image is 4 wide at depth 2.
            // Scaled with its depth, a square covers the same pixel however deep it is.
            points.extend(
                [(x, y), (x, y - 1.0), (x + 1.0, y - 1.0), (x + 1.0, y)]
                    .map(|(x, y)| Vec3::new(x, y, -2.0) * (depth as f32 / 2.0)),
            );
            prims.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    let scene = Scene::new(Parts::simple("Figure 1 of Georges 1995", points, prims))?;
    // A right angle shows 4 units at depth 2, a unit a pixel; all depths lie between the planes.
    let eye = Eye {
        position: Vec3::ZERO,
        target: Vec3::NEG_Z,
        up: Vec3::Y,
        fov: std::f32::consts::FRAC_PI_2,
        near: 0.5,
        far: 20.0,
    };
    Ok((scene, View { eye, width: 4, height: 4 }))
}
