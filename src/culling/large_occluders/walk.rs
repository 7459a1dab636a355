//! The traversal: Figure 9, with view-frustum culling in front and detail objects behind.
//!
//! One frame is: 1. select the active occluders (Section 3.1); 2. visit the kD-tree from the root: cull by
//! the frustum, test against the occluders that partially occlude the parent, drop, keep, or go on to the
//! children (Section 3); 3. gather what survives, object by object (Section 3.2).

use std::ops::Range;

use super::explain::{Chosen, Edge, Evidence, Joined, Related};
use super::index::Index;
use super::joint::{Candidate, jointly};
use super::memory::{Memory, Owner};
use super::occluders::Occluders;
use super::relation::{Classified, EyeSide, Margin, Occlusion, Relation};
use super::selection::{largest_from, leaf_at};
use super::space::{Point, Shape};
use super::{Active, LargeOccluders, Params, line};
use crate::drawing::Subject;
use crate::geometry::{Aabb, Frustum, FrustumTest, NodeId, ObjectId, PrimId, Vector, View};
use crate::method::evidence::{Facing, Tested, prim_faces_away};
use crate::method::{DrawList, Event, Frame, Observer, Verdict};
use crate::scene::Scene;

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
        memory.begin(index.tree.nodes().len(), index.details.len(), index.occluders.len());
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
            margin: Margin::of(view),
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
        let leaf = leaf_at::<S>(&index.tree, self.view.eye.position);
        let direction = index.selection.direction_of::<S>(self.forward);
        // A departure: the paper takes the list as it is. A leaf may be large, so of its list, which is
        // longer than k, those are taken that look largest from the Eye itself.
        let mut list = Vec::new();
        largest_from(
            &index.occluders,
            index.selection.list(leaf, direction).iter(),
            self.eye,
            self.params.occluders,
            &mut list,
        );
        for (rank, &(id, area_angle)) in list.iter().enumerate() {
            self.line(line::PICK);
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
            // Active, though it may hide nothing from here, as from within its plane.
            self.active.choose(id);
            if self.can_hide(id) {
                self.sets.push(id);
            }
        }
        self.memory.active.clone_from(&self.active.0);
    }

    /// Computes how the eye sees an occluder, once a frame; whether it can hide anything.
    fn can_hide(&mut self, id: u32) -> bool {
        let (occluders, eye, margin) = (&self.index.occluders, self.eye, self.margin);
        let (scene, position, one_sided) = (self.scene, self.view.eye.position, self.params.backface_culling);
        let eye_side = self.memory.eye_side(id, |eye_side| {
            eye_side.look(occluders, id, eye, margin);
            // What is not drawn hides nothing.
            if eye_side.side != 0
                && one_sided
                && occluders.prims(id).iter().any(|&p| prim_faces_away(scene, position, p))
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
            let test = self.frustum.test(&node.bounds, planes);
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
            return self.keep(id, cutting, line::GATHER_FREE);
        }
        self.line(line::IS_OCCLUDED);
        self.line(line::IS_LEAF);
        let Some(children) = index.tree.nodes()[id.at()].children() else {
            return self.keep(id, cutting, line::GATHER_LEAF);
        };
        self.line(line::PASS);
        self.watch.event(Event::DecidedNode(id, Verdict::Partial));
        if self.params.cache && !left.is_empty() {
            self.memory.passed(id);
        }
        for child in children {
            self.line(line::CHILD);
            self.visible(child, cutting, left.clone());
        }
    }

    /// Gathers a node at this line.
    fn keep(&mut self, id: NodeId, cutting: u8, line: u8) {
        self.line(line);
        self.gather(id, cutting);
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
        for at in set.clone() {
            let occluder = self.sets[at];
            self.line(line::EACH);
            let (occlusion, candidate) = self.test_one(owner, bounds, occluder, depth, at - set.start);
            match occlusion {
                Occlusion::Full => return Fate::Hidden,
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

    /// Step 3: draws the primitives of a node that the planes `cutting` cut, but for detail objects that are
    /// out of view or that the occluders near them hide.
    fn gather(&mut self, id: NodeId, cutting: u8) {
        let index = self.index;
        self.line(line::GATHER);
        if !self.params.detail_objects {
            self.line(line::DRAW_ALL);
            self.draw(index.tree.prims_below(id));
            return;
        }
        for (object, prims) in index.objects_of(id) {
            self.line(line::OBJECT);
            match self.fate(object, cutting) {
                Verdict::Visible => {
                    self.line(line::DRAW_OBJECT);
                    self.draw(prims);
                }
                // Decided by name: the node as a whole is called visible.
                fate => {
                    self.line(if fate == Verdict::Hidden {
                        line::OBJECT_OCCLUDED
                    } else {
                        line::OBJECT_OUTSIDE
                    });
                    prims.iter().for_each(|&prim| self.watch.event(Event::DecidedPrim(prim, fate)));
                }
            }
        }
    }

    /// Draws primitives, without those that face away if back faces are culled.
    fn draw(&mut self, prims: &[PrimId]) {
        if !self.params.backface_culling {
            self.out.prims.extend_from_slice(prims);
            return;
        }
        let (scene, view) = (self.scene, self.view);
        for &prim in prims {
            self.line(line::POLYGON);
            self.line(line::FACING);
            self.watch.note(move || Evidence::Facing(Facing::of(prim)));
            if prim_faces_away(scene, view.eye.position, prim) {
                self.watch.event(Event::DecidedPrim(prim, Verdict::FacesAway));
            } else {
                self.line(line::DRAW);
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
        // An object in several leaves is gathered once for each.
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
        self.line(line::OBJECT_OUTSIDE);
        let test = self.frustum.test(bounds, planes);
        self.watch.note(move || Evidence::Tested(Tested::of(Subject::Object(object), bounds, planes, test)));
        matches!(test, FrustumTest::Outside(_))
    }

    fn is_hidden(&mut self, object: ObjectId, bounds: &Aabb<S::Vector>) -> bool {
        let index = self.index;
        self.line(line::DETAIL);
        // "Visibility between two points is reflexive": occluders that look large from the center toward the
        // Eye are near the object, though the Eye may see none of them large.
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
        // "It is necessary to perform the visibility test on the entire detail object."
        let start = self.sets.len();
        for at in 0..near {
            let id = self.memory.near_to(object, at);
            if self.can_hide(id) {
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
