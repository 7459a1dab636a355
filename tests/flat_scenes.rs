//! Every fact in the flatland scenes, checked against exact visibility by an angular sweep in 64 bits.
//!
//! Between two neighboring directions to end points (or crossings) the order of segments along a ray does not
//! change, so one ray in the middle tells what is seen there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use cullscope::geometry::{Flat, PrimId, View};
use cullscope::scene::{AnyScene, LoadOptions, Motion, Quiet, Scene, load};
use glam::DVec2;

/// Angles between two directions below which nothing counts as seen, radians: what 32-bit rounding moves
/// things by.
const LEAST_ANGLE: f64 = 1e-6;

fn scenes() -> Vec<(PathBuf, Arc<Scene<Flat>>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes2d");
    let entries = std::fs::read_dir(folder).expect("scenes2d").map(|e| e.expect("an entry").path());
    let mut files: Vec<PathBuf> = entries.filter(|p| p.extension().is_some_and(|e| e == "json")).collect();
    files.sort();
    let open = |p: PathBuf| match load(&p.to_string_lossy(), &LoadOptions::default(), &Quiet) {
        Ok(AnyScene::Flat(scene)) => (p, scene),
        other => panic!("{other:?}"),
    };
    files.into_iter().map(open).collect()
}

struct Seen {
    visible: BTreeSet<PrimId>,
    hidden: BTreeSet<PrimId>,
}

fn look(scene: &Scene<Flat>, view: &View<Flat>) -> Seen {
    let eye = view.eye.position.as_dvec2();
    let forward = (view.eye.target - view.eye.position).as_dvec2();
    let half = f64::from(view.eye.fov) * 0.5;
    let segments: Vec<(PrimId, DVec2, DVec2)> = scene
        .live()
        .iter()
        .map(|&p| {
            let ends: Vec<DVec2> = scene.prim_points(p).map(|v| v.as_dvec2()).collect();
            (p, ends[0], ends[1])
        })
        .collect();
    let mut points: Vec<DVec2> = segments.iter().flat_map(|s| [s.1, s.2]).collect();
    for (i, a) in segments.iter().enumerate() {
        points.extend(segments[..i].iter().filter_map(|b| crossing((a.1, a.2), (b.1, b.2))));
    }
    let angle = |p: DVec2| forward.angle_to(p - eye);
    let mut angles: Vec<f64> =
        points.into_iter().map(angle).filter(|a| a.abs() < half).chain([-half, half]).collect();
    angles.sort_by(f64::total_cmp);
    let (mut visible, mut hit) = (BTreeSet::new(), BTreeSet::new());
    for w in angles.windows(2).filter(|w| w[1] - w[0] > LEAST_ANGLE) {
        let ray = DVec2::from_angle((w[0] + w[1]) * 0.5).rotate(forward.normalize());
        let mut met: Vec<(f64, PrimId)> =
            segments.iter().filter_map(|&(id, a, b)| Some((distance(eye, ray, a, b)?, id))).collect();
        met.sort_by(|a, b| a.0.total_cmp(&b.0));
        hit.extend(met.iter().map(|m| m.1));
        // Up to the first that is opaque, and with it.
        let through = met.iter().take_while(|m| scene.is_see_through(m.1)).count();
        visible.extend(met.iter().take(through + 1).map(|m| m.1));
    }
    Seen { hidden: hit.difference(&visible).copied().collect(), visible }
}

fn distance(eye: DVec2, ray: DVec2, a: DVec2, b: DVec2) -> Option<f64> {
    let along = b - a;
    let across = ray.perp_dot(along);
    let (t, u) = ((a - eye).perp_dot(along) / across, (a - eye).perp_dot(ray) / across);
    (across != 0.0 && t > 0.0 && (0.0..=1.0).contains(&u)).then_some(t)
}

fn crossing(a: (DVec2, DVec2), b: (DVec2, DVec2)) -> Option<DVec2> {
    let (u, v) = (a.1 - a.0, b.1 - b.0);
    let across = u.perp_dot(v);
    let (s, t) = ((b.0 - a.0).perp_dot(v) / across, (b.0 - a.0).perp_dot(u) / across);
    (across.abs() > 1e-15 && (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then(|| a.0 + u * s)
}

#[test]
fn every_scene_says_what_it_teaches_and_has_eyes_and_facts() {
    let all = scenes();
    assert!(all.len() >= 8, "{}", all.len());
    for (path, scene) in &all {
        let (about, name) = (scene.about(), path.display());
        assert!(!about.title.is_empty() && about.teaches.ends_with('.'), "{name}");
        assert!(!about.expect.is_empty() && !about.license.is_empty(), "{name}");
        assert_eq!(scene.paths()[0].name, "eyes", "{name}");
        assert_eq!(
            scene.report().dropped_total() + scene.report().notes.len(),
            0,
            "{name}: {:?}",
            scene.report()
        );
    }
}

/// What an eye sees goes from its near plane to its far one: nothing of a scene is behind that.
#[test]
fn eyes_reach_to_the_end_of_their_scenes() {
    for (file, scene) in scenes() {
        let points: Vec<_> = scene.live().iter().flat_map(|&prim| scene.prim_points(prim)).collect();
        for (name, k, view) in
            scene.paths().iter().flat_map(|p| p.views.iter().enumerate().map(move |(k, v)| (&p.name, k, v)))
        {
            let farthest = points.iter().map(|p| p.distance(view.eye.position)).fold(0.0, f32::max);
            assert!(view.eye.far > farthest, "{}: {name} {k}: {farthest}", file.display());
        }
    }
}

#[test]
fn every_fact_is_true_and_none_is_missing() {
    for (path, scene) in scenes() {
        for fact in &scene.about().expect {
            let posed = Motion::new(&scene).at(fact.frame);
            let seen = look(&posed, &scene.paths()[0].views[fact.eye]);
            let what = format!("{}, eye {}, frame {}", path.display(), fact.eye, fact.frame);
            let set = |list: &[PrimId]| list.iter().copied().collect::<BTreeSet<_>>();
            assert_eq!(set(&fact.visible), seen.visible, "visible: {what}");
            assert_eq!(set(&fact.hidden), seen.hidden, "hidden: {what}");
            assert_eq!(
                fact.visible.len() + fact.hidden.len() + fact.outside.len(),
                scene.prim_count(),
                "{what}"
            );
        }
    }
}

#[test]
fn what_a_scene_is_for_is_in_its_facts() {
    let find =
        |name: &str| scenes().into_iter().find(|(p, _)| p.ends_with(name)).expect("a scene of this name").1;
    // Both walls together hide the box; without either of them it is seen.
    let fusion = find("fusion.json");
    let view = &fusion.paths()[0].views[0];
    let hidden = |scene: &Scene<Flat>, prim: u32| look(scene, view).hidden.contains(&PrimId(prim));
    assert!((2..6).all(|p| hidden(&fusion, p)));
    for gone in [0, 1] {
        let mut parts = (*fusion).clone().into_parts();
        parts.prims[gone] = None;
        let without = Scene::new(parts).expect("a scene");
        assert!(!hidden(&without, 2), "the box stays hidden without wall {gone}");
    }
    // A door that opens shows more and more.
    let door = find("moving_door.json");
    assert_eq!(door.frame_count(), 10);
    let seen = |frame| look(&Motion::new(&door).at(frame), &door.paths()[0].views[0]).visible;
    assert!(!seen(0).contains(&PrimId(13)) && seen(9).contains(&PrimId(13)), "the chair comes into view");
    // In a swarm what is seen changes, and from among the bodies most of what is in view is hidden.
    let swarm = find("swarm.json");
    assert_eq!(swarm.frame_count(), 24);
    assert!(swarm.objects().iter().all(|o| o.motion.is_some()) && swarm.prim_count() < 400);
    let seen = |frame| look(&Motion::new(&swarm).at(frame), &swarm.paths()[0].views[0]);
    let (first, later) = (seen(0), seen(7));
    assert!(first.visible != later.visible && first.hidden.len() > 2 * first.visible.len());
    assert!(later.hidden.len() > 2 * later.visible.len());
    // Something is seen through each gap of the fence, and nothing through its boards.
    let holes = find("holes.json");
    let named = |scene: &Scene<Flat>, p: &PrimId| scene.objects()[scene.object_of(*p).at()].name.clone();
    let seen = look(&holes, &holes.paths()[0].views[0]).visible;
    let names: BTreeSet<String> = seen.iter().map(|p| named(&holes, p)).collect();
    for gap in [2, 5, 10, 20, 40, 80] {
        assert!(names.contains(&format!("behind_{gap}cm")), "{names:?}");
    }
    assert!(!names.iter().any(|n| n.starts_with("behind_board")), "{names:?}");
}

/// The numbers of Zhang et al. (1997, Section 5.3.2, Figure 5) as `figure5.json` has them: four objects of 30
/// segments at 2, 3, 4, 5, two of 2 at 50, which alone hide what is behind them.
#[test]
fn near_thickets_leave_a_hole_that_far_walls_close() {
    let (_, scene) = scenes().into_iter().find(|(p, _)| p.ends_with("figure5.json")).expect("the scene");
    let of = |name: &str| {
        let is = |p: &&PrimId| scene.objects()[scene.object_of(**p).at()].name == name;
        scene.live().iter().filter(is).copied().collect::<Vec<_>>()
    };
    let view = &scene.paths()[0].views[0];
    for (name, count, distance) in
        [("C", 30, 2.0), ("D", 30, 3.0), ("E", 30, 4.0), ("F", 30, 5.0), ("A", 2, 50.0), ("B", 2, 50.0)]
    {
        let prims = of(name);
        let bounds = cullscope::geometry::Aabb::of(prims.iter().flat_map(|p| scene.prim_points(*p)));
        assert_eq!(prims.len(), count, "{name}");
        let from_eye = bounds.center().distance(view.eye.position);
        assert!((from_eye - distance).abs() < 0.001 * distance, "{name}: {from_eye}");
    }
    let behind: Vec<PrimId> = ["behind_A", "behind_both", "behind_B"].iter().flat_map(|n| of(n)).collect();
    assert!(behind.iter().all(|p| look(&scene, view).hidden.contains(p)));
    for wall in ["A", "B"] {
        let mut parts = (*scene).clone().into_parts();
        of(wall).iter().for_each(|p| parts.prims[p.at()] = None);
        let without = look(&Scene::new(parts).expect("a scene"), view);
        assert!(of(&format!("behind_{wall}")).iter().any(|p| without.visible.contains(p)), "without {wall}");
    }
}
