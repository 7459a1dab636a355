//! kD-tree over primitives, in any number of dimensions.
//!
//! Coorg and Teller 1997, Section 4:
//!
//! 1. Nodes are split to a given height (8 levels: 255 nodes);
//! 2. alternately along each axis, at a plane that balances the polygons;
//! 3. then all nodes are bounded, from below.
//!
//! Departure: a polygon that crosses the splitting plane goes to the side of its center and the node's box
//! grows to hold it, so that there is exactly one reference a polygon, and boxes are the bounds of what they
//! hold. Cost: O(n · height) time, one reference a primitive, 1 node per about `n / 2^(height−1)` primitives.

use std::ops::Range;

use super::Hierarchy;
use crate::geometry::{Aabb, NodeId, PrimId, Space, Vector};

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
    count: u32,
}

impl<V> KdNode<V> {
    /// Whether it has no children.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.first_child == 0
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
}

/// A primitive on its way into the tree.
#[derive(Clone, Copy)]
struct Entry<V> {
    bounds: Aabb<V>,
    prim: PrimId,
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
        let mut entries: Vec<Entry<V>> = prims.map(|(prim, bounds)| Entry { bounds, prim }).collect();
        let n = entries.len() as u32;
        let root = KdNode {
            bounds: Aabb::empty(),
            split: 0.0,
            axis: 0,
            level: 0,
            first_child: 0,
            parent: 0,
            first: 0,
            count: n,
        };
        let mut nodes = vec![root];
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
                None => entries[node.first as usize..(node.first + node.count) as usize]
                    .iter()
                    .fold(Aabb::empty(), |b, e| b.union(e.bounds)),
            };
        }
        Some(Self { nodes, order: entries.iter().map(|e| e.prim).collect() })
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
    pub fn range(&self, node: NodeId) -> Range<usize> {
        let n = &self.nodes[node.at()];
        n.first as usize..(n.first + n.count) as usize
    }
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
    fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<KdNode<S::Vector>>() + self.order.len() * size_of::<PrimId>()
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
