//! Coorg and Teller's method against brute force and exact arithmetic.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::parts::{Blockers, Occlusion, outline_seen_from, tangent_corners};
use super::space::Shape;
use crate::culling::Methods;
use crate::drawing::Subject;
use crate::geometry::{Aabb, Flat, NodeId, Solid, Space, Vector, View, orient2d, orient3d};
use crate::method::{Run, Settings};
use crate::scene::{
    AnyScene, LoadOptions, Quiet, Scene, example, figure_eight_path, framing_view, load, random_views,
};

/// Cases of each property; more by `CULLSCOPE_FUZZ_CASES`.
fn cases(default: usize) -> usize {
    std::env::var("CULLSCOPE_FUZZ_CASES").ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

/// Random numbers, some of them on a coarse grid, where degenerate cases are frequent.
struct Chance(Pcg32);

impl Chance {
    fn unit(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 / (1u32 << 24) as f32
    }
    fn below(&mut self, n: u32) -> u32 {
        self.0.next_u32() % n
    }
    fn number(&mut self, grid: bool) -> f32 {
        let v = self.unit() * 12.0 - 6.0;
        if grid { v.round() } else { v }
    }
    fn point<V: Vector>(&mut self, grid: bool) -> V {
        V::from_fn(|_| self.number(grid))
    }
    fn bounds<V: Vector>(&mut self, grid: bool) -> Aabb<V> {
        // On the grid some boxes are flat.
        let size = if grid { 2.0 } else { self.unit() * 4.0 };
        Aabb::of(
            [self.point::<V>(grid), self.point::<V>(grid)]
                .map(|p| p * (size / 4.0))
                .map(|p| if grid { V::from_fn(|a| p.get(a).round()) } else { p }),
        )
    }
}

/// The exact sign of a corner against the plane through an edge and another corner.
trait Exact: Shape + Methods {
    fn sign(edge: [Self::Vector; 2], through: Self::Vector, of: Self::Vector) -> f64;
    /// Whether the segment from `a` to `b` meets a polygon, exactly; touching it counts.
    fn is_blocked(a: Self::Vector, b: Self::Vector, polygon: &[Self::Vector]) -> bool;
}

impl Exact for Flat {
    fn sign([from, _]: [Vec2; 2], through: Vec2, of: Vec2) -> f64 {
        orient2d(from.as_dvec2(), through.as_dvec2(), of.as_dvec2())
    }
    fn is_blocked(a: Vec2, b: Vec2, s: &[Vec2]) -> bool {
        let side = |p: Vec2, q: Vec2, r: Vec2| orient2d(p.as_dvec2(), q.as_dvec2(), r.as_dvec2());
        side(s[0], s[1], a) * side(s[0], s[1], b) <= 0.0 && side(a, b, s[0]) * side(a, b, s[1]) <= 0.0
    }
}

impl Exact for Solid {
    fn sign([from, to]: [Vec3; 2], through: Vec3, of: Vec3) -> f64 {
        orient3d(from.as_dvec3(), to.as_dvec3(), through.as_dvec3(), of.as_dvec3())
    }
    fn is_blocked(a: Vec3, b: Vec3, polygon: &[Vec3]) -> bool {
        let side = |p: Vec3, q: Vec3, r: Vec3, s: Vec3| {
            orient3d(p.as_dvec3(), q.as_dvec3(), r.as_dvec3(), s.as_dvec3())
        };
        (1..polygon.len() - 1).any(|i| {
            let t = [polygon[0], polygon[i], polygon[i + 1]];
            let turns = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| side(a, b, t[i], t[j]));
            let through = turns.iter().all(|s| *s >= 0.0) || turns.iter().all(|s| *s <= 0.0);
            through && side(t[0], t[1], t[2], a) * side(t[0], t[1], t[2], b) <= 0.0
        })
    }
}

/// A table's tangent corners are tangent by exact arithmetic, and missing only where the edge's line meets
/// the box.
fn tangents_are_tangent<S: Exact>(seed: u64) {
    let mut chance = Chance(Pcg32::new(seed, 1));
    let mut found = 0;
    for case in 0..cases(60_000) {
        let grid = case % 3 == 0;
        let edge: [S::Vector; 2] = [chance.point(grid), chance.point(grid)];
        let bounds = chance.bounds::<S::Vector>(grid);
        if edge[0] == edge[1] {
            continue;
        }
        let by: [Option<[u8; 2]>; 2] = tangent_corners::<S>(edge[0], edge[1], &bounds);
        for corners in by.into_iter().flatten() {
            for vertex in corners.map(|v| bounds.corner(v as usize)) {
                let signs: Vec<f64> = bounds.corners().map(|c| S::sign(edge, vertex, c)).collect();
                assert!(
                    signs.iter().all(|s| *s >= 0.0) || signs.iter().all(|s| *s <= 0.0),
                    "{edge:?} {bounds:?} {vertex:?}: {signs:?}"
                );
            }
        }
        // Both find them or neither, but where the line touches the box.
        if let [Some(table), Some(naive)] = by {
            found += 1;
            let same = |v: u8| {
                naive
                    .iter()
                    .any(|n| S::sign(edge, bounds.corner(v as usize), bounds.corner(*n as usize)) == 0.0)
            };
            assert!(table.iter().all(|v| same(*v)), "{edge:?} {bounds:?}: {by:?}");
        } else if !grid {
            assert_eq!(by, [None, None], "{edge:?} {bounds:?}");
        }
    }
    assert!(found > cases(60_000) / 3, "{found} cases with tangents");
}

#[test]
fn the_table_finds_what_looking_at_every_corner_finds() {
    tangents_are_tangent::<Flat>(1);
    tangents_are_tangent::<Solid>(2);
}

#[test]
fn outlines_separate_what_is_seen_from_what_is_not() {
    let bounds = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    for code in 0..27 {
        let at = |digit: u32| [-1.0, 0.5, 2.0][digit as usize];
        let from = Vec3::new(at(code % 3), at(code / 3 % 3), at(code / 9));
        let outline = outline_seen_from(from, &bounds);
        let outside = (0..3).filter(|a| !(0.0..=1.0).contains(&from[*a])).count();
        assert_eq!(outline.len(), [0, 4, 6, 6][outside], "{from}");
        for i in 0..outline.len() {
            let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
            assert_eq!((a ^ b).count_ones(), 1, "{from}: an edge of the box");
            // The plane through the eye and an edge of the outline has the whole box on one side: always the
            // same one.
            let [p, q] = [a, b].map(|v| bounds.corner(v as usize).as_dvec3());
            let sides: Vec<f64> =
                bounds.corners().map(|c| orient3d(from.as_dvec3(), p, q, c.as_dvec3())).collect();
            assert!(sides.iter().all(|s| *s <= 0.0), "{from}: {sides:?}");
        }
    }
}

/// Occluders that share corners: strips of bent walls, and loose ones.
fn occluders<S: Exact>(chance: &mut Chance, grid: bool) -> (Vec<S::Vector>, Vec<Vec<u32>>) {
    let (mut points, mut polygons) = (Vec::new(), Vec::new());
    let (panes, rows) = (1 + chance.below(3), if S::Vector::AXES == 2 { 0 } else { 1 + chance.below(2) });
    let (from, along): (S::Vector, S::Vector) = (chance.point(grid), chance.point(grid));
    let up = if S::Vector::AXES == 2 { S::Vector::default() } else { chance.point::<S::Vector>(grid) };
    for i in 0..=panes {
        let bend: S::Vector = chance.point(grid);
        let foot = from + along * (i as f32) + bend * (0.2 * (i % 2) as f32);
        points.extend((0..=rows).map(|j| foot + up * j as f32));
    }
    let at = |i: u32, j: u32| i * (rows + 1) + j;
    for i in 0..panes {
        if rows == 0 {
            polygons.push(vec![at(i, 0), at(i + 1, 0)]);
        }
        for j in 0..rows {
            polygons.push(vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let loose = points.len() as u32;
    points.extend((0..3).map(|_| chance.point::<S::Vector>(grid)));
    polygons.push((loose..loose + S::CORNERS as u32).collect());
    (points, polygons)
}

/// What is called hidden is hidden, by exact arithmetic: no segment from the eye to a corner of the box, or
/// to a random point in it, gets past the occluders that are said to hide it.
fn nothing_visible_is_called_hidden<S: Exact>(seed: u64, offset: f32) {
    let mut chance = Chance(Pcg32::new(seed, 3));
    let (mut full, mut joint) = (0, 0);
    let all = cases(40_000);
    for case in 0..all {
        let grid = case % 4 == 0;
        let (mut points, polygons) = occluders::<S>(&mut chance, grid);
        let mut bounds = chance.bounds::<S::Vector>(grid);
        let mut eye: S::Vector = chance.point(grid);
        // Toward the other side of the occluders, so that hiding is frequent; on the grid at degenerate
        // places.
        if case % 2 == 1 {
            let middle = points.iter().take(points.len() - 3).fold(S::Vector::default(), |s, p| s + *p)
                * (1.0 / (points.len() - 3) as f32);
            eye = middle + (middle - bounds.center()) * 0.7;
        }
        let shift = S::Vector::splat(offset);
        points.iter_mut().for_each(|p| *p = *p + shift);
        (bounds, eye) = (Aabb { min: bounds.min + shift, max: bounds.max + shift }, eye + shift);
        let blockers = Blockers::<S>::new(&points, &polygons);
        if blockers.len() != polygons.len() {
            continue;
        }
        let hiding = blockers.hiding(&bounds, eye);
        if hiding.is_empty() {
            continue;
        }
        (full, joint) = (full + usize::from(hiding.len() == 1), joint + usize::from(hiding.len() > 1));
        let members: Vec<Vec<S::Vector>> =
            hiding.iter().map(|&i| polygons[i].iter().map(|&c| points[c as usize]).collect()).collect();
        let inside = (0..4)
            .map(|_| S::Vector::from_fn(|a| bounds.min.get(a) + bounds.size().get(a) * chance.unit()))
            .collect::<Vec<_>>();
        for target in bounds.corners().chain(inside) {
            // A random point may round out of the box.
            let target = target.max(bounds.min).min(bounds.max);
            assert!(
                members.iter().any(|m| S::is_blocked(eye, target, m)),
                "case {case}: {eye:?} sees {target:?} of {bounds:?} past {members:?}"
            );
        }
    }
    assert!(
        full > all / 60 && joint > all / 400,
        "{}: {full} and {joint} of {all} cases hide anything",
        S::NAME
    );
}

#[test]
fn what_is_called_hidden_is_hidden_in_flatland() {
    nothing_visible_is_called_hidden::<Flat>(1, 0.0);
}
#[test]
fn what_is_called_hidden_is_hidden_in_space() {
    nothing_visible_is_called_hidden::<Solid>(2, 0.0);
}
#[test]
fn what_is_called_hidden_is_hidden_far_from_the_origin() {
    nothing_visible_is_called_hidden::<Flat>(3, 1e6);
    nothing_visible_is_called_hidden::<Solid>(4, 1e6);
}

/// A square wall of side 2 in the plane z = 0, its front toward +z.
fn square(x: f32, y: f32) -> [Vec3; 4] {
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[a, b]| Vec3::new(x + a, y + b, 0.0))
}

#[test]
fn the_regions_of_figure_2() {
    let wall = Blockers::<Flat>::new(&[Vec2::new(-1.0, 0.0), Vec2::new(1.0, 0.0)], &[vec![0, 1]]);
    let target = Aabb { min: Vec2::new(-0.5, -3.0), max: Vec2::new(0.5, -2.0) };
    let at = |x: f32, y: f32| wall.classify(0, &target, Vec2::new(x, y));
    assert_eq!(
        [at(0.0, 2.0), at(2.2, 2.0), at(9.0, 2.0)],
        [Occlusion::Full, Occlusion::Partial, Occlusion::None]
    );
    // On the box's own side, on the occluder, on its line, in the box.
    assert_eq!([at(0.0, -1.0), at(0.0, 0.0), at(3.0, 0.0), at(0.0, -2.5)], [Occlusion::None; 4]);
    // The supporting line, from the far right corner of the box through the wall's right end, separates 3
    // from 2: at y = 2 it is at x = 1 + 2 · 0.5 / 3.
    assert_eq!([at(1.333, 2.0), at(1.334, 2.0)], [Occlusion::Full, Occlusion::Partial]);
    // The separating line, from the near left corner: x = 1 + 2 · 1.5 / 2.
    assert_eq!([at(2.499, 2.0), at(2.501, 2.0)], [Occlusion::Partial, Occlusion::None]);
}

#[test]
fn connected_occluders_hide_together_what_neither_hides_alone() {
    // Figure 3, in flatland: a bent wall.
    let wall = Blockers::<Flat>::new(
        &[Vec2::new(-2.0, 0.0), Vec2::new(0.0, 0.4), Vec2::new(2.0, 0.0)],
        &[vec![0, 1], vec![1, 2]],
    );
    let target = Aabb { min: Vec2::new(-0.8, -3.0), max: Vec2::new(0.8, -2.0) };
    let eye = Vec2::new(0.0, 3.0);
    assert_eq!([0, 1].map(|i| wall.classify(i, &target, eye)), [Occlusion::Partial; 2]);
    assert_eq!(wall.hiding(&target, eye), [0, 1]);
    // Not connected: the same wall with a corner of its own for each.
    let apart = [Vec2::new(-2.0, 0.0), Vec2::new(0.0, 0.4), Vec2::new(0.0, 0.4), Vec2::new(2.0, 0.0)];
    assert!(Blockers::<Flat>::new(&apart, &[vec![0, 1], vec![2, 3]]).hiding(&target, eye).is_empty());
}

#[test]
fn a_shared_silhouette_edge_is_not_ignored() {
    // Figure 4: two walls that meet in a corner, both to the left of it as seen from the eye.
    let corner = Blockers::<Flat>::new(
        &[Vec2::new(-4.0, 0.0), Vec2::new(0.0, 0.0), Vec2::new(-4.0, -1.0)],
        &[vec![0, 1], vec![1, 2]],
    );
    let target = Aabb { min: Vec2::new(-1.0, -4.0), max: Vec2::new(1.0, -3.0) };
    let eye = Vec2::new(-0.5, 3.0);
    assert_eq!(corner.classify(0, &target, eye), Occlusion::Partial);
    assert!(corner.hiding(&target, eye).is_empty(), "the box is seen past the corner");
}

#[test]
fn only_convex_connected_outlines_hide_jointly() {
    // Figure 5: panes of a wall, the eye at z = 10, the box behind.
    let eye = Vec3::new(0.0, 0.0, 10.0);
    let target = |x: f32, y: f32| Aabb { min: Vec3::new(-x, -y, -2.0), max: Vec3::new(x, y, -1.0) };
    let mut points: Vec<Vec3> = Vec::new();
    for i in 0..4 {
        points.extend((0..3).map(|j| Vec3::new(i as f32 * 2.0 - 3.0, j as f32 * 2.0 - 2.0, 0.0)));
    }
    let pane = |i: u32, j: u32| vec![i * 3 + j, i * 3 + j + 3, i * 3 + j + 4, i * 3 + j + 1];
    let all: Vec<Vec<u32>> = (0..3).flat_map(|i| (0..2).map(move |j| pane(i, j))).collect();
    // (a) Six panes, a convex outline.
    assert_eq!(Blockers::<Solid>::new(&points, &all).hiding(&target(2.5, 1.5), eye).len(), 6);
    // (b) The middle one above is missing: the box crosses the line of an edge.
    let notched: Vec<Vec<u32>> = all.iter().filter(|p| **p != pane(1, 1)).cloned().collect();
    let low = Aabb { min: Vec3::new(-2.5, -1.5, -2.0), max: Vec3::new(2.5, -0.5, -1.0) };
    assert!(Blockers::<Solid>::new(&points, &notched).hiding(&target(2.5, 1.5), eye).is_empty());
    assert_eq!(
        Blockers::<Solid>::new(&points, &notched).hiding(&low, eye).len(),
        3,
        "the lower row still hides what is low"
    );
    // (c) Disconnected: two squares with a gap that the box does not even reach into.
    let pair: Vec<Vec3> = square(-1.01, 0.0).into_iter().chain(square(1.01, 0.0)).collect();
    assert!(
        Blockers::<Solid>::new(&pair, &[vec![0, 1, 2, 3], vec![4, 5, 6, 7]])
            .hiding(&target(1.5, 0.5), eye)
            .is_empty()
    );
}

fn run<S: Methods>(scene: &Arc<Scene<S>>, pairs: &[(&str, &str)]) -> Box<dyn Run<S>> {
    let settings = Settings::of(pairs);
    S::method("large-occluders")
        .expect("listed")
        .ready(scene, &settings, &Quiet)
        .expect("settings")
        .expect("not cancelled")
}

fn solid(call: &str) -> Arc<Scene<Solid>> {
    match load(call, &LoadOptions::default(), &Quiet).expect("a scene") {
        AnyScene::Solid(scene) => scene,
        AnyScene::Flat(_) => unreachable!("asked for in space"),
    }
}

/// Walks with jumps, back and forth, and standing still.
fn walk<S: Space>(scene: &Scene<S>, count: usize, seed: u64) -> Vec<View<S>> {
    let mut chance = Chance(Pcg32::new(seed, 9));
    let path = scene.paths().first().map_or_else(|| figure_eight_path(scene, 200), |p| p.smoothed(3)).views;
    let jumps = random_views(scene, 20, seed);
    let mut at = 0;
    let next = |_| match chance.below(12) {
        0 => jumps[chance.below(20) as usize],
        1 => {
            at = chance.below(path.len() as u32) as usize;
            path[at]
        }
        2 => path[at],
        k => {
            at = (at + path.len() + if k < 9 { 1 } else { 0 }) % path.len();
            path[at]
        }
    };
    (0..count).map(next).collect()
}

fn kept_planes_change_nothing<S: Methods>(scene: &Arc<Scene<S>>, count: usize) {
    for extra in [("detail-objects", "true"), ("backface-culling", "true"), ("cells", "true")] {
        let (mut with, mut without) = (run(scene, &[extra]), run(scene, &[extra, ("cache", "false")]));
        let mut reused = 0;
        for (i, view) in walk(scene, count, 5).iter().enumerate() {
            let (list, tally) = with.count(view);
            assert_eq!(list, without.cull(view), "{}: view {i}", scene.name());
            reused += tally.named().get("relations_reused").copied().unwrap_or(0);
        }
        assert!(reused > 0, "{}: nothing was reused", scene.name());
    }
}

#[test]
fn planes_kept_from_frame_to_frame_change_nothing() {
    kept_planes_change_nothing(&example("street").expect("a scene"), cases(400));
    kept_planes_change_nothing(&example("freedoom_e1m1").expect("a scene"), cases(400));
    kept_planes_change_nothing(&solid("generate:building?polygons=2000&seed=3"), cases(400));
}

#[test]
fn a_saved_selection_is_the_one_that_was_made_and_fits_nothing_else() {
    let scene = solid("generate:building?polygons=1500");
    let entry = Solid::method("large-occluders").expect("listed");
    let settings = |k: &str| Settings::of(&[("occluders", k)]);
    let mut made = run(&scene, &[("occluders", "16")]);
    let saved = made.hierarchy().save().expect("there is something to save");
    let mut restored =
        entry.restore(&scene, &settings("16"), &saved, &Quiet).expect("it fits").expect("not cancelled");
    for view in &scene.paths()[0].views[..12] {
        assert_eq!(made.cull(view), restored.cull(view));
    }
    let refused = |scene: &Arc<Scene<Solid>>, k: &str, bytes: &[u8]| {
        entry.restore(scene, &settings(k), bytes, &Quiet).err().map(|e| e.to_string())
    };
    assert!(refused(&scene, "8", &saved).is_some_and(|e| e.contains("occluders=16")));
    assert_eq!(
        refused(&solid("generate:building?polygons=1500&seed=2"), "16", &saved).as_deref(),
        Some("it was made for another scene")
    );
    let mut rng = Chance(Pcg32::new(8, 8));
    for _ in 0..300 {
        let mut bytes = saved.clone();
        let at = rng.below(bytes.len() as u32) as usize;
        if rng.below(2) == 0 {
            bytes.truncate(at);
        } else {
            bytes[at] ^= 1 << rng.below(8);
        }
        assert!(refused(&scene, "16", &bytes).is_some());
    }
    assert!(
        Solid::method("frustum")
            .expect("listed")
            .restore(&scene, &Settings::default(), &saved, &Quiet)
            .is_err()
    );
}

#[test]
fn it_culls_what_frustum_culling_keeps() {
    let scene = solid("generate:building?polygons=20000");
    let mut frustum = Solid::method("frustum")
        .expect("listed")
        .ready(&scene, &Settings::default(), &Quiet)
        .expect("ok")
        .expect("ok");
    let mut large = run(&scene, &[]);
    let views = &scene.paths()[0].views;
    let drawn =
        |run: &mut dyn Run<Solid>| views.iter().step_by(4).map(|v| run.cull(v).prims.len()).sum::<usize>();
    let (before, after) = (drawn(&mut *frustum), drawn(&mut *large));
    // Walls and floors, which hide the rest, are a good part of so small a building.
    assert!(6 * before > 10 * after, "{before} and {after}");
}

#[test]
fn nothing_hides_what_lies_before_it_or_what_the_near_plane_uncovers() {
    // A wall nearer than the near plane is not drawn, so it hides nothing.
    let wall = square(0.0, 0.0);
    let target = Aabb { min: Vec3::new(-0.2, -0.2, -2.0), max: Vec3::new(0.2, 0.2, -1.0) };
    let mut view = framing_view::<Solid>(&target, 64, 64);
    (view.eye.position, view.eye.target) = (Vec3::new(0.0, 0.0, 0.05), Vec3::ZERO);
    let mut hides = |near: f32| {
        view.eye.near = near;
        !Blockers::<Solid>::new(&wall, &[vec![0, 1, 2, 3]])
            .for_view(&view)
            .hiding(&target, view.eye.position)
            .is_empty()
    };
    assert!(hides(0.01) && !hides(0.1));
    let before = Aabb { min: Vec3::new(-0.1, -0.1, 0.1), max: Vec3::new(0.1, 0.1, 0.2) };
    let blockers = Blockers::<Solid>::new(&wall, &[vec![0, 1, 2, 3]]);
    assert_eq!(blockers.classify(0, &before, Vec3::new(0.0, 0.0, 3.0)), Occlusion::None);
}

/// How many of the segments that a fact of a lecture scene calls hidden are left out.
fn hidden_left_out(name: &str, eye: usize) -> [usize; 2] {
    let path = format!("{}/scenes2d/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let Ok(AnyScene::Flat(scene)) = load(&path, &LoadOptions::default(), &Quiet) else { panic!("{path}") };
    let fact = scene.about().expect.iter().find(|f| f.eye == eye && f.frame == 0).expect("a fact");
    let drawn = run(&scene, &[]).cull(&scene.paths()[0].views[eye]).prims;
    [fact.hidden.iter().filter(|p| !drawn.contains(p)).count(), fact.hidden.len()]
}

#[test]
fn lecture_scenes_show_their_lesson() {
    // All that is hidden where that is what the scene teaches. Elsewhere a side of a box that touches a side
    // which hides it is drawn, as is what only occluders that share nothing hide together.
    for (name, eye, drawn) in [
        ("occluder_and_box", 0, 0),
        ("connected_occluders", 0, 0),
        ("connected_occluders", 1, 1),
        ("fusion", 0, 1),
        ("fusion", 1, 2),
        ("picket_fence", 0, 0),
        ("moving_door", 0, 5),
        ("spiral", 2, 2),
        ("silhouette_edge", 1, 1),
        ("detail_objects", 0, 2),
        ("detail_objects", 1, 1),
        ("two_viewpoints", 0, 12),
        ("city_blocks", 2, 11),
        ("rooms", 0, 1),
        ("bottleneck", 0, 18),
    ] {
        let [found, all] = hidden_left_out(name, eye);
        assert!(found + drawn >= all, "{name}, eye {eye}: {found} of {all} hidden segments are left out");
    }
}

/// A closed box of side 10 about small boxes that touch nothing.
fn shed() -> Arc<Scene<Solid>> {
    let (mut points, mut prims) = (Vec::new(), Vec::new());
    let mut block = |min: Vec3, max: Vec3| {
        let first = points.len() as u32;
        let bounds = Aabb { min, max };
        points.extend(bounds.corners());
        for [a, b, c, d] in
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
        {
            prims.extend([[a, b, c], [a, c, d]].map(|t: [u32; 3]| t.map(|v| first + v)));
        }
    };
    block(Vec3::splat(-5.0), Vec3::splat(5.0));
    for i in 0..21 {
        let at = Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) * 3.0 - Vec3::splat(4.0);
        block(at, at + Vec3::new(0.8, 0.8, 1.5));
    }
    Arc::new(Scene::new(crate::scene::Parts::simple("shed", points, prims)).expect("a scene"))
}

#[test]
fn an_eye_outside_of_the_scene_has_occluders_too() {
    let scene = shed();
    let mut run = run(&scene, &[]);
    for place in [Vec3::new(20.0, 3.0, 20.0), Vec3::new(0.0, 3.0, 20.0), Vec3::new(0.1, 30.0, 0.1)] {
        let mut view = framing_view::<Solid>(&scene.bounds(), 128, 128);
        (view.eye.position, view.eye.target) = (place, Vec3::ZERO);
        let drawn = run.cull(&view).prims.len();
        assert!(drawn <= 40, "from {place} {drawn} of {} triangles are drawn", scene.live().len());
    }
}

#[test]
fn where_back_faces_are_culled_all_active_occluders_can_hide() {
    let scene = example("street").expect("a scene");
    let mut run = run(&scene, &[("backface-culling", "true")]);
    for view in &scene.paths()[0].views {
        let film = run.record(view, usize::MAX).film;
        let count = |kind: &str, about: &dyn Fn(usize) -> bool| {
            (0..film.events().len()).filter(|&at| film.kind(at) == kind && about(at)).count()
        };
        let active = count("OccluderChosen", &|_| true);
        let tested = count("OcclusionTested", &|at| film.subject(at) == Subject::Node(NodeId(0)));
        assert!(active > 8 && active == tested, "{active} are active and {tested} tested");
    }
}
