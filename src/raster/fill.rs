//! Triangles into pixels.
//!
//! (a) Rows of a small triangle are one vector: three edge functions, one mask. (b) Rows of a wide one are
//! spans, whose ends follow from the edge functions by an exact division; then no edge is evaluated per
//! pixel.
//!
//! A pixel keeps its winner whatever the order, so who fills which part of the image, and when, leaves no
//! trace.

use super::setup::{Edge, Setup, center};
use super::simd::Lanes;
use super::vertex::SUBPIXEL_BITS;

/// Pixels that one thread fills: an image, or a block of it.
pub(super) struct Canvas<'a> {
    pub depth: &'a mut [f32],
    pub item: &'a mut [u32],
    /// Column and row in the image of its first pixel.
    pub first: [i32; 2],
    /// Pixels from row to row.
    pub stride: usize,
}

impl Canvas<'_> {
    /// Where a pixel of the image lies.
    #[inline(always)]
    fn place(&self, x: i32, y: i32) -> usize {
        (y - self.first[1]) as usize * self.stride + (x - self.first[0]) as usize
    }
}

/// Fills a triangle, whose box lies in the canvas.
#[inline(always)]
pub(super) fn fill<L: Lanes>(l: L, s: &Setup, canvas: &mut Canvas) {
    // (a) needs edge functions that fit 32-bit lanes and a box no wider than a vector.
    if s.narrow && s.x1 - s.x0 <= L::N as i32 {
        fill_small(l, s, canvas);
    } else {
        fill_spans(l, s, canvas);
    }
}

/// Rows that fit a vector, with 32-bit edge functions.
#[inline(always)]
fn fill_small<L: Lanes>(l: L, s: &Setup, canvas: &mut Canvas) {
    let columns = l.first((s.x1 - s.x0) as usize);
    // Closures would not be compiled for the instruction set, so the three edges are written out.
    let [a, b, c] = &s.edges;
    // (a) The edge functions at the first row's centers; each further row adds the edge's step (Pineda 1988).
    let mut edge_a = l.ramp(a.at as i32, a.dx);
    let mut edge_b = l.ramp(b.at as i32, b.dx);
    let mut edge_c = l.ramp(c.at as i32, c.dx);
    let (step_a, step_b, step_c) = (l.splat_i(a.dy), l.splat_i(b.dy), l.splat_i(c.dy));
    // What depth adds along the row is the same in every row. It is not summed up step by step: a pixel's
    // depth may depend on its place alone.
    let along = l.mul(l.splat(s.plane.dx), l.to_f(l.ramp(center(s.x0) - s.plane.x, 1 << SUBPIXEL_BITS)));
    let (low, high, ids) = (l.splat(s.plane.low), l.splat(s.plane.high), l.splat_i(s.id as i32));
    for y in s.y0..s.y1 {
        let at = canvas.place(s.x0, y);
        let inside = l.none_negative(edge_a, edge_b, edge_c, columns);
        // No nearer than the nearest vertex, whatever the rounding: bounds of what is drawn count on it.
        let z = l.clamp(l.add(l.splat(s.plane.at_row(y)), along), low, high);
        // To the end of the canvas, all of which is ours: so that nearly all vectors are whole ones.
        l.merge(&mut canvas.depth[at..], &mut canvas.item[at..], inside, z, ids);
        (edge_a, edge_b, edge_c) =
            (l.add_i(edge_a, step_a), l.add_i(edge_b, step_b), l.add_i(edge_c, step_c));
    }
}

/// Rows whose spans are found at a time: the arithmetic of many rows is SIMD, that of one is not.
const SPAN_ROWS: usize = 16;

/// Rows of any width, from the exact ends of their spans.
#[inline(always)]
fn fill_spans<L: Lanes>(l: L, s: &Setup, canvas: &mut Canvas) {
    // (b) Three divisions a triangle; spans then take multiplications only.
    let inverse = [s.edges[0].inverse(), s.edges[1].inverse(), s.edges[2].inverse()];
    let (low, high, slope) = (l.splat(s.plane.low), l.splat(s.plane.high), l.splat(s.plane.dx));
    let (ids, next) = (l.splat_i(s.id as i32), l.splat_i((L::N as i32) << SUBPIXEL_BITS));
    let mut y = s.y0;
    while y < s.y1 {
        // Each edge cuts off its part of the spans of the next rows.
        let (mut begin, mut end) = ([0; SPAN_ROWS], [s.x1 - s.x0; SPAN_ROWS]);
        for (edge, &inverse) in s.edges.iter().zip(&inverse) {
            narrow(edge, inverse, y - s.y0, &mut begin, &mut end);
        }
        for (k, y) in (y..s.y1.min(y + SPAN_ROWS as i32)).enumerate() {
            if begin[k] >= end[k] {
                continue;
            }
            let x = s.x0 + begin[k];
            let first = canvas.place(x, y);
            let past = first + (end[k] - begin[k]) as usize;
            let base = l.splat(s.plane.at_row(y));
            let mut way = l.ramp(center(x) - s.plane.x, 1 << SUBPIXEL_BITS);
            // Every pixel between the ends is covered, so no vector but the last needs a mask.
            let depths = canvas.depth[first..past].chunks_exact_mut(L::N);
            let left = depths.len() * L::N;
            for (depth, item) in depths.zip(canvas.item[first..past].chunks_exact_mut(L::N)) {
                let z = l.clamp(l.add(base, l.mul(slope, l.to_f(way))), low, high);
                l.merge(depth, item, l.first(L::N), z, ids);
                way = l.add_i(way, next);
            }
            if first + left < past {
                let z = l.clamp(l.add(base, l.mul(slope, l.to_f(way))), low, high);
                let (depth, item) = (&mut canvas.depth[first + left..], &mut canvas.item[first + left..]);
                l.merge(depth, item, l.first(past - first - left), z, ids);
            }
        }
        y += SPAN_ROWS as i32;
    }
}

/// Takes from the spans of some rows, the first of them `skipped` rows below the triangle's first, what lies
/// beyond an edge.
#[inline(always)]
pub(super) fn narrow<const ROWS: usize>(
    edge: &Edge,
    inverse: f64,
    skipped: i32,
    begin: &mut [i32; ROWS],
    end: &mut [i32; ROWS],
) {
    // Edge functions are whole numbers below 2⁴⁸, so doubles hold them and their sums exactly.
    let (at, dy) = (edge.at as f64 + f64::from(edge.dy) * f64::from(skipped), f64::from(edge.dy));
    // The columns with `e + dx · x ≥ 0`. Rising: from ⌈−e / dx⌉ = −⌊e / dx⌋ on.
    if edge.dx > 0 {
        for (k, begin) in begin.iter_mut().enumerate() {
            *begin = (*begin).max(-quotient(at + dy * k as f64, inverse));
        }
    // Falling: up to ⌊e / −dx⌋.
    } else if edge.dx < 0 {
        for (k, end) in end.iter_mut().enumerate() {
            *end = (*end).min(quotient(at + dy * k as f64, inverse) + 1);
        }
    } else {
        for (k, end) in end.iter_mut().enumerate() {
            *end = if at + dy * (k as f64) < 0.0 { 0 } else { *end };
        }
    }
}

/// Floor of `e / d`, given `inverse` = 1/d, limited to ±2¹⁶, which is off every image. Exact: edges are
/// shorter than 2²³, so a quotient that is no integer is 2⁻²³ or more below the next one, and the
/// product errs by less than 2⁻³⁴; adding 2⁻²⁶ keeps both on their side.
#[inline(always)]
fn quotient(e: f64, inverse: f64) -> i32 {
    const LIMIT: f64 = 65536.0;
    const NUDGE: f64 = 1.0 / (1 << 26) as f64;
    let q = (e * inverse + NUDGE).clamp(-LIMIT, LIMIT);
    // Truncation rounds down once the value is not negative.
    // SAFETY: the clamped value plus `LIMIT` lies in 0..=2¹⁷ and is not NaN: `e` is finite, and `inverse` is
    // that of an edge that is not horizontal.
    #[expect(unsafe_code, reason = "the checked conversion is not SIMD")]
    let floor: i32 = unsafe { (q + LIMIT).to_int_unchecked() };
    floor - LIMIT as i32
}
