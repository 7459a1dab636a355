//! `generate:terrain`: hills that are looked down upon, so that nothing hides anything.
//!
//! What occlusion culling costs shows where it has nothing to cull: every triangle faces each eye of the
//! flight, and where all of a height field faces the eye no part of it is before another. Heights are random
//! at the points of two lattices and smooth between them (value noise). Cost: O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::shapes::Sink;
use super::walk::flight;
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "terrain",
    meaning: "hills from above, where nothing hides anything: for what occlusion culling costs where it can \
              cull nothing",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 150_000,
            min: 2_000,
            max: 8_000_000,
            meaning: "triangles, met within 5 percent",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses the hills",
        },
    ],
    make,
};

const MATERIALS: &[(&str, [f32; 3])] =
    &[("meadow", [0.27, 0.40, 0.15]), ("heath", [0.40, 0.36, 0.17]), ("rock", [0.42, 0.40, 0.37])];
/// Side of the ground, m.
const SIDE: f64 = 1600.0;
/// Points of a lattice a side, and how high it lifts the ground, m. No slope is steeper than 1.5 times the
/// height over the distance of two points, on either axis.
const LATTICES: [(usize, f64); 2] = [(8, 28.0), (28, 4.0)];
/// Height of the eye, m, and how far ahead of it the ground is that it looks at.
const HIGH: f64 = 320.0;
const AHEAD: f64 = 185.0;
const FAR: f64 = 3000.0;

/// Heights at the points of a square lattice.
pub(super) struct Lattice {
    points: usize,
    heights: Vec<f64>,
}

impl Lattice {
    pub(super) fn new(points: usize, high: f64, rng: &mut Pcg32) -> Self {
        let unit = |bits: u32| f64::from(bits) / f64::from(u32::MAX);
        Self { points, heights: (0..points * points).map(|_| high * unit(rng.next_u32())).collect() }
    }
    /// The height at a place of 0..1, smooth between the points.
    pub(super) fn at(&self, x: f64, z: f64) -> f64 {
        let place = |v: f64| {
            let at = v * (self.points - 1) as f64;
            let cell = (at.floor() as usize).min(self.points - 2);
            let t = at - cell as f64;
            (cell, t * t * (3.0 - 2.0 * t))
        };
        let ((i, s), (k, t)) = (place(x), place(z));
        let height = |i: usize, k: usize| self.heights[k * self.points + i];
        let row = |k: usize| height(i, k) + (height(i + 1, k) - height(i, k)) * s;
        row(k) + (row(k + 1) - row(k)) * t
    }
}

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let mut rng = Pcg32::new(values.get("seed"), 50);
    let lattices = LATTICES.map(|(points, high)| Lattice::new(points, high, &mut rng));
    // Two triangles a cell.
    let cells = ((values.get("polygons") as f64 / 2.0).sqrt() + 0.5) as u32;
    let at = |i: u32, k: u32| {
        let (x, z) = (f64::from(i) / f64::from(cells), f64::from(k) / f64::from(cells));
        let height: f64 = lattices.iter().map(|l| l.at(x, z)).sum();
        DVec3::new((x - 0.5) * SIDE, height, (z - 0.5) * SIDE)
    };
    let mut sink = Sink::keeping(MATERIALS);
    sink.begin(|| ("ground".into(), String::new()));
    progress.report(0.1, "raising hills");
    for k in 0..cells {
        for i in 0..cells {
            let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
            // By height.
            sink.paint(((a.y + c.y) / 24.0) as u32 % MATERIALS.len() as u32);
            sink.face(&[a, b, c], DVec3::Y);
            sink.face(&[a, c, d], DVec3::Y);
        }
    }
    let rest = Part { whole: progress, start: 0.3, length: 0.7 };
    let mut parts = assemble(sink.into_mesh(), "terrain", source, options, Report::default(), &rest)?;
    parts.paths.push(way(parts.origin));
    Ok(parts)
}

/// A loop over the ground, looking down ahead.
fn way(origin: DVec3) -> ViewPath<Solid> {
    let stops = [(-400.0, -350.0), (0.0, -450.0), (350.0, -150.0), (250.0, 300.0), (-200.0, 350.0)];
    let at = |k: usize| DVec3::new(stops[k % stops.len()].0, 0.0, stops[k % stops.len()].1);
    let stop = |k: usize| {
        let on = (at(k + 1) - at(k)).normalize() * AHEAD;
        (at(k) + DVec3::Y * HIGH, at(k) + on)
    };
    flight(&(0..=stops.len()).map(stop).collect::<Vec<_>>(), 120, FAR, origin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn terrain(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("hills")).expect("a scene")
    }

    #[test]
    fn the_budget_is_met_and_the_bits_stay() {
        for polygons in [2_000u32, 20_000, 150_000] {
            let scene = terrain(&format!("terrain?polygons={polygons}"));
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.05 * want, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            assert_eq!(touched(&scene), None);
        }
        let hash = |call: &str| terrain(call).hash_hex();
        assert_ne!(hash("terrain?polygons=2000&seed=2"), hash("terrain?polygons=2000&seed=3"));
        // Machines must agree, so the bits are written down.
        assert_eq!(
            hash("terrain?polygons=2000&seed=2"),
            "0da63a1cce19d37913874473ca2622a28c512d71f4287125902f8584b855a467"
        );
    }

    /// A line of sight that went into the ground and came out again would pass a triangle from below.
    #[test]
    fn nothing_hides_anything() {
        for call in ["terrain?polygons=2000", "terrain?polygons=50000&seed=9"] {
            let scene = terrain(call);
            for view in &scene.paths()[0].views {
                let faces_away = scene.live().iter().find(|&&p| scene.faces_away(p, view.eye.position));
                assert_eq!(faces_away, None, "{call}");
            }
        }
    }
}
