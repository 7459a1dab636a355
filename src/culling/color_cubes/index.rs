//! What is built once: the tree of cells, and the faces of each cell's color cube.

use std::ops::Range;

use super::Params;
use super::faces::{Baked, Baking};
use super::saved;
use super::space::Projected;
use crate::geometry::{Aabb, NodeId, PrimId, Space};
use crate::index::{CellTree, Hierarchy};
use crate::raster::CubeFaces;
use crate::scene::{Part, Progress, Scene};

/// The tree of cells with the faces of their color cubes.
#[derive(Debug)]
pub struct CubeTree<S: Space> {
    tree: CellTree<S::Vector>,
    /// Of each node.
    baked: Baked,
    /// How many primitives are in no leaf above each level.
    deep: Vec<u32>,
    key: saved::Key,
}

impl<S: Projected> CubeTree<S> {
    /// Builds it, or reads it from the bytes of [`Hierarchy::save`]; `Ok(None)` when cancelled.
    ///
    /// # Errors
    /// Why what was saved does not fit.
    pub fn build(
        scene: &Scene<S>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, String> {
        let key = saved::key(scene, params);
        if let Some(bytes) = saved {
            let (tree, baked) = saved::read(bytes, &key, scene)?;
            return Ok(Some(Self { deep: deep(&tree, scene), tree, baked, key }));
        }
        progress.report(0.0, "dividing cells");
        let tree = CellTree::build(scene, params.tree_levels, &is_small::<S>, &|| progress.cancelled());
        Ok(tree.and_then(|tree| Self::of_tree(tree, scene, params, progress)))
    }
    /// Makes the cubes of a tree over the scene; `None` when cancelled.
    pub fn of_tree(
        tree: CellTree<S::Vector>,
        scene: &Scene<S>,
        params: &Params,
        progress: &dyn Progress,
    ) -> Option<Self> {
        let baking = Baking {
            scene,
            surfaces: params.surfaces,
            side: params.face_samples,
            composes: params.composes(),
        };
        let part = Part { whole: progress, start: 0.5, length: 0.5 };
        let baked = baking.bake(&tree, params.measures(), &part)?;
        Some(Self { deep: deep(&tree, scene), tree, baked, key: saved::key(scene, params) })
    }
}

/// How many primitives are in no leaf above each level.
fn deep<S: Space>(tree: &CellTree<S::Vector>, scene: &Scene<S>) -> Vec<u32> {
    let levels = CellTree::<S::Vector>::MOST_LEVELS as usize;
    let mut highest = vec![levels as u8; scene.prim_count()];
    for (at, leaf) in tree.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()) {
        let held = tree.references(NodeId(at as u32));
        held.iter().for_each(|prim| highest[prim.at()] = highest[prim.at()].min(leaf.level));
    }
    let mut counts = vec![0; levels];
    // What is in no leaf at all does not exist.
    for level in highest.into_iter().map(usize::from).filter(|level| *level < levels) {
        counts[..=level].iter_mut().for_each(|count| *count += 1);
    }
    counts
}

/// Section 4: a leaf is small enough when its primitives cost no more than the cubes of the children that it
/// would have. Of a cube three faces at most face the eye, in flatland two.
pub fn is_small<S: Projected>(shares: f64, children: u32) -> bool {
    shares <= f64::from(S::CUBE_COST * children)
}

impl<S: Space> CubeTree<S> {
    /// The tree of cells.
    pub fn tree(&self) -> &CellTree<S::Vector> {
        &self.tree
    }
    /// Which part of all primitives is in no leaf above a level: what need not be drawn where cells of that
    /// level are drawn as cubes.
    pub fn share_below(&self, level: usize) -> f32 {
        self.deep.get(level).map_or(0.0, |count| *count as f32 / self.deep[0].max(1) as f32)
    }
    /// The faces of a cell's color cube.
    #[inline]
    pub fn faces(&self, node: NodeId) -> &CubeFaces {
        &self.baked.faces[node.at()]
    }
    /// How wrong it is, from where it is most so: 0 to 1. Nothing where that was not asked for.
    #[inline]
    pub fn error(&self, node: NodeId) -> Option<f32> {
        self.baked.errors.get(node.at()).copied()
    }
}

impl<S: Space> Hierarchy<S> for CubeTree<S> {
    fn node_count(&self) -> usize {
        Hierarchy::<S>::node_count(&self.tree)
    }
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector> {
        self.tree.cell(node)
    }
    fn parent(&self, node: NodeId) -> Option<NodeId> {
        Hierarchy::<S>::parent(&self.tree, node)
    }
    fn children(&self, node: NodeId) -> Range<u32> {
        Hierarchy::<S>::children(&self.tree, node)
    }
    fn level(&self, node: NodeId) -> u32 {
        Hierarchy::<S>::level(&self.tree, node)
    }
    fn prims(&self, node: NodeId) -> &[PrimId] {
        Hierarchy::<S>::prims(&self.tree, node)
    }
    fn held(&self, node: NodeId) -> usize {
        Hierarchy::<S>::held(&self.tree, node)
    }
    fn bytes(&self) -> usize {
        self.tree.bytes() + size_of_val(&*self.baked.faces) + size_of_val(&*self.baked.errors)
    }
    fn save(&self) -> Option<Vec<u8>> {
        Some(saved::write(&self.key, &self.tree, &self.baked))
    }
}
