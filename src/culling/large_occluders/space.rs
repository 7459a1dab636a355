//! What differs between flatland and space: edges, the planes through them, and tangent vertices.
//!
//! Everything here is in f64 on coordinates that were f32, so a difference of two coordinates is exact
//! (unless one is 2²⁹ times the other) and a product of two differences is nearly so.

use std::fmt::Debug;
use std::ops::{Add, Mul, Neg, Sub};

use crate::geometry::{Aabb, Space, Vector};
use crate::scene::{Face, Progress, Scene, Surfaces};

mod flat;
mod solid;

pub use solid::{outline_seen_from, sides_of_outline};

/// A point or direction in f64.
pub trait Point:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
{
    // Only what both spaces need, so that all else in the method is written once.
    fn dot(self, other: Self) -> f64;
    fn get(self, axis: usize) -> f64;
    fn length(self) -> f64 {
        self.dot(self).sqrt()
    }
}

/// An edge of an occluder: two corners of a polygon in space, one end of a segment in flatland.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Edge<P> {
    /// Where it begins: an anchor that every plane through it contains.
    pub from: P,
    /// To its other corner; in flatland along x, as long as the segment, and positive at its first end only.
    pub along: P,
}

/// Arithmetic of a space. A plane through an edge and a vertex is a line through an end and a vertex in
/// flatland.
pub trait Shape: Space {
    type Point: Point;
    // Into f64 and back: the tests compute in f64 alone, pictures are in f32.
    /// Exact.
    fn widened(v: Self::Vector) -> Self::Point;
    /// Rounded, for drawing.
    fn rounded(p: Self::Point) -> Self::Vector;
    // What makes a polygon an occluder, once per scene.
    /// The live primitives as convex polygons; `None` when cancelled.
    fn polygons(scene: &Scene<Self>, surfaces: Surfaces, progress: &dyn Progress) -> Option<Vec<Face>>;
    /// Vector area: along the normal, as long as the area (in flatland: the length).
    fn area(corners: &[Self::Point]) -> Self::Point;
    /// Edge `i` of the polygon.
    fn edge(corners: &[Self::Point], i: usize) -> Edge<Self::Point>;
    /// The corners that two polygons must share to share edge `i`, the lesser first; and whether the edge
    /// runs from the lesser to the greater as seen from the front (in flatland: whether it is the first end).
    fn edge_key(corners: &[u32], i: usize) -> ([u32; 2], bool);
    // What a test of Section 2 needs of each edge.
    /// A normal, not of unit length, of the plane through an edge and the vertex at `arm` from `edge.from`.
    /// For an eye at `r` from `edge.from` in front of the occluder, `normal · r > 0` says that the vertex
    /// lies on the occluder's side of the plane through eye and edge.
    fn through(edge: &Edge<Self::Point>, arm: Self::Point) -> Self::Point;
    /// Distance of the point at `r` from `edge.from` from the edge's line.
    fn distance(edge: &Edge<Self::Point>, r: Self::Point) -> f64;
    // Section 2.1: the table and the plain way must agree, which the tests hold them to.
    /// The two corners of a box at which planes through the edge touch it, by table (Section 2.1); `None`
    /// where the edge's line meets the box.
    fn tangents(edge: &Edge<Self::Point>, bounds: &Aabb<Self::Vector>) -> Option<[u8; 2]>;
    /// The same by looking at every corner: the reference and the peer of the benchmark.
    fn tangents_naive(edge: &Edge<Self::Point>, bounds: &Aabb<Self::Vector>) -> Option<[u8; 2]>;
}

/// Corner `i` of a box, widened.
#[inline]
pub fn corner<S: Shape>(bounds: &Aabb<S::Vector>, i: u8) -> S::Point {
    S::widened(bounds.corner(i as usize))
}

/// The corners of a polygon.
pub fn corners_of<S: Shape>(points: &[S::Vector], ids: &[u32]) -> Vec<S::Point> {
    ids.iter().map(|&c| S::widened(points[c as usize])).collect()
}

/// The axis code of a coordinate against an interval: below, inside or above.
#[inline]
fn slab(v: f64, min: f64, max: f64) -> usize {
    // On the border counts as inside: a face seen edge-on bounds no silhouette.
    usize::from(v >= min) + usize::from(v > max)
}

/// Component of a box corner without making the whole corner.
#[inline]
fn side<V: Vector>(bounds: &Aabb<V>, corner: u8, axis: usize) -> f64 {
    // Bit `axis` of a corner says whether it lies at the far end, as in [`Aabb::corner`].
    f64::from(if corner >> axis & 1 == 1 { bounds.max.get(axis) } else { bounds.min.get(axis) })
}
