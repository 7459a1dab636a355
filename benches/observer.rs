//! What watching costs: `frustum` unobserved, counted and recorded against a copy with every trace of the
//! observer stripped by hand.
//!
//! `cargo bench --bench observer`. Interleaved and paired: each round times both ways, the median ratio of
//! the rounds is printed with its quartiles. The copy lives here so that the library has one function only.

use std::sync::Arc;

use cullscope::culling::Methods;
use cullscope::geometry::{Frustum, FrustumTest, NodeId, Solid, View, faces_away};
use cullscope::index::KdTree;
use cullscope::measure::timing::{Paired, paired};
use cullscope::method::{DrawList, Settings};
use cullscope::scene::{AnyScene, LoadOptions, Quiet, Scene, load, random_views};
use glam::Vec3;

/// Levels of the tree: so many that the walk and not the copying of its result takes the time.
const HEIGHT: u32 = 16;
const ROUNDS: usize = 61;
const VIEWS: usize = 24;

/// `culling::baseline::frustum` with every line that mentions the observer deleted and nothing else changed.
struct Stripped<'a> {
    tree: KdTree<Vec3>,
    scene: &'a Scene<Solid>,
    backface_culling: bool,
}

impl Stripped<'_> {
    fn cull(&self, view: &View<Solid>) -> DrawList {
        let mut out = DrawList::default();
        let frustum = view.frustum();
        let Self { tree: index, scene, backface_culling } = self;
        let mut walk =
            Walk { index, scene, view, frustum, backface_culling: *backface_culling, out: &mut out };
        walk.visible(NodeId(0), Frustum::<Vec3>::ALL);
        out
    }
}

struct Walk<'a> {
    index: &'a KdTree<Vec3>,
    scene: &'a Scene<Solid>,
    view: &'a View<Solid>,
    frustum: Frustum<Vec3>,
    backface_culling: bool,
    out: &'a mut DrawList,
}

impl Walk<'_> {
    fn visible(&mut self, id: NodeId, planes: u8) {
        let index = self.index;
        let node = &index.nodes()[id.at()];
        let test = self.frustum.test(&node.bounds, planes);
        match (test, node.children()) {
            (FrustumTest::Outside(_), _) => {}
            (FrustumTest::Partial(cutting), Some(children)) => {
                for child in children {
                    self.visible(child, cutting);
                }
            }
            (FrustumTest::Inside | FrustumTest::Partial(_), _) => self.gather(id),
        }
    }

    fn gather(&mut self, id: NodeId) {
        let prims = self.index.prims_below(id);
        if !self.backface_culling {
            self.out.prims.extend_from_slice(prims);
            return;
        }
        for &prim in prims {
            let mut corners = [Vec3::ZERO; 3];
            for (to, from) in corners.iter_mut().zip(self.scene.prim_points(prim)) {
                *to = from;
            }
            if !faces_away::<Solid>(self.view.eye.position, &corners) {
                self.out.prims.push(prim);
            }
        }
    }
}

fn hash(lists: impl Iterator<Item = DrawList>) -> u64 {
    lists
        .flat_map(|l| l.prims)
        .fold(0xcbf2_9ce4_8422_2325, |h, p| (h ^ u64::from(p.0)).wrapping_mul(0x100_0000_01b3))
}

fn print(name: &str, p: &Paired) {
    println!(
        "{name}: ×{:.3} (quartiles {:.3} to {:.3}); {:.3} ms against {:.3} ms for {VIEWS} views",
        p.ratio, p.spread[0], p.spread[1], p.b_ms, p.a_ms
    );
}

fn main() {
    let AnyScene::Solid(scene) = load("generate:building", &LoadOptions::default(), &Quiet).expect("a scene")
    else {
        panic!("the generator makes a scene of space");
    };
    let views = random_views(&scene, VIEWS, 7);
    // Each way has a tree of its own, so each finds the other one's in the caches.
    let [stripped, again] = [(); 2].map(|()| Stripped {
        tree: build(&scene),
        scene: &scene,
        backface_culling: std::hint::black_box(false),
    });
    let settings = Settings::of(&[("tree-height", &HEIGHT.to_string())]);
    let entry = Solid::method("frustum").expect("a method");
    let [mut a, mut b, mut c] =
        [(); 3].map(|()| entry.ready(&scene, &settings, &Quiet).expect("settings").expect("not cancelled"));

    let want = hash(views.iter().map(|v| stripped.cull(v)));
    assert_eq!(want, hash(views.iter().map(|v| a.cull(v))), "both ways draw the same");
    let nodes: u64 = views.iter().map(|v| a.count(v).1.nodes_entered).sum();
    println!(
        "scene: {} triangles, tree of {HEIGHT} levels, {nodes} nodes entered, {ROUNDS} rounds",
        scene.live().len()
    );

    let bare = || views.iter().for_each(|v| drop(std::hint::black_box(stripped.cull(v))));
    print(
        "stripped again",
        &paired(ROUNDS, bare, || views.iter().for_each(|v| drop(std::hint::black_box(again.cull(v))))),
    );
    print(
        "unobserved    ",
        &paired(ROUNDS, bare, || views.iter().for_each(|v| drop(std::hint::black_box(a.cull(v))))),
    );
    print(
        "counted       ",
        &paired(ROUNDS, bare, || views.iter().for_each(|v| drop(std::hint::black_box(b.count(v))))),
    );
    print(
        "recorded      ",
        &paired(ROUNDS, bare, || {
            views.iter().for_each(|v| drop(std::hint::black_box(c.record(v, usize::MAX).list)))
        }),
    );
    println!("hash {want:016x}");
}

fn build(scene: &Arc<Scene<Solid>>) -> KdTree<Vec3> {
    KdTree::build(scene.live().iter().map(|&p| (p, scene.prim_bounds(p))), HEIGHT, || false)
        .expect("not cancelled")
}
