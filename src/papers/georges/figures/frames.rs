//! Whole frames: the cubes of a quadtree by state, and the schedule of the simulated machine.

use std::sync::Arc;

use glam::vec2;

use super::pyramid::office;
use crate::culling::Methods;
use crate::drawing::{Anchor, Drawing, Layer, Role};
use crate::figure::page::{below, legend};
use crate::figure::tools::{Tint, WIDTH_PT, eye, flat_panel, page, ready};
use crate::figure::{Look, Paper, panels};
use crate::geometry::{Flat, Solid, View};
use crate::method::{Film, Verdict};
use crate::papers::keys::HIERARCHICAL_Z;
use crate::raster::DepthScale;
use crate::scene::{Scene, SceneError, example};
use crate::trace::Stamps;

/// The picture of the method that shows the machine, by number.
const TIMELINE: usize = 3;

pub fn quadtree(_: Tint) -> Result<Drawing, SceneError> {
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
    let content = panels(WIDTH_PT, 2, &[panel("false", 0), panel("true", 1)]);
    let caption = "A game level from above after a whole frame. Left without coherence: cubes are visited \
                   front to back and asked one by one. Right the second frame with coherence: the cubes that \
                   were visible are drawn first, without being asked, and the rest is asked against an image \
                   that is almost complete; some segments are drawn that the cubes before them would have \
                   hidden.";
    Ok(page(Paper::TwoColumns, "A quadtree's cubes by state", legend(&content), caption, &content))
}

/// The film of a frame after some frames of the same view.
fn after<S: Methods>(
    scene: &Arc<Scene<S>>,
    view: &View<S>,
    pairs: &[(&str, &str)],
    frames: usize,
) -> Arc<dyn Film<S>> {
    let mut run = ready(scene, HIERARCHICAL_Z, pairs);
    (0..frames).for_each(|_| _ = run.cull(view));
    run.record(view, usize::MAX).film
}

pub fn timelines(_: Tint) -> Result<Drawing, SceneError> {
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
            Layer::Labels,
            Role::Ink,
            vec2(0.0, 9.0),
            8.5,
            Anchor::Start,
            format!("distribute by {distribution}"),
        );
        if distribution != "hybrid" {
            picture.items.retain(|i| i.layer != Layer::Legend);
            picture.size_pt.y -= 24.0;
        }
        parts.push(picture);
    }
    let caption = "A second frame of an office on a simulated machine of four processors and four renderers. \
                   By structure, whole parts of the scene go to one processor, and some sit idle; by \
                   primitive, every processor asks for every structure; hybrid, structures are dealt finely, \
                   so that near ones go to different processors. At the right the share of the frame in \
                   which a unit works.";
    Ok(page(
        Paper::TwoColumns,
        "Georges 1995, Section 4.1: three ways to distribute structures",
        vec![],
        caption,
        &below(parts),
    ))
}
