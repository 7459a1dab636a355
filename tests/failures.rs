//! Every listed method on every scene of the catalogue of failures, in both spaces.
//!
//! - Who promises to draw all that is visible does so: nothing is missed, no pixel is wrong, nothing pops;
//! - the known weakness shows: `failures.json` says of which methods, and between which bounds it lies;
//! - the scale of a scene changes nothing, where it is a power of two;
//! - what is counted as popping is that.
//!
//! Only what is counted is asserted, so a run repeats exactly. A method that is listed later is held to the
//! first rule without a change here.

use std::collections::BTreeMap;
use std::sync::Arc;

use cullscope::culling::Methods;
use cullscope::geometry::{Flat, PrimId, Solid, View};
use cullscope::measure::experiment::World;
use cullscope::measure::stability::{Found, Watcher, along};
use cullscope::method::{Entry, Settings};
use cullscope::raster::{Light, Options, Target};
use cullscope::scene::{Failure, Motion, Quiet, Scene, Surfaces, Symptom, failures};
use cullscope::truth::Truth;
use serde::Deserialize;

/// What is expected of a method on a scene.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    case: String,
    space: String,
    method: String,
    /// Parameters other than the defaults.
    #[serde(default)]
    set: BTreeMap<String, String>,
    /// What is measured, if not what the scene is for.
    symptom: Option<String>,
    /// Bounds of the measure, each in it.
    least: f64,
    most: Option<f64>,
}

impl Row {
    fn symptom(&self, failure: &Failure) -> Symptom {
        let Some(word) = &self.symptom else { return failure.symptom };
        let found = Symptom::ALL.into_iter().find(|s| s.word() == word);
        found.unwrap_or_else(|| panic!("failures.json: there is no symptom {word}"))
    }
    fn is_of<S: World>(&self, failure: &Failure, entry: &dyn Entry<S>) -> bool {
        (&*self.case, &*self.space, &*self.method) == (failure.name, S::NAME, entry.card().key)
    }
}

fn rows() -> Vec<Row> {
    let rows: Vec<Row> = serde_json::from_str(include_str!("failures.json")).expect("a list of rows");
    for row in &rows {
        assert!(failures().iter().any(|f| f.name == row.case), "failures.json: no case {}", row.case);
        let known = match &*row.space {
            "flatland" => Flat::method(&row.method).is_some(),
            "space" => Solid::method(&row.method).is_some(),
            other => panic!("failures.json: no space {other}"),
        };
        assert!(known, "failures.json: no method {} in {}", row.method, row.space);
    }
    rows
}

/// What a method does along the path of a scene, and whether it promises to draw all that is visible.
fn followed<S: World>(entry: &dyn Entry<S>, scene: &Arc<Scene<S>>, settings: &Settings) -> (Found, bool) {
    let run = entry.ready(&Motion::new(scene).at(0), settings, &Quiet).expect("settings fit");
    let mut run = run.expect("not cancelled");
    let promises = entry.is_conservative(settings).expect("settings fit");
    let mut watcher = Watcher::new(scene, &mut *run);
    let path = along(&mut watcher, &scene.paths()[0].views, false, &Quiet).expect("not cancelled");
    let mut sum = Found::default();
    path.iter().for_each(|station| sum.join(&station.found));
    (sum, promises)
}

fn every_method_behaves_as_expected<S: World>() {
    let rows = rows();
    let mut wrong = Vec::new();
    for failure in failures() {
        let scene = Arc::new(failure.scene::<S>().expect("a scene"));
        let mut shows = false;
        for entry in S::methods() {
            let here: Vec<&Row> = rows.iter().filter(|row| row.is_of(failure, *entry)).collect();
            let mut ways = vec![Settings::default(), Settings::of(&[("backface-culling", "true")])];
            for settings in here.iter().map(|row| Settings(row.set.clone())) {
                if !ways.contains(&settings) {
                    ways.push(settings);
                }
            }
            for settings in ways {
                let (found, promises) = followed(*entry, &scene, &settings);
                let key = entry.card().key;
                let what = format!("{} in {}: {key} {:?}", failure.name, S::NAME, settings.0);
                let values =
                    Symptom::ALL.map(|s| format!("{} {:.3}", s.word(), found.of(s, scene.live().len())));
                println!("{what}: {}", values.join(", "));
                if promises && !(found.is_exact() && found.popped == 0 && found.popped_pixels == 0) {
                    wrong.push(format!("{what} promises to draw all that is visible: {found:?}"));
                }
                for row in here.iter().filter(|row| row.set == settings.0) {
                    let symptom = row.symptom(failure);
                    let value = found.of(symptom, scene.live().len());
                    let most = row.most.unwrap_or(f64::INFINITY);
                    if !(row.least..=most).contains(&value) {
                        let range = format!("from {} to {most}", row.least);
                        wrong.push(format!("{what}: {} is {value}, not {range}", symptom.word()));
                    }
                    shows |= symptom == failure.symptom && row.least > 0.0;
                }
            }
        }
        // What is only compared with the same scene elsewhere shows nothing else.
        if !shows && !ALIKE.contains(&failure.name) {
            wrong.push(format!("{} in {}: no row says that its weakness shows", failure.name, S::NAME));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_method_behaves_as_expected_in_flatland() {
    every_method_behaves_as_expected::<Flat>();
}
#[test]
fn every_method_behaves_as_expected_in_space() {
    every_method_behaves_as_expected::<Solid>();
}

/// Popping by its definition: primitives from plain runs and the truth alone, pixels from images drawn anew.
fn popping_is_what_it_says<S: World>() {
    let (mut all_prims, mut all_pixels) = (0, 0);
    for failure in failures().iter().filter(|f| ["slivers", "blind"].contains(&f.name)) {
        let scene = Arc::new(failure.scene::<S>().expect("a scene"));
        let views = &scene.paths()[0].views;
        let ready = || {
            let run = S::method("centroid").expect("a method").ready(&scene, &Settings::default(), &Quiet);
            run.expect("settings fit").expect("not cancelled")
        };
        let (mut plain, mut watched) = (ready(), ready());
        let mut watcher = Watcher::new(&scene, &mut *watched);
        let path = along(&mut watcher, views, false, &Quiet).expect("not cancelled");
        let mut truth = Truth::new(&scene, Surfaces::default(), 1, [1.0; 3]);
        let mut at = |view| {
            let (drawn, visible) = (plain.cull(view).prims, truth.look(&*scene, view));
            (shown(&scene, view, &drawn), shown(&scene, view, scene.live()), drawn, visible)
        };
        for k in 1..views.len() {
            let (one, two) = (at(&views[k - 1]), at(&views[k]));
            let both = one.3.iter().filter(|p| two.3.contains(p));
            let popped: Vec<PrimId> =
                both.copied().filter(|p| one.2.contains(p) != two.2.contains(p)).collect();
            let pixels = (0..one.0.len()).filter(|&k| one.0[k] != two.0[k] && one.1[k] == two.1[k]).count();
            let what = format!("{} in {}, view {k}", failure.name, S::NAME);
            assert_eq!((&path[k].popped, path[k].found.popped_pixels), (&popped, pixels), "{what}");
            (all_prims, all_pixels) = (all_prims + popped.len(), all_pixels + pixels);
        }
    }
    assert!(all_prims > 0 && all_pixels > 0, "{all_prims} and {all_pixels} pop in {}", S::NAME);
}

/// The color of each pixel of what was drawn, under the fixed light; `None` where nothing is.
fn shown<S: World>(scene: &Scene<S>, view: &View<S>, prims: &[PrimId]) -> Vec<Option<[f32; 3]>> {
    let mut target = Target::default();
    S::redraw(&mut target, scene, view, prims, &Options::default());
    let color = |item: u32| Light::Fixed.color(scene, view, PrimId(item));
    target.item.iter().map(|&item| (item != Target::NONE).then(|| color(item))).collect()
}

#[test]
fn popping_is_what_it_says_in_flatland() {
    popping_is_what_it_says::<Flat>();
}
#[test]
fn popping_is_what_it_says_in_space() {
    popping_is_what_it_says::<Solid>();
}

/// One scene, at several scales and places.
const ALIKE: [&str; 3] = ["tiny-scale", "huge-scale", "far-off"];

/// Sums and products of numbers that are all multiplied by a power of two are multiplied by one too.
fn scale_changes_nothing<S: World>() {
    let scene = |name: &str| {
        let failure = failures().iter().find(|f| f.name == name).expect("a case");
        Arc::new(failure.scene::<S>().expect("a scene"))
    };
    let [tiny, huge, far] = ALIKE.map(scene);
    for entry in S::methods() {
        let [small, large] = [&tiny, &huge].map(|scene| followed(*entry, scene, &Settings::default()).0);
        let what = format!("{} in {}", entry.card().key, S::NAME);
        assert_eq!(small, large, "{what}");
        // Coordinates are rounded there, and culling is as good: not a primitive more is kept.
        let off = followed(*entry, &far, &Settings::default()).0;
        assert_eq!((off.visible, off.kept), (small.visible, small.kept), "{what}, far off");
    }
}

#[test]
fn scale_changes_nothing_in_flatland() {
    scale_changes_nothing::<Flat>();
}
#[test]
fn scale_changes_nothing_in_space() {
    scale_changes_nothing::<Solid>();
}
