//! Spatial indexes: built once, then frozen.

mod delaunay;
mod kd_tree;
mod octree;
pub mod tessellation;
mod whole;

pub use delaunay::{Delaunay, Tetrahedron};
pub use kd_tree::{KdNode, KdTree};
pub use octree::{Octree, OctreeNode, Redistribution, Shape};
pub use whole::Whole;

use std::ops::Range;

use crate::geometry::{Aabb, NodeId, PrimId, Space};

/// A frozen tree of boxes over the primitives of a scene, as stepping and drawing see it.
/// Parents have smaller ids than their children; the root is node 0.
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
    /// All primitives at and below a node.
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
}
