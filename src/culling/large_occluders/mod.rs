//! `large-occluders`: conservative occlusion culling by a few large convex polygons.
//!
//! Coorg and Teller, "Real-Time Occlusion Culling for Models with Large Occluders", I3D 1997,
//! <https://doi.org/10.1145/253284.253312>. A kD-tree is walked from the root (Figure 9); each node's box is
//! tested against a small set of occluders by supporting and separating planes (Section 2, [`relation`]), one
//! by one and as connected sets ([`joint`]); only those that partially occlude a node are passed to its
//! children. The set is chosen by place and viewing direction (Section 3.1, [`selection`]); the planes are
//! kept from frame to frame (Section 3, [`memory`]); what survives is tested object by object against the
//! occluders near it (Section 3.2).
//!
//! Departures: occlusion is demanded with a margin, so that it also holds for the pixels of the rasterizer
//! (see [`relation`]); where an occluder's own plane cuts a box the relation is partial, not none, since what
//! lies behind it can be occluded; the jointly occluding set need not be a whole component (see [`joint`]);
//! occluders are picked from a leaf's longer list by where they are used (see [`selection`]); detail objects
//! are also tested against the frustum. Cost: O(occluders · nodes visited); memory O(nodes · occluders).

pub mod anatomy;
mod explain;
mod joint;
mod memory;
mod occluders;
mod relation;
mod saved;
mod selection;
mod space;
#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::Arc;

pub use self::explain::Evidence;
use self::explain::{Chosen, Joined, Related};
use self::joint::{Candidate, jointly};
use self::memory::Memory;
pub use self::memory::Owner;
use self::occluders::Occluders;
use self::relation::{Margin, Occlusion, Relation};
use self::selection::{Selection, largest_from, leaf_at};
use self::space::Shape;
use crate::drawing::{Drawing, Subject};
use crate::geometry::{Aabb, Frustum, FrustumTest, NodeId, ObjectId, PrimId, Space, Vector, View};
use crate::index::{Hierarchy, KdTree};
use crate::method::evidence::{Facing, Tested, prim_faces_away};
use crate::method::{
    Card, CodeLine, DrawList, Event, Frame, Knob, Knobs, Method, Moment, Observer, Shown, State, Verdict,
    backface_knob,
};
use crate::scene::{Part, Progress, Scene};

/// The method.
pub struct LargeOccluders;

/// Parameters of [`LargeOccluders`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    tree_height: u32,
    occluders: u32,
    directions: u32,
    marginal_gain: u32,
    cache: bool,
    detail_objects: bool,
    backface_culling: bool,
}

impl Default for Params {
    fn default() -> Self {
        // The paper's: height 8, 32 occluders for each of 8 directions.
        Self {
            tree_height: 8,
            occluders: 32,
            directions: 8,
            marginal_gain: 0,
            cache: true,
            detail_objects: true,
            backface_culling: false,
        }
    }
}

/// What is built once: the kD-tree, the occluders that any place can choose, and which each chooses.
#[derive(Clone, Debug)]
pub struct Index<S: Shape> {
    tree: KdTree<S::Vector>,
    occluders: Occluders<S>,
    selection: Selection,
    /// Bounds of each object that is small enough to be tested as a whole.
    details: Vec<Option<Aabb<S::Vector>>>,
    /// The tree's primitives, those of a leaf sorted by object; and where each run of one object begins.
    by_object: Vec<PrimId>,
    runs: Vec<(u32, ObjectId)>,
    /// The selection with the numbers that all polygons of the scene have, to be saved.
    saved: Arc<[u8]>,
}

impl Params {
    fn key<S: Space>(&self, scene: &Scene<S>) -> saved::Key {
        saved::Key {
            scene: scene.hash_hex(),
            params: [self.tree_height, self.directions, self.occluders, self.marginal_gain],
        }
    }
}

/// The most that a detail object measures, as a share of the scene's diagonal.
const DETAIL_SHARE: f32 = 0.05;
/// The fewest primitives that are worth a test of their own.
const DETAIL_PRIMS: u32 = 4;

impl<S: Shape> Index<S> {
    /// Builds it, with the selection out of `saved` bytes if there are any. `Ok(None)` when cancelled.
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Self>, String> {
        progress.report(0.0, "building the kD-tree");
        let boxes = scene.live().iter().map(|&p| (p, scene.prim_bounds(p)));
        let Some(tree) = KdTree::build(boxes, params.tree_height, || progress.cancelled()) else {
            return Ok(None);
        };
        let Some(faces) = S::polygons(scene, &Part { whole: progress, start: 0.1, length: 0.3 }) else {
            return Ok(None);
        };
        let all = Occluders::<S>::new(scene.points(), &faces);
        let rest = Part { whole: progress, start: 0.4, length: 0.55 };
        let gain = f64::from(params.marginal_gain) / 100.0;
        let made = match saved {
            Some(bytes) => Some(saved::read(bytes, &params.key(scene), tree.nodes().len(), all.len())?),
            None => Selection::new(&tree, &all, [params.directions, params.occluders], gain, &rest),
        };
        let Some(selection) = made else { return Ok(None) };
        let saved = saved::write(&params.key(scene), &selection);
        // Only what some list names can ever be active.
        let kept = selection.named();
        let faces: Vec<_> = kept.iter().map(|&id| faces[all.get(id).source as usize].clone()).collect();
        let occluders = Occluders::<S>::new(scene.points(), &faces);
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
    fn objects_of(&self, node: NodeId) -> impl Iterator<Item = (ObjectId, &[PrimId])> {
        let range = self.tree.range(node);
        let start = |i: usize| self.runs.get(i).map_or(self.by_object.len(), |r| r.0 as usize);
        let first = self.runs.partition_point(|r| (r.0 as usize) < range.start);
        let last = self.runs.partition_point(|r| (r.0 as usize) < range.end);
        (first..last).map(move |i| (self.runs[i].1, &self.by_object[start(i)..start(i + 1)]))
    }
    /// The box that a test was about.
    fn bounds_of(&self, owner: Owner) -> Aabb<S::Vector> {
        match owner {
            Owner::Node(n) => self.tree.nodes()[n.at()].bounds,
            Owner::Object(o) => self.details[o.at()].unwrap_or(Aabb::empty()),
        }
    }
}

/// The tree's primitives with those of each leaf sorted by object, and the beginnings of the runs.
fn runs<S: Space>(scene: &Scene<S>, tree: &KdTree<S::Vector>) -> (Vec<PrimId>, Vec<(u32, ObjectId)>) {
    let mut order = tree.prims_below(NodeId(0)).to_vec();
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

const CODE: &[CodeLine] = &[
    CodeLine { label: "Select:1", text: "S := occluders of P's leaf and direction" },
    CodeLine { label: "Visible:1", text: "Visible(occluders S, node T, viewpoint P)" },
    CodeLine { label: "Visible:2", text: "  if T lies outside the view frustum" },
    CodeLine { label: "Visible:3", text: "    return" },
    CodeLine { label: "Visible:4", text: "  TestOcclusion(S, T, P)" },
    CodeLine { label: "Visible:5", text: "  if S does not occlude T" },
    CodeLine { label: "Visible:6", text: "    Gather(T)" },
    CodeLine { label: "Visible:7", text: "  else if T is occluded" },
    CodeLine { label: "Visible:8", text: "    return" },
    CodeLine { label: "Visible:9", text: "  else if T is a leaf" },
    CodeLine { label: "Visible:10", text: "    Gather(T)" },
    CodeLine { label: "Visible:11", text: "  else" },
    CodeLine { label: "Visible:12", text: "    S' := those of S that partially occlude T" },
    CodeLine { label: "Visible:13", text: "    for each child T' of T: Visible(S', T', P)" },
    CodeLine { label: "TestOcclusion:1", text: "TestOcclusion(S, T, P)" },
    CodeLine { label: "TestOcclusion:2", text: "  for each A of S" },
    CodeLine { label: "TestOcclusion:3", text: "    planes of A and T: kept ones, or made" },
    CodeLine { label: "TestOcclusion:4", text: "    if P satisfies all supporting planes" },
    CodeLine { label: "TestOcclusion:5", text: "      T is occluded by A" },
    CodeLine { label: "TestOcclusion:6", text: "    else if P satisfies all separating planes" },
    CodeLine { label: "TestOcclusion:7", text: "      A partially occludes T" },
    CodeLine { label: "TestOcclusion:8", text: "  if connected ones jointly occlude T" },
    CodeLine { label: "TestOcclusion:9", text: "    T is occluded by them" },
    CodeLine { label: "Gather:1", text: "Gather(T)" },
    CodeLine { label: "Gather:2", text: "  for each detail object D of T" },
    CodeLine { label: "Gather:3", text: "    TestOcclusion(occluders near D, D, P)" },
    CodeLine { label: "Gather:4", text: "  draw all of T but the occluded objects" },
];

/// Numbers of the lines that events refer to.
mod line {
    pub const SELECT: u8 = 0;
    pub const OUTSIDE: u8 = 3;
    pub const TEST: u8 = 4;
    pub const GATHER: u8 = 6;
    pub const OCCLUDED: u8 = 8;
    pub const LEAF: u8 = 10;
    pub const CHILD: u8 = 13;
    pub const FULL: u8 = 18;
    pub const PARTIAL: u8 = 20;
    pub const JOINT: u8 = 22;
    pub const DETAIL: u8 = 25;
}

/// A parameter.
fn knob(name: &'static str, unit: &'static str, meaning: &'static str, source: &'static str) -> Knob {
    Knob { name, unit, meaning, source }
}

impl<S: Shape> Method<S> for LargeOccluders {
    type Params = Params;
    type Index = Index<S>;
    type Memory = Memory<S>;
    type State = Active;
    type Note = Evidence<S>;
    const CARD: Card = Card {
        key: "large-occluders",
        name: "Large occluders",
        summary: "Drops every node of a kD-tree that one large convex polygon, or connected ones together, \
                  hide from the Eye.",
        paper: "Coorg and Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997.",
        doi: "10.1145/253284.253312",
        conservative: true,
        code: CODE,
    };
    fn knobs(params: &mut Params, knobs: &mut dyn Knobs) {
        let height = knob(
            "tree-height",
            "levels",
            "levels of the kD-tree; 8 gives 255 nodes",
            "Coorg and Teller 1997, Section 4",
        );
        knobs.integer(height, 1..=24, &mut params.tree_height);
        let most = knob(
            "occluders",
            "",
            "how many occluders are active at most, k in the paper",
            "Coorg and Teller 1997, Section 3.1",
        );
        knobs.integer(most, 1..=64, &mut params.occluders);
        let directions = knob(
            "directions",
            "",
            "viewing directions that have a set of their own",
            "Coorg and Teller 1997, Section 3.1",
        );
        knobs.integer(directions, 1..=64, &mut params.directions);
        let meaning = "leaves out an occluder whose area-angle is below this share of the sum of the better \
                       ones; 0: never";
        knobs.integer(
            knob("marginal-gain", "%", meaning, "Coorg and Teller 1997, Section 5"),
            0..=100,
            &mut params.marginal_gain,
        );
        let cache = knob("cache", "", "keeps planes from frame to frame", "Coorg and Teller 1997, Section 3");
        knobs.switch(cache, &mut params.cache);
        let detail = knob(
            "detail-objects",
            "",
            "tests what survives object by object against the occluders near it",
            "Coorg and Teller 1997, Section 3.2",
        );
        knobs.switch(detail, &mut params.detail_objects);
        backface_knob(knobs, &mut params.backface_culling);
    }
    fn build(
        scene: &Arc<Scene<S>>,
        params: &Params,
        saved: Option<&[u8]>,
        progress: &dyn Progress,
    ) -> Result<Option<Index<S>>, String> {
        Index::build(scene, params, saved, progress)
    }
    fn cull<O: Observer<Evidence<S>>>(
        frame: &Frame<'_, S, Self>,
        memory: &mut Memory<S>,
        active: &mut Active,
        out: &mut DrawList<S>,
        watch: &mut O,
    ) {
        let Frame { index, scene, view, params, .. } = *frame;
        watch.event(Event::FrameBegan);
        memory.begin(index.tree.nodes().len(), index.details.len(), index.occluders.len());
        let forward = S::widened(view.eye.forward());
        let mut walk = Walk {
            index,
            scene,
            view,
            params,
            memory,
            active,
            out,
            watch,
            frustum: view.frustum(),
            eye: S::widened(view.eye.position),
            forward,
            margin: Margin::of(view),
            sets: Vec::new(),
            candidates: Vec::new(),
        };
        walk.watch.stage("select");
        walk.select();
        let set = 0..walk.sets.len();
        walk.watch.stage("visit");
        walk.visible(NodeId(0), Frustum::<S::Vector>::ALL, set);
    }
}

/// The occluders that are active in a frame, in the order in which they were chosen.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Active(Vec<u32>);

impl Active {
    fn choose(&mut self, occluder: u32) {
        self.0.push(occluder);
    }
}

impl<S: Shape> State<S, LargeOccluders> for Active {
    const KEYFRAME_NOTES: usize = 64;
    fn begin(&mut self, _: &Frame<'_, S, LargeOccluders>) {
        self.0.clear();
    }
    fn apply(&mut self, _: &Scene<S>, note: &Evidence<S>) {
        if let Evidence::Chosen(n) = note {
            self.choose(n.occluder);
        }
    }
}

impl<S: Shape> Shown<S> for LargeOccluders {
    fn explain(moment: &Moment<'_, S, Self>, to: &mut Drawing<S::Vector>) {
        explain::draw(&moment.state.0, &moment.frame, moment.note, to);
    }
}

/// One traversal.
struct Walk<'a, S: Shape, O> {
    index: &'a Index<S>,
    scene: &'a Scene<S>,
    view: &'a View<S>,
    params: &'a Params,
    memory: &'a mut Memory<S>,
    active: &'a mut Active,
    out: &'a mut DrawList<S>,
    watch: &'a mut O,
    frustum: Frustum<S::Vector>,
    eye: S::Point,
    forward: S::Point,
    margin: Margin,
    /// The occluder sets of the nodes on the way down, one after the other.
    sets: Vec<u32>,
    candidates: Vec<Candidate>,
}

/// What the occluders of a set do to a box.
enum Fate {
    Hidden,
    /// Those that partially occlude it; may be empty.
    Left(Range<usize>),
}

impl<S: Shape, O: Observer<Evidence<S>>> Walk<'_, S, O> {
    /// Section 3.1: the active occluders of this frame.
    fn select(&mut self) {
        self.watch.event(Event::Line(line::SELECT));
        let index = self.index;
        let leaf = leaf_at::<S>(&index.tree, self.view.eye.position);
        let direction = index.selection.direction_of::<S>(self.forward);
        let mut list = Vec::new();
        largest_from(
            &index.occluders,
            index.selection.list(leaf, direction).iter(),
            self.eye,
            self.params.occluders,
            &mut list,
        );
        for (rank, &(id, area_angle)) in list.iter().enumerate() {
            let memory = &self.memory;
            self.watch.note(|| {
                Evidence::Chosen(Chosen::of(
                    &index.occluders,
                    id,
                    rank,
                    area_angle,
                    [leaf.0, direction],
                    !memory.active.contains(&id),
                ))
            });
            self.active.choose(id);
            if self.looks_at(id) {
                self.sets.push(id);
            }
        }
        self.memory.active.clone_from(&self.active.0);
    }

    /// Computes how the eye sees an occluder; whether it can hide anything.
    fn looks_at(&mut self, id: u32) -> bool {
        let (occluders, eye, margin) = (&self.index.occluders, self.eye, self.margin);
        let (scene, position, one_sided) = (self.scene, self.view.eye.position, self.params.backface_culling);
        let sight = self.memory.sight(id, |sight| {
            sight.look(occluders, id, eye, margin);
            // What is not drawn hides nothing.
            if sight.side != 0
                && one_sided
                && occluders.prims(id).iter().any(|&p| prim_faces_away(scene, position, p))
            {
                sight.side = 0;
            }
        });
        sight.side != 0
    }

    /// Figure 9, with view-frustum culling in front.
    fn visible(&mut self, id: NodeId, planes: u8, set: Range<usize>) {
        let index = self.index;
        let node = &index.tree.nodes()[id.at()];
        self.watch.event(Event::Entered(id));
        let mut cutting = 0;
        if planes != 0 {
            let test = self.frustum.test(&node.bounds, planes);
            self.watch
                .note(move || Evidence::Tested(Tested::of(Subject::Node(id), &node.bounds, planes, test)));
            match test {
                FrustumTest::Outside(_) => {
                    self.watch.event(Event::Line(line::OUTSIDE));
                    self.watch.event(Event::DecidedNode(id, Verdict::Outside));
                    self.watch.event(Event::Left(id));
                    return;
                }
                FrustumTest::Partial(planes) => cutting = planes,
                FrustumTest::Inside => {}
            }
        }
        self.watch.event(Event::Line(line::TEST));
        let end = self.sets.len();
        match self.test_occlusion(Owner::Node(id), &node.bounds, set) {
            Fate::Hidden => {
                self.watch.event(Event::Line(line::OCCLUDED));
                self.memory.forget_below(&index.tree, id);
                self.watch.event(Event::DecidedNode(id, Verdict::Hidden));
            }
            Fate::Left(left) => self.go_on(id, cutting, left),
        }
        self.sets.truncate(end);
        self.watch.event(Event::Left(id));
    }

    /// A node that is not hidden: its children, or all of it.
    fn go_on(&mut self, id: NodeId, cutting: u8, left: Range<usize>) {
        let index = self.index;
        if left.is_empty() {
            self.memory.forget_below(&index.tree, id);
        }
        let undecided = cutting != 0 || !left.is_empty();
        match index.tree.nodes()[id.at()].children() {
            Some(children) if undecided => {
                self.watch.event(Event::DecidedNode(id, Verdict::Partial));
                if self.params.cache && !left.is_empty() {
                    self.memory.passed(id);
                }
                for child in children {
                    self.watch.event(Event::Line(line::CHILD));
                    self.visible(child, cutting, left.clone());
                }
            }
            _ => {
                self.watch.event(Event::Line(if undecided { line::LEAF } else { line::GATHER }));
                self.gather(id, cutting);
                self.watch.event(Event::DecidedNode(id, Verdict::Visible));
            }
        }
    }

    /// Section 2. On return the occluders that partially occlude the box stand at the end of `self.sets`.
    fn test_occlusion(&mut self, owner: Owner, bounds: &Aabb<S::Vector>, set: Range<usize>) -> Fate {
        let depth = self.depth(bounds);
        let start = self.sets.len();
        self.candidates.clear();
        for at in set.clone() {
            let occluder = self.sets[at];
            let (occlusion, candidate) = self.test_one(owner, bounds, occluder, depth, at - set.start);
            match occlusion {
                Occlusion::Full => {
                    self.watch.event(Event::Line(line::FULL));
                    return Fate::Hidden;
                }
                Occlusion::Partial => {
                    self.watch.event(Event::Line(line::PARTIAL));
                    self.sets.push(occluder);
                    self.candidates.extend(candidate);
                }
                Occlusion::None => {}
            }
        }
        if self.candidates.len() > 1 {
            let members = jointly(&self.index.occluders, &self.candidates, &mut self.memory.joint);
            if members != 0 {
                let (occluders, candidates) = (&self.index.occluders, &self.candidates);
                self.watch.note(move || Evidence::Joined(Joined::of(occluders, owner, candidates, members)));
                self.watch.event(Event::Line(line::JOINT));
                return Fate::Hidden;
            }
        }
        Fate::Left(start..self.sets.len())
    }

    /// One occluder and one box.
    fn test_one(
        &mut self,
        owner: Owner,
        bounds: &Aabb<S::Vector>,
        id: u32,
        depth: f64,
        near: usize,
    ) -> (Occlusion, Option<Candidate>) {
        let (index, margin) = (self.index, self.margin);
        let side = self.memory.sight_of(id).side;
        let kept = if self.params.cache { self.memory.find(owner, id, side, near) } else { None };
        let made;
        let relation = match kept {
            Some(at) => self.memory.get(owner, at),
            None => {
                let relation = Relation::new(&index.occluders, id, side, bounds, false);
                if self.params.cache {
                    let at = self.memory.keep(owner, relation);
                    self.memory.get(owner, at)
                } else {
                    made = relation;
                    &made
                }
            }
        };
        let sight = self.memory.sight_of(id);
        let thickness = index.occluders.thickness(id);
        let seen = relation.classify(sight, thickness, depth, margin);
        self.watch.note(|| {
            Evidence::Related(Related::of(
                &index.occluders,
                owner,
                relation,
                sight,
                seen,
                depth,
                margin,
                kept.is_some(),
            ))
        });
        let candidate = seen.behind.then_some(Candidate { occluder: id, side, seen });
        (seen.occlusion, candidate)
    }

    /// The greatest view depth of a box, rounded up.
    fn depth(&self, bounds: &Aabb<S::Vector>) -> f64 {
        use self::space::Point;
        let axis = |a: usize| {
            let (f, e) = (self.forward.get(a), self.eye.get(a));
            (f * (f64::from(bounds.min.get(a)) - e)).max(f * (f64::from(bounds.max.get(a)) - e))
        };
        (0..S::Vector::AXES).map(axis).sum::<f64>() * (1.0 + 1e-5)
    }

    /// Draws the primitives of a node that the planes `cutting` cut, but for detail objects that are out of
    /// view or that the occluders near them hide.
    fn gather(&mut self, id: NodeId, cutting: u8) {
        let index = self.index;
        if !self.params.detail_objects {
            self.draw(index.tree.prims_below(id));
            return;
        }
        for (object, prims) in index.objects_of(id) {
            match self.fate(object, cutting) {
                Verdict::Visible => self.draw(prims),
                fate => prims.iter().for_each(|&prim| self.watch.event(Event::DecidedPrim(prim, fate))),
            }
        }
    }

    /// Draws primitives, but for back faces if so asked.
    fn draw(&mut self, prims: &[PrimId]) {
        if !self.params.backface_culling {
            self.out.prims.extend_from_slice(prims);
            return;
        }
        let (scene, view) = (self.scene, self.view);
        for &prim in prims {
            if prim_faces_away(scene, view.eye.position, prim) {
                self.watch.note(move || Evidence::Facing(Facing::of(prim)));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Outside));
            } else {
                self.out.prims.push(prim);
            }
        }
    }

    /// Section 3.2: whether a detail object is hidden by what looks large from it toward the eye, since
    /// visibility between two points goes both ways. Found out once a frame.
    fn fate(&mut self, object: ObjectId, cutting: u8) -> Verdict {
        if let Some(known) = self.memory.fates[object.at()] {
            return known;
        }
        let index = self.index;
        let fate = match &index.details[object.at()] {
            Some(bounds) if cutting != 0 && self.is_outside(object, bounds, cutting) => Verdict::Outside,
            Some(bounds) if self.is_hidden(object, bounds) => Verdict::Hidden,
            _ => Verdict::Visible,
        };
        self.memory.fates[object.at()] = Some(fate);
        fate
    }

    fn is_outside(&mut self, object: ObjectId, bounds: &Aabb<S::Vector>, planes: u8) -> bool {
        let test = self.frustum.test(bounds, planes);
        self.watch.note(move || Evidence::Tested(Tested::of(Subject::Object(object), bounds, planes, test)));
        matches!(test, FrustumTest::Outside(_))
    }

    fn is_hidden(&mut self, object: ObjectId, bounds: &Aabb<S::Vector>) -> bool {
        let index = self.index;
        self.watch.event(Event::Line(line::DETAIL));
        let center = bounds.center();
        let direction = index.selection.direction_of::<S>(self.eye - S::widened(center));
        let most = self.params.occluders;
        let near = self.memory.near(object, direction, |list| {
            let leaf = leaf_at::<S>(&index.tree, center);
            // What cuts or touches the object's box, as its own primitives do, cannot hide all of it.
            let beside =
                index.selection.list(leaf, direction).iter().filter(|l| !index.occluders.cuts(l.0, bounds));
            largest_from(&index.occluders, beside, S::widened(center), most, list);
        });
        let start = self.sets.len();
        for at in 0..near {
            let id = self.memory.near_to(object, at);
            if self.looks_at(id) {
                self.sets.push(id);
            }
        }
        let set = start..self.sets.len();
        let hidden = matches!(self.test_occlusion(Owner::Object(object), bounds, set), Fate::Hidden);
        self.sets.truncate(start);
        hidden
    }
}
