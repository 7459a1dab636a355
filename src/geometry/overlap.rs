//! Whether a primitive meets a convex cell: separating axes.
//!
//! Gottschalk, Lin and Manocha 1996; for triangle and box as in Akenine-Möller 2001. Two convex polytopes are
//! apart if and only if a normal of a face of one of them, or of an edge of each, separates them. Touching is
//! meeting. `f32` points are widened, and an axis separates only by more than the bound on its rounding
//! error, so that no contact is missed. Cost: at most 13 axes for triangle and box, 23 for triangle and
//! tetrahedron, 5 in the plane.

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::Aabb;

/// A normal is a product of two rounded differences, a projection a sum of three products with a third: 8
/// half-ulps of the largest such product for each of 6 terms and 2 projections, rounded up.
const ERROR: f64 = 128.0 * (f64::EPSILON * 0.5);

/// Whether the projections of two sets of points onto an axis are apart.
#[inline]
fn apart(a: impl Iterator<Item = f64>, b: impl Iterator<Item = f64>, error: f64) -> bool {
    let span = |values: &mut dyn Iterator<Item = f64>| {
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let ([a_low, a_high], [b_low, b_high]) = (span(&mut { a }), span(&mut { b }));
    a_low - b_high > error || b_low - a_high > error
}

/// Whether two convex sets in space meet, given all axes that could separate them.
#[inline]
fn meet(a: &[DVec3], b: &[DVec3], mut axes: impl Iterator<Item = DVec3>, error: f64) -> bool {
    !axes.any(|axis| apart(a.iter().map(|p| axis.dot(*p)), b.iter().map(|p| axis.dot(*p)), error))
}

/// The error of projections of points of a set of this size onto a product of two of its edges.
fn error_3d(a: &[DVec3], b: &[DVec3]) -> f64 {
    let size = a.iter().chain(b).fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    ERROR * size * size * size
}

/// Whether a triangle meets a tetrahedron.
pub fn triangle_meets_tetrahedron(triangle: [Vec3; 3], tetrahedron: [Vec3; 4]) -> bool {
    let origin = tetrahedron[0].as_dvec3();
    let (t, c) = (triangle.map(|p| p.as_dvec3() - origin), tetrahedron.map(|p| p.as_dvec3() - origin));
    let sides = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let edges = [c[1] - c[0], c[2] - c[0], c[3] - c[0], c[2] - c[1], c[3] - c[1], c[3] - c[2]];
    let faces = [[0, 1], [1, 2], [2, 0], [3, 4]].into_iter().map(|[i, k]| edges[i].cross(edges[k]));
    let normal = std::iter::once_with(|| sides[0].cross(sides[1]));
    let pairs = edges.into_iter().flat_map(|e| sides.map(|s| e.cross(s)));
    meet(&t, &c, faces.chain(normal).chain(pairs), error_3d(&t, &c))
}

/// Where a point lies in regard to a primitive of a dimension less than space, beyond doubt: none, one or two
/// of three facts. By those of its corners most convex cells beside a large primitive are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Beside(u8);

impl Beside {
    /// Before its plane (line).
    const ABOVE: u8 = 1;
    /// Behind its plane.
    const BELOW: u8 = 2;
    /// Over or under the inside of it.
    const OVER: u8 = 4;

    fn of(height: f64, error: f64, is_over: bool) -> Self {
        let over = if is_over { Self::OVER } else { 0 };
        let side = if height > error { Self::ABOVE } else { Self::BELOW };
        Self(if height.abs() > error { side | over } else { over })
    }
    /// Whether a convex cell with corners here meets the primitive; `None` if that is not told by them.
    pub fn meet(corners: impl Iterator<Item = Self>) -> Option<bool> {
        let (all, any) = corners.fold((u8::MAX, 0), |(all, any), c| (all & c.0, any | c.0));
        // What the plane has of a cell that it cuts lies between the corners, so within the primitive.
        let is_cut = any & (Self::ABOVE | Self::BELOW) == Self::ABOVE | Self::BELOW;
        if all & (Self::ABOVE | Self::BELOW) != 0 {
            return Some(false);
        }
        (is_cut && all & Self::OVER != 0).then_some(true)
    }
}

/// The slack of [`Beside`]: so much more than [`ERROR`] that what it says the separating axes say too, though
/// those take other origins.
const BESIDE: f64 = 64.0 * ERROR;

/// Where a point lies in regard to a triangle.
pub fn beside_triangle(triangle: [Vec3; 3], point: Vec3) -> Beside {
    let origin = triangle[0].as_dvec3();
    let (t, p) = (triangle.map(|p| p.as_dvec3() - origin), point.as_dvec3() - origin);
    let sides = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let normal = sides[0].cross(sides[1]);
    let size = t.iter().chain([&p]).fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let error = BESIDE * size * size * size;
    // Products of four lengths, where a height is one of three.
    let is_over = (0..3).all(|k| normal.cross(sides[k]).dot(p - t[k]) > error * size);
    Beside::of(normal.dot(p), error, is_over)
}

/// Where a point lies in regard to a segment of the plane.
pub fn beside_segment(segment: [Vec2; 2], point: Vec2) -> Beside {
    let origin = segment[0].as_dvec2();
    let (along, p) = (segment[1].as_dvec2() - origin, point.as_dvec2() - origin);
    let size = along.abs().max(p.abs()).max_element();
    let error = BESIDE * size * size;
    let (at, end) = (along.dot(p), along.dot(along));
    Beside::of(along.perp().dot(p), error, at > error && end - at > error)
}

/// Whether a triangle meets a box.
pub fn triangle_meets_box(triangle: [Vec3; 3], bounds: &Aabb<Vec3>) -> bool {
    if !Aabb::of(triangle).touches(bounds) {
        return false;
    }
    let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (origin, half) = ((low + high) * 0.5, (high - low) * 0.5);
    let t = triangle.map(|p| p.as_dvec3() - origin);
    let sides = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let size = t.iter().fold(half.max_element(), |m, p| m.max(p.abs().max_element()));
    let normal = std::iter::once_with(|| sides[0].cross(sides[1]));
    // The box's axes are made as long as its edges may be, so that one bound fits all.
    let pairs = sides.into_iter().flat_map(|s| DVec3::AXES.map(|axis| (axis * size).cross(s)));
    let mut axes = normal.chain(pairs);
    let error = ERROR * size * size * size;
    !axes.any(|axis| {
        let reach = axis.abs().dot(half);
        apart(t.iter().map(|p| axis.dot(*p)), [-reach, reach].into_iter(), error)
    })
}

/// Which octants of a box a triangle meets, of those asked for, a bit each (bit `a` of an octant's number
/// says upper on axis `a`); those are asked for that its box touches. The same axes as for a box, each
/// projected once for all octants.
pub fn triangle_meets_octants(triangle: [Vec3; 3], cell: &Aabb<Vec3>, asked: u8) -> u8 {
    let origin = cell.center().as_dvec3();
    let (low, high) = (cell.min.as_dvec3() - origin, cell.max.as_dvec3() - origin);
    let t = triangle.map(|p| p.as_dvec3() - origin);
    let sides = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let largest = low.abs().max_element().max(high.abs().max_element());
    let size = t.iter().fold(largest, |m, p| m.max(p.abs().max_element()));
    let error = ERROR * size * size * size;
    let pairs = sides.into_iter().flat_map(|s| DVec3::AXES.map(|axis| (axis * size).cross(s)));
    let mut met = asked;
    for axis in std::iter::once(sides[0].cross(sides[1])).chain(pairs) {
        let at = t.map(|p| axis.dot(p));
        let (first, last) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
        // On each coordinate axis an octant reaches from the center to one end of the box.
        let ends = [axis * low, axis * high];
        let (least, most) = (ends.map(|e| e.min(DVec3::ZERO)), ends.map(|e| e.max(DVec3::ZERO)));
        for octant in (0..8).filter(|o| asked >> o & 1 == 1) {
            let (x, y, z) = (octant & 1, octant >> 1 & 1, octant >> 2);
            let from = least[x].x + least[y].y + least[z].z;
            let to = most[x].x + most[y].y + most[z].z;
            met &= !(u8::from(first - to > error || from - last > error) << octant);
        }
    }
    met
}

/// Whether a segment meets a triangle of the plane.
pub fn segment_meets_triangle(segment: [Vec2; 2], triangle: [Vec2; 3]) -> bool {
    let origin = triangle[0].as_dvec2();
    let (s, t) = (segment.map(|p| p.as_dvec2() - origin), triangle.map(|p| p.as_dvec2() - origin));
    let axes = [s[1] - s[0], t[1] - t[0], t[2] - t[1], t[0] - t[2]].map(DVec2::perp);
    let size = s.iter().chain(&t).fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let error = ERROR * size * size;
    !axes.into_iter().any(|axis| apart(s.iter().map(|p| axis.dot(*p)), t.iter().map(|p| axis.dot(*p)), error))
}

/// Whether a segment meets a box of the plane.
pub fn segment_meets_box(segment: [Vec2; 2], bounds: &Aabb<Vec2>) -> bool {
    if !Aabb::of(segment).touches(bounds) {
        return false;
    }
    let origin = bounds.min.as_dvec2();
    let s = segment.map(|p| p.as_dvec2() - origin);
    let corners = [0, 1, 2, 3].map(|i| bounds.corner(i).as_dvec2() - origin);
    let axis = (s[1] - s[0]).perp();
    let size = s.iter().chain(&corners).fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    !apart(s.iter().map(|p| axis.dot(*p)), corners.iter().map(|p| axis.dot(*p)), ERROR * size * size)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All octants at a time as each by itself, on random triangles and on grids, where much only touches.
    #[test]
    fn octants_are_met_as_boxes_are() {
        let mut dice = Dice::new(41);
        let mut counts = [0; 9];
        for case in 0..20_000 {
            let on_grid = case % 2 == 0;
            let mut point =
                || if on_grid { dice.grid_point::<Vec3>(5) - Vec3::splat(2.0) } else { dice.point(2.0) };
            let triangle = [point(), point(), point()];
            let cell = Aabb { min: Vec3::splat(-1.5), max: Vec3::splat(1.5 + f32::from(case % 3 == 0)) };
            let center = cell.center();
            let octant = |o: usize| {
                let end = |a: usize| if o >> a & 1 == 1 { cell.max[a] } else { cell.min[a] };
                Aabb::of([center, Vec3::new(end(0), end(1), end(2))])
            };
            let touched = (0..8).filter(|o| Aabb::of(triangle).touches(&octant(*o)));
            let asked = touched.fold(0u8, |bits, o| bits | 1 << o);
            let want = (0..8)
                .filter(|o| triangle_meets_box(triangle, &octant(*o)))
                .fold(0u8, |bits, o| bits | 1 << o);
            assert_eq!(triangle_meets_octants(triangle, &cell, asked), want, "case {case}: {triangle:?}");
            counts[want.count_ones() as usize] += 1;
        }
        assert!(counts.iter().all(|count| *count > 100), "{counts:?}");
    }
    use crate::geometry::dice::Dice;
    use crate::geometry::{orient2d, orient3d};

    fn side(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> f64 {
        orient3d(a.as_dvec3(), b.as_dvec3(), c.as_dvec3(), d.as_dvec3())
    }

    /// Whether a segment crosses a triangle; `None` where some points are coplanar.
    fn crosses(s: [Vec3; 2], t: [Vec3; 3]) -> Option<bool> {
        let ends = s.map(|p| side(t[0], t[1], t[2], p));
        let around = [0, 1, 2].map(|i| side(s[0], s[1], t[i], t[(i + 1) % 3]));
        if ends.contains(&0.0) || around.contains(&0.0) {
            return None;
        }
        Some(ends[0] * ends[1] < 0.0 && (around.iter().all(|v| *v > 0.0) || around.iter().all(|v| *v < 0.0)))
    }

    /// Whether a triangle meets a tetrahedron, from signs of orientation alone; `None` where some points are
    /// coplanar.
    fn meets_by_signs(t: [Vec3; 3], c: [Vec3; 4]) -> Option<bool> {
        let faces = [[1, 3, 2, 0], [0, 2, 3, 1], [0, 3, 1, 2], [0, 1, 2, 3]];
        let mut found = false;
        for p in t {
            let sides =
                faces.map(|f| side(c[f[0]], c[f[1]], c[f[2]], p) * side(c[f[0]], c[f[1]], c[f[2]], c[f[3]]));
            if sides.contains(&0.0) {
                return None;
            }
            found |= sides.iter().all(|s| *s > 0.0);
        }
        for f in faces {
            for i in 0..3 {
                found |= crosses([t[i], t[(i + 1) % 3]], [c[f[0]], c[f[1]], c[f[2]]])?;
            }
        }
        for i in 0..4 {
            for k in i + 1..4 {
                found |= crosses([c[i], c[k]], t)?;
            }
        }
        Some(found)
    }

    #[test]
    fn triangles_meet_tetrahedra_as_exact_signs_say() {
        let mut dice = Dice::new(1);
        let (mut met, mut apart, mut told_met, mut told_apart) = (0, 0, 0, 0);
        for case in 0..30_000 {
            let (t, c) =
                ([0; 3].map(|_| dice.grid_point::<Vec3>(12)), [0; 4].map(|_| dice.grid_point::<Vec3>(12)));
            // Every other triangle is so large that cells lie over the inside of it.
            let t = if case % 2 == 0 { t } else { t.map(|p| p * 6.0 - 30.0) };
            let Some(want) = meets_by_signs(t, c) else { continue };
            assert_eq!(triangle_meets_tetrahedron(t, c), want, "case {case}: {t:?} {c:?}");
            if let Some(told) = Beside::meet(c.iter().map(|p| beside_triangle(t, *p))) {
                assert_eq!(told, want, "case {case}: {t:?} {c:?}");
                *if want { &mut told_met } else { &mut told_apart } += 1;
            }
            // The same far away and small: coordinates of the grid stay exact.
            let moved = |p: Vec3| (p + 1024.0) * 0.001_953_125;
            assert_eq!(triangle_meets_tetrahedron(t.map(moved), c.map(moved)), want, "case {case}");
            *if want { &mut met } else { &mut apart } += 1;
        }
        assert!(met > 1000 && apart > 1000, "{met} met, {apart} apart");
        assert!(told_met > 100 && told_apart > 1000, "by corners alone: {told_met} met, {told_apart} apart");
    }

    #[test]
    fn triangles_meet_boxes_where_they_meet_one_of_five_tetrahedra() {
        let mut dice = Dice::new(2);
        let (mut met, mut apart) = (0, 0);
        // Four corners of a cube are cut off, the fifth tetrahedron is left.
        let split = [[0, 1, 2, 4], [3, 1, 2, 7], [5, 1, 4, 7], [6, 2, 4, 7], [1, 2, 4, 7]];
        for case in 0..20_000 {
            let t = [0; 3].map(|_| dice.grid_point::<Vec3>(10));
            let (p, q) = (dice.grid_point::<Vec3>(10), dice.grid_point::<Vec3>(10));
            let bounds = Aabb { min: p.min(q), max: p.max(q) + 1.0 };
            let corners: Vec<Vec3> = bounds.corners().collect();
            let want = split.iter().any(|c| triangle_meets_tetrahedron(t, c.map(|i| corners[i])));
            assert_eq!(triangle_meets_box(t, &bounds), want, "case {case}: {t:?} {bounds:?}");
            *if want { &mut met } else { &mut apart } += 1;
        }
        assert!(met > 1000 && apart > 1000, "{met} met, {apart} apart");
    }

    #[test]
    fn segments_meet_cells_of_the_plane_as_exact_signs_say() {
        let mut dice = Dice::new(3);
        let (mut met, mut apart) = (0, 0);
        let turn = |a: Vec2, b: Vec2, c: Vec2| orient2d(a.as_dvec2(), b.as_dvec2(), c.as_dvec2());
        let crosses = |s: [Vec2; 2], t: [Vec2; 2]| {
            let signs = [
                turn(s[0], s[1], t[0]),
                turn(s[0], s[1], t[1]),
                turn(t[0], t[1], s[0]),
                turn(t[0], t[1], s[1]),
            ];
            (!signs.contains(&0.0)).then_some(signs[0] * signs[1] < 0.0 && signs[2] * signs[3] < 0.0)
        };
        for case in 0..30_000 {
            let (s, t) =
                ([0; 2].map(|_| dice.grid_point::<Vec2>(12)), [0; 3].map(|_| dice.grid_point::<Vec2>(12)));
            let edges: Option<Vec<bool>> = (0..3).map(|i| crosses(s, [t[i], t[(i + 1) % 3]])).collect();
            let Some(edges) = edges.filter(|_| turn(t[0], t[1], t[2]) != 0.0) else { continue };
            let inside = (0..3).all(|i| turn(t[i], t[(i + 1) % 3], s[0]) * turn(t[0], t[1], t[2]) > 0.0);
            let want = inside || edges.contains(&true);
            assert_eq!(segment_meets_triangle(s, t), want, "case {case}: {s:?} {t:?}");
            if let Some(told) = Beside::meet(t.iter().map(|p| beside_segment(s, *p))) {
                assert_eq!(told, want, "case {case}: {s:?} {t:?}");
            }
            *if want { &mut met } else { &mut apart } += 1;
            let (p, q) = (dice.grid_point::<Vec2>(12), dice.grid_point::<Vec2>(12));
            let bounds = Aabb { min: p.min(q), max: p.max(q) + 1.0 };
            let corner = [0, 1, 3, 2].map(|i| bounds.corner(i));
            let halves = [[corner[0], corner[1], corner[2]], [corner[0], corner[2], corner[3]]];
            assert_eq!(
                segment_meets_box(s, &bounds),
                halves.iter().any(|t| segment_meets_triangle(s, *t)),
                "case {case}"
            );
        }
        assert!(met > 1000 && apart > 1000, "{met} met, {apart} apart");
    }

    #[test]
    fn touching_is_meeting() {
        let cell = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let touching = [
            [Vec3::ZERO, -Vec3::X, -Vec3::Y],
            [Vec3::ZERO, Vec3::X, Vec3::Y],
            [-Vec3::X, Vec3::new(0.2, 0.2, 0.0), -Vec3::Y],
            [Vec3::ZERO; 3],
        ];
        for t in touching {
            assert!(triangle_meets_tetrahedron(t, cell) && triangle_meets_box(t, &bounds), "{t:?}");
            let away = t.map(|p| p - 1e-6);
            assert!(
                !triangle_meets_tetrahedron(away, cell) && !triangle_meets_box(away, &bounds),
                "{away:?}"
            );
        }
        let square = Aabb { min: Vec2::ZERO, max: Vec2::ONE };
        for (s, want) in [
            ([Vec2::ZERO, -Vec2::X], true),
            ([-Vec2::X, Vec2::new(-1e-6, 0.0)], false),
            ([Vec2::X, Vec2::Y], true),
        ] {
            assert_eq!(segment_meets_triangle(s, [Vec2::ZERO, Vec2::X, Vec2::Y]), want);
            assert_eq!(segment_meets_box(s, &square), want);
        }
    }
}
