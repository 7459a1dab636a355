//! The front: cells that wait for projection, least solidity first.
//!
//! Klosowski and Silva 2000, Sections 3.2 and 4.2: a priority queue in which a cell that is put in again gets
//! the new value and leaves its old place, and in which equal values leave in the order in which they were
//! put in. Cost: O(log n).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::geometry::CellId;

/// What is known of a cell in this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct State {
    solidity: f32,
    /// When it was last put in, from 1; 0 if never, [`PROJECTED`] once it was taken out.
    turn: u32,
    is_star_shaped: bool,
}

const PROJECTED: u32 = u32::MAX;

/// An entry of the heap; stale if the cell was put in again later.
#[derive(Clone, Copy, Debug)]
struct Entry {
    solidity: f32,
    turn: u32,
    cell: CellId,
}

impl Ord for Entry {
    /// The heap's greatest is the least solid, and of equal ones the first.
    fn cmp(&self, other: &Self) -> Ordering {
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
        self.cmp(other).is_eq()
    }
}
impl Eq for Entry {}

/// The queue of one frame, with what was taken from it.
#[derive(Clone, Debug, Default)]
pub struct Front {
    heap: BinaryHeap<Entry>,
    cells: Vec<State>,
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
    /// Empties it for so many cells.
    pub fn clear(&mut self, cells: usize) {
        self.heap.clear();
        self.cells.clear();
        self.cells.resize(cells, State::default());
        self.projected.clear();
        self.turns = 0;
    }
    /// Whether a cell was taken out.
    #[inline]
    pub fn is_projected(&self, cell: CellId) -> bool {
        self.cells[cell.at()].turn == PROJECTED
    }
    /// The solidity of a cell in the queue.
    pub fn solidity(&self, cell: CellId) -> Option<f32> {
        self.is_queued(cell).then(|| self.cells[cell.at()].solidity)
    }
    fn is_queued(&self, cell: CellId) -> bool {
        !matches!(self.cells[cell.at()].turn, 0 | PROJECTED)
    }
    /// Puts a cell in that was not taken out; replaces its earlier entry.
    #[inline]
    pub fn put(&mut self, cell: CellId, solidity: f32, is_star_shaped: bool) {
        self.turns += 1;
        self.cells[cell.at()] = State { solidity, turn: self.turns, is_star_shaped };
        self.heap.push(Entry { solidity, turn: self.turns, cell });
    }
    /// Takes out the cell of least solidity.
    #[inline]
    pub fn take(&mut self) -> Option<(CellId, f32)> {
        loop {
            let entry = self.heap.pop()?;
            if self.cells[entry.cell.at()].turn == entry.turn {
                self.leave_out(entry.cell);
                return Some((entry.cell, entry.solidity));
            }
        }
    }
    /// A cell that was taken out was projected.
    pub fn project(&mut self, cell: CellId) {
        self.leave_out(cell);
        self.projected.push(cell);
    }
    /// A cell is in the queue no longer.
    #[inline]
    pub fn leave_out(&mut self, cell: CellId) {
        self.cells[cell.at()].turn = PROJECTED;
    }
    /// The cells in the order in which they will be taken if none is put in again. O(cells).
    pub fn in_order(&self) -> Vec<Queued> {
        let cells = (0..self.cells.len() as u32).map(CellId).filter(|&c| self.is_queued(c));
        let mut all: Vec<(u32, Queued)> = cells
            .map(|cell| {
                let State { solidity, turn, is_star_shaped } = self.cells[cell.at()];
                (turn, Queued { cell, solidity, is_star_shaped })
            })
            .collect();
        all.sort_by(|(turn, a), (later, b)| a.solidity.total_cmp(&b.solidity).then(turn.cmp(later)));
        all.into_iter().map(|(_, queued)| queued).collect()
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

    #[test]
    fn the_least_leaves_first_and_of_equal_ones_the_first() {
        let mut front = Front::default();
        front.clear(5);
        for (cell, solidity) in [(0, 2.0), (1, 1.0), (2, 1.0), (3, 0.5), (3, 3.0), (1, 1.0)] {
            front.put(CellId(cell), solidity, true);
        }
        assert_eq!((front.solidity(CellId(3)), front.solidity(CellId(4))), (Some(3.0), None));
        let order: Vec<_> = std::iter::from_fn(|| front.take()).map(|(c, s)| (c.0, s)).collect();
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
                assert_eq!(front.take(), want);
            }
        }
    }
}
