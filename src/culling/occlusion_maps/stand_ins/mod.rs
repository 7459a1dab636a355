//! What is drawn in place of occluders (Zhang et al. 1997, Sections 6.2 and 8): fewer polygons that hide no
//! more than what they stand for. "The screen space projection of the simplified object should be a subset of
//! that of the original object."
//!
//! - [`merged`]: coplanar polygons, cut into fewer triangles;
//! - *largest*: of what a leaf holds the largest primitives, a subset, of open models too;
//! - [`inner`]: boxes inside closed parts;
//! - *clustered*: for comparison a simplification that preserves nothing, vertex clustering (Rossignac and
//!   Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993,
//!   <https://doi.org/10.1007/978-3-642-78114-8_29>): points in one cell of a grid become their mean, and
//!   what is left of two corners or one is dropped. What is hidden by that is presumed.
//!
//! Stand-ins are a scene of their own, made into clusters after those of the model. Which leaves are
//! occluders, and what is culled, is a matter of the model as ever.
//! Cost: O(n log n) time, of inner boxes O(primitives · cells that they meet).

mod inner;
mod merged;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use self::inner::Inside;
use super::leaves::Leaves;
use crate::geometry::{Aabb, MaterialId, NodeId, PrimId, Projection, Space, Vector, View};
use crate::method::words;
use crate::raster::{DEPTH_SLACK, Drawable, Turns};
use crate::scene::{Parts, Progress, Scene, Surfaces};

words! {
    /// What is drawn of an occluder.
    pub(crate) enum Kind {
        /// All that it holds.
        Original = "original",
        /// Coplanar neighbors as one polygon.
        Merged = "merged",
        /// Its largest primitives.
        Largest = "largest",
        /// Boxes inside closed parts.
        Inner = "inner",
        /// A simplification that does not preserve occlusion.
        Clustered = "clustered",
    }
}

/// Share of a leaf's area that its largest primitives have together.
const LARGEST: f32 = 0.75;

/// What stands in for the leaves of the occluder database.
#[derive(Clone, Debug)]
pub(crate) struct StandIns<S: Space> {
    kind: Kind,
    /// What is drawn; its primitives are leaf by leaf in the order of nodes.
    scene: Scene<S>,
    /// Of each node the first of its primitives, and the end.
    starts: Vec<u32>,
    /// Bounds of what stands in for a node and all below it.
    bounds: Vec<Aabb<S::Vector>>,
    /// Primitives that tile one polygon, in order.
    polygons: Vec<Range<u32>>,
    /// Of each node what its boxes lie in.
    inside: Vec<Option<Inside<S::Vector>>>,
}

/// What is made of a leaf.
pub(super) struct Made<S: Space> {
    /// Corners of each primitive; those that tile one polygon follow each other.
    prims: Vec<[S::Vector; 3]>,
    /// Whether each has two fronts.
    two_sided: Vec<bool>,
    polygons: Vec<Range<u32>>,
    inside: Option<Inside<S::Vector>>,
}

impl<S: Space> Default for Made<S> {
    fn default() -> Self {
        Self { prims: Vec::new(), two_sided: Vec::new(), polygons: Vec::new(), inside: None }
    }
}

impl<S: Space> Made<S> {
    fn add(&mut self, corners: [S::Vector; 3], is_two_sided: bool) {
        self.prims.push(corners);
        self.two_sided.push(is_two_sided);
    }
    /// A primitive as it is.
    fn keep(&mut self, scene: &Scene<S>, prim: PrimId) {
        self.add(corners_of(scene, prim), scene.is_two_sided(prim));
    }
}

/// Corners of a live primitive; of a segment the second end twice.
fn corners_of<S: Space>(scene: &Scene<S>, prim: PrimId) -> [S::Vector; 3] {
    let mut corners = [S::Vector::default(); 3];
    let mut last = S::Vector::default();
    let mut points = scene.prim_points(prim);
    for to in &mut corners {
        last = points.next().unwrap_or(last);
        *to = last;
    }
    corners
}

impl<S: Drawable> StandIns<S> {
    /// Makes them. `detail`: what is smaller counts as nothing, world units. `None` when cancelled, or where
    /// nothing stands in for another.
    pub fn new(
        kind: Kind,
        leaves: &Leaves<'_, S>,
        surfaces: Surfaces,
        detail: f32,
        progress: &dyn Progress,
    ) -> Option<Self> {
        progress.report(0.0, "simplifying occluders");
        // What lets light through hides nothing.
        let hides = |p: &PrimId| !surfaces.show_through(leaves.scene, *p);
        let each = |make: &dyn Fn(&[PrimId]) -> Made<S>| -> BTreeMap<NodeId, Made<S>> {
            let of = |leaf: NodeId| {
                let prims: Vec<PrimId> = leaves.prims(leaf).iter().copied().filter(hides).collect();
                (leaf, make(&prims))
            };
            leaves.all().take_while(|_| !progress.cancelled()).map(of).collect()
        };
        let scene = leaves.scene;
        let made = match kind {
            Kind::Original => return None,
            Kind::Merged => each(&|prims| merged::merge(scene, prims)),
            Kind::Largest => each(&|prims| largest(scene, prims)),
            Kind::Clustered => {
                let places = clustered(scene, detail);
                each(&|prims| moved_to(scene, &places, prims))
            }
            Kind::Inner => inner::boxes(leaves, surfaces, detail, progress)?,
        };
        (!progress.cancelled()).then(|| Self::of(kind, leaves, made)).flatten()
    }
    fn of(kind: Kind, leaves: &Leaves<'_, S>, made: BTreeMap<NodeId, Made<S>>) -> Option<Self> {
        let nodes = leaves.tree.nodes();
        let mut all = Made::<S>::default();
        let (mut starts, mut bounds) = (vec![0], vec![Aabb::empty(); nodes.len()]);
        let mut inside = vec![None; if kind == Kind::Inner { nodes.len() } else { 0 }];
        for node in 0..nodes.len() {
            if let Some(of_leaf) = made.get(&NodeId(node as u32)) {
                let first = all.prims.len() as u32;
                all.prims.extend(&of_leaf.prims);
                all.two_sided.extend(&of_leaf.two_sided);
                all.polygons.extend(of_leaf.polygons.iter().map(|r| r.start + first..r.end + first));
                bounds[node] = Aabb::of(of_leaf.prims.as_flattened().iter().copied());
                if kind == Kind::Inner {
                    inside[node].clone_from(&of_leaf.inside);
                }
            }
            starts.push(all.prims.len() as u32);
        }
        for at in (0..nodes.len()).rev() {
            if let Some([a, b]) = nodes[at].children() {
                bounds[at] = bounds[a.at()].union(bounds[b.at()]);
            }
        }
        let points: Vec<S::Vector> = all.prims.as_flattened().to_vec();
        let corners = |k: u32| S::corners_from([3 * k, 3 * k + 1, 3 * k + 2]);
        let mut parts =
            Parts::simple("stand-ins", points, (0..all.prims.len() as u32).map(corners).collect());
        let mut two_sided = parts.materials[0].clone();
        two_sided.two_sided = true;
        parts.materials.push(two_sided);
        parts.prim_material = all.two_sided.iter().map(|&two| MaterialId(u32::from(two))).collect();
        // A scene without anything is none.
        let scene = Scene::new(parts).ok()?;
        Some(Self { kind, scene, starts, bounds, polygons: all.polygons, inside })
    }
    /// The same for another frame of the scene; `None` where nothing is left of them.
    pub fn follow(&self, leaves: &Leaves<'_, S>, surfaces: Surfaces, detail: f32) -> Option<Self> {
        // Boxes lie in parts that stand still.
        if self.kind == Kind::Inner {
            return Some(self.clone());
        }
        Self::new(self.kind, leaves, surfaces, detail, &crate::scene::Quiet)
    }
    /// What is drawn.
    pub fn scene(&self) -> &Scene<S> {
        &self.scene
    }
    /// What stands in for a node.
    pub fn prims(&self, node: NodeId) -> &[PrimId] {
        &self.scene.live()[self.starts[node.at()] as usize..self.starts[node.at() + 1] as usize]
    }
    /// By how much what stands in may be nearer than what it stands for, of its depth.
    pub fn nearer(&self) -> f32 {
        // Both cuts of a polygon may be off by twice the slack; others are no nearer.
        if self.kind == Kind::Merged { 4.0 * DEPTH_SLACK as f32 } else { 0.0 }
    }
    /// Bounds of what stands in for a node and all below it.
    pub fn bounds(&self, node: NodeId) -> &Aabb<S::Vector> {
        &self.bounds[node.at()]
    }
    /// Whether a leaf is no occluder where its stand-in does not preserve what it hides; else it is drawn
    /// itself.
    pub fn is_optional(&self) -> bool {
        self.kind == Kind::Inner
    }
    /// Whether what stands in for a leaf may be drawn: of what preserves occlusion, whether it does so where
    /// the rasterizer puts it.
    pub fn may_stand_in(&self, node: NodeId, view: &View<S>, projection: &Projection<S::Vector>) -> bool {
        match self.kind {
            Kind::Inner => {
                self.inside[node.at()].as_ref().is_some_and(|inside| inside.is_deep_enough(view, projection))
            }
            Kind::Merged => self.have_same_image(node, &Turns::new(view)),
            Kind::Original | Kind::Largest | Kind::Clustered => true,
        }
    }
    /// Whether the polygons of a leaf may be drawn in place of what they were made of.
    fn have_same_image(&self, node: NodeId, turns: &Turns) -> bool {
        let (from, to) = (self.starts[node.at()], self.starts[node.at() + 1]);
        let first = self.polygons.partition_point(|p| p.start < from);
        let of_leaf = self.polygons[first..].iter().take_while(|p| p.end <= to);
        of_leaf.into_iter().all(|p| {
            let prims = &self.scene.live()[p.start as usize..p.end as usize];
            turns.may_stand_for(prims.iter().map(|&prim| corners_of(&self.scene, prim)))
        })
    }
}

impl<S: Space> StandIns<S> {
    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        self.scene.memory_bytes() + size_of_val(&self.bounds[..]) + size_of_val(&self.starts[..])
    }
}

/// The largest primitives, until they have [`LARGEST`] of the area of all: a subset, so what they cover all
/// cover, at the very same samples and depths.
fn largest<S: Space>(scene: &Scene<S>, prims: &[PrimId]) -> Made<S> {
    let mut by_area: Vec<(f32, PrimId)> = prims.iter().map(|&p| (scene.normal(p).length(), p)).collect();
    by_area.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let enough = by_area.iter().map(|a| a.0).sum::<f32>() * LARGEST;
    let (mut made, mut sum) = (Made::default(), 0.0);
    for (area, prim) in by_area {
        if sum >= enough {
            break;
        }
        sum += area;
        made.keep(scene, prim);
    }
    made
}

/// For each point the first of those in its cell, and where that is moved to: the mean of them.
fn clustered<S: Space>(scene: &Scene<S>, side: f32) -> Vec<(u32, S::Vector)> {
    let points = scene.points();
    // Nothing is smaller than nothing: each point stays.
    if side <= 0.0 {
        return (0..).zip(points.iter().copied()).collect();
    }
    let cell = |p: S::Vector| {
        [0, 1, 2].map(|a| if a < S::Vector::AXES { (p.get(a) / side).floor() as i64 } else { 0 })
    };
    let mut cells: BTreeMap<[i64; 3], (u32, [f64; 3], f64)> = BTreeMap::new();
    for (at, &p) in (0..).zip(points) {
        let (_, sum, count) = cells.entry(cell(p)).or_insert((at, [0.0; 3], 0.0));
        (0..S::Vector::AXES).for_each(|a| sum[a] += f64::from(p.get(a)));
        *count += 1.0;
    }
    let place = |p: &S::Vector| {
        let (first, sum, count) = cells[&cell(*p)];
        (first, S::Vector::from_fn(|a| (sum[a] / count) as f32))
    };
    points.iter().map(place).collect()
}

/// Primitives with their corners moved; of those that become the same one, and none that collapse.
fn moved_to<S: Space>(scene: &Scene<S>, places: &[(u32, S::Vector)], prims: &[PrimId]) -> Made<S> {
    let (mut made, mut seen) = (Made::default(), BTreeSet::new());
    for &prim in prims {
        let Some(corners) = scene.corners(prim) else { continue };
        let at = |k: usize| places[corners.as_ref()[k.min(S::CORNERS - 1)] as usize];
        let mut firsts = [0, 1, 2].map(|k| at(k).0);
        firsts.sort_unstable();
        let distinct = 1 + firsts.windows(2).filter(|w| w[0] != w[1]).count();
        if distinct == S::CORNERS && seen.insert(firsts) {
            made.add([0, 1, 2].map(|k| at(k).1), scene.is_two_sided(prim));
        }
    }
    made
}
