//! The z-buffer of a frame with its z-pyramid: the large state that a run changes and a film replays.

use super::planes::Rays;
use crate::geometry::{PixelRect, PrimId, View};
use crate::raster::{Drawable, Options, Pyramid, PyramidCell, Target};
use crate::scene::Scene;

/// A change of a buffer. A run makes it, and a film makes it again from the note that holds its operands.
#[derive(Clone, Copy, Debug)]
pub enum Step<'a, S: Drawable> {
    /// The tile of a cell is brought up to date.
    Refresh(PyramidCell),
    /// Primitives are drawn.
    ///
    /// Drawing them one by one leads to the same state as drawing them at once, and so may be replayed from
    /// one note a primitive: the image is a function of the set of primitives that are drawn, and drawing
    /// marks tiles as stale and refreshes none.
    Draw {
        /// The scene that they are of.
        scene: &'a Scene<S>,
        /// Which.
        prims: &'a [PrimId],
        /// How.
        options: Options,
    },
}

/// A depth image, its pyramid, and the view it is for.
#[derive(Clone, Debug, Default)]
pub struct Buffer<S: Drawable> {
    view: Option<View<S>>,
    rays: Rays,
    target: Target,
    pyramid: Pyramid,
}

/// Images of the same view with the same pyramid, its stale tiles included.
impl<S: Drawable> PartialEq for Buffer<S> {
    fn eq(&self, other: &Self) -> bool {
        // The rays follow from the view.
        self.view == other.view && self.target == other.target && self.pyramid == other.pyramid
    }
}

impl<S: Drawable> Buffer<S> {
    /// The rays through its pixels.
    #[inline]
    pub(super) fn rays(&self) -> &Rays {
        &self.rays
    }
    /// Empties it for a view.
    pub fn clear(&mut self, view: &View<S>) {
        self.target.clear(view);
        // Once a frame: every query needs them.
        self.rays = Rays::new(view, &view.projection());
        self.view = Some(*view);
        // An empty pixel is as deep as the far plane, in the pyramid as in the image.
        self.pyramid.clear(view.width, view.height, 1.0 / view.eye.far);
    }
    /// Makes a change.
    #[inline]
    pub fn step(&mut self, step: Step<'_, S>) {
        // A run and its film both come through here, so that the same operands make the same change.
        match step {
            Step::Refresh(cell) => self.refresh(cell),
            Step::Draw { scene, prims, options } => self.draw_all(scene, prims, &options),
        }
    }
    /// Draws primitives. The pyramid grows stale.
    fn draw_all(&mut self, scene: &Scene<S>, prims: &[PrimId], options: &Options) {
        if let Some(view) = &self.view {
            S::draw(&mut self.target, scene, view, prims, options);
            // Where they were drawn is not reported: anywhere in the window.
            self.pyramid.touch(options.window.unwrap_or(PixelRect {
                x0: 0,
                x1: view.width,
                y0: 0,
                y1: view.height,
            }));
        }
    }
    /// Farthest depth that is held for a cell.
    #[inline]
    pub fn farthest(&self, cell: PyramidCell) -> f32 {
        self.pyramid.farthest(&self.target.depth, cell)
    }
    /// Farthest depth of a rectangle as it is, from its pixels.
    pub fn farthest_in(&self, r: PixelRect) -> f32 {
        let row = |y: u32| {
            let first = (y * self.target.width) as usize;
            &self.target.depth[first + r.x0 as usize..first + r.x1 as usize]
        };
        (r.y0..r.y1).flat_map(row).fold(f32::INFINITY, |least, &d| if d < least { d } else { least })
    }
    /// Brings the tile of a cell up to date.
    #[inline]
    fn refresh(&mut self, cell: PyramidCell) {
        self.pyramid.refresh(&self.target.depth, cell);
    }
    /// Brings the whole pyramid up to date.
    pub fn refresh_all(&mut self) {
        self.pyramid.refresh_all(&self.target.depth);
    }
    /// The pyramid.
    #[inline]
    pub fn pyramid(&self) -> &Pyramid {
        &self.pyramid
    }
    /// The images.
    pub fn target(&self) -> &Target {
        &self.target
    }
}
