//! Space: occluders are convex polygons. Tangent vertices come from the table of Section 2.1.
//!
//! 1. The edge's first corner is taken as the origin. Where it lies against the box's three slabs (below,
//!    inside, above) gives one of 27 codes, and with it the silhouette of the box: 4 or 6 corners in order
//!    (Figure 7).
//! 2. Seen from there the edge is a point. Its side of each directed silhouette line gives a code of up to 6
//!    bits, and a table maps the code to the two corners where tangents touch (Figure 8). A silhouette line
//!    spans the origin and an edge of the box along an axis, so its side is the sign of two products.

use glam::{DVec3, Vec3};

use super::{Edge, Point, Shape, corner, side, slab};
use crate::geometry::{Aabb, Solid};
use crate::scene::{Face, Progress, Scene, Surfaces};

impl Point for DVec3 {
    #[inline]
    fn dot(self, other: Self) -> f64 {
        self.dot(other)
    }
    #[inline]
    fn get(self, axis: usize) -> f64 {
        self[axis]
    }
}

impl Shape for Solid {
    type Point = DVec3;
    fn widened(v: Vec3) -> DVec3 {
        v.as_dvec3()
    }
    fn rounded(p: DVec3) -> Vec3 {
        p.as_vec3()
    }
    fn polygons(scene: &Scene<Self>, surfaces: Surfaces, progress: &dyn Progress) -> Option<Vec<Face>> {
        scene.convex_polygons(surfaces, progress)
    }
    fn area(corners: &[DVec3]) -> DVec3 {
        // A fan from the first corner: differences are exact, where products of the coordinates themselves
        // would cancel far from the origin.
        let origin = corners[0];
        corners.windows(2).map(|w| (w[0] - origin).cross(w[1] - origin)).sum::<DVec3>() * 0.5
    }
    fn edge(corners: &[DVec3], i: usize) -> Edge<DVec3> {
        let (from, to) = (corners[i], corners[(i + 1) % corners.len()]);
        Edge { from, along: to - from }
    }
    fn edge_key(corners: &[u32], i: usize) -> ([u32; 2], bool) {
        // Two polygons beside each other run along their edge in opposite senses: the pair names the edge,
        // the sense is told apart.
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        ([a.min(b), a.max(b)], a < b)
    }
    #[inline]
    fn through(edge: &Edge<DVec3>, arm: DVec3) -> DVec3 {
        edge.along.cross(arm)
    }
    #[inline]
    fn distance(edge: &Edge<DVec3>, r: DVec3) -> f64 {
        edge.along.cross(r).length() / edge.along.length()
    }
    #[inline]
    fn tangents(edge: &Edge<DVec3>, bounds: &Aabb<Vec3>) -> Option<[u8; 2]> {
        let silhouette = silhouette(edge.from, bounds);
        let bits = sides(silhouette, edge, bounds);
        match TOUCHING[usize::from(silhouette.count == 6)][bits] {
            // All signs alike: the edge, seen as a point, lies inside the outline, so its line meets the box.
            // Which sign it is depends on whether the edge runs toward the box or away from it.
            [NONE, _] if silhouette.count == 0 || bits == 0 || bits + 1 == 1 << silhouette.count => None,
            // Signs that no convex outline has: two lines so close that rounding swapped them.
            [NONE, _] => tangents_naive(edge, bounds),
            [i, j] => Some([silhouette.lines[i as usize].corner, silhouette.lines[j as usize].corner]),
        }
    }
    fn tangents_naive(edge: &Edge<DVec3>, bounds: &Aabb<Vec3>) -> Option<[u8; 2]> {
        tangents_naive(edge, bounds)
    }
}

/// The outline of a box as seen from a point, in order around it, as box corners (Figure 7); empty from
/// inside.
pub fn outline_seen_from(point: Vec3, bounds: &Aabb<Vec3>) -> Vec<u8> {
    let silhouette = silhouette(point.as_dvec3(), bounds);
    silhouette.lines[..silhouette.count].iter().map(|l| l.corner).collect()
}

/// The code of Figure 8: bit `i` says on which side of line `i` of the outline seen from `from` the edge's
/// projection lies.
pub fn sides_of_outline(from: Vec3, to: Vec3, bounds: &Aabb<Vec3>) -> u8 {
    let edge = Edge { from: from.as_dvec3(), along: (to - from).as_dvec3() };
    sides(silhouette(edge.from, bounds), &edge, bounds) as u8
}

#[inline]
fn silhouette(from: DVec3, bounds: &Aabb<Vec3>) -> &'static Silhouette {
    let code = |axis: usize| slab(from[axis], side(bounds, 0, axis), side(bounds, 7, axis));
    &SILHOUETTES[code(0) + 3 * code(1) + 9 * code(2)]
}

#[inline]
fn sides(silhouette: &Silhouette, edge: &Edge<DVec3>, bounds: &Aabb<Vec3>) -> usize {
    let mut bits = 0;
    for (i, line) in silhouette.lines[..silhouette.count].iter().enumerate() {
        let [b, c] = line.axes;
        let arm = |axis: usize| side(bounds, line.corner, axis) - edge.from[axis];
        // Exact differences and two rounded products: a wrong sign takes a near tie, which the bound
        // `ROUNDING` of a relation covers.
        bits |= usize::from((edge.along[b] * arm(c) > edge.along[c] * arm(b)) != line.flip) << i;
    }
    bits
}

/// A directed line of a silhouette: from `corner` along the one axis that is not in `axes`.
#[derive(Clone, Copy)]
struct Line {
    corner: u8,
    axes: [usize; 2],
    /// Whether it runs against its axis.
    flip: bool,
}

/// The outline of a box as seen from a point, in order around it.
#[derive(Clone, Copy)]
struct Silhouette {
    lines: [Line; 6],
    count: usize,
}

static SILHOUETTES: [Silhouette; 27] = silhouettes();

/// The silhouettes of Figure 7, by `x + 3·y + 9·z` where 0, 1, 2 say below, inside, above.
const fn silhouettes() -> [Silhouette; 27] {
    let mut all = [Silhouette { lines: [Line { corner: 0, axes: [0, 0], flip: false }; 6], count: 0 }; 27];
    let mut code = 0;
    while code < 27 {
        // 13 is 1 + 3 + 9, inside all three slabs: from there the box has no outline.
        if code != 13 {
            all[code] = outline([code % 3, code / 3 % 3, code / 9]);
        }
        code += 1;
    }
    all
}

/// Whether the face of the box on the far or near side of an axis is seen.
const fn sees(codes: [usize; 3], axis: usize, far: bool) -> bool {
    codes[axis] == if far { 2 } else { 0 }
}

/// Walks the edges that separate a face that is seen from one that is not, the seen one always on the same
/// hand.
const fn outline(codes: [usize; 3]) -> Silhouette {
    let mut all = Silhouette { lines: [Line { corner: 0, axes: [0, 0], flip: false }; 6], count: 0 };
    let mut at = 0u8;
    let start = loop {
        if next(codes, at).is_some() {
            break at;
        }
        at += 1;
    };
    at = start;
    while let Some(axis) = next(codes, at) {
        all.lines[all.count] =
            Line { corner: at, axes: [(axis + 1) % 3, (axis + 2) % 3], flip: at >> axis & 1 == 1 };
        all.count += 1;
        at ^= 1 << axis;
        // Closed after 4 edges where one face is seen, after 6 where two or three are.
        if at == start || all.count == 6 {
            break;
        }
    }
    all
}

/// The axis along which the outline goes on from a corner, if the corner is on it.
const fn next(codes: [usize; 3], corner: u8) -> Option<usize> {
    let mut axis = 0;
    while axis < 3 {
        // Looking along the step's direction, the one neighbor face is on the left and the other on the
        // right.
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let (far_b, far_c) = (corner >> b & 1 == 1, corner >> c & 1 == 1);
        let (seen_b, seen_c) = (sees(codes, b, far_b), sees(codes, c, far_c));
        let forward = corner >> axis & 1 == 0;
        // Turning from face b to face c about the axis is counter-clockwise if both are on the same side.
        let turn = (far_b == far_c) == forward;
        if seen_b != seen_c && seen_b == turn {
            return Some(axis);
        }
        axis += 1;
    }
    None
}

const NONE: u8 = u8::MAX;
/// Which lines of an outline begin where a tangent touches, by the signs of 4 or 6 lines: where the sign
/// changes.
static TOUCHING: [[[u8; 2]; 64]; 2] = [touching(4), touching(6)];

const fn touching(count: usize) -> [[u8; 2]; 64] {
    let mut all = [[NONE; 2]; 64];
    let mut bits = 0;
    while bits < 1 << count {
        let mut found = [NONE; 2];
        let mut changes = 0;
        let mut i = 0;
        while i < count {
            let before = bits >> ((i + count - 1) % count) & 1;
            if before != bits >> i & 1 {
                if changes < 2 {
                    found[changes] = i as u8;
                }
                changes += 1;
            }
            i += 1;
        }
        // A line through a convex outline changes sides twice. Other codes come from rounding and stay empty.
        if changes == 2 {
            all[bits] = found;
        }
        bits += 1;
    }
    all
}

/// See [`Shape::tangents_naive`]: a plane through the edge and a corner touches the box if all corners lie on
/// one side.
fn tangents_naive(edge: &Edge<DVec3>, bounds: &Aabb<Vec3>) -> Option<[u8; 2]> {
    let arms: [DVec3; 8] = std::array::from_fn(|i| corner::<Solid>(bounds, i as u8) - edge.from);
    let touches = |sign: f64| {
        (0..8u8).find(|&i| {
            let normal = edge.along.cross(arms[i as usize]) * sign;
            // A corner on the line itself spans no plane; one that the plane contains too may round to either
            // side.
            let slack = -1e-14 * normal.length();
            normal != DVec3::ZERO && arms.iter().all(|arm| normal.dot(*arm) >= slack * arm.length())
        })
    };
    Some([touches(1.0)?, touches(-1.0)?])
}
