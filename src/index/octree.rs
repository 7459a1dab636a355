//! Octree over primitives; a quadtree in flatland.
//!
//! Greene, Kass and Miller 1993 (<https://doi.org/10.1145/166117.166147>), as Georges 1995, Section 3.1,
//! describes it. For each cube:
//!
//! 1. decide whether it is divided: not if it holds few primitives;
//! 2. create its parts, halves along every axis;
//! 3. redistribute the primitives among them. Where one goes that crosses the dividing planes is the choice
//!    of that section ([`Redistribution`]);
//! 4. repeat for each part.
//!
//! Departures: cubes that hold nothing are left out; beside its cube a node keeps the bounds of what it holds
//! there, which is what is tested. A primitive that is passed to several children stands in the order once,
//! below the cube that passed it on, so that the primitives below a node are a slice; the children refer to
//! it. Cost: O(n · depth) time; one reference a primitive and one more for each child that shares it.

use std::ops::Range;

use super::Hierarchy;
use super::moving::Moving;
use crate::geometry::{Aabb, NodeId, PrimId, Space, Vector};
use crate::scene::Scene;

/// Where a primitive goes that crosses the planes which divide its cube (Georges 1995, Section 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Redistribution {
    /// It stays with the cube, unless it is small against it; then it goes to all children that it overlaps.
    Hybrid,
    /// It stays with the cube.
    Parent,
    /// It goes to the child that holds its center, whose bounds grow.
    Grown,
    /// It is split among all children that it overlaps. The parts share the whole, which is drawn with the
    /// first of them.
    Split,
}

impl Redistribution {
    /// Every choice.
    pub const ALL: [Self; 4] = [Self::Hybrid, Self::Parent, Self::Grown, Self::Split];
}

/// How to build an octree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Levels at most, 1 to [`Shape::MOST_LEVELS`].
    pub levels: u32,
    /// A cube with no more primitives is not divided.
    pub leaf_prims: u32,
    /// Where crossing primitives go.
    pub redistribution: Redistribution,
    /// A primitive is small if no side of its box is longer than this part of its cube's.
    pub small: f32,
}

impl Shape {
    /// The deepest that makes sense: a cube's side is then 2⁻¹⁹ of the scene's, near the end of f32.
    pub const MOST_LEVELS: u32 = 20;
}

/// One node: a cube and what it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OctreeNode<V> {
    /// The cube; grown where children may grow.
    pub cube: Aabb<V>,
    /// Bounds of what it and all below it hold inside the cube: the volume that is tested.
    pub bounds: Aabb<V>,
    /// Bounds of all primitives here and below as wholes: beyond `bounds` where some are shared with a
    /// neighbor.
    pub whole: Aabb<V>,
    /// The same of what the node itself holds, without its children.
    pub held: Aabb<V>,
    /// Those as wholes.
    pub held_whole: Aabb<V>,
    /// Which child of its parent it is: bit `a` is set for the upper half along axis `a`.
    pub octant: u8,
    /// Depth below the root.
    pub level: u8,
    children: u8,
    first_child: u32,
    parent: u32,
    first: u32,
    /// Primitives in the order that are the node's alone.
    own: u32,
    /// Then those that its children share.
    passed: u32,
    /// All at and below, as they stand in the order.
    count: u32,
    first_shared: u32,
    shared: u32,
}

impl<V> OctreeNode<V> {
    /// Its children, neighbors in the list of nodes.
    #[inline]
    pub fn children(&self) -> Range<u32> {
        self.first_child..self.first_child + u32::from(self.children)
    }
}

/// A frozen octree.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree<V> {
    nodes: Vec<OctreeNode<V>>,
    order: Vec<PrimId>,
    shared: Vec<PrimId>,
    /// What [`Octree::refit`] found out the first time: of each list the boxes of what stands still, in the
    /// cube and whole.
    moving: Option<Moving<[Aabb<V>; 2]>>,
}

/// A division may at most double the references: every primitive may go to two parts, or one in seven to all
/// eight. More parts nothing.
const MOST_REFERENCES: usize = 2;

#[derive(Clone, Copy)]
struct Entry<V> {
    bounds: Aabb<V>,
    prim: PrimId,
    /// Whether another child of some cube above refers to it too.
    is_shared: bool,
}

impl<V: Vector> Octree<V> {
    /// Builds the tree; `None` when `cancelled` returns true (called once a node).
    pub fn build(
        prims: impl Iterator<Item = (PrimId, Aabb<V>)>,
        shape: &Shape,
        cancelled: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let entries: Vec<_> = prims.map(|(prim, bounds)| Entry { bounds, prim, is_shared: false }).collect();
        // The root is a cube around everything, so all cubes are cubes.
        let all = entries.iter().fold(Aabb::empty(), |b, e| b.union(e.bounds));
        let mut tree = Self {
            nodes: vec![OctreeNode::of(cube_around(&all), 0, 0, 0)],
            order: Vec::with_capacity(entries.len()),
            shared: Vec::new(),
            moving: None,
        };
        // 1 to 4, depth first.
        tree.grow(0, entries, shape, cancelled)?;
        // Bounds follow from what nodes hold, from below; a node's own were set when it got its primitives.
        (0..tree.nodes.len()).rev().for_each(|at| tree.bound(at));
        Some(tree)
    }

    /// Fills node `at` with entries and divides it if they are many.
    fn grow(
        &mut self,
        at: usize,
        entries: Vec<Entry<V>>,
        shape: &Shape,
        cancelled: &dyn Fn() -> bool,
    ) -> Option<()> {
        if cancelled() {
            return None;
        }
        // What is put in the order from here until this node is finished is its slice.
        self.nodes[at].first = self.order.len() as u32;
        // 1 and 3.
        let (stay, passed, parts) = self.divide(at, entries, shape);
        // Primitives that stay and that a neighbor has too are referred to; the cube above that passed them
        // on has them in the order.
        let (shared, own): (Vec<_>, Vec<_>) = stay.into_iter().partition(|e| e.is_shared);
        let node = &mut self.nodes[at];
        (node.own, node.passed) = (own.len() as u32, passed.len() as u32);
        (node.first_shared, node.shared) = (self.shared.len() as u32, shared.len() as u32);
        // `bounds` clips to the cube, since the rest lies in another node; `whole` does not, since drawing
        // does not clip.
        for e in own.iter().chain(&shared) {
            node.bounds = node.bounds.union(clipped(&e.bounds, &node.cube));
            node.whole = node.whole.union(e.bounds);
        }
        (node.held, node.held_whole) = (node.bounds, node.whole);
        self.order.extend(own.iter().chain(&passed).map(|e| e.prim));
        self.shared.extend(shared.iter().map(|e| e.prim));
        // Recursion would keep the lists of every level alive.
        drop((own, shared, passed));

        // 2. Empty parts are left out.
        let parts: Vec<_> = parts.into_iter().enumerate().filter(|(_, part)| !part.is_empty()).collect();
        let (cube, level, first_child) =
            (self.nodes[at].cube, self.nodes[at].level + 1, self.nodes.len() as u32);
        for (octant, part) in &parts {
            let mut child = OctreeNode::of(octant_of(&cube, *octant), *octant as u8, level, at as u32);
            // A grown child is never clipped: its cube holds all that it has.
            if shape.redistribution == Redistribution::Grown {
                child.cube = part.iter().fold(child.cube, |b, e| b.union(e.bounds));
            }
            self.nodes.push(child);
        }
        (self.nodes[at].first_child, self.nodes[at].children) = (first_child, parts.len() as u8);
        // 4. All children were listed first, so they are neighbors in the list of nodes.
        for (k, (_, part)) in parts.into_iter().enumerate() {
            self.grow(first_child as usize + k, part, shape, cancelled)?;
        }
        self.nodes[at].count = self.order.len() as u32 - self.nodes[at].first;
        Some(())
    }

    /// What stays with a node, which of it is only listed there because its children share it, and what each
    /// child gets.
    #[expect(clippy::type_complexity, reason = "three results that are taken apart at once")]
    fn divide(
        &self,
        at: usize,
        entries: Vec<Entry<V>>,
        shape: &Shape,
    ) -> (Vec<Entry<V>>, Vec<Entry<V>>, Vec<Vec<Entry<V>>>) {
        let node = &self.nodes[at];
        let center = node.cube.center();
        let side = longest(&node.cube);
        let inside = |a: usize| node.cube.min.get(a) < center.get(a) && center.get(a) < node.cube.max.get(a);
        // 1. Few primitives, the last level, or a cube so small that its center rounds to a side on every
        // axis.
        if entries.len() <= shape.leaf_prims as usize
            || u32::from(node.level) + 1 >= shape.levels
            || !(0..V::AXES).any(inside)
        {
            return (entries, vec![], vec![]);
        }
        // 3. Section 3.1: "small" compared to the cube.
        let to_all = |e: &Entry<V>| match shape.redistribution {
            Redistribution::Hybrid => longest(&e.bounds) <= side * shape.small,
            Redistribution::Split => true,
            Redistribution::Parent | Redistribution::Grown => false,
        };
        let ends = |e: &Entry<V>| (octant_at(e.bounds.min, center), octant_at(e.bounds.max, center));
        // Still 1: where most would be referred to many times over, division parts nothing; it might go on
        // for ever. Two parts for each axis that a box crosses.
        let references =
            |e: &Entry<V>| if to_all(e) { 1usize << (ends(e).0 ^ ends(e).1).count_ones() } else { 1 };
        if entries.iter().map(references).sum::<usize>() > entries.len() * MOST_REFERENCES {
            return (entries, vec![], vec![]);
        }
        let (mut stay, mut passed, mut parts) = (Vec::new(), Vec::new(), vec![Vec::new(); 1 << V::AXES]);
        for entry in entries {
            let (low, high) = ends(&entry);
            if low == high {
                // Both ends in one part: it crosses nothing.
                parts[low].push(entry);
            } else if shape.redistribution == Redistribution::Grown {
                parts[octant_at(entry.bounds.center(), center)].push(entry);
            } else if to_all(&entry) {
                // Those that differ from the lowest only along the axes that are crossed.
                let crossed = low ^ high;
                (0..parts.len())
                    .filter(|o| o & !crossed == low)
                    .for_each(|o| parts[o].push(Entry { is_shared: true, ..entry }));
                // Only the first cube that passes it on has it in the order.
                if !entry.is_shared {
                    passed.push(entry);
                }
            } else {
                // Associated with the cube itself.
                stay.push(entry);
            }
        }
        (stay, passed, parts)
    }

    /// Bounds of a node that has those of what it holds itself, with its children's.
    fn bound(&mut self, at: usize) {
        for child in self.nodes[at].children() {
            let child = self.nodes[child as usize];
            let node = &mut self.nodes[at];
            (node.bounds, node.whole) = (node.bounds.union(child.bounds), node.whole.union(child.whole));
        }
    }

    /// Bounds the nodes anew for another frame of the scene that it was built of, and returns those whose
    /// bounds may have changed. Cubes stay; what moves out of its cube takes the bounds along, in each cube
    /// that refers to it. Called once when it is built, so that it is the same whatever frames come before
    /// another one. Cost: O(primitives) the first time, then O(primitives that move and nodes above
    /// them).
    pub fn refit<S: Space<Vector = V>>(&mut self, scene: &Scene<S>) -> &[NodeId] {
        if scene.moving().is_empty() {
            return &[];
        }
        let moving = self.moving.take().unwrap_or_else(|| self.moving_of(scene));
        for node in &moving.nodes {
            let node = &mut self.nodes[node.at()];
            (node.bounds, node.whole) = (node.held, node.held_whole);
        }
        for list in &moving.lists {
            // Not clipped to the cube: nobody else may hold the rest.
            let moved = moving.of(list).iter().fold(Aabb::empty(), |b, p| b.union(scene.prim_bounds(*p)));
            let node = &mut self.nodes[list.node.at()];
            [node.held, node.held_whole] = list.still.map(|still| still.union(moved));
            (node.bounds, node.whole) = (node.held, node.held_whole);
        }
        moving.nodes.iter().for_each(|node| self.bound(node.at()));
        &self.moving.insert(moving).nodes
    }
    /// The nodes that hold what moves.
    fn moving_of<S: Space<Vector = V>>(&self, scene: &Scene<S>) -> Moving<[Aabb<V>; 2]> {
        let still = |node: NodeId, prims: &mut dyn Iterator<Item = PrimId>| {
            let cube = &self.nodes[node.at()].cube;
            prims.fold([Aabb::empty(); 2], |[inside, whole]: [Aabb<V>; 2], p| {
                let bounds = scene.prim_bounds(p);
                [inside.union(clipped(&bounds, cube)), whole.union(bounds)]
            })
        };
        let listed = |node| [self.own(node), self.shared(node)];
        Moving::new(self.nodes.len(), listed, |node| self.parent_of(node), |p| scene.is_moving(p), still)
    }

    /// All nodes; the root first, parents before children.
    pub fn nodes(&self) -> &[OctreeNode<V>] {
        &self.nodes
    }
    /// The cube that a cube is part of; `None` for the root.
    pub fn parent_of(&self, node: NodeId) -> Option<NodeId> {
        (node.0 != 0).then(|| NodeId(self.nodes[node.at()].parent))
    }
    /// The primitives that are a node's alone.
    #[inline]
    pub fn own(&self, node: NodeId) -> &[PrimId] {
        let n = &self.nodes[node.at()];
        &self.order[n.first as usize..(n.first + n.own) as usize]
    }
    /// The primitives that it passed on to several children.
    #[inline]
    pub fn passed(&self, node: NodeId) -> &[PrimId] {
        let n = &self.nodes[node.at()];
        &self.order[(n.first + n.own) as usize..(n.first + n.own + n.passed) as usize]
    }
    /// The primitives that it shares with neighbors.
    #[inline]
    pub fn shared(&self, node: NodeId) -> &[PrimId] {
        let n = &self.nodes[node.at()];
        &self.shared[n.first_shared as usize..(n.first_shared + n.shared) as usize]
    }
    /// References to primitives in all nodes; with [`Redistribution::Split`] the number of parts.
    pub fn references(&self) -> usize {
        self.nodes.iter().map(|n| (n.own + n.shared) as usize).sum()
    }
}

impl<V: Vector> OctreeNode<V> {
    fn of(cube: Aabb<V>, octant: u8, level: u8, parent: u32) -> Self {
        let empty = Aabb::empty();
        Self {
            cube,
            bounds: empty,
            whole: empty,
            held: empty,
            held_whole: empty,
            octant,
            level,
            parent,
            children: 0,
            first_child: 0,
            first: 0,
            own: 0,
            passed: 0,
            count: 0,
            first_shared: 0,
            shared: 0,
        }
    }
}

/// The cube about a box, with the same center as far as f32 allows.
pub(super) fn cube_around<V: Vector>(bounds: &Aabb<V>) -> Aabb<V> {
    if bounds.is_empty() {
        return Aabb { min: V::default(), max: V::default() };
    }
    // The center may round by half an ulp, so the union makes sure that nothing sticks out.
    let half = V::splat(longest(bounds) * 0.5);
    Aabb { min: bounds.center() - half, max: bounds.center() + half }.union(*bounds)
}

fn longest<V: Vector>(bounds: &Aabb<V>) -> f32 {
    (0..V::AXES).map(|a| bounds.size().get(a)).fold(0.0, f32::max)
}

/// Which child a point lies in: those on a dividing plane belong to the lower one.
fn octant_at<V: Vector>(point: V, center: V) -> usize {
    (0..V::AXES).map(|a| usize::from(point.get(a) > center.get(a)) << a).sum()
}

/// The child cell of an octant: bit `a` says upper on axis `a`.
#[inline]
pub fn octant_of<V: Vector>(cube: &Aabb<V>, octant: usize) -> Aabb<V> {
    let center = cube.center();
    let pick = |upper: bool, a: usize| octant >> a & 1 == usize::from(upper);
    let min = V::from_fn(|a| if pick(true, a) { center.get(a) } else { cube.min.get(a) });
    let max = V::from_fn(|a| if pick(false, a) { center.get(a) } else { cube.max.get(a) });
    Aabb { min, max }
}

fn clipped<V: Vector>(bounds: &Aabb<V>, cube: &Aabb<V>) -> Aabb<V> {
    Aabb { min: bounds.min.max(cube.min), max: bounds.max.min(cube.max) }
}

impl<S: Space> Hierarchy<S> for Octree<S::Vector> {
    fn node_count(&self) -> usize {
        self.nodes.len()
    }
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector> {
        self.nodes[node.at()].bounds
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        self.parent_of(node)
    }
    fn children(&self, node: NodeId) -> Range<u32> {
        self.nodes[node.at()].children()
    }
    fn level(&self, node: NodeId) -> u32 {
        u32::from(self.nodes[node.at()].level)
    }
    /// Those that lie at or below the node with all their references.
    fn prims(&self, node: NodeId) -> &[PrimId] {
        let n = &self.nodes[node.at()];
        &self.order[n.first as usize..(n.first + n.count) as usize]
    }
    fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<OctreeNode<S::Vector>>()
            + (self.order.len() + self.shared.len()) * size_of::<PrimId>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::dice::Dice;
    use crate::geometry::{Flat, Solid};
    use crate::index::tests::random_boxes;
    use glam::{Vec2, Vec3};

    /// What the tree promises beyond the contract of [`Hierarchy`]: bounds of what each cube holds, slices of
    /// the order, and references to shared primitives.
    fn assert_redistributed<V: Vector>(tree: &Octree<V>, boxes: &[(PrimId, Aabb<V>)]) {
        let bounds_of = |p: PrimId| boxes[boxes.binary_search_by_key(&p, |b| b.0).expect("sorted by id")].1;
        let is_below = |node: usize, above: usize| {
            std::iter::successors(Some(node), |&n| (n != 0).then(|| tree.nodes[n].parent as usize))
                .any(|n| n == above)
        };
        for (at, node) in tree.nodes.iter().enumerate() {
            let id = NodeId(at as u32);
            for &prim in tree.own(id).iter().chain(tree.shared(id)) {
                let held = clipped(&bounds_of(prim), &node.cube);
                assert!(
                    !held.is_empty() && node.bounds.encloses(&held),
                    "node {at} bounds what it holds of {prim}"
                );
                assert!(node.whole.encloses(&bounds_of(prim)), "node {at} bounds {prim} as a whole");
            }
            let mut next = node.first + node.own + node.passed;
            for child in node.children() {
                let c = &tree.nodes[child as usize];
                assert_eq!(c.first, next, "child {child} of {at}");
                assert!(c.count + c.shared > 0 || c.children > 0, "node {child} holds something");
                assert!(node.whole.encloses(&c.whole), "node {at} holds its child {child}");
                next += c.count;
            }
            assert_eq!(next, node.first + node.count, "the slices of the children of {at} follow its own");
            for &prim in tree.passed(id) {
                // Its references lie below and together cover its box.
                let holders: Vec<usize> = (at + 1..tree.nodes.len())
                    .filter(|&n| tree.shared(NodeId(n as u32)).contains(&prim))
                    .collect();
                assert!(
                    holders.iter().all(|&n| is_below(n, at)),
                    "what {at} passes on is referred to below it"
                );
                for corner in bounds_of(prim).corners() {
                    assert!(
                        holders.iter().any(|&n| tree.nodes[n].cube.contains(corner)),
                        "a corner of {prim} lies in some cube that holds it"
                    );
                }
            }
        }
    }

    fn check<S: Space>() {
        let mut dice = Dice::new(17);
        for case in 0..400 {
            let n = dice.below(300) as usize;
            let boxes = random_boxes::<S::Vector>(&mut dice, n, &[0.1, 1.0, 5.0], case % 2 == 0);
            let shape = Shape {
                levels: 1 + dice.below(12),
                leaf_prims: 1 + dice.below(20),
                redistribution: Redistribution::ALL[case % 4],
                small: [0.0, 0.1, 0.5, 2.0][case / 4 % 4],
            };
            let tree = Octree::build(boxes.iter().copied(), &shape, &|| false).expect("not cancelled");
            assert_eq!(Hierarchy::<S>::fault(&tree, &boxes), None, "case {case}");
            assert_redistributed(&tree, &boxes);
            assert!(tree.nodes().iter().all(|n| u32::from(n.level) < shape.levels));
            if matches!(shape.redistribution, Redistribution::Parent | Redistribution::Grown) {
                assert_eq!(tree.references(), n, "nothing is shared");
                assert!(tree.nodes().iter().all(|n| n.whole == n.bounds));
            }
        }
    }

    #[test]
    fn random_builds_are_well_formed_in_the_plane_and_in_space() {
        check::<Flat>();
        check::<Solid>();
    }

    /// One large and one small box across the middle, and one in each quarter.
    fn crossing() -> Vec<(PrimId, Aabb<Vec2>)> {
        let square = |x: f32, y: f32, half: f32| Aabb {
            min: Vec2::new(x - half, y - half),
            max: Vec2::new(x + half, y + half),
        };
        let boxes = [
            square(0.0, 0.0, 4.0),
            square(0.0, 3.0, 0.1),
            square(-8.0, -8.0, 0.5),
            square(8.0, -8.0, 0.5),
            square(-8.0, 8.0, 0.5),
            square(8.0, 8.0, 0.5),
        ];
        boxes.into_iter().enumerate().map(|(i, b)| (PrimId(i as u32), b)).collect()
    }

    #[test]
    fn small_primitives_go_to_the_children_they_overlap_and_large_ones_stay() {
        let build = |redistribution| {
            let shape = Shape { levels: 2, leaf_prims: 1, redistribution, small: 0.1 };
            Octree::build(crossing().into_iter(), &shape, &|| false).expect("not cancelled")
        };
        let hybrid = build(Redistribution::Hybrid);
        assert_eq!((hybrid.own(NodeId(0)), hybrid.passed(NodeId(0))), (&[PrimId(0)][..], &[PrimId(1)][..]));
        let holders: Vec<u8> = (1..5)
            .filter(|&n| hybrid.shared(NodeId(n)) == [PrimId(1)])
            .map(|n| hybrid.nodes()[n as usize].octant)
            .collect();
        assert_eq!(holders, [2, 3], "the two upper quarters");
        let parent = build(Redistribution::Parent);
        assert_eq!(parent.own(NodeId(0)), [PrimId(0), PrimId(1)]);
        let grown = build(Redistribution::Grown);
        assert_eq!(grown.own(NodeId(0)), []);
        assert!(grown.nodes().iter().any(|n| n.level == 1
            && n.bounds.contains(Vec2::new(4.0, 4.0))
            && n.bounds.contains(Vec2::new(-4.0, -4.0))));
        assert_eq!(
            build(Redistribution::Split).references(),
            4 + 4 + 2,
            "the large one has four parts, the small one two"
        );
    }

    #[test]
    fn primitives_that_cannot_be_told_apart_end_in_one_place() {
        for redistribution in Redistribution::ALL {
            let same = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
            let shape = Shape { levels: Shape::MOST_LEVELS, leaf_prims: 1, redistribution, small: 0.1 };
            let boxes: Vec<_> = (0..50).map(|i| (PrimId(i), same)).collect();
            let tree = Octree::build(boxes.iter().copied(), &shape, &|| false).expect("not cancelled");
            assert_eq!(Hierarchy::<Solid>::fault(&tree, &boxes), None);
            assert_redistributed(&tree, &boxes);
            assert!(tree.nodes().len() < 30, "{redistribution:?}: {} nodes", tree.nodes().len());
        }
    }

    #[test]
    fn a_build_can_be_cancelled() {
        let shape = Shape { levels: 5, leaf_prims: 1, redistribution: Redistribution::Hybrid, small: 0.1 };
        assert!(Octree::build(crossing().into_iter(), &shape, &|| true).is_none());
    }
}
