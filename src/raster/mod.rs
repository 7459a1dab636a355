//! Depth lines and images, item buffers: a software z-buffer for both spaces.
//!
//! What it is: for each pixel center the nearest primitive that covers it. Vertices are projected in
//! f64 and snapped to a grid of 1/256 pixel; coverage is decided by exact integer edge functions with
//! the top-left rule; depth is `1/w` (larger is nearer), a fixed f32 formula of the primitive alone, in the
//! plane through its vertices as they were before snapping. A pixel keeps the greatest depth, at equal depth
//! the lowest primitive id. So an image is a function of the set of primitives: the order, the threads and
//! the SIMD width leave no trace, and taking away primitives that were hidden changes no byte.
//! [`mod@reference`] does the same in the plainest code. See-through primitives are not drawn into the
//! image, since they hide nothing: they are listed, and [`look_through`] says where they show before it.
//!
//! A primitive that [`crate::geometry::Frustum::test`] calls outside yields no fragment: its vertices lie
//! beyond the plane by more than the rounding here, and pixel centers lie half a pixel inside the image.
//!
//! Cost: O(points + primitives + covered pixels).

mod blend;
mod blocks;
mod closing;
mod fill;
mod flip;
mod frame;
mod image;
mod line;
mod opacity;
mod pyramid;
pub mod reference;
mod saturation;
mod setup;
mod shade;
mod simd;
mod srgb;
mod stand_in;
#[cfg(test)]
pub(crate) mod tests;
mod through;
mod tiles;
mod turns;
mod vertex;

pub use blend::Canvas;
pub use flip::{Flip, SEEN, difference_color, flip, flip_map, flip_mean, shade_differences};
pub use opacity::Opacity;
pub use pyramid::{Pyramid, PyramidCell};
pub use saturation::Saturation;
pub use setup::DEPTH_SLACK;
pub(crate) use shade::Veil;
pub use shade::{
    DepthScale, Light, VEIL, averaged, fixed_light, paint, paint_in_order, shade, shade_depth, shade_with,
};
pub use simd::Isa;
pub use srgb::{linear, srgb, srgb_bytes};
pub use stand_in::{CubeFaces, StandIn};
pub use through::look_through;
pub use tiles::{Answer, Boxes, Clusters, Fate, Hears, How, Outcome, Question, Read, Tiles};
pub use turns::Turns;

use crate::geometry::{Flat, MAX_SIDE_PX, PixelRect, PrimId, Solid, Space, View};
use crate::scene::{Scene, Surfaces};

/// A depth image and an item image of the same size; height 1 in flatland. Row 0 is the top.
#[derive(Default)]
pub struct Target {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `1/w` of the nearest primitive per pixel, row by row; `1/far` where there is none.
    pub depth: Vec<f32>,
    /// Its id, or [`Target::NONE`].
    pub item: Vec<u32>,
    /// See-through primitives that were drawn, as far as they may cover a pixel; in the order of drawing, and
    /// as often as they were. They leave depths and items as they are.
    pub through: Vec<PrimId>,
    scratch: image::Scratch,
}

impl Target {
    /// The item of a pixel that shows no primitive.
    pub const NONE: u32 = u32::MAX;

    /// An empty image of the view's size.
    pub fn new<S: Space>(view: &View<S>) -> Self {
        let mut target = Self::default();
        target.clear(view);
        target
    }
    /// Empties the image and gives it the view's size.
    pub fn clear<S: Space>(&mut self, view: &View<S>) {
        self.clear_rows(view, view.height);
    }
    /// The same, but only so many rows of it: for [`Drawable::draw_rows`].
    pub fn clear_rows<S: Space>(&mut self, view: &View<S>, rows: u32) {
        (self.width, self.height) = (view.width, rows);
        self.depth.clear();
        self.depth.resize(view.width as usize * rows as usize, 1.0 / view.eye.far);
        self.item.clear();
        self.item.resize(self.depth.len(), Self::NONE);
        self.through.clear();
    }
    /// Number of pixels that show another primitive, or the same at another depth, than in `other`;
    /// all of them if the sizes differ.
    pub fn wrong_pixels(&self, other: &Self) -> usize {
        (0..self.item.len()).filter(|&at| self.differs(other, at)).count()
    }
    /// Whether one pixel does.
    pub fn differs(&self, other: &Self, at: usize) -> bool {
        // Bits, not values: −0 and 0 would be equal, and an image is promised byte for byte.
        (self.width, self.height) != (other.width, other.height)
            || self.item[at] != other.item[at]
            || self.depth[at].to_bits() != other.depth[at].to_bits()
    }
}

impl Clone for Target {
    fn clone(&self) -> Self {
        Self {
            width: self.width,
            height: self.height,
            depth: self.depth.clone(),
            item: self.item.clone(),
            through: self.through.clone(),
            scratch: Default::default(),
        }
    }
}

/// Images of the same depths and items. Which see-through primitives were drawn over them is not compared.
impl PartialEq for Target {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height) == (other.width, other.height)
            && self.item == other.item
            && self.depth == other.depth
    }
}

impl std::fmt::Debug for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let covered = self.item.iter().filter(|&&i| i != Self::NONE).count();
        write!(f, "Target {}×{} with {covered} covered pixels", self.width, self.height)
    }
}

/// How much of its depth a fragment may differ by from a point of its primitive that belongs within half a
/// grid step, in both directions, of the pixel's center; besides the rounding of 32 bits. It is never nearer
/// than the nearest of the primitive's vertices, nor farther than the farthest. (A plane through unsnapped
/// vertices is right at the centers that the primitive covers and goes on beyond its edges to those that its
/// snapped image covers besides; see `setup`. Nearly all that are seen change less than this.)
pub const DEPTH_TILT: f64 = 1.0 / (1u32 << 14) as f64;

/// How to draw. None of it but `surfaces` and `window` changes the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// One-sided: skip primitives whose front (counter-clockwise; the left of a segment) does not face the
    /// eye, decided by the exact predicate. Otherwise both sides are drawn.
    pub surfaces: Surfaces,
    /// 1: on the calling thread alone. 0: on all threads of the rayon pool in scope. Any other
    /// number: likewise, split for that many.
    pub threads: usize,
    /// Instruction set; one that the machine lacks falls back to the best it has.
    pub isa: Isa,
    /// Draw these pixels only; they lie in the image.
    pub window: Option<PixelRect>,
}

impl Options {
    fn thread_count(&self) -> usize {
        if self.threads == 0 { rayon::current_num_threads() } else { self.threads }
    }
    fn window_of<S: Space>(&self, view: &View<S>) -> PixelRect {
        self.window.unwrap_or(PixelRect { x0: 0, x1: view.width, y0: 0, y1: view.height })
    }
}

/// Where a primitive is in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The pixels that it can cover.
    pub pixels: PixelRect,
    /// Its nearest depth, `1/w`.
    pub nearest: f32,
}

impl Default for Options {
    fn default() -> Self {
        Self { surfaces: Surfaces::default(), threads: 1, isa: Isa::best(), window: None }
    }
}

/// A space that can be drawn: triangles into an image, segments into a line of pixels.
pub trait Drawable: Space {
    /// Draws `prims` (any order, any subset, dropped ones ignored) over what the target holds.
    ///
    /// # Panics
    /// If the target has not the view's size, or a side exceeds [`MAX_SIDE_PX`].
    fn draw(target: &mut Target, scene: &Scene<Self>, view: &View<Self>, prims: &[PrimId], options: &Options);
    /// Makes the image anew, with its items: the same as [`Target::clear`] and [`Drawable::draw`], faster.
    ///
    /// # Panics
    /// If a side of the view exceeds [`MAX_SIDE_PX`].
    fn redraw(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        options: &Options,
    ) {
        target.clear(view);
        Self::draw(target, scene, view, prims, options);
    }
    /// Draws the rows of the image from `first` on that the target holds: a part of an image that would be
    /// too large as a whole. On the calling thread, and without a window.
    ///
    /// # Panics
    /// If the target has not the view's width, or its rows reach beyond the image.
    fn draw_rows(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        first: u32,
        options: &Options,
    );
    /// Where a primitive is; `None` if it covers no pixel or has to be clipped.
    fn extent(scene: &Scene<Self>, view: &View<Self>, prim: PrimId, options: &Options) -> Option<Extent>;
    /// Calls `visit` with the place of each pixel that a primitive covers, row by row, and its depth there:
    /// what [`Drawable::draw`] would compare with the image, of a see-through primitive as well.
    fn fragments(
        scene: &Scene<Self>,
        view: &View<Self>,
        prim: PrimId,
        options: &Options,
        visit: &mut dyn FnMut(usize, f32),
    );
    /// The same as [`Drawable::draw`] in the plainest code (and without a window); see [`mod@reference`].
    ///
    /// # Panics
    /// As [`Drawable::draw`].
    fn draw_reference(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        options: &Options,
    );
}

impl Drawable for Flat {
    fn draw(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        options: &Options,
    ) {
        line::draw(target, scene, view, prims, options);
    }
    fn draw_rows(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        first: u32,
        options: &Options,
    ) {
        check_rows(target, view, first);
        // A line has one row.
        line::draw(target, scene, view, prims, &Options { window: None, ..*options });
    }
    fn extent(scene: &Scene<Self>, view: &View<Self>, prim: PrimId, options: &Options) -> Option<Extent> {
        line::extent(scene, view, prim, options)
    }
    fn fragments(
        scene: &Scene<Self>,
        view: &View<Self>,
        prim: PrimId,
        options: &Options,
        visit: &mut dyn FnMut(usize, f32),
    ) {
        line::fragments(scene, view, prim, options, visit);
    }
    fn draw_reference(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        options: &Options,
    ) {
        reference::draw_line(target, scene, view, prims, options);
    }
}

impl Drawable for Solid {
    fn draw(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        options: &Options,
    ) {
        image::draw(target, scene, view, prims, options);
    }
    fn redraw(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        options: &Options,
    ) {
        image::redraw(target, scene, view, prims, options);
    }
    fn draw_rows(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        first: u32,
        options: &Options,
    ) {
        check_rows(target, view, first);
        image::draw_rows(target, scene, view, prims, first, options);
    }
    fn extent(scene: &Scene<Self>, view: &View<Self>, prim: PrimId, options: &Options) -> Option<Extent> {
        frame::extent(scene, view, prim, options)
    }
    fn fragments(
        scene: &Scene<Self>,
        view: &View<Self>,
        prim: PrimId,
        options: &Options,
        visit: &mut dyn FnMut(usize, f32),
    ) {
        frame::fragments(scene, view, prim, options, visit);
    }
    fn draw_reference(
        target: &mut Target,
        scene: &Scene<Self>,
        view: &View<Self>,
        prims: &[PrimId],
        options: &Options,
    ) {
        reference::draw_image(target, scene, view, prims, options);
    }
}

/// Draws `prims` into a new image of the view's size, on the calling thread.
pub fn render<S: Drawable>(scene: &Scene<S>, view: &View<S>, prims: &[PrimId]) -> Target {
    let mut target = Target::default();
    S::redraw(&mut target, scene, view, prims, &Options::default());
    target
}

/// The primitives that show in the image, ascending; those that are see-through are not among them.
pub fn visible(target: &Target) -> Vec<PrimId> {
    let ids = || target.item.iter().copied().filter(|&i| i != Target::NONE);
    // A bit for each id: the list comes out ascending and without repetition, with no sort.
    let mut seen = vec![0u64; ids().max().map_or(0, |m| m as usize / 64 + 1)];
    ids().for_each(|i| seen[i as usize / 64] |= 1 << (i % 64));
    let bits = |(word, &bits): (usize, &u64)| {
        (0..64).filter(move |b| bits >> b & 1 == 1).map(move |b| PrimId(word as u32 * 64 + b))
    };
    seen.iter().enumerate().flat_map(bits).collect()
}

/// The primitive at a pixel, if the pixel is in the image and shows one.
pub fn pick(target: &Target, x: u32, y: u32) -> Option<PrimId> {
    if x >= target.width || y >= target.height {
        return None;
    }
    let item = *target.item.get(y as usize * target.width as usize + x as usize)?;
    (item != Target::NONE).then_some(PrimId(item))
}

fn check_size<S: Space>(target: &Target, view: &View<S>) {
    assert_eq!(
        (target.width, target.height),
        (view.width, view.height),
        "the target has another size than the view"
    );
    check_rows(target, view, 0);
}

fn check_rows<S: Space>(target: &Target, view: &View<S>, first: u32) {
    assert_eq!(target.width, view.width, "the target has another width than the view");
    assert!(first + target.height <= view.height, "the target's rows reach beyond the image");
    assert!(view.width.max(view.height) <= MAX_SIDE_PX, "an image side exceeds {MAX_SIDE_PX} pixels");
}
