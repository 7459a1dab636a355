//! Forests against stored copies, against the method, and against numbers made by hand.

use glam::{DVec3, Vec2, Vec3, vec2, vec3};

use super::*;
use crate::culling::color_cubes::index::is_small;
use crate::culling::color_cubes::tests::is_front_to_back;
use crate::geometry::{Flat, Solid};
use crate::index::{CellTree, Items};
use crate::method::{Frame, Method};
use crate::raster::render;
use crate::scene::{AnyScene, LoadOptions, Quiet, load, random_views, samples};

const WHITE: [f32; 3] = [1.0; 3];

fn solid(source: &str) -> Arc<Scene<Solid>> {
    match load(source, &LoadOptions::default(), &Quiet).expect("a generated scene") {
        AnyScene::Solid(scene) => scene,
        AnyScene::Flat(_) => panic!("a tree is in space"),
    }
}

fn stock<S: Projected>(scene: &Arc<Scene<S>>, pairs: &[(&str, &str)]) -> Stock<S> {
    Stock::new(scene, &Settings::of(pairs), &Quiet).expect("settings").expect("not cancelled")
}

/// The method on a stored scene, with the tree of cells that begins with a root, or its own.
fn stored<S: Projected>(
    scene: &Arc<Scene<S>>,
    root: Option<Aabb<S::Vector>>,
    params: &Params,
    view: &View<S>,
) -> DrawList<S> {
    let index = match root {
        None => CubeTree::build(scene, params, None, &Quiet).expect("no bytes").expect("not cancelled"),
        Some(root) => {
            let tree = CellTree::build_in(
                root,
                scene,
                Items::default(),
                params.tree_levels,
                &is_small::<S>(1.0),
                &|| false,
            );
            CubeTree::of_tree(tree.expect("not cancelled"), scene, params, &Quiet).expect("not cancelled")
        }
    };
    let frame: Frame<'_, S, ColorCubes> = Frame { index: &index, scene, view, params, limit: None };
    let mut list = DrawList::default();
    ColorCubes::cull(&frame, &mut (), &mut Default::default(), &mut list, &mut Unobserved);
    list
}

/// A forest of one copy is the method on the scene: same lists, same bytes.
fn one_copy_is_the_method<S: Projected>(
    scene: &Arc<Scene<S>>,
    views: &[View<S>],
    threshold: &str,
    least: usize,
) {
    let stock = stock(scene, &[("pixel-threshold", threshold)]);
    let forest = stock.forest(0);
    assert_eq!((forest.copies(), forest.prims()), (1, scene.live().len() as u64));
    let (mut cubes, mut prims) = (0, 0);
    for view in views {
        let (seen, want) = (forest.cull(view), stored(scene, None, &stock.params, view));
        assert_eq!(seen.list, want);
        let drawn = want.paint(scene, view, &Options::default(), WHITE);
        assert!(forest.paint(&seen, view, WHITE) == drawn, "the images differ");
        cubes += want.stand_ins.len();
        prims += want.prims.len();
    }
    assert!(cubes > least && prims > least, "{cubes} cubes, {prims} primitives");
}

#[test]
fn one_copy_is_the_method_in_both_spaces() {
    let (flat, space) = (samples::soup::<Flat>(2, 4000), samples::soup::<Solid>(2, 4000));
    one_copy_is_the_method(&flat, &random_views(&flat, 6, 3), "60", 20);
    one_copy_is_the_method(&space, &random_views(&space, 6, 3), "60", 100);
    // From 1.75 radii to 14.
    let tree = solid("generate:tree?polygons=2000");
    one_copy_is_the_method(&tree, &tree.paths()[0].views, "3", 100);
}

/// A view in meters, with the eye on the grid on which copies stand.
fn view(eye: Vec3, target: Vec3, [width, height]: [u32; 2]) -> View<Solid> {
    let on_grid = |v: Vec3| (v * 256.0).round() / 256.0;
    let eye = Eye {
        position: on_grid(eye),
        target: on_grid(target),
        up: Vec3::Y,
        fov: 60f32.to_radians(),
        near: 0.05,
        far: 1e5,
    };
    View { eye, width, height }
}

/// Four copies look as four stored ones do, byte for byte, if these have the same cells: the method alone
/// would put its root about the middle of the trees, half of it below the ground. As geometry they look the
/// same whatever the cells.
#[test]
fn copies_look_as_if_they_were_stored() {
    let base = solid("generate:tree?polygons=2000");
    let all = [solid("generate:tree-quadrupling?level=1&polygons=2000")];
    let [four] = &all;
    let stock = stock(&base, &[("pixel-threshold", "6")]);
    let (forest, pitch) = (stock.forest(1), stock.pitch() as f32);
    assert_eq!((forest.copies(), forest.prims()), (4, 8_000));
    let middle = vec3(0.0, 5.0, 0.0);
    let (mut cubes, mut prims) = (0, 0);
    for (at, px) in [
        ([30.0, 12.0, 40.0], 200),
        ([-14.0, 4.0, 19.0], 96),
        ([3.0, 30.0, 21.0], 64),
        ([700.0, 90.0, 60.0], 64),
    ] {
        let view = view(Vec3::from(at), middle, [px, px]);
        let (seen, counted) = forest.count(&view);
        let root = Aabb { min: stock.root().min - vec3(0.5, 0.0, 0.5) * pitch, max: Vec3::ZERO };
        let root = Aabb { max: root.min + Vec3::splat(2.0 * pitch), ..root };
        let want = stored(four, Some(root), &stock.params, &view);
        assert_eq!((counted.cubes, counted.prims), (want.stand_ins.len() as u64, want.prims.len() as u64));
        let drawn = want.paint(four, &view, &Options::default(), WHITE);
        assert!(forest.paint(&seen, &view, WHITE) == drawn, "from {at:?} the images differ");
        cubes += counted.cubes;
        prims += counted.prims;

        let mut image = Target::default();
        assert_eq!(forest.draw_geometry(&mut image, &view, &Options::default()), 8_000);
        let whole = render(four, &view, four.live());
        assert!(image.depth == whole.depth, "from {at:?} the depths differ");
        let shown = |image: &Target, scene: &Scene<Solid>| {
            paint(image, &Canvas::default(), scene, &view, (Light::Fixed, WHITE))
        };
        assert!(shown(&image, &base) == shown(&whole, four), "from {at:?} the geometry differs");
    }
    assert!(cubes > 500 && prims > 100, "{cubes} cubes, {prims} triangles");
}

/// With a threshold of 0 nothing is a cube, and what is outside the view is culled: the image is that of all
/// stored copies.
#[test]
fn without_cubes_it_is_the_geometry_in_view() {
    let base = solid("generate:tree?polygons=2000");
    let sixteen = solid("generate:tree-quadrupling?level=2&polygons=2000");
    let stock = stock(&base, &[("pixel-threshold", "0")]);
    let forest = stock.forest(2);
    let view = view(vec3(1.0, 1.6, 9.0), vec3(5.0, 2.0, -12.0), [96, 64]);
    let (seen, counted) = forest.count(&view);
    assert!(counted.cubes == 0 && counted.prims > 4_000 && counted.prims < 30_000, "{counted:?}");
    let whole = render(&sixteen, &view, sixteen.live());
    let want = paint(&whole, &Canvas::default(), &sixteen, &view, (Light::Fixed, WHITE));
    assert!(forest.paint(&seen, &view, WHITE) == want, "the images differ");
    let mut image = Target::default();
    let drawn = forest.draw_geometry(&mut image, &view, &Options::default());
    assert!(image.depth == whole.depth && drawn < forest.prims(), "{drawn} drawn");
}

/// Cubes of all copies come front to back, in both spaces, those over several copies among them.
fn copies_come_front_to_back<S: Projected>(base: &Arc<Scene<S>>, views: &[View<S>]) {
    let stock = stock(base, &[("pixel-threshold", "20")]);
    let forest = stock.forest(4);
    let (mut all, mut over_several) = (0, 0);
    for view in views {
        let (seen, mut cells) = (forest.cull(view), Vec::new());
        for copy in &seen.copies {
            for one in &seen.list.stand_ins[copy.stand_ins.clone()] {
                let Aabb { min, max } = one.bounds;
                let (min, max) = (min - copy.eye, max - copy.eye);
                // Copies that share a plane round it each in its own space: smaller by more than that.
                let slack = S::Vector::splat(1e-6 * (min.length() + max.length()));
                cells.push(Aabb { min: min + slack, max: max - slack });
                over_several += usize::from((max - min).get(0) > 1.5 * stock.pitch() as f32);
            }
        }
        assert!(is_front_to_back(&cells, S::Vector::default()), "{:?}", view.eye);
        all += cells.len();
    }
    assert!(all > 100 && over_several > 4, "{all} cubes, {over_several} over several copies");
}

#[test]
fn copies_come_front_to_back_in_both_spaces() {
    let tree = solid("generate:tree?polygons=2000");
    let ways = [[90.0, 20.0, 130.0], [5.0, 3.0, 6.0], [-70.0, 60.0, -10.0]].map(Vec3::from);
    copies_come_front_to_back(&tree, &ways.map(|at| view(at, Vec3::ZERO, [64, 64])));
    let base = samples::soup::<Flat>(4, 300);
    let size = 16.0 * base.bounds().size().x;
    let flat = |at: Vec2| {
        let eye = Eye {
            position: at * size,
            target: Vec2::ZERO,
            up: vec2(0.0, 1.0),
            fov: 1.0,
            near: 0.01,
            far: 1e5,
        };
        View { eye, width: 200, height: 1 }
    };
    copies_come_front_to_back(&base, &[vec2(1.3, 0.4), vec2(0.1, 0.03), vec2(-0.2, -0.9)].map(flat));
}

/// Four times as many trees on a square: seen from the side two in a row cover half the face, and from above
/// all of it is as before. In flatland there is nothing above.
#[test]
fn faces_of_squares_follow_from_those_of_copies() {
    let half: Faces = [[0.0, 0.0, 0.0, 0.5]; 6];
    let alphas = |faces: Faces| [faces[0][3], faces[5][3], faces[2][3]];
    let of_space: Vec<_> = squares::<Vec3>(half, 3).into_iter().map(alphas).collect();
    // (1 − (1 − α)²) / 2, which ends in: 0.30468750 → (1 − 0.6953125²) / 2.
    let want = [0.375, 0.304_687_5, 0.258_270_26];
    for (got, want) in of_space.iter().zip(want) {
        assert!(
            (got[0] - want).abs() < 1e-6 && (got[1] - want).abs() < 1e-6 && got[2] == 0.5,
            "{of_space:?}"
        );
    }
    let of_flatland: Vec<f32> = squares::<Vec2>(half, 2).into_iter().map(|faces| faces[2][3]).collect();
    assert_eq!(of_flatland, [0.75, 0.9375]);
}

/// The paper's largest forest, and 2²⁰ trees, whose triangles 32 bits do not count.
#[test]
fn triangles_are_counted_in_64_bits() {
    let base = solid("generate:tree");
    let stock = stock(&base, &[("pixel-threshold", "4")]);
    let sizes = [0, 1, 2, 7, 10].map(|levels| stock.forest(levels).prims());
    assert_eq!(sizes, [52_470, 209_880, 839_520, 859_668_480, 55_018_782_720]);
    // From afar all of it is one cube, and from within most is not looked at.
    let forest = stock.forest(10);
    let far = view(vec3(0.0, 4e6, 4e6), Vec3::ZERO, [64, 64]);
    let (seen, counted) = forest.count(&View { eye: Eye { far: 1e8, ..far.eye }, ..far });
    assert_eq!((seen.list.stand_ins.len(), counted.cells, counted.prims), (1, 1, 0));
    let within = view(vec3(0.0, 1.6, 10.0), vec3(3.0, 2.0, -20.0), [64, 64]);
    let (_, counted) = forest.count(&within);
    assert!(counted.cells > 1_000 && counted.cells < 1_000_000, "{counted:?}");
}

/// In the corner of a forest that is 10 km wide it looks as in the corner of a small one.
#[test]
fn far_from_the_middle_nothing_is_lost() {
    let base = solid("generate:tree?polygons=2000");
    let stock = stock(&base, &[("pixel-threshold", "12")]);
    let from_corner = |levels: u32| {
        let corner = 0.5 * f64::from(1u32 << levels) * stock.pitch();
        let at = |back: DVec3| (DVec3::new(corner, 0.0, corner) - back).as_vec3();
        let view = view(at(DVec3::new(22.0, -1.5, 27.0)), at(DVec3::new(5.0, -3.0, 3.0)), [128, 96]);
        let forest = stock.forest(levels);
        let (seen, counted) = forest.count(&view);
        assert!(counted.cubes > 100 && counted.prims > 100, "{counted:?}");
        (forest.paint(&seen, &view, WHITE), counted.cubes, counted.prims)
    };
    assert!(from_corner(2) == from_corner(10));
}
