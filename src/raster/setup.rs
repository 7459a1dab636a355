//! A triangle made ready for pixels: its box, its edge functions, its depth plane.
//!
//! Pinned-down arithmetic (Pineda 1988, <https://doi.org/10.1145/378456.378457>): with pixel centers a whole
//! 256 grid steps apart an edge function changes by multiples of 256 from center to center, so its low 8 bits
//! never matter and `E >> 8` has the sign of `E` at every center and steps by the edge itself.
//!
//! In the order of cost: the box drops triangles between pixel centers, the area drops flat ones, then come
//! the plane and the three edges.

use super::vertex::{CENTER, SUBPIXEL_BITS, Vertex};
use crate::geometry::PixelRect;

/// Depth over the image: `1/w` is linear there. Grid steps; larger is nearer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Where the depth is `z`: the farthest vertex, so that distant pixels lose nothing to near ones.
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

impl Plane {
    /// The plane through three vertices with twice the signed area `area`, not zero.
    #[inline(always)]
    pub fn of(v: [&Vertex; 3], area: i64) -> Self {
        let [a, b, c] = v;
        // From the farthest vertex; all three orders turn the same way, so `area` keeps its sign.
        let (o, p, q) = if c.z < a.z.min(b.z) {
            (c, a, b)
        } else if b.z < a.z {
            (b, c, a)
        } else {
            (a, b, c)
        };
        // Cramer's rule for the two slopes, in f64, where coordinates and the area are exact.
        let (pz, qz) = (f64::from(p.z) - f64::from(o.z), f64::from(q.z) - f64::from(o.z));
        let per_area = 1.0 / area as f64;
        let dx = (pz * f64::from(q.y - o.y) - qz * f64::from(p.y - o.y)) * per_area;
        let dy = (qz * f64::from(p.x - o.x) - pz * f64::from(q.x - o.x)) * per_area;
        Self::new(*o, dx as f32, dy as f32, o.z, p.z.max(q.z))
    }
    /// The plane of a flatland segment between vertices of different columns.
    pub fn of_segment(a: Vertex, b: Vertex) -> Self {
        let (o, p) = if b.z < a.z { (b, a) } else { (a, b) };
        let dx = (f64::from(p.z) - f64::from(o.z)) / f64::from(p.x - o.x);
        Self::new(o, dx as f32, 0.0, o.z, p.z)
    }
    #[inline(always)]
    fn new(at: Vertex, dx: f32, dy: f32, low: f32, high: f32) -> Self {
        // Without its slopes a plane has the depth of the farthest vertex: too far, so it hides nothing that
        // it should not.
        let usable = dx.abs().max(dy.abs()) < STEEPEST;
        Self {
            x: at.x,
            y: at.y,
            z: at.z,
            dx: if usable { dx } else { 0.0 },
            dy: if usable { dy } else { 0.0 },
            low,
            high,
        }
    }
    /// Depth at the start of row `y`: the part that does not depend on the column.
    #[inline(always)]
    pub fn at_row(&self, y: i32) -> f32 {
        self.z + self.dy * (center(y) - self.y) as f32
    }
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
    /// Makes a triangle ready for the pixels of a window; `None` if it covers no center there.
    #[inline(always)]
    pub fn new(v: [&Vertex; 3], id: u32, whole: bool, window: &PixelRect) -> Option<Self> {
        let (low_x, high_x) = (v[0].x.min(v[1].x).min(v[2].x), v[0].x.max(v[1].x).max(v[2].x));
        let (low_y, high_y) = (v[0].y.min(v[1].y).min(v[2].y), v[0].y.max(v[1].y).max(v[2].y));
        let (x0, x1) = pixels(low_x, high_x, window.x0, window.x1);
        let (y0, y1) = pixels(low_y, high_y, window.y0, window.y1);
        // Most small triangles of a dense model fall between centers and end here.
        if x0 >= x1 || y0 >= y1 {
            return None;
        }
        let area = area(v);
        if area == 0 {
            return None;
        }
        let plane = Plane::of(v, area);
        // Turned to run clockwise on the screen, so that the inside of every edge is positive.
        let [a, b, c] = if area > 0 { v } else { [v[0], v[2], v[1]] };
        let (x, y) = (center(x0), center(y0));
        let edges = [Edge::new(a, b, x, y), Edge::new(b, c, x, y), Edge::new(c, a, x, y)];
        let narrow = high_x - low_x <= NARROW && high_y - low_y <= NARROW;
        Some(Self { x0, x1, y0, y1, edges, narrow, whole, plane, id })
    }
}
