//! What the parts of a frame of `color-cubes` cost: the traversal, the geometry that is left, the cubes; and
//! all of it against drawing everything as geometry.
//!
//! `cargo bench --no-default-features --bench color_cubes [-- SCENE KEY=VALUE…]`. At 124×124 pixels of 2×2
//! samples, from the paper's four distances (Table 2); least times of many frames.

use std::hint::black_box;

use cullscope::geometry::Solid;
use cullscope::measure::timed;
use cullscope::method::{DrawList, Settings};
use cullscope::raster::{Canvas, Drawable, Options, Target};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, load};

const SIDE: u32 = 248;
const ROUNDS: usize = 200;

/// The least time of some runs, ms.
fn least(rounds: usize, mut work: impl FnMut()) -> f64 {
    (0..rounds).map(|_| timed(&mut work).1).fold(f64::INFINITY, f64::min)
}

fn main() {
    let mut words = std::env::args().skip(1).filter(|word| !word.starts_with("--"));
    let source = words.next().unwrap_or_else(|| "generate:tree".into());
    let mut settings = Settings::default();
    settings.0.insert("pixel-threshold".into(), "2".into());
    for word in words {
        let (key, value) = word.split_once('=').expect("KEY=VALUE");
        settings.0.insert(key.into(), value.into());
    }
    let Ok(AnyScene::Solid(scene)) = load(&source, &LoadOptions::default(), &Quiet) else {
        panic!("no scene of space: {source}");
    };
    let path = scene.paths().iter().find(|path| path.name == "distances").unwrap_or(&scene.paths()[0]);
    let method = Solid::method("color-cubes").expect("a method");
    let (run, build) = timed(|| method.ready(&scene, &settings, &Quiet).expect("fine").expect("built"));
    let mut run = run;
    println!("{source}: built in {:.3} s", build / 1000.0);
    let (mut image, mut canvas) = (Target::default(), Canvas::default());
    let options = Options::default();
    for view in &path.views {
        let view = cullscope::geometry::View { width: SIDE, height: SIDE, ..*view };
        let mut list = DrawList::default();
        let rounds = if scene.prim_count() > 1_000_000 { 10 } else { ROUNDS };
        let cull = least(rounds, || list = run.cull(&view));
        let draw = least(rounds, || Solid::redraw(&mut image, &scene, &view, &list.prims, &options));
        let cubes = least(rounds, || {
            canvas.clear(&view);
            canvas.composite(&list.stand_ins, &image, &view, &options);
            black_box(&canvas);
        });
        let all = least(rounds, || Solid::redraw(&mut image, &scene, &view, scene.live(), &options));
        let count = list.stand_ins.len();
        let frame = cull + draw + cubes;
        println!(
            "traversal {:6.1} µs, {} primitives {:7.1} µs, {count} cubes {:6.1} µs ({:.0} ns each); frame \
             {:7.1} µs, geometry {:7.1} µs: {:.2} times as fast",
            cull * 1e3,
            list.prims.len(),
            draw * 1e3,
            cubes * 1e3,
            cubes * 1e6 / count.max(1) as f64,
            frame * 1e3,
            all * 1e3,
            all / frame
        );
    }
}
