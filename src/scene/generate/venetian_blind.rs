//! `generate:venetian-blind`: slats as deep as they are apart, before a wall of colored squares.
//!
//! For Chamberlain et al. (1996, Section 3.2): a small change of direction changes much of what the slats
//! cover, which no six colors can say. Seen φ from their planes they cover min(1, tan φ) of what is behind.
//! Slats are sheets, 1/16 m deep and apart, and lie in the middle of cells of that size of the cube around
//! all, each in one row of them. Cost: O(polygons).

use glam::DVec3;

use super::shapes::Sink;
use super::walk::{flight, small_view};
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;
use crate::scene::circle::circle;

pub(super) const GENERATOR: Generator = Generator {
    name: "venetian-blind",
    meaning: "a blind whose slats are as deep as they are apart, before a wall of colored squares; after \
              Chamberlain et al. 1996, Section 3.2",
    params: &[GeneratorParam {
        name: "polygons",
        default: 12_000,
        min: 600,
        max: 2_000_000,
        meaning: "triangles, met within 10 percent",
    }],
    make,
};

const MATERIALS: &[(&str, [f32; 3])] = &[
    ("slat", [0.72, 0.68, 0.58]),
    ("square red", [0.62, 0.08, 0.05]),
    ("square blue", [0.05, 0.16, 0.52]),
    ("square yellow", [0.78, 0.55, 0.05]),
    ("square green", [0.06, 0.36, 0.12]),
];
const SQUARE: u32 = 1;
const SQUARES: u32 = MATERIALS.len() as u32 - SQUARE;
/// Depth of a slat and distance to the next, m.
const SLAT: f64 = 1.0 / 16.0;
const SLATS: u32 = 32;
/// Half the width and height of the blind and of the wall, m: 32 slats and half a gap above and below.
const HALF: f64 = 1.0;
/// From the rear edge of the slats to the wall, m: an odd number of cells, so that with the slats' own the
/// middle of all lies between two.
const BEHIND: f64 = 17.0 / 16.0;
/// Squares of the wall a side.
const BOARD: u32 = 8;

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let polygons = values.get("polygons") as f64;
    // A tenth is the wall's, in whole cells of each square.
    let fine = ((polygons * 0.1 / f64::from(2 * BOARD * BOARD)).sqrt() as u32).max(1);
    let wall = f64::from(2 * BOARD * BOARD * fine * fine);
    let cells = (((polygons - wall) / f64::from(2 * SLATS) + 0.5) as u32).max(1);
    let mut sink = Sink::keeping(MATERIALS);
    for k in 0..SLATS {
        sink.begin(|| (format!("slat_{k}"), "blind".into()));
        let y = SLAT * (f64::from(k) + 0.5) - HALF;
        let at = |i: u32| 2.0 * HALF * f64::from(i) / f64::from(cells) - HALF;
        for i in 0..cells {
            let corners = [[at(i), 0.0], [at(i + 1), 0.0], [at(i + 1), SLAT], [at(i), SLAT]];
            sink.face(&corners.map(|[x, z]| DVec3::new(x, y, z)), DVec3::Y);
        }
    }
    sink.begin(|| ("wall".into(), String::new()));
    let lines = BOARD * fine;
    let at = |i: u32| 2.0 * HALF * f64::from(i) / f64::from(lines) - HALF;
    for k in 0..lines * lines {
        let (i, j) = (k % lines, k / lines);
        sink.paint(SQUARE + (i / fine + 2 * (j / fine % 2)) % SQUARES);
        let corners = [[at(i), at(j)], [at(i + 1), at(j)], [at(i + 1), at(j + 1)], [at(i), at(j + 1)]];
        sink.face(&corners.map(|[x, y]| DVec3::new(x, y, -BEHIND)), DVec3::Z);
    }
    let mut mesh = sink.into_mesh();
    mesh.materials[0].two_sided = true;
    let rest = Part { whole: progress, start: 0.3, length: 0.7 };
    let mut parts = assemble(mesh, "venetian-blind", source, options, Report::default(), &rest)?;
    parts.paths.extend(ways(parts.origin));
    Ok(parts)
}

/// Distance of the eye from the middle of the blind, m.
const DISTANCE: f64 = 4.0;

/// From the slats' planes upward: in steps of 15°, and smoothly.
fn ways(origin: DVec3) -> [ViewPath<Solid>; 2] {
    let middle = DVec3::Z * (0.5 * SLAT);
    let eye = |degrees: u32| {
        let (c, s) = circle(degrees, 360);
        middle + DVec3::new(0.0, s, c) * DISTANCE
    };
    let stops: Vec<_> = (0..=12).map(|k| (eye(5 * k), middle)).collect();
    let views = (0..=4).map(|k| small_view(eye(15 * k) - origin, middle - origin, DISTANCE)).collect();
    [
        ViewPath { name: "angles".into(), views },
        ViewPath { name: "rise".into(), ..flight(&stops, 120, 4.0 * DISTANCE, origin) },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::{Target, render};
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn blind(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a blind")).expect("a scene")
    }

    #[test]
    fn the_budget_is_met_and_the_bits_stay() {
        for polygons in [600u32, 12_000, 100_000] {
            let scene = blind(&format!("venetian-blind?polygons={polygons}"));
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.1 * want, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            assert_eq!(touched(&scene), None);
        }
        assert_eq!(
            blind("venetian-blind?polygons=600").hash_hex(),
            "a14c3447dae633eeec314f39521bfc3d4e9da1088faa6cfc6ad511f267f633f5"
        );
    }

    /// Slats lie in the middle of cells of their own size of the cube around all, whose edges are multiples
    /// of that size.
    #[test]
    fn each_slat_lies_in_a_row_of_cells() {
        let scene = blind("venetian-blind?polygons=600");
        let bounds = scene.bounds();
        let corner = bounds.center() - glam::Vec3::splat(0.5 * (bounds.max - bounds.min).max_element());
        let slat = SLAT as f32;
        for &prim in scene.live().iter().filter(|p| scene.is_two_sided(**p)) {
            let (low, high) = (scene.prim_bounds(prim).min - corner, scene.prim_bounds(prim).max - corner);
            assert_eq!((low.y / slat).fract(), 0.5);
            assert_eq!(((low.z / slat).fract(), (high.z / slat).fract()), (0.0, 0.0));
        }
    }

    /// What slats as deep as their spacing cover from far away, at 0, 15, 30, 45 and 60°: min(1, tan φ).
    #[test]
    fn slats_cover_the_tangent_of_the_angle() {
        let scene = blind("venetian-blind?polygons=600");
        let slats: Vec<_> = scene.live().iter().copied().filter(|p| scene.is_two_sided(*p)).collect();
        for (view, degrees) in scene.paths()[0].views.iter().zip([0.0f64, 15.0, 30.0, 45.0, 60.0]) {
            let mut view = *view;
            // From a thousand times as far, and cut to the middle of the blind.
            let away = view.eye.position - view.eye.target;
            view.eye.position = view.eye.target + away * 1000.0;
            view.eye.fov = 0.4e-3;
            (view.eye.near, view.eye.far) = (3_000.0, 5_000.0);
            (view.width, view.height) = (512, 2048);
            let image = render(&scene, &view, &slats);
            let rows = 512..1536;
            let covered = rows
                .clone()
                .flat_map(|y| (0..512).map(move |x| y * 512 + x))
                .filter(|at| image.item[*at] != Target::NONE)
                .count() as f64;
            let share = covered / (512.0 * rows.len() as f64);
            let want = degrees.to_radians().tan().min(1.0);
            assert!((share - want).abs() < 0.04, "{degrees}°: {share} instead of {want}");
        }
    }
}
