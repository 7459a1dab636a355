//! The traversal: Figure 9, with view-frustum culling in front and detail objects behind.
//!
//! One frame is: 1. select the active occluders (Section 3.1); 2. visit the kD-tree from the root: cull by
//! the frustum, test against the occluders that partially occlude the parent, drop, keep, or go on to the
//! children (Section 3); 3. gather what survives, object by object (Section 3.2).

use std::ops::Range;

use super::explain::{Chosen, Edge, Evidence, Joined, Parted, Related};
use super::index::Index;
use super::joint::{Candidate, MOST_CANDIDATES, jointly};
use super::memory::{Memory, Owner};
use super::occluders::Occluders;
use super::relation::{Classified, EyeSide, Margin, Occlusion, Relation};
use super::selection::{has_depth, leaf_at, least_angle, ranked_from};
use super::space::{Point, Shape};
use super::{Active, LargeOccluders, Params, line};
use crate::drawing::Subject;
use crate::geometry::{Aabb, Frustum, FrustumTest, NodeId, ObjectId, PrimId, Vector, View};
use crate::index::KdNode;
use crate::method::evidence::{Facing, Tested};
use crate::method::{DrawList, Event, Frame, Observer, Verdict};
use crate::scene::Scene;

/// By how much, relative to its distance, an occluder must be nearer than a part of a primitive that reaches
/// out of its box.
const PARTS_DEPTH: f64 = 1.0 / (1u32 << 11) as f64;
/// [`Walk::is_edge_on`]: 2⁻²⁴ · (6 · 768 + 8) and twice [`crate::raster::DEPTH_TILT`], together, are below
/// [`PARTS_DEPTH`].
const EDGE_ON: f64 = 768.0;

/// One traversal.
pub struct Walk<'a, S: Shape, O> {
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
    /// 1 + the tangent of the angle from the line of sight to a corner of the image.
    spread: f64,
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

impl<'a, S: Shape, O: Observer<Evidence<S>>> Walk<'a, S, O> {
    pub fn new(
        frame: &Frame<'a, S, LargeOccluders>,
        memory: &'a mut Memory<S>,
        active: &'a mut Active,
        out: &'a mut DrawList<S>,
        watch: &'a mut O,
    ) -> Self {
        let Frame { index, scene, view, params, .. } = *frame;
        memory.begin(
            index.tree.nodes().len(),
            index.details.len(),
            index.occluders.len(),
            scene.prim_count(),
        );
        let margin = Margin::of(view);
        Self {
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
            forward: S::widened(view.eye.forward()),
            margin: if index.tree.is_parted() { Margin { depth: PARTS_DEPTH, ..margin } } else { margin },
            spread: 1.0 + Margin::spread(view),
            sets: Vec::new(),
            candidates: Vec::new(),
        }
    }

    /// One frame.
    pub fn run(mut self) {
        self.watch.stage("select");
        self.select();
        let set = 0..self.sets.len();
        self.watch.stage("visit");
        self.visible(NodeId(0), Frustum::<S::Vector>::ALL, set);
    }

    /// 1. Section 3.1: the active occluders of this frame.
    fn select(&mut self) {
        self.line(line::SELECT);
        let index = self.index;
        let direction = index.selection.direction_of::<S>(self.forward);
        let (whole, position) = (index.tree.nodes()[0].bounds, self.view.eye.position);
        if whole.contains(position) {
            // A departure: the paper takes the list as it is. A leaf may be large, so of its list, which is
            // longer than k, those are taken that look largest from the Eye itself.
            let (leaf, mut ranked) = (leaf_at::<S>(&index.tree, position), Vec::new());
            let list = index.selection.list(leaf, direction);
            ranked_from(&index.occluders, list, self.eye, &mut ranked);
            let mut list = ranked.into_iter();
            while list.next().is_some_and(|(id, area)| self.choose(id, area, Some(leaf), direction)) {}
        } else {
            // An Eye outside of the scene's box is in no leaf.
            let (occluders, eye) = (&index.occluders, self.eye);
            let gain = f64::from(self.params.marginal_gain) / 100.0;
            let mut sum = 0.0;
            index.selection.search(occluders, &index.ranking, eye, direction, |id, area| {
                if !has_depth(occluders, id, &whole, eye) {
                    return true;
                }
                let adds = sum == 0.0 || f64::from(area) >= gain * sum;
                sum += f64::from(area);
                adds && self.choose(id, area, None, direction)
            });
        }
        self.memory.active.clone_from(&self.active.0);
    }

    /// Makes an occluder active if it can hide anything; whether there is room for more.
    fn choose(&mut self, id: u32, area_angle: f32, leaf: Option<NodeId>, direction: u32) -> bool {
        // One that shows its back or its edge would take the place of one that hides something.
        if self.can_hide(id) {
            self.line(line::PICK);
            let (memory, occluders, rank) = (&self.memory, &self.index.occluders, self.active.0.len());
            self.watch.note(|| {
                let new = !memory.active.contains(&id);
                Evidence::Chosen(Chosen::of(occluders, id, rank, area_angle, leaf, direction, new))
            });
            self.active.choose(id);
            self.sets.push(id);
        }
        self.active.0.len() < self.params.occluders as usize
    }

    /// Computes how the eye sees an occluder, once a frame; whether it can hide anything.
    fn can_hide(&mut self, id: u32) -> bool {
        let (occluders, eye, margin) = (&self.index.occluders, self.eye, self.margin);
        let (scene, position, one_sided) =
            (self.scene, self.view.eye.position, self.params.surfaces.one_sided);
        let eye_side = self.memory.eye_side(id, |eye_side| {
            eye_side.look(occluders, id, eye, margin);
            // What is not drawn hides nothing.
            if eye_side.side != 0
                && one_sided
                && occluders.prims(id).iter().any(|&p| scene.faces_away(p, position))
            {
                eye_side.side = 0;
            }
        });
        eye_side.side != 0
    }

    /// 2. Figure 9, with view-frustum culling in front ("Frustum Culling", Section 3).
    fn visible(&mut self, id: NodeId, planes: u8, set: Range<usize>) {
        let index = self.index;
        let node = &index.tree.nodes()[id.at()];
        self.watch.event(Event::Entered(id));
        self.line(line::VISIBLE);
        // Planes that the parent lies wholly inside of need no test here.
        let mut cutting = 0;
        if planes != 0 {
            self.line(line::FRUSTUM);
            let test = self.frustum_test(node, planes);
            self.watch
                .note(move || Evidence::Tested(Tested::of(Subject::Node(id), &node.bounds, planes, test)));
            match test {
                FrustumTest::Outside(_) => {
                    // What is kept for it and below stays: "so that they can be reused later".
                    self.line(line::OUTSIDE);
                    self.watch.event(Event::DecidedNode(id, Verdict::Outside));
                    self.watch.event(Event::Left(id));
                    return;
                }
                FrustumTest::Partial(planes) => cutting = planes,
                FrustumTest::Inside => {}
            }
        }
        // The sets of all nodes on the way down lie one after the other, and this node's is cut off at the
        // end.
        self.line(line::TEST);
        let end = self.sets.len();
        match self.test_occlusion(Owner::Node(id), &node.bounds, set) {
            Fate::Hidden => {
                // "Temporal Coherence": what is kept below a node that is decided whole goes.
                self.line(line::FREE);
                self.line(line::IS_OCCLUDED);
                self.line(line::OCCLUDED);
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
        // No occluder is left that could hide any of it, as in the line above where all is hidden.
        if left.is_empty() {
            self.memory.forget_below(&index.tree, id);
        }
        // Lines 5 to 12; the frustum may cut it where no occluder does.
        let undecided = cutting != 0 || !left.is_empty();
        self.line(line::FREE);
        if !undecided {
            return self.keep(id, cutting, left, line::GATHER_FREE);
        }
        self.line(line::IS_OCCLUDED);
        self.line(line::IS_LEAF);
        let Some(children) = index.tree.nodes()[id.at()].children() else {
            return self.keep(id, cutting, left, line::GATHER_LEAF);
        };
        self.line(line::PASS);
        self.watch.event(Event::DecidedNode(id, Verdict::Partial));
        if self.params.cache && !left.is_empty() {
            self.memory.passed(id);
        }
        // The side of the Eye first: what is drawn later is then more often behind.
        let KdNode { axis, split, .. } = index.tree.nodes()[id.at()];
        let is_low = self.view.eye.position.get(axis.into()) <= split;
        for child in if is_low { children } else { [children[1], children[0]] } {
            self.line(line::CHILD);
            self.visible(child, cutting, left.clone());
        }
        self.finish_crossing(id);
    }

    /// Gathers a node at this line.
    fn keep(&mut self, id: NodeId, cutting: u8, left: Range<usize>, line: u8) {
        self.line(line);
        self.gather(id, cutting, left);
        // Back in Visible: what Gather did not leave out is drawn.
        self.line(line);
        self.watch.event(Event::DecidedNode(id, Verdict::Visible));
    }

    fn line(&mut self, line: u8) {
        self.watch.event(Event::Line(line));
    }

    /// Section 2, TestOcclusion of Figure 9. On return the occluders that partially occlude the box stand at
    /// the end of `self.sets`.
    fn test_occlusion(&mut self, owner: Owner, bounds: &Aabb<S::Vector>, set: Range<usize>) -> Fate {
        self.line(line::TEST_OCCLUSION);
        let depth = self.depth(bounds);
        let start = self.sets.len();
        self.candidates.clear();
        // Lines 2 to 10: each alone. One that fully occludes ends it, so that planes to the others need not
        // be made; the set is sorted by area-angle, and that one mostly comes early.
        let hider = if self.params.cache { self.memory.hider(owner) } else { None };
        // "Temporal Coherence": what hid it in the frame before, before all others.
        let first = hider.and_then(|id| set.clone().find(|&at| self.sets[at] == id));
        let tested = first.map(|at| {
            self.line(line::EACH);
            self.test_one(owner, bounds, self.sets[at], depth, at - set.start)
        });
        if let Some((Occlusion::Full, _)) = tested {
            return Fate::Hidden;
        }
        for at in set.clone() {
            let occluder = self.sets[at];
            let (occlusion, candidate) = match tested {
                Some(known) if first == Some(at) => known,
                _ => {
                    self.line(line::EACH);
                    self.test_one(owner, bounds, occluder, depth, at - set.start)
                }
            };
            match occlusion {
                Occlusion::Full => {
                    self.memory.hides(owner, occluder);
                    return Fate::Hidden;
                }
                Occlusion::Partial => {
                    self.sets.push(occluder);
                    self.candidates.extend(candidate);
                }
                Occlusion::None => {}
            }
        }
        // Lines 11 and 12: together.
        if self.candidates.len() > 1 {
            self.line(line::JOINTLY);
            let members = jointly(&self.index.occluders, &self.candidates, &mut self.memory.joint);
            if members != 0 {
                self.line(line::JOINT);
                let (occluders, candidates) = (&self.index.occluders, &self.candidates);
                self.watch.note(move || Evidence::Joined(Joined::of(occluders, owner, candidates, members)));
                return Fate::Hidden;
            }
        }
        Fate::Left(start..self.sets.len())
    }

    /// One occluder and one box. `near`: its place in the parent's set, which is about its place in what the
    /// box keeps.
    fn test_one(
        &mut self,
        owner: Owner,
        bounds: &Aabb<S::Vector>,
        id: u32,
        depth: f64,
        near: usize,
    ) -> (Occlusion, Option<Candidate>) {
        let (index, margin) = (self.index, self.margin);
        let side = self.memory.eye_side_of(id).side;
        let kept = if self.params.cache { self.memory.find(owner, id, side, near) } else { None };
        // Line 4. The planes do not depend on where the Eye is, as long as it stays on this side.
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
        // Lines 5 to 10.
        let eye_side = self.memory.eye_side_of(id);
        let thickness = index.occluders.thickness(id);
        let seen = relation.classify(eye_side, thickness, depth, margin);
        if O::LISTENS {
            report(
                &index.occluders,
                owner,
                relation,
                eye_side,
                seen,
                depth,
                margin,
                kept.is_some(),
                self.watch,
            );
        }
        let candidate = seen.behind.then_some(Candidate { occluder: id, side, seen });
        (seen.occlusion, candidate)
    }

    /// The greatest view depth of a box, rounded up.
    fn depth(&self, bounds: &Aabb<S::Vector>) -> f64 {
        let axis = |a: usize| {
            let (f, e) = (self.forward.get(a), self.eye.get(a));
            (f * (f64::from(bounds.min.get(a)) - e)).max(f * (f64::from(bounds.max.get(a)) - e))
        };
        // Component by component the greater end: the farthest corner without trying all of them. The factor
        // covers the rounding of the line of sight, which is in 32 bits, and then some.
        (0..S::Vector::AXES).map(axis).sum::<f64>() * (1.0 + 1e-5)
    }

    /// A node's box against the frustum.
    fn frustum_test(&self, node: &KdNode<S::Vector>, planes: u8) -> FrustumTest {
        let test = self.frustum.test(&node.bounds, planes);
        let far = 1 << (Frustum::<S::Vector>::PLANES - 1);
        match test {
            // The depth of a primitive is interpolated over all of it. What little that is off may bring a
            // part beyond the far plane before it, so the far plane leaves out whole primitives only.
            FrustumTest::Outside(plane) if 1 << plane.plane == far && !node.is_whole() => {
                match self.frustum.test(&node.bounds, planes & !far) {
                    FrustumTest::Inside => FrustumTest::Partial(far),
                    FrustumTest::Partial(cutting) => FrustumTest::Partial(cutting | far),
                    outside @ FrustumTest::Outside(_) => outside,
                }
            }
            _ => test,
        }
    }

    /// Step 3: draws the primitives at and below a node that the planes `cutting` cut and the occluders
    /// `left` partially occlude, but for detail objects that are out of view or that those or the occluders
    /// near them hide.
    fn gather(&mut self, id: NodeId, cutting: u8, left: Range<usize>) {
        let index = self.index;
        self.line(line::GATHER);
        let children = index.tree.nodes()[id.at()].children();
        // What an inner node has for itself crosses its plane, so leaves below refer to it again.
        for (object, prims) in index.own(id) {
            self.gather_object(id, object, prims, children.is_some(), cutting, left.clone());
        }
        for child in children.into_iter().flatten() {
            self.gather(child, cutting, left.clone());
        }
        for (object, prims) in index.shared(id) {
            self.gather_object(id, object, prims, true, cutting, left.clone());
        }
    }

    /// Draws primitives of an object that were met at a node, or leaves them out; those that are parted once
    /// a frame, since several leaves refer to them.
    fn gather_object(
        &mut self,
        id: NodeId,
        object: ObjectId,
        prims: &[PrimId],
        are_parted: bool,
        cutting: u8,
        left: Range<usize>,
    ) {
        let (fate, line) = if self.params.detail_objects {
            self.line(line::OBJECT);
            match self.fate(object, cutting, left) {
                Verdict::Hidden => (Verdict::Hidden, line::OBJECT_OCCLUDED),
                Verdict::Outside => (Verdict::Outside, line::OBJECT_OUTSIDE),
                fate => (fate, line::DRAW_OBJECT),
            }
        } else {
            (Verdict::Visible, line::DRAW_ALL)
        };
        if are_parted {
            prims.iter().for_each(|&prim| self.decide_once(id, prim, fate, line));
            return;
        }
        self.line(line);
        match fate {
            Verdict::Visible => self.draw(prims),
            // Decided by name: the node as a whole is called visible.
            fate => prims.iter().for_each(|&prim| self.watch.event(Event::DecidedPrim(prim, fate))),
        }
    }
    /// Draws a primitive that was met at a node and that several leaves refer to, or leaves it out.
    fn decide_once(&mut self, id: NodeId, prim: PrimId, fate: Verdict, line: u8) {
        if std::mem::replace(&mut self.memory.decided[prim.at()], true) {
            return;
        }
        self.line(line);
        if fate != Verdict::Visible {
            self.watch.event(Event::DecidedPrim(prim, fate));
            return;
        }
        self.watch.note(move || Evidence::Parted(Parted { prim, node: id, is_seen: true }));
        let drawn = self.out.prims.len();
        self.draw(&[prim]);
        // By name, for it is not among those that the node decides.
        if self.out.prims.len() > drawn {
            self.watch.event(Event::DecidedPrim(prim, Verdict::Visible));
        }
    }

    /// What crosses a node's plane and none of the leaves below has drawn: each of its parts is out of view
    /// or hidden.
    fn finish_crossing(&mut self, id: NodeId) {
        let index = self.index;
        for &prim in &index.tree.lists()[0][index.tree.own(id)] {
            if self.memory.decided[prim.at()] {
                continue;
            }
            if self.is_edge_on(prim) {
                self.decide_once(id, prim, Verdict::Visible, line::CROSSING);
            } else {
                self.line(line::CROSSING);
                self.watch.note(move || Evidence::Parted(Parted { prim, node: id, is_seen: false }));
                self.watch.event(Event::DecidedPrim(prim, Verdict::Hidden));
            }
        }
    }

    /// Whether the eye sees a primitive so much from its edge that the depth of a part of it may be off by
    /// more than the margin of [`PARTS_DEPTH`].
    ///
    /// The rasterizer's depth is `z + dx·X + dy·Y` in 32 bits, X and Y from the farthest corner as snapped.
    /// The sum of the terms' amounts exceeds the depth itself, along the plane's horizon, by at most `(1 +
    /// t)·L/H`: H the distance of the eye from the plane, L the longest edge, t the tangent of the angle
    /// from the line of sight to a corner of the image. Each term is rounded a few times by 2⁻²⁴. In
    /// flatland there is but one term.
    fn is_edge_on(&self, prim: PrimId) -> bool {
        if S::Vector::AXES == 2 {
            return false;
        }
        let mut corners = [S::Point::default(); 3];
        corners.iter_mut().zip(self.scene.prim_points(prim)).for_each(|(to, p)| *to = S::widened(p));
        let area = S::area(&corners);
        let height = area.dot(self.eye - corners[0]).abs() / area.length();
        let sides = [[0, 1], [1, 2], [2, 0]].map(|[a, b]: [usize; 2]| (corners[b] - corners[a]).length());
        let longest = sides.into_iter().fold(0.0, f64::max);
        let is_near = height * EDGE_ON <= longest * self.spread;
        is_near && !self.frustum.excludes(&self.scene.prim_bounds(prim))
    }

    /// Draws primitives, without those that face away if back faces are culled.
    fn draw(&mut self, prims: &[PrimId]) {
        if !self.params.surfaces.one_sided {
            self.out.prims.extend_from_slice(prims);
            return;
        }
        let (scene, view) = (self.scene, self.view);
        for &prim in prims {
            self.line(line::POLYGON);
            self.line(line::FACING);
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            if scene.faces_away(prim, view.eye.position) {
                self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
            } else {
                self.line(line::DRAW);
                self.out.prims.push(prim);
            }
        }
    }

    /// Section 3.2: whether a detail object is hidden by what looks large from it toward the eye, since
    /// visibility between two points goes both ways. Found out once a frame.
    fn fate(&mut self, object: ObjectId, cutting: u8, left: Range<usize>) -> Verdict {
        if let Some(known) = self.memory.fates[object.at()] {
            return known;
        }
        // An object in several leaves is gathered once for each.
        let index = self.index;
        let fate = match &index.details[object.at()] {
            Some(bounds) if cutting != 0 && self.is_outside(object, bounds, cutting) => Verdict::Outside,
            Some(bounds) if self.is_hidden(object, bounds, left) => Verdict::Hidden,
            _ => Verdict::Visible,
        };
        self.memory.fates[object.at()] = Some(fate);
        fate
    }

    fn is_outside(&mut self, object: ObjectId, bounds: &Aabb<S::Vector>, planes: u8) -> bool {
        self.line(line::OBJECT_OUTSIDE);
        let test = self.frustum.test(bounds, planes);
        self.watch.note(move || Evidence::Tested(Tested::of(Subject::Object(object), bounds, planes, test)));
        matches!(test, FrustumTest::Outside(_))
    }

    fn is_hidden(&mut self, object: ObjectId, bounds: &Aabb<S::Vector>, left: Range<usize>) -> bool {
        let index = self.index;
        self.line(line::DETAIL);
        // "Visibility between two points is reflexive": occluders that look large from the center toward the
        // Eye are near the object, though the Eye may see none of them large.
        let center = bounds.center();
        let direction = index.selection.direction_of::<S>(self.eye - S::widened(center));
        let (most, one_sided) = (self.params.occluders as usize, self.params.surfaces.one_sided);
        let (occluders, center) = (&index.occluders, S::widened(center));
        // What cuts or touches the object's box, as its own primitives do, cannot hide all of it; of
        // one-sided ones those can that show it their back.
        let can_hide = |id: &u32| {
            !occluders.cuts(*id, bounds) && (!one_sided || occluders.heights(*id, bounds)[1] < 0.0)
        };
        // The lists lack what has no scene behind it, as seen from within. To an Eye outside that may be what
        // hides most, as a roof.
        let is_inside = index.tree.nodes()[0].bounds.contains(self.view.eye.position);
        let near = self.memory.near(object, (direction, is_inside), |list| {
            if is_inside {
                let leaf = leaf_at::<S>(&index.tree, bounds.center());
                let listed = index.selection.list(leaf, direction).filter(can_hide);
                ranked_from(occluders, listed, center, list);
                list.truncate(most);
            } else {
                list.clear();
                index.selection.search(occluders, &index.ranking, center, direction, |id, area| {
                    if can_hide(&id) {
                        list.push((id, area));
                    }
                    list.len() < most && area >= least_angle::<S>()
                });
            }
        });
        // "It is necessary to perform the visibility test on the entire detail object."
        // First those that hide a part of the node in which it is met: what is large from the Eye and far
        // from the object may hide it too.
        let start = self.sets.len();
        self.sets.extend_from_within(left);
        for at in 0..near {
            let id = self.memory.near_to(object, at);
            if self.sets.len() - start < MOST_CANDIDATES
                && self.can_hide(id)
                && !self.sets[start..].contains(&id)
            {
                self.sets.push(id);
            }
        }
        let set = start..self.sets.len();
        let hidden = matches!(self.test_occlusion(Owner::Object(object), bounds, set), Fate::Hidden);
        self.sets.truncate(start);
        hidden
    }
}

/// Lines 3 to 10 of TestOcclusion with the evidence of each, edge by edge, as [`Relation::classify`] went
/// through them.
#[expect(clippy::too_many_arguments, reason = "the operands of one test")]
fn report<S: Shape, O: Observer<Evidence<S>>>(
    occluders: &Occluders<S>,
    owner: Owner,
    relation: &Relation<S>,
    eye_side: &EyeSide<S>,
    seen: Classified,
    depth: f64,
    margin: Margin,
    reused: bool,
    watch: &mut O,
) {
    let lines = |lines: &[u8], watch: &mut O| lines.iter().for_each(|&l| watch.event(Event::Line(l)));
    lines(&[line::BEFORE], watch);
    if !relation.planes.is_empty() {
        lines(&[line::PLANES], watch);
        for (edge, test) in relation.edge_tests(eye_side, depth, margin).enumerate() {
            lines(&[line::EDGE], watch);
            watch.note(|| Evidence::Edge(Edge::of(occluders, owner, relation, edge, test)));
        }
        lines(&[line::SUPPORTING], watch);
        lines(
            match seen.occlusion {
                Occlusion::Full => &[line::FULL][..],
                Occlusion::Partial => &[line::SEPARATING, line::PARTIAL],
                Occlusion::None => &[line::SEPARATING, line::NONE],
            },
            watch,
        );
    }
    watch.note(|| {
        Evidence::Related(Related::of(occluders, owner, relation, eye_side, seen, depth, margin, reused))
    });
}
