//! Truth and the checker of certificates: they see what is wrong, and accept what is right.

use std::sync::Arc;

use cullscope::culling::{Film, Methods, Settings};
use cullscope::drawing::Subject;
use cullscope::geometry::{Flat, NodeId, PrimId, Solid, View};
use cullscope::raster::{Drawable, render};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, load, random_views};
use cullscope::truth::Truth;
use cullscope::truth::certificate::{Certificate, Checker, Claim, certificates, check_film};

const WHITE: [f32; 3] = [1.0; 3];

fn building() -> Arc<Scene<Solid>> {
    match load("generate:building?polygons=2000&seed=9", &LoadOptions::default(), &Quiet).expect("a building") {
        AnyScene::Solid(scene) => scene,
        AnyScene::Flat(_) => panic!("a building stands in space"),
    }
}

fn street() -> Arc<Scene<Flat>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes2d/street.json");
    match load(path, &LoadOptions::default(), &Quiet).expect("a street") {
        AnyScene::Flat(scene) => scene,
        AnyScene::Solid(_) => panic!("the street is flat"),
    }
}

#[test]
fn leaving_out_something_visible_is_seen() {
    let scene = building();
    let mut truth = Truth::new(&scene, false, 1, WHITE);
    for view in random_views(&scene, 6, 4) {
        let visible = truth.look(&scene, &view);
        let Some(&missing) = visible.get(visible.len() / 2) else { continue };
        let drawn: Vec<PrimId> = scene.live().iter().copied().filter(|&p| p != missing).collect();
        let judged = truth.judge(&scene, &view, &drawn, &render(&scene, &view, &drawn));
        assert_eq!(judged.missed, [missing]);
        let owned = truth.image().item.iter().filter(|&&i| i == missing.0).count();
        assert_eq!(judged.wrong_items, owned, "exactly its pixels are wrong");
        assert!(judged.wrong_pixels <= owned);
        assert!((judged.flip_mean > 0.0) == (judged.wrong_pixels > 0) && judged.flip_mean < 1.0);
        assert_eq!(judged.coverage_ratio(), (visible.len() - 1) as f64 / visible.len() as f64);
        assert_eq!(judged.overdraw(), Some(drawn.len() as f64 / visible.len() as f64));
        // Only what is visible, in any order, is enough.
        let backwards: Vec<PrimId> = visible.iter().rev().copied().collect();
        let judged = truth.judge(&scene, &view, &backwards, &render(&scene, &view, &backwards));
        assert!(judged.is_exact() && judged.overdraw() == Some(1.0), "{judged:?}");
    }
}

#[test]
fn an_eye_that_sees_nothing_is_no_division_by_zero() {
    let scene = street();
    let mut view = random_views(&*scene, 1, 1)[0];
    view.eye.position = scene.bounds().max + scene.bounds().size();
    view.eye.target = view.eye.position + scene.bounds().size();
    let judged = Truth::new(&scene, false, 1, WHITE).judge(&scene, &view, &[], &render(&scene, &view, &[]));
    assert_eq!((judged.visible.len(), judged.coverage_ratio(), judged.overdraw(), judged.flip_mean), (0, 1.0, None, 0.0));
    assert!(judged.is_exact());
}

fn film<S: Methods>(scene: &Arc<Scene<S>>, view: &View<S>, method: &str, settings: &[(&str, &str)]) -> Arc<dyn Film<S>> {
    let settings = Settings(settings.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect());
    let entry = S::method(method).expect("a method");
    entry.ready(scene, &settings, &Quiet).expect("settings").expect("not cancelled").record(view, usize::MAX).film
}

/// Every way to spoil a certificate that leaves it well-formed.
fn spoiled(certificate: &Certificate) -> Vec<(&'static str, Certificate)> {
    let with = |claim| Certificate { claim, ..certificate.clone() };
    match certificate.claim.clone() {
        Claim::FacesAway { eye_distance } => vec![
            ("the sign", with(Claim::FacesAway { eye_distance: -eye_distance })),
            ("the distance", with(Claim::FacesAway { eye_distance: eye_distance * 1.5 })),
            ("the primitive", Certificate { subject: Subject::Prim(PrimId(u32::MAX)), ..certificate.clone() }),
            ("the kind of subject", Certificate { subject: Subject::Node(NodeId(0)), ..certificate.clone() }),
        ],
        Claim::Beyond { plane, far_corner, error, box_min, box_max } => {
            let beyond = |far_corner, error, box_min, box_max| Claim::Beyond { plane: plane.clone(), far_corner, error, box_min, box_max };
            let named = |plane: &str| Claim::Beyond { plane: plane.into(), far_corner, error, box_min: box_min.clone(), box_max: box_max.clone() };
            let opposite = ["left", "right", "bottom", "top", "near", "far"].iter().position(|p| *p == plane).expect("a plane") ^ 1;
            let mut smaller = box_max.clone();
            smaller[0] = box_min[0] - 1.0;
            let grown = |side: &[f64], by: f64| side.iter().map(|v| v + by).collect::<Vec<f64>>();
            let (lower, larger) = (grown(&box_min, -1e6), grown(&box_max, 1e6));
            vec![
                ("the sign", with(beyond(-far_corner, error, box_min.clone(), box_max.clone()))),
                ("the distance", with(beyond(far_corner * 1.5 - 1.0, error, box_min.clone(), box_max.clone()))),
                ("the error", with(beyond(far_corner, -far_corner * 2.0, box_min.clone(), box_max.clone()))),
                ("a negative error", with(beyond(far_corner, -1e-6, box_min.clone(), box_max.clone()))),
                ("the plane", with(named(["left", "right", "bottom", "top", "near", "far"][opposite]))),
                ("a plane that is none", with(named("middle"))),
                ("the node", Certificate { subject: Subject::Node(NodeId(0)), ..certificate.clone() }),
                ("a node that is none", Certificate { subject: Subject::Node(NodeId(u32::MAX)), ..certificate.clone() }),
                ("a box that is too small", with(beyond(far_corner, error, box_min.clone(), smaller))),
                ("a box of another shape", with(beyond(far_corner, error, lower, larger))),
                ("the axes", with(beyond(far_corner, error, vec![0.0], box_max.clone()))),
            ]
        }
    }
}

fn checker_tells_right_from_wrong<S: Methods + Drawable>(scene: &Arc<Scene<S>>) {
    let mut tried = 0;
    for (method, settings) in
        [("frustum", &[("tree-height", "6"), ("backface-culling", "true")][..]), ("centroid", &[]), ("z-buffer", &[("backface-culling", "true")])]
    {
        for view in random_views(scene, 5, 11) {
            let film = film(scene, &view, method, settings);
            let shown = certificates(&*film);
            assert_eq!(check_film(&*film), Ok(shown.len()));
            let checker = Checker::new(scene, film.hierarchy(), &view);
            for certificate in shown.iter().step_by(7) {
                for (what, altered) in spoiled(certificate) {
                    assert!(checker.check(&altered).is_err(), "{method}: {what} altered: {altered:?}");
                    tried += 1;
                }
            }
            // The same evidence for another eye is none.
            let mut turned = view;
            turned.eye.target = view.eye.position + (view.eye.position - view.eye.target);
            turned.eye.fov *= 0.9;
            let other = Checker::new(scene, film.hierarchy(), &turned);
            let beyond = |c: &&Certificate| matches!(c.claim, Claim::Beyond { .. });
            assert!(shown.iter().filter(beyond).all(|c| other.check(c).is_err()), "{method}: an eye that looks the other way");
        }
    }
    assert!(tried > 200, "{tried}");
}

#[test]
fn certificates_are_accepted_and_altered_ones_rejected_in_flatland() {
    checker_tells_right_from_wrong(&street());
}
#[test]
fn certificates_are_accepted_and_altered_ones_rejected_in_space() {
    checker_tells_right_from_wrong(&building());
}
