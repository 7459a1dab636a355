//! Whole frames: the cubes of a quadtree by state, and the schedule of the simulated machine.

use std::sync::Arc;

use glam::vec2;

use super::pyramid::office;
use crate::culling::Methods;
use crate::drawing::{Anchor, Drawing, Item, Layer, Mark, Role, words};
use crate::figure::page::{below, legend};
use crate::figure::tools::{Maker, WIDTH_PT, eye, flat_panel};
use crate::figure::{Look, Paper, panels};
use crate::geometry::{Flat, Solid, View};
use crate::method::{Film, Verdict};
use crate::papers::keys::{HIERARCHICAL_Z, PARALLEL_HIERARCHICAL_Z};
use crate::raster::DepthScale;
use crate::scene::{Scene, SceneError, example};
use crate::trace::Stamps;

/// The picture of the method that shows the machine, by number.
const TIMELINE: usize = 3;
/// Processors of the machine.
const PROCESSORS: &str = "4";

/// A frame of the game level, after some frames of the same view.
fn level(maker: &Maker<'_>, scene: &Arc<Scene<Flat>>, coherence: &str, frames: usize) -> Arc<dyn Film<Flat>> {
    let view = View { width: 512, ..eye(scene, 0) };
    after(maker, HIERARCHICAL_Z, scene, &view, &[("leaf-primitives", "8"), ("coherence", coherence)], frames)
}

pub fn quadtree(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("freedoom_e1m1")?;
    let panel = |coherence: &str, frames: usize| {
        let film = level(maker, &scene, coherence, frames);
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
                   that is almost complete. Both draw the same segments: one that lies behind all that is \
                   drawn in its tiles is left out as it is drawn, whether its cube was asked for or not.";
    Ok(maker.page(Paper::TwoColumns, "A quadtree's cubes by state", legend(&content), caption, &content))
}

/// The film of a frame after some frames of the same view.
fn after<S: Methods>(
    maker: &Maker<'_>,
    method: &str,
    scene: &Arc<Scene<S>>,
    view: &View<S>,
    pairs: &[(&str, &str)],
    frames: usize,
) -> Arc<dyn Film<S>> {
    let mut run = maker.ready(scene, method, pairs);
    (0..frames).for_each(|_| _ = run.cull(view));
    run.record(view, usize::MAX).film
}

/// What the units of the simulated machine do in a second frame.
fn timeline(maker: &Maker<'_>, scene: &Arc<Scene<Solid>>, distribution: &str) -> Drawing {
    let view = View { width: 512, height: 384, ..scene.paths()[0].views[0] };
    let pairs = [
        ("processors", PROCESSORS),
        ("renderers", "4"),
        ("distribution", distribution),
        ("leaf-primitives", "64"),
    ];
    let film = after(maker, PARALLEL_HIERARCHICAL_Z, scene, &view, &pairs, 1);
    film.picture(film.events().len(), TIMELINE, DepthScale::default())
}

/// Ways to deal structures out, in the order of the figure.
const DISTRIBUTIONS: [&str; 4] = ["structure", "primitive", "hybrid", "subtree"];

/// What a timeline says: the least and the greatest share of the frame in which a processor works, in
/// percent, and the ticks of the frame.
fn told(timeline: &Drawing) -> [u32; 3] {
    let numbers = |unit: &str| -> Vec<u32> {
        let number = |item: &Item<_>| match &item.mark {
            Mark::Text { text, .. } => text.strip_suffix(unit)?.parse().ok(),
            _ => None,
        };
        timeline.items.iter().filter_map(number).collect()
    };
    // The renderers follow the processors.
    let shares = numbers(" %").into_iter().take(PROCESSORS.parse().unwrap_or_default());
    let (least, most) = (shares.clone().min(), shares.max());
    [least, most, numbers(" ticks").into_iter().max()].map(Option::unwrap_or_default)
}

pub fn timelines(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = office()?;
    let (mut parts, mut measured) = (Vec::new(), Vec::new());
    for distribution in DISTRIBUTIONS {
        let mut picture = timeline(maker, &scene, distribution);
        let [least, most, ticks] = told(&picture);
        measured.push(format!("by {distribution} {least} to {most} %, {ticks} ticks"));
        picture.text(
            Layer::Labels,
            Role::Ink,
            vec2(0.0, 9.0),
            8.5,
            Anchor::Start,
            format!("distribution: {distribution}"),
        );
        if Some(&distribution) != DISTRIBUTIONS.last() {
            picture.items.retain(|i| i.layer != Layer::Legend);
            picture.size_pt.y -= 24.0;
        }
        parts.push(picture);
    }
    let caption = format!(
        "A second frame of an office of {} triangles on a simulated machine of {PROCESSORS} processors and 4 \
         renderers (512 × 384 pixels). By structure, cubes are dealt out in turn, each \
         with what it holds; by primitive, every processor has a part of every cube and asks for all of \
         them; hybrid, cubes are dealt out in turn and a processor asks for several of its own at once; by \
         subtree, which is not in the paper, whole parts of the scene go to one processor. At the right the \
         share of the frame in which a unit works. Of the processors, and the time of the frame: {}.",
        words::count(scene.live().len()),
        measured.join("; ")
    );
    Ok(maker.page(
        Paper::TwoColumns,
        "Georges 1995, Section 4.1: ways to distribute structures",
        vec![],
        &caption,
        &below(parts),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_coherence_no_more_is_drawn() {
        let scene = example("freedoom_e1m1").expect("a scene");
        let drawn = |coherence, frames| {
            let film = level(&Maker::gray(), &scene, coherence, frames);
            let counts = Stamps::new(&*film).counts(film.events().len());
            let all = [Verdict::Visible, Verdict::Hidden, Verdict::Outside].map(|v| counts.of(v));
            assert_eq!(all.iter().sum::<usize>(), scene.live().len(), "every segment is decided");
            all[0]
        };
        assert_eq!(drawn("true", 1), drawn("false", 0), "segments that are drawn");
    }

    #[test]
    fn whole_parts_of_the_scene_balance_worse_than_cubes_in_turn() {
        let scene = office().expect("a scene");
        let [subtree, structure, primitive, hybrid] = ["subtree", "structure", "primitive", "hybrid"]
            .map(|way| told(&timeline(&Maker::gray(), &scene, way)));
        assert!(subtree[0] + 10 < structure[0], "idlest by subtree {subtree:?}, by structure {structure:?}");
        assert!(
            primitive[2] > hybrid[2],
            "every processor asks for every structure: {primitive:?}, {hybrid:?}"
        );
        assert!([subtree, structure, primitive, hybrid].iter().all(|t| t[1] > 0 && t[2] > 0));
    }
}
