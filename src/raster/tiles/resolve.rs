//! Closer looks at tiles: a plane that nothing is farther than, and exact depths, from the primitives that
//! the tile's bin keeps.

use super::bins::Batch;
use super::wide::{self, Wide, Work, each};
use super::window::raise;
use super::{Resolved, Tiles};
use crate::raster::line::{columns, depth_at};
use crate::raster::setup::{Plane, area, center};
use crate::raster::simd::Isa;

/// Where a tile is among the entries of its bin, and its first pixel.
#[inline(always)]
fn place(tiles: &Tiles, block: usize, tile: usize) -> (usize, usize, [i32; 2]) {
    let (row, strip) = (block / tiles.strips, block % tiles.strips);
    let bin = strip * (tiles.bin_rows + 1) + (row >> 2);
    let bit = 4 * (4 * (row & 3) + (tile >> 2)) + (tile & 3);
    (bin, bit, [(32 * strip + 8 * (tile & 3)) as i32, (16 * row + 4 * (tile >> 2)) as i32])
}

/// A plane that no pixel of a tile is farther than: that of the primitive that covers it whole and is nearest
/// at its center. Returns its number among the floors.
#[inline(always)]
pub(super) fn cover(tiles: &mut Tiles, block: usize, tile: usize) -> usize {
    let (bin, bit, [x, y]) = place(tiles, block, tile);
    let mut best = [0.0; 3];
    for entry in tiles.bins.of(bin) {
        if entry.whole >> bit & 1 == 0 || entry.nearest <= best[0] {
            continue;
        }
        let (batch, lane) = (&tiles.bins.kept[entry.id as usize / 16], entry.id as usize % 16);
        let (a, b) = (batch.floor[1][lane], batch.floor[2][lane]);
        let at = batch.floor[0][lane]
            + a * ((x - batch.column[lane]) as f32 + 3.5)
            + b * ((y - batch.row[lane]) as f32 + 1.5);
        if at > best[0] {
            best = [at, a, b];
        }
    }
    let at = tiles.resolved.floors.len();
    tiles.resolved.floors.push((best, Resolved::NOT));
    tiles.resolved.order.push((block as u32, tile as u32));
    tiles.resolved.at[block][tile] = at as u32;
    at
}

/// Depths of a tile's 32 pixels, from the entries of its bin, which come about front to back.
#[inline(always)]
pub(super) fn resolve<L: Wide>(l: L, tiles: &mut Tiles, block: usize, tile: usize) {
    let (bin, bit, [x, y]) = place(tiles, block, tile);
    let mut depths = [tiles.camera.depth_far; 32];
    let mut far = tiles.camera.depth_far;
    for entry in tiles.bins.of(bin) {
        if entry.tiles >> bit & 1 == 0 || entry.nearest <= far {
            continue;
        }
        let batch = &tiles.bins.kept[entry.id as usize / 16];
        if tiles.is_flat {
            shade_segment(batch, entry.id as usize % 16, x, &mut depths);
        } else {
            shade(l, batch, entry.id as usize % 16, [0, 1, 2], [x, y], &mut depths);
            shade(l, batch, entry.id as usize % 16, [0, 2, 3], [x, y], &mut depths);
        }
        let mut least = l.load(&depths);
        for at in (L::N..32).step_by(L::N) {
            least = l.min(least, l.load(&depths[at..]));
        }
        far = l.least(least);
    }
    let floor = floor(l, &depths);
    let known = &mut tiles.resolved.floors[tiles.resolved.at[block][tile] as usize];
    if floor[0] > known.0[0] {
        known.0 = floor;
    }
    known.1 = tiles.resolved.depths.len() as u32;
    tiles.resolved.depths.push(depths);
    // What was known of the tile is replaced by what is true, which is no farther.
    let known = &mut tiles.lines[(x / 32) as usize * tiles.rows + (y / 4) as usize].far[tile & 3];
    debug_assert!(*known <= far, "a tile claimed {known}, and {far} is true");
    *known = far;
}

/// Exact depths of the whole image, row by row.
pub(super) fn depths(tiles: &mut Tiles, isa: Isa) -> Vec<f32> {
    assert!(tiles.keeps, "nothing was kept for exact depths");
    wide::run(isa, All { tiles });
    let mut depths = vec![0.0; tiles.width as usize * tiles.height as usize];
    for (at, to) in depths.iter_mut().enumerate() {
        let (x, y) = (at % tiles.width as usize, at / tiles.width as usize);
        let block = (y / 16) * tiles.strips + x / 32;
        let tile = (y % 16 / 4) * 4 + x % 32 / 8;
        let floor = tiles.resolved.floors[tiles.resolved.at[block][tile] as usize];
        *to = tiles.resolved.depths[floor.1 as usize][(y % 4) * 8 + x % 8];
    }
    depths
}

/// All tiles, looked at.
struct All<'a> {
    tiles: &'a mut Tiles,
}

impl Work for All<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        for block in 0..self.tiles.strips * self.tiles.block_rows {
            // Tiles that begin below the image hold nothing.
            let lines = (self.tiles.height as usize).div_ceil(4) - 4 * (block / self.tiles.strips);
            for tile in 0..4 * lines.min(4) {
                let known = self.tiles.resolved.at[block][tile];
                let at = if known == Resolved::NOT { cover(self.tiles, block, tile) } else { known as usize };
                if self.tiles.resolved.floors[at].1 == Resolved::NOT {
                    resolve(l, self.tiles, block, tile);
                }
            }
        }
    }
}

/// The plane through three corners of a tile, lowered so that no pixel is farther.
#[inline(always)]
fn floor<L: Wide>(l: L, depths: &[f32; 32]) -> [f32; 3] {
    let (a, b) = ((depths[7] - depths[0]) * (1.0 / 7.0), (depths[24] - depths[0]) * (1.0 / 3.0));
    let at = depths[0] + 3.5 * a + 1.5 * b;
    let (column, row) = l.pixels();
    let across = l.mul(l.sub(l.to_f(column), l.splat(3.5)), l.splat(a));
    let mut least = l.splat(0.0);
    for part in 0..32 / L::N {
        let y = l.sub(l.to_f(row), l.splat(1.5 - (part * L::N / 8) as f32));
        let plane = l.add(l.add(across, l.mul(y, l.splat(b))), l.splat(at));
        least = l.min(least, l.sub(l.load(&depths[part * L::N..]), plane));
    }
    // What rounding takes from three sums of this size.
    let rounding = (at.abs() + 3.5 * a.abs() + 1.5 * b.abs()) * (1.0 / (1 << 20) as f32);
    [at + l.least(least) - rounding, a, b]
}

/// One segment on the columns of the tile at a column, in all rows alike.
#[inline(always)]
fn shade_segment(batch: &Batch, k: usize, x: i32, to: &mut [f32; 32]) {
    let [a, b] = [batch.corner(0, k), batch.corner(1, k)];
    let (first, past) = columns(&a, &b, x as u32, x as u32 + 8);
    // One that covers nothing may have no plane.
    if first >= past {
        return;
    }
    let plane = Plane::of_segment(a, b);
    for at in first..past {
        let z = depth_at(&plane, at as u32);
        to.chunks_exact_mut(8).for_each(|row| raise(&mut row[(at - x) as usize], z));
    }
}

/// One triangle on the 32 pixels of a tile.
#[inline(always)]
fn shade<L: Wide>(l: L, batch: &Batch, k: usize, corners: [usize; 3], [x, y]: [i32; 2], to: &mut [f32; 32]) {
    let v = each!(3; i => batch.corner(corners[i], k));
    if area([&v[0], &v[1], &v[2]]) == 0 {
        return;
    }
    let plane = Plane::of([&v[0], &v[1], &v[2]]);
    let (cx, cy) = (center(x), center(y));
    let (column, row) = l.pixels();
    let mut edges = [l.splat_i(0); 3];
    let mut steps = [l.splat_i(0); 3];
    let rows = (L::N / 8) as i32;
    for j in 0..3 {
        let (a, b) = (&v[j], &v[(j + 1) % 3]);
        let (ex, ey) = (b.x - a.x, b.y - a.y);
        let top_left = ey < 0 || (ey == 0 && ex > 0);
        let e =
            i64::from(ex) * i64::from(cy - a.y) - i64::from(ey) * i64::from(cx - a.x) - i64::from(!top_left);
        // Beyond 2²⁹ no pixel of the tile is on the other side.
        let at = (e >> 8).clamp(-(1 << 29), 1 << 29) as i32;
        let (across, down) = (l.mul_i(column, l.splat_i(ey)), l.mul_i(row, l.splat_i(ex)));
        edges[j] = l.add_i(l.splat_i(at), l.sub_i(down, across));
        steps[j] = l.splat_i(rows * ex);
    }
    let along = l.mul(l.splat(plane.dx), l.to_f(l.add_i(l.shift_up::<8>(column), l.splat_i(cx - plane.x))));
    let mut down = l.add_i(l.shift_up::<8>(row), l.splat_i(cy - plane.y));
    let (low, high) = (l.splat(plane.low), l.splat(plane.high));
    for at in (0..32).step_by(L::N) {
        let inside = l.gt_i(l.or(l.or(edges[0], edges[1]), edges[2]), l.splat_i(-1));
        let base = l.add(l.splat(plane.z), l.mul(l.splat(plane.dy), l.to_f(down)));
        let z = l.min(l.max(l.add(base, along), low), high);
        let old = l.load(&to[at..]);
        l.store(&mut to[at..], l.pick(inside, l.max(z, old), old));
        for j in 0..3 {
            edges[j] = l.add_i(edges[j], steps[j]);
        }
        down = l.add_i(down, l.splat_i(256 * rows));
    }
}
