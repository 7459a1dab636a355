//! The shared vocabulary: what every method says while it works, and who listens.

use std::collections::BTreeMap;

use super::{Field, Value};
use crate::drawing::Subject;
use crate::geometry::{NodeId, PrimId};

/// What was decided about a node (and all below it) or a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Verdict {
    /// Not in the view volume.
    Outside,
    /// One-sided, and turned away from the eye.
    FacesAway,
    /// In the view volume, behind something.
    Hidden,
    /// Left out as hidden, though not proven: something that the method does not count may show it.
    Presumed,
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
            Self::FacesAway => "faces-away",
            Self::Hidden => "hidden",
            Self::Presumed => "presumed",
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

impl Event {
    /// What happened, in the past tense and camel case; of evidence the note knows better.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::FrameBegan => "FrameBegan",
            Self::Entered(_) => "NodeEntered",
            Self::Left(_) => "NodeLeft",
            Self::Queued(..) => "NodeQueued",
            Self::DecidedNode(..) => "NodeDecided",
            Self::DecidedPrim(..) => "PrimDecided",
            Self::Line(_) => "LineReached",
            Self::Noted(_) => "Noted",
        }
    }
    /// The node or primitive that it is about; of evidence the note knows better.
    pub fn subject(&self) -> Subject {
        match *self {
            Self::Entered(n) | Self::Left(n) | Self::Queued(n, _) | Self::DecidedNode(n, _) => {
                Subject::Node(n)
            }
            Self::DecidedPrim(p, _) => Subject::Prim(p),
            Self::FrameBegan | Self::Line(_) | Self::Noted(_) => Subject::None,
        }
    }
    /// The verdict, if it is a decision.
    pub fn verdict(&self) -> Option<Verdict> {
        match *self {
            Self::DecidedNode(_, v) | Self::DecidedPrim(_, v) => Some(v),
            _ => None,
        }
    }
    /// Its operands by name.
    pub(super) fn fields(self, code: &[super::CodeLine]) -> Vec<Field> {
        let integer = |name, v: u32| Field { name, value: Value::Integer(v.into()) };
        let word = |name, v: &str| Field { name, value: Value::Word(v.to_owned()) };
        match self {
            Self::FrameBegan => vec![],
            Self::Entered(n) | Self::Left(n) => vec![integer("node", n.0)],
            Self::Queued(n, key) => {
                vec![integer("node", n.0), Field { name: "priority", value: Value::Number(key.into()) }]
            }
            Self::DecidedNode(n, v) => vec![integer("node", n.0), word("verdict", v.name())],
            Self::DecidedPrim(p, v) => vec![integer("prim", p.0), word("verdict", v.name())],
            Self::Line(i) => vec![word("text", code[i as usize].text.trim())],
            Self::Noted(i) => vec![integer("note", i)],
        }
    }
}

/// Listens to a run. It cannot answer: nothing is returned and no state is seen, so a watched run and
/// an unwatched one cannot differ.
pub trait Observer<Note> {
    /// Whether anyone is listening. Use it to skip work that only reports or fixes an order of work; never to
    /// change a decision.
    const LISTENS: bool = true;
    /// Whether what notes hold is kept. Where it is only counted what they are, what takes long to find out
    /// for them need not be.
    const KEEPS: bool = Self::LISTENS;
    /// A fact in the shared vocabulary.
    fn event(&mut self, event: Event);
    /// A piece of evidence. The closure runs only if someone is listening.
    fn note(&mut self, note: impl FnOnce() -> Note);
    /// A stage of the frame begins; the one before ends. For clocks that do not belong here.
    #[inline(always)]
    fn stage(&mut self, _name: &'static str) {}
}

/// Nobody listens; compiles to nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl<N> Observer<N> for Unobserved {
    const LISTENS: bool = false;
    #[inline(always)]
    fn event(&mut self, _: Event) {}
    #[inline(always)]
    fn note(&mut self, _: impl FnOnce() -> N) {}
}

/// Counts, for tables. Deterministic, so they are the primary measure of cost.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// Nodes entered.
    pub nodes_entered: u64,
    /// Nodes decided whole, that is not `Partial`.
    pub nodes_decided: u64,
    /// Primitives decided one by one.
    pub prims_decided: u64,
    // What the evidence that methods share stands for. These are counted at every node: each has a place of
    // its own, where a name would have to be looked up.
    pub(super) boxes_tested: u64,
    pub(super) planes_tested: u64,
    pub(super) orientations_tested: u64,
    /// The method's own counts, in the order of their first use. A handful that is looked up at every
    /// test: a scan by address is cheaper than a map.
    own: Vec<(&'static str, u64)>,
}

impl Tally {
    /// Adds to a count of the method's own.
    #[inline]
    pub fn add(&mut self, name: &'static str, by: u64) {
        // The same literal mostly has the same address. Where it has not, `add_by_text` finds it.
        match self.own.iter_mut().find(|(known, _)| std::ptr::eq(*known, name)) {
            Some((_, count)) => *count += by,
            None => self.add_by_text(name, by),
        }
    }
    /// Raises a count of the method's own to `least`.
    pub fn at_least(&mut self, name: &'static str, least: u64) {
        match self.own.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count = least.max(*count),
            None => self.own.push((name, least)),
        }
    }
    #[cold]
    fn add_by_text(&mut self, name: &'static str, by: u64) {
        match self.own.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += by,
            None => self.own.push((name, by)),
        }
    }
    /// All counts by name.
    pub fn named(&self) -> BTreeMap<&'static str, u64> {
        let mut all: BTreeMap<_, _> = self.own.iter().copied().collect();
        // Counts of tests that a method never makes are not its own.
        if self.boxes_tested > 0 {
            all.extend([("boxes_tested", self.boxes_tested), ("planes_tested", self.planes_tested)]);
        }
        if self.orientations_tested > 0 {
            all.insert("orientations_tested", self.orientations_tested);
        }
        all.extend([
            ("nodes_entered", self.nodes_entered),
            ("nodes_decided", self.nodes_decided),
            ("prims_decided", self.prims_decided),
        ]);
        all
    }
}

/// The order of first use does not count.
impl PartialEq for Tally {
    fn eq(&self, other: &Self) -> bool {
        self.named() == other.named()
    }
}
impl Eq for Tally {}

/// Evidence that can be counted.
pub trait Tallied {
    /// Adds what this piece of evidence stands for to the method's own counts.
    fn tally(&self, tally: &mut Tally);
}

impl<N: Tallied> Observer<N> for Tally {
    const KEEPS: bool = false;
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
    /// Makes room for as many events and notes as are expected, within the cap.
    pub fn expect(&mut self, events: usize, notes: usize) {
        self.events.reserve(events.min(self.cap));
        self.notes.reserve(notes.min(self.cap));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_counts_are_found_by_address_and_by_text() {
        let mut tally = Tally { nodes_entered: 2, ..Tally::default() };
        let elsewhere: &'static str = Box::leak("cells_tested".to_owned().into_boxed_str());
        for (name, by) in
            [("cells_tested", 3), ("marks", 1), (elsewhere, 4), ("cells_tested", 5), (&elsewhere[..5], 7)]
        {
            tally.add(name, by);
        }
        let want = [
            ("cells", 7),
            ("cells_tested", 12),
            ("marks", 1),
            ("nodes_decided", 0),
            ("nodes_entered", 2),
            ("prims_decided", 0),
        ];
        assert_eq!(tally.named(), BTreeMap::from(want));
        let mut other = Tally { nodes_entered: 2, ..Tally::default() };
        for (name, by) in [("marks", 1), ("cells", 7), ("cells_tested", 12)] {
            other.add(name, by);
        }
        assert_eq!(tally, other, "in another order");
        other.add("cells", 1);
        assert_ne!(tally, other);
    }
}
