//! Segments into the tiles of flatland, whose image is a line of pixels.
//!
//! Which pixels a segment covers and how deep it lies there are the rules of `raster::line`; the masked
//! update and all that follows is that of triangles. The image is the first row of its one row of tiles: a
//! segment counts in all four rows of a tile alike, so that one that it covers is covered whole.
//!
//! **Bounds.** The exact depth at a center is `z + dx·d`, `d` grid steps from an end and a whole number below
//! 2²³, cut to the depths of the ends. Bounds come from the same `z` and `dx` in doubles, so that what they
//! allow for is:
//!
//! - Centers that the snapped segment covers lie up to half a step beyond an end that is not snapped, where
//!   the depth is cut: [`OUTSIDE`] of the change a step holds what is cut off.
//! - Seven roundings to f32: of product and sum in the exact formula, of a bound as it is stored, and of two
//!   products and two sums on the way to a tile or a block. Each is 2⁻²⁴ of at most twice the change over the
//!   segment and two windows with the nearest depth: together less than [`ROUNDING`] of these.
//! - Depths above [`STEEP`], which come with near planes below 1e-30: slopes may have been left out there, or
//!   sums overflow, so the ends alone are bounds.

use super::Tiles;
use super::bins::{Batch, Entry};
use super::clusters::{Cluster, corner};
use super::query::refresh;
use super::ready::Ready;
use super::setup::{Draw, Front};
use super::wide::{Wide, Work};
use super::window::{Place, lesser, merge, positive, raise};
use crate::raster::line::{columns, cut};
use crate::raster::setup::{Plane, center};
use crate::raster::vertex::{NEEDS_CLIP, REJECTS, Vertex};

/// A little more than half.
const OUTSIDE: f64 = 0.51;
const ROUNDING: f64 = 1.0 / (1 << 20) as f64;
const STEEP: f64 = 1e30;

/// Segments of a cluster whose points are projected, in a function of its own.
struct Segments<'a, 'b, L> {
    draw: &'b mut Draw<'a, L>,
    cluster: &'b Cluster,
    front: &'b Front,
}

impl<M: Wide> Work for Segments<'_, '_, M> {
    type Output = ();
    #[inline(always)]
    fn run<L: Wide>(self, l: L) {
        let Self { draw, cluster, front } = self;
        let mut ready = draw.tiles.scratch.ready.take().unwrap_or_default();
        for (&word, &tag) in front.words.iter().zip(&front.tags) {
            let Some(ends) = draw.ends(cluster, word) else { continue };
            let shows = put(l, draw.tiles, &mut ready, ends);
            let told = &mut draw.tiles.scratch.told;
            if shows && told.is_asked {
                told.shown.push(tag);
            }
        }
        draw.tiles.scratch.ready = Some(ready);
    }
}

impl<L: Wide> Draw<'_, L> {
    /// Draws the segments of a cluster that are seen from the front.
    #[inline(always)]
    pub(super) fn segments(&mut self, cluster: &Cluster, front: &Front) {
        self.l.apart(Segments { draw: self, cluster, front });
    }
    /// The ends of a segment on the grid, clipped if need be; `None` if it is out of view.
    #[inline(always)]
    fn ends(&self, c: &Cluster, word: u64) -> Option<[Vertex; 2]> {
        let [a, b] = [0, 1].map(|k| self.tiles.scratch.corners[corner(word, k)]);
        if a.outside() & b.outside() & REJECTS != 0 {
            return None;
        }
        if (a.outside() | b.outside()) & NEEDS_CLIP == 0 {
            return Some([a, b]);
        }
        let camera = &self.tiles.camera;
        let [a, b, _] = self.points_of(c, word).map(|p| camera.clip(p));
        cut(camera, &[a, b])
    }
}

/// One segment into the strips that it covers something of. Whether it may show.
#[inline(always)]
fn put<L: Wide>(l: L, tiles: &mut Tiles, t: &mut Ready, ends: [Vertex; 2]) -> bool {
    let [a, b] = &ends;
    // To whole strips: so a tile that the image's right edge cuts can be covered whole.
    let (x0, x1) = columns(a, b, 0, 32 * tiles.strips as u32);
    if x0 >= x1.min(tiles.width) {
        return false;
    }
    let (first, past) = ((x0 >> 5) as usize, ((x1 - 1) >> 5) as usize + 1);
    bounds(t, ends, 32 * first as i32);
    // The nearest depth in the first block, of its last tile where it comes nearer to the right.
    let most = t.near[0] + 3.0 * positive(t.along[0]);
    let mut shows = false;
    for strip in first..past {
        let right = (4 * (strip - first)) as f32;
        if lesser(right * t.along[0] + most, t.nearest[0]) < tiles.block_far[strip] {
            continue;
        }
        let left = 32 * strip as i32;
        let row = (u32::MAX << (x0 - left).max(0)) & (u32::MAX >> (left + 32 - x1).max(0));
        // The four rows of the first line of tiles.
        let rows = l.pick_i(l.first(4), l.splat_i(row as i32), l.splat_i(0));
        let place = Place { strip, line: 0, right, below: 0.0 };
        let (hit, whole, nearest) = merge::<L, false>(l, tiles, t, 0, place, 0, l.transpose(rows));
        if hit == 0 {
            continue;
        }
        shows = true;
        refresh(l, tiles, strip, 0);
        if tiles.keeps {
            raise(&mut tiles.block_near[strip], nearest);
            let (hit, whole) = (u64::from(hit), u64::from(whole));
            let id = tiles.scratch.segments as u32;
            tiles.bins.push(strip * (tiles.bin_rows + 1), Entry { tiles: hit, whole, id, nearest });
        }
    }
    if shows && tiles.keeps {
        keep(tiles, t, ends, 32 * first as i32);
    }
    shows
}

/// The bounds that the update reads, from the tile that begins at a pixel on.
#[inline(always)]
fn bounds(t: &mut Ready, [a, b]: [Vertex; 2], left: i32) {
    let plane = Plane::of_segment(a, b);
    let slope = f64::from(plane.dx);
    let reach = f64::from((a.x - b.x).abs()) + 64.0 * 256.0;
    let size = slope.abs() * reach + f64::from(plane.high);
    let slack = slope.abs() * OUTSIDE + size * ROUNDING;
    let at = f64::from(plane.z) + slope * f64::from(center(left) - plane.x);
    // Over the centers of a tile, seven columns on.
    let across = slope * (7.0 * 256.0);
    let known = [
        at - slack,
        at + across.min(0.0) - slack,
        at + across.max(0.0) + slack,
        // To the next tile.
        slope * 2048.0,
    ];
    let ends = [plane.low, plane.low, plane.high, 0.0];
    let [floor, far, near, along] = if size < STEEP { known.map(|v| v as f32) } else { ends };
    (t.floor[0], t.far[0], t.near[0], t.along[0], t.down[0]) = (floor, far, near, along, 0.0);
    (t.farthest[0], t.nearest[0]) = (plane.low, plane.high);
}

/// Keeps a segment for exact answers, under the next number.
#[inline(always)]
fn keep(tiles: &mut Tiles, t: &Ready, ends: [Vertex; 2], left: i32) {
    let (batch, lane) = (tiles.scratch.segments / 16, tiles.scratch.segments % 16);
    if lane == 0 {
        tiles.bins.kept.push(Batch::default());
    }
    tiles.scratch.segments += 1;
    let batch = &mut tiles.bins.kept[batch];
    ends.into_iter().enumerate().for_each(|(which, v)| batch.put(which, lane, v));
    // From tile to tile, eight columns.
    (batch.floor[0][lane], batch.floor[1][lane]) = (t.floor[0], t.along[0] * 0.125);
    batch.column[lane] = left;
}
