//! `generate:suspension`: small triangles anywhere in a cube, turned anyhow.
//!
//! For Chamberlain et al. (1996): "suspension-like" distributions of primitives that are uncorrelated and
//! small (Section 5.1), for which as many cells of each level are drawn (Section 3.1). Points lie on a grid
//! of 2⁻¹⁴ m. Cost: O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::plan::signed;
use super::shapes::Sink;
use super::tree::direction;
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values};
use crate::geometry::Solid;
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "suspension",
    meaning: "small triangles anywhere in a cube, turned anyhow; after Chamberlain et al. 1996, Sections 3.1 \
              and 5.1",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 1_000_000,
            min: 100,
            max: 8_000_000,
            meaning: "triangles, met exactly",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses where they are",
        },
    ],
    make,
};

const MATERIALS: &[(&str, [f32; 3])] = &[
    ("speck red", [0.62, 0.10, 0.06]),
    ("speck blue", [0.06, 0.18, 0.54]),
    ("speck yellow", [0.78, 0.56, 0.06]),
    ("speck white", [0.80, 0.80, 0.78]),
];
/// Half the side of the cube that the middles of triangles are in, m.
const HALF: f64 = 32.0;
/// From the middle of a triangle to its corners, m.
const RADIUS: f64 = 0.1;
/// Points lie on multiples of 1/this.
const GRID: f64 = 16_384.0;

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let mut rng = Pcg32::new(values.get("seed"), 61);
    let mut sink = Sink::keeping(MATERIALS);
    sink.begin(|| ("specks".into(), "suspension".into()));
    for _ in 0..values.get("polygons") {
        sink.paint(rng.next_u32() % MATERIALS.len() as u32);
        let middle = DVec3::new(signed(&mut rng), signed(&mut rng), signed(&mut rng)) * HALF;
        let normal = direction(&mut rng);
        let across = normal.any_orthonormal_vector() * RADIUS;
        let along = normal.cross(across);
        // Of equal sides: 120° apart.
        let root = 0.75f64.sqrt();
        let corners = [across, along * root - across * 0.5, along * -root - across * 0.5];
        sink.face(&corners.map(|c| ((middle + c) * GRID).round() / GRID), normal);
    }
    let mut mesh = sink.into_mesh();
    mesh.materials.iter_mut().for_each(|m| m.two_sided = true);
    let rest = Part { whole: progress, start: 0.3, length: 0.7 };
    assemble(mesh, "suspension", source, options, Report::default(), &rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::{Quiet, Scene};

    #[test]
    fn triangles_fill_the_cube_evenly_and_are_small() {
        let parts = generate("suspension?polygons=8000", &LoadOptions::default(), &Quiet).expect("a scene");
        let scene = Scene::<Solid>::new(parts).expect("a scene");
        assert_eq!((scene.prim_count(), scene.live().len()), (8_000, 8_000));
        let mut counts = [0; 8];
        let mut up = 0;
        for &prim in scene.live() {
            let [a, b, c] = [0, 1, 2].map(|k| scene.prim_points(prim).nth(k).expect("three"));
            let middle = (a + b + c) / 3.0;
            assert!(middle.abs().max_element() < 32.001 && a.distance(middle) < 0.101);
            assert!((a.distance(b) - a.distance(c)).abs() < 1e-3, "of equal sides");
            counts[(0..3).map(|k| usize::from(middle[k] > 0.0) << k).sum::<usize>()] += 1;
            up += usize::from(scene.normal(prim).normalize().y.abs() > 0.5);
        }
        // 1,000 are expected, give or take 30; of directions half are within 60° of the vertical.
        assert!(counts.iter().all(|n| (880..1120).contains(n)), "{counts:?}");
        assert!((3_700..4_300).contains(&up), "{up}");
    }
}
