//! Primitives into windows of 32×16 pixels: exact coverage, bounds of depth, and the masked update.
//!
//! **Coverage** (Pineda 1988's edge functions, row by row). With pixel centers 256 grid steps apart an edge's
//! value divided by 256 and rounded down, `e + ex·row − ey·column`, has the sign of the edge function at
//! every center. So in a row the pixels inside an edge are those from the column `q = (e + ex·row) / ey` on,
//! or up to it, and their mask is all ones shifted left by `⌈q⌉`, or turned round. Four such masks are
//! combined, and one permutation of bytes turns rows into the masks of tiles.
//!
//! It is exact. A window's rows are 33 columns wide at most: farther crossings fill or empty a row whatever
//! their fraction. For |q| ≤ 33 in f32, `e + ex·row` and `ey` are whole numbers below 2²⁴; 1/ey and the
//! product are rounded by 2⁻²⁴ each, so q errs by less than 33·2⁻²³, and the sum with the bias ν = 2⁻¹⁷ by
//! 2⁻¹⁹ more: 5.9·10⁻⁶ in all, less than ν = 7.6·10⁻⁶. A q that is no whole number lies at least 1/|ey| ≥
//! 2⁻¹⁶ = 15.3·10⁻⁶ from one, more than both together. So `⌈q − ν⌉` (edges on the left) takes whole numbers
//! as they are and others up, and `⌈q + ν⌉` (on the right) is one more than the last pixel inside. Values
//! beyond 2²⁴ are rounded, and lie 240 columns and more from the edge. Above 256 pixels the same in doubles:
//! q errs by less than 2⁻³⁶, ν is 2⁻²⁶, and 1/|ey| ≥ 2⁻²³.
//!
//! **The update** is that of Hasselgren, Andersson and Akenine-Möller, "Masked Software Occlusion Culling",
//! 2016, Section 3.2, with one change: a primitive that covers a tile whole keeps the layer that was begun
//! where that is nearer.

use super::bins::Entry;
use super::ready::{LARGE, Ready};
use super::wide::{Wide, Work, each};
use super::{Tiles, UNBEGUN};

/// Where a window lies: its strip, its first line, and how many tiles to the right and down of the
/// primitive's first block.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub strip: usize,
    pub line: usize,
    pub right: f32,
    pub below: f32,
}

/// Draws a primitive that fits one window, which begins at any line. Whether it may show.
#[inline(always)]
pub(super) fn single<L: Wide>(l: L, tiles: &mut Tiles, t: &Ready, lane: usize, id: u32) -> bool {
    let (strip, line) = ((t.x0[lane] >> 5) as usize, (t.y0[lane] >> 2) as usize);
    let below = line & 3;
    let place = Place { strip, line, right: 0.0, below: below as f32 };
    let first_row = l.add(l.lanes(), l.splat(4.0 * below as f32));
    let (mut hit, mut whole) = (0, 0);
    for part in 0..16 / L::N {
        if part > 0 && (4 * line + part * L::N) as i32 >= t.y1[lane] {
            break;
        }
        let row = l.add(first_row, l.splat((part * L::N) as f32));
        let mut rows = l.splat_i(-1);
        for k in 0..4 {
            let v = l.add(l.mul(row, l.splat(t.exf[k][lane])), l.splat(t.ef[k][lane]));
            rows = l.and(rows, inside(l, t, lane, k, v));
        }
        let covered = l.transpose(rows);
        let found = merge::<L, false>(l, tiles, t, lane, place, part, covered);
        (hit, whole) = (hit | found.0, whole | found.1);
    }
    if hit != 0 && tiles.keeps {
        let nearest = t.nearest[lane];
        let at = (line >> 2) * tiles.stride() + strip;
        raise(&mut tiles.block_near[at], nearest);
        if below != 0 {
            // The lower part lies in the next block.
            let at = at + tiles.stride();
            raise(&mut tiles.block_near[at], nearest);
        }
        let bin = strip * (tiles.bin_rows + 1) + (line >> 4);
        let shift = 4 * (line & 15) as u32;
        let (hit, whole) = (u64::from(hit), u64::from(whole));
        tiles.bins.push(bin, Entry { tiles: hit << shift, whole: whole << shift, id, nearest });
        if line & 15 > 12 {
            let shift = 64 - shift;
            tiles.bins.push(bin + 1, Entry { tiles: hit >> shift, whole: whole >> shift, id, nearest });
        }
    }
    hit != 0
}

/// The pixels of rows that are inside an edge, from its values at their first pixels.
#[inline(always)]
fn inside<L: Wide>(l: L, t: &Ready, lane: usize, k: usize, v: L::F) -> L::I {
    let q = l.add(l.mul(v, l.splat(t.per_ey[k][lane])), l.splat(t.bias[k][lane]));
    let from = l.ceil(l.max(q, l.splat(0.0)));
    l.xor(l.shift_left(l.splat_i(-1), from), l.splat_i(t.flip[k][lane]))
}

/// The masked update of the tiles of a window, or of a part of it. Returns which may show something of the
/// primitive, which of these it covers whole, and its nearest depth in those.
#[inline(always)]
pub(super) fn merge<L: Wide, const WHOLE: bool>(
    l: L,
    tiles: &mut Tiles,
    t: &Ready,
    lane: usize,
    place: Place,
    part: usize,
    covered: L::I,
) -> (u32, u32, f32) {
    let first = place.strip * tiles.rows + place.line + part * (L::N / 4);
    let lines = &mut tiles.lines[first..first + L::N / 4];
    let (far, near, mask, ever) = l.load_lines(lines);
    let (column, row) = l.tiles();
    let below = place.below + (part * (L::N / 4)) as f32;
    let moved = l.add(
        l.mul(l.add(column, l.splat(place.right)), l.splat(t.along[lane])),
        l.mul(l.add(row, l.splat(below)), l.splat(t.down[lane])),
    );
    // Its nearest depth in each tile: where that is behind all, nothing shows. Where it is as deep, ids
    // decide what the image shows.
    let high = l.min(l.add(moved, l.splat(t.near[lane])), l.splat(t.nearest[lane]));
    let mut hit = l.ge(high, far);
    if !WHOLE {
        hit = l.without(hit, l.eq_i(covered, l.splat_i(0)));
    }
    let bits = l.bits(hit);
    if bits == 0 {
        return (0, 0, 0.0);
    }
    let low = l.max(l.add(moved, l.splat(t.far[lane])), l.splat(t.farthest[lane]));
    let ever = l.pick_i(hit, l.or(ever, covered), ever);
    // Where it is nearer than all that the tile is known to hold, it makes the tile nearer: at once where it
    // covers it, else with what was begun.
    let nearer = l.both(hit, l.gt(low, far));
    let is_whole = l.both(hit, l.eq_i(covered, l.splat_i(-1)));
    let full = l.both(nearer, is_whole);
    let partly = l.without(nearer, full);
    // What was begun is given up where it lies so far behind that it would pull the depth of both closer to
    // the old one, and where a full cover is nearer.
    let twice = l.add(near, near);
    let behind = l.both(partly, l.gt(l.add(low, far), twice));
    let dropped = l.either(behind, l.both(full, l.ge(low, near)));
    let mask = l.pick_i(dropped, l.splat_i(0), mask);
    let mask = l.pick_i(partly, l.or(mask, covered), mask);
    let near = l.pick(dropped, l.splat(UNBEGUN), near);
    let near = l.pick(partly, l.min(near, low), near);
    // What was begun covers the tile now.
    let done = l.both(partly, l.eq_i(mask, l.splat_i(-1)));
    let far = l.pick(full, low, far);
    let far = l.pick(done, near, far);
    let mask = l.pick_i(done, l.splat_i(0), mask);
    let near = l.pick(done, l.splat(UNBEGUN), near);
    l.store_lines(lines, far, near, mask, ever);
    let nearest = l.greatest(l.pick(hit, high, l.splat(0.0)));
    (bits << (part * L::N), l.bits(is_whole) << (part * L::N), nearest)
}

/// A primitive in several windows, which are blocks.
pub(super) struct Several<'a, const SIZE: u8> {
    pub tiles: &'a mut Tiles,
    pub ready: &'a Ready,
    pub lane: usize,
    pub id: u32,
}

/// For up to 16 rows of blocks the strips that an outline may touch, and those that it covers, half-open;
/// from the first strip of the primitive.
#[derive(Default)]
struct Spans {
    from: [i32; 16],
    past: [i32; 16],
    inner: [i32; 16],
    inner_past: [i32; 16],
}

impl<const SIZE: u8> Work for Several<'_, SIZE> {
    type Output = bool;
    #[inline(always)]
    fn run<L: Wide>(self, l: L) -> bool {
        let Self { tiles, ready: t, lane, id } = self;
        let (first, past) = ((t.x0[lane] >> 5) as usize, ((t.x1[lane] - 1) >> 5) as usize + 1);
        let (top, bottom) = ((t.y0[lane] >> 4) as usize, ((t.y1[lane] - 1) >> 4) as usize);
        let mut spans = Spans::default();
        let mut any = false;
        // The nearest depth in each block of a row, from that in its first tile.
        let (along, down) = (4.0 * t.along[lane], 4.0 * t.down[lane]);
        let most = t.near[lane] + 3.0 * (positive(t.along[lane]) + positive(t.down[lane]));
        let (mut hit_from, mut hit_past) = (usize::MAX, 0);
        for row in top..=bottom {
            let k = row - top;
            if k % 16 == 0 {
                let rows = [top, row, (bottom + 1 - row).min(16)];
                fill_spans::<L, SIZE>(l, t, lane, rows, [first, past], &mut spans);
            }
            let (from, to) = (spans.from[k % 16], spans.past[k % 16]);
            let mut begin = from;
            while begin < to {
                // Many blocks at a time: is it behind all of them?
                let right = l.add(l.lanes(), l.splat(begin as f32));
                let moved = l.add(l.mul(right, l.splat(along)), l.splat(down * k as f32 + most));
                let high = l.min(moved, l.splat(t.nearest[lane]));
                let at = row * tiles.stride() + first + begin as usize;
                let shows =
                    l.both(l.first((to - begin) as usize), l.ge(high, l.load(&tiles.block_far[at..])));
                let mut bits = l.bits(shows);
                while bits != 0 {
                    let s = begin + bits.trailing_zeros() as i32;
                    bits &= bits - 1;
                    let is_whole = s >= spans.inner[k % 16] && s < spans.inner_past[k % 16];
                    let block = [first + s as usize, row, s as usize, k];
                    let (hit, whole, nearest) = if is_whole {
                        l.apart(Block::<true, SIZE> { tiles, t, lane, block })
                    } else {
                        l.apart(Block::<false, SIZE> { tiles, t, lane, block })
                    };
                    if hit != 0 && tiles.keeps {
                        let strip = first + s as usize;
                        let at = &mut tiles.scratch.hits[strip];
                        at.0 |= u64::from(hit) << (16 * (row & 3));
                        at.1 |= u64::from(whole) << (16 * (row & 3));
                        raise(&mut at.2, nearest);
                        hit_from = hit_from.min(strip);
                        hit_past = hit_past.max(strip + 1);
                    }
                    any |= hit != 0;
                }
                begin += L::N as i32;
            }
            // A bin has four rows of blocks.
            if row & 3 == 3 || row == bottom {
                keep_hits(tiles, [hit_from, hit_past], row >> 2, id);
                (hit_from, hit_past) = (usize::MAX, 0);
            }
        }
        any
    }
}

/// An entry for each strip whose tiles were hit in a row of bins.
#[inline(always)]
fn keep_hits(tiles: &mut Tiles, [from, past]: [usize; 2], bin_row: usize, id: u32) {
    for strip in from..past {
        let (found, whole, nearest) = std::mem::take(&mut tiles.scratch.hits[strip]);
        let bin = strip * (tiles.bin_rows + 1) + bin_row;
        tiles.bins.push(bin, Entry { tiles: found, whole, id, nearest });
    }
}

/// One block.
struct Block<'a, const WHOLE: bool, const SIZE: u8> {
    tiles: &'a mut Tiles,
    t: &'a Ready,
    lane: usize,
    /// Strip and row in the image; strip and row from the primitive's first.
    block: [usize; 4],
}

impl<const WHOLE: bool, const SIZE: u8> Work for Block<'_, WHOLE, SIZE> {
    type Output = (u32, u32, f32);
    #[inline(always)]
    fn run<L: Wide>(self, l: L) -> (u32, u32, f32) {
        let Self { tiles, t, lane, block: [strip, row, s, k] } = self;
        let place = Place { strip, line: 4 * row, right: (4 * s) as f32, below: (4 * k) as f32 };
        let (mut hit, mut whole, mut nearest) = (0, 0, 0.0);
        for part in 0..16 / L::N {
            let covered = if WHOLE {
                l.splat_i(-1)
            } else if SIZE == LARGE {
                l.transpose(wide_rows(l, t, lane, 32 * strip, 16 * row + part * L::N))
            } else {
                l.transpose(rows(l, t, lane, [s, k], part))
            };
            let found = merge::<L, WHOLE>(l, tiles, t, lane, place, part, covered);
            (hit, whole) = (hit | found.0, whole | found.1);
            raise(&mut nearest, found.2);
        }
        if hit != 0 {
            let at = row * tiles.stride() + strip;
            if WHOLE || SIZE == LARGE {
                let first = strip * tiles.rows + 4 * row;
                let lines = &tiles.lines[first..first + 4];
                let mut far = l.least(l.load_farthest(lines));
                if L::N == 8 {
                    far = lesser(far, l.least(l.load_farthest(&lines[2..])));
                }
                tiles.block_far[at] = far;
            }
            if tiles.keeps {
                raise(&mut tiles.block_near[at], nearest);
            }
        }
        (hit, whole, nearest)
    }
}

/// Rows of a block of a middling primitive.
#[inline(always)]
fn rows<L: Wide>(l: L, t: &Ready, lane: usize, [s, k]: [usize; 2], part: usize) -> L::I {
    let row = l.add(l.lanes(), l.splat((part * L::N) as f32));
    let mut rows = l.splat_i(-1);
    for e in 0..4 {
        // The value at the block's first pixel.
        let at = t.e[e][lane] + t.ex[e][lane] * (16 * k as i32) - t.ey[e][lane] * (32 * s as i32);
        let v = l.add(l.mul(row, l.splat(t.exf[e][lane])), l.splat(at as f32));
        rows = l.and(rows, inside(l, t, lane, e, v));
    }
    rows
}
/// Rows of a block of a large primitive, `x` and `y` its first pixel.
#[inline(always)]
fn wide_rows<L: Wide>(l: L, t: &Ready, lane: usize, x: usize, y: usize) -> L::I {
    let row = l.add_d(l.lanes_d(), l.splat_d(y as f64));
    let mut rows = l.splat_i(-1);
    for k in 0..4 {
        let v = l.add_d(l.mul_d(row, l.splat_d(t.wide_ex[k][lane])), l.splat_d(t.wide_e[k][lane]));
        let q = l.add_d(l.mul_d(v, l.splat_d(t.wide_per_ey[k][lane])), l.splat_d(t.wide_bias[k][lane]));
        // Far to either side is as good as farther.
        let q = l.max_d(l.min_d(q, l.splat_d(20000.0)), l.splat_d(-20000.0));
        let from = l.sub_i(l.nearest(l.ceil_d(q)), l.splat_i(x as i32));
        let from = l.max_i(from, l.splat_i(0));
        rows = l.and(rows, l.xor(l.shift_left(l.splat_i(-1), from), l.splat_i(t.flip[k][lane])));
    }
    rows
}

/// Strips that the outline may touch, and that it covers, for rows of blocks: from the crossings of its edges
/// with the first and the last row of pixels, outward and inward by a pixel for rounding.
#[inline(always)]
fn fill_spans<L: Wide, const SIZE: u8>(
    l: L,
    t: &Ready,
    lane: usize,
    [top, row, count]: [usize; 3],
    [first, past]: [usize; 2],
    spans: &mut Spans,
) {
    let left = (32 * first) as i32;
    for part in (0..count).step_by(L::N) {
        let [low, high, in_low, in_high] = if SIZE == LARGE {
            wide_crossings(l, t, lane, row + part, left)
        } else {
            crossings(l, t, lane, row - top + part, left)
        };
        let strips = l.splat_i((past - first) as i32);
        l.store_i(&mut spans.from[part..], l.max_i(strip_at(l, low, -1.0), l.splat_i(0)));
        l.store_i(&mut spans.past[part..], l.min_i(strip_at(l, high, 33.0), strips));
        l.store_i(&mut spans.inner[part..], strip_at(l, in_low, 33.0));
        l.store_i(&mut spans.inner_past[part..], strip_at(l, in_high, -1.0));
    }
}
/// The strip of a column, and of one so much farther, rounded down.
#[inline(always)]
fn strip_at<L: Wide>(l: L, column: L::F, more: f32) -> L::I {
    let v = l.max(l.min(column, l.splat(1e5)), l.splat(-64.0));
    // Three strips more, so that what is cut off toward zero is rounded down.
    l.sub_i(l.shift_right::<5>(l.truncate(l.add(v, l.splat(more + 96.0)))), l.splat_i(3))
}
/// For rows of blocks of a middling primitive, from its first: the columns, from its first strip, between
/// which it may lie, and between which it covers all.
#[inline(always)]
fn crossings<L: Wide>(l: L, t: &Ready, lane: usize, block: usize, left: i32) -> [L::F; 4] {
    let y = l.mul(l.add(l.lanes(), l.splat(block as f32)), l.splat(16.0));
    let (mut low, mut high) = (l.splat((t.x0[lane] - left) as f32), l.splat((t.x1[lane] - left) as f32));
    let (mut in_low, mut in_high) = (l.splat(0.0), high);
    for k in 0..4 {
        let (ex, per) = (l.splat(t.exf[k][lane]), l.splat(t.per_ey[k][lane]));
        let first = l.mul(l.add(l.mul(y, ex), l.splat(t.ef[k][lane])), per);
        let last = l.add(first, l.mul(l.mul(ex, l.splat(15.0)), per));
        let (a, b) = (l.min(first, last), l.max(first, last));
        if t.flip[k][lane] == 0 {
            (low, in_low) = (l.max(low, a), l.max(in_low, b));
        } else {
            (high, in_high) = (l.min(high, b), l.min(in_high, a));
        }
    }
    [low, high, in_low, in_high]
}
/// The same of a large one, for rows of blocks of the image.
#[inline(always)]
fn wide_crossings<L: Wide>(l: L, t: &Ready, lane: usize, row: usize, left: i32) -> [L::F; 4] {
    let y = l.mul_d(l.add_d(l.lanes_d(), l.splat_d(row as f64)), l.splat_d(16.0));
    let (near, far) = (l.splat_d(-1e6), l.splat_d(1e6));
    let (mut low, mut high, mut in_low, mut in_high) = (near, far, near, far);
    for k in 0..4 {
        let (ex, per) = (t.wide_ex[k][lane], t.wide_per_ey[k][lane]);
        let v = l.add_d(l.mul_d(y, l.splat_d(ex)), l.splat_d(t.wide_e[k][lane]));
        let first = l.mul_d(v, l.splat_d(per));
        let last = l.add_d(first, l.splat_d(15.0 * ex * per));
        let (a, b) = (l.min_d(first, last), l.max_d(first, last));
        if t.flip[k][lane] == 0 {
            (low, in_low) = (l.max_d(low, a), l.max_d(in_low, b));
        } else {
            (high, in_high) = (l.min_d(high, b), l.min_d(in_high, a));
        }
    }
    let start = l.splat_d(f64::from(left));
    let v = [low, high, in_low, in_high];
    each!(4; k => l.narrow(l.max_d(l.min_d(l.sub_d(v[k], start), l.splat_d(1e5)), l.splat_d(-1e5))))
}

#[inline(always)]
pub(super) fn positive(v: f32) -> f32 {
    if v > 0.0 { v } else { 0.0 }
}
#[inline(always)]
pub(super) fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
#[inline(always)]
pub(super) fn raise(to: &mut f32, v: f32) {
    *to = if v > *to { v } else { *to };
}
