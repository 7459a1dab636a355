//! Chamberlain, DeRose, Lischinski, Salesin and Snyder, 1996: what is drawn of the hierarchy (Figure 1), how
//! faces are composed (3), forests (Plate 5), and how time grows with them (Figure 5).

mod figures;
mod shown;
mod tables;
mod views;

use super::keys::COLOR_CUBES;
use super::paper::Paper;

/// The paper.
pub const PAPER: Paper = Paper {
    key: "chamberlain",
    methods: &[COLOR_CUBES],
    shown: shown::SHOWN,
    figures: figures::FIGURES,
    tables: tables::TABLES,
};
