//! The figures of the baselines: the kD-tree, view-frustum culling, the three beside each other, the item
//! buffer.

use std::sync::Arc;

use crate::culling::baseline::{Evidence, Frustum};
use crate::drawing::{Drawing, Layer, Pixels, Role, Subject};
use crate::figure::page::legend;
use crate::figure::tools::{Maker, WIDTH_PT, airy, entry, eye, flat_panel};
use crate::figure::{Look, Panel, Paper, Picture, Swatch, observer_above, panels, world};
use crate::geometry::{Flat, NodeId, Solid, View};
use crate::method::{Film, Verdict, notes};
use crate::papers::keys::{CENTROID, FRUSTUM, Z_BUFFER};
use crate::papers::paper::Figure;
use crate::raster;
use crate::scene::{AnyScene, LoadOptions, Quiet, Scene, SceneError, example, load};
use crate::trace::Stamps;

/// The figures.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "baselines-kd-tree-levels",
        former: Some("kd-tree-levels"),
        summary: "A kD-tree over a street, level by level",
        make: kd_tree_levels,
    },
    Figure {
        name: "baselines-frustum-tests",
        former: Some("frustum-tests"),
        summary: "The three results of a box against the frustum, with their operands",
        make: frustum_tests,
    },
    Figure {
        name: "baselines-frustum-steps",
        former: Some("frustum-steps"),
        summary: "Four moments of view-frustum culling over a kD-tree",
        make: frustum_steps,
    },
    Figure {
        name: "baselines-flatland",
        former: None,
        summary: "The three baselines on the same game level",
        make: baselines_flatland,
    },
    Figure {
        name: "baselines-frustum-space",
        former: Some("frustum-space"),
        summary: "View-frustum culling of an office floor, seen from outside",
        make: frustum_space,
    },
    Figure {
        name: "baselines-item-buffer",
        former: Some("item-buffer"),
        summary: "What the Eye sees: shaded image, item buffer and depth",
        make: item_buffer,
    },
];

/// The scene of small figures.
const STREET: &str = "street";

fn kd_tree_levels(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example(STREET)?;
    let film = maker.film(&scene, &eye(&scene, 0), FRUSTUM, &[]);
    let tree = film.hierarchy();
    let panel = |level: u32| {
        let mut drawing = Drawing::default();
        for &p in scene.live() {
            drawing.line(Layer::Scene, Role::Ink, Subject::Prim(p), scene.prim_points(p).collect::<Vec<_>>());
        }
        let nodes = (0..tree.node_count() as u32).map(NodeId).filter(|&n| tree.level(n) == level);
        let count = nodes.clone().count();
        nodes.for_each(|n| drawing.bounds(Layer::Nodes, Role::Evidence, Subject::Node(n), &tree.bounds(n)));
        Panel {
            label: format!("level {level}: {count} node{}", if count == 1 { "" } else { "s" }),
            picture: Picture::Flat(drawing, airy(&scene, scene.bounds().center())),
        }
    };
    let content = panels(WIDTH_PT, 2, &[0, 1, 2, 4].map(panel));
    let caption = "A kD-tree splits the polygons of a street into halves, alternately along x and y. Each \
                   box is the bounds of what its node holds, so boxes of one level may overlap where a \
                   polygon crosses the splitting line.";
    let legend = vec![
        entry(Role::Ink, Swatch::Line, "polygon"),
        entry(Role::Evidence, Swatch::Line, "bounds of a node"),
    ];
    Ok(maker.page(Paper::TwoColumns, "kD-tree, level by level", legend, caption, &content))
}

/// The step right after the test of a node with this result whose box is the largest that fits well into the
/// picture.
fn step_of(film: &dyn Film<Flat>, result: &str) -> usize {
    let all = film.scene().bounds().diagonal();
    let size_of = |note: &Evidence<Flat>| {
        let Evidence::Tested(test) = note else { return None };
        let Subject::Node(node) = test.subject() else { return None };
        let bounds = film.hierarchy().bounds(node);
        let area = bounds.size().x * bounds.size().y;
        (test.result() == result && bounds.diagonal() < 0.45 * all).then_some(area)
    };
    let sizes = notes::<Flat, Frustum>(film).filter_map(|(at, note)| Some((at, size_of(note)?)));
    sizes.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map_or(film.events().len(), |(at, _)| at + 1)
}

fn frustum_tests(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example(STREET)?;
    let film = maker.film(&scene, &eye(&scene, 0), FRUSTUM, &[]);
    let look = Look { nodes: false, ..Look::default() };
    let panel = |result: &str| flat_panel(&*film, step_of(&*film, result), &look, result.to_owned());
    let content = panels(WIDTH_PT, 3, &["outside", "partial", "inside"].map(panel));
    let caption = "Each node's box (yellow) is tested against the planes of the view frustum, which are \
                   lines in flatland. Outside: even the corner that reaches farthest in is beyond one plane, \
                   so all below the node is dropped. Partial: a plane cuts the box, so its children are \
                   looked at. Inside: all below it is kept without another test.";
    Ok(maker.page(Paper::TwoColumns, "A box against the view frustum", legend(&content), caption, &content))
}

fn frustum_steps(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("freedoom_e1m1")?;
    let film = maker.film(&scene, &eye(&scene, 0), FRUSTUM, &[]);
    let all = film.events().len();
    let panel = |quarter: usize| {
        let step = all * quarter / 4;
        let counts = Stamps::new(&*film).counts(step);
        let label = format!(
            "step {step} of {all}: {} kept, {} dropped",
            counts.of(Verdict::Visible),
            counts.of(Verdict::Outside)
        );
        flat_panel(&*film, step, &Look::default(), label)
    };
    let content = panels(WIDTH_PT, 2, &[1, 2, 3, 4].map(panel));
    let caption = format!(
        "View-frustum culling over a kD-tree, {}, first eye of the file. The traversal goes \
         down from the root; a node outside the frustum is dropped with all below it, a node inside or a \
         leaf is kept.",
        scene.name()
    );
    Ok(maker.page(
        Paper::TwoColumns,
        "View-frustum culling, step by step",
        legend(&content),
        caption,
        &content,
    ))
}

fn baselines_flatland(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = example("freedoom_e1m1")?;
    let view = eye(&scene, 0);
    let look = Look { nodes: false, evidence: false, ..Look::default() };
    let panel = |method: &str| {
        let film = maker.film(&scene, &view, method, &[]);
        let counts = Stamps::new(&*film).counts(film.events().len());
        let label = format!("{method}: {} of {} drawn", counts.of(Verdict::Visible), scene.live().len());
        flat_panel(&*film, film.events().len(), &look, label)
    };
    let content = panels(WIDTH_PT, 3, &[Z_BUFFER, FRUSTUM, CENTROID].map(panel));
    let caption = "The three baselines with their default parameters on the same view. The z-buffer draws \
                   everything; view-frustum culling drops what is outside; centroid ordering draws what is \
                   nearest until its budget of 10 % is spent, and leaves out the rest, visible or not.";
    Ok(maker.page(Paper::TwoColumns, "Three baselines", legend(&content), caption, &content))
}

fn office(polygons: u32) -> Result<Arc<Scene<Solid>>, SceneError> {
    match load(&format!("generate:building?polygons={polygons}"), &LoadOptions::default(), &Quiet)? {
        AnyScene::Solid(scene) => Ok(scene),
        AnyScene::Flat(_) => unreachable!("the building is in space"),
    }
}

fn frustum_space(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let scene = office(2500)?;
    let mut view = scene.paths()[0].views[0];
    view.eye.far = scene.bounds().diagonal() * 0.5;
    let film = maker.film(&scene, &view, FRUSTUM, &[]);
    let stamps = Stamps::new(&*film);
    let observer = observer_above(&scene, 4.0 / 3.0);
    let picture = |step: usize, look: &Look| Picture::Space(world(&*film, &stamps, step, look), observer);
    let end = film.events().len();
    let content = panels(
        WIDTH_PT,
        2,
        &[
            Panel {
                label: format!("step {} of {end}", end / 2),
                picture: picture(end / 2, &Look { nodes: false, ..Look::default() }),
            },
            Panel {
                label: "the result".into(),
                picture: picture(end, &Look { nodes: false, evidence: false, ..Look::default() }),
            },
        ],
    );
    let caption = format!(
        "View-frustum culling of a generated office floor of {} triangles, seen by an observer above it. The \
         Eye stands in a corridor.",
        scene.live().len()
    );
    Ok(maker.page(Paper::TwoColumns, "View-frustum culling in space", legend(&content), caption, &content))
}

fn item_buffer(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let tint = maker.tint;
    let scene = office(20_000)?;
    let sized = |view: &View<Solid>| View { width: 320, height: 240, ..*view };
    let seen = |view: &View<Solid>| raster::visible(&raster::render(&*scene, view, scene.live())).len();
    // The view of the walk that sees most; the first of equals.
    let views = scene.paths()[0].views.iter().map(sized);
    let view = views
        .reduce(|best, view| if seen(&view) > seen(&best) { view } else { best })
        .expect("a path has views");
    let target = raster::render(&*scene, &view, scene.live());
    let paper = tint(Role::Paper);
    let pixels =
        |rgba: Vec<u8>| Picture::Pixels(Pixels { width: view.width, height: view.height, rgba: rgba.into() });
    let hash =
        |p: u32, shift: u32| 0.15 + 0.75 * ((p.wrapping_mul(2_654_435_761) >> shift & 255) as f32 / 255.0);
    let items =
        raster::shade_with(&target, &*scene, &view, paper, |p| [hash(p.0, 0), hash(p.0, 8), hash(p.0, 16)]);
    let visible = raster::visible(&target).len();
    let content = panels(
        WIDTH_PT,
        3,
        &[
            Panel { label: "shaded".into(), picture: pixels(raster::shade(&target, &*scene, &view, paper)) },
            Panel { label: format!("item buffer: {visible} triangles visible"), picture: pixels(items) },
            Panel {
                label: "depth, logarithmic: near is dark".into(),
                picture: pixels(raster::shade_depth(
                    &target.depth,
                    &target.depth,
                    1.0 / view.eye.far,
                    raster::DepthScale::Logarithmic,
                )),
            },
        ],
    );
    let caption = format!(
        "What the Eye sees of {} triangles. In the item buffer every pixel holds the id of the nearest \
         triangle (here as a color): the ids that occur are exactly what is visible at this resolution, and \
         the truth against which every method is measured.",
        scene.live().len()
    );
    Ok(maker.page(Paper::TwoColumns, "The truth: an item buffer", legend(&content), caption, &content))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_baseline_draws_what_the_caption_says() {
        let scene = example("freedoom_e1m1").expect("a scene");
        let all = scene.live().len();
        let [everything, in_view, nearest] = [Z_BUFFER, FRUSTUM, CENTROID].map(|method| {
            let film = Maker::gray().film(&scene, &eye(&scene, 0), method, &[]);
            Stamps::new(&*film).counts(film.events().len()).of(Verdict::Visible)
        });
        assert!(everything == all && in_view < all && nearest.abs_diff(all / 10) <= 1, "{in_view} {nearest}");
    }

    #[test]
    fn each_result_of_a_test_is_found() {
        let scene = example(STREET).expect("a scene");
        let film = Maker::gray().film(&scene, &eye(&scene, 0), FRUSTUM, &[]);
        let steps = ["outside", "partial", "inside"].map(|result| step_of(&*film, result));
        assert!(steps.iter().all(|step| *step < film.events().len()), "{steps:?}");
    }
}
