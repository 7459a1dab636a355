//! The figures of Coorg and Teller, "Real-Time Occlusion Culling for Models with Large Occluders", I3D 1997,
//! made anew: Figures 2 to 12, each computed by the functions that the method `large-occluders` itself runs.

mod chart;
mod flat;
mod frames;
mod notes;
mod regions;
mod setting;
mod solid;

use crate::papers::paper::Figure;

/// The figures, in the paper's order.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "coorg-teller-figure-2",
        former: Some("large-occluders-2"),
        summary: "Regions of full, partial and no occlusion between supporting and separating lines",
        make: flat::supporting_lines,
    },
    Figure {
        name: "coorg-teller-figure-3",
        former: Some("large-occluders-3"),
        summary: "What two connected occluders hide together",
        make: flat::connected,
    },
    Figure {
        name: "coorg-teller-figure-4",
        former: Some("large-occluders-4"),
        summary: "A shared edge on the silhouette must not be ignored",
        make: flat::silhouette_edge,
    },
    Figure {
        name: "coorg-teller-figure-5",
        former: Some("large-occluders-5"),
        summary: "Convex, other and disconnected silhouettes, as the viewpoint sees them",
        make: solid::joint_occlusion,
    },
    Figure {
        name: "coorg-teller-figure-6",
        former: Some("large-occluders-6"),
        summary: "The supporting and the separating plane through an edge",
        make: solid::tangent_planes,
    },
    Figure {
        name: "coorg-teller-figure-7",
        former: Some("large-occluders-7"),
        summary: "The outline of a box from before a face, beside an edge, off a corner",
        make: solid::silhouettes,
    },
    Figure {
        name: "coorg-teller-figure-8",
        former: Some("large-occluders-8"),
        summary: "Codes of the regions around a box, and the tangent vertices they give",
        make: solid::outline_codes,
    },
    Figure {
        name: "coorg-teller-figure-9",
        former: Some("large-occluders-9"),
        summary: "The visibility algorithm as pseudocode",
        make: chart::pseudocode,
    },
    Figure {
        name: "coorg-teller-figure-10",
        former: Some("large-occluders-10"),
        summary: "Nodes classified for two viewpoints in a row, and what was reused",
        make: frames::two_viewpoints,
    },
    Figure {
        name: "coorg-teller-figure-11",
        former: Some("large-occluders-11"),
        summary: "The area-angle, its parameters, and the true solid angle",
        make: chart::area_angle,
    },
    Figure {
        name: "coorg-teller-figure-12",
        former: Some("large-occluders-12"),
        summary: "Detail objects and the occluders near them",
        make: frames::detail_objects,
    },
];
