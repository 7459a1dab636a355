//! What differs between the spaces: primitives seen along an axis, and what a cube costs to draw.

use crate::culling::depth::Faces;
use crate::geometry::{Aabb, Flat, Solid};
use crate::index::tessellation::Cellular;

/// A space in which cells are seen along its axes.
pub trait Projected: Cellular + Faces {
    /// What the faces of a cube cost that can face the eye, in primitives.
    const CUBE_COST: u32;
    /// Samples of a face that has so many along a side.
    fn sample_count(side: u32) -> usize;
    /// What a primitive covers of a face of a cell, clipped to it, seen along an axis; `None` if that has no
    /// area.
    fn outline(corners: &[Self::Vector], cell: &Aabb<Self::Vector>, axis: usize) -> Option<Outline>;
    /// Calls `visit` with each sample of a face of a cell that a primitive covers, seen along an axis, and
    /// how far it is above the lower face there: 0 to the cell's size.
    fn cover(
        corners: &[Self::Vector],
        cell: &Aabb<Self::Vector>,
        axis: usize,
        side: u32,
        visit: &mut dyn FnMut(usize, f64),
    );
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

/// The samples of a row of `side` over a face of this size whose centers can lie in a span from its lower
/// end.
fn samples_in([low, high]: [f64; 2], size: f64, side: u32) -> std::ops::Range<u32> {
    let at = |v: f64| (v / size * f64::from(side) - 0.5).clamp(-1.0, f64::from(side));
    // One more on each side, for the rounding: the centers themselves decide.
    (at(low).floor().max(0.0) as u32)..(at(high).ceil() + 1.0).min(f64::from(side)) as u32
}

impl Projected for Flat {
    // Two edges, a segment each.
    const CUBE_COST: u32 = 2;
    fn sample_count(side: u32) -> usize {
        side as usize
    }
    fn outline(corners: &[glam::Vec2], cell: &Aabb<glam::Vec2>, axis: usize) -> Option<Outline> {
        let (origin, size) = (cell.min.as_dvec2(), cell.size().as_dvec2());
        let place = |k: usize| {
            let p = (corners[k].as_dvec2() - origin) / size;
            [p[1 - axis], p[axis]]
        };
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
    fn cover(
        corners: &[glam::Vec2],
        cell: &Aabb<glam::Vec2>,
        axis: usize,
        side: u32,
        visit: &mut dyn FnMut(usize, f64),
    ) {
        let across = 1 - axis;
        let (origin, size) = (cell.min.as_dvec2(), cell.size().as_dvec2());
        let [mut a, mut b] = [0, 1].map(|i| corners[i].as_dvec2() - origin);
        if a[across] > b[across] {
            std::mem::swap(&mut a, &mut b);
        }
        if size[across] <= 0.0 {
            return;
        }
        for at in samples_in([a[across], b[across]], size[across], side) {
            let place = (f64::from(at) + 0.5) / f64::from(side) * size[across];
            // Its lower end belongs to a segment, its upper end to the next one.
            if place < a[across] || place >= b[across] {
                continue;
            }
            let share = (place - a[across]) / (b[across] - a[across]);
            let height = a[axis] + share * (b[axis] - a[axis]);
            if (0.0..=size[axis]).contains(&height) {
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
    fn outline(corners: &[glam::Vec3], cell: &Aabb<glam::Vec3>, axis: usize) -> Option<Outline> {
        let (origin, size) = (cell.min.as_dvec3(), cell.size().as_dvec3());
        // Along both axes of the face, and above it.
        let p = [0, 1, 2].map(|k| {
            let p = (corners[k].as_dvec3() - origin) / size;
            glam::DVec3::new(p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis])
        });
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
    fn cover(
        corners: &[glam::Vec3],
        cell: &Aabb<glam::Vec3>,
        axis: usize,
        side: u32,
        visit: &mut dyn FnMut(usize, f64),
    ) {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (origin, size) = (cell.min.as_dvec3(), cell.size().as_dvec3());
        let mut p = [0, 1, 2].map(|i| corners[i].as_dvec3() - origin);
        let cross = |a: glam::DVec3, b: glam::DVec3, at: [f64; 2]| {
            (b[u] - a[u]) * (at[1] - a[v]) - (b[v] - a[v]) * (at[0] - a[u])
        };
        let mut area = cross(p[0], p[1], [p[2][u], p[2][v]]);
        if area < 0.0 {
            p.swap(1, 2);
            area = -area;
        }
        // Seen edge-on it covers nothing: so surfaces tear that are seen from between the axes (Section 5.1).
        if area == 0.0 || size.min_element() <= 0.0 {
            return;
        }
        // Left and top edges of a counter-clockwise triangle belong to it, as the rasterizer has it.
        let owns = |a: glam::DVec3, b: glam::DVec3| b[v] < a[v] || (b[v] == a[v] && b[u] < a[u]);
        let edges = [(p[1], p[2]), (p[2], p[0]), (p[0], p[1])];
        let span = |axis: usize| {
            let values = p.map(|p| p[axis]);
            [values[0].min(values[1]).min(values[2]), values[0].max(values[1]).max(values[2])]
        };
        let center = |at: u32, axis: usize| (f64::from(at) + 0.5) / f64::from(side) * size[axis];
        let columns = samples_in(span(u), size[u], side);
        for row in samples_in(span(v), size[v], side) {
            for column in columns.clone() {
                let at = [center(column, u), center(row, v)];
                let weights = edges.map(|(a, b)| cross(a, b, at));
                let covers =
                    (0..3).all(|k| weights[k] > 0.0 || weights[k] == 0.0 && owns(edges[k].0, edges[k].1));
                if !covers {
                    continue;
                }
                let height = (0..3).map(|k| weights[k] * p[k][axis]).sum::<f64>() / area;
                if (0.0..=size[axis]).contains(&height) {
                    visit((row * side + column) as usize, height);
                }
            }
        }
    }
}
