//! The triangulation against its definition, by exact arithmetic, and against brute force.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::{Delaunay, FACES};
use crate::geometry::dice::Dice;
use crate::geometry::{insphere, orient3d};

fn triangulate(points: Vec<Vec3>) -> Delaunay {
    Delaunay::new(points, || false).expect("not cancelled")
}

fn corners(d: &Delaunay, t: usize) -> [DVec3; 4] {
    d.tetrahedra[t].vertices.map(|v| d.points[v as usize].as_dvec3())
}

/// Everything that is promised: positive cells, faces that match, no point in the sphere of a cell beyond a
/// face of it (which is enough for all spheres to be empty), a convex boundary, and every point in use or
/// named as a duplicate.
fn fault(d: &Delaunay) -> Option<String> {
    let mut used = vec![false; d.points.len()];
    for (t, cell) in d.tetrahedra.iter().enumerate() {
        let [a, b, c, e] = corners(d, t);
        if orient3d(a, b, c, e) <= 0.0 {
            return Some(format!("{t} is not positive"));
        }
        cell.vertices.iter().for_each(|v| used[*v as usize] = true);
        for face in 0..4 {
            let mut here = cell.face(face);
            here.sort_unstable();
            let [p, q, r] = cell.face(face).map(|v| d.points[v as usize].as_dvec3());
            match cell.neighbor(face) {
                Some(n) => {
                    let other = &d.tetrahedra[n as usize];
                    let Some(back) = (0..4).find(|k| other.neighbor(*k) == Some(t as u32)) else {
                        return Some(format!("{n} does not know {t}"));
                    };
                    let mut there = other.face(back);
                    there.sort_unstable();
                    if here != there {
                        return Some(format!("{t} and {n} share no face"));
                    }
                    if insphere(a, b, c, e, d.points[other.vertices[back] as usize].as_dvec3()) > 0.0 {
                        return Some(format!("the sphere of {t} holds a vertex of {n}"));
                    }
                }
                None if d.points.iter().any(|point| orient3d(p, q, r, point.as_dvec3()) < 0.0) => {
                    return Some(format!("a point lies beyond face {face} of {t}, which is on the hull"));
                }
                None => {}
            }
        }
    }
    let stands_in = |[left_out, kept]: &[u32; 2]| d.points[*left_out as usize] == d.points[*kept as usize];
    if !d.duplicates.iter().all(stands_in) {
        return Some("a duplicate is none".into());
    }
    d.duplicates.iter().for_each(|pair| used[pair[0] as usize] = true);
    (!d.tetrahedra.is_empty() && used.contains(&false)).then(|| "a point is missing".into())
}

fn volume(d: &Delaunay) -> f64 {
    let one = |t| {
        let [a, b, c, e] = corners(d, t);
        (b - a).cross(c - a).dot(e - a) / 6.0
    };
    (0..d.tetrahedra.len()).map(one).sum()
}

/// Volume of the convex hull of points no four of which are coplanar on it: of every plane through three that
/// has all others on one side.
fn hull_volume(points: &[DVec3]) -> f64 {
    let (n, mut sum) = (points.len(), 0.0);
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let [a, b, c] = [i, j, k].map(|v| points[v]);
                let sides: Vec<f64> =
                    (0..n).filter(|v| ![i, j, k].contains(v)).map(|v| orient3d(a, b, c, points[v])).collect();
                if sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0) {
                    sum += (a - points[0]).dot((b - points[0]).cross(c - points[0])).abs() / 6.0;
                }
            }
        }
    }
    sum
}

/// A point of the unit cube.
fn point(dice: &mut Dice) -> Vec3 {
    Vec3::new(dice.unit(), dice.unit(), dice.unit())
}

/// A point of a grid of this many places along each axis.
fn grid_point(dice: &mut Dice, [x, y, z]: [u32; 3]) -> Vec3 {
    Vec3::new(dice.below(x) as f32, dice.below(y) as f32, dice.below(z) as f32)
}

#[test]
fn random_points_are_triangulated_and_fill_their_hull() {
    let mut dice = Dice::new(1);
    for case in 0..60 {
        let n = 4 + dice.below(28) as usize;
        let d = triangulate((0..n).map(|_| point(&mut dice)).collect());
        assert_eq!(fault(&d), None, "case {case}");
        let (filled, hull) =
            (volume(&d), hull_volume(&d.points.iter().map(|p| p.as_dvec3()).collect::<Vec<_>>()));
        assert!((filled - hull).abs() < 1e-12, "case {case}: {filled} of {hull}");
    }
    let d = triangulate((0..3000).map(|_| point(&mut dice)).collect());
    assert_eq!(fault(&d), None);
    assert!((6.0..7.0).contains(&(d.tetrahedra.len() as f64 / 3000.0)), "{}", d.tetrahedra.len());
}

#[test]
fn no_point_lies_in_any_sphere() {
    let mut dice = Dice::new(2);
    for case in 0..20 {
        let d = triangulate(
            (0..60)
                .map(|_| if case % 2 == 0 { point(&mut dice) } else { grid_point(&mut dice, [4; 3]) })
                .collect(),
        );
        for t in 0..d.tetrahedra.len() {
            let [a, b, c, e] = corners(&d, t);
            assert!(d.points.iter().all(|p| insphere(a, b, c, e, p.as_dvec3()) <= 0.0), "case {case}");
        }
    }
}

#[test]
fn small_sets_on_small_grids_have_ties_of_every_kind() {
    let mut dice = Dice::new(3);
    let (mut flat, mut doubled) = (0, 0);
    for case in 0..20_000 {
        let n = dice.below(24) as usize;
        let size = [1 + dice.below(4), 1 + dice.below(4), 1 + dice.below(4)];
        let d = triangulate((0..n).map(|_| grid_point(&mut dice, size)).collect());
        assert_eq!(fault(&d), None, "case {case}: {:?}", d.points);
        flat += u32::from(d.tetrahedra.is_empty());
        doubled += u32::from(!d.duplicates.is_empty());
    }
    assert!(flat > 1000 && doubled > 1000, "{flat} flat, {doubled} with duplicates");
}

#[test]
fn whole_grids_fill_their_box() {
    for [x, y, z] in [[2, 2, 2], [3, 4, 5], [12, 12, 12], [30, 2, 9]] {
        for scale in [1.0, 0.1] {
            let number =
                |i: u32| Vec3::new((i % x) as f32, (i / x % y) as f32, (i / (x * y)) as f32) * scale + 7.0;
            let d = triangulate((0..x * y * z).map(number).collect());
            assert_eq!((fault(&d), d.duplicates.len()), (None, 0));
            let want = f64::from((x - 1) * (y - 1) * (z - 1)) * f64::from(scale).powi(3);
            assert!((volume(&d) - want).abs() < 1e-5 * want, "{} of {want}", volume(&d));
        }
    }
}

#[test]
fn points_near_a_sphere_and_of_mixed_size_are_no_trouble() {
    let mut dice = Dice::new(4);
    let sphere = (0..400).map(|_| (point(&mut dice) * 2.0 - 1.0).normalize()).collect();
    let mixed = (0..400).map(|i| point(&mut dice) * 10f32.powi(i % 60 - 30)).collect();
    let clusters = (0..400).map(|i| Vec3::splat((i % 7) as f32 * 1000.0) + point(&mut dice) * 1e-3).collect();
    for points in [sphere, mixed, clusters] {
        let d = triangulate(points);
        assert_eq!(fault(&d), None);
        assert!(d.tetrahedra.len() > 400);
    }
}

#[test]
fn sets_without_volume_have_no_cells() {
    let line = |i: u32| Vec3::new(i as f32, 2.0 * i as f32, -(i as f32));
    let plane = |i: u32| Vec3::new(i as f32, (i * i % 7) as f32, 3.0);
    for n in [0, 1, 2, 3, 4, 50] {
        for d in [
            triangulate((0..n).map(line).collect()),
            triangulate((0..n).map(plane).collect()),
            triangulate(vec![Vec3::ONE; n as usize]),
        ] {
            assert_eq!((fault(&d), d.tetrahedra.len()), (None, 0));
        }
    }
}

#[test]
fn duplicates_are_named_once_each() {
    let mut dice = Dice::new(5);
    let mut points: Vec<Vec3> = (0..200).map(|_| point(&mut dice)).collect();
    points.extend_from_within(..);
    points.push(-points[0] * 0.0);
    points.push(points[0] * 0.0);
    let d = triangulate(points);
    assert_eq!((fault(&d), d.duplicates.len()), (None, 201));
}

#[test]
fn the_same_points_give_the_same_cells() {
    let mut dice = Dice::new(6);
    let points: Vec<Vec3> = (0..500).map(|_| grid_point(&mut dice, [9; 3])).collect();
    let (a, b) = (triangulate(points.clone()), triangulate(points));
    assert_eq!((&a.tetrahedra, &a.duplicates), (&b.tetrahedra, &b.duplicates));
}

#[test]
fn a_triangulation_can_be_cancelled() {
    let mut dice = Dice::new(8);
    assert!(Delaunay::new((0..9000).map(|_| point(&mut dice)).collect(), || true).is_none());
}

#[test]
fn the_checks_see_what_is_wrong() {
    let mut dice = Dice::new(9);
    let good = triangulate((0..40).map(|_| point(&mut dice)).collect());
    let broken = |f: &dyn Fn(&mut Delaunay)| {
        let mut bad = good.clone();
        f(&mut bad);
        fault(&bad).expect("a fault")
    };
    assert!(broken(&|d| d.tetrahedra[3].vertices.swap(0, 1)).contains("positive"));
    assert!(broken(&|d| d.tetrahedra[3].neighbors.rotate_left(1)).contains("3"));
    assert!(broken(&|d| d.points[7] = d.points[8]).len() > 3);
    assert!(broken(&|d| d.points.push(Vec3::splat(9.0))).contains("beyond"));
    assert!(broken(&|d| d.points.push(Vec3::splat(0.5))).contains("missing"));
    assert!(broken(&|d| d.duplicates.push([1, 2])).contains("duplicate"));
    assert!(broken(&|d| flip(d)).contains("sphere"));
}

/// Replaces two cells whose union is convex by the three around the segment between their far vertices.
fn flip(d: &mut Delaunay) {
    let point = |d: &Delaunay, v: u32| d.points[v as usize].as_dvec3();
    for t in 0..d.tetrahedra.len() {
        for face in 0..4 {
            let cell = d.tetrahedra[t];
            let Some(n) = cell.neighbor(face) else { continue };
            let other = d.tetrahedra[n as usize];
            let back = (0..4).find(|k| other.neighbor(*k) == Some(t as u32)).expect("mutual");
            let (near, far) = (cell.vertices[face], other.vertices[back]);
            let ring = cell.face(face);
            let made = [0, 1, 2].map(|k| [ring[k], ring[(k + 1) % 3], far, near]);
            let positive =
                |v: &[u32; 4]| orient3d(point(d, v[0]), point(d, v[1]), point(d, v[2]), point(d, v[3])) > 0.0;
            if made.iter().all(positive) {
                d.tetrahedra[t].vertices = made[0];
                d.tetrahedra[n as usize].vertices = made[1];
                d.tetrahedra.push(super::Tetrahedron { vertices: made[2], neighbors: [0; 4] });
                relink(d);
                return;
            }
        }
    }
}

fn relink(d: &mut Delaunay) {
    let mut faces = BTreeMap::<[u32; 3], Vec<(usize, usize)>>::new();
    for (t, cell) in d.tetrahedra.iter().enumerate() {
        for (face, corners) in FACES.iter().enumerate() {
            let mut key = corners.map(|k| cell.vertices[k]);
            key.sort_unstable();
            faces.entry(key).or_default().push((t, face));
        }
    }
    for sides in faces.values() {
        for (i, (t, face)) in sides.iter().enumerate() {
            d.tetrahedra[*t].neighbors[*face] = sides.get(1 - i).map_or(super::NONE, |other| other.0 as u32);
        }
    }
}
