//! Building the kD-tree over a million boxes, against the BVH builder `obvhs`.
//!
//! `cargo bench --bench kd_tree`. One thread, interleaved and paired. The two build different things: at 8
//! levels, the methods' default, the tree has 255 nodes; at 20 levels it ends at one or two boxes a leaf, as
//! the BVH does, and that is the fair comparison.

use std::time::Duration;

use cullscope::geometry::{Aabb, PrimId};
use cullscope::index::KdTree;
use cullscope::measure::timing::{paired, timed};
use glam::Vec3;
use obvhs::BvhBuildParams;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

const BOXES: usize = 1_000_000;
const ROUNDS: usize = 5;

fn boxes() -> Vec<Aabb<Vec3>> {
    let mut rng = Pcg32::new(1, 2);
    let mut unit = move || (rng.next_u32() >> 8) as f32 / (1u32 << 24) as f32;
    let mut one = || {
        let min = Vec3::new(unit(), unit(), unit()) * 1000.0;
        Aabb { min, max: min + Vec3::new(unit(), unit(), unit()) * 5.0 }
    };
    (0..BOXES).map(|_| one()).collect()
}

fn build(boxes: &[Aabb<Vec3>], height: u32) -> KdTree<Vec3> {
    KdTree::build(boxes.iter().enumerate().map(|(i, b)| (PrimId(i as u32), *b)), height, || false)
        .expect("not cancelled")
}

fn main() {
    let ours = boxes();
    let theirs: Vec<_> = ours.iter().map(|b| obvhs::aabb::Aabb::new(b.min.into(), b.max.into())).collect();
    let peer = |params: BvhBuildParams| {
        obvhs::bvh2::builder::build_bvh2(&theirs, params, &mut Duration::default()).nodes.len()
    };
    let per_box = |ms: f64| ms * 1e6 / BOXES as f64;
    let kinds = [
        ("fastest", BvhBuildParams::fastest_build()),
        ("very fast", BvhBuildParams::very_fast_build()),
        ("medium", BvhBuildParams::medium_build()),
    ];
    for height in [8, 20] {
        let ms = timed(|| build(&ours, height).nodes().len()).1;
        println!("kD-tree of {height} levels, once: {:.0} ms, {:.0} ns a box", ms, per_box(ms));
        for (name, params) in kinds {
            let p = paired(
                ROUNDS,
                || _ = std::hint::black_box(peer(params)),
                || _ = std::hint::black_box(build(&ours, height).nodes().len()),
            );
            println!(
                "kD-tree of {height} levels {:.0} ns a box; obvhs 0.4 {name} {:.0} ns a box; ×{:.2} \
                 (quartiles {:.2} to {:.2})",
                per_box(p.b_ms),
                per_box(p.a_ms),
                p.ratio,
                p.spread[0],
                p.spread[1]
            );
        }
    }
    let tree = build(&ours, 20);
    let hash = tree.nodes().iter().fold(0u64, |h, n| {
        h.rotate_left(7) ^ u64::from(n.bounds.min.x.to_bits()) ^ u64::from(n.split.to_bits())
    });
    println!("{} nodes, hash {hash:016x}", tree.nodes().len());
}
