//! What the parts of `hierarchical-z` cost: a query, culling, and whole frames, at four image sizes.
//!
//! `cargo bench --no-default-features --bench hierarchical_z`. Frames of the walk with obscuration culling
//! are paired and interleaved with view-frustum culling and drawing of the same views; each line ends with a
//! hash of its result.

use std::hint::black_box;
use std::sync::Arc;

use cullscope::culling::Methods;
use cullscope::culling::hierarchical_z_parts::Obscurer;
use cullscope::geometry::{NodeId, Solid, View};
use cullscope::measure::timed;
use cullscope::measure::timing::{Paired, median, paired};
use cullscope::method::{Run, Settings};
use cullscope::raster::{Boxes, Drawable, Options, Target};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, load};

const SIZES: [[u32; 2]; 4] = [[256, 256], [512, 512], [1024, 1024], [1920, 1080]];
const ROUNDS: usize = 9;
/// Views along the path.
const VIEWS: usize = 60;

fn hash(values: impl Iterator<Item = u32>) -> u64 {
    values.fold(0xcbf2_9ce4_8422_2325, |h, v| (h ^ u64::from(v)).wrapping_mul(0x0100_0000_01b3))
}

fn main() {
    for source in ["generate:building", "generate:city"] {
        let AnyScene::Solid(scene) = load(source, &LoadOptions::default(), &Quiet).expect("a generator")
        else {
            continue;
        };
        let path = &scene.paths()[0];
        let step = (path.views.len() / VIEWS).max(1);
        let mut frustum = Solid::method("frustum")
            .expect("a method")
            .ready(&scene, &Settings::default(), &Quiet)
            .expect("fine")
            .expect("built");
        let nodes =
            (0..frustum.hierarchy().node_count() as u32).map(|n| frustum.hierarchy().bounds(NodeId(n)));
        let boxes = Boxes::new(nodes);
        for [width, height] in SIZES {
            let views: Vec<View<Solid>> =
                path.views.iter().step_by(step).map(|v| View { width, height, ..*v }).collect();
            let mut occluders =
                Obscurer::new(&scene, &Settings::default(), &Quiet).expect("fine").expect("built");
            let (mut cull, mut query, mut answers) = (Vec::new(), Vec::new(), Vec::new());
            for view in &views {
                cull.push(timed(|| occluders.render(view)).1);
                let (all, ms) = timed(|| occluders.hides_all(&boxes));
                let in_view = all.iter().flatten().count().max(1);
                query.push(ms * 1e6 / in_view as f64);
                answers.extend(all.into_iter().map(|a| a.map_or(3, u32::from)));
            }
            let hidden = answers.iter().filter(|a| **a == 1).count() as f64
                / answers.iter().filter(|a| **a < 3).count().max(1) as f64;
            println!(
                "{source} {width}x{height}: culling {:.3} ms, query {:.0} ns a box in view ({:.1} % hidden), \
                 hash {:016x}",
                median(cull),
                median(query),
                100.0 * hidden,
                hash(answers.into_iter())
            );
            frames(source, &scene, &views, &mut frustum, &mut occluders);
        }
    }
}

/// Frames against those culled by the frustum.
fn frames(
    source: &str,
    scene: &Arc<Scene<Solid>>,
    views: &[View<Solid>],
    frustum: &mut Box<dyn Run<Solid>>,
    occluders: &mut Obscurer<Solid>,
) {
    let (mut target, mut other) = (Target::default(), Target::default());
    let (mut all, mut kept) = (0, 0);
    let result = paired(
        ROUNDS,
        || {
            for view in views {
                let list = frustum.cull(view);
                Solid::redraw(&mut target, scene, view, &list.prims, &Options::default());
                all = list.prims.len();
                black_box(&target);
            }
        },
        || {
            for view in views {
                let list = occluders.render(view);
                Solid::redraw(&mut other, scene, view, &list.prims, &Options::default());
                kept = list.prims.len();
                black_box(&other);
            }
        },
    );
    say(
        source,
        views,
        &result,
        ["frame", "culled by frustum"],
        &format!(", last view {kept} of {all} drawn"),
    );
}

/// One line: a frame of the second way, of the first, and their ratio.
fn say(source: &str, views: &[View<Solid>], result: &Paired, [second, first]: [&str; 2], more: &str) {
    println!(
        "{source} {}x{}: {second} {:.2} ms against {:.2} ms {first}: ×{:.3} (quartiles {:.3} to {:.3}){more}",
        views[0].width,
        views[0].height,
        result.b_ms / views.len() as f64,
        result.a_ms / views.len() as f64,
        result.ratio,
        result.spread[0],
        result.spread[1],
    );
}
