//! Zhang, Manocha, Hudson and Hoff, 1997: all of its figures, from the pipeline (2) to the three models
//! (11 to 13), and what it measured.

mod figures;
mod shown;
mod tables;

use super::keys::OCCLUSION_MAPS;
use super::paper::Paper;

/// The paper.
pub const PAPER: Paper = Paper {
    key: "zhang",
    methods: &[OCCLUSION_MAPS],
    shown: shown::SHOWN,
    figures: figures::FIGURES,
    tables: tables::TABLES,
};
