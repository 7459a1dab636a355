//! Worked examples of the paper's rules, and whole frames.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use glam::{vec2, vec3};

use super::faces::{Baking, Faces, Room, composed, over};
use super::index::is_small;
use super::walk::pixels_at_depth_1;
use super::*;
use crate::geometry::dice::Dice;
use crate::geometry::{Aabb, Eye, Flat, Frustum, FrustumTest, NodeId, ObjectId, PrimId, Solid, Vector, View};
use crate::index::{Hierarchy, Items};
use crate::method::{Entry, Of, Recorder, Settings, Unobserved, Verdict};
use crate::raster::{Canvas, Options, Target, averaged, fixed_light, paint, render};
use crate::scene::{AnyScene, LoadOptions, Parts, Quiet, framing_view, load, random_views, samples};

fn is_near(a: [f32; 4], b: [f32; 4]) -> bool {
    (0..4).all(|c| (a[c] - b[c]).abs() < 1e-6)
}

/// Section 4, "front four over back four, average".
#[test]
fn faces_are_composed_column_by_column() {
    // Over, premultiplied (Porter and Duff 1984).
    let (front, back) = ([0.5, 0.0, 0.0, 0.5], [0.0, 0.25, 0.0, 0.25]);
    assert_eq!(over(front, back), [0.5, 0.125, 0.0, 0.625]);
    assert_eq!(over([0.2, 0.3, 0.4, 1.0], back), [0.2, 0.3, 0.4, 1.0], "nothing shows behind what is opaque");
    assert_eq!(over([0.0; 4], back), back, "all shows behind what is clear");
    // That column at the lower x face, and three clear ones: the lower x half of the cell is in front.
    let column = |octant: usize, _: usize| match octant {
        0 => front,
        1 => back,
        _ => [0.0; 4],
    };
    assert!(is_near(composed::<glam::Vec3>(column)[0], [0.125, 0.031_25, 0.0, 0.156_25]));
    assert!(is_near(composed::<glam::Vec2>(column)[0], [0.25, 0.0625, 0.0, 0.3125]), "two columns");
    // From the upper side the other one is in front.
    assert!(is_near(composed::<glam::Vec3>(column)[1], over(back, front).map(|c| c / 4.0)));
}

/// A wall across x that crosses a cell covers its x faces, level by level, and no other.
#[test]
fn a_wall_covers_the_faces_along_it_alone() {
    let wall = |columns: &'static [usize]| {
        move |octant: usize, face: usize| {
            if face < 2 && columns.contains(&octant) { [1.0; 4] } else { [0.0; 4] }
        }
    };
    let alphas = |faces: Faces| faces.map(|f| f[3]);
    let whole = composed::<glam::Vec3>(wall(&[0, 2, 4, 6]));
    assert_eq!(alphas(whole), [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    let up = composed::<glam::Vec3>(|octant, face| if octant & 1 == 0 { whole[face] } else { [0.0; 4] });
    assert_eq!(alphas(up), alphas(whole), "the next level");
    // In the lower columns alone.
    assert_eq!(alphas(composed::<glam::Vec3>(wall(&[0, 4])))[..3], [0.5, 0.5, 0.0]);
    // And the wall itself, of two triangles: the cell's own faces.
    let corners = [vec3(0.3, 0.0, 0.0), vec3(0.3, 1.0, 0.0), vec3(0.3, 1.0, 1.0), vec3(0.3, 0.0, 1.0)];
    let parts = Parts::simple("wall", corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]]);
    let scene = Scene::<Solid>::new(parts).expect("a wall");
    let faces = baked(&scene, &Aabb { min: vec3(0.0, 0.0, 0.0), max: vec3(1.0, 1.0, 1.0) }, 4);
    assert_eq!(alphas(faces), [1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
}

fn baked<S: Projected>(scene: &Scene<S>, cell: &Aabb<S::Vector>, side: u32) -> Faces {
    let baking = Baking { scene, surfaces: Surfaces::default(), side, is_analytic: false, composes: true };
    baking.projected(cell, scene.live(), &mut Room::default())
}

/// Section 4: the mean of 4×4 samples, premultiplied. A diagonal belongs to one of the triangles beside it.
#[test]
fn a_leaf_is_the_mean_of_its_samples() {
    let points = vec![vec3(0.0, 0.0, 0.5), vec3(1.0, 0.0, 0.5), vec3(1.0, 1.0, 0.5), vec3(0.0, 1.0, 0.5)];
    let cell = Aabb { min: vec3(0.0, 0.0, 0.0), max: vec3(1.0, 1.0, 1.0) };
    let alphas = [[0, 1, 3], [1, 2, 3]].map(|triangle| {
        let mut parts = Parts::<Solid>::simple("half", points.clone(), vec![triangle]);
        parts.materials[0].color = [1.0, 0.0, 0.0];
        let scene = Scene::new(parts).expect("a triangle");
        let (faces, light) = (baked(&scene, &cell, 4), fixed_light(&scene, PrimId(0)));
        assert!(is_near(faces[4], [faces[4][3] * light, 0.0, 0.0, faces[4][3]]), "{:?}", faces[4]);
        assert_eq!((faces[4], faces[0], faces[3]), (faces[5], [0.0; 4], [0.0; 4]), "edge-on it is nothing");
        // One sample lies on the diagonal, as do 64 of 64×64.
        let one = baked(&scene, &cell, 1)[4][3];
        assert!((baked(&scene, &cell, 64)[4][3] - 0.5).abs() <= 1.0 / 128.0);
        [faces[4][3], one]
    });
    assert_eq!(alphas, [[0.375, 0.0], [0.625, 1.0]]);
    // What lies outside the cell is not seen.
    let scene = Scene::<Solid>::new(Parts::simple("half", points, vec![[0, 1, 3]])).expect("a triangle");
    let above = Aabb { min: vec3(0.0, 0.0, 0.6), max: vec3(1.0, 1.0, 1.6) };
    assert_eq!(baked(&scene, &above, 4), [[0.0; 4]; 6]);
}

/// The paper's over takes coverage in a row as unrelated: of two halves it makes three quarters, whether they
/// are the same or fill each other up. Made from the primitives they are right.
#[test]
fn composing_takes_coverage_as_unrelated() {
    let opacity = |behind: f32| {
        // Cells of side 1, each with a segment half as wide across its middle; the back ones are moved.
        let (mut points, mut prims) = (Vec::new(), Vec::new());
        for (x, y) in [(0.0, 0.5), (1.0, 0.5), (behind, 1.5), (1.0 + behind, 1.5)] {
            prims.push([points.len() as u32, points.len() as u32 + 1]);
            points.extend([vec2(x, y), vec2(x + 0.5, y)]);
        }
        let scene = Scene::<Flat>::new(Parts::simple("halves", points, prims)).expect("segments");
        let whole = Aabb { min: vec2(0.0, 0.0), max: vec2(2.0, 2.0) };
        let of =
            |octant: usize, face: usize| baked(&scene, &crate::index::octant_of(&whole, octant), 4)[face];
        [composed::<glam::Vec2>(of)[2][3], baked(&scene, &whole, 4)[2][3]]
    };
    assert_eq!((opacity(0.0), opacity(0.5)), ([0.75, 0.5], [0.75, 1.0]));
}

/// A wall aslant is whole where it is seen through, but its cube is torn from 45°; a cloud of specks looks
/// alike from everywhere. Along the axes neither is wrong, so nothing is to be learned there (Section 5.1).
#[test]
fn surfaces_are_more_wrong_than_clouds() {
    let cell = Aabb { min: vec2(0.0, 0.0), max: vec2(1.0, 1.0) };
    let error = |points: Vec<glam::Vec2>| {
        let prims = (0..points.len() as u32 / 2).map(|k| [2 * k, 2 * k + 1]).collect();
        let mut parts = Parts::<Flat>::simple("segments", points, prims);
        parts.materials[0].color = [0.0; 3];
        let scene = Scene::new(parts).expect("segments");
        let baking = Baking {
            scene: &scene,
            surfaces: Surfaces::default(),
            side: 64,
            is_analytic: false,
            composes: true,
        };
        let room = &mut Room::default();
        let faces = baking.projected(&cell, scene.live(), room);
        baking.error(&cell, scene.live(), &faces, room)
    };
    // Across x: the x faces are covered and the y faces clear, so the cube covers half from 45°. The wall at
    // the side covers the face that it lies on, and nothing behind the other.
    let wall = error(vec![vec2(0.5, 0.0), vec2(0.5, 1.0)]);
    // A ray at 45° through a sample of a face meets the middle line of the cell where it comes in within
    // half a side of it: half of both faces, so as much as the cube covers; but not where the cube has it.
    assert!(wall < 0.02, "as much is covered as is: {wall}");
    // What a ray meets after it has left the cell by another side is not in it.
    let long = error(vec![vec2(0.5, -5.0), vec2(0.5, 6.0)]);
    assert!(long < 0.02, "{long}");
    // From corner to corner all is covered from one diagonal and nothing from the other; the cube covers all.
    let slant = error(vec![vec2(0.0, 0.0), vec2(1.0, 1.0)]);
    assert!(slant > 0.9, "{slant}");
    let mut dice = Dice::new(11);
    let mut specks = Vec::new();
    for _ in 0..60 {
        let (at, along) = (vec2(dice.unit(), dice.unit()), dice.vector::<glam::Vec2>(0.02));
        specks.extend([at, at + along]);
    }
    let cloud = error(specks);
    assert!(cloud < 0.25, "{cloud}");
}

/// Section 4: no more than the cubes of the children would cost.
#[test]
fn a_cell_is_a_leaf_by_what_its_childrens_cubes_cost() {
    // Eight cubes of six triangles each, then four.
    assert_eq!([48.0, 49.0].map(|cost| is_small::<Solid>(1.0)(cost, 8)), [true, false]);
    assert_eq!([24.0, 25.0].map(|cost| is_small::<Solid>(1.0)(cost, 4)), [true, false]);
    // In flatland two segments face the eye.
    assert_eq!([8.0, 9.0].map(|cost| is_small::<Flat>(1.0)(cost, 4)), [true, false]);
    // A sphere of 800 triangles in even parts: small enough in 34 cells, not in 33.
    // Where a cube costs half as much, so may what a leaf holds.
    assert_eq!([24.0, 25.0].map(|cost| is_small::<Solid>(0.5)(cost, 8)), [true, false]);
    assert_eq!([33.0, 34.0].map(|cells| is_small::<Solid>(1.0)(800.0 / cells, 4)), [false, true]);
}

/// The share of each primitive in each node, from the tree alone.
fn shares<S: Projected>(tree: &CellTree<S::Vector>, scene: &Scene<S>) -> Vec<BTreeMap<PrimId, f64>> {
    let held =
        |node: NodeId| tree.references(node).iter().copied().collect::<std::collections::BTreeSet<_>>();
    let mut all = vec![BTreeMap::new(); tree.nodes().len()];
    all[0] = scene.live().iter().map(|&p| (p, 1.0)).collect();
    for at in 0..all.len() {
        let children: Vec<_> = Hierarchy::<S>::children(tree, NodeId(at as u32)).map(NodeId).collect();
        for child in &children {
            for prim in held(*child) {
                let among = children.iter().filter(|c| held(**c).contains(&prim)).count();
                let share = all[at][&prim] / among as f64;
                all[child.at()].insert(prim, share);
            }
        }
    }
    all
}

/// What the stop rule is asked is the sum of shares, of each node in turn; over the leaves they sum up to the
/// primitives.
fn shares_add_up<S: Projected>() {
    let mut leaves_sharing = 0;
    for seed in 0..3 {
        let scene = samples::soup::<S>(seed, 500);
        let sums = RefCell::new(Vec::new());
        let stop = |sum: f64, children: u32| {
            // Asked of each node before anything is parted: would one child be too many?
            if children == 1 {
                sums.borrow_mut().push(sum);
            }
            is_small::<S>(1.0)(sum, children)
        };
        let tree = CellTree::build(&scene, Items::default(), 20, &stop, &|| false).expect("not cancelled");
        let (all, mut open, mut want) = (shares(&tree, &scene), vec![NodeId(0)], Vec::new());
        while let Some(node) = open.pop() {
            want.push(all[node.at()].values().sum::<f64>());
            open.extend(Hierarchy::<S>::children(&tree, node).rev().map(NodeId));
        }
        let asked = sums.into_inner();
        assert_eq!(asked.len(), want.len(), "seed {seed}");
        assert!(
            asked.iter().zip(&want).all(|(a, b)| (a - b).abs() < 1e-4),
            "seed {seed}: {asked:?} {want:?}"
        );
        let is_leaf = |at: &usize| tree.nodes()[*at].is_leaf();
        let sum: f64 = (0..all.len()).filter(is_leaf).flat_map(|at| all[at].values()).sum();
        assert!((sum - 500.0).abs() < 1e-6, "{sum}");
        leaves_sharing +=
            (0..all.len()).filter(is_leaf).filter(|at| all[*at].values().any(|s| *s < 1.0)).count();
    }
    assert!(leaves_sharing > 10, "{leaves_sharing}");
}

#[test]
fn shares_add_up_to_the_primitives() {
    shares_add_up::<Flat>();
    shares_add_up::<Solid>();
}

/// A view of an image of `px` pixels a side, 60° high, from a distance along a direction.
fn view_from(toward: glam::Vec3, px: u32) -> View<Solid> {
    let eye = Eye {
        position: toward,
        target: glam::Vec3::ZERO,
        up: vec3(0.1, 1.0, 0.2),
        fov: 60f32.to_radians(),
        near: 0.01,
        far: 1e4,
    };
    View { eye, width: px, height: px }
}

/// Table 2 at 14 radii: the cells of level 4 are those that are drawn.
#[test]
fn a_whole_view_is_drawn_at_one_level() {
    let pixels = pixels_at_depth_1(&view_from(vec3(0.0, 0.0, 14.0), 124));
    assert!((pixels - 107.387).abs() < 0.01, "{pixels}");
    let sizes = [3, 4, 5].map(|level| 2.0 / f32::from(1u16 << level) * pixels / 14.0);
    assert!(sizes.iter().zip([1.918, 0.959, 0.479]).all(|(s, want)| (s - want).abs() < 1e-3), "{sizes:?}");
}

fn ready<S: Projected>(scene: &Arc<Scene<S>>, pairs: &[(&str, &str)]) -> Box<dyn crate::method::Run<S>> {
    Of::<ColorCubes>::NEW
        .ready(scene, &Settings::of(pairs), &Quiet)
        .expect("settings")
        .expect("not cancelled")
}

/// Whether no cube of a list hides one before it: some plane parts each two, with the eye on the side of the
/// first, or in it.
pub(super) fn is_front_to_back<V: Vector>(cells: &[Aabb<V>], eye: V) -> bool {
    let parts = |a: &Aabb<V>, b: &Aabb<V>| {
        (0..V::AXES).any(|k| {
            a.max.get(k) <= b.min.get(k) && eye.get(k) <= b.min.get(k)
                || a.min.get(k) >= b.max.get(k) && eye.get(k) >= b.max.get(k)
        })
    };
    (0..cells.len()).all(|i| (0..i).all(|before| parts(&cells[before], &cells[i])))
}

fn frames_are_in_order<S: Projected>() {
    let (mut cubes, mut mixed) = (0, 0);
    for seed in 0..4 {
        let scene = samples::soup::<S>(seed, 4000);
        let mut run = ready(&scene, &[("pixel-threshold", "60")]);
        for view in random_views(&scene, 6, seed) {
            let list = run.cull(&view);
            let cells: Vec<_> = list.stand_ins.iter().map(|s| s.bounds).collect();
            assert!(is_front_to_back(&cells, view.eye.position), "seed {seed}");
            let back: Vec<_> = cells.iter().rev().copied().collect();
            assert!(
                cells.len() < 8 || !is_front_to_back(&back, view.eye.position),
                "the check sees an order"
            );
            cubes += cells.len();
            mixed += usize::from(!cells.is_empty() && !list.prims.is_empty());
        }
    }
    assert!(cubes > 200 && mixed > 4, "{cubes} cubes, {mixed} views with both");
}

#[test]
fn cubes_come_front_to_back() {
    frames_are_in_order::<Flat>();
    frames_are_in_order::<Solid>();
}

/// Seen along the diagonal each face shows a third of a cube, and 30° from an axis sin and cos of their sum.
#[test]
fn faces_show_by_their_projected_areas() {
    let shares = |toward: glam::Vec3| {
        let view =
            View { eye: Eye { fov: 0.006, ..view_from(toward * 400.0, 300).eye }, ..view_from(toward, 300) };
        let mut faces = [[0.0; 4]; 6];
        [1, 3, 5].into_iter().enumerate().for_each(|(c, face)| (faces[face][c], faces[face][3]) = (1.0, 1.0));
        let cube = crate::raster::StandIn {
            node: NodeId(0),
            bounds: Aabb { min: vec3(-0.5, -0.5, -0.5), max: vec3(0.5, 0.5, 0.5) },
            faces: crate::raster::CubeFaces::new(&faces),
            after: 0,
        };
        let mut canvas = Canvas::default();
        canvas.clear(&view);
        canvas.composite(&[cube], &Target::new(&view), &view, &Options::default());
        let sums = [0, 1, 2].map(|c| canvas.samples().map(|s| s[c]).sum::<f32>());
        sums.map(|s| s / sums.iter().sum::<f32>())
    };
    let diagonal = shares(vec3(1.0, 1.0, 1.0).normalize());
    assert!(diagonal.iter().all(|s| (s - 1.0 / 3.0).abs() < 0.01), "{diagonal:?}");
    let (sine, cosine) = 30f32.to_radians().sin_cos();
    let aside = shares(vec3(cosine, 0.0, sine));
    assert!((aside[0] - 0.634).abs() < 0.01 && (aside[2] - 0.366).abs() < 0.01, "{aside:?}");
}

/// A venetian blind (Section 3.2): slats as deep as they are apart cover min(1, tan φ) of what is behind,
/// seen at φ from their plane. Of a cell about one of them, as wide, two faces are covered and two are clear:
/// its cube covers sin φ / (sin φ + cos φ) of its own outline.
#[test]
fn a_blind_is_not_what_its_cube_shows() {
    let slat = |y: f32| [vec2(0.0, y + 0.5), vec2(1.0, y + 0.5)];
    let points: Vec<_> = (-40..40).flat_map(|k| slat(k as f32)).collect();
    let prims = (0..80).map(|k| [2 * k, 2 * k + 1]).collect();
    let scene = Scene::<Flat>::new(Parts::simple("blind", points, prims)).expect("segments");
    let cell = Aabb { min: vec2(0.0, 0.0), max: vec2(1.0, 1.0) };
    let faces = baked(&scene, &cell, 16);
    assert_eq!(faces.map(|f| f[3])[..4], [0.0, 0.0, 1.0, 1.0]);
    let covers = [0.0, 15.0, 30.0, 45.0, 60.0].map(|degrees: f32| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let middle = vec2(0.5, 0.5);
        let position = middle + vec2(cosine, sine) * 2000.0;
        // An outline of sin φ + cos φ, and some slats about it.
        let fov = 4.0 / 2000.0;
        let up = vec2(0.0, 1.0);
        let eye = Eye { position, target: middle, up, fov, near: 1.0, far: 4000.0 };
        let view = View::<Flat> { eye, width: 8000, height: 1 };
        let slats = render(&scene, &view, scene.live());
        let covered = slats.item.iter().filter(|item| **item != Target::NONE).count() as f32 / 8000.0;
        let sum = |faces: &Faces| {
            let faces = crate::raster::CubeFaces::new(faces);
            let cube = crate::raster::StandIn { node: NodeId(0), bounds: cell, faces, after: 0 };
            let mut canvas = Canvas::default();
            canvas.clear(&view);
            canvas.composite(&[cube], &Target::new(&view), &view, &Options::default());
            canvas.samples().map(|s| 1.0 - s[3]).sum::<f32>()
        };
        [covered, sum(&faces) / sum(&[[1.0; 4]; 6])]
    });
    let wants = [[0.0, 0.0], [0.268, 0.211], [0.577, 0.366], [1.0, 0.5], [1.0, 0.634]];
    for (got, want) in covers.iter().zip(wants) {
        // Some four slats are in the image, so its ends are a part of one.
        assert!((got[0] - want[0]).abs() < 0.08 && (got[1] - want[1]).abs() < 0.002, "{covers:?}");
    }
}

/// With the eye on the upper side of all axes each cell comes after those that fewer planes part from the
/// eye, the same ones among them: 7 first, 0 last. The order 7; 6, 5, 3; 4, 2, 1; 0, whichever way inside a
/// group, gives the same picture.
#[test]
fn octants_come_by_the_planes_before_them() {
    let mut dice = Dice::new(2);
    let mut points = Vec::new();
    for k in 0..8 * 9 {
        let center = vec3((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2 & 1) as f32) * 4.0 - 2.0;
        points.extend([0, 1, 2].map(|_| center + dice.vector::<glam::Vec3>(1.9)));
    }
    let prims = (0..72).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let scene = Arc::new(Scene::<Solid>::new(Parts::simple("octants", points, prims)).expect("triangles"));
    let mut view = view_from(vec3(30.0, 31.0, 32.0), 128);
    view.eye.near = 1.0;
    // A side is about 17 pixels there, that of a child half as many.
    let list = ready(&scene, &[("pixel-threshold", "12")]).cull(&view);
    let octant = |cube: &crate::raster::StandIn<glam::Vec3>| {
        (0..3).map(|a| usize::from(cube.bounds.center()[a] > 0.0) << a).sum::<usize>()
    };
    let order: Vec<usize> = list.stand_ins.iter().map(octant).collect();
    assert_eq!((order.len(), order[0], order[7]), (8, 7, 0), "{order:?}");
    let is_before =
        |a: usize, b: usize| order.iter().position(|o| *o == a) < order.iter().position(|o| *o == b);
    for (near, far) in (0..8).flat_map(|a| (0..8).map(move |b| (a, b))) {
        // All that the far one has on the eye's side the near one has as well.
        assert!(near == far || near & far != far || is_before(near, far), "{near} {far}: {order:?}");
    }
    let picture = |cubes: &[crate::raster::StandIn<glam::Vec3>]| {
        let mut canvas = Canvas::default();
        canvas.clear(&view);
        canvas.composite(cubes, &Target::new(&view), &view, &Options::default());
        canvas
    };
    let mut other = list.stand_ins.clone();
    for groups in [[7, 6, 5, 3, 4, 2, 1, 0], [7, 3, 6, 5, 1, 4, 2, 0]] {
        other.sort_by_key(|cube| groups.iter().position(|o| *o == octant(cube)));
        assert_eq!(picture(&other), picture(&list.stand_ins));
    }
    other.swap(0, 7);
    assert_ne!(picture(&other), picture(&list.stand_ins), "the order does matter");
}

/// Without cubes it is the z-buffer, and the picture of one, byte for byte. With a high threshold all of a
/// view is one cube.
fn thresholds_bound_what_is_drawn<S: Projected>() {
    for seed in 0..3 {
        let scene = samples::soup::<S>(seed, 200);
        let [mut exact, mut coarse] = ["0", "256"].map(|t| ready(&scene, &[("pixel-threshold", t)]));
        for view in random_views(&scene, 4, seed) {
            let list = exact.cull(&view);
            let options = Options::default();
            let white = [1.0; 3];
            let whole = paint(
                &render(&scene, &view, scene.live()),
                &Canvas::default(),
                &scene,
                &view,
                (Light::Fixed, white),
            );
            assert_eq!((list.stand_ins.len(), list.paint(&scene, &view, &options, white)), (0, whole));
        }
        let mut far = framing_view(&scene.bounds(), 64, 64);
        far.eye.position = far.eye.position * 4.0;
        far.eye.far *= 4.0;
        let list = coarse.cull(&far);
        assert_eq!((list.prims.len(), list.stand_ins.len()), (0, 1));
    }
}

#[test]
fn thresholds_bound_what_is_drawn_in_both_spaces() {
    thresholds_bound_what_is_drawn::<Flat>();
    thresholds_bound_what_is_drawn::<Solid>();
}

/// With two samples along a pixel's sides the same is drawn, and the picture is the mean of one with twice as
/// many pixels a side; so without cubes it is that of geometry (Section 5: "2×2 samples").
fn samples_are_averaged<S: Projected>() {
    let (white, options) = ([1.0; 3], Options::default());
    let (mut softer, mut with_cubes) = (0, 0);
    for order in ["exact", "paper"] {
        for threshold in ["0", "20"] {
            let scene = samples::soup::<S>(5, 400);
            let mut far = framing_view(&scene.bounds(), 64, 64);
            far.eye.position = far.eye.position * 2.0;
            far.eye.far *= 2.0;
            let pairs = [("pixel-threshold", threshold), ("order", order)];
            let mut one = ready(&scene, &pairs);
            let mut two = ready(&scene, &[pairs[0], pairs[1], ("samples", "2")]);
            for view in random_views(&scene, 2, 11).into_iter().chain([far]) {
                let [list, fine] = [&mut one, &mut two].map(|run| run.cull(&view));
                assert_eq!((list.samples, fine.samples), (1, 2));
                assert_eq!(DrawList { samples: 1, ..fine.clone() }, list);
                let down = if S::Vector::AXES == 2 { 1 } else { 2 };
                let large = View { width: view.width * 2, height: view.height * down, ..view };
                let painted = list.paint(&scene, &large, &options, white);
                let mean = averaged(&painted, large.width as usize, [2, down as usize]);
                let seen = fine.paint(&scene, &view, &options, white);
                assert!(seen == mean, "{order}, {threshold}");
                softer += usize::from(seen != list.paint(&scene, &view, &options, white));
                assert!(list.stand_ins.is_empty() || threshold != "0");
                with_cubes += usize::from(!list.stand_ins.is_empty());
            }
        }
    }
    assert!(softer > 3 && with_cubes > 1, "of 12 {softer} are softer, and {with_cubes} have cubes");
}

#[test]
fn samples_are_averaged_in_both_spaces() {
    samples_are_averaged::<Flat>();
    samples_are_averaged::<Solid>();
}

/// A primitive in several cells: drawn once if one of them is drawn as geometry, else in cubes alone.
#[test]
fn what_cells_share_is_drawn_once() {
    let (mut drawn, mut in_cubes) = (0, 0);
    for seed in 0..3 {
        let scene = samples::soup::<Solid>(seed, 3000);
        let params = Params { pixel_threshold: 80.0, ..Params::default() };
        let index = CubeTree::build(&scene, &params, None, &Quiet).expect("no bytes").expect("not cancelled");
        let view = &random_views(&scene, 1, seed)[0];
        let frame: Frame<'_, Solid, ColorCubes> =
            Frame { index: &index, scene: &scene, view, params: &params, limit: None };
        let (mut list, mut film) = (DrawList::default(), Recorder::new(usize::MAX));
        ColorCubes::cull(&frame, &mut (), &mut Drawn::default(), &mut list, &mut film);
        let mut plain = DrawList::default();
        ColorCubes::cull(&frame, &mut (), &mut Drawn::default(), &mut plain, &mut Unobserved);
        assert_eq!(plain, list);
        // Each is decided about once, and drawn once.
        let mut decided = BTreeSet::new();
        let prims = film.events.iter().filter_map(|e| match *e {
            Event::DecidedPrim(prim, _) => Some(prim),
            _ => None,
        });
        prims.for_each(|prim| assert!(decided.insert(prim), "{prim:?} twice"));
        assert!(list.prims.windows(2).all(|pair| pair[0] < pair[1]));
        let verdict = |prim: PrimId| {
            film.events.iter().find_map(|e| match *e {
                Event::DecidedPrim(p, v) if p == prim => Some(v),
                _ => None,
            })
        };
        // The cells that each primitive meets, by how they were drawn.
        let cube_cells: Vec<_> = list.stand_ins.iter().map(|s| s.node).collect();
        let is_in_cube =
            |prim: &PrimId| cube_cells.iter().any(|n| index.tree().references(*n).contains(prim));
        for &prim in scene.live().iter().filter(|p| is_in_cube(p)) {
            let times = list.prims.iter().filter(|p| **p == prim).count();
            assert!(times <= 1);
            match verdict(prim) {
                Some(Verdict::Visible) => (drawn, _) = (drawn + 1, assert_eq!(times, 1)),
                Some(Verdict::Approximated) => (in_cubes, _) = (in_cubes + 1, assert_eq!(times, 0)),
                None => assert_eq!(times, 0, "it lies in that cube wholly"),
                other => panic!("{other:?}"),
            }
        }
    }
    assert!(drawn > 5 && in_cubes > 5, "{drawn} drawn, {in_cubes} in cubes alone");
}

/// The cells in view that are small enough on the screen and in none that is, found by looking at each.
fn small_cells<S: Projected>(index: &CubeTree<S>, view: &View<S>, threshold: f32) -> Vec<NodeId> {
    let (tree, mut open, mut small) = (index.tree(), vec![NodeId(0)], Vec::new());
    while let Some(node) = open.pop() {
        let cell = tree.cell(node);
        if matches!(view.frustum().test(&cell, Frustum::<S::Vector>::ALL), FrustumTest::Outside(_)) {
            continue;
        }
        let depth = view.eye.forward().dot(cell.center() - view.eye.position);
        if depth > view.eye.near && cell.size().get(0) * pixels_at_depth_1(view) / depth <= threshold {
            small.push(node);
        } else {
            open.extend(Hierarchy::<S>::children(tree, node).map(NodeId));
        }
    }
    small.sort_unstable();
    small
}

/// Drawn as cubes are cells in view that are small enough and lie in none that is; of the others all
/// primitives are drawn, since to look for them was a loss.
fn small_cells_in_view_are_cubes<S: Projected>() {
    let (mut cubes, mut away) = (0, 0);
    for seed in 0..3 {
        let scene = samples::soup::<S>(seed, 4000);
        let threshold = 60.0;
        let params = Params { pixel_threshold: threshold, ..Params::default() };
        let index = CubeTree::build(&scene, &params, None, &Quiet).expect("no bytes").expect("not cancelled");
        let mut run = ready(&scene, &[("pixel-threshold", "60")]);
        for view in random_views(&scene, 6, seed) {
            let list = run.cull(&view);
            let drawn: BTreeSet<_> = list.stand_ins.iter().map(|cube| cube.node).collect();
            let small = small_cells(&index, &view, threshold);
            assert!(drawn.iter().all(|node| small.contains(node)), "seed {seed}");
            let prims: BTreeSet<_> = list.prims.iter().copied().collect();
            for node in small.iter().filter(|node| !drawn.contains(node)) {
                let held = index.tree().references(*node);
                assert!(held.iter().all(|prim| prims.contains(prim)), "seed {seed}, node {node}");
            }
            cubes += drawn.len();
            away += scene.live().len() - list.prims.len();
        }
    }
    assert!(cubes > 50 && away > 4000, "{cubes} {away}");
}

#[test]
fn small_cells_in_view_are_cubes_in_both_spaces() {
    small_cells_in_view_are_cubes::<Flat>();
    small_cells_in_view_are_cubes::<Solid>();
}

/// A primitive that ends on a dividing plane is on the side on which the rest of it is.
#[test]
fn what_ends_on_a_plane_is_on_one_side_of_it() {
    let points = [[-1.0, -1.0], [0.0, -0.5], [1.0, 1.0], [0.2, 0.3], [0.5, -0.5], [0.6, -0.4]];
    let prims = vec![[0, 1], [2, 3], [4, 5]];
    let parts = Parts::simple("ends", points.map(|[x, y]| vec2(x, y)).to_vec(), prims);
    let scene = Scene::<Flat>::new(parts).expect("segments");
    let tree = CellTree::build(&scene, Items::default(), 2, &|_, _| false, &|| false).expect("not cancelled");
    assert_eq!(tree.root().center(), vec2(0.0, 0.0));
    let held = |octant: usize| tree.nodes()[0].child(octant).map(|leaf| tree.references(leaf).to_vec());
    let wants = [Some(vec![PrimId(0)]), Some(vec![PrimId(2)]), None, Some(vec![PrimId(1)])];
    assert_eq!([0, 1, 2, 3].map(held), wants);
    // A slanted one passes by a corner of its box: at x = 0 it is at y = 0.8 already.
    let points = [[-1.0, -0.2], [0.2, 1.0], [-1.0, -1.0], [-0.9, -0.9], [1.0, 0.9], [0.9, 1.0]];
    let parts =
        Parts::simple("slanted", points.map(|[x, y]| vec2(x, y)).to_vec(), vec![[0, 1], [2, 3], [4, 5]]);
    let scene = Scene::<Flat>::new(parts).expect("segments");
    let tree = CellTree::build(&scene, Items::default(), 2, &|_, _| false, &|| false).expect("not cancelled");
    assert_eq!(tree.root().center(), vec2(0.0, 0.0));
    let holds = |octant: usize| {
        tree.nodes()[0].child(octant).is_some_and(|leaf| tree.references(leaf).contains(&PrimId(0)))
    };
    assert_eq!([0, 1, 2, 3].map(holds), [true, false, true, true]);
    // Of a sample on an end that two segments share the one above it is seen.
    let cell = Aabb { min: vec2(0.0, 0.0), max: vec2(1.0, 1.0) };
    let alphas = [[0.0, 0.5], [0.5, 1.0]].map(|[from, to]| {
        let points = vec![vec2(from, 0.5), vec2(to, 0.5)];
        let scene = Scene::<Flat>::new(Parts::simple("half", points, vec![[0, 1]])).expect("a segment");
        baked(&scene, &cell, 1)[2][3]
    });
    assert_eq!(alphas, [0.0, 1.0]);
}

/// Light comes through each layer once: of what several leaves below a cell share as well.
#[test]
fn light_comes_through_each_layer_once() {
    use crate::raster::VEIL;
    let panes = |heights: &[f32]| {
        let points: Vec<_> = heights.iter().flat_map(|y| [vec2(0.0, *y), vec2(1.0, *y)]).collect();
        let prims = (0..heights.len() as u32).map(|k| [2 * k, 2 * k + 1]).collect();
        let mut parts = Parts::<Flat>::simple("panes", points, prims);
        parts.materials[0].see_through = true;
        Scene::new(parts).expect("segments")
    };
    let cell = Aabb { min: vec2(0.0, 0.0), max: vec2(1.0, 1.0) };
    for count in 1..4 {
        let scene = panes(&[0.3, 0.5, 0.9][..count]);
        let want = 1.0 - (1.0 - VEIL).powi(count as i32);
        let got = baked(&scene, &cell, 4)[2][3];
        assert!((got - want).abs() < 1e-6, "{count} panes: {got} {want}");
    }
    // A pane in both halves of the root; what stands upright in the left one is the reason to divide it.
    let points = [[0.0, 0.3], [1.0, 0.3], [0.1, 0.3], [0.1, 0.4]].map(|[x, y]| vec2(x, y)).to_vec();
    let mut parts = Parts::<Flat>::simple("pane", points, vec![[0, 1], [2, 3]]);
    parts.materials[0].see_through = true;
    let scene = Scene::new(parts).expect("segments");
    let tree = CellTree::build(&scene, Items::default(), 2, &|_, _| false, &|| false).expect("not cancelled");
    assert!(tree.nodes().len() > 2, "two leaves share it");
    let surfaces = Surfaces::default();
    let baking = Baking { scene: &scene, surfaces, side: 16, is_analytic: false, composes: false };
    let root = baking.bake(&tree, false, &Quiet).expect("not cancelled").faces[0];
    assert!(root.get(2)[3] > 0.5 * VEIL && root.get(2)[3] < VEIL + 0.01, "{root:?}");
}

/// With a bound on the error cells are drawn as cubes that keep it, and no others.
#[test]
fn cubes_that_are_too_wrong_are_refined() {
    let scene = samples::soup::<Flat>(4, 2000);
    let mut counts = Vec::new();
    for bound in [0].into_iter().chain((2..=100).step_by(2)).map(|bound| bound as f32) {
        let params = Params { pixel_threshold: 12.0, error_bound: bound, ..Params::default() };
        let index = CubeTree::build(&scene, &params, None, &Quiet).expect("no bytes").expect("not cancelled");
        let view = framing_view(&scene.bounds(), 256, 1);
        let frame: Frame<'_, Flat, ColorCubes> =
            Frame { index: &index, scene: &scene, view: &view, params: &params, limit: None };
        let mut list = DrawList::default();
        ColorCubes::cull(&frame, &mut (), &mut Drawn::default(), &mut list, &mut Unobserved);
        let forward = view.eye.forward();
        for cube in &list.stand_ins {
            let depth = forward.dot(cube.bounds.center() - view.eye.position);
            let size = cube.bounds.size().x * pixels_at_depth_1(&view) / depth;
            let error = index.error(cube.node).unwrap_or(0.0);
            assert!(size <= 12.01 && (bound == 0.0 || error * size * size <= bound * 1.01), "{size} {error}");
        }
        counts.push(list.stand_ins.len());
    }
    // Some bound parts them, a low one refuses more than a high one.
    let all = counts[0];
    assert!(counts.iter().any(|count| (1..all).contains(count)), "{counts:?}");
    assert!(counts[1] < all && counts[50] == all, "{counts:?}");
}

/// A preprocess comes back as it was, and one that does not fit is refused in one line.
#[test]
fn what_was_saved_comes_back_or_is_refused() {
    fn check<S: Projected>(other: &Scene<S>, scene: &Scene<S>) {
        let params = Params { interior: Interior::Direct, error_bound: 0.2, ..Params::default() };
        let built = CubeTree::build(scene, &params, None, &Quiet).expect("no bytes").expect("not cancelled");
        let bytes = built.save().expect("it is kept");
        let read = |scene: &Scene<S>, params: &Params, bytes: &[u8]| {
            CubeTree::build(scene, params, Some(bytes), &Quiet).map(|tree| tree.expect("not cancelled"))
        };
        let again = read(scene, &params, &bytes).expect("it fits");
        assert_eq!(again.save(), Some(bytes.clone()));
        assert_eq!(again.tree().nodes(), built.tree().nodes());
        let refused = |scene: &Scene<S>, params: &Params, bytes: &[u8]| {
            let why = read(scene, params, bytes).expect_err("refused");
            assert!(!why.is_empty() && !why.contains('\n'), "{why}");
            why
        };
        assert_eq!(refused(other, &params, &bytes), "it was made for another scene");
        let others = Params { face_samples: 3, ..params };
        assert!(
            refused(scene, &others, &bytes).contains("face-samples=4 interior=direct error-bound=above 0")
        );
        let others = Params { faces: Coverage::Analytic, ..params };
        assert!(refused(scene, &others, &bytes).contains("faces=sampled"));
        // What hides cells is a matter of the frame.
        let hiding = Params { occlusion: Occlusion::Depth, ..params };
        assert!(read(scene, &hiding, &bytes).is_ok_and(|tree| tree.occluders().is_some()));
        let mut dice = Dice::new(5);
        for _ in 0..40 {
            let mut damaged = bytes.clone();
            damaged[12 + dice.below(bytes.len() as u32 - 12) as usize] ^= 1 << dice.below(8);
            refused(scene, &params, &damaged);
            refused(scene, &params, &bytes[..dice.below(bytes.len() as u32) as usize]);
        }
    }
    check(&samples::soup::<Flat>(1, 60), &samples::soup::<Flat>(2, 60));
    check(&samples::soup::<Solid>(1, 90), &samples::soup::<Solid>(2, 90));
}

/// Tables that are no tree are no tree, whatever sum stands under them.
#[test]
fn tables_of_no_tree_are_refused() {
    let scene = samples::soup::<Solid>(3, 3000);
    let tree = CellTree::build(&scene, Items::default(), 20, &is_small::<Solid>(1.0), &|| false)
        .expect("not cancelled");
    let [nodes, references] = tree.tables();
    let is_taken = |nodes: &[u32], references: &[u32]| {
        CellTree::of_tables(&*scene, Items::default(), nodes, references.to_vec()).is_some()
    };
    assert!(is_taken(&nodes, &references) && nodes.len() > 50);
    let mut dice = Dice::new(9);
    for _ in 0..2000 {
        let mut changed = nodes.clone();
        let at = dice.below(nodes.len() as u32) as usize;
        changed[at] = match dice.below(3) {
            0 => dice.bits(),
            1 => changed[at].wrapping_add(1),
            _ => dice.below(64),
        };
        // The root has no parent to name.
        assert!(changed == nodes || at == 0 || !is_taken(&changed, &references), "word {at}");
    }
    assert!(!is_taken(&nodes, &references[1..]));
    assert!(!is_taken(&nodes[..nodes.len() - 1], &references));
    let mut strange = references.clone();
    strange[7] = 3000;
    assert!(!is_taken(&nodes, &strange));
}

/// A leaf refers to the objects of which a primitive comes into its cell, found by brute force.
#[test]
fn a_leaf_refers_to_the_objects_in_it() {
    let loaded = load("generate:molecule?atoms=24", &LoadOptions::default(), &Quiet).expect("a molecule");
    let AnyScene::Solid(scene) = loaded else { panic!("in space") };
    let stop = is_small::<Solid>(1.0);
    let tree = CellTree::build(&scene, Items::objects(&scene), 20, &stop, &|| false).expect("not cancelled");
    let mut shared = 0;
    for at in (0..tree.nodes().len()).filter(|&at| tree.nodes()[at].is_leaf()) {
        let id = NodeId(at as u32);
        let cell = tree.cell(id);
        let comes_in = |&prim: &PrimId| {
            let of = Aabb::of(scene.prim_points(prim));
            of.min.cmplt(cell.max).all() && of.max.cmpgt(cell.min).all()
        };
        let inside: BTreeSet<_> =
            scene.live().iter().filter(|p| comes_in(p)).map(|p| scene.object_of(*p)).collect();
        let listed: BTreeSet<_> = tree.references(id).iter().map(|p| scene.object_of(*p)).collect();
        assert_eq!(listed, inside, "node {id}");
        shared += usize::from(inside.len() > 1);
    }
    assert!(shared > 20, "{shared} leaves of several objects");
}

/// Objects that are images of each other in the middle planes of a cube divide its eight cells alike.
#[test]
fn each_cell_is_handed_its_part_of_an_object() {
    const SIDE: f32 = 8.0;
    let mut dice = Dice::new(3);
    let middles: Vec<_> = (0..20).map(|_| (dice.point(0.7) + 1.0) * 2.0).collect();
    let corners: Vec<_> = (0..600)
        .flat_map(|k| {
            let at = middles[k / 30] + dice.point(0.4);
            [at, at + dice.point(0.1), at + dice.point(0.1)]
        })
        // No corner on a plane that halves a cell, and exact images.
        .map(|at| ((at * 1024.0).floor() * 2.0 + 1.0) / 2048.0)
        .collect();
    let image = |octant: usize, at: glam::Vec3| {
        glam::Vec3::from_array(std::array::from_fn(
            |a| if octant >> a & 1 == 0 { at[a] } else { SIDE - at[a] },
        ))
    };
    let points: Vec<_> = (0..8).flat_map(|o| corners.iter().map(move |at| image(o, *at))).collect();
    let prims: Vec<_> = (0..points.len() as u32 / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let mut parts: Parts<Solid> = Parts::simple("eight images", points, prims);
    parts.objects = vec![parts.objects[0].clone(); 160];
    parts.prim_object = (0..4800).map(|k| ObjectId(k / 30)).collect();
    let scene = Scene::new(parts).expect("a valid scene");
    let root = Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::splat(SIDE) };
    let items = Items::objects(&scene);
    let tree = CellTree::build_in(root, &scene, items, 7, &is_small::<Solid>(1.0), &|| false);
    let tree = tree.expect("not cancelled");
    let mut below = vec![1; tree.nodes().len()];
    for at in (1..below.len()).rev() {
        let parent = Hierarchy::<Solid>::parent(&tree, NodeId(at as u32)).expect("not the root");
        below[parent.at()] += below[at];
    }
    let of_octants: Vec<usize> =
        (0..8).map(|o| below[tree.nodes()[0].child(o).expect("full").at()]).collect();
    assert!(of_octants[0] > 50 && of_octants.iter().all(|n| *n == of_octants[0]), "{of_octants:?}");
}

/// Objects are drawn whole or not at all, no primitive twice; and their cells have the faces that all the
/// scene's primitives give them.
#[test]
fn objects_are_drawn_whole() {
    // Spheres of 800 triangles each.
    let loaded = load("generate:molecule?atoms=24", &LoadOptions::default(), &Quiet).expect("a molecule");
    let AnyScene::Solid(scene) = loaded else { panic!("in space") };
    let params = Params { primitives: Primitives::Objects, pixel_threshold: 3.0, ..Params::default() };
    let index = CubeTree::build(&scene, &params, None, &Quiet).expect("no bytes").expect("not cancelled");
    let tree = index.tree();
    let baking =
        Baking { scene: &*scene, surfaces: Surfaces::default(), side: 4, is_analytic: false, composes: true };
    for (at, _) in tree.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()).step_by(7) {
        let id = NodeId(at as u32);
        let faces = baking.projected(&tree.cell(id), scene.live(), &mut Room::default());
        assert_eq!(*index.faces(id), crate::raster::CubeFaces::new(&faces), "node {id}");
    }
    let (mut drawn, mut cubes) = (0, 0);
    for px in [16, 24, 32, 512] {
        let view = framing_view(&scene.bounds(), px, px);
        let frame: Frame<'_, Solid, ColorCubes> =
            Frame { index: &index, scene: &scene, view: &view, params: &params, limit: None };
        let mut list = DrawList::default();
        ColorCubes::cull(&frame, &mut (), &mut Default::default(), &mut list, &mut Unobserved);
        let mut times: BTreeMap<_, usize> = BTreeMap::new();
        for prim in &list.prims {
            *times.entry(scene.object_of(*prim)).or_default() += 1;
        }
        assert!(times.values().all(|count| *count == 800), "{times:?}");
        drawn += times.len();
        cubes += list.stand_ins.len();
    }
    assert!(drawn >= 24 && cubes > 50, "{drawn} objects, {cubes} cubes");
}
