//! A triangle made ready for pixels: its box, its edge functions, its depth plane.
//!
//! Pinned-down arithmetic (Pineda 1988, <https://doi.org/10.1145/378456.378457>): with pixel centers a whole
//! 256 grid steps apart an edge function changes by multiples of 256 from center to center, so its low 8 bits
//! never matter and `E >> 8` has the sign of `E` at every center and steps by the edge itself.
//!
//! Corners are snapped for coverage alone. The depth plane goes through the places where they were: one
//! through snapped corners would be tilted, and a face seen nearly edge-on would win whole rows from its
//! neighbors. Over the snapped triangle that plane differs from the corners' depths, mixed, by what it
//! changes along the way that a corner was moved, half a grid step an axis at most. Where that exceeds
//! [`DEPTH_TILT`] of the depth, the plane goes through the snapped corners instead. So what covers a pixel's
//! center has the depth there, but for that share, of a point of the primitive that belongs within half a
//! grid step of it; without the bound a face seen edge-on could come before what hides it.
//!
//! In the order of cost: the box drops triangles between pixel centers, the area drops flat ones, then come
//! the plane and the three edges.

use super::DEPTH_TILT;
use super::vertex::{CENTER, SUBPIXEL_BITS, Vertex};
use crate::geometry::PixelRect;

/// Depth over the image: `1/w` is linear there. Grid steps; larger is nearer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Where the depth is `z`: the farthest vertex as snapped, so that distant pixels lose nothing to near
    /// ones.
    pub x: i32,
    /// Row of that vertex.
    pub y: i32,
    /// Depth there.
    pub z: f32,
    /// Change per step in x.
    pub dx: f32,
    /// Change per step in y.
    pub dy: f32,
    /// Least depth of the vertices; rounding never leads below.
    pub low: f32,
    /// Greatest depth of the vertices; rounding never leads above.
    pub high: f32,
}

/// Slopes above this would overflow over the guard band; they come only with near planes below 1e-20.
const STEEPEST: f32 = 1e28;
/// An area below this share of its own two terms is not trusted: it is rounded by 2⁻⁵² of them, so that above
/// it what the slopes are divided by is right to 2⁻²⁴, as are the depths.
const FLAT: f64 = 1.0 / (1u64 << 28) as f64;

/// By how much a fragment may be nearer than the point of its primitive that is drawn there, relative to that
/// point's depth: whoever bounds fragments by the geometry allows for it. The tilt of planes, and what
/// rounding may add.
pub const DEPTH_SLACK: f64 = DEPTH_TILT + ROUNDED;
/// Half of it is for [`lowered`], the rest for corners, sums and bounds in f32.
const ROUNDED: f64 = 1.0 / (1 << 17) as f64;
/// Bound on the rounding of a depth over the sum of the changes along x and y that it is made of: slopes, the
/// area, products and sums are rounded by 2⁻²⁴ each, once a term.
const ROUNDING: f64 = 1.0 / (1 << 22) as f64;
/// The same of slopes before they are f32, over the terms of Cramer's rule.
const SLOPE_ROUNDING: f64 = 1.0 / (1u64 << 50) as f64;

/// By how much a plane is to be lowered so that no fragment comes nearer than the triangle, by more than half
/// of [`ROUNDED`]: mostly by nothing. `ways` and `rise`: from the farthest vertex to the others.
///
/// In a sliver seen edge-on the changes along x and y are large and cancel, and what is left is rounding.
/// Fragments are means of the vertices, the rounding of a mean is at most the mean of theirs, and a plane
/// that is too low is clamped to the farthest vertex.
#[inline(always)]
fn lowered([dx, dy]: [f64; 2], [p, q]: [[f64; 2]; 2], rise: [f64; 2], low: f64, per_area: f64) -> f64 {
    let cramer = rise[0].max(rise[1])
        * (p[0].abs() + q[0].abs())
        * (p[1].abs() + q[1].abs())
        * per_area.abs()
        * SLOPE_ROUNDING;
    let error = |v: [f64; 2]| ((dx * v[0]).abs() + (dy * v[1]).abs()) * ROUNDING + cramer;
    let (a, b) = (error(p), error(q));
    let is_small = |error: f64, rise: f64| error <= (low + rise) * ROUNDED * 0.5;
    if is_small(a, rise[0]) && is_small(b, rise[1]) { 0.0 } else { a + b }
}

impl Plane {
    /// The plane through three vertices whose places on the grid span an area.
    #[inline(always)]
    pub fn of(v: [&Vertex; 3]) -> Self {
        let [a, b, c] = v;
        // From the farthest vertex; all three orders turn the same way.
        let (o, p, q) = if is_farther(c, a) && is_farther(c, b) {
            (c, a, b)
        } else if is_farther(b, a) {
            (b, c, a)
        } else {
            (a, b, c)
        };
        let low = f64::from(o.z);
        let rise = [f64::from(p.z) - low, f64::from(q.z) - low];
        let ways = [unsnapped(o, p), unsnapped(o, q)];
        let (slope, per_area, is_clear) = slopes(ways, rise);
        if is_clear && is_gentle(slope, o.z) {
            // Pixels measure from the snapped vertex, where the plane has another depth than at its place.
            let rest = o.rest();
            let z = (low - slope[0] * rest[0]) - slope[1] * rest[1];
            let z = z - lowered(slope, ways, rise, low, per_area);
            return Self::new(o, z as f32, slope, p.z.max(q.z));
        }
        let ways = [snapped(o, p), snapped(o, q)];
        let (slope, per_area, _) = slopes(ways, rise);
        let z = low - lowered(slope, ways, rise, low, per_area);
        Self::new(o, z as f32, slope, p.z.max(q.z))
    }
    /// The plane of a flatland segment between vertices of different columns; the same, one dimension down.
    pub fn of_segment(a: Vertex, b: Vertex) -> Self {
        let (o, p) = if is_farther(&b, &a) { (b, a) } else { (a, b) };
        let rise = f64::from(p.z) - f64::from(o.z);
        let slope = [rise / unsnapped(&o, &p)[0], 0.0];
        if is_gentle(slope, o.z) {
            return Self::new(&o, (f64::from(o.z) - slope[0] * o.rest()[0]) as f32, slope, p.z);
        }
        Self::new(&o, o.z, [rise / snapped(&o, &p)[0], 0.0], p.z)
    }
    /// The plane with depth `z` at the snapped place of its farthest vertex.
    #[inline(always)]
    fn new(at: &Vertex, z: f32, slope: [f64; 2], high: f32) -> Self {
        let [dx, dy] = [slope[0] as f32, slope[1] as f32];
        // Without its slopes a plane has the depth of the farthest vertex: too far, so it hides nothing that
        // it should not.
        let usable = dx.abs().max(dy.abs()) < STEEPEST;
        Self {
            x: at.x,
            y: at.y,
            z,
            dx: if usable { dx } else { 0.0 },
            dy: if usable { dy } else { 0.0 },
            low: at.z,
            high,
        }
    }
    /// Depth at the start of row `y`: the part that does not depend on the column.
    #[inline(always)]
    pub fn at_row(&self, y: i32) -> f32 {
        self.z + self.dy * (center(y) - self.y) as f32
    }
}

/// Whether a vertex is farther than another; of equally far ones by their places, so that a plane does not
/// depend on which corner of its triangle comes first.
#[inline(always)]
fn is_farther(a: &Vertex, b: &Vertex) -> bool {
    a.z < b.z || a.z == b.z && (a.x, a.y, a.packed) < (b.x, b.y, b.packed)
}

/// From one vertex to another on the grid.
#[inline(always)]
fn snapped(from: &Vertex, to: &Vertex) -> [f64; 2] {
    [f64::from(to.x - from.x), f64::from(to.y - from.y)]
}

/// The same between the places before snapping: exact, for they are multiples of 2⁻¹⁰ steps below 2²⁴.
#[inline(always)]
fn unsnapped(from: &Vertex, to: &Vertex) -> [f64; 2] {
    let ([x, y], a, b) = (snapped(from, to), from.rest(), to.rest());
    [x + (b[0] - a[0]), y + (b[1] - a[1])]
}

/// Slopes of the plane that rises by two amounts on the ways to two places, one over twice the area that
/// these span, and whether that is clear.
#[inline(always)]
fn slopes([p, q]: [[f64; 2]; 2], rise: [f64; 2]) -> ([f64; 2], f64, bool) {
    // Cramer's rule in f64. Between snapped places products and area are exact.
    let (one, other) = (p[0] * q[1], p[1] * q[0]);
    let area = one - other;
    let per_area = 1.0 / area;
    let dx = (rise[0] * q[1] - rise[1] * p[1]) * per_area;
    let dy = (rise[1] * p[0] - rise[0] * q[0]) * per_area;
    ([dx, dy], per_area, area.abs() > FLAT * (one.abs() + other.abs()))
}

/// Whether half a grid step along each axis changes the depth by at most [`DEPTH_TILT`] of the least, so at
/// no corner by more.
#[inline(always)]
fn is_gentle(slope: [f64; 2], low: f32) -> bool {
    // Slopes without an area are not numbers, and gentle neither.
    (slope[0].abs() + slope[1].abs()) * 0.5 <= DEPTH_TILT * f64::from(low)
}

/// Grid coordinate of a pixel's center.
#[inline(always)]
pub(super) fn center(pixel: i32) -> i32 {
    (pixel << SUBPIXEL_BITS) + CENTER
}

/// The pixels `from..to` whose centers lie in the closed grid interval, half-open.
#[inline(always)]
pub(super) fn pixels(low: i32, high: i32, from: u32, to: u32) -> (i32, i32) {
    (
        // Center `k` lies at `256 k + 128`: the first at or after `low`, and one past the last at or before
        // `high`. Shifts round down below 0 too.
        ((low + CENTER - 1) >> SUBPIXEL_BITS).max(from as i32),
        (((high - CENTER) >> SUBPIXEL_BITS) + 1).min(to as i32),
    )
}

/// Least and greatest coordinate along each axis.
#[inline(always)]
fn span(v: [&Vertex; 3]) -> [(i32, i32); 2] {
    [
        (v[0].x.min(v[1].x).min(v[2].x), v[0].x.max(v[1].x).max(v[2].x)),
        (v[0].y.min(v[1].y).min(v[2].y), v[0].y.max(v[1].y).max(v[2].y)),
    ]
}

/// Twice the signed area; positive if clockwise on the screen (y down).
#[inline(always)]
pub(super) fn area(v: [&Vertex; 3]) -> i64 {
    let (ux, uy) = (i64::from(v[1].x - v[0].x), i64::from(v[1].y - v[0].y));
    let (vx, vy) = (i64::from(v[2].x - v[0].x), i64::from(v[2].y - v[0].y));
    ux * vy - uy * vx
}

/// An edge function over the pixel centers, divided by 256 and rounded down; the top-left rule is in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Its value at the first pixel of the triangle's box.
    pub at: i64,
    /// Its change per column.
    pub dx: i32,
    /// Its change per row.
    pub dy: i32,
}

impl Edge {
    /// The edge from `a` to `b` with the triangle on its right (y down), first pixel centered at `(x, y)`.
    #[inline(always)]
    fn new(a: &Vertex, b: &Vertex, x: i32, y: i32) -> Self {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        // A center on the edge belongs to the triangle to its right or below it.
        let top_left = dy < 0 || (dy == 0 && dx > 0);
        // The rule in one subtraction: for whole numbers `E > 0` is `E − 1 ≥ 0`, so a single comparison
        // serves all edges.
        let e =
            i64::from(dx) * i64::from(y - a.y) - i64::from(dy) * i64::from(x - a.x) - i64::from(!top_left);
        Self { at: e >> SUBPIXEL_BITS, dx: -dy, dy: dx }
    }
    /// One over the size of the change per column; infinite for a horizontal edge.
    #[inline(always)]
    pub fn inverse(&self) -> f64 {
        1.0 / f64::from(self.dx.abs())
    }
}

/// A triangle ready to be filled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setup {
    /// First column and row, and the ones past the last.
    pub x0: i32,
    pub x1: i32,
    pub y0: i32,
    pub y1: i32,
    /// Its edge functions; a center is covered where none is negative.
    pub edges: [Edge; 3],
    /// Whether the edge functions fit 32 bits all over the triangle's box.
    pub narrow: bool,
    /// Whether it is the whole primitive, not a part that clipping left.
    pub whole: bool,
    pub plane: Plane,
    pub id: u32,
}

/// A triangle whose box is at most this wide and high, in grid steps, has edge functions that fit 32 bits:
/// 2 · 2¹⁸ · 2¹⁸ / 2⁸ = 2²⁹ in the box, and the lanes of a vector past its end add less than 2²².
const NARROW: i32 = 1024 << SUBPIXEL_BITS;

impl Setup {
    /// The pixels of its box.
    #[inline(always)]
    pub fn rect(&self) -> PixelRect {
        PixelRect { x0: self.x0 as u32, x1: self.x1 as u32, y0: self.y0 as u32, y1: self.y1 as u32 }
    }
    /// The pixels of a window in a triangle's box; `None` if it covers no center there.
    #[inline(always)]
    pub fn bounds(v: [&Vertex; 3], window: &PixelRect) -> Option<PixelRect> {
        let [(low_x, high_x), (low_y, high_y)] = span(v);
        let (x0, x1) = pixels(low_x, high_x, window.x0, window.x1);
        let (y0, y1) = pixels(low_y, high_y, window.y0, window.y1);
        // Most small triangles of a dense model fall between centers and end here.
        if x0 >= x1 || y0 >= y1 || area(v) == 0 {
            return None;
        }
        Some(PixelRect { x0: x0 as u32, x1: x1 as u32, y0: y0 as u32, y1: y1 as u32 })
    }
    /// The part of a triangle in a block of pixels, with which it shares some of its box; `None` if an edge
    /// leaves all of them out.
    #[inline(always)]
    pub fn within(&self, block: &PixelRect) -> Option<Self> {
        let mut part = *self;
        (part.x0, part.x1) = (self.x0.max(block.x0 as i32), self.x1.min(block.x1 as i32));
        (part.y0, part.y1) = (self.y0.max(block.y0 as i32), self.y1.min(block.y1 as i32));
        let (right, down) = (i64::from(part.x0 - self.x0), i64::from(part.y0 - self.y0));
        let (wide, high) = (i64::from(part.x1 - part.x0 - 1), i64::from(part.y1 - part.y0 - 1));
        let mut signs = 0;
        for edge in &mut part.edges {
            let (dx, dy) = (i64::from(edge.dx), i64::from(edge.dy));
            edge.at += dx * right + dy * down;
            // Its value at the corner where it is greatest.
            signs |= edge.at + (dx * wide).max(0) + (dy * high).max(0);
        }
        (signs >= 0).then_some(part)
    }
    /// Makes a triangle ready for the pixels of a window; `None` if it covers no center there.
    #[inline(always)]
    pub fn new(v: [&Vertex; 3], id: u32, whole: bool, window: &PixelRect) -> Option<Self> {
        let PixelRect { x0, x1, y0, y1 } = Self::bounds(v, window)?;
        let (x0, x1, y0, y1) = (x0 as i32, x1 as i32, y0 as i32, y1 as i32);
        let plane = Plane::of(v);
        // Turned to run clockwise on the screen, so that the inside of every edge is positive.
        let [a, b, c] = if area(v) > 0 { v } else { [v[0], v[2], v[1]] };
        let (x, y) = (center(x0), center(y0));
        let edges = [Edge::new(a, b, x, y), Edge::new(b, c, x, y), Edge::new(c, a, x, y)];
        let narrow = span(v).iter().all(|(low, high)| high - low <= NARROW);
        Some(Self { x0, x1, y0, y1, edges, narrow, whole, plane, id })
    }
}
