//! What is built once: a hierarchy of boxes over the model, and the occluder database (Zhang et al. 1997,
//! Section 5.3.1), which is the same hierarchy without the leaves that make poor occluders.
//!
//! 1. The model's hierarchy is a kD-tree whose boxes hold each primitive once (Section 6.2: "an axis-aligned
//!    bounding box hierarchy").
//! 2. A leaf is no occluder if it is *small*, *redundant* or *complex*. It stays an occludee.
//! 3. What the leaves hold is made ready for tiles, in which occluders are drawn.
//! 4. So is what is drawn in their place, if anything is ([`super::stand_ins`], Section 8).
//! 5. With `selection=grid` it is looked at from the points of a grid ([`super::grid`], Section 5.3.2).
//!
//! Cost: O(n log n) time, and leaves × [`MOST_FACES`] for redundancy.

use std::ops::Range;
use std::sync::Arc;

use super::Params;
use super::grid::Grid;
use super::leaves::Leaves;
use super::saved::{self, Key};
use super::stand_ins::{Kind, StandIns};
use crate::geometry::{Aabb, NodeId, PrimId, Projection, Space, Vector, View};
use crate::index::{Hierarchy, KdTree};
use crate::raster::{Clusters, Drawable};
use crate::scene::{Face, Part, Progress, Scene};

/// How many leaves the database has, and how many it dropped, each by the first reason that held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Leaves that are occluders, and what they hold.
    pub kept: u32,
    pub kept_prims: u32,
    pub small: u32,
    pub redundant: u32,
    pub complex: u32,
}

/// The model's hierarchy, and its leaves that may be occluders.
#[derive(Clone)]
pub struct Databases<S: Space> {
    tree: KdTree<S::Vector>,
    /// Two groups for each node, and after all of them two for what stands in for each.
    clusters: Arc<Clusters>,
    /// For each node whether it, or some leaf below it, is in the occluder database.
    occluders: Vec<bool>,
    counts: Counts,
    stand_ins: Option<Arc<StandIns<S>>>,
    /// Whether leaves are drawn themselves; else what stands in for them, if there is anything.
    draws_leaves: bool,
    /// What is seen from the points of a grid, and what it was made for.
    grid: Option<Arc<(Grid<S::Vector>, Key)>>,
}

/// By what share of a face's diagonal something that it makes redundant stands before it at most.
const BEFORE: f32 = 0.02;
/// Faces that can make something redundant: so many of the largest.
pub const MOST_FACES: usize = 1000;
/// A leaf is complex if it has more than so many times the median of primitives for its size.
const COMPLEX: f32 = 8.0;

impl<S: Drawable> Databases<S> {
    /// Builds both, around saved lists if there are any; `Ok(None)` when cancelled.
    ///
    /// # Errors
    /// Why what was saved does not fit.
    pub fn build(
        scene: &Scene<S>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, String> {
        if saved.is_some() && !params.uses_grid() {
            return Err("only what selection=grid looks up is kept".into());
        }
        // Looking from many points takes the larger part of the time, so it gets that of the bar.
        let length = if params.uses_grid() { 0.2 } else { 1.0 };
        let Some(mut made) = Self::without_grid(scene, params, &Part { whole: progress, start: 0.0, length })
        else {
            return Ok(None);
        };
        if params.uses_grid() {
            let seen = Leaves { scene, tree: &made.tree, occluders: &made.occluders };
            let (grid, key) = (Grid::new(&scene.bounds(), params.grid), saved::key(scene, params));
            let rest = Part { whole: progress, start: length, length: 1.0 - length };
            let grid = match saved {
                Some(bytes) => Some(saved::read(bytes, &key, grid, &seen)?),
                None => grid.fill(&seen, params.surfaces, &rest),
            };
            let Some(grid) = grid else { return Ok(None) };
            made.grid = Some(Arc::new((grid, key)));
        }
        Ok(Some(made))
    }
    fn without_grid(scene: &Scene<S>, params: &Params, progress: &dyn Progress) -> Option<Self> {
        progress.report(0.0, "building the kD-tree");
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        let height = height(scene.live().len(), params.leaf_prims::<S>());
        let mut tree = KdTree::build(boxes, height, || progress.cancelled())?;
        tree.refit(scene);
        progress.report(0.3, "building the occluder database");
        let (occluders, counts) = database(scene, &tree, detail(scene, params), progress)?;
        let leaves = Leaves { scene, tree: &tree, occluders: &occluders };
        let (detail, part) = (detail(scene, params), Part { whole: progress, start: 0.6, length: 0.2 });
        let stand_ins =
            StandIns::new(params.occluders, &leaves, params.surfaces, detail, &part).map(Arc::new);
        progress.report(0.8, "making clusters");
        let clusters = clusters(scene, params, &tree, stand_ins.as_deref());
        let draws_leaves = params.occluders == Kind::Original;
        let made = Self { tree, clusters, occluders, counts, stand_ins, draws_leaves, grid: None };
        (!progress.cancelled()).then_some(made)
    }
    /// Goes over to another frame of the scene (Section 5.5): nodes keep what they hold, with new bounds, and
    /// leaves of the occluder database stay in it. The lists of a grid are of what stands still.
    pub fn follow(&mut self, scene: &Scene<S>, params: &Params) {
        self.tree.refit(scene);
        let Some(made) = &self.stand_ins else {
            return Arc::make_mut(&mut self.clusters).follow(scene);
        };
        let leaves = Leaves { scene, tree: &self.tree, occluders: &self.occluders };
        self.stand_ins = made.follow(&leaves, params.surfaces, detail(scene, params)).map(Arc::new);
        self.clusters = clusters(scene, params, &self.tree, self.stand_ins.as_deref());
    }
    /// The model's hierarchy.
    pub fn tree(&self) -> &KdTree<S::Vector> {
        &self.tree
    }
    /// What its leaves hold, two groups a node.
    pub fn clusters(&self) -> &Arc<Clusters> {
        &self.clusters
    }
    /// Whether a node is a leaf of the occluder database, or has one below it.
    pub fn has_occluders(&self, node: NodeId) -> bool {
        self.occluders[node.at()]
    }
    /// What stands in for occluders, if anything does.
    pub fn stand_ins(&self) -> Option<&StandIns<S>> {
        self.stand_ins.as_deref()
    }
    /// Bounds of what is drawn of a node as an occluder.
    pub fn occluder_bounds(&self, node: NodeId) -> &Aabb<S::Vector> {
        self.stand_ins().map_or(&self.tree.nodes()[node.at()].bounds, |made| made.bounds(node))
    }
    /// How many primitives are drawn of a leaf as an occluder; 0 where it is none.
    pub fn occluder_prims(&self, leaf: NodeId, view: &View<S>, projection: &Projection<S::Vector>) -> u32 {
        let may_stand_in =
            |made: &&StandIns<S>| !made.is_optional() || made.may_stand_in(leaf, view, projection);
        match self.stand_ins().filter(may_stand_in) {
            Some(made) => made.prims(leaf).len() as u32,
            None if self.draws_leaves => self.tree.prims_below(leaf).len() as u32,
            None => 0,
        }
    }
    /// The node whose groups are drawn where a leaf is an occluder: its own, or what stands in for it.
    pub fn drawn_for(&self, leaf: NodeId, view: &View<S>, projection: &Projection<S::Vector>) -> NodeId {
        match self.stand_ins() {
            Some(made) if made.may_stand_in(leaf, view, projection) => {
                NodeId(leaf.0 + self.tree.nodes().len() as u32)
            }
            _ => leaf,
        }
    }
    /// How many ids what is drawn has.
    pub fn drawn_count(&self, scene: &Scene<S>) -> usize {
        scene.prim_count() + self.stand_ins().map_or(0, |made| made.scene().prim_count())
    }
    /// What is seen from the points of a grid, if there is one.
    pub fn grid(&self) -> Option<&Grid<S::Vector>> {
        self.grid.as_ref().map(|made| &made.0)
    }
    /// What the database holds.
    pub fn counts(&self) -> Counts {
        self.counts
    }
}

/// What leaves hold, made ready for tiles. These are given two groups a node, of which the second is for what
/// nodes share: none does here. After these come as many for what stands in for nodes.
fn clusters<S: Drawable>(
    scene: &Scene<S>,
    params: &Params,
    tree: &KdTree<S::Vector>,
    stand_ins: Option<&StandIns<S>>,
) -> Arc<Clusters> {
    let groups = tree.nodes().iter().enumerate().flat_map(|(at, node)| {
        let own = if node.is_leaf() { tree.prims_below(NodeId(at as u32)) } else { &[] };
        [own, &[]]
    });
    let mut clusters = Clusters::new(scene, params.surfaces, groups);
    if let Some(made) = stand_ins {
        let groups = (0..tree.nodes().len() as u32).flat_map(|node| [made.prims(NodeId(node)), &[]]);
        clusters.extend(made.scene(), params.surfaces, groups, scene.prim_count() as u32);
    }
    Arc::new(clusters)
}

/// What is smaller is no occluder, world units.
fn detail<S: Space>(scene: &Scene<S>, params: &Params) -> f32 {
    scene.bounds().diagonal() * params.occluder_size as f32 * 1e-3
}

/// Levels of a tree whose leaves hold at most so many of `count` primitives.
fn height(count: usize, leaf: u32) -> u32 {
    let leaves = count.div_ceil(leaf.max(1) as usize).max(1);
    (leaves.next_power_of_two().trailing_zeros() + 1).min(24)
}

/// Which nodes hold occluders, and how many leaves do.
fn database<S: Drawable>(
    scene: &Scene<S>,
    tree: &KdTree<S::Vector>,
    least: f32,
    progress: &dyn Progress,
) -> Option<(Vec<bool>, Counts)> {
    let leaves: Vec<NodeId> =
        (0..tree.nodes().len() as u32).map(NodeId).filter(|n| tree.nodes()[n.at()].is_leaf()).collect();
    let density = |leaf: NodeId| {
        tree.prims_below(leaf).len() as f32 / extent(&tree.nodes()[leaf.at()].bounds).max(f32::MIN_POSITIVE)
    };
    let mut sorted: Vec<f32> = leaves.iter().map(|&leaf| density(leaf)).collect();
    sorted.sort_by(f32::total_cmp);
    let median = sorted[sorted.len() / 2];
    let faces = large_faces(scene);
    let (mut occluders, mut counts) = (vec![false; tree.nodes().len()], Counts::default());
    for leaf in leaves {
        if progress.cancelled() {
            return None;
        }
        let prims = tree.prims_below(leaf);
        let bounds = &tree.nodes()[leaf.at()].bounds;
        // Section 5.3.1, its three criteria in its order. What holds nothing hides nothing either.
        if prims.is_empty() || bounds.diagonal() < least {
            counts.small += 1;
        } else if faces.iter().any(|face| face.covers(scene, bounds, prims)) {
            counts.redundant += 1;
        } else if density(leaf) > COMPLEX * median {
            counts.complex += 1;
        } else {
            counts.kept += 1;
            counts.kept_prims += prims.len() as u32;
            occluders[leaf.at()] = true;
        }
    }
    // Children follow their parents.
    for at in (0..occluders.len()).rev() {
        let below = tree.nodes()[at].children();
        occluders[at] |= below.is_some_and(|pair| pair.iter().any(|child| occluders[child.at()]));
    }
    Some((occluders, counts))
}

/// How much of the view a box can take up: half its surface, in flatland half its outline.
fn extent<V: Vector>(bounds: &Aabb<V>) -> f32 {
    let size = bounds.size();
    match V::AXES {
        2 => size.get(0) + size.get(1),
        _ => size.get(0) * size.get(1) + size.get(1) * size.get(2) + size.get(2) * size.get(0),
    }
}

/// A face on which something may be redundant.
struct Wall<'a, V> {
    face: &'a Face,
    normal: V,
    bounds: Aabb<V>,
}

/// The largest faces, the largest first.
fn large_faces<S: Drawable>(scene: &Scene<S>) -> Vec<Wall<'_, S::Vector>> {
    let bounds = |face: &Face| Aabb::of(face.corners.iter().map(|&c| scene.points()[c as usize]));
    let mut faces: Vec<(f32, &Face)> = scene.faces().iter().map(|f| (bounds(f).diagonal(), f)).collect();
    // Equally large ones in the order of the scene, so that every run takes the same.
    faces.sort_by(|a, b| b.0.total_cmp(&a.0));
    faces.truncate(MOST_FACES);
    let mut walls = Vec::new();
    for (_, face) in faces {
        let Some(&prim) = face.prims.first() else { continue };
        let normal = scene.normal(prim);
        let length = normal.length();
        if length > 0.0 {
            walls.push(Wall { face, normal: normal * (1.0 / length), bounds: bounds(face) });
        }
    }
    walls
}

impl<V: Vector> Wall<'_, V> {
    /// Whether what a leaf holds lies closely before this larger face, within its outline.
    fn covers<S: Space<Vector = V>>(&self, scene: &Scene<S>, bounds: &Aabb<V>, prims: &[PrimId]) -> bool {
        let (diagonal, origin) = (self.bounds.diagonal(), self.bounds.center());
        let reach = BEFORE * diagonal;
        let height = |p: V| self.normal.dot(p - scene.points()[self.face.corners[0] as usize]);
        // Most leaves are nowhere near.
        let half = bounds.diagonal() * 0.5;
        if bounds.diagonal() >= diagonal || (bounds.center() - origin).length() > half + diagonal {
            return false;
        }
        let middle = height(bounds.center());
        if middle < -half || middle > reach + half {
            return false;
        }
        // A piece of the face itself hides what the face hides.
        if prims.iter().any(|p| self.face.prims.binary_search(p).is_ok()) {
            return false;
        }
        let is_before = |p: V| (0.0..=reach).contains(&height(p)) && self.is_within(scene, p);
        prims.iter().all(|&p| scene.prim_points(p).all(is_before))
    }
    /// Whether a point lies before or behind the face, within its outline, which is convex.
    fn is_within<S: Space<Vector = V>>(&self, scene: &Scene<S>, point: V) -> bool {
        let corner = |i: usize| scene.points()[self.face.corners[i % self.face.corners.len()] as usize];
        let count = self.face.corners.len();
        let middle = (0..count).fold(V::default(), |sum, i| sum + corner(i)) * (1.0 / count as f32);
        (0..count).all(|i| {
            let (a, along) = (corner(i), corner(i + 1) - corner(i));
            // Inward, square to the edge; the ends of a segment have no edges.
            let inward = match S::CORNERS {
                2 => middle - a,
                _ => {
                    let inward = middle - a;
                    inward - along * (inward.dot(along) / along.dot(along).max(f32::MIN_POSITIVE))
                }
            };
            inward.dot(point - a) >= 0.0
        })
    }
}

/// As a tree it is the model's hierarchy.
impl<S: Space> Hierarchy<S> for Databases<S> {
    fn node_count(&self) -> usize {
        Hierarchy::<S>::node_count(&self.tree)
    }
    fn bounds(&self, node: NodeId) -> Aabb<S::Vector> {
        Hierarchy::<S>::bounds(&self.tree, node)
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
    fn bytes(&self) -> usize {
        let grid = self.grid.as_ref().map_or(0, |made| made.0.bytes());
        let stand_ins = self.stand_ins.as_ref().map_or(0, |made| made.bytes());
        Hierarchy::<S>::bytes(&self.tree) + self.clusters.bytes() + self.occluders.len() + grid + stand_ins
    }
    fn save(&self) -> Option<Vec<u8>> {
        self.grid.as_ref().map(|made| saved::write(&made.1, &made.0))
    }
}
