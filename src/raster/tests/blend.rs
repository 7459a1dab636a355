//! Color cubes over an image: each sample meets one face, walls of cubes have no crack, and nothing is drawn
//! that geometry hides.

use glam::{vec2, vec3};

use super::*;
use crate::geometry::{Aabb, Flat, NodeId, Vector};
use crate::raster::blend::draw_in_order;

/// A box whose faces are all the same.
fn cube<V: Vector>(min: V, max: V, face: [f32; 4]) -> StandIn<V> {
    StandIn { node: NodeId(0), bounds: Aabb { min, max }, faces: CubeFaces::new(&[face; 6]), after: 0 }
}

fn over<S: Drawable>(boxes: &[StandIn<S::Vector>], image: &Target, view: &View<S>, threads: usize) -> Canvas {
    let mut canvas = Canvas::default();
    canvas.clear(view);
    canvas.composite(boxes, image, view, &Options { threads, ..Options::default() });
    canvas
}

fn sample(canvas: &Canvas, at: usize) -> [f32; 4] {
    canvas.samples().nth(at).expect("a sample of the image")
}

/// Within the steps of the bytes that faces are kept in.
fn is_near(a: [f32; 4], b: [f32; 4]) -> bool {
    (0..4).all(|c| (a[c] - b[c]).abs() < 0.01)
}

/// Flatland's line of pixels from below, looking up.
fn flat_view(width: u32) -> View<Flat> {
    let (position, target) = (vec2(0.0, -1.0), vec2(0.0, 0.0));
    let fov = std::f32::consts::FRAC_PI_2;
    View { eye: Eye { position, target, up: vec2(0.0, 1.0), fov, near: 0.1, far: 100.0 }, width, height: 1 }
}

/// Porter and Duff 1984: three half-covered cells, red, green and blue from the eye, before black.
#[test]
fn cells_along_a_ray_are_composited_front_to_back() {
    let view = flat_view(3);
    let cell = |at: f32, color: [f32; 3]| {
        let [r, g, b] = color;
        cube(vec2(-0.5, at), vec2(0.5, at + 1.0), [r * 0.5, g * 0.5, b * 0.5, 0.5])
    };
    let boxes = [cell(1.0, [1.0, 0.0, 0.0]), cell(2.0, [0.0, 1.0, 0.0]), cell(3.0, [0.0, 0.0, 1.0])];
    let seen = sample(&over(&boxes, &Target::new(&view), &view, 1), 1);
    assert!(is_near(seen, [0.5, 0.25, 0.125, 0.125]), "{seen:?}");
    // From the back by over: C = F + (1 − α) · B.
    let mut back = [0.0; 4];
    for face in boxes.iter().rev().map(|b| b.faces.get(2)) {
        back = std::array::from_fn(|c| face[c] + (1.0 - face[3]) * back[c]);
    }
    assert!((0..3).all(|c| (back[c] - seen[c]).abs() < 1e-6) && (1.0 - back[3] - seen[3]).abs() < 1e-6);
}

/// An opaque wall of 64×64 cells of 0.7 pixels, turned at random a thousand times: no sample within its
/// outline shows the background, none is met twice, and no color exceeds what is covered.
#[test]
fn a_wall_of_cells_has_no_crack_and_no_seam() {
    let (count, mut dice) = (64, Dice::new(7));
    let view = straight_view(64, 0.001, 100.0);
    // At distance 4 an image 64 pixels wide is 8 units wide.
    let side = 0.7 * 8.0 / 64.0;
    let half = side * count as f32 / 2.0;
    for turn in 0..1000 {
        let mut view = view;
        let toward = dice.point(1.0);
        let length = toward.length();
        if length < 0.1 {
            continue;
        }
        view.eye.position = toward * (4.0 / length);
        view.eye.target = dice.point(0.3);
        view.eye.up = dice.point(1.0);
        if view.eye.fault().is_some() {
            continue;
        }
        let place = |i: i32| -half + side * i as f32;
        // Translucent, so that a sample that two cells claim shows as well. One layer: each ray crosses
        // several cells at most where it goes along the wall.
        let slab = cube(vec3(-half, -half, 0.0), vec3(place(count), place(count), side), [0.5; 4]);
        let cells: Vec<_> = (0..count * count)
            .map(|k| {
                let (x, y) = (k % count, k / count);
                let (low, high) = (vec3(place(x), place(y), 0.0), vec3(place(x + 1), place(y + 1), side));
                cube(low, high, [1.0; 4])
            })
            .collect();
        let image = Target::new(&view);
        let (whole, parts) = (over(&[slab], &image, &view, 1), over(&cells, &image, &view, 1));
        for (at, (whole, part)) in whole.samples().zip(parts.samples()).enumerate() {
            assert_eq!(whole[3] < 1.0, part[3] < 1.0, "view {turn}, sample {at}: {whole:?} {part:?}");
            let most = 1.0 - part[3];
            assert!(part[..3].iter().all(|c| *c <= most + 1e-6) && (0.0..=1.0).contains(&most));
        }
        if turn % 16 > 0 {
            continue;
        }
        let bands = over(&cells, &image, &view, 5);
        assert_eq!(parts, bands, "view {turn}: threads");
        // Nor on what a canvas held before.
        let mut again = bands;
        again.clear(&view);
        again.composite(&cells[..7], &image, &view, &Options::default());
        assert_eq!(again, over(&cells[..7], &image, &view, 1), "view {turn}: cleared");
    }
}

/// A sample that looks along an edge that two cells share belongs to one of them.
#[test]
fn a_ray_along_a_shared_edge_meets_one_cell() {
    let mut view = straight_view(1, 0.1, 100.0);
    view.eye.target = vec3(0.0, 0.0, -1.0);
    let cells: Vec<_> = [[-1.0, -1.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 0.0]]
        .into_iter()
        .map(|[x, y]| cube(vec3(x, y, -2.5), vec3(x + 1.0, y + 1.0, -1.5), [0.5; 4]))
        .collect();
    let seen = sample(&over(&cells, &Target::new(&view), &view, 1), 0);
    assert!(is_near(seen, [0.5; 4]), "met once: {seen:?}");
    // The next image has no sample there: its ray passes beside the edge.
    let view = straight_view(2, 0.1, 100.0);
    assert!(over(&cells, &Target::new(&view), &view, 1).samples().all(|s| is_near(s, [0.5; 4])));
}

/// A sample that looks through an edge of a cell, past which its ray would be in the next one, belongs to
/// the next one alone.
#[test]
fn a_ray_through_an_edge_meets_one_cell() {
    // Samples look along x = ±¼ and ±¾ of the depth: at depth 4 through the edges at ±1 and ±3.
    let view = straight_view(4, 0.1, 100.0);
    let planes = [-16.0, -3.0, -1.0, 1.0, 3.0, 16.0];
    let cell = |x: [f32; 2]| cube(vec3(x[0], -16.0, -5.0), vec3(x[1], 16.0, -4.0), [0.5; 4]);
    let across: Vec<_> = planes.windows(2).map(|x| cell([x[0], x[1]])).collect();
    let cell = |y: [f32; 2]| cube(vec3(-16.0, y[0], -5.0), vec3(16.0, y[1], -4.0), [0.5; 4]);
    let up: Vec<_> = planes.windows(2).map(|y| cell([y[0], y[1]])).collect();
    for cells in [across, up] {
        let seen: Vec<_> = over(&cells, &Target::new(&view), &view, 1).samples().collect();
        assert!(seen.iter().all(|s| is_near(*s, [0.5; 4])), "each is met once: {seen:?}");
    }
}

/// The faces that a cell turns to the eye, by the axis along which the ray enters it.
#[test]
fn the_face_toward_the_eye_is_drawn() {
    let view = straight_view(3, 0.1, 100.0);
    let mut faces = [[0.0; 4]; 6];
    (0..6).for_each(|f| faces[f] = [f as f32 / 6.0, 0.0, 0.0, 1.0]);
    let bounds = Aabb { min: vec3(-0.2, -0.2, -3.0), max: vec3(0.2, 0.2, -2.0) };
    let one = StandIn { node: NodeId(0), bounds, faces: CubeFaces::new(&faces), after: 0 };
    let seen = sample(&over(&[one], &Target::new(&view), &view, 1), 4);
    // Looking along −z one sees the upper z side.
    assert!(is_near(seen, [5.0 / 6.0, 0.0, 0.0, 0.0]), "{seen:?}");
    // An eye in a box, and one that has it behind, see no face of it.
    let around = cube(Vec3::splat(-1.0), Vec3::splat(1.0), [1.0; 4]);
    let behind = cube(vec3(-1.0, -1.0, 1.0), vec3(1.0, 1.0, 2.0), [1.0; 4]);
    for hidden in [around, behind] {
        let canvas = over(&[hidden], &Target::new(&view), &view, 1);
        assert!(canvas.samples().all(|s| s[3] == 1.0), "{canvas:?}");
    }
}

/// Section 5.1: what of a translucent cell is seen depends on the geometry about it. Green at depth 6, a red
/// half-covered face at depth 5: half of each. A face at depth 7 is hidden, a green pane at depth 4 hides
/// all.
#[test]
fn cells_are_tested_against_geometry_whatever_the_order() {
    let view = straight_view(5, 0.1, 100.0);
    let square = |depth: f32| {
        let at = |x: f32, y: f32| vec3(x * depth * 4.0, y * depth * 4.0, -depth);
        [at(-1.0, -1.0), at(3.0, -1.0), at(-1.0, 3.0)]
    };
    let mut parts = soup(&[square(6.0)]).into_parts();
    parts.materials[0].color = [0.0, 1.0, 0.0];
    let scene = Scene::new(parts).expect("a scene");
    let image = render(&scene, &view, scene.live());
    let face =
        |depth: f32| cube(vec3(-1.0, -1.0, -depth - 1.0), vec3(1.0, 1.0, -depth), [0.5, 0.0, 0.0, 0.5]);
    let painted = |depth: f32| {
        let canvas = over(&[face(depth)], &image, &view, 1);
        paint(&image, &canvas, &scene, &view, (Light::Headlight, [0.0; 3]))
    };
    let middle = 4 * 12;
    // The headlight meets the middle of the triangle at an angle.
    let green = srgb::linear(shade(&image, &scene, &view, [0.0; 3])[middle + 1]);
    let half = srgb_bytes([0.5, green * 0.5, 0.0]);
    let near = painted(5.0);
    assert!((0..3).all(|c| near[middle + c].abs_diff(half[c]) <= 1), "{:?}", &near[middle..middle + 4]);
    assert_eq!(painted(7.0), shade(&image, &scene, &view, [0.0; 3]), "a hidden cell leaves no trace");
    // The paper's pass, back to front, the cube writing its depth: on black the green is lost if it comes
    // later.
    let in_order = |after: u32| {
        let boxes = [StandIn { after, ..face(5.0) }];
        draw_in_order(&scene, &view, (scene.live(), &boxes), [0.0; 3], |_| [0.0, 1.0, 0.0])[12]
    };
    let wants = [(1, [0.5, 0.5, 0.0]), (0, [0.5, 0.0, 0.0])];
    for (after, want) in wants {
        let got = in_order(after);
        assert!((0..3).all(|c| (got[c] - want[c]).abs() < 0.01), "{after}: {got:?}");
    }
    let empty = paint(&image, &Canvas::default(), &scene, &view, (Light::Headlight, [0.0; 3]));
    assert_eq!(empty, shade(&image, &scene, &view, [0.0; 3]), "no cells: the same bytes");
}

/// What is kept of a face keeps its bounds, and comes back as it was.
#[test]
fn faces_keep_no_color_above_their_coverage() {
    let mut dice = Dice::new(3);
    for _ in 0..2000 {
        let alpha = dice.unit();
        let mut color = || alpha * dice.unit();
        let face = [color(), color(), color(), alpha];
        let kept = CubeFaces::new(&[face; 6]);
        let got = kept.get(3);
        assert!(got[..3].iter().all(|c| *c <= got[3]), "{face:?} {got:?}");
        assert!(is_near(face, got), "{face:?} {got:?}");
        assert_eq!(CubeFaces::of_bytes(kept.bytes()), Some(kept));
    }
    assert_eq!(CubeFaces::new(&[[1.0; 4]; 6]).get(0), [1.0; 4]);
    assert_eq!(CubeFaces::new(&[[0.0; 4]; 6]).get(5), [0.0; 4]);
    assert_eq!(CubeFaces::of_bytes([[9, 0, 0, 0]; 6]), None, "light where nothing is");
}
