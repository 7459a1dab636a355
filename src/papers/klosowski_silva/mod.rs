//! Klosowski and Silva, TVCG 2000: Figures 2 to 14, Table 1, and what Sections 3 to 7 claim.

mod figures;
mod shown;
mod tables;

use super::keys::LAYERED_PROJECTION;
use super::paper::Paper;

/// The paper.
pub const PAPER: Paper = Paper {
    key: "klosowski-silva",
    methods: &[LAYERED_PROJECTION],
    shown: shown::SHOWN,
    figures: figures::FIGURES,
    tables: tables::TABLES,
};
