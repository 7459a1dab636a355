//! What is built once: the tree of cells, and the faces of each cell's color cube.

use std::ops::Range;
use std::sync::Arc;

use super::costs::pays;
use super::faces::{Baked, Baking};
use super::saved;
use super::space::Projected;
use super::{Params, Primitives};
use crate::geometry::{Aabb, NodeId, PrimId, Space, Vector};
use crate::index::{CellTree, Hierarchy, Items};
use crate::raster::{Clusters, CubeFaces};
use crate::scene::{Part, Progress, Scene};

/// The tree of cells with the faces of their color cubes.
#[derive(Debug)]
pub struct CubeTree<S: Space> {
    tree: CellTree<S::Vector>,
    /// Of each node.
    baked: Baked,
    /// Of each node: where it pays to look below it.
    pays: Vec<u8>,
    /// What hides cells, where that is asked.
    occluders: Option<Occluders<S::Vector>>,
    key: saved::Key,
}

/// What is needed to find cells that are hidden.
#[derive(Debug)]
pub struct Occluders<V> {
    /// Of each node two groups, which leaves alone have: what no other leaf holds, and the rest.
    pub clusters: Arc<Clusters>,
    /// Of each node the box of its cell and of all primitives that meet it, as wholes.
    pub wholes: Vec<Aabb<V>>,
}

impl<V: Vector> Occluders<V> {
    fn new<S: Projected<Vector = V>>(scene: &Scene<S>, params: &Params, tree: &CellTree<V>) -> Self {
        let groups = tree.nodes().iter().enumerate().flat_map(|(at, node)| {
            let (own, shared) =
                if node.is_leaf() { tree.of_leaf(NodeId(at as u32)) } else { Default::default() };
            [own, shared]
        });
        let clusters = Arc::new(Clusters::new(scene, params.surfaces, groups));
        let mut wholes = vec![Aabb::empty(); tree.nodes().len()];
        // Children have higher numbers.
        for (at, node) in tree.nodes().iter().enumerate().rev() {
            let id = NodeId(at as u32);
            wholes[at] = if node.is_leaf() {
                let held = tree.references(id).iter().map(|prim| scene.prim_bounds(*prim));
                held.fold(tree.cell(id), |whole, bounds| whole.union(bounds))
            } else {
                let below = node.children().map(|child| wholes[child as usize]);
                below.fold(tree.cell(id), |whole: Aabb<V>, child| whole.union(child))
            };
        }
        Self { clusters, wholes }
    }
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
        let (key, items) = (saved::key(scene, params), items(scene, params));
        if let Some(bytes) = saved {
            let (tree, baked) = saved::read(bytes, &key, scene, items)?;
            return Ok(Some(Self::of(scene, params, (tree, baked), key)));
        }
        progress.report(0.0, "dividing cells");
        let (levels, cancelled) = (params.tree_levels, || progress.cancelled());
        let tree = CellTree::build(scene, items, levels, &is_small::<S>(params.cube_cost), &cancelled);
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
            is_analytic: params.is_analytic(),
            composes: params.composes(),
        };
        let part = Part { whole: progress, start: 0.5, length: 0.5 };
        let baked = baking.bake(&tree, params.measures(), &part)?;
        Some(Self::of(scene, params, (tree, baked), saved::key(scene, params)))
    }
    /// What follows from the tree is made anew, and not kept.
    fn of(
        scene: &Scene<S>,
        params: &Params,
        (tree, baked): (CellTree<S::Vector>, Baked),
        key: saved::Key,
    ) -> Self {
        let occluders = params.hides().then(|| Occluders::new(scene, params, &tree));
        let excess: Vec<f32> = baked.errors.iter().map(|error| error * params.inverse_most_error()).collect();
        Self { pays: pays(&tree, scene, &excess), tree, baked, occluders, key }
    }
}

/// What the tree refers to.
pub fn items<S: Space>(scene: &Scene<S>, params: &Params) -> Items {
    match params.primitives {
        Primitives::Triangles => Items::default(),
        Primitives::Objects => Items::objects(scene),
    }
}

/// Section 4: a leaf is small enough when its primitives cost no more than the cubes of the children that it
/// would have. Of a cube three faces at most face the eye, in flatland two. `cost`: of a cube, beside that of
/// the primitives of these.
pub fn is_small<S: Projected>(cost: f32) -> impl Fn(f64, u32) -> bool {
    let cost = f64::from(cost) * f64::from(S::CUBE_COST);
    move |shares, children| shares <= cost * f64::from(children)
}

impl<S: Space> CubeTree<S> {
    /// The tree of cells.
    pub fn tree(&self) -> &CellTree<S::Vector> {
        &self.tree
    }
    /// What hides cells; `None` where nobody asks.
    pub fn occluders(&self) -> Option<&Occluders<S::Vector>> {
        self.occluders.as_ref()
    }
    /// The deepest level whose cells must be no larger than the threshold, for it to be no loss to look below
    /// a node; 0 if it always is one.
    #[inline]
    pub fn pays_from(&self, node: NodeId) -> u8 {
        self.pays[node.at()]
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
        let occluders = self.occluders.as_ref().map_or(0, |o| o.clusters.bytes() + size_of_val(&*o.wholes));
        let Baked { faces, errors } = &self.baked;
        self.tree.bytes() + size_of_val(&**faces) + size_of_val(&**errors) + self.pays.len() + occluders
    }
    fn save(&self) -> Option<Vec<u8>> {
        Some(saved::write(&self.key, &self.tree, &self.baked))
    }
}
