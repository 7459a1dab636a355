//! Moving through a film: step, step over, step out, to the next verdict, forwards and backwards.
//!
//! Step `k` lies between event `k − 1` (the last that happened, the *current* one) and event `k`.
//! Memory: 8 bytes an event.

use crate::geometry::NodeId;
use crate::method::{Event, Verdict};

/// How fine a step is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// Decisions and the evidence for them; lines of pseudocode are passed over.
    Coarse,
    /// Every event.
    #[default]
    Full,
}

impl Detail {
    /// Whether an event is a stop of its own.
    pub fn shows(self, event: &Event) -> bool {
        self == Self::Full || !matches!(event, Event::Line(_))
    }
}

/// Where the moves of a film lead. Built in one pass.
#[derive(Clone, Debug, Default)]
pub struct Moves {
    /// Of an `Entered`: the matching `Left`; of a `Left`: its `Entered`; otherwise itself.
    partner: Vec<u32>,
    /// Index of the `Entered` around each event, or `NONE`. (An `Entered` and its `Left` lie in the node
    /// around them.)
    around: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Moves {
    /// Reads the events once.
    pub fn new(events: &[Event]) -> Self {
        let mut moves =
            Self { partner: (0..events.len() as u32).collect(), around: Vec::with_capacity(events.len()) };
        let mut open: Vec<u32> = Vec::new();
        for (i, event) in events.iter().enumerate() {
            if let Event::Left(_) = event
                && let Some(entered) = open.pop()
            {
                moves.partner[i] = entered;
                moves.partner[entered as usize] = i as u32;
            }
            moves.around.push(open.last().copied().unwrap_or(NONE));
            if let Event::Entered(_) = event {
                open.push(i as u32);
            }
        }
        // A capped film ends inside nodes; they end where the film does.
        for entered in open {
            moves.partner[entered as usize] = events.len() as u32 - 1;
        }
        moves
    }

    /// One event on.
    pub fn forward(&self, events: &[Event], step: usize, detail: Detail) -> usize {
        (step..events.len()).find(|&i| detail.shows(&events[i])).map_or(events.len(), |i| i + 1)
    }
    /// One event back: to the state before the current event.
    pub fn back(&self, events: &[Event], step: usize, detail: Detail) -> usize {
        // Undo the current stop, then rest on the stop before it.
        let undone = (0..step.min(events.len())).rev().find(|&i| detail.shows(&events[i])).unwrap_or(0);
        (0..undone).rev().find(|&i| detail.shows(&events[i])).map_or(0, |i| i + 1)
    }
    /// Like forward, but passes over the subtree if the next event enters a node.
    pub fn over(&self, events: &[Event], step: usize, detail: Detail) -> usize {
        let next = (step..events.len()).find(|&i| detail.shows(&events[i]));
        match next {
            Some(i) if matches!(events[i], Event::Entered(_)) => self.partner[i] as usize + 1,
            // Just entered: finish this node.
            Some(i) if i > 0 && i == step && matches!(events[i - 1], Event::Entered(_)) => {
                self.partner[i - 1] as usize + 1
            }
            Some(i) => i + 1,
            None => events.len(),
        }
    }
    /// The reverse of [`Moves::over`]: passes back over the subtree that was just left.
    pub fn back_over(&self, events: &[Event], step: usize, detail: Detail) -> usize {
        match step.checked_sub(1).map(|i| (i, events[i])) {
            Some((i, Event::Left(_))) => self.partner[i] as usize,
            _ => self.back(events, step, detail),
        }
    }
    /// To the end of the node that is being looked at.
    pub fn out(&self, events: &[Event], step: usize) -> usize {
        self.node_around(events, step).map_or(events.len(), |entered| self.partner[entered] as usize + 1)
    }
    /// To before the node that is being looked at was entered.
    pub fn back_out(&self, events: &[Event], step: usize) -> usize {
        self.node_around(events, step).unwrap_or(0)
    }
    /// Index of the `Entered` of the node in which the traversal is at a step.
    fn node_around(&self, events: &[Event], step: usize) -> Option<usize> {
        let current = step.checked_sub(1)?;
        if matches!(events[current], Event::Entered(_)) {
            return Some(current);
        }
        Some(self.around[current]).filter(|&e| e != NONE).map(|e| e as usize)
    }
    /// To the next event that `wanted` accepts, if there is one.
    pub fn next(&self, events: &[Event], step: usize, wanted: impl Fn(&Event) -> bool) -> Option<usize> {
        (step..events.len()).find(|&i| wanted(&events[i])).map(|i| i + 1)
    }
    /// Back to the event before the current one that `wanted` accepts, if there is one.
    pub fn previous(&self, events: &[Event], step: usize, wanted: impl Fn(&Event) -> bool) -> Option<usize> {
        (0..step.saturating_sub(1)).rev().find(|&i| wanted(&events[i])).map(|i| i + 1)
    }
    /// Whether an event is a verdict other than `Partial`.
    pub fn is_verdict(event: &Event) -> bool {
        matches!(event, Event::DecidedNode(_, v) | Event::DecidedPrim(_, v) if *v != Verdict::Partial)
    }
    /// The nodes that are open at a step, the root first: the call stack.
    pub fn stack(&self, events: &[Event], step: usize) -> Vec<NodeId> {
        let mut stack = Vec::new();
        let mut at = self.node_around(events, step);
        while let Some(i) = at {
            if let Event::Entered(n) = events[i] {
                stack.push(n);
            }
            at = Some(self.around[i]).filter(|&e| e != NONE).map(|e| e as usize);
        }
        stack.reverse();
        stack
    }
    /// The line of pseudocode at a step: the last one reached.
    pub fn line(&self, events: &[Event], step: usize) -> Option<u8> {
        events[..step.min(events.len())]
            .iter()
            .rev()
            .find_map(|e| if let Event::Line(l) = e { Some(*l) } else { None })
    }
    /// How deep event `at` is nested.
    pub fn depth(&self, at: usize) -> usize {
        std::iter::successors(Some(self.around[at]), |&e| (e != NONE).then(|| self.around[e as usize]))
            .take_while(|&e| e != NONE)
            .count()
    }
}
