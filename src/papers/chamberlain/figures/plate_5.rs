//! Plate 5: forests that grow fourfold and sixteenfold, up to 4,096 trees.

use crate::culling::color_cubes::forest::Stock;
use crate::drawing::words::grouped;
use crate::drawing::{Drawing, Pixels, Role};
use crate::figure::tools::{Maker, WIDTH_PT};
use crate::figure::{Panel, Paper, Picture, panels};
use crate::geometry::Solid;
use crate::method::Settings;
use crate::papers::chamberlain::views::Place;
use crate::papers::keys::COLOR_CUBES;
use crate::raster::{Options, averaged};
use crate::scene::{AnyScene, LoadOptions, Quiet, SceneError, load};

/// Pixels of an image, as the paper's.
const SIDE_PX: u32 = 124;
/// Four to the power of these are the trees of the plate.
const LEVELS: [u32; 4] = [0, 2, 3, 6];

/// A panel of so many trees, of an image with two samples a side of a pixel and what is drawn in it.
fn panel(rgba: &[u8], levels: u32, cubes: usize) -> Panel {
    let trees = grouped(4f64.powi(levels as i32), 0);
    let cubes = grouped(cubes as f64, 0);
    let noun = if levels == 0 { "tree" } else { "trees" };
    let label = format!("{trees} {noun}: {cubes} cubes");
    let rgba = averaged(rgba, 2 * SIDE_PX as usize, [2, 2]).into();
    Panel { label, picture: Picture::Pixels(Pixels { width: SIDE_PX, height: SIDE_PX, rgba }) }
}

pub fn forests(maker: &Maker<'_>) -> Result<Drawing, SceneError> {
    let AnyScene::Solid(tree) = load("generate:tree", &LoadOptions::default(), &Quiet)? else {
        unreachable!("a generated scene is in space")
    };
    // Of a pixel there are two samples a side, and a cell no larger than a pixel is a cube.
    let settings = [("pixel-threshold", "2")];
    let stock = Stock::<Solid>::new(&tree, &Settings::of(&settings), &Quiet);
    let stock = stock.expect("figures use settings that exist").expect("nobody cancels a figure");
    let paper = (maker.tint)(Role::Paper);
    let view = |levels: u32| Place::Above.view(&stock, 1 << levels, [2 * SIDE_PX; 2]);
    // One tree is what the method draws; a forest is what it draws of copies.
    let alone = maker.ready(&tree, COLOR_CUBES, &settings).cull(&view(0));
    let rgba = alone.paint(&tree, &view(0), &Options::default(), paper);
    let mut all = vec![panel(&rgba, 0, alone.stand_ins.len())];
    let mut triangles = vec![grouped(alone.prims.len() as f64, 0)];
    for levels in LEVELS.into_iter().skip(1) {
        let (forest, view) = (stock.forest(levels), view(levels));
        let seen = forest.cull(&view);
        let rgba = forest.paint(&seen, &view, paper);
        all.push(panel(&rgba, levels, seen.list.stand_ins.len()));
        triangles.push(grouped(seen.list.prims.len() as f64, 0));
    }
    let content = panels(WIDTH_PT, 4, &all);
    let counts = [tree.live().len() as f64, stock.forest(LEVELS[3]).prims() as f64];
    let caption = caption(counts, &triangles.join(", "));
    let title = "Chamberlain et al. 1996, Plate 5: forests that grow fourfold";
    Ok(maker.page(Paper::TwoColumns, title, Vec::new(), caption, &content))
}

/// What is shown, of these triangles in a tree and in the largest forest.
fn caption([tree, forest]: [f64; 2], drawn: &str) -> String {
    format!(
        "A tree of {} triangles, and squares of 16, 64 and 4,096 of it, the largest of {} triangles, in \
         images of 124 × 124 pixels with 2 × 2 samples each. No tree is copied: one is stored, with its \
         hierarchy, and seen from shifted eyes; above it stands a hierarchy of squares of four, whose color \
         cubes are composed of their parts'. Below each image are the cubes that are drawn for it; beside \
         them {} triangles are. As all of a square is in view, trees shrink as they become more, until cubes \
         of several trees stand for them.",
        grouped(tree, 0),
        grouped(forest, 0),
        drawn
    )
}
