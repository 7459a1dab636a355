//! The figures of Coorg and Teller, "Real-Time Occlusion Culling for Models with Large Occluders", I3D 1997, made anew:
//! Figures 2 to 12, each computed by the functions that the method `large-occluders` itself runs.

mod chart;
mod flat;
mod kit;
mod regions;
mod run;
mod solid;

use crate::figure::builtin::Row;

/// The figures, in the paper's order.
pub const FIGURES: &[Row] = &[
    ("large-occluders-2", "Regions of full, partial and no occlusion between supporting and separating lines", flat::supporting_lines),
    ("large-occluders-3", "What two connected occluders hide together", flat::connected),
    ("large-occluders-4", "A shared edge on the silhouette must not be ignored", flat::silhouette_edge),
    ("large-occluders-5", "Convex, other and disconnected silhouettes, as the viewpoint sees them", solid::joint_occlusion),
    ("large-occluders-6", "The supporting and the separating plane through an edge", solid::tangent_planes),
    ("large-occluders-7", "The outline of a box from before a face, beside an edge, off a corner", solid::silhouettes),
    ("large-occluders-8", "Codes of the regions around a box, and the tangent vertices they give", solid::outline_codes),
    ("large-occluders-9", "The visibility algorithm as pseudocode", chart::pseudocode),
    ("large-occluders-10", "Nodes classified for two viewpoints in a row, and what was reused", run::two_viewpoints),
    ("large-occluders-11", "The area-angle, its parameters, and the true solid angle", chart::area_angle),
    ("large-occluders-12", "Detail objects and the occluders near them", run::detail_objects),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Mark, metrics};

    #[test]
    fn no_text_sticks_out_or_is_too_small() {
        for (name, _, make) in FIGURES {
            let page = make(&|_| [0.0; 3]).expect("a figure");
            for item in &page.items {
                let Mark::Text { at, text, size_pt, anchor, font } = &item.mark else { continue };
                let [low, high] = metrics::text_box(*at, text, *font, *size_pt, *anchor);
                assert!(low.x >= 0.0 && high.x <= page.size_pt.x && high.y <= page.size_pt.y, "{name}: {text}");
                assert!(*size_pt > 5.0, "{name}: {text} has {size_pt} pt");
            }
        }
    }
}
