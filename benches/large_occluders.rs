//! What the tests of `large-occluders` cost: tangent corners and whole relations by table against naively, a
//! kept relation checked, and a frame with planes kept from frame to frame against without.
//!
//! `cargo bench --bench large_occluders`. Interleaved and paired: each round times both ways, the median
//! ratio of the rounds is printed with its quartiles. A relation is one occluder and one box, as a node of
//! the kD-tree needs it.

use std::cell::Cell;
use std::hint::black_box;

use cullscope::culling::Methods;
use cullscope::culling::anatomy::{Blockers, tangent_corners_by};
use cullscope::geometry::{Aabb, NodeId, Solid, View, WALKING_STEP_M};
use cullscope::measure::timing::{Paired, paired};
use cullscope::method::{Run, Settings};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, load};
use glam::Vec3;

/// The paper's: active occluders, and levels of the tree.
const OCCLUDERS: usize = 32;
const HEIGHT: usize = 8;
const ROUNDS: usize = 31;
/// Frames of the walk that one round goes on by.
const FRAMES: usize = 40;

/// Keeps a result from being optimized away.
fn eat<T>(result: T) {
    let _ = black_box(result);
}

fn print(name: &str, p: &Paired, unit: &str, count: f64, scale: f64) {
    let each = |ms: f64| ms * scale / count;
    println!(
        "{name}: {:.1} {unit} against {:.1} {unit}: ×{:.3} (quartiles {:.3} to {:.3})",
        each(p.b_ms),
        each(p.a_ms),
        p.ratio,
        p.spread[0],
        p.spread[1]
    );
}

/// The largest faces of a scene, corner indices.
fn largest(scene: &Scene<Solid>) -> Vec<Vec<u32>> {
    let area = |corners: &[u32]| {
        let p: Vec<Vec3> = corners.iter().map(|&c| scene.points()[c as usize]).collect();
        (1..p.len() - 1).map(|i| (p[i] - p[0]).cross(p[i + 1] - p[0])).sum::<Vec3>().length()
    };
    let mut faces: Vec<(f32, &Vec<u32>)> =
        scene.faces().iter().map(|f| (area(&f.corners), &f.corners)).collect();
    faces.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    faces.into_iter().take(OCCLUDERS).map(|f| f.1.clone()).collect()
}

fn run(scene: &std::sync::Arc<Scene<Solid>>, method: &str, pairs: &[(&str, &str)]) -> Box<dyn Run<Solid>> {
    let settings = Settings::of(pairs);
    Solid::method(method)
        .expect("a method")
        .ready(scene, &settings, &Quiet)
        .expect("settings")
        .expect("not cancelled")
}

fn relations(scene: &Scene<Solid>, boxes: &[Aabb<Vec3>], eye: Vec3) -> u64 {
    let faces = largest(scene);
    let edges: Vec<[Vec3; 2]> = faces
        .iter()
        .flat_map(|f| (0..f.len()).map(|i| [f[i], f[(i + 1) % f.len()]].map(|c| scene.points()[c as usize])))
        .collect();
    let corners = |naive: bool| {
        let of = |[a, b]: &[Vec3; 2]| {
            let one = |bounds: &Aabb<Vec3>| {
                tangent_corners_by::<Solid>(*a, *b, bounds, naive)
                    .map_or(64, |[s, t]| u64::from(s) * 8 + u64::from(t))
            };
            boxes.iter().map(one).sum::<u64>()
        };
        edges.iter().map(of).sum::<u64>()
    };
    let count = (edges.len() * boxes.len()) as f64;
    let by = paired(ROUNDS, || eat(corners(true)), || eat(corners(false)));
    println!(
        "{} edges of {} occluders, {} boxes; table against naive:",
        edges.len(),
        faces.len(),
        boxes.len()
    );
    print("tangent corners of an edge", &by, "ns", count, 1e6);

    let blockers = Blockers::<Solid>::new(scene.points(), &faces);
    let count = (blockers.len() * boxes.len()) as f64;
    let make = |naive: bool| boxes.iter().map(|b| blockers.make_relations(b, eye, naive)).sum::<f64>();
    let by = paired(ROUNDS, || eat(make(true)), || eat(make(false)));
    print("relation made             ", &by, "ns", count, 1e6);
    let kept = blockers.keep(boxes, eye);
    let by = paired(ROUNDS, || eat(make(false)), || eat(blockers.check(&kept, eye)));
    print("relation checked, not made", &by, "ns", count, 1e6);
    let [partial, full] = blockers.check(&kept, eye);
    corners(false) ^ (partial as u64) << 40 ^ (full as u64) << 20
}

fn frames(scene: &std::sync::Arc<Scene<Solid>>) -> u64 {
    let path = scene.paths().iter().find(|p| p.name == "figure 8").expect("a path");
    let walk: Vec<View<Solid>> = path.walked(WALKING_STEP_M, FRAMES * (ROUNDS + 1)).views;
    let (height, most) = (HEIGHT.to_string(), OCCLUDERS.to_string());
    let same = [("tree-height", &*height), ("occluders", &*most)];
    let with = |cache| run(scene, "large-occluders", &[same[0], same[1], ("cache", cache)]);
    let (mut fresh, mut kept, mut frustum) = (with("false"), with("true"), run(scene, "frustum", &same[..1]));
    let hash = Cell::new(0xcbf2_9ce4_8422_2325u64);
    // Each goes its own way along the same walk, so that it always remembers the frames before.
    let mut go = |at: &Cell<usize>, run: &mut dyn Run<Solid>| {
        let sum: usize = walk[at.get()..at.get() + FRAMES].iter().map(|v| run.cull(v).prims.len()).sum();
        at.set(at.get() + FRAMES);
        sum as u64
    };
    let [a, b, c] = [(); 3].map(|()| Cell::new(0));
    let go = std::cell::RefCell::new(&mut go);
    let by = paired(
        ROUNDS,
        || hash.set((hash.get() ^ (go.borrow_mut())(&a, &mut *fresh)).wrapping_mul(0x100_0000_01b3)),
        || eat((go.borrow_mut())(&b, &mut *kept)),
    );
    println!(
        "{} triangles, {} frames at walking speed; planes kept against made anew:",
        scene.live().len(),
        FRAMES * ROUNDS
    );
    print("frame culled              ", &by, "µs", FRAMES as f64, 1e3);
    kept.forget();
    b.set(0);
    let by = paired(
        ROUNDS,
        || eat((go.borrow_mut())(&c, &mut *frustum)),
        || eat((go.borrow_mut())(&b, &mut *kept)),
    );
    print("against frustum culling   ", &by, "µs", FRAMES as f64, 1e3);
    hash.get()
}

fn main() {
    let AnyScene::Solid(scene) = load("generate:building", &LoadOptions::default(), &Quiet).expect("a scene")
    else {
        panic!("the generator makes a scene of space");
    };
    let height = HEIGHT.to_string();
    let tree = run(&scene, "frustum", &[("tree-height", &*height)]);
    let boxes: Vec<Aabb<Vec3>> =
        (0..tree.hierarchy().node_count() as u32).map(|n| tree.hierarchy().bounds(NodeId(n))).collect();
    let eye = scene.paths()[0].views[0].eye.position;
    let hash = relations(&scene, &boxes, eye) ^ frames(&scene);
    println!("hash {hash:016x}");
}
