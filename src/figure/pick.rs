//! What lies under the pointer: the nearest triangle or node box along a ray, the nearest segment to a point.
//!
//! Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", Journal of Graphics Tools 2(1),
//! 1997, without an index: a click may take the time of a pass over the primitives, and what can be picked
//! depends on what is shown. Ties go to the smaller id, so a click is the same on every machine.
//!
//! Distances are in units of the direction's length, so world units for a unit direction. O(primitives).

use glam::{Vec2, Vec3};

use crate::geometry::{Aabb, Flat, NodeId, PrimId, Solid};
use crate::scene::Scene;

/// The nearest triangle, front or back, that the ray hits and `accept` takes, and how far along the ray.
pub fn pick(
    scene: &Scene<Solid>,
    origin: Vec3,
    direction: Vec3,
    accept: impl Fn(PrimId) -> bool,
) -> Option<(PrimId, f32)> {
    let mut nearest: Option<(PrimId, f32)> = None;
    let points = scene.points();
    for &prim in scene.live() {
        let Some(corners) = scene.corners(prim) else { continue };
        let most = nearest.map_or(f32::INFINITY, |(_, t)| t);
        // Ids ascend, so a tie keeps the smaller one.
        if let Some(t) = hit(corners.map(|c| points[c as usize]), origin, direction).filter(|&t| t < most)
            && accept(prim)
        {
            nearest = Some((prim, t));
        }
    }
    nearest
}

/// Where a ray hits a triangle, edges included.
#[inline]
fn hit([a, b, c]: [Vec3; 3], origin: Vec3, direction: Vec3) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let det = ab.dot(p);
    // Scaled by the determinant, so that only a hit divides. A ray in the plane hits nothing.
    let sign = if det < 0.0 { -1.0 } else { 1.0 };
    let size = det * sign;
    let from_a = origin - a;
    let u = from_a.dot(p) * sign;
    if !(size > 0.0 && (0.0..=size).contains(&u)) {
        return None;
    }
    let q = from_a.cross(ab);
    let v = direction.dot(q) * sign;
    if v < 0.0 || u + v > size {
        return None;
    }
    let t = ac.dot(q) * sign / size;
    (t >= 0.0 && t.is_finite()).then_some(t)
}

/// The segment nearest to `point`, if it is no farther than `radius`, and its distance.
pub fn pick_segment(
    scene: &Scene<Flat>,
    point: Vec2,
    radius: f32,
    accept: impl Fn(PrimId) -> bool,
) -> Option<(PrimId, f32)> {
    let mut nearest: Option<(PrimId, f32)> = None;
    for &prim in scene.live() {
        let Some([a, b]) = scene.corners(prim).map(|c| c.map(|k| scene.points()[k as usize])) else {
            continue;
        };
        let along = b - a;
        let t = ((point - a).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
        let distance = (a + along * t).distance(point);
        if distance <= radius && nearest.is_none_or(|(_, d)| distance < d) && accept(prim) {
            nearest = Some((prim, distance));
        }
    }
    nearest
}

/// The smallest of these boxes that the ray passes through, and where it enters (0 if it starts inside). In
/// nested boxes the smallest is the one a person means; of equal boxes the first.
pub fn pick_node(
    nodes: impl IntoIterator<Item = (NodeId, Aabb<Vec3>)>,
    origin: Vec3,
    direction: Vec3,
) -> Option<(NodeId, f32)> {
    let mut smallest: Option<(f32, NodeId, f32)> = None;
    for (node, bounds) in nodes {
        let Some(t) = enter(&bounds, origin, direction) else { continue };
        let size = bounds.diagonal();
        if smallest.is_none_or(|(least, ..)| size < least) {
            smallest = Some((size, node, t));
        }
    }
    smallest.map(|(_, node, t)| (node, t))
}

/// Where a ray enters a box (Kay and Kajiya, "Ray Tracing Complex Scenes", 1986): by slabs.
fn enter(bounds: &Aabb<Vec3>, origin: Vec3, direction: Vec3) -> Option<f32> {
    let (mut first, mut last) = (0f32, f32::INFINITY);
    for axis in 0..3 {
        let (low, high) = (bounds.min[axis] - origin[axis], bounds.max[axis] - origin[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (a, b) = (low / direction[axis], high / direction[axis]);
        first = first.max(a.min(b));
        last = last.min(a.max(b));
    }
    (first <= last).then_some(first)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use rand_pcg::{Pcg32, rand_core::Rng};

    use super::*;
    use crate::scene::Parts;

    fn unit(random: &mut Pcg32) -> f32 {
        (random.next_u32() >> 8) as f32 / 8_388_608.0 - 1.0
    }
    fn vec3(random: &mut Pcg32) -> Vec3 {
        Vec3::new(unit(random), unit(random), unit(random))
    }

    fn soup(random: &mut Pcg32, triangles: u32) -> Scene<Solid> {
        let mut points = Vec::new();
        for _ in 0..triangles {
            let at = vec3(random) * 10.0;
            points.extend([at, at + vec3(random) * 3.0, at + vec3(random) * 3.0]);
        }
        let prims = (0..triangles).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Scene::new(Parts::simple("soup", points, prims)).expect("a scene")
    }

    /// Distance along the ray and the least barycentric weight, in doubles, from planes and areas.
    fn hit_exactly(points: [Vec3; 3], origin: Vec3, direction: Vec3) -> Option<(f64, f64)> {
        let [a, b, c] = points.map(Vec3::as_dvec3);
        let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
        let normal = (b - a).cross(c - a);
        let t = normal.dot(a - o) / normal.dot(d);
        let p = o + d * t;
        let weight = |u: DVec3, v: DVec3| (v - u).cross(p - u).dot(normal) / normal.length_squared();
        let least = weight(a, b).min(weight(b, c)).min(weight(c, a));
        t.is_finite().then_some((t, least))
    }

    #[test]
    fn the_nearest_triangle_is_that_of_doubles() {
        let mut random = Pcg32::new(1, 2);
        let scene = soup(&mut random, 300);
        let (mut hits, mut compared) = (0, 0);
        for _ in 0..400 {
            let (origin, direction) = (vec3(&mut random) * 12.0, vec3(&mut random).normalize_or(Vec3::X));
            let all: Vec<_> = scene
                .live()
                .iter()
                .map(|&p| {
                    (
                        p,
                        hit_exactly(
                            std::array::from_fn(|i| scene.prim_points(p).nth(i).unwrap_or_default()),
                            origin,
                            direction,
                        ),
                    )
                })
                .collect();
            // Rays that graze an edge within rounding may go either way.
            if all.iter().any(|(_, h)| h.is_some_and(|(t, w)| t > -1e-3 && w.abs() < 1e-4)) {
                continue;
            }
            let nearest = all
                .iter()
                .filter_map(|&(p, h)| h.filter(|&(t, w)| t >= 0.0 && w > 0.0).map(|(t, _)| (p, t)))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let found = pick(&scene, origin, direction, |_| true);
            assert_eq!(found.map(|f| f.0), nearest.map(|n| n.0));
            if let (Some((prim, t)), Some((_, exact))) = (found, nearest) {
                assert!((f64::from(t) - exact).abs() < 1e-4 * exact.max(1.0), "{t} {exact}");
                // Without it, something behind it or nothing is found.
                let next = pick(&scene, origin, direction, |p| p != prim);
                assert!(next.is_none_or(|(p, further)| p != prim && further >= t));
                hits += 1;
            }
            compared += 1;
        }
        assert!(hits > 100 && compared > 300, "{hits} {compared}");
    }

    #[test]
    fn ties_go_to_the_smaller_id_and_edges_belong_to_triangles() {
        let square = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let prims = vec![[0, 1, 2], [0, 2, 3], [0, 1, 2], [2, 1, 0]];
        let scene = Scene::<Solid>::new(Parts::simple("square", square.to_vec(), prims)).expect("a scene");
        let from = |x, y| pick(&scene, Vec3::new(x, y, 2.0), -Vec3::Z, |_| true);
        assert_eq!(from(0.5, 0.25), Some((PrimId(0), 2.0)));
        assert_eq!(from(0.25, 0.5), Some((PrimId(1), 2.0)));
        assert_eq!(from(0.5, 0.5), Some((PrimId(0), 2.0)), "on the diagonal");
        assert_eq!(from(1.5, 0.5), None);
        assert_eq!(pick(&scene, Vec3::new(0.5, 0.25, 2.0), Vec3::Z, |_| true), None, "behind the origin");
        assert_eq!(pick(&scene, Vec3::new(-1.0, 0.5, 0.0), Vec3::X, |_| true), None, "in the plane");
        assert_eq!(
            pick(&scene, Vec3::new(0.5, 0.25, 2.0), -Vec3::Z, |p| p.0 > 2),
            Some((PrimId(3), 2.0)),
            "from the back"
        );
    }

    #[test]
    fn the_nearest_segment_within_the_radius() {
        let points = vec![Vec2::ZERO, Vec2::new(4.0, 0.0), Vec2::new(4.0, 3.0)];
        let scene = Scene::<Flat>::new(Parts::simple("corner", points, vec![[0, 1], [1, 2], [0, 1]]))
            .expect("a scene");
        let at = |x, y, r| pick_segment(&scene, Vec2::new(x, y), r, |_| true);
        assert_eq!(at(1.0, 0.5, 1.0), Some((PrimId(0), 0.5)));
        assert_eq!(at(3.5, 2.0, 1.0), Some((PrimId(1), 0.5)));
        assert_eq!(at(-3.0, -4.0, 5.0), Some((PrimId(0), 5.0)), "past its end");
        assert_eq!(at(1.0, 0.5, 0.4), None);
        assert_eq!(pick_segment(&scene, Vec2::new(1.0, 0.5), 1.0, |p| p.0 == 2), Some((PrimId(2), 0.5)));
    }

    #[test]
    fn the_smallest_box_on_the_ray_against_sampled_points() {
        let cube = |half: f32, x: f32| Aabb {
            min: Vec3::new(x - half, -half, -half),
            max: Vec3::new(x + half, half, half),
        };
        let nodes = [
            (NodeId(0), cube(8.0, 0.0)),
            (NodeId(1), cube(2.0, -4.0)),
            (NodeId(2), cube(1.0, 4.0)),
            (NodeId(3), cube(1.0, 4.0)),
        ];
        let along = |origin, direction| pick_node(nodes, origin, direction);
        assert_eq!(along(Vec3::new(-20.0, 0.0, 0.0), Vec3::X), Some((NodeId(2), 23.0)));
        assert_eq!(along(Vec3::new(-20.0, 1.5, 0.0), Vec3::X), Some((NodeId(1), 14.0)));
        assert_eq!(along(Vec3::new(-20.0, 5.0, 0.0), Vec3::X), Some((NodeId(0), 12.0)));
        assert_eq!(along(Vec3::new(-20.0, 9.0, 0.0), Vec3::X), None);
        assert_eq!(along(Vec3::new(4.5, 0.0, 0.0), Vec3::X), Some((NodeId(2), 0.0)), "from inside");
        assert_eq!(along(Vec3::new(20.0, 0.0, 0.0), Vec3::X), None, "behind the origin");
        let mut random = Pcg32::new(3, 4);
        for _ in 0..500 {
            let (origin, direction) = (vec3(&mut random) * 20.0, vec3(&mut random).normalize_or(Vec3::X));
            let passes =
                |b: &Aabb<Vec3>| (0..8000).any(|i| b.contains(origin + direction * (i as f32 * 0.01)));
            let sampled = [1, 2].map(|i: usize| passes(&nodes[i].1));
            let found = along(origin, direction).map(|f| f.0);
            // Samples may miss a clipped corner, but never hit what the ray misses.
            assert!(!sampled[1] || found == Some(NodeId(2)));
            assert!(!sampled[0] || matches!(found, Some(NodeId(1 | 2))));
        }
    }
}
