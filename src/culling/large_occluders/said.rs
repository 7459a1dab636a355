//! What this method says of planes, against the corners of the boxes themselves.

use std::sync::Arc;

use glam::Vec2;

use super::explain::{Edge, Evidence, Related};
use super::index::Index;
use super::relation::{EdgeTest, Occlusion, Reason};
use super::space::{Point, Shape};
use super::{LargeOccluders, Params};
use crate::culling::Methods;
use crate::drawing::{Drawing, Mark, Role};
use crate::geometry::{Eye, Flat, Solid, Space, Vector, View};
use crate::method::{Film, Settings, notes};
use crate::scene::{AnyScene, LoadOptions, Parts, Quiet, Scene, example, load, random_views};

fn index<S: Shape>(scene: &Arc<Scene<S>>) -> Index<S> {
    Index::build(scene, &Params::default(), None, &Quiet).expect("nothing saved").expect("not cancelled")
}

fn building() -> Arc<Scene<Solid>> {
    let call = "generate:building?polygons=1500&seed=3";
    let Ok(AnyScene::Solid(scene)) = load(call, &LoadOptions::default(), &Quiet) else {
        unreachable!("a building is in space")
    };
    scene
}

fn film<S: Methods>(scene: &Arc<Scene<S>>, view: &View<S>) -> Arc<dyn Film<S>> {
    let entry = S::method("large-occluders").expect("listed");
    let mut run = entry.ready(scene, &Settings::default(), &Quiet).expect("ok").expect("not cancelled");
    run.record(view, usize::MAX).film
}

/// How far the corners of a box lie on the occluder's side of the plane through the eye and an edge, by
/// plain sums over all of them: the least and the greatest, times lengths that are the same for both.
fn sides<S: Shape>(index: &Index<S>, n: &Edge, eye: S::Point) -> [f64; 2] {
    let edges = index.occluders.edges(n.occluder);
    let edge = &edges[usize::from(n.edge)];
    let occluder = index.occluders.get(n.occluder);
    // Of a unit normal from the eye's side, whatever the side.
    let through = |arm: S::Point| {
        let normal = S::through(edge, arm);
        normal.dot(eye - edge.from) / normal.length()
    };
    let side = if occluder.normal.dot(eye - occluder.anchor) > 0.0 { 1.0 } else { -1.0 };
    let bounds = index.bounds_of(n.owner);
    bounds
        .corners()
        .map(|c| side * through(S::widened(c) - edge.from))
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, greatest], side| {
            [least.min(side), greatest.max(side)]
        })
}

/// Every edge test of a frame against all corners: inside the supporting plane lies every corner on the
/// occluder's side, outside the separating one none does.
fn edges_say_what_corners_say<S: Methods + Shape>(scene: &Arc<Scene<S>>) -> [u32; 3] {
    let index = index(scene);
    let mut seen = [0; 3];
    for view in random_views(scene, 12, 5) {
        let eye = S::widened(view.eye.position);
        let film = film(scene, &view);
        for (at, note) in notes::<S, LargeOccluders>(&*film) {
            let Evidence::Edge(n) = note else { continue };
            // Where the occluder cuts the box the two planes have no order.
            let Some(EdgeTest { supporting, needed, separating }) = n.test.filter(|t| t.needed.is_finite())
            else {
                continue;
            };
            let [least, greatest] = sides(&index, n, eye);
            let what = format!("{}: {} {least} {greatest}", scene.name(), film.sentence(at));
            let near = 1e-6 * needed.max(1.0);
            if supporting >= needed {
                assert!(least > -near, "{what}");
                assert!(film.sentence(at).contains("and inside its supporting one"), "{what}");
                seen[0] += 1;
            } else if separating <= 0.0 {
                assert!(greatest < near, "{what}");
                assert!(film.sentence(at).contains("outside its separating"), "{what}");
                seen[1] += 1;
            } else {
                assert!(least < needed + near && greatest > -near, "{what}");
                seen[2] += 1;
            }
        }
    }
    seen
}

#[test]
fn edge_by_edge_the_planes_are_those_of_the_corners() {
    let scene = building();
    for seen in
        [edges_say_what_corners_say(&example("street").expect("a scene")), edges_say_what_corners_say(&scene)]
    {
        assert!(seen.iter().all(|&n| n > 20), "each outcome is met: {seen:?}");
    }
}

/// The points of the plane that a step draws with emphasis.
fn emphasized<S: Space>(film: &dyn Film<S>, step: usize) -> Option<Vec<S::Vector>> {
    let mut drawing = Drawing::default();
    film.explain(step, &mut drawing);
    let planes = drawing.items.into_iter().filter(|item| item.role == Role::Evidence);
    planes
        .filter_map(|item| match item.mark {
            Mark::Line { points, .. } | Mark::Area(points) => Some(points),
            _ => None,
        })
        .next_back()
}

/// Distance of the eye from a drawn plane, or line of flatland.
fn distance<S: Space>(points: &[S::Vector], eye: S::Vector) -> f32 {
    let along = points[1] - points[0];
    let arm = eye - points[0];
    let apart = |from: S::Vector| {
        // What is left of `from` without its share along the line.
        from - along * (from.dot(along) / along.dot(along))
    };
    match points.get(2) {
        None => apart(arm).length(),
        Some(&third) => {
            let (u, v) = (apart(third - points[0]), apart(arm));
            (v - u * (v.dot(u) / u.dot(u))).length()
        }
    }
}

fn drawn_is_said<S: Methods + Shape>(scene: &Arc<Scene<S>>) -> u32 {
    let mut compared = 0;
    for view in random_views(scene, 6, 5) {
        let film = film(scene, &view);
        for (at, note) in notes::<S, LargeOccluders>(&*film) {
            let Evidence::Related(Related { reason: Reason::Plane(d), occlusion, .. }) = note else {
                continue;
            };
            assert_eq!(d.is_supporting, *occlusion != Occlusion::None);
            let points = emphasized(&*film, at + 1).expect("the plane that decided is drawn");
            let (shown, said) = (distance::<S>(&points, view.eye.position), d.distance.abs() as f32);
            // Drawn in 32 bits, through points that are drawn out past the eye.
            let scale = scene.bounds().diagonal();
            assert!((shown - said).abs() < 2e-3 * scale, "{}: {shown} {said}", film.sentence(at));
            compared += 1;
        }
    }
    compared
}

#[test]
fn the_plane_that_is_drawn_is_the_one_that_the_sentence_names() {
    assert!(drawn_is_said(&example("street").expect("a scene")) > 50);
    let scene = building();
    assert!(drawn_is_said(&scene) > 50);
}

/// A wall from (−4, 0) to (4, 0), a segment 2 behind it from −1 to 1, one beside that from 6 to 8, and one
/// behind the eye, which stands 4 before the wall.
#[test]
fn a_case_that_can_be_reckoned_by_hand() {
    let points = [
        [-4.0, 0.0],
        [4.0, 0.0],
        [-1.0, -2.0],
        [1.0, -2.0],
        [6.0, -2.0],
        [8.0, -2.0],
        [-1.0, 6.0],
        [1.0, 6.0],
    ];
    let points = points.map(|[x, y]| Vec2::new(x, y)).to_vec();
    let scene = Parts::simple("wall", points, vec![[0, 1], [2, 3], [4, 5], [6, 7]]);
    let scene = Arc::new(Scene::<Flat>::new(scene).expect("valid"));
    let (position, target) = (Vec2::new(0.0, 4.0), Vec2::ZERO);
    let eye = Eye { position, target, up: Vec2::Y, fov: 2.4, near: 0.1, far: 100.0 };
    let film = film(&scene, &View { eye, width: 512, height: 1 });
    let said: Vec<String> = (0..film.events().len())
        .filter(|&at| film.kind(at) == "OcclusionTested")
        .map(|at| film.sentence(at))
        .collect();
    // The supporting line through (4, 0) and (1, −2) is 2x − 3y = 8, from which (0, 4) lies 20/√13 = 5.55
    // inside, as does its mirror image.
    let full = said.iter().find(|s| s.contains("full occlusion")).expect("the segment is hidden");
    assert!(full.contains("2 supporting lines of the occluder of segment 0"), "{full}");
    assert!(full.contains("of the closest by 5.55 units"), "{full}");
    let none = said.iter().any(|s| s.contains("no occlusion") || s.contains("no part of the one"));
    assert!(none, "the other one is not: {said:?}");
}
