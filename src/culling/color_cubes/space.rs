//! What differs between the spaces: primitives seen along an axis, and what a cube costs to draw.

use std::ops::Range;

use crate::culling::depth::Faces;
use crate::geometry::{Aabb, Flat, PrimId, Solid, Space, Vector};
use crate::index::tessellation::Cellular;
use crate::scene::Scene;

/// Corners of a primitive from the lower end of a cell, in samples of its faces: 0 to as many as a side has.
/// In flatland the third corner and the third axis are not used.
pub type Corners = [[f64; 3]; 3];

/// A cell in samples of its faces.
pub struct Window {
    origin: [f64; 3],
    scale: [f64; 3],
}

impl Window {
    /// Of a cell whose faces have so many samples along a side.
    pub fn new<V: Vector>(cell: &Aabb<V>, side: u32) -> Self {
        let size = cell.size();
        let of = |a: usize, value: &dyn Fn(usize) -> f64| if a < V::AXES { value(a) } else { 0.0 };
        // What has no size is seen as nothing.
        let scale = |a: usize| if size.get(a) > 0.0 { f64::from(side) / f64::from(size.get(a)) } else { 0.0 };
        Self {
            origin: std::array::from_fn(|a| of(a, &|a| cell.min.get(a).into())),
            scale: std::array::from_fn(|a| of(a, &scale)),
        }
    }
    /// A primitive in it.
    #[inline]
    pub fn corners<S: Space>(&self, scene: &Scene<S>, prim: PrimId) -> Corners {
        let mut corners = [[0.0; 3]; 3];
        for (to, from) in corners.iter_mut().zip(scene.prim_points(prim)) {
            for (a, to) in to.iter_mut().enumerate().take(S::Vector::AXES) {
                *to = (f64::from(from.get(a)) - self.origin[a]) * self.scale[a];
            }
        }
        corners
    }
}

/// A space in which cells are seen along its axes.
pub trait Projected: Cellular + Faces {
    /// What the faces of a cube cost that can face the eye, in primitives.
    const CUBE_COST: u32;
    /// Samples of a face that has so many along a side.
    fn sample_count(side: u32) -> usize;
    /// What a primitive covers of a face of a cell, clipped to it, seen along an axis, with one sample a
    /// side; `None` if that has no area.
    fn outline(corners: &Corners, axis: usize) -> Option<Outline>;
    /// Calls `visit` with each sample of a face of a cell that a primitive covers, seen along an axis, and
    /// how far it is above the lower face there: 0 to `side`.
    fn cover(corners: &Corners, axis: usize, side: u32, visit: impl FnMut(usize, f64));
}

/// More than places are rounded by, in samples.
const SLACK: f64 = 1e-9;

/// The samples of a row of `side` whose centers can lie in a span: the centers themselves decide.
#[inline]
fn samples_in(low: f64, high: f64, side: u32) -> Range<u32> {
    let first = (low - 0.5 - SLACK).clamp(0.0, f64::from(side));
    let past = (high + 0.5 + SLACK).clamp(0.0, f64::from(side));
    // Rounded up and down by the conversion, which is no call.
    let up = first as u32 + u32::from(f64::from(first as u32) < first);
    up..past as u32
}

/// What a primitive covers of a face.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Corners of a convex polygon, counterclockwise, 0 to 1 along both axes of the face. In flatland the
    /// face is drawn out to a square.
    pub corners: Vec<[f64; 2]>,
    /// How far above the lower face it is there, in sizes of the cell: `a·x + b·y + c`.
    pub height: [f64; 3],
}

impl Projected for Flat {
    // Two edges, a segment each.
    const CUBE_COST: u32 = 2;
    fn sample_count(side: u32) -> usize {
        side as usize
    }
    fn outline(corners: &Corners, axis: usize) -> Option<Outline> {
        let place = |k: usize| [corners[k][1 - axis], corners[k][axis]];
        let (a, b) = (place(0), place(1));
        // The part of the segment that lies in the cell.
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for k in 0..2 {
            let along = b[k] - a[k];
            if along == 0.0 {
                if !(0.0..=1.0).contains(&a[k]) {
                    return None;
                }
                continue;
            }
            let ends = [-a[k] / along, (1.0 - a[k]) / along];
            (first, last) = (first.max(ends[0].min(ends[1])), last.min(ends[0].max(ends[1])));
        }
        let ends = [first, last].map(|t| a[0] + t * (b[0] - a[0]));
        let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        // No number is not less than another either.
        if !(first < last && low < high) {
            return None;
        }
        let slope = (b[1] - a[1]) / (b[0] - a[0]);
        let corners = vec![[low, 0.0], [high, 0.0], [high, 1.0], [low, 1.0]];
        Some(Outline { corners, height: [slope, 0.0, a[1] - slope * a[0]] })
    }
    fn cover(corners: &Corners, axis: usize, side: u32, mut visit: impl FnMut(usize, f64)) {
        let across = 1 - axis;
        let [mut a, mut b, _] = *corners;
        if a[across] > b[across] {
            std::mem::swap(&mut a, &mut b);
        }
        for at in samples_in(a[across], b[across], side) {
            let place = f64::from(at) + 0.5;
            // Its lower end belongs to a segment, its upper end to the next one.
            if place < a[across] || place >= b[across] {
                continue;
            }
            let share = (place - a[across]) / (b[across] - a[across]);
            let height = a[axis] + share * (b[axis] - a[axis]);
            if (0.0..=f64::from(side)).contains(&height) {
                visit(at as usize, height);
            }
        }
    }
}

impl Projected for Solid {
    // Three quads, two triangles each.
    const CUBE_COST: u32 = 6;
    fn sample_count(side: u32) -> usize {
        (side * side) as usize
    }
    fn outline(corners: &Corners, axis: usize) -> Option<Outline> {
        // Along both axes of the face, and above it.
        let p = corners.map(|p| glam::DVec3::new(p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis]));
        let normal = (p[1] - p[0]).cross(p[2] - p[0]);
        // Seen edge-on it covers nothing, and where a cell has no size there are no numbers.
        if !(normal.z != 0.0 && normal.is_finite()) {
            return None;
        }
        let (a, b) = (-normal.x / normal.z, -normal.y / normal.z);
        let mut inside = p.to_vec();
        for k in 0..3 {
            for (sign, offset) in [(1.0, 0.0), (-1.0, 1.0)] {
                // Sutherland and Hodgman 1974.
                let from = std::mem::take(&mut inside);
                for (at, point) in from.iter().enumerate() {
                    let next = from[(at + 1) % from.len()];
                    let [here, there] = [*point, next].map(|p| sign * p[k] + offset);
                    if here >= 0.0 {
                        inside.push(*point);
                    }
                    if (here < 0.0) != (there < 0.0) {
                        inside.push(*point + (next - *point) * (here / (here - there)));
                    }
                }
            }
        }
        let mut corners: Vec<[f64; 2]> = inside.iter().map(|p| [p.x, p.y]).collect();
        if normal.z < 0.0 {
            corners.reverse();
        }
        (corners.len() > 2).then_some(Outline { corners, height: [a, b, p[0].z - a * p[0].x - b * p[0].y] })
    }
    fn cover(corners: &Corners, axis: usize, side: u32, mut visit: impl FnMut(usize, f64)) {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let [a, mut b, mut c] = corners.map(|p| [p[u], p[v], p[axis]]);
        let mut area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area < 0.0 {
            std::mem::swap(&mut b, &mut c);
            area = -area;
        }
        // Seen edge-on it covers nothing: so surfaces tear that are seen from between the axes (Section 5.1).
        if area == 0.0 {
            return;
        }
        let columns = samples_in(a[0].min(b[0]).min(c[0]), a[0].max(b[0]).max(c[0]), side);
        let rows = samples_in(a[1].min(b[1]).min(c[1]), a[1].max(b[1]).max(c[1]), side);
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let edges = [(b, c), (c, a), (a, b)].map(|(from, to)| Edge::new(from, to));
        let top = f64::from(side);
        for row in rows {
            let y = f64::from(row) + 0.5;
            for column in columns.clone() {
                let x = f64::from(column) + 0.5;
                let weights = edges.map(|edge| edge.weight(x, y));
                if (0..3).any(|k| weights[k] < edges[k].least) {
                    continue;
                }
                let height = (weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2]) / area;
                if (0.0..=top).contains(&height) {
                    visit((row * side + column) as usize, height);
                }
            }
        }
    }
}

/// An edge of a counter-clockwise triangle.
#[derive(Clone, Copy)]
struct Edge {
    from: [f64; 3],
    along: [f64; 2],
    /// Left and top edges belong to a triangle, as the rasterizer has it: so much its weight is at least.
    least: f64,
}

impl Edge {
    #[inline]
    fn new(from: [f64; 3], to: [f64; 3]) -> Self {
        let owns = to[1] < from[1] || (to[1] == from[1] && to[0] < from[0]);
        let along = [to[0] - from[0], to[1] - from[1]];
        Self { from, along, least: if owns { 0.0 } else { f64::MIN_POSITIVE } }
    }
    /// Twice the area of the triangle from the edge to a place.
    #[inline]
    fn weight(&self, x: f64, y: f64) -> f64 {
        self.along[0] * (y - self.from[1]) - self.along[1] * (x - self.from[0])
    }
}
