//! Occlusion maps: how much of each block of an image is covered, level above level.
//!
//! Zhang, Manocha, Hudson and Hoff, "Visibility Culling using Hierarchical Occlusion Maps", SIGGRAPH 1997,
//! Section 4, <https://doi.org/10.1145/258734.258781>:
//!
//! 1. A pixel of the finest map, level 0, stands for a square of samples (in flatland a piece of their line),
//!    those of an image of the occluders.
//! 2. Two by two pixels of a level (two in flatland) are averaged to one of the next, down to a map of at
//!    most 4×4.
//!
//! Kept are counts of *black* samples, those that nothing covers: whole numbers, which only add up, so that
//! no level is rounded. Opacity is `1 − black / present`; samples beyond the image's edge are neither black
//! nor present.
//!
//! Small holes may be filled before the samples are counted ([`Opacity::fill_holes`]).
//!
//! Cost: O(tiles + pixels of level 0); 4 bytes a map pixel.

use super::closing::{present_of_tile, small_holes};
use super::{PyramidCell, Tiles};
use crate::geometry::PixelRect;

/// Levels of black samples over an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Opacity {
    /// Size of the image of the occluders, samples.
    size: [u32; 2],
    /// A pixel of level 0 has `1 << shift` samples a side.
    shift: u32,
    is_flat: bool,
    /// Most black samples of a hole that is filled.
    closing: u32,
    /// From the finest up.
    levels: Vec<Map>,
}

/// One level.
#[derive(Clone, Debug, Default, PartialEq)]
struct Map {
    columns: u32,
    rows: u32,
    /// Black samples of each pixel, row by row.
    black: Vec<u32>,
    /// Samples that were black before holes were filled; nothing where none are.
    filled: Vec<u32>,
}

/// Both sides of the coarsest map are at most this (Section 4.1: "typically 4×4").
const TOP: u32 = 4;

impl Opacity {
    /// Maps over an image of so many samples, whose finest pixels have `1 << shift` of them a side; nothing
    /// is covered. In flatland the image is one row.
    pub fn clear(&mut self, size: [u32; 2], shift: u32, is_flat: bool) {
        (self.size, self.shift, self.is_flat, self.closing) = (size, shift, is_flat, 0);
        let mut at = [size[0].div_ceil(1 << shift), if is_flat { 1 } else { size[1].div_ceil(1 << shift) }];
        let mut count = 0;
        loop {
            if self.levels.len() == count {
                self.levels.push(Map::default());
            }
            let map = &mut self.levels[count];
            (map.columns, map.rows) = (at[0], at[1]);
            map.black.clear();
            map.filled.clear();
            count += 1;
            if at[0].max(at[1]) <= TOP {
                break;
            }
            at = at.map(|n| n.div_ceil(2));
        }
        self.levels.truncate(count);
        for level in 0..count {
            self.blacken(level);
        }
    }
    /// From here on fills holes of at most so many black samples before the samples are counted: connected
    /// ones, if only at corners. See `closing`.
    pub fn fill_holes(&mut self, most: u32) {
        self.closing = most;
    }
    /// Makes all samples of a level black.
    fn blacken(&mut self, level: usize) {
        let ([width, height], shift) = (self.size, self.shift + level as u32);
        let map = &mut self.levels[level];
        // Whole pixels but for the last column and the last row, which the image's edge may cut.
        let last = |pixels: u32, cells: u32| pixels - ((cells - 1) << shift);
        let side = 1 << shift;
        let (right, [down, bottom]) =
            (last(width, map.columns), if self.is_flat { [1, 1] } else { [side, last(height, map.rows)] });
        map.black.clear();
        map.black.resize((map.columns * map.rows) as usize, side * down);
        let (columns, rows) = (map.columns as usize, map.rows as usize);
        map.black[(rows - 1) * columns..].fill(side * bottom);
        for y in 0..rows {
            map.black[(y + 1) * columns - 1] = right * if y + 1 == rows { bottom } else { down };
        }
    }
    /// Makes the maps of what is drawn into tiles of the same size.
    pub fn build(&mut self, tiles: &Tiles) {
        self.build_from(|strip, row| tiles.covered_line(strip, row));
    }
    /// The same from the depths of the samples, row by row: those nearer than `depth_far` are covered.
    pub fn build_from_depths(&mut self, depths: &[f32], depth_far: f32) {
        let [width, height] = self.size.map(|n| n as usize);
        self.build_from(|strip, row| {
            [0, 1, 2, 3].map(|k| {
                let at = |bit: usize| (32 * strip + 8 * k + bit % 8, 4 * row + bit / 8);
                let is_covered = |(x, y)| x < width && y < height && depths[y * width + x] > depth_far;
                (0..32).fold(0, |mask, bit| mask | u32::from(is_covered(at(bit))) << bit)
            })
        });
    }
    /// From masks of four tiles of 8×4 samples side by side, bit `8 y + x`, given by strip of 32 samples and
    /// row.
    fn build_from(&mut self, masks: impl Fn(usize, usize) -> [u32; 4]) {
        if self.closing == 0 {
            return self.count(masks);
        }
        let of_tile = |x: u16, y: u16| masks(usize::from(x) / 4, usize::from(y))[usize::from(x) % 4];
        let filled = small_holes(self.size, self.closing, of_tile);
        let columns = self.size[0].div_ceil(8) as usize;
        let of_line = |strip: usize, row: usize| {
            [0, 1, 2, 3].map(|k| match 4 * strip + k {
                x if x < columns => filled[row * columns + x],
                _ => 0,
            })
        };
        // Counted by the same code, as if they were all that is black.
        self.count(|strip, row| of_line(strip, row).map(|m| !m));
        for map in &mut self.levels {
            map.filled.clone_from(&map.black);
        }
        self.count(|strip, row| {
            let (covered, filled) = (masks(strip, row), of_line(strip, row));
            [0, 1, 2, 3].map(|k| covered[k] | filled[k])
        });
    }
    /// Counts the black samples of level 0, then adds up.
    fn count(&mut self, masks: impl Fn(usize, usize) -> [u32; 4]) {
        self.blacken(0);
        let whole =
            if self.is_flat { [0; 2] } else { [self.size[0] / 32, self.size[1] / 4].map(|n| n as usize) };
        for strip in 0..self.size[0].div_ceil(32) as usize {
            for row in 0..self.size[1].div_ceil(4) as usize {
                let masks = masks(strip, row);
                if masks == [0; 4] {
                    continue;
                }
                // Most lies in the image as a whole.
                if strip < whole[0] && row < whole[1] {
                    let map = &mut self.levels[0];
                    match self.shift {
                        0 => whiten_whole::<0>(map, [strip, row], masks),
                        1 => whiten_whole::<1>(map, [strip, row], masks),
                        2 => whiten_whole::<2>(map, [strip, row], masks),
                        shift => {
                            let first = ((4 * row) >> shift) * map.columns as usize;
                            let at = |k: usize| first + ((32 * strip + 8 * k) >> shift);
                            (0..4).for_each(|k| map.black[at(k)] -= masks[k].count_ones());
                        }
                    }
                } else {
                    (0..4).for_each(|k| self.whiten([(4 * strip + k) as u32, row as u32], masks[k]));
                }
            }
        }
        for level in 1..self.levels.len() {
            let (below, above) = self.levels.split_at_mut(level);
            add_up(&below[level - 1], &mut above[0]);
        }
    }
    /// Takes what is covered of a tile off the black samples of level 0.
    fn whiten(&mut self, [x, y]: [u32; 2], mask: u32) {
        let ([width, height], shift, is_flat) = (self.size, self.shift, self.is_flat);
        if mask == 0 || 8 * x >= width {
            return;
        }
        let map = &mut self.levels[0];
        // A tile holds several pixels, or lies in one.
        let (across, down) = (1 << shift.min(3), if is_flat { 1 } else { 1 << shift.min(2) });
        let (wide, high) = (8 / across, if is_flat { 1 } else { 4 / down });
        let row = 0xff >> (8 - across);
        let square = (0..down).fold(0, |bits, y| bits | row << (8 * y));
        let covered = mask & present_of_tile([width, height], [x, y]);
        for cell in 0..wide * high {
            let (i, j) = (cell % wide, cell / wide);
            let bits = covered & square << (8 * down * j + across * i);
            let (to_x, to_y) = ((8 * x + i * across) >> shift, (4 * y + j * down) >> shift);
            if to_x < map.columns && to_y < map.rows {
                map.black[(to_y * map.columns + to_x) as usize] -= bits.count_ones();
            }
        }
    }

    /// Number of levels.
    pub fn levels(&self) -> u8 {
        self.levels.len() as u8
    }
    /// Columns and rows of a level.
    pub fn size(&self, level: u8) -> [u32; 2] {
        let map = &self.levels[usize::from(level)];
        [map.columns, map.rows]
    }
    /// Size of the image that the maps are of, samples.
    pub fn samples(&self) -> [u32; 2] {
        self.size
    }
    /// Samples a side of a pixel of a level, as a power of two.
    pub fn shift(&self, level: u8) -> u32 {
        self.shift + u32::from(level)
    }
    /// The pixels of a level, row by row.
    pub fn cells(&self, level: u8) -> impl Iterator<Item = PyramidCell> + use<> {
        let [columns, rows] = self.size(level);
        (0..rows)
            .flat_map(move |y| (0..columns).map(move |x| PyramidCell { level, x: x as u16, y: y as u16 }))
    }
    /// Black samples of a pixel.
    #[inline]
    pub fn black(&self, cell: PyramidCell) -> u32 {
        let map = &self.levels[usize::from(cell.level)];
        map.black[u32::from(cell.y) as usize * map.columns as usize + usize::from(cell.x)]
    }
    /// Samples of a pixel that were black before holes were filled.
    #[inline]
    pub fn filled(&self, cell: PyramidCell) -> u32 {
        let map = &self.levels[usize::from(cell.level)];
        let at = u32::from(cell.y) as usize * map.columns as usize + usize::from(cell.x);
        map.filled.get(at).copied().unwrap_or(0)
    }
    /// Samples of a pixel that lie in the image.
    #[inline]
    pub fn present(&self, cell: PyramidCell) -> u32 {
        let [width, height] = self.size;
        let shift = self.shift(cell.level);
        let side = |at: u16, end: u32| end.min((u32::from(at) + 1) << shift) - (u32::from(at) << shift);
        side(cell.x, width) * if self.is_flat { 1 } else { side(cell.y, height) }
    }
    /// Pixels of level 0 that a pixel stands for.
    #[inline]
    pub fn finest_in(&self, cell: PyramidCell) -> u32 {
        let [columns, rows] = self.size(0);
        let level = u32::from(cell.level);
        let side = |at: u16, end: u32| end.min((u32::from(at) + 1) << level) - (u32::from(at) << level);
        side(cell.x, columns) * side(cell.y, rows)
    }
    /// The share of a pixel that is covered, 0 to 1.
    pub fn opacity(&self, cell: PyramidCell) -> f64 {
        1.0 - f64::from(self.black(cell)) / f64::from(self.present(cell))
    }
    /// Samples of a whole pixel of level 0.
    pub fn whole(&self) -> u32 {
        1 << (self.shift * if self.is_flat { 1 } else { 2 })
    }
    /// The pixels of level 0 that hold these samples.
    pub fn under(&self, samples: PixelRect) -> PixelRect {
        let past = |v: u32| v.saturating_sub(1) >> self.shift;
        PixelRect {
            x0: samples.x0 >> self.shift,
            x1: past(samples.x1) + 1,
            y0: if self.is_flat { 0 } else { samples.y0 >> self.shift },
            y1: if self.is_flat { 1 } else { past(samples.y1) + 1 },
        }
    }
    /// The level at which a test of some pixels of level 0 begins: the least on which they lie under at most
    /// two a side, or the top (Section 5.1: where a map pixel is about as large as the rectangle).
    pub fn start(&self, under: PixelRect) -> u8 {
        let top = self.levels() - 1;
        let spans = |k: u8| {
            let span = |low: u32, past: u32| ((past - 1) >> k) - (low >> k);
            span(under.x0, under.x1).max(span(under.y0, under.y1))
        };
        (0..top).find(|&k| spans(k) <= 1).unwrap_or(top)
    }
}

/// Takes what is covered of four tiles side by side off the black samples, where pixels of the map have
/// `1 << SHIFT` samples a side, 4 at most, so that they are of one tile each.
#[inline(always)]
fn whiten_whole<const SHIFT: u32>(map: &mut Map, [strip, row]: [usize; 2], masks: [u32; 4]) {
    let (columns, side) = (map.columns as usize, 1_usize << SHIFT);
    let (wide, high) = (8 / side, 4 / side);
    let square = (0..side).fold(0, |bits, y| bits | (0xff_u32 >> (8 - side)) << (8 * y));
    for j in 0..high {
        let pixels = &mut map.black[(row * high + j) * columns + 4 * wide * strip..][..4 * wide];
        for (pixels, mask) in pixels.chunks_exact_mut(wide).zip(masks) {
            for (i, black) in pixels.iter_mut().enumerate() {
                *black = (!mask >> (8 * side * j + side * i) & square).count_ones();
            }
        }
    }
}

/// A level from the one below: sums of two by two pixels, fewer at the far edges.
fn add_up(below: &Map, to: &mut Map) {
    let (wide, columns) = (below.columns as usize, to.columns as usize);
    for (y, to) in to.black.chunks_exact_mut(columns).enumerate() {
        let first = &below.black[2 * y * wide..][..wide];
        // The last row may have one below it only, and the last column one beside it.
        let has_second = 2 * y + 1 < below.rows as usize;
        let second = if has_second { &below.black[(2 * y + 1) * wide..][..wide] } else { first };
        let half = u32::from(!has_second);
        for ((to, a), b) in to.iter_mut().zip(first.chunks_exact(2)).zip(second.chunks_exact(2)) {
            *to = (a[0] + a[1] + b[0] + b[1]) >> half;
        }
        if wide % 2 == 1 {
            to[columns - 1] = (first[wide - 1] + second[wide - 1]) >> half;
        }
    }
}
