//! The leaves of the occluder database, as preprocesses read them.

use crate::geometry::{NodeId, PrimId, Space};
use crate::index::KdTree;
use crate::scene::Scene;

/// A scene with its tree.
pub(crate) struct Leaves<'a, S: Space> {
    pub scene: &'a Scene<S>,
    pub tree: &'a KdTree<S::Vector>,
    /// For each node whether it, or some leaf below it, is in the occluder database.
    pub occluders: &'a [bool],
}

impl<S: Space> Leaves<'_, S> {
    /// Whether a node is a leaf of the database.
    pub fn is_one(&self, node: NodeId) -> bool {
        self.tree.nodes().get(node.at()).is_some_and(|n| n.is_leaf()) && self.occluders[node.at()]
    }
    /// All, ascending.
    pub fn all(&self) -> impl Iterator<Item = NodeId> {
        (0..self.tree.nodes().len() as u32).map(NodeId).filter(|&node| self.is_one(node))
    }
    /// What a leaf holds.
    pub fn prims(&self, leaf: NodeId) -> &[PrimId] {
        self.tree.prims_below(leaf)
    }
    /// Of each primitive the leaf of the database that holds it.
    pub fn of_prims(&self) -> Vec<Option<NodeId>> {
        let mut leaf_of = vec![None; self.scene.prim_count()];
        for leaf in self.all() {
            self.prims(leaf).iter().for_each(|p| leaf_of[p.at()] = Some(leaf));
        }
        leaf_of
    }
}
