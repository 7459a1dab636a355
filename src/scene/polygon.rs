//! Cutting a polygon into triangles, and finding out whether it is convex and planar.
//!
//! A convex one becomes the fan (0, i, i+1), a quadrilateral that is not the fan from the other diagonal, any
//! other is handed to ear clipping along the normal that Newell's sum gives (Sutherland, Sproull and
//! Schumacker 1974, appendix); signs are exact. Where the polygon is bent, the cut in the plane misses what
//! stands upright on it: the border that is left over is cut in its own plane, until a surface of n − 2
//! triangles spans the whole border. A border that crosses itself, for which no surface is right, becomes the
//! fan, as other readers have it. Cost: O(n) for a convex polygon; for others O(n²) with a small factor (ear
//! clipping with a z-order curve: 10 ms for 5,000 corners, 5 to 9 s for 100,000).

use std::collections::BTreeMap;

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
    /// Fewer than three corners.
    Flattened,
    /// Concave, of more than [`MAX_CONCAVE`] corners: not cut.
    TooLong,
}

/// Most corners of a concave polygon: ear clipping, whose cost grows with the square, then takes 15 seconds.
pub(super) const MAX_CONCAVE: usize = 1 << 17;

/// How far a corner may lie off the plane of a polygon that counts as planar, in parts of its size:
/// some 100 roundings of a 32-bit coordinate, well below what a pixel shows.
const PLANAR: f64 = 1e-5;

/// Most times that what is left over of a border is cut in its turn; what is left then becomes a fan.
const DEEPEST: u8 = 8;
/// Most passes over the triangles without area of a polygon.
const PASSES: usize = 32;

/// Reusable tables of the cutter.
#[derive(Default)]
pub(super) struct Cutter {
    /// How many borders are around the one that is cut.
    depth: u8,
    earcut: Option<Earcut<f64>>,
    flat: Vec<[f64; 2]>,
    /// Corner numbers of the triangles, three each.
    pub(super) triangles: Vec<u32>,
}

impl Cutter {
    /// Cuts the polygon; afterwards `triangles` holds n − 2 of them (fewer only if the border goes back along
    /// itself), which together have the border of the polygon.
    pub(super) fn cut(&mut self, corners: &[DVec3]) -> Shape {
        self.triangles.clear();
        let n = corners.len() as u32;
        if n < 3 {
            return Shape::Flattened;
        }
        let normal = newell(corners);
        if normal == DVec3::ZERO {
            self.fan(n);
            return Shape::Concave;
        }
        self.project(corners, normal);
        if is_convex(&self.flat) {
            self.fan(n);
            return if is_planar(corners, normal) { Shape::Convex } else { Shape::Bent };
        }
        if n as usize > MAX_CONCAVE {
            return Shape::TooLong;
        }
        if n == 4 {
            self.quadrilateral();
        } else if self.depth > DEEPEST || !self.clip_ears() || !self.span_rest(corners) {
            self.triangles.clear();
            self.fan(n);
        }
        Shape::Concave
    }

    fn fan(&mut self, n: u32) {
        self.triangles.extend((1..n - 1).flat_map(|i| [0, i, i + 1]));
    }

    /// One that is not convex: from the concave corner, if there is one. If the border crosses itself, the
    /// fan.
    fn quadrilateral(&mut self) {
        let corner = |i: usize| DVec2::from_array(self.flat[i]);
        let turn = |a, b, c| orient2d(corner(a), corner(b), corner(c));
        let other = turn(1, 2, 3) > 0.0 && turn(1, 3, 0) > 0.0;
        self.triangles.extend(if other { [1, 2, 3, 1, 3, 0] } else { [0, 1, 2, 0, 2, 3] });
    }

    /// Cuts in the projection; `false` if the triangles turn different ways, so that they overlap.
    fn clip_ears(&mut self) -> bool {
        let earcut = self.earcut.get_or_insert_with(Earcut::new);
        earcut.earcut_slice::<u32>(&self.flat, &[], &mut self.triangles);
        let corner = |i: u32| DVec2::from_array(self.flat[i as usize]);
        let mut turned = 0;
        for triangle in self.triangles.as_chunks_mut::<3>().0 {
            if orient2d(corner(triangle[0]), corner(triangle[1]), corner(triangle[2])) < 0.0 {
                triangle.swap(1, 2);
                turned += 1;
            }
        }
        let count = self.triangles.len() / 3;
        count == self.flat.len() - 2 || (count < self.flat.len() && (turned == 0 || turned == count))
    }

    /// Cuts what of the border the triangles do not have, loop by loop, each in its own plane; `false` if no
    /// surface of n − 2 triangles comes of it.
    fn span_rest(&mut self, corners: &[DVec3]) -> bool {
        let n = corners.len();
        if self.triangles.len() == 3 * (n - 2) {
            return true;
        }
        let mut inner = Self { depth: self.depth + 1, ..Self::default() };
        for ring in loops(n as u32, &self.triangles) {
            // Ears that were not found at all leave the border as it was.
            if ring.len() >= n {
                return false;
            }
            let places: Vec<DVec3> = ring.iter().map(|c| corners[*c as usize]).collect();
            inner.cut(&places);
            self.triangles.extend(inner.triangles.iter().map(|c| ring[*c as usize]));
        }
        self.triangles.len() <= 3 * (n - 2)
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

/// The closed loops of a border of `n` corners that are no border of these triangles.
fn loops(n: u32, triangles: &[u32]) -> Vec<Vec<u32>> {
    // How often an edge is in the border more often than in the triangles, by its lower end first.
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    let mut count = |from: u32, to: u32, sign: i32| {
        *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { sign } else { -sign };
    };
    (0..n).for_each(|i| count(i, (i + 1) % n, 1));
    for [a, b, c] in triangles.as_chunks::<3>().0 {
        [(a, b), (b, c), (c, a)].into_iter().for_each(|(from, to)| count(*from, *to, -1));
    }
    let mut ways: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for ((low, high), times) in edges {
        let (from, to) = if times > 0 { (low, high) } else { (high, low) };
        (0..times.abs()).for_each(|_| ways.entry(from).or_default().push(to));
    }
    let mut found = Vec::new();
    // A walk that comes back to a corner cuts a loop off.
    let mut at: BTreeMap<u32, usize> = BTreeMap::new();
    while let Some((&start, _)) = ways.first_key_value() {
        let mut walk = vec![start];
        at.insert(start, 0);
        let mut here = start;
        while let Some(next) = ways.get_mut(&here).and_then(Vec::pop) {
            if ways.get(&here).is_some_and(Vec::is_empty) {
                ways.remove(&here);
            }
            if let Some(&begin) = at.get(&next) {
                let ring = walk.split_off(begin);
                ring.iter().for_each(|c| {
                    at.remove(c);
                });
                if ring.len() > 2 {
                    found.push(ring);
                }
            }
            at.insert(next, walk.len());
            walk.push(next);
            here = next;
        }
        at.clear();
    }
    found
}

/// Turns edges until no triangle is without area that need not be: where a corner lies on the longest edge of
/// its triangle and another triangle has that edge, the two become the two others of the same four corners.
/// `alive` tells whether a triangle has an area.
pub(super) fn turn_edges(triangles: &mut [[u32; 3]], corners: &[DVec3], alive: impl Fn([u32; 3]) -> bool) {
    let mut dead: Vec<usize> = (0..triangles.len()).filter(|t| !alive(triangles[*t])).collect();
    if dead.is_empty() || dead.len() == triangles.len() {
        return;
    }
    let sides = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)];
    let mut owner: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (t, corners) in triangles.iter().enumerate() {
        sides(*corners).into_iter().for_each(|side| {
            owner.insert(side, t);
        });
    }
    // A fan over a straight border opens from one of its ends: each pass goes the other way.
    for _ in 0..PASSES {
        let before = dead.len();
        dead.reverse();
        dead.retain(|&t| {
            let length = |(a, b): (u32, u32)| corners[a as usize].distance_squared(corners[b as usize]);
            let around = sides(triangles[t]);
            let longer = |a: usize, b: usize| if length(around[b]) > length(around[a]) { b } else { a };
            let longest = longer(longer(0, 1), 2);
            let (u, v) = around[longest];
            let p = triangles[t][(longest + 2) % 3];
            let Some(&other) = owner.get(&(v, u)).filter(|o| **o != t) else { return true };
            let c = triangles[other].iter().copied().find(|c| *c != u && *c != v);
            let Some(c) = c.filter(|c| *c != p) else { return true };
            let turned = [[p, u, c], [c, v, p]];
            if !(turned.iter().all(|t| alive(*t)) && alive(triangles[other])) {
                return true;
            }
            (triangles[t], triangles[other]) = (turned[0], turned[1]);
            for (t, corners) in [(t, turned[0]), (other, turned[1])] {
                sides(corners).into_iter().for_each(|side| {
                    owner.insert(side, t);
                });
            }
            owner.remove(&(u, v));
            owner.remove(&(v, u));
            false
        });
        if dead.is_empty() || dead.len() == before {
            return;
        }
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

    /// Twice the sum of the triangles' vector areas: that of the border, whatever surface spans it.
    fn vector_area(corners: &[DVec3], triangles: &[u32]) -> DVec3 {
        let corner = |i: u32| corners[i as usize];
        let of = |t: &[u32; 3]| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0]));
        triangles.as_chunks::<3>().0.iter().map(of).sum()
    }

    #[test]
    fn shapes_are_told_apart_in_both_windings() {
        let cases = [
            (vec![(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)], Shape::Convex),
            (vec![(0.0, 0.0), (2.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)], Shape::Convex),
            (vec![(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (3.0, 1.0)], Shape::Concave),
            (vec![(0.0, 3.0), (-1.8, -2.4), (2.9, 0.9), (-2.9, 0.9), (1.8, -2.4)], Shape::Concave),
        ];
        for (points, want) in cases {
            let mut corners = polygon(&points);
            for _ in 0..2 {
                let mut cutter = Cutter::default();
                assert_eq!(cutter.cut(&corners), want, "{points:?}");
                let whole = newell(&corners);
                assert!((vector_area(&corners, &cutter.triangles) - whole).length() < 1e-9, "{points:?}");
                assert_eq!(cutter.triangles.len(), 3 * (points.len() - 2), "{points:?}");
                if points.len() == 4 {
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
    fn a_long_straight_border_takes_no_long_time() {
        // The fan begins in the middle of a straight border of many corners: it opens from both ends.
        let n = 20_000;
        let mut corners: Vec<DVec3> = (n / 2..=n).map(|k| DVec3::new(f64::from(k), 0.0, 0.0)).collect();
        corners.extend([DVec3::new(f64::from(n), 9.0, 0.0), DVec3::new(0.0, 9.0, 0.0)]);
        corners.extend((0..n / 2).map(|k| DVec3::new(f64::from(k), 0.0, 0.0)));
        let mut cutter = Cutter::default();
        assert_eq!(cutter.cut(&corners), Shape::Convex);
        let triangles = cutter.triangles.as_chunks_mut::<3>().0;
        let calls = std::cell::Cell::new(0);
        turn_edges(triangles, &corners, |t| {
            calls.set(calls.get() + 1);
            area(&corners, &t) > 0.0
        });
        assert!(triangles.iter().all(|t| area(&corners, t) > 0.0) && calls.get() < 10 * n, "{calls:?}");
    }

    fn cut(corners: &[[f64; 3]]) -> (Vec<u32>, f64) {
        let corners: Vec<DVec3> = corners.iter().map(|c| DVec3::from_array(*c)).collect();
        let mut cutter = Cutter::default();
        cutter.cut(&corners);
        let area = area(&corners, &cutter.triangles);
        (cutter.triangles, area)
    }

    #[test]
    fn what_stands_upright_is_kept() {
        // A floor with a gable upon one side; and one with a notch and two gables. Seen from above each gable
        // is a line.
        let house = vec![(0, 0, 2), (2, 0, 2), (2, 0, 0), (0, 0, 0), (1, 1, 0)];
        let barn = vec![
            (0, 0, 4),
            (2, 0, 3),
            (4, 0, 4),
            (4, 0, 0),
            (4, 2, 0),
            (3, 1, 0),
            (2, 2, 0),
            (1, 1, 0),
            (0, 2, 0),
            (0, 0, 0),
        ];
        for shape in [house, barn] {
            let n = shape.len();
            for first in 0..n {
                let corners: Vec<DVec3> = (0..n)
                    .map(|k| shape[(k + first) % n])
                    .map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
                    .collect();
                let mut cutter = Cutter::default();
                cutter.cut(&corners);
                let triangles = cutter.triangles.as_chunks::<3>().0;
                assert_eq!(triangles.len(), n - 2, "from corner {first} of {n}");
                assert!(triangles.iter().all(|t| area(&corners, t) > 0.1), "from corner {first} of {n}");
                assert_eq!(vector_area(&corners, &cutter.triangles), newell(&corners));
            }
        }
    }

    #[test]
    fn a_border_that_crosses_itself_is_the_fan() {
        let bow_tie = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(cut(&bow_tie), (vec![0, 1, 2, 0, 2, 3], 1.0));
        let uneven = [[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(cut(&uneven).0, [0, 1, 2, 0, 2, 3]);
        let arrow = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]];
        assert_eq!(cut(&arrow), (vec![0, 1, 2, 0, 2, 3], 4.0));
        let turned = [arrow[1], arrow[2], arrow[3], arrow[0]];
        assert_eq!(cut(&turned), (vec![1, 2, 3, 1, 3, 0], 4.0));
    }

    #[test]
    fn corners_on_a_straight_border_lose_no_triangle() {
        // A square with five corners on one side, from any corner on, and a comb's back likewise.
        let ring: Vec<DVec3> = [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 4), (0, 4)]
            .iter()
            .map(|(x, y)| DVec3::new(f64::from(*x), f64::from(*y), 0.0))
            .collect();
        let notched: Vec<DVec3> =
            [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 4), (3, 4), (2, 3), (1, 4), (0, 4)]
                .iter()
                .map(|(x, y)| DVec3::new(f64::from(*x), f64::from(*y), 0.0))
                .collect();
        for (shape, want) in [(ring, 16.0), (notched, 15.0)] {
            for first in 0..shape.len() {
                let corners: Vec<DVec3> =
                    (0..shape.len()).map(|k| shape[(k + first) % shape.len()]).collect();
                let mut cutter = Cutter::default();
                cutter.cut(&corners);
                let size = |t: [u32; 3]| area(&corners, &t);
                let triangles = cutter.triangles.as_chunks_mut::<3>().0;
                turn_edges(triangles, &corners, |t| size(t) > 0.0);
                assert_eq!(triangles.len(), corners.len() - 2);
                assert!(triangles.iter().all(|t| size(*t) > 0.0), "from corner {first}: {triangles:?}");
                assert_eq!(triangles.iter().map(|t| size(*t)).sum::<f64>(), want);
            }
        }
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
