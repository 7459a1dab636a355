//! The index of methods that use none: one node that holds the scene.

use std::ops::Range;
use std::sync::Arc;

use super::Hierarchy;
use crate::geometry::{Aabb, NodeId, PrimId, Space};
use crate::scene::Scene;

/// A single node over all live primitives.
pub struct Whole<S: Space> {
    scene: Arc<Scene<S>>,
}

impl<S: Space> Whole<S> {
    /// The scene as one node.
    pub fn new(scene: Arc<Scene<S>>) -> Self {
        Self { scene }
    }
}

impl<S: Space> Hierarchy<S> for Whole<S> {
    fn node_count(&self) -> usize {
        1
    }
    fn bounds(&self, _: NodeId) -> Aabb<S::Vector> {
        self.scene.bounds()
    }
    fn parent(&self, _: NodeId) -> Option<NodeId> {
        None
    }
    fn children(&self, _: NodeId) -> Range<u32> {
        0..0
    }
    fn level(&self, _: NodeId) -> u32 {
        0
    }
    fn prims(&self, _: NodeId) -> &[PrimId] {
        self.scene.live()
    }
    fn bytes(&self) -> usize {
        size_of::<Self>()
    }
}
