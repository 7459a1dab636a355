//! Figures of Georges, "Obscuration Culling on Parallel Graphics Architectures", UNC TR95-017, 1995, made
//! anew (1 and 2), and of what the method `hierarchical-z` does on scenes: its pyramid, its queries, its
//! octree, its simulated machine.

use std::sync::Arc;

use glam::vec2;

use super::builtin::{Row, eye, film, flat_panel, page};
use super::page::legend;
use super::{Entry, Look, Page, Paper, Swatch, Tint, panels};
use crate::culling::obscuration::{figure_1, pyramid_picture};
use crate::drawing::{Drawing, Item, Mark, Role};
use crate::geometry::{Flat, PixelRect, Solid, Space, View};
use crate::method::{Event, Film, Value, Verdict};
use crate::raster::DepthScale;
use crate::scene::{AnyScene, LoadOptions, Quiet, Scene, SceneError, example, load};
use crate::trace::Stamps;

/// The figures.
pub const FIGURES: &[Row] = &[
    ("hierarchical-z-1", "The three levels of a simple z-pyramid", simple_pyramid),
    ("hierarchical-z-2", "A face is tested against the z-pyramid, level by level", simple_query),
    ("hierarchical-z-query", "What a query reads of the pyramid over an office", office_query),
    ("hierarchical-z-stack", "The z-pyramid over the image", office_stack),
    (
        "hierarchical-z-flatland",
        "A cube of a quadtree is asked for, and the strips of its pyramid",
        flatland_query,
    ),
    ("hierarchical-z-quadtree", "A quadtree's cubes by state, and what is drawn", quadtree),
    (
        "hierarchical-z-timeline",
        "What processors and renderers do when, for three ways to deal structures out",
        timelines,
    ),
];

/// Pictures of the method, by number.
const PYRAMID: usize = 0;
const STACKED: usize = 1;
const TIMELINE: usize = 3;

/// Puts drawings below each other.
fn below(parts: Vec<Drawing>) -> Drawing {
    let mut all = Drawing::default();
    for part in parts {
        let by = vec2(0.0, all.size_pt.y);
        all.items
            .extend(part.items.into_iter().map(|item| Item { mark: item.mark.mapped(|p| p + by), ..item }));
        all.size_pt = vec2(all.size_pt.x.max(part.size_pt.x), by.y + part.size_pt.y);
    }
    all
}

/// The legend of lit cells.
fn cells() -> Vec<Entry> {
    let entry = |role, label: &str| Entry { role, label: label.into(), swatch: Swatch::Line };
    vec![
        entry(Role::Hidden, "the face lies behind the cell"),
        entry(Role::Undecided, "it may not: the cells below are read"),
        entry(Role::Visible, "a sample shows the face"),
        entry(Role::Current, "read last"),
    ]
}

fn two_columns(title: &str, legend: Vec<Entry>, caption: String, content: &Drawing) -> Drawing {
    Page { paper: Paper::TwoColumns, title: title.into(), legend, caption }.compose(content)
}

fn simple_pyramid(_: Tint) -> Result<Drawing, SceneError> {
    let (scene, view) = figure_1()?;
    let (content, _) = pyramid_picture(&scene, &view, None, DepthScale::Linear);
    let caption = "Level 0 is the z-buffer. Each value of the level above is the farthest of the four below \
                   it, so the single value on top, 9, is the farthest depth of the whole image. The values \
                   are those of the paper's Figure 1; near is dark, far is light.";
    Ok(two_columns(
        "Georges 1995, Figure 1: a z-pyramid of three levels",
        vec![],
        caption.into(),
        &trimmed(content),
    ))
}

/// Without the lines below the levels that speak of reads.
fn trimmed(mut content: Drawing) -> Drawing {
    content.items.retain(|i| !matches!(&i.mark, Mark::Text { text, .. } if text.starts_with("No cell")));
    content
}

fn simple_query(_: Tint) -> Result<Drawing, SceneError> {
    let (scene, view) = figure_1()?;
    let mut parts = Vec::new();
    for pixels in [PixelRect { x0: 0, x1: 1, y0: 0, y1: 2 }, PixelRect { x0: 0, x1: 2, y0: 0, y1: 1 }] {
        let (picture, _) = pyramid_picture(&scene, &view, Some((pixels, 6.0)), DepthScale::Linear);
        parts.push(picture);
    }
    let caption = "A face whose nearest point is at depth 6 is asked for. Above it covers the left column of \
                   the upper left quarter: the finest cell that covers it holds 9, so nothing is decided; \
                   the two samples that the face itself covers are 4 and 4, both nearer than 6, so the face \
                   is hidden. Below it covers the upper row: sample 4 hides it, sample 9 does not, so it is \
                   visible.";
    Ok(two_columns(
        "Georges 1995, Figure 2: a face against the pyramid",
        cells(),
        caption.into(),
        &below(parts),
    ))
}

fn office() -> Result<Arc<Scene<Solid>>, SceneError> {
    match load("generate:building?polygons=20000", &LoadOptions::default(), &Quiet)? {
        AnyScene::Solid(scene) => Ok(scene),
        AnyScene::Flat(_) => unreachable!("the building is in space"),
    }
}

/// The step at which the answer for a hidden node is given that read many cells, but no more than fit a
/// picture; its node.
fn hidden_query<S: Space>(film: &dyn Film<S>, most: u64) -> usize {
    let reads = |at: usize| {
        let (kind, fields) = film.fields(at);
        let is_hidden = fields.iter().any(|f| f.name == "hidden" && f.value == Value::Switch(true));
        let reads = fields.iter().find_map(|f| {
            if let ("cells_read", Value::Integer(n)) = (f.name, &f.value) { Some(*n) } else { None }
        });
        (kind == "ObscurationTested" && is_hidden).then_some(reads?).filter(|n| *n <= most)
    };
    let noted = (0..film.events().len()).filter(|&at| matches!(film.events()[at], Event::Noted(_)));
    let best = noted.filter_map(|at| Some((reads(at)?, at))).max_by_key(|(n, at)| (*n, usize::MAX - at));
    // The last read is right before the answer.
    best.map_or(film.events().len(), |(_, at)| at)
}

fn office_film() -> Result<Arc<dyn Film<Solid>>, SceneError> {
    let scene = office()?;
    let view = View { width: 256, height: 192, ..scene.paths()[0].views[0] };
    Ok(film(&scene, &view, "hierarchical-z", &[]))
}

fn office_query(_: Tint) -> Result<Drawing, SceneError> {
    let film = office_film()?;
    let step = hidden_query(&*film, 40);
    let content = film.picture(step, PYRAMID, DepthScale::Logarithmic);
    let caption = format!(
        "The pyramid over an office of {} triangles, 256 × 192 pixels, at step {step} of {}, when a cube of \
         the octree has been found hidden. Cells are numbered in the order in which they were read: where a \
         coarse cell does not decide, the four below it are read, down to the samples. Cross-hatched cells \
         were drawn into since they were last read.",
        film.scene().live().len(),
        film.events().len()
    );
    Ok(two_columns("What a query reads", cells(), caption, &content))
}

fn office_stack(_: Tint) -> Result<Drawing, SceneError> {
    let film = office_film()?;
    let step = hidden_query(&*film, 40);
    let content = film.picture(step, STACKED, DepthScale::Logarithmic);
    let caption = "The same step with the levels above each other, the image at the bottom: a query begins \
                   at the finest cell that covers the face, and goes down where it must.";
    Ok(two_columns("The z-pyramid over the image", cells(), caption.into(), &content))
}

fn flatland_query(_: Tint) -> Result<Drawing, SceneError> {
    let scene = example("street")?;
    let view = View { width: 64, ..eye(&scene, 0) };
    let film = film(&scene, &view, "hierarchical-z", &[("leaf-primitives", "4")]);
    let step = hidden_query(&*film, 12);
    let world = panels(
        super::builtin::WIDTH_PT,
        1,
        &[flat_panel(&*film, step + 1, &Look::default(), format!("step {step} of {}", film.events().len()))],
    );
    let strips = film.picture(step, PYRAMID, DepthScale::Logarithmic);
    let caption = "Flatland: the image is a line of 64 pixels, its pyramid a strip a level. A cube of the \
                   quadtree (yellow) is asked for; the lines of sight bound the cell that decided, the \
                   farthest thing drawn there lies before the cube's nearest corner, so the cube is hidden.";
    Ok(two_columns(
        "A cube against the pyramid, in flatland",
        legend(&world),
        caption.into(),
        &below(vec![world, strips]),
    ))
}

fn quadtree(_: Tint) -> Result<Drawing, SceneError> {
    let scene = example("freedoom_e1m1")?;
    let view = View { width: 512, ..eye(&scene, 0) };
    let panel = |coherence: &str, frames: usize| {
        let film =
            after::<Flat>(&scene, &view, &[("leaf-primitives", "8"), ("coherence", coherence)], frames);
        let end = film.events().len();
        let counts = Stamps::new(&*film).counts(end);
        let label = format!(
            "{} drawn, {} hidden, {} outside",
            counts.of(Verdict::Visible),
            counts.of(Verdict::Hidden),
            counts.of(Verdict::Outside)
        );
        flat_panel(&*film, end, &Look { evidence: false, ..Look::default() }, label)
    };
    let content = panels(super::builtin::WIDTH_PT, 2, &[panel("false", 0), panel("true", 1)]);
    let caption = "A game level from above after a whole frame. Left without coherence: cubes are visited \
                   front to back and asked one by one. Right the second frame with coherence: the cubes that \
                   were visible are drawn first, without being asked, and the rest is asked against an image \
                   that is almost complete; some segments are drawn that the cubes before them would have \
                   hidden.";
    Ok(page("A quadtree's cubes by state", caption, &content))
}

/// The film of a frame after some frames of the same view.
fn after<S: crate::culling::Methods>(
    scene: &Arc<Scene<S>>,
    view: &View<S>,
    pairs: &[(&str, &str)],
    frames: usize,
) -> Arc<dyn Film<S>> {
    let entry = S::method("hierarchical-z").expect("built-in figures name methods that exist");
    let run = entry
        .ready(scene, &super::builtin::settings(pairs), &Quiet)
        .expect("built-in figures use settings that exist");
    let mut run = run.expect("nobody cancels a built-in figure");
    (0..frames).for_each(|_| _ = run.cull(view));
    run.record(view, usize::MAX).film
}

fn timelines(_: Tint) -> Result<Drawing, SceneError> {
    let scene = office()?;
    let view = View { width: 512, height: 384, ..scene.paths()[0].views[0] };
    let mut parts = Vec::new();
    for distribution in ["structure", "primitive", "hybrid"] {
        let film = after::<Solid>(
            &scene,
            &view,
            &[
                ("processors", "4"),
                ("renderers", "4"),
                ("distribution", distribution),
                ("leaf-primitives", "64"),
            ],
            1,
        );
        let mut picture = film.picture(film.events().len(), TIMELINE, DepthScale::default());
        picture.text(
            crate::drawing::Layer::Labels,
            Role::Ink,
            vec2(0.0, 9.0),
            8.5,
            crate::drawing::Anchor::Start,
            format!("distribute by {distribution}"),
        );
        if distribution != "hybrid" {
            picture.items.retain(|i| i.layer != crate::drawing::Layer::Legend);
            picture.size_pt.y -= 24.0;
        }
        parts.push(picture);
    }
    let caption = "A second frame of an office on a simulated machine of four processors and four renderers. \
                   By structure, whole parts of the scene go to one processor, and some sit idle; by \
                   primitive, every processor asks for every structure; hybrid, structures are dealt finely, \
                   so that near ones go to different processors. At the right the share of the frame in \
                   which a unit works.";
    Ok(two_columns(
        "Georges 1995, Section 4.1: three ways to distribute structures",
        vec![],
        caption.into(),
        &below(parts),
    ))
}
