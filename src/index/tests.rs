//! The contract of [`Hierarchy`] sees each fault that it names; boxes follow what moves; boxes for tests of
//! all trees.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec2;

use super::{Hierarchy, KdTree, Octree, Redistribution, Shape, nodes};
use crate::geometry::dice::Dice;
use crate::geometry::{Aabb, Flat, NodeId, ObjectId, PrimId, Solid, Space, Vector};
use crate::scene::{Motion, Object, Pose, Scene, samples};

/// Boxes in a cube of side 16, whose sizes are 0 to each of `sizes` in turn; or with corners on a coarse
/// grid, where centers are equal and dividing planes fall.
pub(super) fn random_boxes<V: Vector>(
    dice: &mut Dice,
    n: usize,
    sizes: &[f32],
    grid: bool,
) -> Vec<(PrimId, Aabb<V>)> {
    let mut coordinate = |most: f32| {
        let v = dice.between(0.0, most);
        if grid { v.floor() } else { v }
    };
    let mut one = |i: usize| {
        let min = V::from_fn(|_| coordinate(16.0));
        let size = sizes[i % sizes.len()];
        (PrimId(i as u32), Aabb { min, max: min + V::from_fn(|_| coordinate(size)) })
    };
    (0..n).map(&mut one).collect()
}

/// A tree written down: a root over two leaves, and four primitives.
#[derive(Clone)]
struct Written {
    parents: Vec<Option<NodeId>>,
    children: Vec<Range<u32>>,
    levels: Vec<u32>,
    bounds: Vec<Aabb<Vec2>>,
    prims: Vec<Vec<PrimId>>,
    held: Vec<usize>,
}

impl Hierarchy<Flat> for Written {
    fn node_count(&self) -> usize {
        self.parents.len()
    }
    fn bounds(&self, node: NodeId) -> Aabb<Vec2> {
        self.bounds[node.at()]
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        self.parents[node.at()]
    }
    fn children(&self, node: NodeId) -> Range<u32> {
        self.children[node.at()].clone()
    }
    fn level(&self, node: NodeId) -> u32 {
        self.levels[node.at()]
    }
    fn prims(&self, node: NodeId) -> &[PrimId] {
        &self.prims[node.at()]
    }
    fn held(&self, node: NodeId) -> usize {
        self.held[node.at()]
    }
    fn bytes(&self) -> usize {
        0
    }
}

fn span(from: f32, to: f32) -> Aabb<Vec2> {
    Aabb { min: Vec2::splat(from), max: Vec2::splat(to) }
}

#[test]
fn the_contract_sees_what_is_wrong() {
    let prims: Vec<_> = (0..4).map(|i| (PrimId(i), span(i as f32, i as f32 + 1.0))).collect();
    let ids = |list: &[u32]| list.iter().copied().map(PrimId).collect::<Vec<_>>();
    let good = Written {
        parents: vec![None, Some(NodeId(0)), Some(NodeId(0))],
        children: vec![1..3, 0..0, 0..0],
        levels: vec![0, 1, 1],
        bounds: vec![span(0.0, 4.0), span(0.0, 2.0), span(2.0, 4.0)],
        // One primitive stays with the root.
        prims: vec![ids(&[3, 0, 1, 2]), ids(&[0, 1]), ids(&[2])],
        held: vec![4, 3, 1],
    };
    assert_eq!(good.fault(&prims), None);
    let broken = |f: &dyn Fn(&mut Written)| {
        let mut bad = good.clone();
        f(&mut bad);
        bad.fault(&prims).expect("a fault")
    };
    assert!(broken(&|w| w.levels[0] = 1).contains("no root"));
    assert!(broken(&|w| w.parents[0] = Some(NodeId(1))).contains("no root"));
    assert!(broken(&|w| w.children[1] = 0..1).contains("cannot be the parent"));
    assert!(broken(&|w| w.children[2] = 3..4).contains("cannot be the parent"));
    assert!(broken(&|w| w.parents[2] = Some(NodeId(1))).contains("does not know"));
    assert!(broken(&|w| w.levels[2] = 2).contains("does not know"));
    assert!(broken(&|w| w.children[0] = 1..2).contains("are children"));
    assert!(broken(&|w| w.prims[0] = ids(&[0, 1, 2])).contains("every primitive once"));
    assert!(broken(&|w| w.prims[0] = ids(&[3, 0, 1, 2, 2])).contains("every primitive once"));
    assert!(broken(&|w| w.prims[2] = ids(&[1, 2])).contains("another child"));
    assert!(broken(&|w| w.prims[2] = ids(&[2, 2])).contains("another child"));
    assert!(broken(&|w| w.prims[2] = ids(&[7])).contains("another child"));
    assert!(broken(&|w| w.held[1] = 1).contains("more primitives"));
    assert!(broken(&|w| w.bounds[2] = span(2.0, 5.0)).contains("do not hold those of 2"));
    assert!(broken(&|w| w.bounds[1] = span(0.0, 1.5)).contains("do not hold 1"));
}

/// A scene of objects of two primitives, of which every other moves.
fn moving<S: Space>(seed: u64, n: u32) -> Arc<Scene<S>> {
    let mut parts = Arc::unwrap_or_clone(samples::soup::<S>(seed, n)).into_parts();
    let mut dice = Dice::new(seed);
    let mut pose = || {
        let half = dice.between(-1.5, 1.5);
        let translation = std::array::from_fn(|_| dice.between(-9.0, 9.0));
        Pose { rotation: [0.0, 0.0, half.sin(), half.cos()], translation }
    };
    let mut object = |k: u32| Object {
        name: String::new(),
        group: String::new(),
        motion: k.is_multiple_of(2).then(|| (0..4).map(|_| pose()).collect()),
    };
    parts.objects = (0..n.div_ceil(2)).map(&mut object).collect();
    for (at, object) in parts.prim_object.iter_mut().enumerate() {
        *object = ObjectId(at as u32 / 2);
    }
    Arc::new(Scene::new(parts).expect("a valid scene"))
}

fn boxes<S: Space>(scene: &Scene<S>) -> Vec<(PrimId, Aabb<S::Vector>)> {
    scene.live().iter().map(|&p| (p, scene.prim_bounds(p))).collect()
}

/// Boxes follow what moves; where none ends at a plane they are as tight as if they were computed anew.
fn boxes_follow<S: Space>() {
    for seed in 0..12 {
        let scene = moving::<S>(seed, 20 + 40 * seed as u32);
        let mut motion = Motion::new(&scene);
        let first = motion.at(0);
        let all = || boxes(&first).into_iter();
        let mut whole = KdTree::build(all(), 5, || false).expect("not cancelled");
        let mut cells = KdTree::build_cells(all(), 5, &|| false).expect("not cancelled");
        let mut octrees = Redistribution::ALL.map(|redistribution| {
            let shape = Shape { levels: 6, leaf_prims: 3, redistribution, small: 0.3 };
            Octree::build(all(), &shape, &|| false).expect("not cancelled")
        });
        for frame in [0, 2, 1, 3, 0] {
            let now = motion.at(frame);
            let prims = boxes(&now);
            let tight = |hierarchy: &dyn Hierarchy<S>, node: NodeId| {
                let bounds = hierarchy.prims(node).iter().map(|p| now.prim_bounds(*p));
                bounds.fold(Aabb::empty(), |all: Aabb<S::Vector>, b| all.union(b))
            };
            let changed = whole.refit(&now).len();
            assert!(changed > 0 && changed <= whole.nodes().len(), "seed {seed}");
            cells.refit(&now);
            assert_eq!(Hierarchy::<S>::fault(&whole, &prims), None, "seed {seed}, frame {frame}");
            assert_eq!(Hierarchy::<S>::fault(&cells, &prims), None, "seed {seed}, frame {frame}, cells");
            for (tree, redistribution) in octrees.iter_mut().zip(Redistribution::ALL) {
                tree.refit(&now);
                let what = format!("seed {seed}, frame {frame}, {redistribution:?}");
                assert_eq!(Hierarchy::<S>::fault(&*tree, &prims), None, "{what}");
                for node in nodes::<S>(&*tree).filter(|_| redistribution == Redistribution::Parent) {
                    assert_eq!(Hierarchy::<S>::bounds(&*tree, node), tight(&*tree, node), "{what}");
                }
            }
            for node in nodes::<S>(&whole) {
                assert_eq!(Hierarchy::<S>::bounds(&whole, node), tight(&whole, node), "seed {seed}");
            }
        }
    }
}

#[test]
fn boxes_follow_what_moves() {
    boxes_follow::<Flat>();
    boxes_follow::<Solid>();
}
