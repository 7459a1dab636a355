//! Flatland: occluders are segments, their edges are end points, planes are lines.

use glam::{DVec2, Vec2};

use super::{Edge, Point, Shape, corner, side, slab};
use crate::geometry::{Aabb, Flat};
use crate::scene::{Face, Progress, Scene, Surfaces};

impl Point for DVec2 {
    #[inline]
    fn dot(self, other: Self) -> f64 {
        self.dot(other)
    }
    #[inline]
    fn get(self, axis: usize) -> f64 {
        self[axis]
    }
}

impl Shape for Flat {
    type Point = DVec2;
    fn widened(v: Vec2) -> DVec2 {
        v.as_dvec2()
    }
    fn rounded(p: DVec2) -> Vec2 {
        p.as_vec2()
    }
    fn polygons(scene: &Scene<Self>, surfaces: Surfaces, progress: &dyn Progress) -> Option<Vec<Face>> {
        scene.convex_polygons(surfaces, progress)
    }
    fn area(corners: &[DVec2]) -> DVec2 {
        // A quarter turn counter-clockwise, which keeps the length of the segment.
        (corners[1] - corners[0]).perp()
    }
    fn edge(corners: &[DVec2], i: usize) -> Edge<DVec2> {
        // The second end looks back, which flips the sign of its lines' normals.
        let (from, to) = (corners[i], corners[1 - i]);
        Edge { from, along: if i == 0 { DVec2::X } else { -DVec2::X } * (to - from).length() }
    }
    fn edge_key(corners: &[u32], i: usize) -> ([u32; 2], bool) {
        ([corners[i]; 2], i == 0)
    }
    #[inline]
    fn through(edge: &Edge<DVec2>, arm: DVec2) -> DVec2 {
        if edge.along.x > 0.0 { arm.perp() } else { -arm.perp() }
    }
    #[inline]
    fn distance(_: &Edge<DVec2>, r: DVec2) -> f64 {
        r.length()
    }
    #[inline]
    fn tangents(edge: &Edge<DVec2>, bounds: &Aabb<Vec2>) -> Option<[u8; 2]> {
        let code = |axis: usize| slab(edge.from[axis], side(bounds, 0, axis), side(bounds, 3, axis));
        TANGENTS[code(0) + 3 * code(1)]
    }
    fn tangents_naive(edge: &Edge<DVec2>, bounds: &Aabb<Vec2>) -> Option<[u8; 2]> {
        tangents_naive(edge, bounds)
    }
}

/// Tangent corners of a box by where a point lies against its two slabs, x first.
const TANGENTS: [Option<[u8; 2]>; 9] = [
    // Below the box: from the left, under it, from the right.
    Some([1, 2]),
    Some([0, 1]),
    Some([0, 3]),
    // Beside it.
    Some([0, 2]),
    // On or in the box every line through the point meets it.
    None,
    Some([1, 3]),
    // Above it.
    Some([0, 3]),
    Some([2, 3]),
    Some([1, 2]),
];

/// See [`Shape::tangents_naive`].
fn tangents_naive(edge: &Edge<DVec2>, bounds: &Aabb<Vec2>) -> Option<[u8; 2]> {
    let arms: [DVec2; 4] = std::array::from_fn(|i| corner::<Flat>(bounds, i as u8) - edge.from);
    let touches =
        |sign: f64| (0..4u8).find(|&i| arms.iter().all(|arm| sign * arms[i as usize].perp_dot(*arm) >= 0.0));
    Some([touches(1.0)?, touches(-1.0)?])
}
