//! Chamberlain, DeRose, Lischinski, Salesin and Snyder, measured: how time grows with the number of trees
//! (Section 5.2, Figure 5), and that each level of the hierarchy is drawn as often as any other (Section
//! 3.1).
//!
//! Cost: O(levels · (cells visited + triangles drawn)).

mod figure_5;
mod shells;

use crate::measure::Experiment;

/// The tables.
pub const TABLES: &[Experiment] = &[figure_5::TABLE, shells::TABLE];
