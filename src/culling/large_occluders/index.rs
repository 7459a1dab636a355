//! What is built once: the kD-tree, the occluders, which of them each place chooses, and the detail objects.
//!
//! Coorg and Teller 1997, Sections 3.1, 3.2 and 4. In this order: 1. the kD-tree over all primitives; 2. the
//! polygons of the scene as occluders; 3. for each leaf and direction those that look largest, or the same
//! from saved bytes; 4. of all occluders those that some list names; 5. the objects that are small.

use std::ops::Range;
use std::sync::Arc;

use super::memory::Owner;
use super::occluders::Occluders;
use super::selection::Selection;
use super::space::Shape;
use super::{Params, saved};
use crate::geometry::{Aabb, NodeId, ObjectId, PrimId, Space};
use crate::index::{Hierarchy, KdTree};
use crate::scene::{Part, Progress, Scene};

/// What is built once: the kD-tree, the occluders that any place can choose, and which each chooses.
#[derive(Clone, Debug)]
pub struct Index<S: Shape> {
    pub tree: KdTree<S::Vector>,
    pub occluders: Occluders<S>,
    pub selection: Selection,
    /// Bounds of each object that is small enough to be tested as a whole.
    pub details: Vec<Option<Aabb<S::Vector>>>,
    /// The tree's primitives, those of a leaf sorted by object; and where each run of one object begins.
    by_object: Vec<PrimId>,
    runs: Vec<(u32, ObjectId)>,
    /// The selection with the numbers that all polygons of the scene have, to be saved.
    saved: Arc<[u8]>,
}

impl Params {
    fn key<S: Space>(&self, scene: &Scene<S>) -> saved::Key {
        // What the lists depend on. The other parameters change only what a frame does with them.
        saved::Key {
            scene: scene.hash_hex(),
            params: [self.tree_height, self.directions, self.occluders, self.marginal_gain],
        }
    }
}

/// The most that a detail object measures, as a share of the scene's diagonal. Section 3.2 takes objects for
/// points, "usually limited in spatial extent": an occluder that looks large from the center then looks
/// large from all of it. Of a building's diagonal it is a piece of furniture, of a city's a house.
const DETAIL_SHARE: f32 = 0.05;
/// The fewest primitives that are worth a test of their own: a test reads some occluders' edges, drawing a
/// primitive or two costs less.
const DETAIL_PRIMS: u32 = 4;

impl<S: Shape> Index<S> {
    /// Builds it, with the selection out of `saved` bytes if there are any. `Ok(None)` when cancelled.
    ///
    /// # Errors
    /// Why the bytes do not fit the scene and the parameters.
    pub fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, String> {
        // 1.
        progress.report(0.0, "building the kD-tree");
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        let Some(tree) = KdTree::build(boxes, params.tree_height, || progress.cancelled()) else {
            return Ok(None);
        };
        // 2. Polygons, not primitives: a wall of two triangles hides what neither of them does.
        let Some(faces) = S::polygons(scene, &Part { whole: progress, start: 0.1, length: 0.3 }) else {
            return Ok(None);
        };
        let all = Occluders::<S>::new(scene.points(), &faces);
        // 3. By far the longest step, so its result is what is saved: with the numbers that all polygons
        // have, which do not depend on the selection.
        let rest = Part { whole: progress, start: 0.4, length: 0.55 };
        let gain = f64::from(params.marginal_gain) / 100.0;
        let made = match saved {
            Some(bytes) => Some(saved::read(bytes, &params.key(scene), tree.nodes().len(), all.len())?),
            None => Selection::new(&tree, &all, [params.directions, params.occluders], gain, &rest),
        };
        let Some(selection) = made else { return Ok(None) };
        let saved = saved::write(&params.key(scene), &selection);
        // 4. Only what some list names can ever be active: of many polygons a few, which stay in the cache.
        let kept = selection.named();
        let faces: Vec<_> = kept.iter().map(|&id| faces[all.get(id).source as usize].clone()).collect();
        let occluders = Occluders::<S>::new(scene.points(), &faces);
        // 5.
        let (by_object, runs) = runs(scene, &tree);
        let selection = selection.renumbered(&kept);
        Ok(Some(Self {
            tree,
            occluders,
            selection,
            details: details(scene),
            by_object,
            runs,
            saved: saved.into(),
        }))
    }
    /// The primitives at and below a node, object by object within each leaf.
    pub fn objects_of(&self, node: NodeId) -> impl Iterator<Item = (ObjectId, &[PrimId])> {
        // The leaves below a node lie side by side, and so do their runs: two searches find the ends.
        let range = self.tree.range(node);
        let start = |i: usize| self.runs.get(i).map_or(self.by_object.len(), |r| r.0 as usize);
        let first = self.runs.partition_point(|r| (r.0 as usize) < range.start);
        let last = self.runs.partition_point(|r| (r.0 as usize) < range.end);
        (first..last).map(move |i| (self.runs[i].1, &self.by_object[start(i)..start(i + 1)]))
    }
    /// The box that a test was about.
    pub fn bounds_of(&self, owner: Owner) -> Aabb<S::Vector> {
        match owner {
            Owner::Node(n) => self.tree.nodes()[n.at()].bounds,
            Owner::Object(o) => self.details[o.at()].unwrap_or(Aabb::empty()),
        }
    }
}

/// The tree's primitives with those of each leaf sorted by object, and the beginnings of the runs.
fn runs<S: Space>(scene: &Scene<S>, tree: &KdTree<S::Vector>) -> (Vec<PrimId>, Vec<(u32, ObjectId)>) {
    let mut order = tree.prims_below(NodeId(0)).to_vec();
    // Leaf by leaf in the order of their ranges, so that runs come out ascending; a node's range is a range
    // of runs, since it begins and ends with a leaf.
    let mut leaves: Vec<Range<usize>> = (0..tree.nodes().len())
        .filter(|&n| tree.nodes()[n].is_leaf())
        .map(|n| tree.range(NodeId(n as u32)))
        .collect();
    leaves.sort_unstable_by_key(|r| r.start);
    let mut runs = Vec::new();
    for leaf in leaves {
        order[leaf.clone()].sort_unstable_by_key(|&p| (scene.object_of(p), p));
        for at in leaf.clone() {
            let object = scene.object_of(order[at]);
            if at == leaf.start || scene.object_of(order[at - 1]) != object {
                runs.push((at as u32, object));
            }
        }
    }
    (order, runs)
}

/// Bounds of the objects that count as details (Section 3.2).
fn details<S: Space>(scene: &Scene<S>) -> Vec<Option<Aabb<S::Vector>>> {
    let mut found = vec![(0, Aabb::empty()); scene.objects().len()];
    for &prim in scene.live() {
        let (count, bounds) = &mut found[scene.object_of(prim).at()];
        *count += 1;
        *bounds = bounds.union(scene.prim_bounds(prim));
    }
    // Whole objects, also where only part of one survives: it is tested once a frame.
    let most = scene.bounds().diagonal() * DETAIL_SHARE;
    found
        .into_iter()
        .map(|(count, bounds)| (count >= DETAIL_PRIMS && bounds.diagonal() <= most).then_some(bounds))
        .collect()
}

impl<S: Shape> Hierarchy<S> for Index<S> {
    fn node_count(&self) -> usize {
        self.tree.nodes().len()
    }
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector> {
        self.tree.nodes()[node.at()].bounds
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
        self.tree.prims_below(node)
    }
    fn save(&self) -> Option<Vec<u8>> {
        Some(self.saved.to_vec())
    }
    fn bytes(&self) -> usize {
        Hierarchy::<S>::bytes(&self.tree)
            + self.occluders.bytes()
            + self.selection.bytes()
            + self.details.len() * size_of::<Option<Aabb<S::Vector>>>()
            + self.by_object.len() * size_of::<PrimId>()
            + self.runs.len() * size_of::<(u32, ObjectId)>()
    }
}
