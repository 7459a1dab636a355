//! Figures of Chamberlain et al., "Fast Rendering of Complex Environments Using a Spatial Hierarchy",
//! Graphics Interface 1996, made anew.

mod notes;
mod plate_5;
mod plates;
mod tearing;

use glam::vec2;

use self::notes::{cubes, leaves, step_of_inner_cell};
use crate::drawing::{Drawing, Role};
use crate::figure::page::legend;
use crate::figure::tools::{Maker, TWO_COLUMNS_PT, WIDTH_PT, entry, eye, flat_panel};
use crate::figure::{Look, Paper, Row, Swatch, listing, panels};
use crate::geometry::View;
use crate::method::CodeLine;
use crate::papers::keys::COLOR_CUBES;
use crate::papers::paper::Figure;
use crate::raster::DepthScale;
use crate::scene::{SceneError, example};

/// The figures.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "chamberlain-figure-1",
        former: None,
        summary: "A molecule from above: leaves drawn as geometry, cells drawn as color cubes, cells culled",
        make: traversal,
    },
    Figure {
        name: "chamberlain-figure-2",
        former: None,
        summary: "Render, the traversal, in pseudocode with its departures",
        make: pseudocode,
    },
    Figure {
        name: "chamberlain-figure-3",
        former: None,
        summary: "Faces of a cell composed of those of its children",
        make: composition,
    },
    tearing::FIGURE,
    plates::TREE,
    plates::MOLECULE,
    plates::ISLAND,
    plates::BUST,
    plates::ORDER,
    Figure {
        name: "chamberlain-plate-5",
        former: None,
        summary: "1, 16, 64 and 4,096 trees, up to 215 million triangles, drawn by color cubes",
        make: plate_5::forests,
    },
];

/// The method's picture of how a face is made.
const MAKING: usize = 1;

pub fn traversal(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("molecule")?;
    let mut view = View { width: 96, ..eye(&scene, 0) };
    // At its rim, looking in.
    (view.eye.position, view.eye.target) = (vec2(-13.0, -7.0), vec2(0.0, 1.0));
    (view.eye.near, view.eye.far) = (0.5, 40.0);
    let film = maker.film(&scene, &view, COLOR_CUBES, &[("pixel-threshold", "12")]);
    let (cubes, leaves) = (cubes(&*film), leaves(&*film));
    let label = format!("{cubes} cells drawn as color cubes, {leaves} as geometry");
    let content = panels(WIDTH_PT, 1, &[flat_panel(&*film, film.events().len(), &Look::default(), label)]);
    let caption = format!(
        "A molecule in flatland from above, seen in a line of {} pixels. The threshold is 12 pixels, so that \
         cubes are large enough to be looked at. Near the eye cells are larger and are divided down to \
         leaves, which are drawn as geometry; farther off cells are drawn as their color cubes: along the \
         edges that face the eye stand the colors of its faces, on paper, which shows through as far as they \
         are not covered. What is outside the view is culled, a whole cell at a time. Where \
         cubes would not pay for the visit, a cell is drawn as geometry however far off it is.",
        view.width
    );
    Ok(maker.page(
        Paper::TwoColumns,
        "Chamberlain et al. 1996, Figure 1: what is drawn of the hierarchy",
        legend(&content),
        caption,
        &content,
    ))
}

/// The figure itself is lost in the paper; by its place it is this.
pub fn pseudocode(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("forest")?;
    let film = maker.film(&scene, &eye(&scene, 0), COLOR_CUBES, &[]);
    let lines = film.card().code.iter().zip(0..).filter(|(_, line)| film.has_line(*line));
    let code: Vec<CodeLine> = lines.map(|(line, _)| *line).collect();
    let caption = "Render, called with the root of the octree and the planes of the view frustum, as the \
                   explorer steps through it. The paper's own figure was not at hand: this is what its text \
                   says, in lines. In gray below a line: what the paper has in its place.";
    let title = "Chamberlain et al. 1996, Figure 2: Render";
    Ok(maker.page(Paper::TwoColumns, title, Vec::new(), caption, &listing(&Row::all(&code), TWO_COLUMNS_PT)))
}

pub fn composition(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("molecule")?;
    let view = View { width: 96, ..eye(&scene, 0) };
    let film = maker.film(&scene, &view, COLOR_CUBES, &[("pixel-threshold", "30")]);
    let content = film.picture(step_of_inner_cell(&*film), MAKING, DepthScale::Linear);
    let caption = "The faces of a cell of flatland, which has four children. For each face there are two \
                   columns: the front child's face, above, goes over the back one's, below it, and the mean \
                   of the two results is the face of the cell. Opacity is shown as such, so that paper shows \
                   through what is partly covered. In space there are four columns of two for each of six \
                   faces.";
    Ok(maker.page(
        Paper::TwoColumns,
        "Chamberlain et al. 1996, Figure 3: composing and averaging faces of children",
        vec![entry(Role::Approximated, Swatch::Area, "a face, in its color and opacity")],
        caption,
        &content,
    ))
}
