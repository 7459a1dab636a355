//! The front: cells that wait for projection, least solidity first.
//!
//! Klosowski and Silva 2000, Sections 3.2 and 4.2: a priority queue in which a cell that is put in again gets
//! the new value and leaves its old place, and in which equal values leave in the order in which they were
//! put in.
//!
//! A binary heap cannot remove from its middle, so a cell that is put in again leaves a stale entry behind,
//! which is dropped when it comes to the top. Stale entries are no more than the faces that cells were
//! reached by. Cost: O(log n) for a cell put in or taken out, amortized.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::geometry::CellId;

/// What is known of a cell in this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Place {
    solidity: f32,
    /// When it was last put in, from 2: twice the number of cells put in before and it, and one more if the
    /// Eye sees it through the face by which it was reached. 0 if never, [`GONE`] once it left for good.
    // One number, so that a place takes 8 bytes: the run looks at that of every neighbor of every cell.
    turn: u32,
}

/// The turn of a cell that was projected or left out.
const GONE: u32 = u32::MAX;

/// An entry of the heap; stale if the cell was put in again later, or left.
#[derive(Clone, Copy, Debug)]
struct Entry {
    solidity: f32,
    // The time stamp of Section 4.2. It also gives a stale entry away: the cell has a later one.
    turn: u32,
    cell: CellId,
}

impl Ord for Entry {
    /// The heap's greatest is the least solid. Ties leave first in, first out, by the time stamp of
    /// Section 4.2.
    fn cmp(&self, other: &Self) -> Ordering {
        // Both the other way round, since the heap has its greatest on top. Empty cells that the Eye looks
        // through all have solidity 0: without the time stamp they would leave as the heap happens to lie,
        // and the front would not grow evenly around the Eye.
        other.solidity.total_cmp(&self.solidity).then(other.turn.cmp(&self.turn))
    }
}
impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        // Equality has to follow the order; of two entries of one frame it is never true, since no turn comes
        // twice.
        self.cmp(other).is_eq()
    }
}
impl Eq for Entry {}

/// The queue of one frame, with what was taken from it. A run and its film change it by [`Front::put`],
/// [`Front::project`] and [`Front::leave_out`] only.
#[derive(Clone, Debug, Default)]
pub struct Front {
    /// The entry at the top is never stale.
    heap: BinaryHeap<Entry>,
    cells: Vec<Place>,
    turns: u32,
    projected: Vec<CellId>,
}

/// Fronts that will yield the same cells: entries of the heap that were replaced do not count.
impl PartialEq for Front {
    fn eq(&self, other: &Self) -> bool {
        (self.turns, &self.cells, &self.projected) == (other.turns, &other.cells, &other.projected)
    }
}

/// A cell in the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Queued {
    pub cell: CellId,
    pub solidity: f32,
    /// Whether the Eye sees it through the face by which it was reached.
    pub is_star_shaped: bool,
}

impl Front {
    /// Bytes that a copy takes for each cell at most: its place, its number among the projected ones, and
    /// an entry of the heap, of which there are fewer than cells while the front is a surface.
    #[cfg(test)]
    pub const BYTES_A_CELL: usize = size_of::<Place>() + size_of::<CellId>() + size_of::<Entry>();

    /// Empties it for so many cells.
    pub fn clear(&mut self, cells: usize) {
        // The buffers stay, so that a frame begins without new memory.
        self.heap.clear();
        self.cells.clear();
        self.cells.resize(cells, Place::default());
        self.projected.clear();
        self.turns = 0;
    }
    /// Whether a cell was projected, or left out for good.
    #[inline]
    pub fn is_projected(&self, cell: CellId) -> bool {
        self.cells[cell.at()].turn == GONE
    }
    /// The solidity of a cell in the queue.
    pub fn solidity(&self, cell: CellId) -> Option<f32> {
        let place = self.cells[cell.at()];
        (place.turn != 0 && place.turn != GONE).then_some(place.solidity)
    }
    /// The cell of least solidity; it stays until it is projected or left out.
    #[inline]
    pub fn least(&self) -> Option<(CellId, f32)> {
        self.heap.peek().map(|entry| (entry.cell, entry.solidity))
    }
    /// Puts a cell in that did not leave; replaces its earlier entry.
    #[inline]
    pub fn put(&mut self, cell: CellId, solidity: f32, is_star_shaped: bool) {
        self.turns += 2;
        let turn = self.turns + u32::from(is_star_shaped);
        self.cells[cell.at()] = Place { solidity, turn };
        // The old entry stays where it is: finding it would take a walk through the heap.
        self.heap.push(Entry { solidity, turn, cell });
        // Only the earlier entry of this cell can have grown stale.
        if self.heap.peek().is_some_and(|top| top.cell == cell && top.turn != turn) {
            self.drop_stale();
        }
    }
    /// Takes out a cell that is projected.
    pub fn project(&mut self, cell: CellId) {
        self.leave_out(cell);
        self.projected.push(cell);
    }
    /// Takes out a cell that is not projected.
    #[inline]
    pub fn leave_out(&mut self, cell: CellId) {
        // No entry has this turn, so that of the cell is stale from here on.
        self.cells[cell.at()].turn = GONE;
        self.drop_stale();
    }
    fn drop_stale(&mut self) {
        // Each entry is dropped once at most, so this costs no more than putting it in did.
        while self.heap.peek().is_some_and(|entry| !self.is_current(entry)) {
            self.heap.pop();
        }
    }
    #[inline]
    fn is_current(&self, entry: &Entry) -> bool {
        self.cells[entry.cell.at()].turn == entry.turn
    }
    fn waiting(&self) -> impl Iterator<Item = &Entry> {
        // Stale entries below the top are passed over, since a reader may not remove them.
        self.heap.iter().filter(|entry| self.is_current(entry))
    }
    /// How many cells wait. O(entries of the heap).
    pub fn count(&self) -> usize {
        self.waiting().count()
    }
    /// The first `most` cells in the order in which they will be taken if none is put in again.
    /// O(entries of the heap + k log k) for k cells: drawn at every step of a film, it looks at no cell that
    /// the front did not reach and sorts none that is not shown.
    pub fn first(&self, most: usize) -> Vec<Queued> {
        let mut entries: Vec<Entry> = self.waiting().copied().collect();
        let later = |a: &Entry, b: &Entry| b.cmp(a);
        if entries.len() > most {
            entries.select_nth_unstable_by(most, later);
            entries.truncate(most);
        }
        // No two entries have the same turn, so the order is total.
        entries.sort_unstable_by(later);
        let queued = |entry: Entry| Queued {
            cell: entry.cell,
            solidity: entry.solidity,
            is_star_shaped: entry.turn & 1 == 1,
        };
        entries.into_iter().map(queued).collect()
    }
    /// The cells that were projected, in order.
    pub fn projected(&self) -> &[CellId] {
        &self.projected
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::Rng;

    fn take(front: &mut Front) -> Option<(CellId, f32)> {
        let least = front.least();
        if let Some((cell, _)) = least {
            front.project(cell);
        }
        least
    }

    #[test]
    fn the_least_leaves_first_and_of_equal_ones_the_first() {
        let mut front = Front::default();
        front.clear(5);
        for (cell, solidity) in [(0, 2.0), (1, 1.0), (2, 1.0), (3, 0.5), (3, 3.0), (1, 1.0)] {
            front.put(CellId(cell), solidity, true);
        }
        assert_eq!((front.solidity(CellId(3)), front.solidity(CellId(4))), (Some(3.0), None));
        let order: Vec<_> = std::iter::from_fn(|| take(&mut front)).map(|(c, s)| (c.0, s)).collect();
        assert_eq!(order, [(2, 1.0), (1, 1.0), (0, 2.0), (3, 3.0)], "cell 1 was put in again, behind 2");
        assert!(front.is_projected(CellId(1)) && !front.is_projected(CellId(4)));
    }

    #[test]
    fn it_does_what_a_list_does() {
        let mut rng = Pcg32::new(3, 3);
        let mut front = Front::default();
        front.clear(40);
        let mut list: Vec<(CellId, f32)> = Vec::new();
        for _ in 0..4000 {
            let cell = CellId(rng.next_u32() % 40);
            if !rng.next_u32().is_multiple_of(3) && !front.is_projected(cell) {
                let solidity = (rng.next_u32() % 8) as f32;
                list.retain(|(c, _)| *c != cell);
                list.push((cell, solidity));
                front.put(cell, solidity, true);
            } else if rng.next_u32().is_multiple_of(20) {
                // The first of the least.
                let want = (0..list.len())
                    .min_by(|a, b| list[*a].1.total_cmp(&list[*b].1))
                    .map(|at| list.remove(at));
                let first: Vec<_> = front.first(3).iter().map(|q| (q.cell, q.solidity)).collect();
                assert_eq!(front.count(), list.len() + usize::from(want.is_some()));
                assert_eq!(first.first().copied(), want);
                assert_eq!(
                    first,
                    front.first(usize::MAX).iter().take(3).map(|q| (q.cell, q.solidity)).collect::<Vec<_>>()
                );
                assert_eq!(take(&mut front), want);
            }
        }
    }
}
