//! Spatial indexes: built once, then frozen but for the boxes of what moves.

mod cell_tree;
mod delaunay;
mod items;
mod kd_tree;
mod moving;
mod octree;
pub mod tessellation;
#[cfg(test)]
mod tests;
mod whole;

pub use cell_tree::{CellNode, CellTree, octants_touched};
pub use delaunay::{Delaunay, Tetrahedron};
pub use items::Items;
pub use kd_tree::{KdNode, KdTree};
pub use octree::{Octree, OctreeNode, Redistribution, Shape, octant_of};
pub use whole::Whole;

use std::ops::Range;

use crate::geometry::{Aabb, NodeId, PrimId, Space};

/// A frozen tree of boxes over the primitives of a scene, as stepping and drawing see it.
///
/// 1. Node 0 is the root, on level 0. Every other node has one parent, of a smaller id, on the level above.
/// 2. The root lists every live primitive once. The children of a node list primitives of that node, and no
///    two children the same one.
/// 3. The bounds of a node hold those of its children and all primitives that it lists.
///
/// [`Hierarchy::fault`] checks all of it.
pub trait Hierarchy<S: Space>: Send + Sync {
    /// Number of nodes, at least 1.
    fn node_count(&self) -> usize;
    /// Bounds of everything at and below a node.
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector>;
    /// Parent, or `None` for the root.
    fn parent(&self, node: NodeId) -> Option<NodeId>;
    /// Ids of the children; empty for a leaf.
    fn children(&self, node: NodeId) -> Range<u32>;
    /// Depth below the root, which is 0.
    fn level(&self, node: NodeId) -> u32;
    /// The primitives that lie wholly at and below a node: deciding the node decides them.
    fn prims(&self, node: NodeId) -> &[PrimId];
    /// How many primitives meet a node, more than `prims` where nodes share some.
    fn held(&self, node: NodeId) -> usize {
        self.prims(node).len()
    }
    /// The edges of a node that is no box; those of a polygon run around it. `None` for a box.
    fn edges(&self, _: NodeId) -> Option<Vec<[S::Vector; 2]>> {
        None
    }
    /// Bytes that the index takes.
    fn bytes(&self) -> usize;
    /// The part of it that took long to build, as bytes around which its method builds it again; `None` if
    /// none did.
    fn save(&self) -> Option<Vec<u8>> {
        None
    }

    /// What of the contract of this trait does not hold over these primitives (by ascending id, with their
    /// bounds), if anything. Cost: O(primitives · levels + nodes).
    fn fault(&self, prims: &[(PrimId, Aabb<S::Vector>)]) -> Option<String> {
        fault_of_nodes(self).or_else(|| fault_of_lists(self, prims)).or_else(|| fault_of_bounds(self, prims))
    }
}

fn nodes<S: Space>(index: &(impl Hierarchy<S> + ?Sized)) -> impl Iterator<Item = NodeId> {
    (0..index.node_count() as u32).map(NodeId)
}

/// 1. Parents, children and levels.
fn fault_of_nodes<S: Space>(index: &(impl Hierarchy<S> + ?Sized)) -> Option<String> {
    let count = index.node_count();
    if count == 0 || index.parent(NodeId(0)).is_some() || index.level(NodeId(0)) != 0 {
        return Some("node 0 is no root".into());
    }
    // Each node is listed by its parent alone, so that many mentions are one of each.
    let mut mentions = 0;
    for node in nodes(index) {
        for child in index.children(node).map(NodeId) {
            mentions += 1;
            if child <= node || child.at() >= count {
                return Some(format!("{node} cannot be the parent of {child}"));
            }
            if index.parent(child) != Some(node) || index.level(child) != index.level(node) + 1 {
                return Some(format!("{child} does not know that it is a child of {node}"));
            }
        }
    }
    (mentions != count - 1).then(|| format!("{mentions} of {count} nodes are children"))
}

/// 2. Which node lists which primitives.
fn fault_of_lists<S: Space>(
    index: &(impl Hierarchy<S> + ?Sized),
    prims: &[(PrimId, Aabb<S::Vector>)],
) -> Option<String> {
    let mut listed = index.prims(NodeId(0)).to_vec();
    listed.sort_unstable();
    if !listed.iter().eq(prims.iter().map(|(prim, _)| prim)) {
        return Some("the root does not list every primitive once".into());
    }
    // The last node whose list each primitive was found in. A child takes its primitives over, so one that a
    // sibling has taken, or the parent lacks, is not found.
    let mut holder = vec![None; listed.last().map_or(0, |last| last.at() + 1)];
    for node in nodes(index) {
        index.prims(node).iter().for_each(|prim| holder[prim.at()] = Some(node));
        for child in index.children(node).map(NodeId) {
            for prim in index.prims(child) {
                if holder.get(prim.at()) != Some(&Some(node)) {
                    return Some(format!("{child} lists {prim}, which {node} lacks or another child lists"));
                }
                holder[prim.at()] = Some(child);
            }
        }
        if index.held(node) < index.prims(node).len() {
            return Some(format!("{node} lists more primitives than meet it"));
        }
    }
    None
}

/// 3. What the bounds hold. The lists are sound.
fn fault_of_bounds<S: Space>(
    index: &(impl Hierarchy<S> + ?Sized),
    prims: &[(PrimId, Aabb<S::Vector>)],
) -> Option<String> {
    let of = |prim: &PrimId| prims.binary_search_by_key(prim, |(id, _)| *id).ok().map(|at| prims[at].1);
    for node in nodes(index) {
        let bounds = index.bounds(node);
        let outside = |inner: &Aabb<S::Vector>| !inner.is_empty() && !bounds.encloses(inner);
        if let Some(child) = index.children(node).find(|c| outside(&index.bounds(NodeId(*c)))) {
            return Some(format!("the bounds of {node} do not hold those of {child}"));
        }
        if let Some(prim) = index.prims(node).iter().find(|p| of(p).is_none_or(|b| outside(&b))) {
            return Some(format!("the bounds of {node} do not hold {prim}"));
        }
    }
    None
}
