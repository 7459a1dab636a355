//! Cells that are left out because they do not show: nothing is missing in the picture.

use std::sync::Arc;

use super::*;
use crate::geometry::dice::Dice;
use crate::geometry::{Flat, PrimId, Solid, Space, View};
use crate::method::{Recorder, Unobserved, Verdict};
use crate::raster::{Canvas, Options, fixed_light, render};
use crate::scene::{Parts, Quiet, framing_view, random_views};

/// Many primitives of a size, and some large ones that hide what is behind them.
fn cluttered<S: Space>(seed: u64, (small, length): (u32, f32), large: u32) -> Arc<Scene<S>> {
    let mut dice = Dice::new(seed);
    let n = S::CORNERS as u32;
    let mut points: Vec<S::Vector> = Vec::new();
    for k in 0..small + large {
        let center: S::Vector = dice.vector(10.0);
        let size = if k < large { 9.0 } else { length };
        points.extend((0..n).map(|_| center + dice.vector(size)));
    }
    let prims = (0..small + large).map(|i| S::corners_from(std::array::from_fn(|k| i * n + k as u32)));
    let mut parts = Parts::simple("clutter", points, prims.collect());
    parts.materials[0].color = [0.8, 0.5, 0.2];
    Arc::new(Scene::new(parts).expect("a valid scene"))
}

/// A frame: what is drawn, and how many cells were left out behind geometry and behind cubes.
fn frame<S: Projected>(scene: &Scene<S>, view: &View<S>, params: &Params) -> (DrawList<S>, [usize; 2]) {
    let index = CubeTree::build(scene, params, None, &Quiet).expect("no bytes").expect("not cancelled");
    let frame: Frame<'_, S, ColorCubes> = Frame { index: &index, scene, view, params, limit: None };
    let begun = || {
        let mut drawn = Drawn::default();
        crate::method::State::begin(&mut drawn, &frame);
        drawn
    };
    let (mut list, mut film) = (DrawList::default(), Recorder::new(usize::MAX));
    ColorCubes::cull(&frame, &mut (), &mut begun(), &mut list, &mut film);
    let mut plain = DrawList::default();
    ColorCubes::cull(&frame, &mut (), &mut begun(), &mut plain, &mut Unobserved);
    assert_eq!(plain, list, "watched or not");
    let count = |verdict: Verdict| {
        film.events.iter().filter(|e| matches!(e, Event::DecidedNode(_, v) if *v == verdict)).count()
    };
    (list, [count(Verdict::Hidden), count(Verdict::Presumed)])
}

fn params(pixel_threshold: f32, occlusion: Occlusion) -> Params {
    Params { pixel_threshold, occlusion, ..Params::default() }
}

/// Views from outside and inside, of about so many pixels.
fn views<S: Space>(scene: &Scene<S>, seed: u64, px: u32) -> Vec<View<S>> {
    let mut views = random_views(scene, 5, seed);
    views.push(framing_view(&scene.bounds(), px, px));
    for view in &mut views {
        (view.width, view.height) = (px, view.height.min(px));
    }
    views
}

fn hiding_by_depth_changes_no_byte<S: Projected>(px: u32) {
    let (mut hidden, mut fewer) = (0, 0);
    for seed in 0..6 {
        let scene = cluttered::<S>(seed, (2000, 0.6), 12);
        for view in views(&scene, seed, px) {
            for threshold in [0.0, 1.0, 6.0, 40.0] {
                let (plain, none) = frame(&scene, &view, &params(threshold, Occlusion::None));
                let (list, [count, _]) = frame(&scene, &view, &params(threshold, Occlusion::Depth));
                assert_eq!(none, [0, 0]);
                let painted = |list: &DrawList<S>| list.paint(&scene, &view, &Options::default(), [1.0; 3]);
                assert_eq!(painted(&list), painted(&plain), "seed {seed}, threshold {threshold}");
                if threshold == 0.0 {
                    let whole = render(&scene, &view, scene.live());
                    assert_eq!(render(&scene, &view, &list.prims), whole, "seed {seed}");
                }
                hidden += count;
                fewer += usize::from(
                    list.prims.len() < plain.prims.len() && list.stand_ins.len() <= plain.stand_ins.len(),
                );
            }
        }
    }
    assert!(hidden > 300 && fewer > 20, "{hidden} cells, {fewer} frames");
}

/// Behind what is drawn nothing shows: the same bytes, whether cells are drawn as cubes or not.
#[test]
fn hiding_by_depth_changes_no_byte_in_flatland() {
    hiding_by_depth_changes_no_byte::<Flat>(512);
}
#[test]
fn hiding_by_depth_changes_no_byte_in_space() {
    hiding_by_depth_changes_no_byte::<Solid>(160);
}

/// The picture in linear light, before anything is rounded, on white.
fn linear<S: Projected>(list: &DrawList<S>, scene: &Scene<S>, view: &View<S>) -> Vec<[f32; 3]> {
    let image = render(scene, view, &list.ascending());
    let mut canvas = Canvas::default();
    canvas.clear(view);
    canvas.composite(&list.stand_ins, &image, view, &Options::default());
    let behind = |item: u32| match item {
        crate::raster::Target::NONE => [1.0; 3],
        item => scene.color_of(PrimId(item)).map(|c| c * fixed_light(scene, PrimId(item))),
    };
    let mixed =
        |(sample, &item): ([f32; 4], &u32)| std::array::from_fn(|c| sample[c] + sample[3] * behind(item)[c]);
    canvas.samples().zip(&image.item).map(mixed).collect()
}

fn hiding_behind_cubes_changes_next_to_nothing<S: Projected>(px: u32, small: (u32, f32)) {
    let (mut presumed, mut worst) = (0, 0.0_f32);
    for seed in 0..2 {
        let scene = cluttered::<S>(seed, small, 6);
        for view in views(&scene, seed, px) {
            for threshold in [6.0, 24.0] {
                let (plain, _) = frame(&scene, &view, &params(threshold, Occlusion::Depth));
                let (list, [_, count]) = frame(&scene, &view, &params(threshold, Occlusion::DepthAndOpacity));
                presumed += count;
                let [a, b] = [&list, &plain].map(|list| linear(list, &scene, &view));
                let off = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs());
                worst = off.fold(worst, f32::max);
                assert!(worst < 1.0 / 1024.0, "seed {seed}, threshold {threshold}: {worst}");
                let (before, after) = (plain.stand_ins.len(), list.stand_ins.len());
                assert!(after <= before && list.prims.len() <= plain.prims.len());
            }
        }
    }
    assert!(presumed > 4, "{presumed} cells, {worst}");
}

/// Behind cubes that are full less than a quarter of a step of 256 shows.
#[test]
fn hiding_behind_cubes_changes_next_to_nothing_in_flatland() {
    hiding_behind_cubes_changes_next_to_nothing::<Flat>(512, (6000, 0.6));
}
#[test]
fn hiding_behind_cubes_changes_next_to_nothing_in_space() {
    hiding_behind_cubes_changes_next_to_nothing::<Solid>(128, (10_000, 1.5));
}

/// A wall that fills the view hides all cells behind it but those that are too small to be asked for; with
/// order=paper, and where nobody asks, none is.
#[test]
fn what_is_behind_a_wall_is_left_out() {
    let mut dice = Dice::new(8);
    // The wall's two halves first: they are its lower and upper triangle at z = 5.
    let at = |x: f32, y: f32| glam::vec3(x, y, 5.0);
    let mut points = vec![at(-10.0, -10.0), at(10.0, -10.0), at(-10.0, 10.0)];
    points.extend([at(10.0, -10.0), at(10.0, 10.0), at(-10.0, 10.0)]);
    for _ in 0..3000 {
        let center = dice.vector::<glam::Vec3>(9.0) * glam::vec3(1.0, 1.0, 0.3) - glam::vec3(0.0, 0.0, 6.0);
        points.extend([0, 1, 2].map(|_| center + dice.vector::<glam::Vec3>(0.3)));
    }
    let prims = (0..points.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let scene = Scene::<Solid>::new(Parts::simple("wall", points, prims)).expect("a valid scene");
    let mut view = framing_view(&scene.bounds(), 128, 128);
    view.eye.position = glam::vec3(0.0, 0.0, 14.0);
    view.eye.target = glam::vec3(0.0, 0.0, 0.0);
    let (plain, _) = frame(&scene, &view, &params(0.0, Occlusion::None));
    assert!(plain.prims.len() > 1500, "{}", plain.prims.len());
    let (list, [hidden, presumed]) = frame(&scene, &view, &params(0.0, Occlusion::Depth));
    assert!(hidden > 0 && presumed == 0 && list.prims.len() < 200, "{hidden} {}", list.prims.len());
    let paper = Params { order: Order::Paper, ..params(0.0, Occlusion::Depth) };
    assert_eq!(frame(&scene, &view, &paper).1, [0, 0]);
}
