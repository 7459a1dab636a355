//! Pictures of what is not in the world: the pyramid, and the visible list.

use super::evidence::Evidence;
use crate::culling::cubes::CubeNote;
use crate::culling::depth::picture::{Lists, last_reads, levels, stacked};
use crate::culling::depth::{DepthNote, Faces, Tiled};
use crate::drawing::Drawing;
use crate::geometry::View;
use crate::raster::DepthScale;

/// Names of the pictures.
pub(super) const PICTURES: &[&str] = &["z-pyramid", "z-pyramid, stacked", "visible list"];

/// Draws picture `which`.
pub(super) fn picture<S: Faces>(
    tiled: &Tiled<S>,
    view: &View<S>,
    notes: &[Evidence<S>],
    which: usize,
    scale: DepthScale,
) -> Drawing {
    // Backward from the step: the latest query is shown, whole or as far as it has come.
    let reads = || last_reads(notes.iter().rev().map(Evidence::depth));
    // In the order of `PICTURES`.
    match which {
        0 => levels(&tiled.levels(), view, &reads(), scale),
        1 => stacked(&tiled.levels(), view, &reads(), scale),
        _ => lists(notes).draw(),
    }
}

/// The visible list in the order of drawing, and what came of every cube that was queried.
pub(super) fn lists<S: Faces>(notes: &[Evidence<S>]) -> Lists {
    let mut lists = Lists::default();
    for note in notes {
        match note {
            // The same cube is recorded once more when the visit meets it, with false: it is not drawn again.
            Evidence::Listed(node, true) => lists.drawn.push((*node, "from the list")),
            Evidence::Depth(DepthNote::Answered(a)) => {
                // What passes its check at the end of the frame is drawn already.
                if !a.answer.is_hidden && !lists.is_checking {
                    lists.drawn.push((a.node, "passed its test"));
                }
                lists.query(a);
            }
            Evidence::Cube(CubeNote::Checked(_)) => lists.is_checking = true,
            Evidence::Cube(CubeNote::Unlisted { node, .. }) => lists.unlisted.push(*node),
            _ => {}
        }
    }
    lists
}
