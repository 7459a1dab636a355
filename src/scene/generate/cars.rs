//! `generate:cars`: five copies of a car, most of whose triangles are inside it.
//!
//! After the five car bodies with engines of Klosowski and Silva (2000, Section 5): under the hood an engine
//! with all its parts, seats and lining behind open windows, so that no view sees more than a small part. The
//! copies are equal, and stand in staggered rows that hide each other. What the other parts leave of a car's
//! triangles goes into the body's surface, whose tessellation is fine. Cost: O(polygons).

use glam::DVec3;

use super::car::{MATERIALS, car};
use super::shapes::{Frame, Sink};
use super::walk::flight;
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values, detail_for};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "cars",
    meaning: "five copies of a car body around an engine, most of it inside; after the car model of \
              Klosowski and Silva 2000",
    params: &[GeneratorParam {
        name: "polygons",
        default: 810_000,
        min: 100_000,
        max: 8_000_000,
        meaning: "triangles, met within 2 percent",
    }],
    make,
};

/// Where the cars stand (x, z), m, and whether they look along +x or −x.
const PLACES: [(f64, f64, bool); 5] =
    [(0.0, 0.0, true), (0.6, 2.7, true), (-0.5, 5.4, false), (6.0, 1.2, false), (6.4, 4.2, true)];
/// The middle of them.
const MIDDLE: DVec3 = DVec3::new(3.0, 0.6, 2.7);

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let polygons = values.get("polygons");
    let each = polygons.saturating_sub(2) / PLACES.len() as u64;
    // The parts inside are most of a car; the body gets the rest. The paper finds 44 % of what is visible
    // with 1 % of the triangles, so that at most one in 44 of them is visible there.
    let one = Frame { origin: DVec3::ZERO, right: DVec3::X, away: DVec3::Z };
    let inner = |sink: &mut Sink, detail: u32| car(sink, &one, detail, 0, "");
    // One step below what would be more.
    let detail = detail_for(each * 19 / 20, source, progress, inner)?.max(2) - 1;
    let mut count = Sink::counting();
    inner(&mut count, detail);
    let skin = each.saturating_sub(count.triangles);
    progress.report(0.2, "building cars");
    let mut sink = Sink::keeping(MATERIALS);
    sink.begin(|| ("ground".into(), String::new()));
    sink.paint(super::car::GROUND);
    sink.face(
        &[(-9.0, -9.0), (15.0, -9.0), (15.0, 15.0), (-9.0, 15.0)].map(|(x, z)| DVec3::new(x, 0.0, z)),
        DVec3::Y,
    );
    for (k, (x, z, along)) in PLACES.into_iter().enumerate() {
        let side = if along { 1.0 } else { -1.0 };
        let frame = Frame { origin: DVec3::new(x, 0.0, z), right: DVec3::X * side, away: DVec3::Z * side };
        car(&mut sink, &frame, detail, skin, &format!("car_{k}"));
    }
    let rest = Part { whole: progress, start: 0.4, length: 0.6 };
    let mut parts = assemble(sink.into_mesh(), "cars", source, options, Report::default(), &rest)?;
    parts.paths.push(way(parts.origin));
    Ok(parts)
}

/// Once around all cars, rising and sinking, and in between them.
fn way(origin: DVec3) -> ViewPath<Solid> {
    let stops = [
        (11.5, 1.7, 2.7),
        (10.5, 2.2, 8.0),
        (6.0, 3.2, 10.5),
        (0.0, 2.6, 10.0),
        (-4.5, 1.8, 7.5),
        (-5.5, 1.6, 3.0),
        (-4.5, 1.5, -1.5),
        (0.0, 1.8, -3.8),
        (5.0, 2.5, -4.5),
        (9.5, 2.0, -2.0),
        (10.5, 1.5, 2.0),
    ];
    flight(&stops.map(|(x, y, z)| (DVec3::new(x, y, z), MIDDLE)), 200, 40.0, origin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn cars(polygons: u32) -> Scene<Solid> {
        Scene::new(
            generate(&format!("cars?polygons={polygons}"), &LoadOptions::default(), &Quiet).expect("cars"),
        )
        .expect("a scene")
    }

    #[test]
    fn any_budget_is_met_within_two_percent_and_the_copies_are_equal() {
        for polygons in [100_000u32, 810_000] {
            let scene = cars(polygons);
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.02 * want, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            let of = |k: usize| {
                scene
                    .live()
                    .iter()
                    .filter(|p| scene.objects()[scene.object_of(**p).at()].group == format!("car_{k}"))
                    .count()
            };
            assert!((1..5).all(|k| of(k) == of(0)) && of(0) * 5 + 2 == scene.prim_count());
        }
    }

    #[test]
    fn the_bits_stay_and_the_flight_touches_nothing() {
        let scene = cars(100_000);
        assert_eq!(touched(&scene), None);
        assert!(scene.paths()[0].views.iter().all(|v| v.eye.fault().is_none()));
        // Machines must agree, so the bits are written down.
        assert_eq!(scene.hash_hex(), "6e422336ae46a39cdbb3505fd714161685fddca7ed6fcec154e6668a8db4a3d9");
    }
}
