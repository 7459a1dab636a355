//! The z-pyramid over a depth image: each value the farthest of the four below (Greene, Kass and Miller 1993,
//! <https://doi.org/10.1145/166117.166147>; Georges 1995, Section 3.2).
//!
//! Level 0 is the depth image itself and is not copied; level k has `⌈width / 2ᵏ⌉ × ⌈height / 2ᵏ⌉` values, up
//! to the one value of the root, for images of any size; a line of pixels has a pyramid of lines. Depths are
//! `1/w`, so *farthest* is the least.
//!
//! Departure: Georges updates all levels as primitives are drawn; here they are brought up to date on demand.
//!
//! 1. Drawing marks tiles of 16 × 16 pixels as stale ([`Pyramid::touch`]).
//! 2. [`Pyramid::refresh`] recomputes levels 1 to 4 of a tile from its depths ([`Reduce`]).
//! 3. It carries the tile's one value up to the root, as far as values change (`raise`).
//!
//! Depths only come nearer while an image is drawn, so a stale value is never nearer than the true one, and
//! whatever is behind it is hidden.
//!
//! Cost: a tile takes one pass over its 256 depths, in SIMD; `1/3` of the image's memory.

use super::simd::{self, Lanes, Work};
use crate::geometry::PixelRect;

/// Level of the values that stand for one tile: 16 pixels are one AVX-512 vector a row, and 256 depths are
/// 1 KiB. Smaller tiles would be refreshed more often, larger ones would redo more pixels that have not
/// changed.
const TILE_LEVEL: u32 = 4;
/// Side of a tile in pixels.
const TILE_PX: u32 = 1 << TILE_LEVEL;
/// Values of the levels 1 to 3 in a tile: 8², 4² and 2².
const FINE: usize = 64 + 16 + 4;
/// Where each of the levels 1 to 3 begins in a tile's values.
const FINE_AT: [usize; 4] = [0, 0, 64, 80];

/// State bits of a tile: something was drawn into it since it was brought up to date; its fine values are of
/// this image.
const STALE: u8 = 1;
const FINE_HELD: u8 = 2;

/// A cell of the pyramid. Level 0 are the pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PyramidCell {
    /// Level; cells are `2^level` pixels wide.
    pub level: u8,
    /// Column on its level.
    pub x: u16,
    /// Row on its level.
    pub y: u16,
}

impl PyramidCell {
    /// The level of the tiles of [`super::Tiles`], 8×4 pixels: above all of a pyramid.
    pub const TILE: u8 = 32;
    /// The level of its blocks, 32×16 pixels.
    pub const BLOCK: u8 = 33;

    /// Sides of the cells of a level in pixels, as shifts.
    pub fn shifts(level: u8) -> [u32; 2] {
        match level {
            Self::TILE => [3, 2],
            Self::BLOCK => [5, 4],
            _ => [level.into(); 2],
        }
    }
    /// The pixels that it stands for, in an image of this size.
    pub fn pixels(self, width: u32, height: u32) -> PixelRect {
        let along = |at: u16, shift: u32, size: u32| {
            ((u32::from(at) << shift).min(size), ((u32::from(at) + 1) << shift).min(size))
        };
        let [across, down] = Self::shifts(self.level);
        let ((x0, x1), (y0, y1)) = (along(self.x, across, width), along(self.y, down, height));
        PixelRect { x0, x1, y0, y1 }
    }
}

/// A z-pyramid.
#[derive(Clone, Debug, Default)]
pub struct Pyramid {
    width: u32,
    height: u32,
    /// Tiles in a row.
    columns: u32,
    /// Levels 1 to 3 of each tile.
    fine: Vec<[f32; FINE]>,
    /// State bits of each tile.
    state: Vec<u8>,
    /// Level 4 and up.
    coarse: Vec<Level>,
    /// Depth where nothing was drawn.
    far: f32,
}

#[derive(Clone, Debug, PartialEq)]
struct Level {
    width: u32,
    height: u32,
    values: Vec<f32>,
}

/// What a reader can see of them: the fine values of a tile that does not hold any are left over from an
/// earlier image.
impl PartialEq for Pyramid {
    fn eq(&self, other: &Self) -> bool {
        let held = |tile: usize| self.state[tile] & FINE_HELD != 0;
        (self.width, self.height, self.far) == (other.width, other.height, other.far)
            && self.state == other.state
            && self.coarse == other.coarse
            && (0..self.fine.len()).filter(|&t| held(t)).all(|t| self.fine[t] == other.fine[t])
    }
}

impl Pyramid {
    /// Empties it for an image of this size whose every depth is `far`.
    pub fn clear(&mut self, width: u32, height: u32, far: f32) {
        // An image of the same size keeps the memory.
        if (self.width, self.height) != (width, height) {
            (self.width, self.height) = (width, height);
            let sizes = |level: u32| (width.div_ceil(1 << level), height.div_ceil(1 << level));
            self.columns = sizes(TILE_LEVEL).0;
            let tiles = self.columns as usize * sizes(TILE_LEVEL).1 as usize;
            self.fine = vec![[far; FINE]; tiles];
            let level = |(width, height): (u32, u32)| Level {
                width,
                height,
                values: vec![far; width as usize * height as usize],
            };
            self.coarse = (TILE_LEVEL..=self.root().max(TILE_LEVEL)).map(|l| level(sizes(l))).collect();
        }
        // Fine values stay: none is read before a refresh makes its tile's state say so.
        self.far = far;
        self.state.clear();
        self.state.resize(self.fine.len(), 0);
        self.coarse.iter_mut().for_each(|l| l.values.fill(far));
    }
    /// The level of the single value at the top.
    pub fn root(&self) -> u32 {
        self.width.max(self.height).max(1).next_power_of_two().trailing_zeros()
    }
    /// Columns and rows of a level, at most [`Pyramid::root`].
    pub fn size(&self, level: u32) -> (u32, u32) {
        (self.width.div_ceil(1 << level), self.height.div_ceil(1 << level))
    }
    /// The farthest depth that it holds for a cell: never nearer than the truth, and equal to it where the
    /// cell is not stale. `depth` is the image.
    #[inline]
    pub fn farthest(&self, depth: &[f32], cell: PyramidCell) -> f32 {
        let (level, x, y) = (u32::from(cell.level), u32::from(cell.x), u32::from(cell.y));
        if level == 0 {
            return depth[(y * self.width + x) as usize];
        }
        if level >= TILE_LEVEL {
            let l = &self.coarse[(level - TILE_LEVEL) as usize];
            return l.values[(y * l.width + x) as usize];
        }
        // Levels 1 to 3 lie in the tile, row by row, `2^up` values a row.
        let up = TILE_LEVEL - level;
        let tile = ((y >> up) * self.columns + (x >> up)) as usize;
        // Not refreshed since the image was cleared: the tile's own value stands for all of them, and is no
        // nearer.
        if self.state[tile] & FINE_HELD == 0 {
            return self.coarse[0].values[tile];
        }
        let mask = (1 << up) - 1;
        self.fine[tile][FINE_AT[level as usize] + (((y & mask) << up) + (x & mask)) as usize]
    }
    /// Whether something was drawn into the tile that holds a cell of level 1 to 4 since it was brought up to
    /// date.
    #[inline]
    pub fn is_stale(&self, cell: PyramidCell) -> bool {
        (1..=TILE_LEVEL as u8).contains(&cell.level) && self.state[self.tile_of(cell)] & STALE != 0
    }
    /// Whether any tile under a cell of any level above 0 is stale; slower.
    pub fn is_stale_below(&self, cell: PyramidCell) -> bool {
        if u32::from(cell.level) <= TILE_LEVEL {
            return self.is_stale(cell);
        }
        // Above the tiles a cell is as stale as any tile under it.
        let r = cell.pixels(self.width, self.height);
        let columns = r.x0 / TILE_PX..r.x1.div_ceil(TILE_PX);
        (r.y0 / TILE_PX..r.y1.div_ceil(TILE_PX))
            .any(|row| columns.clone().any(|c| self.state[(row * self.columns + c) as usize] & STALE != 0))
    }
    #[inline]
    fn tile_of(&self, cell: PyramidCell) -> usize {
        let up = TILE_LEVEL - u32::from(cell.level);
        ((u32::from(cell.y) >> up) * self.columns + (u32::from(cell.x) >> up)) as usize
    }
    /// Notes that something was drawn in a rectangle of pixels (not empty, in the image).
    #[inline]
    pub fn touch(&mut self, r: PixelRect) {
        for row in r.y0 / TILE_PX..=(r.y1 - 1) / TILE_PX {
            // Tiles of a row are neighbors in memory.
            let at = (row * self.columns) as usize;
            let tiles = at + (r.x0 / TILE_PX) as usize..=at + ((r.x1 - 1) / TILE_PX) as usize;
            self.state[tiles].iter_mut().for_each(|s| *s |= STALE);
        }
    }
    /// Brings the tile of a stale cell up to date, with all values above it.
    pub fn refresh(&mut self, depth: &[f32], cell: PyramidCell) {
        let tile = self.tile_of(cell);
        self.refresh_tile(depth, tile);
    }
    /// Brings everything up to date.
    pub fn refresh_all(&mut self, depth: &[f32]) {
        (0..self.state.len())
            .filter(|&t| self.state[t] & STALE != 0)
            .collect::<Vec<_>>()
            .into_iter()
            .for_each(|t| self.refresh_tile(depth, t));
    }
    fn refresh_tile(&mut self, depth: &[f32], tile: usize) {
        self.state[tile] = FINE_HELD;
        let (column, row) = (tile as u32 % self.columns, tile as u32 / self.columns);
        let (x0, y0) = (column * TILE_PX, row * TILE_PX);
        // Tiles at the right and lower edge of the image may be cut off.
        let (columns, rows) =
            ((self.width - x0).min(TILE_PX) as usize, (self.height - y0).min(TILE_PX) as usize);
        let depth = &depth[(y0 * self.width + x0) as usize..];
        let fine = &mut self.fine[tile];
        let mut farthest = 0.0;
        // 2. All levels inside the tile.
        simd::run_best(Reduce {
            depth,
            stride: self.width as usize,
            columns,
            rows,
            fine,
            farthest: &mut farthest,
        });
        // 3. All levels above it.
        self.raise(column, row, farthest);
    }
    /// Puts a tile's value in its place and brings all above it up to date.
    fn raise(&mut self, mut x: u32, mut y: u32, mut value: f32) {
        for k in 0..self.coarse.len() {
            let width = self.coarse[k].width;
            let at = (y * width + x) as usize;
            // Higher levels depend on the tile through this value alone.
            if self.coarse[k].values[at] == value {
                return;
            }
            self.coarse[k].values[at] = value;
            let Level { width, height, values } = &self.coarse[k];
            (x, y) = (x / 2, y / 2);
            // Up to four values below the next one; at the edge of the image there may be two or one.
            value = f32::INFINITY;
            for row in 2 * y..(2 * y + 2).min(*height) {
                for column in 2 * x..(2 * x + 2).min(*width) {
                    value = value.min(values[(row * width + column) as usize]);
                }
            }
        }
    }

    /// The at most four cells, of the finest level on which there are no more, that cover a rectangle of
    /// pixels (not empty, in the image): first and last.
    #[inline]
    pub fn cover(&self, r: PixelRect) -> (PyramidCell, PyramidCell) {
        // A span of at most `2^level` pixels meets at most two cells along an axis.
        let side = (r.x1 - r.x0).max(r.y1 - r.y0);
        let level = u32::BITS - (side - 1).leading_zeros();
        let cell = |x: u32, y: u32| PyramidCell {
            level: level as u8,
            x: (x >> level) as u16,
            y: (y >> level) as u16,
        };
        (cell(r.x0, r.y0), cell(r.x1 - 1, r.y1 - 1))
    }
    /// Panics unless every value that is not stale is the farthest of the pixels below it, and no other is
    /// nearer.
    #[cfg(test)]
    pub(super) fn assert_well_formed(&self, depth: &[f32]) {
        // By definition: the farthest of all pixels under each cell.
        for level in 1..=self.root() {
            let (columns, rows) = self.size(level);
            for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x as u16, y as u16))) {
                let cell = PyramidCell { level: level as u8, x, y };
                let p = cell.pixels(self.width, self.height);
                let pixels =
                    (p.y0..p.y1).flat_map(|y| (p.x0..p.x1).map(move |x| (y * self.width + x) as usize));
                let (truth, held) =
                    (pixels.map(|i| depth[i]).fold(f32::INFINITY, f32::min), self.farthest(depth, cell));
                assert!(held <= truth, "{cell:?} holds {held}, nearer than {truth}");
                let is_stale = if level <= TILE_LEVEL {
                    self.is_stale(cell)
                } else {
                    self.state.iter().any(|s| s & STALE != 0)
                };
                assert!(is_stale || held == truth, "{cell:?} holds {held}, not {truth}");
            }
        }
    }
}

/// One tile: from its depths to its 85 values.
struct Reduce<'a> {
    depth: &'a [f32],
    stride: usize,
    columns: usize,
    rows: usize,
    fine: &'a mut [f32; FINE],
    farthest: &'a mut f32,
}

impl Work for Reduce<'_> {
    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        const SIDE: usize = TILE_PX as usize;
        // A full tile in every case, so that all loops have constant bounds and become SIMD. Pixels beyond
        // the image's edge are nearer than all: they never are the farthest.
        let mut pixels = [f32::INFINITY; SIDE * SIDE];
        for row in 0..self.rows {
            let from = &self.depth[row * self.stride..];
            // A copy of known length is a vector or two; the other is a call.
            if self.columns == SIDE {
                pixels[row * SIDE..(row + 1) * SIDE].copy_from_slice(&from[..SIDE]);
            } else {
                pixels[row * SIDE..row * SIDE + self.columns].copy_from_slice(&from[..self.columns]);
            }
        }
        let mut level_1 = [0.0; 64];
        halve::<SIDE>(&pixels, &mut level_1);
        let mut level_2 = [0.0; 16];
        halve::<8>(&level_1, &mut level_2);
        let mut level_3 = [0.0; 4];
        halve::<4>(&level_2, &mut level_3);
        self.fine[..64].copy_from_slice(&level_1);
        self.fine[64..80].copy_from_slice(&level_2);
        self.fine[80..].copy_from_slice(&level_3);
        *self.farthest = least(least(level_3[0], level_3[1]), least(level_3[2], level_3[3]));
    }
}

/// Each value the least of four of a square of `SIDE` columns: first of two rows, which is plain SIMD, then
/// of neighbors.
#[inline(always)]
fn halve<const SIDE: usize>(from: &[f32], to: &mut [f32]) {
    for (rows, to) in from.chunks_exact(2 * SIDE).zip(to.chunks_exact_mut(SIDE / 2)) {
        // Two rows first: whole vectors against each other. Only the half that is left is paired within.
        let mut both = [0.0; SIDE];
        for (k, v) in both.iter_mut().enumerate() {
            *v = least(rows[k], rows[k + SIDE]);
        }
        for (k, v) in to.iter_mut().enumerate() {
            *v = least(both[2 * k], both[2 * k + 1]);
        }
    }
}

/// The lesser; none is NaN.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
