//! The baselines against brute force.

use crate::culling::Methods;
use crate::geometry::{Eye, Flat, PrimId, Solid, Space, Vector, View, faces_away};
use crate::method::{Event, SettingError, Settings, Value, Verdict};
use crate::scene::{Quiet, Scene, framing_view, samples};
use std::sync::Arc;

fn settings(pairs: &[(&str, &str)]) -> Settings {
    Settings::of(pairs)
}

/// An eye inside the scene that turns with `k`.
fn inside<S: Space>(scene: &Scene<S>, k: u32) -> View<S> {
    let mut view = framing_view::<S>(&scene.bounds(), 64, 64);
    let angle = k as f32;
    let toward = S::Vector::from_fn(|a| [angle.cos(), angle.sin(), 0.3][a]);
    let position = scene.bounds().center() + toward * (k % 5) as f32;
    view.eye = Eye { position, target: position + toward, near: 0.05, far: 16.0, ..view.eye };
    view
}

fn cull<S: Methods>(
    scene: &Arc<Scene<S>>,
    method: &str,
    pairs: &[(&str, &str)],
    view: &View<S>,
) -> Vec<PrimId> {
    let mut run = S::method(method)
        .expect("a method")
        .ready(scene, &settings(pairs), &Quiet)
        .expect("settings")
        .expect("not cancelled");
    run.cull(view).prims
}

fn has_a_corner_in_view<S: Space>(scene: &Scene<S>, view: &View<S>, prim: PrimId) -> bool {
    let projection = view.projection();
    let axes = S::Vector::AXES;
    scene.prim_points(prim).any(|p| {
        let clip = projection.clip(p);
        let w = clip.get(axes - 1);
        w >= view.eye.near && w <= view.eye.far && (0..axes - 1).all(|a| clip.get(a).abs() <= w)
    })
}

fn frustum_keeps_what_is_in_view<S: Methods>() {
    let (mut kept, mut total) = (0, 0);
    for seed in 0..20 {
        let scene = samples::soup::<S>(seed, 400);
        let view = inside(&scene, seed as u32);
        let mut drawn = cull(&scene, "frustum", &[("tree-height", "12")], &view);
        drawn.sort();
        let once = drawn.len();
        drawn.dedup();
        assert_eq!(drawn.len(), once, "each primitive at most once");
        for &p in scene.live() {
            if has_a_corner_in_view(&scene, &view, p) {
                assert!(
                    drawn.binary_search(&p).is_ok(),
                    "{} {p} has a corner in view and was culled",
                    S::PRIM
                );
            }
        }
        kept += drawn.len();
        total += scene.live().len();
    }
    assert!(kept * 2 < total, "it culls more than half of these scenes: kept {kept} of {total}");
}

#[test]
fn frustum_culling_keeps_what_is_in_view_and_culls_the_rest() {
    frustum_keeps_what_is_in_view::<Flat>();
    frustum_keeps_what_is_in_view::<Solid>();
}

#[test]
fn a_taller_tree_culls_no_less() {
    let scene = samples::soup::<Solid>(3, 2000);
    let view = inside(&scene, 3);
    let drawn: Vec<usize> = ["1", "4", "8", "12"]
        .iter()
        .map(|h| cull(&scene, "frustum", &[("tree-height", h)], &view).len())
        .collect();
    assert_eq!(drawn[0], 2000, "a tree of one level is one node");
    assert!(drawn.windows(2).all(|w| w[1] <= w[0]), "{drawn:?}");
}

fn back_faces_are_left_out<S: Methods>() {
    let scene = samples::soup::<S>(5, 500);
    let view = inside(&scene, 1);
    for method in ["z-buffer", "frustum", "centroid"] {
        let budget: &[(&str, &str)] = if method == "centroid" { &[("budget", "100%")] } else { &[] };
        let two_sided = cull(&scene, method, budget, &view);
        let one_sided = cull(&scene, method, &[budget, &[("backface-culling", "true")]].concat(), &view);
        let faces =
            |p: &PrimId| !faces_away::<S>(view.eye.position, &scene.prim_points(*p).collect::<Vec<_>>());
        assert_eq!(one_sided, two_sided.into_iter().filter(faces).collect::<Vec<_>>(), "{method}");
        assert!(!one_sided.is_empty());
    }
}

#[test]
fn back_face_culling_leaves_out_exactly_what_faces_away() {
    back_faces_are_left_out::<Flat>();
    back_faces_are_left_out::<Solid>();
}

#[test]
fn the_centroid_order_is_that_of_a_plain_sort_cut_at_the_budget() {
    let scene = samples::soup::<Solid>(6, 300);
    let view = inside(&scene, 2);
    let distance = |p: PrimId| {
        let c: glam::Vec3 = scene.prim_points(p).sum::<glam::Vec3>() / 3.0;
        f64::from(c.distance(view.eye.position))
    };
    let all = cull(&scene, "centroid", &[("budget", "100%")], &view);
    assert!(
        all.len() > 15 && all.windows(2).all(|w| distance(w[0]) <= distance(w[1]) + 1e-5),
        "nearest first"
    );
    assert_eq!(cull(&scene, "centroid", &[("budget", "7")], &view), all[..7]);
    assert_eq!(cull(&scene, "centroid", &[("budget", "5%")], &view), all[..15], "5 % of the scene's 300");
    assert!(cull(&scene, "centroid", &[("budget", "0")], &view).is_empty());
}

#[test]
fn counts_agree_with_the_film() {
    let scene = samples::soup::<Flat>(7, 300);
    let view = inside(&scene, 3);
    let mut run = Flat::method("frustum")
        .expect("a method")
        .ready(&scene, &Settings::default(), &Quiet)
        .expect("ok")
        .expect("ok");
    let (list, tally) = run.count(&view);
    let recording = run.record(&view, usize::MAX);
    assert_eq!(list, recording.list);
    let count = |f: fn(&Event) -> bool| recording.film.events().iter().filter(|e| f(e)).count() as u64;
    assert_eq!(tally.nodes_entered, count(|e| matches!(e, Event::Entered(_))));
    assert_eq!(
        tally.nodes_decided,
        count(|e| matches!(e, Event::DecidedNode(_, v) if *v != Verdict::Partial))
    );
    let (boxes, planes) = (tally.named()["boxes_tested"], tally.named()["planes_tested"]);
    assert_eq!(boxes, tally.nodes_entered);
    assert!(planes >= tally.nodes_entered && planes <= 4 * tally.nodes_entered);

    // What is computed when a note is read is what was found when it was taken.
    let (mut told, mut outside) = (0, 0);
    for at in 0..recording.film.events().len() {
        let (kind, fields) = recording.film.fields(at);
        if kind != "NodeClassified" {
            continue;
        }
        let value = |name: &str| &fields.iter().find(|f| f.name == name).expect("a field").value;
        let (Value::Word(result), Value::List(far), Value::List(near), Value::List(error)) =
            (value("result"), value("far_corner_units"), value("near_corner_units"), value("error_units"))
        else {
            panic!("{fields:?}");
        };
        told += far.len() as u64;
        let last = far.len() - 1;
        assert_eq!(result == "outside", far[last] < -error[last]);
        assert!(
            (0..last).all(|i| far[i] >= -error[i]),
            "the first plane that says outside is the last one tested"
        );
        assert!(result != "inside" || near.iter().all(|d| *d >= 0.0));
        outside += u64::from(result == "outside");
    }
    assert_eq!(told, planes, "planes named by notes and planes counted");
    assert!(outside > 10, "{outside}");
}

#[test]
fn every_event_has_a_sentence_and_fields() {
    let scene = samples::soup::<Solid>(8, 60);
    let view = inside(&scene, 4);
    for entry in Solid::methods() {
        let backfaces = settings(&[("backface-culling", "true")]);
        let film =
            entry.ready(&scene, &backfaces, &Quiet).expect("ok").expect("ok").record(&view, usize::MAX).film;
        for at in 0..film.events().len() {
            let (sentence, (kind, fields)) = (film.sentence(at), film.fields(at));
            assert!(sentence.len() > 10 && !sentence.contains("NaN"), "{sentence}");
            assert!(kind.chars().next().is_some_and(char::is_uppercase));
            assert!(fields.iter().all(|f| f.name.chars().all(|c| c.is_ascii_lowercase() || c == '_')));
        }
    }
}

#[test]
fn a_wrong_setting_says_what_is_right() {
    let entry = Flat::method("frustum").expect("a method");
    let error = |k: &str, v: &str| entry.knobs(&settings(&[(k, v)])).expect_err("refused").to_string();
    assert_eq!(
        error("height", "3"),
        "`frustum` has no parameter `height`; it has tree-height, backface-culling, see-through"
    );
    assert_eq!(error("tree-height", "0"), "`tree-height=0`: expected a whole number from 1 to 24");
    assert_eq!(error("backface-culling", "yes"), "`backface-culling=yes`: expected true or false");
    let budget = Flat::method("centroid")
        .expect("a method")
        .knobs(&settings(&[("budget", "120%")]))
        .expect_err("refused");
    assert!(budget.to_string().starts_with("`budget=120%`: expected a number of primitives"));
    assert_eq!(Settings::default().parse("height"), Err(SettingError::NotAPair("height".into())));
}
