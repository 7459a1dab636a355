//! `generate:thin-slabs`: blinds and posts at growing distances, with objects behind them.
//!
//! For the known weakness of culling by depth samples (Georges 1995, Section 3; Greene, Kass and Miller
//! 1993): slabs and gaps have the same size everywhere, so with distance they become narrower than a pixel.
//! An image then takes a blind for solid, loses a post, and hides what a finer image shows. Each blind spans
//! the same angle as every other, so all cover as many pixels. Cost: O(polygons).

use glam::DVec3;

use super::furniture::{self, MATERIALS};
use super::sculpture::sculpture;
use super::shapes::{Frame, Sink, block};
use super::walk::flight;
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "thin-slabs",
    meaning: "blinds and posts that become narrower than a pixel with distance, and what they hide: for \
              aliasing",
    params: &[GeneratorParam {
        name: "polygons",
        default: 60_000,
        min: 30_000,
        max: 2_000_000,
        meaning: "triangles, met within 5 percent; the objects behind the blinds share what the slabs leave",
    }],
    make,
};

/// Width of a slat, of the gap to the next, and its thickness, m.
const SLAT: f64 = 0.06;
const GAP: f64 = 0.02;
const THICK: f64 = 0.004;
const BLINDS: u32 = 8;
/// Distance of the first blind, and of each by that of the one before.
const FIRST: f64 = 4.0;
const GROWTH: f64 = 1.55;
/// Half a blind's width, and its height, by its distance.
const HALF_WIDTH: f64 = 0.055;
const HEIGHT: f64 = 0.5;
/// Width of a post, m.
const POST: f64 = 0.03;
const EYE: f64 = 1.6;

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let mut slabs = Sink::counting();
    furnish(&mut slabs, 0);
    let each = values.get("polygons").saturating_sub(slabs.triangles) / u64::from(BLINDS);
    let mut sink = Sink::keeping(MATERIALS);
    furnish(&mut sink, each);
    let rest = Part { whole: progress, start: 0.3, length: 0.7 };
    let mut parts = assemble(sink.into_mesh(), "thin-slabs", source, options, Report::default(), &rest)?;
    parts.paths.push(way(parts.origin));
    Ok(parts)
}

/// Distance of a blind, and the tangent of the angle at which it stands from the middle.
fn place(k: u32) -> (f64, f64) {
    let distance = (0..k).fold(FIRST, |d, _| d * GROWTH);
    (distance, -0.49 + 0.14 * f64::from(k))
}

/// Ground, blinds and posts, and an object of `each` triangles behind every blind; none if that is 0.
fn furnish(sink: &mut Sink, each: u64) {
    let far = 1.5 * place(BLINDS - 1).0;
    sink.begin(|| ("ground".into(), String::new()));
    sink.paint(furniture::FLOOR);
    sink.face(
        &[(-far, 20.0), (far, 20.0), (far, -far), (-far, -far)].map(|(x, z)| DVec3::new(x, 0.0, z)),
        DVec3::Y,
    );
    for k in 0..BLINDS {
        let (distance, slope) = place(k);
        let foot =
            Frame { origin: DVec3::new(slope * distance, 0.0, -distance), right: DVec3::X, away: DVec3::Z };
        let (half, height) = (HALF_WIDTH * distance, EYE + HEIGHT * 0.5 * distance);
        sink.begin(|| (format!("blind_{k}"), "slabs".into()));
        sink.paint(furniture::BLIND);
        // Every other one hangs, the others lie.
        let along = if k % 2 == 0 { height } else { 2.0 * half };
        for i in 0..(along / (SLAT + GAP)) as u32 {
            let low = f64::from(i) * (SLAT + GAP);
            if k % 2 == 0 {
                block(sink, &foot, [-half, low, 0.0], [half, low + SLAT, THICK]);
            } else {
                block(sink, &foot, [low - half, 0.0, 0.0], [low - half + SLAT, height, THICK]);
            }
        }
        sink.begin(|| (format!("post_{k}"), "slabs".into()));
        sink.paint(furniture::METAL);
        let beside = foot.moved([0.07 * distance, 0.0, 0.0]);
        block(sink, &beside, [-0.5 * POST, 0.0, 0.0], [0.5 * POST, height, POST]);
        if each > 0 {
            sink.begin(|| (format!("object_{k}"), "objects".into()));
            sink.paint(furniture::BOOKS + k % 3);
            let size = 0.045 * distance;
            sculpture(sink, foot.at([0.0, EYE + 0.06 * distance, -1.6 * size]), size, k, each);
        }
    }
}

/// From near the first blinds back to where all are far.
fn way(origin: DVec3) -> ViewPath<Solid> {
    let far = place(BLINDS - 1).0;
    let stops = [(0.0, 0.0), (0.4, 3.0), (-0.4, 7.0), (0.3, 12.0), (0.0, 18.0)].map(|(x, z)| {
        let eye = DVec3::new(x, EYE, z);
        (eye, eye - DVec3::Z)
    });
    flight(&stops, 120, 2.5 * far, origin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn slabs(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("slabs")).expect("a scene")
    }

    #[test]
    fn the_budget_is_met_and_the_bits_stay() {
        for polygons in [30_000u32, 60_000, 200_000] {
            let scene = slabs(&format!("thin-slabs?polygons={polygons}"));
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.05 * want, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            assert_eq!(touched(&scene), None);
        }
        // Machines must agree, so the bits are written down.
        assert_eq!(
            slabs("thin-slabs?polygons=30000").hash_hex(),
            "a86f9bc45e4e6106af2830764d009decffbecbdcd37ea294250178963723bea3"
        );
    }

    /// At a thousand pixels the gaps of the nearest blind are wider than a pixel and those of the farthest
    /// are not.
    #[test]
    fn gaps_pass_the_size_of_a_pixel() {
        let pixel = 2.0 * 30f64.to_radians().tan() / 1024.0;
        assert!(GAP / place(0).0 > 2.0 * pixel);
        assert!((SLAT + GAP) / place(BLINDS - 1).0 < pixel);
    }
}
