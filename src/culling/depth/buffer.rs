//! The z-buffer of a frame with its z-pyramid: the large state that a run changes and a film replays.

use crate::geometry::{Frustum, PixelRect, PrimId, Projection, View};
use crate::raster::{Drawable, Extent, Options, Pyramid, PyramidCell, Sieve, Target};
use crate::scene::Scene;

/// A view with what follows from it.
#[derive(Clone, Copy, Debug)]
pub struct Sight<S: Drawable> {
    pub view: View<S>,
    pub projection: Projection<S::Vector>,
    pub frustum: Frustum<S::Vector>,
}

/// A depth image, its pyramid, and the view it is for.
#[derive(Clone, Debug)]
pub struct Buffer<S: Drawable> {
    sight: Option<Sight<S>>,
    target: Target,
    pyramid: Pyramid,
    hidden: Vec<PrimId>,
}

/// Images of the same view with the same pyramid, its stale tiles included.
impl<S: Drawable> PartialEq for Buffer<S> {
    fn eq(&self, other: &Self) -> bool {
        let view = |b: &Self| b.sight.as_ref().map(|s| s.view);
        view(self) == view(other) && self.target == other.target && self.pyramid == other.pyramid
    }
}

impl<S: Drawable> Default for Buffer<S> {
    fn default() -> Self {
        Self { sight: None, target: Target::default(), pyramid: Pyramid::default(), hidden: Vec::new() }
    }
}

impl<S: Drawable> Buffer<S> {
    /// The view it is for and its projection, once there is one.
    pub fn view(&self) -> Option<(&View<S>, &Projection<S::Vector>)> {
        self.sight.as_ref().map(|s| (&s.view, &s.projection))
    }
    /// The same with its frustum.
    #[inline]
    pub fn sight(&self) -> Option<&Sight<S>> {
        self.sight.as_ref()
    }
    /// Empties it for a view.
    pub fn clear(&mut self, view: &View<S>) {
        self.target.clear(view);
        self.look(view);
    }
    /// The same for depths alone, which queries need: nobody will look at which primitive shows where.
    pub fn clear_depths(&mut self, view: &View<S>) {
        self.target.clear_depths(view);
        self.look(view);
    }
    fn look(&mut self, view: &View<S>) {
        self.sight = Some(Sight { view: *view, projection: view.projection(), frustum: view.frustum() });
        self.pyramid.clear(view.width, view.height, 1.0 / view.eye.far);
    }
    /// Draws primitives but for those that lie behind their pyramid cells, which are returned in the order of
    /// `prims`. The pyramid grows stale where something was drawn.
    pub fn draw(&mut self, scene: &Scene<S>, prims: &[PrimId], options: &Options) -> &[PrimId] {
        self.hidden.clear();
        if let Some(Sight { view, .. }) = &self.sight {
            let sieve = Sieve { pyramid: &mut self.pyramid, hidden: &mut self.hidden };
            S::sift(&mut self.target, sieve, scene, view, prims, options);
        }
        &self.hidden
    }
    /// Draws primitives without asking the pyramid, which grows stale all over.
    pub fn draw_all(&mut self, scene: &Scene<S>, prims: &[PrimId], options: &Options) {
        if let Some(Sight { view, .. }) = &self.sight {
            S::draw(&mut self.target, scene, view, prims, options);
            self.pyramid.touch(options.window.unwrap_or(PixelRect {
                x0: 0,
                x1: view.width,
                y0: 0,
                y1: view.height,
            }));
        }
    }
    /// What [`Buffer::draw`] compares for a primitive: its extent and the farthest depth that the pyramid
    /// holds for it. The same before and after it was drawn: only refreshing changes what the pyramid holds.
    pub fn operands(&self, scene: &Scene<S>, prim: PrimId, options: &Options) -> Option<(Extent, f32)> {
        let extent = S::extent(scene, &self.sight.as_ref()?.view, prim, options)?;
        Some((extent, self.pyramid.farthest_over(&self.target.depth, extent.pixels)))
    }
    /// Makes a part of the pyramid stale.
    pub fn touch(&mut self, pixels: PixelRect) {
        self.pyramid.touch(pixels);
    }
    /// Farthest depth that is held for a cell.
    #[inline]
    pub fn farthest(&self, cell: PyramidCell) -> f32 {
        self.pyramid.farthest(&self.target.depth, cell)
    }
    /// Farthest depth that is held for a rectangle.
    pub fn farthest_over(&self, pixels: PixelRect) -> f32 {
        self.pyramid.farthest_over(&self.target.depth, pixels)
    }
    /// Brings the tile of a cell up to date.
    #[inline]
    pub fn refresh(&mut self, cell: PyramidCell) {
        self.pyramid.refresh(&self.target.depth, cell);
    }
    /// Brings the tiles under a rectangle up to date if no more than `most` are stale; returns how many were.
    pub fn refresh_under(&mut self, pixels: PixelRect, most: usize) -> usize {
        if pixels.is_empty() { 0 } else { self.pyramid.refresh_under(&self.target.depth, pixels, most) }
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
