//! Whether something lies behind all that covers it, whatever nothing covers: the depth test of occlusion
//! maps by the depths of the occluders' own samples (Zhang, "Effective Occlusion Culling for the Interactive
//! Display of Arbitrary Models", UNC 1998: the *no-background* z-buffer).
//!
//! A tile's depths bound what covers it; where they do not decide, its exact depths do (`resolve`).

use super::look::Asked;
use super::query::{first_pixel, look_closer, tile_at};
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
        // What is large mostly begins before something that is drawn.
        for row in top..bottom {
            for strip in left..right {
                let nearest = self.tiles.block_near[row * self.tiles.stride() + strip];
                let all = if self.tiles.is_flat { 0xf } else { 0xffff };
                let is_inside = asked.tiles_inside(strip, row, self.tiles.is_flat) == all;
                if is_inside && nearest > self.tiles.camera.depth_far && self.nearest >= nearest {
                    let cell = PyramidCell { level: PyramidCell::BLOCK, x: strip as u16, y: row as u16 };
                    self.read(cell, nearest, Outcome::Shows);
                    return false;
                }
            }
        }
        for row in top..bottom {
            for strip in left..right {
                // A block that is full, and all of it nearer.
                let held = self.tiles.block_far[row * self.tiles.stride() + strip];
                if self.nearest < held {
                    let cell = PyramidCell { level: PyramidCell::BLOCK, x: strip as u16, y: row as u16 };
                    self.read(cell, held, Outcome::Behind);
                    continue;
                }
                let mut bits = asked.tiles(strip, row);
                while bits != 0 {
                    let tile = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    if !self.is_behind(l, &asked, row * self.tiles.strips + strip, tile) {
                        return false;
                    }
                }
            }
        }
        true
    }
}

impl<H: Hears> Behind<'_, H> {
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
