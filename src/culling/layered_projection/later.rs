//! What the budget left out: when it would have been drawn, had the budget been larger.
//!
//! Found by going on: the traversal from where the budget was spent, with nobody to see it. A larger budget
//! draws the same and then more, so the place of a primitive in what is drawn from here on is by how much the
//! budget was too small for it. Only for people who ask why; it costs about a frame without a budget.

use super::explain::{Evidence, LeftOut};
use super::front::Queued;
use super::index::Index;
use crate::geometry::{CellId, PrimId};
use crate::index::tessellation::Cellular;
use crate::method::{Event, Observer};
use crate::scene::Scene;

/// Not drawn, however large the budget.
const NEVER: u32 = u32::MAX;

/// What a larger budget would have drawn.
pub(super) struct Later {
    /// The cell with which the budget was spent, and its solidity.
    last: CellId,
    of_last: f32,
    /// For each cell after how many more primitives all of it is drawn.
    of_cell: Vec<u32>,
    /// For each primitive the cell that draws it, and how many more primitives are drawn up to it.
    of_prim: Vec<(CellId, u32)>,
    /// For each cell that waited in the front when the budget was spent its solidity and its place, from 1.
    queued: Vec<Option<(f32, u32)>>,
}

/// Hears which cells are projected.
#[derive(Default)]
pub(super) struct Projections(Vec<(CellId, u32)>);

impl<S: Cellular> Observer<Evidence<S>> for Projections {
    // What only reports is not done.
    const LISTENS: bool = false;
    fn event(&mut self, _: Event) {}
    fn note(&mut self, note: impl FnOnce() -> Evidence<S>) {
        if let Evidence::Projected(n) = note() {
            self.0.push((n.cell, n.drawn));
        }
    }
}

impl Later {
    /// From the cell with which the budget was spent, its solidity and how many of its primitives were left
    /// out; the front as it was then; and what a traversal that went on projected and drew, those first.
    pub fn of<S: Cellular>(
        index: &Index<S>,
        scene: &Scene<S>,
        (last, of_last, cut_off): (CellId, f32, usize),
        waiting: Vec<Queued>,
        seen: Projections,
        drawn: &[PrimId],
    ) -> Self {
        let cells = index.count();
        let mut queued = vec![None; cells];
        for (at, waiting) in waiting.into_iter().enumerate() {
            queued[waiting.cell.at()] = Some((waiting.solidity, at as u32 + 1));
        }
        let mut of_cell = vec![NEVER; cells];
        let mut of_prim = vec![(last, NEVER); scene.prim_count()];
        let mut more = 0;
        for (cell, count) in std::iter::once((last, cut_off as u32)).chain(seen.0) {
            for _ in 0..count {
                of_prim[drawn[more as usize].at()] = (cell, more + 1);
                more += 1;
            }
            of_cell[cell.at()] = more;
        }
        Self { last, of_last, of_cell, of_prim, queued }
    }
    /// Why a primitive was left out; `None` if no budget would have drawn it.
    pub fn of_prim(&self, prim: PrimId) -> Option<LeftOut> {
        let (cell, more) = self.of_prim[prim.at()];
        (more != NEVER).then(|| self.left_out(cell, Some(prim), more))
    }
    /// Why a cell was left out; `None` if no budget would have reached it.
    pub fn of_cell(&self, cell: CellId) -> Option<LeftOut> {
        let more = self.of_cell[cell.at()];
        (more != NEVER).then(|| self.left_out(cell, None, more))
    }
    fn left_out(&self, cell: CellId, prim: Option<PrimId>, more: u32) -> LeftOut {
        LeftOut { cell, prim, queued: self.queued[cell.at()], last: self.last, of_last: self.of_last, more }
    }
}
