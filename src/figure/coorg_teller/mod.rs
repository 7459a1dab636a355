//! The figures of Coorg and Teller, "Real-Time Occlusion Culling for Models with Large Occluders", I3D 1997, made anew:
//! Figures 2 to 12, each computed by the functions that the method `large-occluders` itself runs.

mod flat;
mod kit;
mod regions;

use crate::drawing::Drawing;
use crate::figure::Tint;
use crate::scene::SceneError;

/// Name, summary and maker of a figure.
pub type Row = (&'static str, &'static str, fn(Tint) -> Result<Drawing, SceneError>);

/// The figures, in the paper's order.
pub const FIGURES: &[Row] = &[
    ("large-occluders-2", "Regions of full, partial and no occlusion between supporting and separating lines", flat::supporting_lines),
    ("large-occluders-3", "What two connected occluders hide together", flat::connected),
    ("large-occluders-4", "A shared edge on the silhouette must not be ignored", flat::silhouette_edge),
];
