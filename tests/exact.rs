//! The conservative methods on real models: no visible primitive is missed, and the image of what was kept is
//! the image of everything, byte for byte.
//!
//! The committed scenes always, from a few views. Where `CULLSCOPE_SCENES` names a folder, every model below
//! it as well, along its whole paths and from 100 random views:
//! `CULLSCOPE_SCENES=models cargo test --release --test exact -- --nocapture`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use cullscope::culling::Methods;
use cullscope::geometry::View;
use cullscope::measure::timing::timed;
use cullscope::method::Settings;
use cullscope::raster::{Canvas, Drawable, Options, Target, shade};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, load, random_views};
use cullscope::truth::Truth;

const WHITE: [f32; 3] = [1.0; 3];

/// Scene files below a folder, in order.
fn models(folder: &Path, into: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a readable folder").map(|e| e.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            models(&path, into);
        } else if path.to_string_lossy().ends_with(".obj") || path.to_string_lossy().ends_with(".flat.json") {
            into.push(path);
        }
    }
}

/// What was seen over all views of a scene.
#[derive(Default)]
struct Sum {
    views: usize,
    drawn: usize,
    visible: usize,
    missed: usize,
    wrong_pixels: usize,
    cull_ms: f64,
    draw_ms: f64,
    all_ms: f64,
}

fn look<S: Methods + Drawable>(
    method: &str,
    pairs: &[(&str, &str)],
    scene: &Arc<Scene<S>>,
    views: &[View<S>],
) -> Sum {
    let entry = S::method(method).expect("a method");
    let settings = Settings::of(pairs);
    let mut run = entry.ready(scene, &settings, &Quiet).expect("settings").expect("not cancelled");
    let mut truth = Truth::new(scene, settings.surfaces(), 1, WHITE);
    let mut target = Target::default();
    let mut sum = Sum { views: views.len(), ..Sum::default() };
    for view in views {
        let (list, cull_ms) = timed(|| run.cull(view));
        let draw_ms = timed(|| list.redraw(&mut target, scene, view, &Options::default())).1;
        let (judged, all_ms) = timed(|| truth.judge(scene, view, &list, (&target, &Canvas::default())));
        assert_eq!(judged.wrong_items == 0, *truth.image() == target, "{}: items and depths", scene.name());
        // The colored images as bytes, from now and then, since coloring is slower than drawing.
        if sum.drawn == 0 {
            assert!(
                shade(truth.image(), scene, view, WHITE) == shade(&target, scene, view, WHITE),
                "{}: {view:?}",
                scene.name()
            );
        }
        sum.drawn += list.prims.len();
        sum.visible += judged.visible.len();
        sum.missed += judged.missed.len();
        sum.wrong_pixels += judged.wrong_items.max(judged.wrong_pixels);
        sum.cull_ms += cull_ms;
        sum.draw_ms += draw_ms;
        sum.all_ms += all_ms;
    }
    sum
}

/// Views along the scene's paths, each `every`th, and random ones; of at most `side_px` pixels across.
fn views<S: Drawable>(scene: &Scene<S>, every: usize, random: usize, side_px: u32) -> Vec<View<S>> {
    let along = scene.paths().iter().flat_map(|p| p.views.iter().step_by(every));
    let mut views: Vec<View<S>> = along.copied().chain(random_views(scene, random, 1)).collect();
    views.iter_mut().for_each(|v| (v.width, v.height) = (v.width.min(side_px), v.height.min(side_px)));
    views
}

/// Settings beside the defaults with which a method promises to miss nothing.
const SETTINGS: [(&str, &[(&str, &str)]); 6] = [
    ("large-occluders", &[("cells", "true"), ("tree-height", "12")]),
    ("hierarchical-z", &[("coherence", "false"), ("query", "rectangles"), ("redistribution", "split")]),
    ("hierarchical-z", &[("form", "two-pass"), ("check-interval", "30"), ("query", "sphere")]),
    ("parallel-hierarchical-z", &[("leaf-primitives", "256")]),
    ("layered-projection", &[("budget", "2%"), ("queries", "true")]),
    (
        "layered-projection",
        &[("budget", "5%"), ("queries", "true"), ("tessellation", "octree"), ("seeds", "16")],
    ),
];

/// Every method of the list that promises to miss none, and those settings.
fn check<S: Methods + Drawable>(scene: &Arc<Scene<S>>, views: &[View<S>]) -> (usize, usize) {
    let cards = S::methods().iter().map(|m| m.card());
    let by_default = cards.filter(|c| c.conservative).map(|c| (c.key, &[][..]));
    by_default
        .chain(SETTINGS)
        .map(|(method, pairs)| check_method(method, pairs, scene, views))
        .fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1))
}

fn check_method<S: Methods + Drawable>(
    method: &str,
    pairs: &[(&str, &str)],
    scene: &Arc<Scene<S>>,
    views: &[View<S>],
) -> (usize, usize) {
    let sum = look(method, pairs, scene, views);
    let method = pairs.iter().fold(method.to_owned(), |text, (k, v)| format!("{text} {k}={v}"));
    let per = |total: f64| total / sum.views.max(1) as f64;
    println!(
        "{method:<16} {:<28} {:>7} {}s {:>4} views: {} missed, {} wrong pixels; drawn {:>8.0} visible \
         {:>7.0} a view; cull {:.3} ms, draw {:.2} ms, truth {:.2} ms",
        scene.name(),
        scene.live().len(),
        S::PRIM,
        sum.views,
        sum.missed,
        sum.wrong_pixels,
        per(sum.drawn as f64),
        per(sum.visible as f64),
        per(sum.cull_ms),
        per(sum.draw_ms),
        per(sum.all_ms),
    );
    (sum.missed, sum.wrong_pixels)
}

fn check_file(path: &str, every: usize, random: usize, side_px: u32) {
    let found = match load(path, &LoadOptions::default(), &Quiet).unwrap_or_else(|e| panic!("{e}")) {
        AnyScene::Flat(scene) => check(&scene, &views(&scene, every, random, side_px)),
        AnyScene::Solid(scene) => check(&scene, &views(&scene, every, random, side_px)),
    };
    assert_eq!(found, (0, 0), "{path}: missed triangles and wrong pixels");
}

#[test]
fn committed_models_lose_nothing() {
    let mut found = Vec::new();
    for folder in ["scenes2d", "scenes3d"] {
        models(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut found);
    }
    assert!(found.len() >= 8, "the real models are there");
    found.iter().for_each(|path| check_file(&path.to_string_lossy(), 40, 4, 200));
}

#[test]
fn models_at_hand_lose_nothing() {
    let Some(folder) = std::env::var_os("CULLSCOPE_SCENES") else {
        println!("skipped: CULLSCOPE_SCENES names no folder of models");
        return;
    };
    let mut found = Vec::new();
    models(Path::new(&folder), &mut found);
    assert!(!found.is_empty(), "no model below {}", folder.display());
    found.iter().for_each(|path| check_file(&path.to_string_lossy(), 1, 100, 1024));
}

#[test]
fn generated_models_lose_nothing() {
    // Where models are named, at full size, along the whole walk and from 100 random views.
    let full = std::env::var_os("CULLSCOPE_SCENES").is_some();
    let (every, random, side_px) = if full { (1, 100, 1024) } else { (24, 6, 160) };
    for (name, few) in [
        ("building", 6_000),
        ("city", 6_000),
        ("machine-room", 30_000),
        ("box-and-objects", 4_000),
        ("thin-slabs", 30_000),
        ("seminar-room", 10_000),
        ("cars", 100_000),
        ("forest", 20_000),
        ("swarm", 10_000),
        ("terrain", 10_000),
        ("tree", 10_000),
        ("tree-quadrupling", 4_000),
        ("venetian-blind", 4_000),
        ("bust", 10_000),
        ("suspension", 6_000),
    ] {
        let call = if full { format!("generate:{name}") } else { format!("generate:{name}?polygons={few}") };
        check_file(&call, every, random, side_px);
    }
}
