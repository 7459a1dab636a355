//! `generate:tree`: one tree with leaves, and `generate:tree-quadrupling`, a square of its copies.
//!
//! For Chamberlain et al. (1996): the tree of Plate 1, of 52,470 triangles, and the forests of Plate 5 that
//! grow fourfold from one to the next. Points lie on a grid of 2⁻¹⁴ m, and trees stand a multiple of
//! 2⁻¹¹ m from the middle, so that in 32 bits each copy has exactly the shape of the first. Cost:
//! O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;

use super::shapes::Sink;
use super::tree::Tree;
use super::walk::{EYE, around, flight};
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values, detail_for};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;
use crate::scene::mesh::{Mesh, RawFace};

/// Triangles of the paper's tree.
const POLYGONS: u64 = 52_470;

const SIZE: GeneratorParam = GeneratorParam {
    name: "polygons",
    default: POLYGONS,
    min: 2_000,
    max: 8_000_000,
    meaning: "triangles of a tree, met exactly",
};
const SEED: GeneratorParam = GeneratorParam {
    name: "seed",
    default: 1,
    min: 0,
    max: u32::MAX as u64,
    meaning: "chooses how the tree grows and where its leaves hang",
};

pub(super) const GENERATOR: Generator = Generator {
    name: "tree",
    meaning: "a tree with leaves that are seen from both sides, with nothing around it; after Chamberlain et \
              al. 1996, Plate 1",
    params: &[SIZE, SEED],
    make: |values, source, options, progress| stand(values, source, options, progress, 0),
};

pub(super) const QUADRUPLING: Generator = Generator {
    name: "tree-quadrupling",
    meaning: "copies of one tree on a square grid, four times as many from level to level; after Chamberlain \
              et al. 1996, Plate 5",
    params: &[
        GeneratorParam {
            name: "level",
            default: 1,
            min: 0,
            max: 3,
            meaning: "there are 4 to the power of it; larger forests are drawn by `cullscope paper \
                      chamberlain-figure-5`",
        },
        GeneratorParam { max: 130_000, ..SIZE },
        SEED,
    ],
    make: |values, source, options, progress| {
        stand(values, source, options, progress, values.get("level") as u32)
    },
};

const MATERIALS: &[(&str, [f32; 3])] = &[
    ("bark", [0.20, 0.13, 0.08]),
    ("leaf dark", [0.06, 0.21, 0.05]),
    ("leaf", [0.11, 0.30, 0.06]),
    ("leaf bright", [0.19, 0.40, 0.08]),
    ("leaf yellow", [0.36, 0.44, 0.09]),
];
const LEAF: u32 = 1;
const GREENS: u32 = MATERIALS.len() as u32 - LEAF;

/// Heights and radii in m: with its branches about a third wider than half its height, so that its octree
/// is filled in all three directions.
const TREE: Tree =
    Tree { foot: DVec3::ZERO, crown: [1.7, 10.0], radius: 3.6, trunk: 0.27, branches: 18, twigs: 8 };
/// Share of the triangles for wood.
const WOOD: f64 = 0.3;
/// Area of leaves by the crown's cross-section: less than that of a wood's, so that branches show.
const DENSITY: f64 = 2.1;
/// Points lie on multiples of 1/this.
const GRID: f64 = 16_384.0;
/// The distance of two trees is a multiple of 1/this.
const PITCH_GRID: f64 = 1024.0;

/// What is called `name` of `4^level` trees.
fn stand(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
    level: u32,
) -> Result<Parts<Solid>, SceneError> {
    let (polygons, seed) = (values.get("polygons"), values.get("seed"));
    let wood = |sink: &mut Sink, detail: u32| _ = TREE.wood(sink, detail, &mut Pcg32::new(seed, 60));
    let detail = detail_for((polygons as f64 * WOOD) as u64, source, progress, wood)?.max(2) - 1;
    progress.report(0.2, "growing a tree");
    let tree = grow(polygons, seed, detail);
    let side = 1u32 << level;
    let pitch = pitch(&tree);
    let at = |k: u32| (f64::from(k) - 0.5 * f64::from(side - 1)) * pitch;
    let places: Vec<DVec3> = (0..side * side).map(|k| DVec3::new(at(k % side), 0.0, at(k / side))).collect();
    let mesh = if level == 0 { tree } else { copies(&tree, &places) };
    let name = source.split(['?', ':']).nth(1).unwrap_or("tree").to_owned();
    let rest = Part { whole: progress, start: 0.4, length: 0.6 };
    let mut parts = assemble(mesh, &name, source, options, Report::default(), &rest)?;
    parts.paths.extend(around(&parts.points, 30));
    if level > 0 {
        let reach = 0.5 * f64::from(side) * pitch;
        parts.paths.push(between_rows(reach, parts.origin));
    }
    Ok(parts)
}

/// A tree around the vertical through 0, its points on the grid.
fn grow(polygons: u64, seed: u64, detail: u32) -> Mesh {
    let mut sink = Sink::keeping(MATERIALS);
    let mut rng = Pcg32::new(seed, 60);
    sink.begin(|| ("wood".into(), "tree_0".into()));
    let twigs = TREE.wood(&mut sink, detail, &mut rng);
    let left = polygons.saturating_sub(sink.triangles);
    sink.begin(|| ("leaves".into(), "tree_0".into()));
    TREE.foliage(&mut sink, &twigs, (left, DENSITY), (LEAF, GREENS), &mut rng);
    let mut mesh = sink.into_mesh();
    mesh.points.iter_mut().for_each(|p| *p = (*p * GRID).round() / GRID);
    fill_cube(&mut mesh);
    mesh.materials[LEAF as usize..].iter_mut().for_each(|m| m.two_sided = true);
    mesh
}

/// The box around a tree.
fn span(tree: &Mesh) -> (DVec3, DVec3) {
    let all = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    tree.points.iter().fold(all, |(low, high), p| (low.min(*p), high.max(*p)))
}

/// How far apart trees stand: the side of the cube around one, a multiple of the grid, so that cells of
/// copies lie side by side (the cubes of an octree over them are those of its own).
fn pitch(tree: &Mesh) -> f64 {
    let (low, high) = span(tree);
    ((high - low).max_element() * PITCH_GRID).ceil() / PITCH_GRID
}

/// Moves the ends of a tree's longest side out, by less than a millimeter, until the cube around it is one
/// that copies can stand in without a gap.
fn fill_cube(tree: &mut Mesh) {
    let ((low, high), pitch) = (span(tree), pitch(tree));
    let axis = (high - low).max_position();
    let ends = tree.points.iter_mut().filter(|p| p[axis] == high[axis]);
    ends.for_each(|p| p[axis] = low[axis] + pitch);
}

/// A tree at each place.
fn copies(tree: &Mesh, places: &[DVec3]) -> Mesh {
    let mut all = Mesh { materials: tree.materials.clone(), ..Mesh::default() };
    for (k, place) in places.iter().enumerate() {
        let (points, corners, objects) =
            (all.points.len() as u32, all.corners.len() as u32, all.objects.len() as u32);
        all.points.extend(tree.points.iter().map(|p| *p + *place));
        all.corners.extend(tree.corners.iter().map(|c| c + points));
        let moved = |f: &RawFace| RawFace { end: f.end + corners, object: f.object + objects, ..*f };
        all.faces.extend(tree.faces.iter().map(moved));
        let named =
            |o: &crate::scene::Object| crate::scene::Object { group: format!("tree_{k}"), ..o.clone() };
        all.objects.extend(tree.objects.iter().map(named));
    }
    all
}

/// A flight between the two middle rows, at the height of a person's eyes, into the middle of the forest.
fn between_rows(reach: f64, origin: DVec3) -> ViewPath<Solid> {
    let eye = |z: f64| DVec3::new(0.0, EYE, z);
    let stops = [2.0, 1.0, 0.5, 0.0].map(|share| (eye(share * reach), eye(share * reach - 10.0)));
    ViewPath { name: "between the rows".into(), ..flight(&stops, 120, 8.0 * reach, origin) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn scene(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("trees")).expect("a scene")
    }

    /// Chamberlain et al. 1996, Table 1: the tree has 52,470 triangles.
    #[test]
    fn any_number_of_triangles_is_met_and_leaves_have_two_sides() {
        for (call, want) in
            [("tree", 52_470), ("tree?polygons=2000", 2_000), ("tree?polygons=7519&seed=3", 7_519)]
        {
            let scene = scene(call);
            assert_eq!((scene.prim_count(), scene.live().len()), (want, want), "{call}");
            let leaves =
                |p: &&crate::geometry::PrimId| scene.objects()[scene.object_of(**p).at()].name == "leaves";
            let count = scene.live().iter().filter(leaves).count();
            assert!(count as f64 > 0.6 * want as f64, "{count} of {want}");
            assert!(scene.live().iter().filter(leaves).all(|p| scene.is_two_sided(*p)));
            assert_eq!(touched(&scene), None);
        }
        // Machines must agree, so the bits are written down.
        assert_eq!(
            scene("tree?polygons=2000").hash_hex(),
            "d115304291b4bbe1e6ba988bcf7089cc8edf4e9c25c7dd6f34f39e9e48645327"
        );
    }

    /// 2^(2n) trees, each with exactly the points of the first, a cube's side apart.
    #[test]
    fn copies_are_exact_and_a_cube_apart() {
        let (one, four) = (scene("tree?polygons=2000"), scene("tree-quadrupling?level=1&polygons=2000"));
        assert_eq!(scene("tree-quadrupling?level=0&polygons=2000").hash_hex(), one.hash_hex());
        assert_eq!(scene("tree-quadrupling?level=2&polygons=2000").live().len(), 16 * 2_000);
        assert_eq!((four.live().len(), four.objects().len()), (8_000, 8));
        let size = one.bounds().max - one.bounds().min;
        let pitch = (four.bounds().max.x - four.bounds().min.x) - size.x;
        let side = size.max_element();
        assert_eq!(pitch, side, "cells of copies lie side by side");
        assert_eq!(pitch * 1024.0, (pitch * 1024.0).round());
        for (k, corner) in [(0, [-0.5, -0.5]), (1, [0.5, -0.5]), (2, [-0.5, 0.5]), (3, [0.5, 0.5])] {
            let offset = glam::Vec3::new(corner[0] * pitch, 0.0, corner[1] * pitch);
            for (&a, &b) in one.live().iter().zip(&four.live()[k * 2_000..]) {
                let moved: Vec<glam::Vec3> = one.prim_points(a).map(|p| p + offset).collect();
                assert_eq!(moved, four.prim_points(b).collect::<Vec<_>>(), "tree {k}");
            }
        }
    }

    /// A level that is too large is refused with what draws it.
    #[test]
    fn larger_forests_are_referred_to_the_figure() {
        let refused = generate("tree-quadrupling?level=7", &LoadOptions::default(), &Quiet);
        let said = refused.expect_err("16,384 trees are too many").to_string();
        assert_eq!(
            said,
            "generate:tree-quadrupling?level=7: `level` must be a whole number from 0 to 3, not `7` (there \
             are 4 to the power of it; larger forests are drawn by `cullscope paper chamberlain-figure-5`)"
        );
    }
}
