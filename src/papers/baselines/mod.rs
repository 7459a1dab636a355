//! The baselines: drawing everything, culling by the view frustum, and drawing what is nearest.

mod figures;

use super::keys::{CENTROID, FRUSTUM, Z_BUFFER};
use super::paper::Paper;

/// The works of the baselines, which share their figures.
pub const PAPER: Paper = Paper {
    key: "baselines",
    methods: &[Z_BUFFER, FRUSTUM, CENTROID],
    shown: &[],
    figures: figures::FIGURES,
    tables: &[],
};
