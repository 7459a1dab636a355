//! Zhang, Manocha, Hudson and Hoff, 1997: occluders, kept and culled (Figure 1), the hierarchy of occlusion
//! maps (3), the distance criterion (5), approximate culling (7) and the overlap test (8).

mod figures;
mod tables;

use super::keys::OCCLUSION_MAPS;
use super::paper::Paper;

/// The paper.
pub const PAPER: Paper =
    Paper { key: "zhang", methods: &[OCCLUSION_MAPS], figures: figures::FIGURES, tables: tables::TABLES };
