//! `generate:forest`: trees with leaves before and around a house, which is seen through them.
//!
//! After the trees and the house of Zhang et al. (1997, Figures 6 and 7): the trees hide the house together,
//! but for holes among their leaves, of a pixel or a few where the path begins. It comes nearer, so that
//! holes grow and what is seen through them with them. What house and wood leave of the triangles goes into
//! leaves, whose size follows from their number, so that as much light falls through. Cost: O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;

use super::cottage::{self, RIDGE, cottage};
use super::shapes::{Frame, Sink};
use super::tree::{KITE, Tree, Twig};
use super::walk::{flight, sight};
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values, detail_for};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "forest",
    meaning: "a house behind and among trees, seen through holes of a pixel or a few between their leaves; \
              after Zhang et al. 1997, Figures 6 and 7",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 150_000,
            min: 20_000,
            max: 8_000_000,
            meaning: "triangles, met within 2 percent",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses how trees grow and where leaves hang",
        },
        GeneratorParam {
            name: "leaf",
            default: 0,
            min: 0,
            max: 2_000,
            meaning: "length of a leaf in mm; 0 chooses it so that any number of leaves lets as much light \
                      through",
        },
    ],
    make,
};

/// Materials of what grows; they follow those of the house.
const MATERIALS: &[(&str, [f32; 3])] = &[
    ("grass", [0.27, 0.40, 0.15]),
    ("bark", [0.22, 0.16, 0.11]),
    ("leaf blue", [0.07, 0.22, 0.10]),
    ("leaf dark", [0.08, 0.25, 0.06]),
    ("leaf", [0.12, 0.31, 0.06]),
    ("leaf bright", [0.18, 0.38, 0.08]),
    ("leaf fresh", [0.27, 0.44, 0.09]),
    ("leaf yellow", [0.38, 0.47, 0.12]),
];
const GRASS: u32 = cottage::MATERIALS.len() as u32;
const BARK: u32 = GRASS + 1;
const LEAF: u32 = GRASS + 2;
/// Greens of leaves, and how many of them a tree has.
const GREENS: u32 = 6;
const GREENS_EACH: u32 = 3;

/// Where trees stand (x, z), and the height and radius of their crowns, m. The house stands around 0 and
/// looks along +z; the first of them hide it.
const TREES: [[f64; 4]; 11] = [
    [-5.3, 13.2, 8.7, 3.1],
    [0.1, 12.3, 9.0, 3.2],
    [5.5, 13.4, 8.5, 3.1],
    [-2.7, 8.6, 8.9, 3.0],
    [3.0, 9.0, 8.5, 3.0],
    [-11.4, 8.4, 9.6, 3.4],
    [11.6, 7.6, 9.2, 3.3],
    [-10.4, -2.4, 10.2, 3.5],
    [10.8, -4.4, 9.7, 3.4],
    [-4.2, -10.2, 11.6, 3.6],
    [4.8, -11.4, 12.2, 3.7],
];
const BEFORE: usize = 5;
/// The same of bushes.
const BUSHES: [[f64; 4]; 7] = [
    [-7.6, 15.2, 2.5, 1.6],
    [-4.9, 15.9, 2.8, 1.7],
    [-2.2, 15.0, 2.7, 1.7],
    [0.6, 15.8, 2.8, 1.7],
    [3.3, 15.1, 2.8, 1.7],
    [6.0, 15.8, 2.6, 1.6],
    [8.6, 15.0, 2.4, 1.5],
];
/// Area of leaves per cross-section of a crown, both in m².
const DENSITY: f64 = 3.2;
/// The same of trees that hide nothing, against the others.
const SPARSE: f64 = 0.6;
/// Share of the triangles for house, wood and ground.
const NOT_LEAVES: f64 = 0.3;
/// From the middle of the ground to its edge, m.
const REACH: f64 = 60.0;

fn trees() -> Vec<Tree> {
    let tree = |&[x, z, high, radius]: &[f64; 4]| Tree {
        foot: DVec3::new(x, 0.0, z),
        crown: [0.06 * high, high],
        radius,
        trunk: 0.026 * high,
        branches: 12,
        twigs: 5,
    };
    let bush = |&[x, z, high, radius]: &[f64; 4]| Tree {
        foot: DVec3::new(x, 0.0, z),
        crown: [0.02 * high, high],
        radius,
        trunk: 0.05,
        branches: 9,
        twigs: 3,
    };
    TREES.iter().map(tree).chain(BUSHES.iter().map(bush)).collect()
}

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (polygons, seed) = (values.get("polygons"), values.get("seed"));
    let bare = |sink: &mut Sink, detail: u32| grow(sink, seed, detail, |_, _, _, _| {});
    // One step below what would be more.
    let budget = (polygons as f64 * NOT_LEAVES) as u64;
    let detail = detail_for(budget, source, progress, bare)?.max(2) - 1;
    let mut count = Sink::counting();
    bare(&mut count, detail);
    let leaves = polygons.saturating_sub(count.triangles) / 2;
    let trees = trees();
    let wanted = |k: usize| {
        let is_sparse = (BEFORE..TREES.len()).contains(&k);
        trees[k].shade() * if is_sparse { SPARSE } else { 1.0 }
    };
    let shade: f64 = (0..trees.len()).map(wanted).sum();
    let length = match values.get("leaf") {
        0 => (DENSITY * shade / (KITE * leaves.max(1) as f64)).sqrt(),
        given => given as f64 * 1e-3,
    };
    progress.report(0.2, "growing trees");
    let mut sink = Sink::keeping(&[cottage::MATERIALS, MATERIALS].concat());
    grow(&mut sink, seed, detail, |sink, k, twigs, rng| {
        let share = (leaves as f64 * wanted(k) / shade) as u64;
        // Neighbors differ in their greens.
        let first = LEAF + k as u32 % (GREENS - GREENS_EACH + 1);
        trees[k].leaves(sink, twigs, (share, length), (first, GREENS_EACH), rng);
    });
    let mut mesh = sink.into_mesh();
    // A leaf is a sheet, seen from both sides.
    mesh.materials[LEAF as usize..(LEAF + GREENS) as usize].iter_mut().for_each(|m| m.two_sided = true);
    let rest = Part { whole: progress, start: 0.4, length: 0.6 };
    let mut parts = assemble(mesh, "forest", source, options, Report::default(), &rest)?;
    let origin = parts.origin;
    parts.paths.push(ViewPath { name: "zoom".into(), ..flight(&stops(), 120, FAR, origin) });
    let [far, near] = [stops()[0], (DVec3::new(0.9, 2.8, 23.5), DVec3::new(0.2, 3.1, 0.0))];
    let views = [far, near].map(|(from, to)| sight(from - origin, to - origin, FAR)).to_vec();
    parts.paths.push(ViewPath { name: "views".into(), views });
    Ok(parts)
}

/// Far plane, m.
const FAR: f64 = 150.0;

/// From where the whole house lies behind the trees to just before their leaves.
fn stops() -> [(DVec3, DVec3); 3] {
    let target = DVec3::new(0.0, 0.45 * RIDGE, 0.0);
    [(1.6, 3.0, 36.0), (1.2, 2.9, 27.0), (0.7, 2.7, 19.2)].map(|(x, y, z)| (DVec3::new(x, y, z), target))
}

/// The ground, the house, and each tree with what `leaves` hangs on it by its number.
fn grow(sink: &mut Sink, seed: u64, detail: u32, leaves: impl Fn(&mut Sink, usize, &[Twig], &mut Pcg32)) {
    sink.begin(|| ("meadow".into(), String::new()));
    sink.paint(GRASS);
    let cells = 24;
    let step = 2.0 * REACH / f64::from(cells);
    for k in 0..cells * cells {
        let (x, z) = (step * f64::from(k % cells) - REACH, step * f64::from(k / cells) - REACH);
        let corners = [[x, z], [x + step, z], [x + step, z + step], [x, z + step]];
        sink.face(&corners.map(|[x, z]| DVec3::new(x, 0.0, z)), DVec3::Y);
    }
    // The house's front is to its frame's −z.
    let frame = Frame { origin: DVec3::ZERO, right: -DVec3::X, away: -DVec3::Z };
    cottage(sink, &frame, detail, &mut Pcg32::new(seed, 40));
    for (k, tree) in trees().iter().enumerate() {
        let rng = &mut Pcg32::new(seed.wrapping_mul(1_000_003).wrapping_add(k as u64), 41);
        let name = if k < TREES.len() { "tree" } else { "bush" };
        sink.begin(|| ("wood".into(), format!("{name}_{k}")));
        sink.paint(BARK);
        let twigs = tree.wood(sink, detail, rng);
        sink.begin(|| ("leaves".into(), format!("{name}_{k}")));
        leaves(sink, k, &twigs, rng);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn forest(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a forest")).expect("a scene")
    }

    #[test]
    fn any_budget_is_met_within_two_percent_and_a_tenth_of_it_is_the_house() {
        for polygons in [20_000u32, 150_000, 400_000] {
            let scene = forest(&format!("forest?polygons={polygons}"));
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.02 * want, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            assert_eq!(touched(&scene), None);
            let views = scene.paths().iter().flat_map(|p| &p.views);
            assert!(views.into_iter().all(|v| v.eye.fault().is_none()));
            let of = |is: fn(&crate::scene::Object) -> bool| {
                scene.live().iter().filter(|p| is(&scene.objects()[scene.object_of(**p).at()])).count() as f64
            };
            let (house, leaves) = (of(|o| o.group == cottage::GROUP), of(|o| o.name == "leaves"));
            assert!(house > 0.05 * want && house < 0.2 * want, "{house} of {want}");
            assert!(leaves > 0.55 * want && leaves < 0.9 * want, "{leaves} of {want}");
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_forest_and_another_one_another() {
        let hash = |call: &str| forest(call).hash_hex();
        assert_ne!(hash("forest?polygons=20000&seed=4"), hash("forest?polygons=20000&seed=5"));
        assert_ne!(hash("forest?polygons=20000&seed=4"), hash("forest?polygons=20000&seed=4&leaf=300"));
        // Machines must agree, so the bits are written down.
        assert_eq!(
            hash("forest?polygons=20000&seed=4"),
            "66372aa0da63319d0faa612d04c91de559345a501a41f0c6026cf38ca93d9ffb"
        );
    }

    /// Leaves are seen from both sides and stay in their crowns; a crown's cross-section has the area of
    /// leaves that it should have, whatever their number.
    #[test]
    fn leaves_are_sheets_in_their_crowns_of_the_same_area() {
        for polygons in [20_000u32, 60_000] {
            let scene = forest(&format!("forest?polygons={polygons}"));
            for (k, tree) in trees().iter().enumerate().take(BEFORE) {
                let mut area = 0.0;
                let group = format!("tree_{k}");
                for &prim in scene.live() {
                    let object = &scene.objects()[scene.object_of(prim).at()];
                    if object.name != "leaves" || object.group != group {
                        continue;
                    }
                    assert!(scene.is_two_sided(prim));
                    area += f64::from(scene.normal(prim).length()) * 0.5;
                    let bounds = scene.prim_bounds(prim);
                    let aside = (bounds.center().as_dvec3() - tree.foot).with_y(0.0).length();
                    assert!(aside < tree.radius + 0.8 && f64::from(bounds.max.y) < tree.crown[1] + 1.2);
                }
                // The fold, and lengths that vary by a quarter, make it a little larger.
                let density = area / tree.shade();
                assert!(density > DENSITY && density < 1.1 * DENSITY, "{group}: {density}");
            }
        }
    }
}
