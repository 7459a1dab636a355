//! Cutting a polygon into triangles, and finding out whether it is convex and planar.
//!
//! A convex one becomes the fan (0, i, i+1), any other is handed to ear clipping along the normal that
//! Newell's sum gives (Sutherland, Sproull and Schumacker 1974, appendix); signs are exact. Cost: O(n) for a
//! convex polygon; for others O(n²) with a small factor (ear clipping with a z-order curve: 10 ms for 5,000
//! corners, 5 to 9 s for 100,000).

use earcut::Earcut;
use glam::{DVec2, DVec3};

use crate::geometry::orient2d;

/// How a polygon was cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// Planar and convex: the fan, and worth keeping as a polygon.
    Convex,
    /// Convex as seen along its normal, yet bent: the fan.
    Bent,
    /// Concave, or its border crosses itself.
    Concave,
    /// All corners on a line or in a point.
    Flattened,
    /// Concave, of more than [`MAX_CONCAVE`] corners: not cut.
    TooLong,
}

/// Most corners of a concave polygon: ear clipping, whose cost grows with the square, then takes 15 seconds.
pub(super) const MAX_CONCAVE: usize = 1 << 17;

/// How far a corner may lie off the plane of a polygon that counts as planar, in parts of its size:
/// some 100 roundings of a 32-bit coordinate, well below what a pixel shows.
const PLANAR: f64 = 1e-5;

/// Reusable tables of the cutter.
#[derive(Default)]
pub(super) struct Cutter {
    earcut: Option<Earcut<f64>>,
    flat: Vec<[f64; 2]>,
    /// Corner numbers of the triangles, three each.
    pub(super) triangles: Vec<u32>,
}

impl Cutter {
    /// Cuts the polygon; afterwards `triangles` holds at most n − 2 of them, with the winding of the polygon.
    pub(super) fn cut(&mut self, corners: &[DVec3]) -> Shape {
        self.triangles.clear();
        let n = corners.len();
        if n < 3 {
            return Shape::Flattened;
        }
        let normal = newell(corners);
        if normal == DVec3::ZERO {
            return Shape::Flattened;
        }
        self.project(corners, normal);
        if is_convex(&self.flat) {
            self.triangles.extend((1..n as u32 - 1).flat_map(|i| [0, i, i + 1]));
            return if is_planar(corners, normal) { Shape::Convex } else { Shape::Bent };
        }
        if n > MAX_CONCAVE {
            return Shape::TooLong;
        }
        let earcut = self.earcut.get_or_insert_with(Earcut::new);
        earcut.earcut_slice::<u32>(&self.flat, &[], &mut self.triangles);
        for triangle in self.triangles.as_chunks_mut::<3>().0 {
            let corner = |i: u32| DVec2::from_array(self.flat[i as usize]);
            if orient2d(corner(triangle[0]), corner(triangle[1]), corner(triangle[2])) < 0.0 {
                triangle.swap(1, 2);
            }
        }
        self.triangles.truncate(3 * (n - 2));
        Shape::Concave
    }

    /// Drops the axis along which the normal is longest, so that the polygon stays counter-clockwise.
    fn project(&mut self, corners: &[DVec3], normal: DVec3) {
        let size = normal.abs();
        let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
        let (u, v) = if normal[axis] > 0.0 {
            ((axis + 1) % 3, (axis + 2) % 3)
        } else {
            ((axis + 2) % 3, (axis + 1) % 3)
        };
        self.flat.clear();
        self.flat.extend(corners.iter().map(|c| [c[u], c[v]]));
    }
}

/// Twice the vector area. Relative to the first corner, so that it does not round with the distance from the
/// origin.
pub(super) fn newell(corners: &[DVec3]) -> DVec3 {
    let first = corners[0];
    corners.windows(2).map(|w| (w[0] - first).cross(w[1] - first)).sum()
}

fn is_planar(corners: &[DVec3], normal: DVec3) -> bool {
    let unit = normal.normalize_or_zero();
    let size = corners.iter().map(|c| (*c - corners[0]).abs().max_element()).fold(0.0, f64::max);
    corners.iter().all(|c| unit.dot(*c - corners[0]).abs() <= PLANAR * size)
}

/// Whether a counter-clockwise border turns left (or not at all) at every corner and goes round once.
fn is_convex(border: &[[f64; 2]]) -> bool {
    let n = border.len();
    let corner = |i: usize| DVec2::from_array(border[i % n]);
    let mut direction = 0.0;
    let mut turns = 0;
    for i in 0..n {
        let (a, b) = (corner(i), corner(i + 1));
        if a == b {
            continue;
        }
        // The corner after this edge, past repeated points.
        let Some(c) = (2..=n).map(|k| corner(i + k)).find(|c| *c != b) else { return false };
        let turn = orient2d(a, b, c);
        if turn < 0.0 || (turn == 0.0 && (b - a).dot(c - b) < 0.0) {
            return false;
        }
        // A border that goes round once changes its direction along x twice.
        let along = (b - a).x;
        if along != 0.0 {
            turns += u32::from(direction * along < 0.0);
            direction = along.signum();
        }
    }
    turns <= 2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|&(x, y)| DVec3::new(x, y, 0.25 * x)).collect()
    }
    fn area(corners: &[DVec3], triangles: &[u32]) -> f64 {
        let corner = |i: u32| corners[i as usize];
        triangles
            .as_chunks::<3>()
            .0
            .iter()
            .map(|t| 0.5 * (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0])).length())
            .sum()
    }

    #[test]
    fn shapes_are_told_apart_in_both_windings() {
        let cases = [
            (vec![(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)], Shape::Convex),
            (vec![(0.0, 0.0), (2.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)], Shape::Convex),
            (vec![(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (3.0, 1.0)], Shape::Concave),
            (vec![(0.0, 3.0), (-1.8, -2.4), (2.9, 0.9), (-2.9, 0.9), (1.8, -2.4)], Shape::Concave),
            (vec![(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0)], Shape::Flattened),
        ];
        for (points, want) in cases {
            let mut corners = polygon(&points);
            for _ in 0..2 {
                let mut cutter = Cutter::default();
                assert_eq!(cutter.cut(&corners), want, "{points:?}");
                let whole = newell(&corners);
                for t in cutter.triangles.as_chunks::<3>().0 {
                    let [a, b, c] = t.map(|i| corners[i as usize]);
                    assert!((b - a).cross(c - a).dot(whole) >= 0.0, "winding of {points:?}");
                }
                if want != Shape::Flattened && points.len() == 4 {
                    assert!((area(&corners, &cutter.triangles) - whole.length() * 0.5).abs() < 1e-9);
                }
                corners.reverse();
            }
        }
    }

    #[test]
    fn a_bent_square_is_a_fan_but_no_polygon() {
        let corners = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.1), (0.0, 1.0, 0.0)]
            .map(|(x, y, z)| DVec3::new(x, y, z));
        let mut cutter = Cutter::default();
        assert_eq!(cutter.cut(&corners), Shape::Bent);
        assert_eq!(cutter.triangles, [0, 1, 2, 0, 2, 3]);
    }

    #[test]
    fn a_comb_of_many_corners_is_cut_into_its_area() {
        let mut corners = vec![DVec3::new(0.0, -1.0, 0.0)];
        let teeth = 25_000;
        for k in (0..teeth).rev() {
            let x = f64::from(k) * 2.0;
            corners.extend(
                [(x + 2.0, 0.0), (x + 1.0, 5.0 + f64::from(k % 7)), (x, 0.0)]
                    .map(|(x, y)| DVec3::new(x, y, 0.0)),
            );
        }
        corners[0].x = f64::from(teeth) * 2.0;
        corners.push(DVec3::new(0.0, -1.0, 0.0));
        let mut cutter = Cutter::default();
        assert_eq!(cutter.cut(&corners), Shape::Concave);
        let want = newell(&corners).length() * 0.5;
        assert!((area(&corners, &cutter.triangles) - want).abs() < want * 1e-9);
    }
}
