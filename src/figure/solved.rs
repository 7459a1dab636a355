//! Space on paper as vectors with hidden surfaces solved: polygons in an order in which each may be painted
//! over those before it.
//!
//! A binary space partition of the polygons (Fuchs, Kedem and Naylor 1980, "On visible surface generation by
//! a priori tree structures"), walked from the far side of each plane to the near one. Polygons that
//! a plane cuts become two, so what pierces each other comes out right too; a cut is no edge of the picture.

use glam::{DVec3, Vec2, Vec3};

use super::place::Camera;
use crate::drawing::{Drawing, Layer, Mark, Role, Subject};
use crate::geometry::{Solid, View};

/// A surface of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Its corners, convex and planar, world coordinates.
    pub points: Vec<Vec3>,
    /// Whether the side from each corner to the next one is outlined.
    pub is_edge: Vec<bool>,
    /// Its color (sRGB); without one it hides nothing, and only its outline shows, over everything.
    pub rgb: Option<[u8; 3]>,
    /// What it means, which gives the line its pattern.
    pub role: Role,
    /// What it stands for.
    pub subject: Subject,
}

/// Pieces into which cuts may part surfaces, for each surface and at least.
const PIECES: usize = 40;
const FEW: usize = 20_000;

/// Surfaces on paper as `observer` sees them, whose image fills the rectangle from `min_pt` to `max_pt`: what
/// is nearer hides what is behind, once it is painted in this order. What lies before the near plane is cut
/// off. `None` if they cut each other into too many pieces.
pub fn solved(faces: &[Face], observer: &View<Solid>, min_pt: Vec2, max_pt: Vec2) -> Option<Drawing> {
    let camera = Camera::new(observer, min_pt, max_pt);
    // In clip coordinates, where the eye is the origin: planes stay planes.
    let near = Plane { normal: DVec3::Z, at: f64::from(observer.eye.near) };
    let before = |(of, face): (usize, &Face)| {
        let points: Vec<DVec3> = face.points.iter().map(|&p| camera.clip(p).as_dvec3()).collect();
        // What is beside, above or below the picture needs no place in it.
        let is_beside = [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)]
            .iter()
            .any(|&(axis, sign)| points.iter().all(|p| p[axis] * sign > p.z));
        let piece = Piece { points, is_edge: face.is_edge.clone(), of };
        let [_, front] = piece.cut(&near, 0.0);
        front.filter(|_| !is_beside)
    };
    let (solid, open): (Vec<_>, Vec<_>) =
        (faces.iter().enumerate().filter_map(before)).partition(|piece| faces[piece.of].rgb.is_some());
    let most = (solid.len() * PIECES).max(FEW);
    let mut paper = Drawing::default();
    for piece in ordered(solid, DVec3::ZERO, most)?.into_iter().chain(open) {
        let face = &faces[piece.of];
        let points = piece.points.iter().map(|p| camera.paper(p.as_vec3())).collect();
        let mark = Mark::Facet { points, is_edge: piece.is_edge, rgb: face.rgb };
        paper.push(Layer::Scene, face.role, face.subject, mark);
    }
    Some(paper)
}

/// A polygon of a picture, or a piece of one.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    /// Its corners, convex and planar.
    points: Vec<DVec3>,
    /// Whether the side from each corner to the next one is an edge of the polygon, not a cut.
    is_edge: Vec<bool>,
    /// Which polygon.
    of: usize,
}

impl Piece {
    /// The parts of it behind and before a plane; what is within `thick` of it counts for neither.
    fn cut(self, plane: &Plane, thick: f64) -> [Option<Self>; 2] {
        let sides: Vec<f64> = self.points.iter().map(|&p| plane.side(p)).collect();
        let has = |sign: f64| sides.iter().any(|s| s * sign > thick);
        match (has(-1.0), has(1.0)) {
            (true, true) => [self.part(&sides, -1.0), self.part(&sides, 1.0)],
            (false, _) => [None, Some(self)],
            (true, false) => [Some(self), None],
        }
    }
    /// The part on one side of a plane that cuts it.
    fn part(&self, sides: &[f64], sign: f64) -> Option<Self> {
        let (n, mut part) = (self.points.len(), Self { points: vec![], is_edge: vec![], of: self.of });
        for k in 0..n {
            let (a, b) = (sides[k] * sign, sides[(k + 1) % n] * sign);
            let crossing = || {
                let (from, to) = (self.points[k], self.points[(k + 1) % n]);
                from + (to - from) * (a / (a - b))
            };
            if a >= 0.0 {
                part.points.push(self.points[k]);
                part.is_edge.push(self.is_edge[k]);
                if b < 0.0 && a > 0.0 {
                    part.points.push(crossing());
                    part.is_edge.push(false);
                } else if b < 0.0 {
                    // It goes on along the plane.
                    *part.is_edge.last_mut()? = false;
                }
            } else if b > 0.0 {
                part.points.push(crossing());
                part.is_edge.push(self.is_edge[k]);
            }
        }
        (part.points.len() > 2).then_some(part)
    }
}

#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: DVec3,
    at: f64,
}

impl Plane {
    /// The plane of a polygon; `None` if it has no area.
    fn of(points: &[DVec3]) -> Option<Self> {
        let next = |k: usize| points[(k + 1) % points.len()];
        let normal: DVec3 =
            (0..points.len()).map(|k| (points[k] - points[0]).cross(next(k) - points[0])).sum();
        let normal = normal.try_normalize()?;
        Some(Self { normal, at: normal.dot(points[0]) })
    }
    fn side(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.at
    }
}

struct Node {
    plane: Plane,
    /// What lies in the plane.
    within: Vec<Piece>,
    /// Behind and before it.
    children: [Option<usize>; 2],
}

/// Polygons that are looked at to find a plane that cuts few others, and others that it is tried on.
const CANDIDATES: usize = 8;
const TRIED: usize = 96;
/// Thickness of planes, of the picture's extent: corners are no more exact.
const THICK: f64 = 2e-6;

/// Polygons from the farthest to the nearest as seen from `eye`, cut where they must be; `None` if they
/// become more than `most`. Of those that lie in one plane the first comes last, as it does in images.
fn ordered(polygons: Vec<Piece>, eye: DVec3, most: usize) -> Option<Vec<Piece>> {
    let extent = polygons.iter().flat_map(|p| &p.points).map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let nodes = built(polygons, extent * THICK, most)?;
    let mut sorted = Vec::new();
    // Either a node that is to be walked, or one whose own polygons are to be painted.
    let mut open = vec![(0, false)];
    while let Some((at, is_walked)) = open.pop() {
        let Some(node) = nodes.get(at) else { continue };
        if is_walked {
            let mut within = node.within.clone();
            within.sort_by_key(|piece| std::cmp::Reverse(piece.of));
            sorted.extend(within);
            continue;
        }
        let near = usize::from(node.plane.side(eye) > 0.0);
        open.extend(node.children[near].map(|child| (child, false)));
        open.push((at, true));
        open.extend(node.children[1 - near].map(|child| (child, false)));
    }
    Some(sorted)
}

/// The tree; its first node is the root.
fn built(polygons: Vec<Piece>, thick: f64, most: usize) -> Option<Vec<Node>> {
    let (mut nodes, mut count): (Vec<Node>, usize) = (Vec::new(), polygons.len());
    let mut open = vec![(polygons, None::<(usize, usize)>)];
    while let Some((all, parent)) = open.pop() {
        let Some(plane) = splitter(&all, thick) else { continue };
        let at = nodes.len();
        if let Some((parent, side)) = parent {
            nodes[parent].children[side] = Some(at);
        }
        let before = all.len();
        let [mut behind, mut front, mut within] = [vec![], vec![], vec![]];
        for piece in all {
            if piece.points.iter().all(|&p| plane.side(p).abs() <= thick) {
                within.push(piece);
                continue;
            }
            let [low, high] = piece.cut(&plane, thick);
            behind.extend(low);
            front.extend(high);
        }
        count = count + behind.len() + front.len() + within.len() - before;
        if count > most {
            return None;
        }
        nodes.push(Node { plane, within, children: [None; 2] });
        for (side, some) in [behind, front].into_iter().enumerate().filter(|(_, some)| !some.is_empty()) {
            open.push((some, Some((at, side))));
        }
    }
    Some(nodes)
}

/// The plane of a polygon that cuts few of the others and parts them evenly; what has no area has none.
fn splitter(all: &[Piece], thick: f64) -> Option<Plane> {
    let every = |count: usize| all.iter().step_by(all.len().div_ceil(count).max(1));
    let cost = |plane: &Plane| {
        let (mut cuts, mut sum) = (0, 0_i64);
        for piece in every(TRIED) {
            let sides = piece.points.iter().map(|&p| plane.side(p));
            let (low, high) = sides.fold((0.0_f64, 0.0_f64), |(l, h), s| (l.min(s), h.max(s)));
            match (low < -thick, high > thick) {
                (true, true) => cuts += 1,
                (true, false) => sum -= 1,
                (false, true) => sum += 1,
                (false, false) => {}
            }
        }
        4 * cuts + sum.abs()
    };
    let planes = every(CANDIDATES).filter_map(|piece| Plane::of(&piece.points));
    let best = planes.min_by_key(cost);
    best.or_else(|| all.iter().find_map(|piece| Plane::of(&piece.points)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::Rng;

    fn whole(points: Vec<DVec3>, of: usize) -> Piece {
        Piece { is_edge: vec![true; points.len()], points, of }
    }

    fn triangles(seed: u64, n: usize) -> Vec<Piece> {
        let mut rng = Pcg32::new(seed, 3);
        let mut unit = move || f64::from(rng.next_u32() >> 8) / f64::from(1_u32 << 24);
        let mut near = move |c: DVec3, r: f64| c + (dvec3(unit(), unit(), unit()) - 0.5) * r;
        let center = |near: &mut dyn FnMut(DVec3, f64) -> DVec3| near(DVec3::ZERO, 6.0);
        (0..n)
            .map(|k| {
                let c = center(&mut near);
                whole((0..3).map(|_| near(c, 3.0)).collect(), k)
            })
            .collect()
    }

    /// Where a ray from the eye meets a polygon, in lengths of its direction.
    fn hit(points: &[DVec3], eye: DVec3, toward: DVec3) -> Option<f64> {
        let plane = Plane::of(points)?;
        let t = -plane.side(eye) / plane.normal.dot(toward);
        let at = eye + toward * t;
        let n = points.len();
        let is_left =
            |k: usize| plane.normal.dot((points[(k + 1) % n] - points[k]).cross(at - points[k])) >= 0.0;
        (t > 0.0 && (0..n).all(is_left)).then_some(t)
    }

    /// What is painted last along a ray is what the ray meets first, by every polygon's plane alone; also of
    /// triangles that pierce each other.
    #[test]
    fn the_last_painted_is_the_nearest() {
        let (mut met, mut cut) = (0, 0);
        for seed in 0..6 {
            let all = triangles(seed, 60);
            let eye = dvec3(0.3, -7.0, 0.9);
            let sorted = ordered(all.clone(), eye, 100_000).expect("few enough");
            cut += sorted.len() - all.len();
            for k in 0..900 {
                let (x, z) = (f64::from(k % 30) / 15.0 - 0.97, f64::from(k / 30) / 15.0 - 0.97);
                let toward = dvec3(x, 1.0, z);
                let nearest = all.iter().filter_map(|p| Some((hit(&p.points, eye, toward)?, p.of)));
                let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
                let painted = sorted.iter().rev().find(|p| hit(&p.points, eye, toward).is_some());
                assert_eq!(painted.map(|p| p.of), nearest.map(|n| n.1), "seed {seed}, ray {k}");
                met += usize::from(nearest.is_some());
            }
        }
        assert!(met > 1000 && cut > 100, "{met} rays met something, {cut} cuts");
    }

    /// Pieces cover what they are of, and their edges are parts of its edges: all of them, and no cuts.
    #[test]
    fn cuts_are_no_edges() {
        let all = triangles(9, 40);
        let sorted = ordered(all.clone(), dvec3(0.0, -9.0, 0.0), 100_000).expect("few enough");
        let length = |piece: &Piece| -> f64 {
            let n = piece.points.len();
            let side = |k: usize| (piece.points[(k + 1) % n] - piece.points[k]).length();
            (0..n).filter(|&k| piece.is_edge[k]).map(side).sum()
        };
        let area = |points: &[DVec3]| -> f64 {
            let side = |k: usize| (points[k] - points[0]).cross(points[(k + 1) % points.len()] - points[0]);
            0.5 * (0..points.len()).map(side).sum::<DVec3>().length()
        };
        for whole in &all {
            let of = || sorted.iter().filter(|p| p.of == whole.of);
            let (edges, areas) = (of().map(length).sum::<f64>(), of().map(|p| area(&p.points)).sum::<f64>());
            assert!((edges - length(whole)).abs() < 1e-4, "{edges} of {}", length(whole));
            assert!((areas - area(&whole.points)).abs() < 1e-4);
        }
    }

    /// A plane through a corner cuts the side that it meets, and along it there is no edge.
    #[test]
    fn a_plane_may_pass_through_corners() {
        let corners = [[-1.0, 0.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
        let rhomb = whole(corners.map(|[x, y]| dvec3(x, y, 1.0)).to_vec(), 0);
        let plane = Plane { normal: DVec3::X, at: 0.0 };
        for part in rhomb.cut(&plane, 1e-9).map(|part| part.expect("on both sides")) {
            let upright = |k: usize| part.points[k].x == 0.0 && part.points[(k + 1) % 3].x == 0.0;
            assert_eq!(part.points.len(), 3);
            assert!((0..3).all(|k| part.is_edge[k] != upright(k)), "{part:?}");
        }
    }

    /// Of polygons in one plane the first is on top, as in images; what is too much is refused.
    #[test]
    fn ties_go_to_the_first() {
        let square = |at: f64, of| {
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            whole(corners.map(|[x, z]| dvec3(x + at, 2.0, z)).to_vec(), of)
        };
        let all = vec![square(0.0, 0), square(0.5, 1), square(0.2, 2)];
        let sorted = ordered(all, DVec3::ZERO, 10).expect("few enough");
        assert_eq!(sorted.iter().map(|p| p.of).collect::<Vec<_>>(), [2, 1, 0]);
        assert_eq!(ordered(triangles(2, 50), DVec3::ZERO, 60), None);
        assert_eq!(ordered(vec![], DVec3::ZERO, 10), Some(vec![]));
    }
}
