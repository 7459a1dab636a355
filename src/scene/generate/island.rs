//! `generate:terrain-island`: an island in the sea with trees all over it.
//!
//! For Chamberlain et al. (1996, Plate 3 and Table 1): a terrain of some 33,000 triangles and 480 trees of
//! 7,519 each, 3,642,224 together. Large triangles and small ones in one octree, and no wall that hides much.
//! Cost: O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::plan::signed;
use super::shapes::Sink;
use super::terrain::Lattice;
use super::tree::Tree;
use super::walk::{EYE, around, sight, spline};
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values, detail_for};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "terrain-island",
    meaning: "an island with 480 trees; after Chamberlain et al. 1996, Plate 3",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 3_642_224,
            min: 400_000,
            max: 16_000_000,
            meaning: "triangles, met exactly; nearly all are the trees'",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses hills and trees",
        },
    ],
    make,
};

const MATERIALS: &[(&str, [f32; 3])] = &[
    ("sea", [0.06, 0.20, 0.34]),
    ("sand", [0.66, 0.56, 0.36]),
    ("meadow", [0.24, 0.37, 0.12]),
    ("heath", [0.32, 0.34, 0.14]),
    ("rock", [0.38, 0.36, 0.33]),
    ("bark", [0.20, 0.13, 0.08]),
    ("leaf blue", [0.06, 0.20, 0.10]),
    ("leaf dark", [0.07, 0.23, 0.05]),
    ("leaf", [0.11, 0.30, 0.06]),
    ("leaf bright", [0.19, 0.38, 0.08]),
    ("leaf yellow", [0.38, 0.42, 0.09]),
    ("leaf autumn", [0.48, 0.26, 0.05]),
];
const SAND: u32 = 1;
const ROCK: u32 = 4;
const BARK: u32 = 5;
const LEAF: u32 = 6;
/// Greens of leaves, and how many of them a tree has.
const GREENS: u32 = MATERIALS.len() as u32 - LEAF;
const GREENS_EACH: u32 = 3;

const TREES: u64 = 480;
/// Share of the triangles for ground and sea: 33,104 of 3,642,224 in the paper.
const GROUND: f64 = 0.0091;
/// Cells of the sea a side.
const SEA: u32 = 16;
/// From the middle to the edge of the square of sea, and to the shore, m.
const REACH: f64 = 240.0;
const SHORE: f64 = 190.0;
/// From the middle to the edge of the ground, which lies under the sea, m.
const GROUND_REACH: f64 = 222.0;
/// Height of the island's middle over the sea, m, without its hills; and how deep its edge lies.
const HIGH: f64 = 24.0;
const DEEP: f64 = 4.0;
/// Points of a lattice a side, and how high its hills are, m.
const LATTICES: [(usize, f64); 2] = [(9, 16.0), (28, 3.5)];
/// Share of a tree's triangles for its wood.
const WOOD: f64 = 0.3;
/// Area of leaves by a crown's cross-section.
const DENSITY: f64 = 2.4;
/// Trees stand no nearer to each other and to the walk than this, besides half their crowns, m.
const APART: f64 = 1.5;
/// So low no tree stands over the sea, m.
const DRY: f64 = 2.0;

/// The ground.
struct Island {
    lattices: [Lattice; 2],
}

impl Island {
    /// Height over the sea, m.
    fn height(&self, x: f64, z: f64) -> f64 {
        let place = |v: f64| (0.5 + 0.5 * v / REACH).clamp(0.0, 1.0);
        let hills: f64 = self.lattices.iter().map(|l| l.at(place(x), place(z))).sum();
        // The shore is not round: it follows the hills as well.
        let out = ((x * x + z * z) / (SHORE * SHORE)).min(1.6);
        let rise = (1.0 - out).max(-0.6);
        HIGH * rise * rise.abs() + hills * (rise + 0.35).clamp(0.0, 1.0) - DEEP
    }
    fn at(&self, x: f64, z: f64) -> DVec3 {
        DVec3::new(x, self.height(x, z), z)
    }
}

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (polygons, seed) = (values.get("polygons"), values.get("seed"));
    let mut rng = Pcg32::new(seed, 80);
    let island = Island { lattices: LATTICES.map(|(points, high)| Lattice::new(points, high, &mut rng)) };
    let mut sink = Sink::keeping(MATERIALS);
    progress.report(0.05, "raising the island");
    land(&mut sink, &island, polygons);
    let way = way();
    let trees = plant(&island, &way, &mut rng);
    // What is left goes to the trees evenly, one triangle more to the first ones.
    let left = polygons.saturating_sub(sink.triangles);
    let share = |k: usize| left / TREES + u64::from((k as u64) < left % TREES);
    let detail = detail_of(&trees[0], share(0), source, progress)?;
    for (k, tree) in trees.iter().enumerate() {
        progress.report(0.1 + 0.3 * k as f32 / trees.len() as f32, "growing trees");
        if progress.cancelled() {
            return Err(SceneError::Cancelled(source.to_owned()));
        }
        let rng = &mut Pcg32::new(seed.wrapping_mul(1_000_003).wrapping_add(k as u64), 82);
        let before = sink.triangles;
        sink.begin(|| ("wood".into(), format!("tree_{k}")));
        sink.paint(BARK);
        let twigs = tree.wood(&mut sink, detail, rng);
        sink.begin(|| ("leaves".into(), format!("tree_{k}")));
        let first = LEAF + rng.next_u32() % (GREENS - GREENS_EACH + 1);
        let left = share(k) + before - sink.triangles;
        tree.foliage(&mut sink, &twigs, (left, DENSITY), (first, GREENS_EACH), rng);
    }
    let mut mesh = sink.into_mesh();
    mesh.materials[LEAF as usize..].iter_mut().for_each(|m| m.two_sided = true);
    let rest = Part { whole: progress, start: 0.4, length: 0.6 };
    let mut parts = assemble(mesh, "terrain-island", source, options, Report::default(), &rest)?;
    parts.paths.push(walk(&island, &way, parts.origin));
    parts.paths.extend(around(&parts.points, 30));
    // From a hill's height, not from the level of the sea.
    let rise = 0.35 * REACH as f32;
    let views = parts.paths.iter_mut().skip(1).flat_map(|p| &mut p.views);
    views.for_each(|v| v.eye.position.y += rise * (v.eye.far / (4.0 * REACH as f32)).min(4.0));
    Ok(parts)
}

/// The detail of trees of so many triangles.
fn detail_of(tree: &Tree, triangles: u64, source: &str, progress: &dyn Progress) -> Result<u32, SceneError> {
    let wood = |sink: &mut Sink, detail: u32| _ = tree.wood(sink, detail, &mut Pcg32::new(0, 81));
    Ok(detail_for((triangles as f64 * WOOD) as u64, source, progress, wood)?.max(2) - 1)
}

/// Ground and sea.
fn land(sink: &mut Sink, island: &Island, polygons: u64) {
    let of_ground = polygons as f64 * GROUND - f64::from(2 * SEA * SEA);
    let cells = (of_ground.max(2.0) * 0.5).sqrt() as u32;
    let line = |i: u32, cells: u32, reach: f64| reach * (2.0 * f64::from(i) / f64::from(cells) - 1.0);
    sink.begin(|| ("ground".into(), String::new()));
    for k in 0..cells * cells {
        let (i, j) = (k % cells, k / cells);
        let at = |i: u32, j: u32| island.at(line(i, cells, GROUND_REACH), line(j, cells, GROUND_REACH));
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        let (middle, steep) = ((a.y + c.y) * 0.5, (a.y - c.y).abs().max((b.y - d.y).abs()) / a.distance(c));
        // Sand at the shore, then meadow and heath by height; rock where it is steep.
        let by_height = SAND + u32::from(middle > 1.4) + u32::from(middle > 16.0);
        sink.paint(if steep > 0.5 { ROCK } else { by_height });
        sink.face(&[a, b, c], DVec3::Y);
        sink.face(&[a, c, d], DVec3::Y);
    }
    sink.begin(|| ("sea".into(), String::new()));
    sink.paint(0);
    for k in 0..SEA * SEA {
        let at = |i: u32, j: u32| DVec3::new(line(i, SEA, REACH), 0.0, line(j, SEA, REACH));
        let (i, j) = (k % SEA, k / SEA);
        sink.face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], DVec3::Y);
    }
}

/// Points of the walk on the map, where no tree stands.
fn way() -> Vec<DVec3> {
    const STOPS: [(f64, f64); 7] = [
        (0.0, 112.0),
        (78.0, 74.0),
        (104.0, -22.0),
        (42.0, -96.0),
        (-48.0, -82.0),
        (-106.0, -8.0),
        (-62.0, 84.0),
    ];
    let stop = |k: usize| DVec3::new(STOPS[k % STOPS.len()].0, 0.0, STOPS[k % STOPS.len()].1);
    (0..240).map(|k| spline(STOPS.len() + 1, stop, f64::from(k) / 240.0)).collect()
}

/// Once around, looking ahead and a little inland.
fn walk(island: &Island, way: &[DVec3], origin: DVec3) -> ViewPath<Solid> {
    let eye = |k: usize| island.at(way[k].x, way[k].z) + DVec3::Y * EYE;
    let view = |k: usize| {
        let ahead = way[(k + 16) % way.len()] * 0.86;
        let target = DVec3::new(ahead.x, eye(k).y + 0.5, ahead.z);
        sight(eye(k) - origin, target - origin, 6.0 * REACH)
    };
    ViewPath { name: "walk".into(), views: (0..way.len()).map(view).collect() }
}

/// Trees by lot on dry ground, away from each other and from the walk.
fn plant(island: &Island, way: &[DVec3], rng: &mut Pcg32) -> Vec<Tree> {
    /// Places tried before one that is too near others is taken.
    const TRIES: u32 = 400;
    let mut trees: Vec<Tree> = Vec::with_capacity(TREES as usize);
    while (trees.len() as u64) < TREES {
        let high = 8.5 + 3.5 * signed(rng);
        let radius = high * (0.31 + 0.06 * signed(rng));
        let mut foot = DVec3::ZERO;
        for _ in 0..TRIES {
            foot = island.at(SHORE * signed(rng), SHORE * signed(rng));
            let flat = |p: DVec3| (p - foot).with_y(0.0).length();
            let free = way.iter().all(|p| flat(*p) > radius + APART)
                && trees.iter().all(|t| flat(t.foot) > 0.5 * (radius + t.radius) + APART);
            if foot.y > DRY && free {
                break;
            }
        }
        let foot = foot.with_y(foot.y - 0.1);
        trees.push(Tree {
            foot,
            crown: [0.16 * high, high],
            radius,
            trunk: 0.026 * high,
            branches: 10,
            twigs: 4,
        });
    }
    trees
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    /// Chamberlain et al. 1996, Table 1: 3,642,224 triangles, of which trees have 7,519 each.
    #[test]
    fn the_budget_is_met_and_trees_stand_on_dry_ground() {
        let default = GENERATOR.params.iter().find(|p| p.name == "polygons").map(|p| p.default);
        assert_eq!(default, Some(480 * 7_519 + 33_104));
        let parts = generate("terrain-island?polygons=400000", &LoadOptions::default(), &Quiet);
        let scene = Scene::new(parts.expect("an island")).expect("a scene");
        assert_eq!((scene.prim_count(), scene.live().len()), (400_000, 400_000));
        assert_eq!(touched(&scene), None);
        let (mut feet, mut of_trees) = (vec![f32::INFINITY; TREES as usize], vec![0; TREES as usize]);
        for &prim in scene.live() {
            let object = &scene.objects()[scene.object_of(prim).at()];
            let Some(k) = object.group.strip_prefix("tree_").and_then(|k| k.parse::<usize>().ok()) else {
                continue;
            };
            of_trees[k] += 1;
            feet[k] = feet[k].min(scene.prim_bounds(prim).min.y);
        }
        assert!(feet.iter().all(|y| *y > DRY as f32 - 0.2), "{feet:?}");
        // All alike, but for one triangle.
        let (least, most) = (of_trees.iter().min(), of_trees.iter().max());
        assert!(most.zip(least).is_some_and(|(m, l)| m - l <= 1), "{least:?} to {most:?}");
        // Machines must agree, so the bits are written down.
        assert_eq!(scene.hash_hex(), "bafbcbc6f8e46ad0457e3e78d22b206c79744b3dc72a073b228fb68a5cb2a59c");
    }
}
