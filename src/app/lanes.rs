//! The timeline: events in lanes, squeezed into as many columns as there are pixels.

use crate::method::{Event, Verdict};

/// A row of the timeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lane {
    /// Nodes entered and left.
    Walk,
    /// Evidence.
    Evidence,
    /// Decisions about nodes.
    Nodes,
    /// Decisions about primitives.
    Prims,
}

impl Lane {
    /// From top to bottom.
    pub const ALL: [Lane; 4] = [Lane::Walk, Lane::Evidence, Lane::Nodes, Lane::Prims];
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Walk => "Walk",
            Self::Evidence => "Evidence",
            Self::Nodes => "Nodes",
            Self::Prims => "Primitives",
        }
    }
}

/// One column of one lane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cell {
    /// Events in it.
    pub count: u32,
    /// Deepest nesting, of the walk.
    pub depth: u32,
    /// Its decisions by verdict.
    pub verdicts: [u32; crate::trace::Counts::VERDICTS.len()],
}

impl Cell {
    /// The verdict that most of its decisions have.
    pub fn main_verdict(&self) -> Option<Verdict> {
        let most = self.verdicts.iter().copied().max().filter(|&m| m > 0)?;
        crate::trace::Counts::VERDICTS.into_iter().find(|&v| self.verdicts[v as usize] == most)
    }
}

/// All lanes, `columns` cells each, by [`Lane::ALL`]. One pass over the events.
pub fn lanes(events: &[Event], columns: usize) -> [Vec<Cell>; 4] {
    let columns = columns.max(1);
    let mut lanes: [Vec<Cell>; 4] = std::array::from_fn(|_| vec![Cell::default(); columns]);
    let mut depth = 0u32;
    for (i, event) in events.iter().enumerate() {
        let column = (i as u64 * columns as u64 / events.len() as u64) as usize;
        let lane = match event {
            Event::Entered(_) => {
                depth += 1;
                Lane::Walk
            }
            Event::Left(_) => {
                depth = depth.saturating_sub(1);
                Lane::Walk
            }
            Event::Noted(_) => Lane::Evidence,
            Event::DecidedNode(..) => Lane::Nodes,
            Event::DecidedPrim(..) => Lane::Prims,
            _ => continue,
        };
        let cell = &mut lanes[lane as usize][column];
        cell.count += 1;
        cell.depth = cell.depth.max(depth);
        if let Event::DecidedNode(_, v) | Event::DecidedPrim(_, v) = event {
            cell.verdicts[*v as usize] += 1;
        }
    }
    lanes
}
