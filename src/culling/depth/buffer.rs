//! The z-buffer of a frame with its z-pyramid: the large state that a run changes and a film replays.

use super::planes::Rays;
use crate::geometry::{Frustum, PixelRect, PrimId, Projection, View};
use crate::raster::{Drawable, Extent, Options, Pyramid, PyramidCell, Sieve, Target};
use crate::scene::Scene;

/// A view with its projection and its planes, which every query needs.
#[derive(Clone, Copy, Debug)]
pub struct Projected<S: Drawable> {
    pub view: View<S>,
    pub projection: Projection<S::Vector>,
    pub frustum: Frustum<S::Vector>,
}

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
#[derive(Clone, Debug)]
pub struct Buffer<S: Drawable> {
    projected: Option<Projected<S>>,
    rays: Rays,
    target: Target,
    pyramid: Pyramid,
    hidden: Vec<PrimId>,
}

/// Images of the same view with the same pyramid, its stale tiles included.
impl<S: Drawable> PartialEq for Buffer<S> {
    fn eq(&self, other: &Self) -> bool {
        // Projection, planes and rays follow from the view, and `hidden` is no state: it is what the last
        // drawing left out.
        let view = |b: &Self| b.projected.as_ref().map(|s| s.view);
        view(self) == view(other) && self.target == other.target && self.pyramid == other.pyramid
    }
}

impl<S: Drawable> Default for Buffer<S> {
    fn default() -> Self {
        Self {
            projected: None,
            rays: Rays::default(),
            target: Target::default(),
            pyramid: Pyramid::default(),
            hidden: Vec::new(),
        }
    }
}

impl<S: Drawable> Buffer<S> {
    /// The view it is for and its projection, once there is one.
    pub fn view(&self) -> Option<(&View<S>, &Projection<S::Vector>)> {
        self.projected.as_ref().map(|s| (&s.view, &s.projection))
    }
    /// The same with its frustum.
    #[inline]
    pub fn projected(&self) -> Option<&Projected<S>> {
        self.projected.as_ref()
    }
    /// The rays through its pixels.
    #[inline]
    pub(super) fn rays(&self) -> &Rays {
        &self.rays
    }
    /// Empties it for a view.
    pub fn clear(&mut self, view: &View<S>) {
        self.target.clear(view);
        self.look(view);
    }
    fn look(&mut self, view: &View<S>) {
        // Once a frame: every query needs all of them.
        let projection = view.projection();
        self.rays = Rays::new(view, &projection);
        self.projected = Some(Projected { view: *view, projection, frustum: view.frustum() });
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
    /// Draws primitives but for those that lie behind their pyramid cells, which are returned in the order of
    /// `prims`. The pyramid grows stale where something was drawn.
    pub fn draw(&mut self, scene: &Scene<S>, prims: &[PrimId], options: &Options) -> &[PrimId] {
        self.hidden.clear();
        if let Some(Projected { view, .. }) = &self.projected {
            // Greene, Kass and Miller 1993, Section 3.2: the pyramid also rejects single primitives. A
            // departure from Georges 1995, Section 3.2: what is drawn only marks tiles as stale.
            let sieve = Sieve { pyramid: &mut self.pyramid, hidden: &mut self.hidden };
            S::sift(&mut self.target, sieve, scene, view, prims, options);
        }
        &self.hidden
    }
    /// Draws primitives without asking the pyramid, which grows stale all over.
    fn draw_all(&mut self, scene: &Scene<S>, prims: &[PrimId], options: &Options) {
        if let Some(Projected { view, .. }) = &self.projected {
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
    /// What [`Buffer::draw`] compares for a primitive: its extent and the farthest depth that the pyramid
    /// holds for it. The same before and after it was drawn: only refreshing changes what the pyramid holds
    /// above level 0.
    pub fn operands(&self, scene: &Scene<S>, prim: PrimId, options: &Options) -> Option<(Extent, f32)> {
        // Nothing is refreshed for it, so to record what was compared does not change what is read next.
        let extent = S::extent(scene, &self.projected.as_ref()?.view, prim, options)?;
        Some((extent, self.pyramid.farthest_over(&self.target.depth, extent.pixels)))
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
