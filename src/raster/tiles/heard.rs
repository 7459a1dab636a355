//! What a question reads, told to whoever listens.

use crate::raster::PyramidCell;

/// How a cell compared with what was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It lies behind all that is drawn in the cell.
    Behind,
    /// It may not; what is below the cell is asked.
    Descends,
    /// A pixel of the cell shows nothing nearer.
    Shows,
}

/// A cell was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Read {
    /// The cell.
    pub cell: PyramidCell,
    /// Its farthest depth, `1/w`.
    pub held: f32,
    /// The nearest at which what was asked for begins in it, `1/w`.
    pub nearest: f32,
    /// What followed.
    pub outcome: Outcome,
}

/// Hears what a question reads, in order. It returns nothing, so a question with a listener and one without
/// are the same.
pub trait Hears {
    /// Whether anyone does; else nothing is worked out for it.
    const LISTENS: bool;
    /// A cell was compared with what was asked for.
    fn reads(&mut self, read: Read);
    /// A tile that did not decide is looked at closer: at its pixels that nothing covers, or at the depths of
    /// all of them.
    #[inline(always)]
    fn looks_closer(&mut self, _at_depths: bool) {}
    /// What a cell holds was brought up to date: a block from its tiles, a tile by exact depths.
    fn refreshes(&mut self, cell: PyramidCell);
}

/// Nobody does.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Nobody;

impl Hears for Nobody {
    const LISTENS: bool = false;
    #[inline(always)]
    fn reads(&mut self, _: Read) {}
    #[inline(always)]
    fn refreshes(&mut self, _: PyramidCell) {}
}
