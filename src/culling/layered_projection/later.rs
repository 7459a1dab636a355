//! What the budget left out: when it would have been drawn, had the budget been larger.
//!
//! Found by going on: the traversal from where the budget was spent, with nobody to see it. A larger budget
//! draws the same and then more, so the place of a primitive in what is drawn from here on is by how much the
//! budget was too small for it. Only for people who ask why; it costs about a frame without a budget.

use super::explain::{Evidence, LeftOut};
use super::index::node_of;
use super::walk::{Source, Walk};
use crate::culling::depth::Faces;
use crate::geometry::{CellId, PrimId};
use crate::index::tessellation::Cellular;
use crate::method::{DrawList, Event, Observer, Verdict};

/// Not drawn, however large the budget.
const NEVER: u32 = u32::MAX;

/// What a larger budget would have drawn.
pub(super) struct Later {
    last: Source,
    /// For each cell after how many more primitives all of it is drawn.
    of_cell: Vec<u32>,
    /// For each primitive the cell that draws it, and how many more primitives are drawn up to it.
    of_prim: Vec<(CellId, u32)>,
    /// For each cell that waited in the front when the budget was spent its solidity and its place, from 1.
    queued: Vec<Option<(f32, u32)>>,
}

/// Hears which cells are projected.
#[derive(Default)]
struct Projections(Vec<(CellId, u32)>);

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
    /// Goes on from the cell with which the budget was spent.
    pub fn of<S: Cellular + Faces, O: Observer<Evidence<S>>>(walk: &Walk<'_, S, O>, last: Source) -> Self {
        let cells = walk.index.count();
        let mut queued = vec![None; cells];
        for (at, waiting) in walk.front.first(usize::MAX).into_iter().enumerate() {
            queued[waiting.cell.at()] = Some((waiting.solidity, at as u32 + 1));
        }
        let (mut front, mut seen) = (walk.front.clone(), Projections::default());
        // The rest of the cell in which the budget ended comes first.
        let mut list = DrawList { prims: walk.cut_off.clone(), stand_ins: Vec::new() };
        let mut further = walk.unlimited(&mut front, &mut list, &mut seen);
        further.hand_on(&last);
        while further.spread().is_none() && further.begin_again().is_some() {}
        let mut of_cell = vec![NEVER; cells];
        let mut of_prim = vec![(last.cell, NEVER); walk.scene.prim_count()];
        let mut more = 0;
        for (cell, drawn) in std::iter::once((last.cell, walk.cut_off.len() as u32)).chain(seen.0) {
            for _ in 0..drawn {
                of_prim[list.prims[more as usize].at()] = (cell, more + 1);
                more += 1;
            }
            of_cell[cell.at()] = more;
        }
        Self { last, of_cell, of_prim, queued }
    }
    /// Why a primitive was left out; `None` if no budget would have drawn it.
    pub fn of_prim(&self, prim: PrimId) -> Option<LeftOut> {
        let (cell, more) = self.of_prim[prim.at()];
        (more != NEVER).then(|| self.left_out(cell, Some(prim), more))
    }
    /// Why a cell was left out; `None` if no budget would have reached it.
    fn of_cell(&self, cell: CellId) -> Option<LeftOut> {
        let more = self.of_cell[cell.at()];
        (more != NEVER).then(|| self.left_out(cell, None, more))
    }
    fn left_out(&self, cell: CellId, prim: Option<PrimId>, more: u32) -> LeftOut {
        let (last, of_last) = (self.last.cell, self.last.solidity);
        LeftOut { cell, prim, queued: self.queued[cell.at()], last, of_last, more }
    }
}

impl<S: Cellular + Faces, O: Observer<Evidence<S>>> Walk<'_, S, O> {
    /// Says of what the budget left out of the cell in which it ended, and of each cell that was not reached,
    /// how much more it would have taken.
    pub(super) fn report_left_out(&mut self, later: &Later) {
        for prim in std::mem::take(&mut self.cut_off) {
            if let Some(left_out) = later.of_prim(prim) {
                self.watch.note(|| Evidence::LeftOut(left_out));
            }
            self.watch.event(Event::DecidedPrim(prim, Verdict::OverBudget));
        }
        for cell in (0..self.index.count() as u32).map(CellId).filter(|c| *c != later.last.cell) {
            if self.front.is_projected(cell) || !self.is_in_view(cell) {
                continue;
            }
            // Of what no budget reaches all in view is empty.
            if let Some(left_out) = later.of_cell(cell) {
                self.watch.note(|| Evidence::LeftOut(left_out));
                self.watch.event(Event::DecidedNode(node_of(cell), Verdict::OverBudget));
            }
        }
    }
}
