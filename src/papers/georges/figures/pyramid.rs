//! Figures 1 and 2, and queries against the pyramid over scenes.

use std::sync::Arc;

use super::notes::hidden_query;
use crate::culling::hierarchical_z_parts::{figure_1, pyramid_picture};
use crate::drawing::{Drawing, Mark, Role};
use crate::figure::page::{below, legend};
use crate::figure::tools::{Maker, WIDTH_PT, entry, eye, flat_panel};
use crate::figure::{Entry, Look, Paper, Swatch, panels};
use crate::geometry::{Flat, PixelRect, Solid, View};
use crate::method::Film;
use crate::papers::keys::HIERARCHICAL_Z;
use crate::raster::DepthScale;
use crate::scene::{AnyScene, LoadOptions, Quiet, Scene, SceneError, example, load};

/// Pictures of the method, by number.
const PYRAMID: usize = 0;
const STACKED: usize = 1;

/// The legend of lit cells.
fn cells() -> Vec<Entry> {
    let entry = |role, label: &str| entry(role, Swatch::Line, label);
    vec![
        entry(Role::Hidden, "what is asked for lies behind the cell"),
        entry(Role::Undecided, "it may not: the cells below are read"),
        entry(Role::Visible, "a sample shows it"),
        entry(Role::Current, "read last"),
    ]
}

pub fn simple_pyramid(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let (scene, view) = figure_1()?;
    let (content, _) = pyramid_picture(&scene, &view, None, DepthScale::Linear);
    let caption = "Level 0 is the z-buffer. Each value of the level above is the farthest of the four below \
                   it, so the single value on top, 9, is the farthest depth of the whole image. The values \
                   are those of the paper's Figure 1; near is dark, far is light.";
    Ok(maker.page(
        Paper::TwoColumns,
        "Georges 1995, Figure 1: a z-pyramid of three levels",
        vec![],
        caption,
        &trimmed(content),
    ))
}

/// Without the lines below the levels that speak of reads.
fn trimmed(mut content: Drawing) -> Drawing {
    content.items.retain(|i| !matches!(&i.mark, Mark::Text { text, .. } if text.starts_with("No cell")));
    content
}

/// The faces of Figure 2, as pixels, and the depth of their nearest point.
const FACES: [PixelRect; 2] =
    [PixelRect { x0: 0, x1: 1, y0: 0, y1: 2 }, PixelRect { x0: 0, x1: 2, y0: 0, y1: 1 }];
const NEAREST: f32 = 6.0;

pub fn simple_query(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let (scene, view) = figure_1()?;
    let mut parts = Vec::new();
    for pixels in FACES {
        let (picture, _) = pyramid_picture(&scene, &view, Some((pixels, NEAREST)), DepthScale::Linear);
        parts.push(picture);
    }
    let caption = "A face whose nearest point is at depth 6 is asked for. Above, the paper's example: it \
                   covers the left column of the upper left quarter; the finest cell that covers it holds 9, \
                   so nothing is decided; the two samples that the face itself covers are 4 and 4, both \
                   nearer than 6, so the face is hidden. (The paper's text places that cell of value 9 in \
                   the upper right of level 1, where its own Figure 1 has 8: a slip.) Below, a second \
                   example, which is not the paper's: the face covers the upper row; sample 4 hides it, \
                   sample 9 does not, so it is visible.";
    Ok(maker.page(
        Paper::TwoColumns,
        "Georges 1995, Figure 2, and a second example: a face against the pyramid",
        cells(),
        caption,
        &below(parts),
    ))
}

pub fn office() -> Result<Arc<Scene<Solid>>, SceneError> {
    match load("generate:building?polygons=20000", &LoadOptions::default(), &Quiet)? {
        AnyScene::Solid(scene) => Ok(scene),
        AnyScene::Flat(_) => unreachable!("the building is in space"),
    }
}

fn office_film(maker: &Maker<'_>) -> Result<Arc<dyn Film<Solid>>, SceneError> {
    let scene = office()?;
    let view = View { width: 256, height: 192, ..scene.paths()[0].views[0] };
    Ok(maker.film(&scene, &view, HIERARCHICAL_Z, &[]))
}

pub fn office_query(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = office_film(maker)?;
    let step = hidden_query(&*film, 40);
    let content = film.picture(step, PYRAMID, DepthScale::Logarithmic);
    let caption = format!(
        "The levels over an office of {} triangles, 256 × 192 pixels, at step {step} of {}, when a cube of \
         the octree has been found hidden. Cells are numbered in the order in which they were read: blocks \
         of 32 × 16 pixels first; where one does not decide, its tiles of 8 × 4, and where these do not, \
         pixels. The last picture shows the masks of tiles: where a nearer layer is begun that does not \
         cover its tile yet. Cross-hatched blocks hold less than their tiles know.",
        film.scene().live().len(),
        film.events().len()
    );
    Ok(maker.page(Paper::TwoColumns, "What a query reads", cells(), caption, &content))
}

pub fn office_stack(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = office_film(maker)?;
    let step = hidden_query(&*film, 40);
    let content = film.picture(step, STACKED, DepthScale::Logarithmic);
    let caption = "The same step with the levels above each other, the pixels at the bottom: a query begins \
                   at the blocks that the box touches, and goes down where it must.";
    Ok(maker.page(Paper::TwoColumns, "The z-pyramid over the image", cells(), caption, &content))
}

fn street_film(maker: &Maker<'_>) -> Result<Arc<dyn Film<Flat>>, SceneError> {
    let scene = example("street")?;
    let view = View { width: 64, ..eye(&scene, 0) };
    Ok(maker.film(&scene, &view, HIERARCHICAL_Z, &[("leaf-primitives", "4")]))
}

pub fn flatland_query(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = street_film(maker)?;
    let step = hidden_query(&*film, 12);
    let world = panels(
        WIDTH_PT,
        1,
        &[flat_panel(&*film, step + 1, &Look::default(), format!("step {step} of {}", film.events().len()))],
    );
    let strips = film.picture(step, PYRAMID, DepthScale::Logarithmic);
    let caption = "Flatland: the image is a line of 64 pixels, its levels a strip each. A cube of the \
                   quadtree (yellow) is asked for; the lines of sight bound the cell that decided, the \
                   farthest thing drawn there lies before the cube's nearest corner, so the cube is hidden.";
    Ok(maker.page(
        Paper::TwoColumns,
        "A cube against the pyramid, in flatland",
        legend(&world),
        caption,
        &below(vec![world, strips]),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::culling::depth::Faces;
    use crate::method::{Event, Verdict};

    #[test]
    fn the_first_face_of_figure_2_is_hidden_and_the_second_is_not() {
        let (scene, view) = figure_1().expect("a scene");
        let is_hidden =
            |pixels| pyramid_picture(&scene, &view, Some((pixels, NEAREST)), DepthScale::Linear).1;
        assert_eq!(FACES.map(is_hidden), [true, false]);
    }

    /// The note at the step of a figure is the answer that hides the node decided next.
    fn is_followed_by_a_hidden_node<S: Faces>(film: &dyn Film<S>, most: u32) {
        let step = hidden_query(film, most);
        let decided = (step..film.events().len())
            .find(|&at| matches!(film.events()[at], Event::DecidedNode(_, Verdict::Hidden)));
        let decided = decided.expect("a node is hidden");
        assert_eq!(film.evidence_of(decided), Some(step));
        assert_eq!(film.subject(decided), film.subject(step));
    }

    #[test]
    fn the_queries_that_are_shown_hide_a_cube() {
        is_followed_by_a_hidden_node(&*office_film(&Maker::gray()).expect("a scene"), 40);
        is_followed_by_a_hidden_node(&*street_film(&Maker::gray()).expect("a scene"), 12);
    }
}
