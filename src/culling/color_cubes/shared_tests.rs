//! Primitives that several cells share, worked by hand: what share of them each cell bears, and what becomes
//! of them in a frame.

use std::cell::RefCell;

use glam::{Vec2, vec2, vec3};

use super::walk::pixels_at_depth_1;
use super::*;
use crate::geometry::{Aabb, Eye, Flat, NodeId, PrimId, Solid, View};
use crate::index::Items;
use crate::method::{Recorder, Verdict};
use crate::scene::{Parts, Quiet};

/// A triangle that two children of the root meet, one of which is divided and gives it to four: shares of
/// one half and four times an eighth, together 1.
#[test]
fn a_triangle_is_shared_out_evenly_at_each_division() {
    // At z = 1 over four quarters of the lower corner's octant, and past x = 4.
    let mut points = vec![vec3(0.5, 0.5, 1.0), vec3(0.5, 3.9, 1.0), vec3(6.0, 0.5, 1.0)];
    // A speck in that octant, in a part of its own, and one in another octant.
    for at in [vec3(3.5, 3.5, 3.5), vec3(6.5, 6.5, 1.0)] {
        points.extend([at, at + vec3(0.1, 0.0, 0.0), at + vec3(0.0, 0.1, 0.0)]);
    }
    let prims = vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]];
    let scene = Scene::<Solid>::new(Parts::simple("shared", points, prims)).expect("triangles");
    let root = Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::splat(8.0) };
    let sums = RefCell::new(Vec::new());
    let stop = |sum: f64, children: u32| {
        // Of each cell it is asked first whether one child would be too many.
        if children == 1 {
            sums.borrow_mut().push(sum);
        }
        sum < 1.5
    };
    let tree =
        CellTree::build_in(root, &scene, Items::default(), 20, &stop, &|| false).expect("not cancelled");
    let mut leaves = Vec::new();
    for (at, node) in tree.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()) {
        let held = tree.references(NodeId(at as u32));
        leaves.push((node.level, held.iter().map(|p| p.0).collect::<Vec<_>>()));
    }
    leaves.sort();
    let eighth = || (2, vec![0]);
    assert_eq!(leaves, [(1, vec![0]), (1, vec![2]), eighth(), eighth(), eighth(), eighth(), (2, vec![1])]);
    // Both specks, and the cells that are divided: one half and the first speck, and all.
    let mut sums = sums.into_inner();
    sums.sort_by(f64::total_cmp);
    assert_eq!(sums, [0.125, 0.125, 0.125, 0.125, 0.5, 1.0, 1.0, 1.5, 3.0]);
}

/// Cells of side 2 in a row, as they are left of a square of side 16 at level 3; the first seven hold one
/// long segment together, and all of them specks.
fn row() -> Arc<Scene<Flat>> {
    let (mut points, mut prims) = (vec![vec2(0.5, 1.0), vec2(13.5, 1.0)], vec![[0, 1]]);
    let mut add = |from: Vec2, to: Vec2| {
        prims.push([points.len() as u32, points.len() as u32 + 1]);
        points.extend([from, to]);
    };
    // The corners of the square.
    add(vec2(0.0, 0.0), vec2(0.1, 0.0));
    add(vec2(16.0, 16.0), vec2(15.9, 16.0));
    for cell in 0..8u16 {
        for speck in 0..60u16 {
            let at = vec2(2.0 * f32::from(cell) + 0.3 + 0.02 * f32::from(speck), 0.2);
            add(at, at + vec2(0.01, 1.6));
        }
    }
    Arc::new(Scene::new(Parts::simple("row", points, prims)).expect("segments"))
}

/// What becomes of the long segment where cells of at most a part of the pixels at depth 1 are drawn as
/// cubes: how many of its leaves are larger than that, how often it is drawn, and the verdicts about it.
fn long_segment(part: f32) -> (usize, usize, Vec<Verdict>) {
    let scene = row();
    // Along the row: its cells are at depths 4, 6, … 18.
    let eye = Eye {
        position: vec2(-3.0, 1.0),
        target: vec2(0.0, 1.0),
        up: Vec2::ZERO,
        fov: 90f32.to_radians(),
        near: 0.1,
        far: 100.0,
    };
    let view = View { eye, width: 100, height: 1 };
    let pixel_threshold = part * pixels_at_depth_1::<Flat>(&view);
    let params = Params { pixel_threshold, tree_levels: 4, ..Params::default() };
    let index = CubeTree::build(&scene, &params, None, &Quiet).expect("no bytes").expect("not cancelled");
    let tree = index.tree();
    assert_eq!((tree.root().min, tree.root().max), (Vec2::ZERO, Vec2::splat(16.0)));
    let (mut leaves, mut large) = (0, 0);
    for (at, _) in tree.nodes().iter().enumerate().filter(|(_, node)| node.is_leaf()) {
        let id = NodeId(at as u32);
        if tree.references(id).contains(&PrimId(0)) {
            leaves += 1;
            large += usize::from(2.0 / (tree.cell(id).center().x + 3.0) > part);
        }
    }
    assert_eq!(leaves, 7);
    let frame: Frame<'_, Flat, ColorCubes> =
        Frame { index: &index, scene: &scene, view: &view, params: &params, limit: None };
    let (mut list, mut film) = (DrawList::default(), Recorder::new(usize::MAX));
    ColorCubes::cull(&frame, &mut (), &mut Drawn::default(), &mut list, &mut film);
    let verdicts = film.events.iter().filter_map(|event| match *event {
        Event::DecidedPrim(PrimId(0), verdict) => Some(verdict),
        _ => None,
    });
    (large, list.prims.iter().filter(|p| p.0 == 0).count(), verdicts.collect())
}

/// Sides over depths are 2/4, 2/6, 2/8, 2/10, …: three of seven are above 0.22, and none is above 0.6.
#[test]
fn what_seven_leaves_share_is_drawn_once_or_approximated() {
    assert_eq!(long_segment(0.22), (3, 1, vec![Verdict::Visible]));
    assert_eq!(long_segment(0.6), (0, 0, vec![Verdict::Approximated]));
}
