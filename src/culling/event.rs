//! The shared vocabulary: what every method says while it works, and who listens.

use std::collections::BTreeMap;

use super::{Field, Value};
use crate::geometry::{NodeId, PrimId};

/// What was decided about a node (and all below it) or a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Verdict {
    /// Not in the view volume, or facing away.
    Outside,
    /// In the view volume, behind something.
    Hidden,
    /// Undecided as a whole: decided piece by piece.
    Partial,
    /// In the answer.
    Visible,
    /// A stand-in was drawn for it.
    Approximated,
    /// Left out because the budget was spent.
    OverBudget,
}

impl Verdict {
    /// Kebab-case name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Hidden => "hidden",
            Self::Partial => "partial",
            Self::Visible => "visible",
            Self::Approximated => "approximated",
            Self::OverBudget => "over-budget",
        }
    }
}

/// A fact, in the past tense. Anything bigger than 16 bytes goes in the method's own notes, and
/// `Noted` holds its index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A frame began.
    FrameBegan,
    /// The traversal reached a node.
    Entered(NodeId),
    /// The traversal is done with a node and all below it.
    Left(NodeId),
    /// A node was put into the method's queue with this priority.
    Queued(NodeId, f32),
    /// A node was decided; unless `Partial`, all below it with it.
    DecidedNode(NodeId, Verdict),
    /// A primitive was decided.
    DecidedPrim(PrimId, Verdict),
    /// Execution reached this line of [`super::Card::code`].
    Line(u8),
    /// Evidence that only this method understands; index into its notes.
    Noted(u32),
}
const _: () = assert!(size_of::<Event>() <= 16, "events are kept by the million");

/// Kind and operands of an event that is not a note.
pub(super) fn fields(event: Event, code: &[super::CodeLine]) -> (&'static str, Vec<Field>) {
    let integer = |name, v: u32| Field { name, value: Value::Integer(v.into()) };
    let word = |name, v: &str| Field { name, value: Value::Word(v.to_owned()) };
    match event {
        Event::FrameBegan => ("FrameBegan", vec![]),
        Event::Entered(n) => ("NodeEntered", vec![integer("node", n.0)]),
        Event::Left(n) => ("NodeLeft", vec![integer("node", n.0)]),
        Event::Queued(n, key) => ("NodeQueued", vec![integer("node", n.0), Field { name: "priority", value: Value::Number(key.into()) }]),
        Event::DecidedNode(n, v) => ("NodeDecided", vec![integer("node", n.0), word("verdict", v.name())]),
        Event::DecidedPrim(p, v) => ("PrimDecided", vec![integer("prim", p.0), word("verdict", v.name())]),
        Event::Line(i) => ("LineReached", vec![word("text", code[i as usize].text.trim())]),
        Event::Noted(i) => ("Noted", vec![integer("note", i)]),
    }
}

/// Listens to a run. It cannot answer: nothing is returned and no state is seen, so a watched run and
/// an unwatched one cannot differ.
pub trait Observer<Note> {
    /// A fact in the shared vocabulary.
    fn event(&mut self, event: Event);
    /// A piece of evidence. The closure runs only if someone is listening.
    fn note(&mut self, note: impl FnOnce() -> Note);
}

/// Nobody listens; compiles to nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl<N> Observer<N> for Unobserved {
    #[inline(always)]
    fn event(&mut self, _: Event) {}
    #[inline(always)]
    fn note(&mut self, _: impl FnOnce() -> N) {}
}

/// Counts, for tables. Deterministic, so they are the primary measure of cost.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Nodes entered.
    pub nodes_entered: u64,
    /// Nodes decided whole, that is not `Partial`.
    pub nodes_decided: u64,
    /// Primitives decided one by one.
    pub prims_decided: u64,
    /// The method's own counts by name, such as `planes_tested`.
    pub own: BTreeMap<&'static str, u64>,
}

impl Tally {
    /// Adds to a count of the method's own.
    #[inline]
    pub fn add(&mut self, name: &'static str, by: u64) {
        *self.own.entry(name).or_default() += by;
    }
    /// All counts by name.
    pub fn named(&self) -> BTreeMap<&'static str, u64> {
        let mut all = self.own.clone();
        all.extend([("nodes_entered", self.nodes_entered), ("nodes_decided", self.nodes_decided), ("prims_decided", self.prims_decided)]);
        all
    }
}

/// Evidence that can be counted.
pub trait Tallied {
    /// Adds what this piece of evidence stands for to the method's own counts.
    fn tally(&self, tally: &mut Tally);
}

impl<N: Tallied> Observer<N> for Tally {
    #[inline]
    fn event(&mut self, event: Event) {
        match event {
            Event::Entered(_) => self.nodes_entered += 1,
            Event::DecidedNode(_, verdict) => self.nodes_decided += u64::from(verdict != Verdict::Partial),
            Event::DecidedPrim(..) => self.prims_decided += 1,
            _ => {}
        }
    }
    #[inline]
    fn note(&mut self, note: impl FnOnce() -> N) {
        note().tally(self);
    }
}

/// Keeps everything up to a cap.
#[derive(Clone, Debug)]
pub struct Recorder<N> {
    /// Events in order.
    pub events: Vec<Event>,
    /// `Event::Noted(i)` refers to `notes[i]`.
    pub notes: Vec<N>,
    /// Events beyond the cap, which were not kept.
    pub lost: u64,
    cap: usize,
}

impl<N> Recorder<N> {
    /// A recorder that keeps the first `cap` events.
    pub fn new(cap: usize) -> Self {
        Self { events: Vec::new(), notes: Vec::new(), lost: 0, cap }
    }
}

impl<N> Observer<N> for Recorder<N> {
    #[inline]
    fn event(&mut self, event: Event) {
        if self.events.len() < self.cap {
            self.events.push(event);
        } else {
            self.lost += 1;
        }
    }
    #[inline]
    fn note(&mut self, note: impl FnOnce() -> N) {
        if self.events.len() < self.cap {
            self.events.push(Event::Noted(self.notes.len() as u32));
            self.notes.push(note());
        } else {
            self.lost += 1;
        }
    }
}
