//! `generate:box-and-objects`: a plain box and a row of complex objects that it hides.
//!
//! The first test of Georges (1995, Section 5.2): the flight begins where all objects are in sight and moves
//! on until the box hides them all. The box and the place where the flight ends follow from the length of the
//! row. Cost: O(polygons).

use glam::DVec3;

use super::furniture::{self, MATERIALS};
use super::plan::corners;
use super::sculpture::{KINDS, sculpture};
use super::shapes::{Frame, Sink, block};
use super::walk::flight;
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "box-and-objects",
    meaning: "a plain box that hides a row of dense objects, which are all in sight where the flight begins; \
              after Georges 1995",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 60_000,
            min: 1_000,
            max: 8_000_000,
            meaning: "triangles, met within 5 percent",
        },
        GeneratorParam {
            name: "objects",
            default: 8,
            min: 1,
            max: 64,
            meaning: "objects in the row, which share the triangles",
        },
    ],
    make,
};

/// From the middle of an object to that of the next, m.
const APART: f64 = 1.9;
const RADIUS: f64 = 0.8;
/// The row stands at this z, the box around 0, the flight comes from +z.
const ROW: f64 = -7.0;
const BOX_HALF_DEPTH: f64 = 1.0;
const BOX_HEIGHT: f64 = 3.0;
const EYE: f64 = 1.6;
/// Triangles of an object at least.
const LEAST: u64 = 40;

/// Sizes that follow from the number of objects, m.
struct Row {
    objects: u32,
    /// Half the row's length, objects included.
    half: f64,
    /// z of the eye at the end of the flight.
    eye: f64,
    /// Half the box's width.
    cover: f64,
}

impl Row {
    fn new(objects: u64) -> Self {
        let half = (objects - 1) as f64 * 0.5 * APART + RADIUS * 1.3;
        // The whole row lies within 60 degrees, seen from there.
        let eye = (2.0 * half + ROW + 1.0).max(5.0);
        let cover = (half + 0.5) * (eye - BOX_HALF_DEPTH) / (eye - ROW - RADIUS * 1.3) + 0.5;
        Self { objects: objects as u32, half, eye, cover }
    }
    fn middle(&self, k: u32) -> DVec3 {
        DVec3::new((f64::from(k) - f64::from(self.objects - 1) * 0.5) * APART, 1.2, ROW)
    }
}

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (polygons, row) = (values.get("polygons"), Row::new(values.get("objects")));
    let each = polygons / u64::from(row.objects);
    if each < LEAST {
        let why = format!("{} objects of {each} triangles: give more polygons or fewer objects", row.objects);
        return Err(SceneError::Format { path: source.to_owned(), why });
    }
    let mut sink = Sink::keeping(MATERIALS);
    furnish(&mut sink, &row, each);
    let rest = Part { whole: progress, start: 0.3, length: 0.7 };
    let mut parts = assemble(sink.into_mesh(), "box-and-objects", source, options, Report::default(), &rest)?;
    parts.paths.push(way(&row, parts.origin));
    Ok(parts)
}

fn furnish(sink: &mut Sink, row: &Row, each: u64) {
    let (wide, deep) = (row.half.max(row.cover) + 3.0, row.eye + 3.0);
    sink.begin(|| ("floor".into(), String::new()));
    sink.paint(furniture::FLOOR);
    let ground = corners([-wide, ROW - 4.0, wide, deep]);
    sink.face(&ground.map(|[x, z]| DVec3::new(x, 0.0, z)), DVec3::Y);
    sink.begin(|| ("box".into(), String::new()));
    sink.paint(furniture::WOOD);
    let frame = Frame { origin: DVec3::ZERO, right: DVec3::X, away: DVec3::Z };
    block(sink, &frame, [-row.cover, 0.0, -BOX_HALF_DEPTH], [row.cover, BOX_HEIGHT, BOX_HALF_DEPTH]);
    for k in 0..row.objects {
        sink.begin(|| (format!("object_{k}"), "objects".into()));
        sink.paint(
            [furniture::METAL, furniture::BOOKS, furniture::LEAF, furniture::BOOKS + 2][(k % KINDS) as usize],
        );
        sculpture(sink, row.middle(k), RADIUS, k, each);
    }
}

/// Above the box with all objects in sight, down, and along behind it.
fn way(row: &Row, origin: DVec3) -> ViewPath<Solid> {
    let above = BOX_HEIGHT + 0.55 * (row.eye + BOX_HALF_DEPTH);
    let (aim, low) = (DVec3::new(0.0, 1.0, ROW), DVec3::new(0.0, EYE, ROW));
    let at = |x: f64, y: f64| DVec3::new(x * row.half, y, row.eye);
    let stops = [
        (at(0.15, above), aim),
        (at(-0.1, above), aim),
        (at(0.1, 0.6 * above + 0.4 * EYE), aim),
        (at(0.05, EYE), low),
        (at(-0.02, EYE), low),
        (at(0.02, EYE), low),
    ];
    flight(&stops, 120, 2.0 * (row.eye + row.half + above), origin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn row(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a row")).expect("a scene")
    }

    #[test]
    fn the_budget_is_met_within_five_percent() {
        for (polygons, objects) in [(60_000u32, 12), (1_000, 1), (5_000, 4), (200_000, 40)] {
            let scene = row(&format!("box-and-objects?polygons={polygons}&objects={objects}"));
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.05 * want, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            assert_eq!(touched(&scene), None);
        }
        let error = generate("box-and-objects?polygons=1000&objects=64", &LoadOptions::default(), &Quiet)
            .expect_err("too many objects");
        assert!(error.to_string().contains("fewer objects"), "{error}");
    }

    #[test]
    fn the_same_call_gives_the_same_bits() {
        // Machines must agree, so the bits are written down.
        assert_eq!(
            row("box-and-objects?polygons=2000&objects=5").hash_hex(),
            "c5e7cb542e7ae5292e4fd7dddeef40f89e070734f04dba4ec6487dd94a46df91"
        );
    }

    /// A ray from an eye to a point meets the box.
    fn behind_box(row: &Row, eye: DVec3, p: DVec3) -> bool {
        let (low, high) =
            (DVec3::new(-row.cover, 0.0, -BOX_HALF_DEPTH), DVec3::new(row.cover, BOX_HEIGHT, BOX_HALF_DEPTH));
        let (a, b) = ((low - eye) / (p - eye), (high - eye) / (p - eye));
        let (enter, leave) = (a.min(b).max_element(), a.max(b).min_element());
        enter < leave && enter > 0.0 && enter < 1.0
    }

    #[test]
    fn the_flight_begins_with_all_objects_in_sight_and_ends_with_all_hidden() {
        for objects in [1u32, 8, 24] {
            let (sizes, scene) = (
                Row::new(u64::from(objects)),
                row(&format!("box-and-objects?polygons=12000&objects={objects}")),
            );
            let views = &scene.paths()[0].views;
            let points = |view: &crate::geometry::View<Solid>| {
                let eye = view.eye.position.as_dvec3() + scene.origin();
                let hidden = |k: u32| {
                    let of_object = |p: &&crate::geometry::PrimId| {
                        scene.objects()[scene.object_of(**p).at()].name == format!("object_{k}")
                    };
                    let prims = scene.live().iter().filter(of_object);
                    let all: Vec<bool> = prims
                        .flat_map(|&p| scene.prim_points(p))
                        .map(|p| behind_box(&sizes, eye, p.as_dvec3() + scene.origin()))
                        .collect();
                    (all.iter().any(|h| *h), all.iter().all(|h| *h))
                };
                (0..objects).map(hidden).collect::<Vec<_>>()
            };
            assert!(points(&views[0]).iter().all(|(some, _)| !some), "{objects}: hidden at the start");
            for view in views[90..].iter().step_by(7) {
                assert!(points(view).iter().all(|(_, all)| *all), "{objects}: in sight at the end");
            }
        }
    }
}
