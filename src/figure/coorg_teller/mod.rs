//! The figures of Coorg and Teller, "Real-Time Occlusion Culling for Models with Large Occluders", I3D 1997,
//! made anew: Figures 2 to 12, each computed by the functions that the method `large-occluders` itself runs.

mod chart;
mod flat;
pub(super) mod kit;
mod regions;
mod run;
mod solid;

use crate::figure::builtin::Row;

/// The figures, in the paper's order.
pub const FIGURES: &[Row] = &[
    (
        "large-occluders-2",
        "Regions of full, partial and no occlusion between supporting and separating lines",
        flat::supporting_lines,
    ),
    ("large-occluders-3", "What two connected occluders hide together", flat::connected),
    ("large-occluders-4", "A shared edge on the silhouette must not be ignored", flat::silhouette_edge),
    (
        "large-occluders-5",
        "Convex, other and disconnected silhouettes, as the viewpoint sees them",
        solid::joint_occlusion,
    ),
    ("large-occluders-6", "The supporting and the separating plane through an edge", solid::tangent_planes),
    (
        "large-occluders-7",
        "The outline of a box from before a face, beside an edge, off a corner",
        solid::silhouettes,
    ),
    (
        "large-occluders-8",
        "Codes of the regions around a box, and the tangent vertices they give",
        solid::outline_codes,
    ),
    ("large-occluders-9", "The visibility algorithm as pseudocode", chart::pseudocode),
    (
        "large-occluders-10",
        "Nodes classified for two viewpoints in a row, and what was reused",
        run::two_viewpoints,
    ),
    ("large-occluders-11", "The area-angle, its parameters, and the true solid angle", chart::area_angle),
    ("large-occluders-12", "Detail objects and the occluders near them", run::detail_objects),
];
