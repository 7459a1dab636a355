//! Faces by areas: right values by hand, and against very many samples.

use glam::{vec2, vec3};

use super::analytic;
use super::faces::{Baking, Faces, Room, composed};
use super::space::Projected;
use crate::geometry::dice::Dice;
use crate::geometry::{Aabb, Flat, PrimId, Solid, Vector};
use crate::raster::fixed_light;
use crate::scene::{Material, Parts, Scene, Surfaces};

fn unit<V: Vector>() -> Aabb<V> {
    Aabb { min: V::default(), max: V::from_fn(|_| 1.0) }
}

/// Primitives with points and a color of their own each.
fn scene_of<S: Projected>(prims: &[Vec<S::Vector>], colors: &[[f32; 3]]) -> Scene<S> {
    let n = S::CORNERS as u32;
    let corners = |at: u32| S::corners_from(std::array::from_fn(|k| at * n + k as u32));
    let list = (0..prims.len() as u32).map(corners).collect();
    let mut parts = Parts::simple("faces", prims.concat(), list);
    parts.materials = colors.iter().map(|c| Material::new("one", *c)).collect();
    parts.prim_material.iter_mut().enumerate().for_each(|(at, m)| m.0 = (at % colors.len()) as u32);
    Scene::new(parts).expect("a valid scene")
}

fn baking<S: Projected>(scene: &Scene<S>, is_analytic: bool, side: u32) -> Baking<'_, S> {
    Baking { scene, surfaces: Surfaces::default(), side, is_analytic, composes: true }
}

fn faces_of<S: Projected>(scene: &Scene<S>, cell: &Aabb<S::Vector>) -> Faces {
    baking(scene, true, 1).projected(cell, scene.live(), &mut Room::default())
}

fn is_near(a: [f32; 4], b: [f32; 4]) -> bool {
    (0..4).all(|c| (a[c] - b[c]).abs() < 1e-5)
}

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.0, 1.0, 0.0];

/// The color of a primitive as faces keep it, over a share of the face.
fn share<S: Projected>(scene: &Scene<S>, prim: u32, share: f32) -> [f32; 4] {
    let light = fixed_light(scene, PrimId(prim));
    let [r, g, b] = scene.color_of(PrimId(prim)).map(|c| c * light * share);
    [r, g, b, share]
}

fn sum(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|c| a[c] + b[c])
}

/// A face is divided along its diagonal: each half is a half, and both together are the face.
#[test]
fn halves_of_a_face_are_halves() {
    let at = |x: f32, y: f32| vec3(x, y, 0.5);
    let halves =
        [vec![at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)], vec![at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]];
    for half in &halves {
        let scene = scene_of::<Solid>(std::slice::from_ref(half), &[RED]);
        let faces = faces_of(&scene, &unit());
        assert!(is_near(faces[4], share(&scene, 0, 0.5)) && is_near(faces[5], faces[4]), "{faces:?}");
        assert_eq!(faces[..4], [[0.0; 4]; 4], "edge-on it is nothing");
        // What lies outside the cell is not seen: of the cell above nothing, of the lower left quarter all of
        // it or nothing.
        let above = Aabb { min: vec3(0.0, 0.0, 0.6), max: vec3(1.0, 1.0, 1.6) };
        assert_eq!(faces_of(&scene, &above), [[0.0; 4]; 6]);
        let quarter = Aabb { min: vec3(0.0, 0.0, 0.25), max: vec3(0.5, 0.5, 0.75) };
        let is_lower = half[0].x == 0.0;
        let want = if is_lower { 1.0 } else { 0.0 };
        assert!((faces_of(&scene, &quarter)[4][3] - want).abs() < 1e-6);
    }
    let both = scene_of::<Solid>(&halves, &[RED, GREEN]);
    let want = sum(share(&both, 0, 0.5), share(&both, 1, 0.5));
    let faces = faces_of(&both, &unit());
    assert!(is_near(faces[4], want) && faces[4][3] <= 1.0, "{faces:?}");
}

/// The paper's over takes coverage in a row as unrelated; made from the primitives it is right.
#[test]
fn coverage_in_a_row_is_right_where_it_is_made_directly() {
    let opacity = |behind: f32| {
        let segment = |x: f32, y: f32| vec![vec2(x, y), vec2(x + 0.5, y)];
        let prims = [segment(0.0, 0.5), segment(1.0, 0.5), segment(behind, 1.5), segment(1.0 + behind, 1.5)];
        let scene = scene_of::<Flat>(&prims, &[RED]);
        let whole = Aabb { min: vec2(0.0, 0.0), max: vec2(2.0, 2.0) };
        let child = |octant: usize| faces_of(&scene, &crate::index::octant_of(&whole, octant));
        [composed::<glam::Vec2>(|octant, face| child(octant)[face])[2][3], faces_of(&scene, &whole)[2][3]]
    };
    assert_eq!((opacity(0.0), opacity(0.5)), ([0.75, 0.5], [0.75, 1.0]));
}

/// In flatland: [0, ½] at a half in red, before and behind [¼, ¾] at a fifth in green; the first of equally
/// near ones is seen.
#[test]
fn the_nearest_shows_of_what_overlaps() {
    let prims = [vec![vec2(0.0, 0.5), vec2(0.5, 0.5)], vec![vec2(0.25, 0.2), vec2(0.75, 0.2)]];
    let scene = scene_of::<Flat>(&prims, &[RED, GREEN]);
    let want = |red: f32, green: f32| sum(share(&scene, 0, red), share(&scene, 1, green));
    // All ends lie between the 64 samples.
    for is_analytic in [true, false] {
        let faces = baking(&scene, is_analytic, 64).projected(&unit(), scene.live(), &mut Room::default());
        assert!(is_near(faces[2], want(0.25, 0.5)) && is_near(faces[3], want(0.5, 0.25)), "{faces:?}");
    }
    let same = [prims[0].clone(), vec![vec2(0.25, 0.5), vec2(0.75, 0.5)]];
    let scene = scene_of::<Flat>(&same, &[RED, GREEN]);
    let want = sum(share(&scene, 0, 0.5), share(&scene, 1, 0.25));
    for is_analytic in [true, false] {
        let faces = baking(&scene, is_analytic, 64).projected(&unit(), scene.live(), &mut Room::default());
        assert!(is_near(faces[2], want) && is_near(faces[3], want), "{faces:?}");
    }
}

/// Two planes that cut each other along the middle of the face, z = x in red and z = 1 − x in green: from
/// below each shows where it is lower. Three bars in a ring, each over the next one, have no order either.
#[test]
fn what_has_no_order_by_depth_is_right() {
    let plane = |z: [f32; 2]| {
        let at = |x: usize, y: f32| vec3(x as f32, y, z[x]);
        [vec![at(0, 0.0), at(1, 0.0), at(1, 1.0)], vec![at(0, 0.0), at(1, 1.0), at(0, 1.0)]]
    };
    let prims: Vec<_> = plane([0.0, 1.0]).into_iter().chain(plane([1.0, 0.0])).collect();
    let scene = scene_of::<Solid>(&prims, &[RED, RED, GREEN, GREEN]);
    let faces = faces_of(&scene, &unit());
    let want = sum(share(&scene, 0, 0.5), share(&scene, 2, 0.5));
    assert!(is_near(faces[4], want) && is_near(faces[5], want), "{faces:?} {want:?}");
    // Red from the left half below, green from the right: it is not one and the same half.
    let left = Aabb { min: vec3(0.0, 0.0, 0.0), max: vec3(0.5, 1.0, 1.0) };
    let faces = faces_of(&scene, &left);
    assert!(
        is_near(faces[4], share(&scene, 0, 1.0)) && is_near(faces[5], share(&scene, 2, 1.0)),
        "{faces:?}"
    );

    // Bars from one corner of a triangle past the next: each begins low and ends high.
    let corner = |k: usize| {
        let angle = k as f32 * std::f32::consts::TAU / 3.0;
        vec3(0.5 + 0.4 * angle.cos(), 0.5 + 0.4 * angle.sin(), 0.0)
    };
    let bars: Vec<Vec<_>> = (0..3)
        .map(|k| {
            let (from, to) = (corner(k), corner((k + 1) % 3));
            let aside = (to - from).cross(glam::Vec3::Z).normalize() * 0.15;
            let low = from + vec3(0.0, 0.0, 0.2) - (to - from) * 0.1;
            vec![low - aside, low + aside, to + (to - from) * 0.1 + vec3(0.0, 0.0, 0.8)]
        })
        .collect();
    let scene = scene_of::<Solid>(&bars, &[RED, GREEN, [0.0, 0.0, 1.0]]);
    near_samples(&scene, 1.0);
}

/// The greatest difference from 65,536 samples, in space 256×256: those whose squares an edge crosses may go
/// either way. An edge as long as the face crosses at most 2·256 + 1 of them, and not all to the same side;
/// `edges`: by how many such that one and the same way is allowed for.
fn near_samples<S: Projected>(scene: &Scene<S>, edges: f32) {
    let side = if S::Vector::AXES == 2 { 1 << 16 } else { 256 };
    let sampled = baking(scene, false, side).projected(&unit(), scene.live(), &mut Room::default());
    let (areas, samples) = (faces_of(scene, &unit()), sampled);
    for face in 0..2 * S::Vector::AXES {
        let worst = (0..4).map(|c| (areas[face][c] - samples[face][c]).abs()).fold(0.0, f32::max);
        assert!(worst < 0.004 * edges, "face {face}: {:?} {:?}", areas[face], samples[face]);
        let [r, g, b, alpha] = areas[face];
        assert!(r.max(g).max(b) <= alpha + 1e-6 && (0.0..=1.0).contains(&alpha), "{:?}", areas[face]);
    }
}

/// Random primitives about the cell, most of which it cuts.
fn soup<S: Projected>(seed: u64, count: usize, size: f32) -> Scene<S> {
    let mut dice = Dice::new(seed);
    let prims: Vec<Vec<S::Vector>> = (0..count)
        .map(|_| {
            let center = S::Vector::from_fn(|_| dice.unit());
            (0..S::CORNERS).map(|_| center + dice.vector(size)).collect()
        })
        .collect();
    scene_of(&prims, &[RED, GREEN, [0.0, 0.0, 1.0], [0.7, 0.7, 0.2]])
}

fn areas_are_those_of_very_many_samples<S: Projected>() {
    for seed in 0..60 {
        let (count, size) = [(3, 0.8), (12, 0.5), (30, 0.3), (60, 0.15)][seed as usize % 4];
        near_samples(&soup::<S>(seed, count, size), 1.0);
    }
}

#[test]
fn areas_are_those_of_very_many_samples_in_both_spaces() {
    areas_are_those_of_very_many_samples::<Flat>();
    areas_are_those_of_very_many_samples::<Solid>();
}

/// Seen from its front alone, if that is asked; the other side shows what is behind.
#[test]
fn fronts_alone_are_seen_where_that_is_asked() {
    let up = vec![vec3(0.0, 0.0, 0.5), vec3(1.0, 0.0, 0.5), vec3(0.0, 1.0, 0.5)];
    let down = vec![vec3(0.0, 0.0, 0.7), vec3(0.0, 1.0, 0.7), vec3(1.0, 0.0, 0.7)];
    let scene = scene_of::<Solid>(&[up, down], &[RED, GREEN]);
    let surfaces = Surfaces { one_sided: true, ..Surfaces::default() };
    let faces =
        Baking { surfaces, ..baking(&scene, true, 1) }.projected(&unit(), scene.live(), &mut Room::default());
    // From below the first one turns away, and the second one shows through it; from above the other way.
    assert!(
        is_near(faces[4], share(&scene, 1, 0.5)) && is_near(faces[5], share(&scene, 0, 0.5)),
        "{faces:?}"
    );
    let both = faces_of(&scene, &unit());
    assert!(is_near(both[4], share(&scene, 0, 0.5)) && is_near(both[5], share(&scene, 1, 0.5)), "{both:?}");
}

/// Where light comes through, or very many are seen, a face is the mean of 64 samples a side.
#[test]
fn what_is_too_much_is_sampled() {
    let many = soup::<Solid>(5, 140, 0.05);
    let sampled = |scene: &Scene<Solid>, side| {
        baking(scene, false, side).projected(&unit(), scene.live(), &mut Room::default())
    };
    assert_eq!(faces_of(&many, &unit()), sampled(&many, analytic::SIDE));
    let fewer = soup::<Solid>(5, 12, 0.4);
    assert_ne!(faces_of(&fewer, &unit()), sampled(&fewer, analytic::SIDE));
    let mut parts = fewer.into_parts();
    parts.materials[0].see_through = true;
    let glass = Scene::new(parts).expect("a valid scene");
    assert_eq!(faces_of(&glass, &unit()), sampled(&glass, analytic::SIDE));
}
