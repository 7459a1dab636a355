//! Coorg and Teller, I3D 1997: Figures 2 to 12, Tables 1 to 3, and what Sections 4.1 and 5 count.

mod figures;
mod shown;
mod tables;

use super::keys::LARGE_OCCLUDERS;
use super::paper::Paper;

/// The paper.
pub const PAPER: Paper = Paper {
    key: "coorg-teller",
    methods: &[LARGE_OCCLUDERS],
    shown: shown::SHOWN,
    figures: figures::FIGURES,
    tables: tables::TABLES,
};
