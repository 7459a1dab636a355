//! When each node and primitive was decided, and what follows from it at any step.
//!
//! A decision of a node holds for all primitives below it that were not decided before. The first
//! decision other than `Partial` stands. Memory: 12 bytes a node, 8 a primitive, 4 more a decided
//! primitive for the counts.

use crate::geometry::{NodeId, PrimId, Space};
use crate::method::{Event, Film, Verdict};

/// A decision: the step from which on it holds, and what it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Smallest step at which it is known; [`Stamp::NEVER`] if it never is.
    pub step: u32,
    /// The decision; meaningless if never.
    pub verdict: Verdict,
}

impl Stamp {
    /// The step of what never happens.
    pub const NEVER: u32 = u32::MAX;
    const NONE: Stamp = Stamp { step: Self::NEVER, verdict: Verdict::Partial };

    fn decision(self) -> Option<(usize, Verdict)> {
        (self.step != Self::NEVER).then_some((self.step as usize, self.verdict))
    }
}

/// What is known of a node or primitive at a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Nothing was said about it.
    Unseen,
    /// Entered and not yet decided.
    Open,
    /// Decided.
    Decided(Verdict),
}

/// How many primitives are in which state at a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Nodes entered.
    pub nodes_entered: usize,
    /// Primitives by verdict, in the order of [`Counts::VERDICTS`].
    pub prims: [usize; Self::VERDICTS.len()],
    /// Primitives not decided.
    pub undecided: usize,
}

impl Counts {
    /// The order of [`Counts::prims`].
    pub const VERDICTS: [Verdict; 8] = [
        Verdict::Outside,
        Verdict::FacesAway,
        Verdict::Hidden,
        Verdict::Presumed,
        Verdict::Partial,
        Verdict::Visible,
        Verdict::Approximated,
        Verdict::OverBudget,
    ];
    /// Primitives with this verdict.
    pub fn of(&self, verdict: Verdict) -> usize {
        self.prims[verdict as usize]
    }
}

/// The stamps of one film.
#[derive(Clone, Debug)]
pub struct Stamps {
    entered: Vec<u32>,
    nodes: Vec<Stamp>,
    prims: Vec<Stamp>,
    /// Ascending steps of `Entered`.
    entered_steps: Vec<u32>,
    /// Ascending steps of primitives' decisions by verdict.
    decided_steps: [Vec<u32>; Counts::VERDICTS.len()],
    live: usize,
}

impl Stamps {
    /// Reads a film once. O(events + nodes + primitives · (log n for the counts)).
    pub fn new<S: Space>(film: &dyn Film<S>) -> Self {
        let hierarchy = film.hierarchy();
        let mut stamps = Self {
            entered: vec![Stamp::NEVER; hierarchy.node_count()],
            nodes: vec![Stamp::NONE; hierarchy.node_count()],
            prims: vec![Stamp::NONE; film.scene().prim_count()],
            entered_steps: Vec::new(),
            decided_steps: Default::default(),
            live: film.scene().live().len(),
        };
        for (i, event) in film.events().iter().enumerate() {
            let step = i as u32 + 1;
            match *event {
                Event::Entered(n) => {
                    stamps.entered[n.at()] = stamps.entered[n.at()].min(step);
                    stamps.entered_steps.push(step);
                }
                Event::DecidedNode(n, verdict) => {
                    let stamp = &mut stamps.nodes[n.at()];
                    if stamp.step == Stamp::NEVER || stamp.verdict == Verdict::Partial {
                        *stamp = Stamp { step, verdict };
                    }
                    if verdict != Verdict::Partial {
                        hierarchy.prims(n).iter().for_each(|&p| stamps.decide(p, step, verdict));
                    }
                }
                Event::DecidedPrim(p, verdict) => stamps.decide(p, step, verdict),
                _ => {}
            }
        }
        stamps
    }

    fn decide(&mut self, prim: PrimId, step: u32, verdict: Verdict) {
        let stamp = &mut self.prims[prim.at()];
        if stamp.step == Stamp::NEVER && verdict != Verdict::Partial {
            *stamp = Stamp { step, verdict };
            self.decided_steps[verdict as usize].push(step);
        }
    }

    /// The decision of every primitive, by id.
    pub fn prims(&self) -> &[Stamp] {
        &self.prims
    }
    /// The decision of every node, by id; `Partial` if that is all that was ever said.
    pub fn nodes(&self) -> &[Stamp] {
        &self.nodes
    }
    /// The step at which a node was first entered, or [`Stamp::NEVER`].
    pub fn entered(&self, node: NodeId) -> u32 {
        self.entered[node.at()]
    }
    /// A node at a step.
    pub fn node(&self, node: NodeId, step: usize) -> State {
        let stamp = self.nodes[node.at()];
        if stamp.step as usize <= step {
            State::Decided(stamp.verdict)
        } else if self.entered[node.at()] as usize <= step {
            State::Open
        } else {
            State::Unseen
        }
    }
    /// A primitive at a step.
    pub fn prim(&self, prim: PrimId, step: usize) -> State {
        let stamp = self.prims[prim.at()];
        if stamp.step as usize <= step { State::Decided(stamp.verdict) } else { State::Unseen }
    }
    /// The step from which on a primitive's decision holds (what "jump to why" jumps to), and the decision.
    pub fn prim_decision(&self, prim: PrimId) -> Option<(usize, Verdict)> {
        self.prims[prim.at()].decision()
    }
    /// The step from which on a node's decision holds, if it was decided itself, and the decision.
    pub fn node_decision(&self, node: NodeId) -> Option<(usize, Verdict)> {
        self.nodes[node.at()].decision()
    }
    /// The step at which a node was first entered, if it was.
    pub fn entered_at(&self, node: NodeId) -> Option<usize> {
        Some(self.entered[node.at()]).filter(|&s| s != Stamp::NEVER).map(|s| s as usize)
    }
    /// Counts at a step.
    pub fn counts(&self, step: usize) -> Counts {
        let upto = |steps: &Vec<u32>| steps.partition_point(|&s| s as usize <= step);
        let prims = std::array::from_fn(|v| upto(&self.decided_steps[v]));
        Counts {
            nodes_entered: upto(&self.entered_steps),
            prims,
            undecided: self.live - prims.iter().sum::<usize>(),
        }
    }
}
