//! Depths made for questions: tiles with coverage masks, primitives kept for exact answers, boxes asked by
//! their planes.
//!
//! Coarse masks decide, primitives are kept, exact depths are made on demand. A frame:
//!
//! 1. [`Tiles::clear`] for a view, [`Tiles::draw`] clusters of occluders front to back. A cluster that is
//!    hidden so far is left out whole, before any of its points is touched. Of the rest back faces go by
//!    stored planes; what is left is set up many at a time (`setup`) and put into windows of 32×16 pixels
//!    (`window`) by the masked update of Hasselgren, Andersson and Akenine-Möller, "Masked Software Occlusion
//!    Culling", 2016, <https://doi.org/10.2312/hpg.20161189>. A tile of 8×4 pixels knows a depth that nothing
//!    in it is farther than, a nearer layer that is begun with the mask of its pixels, and what was ever
//!    covered.
//! 2. [`Tiles::hides_all`]: a box is compared with blocks of 32×16 pixels, then tiles, by its front and back
//!    planes (`query`). Where tiles do not decide, they are shaded exactly from the primitives that their bin
//!    kept (`resolve`).
//!
//! An exact answer is that of the full image that [`super::Drawable::draw`] makes: nothing that could win a
//! pixel was left out, and what a tile claims is never nearer than the truth. So answers depend neither on
//! the order of drawing nor on the instruction set, whose width leaves no trace in the state either.
//!
//! Flatland goes the same way: its image is a line of pixels, one row of tiles, and only what a segment
//! covers and how deep it lies there is its own (`segments`).
//!
//! Memory: half a byte a pixel, and some 80 bytes for each primitive that may show.

mod bins;
mod clusters;
mod covered;
mod edges;
mod heard;
mod look;
mod plane;
mod query;
mod ready;
mod resolve;
mod segments;
mod setup;
pub(super) mod wide;
mod window;

pub use clusters::{Boxes, Clusters};
pub use heard::{Hears, Outcome, Read};
pub use query::{Answer, How, Question};

use self::bins::Bins;
use self::covered::Behind;
use self::look::Look;
use self::setup::Scratch;
use super::PyramidCell;
use super::simd::Isa;
use super::vertex::Camera;
use crate::geometry::{MAX_SIDE_PX, PixelRect, PrimId, Space, View};

/// Four tiles of 8×4 pixels side by side: 32×4 pixels in a cache line. Depths are `1/w`, larger is nearer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub(in crate::raster) struct Line {
    /// Nothing in the tile is farther than this.
    far: [f32; 4],
    /// Where `mask` is set nothing is farther than this.
    near: [f32; 4],
    /// The pixels that hold at least `near`; bit `8 y + x`.
    mask: [u32; 4],
    /// The pixels that anything covers.
    ever: [u32; 4],
}

/// No layer is begun: nearer than all, so that it never counts as far behind.
const UNBEGUN: f32 = f32::MAX;

/// Depths of a frame as tiles, with what exact answers need.
#[derive(Clone, Debug, Default)]
pub struct Tiles {
    camera: Camera,
    look: Look,
    /// Whether the image is flatland's line of pixels.
    is_flat: bool,
    /// Size in pixels.
    width: i32,
    height: i32,
    /// Columns of blocks of 32×16 pixels, each a strip of the image.
    strips: usize,
    /// Rows of blocks.
    block_rows: usize,
    /// Lines of a strip, and those past its end that a window may reach into.
    rows: usize,
    /// Rows of bins of 32×64 pixels.
    bin_rows: usize,
    /// Strip by strip, from the top.
    lines: Vec<Line>,
    /// For each block, row by row, [`Tiles::stride`] a row: no tile in it is farther.
    block_far: Vec<f32>,
    /// Nothing in it is nearer.
    block_near: Vec<f32>,
    /// Whether exact answers are kept ready.
    keeps: bool,
    bins: Bins,
    scratch: Scratch,
    resolved: Resolved,
}

/// What became of a primitive that was to be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// It faces away from the eye.
    Away,
    /// It shows nowhere: out of view, between pixel centers, or in no tile nearer than all that is there.
    Hidden,
    /// It may show.
    Shown,
    /// It is in no cluster, since it hides nothing: it lets light through, or is a line or a point.
    Apart,
}

/// Tiles that were looked at closer.
#[derive(Clone, Debug, Default)]
struct Resolved {
    /// For each tile of a block in turn its number in `floors`, or [`Resolved::NOT`].
    at: Vec<[u32; 16]>,
    /// Of each of the floors its block and tile.
    order: Vec<(u32, u32)>,
    /// A plane that no pixel of it is farther than: depth at the center, changes a column and a row; and its
    /// number in `depths`, or [`Resolved::NOT`].
    floors: Vec<([f32; 3], u32)>,
    /// Depths of its 32 pixels.
    depths: Vec<[f32; 32]>,
}

impl Resolved {
    const NOT: u32 = u32::MAX;
}

/// What a frame has drawn, as far as it is known: a question may find a tile nearer than was claimed, and
/// brings blocks up to date. Nothing of how it was drawn.
impl PartialEq for Tiles {
    fn eq(&self, other: &Self) -> bool {
        (self.camera, self.is_flat, self.keeps) == (other.camera, other.is_flat, other.keeps)
            && (self.width, self.height) == (other.width, other.height)
            && self.lines == other.lines
            && self.block_far == other.block_far
            && self.block_near == other.block_near
            && self.bins == other.bins
    }
}

impl Tiles {
    /// Empties them for a view. `keeps`: exact answers will be asked for.
    ///
    /// # Panics
    /// If a side of the image exceeds [`MAX_SIDE_PX`].
    pub fn clear<S: Space>(&mut self, view: &View<S>, keeps: bool) {
        assert!(view.width.max(view.height) <= MAX_SIDE_PX, "an image side exceeds {MAX_SIDE_PX} pixels");
        (self.width, self.height, self.keeps) = (view.width as i32, view.height as i32, keeps);
        self.is_flat = S::CORNERS == 2;
        self.strips = view.width.div_ceil(32) as usize;
        self.block_rows = view.height.div_ceil(16) as usize;
        self.bin_rows = view.height.div_ceil(64) as usize;
        self.rows = if self.is_flat { 4 } else { self.bin_rows * 16 + 4 };
        self.camera = Camera::new(view);
        self.look = Look::new(&self.camera, f64::from(view.width), f64::from(view.height));
        // An empty pixel is as deep as the far plane, as in an image.
        let cleared = self.camera.depth_far;
        let line = Line { far: [cleared; 4], near: [UNBEGUN; 4], mask: [0; 4], ever: [0; 4] };
        refill(&mut self.lines, self.strips * self.rows, line);
        if self.is_flat {
            // The other lines of a block hold nothing that makes it farther than the one that is seen.
            let below = Line { far: [UNBEGUN; 4], ..line };
            self.lines.chunks_exact_mut(4).for_each(|block| block[1..].fill(below));
        }
        // A bin's worth of rows and one more, since single windows begin at any line.
        let blocks = self.stride() * (self.bin_rows * 4 + 2);
        refill(&mut self.block_far, blocks, cleared);
        refill(&mut self.block_near, blocks, cleared);
        self.bins.clear(if keeps { self.strips * (self.bin_rows + 1) } else { 0 });
        self.scratch.clear(self.strips);
        self.forget();
        self.resolved.at.resize(self.strips * self.block_rows, [Resolved::NOT; 16]);
    }
    /// Draws occluders of the view's space front to back, those clusters that are not hidden when their turn
    /// comes. `one_sided`: primitives have a front only, unless their material has two sides.
    pub fn draw(&mut self, clusters: &Clusters, one_sided: bool, isa: Isa) {
        query::draw(self, clusters, one_sided, isa);
    }
    /// Draws groups of occluders and tells what became of each primitive, in the order of the groups'
    /// clusters: all that face the eye are drawn, but for those that are drawn already and, where clusters
    /// are tested, those of hidden ones. These are told to be hidden, whichever way they face. The groups are
    /// drawn together: what fills no vector of the one is drawn with the next.
    pub fn draw_groups(
        &mut self,
        clusters: &Clusters,
        groups: &[(usize, How<'_>)],
        isa: Isa,
        fates: &mut Vec<(PrimId, Fate)>,
    ) {
        self.scratch.told.begin();
        self.scratch.told.is_asked = true;
        let is_held = |(group, _): &&(usize, How<'_>)| !clusters.of_group(*group).is_empty();
        let last = groups.iter().rposition(|one| is_held(&one));
        for (k, &(group, how)) in groups.iter().enumerate().filter(|(_, one)| is_held(one)) {
            if how.tested {
                // What becomes of a cluster is not looked for primitive by primitive.
                let prims = clusters.of_group(group).iter().flat_map(|c| c.prims.clone());
                self.scratch.told.faced.extend(prims.map(|prim| (prim << 2 | 3) as i32));
            }
            query::draw_group(self, clusters, group, how, Some(k) != last, isa);
        }
        self.scratch.told.is_asked = false;
        for (group, how) in groups {
            clusters.fates(*group, how.skipped, &self.scratch.told, fates);
        }
    }
    /// Draws all of a group of occluders that faces the eye. What fills no vector waits for what comes next:
    /// nothing may be asked before [`Tiles::settle`].
    pub fn gather(&mut self, clusters: &Clusters, group: usize, one_sided: bool, isa: Isa) {
        self.scratch.told.is_asked = true;
        query::gather(self, clusters, group, one_sided, isa);
        self.scratch.told.is_asked = false;
    }
    /// Draws what waits. The primitives, of all that were gathered since the tiles were emptied, that may
    /// show; one may be told twice.
    pub fn settle(&mut self, clusters: &Clusters, isa: Isa) -> impl Iterator<Item = PrimId> {
        self.scratch.told.is_asked = true;
        query::settle(self, clusters, isa);
        self.scratch.told.is_asked = false;
        clusters.named(&self.scratch.told.shown)
    }
    /// Whether something does.
    pub fn waits(&self) -> bool {
        self.scratch.waits()
    }
    /// Whether something is hidden by what is drawn. What is read goes to `hears`; what changes is what
    /// [`Tiles::refresh`] of the cells changes that it hears of.
    pub fn hides<H: Hears>(&mut self, question: Question, isa: Isa, hears: &mut H) -> bool {
        query::hides(self, question, isa, hears)
    }
    /// Whether what lies in these pixels, no nearer than a depth, is behind all that covers any of them; of
    /// those that nothing covers nothing is said. Exact, which needs what [`Tiles::clear`] was told to keep.
    /// What is read goes to `hears`, as for [`Tiles::hides`].
    pub fn is_behind<H: Hears>(&mut self, pixels: PixelRect, nearest: f32, isa: Isa, hears: &mut H) -> bool {
        wide::run(isa, Behind { tiles: self, pixels, nearest, hears })
    }
    /// Brings a block up to date from its tiles, or a tile by exact depths, which were kept for it.
    pub fn refresh(&mut self, cell: PyramidCell, isa: Isa) {
        query::refresh_cell(self, cell, isa);
    }
    /// The pixels of a tile, of those `among`, at which something at a depth, `1/w`, shows by all that is
    /// drawn: where it does not lie behind that. Bit `8 y + x`. It needs what [`Tiles::clear`] was told to
    /// keep.
    pub fn open(&mut self, tile: PyramidCell, nearest: f32, among: u32, isa: Isa) -> u32 {
        let [bare, may] = self.open_bounds(tile, nearest, among);
        if bare == may { may } else { bare | query::open(self, tile, nearest, may & !bare, isa) }
    }
    /// Pixels that are among those of [`Tiles::open`], and pixels that hold all of these: as far as it is
    /// known.
    pub fn open_bounds(&self, tile: PyramidCell, nearest: f32, among: u32) -> [u32; 2] {
        let (line, k) = (&self.lines[self.line_of(tile)], usize::from(tile.x % 4));
        if nearest < line.far[k] {
            return [0; 2];
        }
        let hidden = if nearest < line.near[k] { line.mask[k] } else { 0 };
        // Where nothing is, anything shows.
        [among & !line.ever[k], among & !hidden]
    }
    /// Whether boxes are hidden by what is drawn. `exact`: tiles that do not decide are shaded, which needs
    /// what [`Tiles::clear`] was told to keep; else they count as showing the box.
    pub fn hides_all(&mut self, boxes: &Boxes, exact: bool, isa: Isa, answers: &mut Vec<Answer>) {
        query::hides_all(self, boxes, exact && self.keeps, isa, answers);
    }
    /// Columns and rows of tiles, or of blocks, that lie in the image.
    pub fn size(&self, level: u8) -> [u32; 2] {
        let [across, down] = PyramidCell::shifts(level);
        [(self.width as u32).div_ceil(1 << across), (self.height as u32).div_ceil(1 << down)]
    }
    /// What a tile or a block holds: nothing in it is farther.
    pub fn held(&self, cell: PyramidCell) -> f32 {
        let (x, y) = (usize::from(cell.x), usize::from(cell.y));
        match cell.level {
            PyramidCell::BLOCK => self.block_far[y * self.stride() + x],
            _ => self.lines[self.line_of(cell)].far[x % 4],
        }
    }
    /// The pixels of a tile whose nearer layer is begun, bit `8 y + x`, and what none of them is farther
    /// than.
    pub fn begun(&self, cell: PyramidCell) -> (u32, f32) {
        let (line, k) = (&self.lines[self.line_of(cell)], usize::from(cell.x % 4));
        (line.mask[k], line.near[k])
    }
    /// The pixels of a tile that anything covers, bit `8 y + x`.
    pub fn covered_pixels(&self, cell: PyramidCell) -> u32 {
        self.lines[usize::from(cell.x) / 4 * self.rows + usize::from(cell.y)].ever[usize::from(cell.x % 4)]
    }
    /// The same of four tiles side by side, of a strip of 32 pixels.
    pub(super) fn covered_line(&self, strip: usize, row: usize) -> [u32; 4] {
        self.lines[strip * self.rows + row].ever
    }
    /// The farthest depth that any tile in the image holds.
    pub fn farthest(&self) -> f32 {
        let [columns, rows] = self.size(PyramidCell::TILE).map(|n| n as u16);
        let cell = |x, y| PyramidCell { level: PyramidCell::TILE, x, y };
        let all = (0..rows).flat_map(|y| (0..columns).map(move |x| cell(x, y)));
        all.map(|c| self.held(c)).fold(f32::INFINITY, f32::min)
    }
    /// The depths of all pixels, row by row, as [`super::Drawable::draw`] makes them of the same occluders.
    pub fn depths(&mut self, isa: Isa) -> Vec<f32> {
        resolve::depths(self, isa)
    }

    /// Panics unless no tile and no block claims to be nearer than the farthest of its pixels, or a block to
    /// be farther than the nearest of its own, and what was ever covered is what the image `depth` covers.
    #[cfg(test)]
    pub(super) fn assert_claims(&self, depth: &[f32]) {
        for y in 0..self.height as usize {
            for x in 0..self.width as usize {
                let is = depth[y * self.width as usize + x];
                let (line, k) = (&self.lines[(x / 32) * self.rows + y / 4], x % 32 / 8);
                assert!(line.far[k] <= is, "({x}, {y}) is {is}, the tile claims {}", line.far[k]);
                let is_begun = line.mask[k] >> (y % 4 * 8 + x % 8) & 1 == 1;
                assert!(!is_begun || line.near[k] <= is, "({x}, {y}) is {is}, begun is {}", line.near[k]);
                let covered = line.ever[k] >> (y % 4 * 8 + x % 8) & 1 == 1;
                assert!(covered || is == self.camera.depth_far, "({x}, {y}) is not covered");
                let block = y / 16 * self.stride() + x / 32;
                assert!(self.block_far[block] <= is, "({x}, {y}) is farther than its block");
                assert!(self.block_near[block] >= is, "({x}, {y}) is nearer than its block");
            }
        }
        if self.is_flat {
            for (&block, lines) in self.block_far.iter().zip(self.lines.chunks_exact(4)) {
                let least = lines[0].far.into_iter().fold(f32::INFINITY, f32::min);
                assert_eq!(block, least, "a block is as far as the farthest of its tiles in the line");
            }
        }
    }

    /// The pixels that anything covers, row by row.
    #[cfg(test)]
    pub(super) fn covered(&self) -> Vec<bool> {
        let covers = |x: usize, y: usize| {
            self.lines[(x / 32) * self.rows + y / 4].ever[x % 32 / 8] >> (y % 4 * 8 + x % 8) & 1 == 1
        };
        let (width, height) = (self.width as usize, self.height as usize);
        (0..width * height).map(|at| covers(at % width, at / width)).collect()
    }

    /// Places of `block_far` and `block_near` a row: a vector reads up to 15 past its end.
    #[inline(always)]
    fn stride(&self) -> usize {
        self.strips + 16
    }
    /// The line that a tile is in.
    #[inline(always)]
    fn line_of(&self, tile: PyramidCell) -> usize {
        usize::from(tile.x) / 4 * self.rows + usize::from(tile.y)
    }
    /// The first line of a block.
    #[inline(always)]
    fn first_line(&self, strip: usize, row: usize) -> usize {
        strip * self.rows + 4 * row
    }
    /// Forgets what was looked at closer: more is drawn.
    fn forget(&mut self) {
        // Few tiles are; to fill all of them anew would take longer than to draw a small group.
        for &(block, tile) in &self.resolved.order {
            self.resolved.at[block as usize][tile as usize] = Resolved::NOT;
        }
        self.resolved.order.clear();
        self.resolved.floors.clear();
        self.resolved.depths.clear();
    }
}

fn refill<T: Copy>(v: &mut Vec<T>, count: usize, value: T) {
    v.clear();
    v.resize(count, value);
}
