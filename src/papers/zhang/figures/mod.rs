//! Figures of Zhang et al., "Visibility Culling using Hierarchical Occlusion Maps", SIGGRAPH 1997, made anew.

mod averages;
mod charts;
mod distance;
mod notes;
mod pipeline;
mod plates;
mod space;
mod trees;

use std::sync::Arc;

use self::notes::{culled_node, occluder_prims};
use crate::drawing::{Drawing, Role};
use crate::figure::page::{below, legend};
use crate::figure::tools::{Maker, WIDTH_PT, entry, eye, flat_panel};
use crate::figure::{Entry, Look, Paper, Swatch, panels};
use crate::geometry::{Flat, Solid, View};
use crate::method::{Film, Verdict};
use crate::papers::keys::OCCLUSION_MAPS;
use crate::papers::paper::Figure;
use crate::raster::DepthScale;
use crate::scene::{AnyScene, LoadOptions, Quiet, Scene, SceneError, example, load};
use crate::trace::Stamps;

/// The figures.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "zhang-figure-1",
        former: None,
        summary: "A game level from above: occluders, what is kept and what is culled",
        make: level,
    },
    Figure {
        name: "zhang-figure-2",
        former: None,
        summary: "The pipeline: two phases, with a picture of one frame in each block",
        make: pipeline::pipeline,
    },
    Figure {
        name: "zhang-figure-3",
        former: None,
        summary: "The hierarchy of occlusion maps over a street",
        make: hierarchy,
    },
    Figure {
        name: "zhang-figure-4",
        former: None,
        summary: "A map is averaged as a texture that is drawn at half its size",
        make: averages::averages,
    },
    Figure {
        name: "zhang-figure-5",
        former: None,
        summary: "The distance criterion misses what is far and hides much",
        make: distance::distance,
    },
    Figure {
        name: "zhang-figure-6",
        former: None,
        summary: "A house behind trees, the holes among them, and the maps",
        make: trees::trees,
    },
    Figure {
        name: "zhang-figure-7",
        former: None,
        summary: "Trees as occluders, without and with approximate culling",
        make: thresholds,
    },
    Figure {
        name: "zhang-figure-8",
        former: None,
        summary: "The overlap test reads map pixels, level by level",
        make: overlap,
    },
    Figure {
        name: "zhang-figure-9",
        former: None,
        summary: "What is drawn and culled frame by frame, on three models",
        make: charts::frames,
    },
    Figure {
        name: "zhang-figure-10",
        former: None,
        summary: "What a frame draws by stage, on three models",
        make: charts::stages,
    },
    Figure {
        name: "zhang-figure-11",
        former: None,
        summary: "A city from above: occluders, kept, culled",
        make: plates::city,
    },
    Figure {
        name: "zhang-figure-12",
        former: None,
        summary: "A swarm of moving bodies from above: occluders, kept, culled",
        make: plates::swarm,
    },
    Figure {
        name: "zhang-figure-13",
        former: None,
        summary: "A machine room from above: occluders, kept, culled",
        make: plates::room,
    },
];

/// Pictures of the method, by number.
const MAPS: usize = 0;
const STACKED: usize = 1;

fn counts<S: crate::culling::Methods>(film: &dyn Film<S>) -> [usize; 4] {
    let counts = Stamps::new(film).counts(film.events().len());
    let of = |verdict| counts.of(verdict);
    [of(Verdict::Visible), of(Verdict::Hidden), of(Verdict::Presumed), of(Verdict::Outside)]
}

/// One frame of a flatland scene with a budget that does not adapt.
fn flat_film(
    maker: &Maker<'_>,
    scene: &Arc<Scene<Flat>>,
    budget: &str,
    width: u32,
    more: &[(&str, &str)],
) -> Arc<dyn Film<Flat>> {
    let view = View { width, ..eye(scene, 0) };
    let fixed = [("adapt", "false"), ("occluder-budget", budget), ("depth", "estimation")];
    let pairs = [&fixed, more].concat();
    maker.film(scene, &view, OCCLUSION_MAPS, &pairs)
}

pub fn level(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("freedoom_e1m1")?;
    let film = flat_film(maker, &scene, "60", 1024, &[]);
    let [drawn, hidden, _, outside] = counts(&*film);
    let label = format!("{drawn} drawn, {hidden} hidden, {outside} outside");
    let look = Look { nodes: false, ..Look::default() };
    let content = panels(WIDTH_PT, 1, &[flat_panel(&*film, film.events().len(), &look, label)]);
    let in_view = drawn + hidden;
    let caption = format!(
        "A game level from above. Of its {} segments {} are occluders, those nearest to the eye; some \
         of them lie behind others. Kept are {drawn} of {in_view} in view: {:.1} % of these are culled. The \
         lines across the view are the depth estimation buffer: what lies beyond them, within what the \
         occluders cover, is hidden. In the paper's Figure 1 82.7 % of a machine room are culled, outside \
         the frustum or hidden; here that is {:.1} %.",
        scene.live().len(),
        occluder_prims(&*film),
        100.0 * hidden as f64 / in_view as f64,
        100.0 * (hidden + outside) as f64 / scene.live().len() as f64
    );
    Ok(maker.page(
        Paper::TwoColumns,
        "Zhang et al. 1997, Figure 1, in flatland: occluders, kept, culled",
        legend(&content),
        caption,
        &content,
    ))
}

fn city_film(maker: &Maker<'_>) -> Result<Arc<dyn Film<Solid>>, SceneError> {
    let options = LoadOptions::default();
    let AnyScene::Solid(scene) = load("generate:city?polygons=6000&seed=7", &options, &Quiet)? else {
        unreachable!("a city is in space")
    };
    // Where a street is looked along.
    let path = scene.paths().iter().find(|p| p.name == "figure 8");
    let view = path.and_then(|p| p.views.get(24)).copied();
    let view = View { width: 256, height: 192, ..view.unwrap_or(scene.paths()[0].views[0]) };
    let pairs =
        [("adapt", "false"), ("occluder-budget", "300"), ("map-resolution", "64"), ("depth", "estimation")];
    Ok(maker.film(&scene, &view, OCCLUSION_MAPS, &pairs))
}

/// The legend of lit map pixels.
fn pixels() -> Vec<Entry> {
    let entry = |role, label: &str| entry(role, Swatch::Line, label);
    vec![
        entry(Role::Hidden, "opaque enough"),
        entry(Role::Undecided, "not so: the pixels below are read"),
        entry(Role::Visible, "not opaque: the test ends"),
        entry(Role::Current, "read last"),
    ]
}

pub fn hierarchy(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = city_film(maker)?;
    let step = culled_node(&*film, 12);
    let picture = |which| film.picture(step, which, DepthScale::Linear);
    let caption = "The occluders of a street in white, at the bottom, and above them the levels that come \
                   of averaging 2 × 2 pixels, down to 4 × 4: a pixel's gray is the share of it that is \
                   covered. Below the levels beside each other. At this step a node of the model has been \
                   found within what is covered; the pixels that were read for it are lit and numbered.";
    Ok(maker.page(
        Paper::TwoColumns,
        "Zhang et al. 1997, Figure 3: a hierarchy of occlusion maps",
        pixels(),
        caption,
        &below(vec![picture(STACKED), picture(MAPS)]),
    ))
}

pub fn thresholds(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("forest")?;
    let panel = |threshold: &str| {
        let more = [("opacity-threshold", threshold), ("map-resolution", "64")];
        let film = flat_film(maker, &scene, "60", 1024, &more);
        let [drawn, hidden, presumed, _] = counts(&*film);
        let label =
            format!("threshold {threshold}: {drawn} drawn, {hidden} hidden, {presumed} presumed hidden");
        flat_panel(
            &*film,
            film.events().len(),
            &Look { evidence: false, nodes: false, ..Look::default() },
            label,
        )
    };
    let content = panels(WIDTH_PT, 2, &[panel("1"), panel("0.7")]);
    let caption = "A forest from above. Left a map pixel of 16 samples is opaque only if the occluders cover \
                   all of it. Right it is opaque with up to 4 samples black, so that what shows through \
                   small gaps is left out as well: presumed hidden, not proven. The paper's Figure 7 uses \
                   thresholds from 0.7 up.";
    Ok(maker.page(
        Paper::TwoColumns,
        "Zhang et al. 1997, Figure 7, in flatland: approximate culling",
        legend(&content),
        caption,
        &content,
    ))
}

fn street_film(maker: &Maker<'_>) -> Result<Arc<dyn Film<Flat>>, SceneError> {
    Ok(flat_film(maker, &example("street")?, "12", 64, &[("leaf-primitives", "4")]))
}

pub fn overlap(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let film = street_film(maker)?;
    let step = culled_node(&*film, 12);
    let label = format!("step {step} of {}", film.events().len());
    let world = panels(WIDTH_PT, 1, &[flat_panel(&*film, step + 1, &Look::default(), label)]);
    let strips = film.picture(step, MAPS, DepthScale::Linear);
    let caption = "Flatland: the image is a line of 64 samples, and its maps are strips, white where the \
                   occluders cover them. A node of the hierarchy (yellow) lies behind the depth estimation \
                   buffer, the line across the view; its pixels are looked up from the level on which they \
                   are about as large as it, and where one is not opaque, those below it. All are opaque, \
                   so the node is hidden.";
    Ok(maker.page(
        Paper::TwoColumns,
        "Zhang et al. 1997, Figure 8: the overlap test, in flatland",
        [legend(&world), pixels()].concat(),
        caption,
        &below(vec![world, strips]),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Event;

    #[test]
    fn a_lower_threshold_culls_more_of_the_forest() {
        let maker = Maker::gray();
        let scene = example("forest").expect("an example");
        let of = |threshold: &str| {
            let more = [("opacity-threshold", threshold), ("map-resolution", "64")];
            counts(&*flat_film(&maker, &scene, "60", 1024, &more))
        };
        let ([exact, hidden, none, _], [fewer, _, presumed, _]) = (of("1"), of("0.7"));
        assert!(none == 0 && hidden > 0 && presumed > 0 && fewer < exact, "{exact} and {fewer} drawn");
    }

    #[test]
    fn the_node_that_is_shown_is_hidden() {
        let maker = Maker::gray();
        let film = street_film(&maker).expect("made");
        let step = culled_node(&*film, 12);
        assert!(step < film.events().len(), "some node is culled");
        let city = city_film(&maker).expect("made");
        assert!(culled_node(&*city, 12) < city.events().len(), "in space too");
        let next = film.events()[step..].iter().find_map(Event::verdict);
        assert_eq!(next, Some(Verdict::Hidden));
    }

    #[test]
    fn most_of_the_level_that_is_in_view_is_culled() {
        let maker = Maker::gray();
        let scene = example("freedoom_e1m1").expect("an example");
        let [drawn, hidden, ..] = counts(&*flat_film(&maker, &scene, "60", 1024, &[]));
        assert!(hidden > drawn, "{hidden} hidden, {drawn} drawn");
    }
}
