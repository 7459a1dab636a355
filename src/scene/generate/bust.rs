//! `generate:bust`: a head with shoulders on a foot, one smooth closed surface.
//!
//! For Chamberlain et al. (1996, Plate 4): a surface that parts of its octree show from the front and others
//! edge-on, so that color cubes tear it. Cross-sections change along a curve from the foot to the top of the
//! head; the face is a height over the plane of the front, ears one over that of the side. Cost: O(polygons).

use glam::{DVec3, DVec4};

use super::lathe::grid;
use super::shapes::{Sink, circle};
use super::walk::{around, spline};
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values};
use crate::geometry::Solid;
use crate::scene::Report;
use crate::scene::assemble::assemble;
use crate::scene::polygon::newell;

pub(super) const GENERATOR: Generator = Generator {
    name: "bust",
    meaning: "head and shoulders as one smooth closed surface, for where color cubes tear; after Chamberlain \
              et al. 1996, Plate 4",
    params: &[GeneratorParam {
        name: "polygons",
        default: 120_000,
        min: 2_000,
        max: 8_000_000,
        meaning: "triangles, met within 2 percent",
    }],
    make,
};

const MATERIALS: &[(&str, [f32; 3])] = &[("marble", [0.70, 0.66, 0.60])];

/// Cross-sections from the foot upward: height, half the width, and how far they reach forward and back from
/// the axis, m. The first and the last are points, which closes the surface.
const STOPS: [[f64; 4]; 29] = [
    [0.000, 0.000, 0.000, 0.000],
    [0.000, 0.075, 0.075, 0.075],
    [0.010, 0.082, 0.082, 0.082],
    [0.022, 0.070, 0.070, 0.070],
    [0.050, 0.050, 0.050, 0.050],
    [0.075, 0.058, 0.055, 0.055],
    [0.100, 0.110, 0.090, 0.070],
    [0.135, 0.165, 0.105, 0.085],
    [0.180, 0.205, 0.110, 0.100],
    [0.225, 0.215, 0.108, 0.105],
    [0.262, 0.195, 0.090, 0.098],
    [0.285, 0.135, 0.070, 0.088],
    [0.302, 0.080, 0.056, 0.076],
    [0.320, 0.061, 0.050, 0.066],
    [0.340, 0.057, 0.047, 0.062],
    [0.356, 0.057, 0.050, 0.063],
    [0.364, 0.052, 0.078, 0.066],
    [0.378, 0.057, 0.086, 0.074],
    [0.395, 0.062, 0.088, 0.084],
    [0.415, 0.067, 0.088, 0.094],
    [0.435, 0.071, 0.087, 0.100],
    [0.455, 0.074, 0.087, 0.104],
    [0.475, 0.076, 0.088, 0.106],
    [0.500, 0.077, 0.089, 0.106],
    [0.530, 0.075, 0.084, 0.102],
    [0.558, 0.068, 0.072, 0.092],
    [0.580, 0.054, 0.054, 0.074],
    [0.594, 0.032, 0.030, 0.044],
    [0.598, 0.000, 0.000, 0.000],
];

/// A bump on the face or the side of the head: where its middle is (across, up), how far it reaches, and how
/// high it is, m.
struct Bump([f64; 2], [f64; 2], f64);

/// On one side of the face; the other has them too.
const FACE: [Bump; 17] = [
    // Sockets, eyeballs with drilled pupils, lids.
    Bump([0.031, 0.469], [0.028, 0.020], -0.015),
    Bump([0.031, 0.466], [0.0175, 0.0115], 0.0115),
    Bump([0.030, 0.466], [0.0055, 0.0055], -0.005),
    Bump([0.031, 0.4755], [0.021, 0.0045], 0.0035),
    Bump([0.031, 0.4565], [0.019, 0.004], 0.002),
    // Brow and cheek.
    Bump([0.030, 0.490], [0.040, 0.011], 0.007),
    Bump([0.043, 0.440], [0.030, 0.026], 0.007),
    Bump([0.052, 0.405], [0.022, 0.030], -0.004),
    // Wings of the nose and nostrils.
    Bump([0.013, 0.4235], [0.0085, 0.0085], 0.009),
    Bump([0.007, 0.4165], [0.005, 0.004], -0.006),
    // Lips on both sides of the mouth, and the corner of it.
    Bump([0.006, 0.4025], [0.022, 0.0065], 0.0075),
    Bump([0.000, 0.3905], [0.024, 0.0075], 0.0045),
    Bump([0.000, 0.3965], [0.029, 0.0028], -0.0035),
    Bump([0.026, 0.3965], [0.006, 0.006], -0.003),
    // Between nose and lip, below the lip, and the chin.
    Bump([0.000, 0.4105], [0.004, 0.006], -0.0015),
    Bump([0.000, 0.3815], [0.020, 0.006], -0.0025),
    Bump([0.000, 0.3700], [0.026, 0.015], 0.006),
];

/// On both sides of the head, across it: forward, and up.
const EAR: [Bump; 3] = [
    Bump([-0.012, 0.452], [0.021, 0.036], 0.019),
    Bump([-0.008, 0.456], [0.011, 0.021], -0.012),
    Bump([-0.006, 0.425], [0.010, 0.012], 0.006),
];

/// The chest: collarbones and breast.
const CHEST: [Bump; 2] =
    [Bump([0.060, 0.268], [0.075, 0.010], 0.007), Bump([0.070, 0.180], [0.075, 0.060], 0.008)];

impl Bump {
    /// Its height at a place: (1 − d²)³, smooth where it ends.
    fn at(&self, across: f64, up: f64) -> f64 {
        let Self([x, y], [wide, high], height) = self;
        let (u, v) = ((across - x) / wide, (up - y) / high);
        let left = (1.0 - u * u - v * v).max(0.0);
        height * left * left * left
    }
}

/// 0 below, 1 above, smooth between.
fn step(from: f64, to: f64, at: f64) -> f64 {
    let t = ((at - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// How far the ridge of the nose stands out at a place of the face.
fn nose(across: f64, up: f64) -> f64 {
    let (top, tip, under) = (0.482, 0.4255, 0.4155);
    let down = ((top - up) / (top - tip)).clamp(0.0, 1.0);
    let high = 0.004 * step(0.0, 0.15, down) + 0.023 * down * (0.45 + 0.55 * down);
    let wide = 0.0125 + 0.005 * down * down;
    let u = (across / wide).abs().min(1.0);
    high * step(under, tip, up) * (1.0 - u * u) * (1.0 - u * u)
}

/// How far the hair stands out from the head: nothing on the face and below the nape.
fn hair(ahead: f64, along: f64, up: f64) -> f64 {
    // From the forehead back over the ears to the nape; `ahead` is 1 in front and −1 behind.
    let line = if ahead > 0.0 { 0.478 + 0.062 * step(0.15, 0.95, ahead) } else { 0.478 + 0.105 * ahead };
    let (_, wave) = circle(((along * 22.0 + up * 40.0).rem_euclid(1.0) * 65_536.0) as u32 % 65_536, 65_536);
    step(line, line + 0.014, up) * (0.0085 + 0.0016 * wave)
}

/// The point of the surface at a turn around the axis, 0 in front and a quarter at the left, and a height
/// along it, both of 0..1.
fn point((c, s): (f64, f64), turn: f64, along: f64) -> DVec3 {
    let here = spline(STOPS.len(), |k| DVec4::from_array(STOPS[k]), along);
    let (up, wide, forward, back) = (here.x, here.y, here.z, here.w);
    let (mut x, mut z) = (s * wide, c * if c > 0.0 { forward } else { back });
    let (side, both) = (x.abs(), |bumps: &[Bump]| bumps.iter().map(|b| b.at(x.abs(), up)).sum::<f64>());
    // What faces forward bears the face, what faces aside the ears.
    let front = step(0.1, 0.45, c);
    let ahead = front * (both(&FACE) + both(&CHEST) + nose(side, up));
    let aside = step(0.55, 0.85, s.abs()) * EAR.iter().map(|b| b.at(z, up)).sum::<f64>();
    let hair = if up > 0.36 { hair(c, turn, up) } else { 0.0 };
    z += ahead + c * hair;
    x += s.signum() * aside + s * hair;
    DVec3::new(x, up + hair * step(0.5, 0.6, up), z)
}

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    progress.report(0.1, "carving");
    let mut sink = Sink::keeping(MATERIALS);
    sink.begin(|| ("bust".into(), String::new()));
    let (columns, rows) = grid(values.get("polygons"), 1.1);
    // At both ends a cell has one triangle.
    let rows = rows + 1;
    let at = |i: u32, j: u32| {
        let i = i % columns;
        // At the ends all columns meet.
        let turn = if j == 0 || j == rows { 0 } else { i };
        point(circle(turn, columns), f64::from(turn) / f64::from(columns), f64::from(j) / f64::from(rows))
    };
    let column = |i: u32| -> Vec<DVec3> { (0..=rows).map(|j| at(i, j)).collect() };
    let mut here = column(0);
    for i in 0..columns {
        let next = column(i + 1);
        for j in 0..rows as usize {
            // Outward by the order of the corners, since no point inside is seen from all of the surface.
            let [a, b, c, d] = [here[j], next[j], next[j + 1], here[j + 1]];
            for triangle in [[a, b, c], [a, c, d]] {
                if triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0] {
                    sink.face(&triangle, newell(&triangle));
                }
            }
        }
        here = next;
    }
    let rest = Part { whole: progress, start: 0.3, length: 0.7 };
    let mut parts = assemble(sink.into_mesh(), "bust", source, options, Report::default(), &rest)?;
    parts.paths.extend(around(&parts.points, 45));
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn bust(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a bust")).expect("a scene")
    }

    #[test]
    fn the_budget_is_met_and_the_bits_stay() {
        for polygons in [2_000u32, 20_000, 120_000] {
            let scene = bust(&format!("bust?polygons={polygons}"));
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.03 * want, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            assert_eq!(touched(&scene), None);
        }
        assert_eq!(
            bust("bust?polygons=2000").hash_hex(),
            "e50a4b0c0b55ec79ee1e7b7c3a077c48ce756f1b2741aab304691e2c5e7fb911"
        );
    }

    /// Every edge has a triangle on either side, which run along it in opposite directions.
    #[test]
    fn the_surface_is_closed_and_turned_outward() {
        let scene = bust("bust?polygons=20000");
        let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        let mut volume = 0.0;
        for &prim in scene.live() {
            let Some(corners) = scene.corners(prim) else { continue };
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
            let p: Vec<DVec3> = scene.prim_points(prim).map(|p| p.as_dvec3()).collect();
            volume += p[0].dot(p[1].cross(p[2])) / 6.0;
        }
        assert_eq!(edges.values().filter(|n| **n != 0).count(), 0);
        // Some liters.
        assert!(volume > 0.008 && volume < 0.02, "{volume} m³");
    }
}
