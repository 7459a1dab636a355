//! What the budget leaves, compared with the depths of what it drew. Two extensions of Section 6:
//!
//! 1. "Render a first chunk of geometry, then use the hardware to cull away unprojected geometry": queries
//!    for the rest, which make the result exact.
//! 2. "Adjust the PLP budget to increase the quality": how much of the image the rest could still change,
//!    by which a budget is found to be enough.
//!
//! The z-buffer is tiles ([`Tiled`]), into which cells are drawn whole. A cell is hidden if its box is; then
//! the primitives that meet it alone are. Of those that meet several cells each is compared by itself, since
//! its fragments may reach over a cell's boundary by the rasterizer's rounding.

use std::marker::PhantomData;
use std::sync::Arc;

use super::explain::Evidence;
use super::index::node_of;
use crate::culling::depth::{Answer, Faces, Summary, TileStep, Tiled, deciding, footprint};
use crate::geometry::{Aabb, CellId, Footprint, NodeId, PixelRect, PrimId, View};
use crate::index::tessellation::Cellular;
use crate::method::Observer;
use crate::raster::{Clusters, Fate, Hears, Options, PyramidCell, Read};
use crate::scene::{Scene, Surfaces};

/// The depths of a frame.
pub struct Rest<S: Faces> {
    tiled: Tiled<S>,
    /// Cells that were projected since something was asked last.
    waiting: Vec<CellId>,
    one_sided: bool,
}

impl<S: Cellular + Faces> Rest<S> {
    /// `clusters`: what cells hold; of a scene of `prims` primitives.
    pub fn new(view: &View<S>, clusters: &Arc<Clusters>, prims: usize, surfaces: Surfaces) -> Self {
        let mut tiled = Tiled::default();
        tiled.clear(view, clusters, prims);
        Self { tiled, waiting: Vec::new(), one_sided: surfaces.one_sided }
    }
    /// Takes in a cell that is in view and was projected.
    pub fn add(&mut self, cell: CellId) {
        self.waiting.push(cell);
    }
    /// Draws what was projected.
    pub fn catch_up(&mut self) {
        // Only now: most of a frame is projected before anything is asked, and without a question nothing is
        // drawn.
        for cell in self.waiting.drain(..) {
            self.tiled.step(TileStep::Draw(node_of(cell), self.one_sided));
        }
    }
    /// Whether a box is hidden; `None` if it is out of view. What decided is found for `O` to tell.
    pub fn hides<O: Observer<Evidence<S>>>(&mut self, bounds: &Aabb<S::Vector>) -> Option<Answer> {
        let mut sum = Sum::<_, O>::default();
        // Exactly: a cell that is let through though it is hidden costs more than some tiles' depths.
        let (is_hidden, nearest) = self.tiled.hides_box(bounds, true, &mut sum)?;
        Some(sum.summary.answer(is_hidden, nearest))
    }
    /// Draws what several cells share and none of them drew. Returns of each primitive of the scene whether
    /// it is among these and hidden.
    pub fn draw_shared<O: Observer<Evidence<S>>>(&mut self, scene: &Scene<S>) -> Vec<bool> {
        let (mut is_hidden, mut apart) = (vec![false; scene.prim_count()], Vec::new());
        // Most of it is in hidden cells.
        for &(prim, fate) in self.tiled.draw_unhidden(NodeId(0), self.one_sided) {
            match fate {
                Fate::Shown => {}
                Fate::Hidden | Fate::Away => is_hidden[prim.at()] = true,
                Fate::Apart => apart.push(prim),
            }
        }
        // What hides nothing is in no tile, so its box is asked for. By tiles alone, as the others are.
        for prim in apart {
            let mut sum = Sum::<_, O>::default();
            let hidden = self.tiled.hides_box(&scene.prim_bounds(prim), false, &mut sum);
            is_hidden[prim.at()] = hidden.is_none_or(|(is_hidden, _)| is_hidden);
        }
        is_hidden
    }
    /// The nearest depth of a primitive in the tile in which it comes nearest to showing, and the farthest
    /// that is drawn there, `1/w`. `None` if it covers no pixel.
    pub fn depths(&self, scene: &Scene<S>, view: &View<S>, prim: PrimId) -> Option<[f32; 2]> {
        deciding(self.tiled.tiles(), scene, view, prim).map(|read| [read.nearest, read.held])
    }
    /// Begins to find out what part of the image can still change.
    pub fn doubt(&mut self, view: &View<S>) -> Doubt<'_, S> {
        let [columns, rows] = self.tiled.tiles().size(PyramidCell::TILE);
        Doubt {
            tiled: &mut self.tiled,
            view: *view,
            columns,
            marks: vec![(0.0, 0); (columns * rows) as usize],
            is_all: false,
        }
    }
}

/// Sums up what a question reads, where `O` listens: the walk notes the answer as a whole, no single reads.
struct Sum<N, O> {
    summary: Summary,
    kinds: PhantomData<(N, O)>,
}

impl<N, O> Default for Sum<N, O> {
    fn default() -> Self {
        Self { summary: Summary::default(), kinds: PhantomData }
    }
}

impl<N, O: Observer<N>> Hears for Sum<N, O> {
    const LISTENS: bool = O::LISTENS;
    fn reads(&mut self, read: Read) {
        self.summary.take(&read);
    }
    fn refreshes(&mut self, _: PyramidCell) {}
}

/// The pixels that something not drawn yet could change.
pub struct Doubt<'a, S: Faces> {
    tiled: &'a mut Tiled<S>,
    view: View<S>,
    columns: u32,
    /// For each tile the nearest depth at which anything of the rest could show in it, and the pixels at
    /// which something could, bit `8 y + x`.
    marks: Vec<(f32, u32)>,
    is_all: bool,
}

impl<S: Faces> Doubt<'_, S> {
    /// Marks what the contents of a box could change.
    pub fn of_box(&mut self, bounds: &Aabb<S::Vector>) {
        // Without bounds in the image it could change any pixel.
        self.is_all |= !self.is_bounded(bounds);
    }
    /// Marks what a primitive could change; whether that is known.
    pub fn of_prim(&mut self, scene: &Scene<S>, prim: PrimId) -> bool {
        if let Some(extent) = S::extent(scene, &self.view, prim, &Options::default()) {
            self.mark(extent.pixels, extent.nearest);
            return true;
        }
        // It covers no pixel, or it is cut by the view volume and its box may say enough.
        self.is_bounded(&scene.prim_bounds(prim))
    }
    /// Marks the image of a box; whether it has one: what reaches the near plane has no bounds.
    fn is_bounded(&mut self, bounds: &Aabb<S::Vector>) -> bool {
        let Some(seen) = self.tiled.projected() else { return true };
        let footprint = footprint(&seen.view, &seen.projection, bounds);
        if let Footprint::Seen(image) = &footprint {
            self.mark(image.pixels, image.nearest);
        }
        !matches!(footprint, Footprint::CrossesNear)
    }
    fn mark(&mut self, r: PixelRect, nearest: f32) {
        if r.is_empty() || self.is_all {
            return;
        }
        // Bits of a row and of a column of pixels that lie in the rectangle.
        let part = |first: u32, past: u32, from: u32, most: u32| {
            let (first, past) = (first.max(from) - from, past.min(from + most) - from);
            (1u32 << past) - (1 << first)
        };
        for y in r.y0 / 4..=(r.y1 - 1) / 4 {
            let rows = part(r.y0, r.y1, 4 * y, 4);
            // Each of the four bits to a row of its own.
            let rows = (rows & 1) | (rows & 2) << 7 | (rows & 4) << 14 | (rows & 8) << 21;
            for x in r.x0 / 8..=(r.x1 - 1) / 8 {
                let (most, pixels) = &mut self.marks[(y * self.columns + x) as usize];
                // The greatest of all for each pixel: a bound that takes eight bytes a tile.
                *most = most.max(nearest);
                *pixels |= rows * part(r.x0, r.x1, 8 * x, 8);
            }
        }
    }
    /// A bound on the share of the image that the rest could change: as close as it takes to know whether it
    /// exceeds `most`.
    pub fn share(self, most: f32) -> f32 {
        if self.is_all {
            return 1.0;
        }
        let pixels = f64::from(self.view.width) * f64::from(self.view.height);
        let share = |open: u32| (f64::from(open) / pixels) as f32;
        // Equal depths count, since which of two equals shows is the rasterizer's choice.
        let (mut least, mut greatest, mut undecided) = (0, 0, Vec::new());
        for (at, (nearest, marked)) in self.marks.into_iter().enumerate().filter(|(_, mark)| mark.1 != 0) {
            let (x, y) = ((at as u32 % self.columns) as u16, (at as u32 / self.columns) as u16);
            let tile = PyramidCell { level: PyramidCell::TILE, x, y };
            let [open, may] = self.tiled.tiles().open_bounds(tile, nearest, marked);
            (least, greatest) = (least + open.count_ones(), greatest + may.count_ones());
            if open != may {
                undecided.push((tile, nearest, may & !open));
            }
        }
        // Exact depths take time, and mostly tiles decide.
        for (tile, nearest, pixels) in undecided {
            if share(least) > most || share(greatest) <= most {
                break;
            }
            let open = self.tiled.open(tile, nearest, pixels).count_ones();
            (least, greatest) = (least + open, greatest - (pixels.count_ones() - open));
        }
        share(greatest)
    }
}
