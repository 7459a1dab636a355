//! What the budget leaves, compared with the z-buffer of what it drew. Two extensions of Section 6:
//!
//! 1. "Render a first chunk of geometry, then use the hardware to cull away unprojected geometry": queries
//!    for the rest, which make the result exact.
//! 3. "Adjust the PLP budget to increase the quality": how much of the image the rest could still change,
//!    by which a budget is found to be enough.
//!
//! A cell is hidden if its box is; then the primitives that meet it alone are. Of those that meet several
//! cells each is compared by itself, since its fragments may reach over a cell's boundary by the rasterizer's
//! rounding.

use crate::culling::depth::{Answer, Buffer, Faces, Nobody, footprint, hides};
use crate::geometry::{Aabb, Footprint, PixelRect, PrimId, View};
use crate::raster::{Options, PyramidCell};
use crate::scene::{Scene, Surfaces};

/// The z-buffer of a frame.
pub struct Rest<S: Faces> {
    buffer: Buffer<S>,
    /// How many of the frame's primitives it holds.
    drawn: usize,
    options: Options,
}

impl<S: Faces> Rest<S> {
    /// For primitives that are known to face the eye where that matters.
    pub fn new(view: &View<S>, surfaces: Surfaces) -> Self {
        let mut buffer = Buffer::default();
        buffer.clear(view);
        let options = Options { surfaces: surfaces.both_sides(), ..Options::default() };
        Self { buffer, drawn: 0, options }
    }
    /// Draws what was added to the frame's primitives.
    pub fn catch_up(&mut self, scene: &Scene<S>, prims: &[PrimId]) {
        if self.drawn < prims.len() {
            // Those that the pyramid hides are not drawn, which changes no pixel.
            self.buffer.draw(scene, &prims[self.drawn..], &self.options);
            self.drawn = prims.len();
        }
    }
    /// Whether a box is hidden; `None` if it is out of view.
    pub fn hides(&mut self, bounds: &Aabb<S::Vector>) -> Option<Answer> {
        // Nobody listens to single reads: the walk notes the answer as a whole.
        hides(&mut self.buffer, bounds, Nobody)
    }
    /// Draws these primitives, not yet among the frame's, and returns the hidden ones of them.
    pub fn draw(&mut self, scene: &Scene<S>, prims: &[PrimId]) -> &[PrimId] {
        self.buffer.refresh_all();
        self.buffer.draw(scene, prims, &self.options)
    }
    /// What [`Rest::draw`] compared for a primitive: its nearest depth, and the farthest that is drawn where
    /// it would show, `1/w`. `None` where the view volume cuts it or it covers no pixel.
    pub fn depths(&self, scene: &Scene<S>, prim: PrimId) -> Option<[f32; 2]> {
        // Right also after the primitive was drawn, as long as it is no single pixel: until the pyramid is
        // refreshed it holds what it held.
        let (extent, held) = self.buffer.operands(scene, prim, &self.options)?;
        Some([extent.nearest, held])
    }
    /// Begins to find out what part of the image can still change.
    pub fn doubt(&mut self, view: &View<S>) -> Doubt<'_, S> {
        self.buffer.refresh_all();
        let (columns, rows) = self.buffer.pyramid().size(Doubt::<S>::LEVEL);
        Doubt {
            buffer: &self.buffer,
            view: *view,
            columns,
            marks: vec![false; (columns * rows) as usize],
            is_all: false,
        }
    }
}

/// The blocks of pixels that something not drawn yet could change.
pub struct Doubt<'a, S: Faces> {
    buffer: &'a Buffer<S>,
    view: View<S>,
    columns: u32,
    marks: Vec<bool>,
    is_all: bool,
}

impl<S: Faces> Doubt<'_, S> {
    /// Level of the pyramid whose cells are marked: blocks of 4 × 4 pixels. Finer, and the boxes' rectangles
    /// cost sixteen times as many marks; coarser, and a block with one open pixel counts as changed by ever
    /// more pixels that are not.
    const LEVEL: u32 = 2;

    /// Marks what the contents of a box could change.
    pub fn of_box(&mut self, bounds: &Aabb<S::Vector>) {
        // Without bounds in the image it could change any pixel.
        self.is_all |= !self.is_bounded(bounds);
    }
    /// Marks what a primitive could change; whether that is known.
    pub fn of_prim(&mut self, scene: &Scene<S>, prim: PrimId) -> bool {
        if let Some((extent, _)) = self.buffer.operands(scene, prim, &Options::default()) {
            self.mark(extent.pixels, extent.nearest);
            return true;
        }
        // It covers no pixel, or it is cut by the view volume and its box may say enough.
        self.is_bounded(&scene.prim_bounds(prim))
    }
    /// Marks the image of a box; whether it has one: what reaches the near plane has no bounds.
    fn is_bounded(&mut self, bounds: &Aabb<S::Vector>) -> bool {
        let Some((view, projection)) = self.buffer.view() else { return true };
        let footprint = footprint(view, projection, bounds);
        if let Footprint::Seen(image) = &footprint {
            self.mark(image.pixels, image.nearest);
        }
        !matches!(footprint, Footprint::CrossesNear)
    }
    fn mark(&mut self, r: PixelRect, nearest: f32) {
        if r.is_empty() || self.is_all {
            return;
        }
        // In `1/w` the greater is the nearer: something at least as near as the farthest that a block holds
        // could show in it. Equal depths count, since which of two equals shows is the rasterizer's choice.
        for y in r.y0 >> Self::LEVEL..=(r.y1 - 1) >> Self::LEVEL {
            for x in r.x0 >> Self::LEVEL..=(r.x1 - 1) >> Self::LEVEL {
                let mark = &mut self.marks[(y * self.columns + x) as usize];
                let cell = PyramidCell { level: Self::LEVEL as u8, x: x as u16, y: y as u16 };
                *mark = *mark || nearest >= self.buffer.farthest(cell);
            }
        }
    }
    /// The share of the image that is marked.
    pub fn share(&self) -> f32 {
        if self.is_all {
            return 1.0;
        }
        let (width, height) = (self.view.width, self.view.height);
        // Blocks at the right and lower border are cut by the image: count their pixels, not the blocks.
        let pixels = |at: usize| {
            let (x, y) = (at as u32 % self.columns, at as u32 / self.columns);
            let r = PyramidCell { level: Self::LEVEL as u8, x: x as u16, y: y as u16 }.pixels(width, height);
            u64::from(r.x1 - r.x0) * u64::from(r.y1 - r.y0)
        };
        let marked: u64 = (0..self.marks.len()).filter(|&at| self.marks[at]).map(pixels).sum();
        (marked as f64 / (f64::from(width) * f64::from(height))) as f32
    }
}
