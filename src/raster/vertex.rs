//! From world points to the pixel grid: projection, snapping, clipping.
//!
//! Projection runs in f64 on the f32 rows of the view's [`Projection`](crate::geometry::Projection),
//! relative to the eye, so it is exact to about 2⁻⁵⁰ and the snap to 1/256 pixel is the one error that
//! counts. What the snap takes is kept, in parts of 2⁻¹⁸ pixel: corners are moved for coverage alone, and
//! depth planes go through the places where they were. Clipping (near plane and guard band) also runs in f64,
//! in clip space, and cuts an edge from its lesser end whichever triangle it belongs to, so that neighbors
//! keep sharing their edges.

use crate::geometry::{Space, Vector, View};

/// Grid steps in a pixel, as a shift.
pub(super) const SUBPIXEL_BITS: i32 = 8;
/// Grid steps from a pixel's corner to its center.
pub(super) const CENTER: i32 = 1 << (SUBPIXEL_BITS - 1);
/// Half the side of the guard band about the middle of the image, grid steps: 16384 pixels. Inside it
/// coordinate differences stay below 2²³, exact in f32, and edge functions below 2⁴⁸.
pub(super) const GUARD: f64 = 16384.0 * (1 << SUBPIXEL_BITS) as f64;

/// A point in clip space: x, y, w. Flatland has y = 0.
pub(super) type Clip = [f64; 3];

/// Parts of a grid step that the place before snapping is kept to: 2⁻¹⁸ pixel.
const REST_PARTS: f64 = 1024.0;
/// Bits of each of the two rests, which lie within ±512.
const REST_BITS: i32 = 12;

/// A vertex on the pixel grid. Sixteen bytes, so that loops over points store whole vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub(super) struct Vertex {
    /// Column, grid steps.
    pub x: i32,
    /// Row, grid steps, down.
    pub y: i32,
    /// 1/w.
    pub z: f32,
    /// From the low end: which planes it lies outside of, the rest of the column, that of the row.
    pub packed: u32,
}

impl Vertex {
    #[inline(always)]
    fn new(at: [f64; 2], z: f32, outside: u32) -> Self {
        let (x, rest_x) = snap(at[0]);
        let (y, rest_y) = snap(at[1]);
        let rests = (rest_x as u32 & ((1 << REST_BITS) - 1)) << (32 - 2 * REST_BITS)
            | (rest_y as u32) << (32 - REST_BITS);
        Self { x, y, z, packed: rests | outside }
    }
    /// Which planes it lies outside of: a bit each, below.
    #[inline(always)]
    pub fn outside(&self) -> u32 {
        self.packed & ((1 << (32 - 2 * REST_BITS)) - 1)
    }
    /// Where its place before snapping lies from `(x, y)`: within half a grid step an axis.
    #[inline(always)]
    pub fn rest(&self) -> [f64; 2] {
        // Shifts to the upper end and back bring the signs along.
        let (x, y) =
            ((self.packed << REST_BITS) as i32 >> (32 - REST_BITS), self.packed as i32 >> (32 - REST_BITS));
        [f64::from(x) * (1.0 / REST_PARTS), f64::from(y) * (1.0 / REST_PARTS)]
    }
}

/// Nearer than the near plane: has no place on the grid.
const NEAR: u32 = 1 << 5;
/// Off the guard band: has no place on the grid.
const OFF_GRID: u32 = 1 << 6;
/// A vertex with one of these needs its triangle clipped.
pub(super) const NEEDS_CLIP: u32 = NEAR | OFF_GRID;
/// A triangle whose vertices share one of these is out of view.
pub(super) const REJECTS: u32 = OFF_GRID - 1;

/// The view's projection to the pixel grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Camera {
    pub eye: [f64; 3],
    /// Rows of x, y and w of clip space.
    pub rows: [[f64; 3]; 3],
    /// Middle of the image, grid steps.
    pub middle: [f64; 2],
    pub near: f64,
    /// Depth of the far plane.
    pub depth_far: f32,
}

impl Camera {
    pub fn new<S: Space>(view: &View<S>) -> Self {
        let projection = view.projection();
        let axes = S::Vector::AXES;
        let widen = |v: S::Vector| std::array::from_fn(|a| if a < axes { f64::from(v.get(a)) } else { 0.0 });
        let mut rows = [[0.0; 3]; 3];
        // Flatland has no y row: it stays 0, and every point lies in the middle of the one row of pixels.
        for (row, &from) in rows.iter_mut().zip(&projection.rows[..axes - 1]) {
            *row = widen(from);
        }
        rows[2] = widen(projection.rows[axes - 1]);
        let half = |pixels: u32| f64::from(pixels) * f64::from(CENTER);
        Self {
            eye: widen(projection.eye),
            rows,
            middle: [half(view.width), half(view.height)],
            near: f64::from(view.eye.near),
            depth_far: 1.0 / view.eye.far,
        }
    }

    /// Clip coordinates of a world point.
    #[inline(always)]
    pub fn clip<V: Vector>(&self, point: V) -> Clip {
        // Written out: a closure would not be compiled for the caller's instruction set.
        let z = if V::AXES == 3 { f64::from(point.get(2)) - self.eye[2] } else { 0.0 };
        let r = [f64::from(point.get(0)) - self.eye[0], f64::from(point.get(1)) - self.eye[1], z];
        [dot(self.rows[0], r), dot(self.rows[1], r), dot(self.rows[2], r)]
    }

    /// The vertex of a point in clip space.
    #[inline(always)]
    pub fn vertex(&self, clip: Clip) -> Vertex {
        let [x, y, w] = clip;
        // Without branches, so that loops over points become SIMD: places of points that have none are
        // computed too, and dropped below.
        let (at, z) = self.place(clip);
        let near = w < self.near;
        let off_grid = !near & ((at[0] - self.middle[0]).abs().max((at[1] - self.middle[1]).abs()) > GUARD);
        // By the rounded depth that pixels compare: a triangle whose corners all lie beyond wins no pixel.
        let beyond_far = !near & (z < self.depth_far);
        // Each bit is a half-space of clip space, which holds for points behind the eye too.
        let sides =
            u32::from(x < -w) | u32::from(x > w) << 1 | u32::from(y < -w) << 2 | u32::from(y > w) << 3;
        let outside = sides | u32::from(beyond_far) << 4 | u32::from(near) << 5 | u32::from(off_grid) << 6;
        let on_grid = outside & NEEDS_CLIP == 0;
        Vertex::new([if on_grid { at[0] } else { 0.0 }, if on_grid { at[1] } else { 0.0 }], z, outside)
    }

    /// Grid coordinates before snapping, and depth.
    #[inline(always)]
    fn place(&self, [x, y, w]: Clip) -> ([f64; 2], f32) {
        let inverse = 1.0 / w;
        // y points down on the grid.
        let at =
            [self.middle[0] + x * inverse * self.middle[0], self.middle[1] - y * inverse * self.middle[1]];
        // 1/w of a near plane below 3e-39 would be infinite.
        (at, (inverse as f32).min(f32::MAX))
    }

    /// The part of a convex polygon (or of a segment) that is beyond the near plane and on the guard
    /// band, in order; fewer corners than before may be left, or none.
    pub fn clipped(&self, corners: &[Clip]) -> Polygon {
        let mut polygon = Polygon::default();
        corners.iter().for_each(|&c| polygon.push(c));
        // `|x / w| · middle ≤ GUARD` without the division.
        let [gx, gy] = self.middle.map(|m| GUARD / m);
        // Inside is plane·(x, y, w) ≥ offset. The near plane comes first: beyond it `w` is positive.
        let planes = [
            ([0.0, 0.0, 1.0], self.near),
            ([1.0, 0.0, gx], 0.0),
            ([-1.0, 0.0, gx], 0.0),
            ([0.0, 1.0, gy], 0.0),
            ([0.0, -1.0, gy], 0.0),
        ];
        for (plane, offset) in planes {
            let distance = |c: &Clip| (plane[0] * c[0] + plane[1] * c[1]) + plane[2] * c[2] - offset;
            // Most polygons cross one or two of the planes.
            if polygon.corners().iter().any(|c| distance(c) < 0.0) {
                polygon = polygon.cut(distance);
            }
        }
        polygon
    }

    /// The vertex of a corner of a clipped polygon.
    pub fn clipped_vertex(&self, corner: Clip) -> Vertex {
        let (at, z) = self.place(corner);
        Vertex::new(at, z, 0)
    }
}

/// A convex polygon in clip space: a triangle cut by five planes has at most eight corners.
#[derive(Clone, Copy, Default)]
pub(super) struct Polygon {
    corners: [Clip; 8],
    count: usize,
}

impl Polygon {
    pub fn corners(&self) -> &[Clip] {
        &self.corners[..self.count]
    }
    fn push(&mut self, corner: Clip) {
        // Rounding can make a sliver seem concave; a ninth corner would then be a repetition.
        if self.count < self.corners.len() {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }
    fn cut(&self, distance: impl Fn(&Clip) -> f64) -> Self {
        // Sutherland and Hodgman 1974: corners inside are kept, and each edge that changes sides adds its
        // crossing.
        let mut kept = Self::default();
        // A segment has one edge, a polygon closes.
        let edges = if self.count == 2 { 1 } else { self.count };
        for i in 0..self.count {
            let (a, b) = (self.corners[i], self.corners[(i + 1) % self.count]);
            let (da, db) = (distance(&a), distance(&b));
            if da >= 0.0 {
                kept.push(a);
            }
            if i < edges && (da >= 0.0) != (db >= 0.0) {
                kept.push(crossing(a, b, da, db));
            }
        }
        kept
    }
}

/// Where the edge between `a` and `b` crosses the plane at signed distances `da` and `db`, computed
/// from the lesser end, so that both triangles of an edge find the same point.
fn crossing(a: Clip, b: Clip, da: f64, db: f64) -> Clip {
    // Two triangles run along their common edge in opposite directions, and rounding depends on the
    // direction.
    let ((a, da), (b, db)) = if a <= b { ((a, da), (b, db)) } else { ((b, db), (a, da)) };
    let t = da / (da - db);
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

/// A coordinate on the grid and what the snap took from it, in parts of a step. Both to nearest, ties to
/// even, for |v| < 2⁵⁰.
#[inline(always)]
fn snap(v: f64) -> (i32, i32) {
    // At 1.5 · 2⁵² neighbors of f64 are 1 apart: the sum rounds, and its low bits are the integer, negative
    // ones in two's complement.
    const ONES: f64 = (3u64 << 51) as f64;
    let sum = v + ONES;
    // Both differences are exact, so the rest is a function of the place alone.
    let rest = (v - (sum - ONES)) * REST_PARTS;
    (sum.to_bits() as i32, (rest + ONES).to_bits() as i32)
}
