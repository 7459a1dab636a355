//! What is kept from frame to frame (Section 3): the relations of nodes and detail objects to occluders.
//!
//! A relation holds as long as the eye stays on one side of the occluder, so it is checked and not computed
//! again. Those below a node that is decided as a whole are forgotten; those outside the frustum are kept.
//! At most [`KEPT`] relations a node are kept, so memory is bounded by the tree and not by the length of a
//! walk.

use super::relation::{EyeSide, Relation};
use super::space::Shape;
use crate::geometry::{NodeId, ObjectId};
use crate::index::KdTree;
use crate::method::Verdict;

/// Relations that one node or object keeps at most: twice the largest set of active occluders, so that a
/// viewer who turns back finds the set of the direction before still there.
const KEPT: usize = 128;

/// See the module. Made for one scene and its parameters.
#[derive(Clone, Debug)]
pub struct Memory<S: Shape> {
    nodes: Vec<Kept<S>>,
    objects: Vec<Kept<S>>,
    /// Whether a node or one below it keeps anything.
    below: Vec<bool>,
    /// The occluders in use, best first.
    pub active: Vec<u32>,
    /// For each detail object the occluders near it, for the latest direction.
    near: Vec<Option<(Sight, Box<[u32]>)>>,
    list: Vec<(u32, f32)>,
    /// How the eye of this frame sees each occluder that was looked up.
    eye_sides: Vec<EyeSide<S>>,
    /// Whether an occluder was looked up in this frame, and the list of those that were.
    fresh: Vec<bool>,
    seen: Vec<u32>,
    pub joint: super::joint::Scratch,
    /// Objects that keep relations, in no order that matters.
    keeping: Vec<ObjectId>,
    /// What this frame found out about each detail object.
    pub fates: Vec<Option<Verdict>>,
    /// Whether this frame has decided a primitive that several leaves refer to.
    pub decided: Vec<bool>,
}

/// The relations of one node or object.
#[derive(Clone, Debug)]
struct Kept<S: Shape> {
    relations: Vec<Relation<S>>,
    /// Occluder and side of each, apart: a search reads a few bytes of each and not all of its planes.
    names: Vec<(u32, i8)>,
    /// The occluder that hid it when it was last hidden, which mostly hides it still.
    hider: Option<u32>,
}

impl<S: Shape> Default for Kept<S> {
    fn default() -> Self {
        Self { relations: Vec::new(), names: Vec::new(), hider: None }
    }
}

impl<S: Shape> Default for Memory<S> {
    fn default() -> Self {
        Self {
            nodes: Vec::new(),
            objects: Vec::new(),
            below: Vec::new(),
            active: Vec::new(),
            near: Vec::new(),
            list: Vec::new(),
            eye_sides: Vec::new(),
            fresh: Vec::new(),
            seen: Vec::new(),
            joint: super::joint::Scratch::default(),
            keeping: Vec::new(),
            fates: Vec::new(),
            decided: Vec::new(),
        }
    }
}

impl<S: Shape> Kept<S> {
    /// Forgets relations to some occluders (ascending).
    fn forget(&mut self, occluders: &[u32]) {
        let names = &self.names;
        if names.iter().any(|(id, _)| occluders.binary_search(id).is_ok()) {
            let stays = |at: usize| occluders.binary_search(&names[at].0).is_err();
            let mut at = 0..names.len();
            self.relations.retain(|_| at.next().is_some_and(stays));
            self.names.retain(|(id, _)| occluders.binary_search(id).is_err());
        }
        self.hider = self.hider.filter(|id| occluders.binary_search(id).is_err());
    }
}

/// A direction, and whether the Eye stands within the scene's box.
pub type Sight = (u32, bool);

/// Whose relations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    Node(NodeId),
    Object(ObjectId),
}

impl<S: Shape> Memory<S> {
    /// Forgets what is no longer true in another frame of the scene: of nodes with other bounds, of objects
    /// that moved, and of occluders that did, ascending.
    pub fn follow(&mut self, nodes: &[NodeId], objects: &[ObjectId], occluders: &[u32]) {
        // Before the first frame nothing is kept.
        if self.nodes.is_empty() {
            return;
        }
        nodes.iter().for_each(|node| self.nodes[node.at()] = Kept::default());
        for object in objects {
            (self.objects[object.at()], self.near[object.at()]) = (Kept::default(), None);
        }
        if occluders.is_empty() {
            return;
        }
        self.nodes.iter_mut().chain(&mut self.objects).for_each(|kept| kept.forget(occluders));
        // Those near an object are chosen so that they do not cut it.
        self.near.fill(None);
    }
    /// Begins a frame: earlier eye_sides are stale, relations are not.
    pub fn begin(&mut self, nodes: usize, objects: usize, occluders: usize, prims: usize) {
        // Only the first frame grows anything: the memory belongs to one index.
        self.nodes.resize_with(nodes, Kept::default);
        self.below.resize(nodes, false);
        self.objects.resize_with(objects, Kept::default);
        self.near.resize(objects, None);
        self.eye_sides.resize_with(occluders, EyeSide::default);
        self.fresh.resize(occluders, false);
        // Only what the last frame looked up: most occluders of a scene are far from any one place.
        self.seen.drain(..).for_each(|id| self.fresh[id as usize] = false);
        self.fates.resize(objects, None);
        self.decided.clear();
        self.decided.resize(prims, false);
        // "Until the node is no longer involved in the visibility calculation" (Section 3), said of objects:
        // those that the last frame did not decide keep nothing.
        let (fates, kept, near) = (&mut self.fates, &mut self.objects, &mut self.near);
        self.keeping.sort_unstable();
        self.keeping.dedup();
        self.keeping.retain(|object| {
            let was_decided = fates[object.at()].take().is_some();
            if !was_decided {
                (kept[object.at()], near[object.at()]) = (Kept::default(), None);
            }
            was_decided
        });
        fates.fill(None);
    }
    /// Number of occluders near a detail object for a direction, chosen by `choose` if the latest direction
    /// was another.
    pub fn near(
        &mut self,
        object: ObjectId,
        direction: Sight,
        choose: impl FnOnce(&mut Vec<(u32, f32)>),
    ) -> usize {
        // Chosen again only when the object is seen from another direction: a walk past it asks a few times.
        let slot = &mut self.near[object.at()];
        if slot.as_ref().is_none_or(|n| n.0 != direction) {
            // One buffer for all objects. Only the numbers are kept: the area-angles have served when the
            // best are found.
            choose(&mut self.list);
            *slot = Some((direction, self.list.iter().map(|l| l.0).collect()));
            self.keeping.push(object);
        }
        slot.as_ref().map_or(0, |n| n.1.len())
    }
    /// One of the occluders near a detail object.
    pub fn near_to(&self, object: ObjectId, at: usize) -> u32 {
        self.near[object.at()].as_ref().map_or(0, |n| n.1[at])
    }
    /// How the eye sees an occluder, computed by `look` at the first lookup of a frame.
    #[inline]
    pub fn eye_side(&mut self, id: u32, look: impl FnOnce(&mut EyeSide<S>)) -> &EyeSide<S> {
        let eye_side = &mut self.eye_sides[id as usize];
        if !std::mem::replace(&mut self.fresh[id as usize], true) {
            look(eye_side);
            self.seen.push(id);
        }
        eye_side
    }
    /// What [`Memory::eye_side`] computed.
    #[inline]
    pub fn eye_side_of(&self, id: u32) -> &EyeSide<S> {
        // Not asked whether it is fresh: an occluder gets into a set only after `Walk::can_hide` looked at
        // it.
        &self.eye_sides[id as usize]
    }
    /// The kept relation to an occluder, if the eye is still on the side it holds for; `near`: where to look
    /// first.
    pub fn find(&self, owner: Owner, occluder: u32, side: i8, near: usize) -> Option<usize> {
        // A set changes little from frame to frame, so a relation is mostly found at its place or just
        // behind.
        let (names, wanted) = (&self.of(owner).names, (occluder, side));
        let n = names.len();
        (near..n).chain(0..near.min(n)).find(|&i| names[i] == wanted)
    }
    /// A kept relation.
    pub fn get(&self, owner: Owner, at: usize) -> &Relation<S> {
        &self.of(owner).relations[at]
    }
    fn of(&self, owner: Owner) -> &Kept<S> {
        match owner {
            Owner::Node(n) => &self.nodes[n.at()],
            Owner::Object(o) => &self.objects[o.at()],
        }
    }
    /// The occluder that hid a box when it was last hidden by one alone.
    pub fn hider(&self, owner: Owner) -> Option<u32> {
        self.of(owner).hider
    }
    /// An occluder hides a box.
    pub fn hides(&mut self, owner: Owner, occluder: u32) {
        match owner {
            Owner::Node(n) => self.nodes[n.at()].hider = Some(occluder),
            Owner::Object(o) => self.objects[o.at()].hider = Some(occluder),
        }
    }
    /// Keeps a relation in place of one for the other side; returns where it is.
    pub fn keep(&mut self, owner: Owner, relation: Relation<S>) -> usize {
        // A mark at the node says that `forget_below` of an ancestor has something to do here.
        let kept = match owner {
            Owner::Node(n) => {
                self.below[n.at()] = true;
                &mut self.nodes[n.at()]
            }
            Owner::Object(o) => &mut self.objects[o.at()],
        };
        // The eye went to the other side: the planes there are others, and the old ones are of no use.
        let name = (relation.occluder, relation.side);
        if let Some(at) = kept.names.iter().position(|(occluder, _)| *occluder == relation.occluder) {
            (kept.relations[at], kept.names[at]) = (relation, name);
            return at;
        }
        if kept.names.len() >= KEPT {
            // The oldest half goes: what is in use will be kept again.
            kept.relations.drain(..KEPT / 2);
            kept.names.drain(..KEPT / 2);
        }
        kept.relations.push(relation);
        kept.names.push(name);
        kept.names.len() - 1
    }
    /// A node on the way down keeps something below it.
    pub fn passed(&mut self, node: NodeId) {
        self.below[node.at()] = true;
    }
    /// Forgets what is kept below a node (and not at it), since it was decided as a whole.
    pub fn forget_below(&mut self, tree: &KdTree<S::Vector>, node: NodeId) {
        // Mostly nothing was kept: without this mark every hidden subtree would be walked in every frame.
        if !self.below[node.at()] {
            return;
        }
        let Some(children) = tree.nodes()[node.at()].children() else { return };
        // What the decided node itself keeps stays: the next frame needs it to decide again.
        for child in children {
            self.forget_below(tree, child);
            self.nodes[child.at()] = Kept::default();
            self.below[child.at()] = false;
        }
    }
}
