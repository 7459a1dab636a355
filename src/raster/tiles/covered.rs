//! Whether something lies behind all that covers it, whatever nothing covers: the depth test of occlusion
//! maps by the depths of the occluders' own samples (Zhang, "Effective Occlusion Culling for the Interactive
//! Display of Arbitrary Models", UNC 1998: the *no-background* z-buffer).
//!
//! A tile's depths bound what covers it; where they do not decide, its exact depths do (`resolve`).

use super::look::Asked;
use super::query::{cell_at, first_pixel, look_closer, reached, tile_at};
use super::wide::{Wide, Work};
use super::{Hears, Outcome, Read, Resolved, Tiles};
use crate::geometry::PixelRect;
use crate::raster::PyramidCell;

/// What is asked for: what lies in these pixels, no nearer than a depth.
pub(super) struct Behind<'a, H> {
    pub tiles: &'a mut Tiles,
    pub pixels: PixelRect,
    pub nearest: f32,
    pub hears: &'a mut H,
}

impl<H: Hears> Work for Behind<'_, H> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Wide>(mut self, l: L) -> bool {
        let p = self.pixels;
        if p.is_empty() {
            return true;
        }
        let (x0, x1, y0, y1) = (p.x0 as i32, p.x1 as i32, p.y0 as i32, p.y1 as i32);
        let asked = Asked { id: 0, x0, x1, y0, y1, nearest: self.nearest, crosses_near: false };
        let [left, right, top, bottom] = asked.blocks();
        // What may be seen mostly begins before all that is drawn in some block.
        for row in top..bottom {
            for begin in (left..right).step_by(L::N) {
                let mut before = l.bits(self.begins_before(l, begin, row, right));
                while before != 0 {
                    let strip = begin + before.trailing_zeros() as usize;
                    before &= before - 1;
                    if self.is_covered(&asked, strip, row) {
                        let nearest = self.tiles.block_near[row * self.tiles.stride() + strip];
                        self.read(cell_at(PyramidCell::BLOCK, [strip, row]), nearest, Outcome::Shows);
                        return false;
                    }
                }
            }
        }
        for row in top..bottom {
            for begin in (left..right).step_by(L::N) {
                // Blocks that are full, and all of them nearer, need no more.
                let mut open = l.bits(reached(l, self.tiles, &asked, begin, row, right));
                self.tell_blocks(begin, right.min(begin + L::N), row, open);
                while open != 0 {
                    let strip = begin + open.trailing_zeros() as usize;
                    open &= open - 1;
                    if !self.is_behind_block(l, &asked, strip, row) {
                        return false;
                    }
                }
            }
        }
        true
    }
}

impl<H: Hears> Behind<'_, H> {
    /// Of the blocks of a row from one on, up to another, those in which something is drawn and it is no
    /// farther than all of that.
    #[inline(always)]
    fn begins_before<L: Wide>(&self, l: L, begin: usize, row: usize, past: usize) -> L::M {
        let near = l.load(&self.tiles.block_near[row * self.tiles.stride() + begin..]);
        let drawn = l.gt(near, l.splat(self.tiles.camera.depth_far));
        l.both(l.first(past - begin), l.both(drawn, l.ge(l.splat(self.nearest), near)))
    }
    /// Whether anything covers one of its pixels in a block.
    #[inline(always)]
    fn is_covered(&self, asked: &Asked, strip: usize, row: usize) -> bool {
        let mut bits = asked.tiles(strip, row);
        while bits != 0 {
            let tile = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let at = first_pixel(self.tiles, row * self.tiles.strips + strip, tile);
            let line = &self.tiles.lines[self.tiles.first_line(strip, row) + (tile >> 2)];
            if line.ever[tile & 3] & asked.pixels(at) != 0 {
                return true;
            }
        }
        false
    }
    /// Whether it lies behind all that covers it in a block.
    #[inline(always)]
    fn is_behind_block<L: Wide>(&mut self, l: L, asked: &Asked, strip: usize, row: usize) -> bool {
        let mut open = 0;
        for part in 0..16 / L::N {
            let first = self.tiles.first_line(strip, row) + part * (L::N / 4);
            let far = l.load_farthest(&self.tiles.lines[first..]);
            open |= l.bits(l.ge(l.splat(self.nearest), far)) << (part * L::N);
        }
        let among = asked.tiles(strip, row);
        open &= among;
        self.tell_tiles(strip, row, among & !open);
        while open != 0 {
            let tile = open.trailing_zeros() as usize;
            open &= open - 1;
            if !self.is_behind(l, asked, row * self.tiles.strips + strip, tile) {
                return false;
            }
        }
        true
    }
    /// Tells of blocks that are nearer: all of a row but those that are open.
    #[inline(always)]
    fn tell_blocks(&mut self, begin: usize, past: usize, row: usize, open: u32) {
        if H::LISTENS {
            for strip in (begin..past).filter(|strip| open >> (strip - begin) & 1 == 0) {
                let held = self.tiles.block_far[row * self.tiles.stride() + strip];
                self.read(cell_at(PyramidCell::BLOCK, [strip, row]), held, Outcome::Behind);
            }
        }
    }
    /// Tells of tiles that are nearer.
    #[inline(always)]
    fn tell_tiles(&mut self, strip: usize, row: usize, tiles: u32) {
        if H::LISTENS {
            for k in (0..16).filter(|k| tiles >> k & 1 == 1) {
                let cell = tile_at(first_pixel(self.tiles, row * self.tiles.strips + strip, k));
                let held = self.tiles.held(cell);
                self.read(cell, held, Outcome::Behind);
            }
        }
    }
    #[inline(always)]
    fn read(&mut self, cell: PyramidCell, held: f32, outcome: Outcome) {
        let nearest = self.nearest;
        self.hears.reads(Read { cell, held, nearest, outcome });
    }
    /// Whether it lies behind all that covers it in a tile.
    #[inline(always)]
    fn is_behind<L: Wide>(&mut self, l: L, asked: &Asked, block: usize, tile: usize) -> bool {
        let at = first_pixel(self.tiles, block, tile);
        let (row, strip) = (block / self.tiles.strips, block % self.tiles.strips);
        let line = self.tiles.lines[self.tiles.first_line(strip, row) + (tile >> 2)];
        let k = tile & 3;
        let covered = line.ever[k] & asked.pixels(at);
        if covered == 0 {
            return true;
        }
        // What is not begun anew is at least as near as the tile as a whole.
        let is_begun = covered & !line.mask[k] == 0;
        let held = if is_begun && line.near[k] > line.far[k] { line.near[k] } else { line.far[k] };
        if self.nearest < held {
            self.read(tile_at(at), held, Outcome::Behind);
            return true;
        }
        self.read(tile_at(at), held, Outcome::Descends);
        self.hears.looks_closer(true);
        let known = self.tiles.resolved.at[block][tile];
        if known == Resolved::NOT || self.tiles.resolved.floors[known as usize].1 == Resolved::NOT {
            look_closer(l, self.tiles, block, tile);
            self.hears.refreshes(tile_at(at));
        }
        let floor = self.tiles.resolved.floors[self.tiles.resolved.at[block][tile] as usize];
        let depths = &self.tiles.resolved.depths[floor.1 as usize];
        let (mut least, mut which, mut rest) = (f32::MAX, 0, covered);
        while rest != 0 {
            let bit = rest.trailing_zeros();
            rest &= rest - 1;
            if depths[bit as usize] < least {
                (least, which) = (depths[bit as usize], bit);
            }
        }
        let cell = PyramidCell {
            level: 0,
            x: (at[0] as u32 + which % 8) as u16,
            y: (at[1] as u32 + which / 8) as u16,
        };
        // As deep is not behind: it may be what was drawn.
        let is_behind = self.nearest < least;
        self.read(cell, least, if is_behind { Outcome::Behind } else { Outcome::Shows });
        is_behind
    }
}
