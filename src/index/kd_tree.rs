//! kD-tree over primitives, in any number of dimensions.
//!
//! Coorg and Teller 1997, Section 4:
//!
//! 1. Nodes are split to a given height (8 levels: 255 nodes);
//! 2. alternately along each axis, at a plane that balances the polygons;
//! 3. then all nodes are bounded, from below.
//!
//! The paper does not say where a polygon goes that crosses the splitting plane. Two trees:
//!
//! - [`KdTree::build`]: to the side of its center, and the node's box grows to hold it. There is exactly one
//!   reference a polygon. Cost: O(n · height) time, 1 node per about `n / 2^(height−1)` primitives.
//! - [`KdTree::build_cells`]: to both sides, and boxes end at the planes: they bound what their nodes hold
//!   within their cells. The polygon stands once in the order, at the node whose plane it crosses first, and
//!   the leaves refer to it. Cost: O(n · height · log n) time; at most [`MOST_REFERENCES`] as many references
//!   from level to level.

use std::ops::Range;

use super::Hierarchy;
use super::moving::Moving;
use crate::geometry::{Aabb, NodeId, PrimId, Space, Vector};
use crate::scene::Scene;

/// One node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KdNode<V> {
    /// Bounds of the primitives below, world units.
    pub bounds: Aabb<V>,
    /// Where it is split along `axis`: centers of the first child's primitives are ≤ this; meaningless for a
    /// leaf.
    pub split: f32,
    /// Splitting axis; meaningless for a leaf.
    pub axis: u8,
    /// Depth below the root.
    pub level: u8,
    /// First of the two children, which are neighbours; 0 for a leaf.
    first_child: u32,
    parent: u32,
    first: u32,
    /// Of those at and below it the first ones, which are no child's: all of a leaf's, and elsewhere those
    /// that cross the plane.
    own: u32,
    count: u32,
    /// Primitives of nodes above that reach into this leaf.
    first_shared: u32,
    shared: u32,
    /// How many primitives meet it.
    held: u32,
}

impl<V: Vector> KdNode<V> {
    fn new(level: u8, parent: u32) -> Self {
        Self {
            bounds: Aabb::empty(),
            split: 0.0,
            axis: 0,
            level,
            first_child: 0,
            parent,
            first: 0,
            own: 0,
            count: 0,
            first_shared: 0,
            shared: 0,
            held: 0,
        }
    }
}

impl<V> KdNode<V> {
    /// Whether it has no children.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.first_child == 0
    }
    /// Whether all that meets it lies wholly at and below it.
    #[inline]
    pub fn is_whole(&self) -> bool {
        self.held == self.count
    }
    /// Its two children; `None` for a leaf.
    #[inline]
    pub fn children(&self) -> Option<[NodeId; 2]> {
        (!self.is_leaf()).then(|| [NodeId(self.first_child), NodeId(self.first_child + 1)])
    }
}

/// A frozen kD-tree.
#[derive(Clone, Debug)]
pub struct KdTree<V> {
    nodes: Vec<KdNode<V>>,
    order: Vec<PrimId>,
    shared: Vec<PrimId>,
    /// What [`KdTree::refit`] found out the first time.
    moving: Option<Moving<Aabb<V>>>,
}

/// By how much a division may multiply references. Where a plane cuts most of what there is, halves hold
/// nearly as much as the whole, and dividing on parts little.
const MOST_REFERENCES: f32 = 1.5;

/// A primitive on its way into the tree.
#[derive(Clone, Copy)]
struct Entry<V> {
    bounds: Aabb<V>,
    prim: PrimId,
    /// Whether it crossed a plane above.
    is_shared: bool,
}

impl<V: Vector> Entry<V> {
    /// Twice the center; the factor does not matter for ordering.
    #[inline]
    fn key(&self, axis: usize) -> f32 {
        self.bounds.min.get(axis) + self.bounds.max.get(axis)
    }
}

impl<V: Vector> KdTree<V> {
    /// Builds a tree of at most `height ≥ 1` levels. A node is not split further when it holds one
    /// primitive, or when all its centers coincide. Ties are broken by id.
    /// Stops early and returns `None` when `cancelled` returns true (called once a node).
    pub fn build(
        prims: impl Iterator<Item = (PrimId, Aabb<V>)>,
        height: u32,
        cancelled: impl Fn() -> bool,
    ) -> Option<Self> {
        let mut entries = entries(prims);
        let mut nodes = vec![KdNode { count: entries.len() as u32, ..KdNode::new(0, 0) }];
        let mut at = 0;
        // 1. Breadth first: the nodes from `at` on are still to be split, and parents come before their
        // children.
        while at < nodes.len() {
            if cancelled() {
                return None;
            }
            let node = nodes[at];
            let range = node.first as usize..(node.first + node.count) as usize;
            if u32::from(node.level) + 1 < height
                // 2. The axes take turns from level to level.
                && let Some((axis, half, split)) =
                    partition(&mut entries[range], node.level as usize % V::AXES)
            {
                // Children share the parent's slice of the order, which `partition` has sorted into two.
                let child =
                    KdNode { split: 0.0, level: node.level + 1, first_child: 0, parent: at as u32, ..node };
                let left = nodes.len() as u32;
                nodes.push(KdNode { count: half, ..child });
                nodes.push(KdNode { first: node.first + half, count: node.count - half, ..child });
                (nodes[at].first_child, nodes[at].axis, nodes[at].split) = (left, axis as u8, split);
            }
            at += 1;
        }
        // 3. Children follow their parents, so one pass backwards bounds every node: leaves by what they
        // hold, inner nodes by their children.
        for at in (0..nodes.len()).rev() {
            let node = nodes[at];
            nodes[at].bounds = match node.children() {
                Some([a, b]) => nodes[a.at()].bounds.union(nodes[b.at()].bounds),
                None => bounds_of(&entries[node.first as usize..(node.first + node.count) as usize]),
            };
            nodes[at].own = if node.is_leaf() { node.count } else { 0 };
            nodes[at].held = node.count;
        }
        Some(Self {
            nodes,
            order: entries.iter().map(|e| e.prim).collect(),
            shared: Vec::new(),
            moving: None,
        })
    }

    /// Builds a tree of at most `height ≥ 1` levels whose boxes end at the splitting planes. A node is not
    /// split further where that would part nothing. The result does not depend on the order of the input.
    /// Stops early and returns `None` when `cancelled` returns true (called once a node).
    pub fn build_cells(
        prims: impl Iterator<Item = (PrimId, Aabb<V>)>,
        height: u32,
        cancelled: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let mut entries = entries(prims);
        entries.sort_unstable_by_key(|e| e.prim);
        let order = Vec::with_capacity(entries.len());
        let mut tree = Self { nodes: vec![KdNode::new(0, 0)], order, shared: Vec::new(), moving: None };
        tree.grow(0, entries, height, cancelled)?;
        Some(tree)
    }

    /// Fills node `at` and all below it.
    fn grow(
        &mut self,
        at: usize,
        entries: Vec<Entry<V>>,
        height: u32,
        cancelled: &dyn Fn() -> bool,
    ) -> Option<()> {
        if cancelled() {
            return None;
        }
        let level = self.nodes[at].level;
        self.nodes[at].first = self.order.len() as u32;
        self.nodes[at].first_shared = self.shared.len() as u32;
        self.nodes[at].held = entries.len() as u32;
        // 1 and 2.
        let plane =
            if u32::from(level) + 1 < height { plane(&entries, level as usize % V::AXES) } else { None };
        if let Some((axis, split)) = plane {
            let (passed, halves) = divided(entries, axis, split);
            self.order.extend(passed.iter().map(|e| e.prim));
            let first_child = self.nodes.len() as u32;
            let node = &mut self.nodes[at];
            (node.own, node.first_child, node.axis, node.split) =
                (passed.len() as u32, first_child, axis as u8, split);
            drop(passed);
            self.nodes.extend([KdNode::new(level + 1, at as u32); 2]);
            for (child, half) in (first_child as usize..).zip(halves) {
                self.grow(child, half, height, cancelled)?;
                // 3.
                self.nodes[at].bounds = self.nodes[at].bounds.union(self.nodes[child].bounds);
            }
        } else {
            self.nodes[at].bounds = bounds_of(&entries);
            let (shared, own): (Vec<Entry<V>>, Vec<_>) = entries.iter().partition(|e| e.is_shared);
            (self.nodes[at].own, self.nodes[at].shared) = (own.len() as u32, shared.len() as u32);
            self.order.extend(own.iter().map(|e| e.prim));
            self.shared.extend(shared.iter().map(|e| e.prim));
        }
        self.nodes[at].count = self.order.len() as u32 - self.nodes[at].first;
        Some(())
    }

    /// Bounds the nodes anew for another frame of the scene that it was built of, and returns those whose
    /// bounds may have changed. In a tree of cells boxes still end at the planes, but for those of what
    /// moves: they are whole in each leaf that refers to them. Called once when it is built, so that it is
    /// the same whatever frames come before another one. Cost: O(primitives) the first time, then
    /// O(primitives that move and nodes above them).
    pub fn refit<S: Space<Vector = V>>(&mut self, scene: &Scene<S>) -> &[NodeId] {
        if scene.moving().is_empty() {
            return &[];
        }
        let moving = self.moving.take().unwrap_or_else(|| self.moving_of(scene));
        for list in &moving.lists {
            let bounds = moving.of(list).iter().fold(list.still, |b, p| b.union(scene.prim_bounds(*p)));
            self.nodes[list.node.at()].bounds = bounds;
        }
        // As when it was built, from below.
        for node in &moving.nodes {
            if let Some([a, b]) = self.nodes[node.at()].children() {
                self.nodes[node.at()].bounds = self.nodes[a.at()].bounds.union(self.nodes[b.at()].bounds);
            }
        }
        &self.moving.insert(moving).nodes
    }
    /// The leaves that refer to what moves. Inner nodes are bounded by their children, also where they list
    /// what crosses their plane: leaves on both sides refer to that.
    fn moving_of<S: Space<Vector = V>>(&self, scene: &Scene<S>) -> Moving<Aabb<V>> {
        let listed = |node: NodeId| {
            let is_leaf = self.nodes[node.at()].is_leaf();
            let own = if is_leaf { &self.order[self.own(node)] } else { &[] };
            [own, &self.shared[self.shared(node)]]
        };
        let still = |node: NodeId, prims: &mut dyn Iterator<Item = PrimId>| {
            let cell = self.is_parted().then(|| self.cell(node));
            let part = |b: Aabb<V>| cell.map_or(b, |c| Aabb { min: b.min.max(c.min), max: b.max.min(c.max) });
            prims.fold(Aabb::empty(), |all, p| all.union(part(scene.prim_bounds(p))))
        };
        let parent = |node| Hierarchy::<S>::parent(self, node);
        Moving::new(self.nodes.len(), listed, parent, |p| scene.is_moving(p), still)
    }
    /// What the planes above a node leave of space.
    fn cell(&self, node: NodeId) -> Aabb<V> {
        let mut cell = Aabb { min: V::splat(f32::NEG_INFINITY), max: V::splat(f32::INFINITY) };
        let mut at = node.0;
        while at != 0 {
            let parent = self.nodes[at as usize].parent;
            let KdNode { axis, split, first_child, .. } = self.nodes[parent as usize];
            let cut = |v: V, to: fn(f32, f32) -> f32| {
                V::from_fn(|a| if a == axis as usize { to(v.get(a), split) } else { v.get(a) })
            };
            if at == first_child {
                cell.max = cut(cell.max, f32::min);
            } else {
                cell.min = cut(cell.min, f32::max);
            }
            at = parent;
        }
        cell
    }

    /// All nodes; the root first, parents before children.
    pub fn nodes(&self) -> &[KdNode<V>] {
        &self.nodes
    }
    /// The primitives at and below a node.
    #[inline]
    pub fn prims_below(&self, node: NodeId) -> &[PrimId] {
        &self.order[self.range(node)]
    }

    /// Where the primitives at and below a node stand in the order of all.
    #[inline]
    fn range(&self, node: NodeId) -> Range<usize> {
        let n = &self.nodes[node.at()];
        n.first as usize..(n.first + n.count) as usize
    }
    /// Where those of a node that none of its children lists stand in the order of all: a leaf's, and
    /// elsewhere those that cross the node's plane, to which leaves on both sides refer.
    #[inline]
    pub fn own(&self, node: NodeId) -> Range<usize> {
        let n = &self.nodes[node.at()];
        n.first as usize..(n.first + n.own) as usize
    }
    /// Where the primitives of nodes above that reach into a leaf stand in the list of those.
    #[inline]
    pub fn shared(&self, node: NodeId) -> Range<usize> {
        let n = &self.nodes[node.at()];
        n.first_shared as usize..(n.first_shared + n.shared) as usize
    }
    /// All primitives, and the references to those that cross planes.
    pub fn lists(&self) -> [&[PrimId]; 2] {
        [&self.order, &self.shared]
    }
    /// Whether some primitive has several references.
    pub fn is_parted(&self) -> bool {
        !self.shared.is_empty()
    }
    /// Sorts what each node lists.
    pub fn sort_lists<K: Ord>(&mut self, key: impl Fn(PrimId) -> K) {
        for at in 0..self.nodes.len() {
            let node = NodeId(at as u32);
            let (own, shared) = (self.own(node), self.shared(node));
            self.order[own].sort_unstable_by_key(|p| key(*p));
            self.shared[shared].sort_unstable_by_key(|p| key(*p));
        }
    }
}

fn entries<V: Vector>(prims: impl Iterator<Item = (PrimId, Aabb<V>)>) -> Vec<Entry<V>> {
    prims.map(|(prim, bounds)| Entry { bounds, prim, is_shared: false }).collect()
}

fn bounds_of<V: Vector>(entries: &[Entry<V>]) -> Aabb<V> {
    entries.iter().fold(Aabb::empty(), |b, e| b.union(e.bounds))
}

/// The plane that parts entries best: along `axis`, or the next one along which any does; `None` if none
/// does. Best is what leaves the larger side the least, those that cross counted twice: what crosses is
/// tested on both sides, so a plane a little off the balance is better than one through a crowd.
fn plane<V: Vector>(entries: &[Entry<V>], axis: usize) -> Option<(usize, f32)> {
    let n = entries.len();
    let sorted = |of: &dyn Fn(&Entry<V>) -> f32| {
        let mut all: Vec<f32> = entries.iter().map(of).collect();
        all.sort_unstable_by(f32::total_cmp);
        all
    };
    let along = |axis: usize| {
        let mins = sorted(&|e| e.bounds.min.get(axis));
        let maxs = sorted(&|e| e.bounds.max.get(axis));
        let is_flat = |e: &&Entry<V>| e.bounds.min.get(axis) == e.bounds.max.get(axis);
        let mut flat: Vec<f32> = entries.iter().filter(is_flat).map(|e| e.bounds.min.get(axis)).collect();
        flat.sort_unstable_by(f32::total_cmp);
        // Every end of a box is tried: between two of them nothing changes sides.
        let mut ends = [&mins[..], &maxs[..]].concat();
        ends.sort_unstable_by(f32::total_cmp);
        ends.dedup();
        let parted = |split: f32| {
            let below = |list: &[f32]| list.partition_point(|v| *v < split);
            let ended = |list: &[f32]| list.partition_point(|v| *v <= split);
            let low = ended(&maxs);
            // Those in the plane itself are low: they do not reach beyond it.
            let high = n - below(&mins) - (ended(&flat) - below(&flat));
            [low, n - low - high, high]
        };
        let of = |&split: &f32| {
            let [low, crossing, high] = parted(split);
            let larger = low.max(high) + crossing;
            let parts = larger < n && (n + crossing) as f32 <= n as f32 * MOST_REFERENCES;
            parts.then_some((larger + crossing, split))
        };
        ends.iter().filter_map(of).min_by_key(|(cost, _)| *cost).map(|(_, split)| (axis, split))
    };
    (0..V::AXES).find_map(|k| along((axis + k) % V::AXES))
}

/// Entries on either side of a plane, and those that cross it for the first time.
fn divided<V: Vector>(
    entries: Vec<Entry<V>>,
    axis: usize,
    split: f32,
) -> (Vec<Entry<V>>, [Vec<Entry<V>>; 2]) {
    let (mut passed, mut low, mut high) = (Vec::new(), Vec::new(), Vec::new());
    for entry in entries {
        let Entry { bounds, .. } = entry;
        if bounds.max.get(axis) <= split {
            low.push(entry);
        } else if bounds.min.get(axis) >= split {
            high.push(entry);
        } else {
            let cut = |v: V| V::from_fn(|a| if a == axis { split } else { v.get(a) });
            let part = |bounds| Entry { bounds, is_shared: true, ..entry };
            low.push(part(Aabb { min: bounds.min, max: cut(bounds.max) }));
            high.push(part(Aabb { min: cut(bounds.min), max: bounds.max }));
            // Only at the first plane that it crosses: all its references lie below that.
            if !entry.is_shared {
                passed.push(entry);
            }
        }
    }
    (passed, [low, high])
}

/// Reorders entries into two halves by their centers: along `axis`, or the next axis along which
/// they differ. Returns axis, size of the first half and the plane; `None` if they cannot be told apart.
fn partition<V: Vector>(entries: &mut [Entry<V>], axis: usize) -> Option<(usize, u32, f32)> {
    // Nothing to balance.
    if entries.len() < 2 {
        return None;
    }
    // Departure: the next axis where the centers agree along the one whose turn it is, since any plane there
    // would leave all on one side.
    let differ = |axis: &usize| entries.iter().any(|e| e.key(*axis) != entries[0].key(*axis));
    let axis = (0..V::AXES).map(|k| (axis + k) % V::AXES).find(differ)?;
    let half = entries.len() / 2;
    // A total order, so that the halves, and all of the tree, do not depend on the order of the input.
    let order = |a: &Entry<V>, b: &Entry<V>| a.key(axis).total_cmp(&b.key(axis)).then(a.prim.cmp(&b.prim));
    // The median by selection, in linear time; the plane goes through the first center above it.
    let (_, first_of_second, _) = entries.select_nth_unstable_by(half, order);
    Some((axis, half as u32, first_of_second.key(axis) * 0.5))
}

impl<S: Space> Hierarchy<S> for KdTree<S::Vector> {
    fn node_count(&self) -> usize {
        self.nodes.len()
    }
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector> {
        self.nodes[node.at()].bounds
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        (node.0 != 0).then(|| NodeId(self.nodes[node.at()].parent))
    }
    fn children(&self, node: NodeId) -> Range<u32> {
        let first = self.nodes[node.at()].first_child;
        if first == 0 { 0..0 } else { first..first + 2 }
    }
    fn level(&self, node: NodeId) -> u32 {
        u32::from(self.nodes[node.at()].level)
    }
    fn prims(&self, node: NodeId) -> &[PrimId] {
        self.prims_below(node)
    }
    fn held(&self, node: NodeId) -> usize {
        self.nodes[node.at()].held as usize
    }
    fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<KdNode<S::Vector>>()
            + (self.order.len() + self.shared.len()) * size_of::<PrimId>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::dice::Dice;
    use crate::geometry::{Flat, Solid};
    use crate::index::tests::random_boxes;
    use glam::{Vec2, Vec3, Vec4};

    /// What the tree promises beyond the contract of [`Hierarchy`]: tight bounds, and children that are a
    /// balanced partition of their parent at its plane.
    fn assert_balanced<V: Vector>(tree: &KdTree<V>, boxes: &[(PrimId, Aabb<V>)], height: u32) {
        let bounds_of = |p: PrimId| boxes[boxes.binary_search_by_key(&p, |b| b.0).expect("sorted by id")].1;
        for (i, node) in tree.nodes.iter().enumerate() {
            let id = NodeId(i as u32);
            let bounds = tree.prims_below(id).iter().fold(Aabb::empty(), |b, &p| b.union(bounds_of(p)));
            assert_eq!(bounds, node.bounds, "node {i} is bounded tightly");
            assert!(u32::from(node.level) < height, "node {i} is above the height limit");
            let Some([a, b]) = node.children() else { continue };
            let (na, nb) = (&tree.nodes[a.at()], &tree.nodes[b.at()]);
            assert_eq!(
                (na.first, na.first + na.count, nb.first + nb.count),
                (node.first, nb.first, node.first + node.count)
            );
            assert!(na.count.abs_diff(nb.count) <= 1, "node {i} is balanced");
            let key = |p: &PrimId| {
                bounds_of(*p).min.get(node.axis as usize) + bounds_of(*p).max.get(node.axis as usize)
            };
            let low = tree.prims_below(a).iter().map(key).fold(f32::NEG_INFINITY, f32::max);
            let high = tree.prims_below(b).iter().map(key).fold(f32::INFINITY, f32::min);
            assert!(
                low <= high && low * 0.5 <= node.split && node.split <= high * 0.5,
                "node {i} is split at its plane"
            );
        }
    }

    /// [`Hierarchy::fault`] of a space.
    type Fault<V> = fn(&KdTree<V>, &[(PrimId, Aabb<V>)]) -> Option<String>;

    fn check<V: Vector>(fault: Fault<V>) {
        let mut dice = Dice::new(7);
        for case in 0..300 {
            let n = 1 + dice.below(300) as usize;
            let height = 1 + dice.below(12);
            let boxes = random_boxes::<V>(&mut dice, n, &[2.0], case % 2 == 0);
            let tree = KdTree::build(boxes.iter().copied(), height, || false).expect("not cancelled");
            assert_eq!(fault(&tree, &boxes), None, "case {case}");
            assert_balanced(&tree, &boxes, height);
        }
    }

    #[test]
    fn random_builds_are_well_formed_in_two_three_and_four_dimensions() {
        check::<Vec2>(Hierarchy::<Flat>::fault);
        check::<Vec3>(Hierarchy::<Solid>::fault);
        // No scene has four dimensions.
        check::<Vec4>(|_, _| None);
    }

    /// What a tree of cells promises beyond the contract: each leaf refers to all that reaches into its cell,
    /// and bounds it there; what crosses a plane is listed where it first does.
    fn assert_parted<V: Vector>(tree: &KdTree<V>, boxes: &[(PrimId, Aabb<V>)], height: u32) {
        let bounds_of = |p: PrimId| boxes[boxes.binary_search_by_key(&p, |b| b.0).expect("sorted by id")].1;
        let [order, shared] = tree.lists();
        let mut cells = vec![Aabb { min: V::splat(-1e9), max: V::splat(1e9) }; tree.nodes.len()];
        let mut leaves_of = vec![Vec::new(); boxes.len()];
        for (i, node) in tree.nodes.iter().enumerate() {
            let (id, cell) = (NodeId(i as u32), cells[i]);
            assert!(u32::from(node.level) < height, "node {i} is above the height limit");
            let own = &order[tree.own(id)];
            if let Some([a, b]) = node.children() {
                let cut = |v: V| V::from_fn(|a| if a == node.axis as usize { node.split } else { v.get(a) });
                (cells[a.at()].max, cells[b.at()].min) = (cut(cell.max), cut(cell.min));
                (cells[a.at()].min, cells[b.at()].max) = (cell.min, cell.max);
                let axis = node.axis as usize;
                let crosses = |p: &PrimId| {
                    bounds_of(*p).min.get(axis) < node.split && node.split < bounds_of(*p).max.get(axis)
                };
                assert!(own.iter().all(crosses), "what node {i} lists itself crosses its plane");
                continue;
            }
            let held: Vec<PrimId> = own.iter().chain(&shared[tree.shared(id)]).copied().collect();
            assert_eq!(held.len(), node.held as usize, "node {i}");
            for &(prim, b) in boxes {
                let overlaps =
                    (0..V::AXES).all(|a| b.min.get(a) < cell.max.get(a) && cell.min.get(a) < b.max.get(a));
                assert!(!overlaps || held.contains(&prim), "leaf {i} refers to {prim}");
            }
            for prim in held {
                let part =
                    Aabb { min: bounds_of(prim).min.max(cell.min), max: bounds_of(prim).max.min(cell.max) };
                assert!(
                    !part.is_empty() && node.bounds.encloses(&part),
                    "leaf {i} bounds its part of {prim}"
                );
                leaves_of[prim.at()].push(i);
            }
        }
        for &(prim, b) in boxes {
            let held = |corner: V| leaves_of[prim.at()].iter().any(|&leaf| cells[leaf].contains(corner));
            assert!(b.corners().all(held), "each corner of {prim} lies in a leaf that refers to it");
        }
    }

    fn check_cells<V: Vector>(fault: Fault<V>) {
        let mut dice = Dice::new(11);
        let mut parted = 0;
        for case in 0..300 {
            let n = 1 + dice.below(300) as usize;
            let height = 1 + dice.below(12);
            let mut boxes = random_boxes::<V>(&mut dice, n, &[0.1, 2.0, 9.0], case % 2 == 0);
            let tree = KdTree::build_cells(boxes.iter().copied(), height, &|| false).expect("not cancelled");
            assert_eq!(fault(&tree, &boxes), None, "case {case}");
            assert_parted(&tree, &boxes, height);
            parted += usize::from(tree.is_parted());
            boxes.reverse();
            let same = KdTree::build_cells(boxes.into_iter(), height, &|| false).expect("not cancelled");
            assert_eq!((tree.nodes, tree.order, tree.shared), (same.nodes, same.order, same.shared));
        }
        assert!(parted > 150, "{parted} of 300 trees part primitives");
    }

    #[test]
    fn cells_hold_all_that_reaches_into_them() {
        check_cells::<Vec2>(Hierarchy::<Flat>::fault);
        check_cells::<Vec3>(Hierarchy::<Solid>::fault);
    }

    #[test]
    fn height_eight_gives_the_papers_255_nodes_and_alternates_axes() {
        let boxes = random_boxes::<Vec3>(&mut Dice::new(1), 5000, &[2.0], false);
        let tree = KdTree::build(boxes.iter().copied(), 8, || false).expect("not cancelled");
        assert_eq!(tree.nodes().len(), 255);
        assert!(tree.nodes().iter().filter(|n| !n.is_leaf()).all(|n| n.axis == n.level % 3));
    }

    #[test]
    fn primitives_that_cannot_be_told_apart_stay_in_one_leaf() {
        let b = Aabb { min: Vec2::ZERO, max: Vec2::ONE };
        let tree = KdTree::build((0..50).map(|i| (PrimId(i), b)), 8, || false).expect("not cancelled");
        assert_eq!(tree.nodes().len(), 1);
    }

    #[test]
    fn the_order_of_input_does_not_matter() {
        let mut boxes = random_boxes::<Vec3>(&mut Dice::new(3), 400, &[2.0], true);
        let a = KdTree::build(boxes.iter().copied(), 6, || false).expect("not cancelled");
        boxes.reverse();
        let b = KdTree::build(boxes.iter().copied(), 6, || false).expect("not cancelled");
        assert_eq!(a.nodes, b.nodes);
    }

    #[test]
    fn a_build_can_be_cancelled() {
        let boxes = random_boxes::<Vec2>(&mut Dice::new(3), 40, &[2.0], false);
        assert!(KdTree::build(boxes.into_iter(), 6, || true).is_none());
    }
}
