//! What a question about depth is answered, and what that rests on.

use crate::raster::{Outcome, PyramidCell, Read};

/// A cell that decided, and the two depths that were compared there, `1/w`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decisive {
    pub cell: PyramidCell,
    /// The farthest depth that it holds.
    pub held: f32,
    /// The nearest at which what was asked for begins in it.
    pub nearest: f32,
}

impl Decisive {
    /// By how much the cell hides it, `1/w`; negative or 0 if it does not.
    fn margin(&self) -> f32 {
        self.held - self.nearest
    }
}

/// How a question ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Answer {
    /// Whether nothing of what was asked for can be seen.
    pub is_hidden: bool,
    /// Its nearest depth, `1/w`.
    pub nearest: f32,
    /// Cells that were read.
    pub reads: u32,
    /// The cell that decided: the one that shows it, or of those that hide it the one with the least margin.
    /// `None` where none decided: it covers no pixel.
    pub decisive: Option<Decisive>,
}

impl Answer {
    /// Takes in what another part of the image says.
    pub fn join(&mut self, other: &Self) {
        self.reads += other.reads;
        // A cell that shows the box has no margin, and one that hides it has: the least of all shows the box,
        // or else hides it by the least.
        let decides = match (self.decisive, other.decisive) {
            (Some(a), Some(b)) => b.margin() < a.margin(),
            (None, b) => b.is_some(),
            (_, None) => false,
        };
        if decides {
            self.decisive = other.decisive;
        }
    }
}

/// What a question has read so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Summary {
    reads: u32,
    decisive: Option<Decisive>,
}

impl Summary {
    /// Takes in a cell that was read.
    #[inline]
    pub fn take(&mut self, read: &Read) {
        self.reads += 1;
        let here = Decisive { cell: read.cell, held: read.held, nearest: read.nearest };
        match read.outcome {
            Outcome::Shows => self.decisive = Some(here),
            // Kept is the cell with the least margin.
            Outcome::Behind if self.decisive.is_none_or(|least| here.margin() < least.margin()) => {
                self.decisive = Some(here);
            }
            Outcome::Behind | Outcome::Descends => {}
        }
    }
    /// The answer to a question for something that comes no nearer than a depth, `1/w`.
    pub fn answer(self, is_hidden: bool, nearest: f32) -> Answer {
        Answer { is_hidden, nearest, reads: self.reads, decisive: self.decisive }
    }
}
