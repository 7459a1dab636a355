//! `generate:swarm`: animals and teapots that drift and turn, each by itself, seen from among them.
//!
//! After the dynamic environment of Zhang et al. (1997, Sections 5.5 and 6.2, Figure 12): dinosaurs and
//! teapots of 986,800 polygons, each in its own motion. Here they stand around the sites of a face-centered
//! lattice, which packs most bodies into a ball, and turn around their centers while these go round in small
//! circles: loops of [`FRAMES`] frames that begin where the stored points are. The eye goes round inside, in
//! a ring that bodies keep out of, and looks through the middle. Cost: O(polygons).

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::creatures::{saurian, teapot};
use super::plan::signed;
use super::shapes::{Sink, circle};
use super::tree::direction;
use super::walk::sight;
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values};
use crate::geometry::{Solid, ViewPath};
use crate::scene::assemble::assemble;
use crate::scene::mesh::Mesh;
use crate::scene::{Object, Pose, Report};

pub(super) const GENERATOR: Generator = Generator {
    name: "swarm",
    meaning: "animals and teapots that drift and turn, each by itself, so many that few are seen from among \
              them; after the dynamic environment of Zhang et al. 1997",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 987_000,
            min: 10_000,
            max: 8_000_000,
            meaning: "triangles, met within 2 percent",
        },
        GeneratorParam {
            name: "bodies",
            default: 0,
            min: 0,
            max: 20_000,
            meaning: "bodies, which share the triangles; 0 chooses them by the number of polygons (1,600 \
                      for 987,000)",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses sizes, colors and motions",
        },
    ],
    make,
};

/// Frames of a motion, and views of the path: each view sees the frame of its number.
const FRAMES: u32 = 120;
/// From the center of a body to that of the nearest others, m.
const APART: f64 = 1.08;
/// The greatest size of a body against that of its kind, which is some 1.2 m around its center.
const SIZE: f64 = 0.58;
/// How far a center lies from its site at most, so that no row of sites lets one look through, m.
const LOOSE: f64 = 0.07;
/// Radius of the circle in which a center goes round, m.
const DRIFT: f64 = 0.06;
/// From the way of the eye to the nearest center, m: no body reaches as far.
const CLEAR: f64 = 1.0;
/// Triangles of a body at least.
const LEAST: u64 = 200;

const MATERIALS: &[(&str, [f32; 3])] = &[
    ("eye", [0.05, 0.04, 0.04]),
    ("knob", [0.62, 0.47, 0.20]),
    ("skin green", [0.22, 0.40, 0.18]),
    ("skin olive", [0.42, 0.43, 0.20]),
    ("skin brown", [0.42, 0.28, 0.16]),
    ("skin gray", [0.38, 0.41, 0.44]),
    ("glaze white", [0.80, 0.79, 0.74]),
    ("glaze blue", [0.14, 0.26, 0.52]),
    ("glaze red", [0.56, 0.13, 0.11]),
    ("glaze copper", [0.66, 0.38, 0.22]),
];
const SKIN: u32 = 2;
const GLAZE: u32 = 6;
/// Colors of each kind.
const COLORS: u32 = 4;

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (polygons, seed) = (values.get("polygons"), values.get("seed"));
    let wanted = match values.get("bodies") {
        0 => ((1600.0 * (polygons as f64 / 987_000.0).sqrt() + 0.5) as u64).min(polygons / LEAST),
        given => given,
    };
    let each = polygons / wanted;
    if each < LEAST {
        let why = format!("{wanted} bodies of {each} triangles: give more polygons or fewer bodies");
        return Err(SceneError::Format { path: source.to_owned(), why });
    }
    progress.report(0.1, "modeling");
    let kinds = [model(|sink| saurian(sink, each, [SKIN, 0])), model(|sink| teapot(sink, each, [GLAZE, 1]))];
    let order = in_order(kinds.each_ref().map(|kind| kind.faces.len() as u64), polygons, seed);
    let (sites, ring) = sites(order.len());
    let mut mesh = Mesh { materials: Sink::keeping(MATERIALS).into_mesh().materials, ..Mesh::default() };
    let mut motions = Vec::with_capacity(sites.len());
    for (k, (kind, site)) in order.into_iter().zip(sites).enumerate() {
        if progress.cancelled() {
            return Err(SceneError::Cancelled(source.to_owned()));
        }
        let rng = &mut Pcg32::new(seed.wrapping_mul(1_000_003).wrapping_add(k as u64), 50 + kind as u64);
        let (name, group) = [("saurian", "saurians"), ("teapot", "teapots")][kind];
        mesh.objects.push(Object { name: format!("{name}_{k}"), group: group.into(), motion: None });
        let site = site + direction(rng) * (LOOSE * signed(rng));
        stand(&mut mesh, &kinds[kind], site, rng);
        motions.push((site, Way::drawn(rng)));
    }
    let rest = Part { whole: progress, start: 0.3, length: 0.7 };
    let mut parts = assemble(mesh, "swarm", source, options, Report::default(), &rest)?;
    let origin = parts.origin;
    for (object, (site, way)) in parts.objects.iter_mut().zip(motions) {
        object.motion = Some((0..FRAMES).map(|frame| way.pose(site - origin, frame)).collect());
    }
    parts.paths = views(ring, origin);
    Ok(parts)
}

/// Which kind each body is of, if one of each kind has so many triangles: the kinds take turns until another
/// body would lead farther away from the wanted number than none, and are then shuffled.
fn in_order(triangles: [u64; 2], wanted: u64, seed: u64) -> Vec<usize> {
    let mut order = Vec::new();
    let mut total = 0;
    for (kind, more) in triangles.into_iter().enumerate().cycle() {
        if total + more / 2 > wanted || more == 0 {
            break;
        }
        order.push(kind);
        total += more;
    }
    let rng = &mut Pcg32::new(seed, 49);
    for k in (1..order.len()).rev() {
        order.swap(k, rng.next_u32() as usize % (k + 1));
    }
    order
}

/// A body as a mesh of triangles whose corners are shared.
fn model(draw: impl Fn(&mut Sink)) -> Mesh {
    let mut sink = Sink::keeping(MATERIALS);
    draw(&mut sink);
    let mut mesh = sink.into_mesh();
    let mut places = BTreeMap::new();
    let mut points = Vec::new();
    for corner in &mut mesh.corners {
        let point = mesh.points[*corner as usize];
        // −0 becomes 0, so that equal points have equal bits.
        let key = (point + DVec3::ZERO).to_array().map(f64::to_bits);
        *corner = *places.entry(key).or_insert_with(|| {
            points.push(point);
            points.len() as u32 - 1
        });
    }
    mesh.points = points;
    mesh
}

/// Sets up a body at a site: its size, where it looks, how it leans and its color by lot.
fn stand(mesh: &mut Mesh, kind: &Mesh, site: DVec3, rng: &mut Pcg32) {
    let size = SIZE * (0.92 + 0.08 * signed(rng));
    let (c, s) = circle(rng.next_u32() % 4096, 4096);
    let lean = DVec3::new(0.3 * signed(rng), 1.0, 0.3 * signed(rng)).normalize();
    let ahead = DVec3::new(c, 0.0, s).cross(lean).normalize();
    let aside = ahead.cross(lean);
    let color = rng.next_u32() % COLORS;
    let (object, first) = (mesh.objects.len() as u32 - 1, mesh.points.len() as u32);
    mesh.points.extend(kind.points.iter().map(|p| site + (ahead * p.x + lean * p.y + aside * p.z) * size));
    for (ring, face) in kind.rings().zip(&kind.faces) {
        let corners: [u32; 3] = std::array::from_fn(|i| first + ring[i]);
        let material = if face.material < SKIN { face.material } else { face.material + color };
        mesh.push(&corners, object, material);
    }
}

/// How a body moves: once around an axis through its center, which goes once round a circle.
struct Way {
    axis: DVec3,
    /// From the center of the circle to where it begins, and a quarter later, m.
    circle: [DVec3; 2],
}

impl Way {
    fn drawn(rng: &mut Pcg32) -> Self {
        let (axis, from, other) = (direction(rng), direction(rng), direction(rng));
        let across = from.cross(other).normalize_or(DVec3::Y);
        Self { axis, circle: [from * DRIFT, across * DRIFT] }
    }
    /// The pose of a frame for a body whose center is stored at `center`. A pose turns about the origin, so
    /// the center is brought back to its place.
    fn pose(&self, center: DVec3, frame: u32) -> Pose {
        let (c, s) = circle(frame % FRAMES, FRAMES);
        let here = center + self.circle[0] * (c - 1.0) + self.circle[1] * s;
        let (half_c, half_s) = circle(frame % FRAMES, 2 * FRAMES);
        let turn = self.axis * half_s;
        let turn = DQuat::from_xyzw(turn.x, turn.y, turn.z, half_c);
        Pose {
            rotation: turn.to_array().map(|v| v as f32),
            translation: (here - turn * center).to_array().map(|v| v as f32),
        }
    }
}

/// The sites of so many bodies, those nearest to the middle first, and the radius of the ring that they keep
/// clear of.
fn sites(count: usize) -> (Vec<DVec3>, f64) {
    // Points of a cubic lattice whose coordinates add up to an even number are face-centered cubic; there are
    // two cells to a site.
    let step = APART * std::f64::consts::FRAC_1_SQRT_2;
    let mut reach = 2;
    let nearest = |reach: i32, ring: Option<f64>| {
        let range = -reach..=reach;
        let mut all = Vec::new();
        for (i, j) in range.clone().flat_map(|i| range.clone().map(move |j| (i, j))) {
            for k in range.clone().filter(|k| (i + j + k) % 2 == 0) {
                let site = DVec3::new(f64::from(i), f64::from(j), f64::from(k)) * step;
                let out = (site.x * site.x + site.z * site.z).sqrt();
                let from_ring = |ring: f64| (out - ring) * (out - ring) + site.y * site.y;
                let square = i * i + j * j + k * k;
                if square <= reach * reach
                    && ring.is_none_or(|r| from_ring(r) >= (CLEAR + LOOSE) * (CLEAR + LOOSE))
                {
                    all.push((square, [i, j, k], site));
                }
            }
        }
        all.sort_unstable_by_key(|(square, at, _)| (*square, *at));
        all
    };
    loop {
        let (solid, ring) = (nearest(reach, None), |at: DVec3| RING * at.length());
        if let Some(ring) = solid.get(count.saturating_sub(1)).map(|(.., at)| ring(*at)) {
            let all = nearest(reach, Some(ring));
            if all.len() >= count {
                return (all.into_iter().take(count).map(|(.., site)| site).collect(), ring);
            }
        }
        reach += 1 + reach / 4;
    }
}

/// Radius of the eye's ring against that of the ball of bodies.
const RING: f64 = 0.6;

/// Round in the ring once, and two single views: from inside, and of all from outside.
fn views(ring: f64, origin: DVec3) -> Vec<ViewPath<Solid>> {
    let far = 8.0 * ring.max(1.0);
    let inside = |k: u32| {
        let (c, s) = circle(k, FRAMES);
        sight(DVec3::new(c, 0.0, s) * ring - origin, -origin, far)
    };
    let outside = sight(DVec3::new(0.5, 0.35, 0.8) * (4.0 * ring) - origin, -origin, far);
    vec![
        ViewPath { name: "ring".into(), views: (0..FRAMES).map(inside).collect() },
        ViewPath { name: "views".into(), views: vec![inside(0), outside] },
    ]
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::{Quiet, Scene};

    fn swarm(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a swarm")).expect("a scene")
    }

    #[test]
    fn any_budget_is_met_within_two_percent() {
        for call in ["polygons=10000", "polygons=100000&bodies=20&seed=7", "polygons=987000"] {
            let scene = swarm(&format!("swarm?{call}"));
            let want: f64 =
                call["polygons=".len()..].split('&').next().and_then(|n| n.parse().ok()).expect("a number");
            let got = scene.prim_count() as f64;
            assert!((got - want).abs() < 0.02 * want, "{call}: {got}");
            assert_eq!(scene.report().dropped_total(), 0, "{call}: {:?}", scene.report());
            let views = scene.paths().iter().flat_map(|p| &p.views);
            assert!(views.into_iter().all(|v| v.eye.fault().is_none()));
        }
        let error = generate("swarm?polygons=10000&bodies=1000", &LoadOptions::default(), &Quiet)
            .expect_err("too many bodies");
        assert!(error.to_string().contains("fewer bodies"), "{error}");
    }

    #[test]
    fn the_same_seed_gives_the_same_swarm_and_another_one_another() {
        let hash = |call: &str| swarm(call).hash_hex();
        assert_ne!(hash("swarm?polygons=10000&seed=4"), hash("swarm?polygons=10000&seed=5"));
        // Machines must agree, so the bits are written down.
        assert_eq!(
            hash("swarm?polygons=10000&seed=4"),
            "4ea7b0f1e9c5a02636aa05925a948e2e467aa0a1e022c7df7c755ceadc2ba475"
        );
    }

    /// Each edge belongs to two triangles, which go along it in opposite directions, and what they enclose is
    /// more than nothing: so all look outward.
    #[test]
    fn bodies_are_closed_and_look_outward() {
        for call in ["swarm?polygons=10000", "swarm?polygons=60000&bodies=12"] {
            let scene = swarm(call);
            let mut edges = vec![BTreeSet::new(); scene.objects().len()];
            let mut volumes = vec![0.0; scene.objects().len()];
            for &prim in scene.live() {
                let object = scene.object_of(prim).at();
                let corners = scene.corners(prim).expect("live");
                for k in 0..3 {
                    let edge = (corners[k], corners[(k + 1) % 3]);
                    assert!(edges[object].insert(edge), "{call}: an edge that goes the same way twice");
                }
                let [a, b, c] = corners.map(|k| scene.points()[k as usize].as_dvec3());
                volumes[object] += a.dot(b.cross(c)) / 6.0;
            }
            for (object, edges) in edges.iter().enumerate() {
                let name = &scene.objects()[object].name;
                assert!(edges.iter().all(|(a, b)| edges.contains(&(*b, *a))), "{call}: {name} is open");
                assert!(volumes[object] > 0.02, "{call}: {name} encloses {} m³", volumes[object]);
            }
        }
    }

    /// A motion begins where the points are stored, ends a step before that, and turns a body about its own
    /// center, which stays near; no body ever reaches the eye that passes in the same frame.
    #[test]
    fn bodies_turn_about_themselves_and_keep_clear_of_the_eye() {
        let scene = swarm("swarm?polygons=20000&seed=3");
        assert_eq!(scene.frame_count(), FRAMES as usize);
        let mut points = vec![BTreeSet::new(); scene.objects().len()];
        for &prim in scene.live() {
            points[scene.object_of(prim).at()].extend(scene.corners(prim).expect("live"));
        }
        let ring = &scene.paths()[0].views;
        assert_eq!(ring.len(), FRAMES as usize);
        for (object, points) in scene.objects().iter().zip(&points) {
            let motion = object.motion.as_deref().expect("it moves");
            let all = || points.iter().map(|k| scene.points()[*k as usize]);
            let bounds = crate::geometry::Aabb::of(all());
            assert!(all().all(|p| motion[0].apply(p).distance(p) < 1e-5), "{}", object.name);
            let reach = all().map(|p| p.distance(bounds.center())).fold(0.0, f32::max);
            let mut turned = false;
            for (frame, pose) in motion.iter().enumerate() {
                let center = pose.apply(bounds.center());
                // The center of the bounds is not quite that of the body.
                assert!(center.distance(bounds.center()) < 0.5, "{} frame {frame}", object.name);
                assert!(center.distance(ring[frame].eye.position) > 0.1, "{} frame {frame}", object.name);
                if center.distance(ring[frame].eye.position) < reach + 0.1 {
                    let near = all().map(|p| pose.apply(p).distance(ring[frame].eye.position));
                    assert!(near.fold(f32::MAX, f32::min) > 0.1, "{} frame {frame}", object.name);
                }
                let next = motion[(frame + 1) % motion.len()];
                let step = all().map(|p| pose.apply(p).distance(next.apply(p))).fold(0.0, f32::max);
                assert!(step < 0.06, "{} jumps {step} m after frame {frame}", object.name);
                turned |= all().any(|p| pose.apply(p).distance(p) > 0.5);
            }
            assert!(turned, "{} does not turn", object.name);
        }
    }
}
