//! What is built once: the octree (Georges 1995, Section 3.1), and what its cubes hold, ready to be drawn
//! into tiles.

use std::ops::Range;
use std::sync::Arc;

use super::Params;
use crate::geometry::{Aabb, NodeId, PrimId, Space};
use crate::index::{Hierarchy, Octree};
use crate::raster::{Clusters, Drawable};
use crate::scene::{Progress, Scene};

/// An octree with the clusters of its cubes.
#[derive(Clone)]
pub struct CubeIndex<S: Space> {
    octree: Octree<S::Vector>,
    clusters: Arc<Clusters>,
}

impl<S: Drawable> CubeIndex<S> {
    /// Builds it; `None` when cancelled.
    pub fn build(scene: &Scene<S>, params: &Params, progress: &dyn Progress) -> Option<Self> {
        let octree = params.cubes.build(scene, progress)?;
        progress.report(0.5, "making clusters");
        let clusters = clusters(scene, params, &octree);
        (!progress.cancelled()).then_some(Self { octree, clusters })
    }
    /// Goes over to another frame of the scene: the cubes stay, with the bounds of what they hold now.
    pub fn follow(&mut self, scene: &Scene<S>) {
        self.octree.refit(scene);
        Arc::make_mut(&mut self.clusters).follow(scene);
    }
    /// The tree.
    pub fn octree(&self) -> &Octree<S::Vector> {
        &self.octree
    }
    /// What its cubes hold: for each in turn what is its own, then what it shares with others.
    pub fn clusters(&self) -> &Arc<Clusters> {
        &self.clusters
    }
}

fn clusters<S: Drawable>(scene: &Scene<S>, params: &Params, octree: &Octree<S::Vector>) -> Arc<Clusters> {
    let nodes = (0..octree.nodes().len() as u32).map(NodeId);
    // What is a cube's own apart from what it shares, which may be drawn already.
    let groups = nodes.flat_map(|node| [octree.own(node), octree.shared(node)]);
    Arc::new(Clusters::new(scene, params.surfaces, groups))
}

/// As a tree it is the octree.
impl<S: Space> Hierarchy<S> for CubeIndex<S> {
    fn node_count(&self) -> usize {
        Hierarchy::<S>::node_count(&self.octree)
    }
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector> {
        Hierarchy::<S>::bounds(&self.octree, node)
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        Hierarchy::<S>::parent(&self.octree, node)
    }
    fn children(&self, node: NodeId) -> Range<u32> {
        Hierarchy::<S>::children(&self.octree, node)
    }
    fn level(&self, node: NodeId) -> u32 {
        Hierarchy::<S>::level(&self.octree, node)
    }
    fn prims(&self, node: NodeId) -> &[PrimId] {
        Hierarchy::<S>::prims(&self.octree, node)
    }
    fn held(&self, node: NodeId) -> usize {
        Hierarchy::<S>::held(&self.octree, node)
    }
    fn bytes(&self) -> usize {
        Hierarchy::<S>::bytes(&self.octree) + self.clusters.bytes()
    }
}
