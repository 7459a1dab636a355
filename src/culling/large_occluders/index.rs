//! What is built once: the kD-tree, the occluders, which of them each place chooses, and the detail objects.
//!
//! Coorg and Teller 1997, Sections 3.1, 3.2 and 4. In this order: 1. the kD-tree over all primitives; 2. the
//! polygons of the scene as occluders; 3. for each leaf and direction those that look largest, or the same
//! from saved bytes; 4. of all occluders those that some list names, and the largest, for an Eye outside; 5.
//! the objects that are small.

use std::ops::Range;
use std::sync::Arc;

use super::memory::{Memory, Owner};
use super::occluders::Occluders;
use super::ranking::Ranking;
use super::selection::{Selection, Wanted};
use super::space::Shape;
use super::{Params, saved};
use crate::geometry::{Aabb, NodeId, ObjectId, PrimId, Space};
use crate::index::{Hierarchy, KdTree};
use crate::scene::{Face, Part, Progress, Scene};

/// What is built once: the kD-tree, the occluders that any place can choose, and which each chooses.
#[derive(Clone, Debug)]
pub struct Index<S: Shape> {
    pub tree: KdTree<S::Vector>,
    pub occluders: Occluders<S>,
    /// The occluders by area-angle from any point, for an Eye that is in no leaf.
    pub ranking: Ranking<S::Vector>,
    pub selection: Selection,
    /// Bounds of each object that is small enough to be tested as a whole.
    pub details: Vec<Option<Aabb<S::Vector>>>,
    /// The occluders that move, with the faces that they are made of.
    moving: Vec<(u32, Face)>,
    /// Where the runs of one object begin in the two lists of the tree, whose nodes sort them by object.
    runs: [Vec<(u32, ObjectId)>; 2],
    /// The selection with the numbers that all polygons of the scene have, to be saved.
    saved: Arc<[u8]>,
}

impl Params {
    fn key<S: Space>(&self, scene: &Scene<S>) -> saved::Key {
        // What the lists depend on. The other parameters change only what a frame does with them.
        saved::Key {
            scene: scene.hash_hex(),
            params: [
                self.levels(scene),
                self.cells.into(),
                self.directions,
                self.occluders,
                self.marginal_gain,
                u32::from(self.surfaces.one_sided) | u32::from(self.surfaces.solid) << 1,
            ],
        }
    }
    /// Levels of the kD-tree.
    fn levels<S: Space>(&self, scene: &Scene<S>) -> u32 {
        if self.tree_height > 0 {
            return self.tree_height;
        }
        (scene.live().len().div_ceil(LEAF_PRIMS).max(1).ilog2() + 1).min(MOST_LEVELS)
    }
    fn wanted(&self) -> Wanted {
        Wanted {
            directions: self.directions,
            most: self.occluders,
            gain: f64::from(self.marginal_gain) / 100.0,
            one_sided: self.surfaces.one_sided,
        }
    }
    fn tree<S: Space>(&self, scene: &Scene<S>, progress: &dyn Progress) -> Option<KdTree<S::Vector>> {
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        let (levels, cancelled) = (self.levels(scene), || progress.cancelled());
        let mut tree = if self.cells {
            KdTree::build_cells(boxes, levels, &cancelled)?
        } else {
            KdTree::build(boxes, levels, cancelled)?
        };
        // Runs of one object are decided together.
        tree.sort_lists(|p| (scene.object_of(p), p));
        tree.refit(scene);
        Some(tree)
    }
}

/// Primitives of a leaf where the height of the tree is chosen by the scene, and how high that may be.
const LEAF_PRIMS: usize = 32;
const MOST_LEVELS: u32 = 14;
/// How many of the largest occluders are kept for an Eye outside of the scene's box, which no list serves.
const LARGEST: usize = 2048;
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
        let Some(tree) = params.tree(scene, progress) else { return Ok(None) };
        // 2. Polygons, not primitives: a wall of two triangles hides what neither of them does.
        let part = Part { whole: progress, start: 0.1, length: 0.3 };
        let Some(faces) = S::polygons(scene, params.surfaces, &part) else { return Ok(None) };
        let all = Occluders::<S>::new(scene.points(), &faces);
        // 3. By far the longest step, so its result is what is saved: with the numbers that all polygons
        // have, which do not depend on the selection.
        let rest = Part { whole: progress, start: 0.4, length: 0.55 };
        let made = match saved {
            Some(bytes) => Some(saved::read::<S>(bytes, &params.key(scene), tree.nodes().len(), all.len())?),
            None => Selection::new(&tree, &all, &params.wanted(), &rest),
        };
        let Some(selection) = made else { return Ok(None) };
        let saved = saved::write(&params.key(scene), &selection);
        // 4. Only what some list names can ever be active within the scene: of many polygons a few, which
        // stay in the cache.
        let mut kept = selection.named();
        kept.extend(largest(&all));
        kept.sort_unstable();
        kept.dedup();
        let faces: Vec<_> = kept.iter().map(|&id| faces[all.get(id).source as usize].clone()).collect();
        let occluders = Occluders::<S>::new(scene.points(), &faces);
        let Some(ranking) = Ranking::new(&occluders, || progress.cancelled()) else { return Ok(None) };
        let selection = selection.renumbered(&kept);
        let runs = runs(scene, &tree);
        // All primitives of a face are of one object, or of objects that stand still.
        let moves = |id: u32| occluders.prims(id).iter().any(|p| scene.is_moving(*p));
        let face = |id: u32| faces[occluders.get(id).source as usize].clone();
        let ids = 0..occluders.len() as u32;
        let moving = if scene.moving().is_empty() {
            vec![]
        } else {
            ids.filter(|id| moves(*id)).map(|id| (id, face(id))).collect()
        };
        // 5.
        let details = details(scene);
        Ok(Some(Self { tree, occluders, ranking, selection, details, moving, runs, saved: saved.into() }))
    }
    /// Goes over to another frame of the scene: the tree keeps its planes and each place its list of
    /// occluders, which only says where to look; boxes and occluders are where they are now, and of the
    /// memory stays what is still true. False if an occluder has lost its area; then nothing of it may be
    /// used.
    pub fn follow(&mut self, scene: &Scene<S>, memory: &mut Memory<S>) -> bool {
        if !self.occluders.follow(scene.points(), &self.moving) {
            return false;
        }
        if !self.moving.is_empty()
            && let Some(ranking) = Ranking::new(&self.occluders, || false)
        {
            self.ranking = ranking;
        }
        let mut moved: Vec<ObjectId> = scene.moving().iter().map(|p| scene.object_of(*p)).collect();
        moved.dedup();
        for object in &moved {
            self.details[object.at()] = self.details[object.at()].map(|_| Aabb::empty());
        }
        for &prim in scene.moving() {
            if let Some(bounds) = &mut self.details[scene.object_of(prim).at()] {
                *bounds = bounds.union(scene.prim_bounds(prim));
            }
        }
        let occluders: Vec<u32> = self.moving.iter().map(|(id, _)| *id).collect();
        memory.follow(self.tree.refit(scene), &moved, &occluders);
        true
    }
    /// The primitives that a node has for itself, object by object.
    pub fn own(&self, node: NodeId) -> impl Iterator<Item = (ObjectId, &[PrimId])> {
        self.runs_of(0, self.tree.own(node))
    }
    /// Those of nodes above that reach into a leaf, object by object.
    pub fn shared(&self, node: NodeId) -> impl Iterator<Item = (ObjectId, &[PrimId])> {
        self.runs_of(1, self.tree.shared(node))
    }
    fn runs_of(&self, list: usize, range: Range<usize>) -> impl Iterator<Item = (ObjectId, &[PrimId])> {
        // What a node lists begins with a run and ends with one: two searches find the ends.
        let (runs, prims) = (&self.runs[list][..], self.tree.lists()[list]);
        let start = move |i: usize| runs.get(i).map_or(prims.len(), |r| r.0 as usize);
        let first = runs.partition_point(|r| (r.0 as usize) < range.start);
        let last = runs.partition_point(|r| (r.0 as usize) < range.end);
        (first..last).map(move |i| (runs[i].1, &prims[start(i)..start(i + 1)]))
    }
    /// The box that a test was about.
    pub fn bounds_of(&self, owner: Owner) -> Aabb<S::Vector> {
        match owner {
            Owner::Node(n) => self.tree.nodes()[n.at()].bounds,
            Owner::Object(o) => self.details[o.at()].unwrap_or(Aabb::empty()),
        }
    }
}

/// The numbers of the largest occluders, in no order that matters.
fn largest<S: Shape>(all: &Occluders<S>) -> Vec<u32> {
    let mut ids: Vec<u32> = (0..all.len() as u32).collect();
    let larger = |a: &u32, b: &u32| all.get(*b).area.total_cmp(&all.get(*a).area).then(a.cmp(b));
    if ids.len() > LARGEST {
        ids.select_nth_unstable_by(LARGEST, larger);
        ids.truncate(LARGEST);
    }
    ids
}

/// Where the runs of one object begin in the tree's lists, which are sorted by object node by node.
fn runs<S: Space>(scene: &Scene<S>, tree: &KdTree<S::Vector>) -> [Vec<(u32, ObjectId)>; 2] {
    let nodes = || (0..tree.nodes().len() as u32).map(NodeId);
    let of = |prims: &[PrimId], mut ranges: Vec<Range<usize>>| {
        ranges.sort_unstable_by_key(|r| r.start);
        let mut runs: Vec<(u32, ObjectId)> = Vec::new();
        for range in ranges {
            for at in range.clone() {
                let object = scene.object_of(prims[at]);
                if at == range.start || scene.object_of(prims[at - 1]) != object {
                    runs.push((at as u32, object));
                }
            }
        }
        runs
    };
    let [order, shared] = tree.lists();
    [of(order, nodes().map(|n| tree.own(n)).collect()), of(shared, nodes().map(|n| tree.shared(n)).collect())]
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
    fn held(&self, node: NodeId) -> usize {
        Hierarchy::<S>::held(&self.tree, node)
    }
    fn save(&self) -> Option<Vec<u8>> {
        Some(self.saved.to_vec())
    }
    fn bytes(&self) -> usize {
        Hierarchy::<S>::bytes(&self.tree)
            + self.occluders.bytes()
            + self.ranking.bytes::<S>()
            + self.selection.bytes()
            + self.details.len() * size_of::<Option<Aabb<S::Vector>>>()
            + self
                .moving
                .iter()
                .map(|(_, f)| size_of::<Face>() + 4 * (f.corners.len() + f.prims.len()))
                .sum::<usize>()
            + self.runs.iter().map(|r| r.len() * size_of::<(u32, ObjectId)>()).sum::<usize>()
    }
}
