//! Georges, 1995: Figures 1 and 2, pictures of the method on scenes, and the models of Section 5.2.

mod figures;
mod shown;
mod tables;

use super::keys::HIERARCHICAL_Z;
use super::paper::Paper;

/// The paper.
pub const PAPER: Paper = Paper {
    key: "georges",
    methods: &[HIERARCHICAL_Z],
    shown: shown::SHOWN,
    figures: figures::FIGURES,
    tables: tables::TABLES,
};
