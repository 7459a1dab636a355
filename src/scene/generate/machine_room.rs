//! `generate:machine-room`: four rooms of a ship full of machines, and a torpedo behind three bulkheads.
//!
//! After the submarine that Georges (1995, Section 5.2) tested with: many large polygons that hide, and one
//! very dense object that is hidden from most of the way. The doors of the bulkheads stand so that no line
//! of sight passes two of them, so the body is hidden from all of the first two rooms and most of the third.
//! The number of triangles is met as in the building. Cost: O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;

use super::building::{WALL, build_wall, slab};
use super::furniture::Piece;
use super::machinery::{self as piece, BULKHEAD, DECK, HULL, MATERIALS, OVERHEAD, STEEL};
use super::plan::Wall;
use super::shapes::{Frame, Sink, block};
use super::walk::flight;
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values, detail_for};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "machine-room",
    meaning: "rooms full of machines, and one very dense body behind walls for most of a flight; after the \
              submarine of Georges 1995",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 300_000,
            min: 30_000,
            max: 8_000_000,
            meaning: "triangles, met within 2 percent",
        },
        GeneratorParam {
            name: "body",
            default: 0,
            min: 0,
            max: 4_000_000,
            meaning: "triangles of the hidden body, half of all at most; 0 is a third of all (100,000 of \
                      300,000)",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses sizes and colors of machines",
        },
    ],
    make,
};

/// Length of a room from bulkhead to bulkhead, m.
const BAY: f64 = 9.0;
const BAYS: u32 = 4;
/// Width of the rooms, m.
const WIDE: f64 = 16.0;
const HIGH: f64 = 5.0;
/// Middles of the doors in the bulkheads, m from the north wall.
const DOORS: [f64; 3] = [2.7, 12.7, 2.7];
/// The middle of the hidden body, and where its nose is.
const BODY: DVec3 = DVec3::new(32.5, 1.35, 8.0);
const NOSE: f64 = 3.5;

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (polygons, seed) = (values.get("polygons"), values.get("seed"));
    let body = match values.get("body") {
        0 => polygons / 3,
        given if given > polygons / 2 => {
            let why = format!("a body of {given} triangles is more than half of {polygons}");
            return Err(SceneError::Format { path: source.to_owned(), why });
        }
        given => given,
    };
    let detail =
        detail_for(polygons, source, progress, |sink, detail| furnish(sink, seed, detail, polygons, body))?;
    progress.report(0.3, "furnishing");
    let mut sink = Sink::keeping(MATERIALS);
    furnish(&mut sink, seed, detail, polygons, body);
    let rest = Part { whole: progress, start: 0.5, length: 0.5 };
    let mut parts = assemble(sink.into_mesh(), "machine-room", source, options, Report::default(), &rest)?;
    parts.paths.push(way(parts.origin));
    Ok(parts)
}

/// Where the back of a piece is turned to.
#[derive(Clone, Copy)]
enum Back {
    North,
    South,
    West,
    East,
}
use Back::{East, North, South, West};

/// A piece: name, x, z in m, its back, and how it is made.
type Stand = (&'static str, f64, f64, Back, Piece);

/// Machines in the order in which they are set up; the last of them are left off where the budget ends.
const MACHINES: &[Stand] = &[
    ("console", 2.0, 0.1, North, piece::console),
    ("console", 4.0, 0.1, North, piece::console),
    ("console", 0.1, 11.0, West, piece::console),
    ("console", 0.1, 13.0, West, piece::console),
    ("cabinet", 2.2, 10.3, South, piece::cabinet),
    ("cabinet", 3.2, 10.3, South, piece::cabinet),
    ("cabinet", 4.2, 10.3, South, piece::cabinet),
    ("cabinet", 8.9, 8.4, East, piece::cabinet),
    ("cabinet", 8.9, 9.4, East, piece::cabinet),
    ("tank", 16.9, 1.3, East, piece::tank),
    ("tank", 16.9, 4.0, East, piece::tank),
    ("tank", 16.9, 6.7, East, piece::tank),
    ("tank", 14.4, 1.3, North, piece::tank),
    ("tank", 10.3, 14.6, South, piece::tank),
    ("tank", 12.7, 14.6, South, piece::tank),
    ("pump", 10.2, 9.6, West, piece::pump),
    ("pump", 10.2, 12.2, West, piece::pump),
    ("pump", 15.0, 15.2, South, piece::pump),
    ("engine", 19.5, 3.0, West, piece::engine),
    ("engine", 21.6, 2.3, East, piece::engine),
    ("engine", 24.8, 11.2, East, piece::engine),
    ("engine", 23.0, 14.3, South, piece::engine),
    ("pump", 26.2, 14.6, East, piece::pump),
    ("tank", 32.5, 1.2, North, piece::tank),
    ("cabinet", 27.1, 9.0, West, piece::cabinet),
    ("cabinet", 27.1, 10.0, West, piece::cabinet),
    ("cabinet", 27.1, 11.0, West, piece::cabinet),
    ("bottles", 6.0, 15.9, South, piece::bottles),
    ("bottles", 8.0, 15.9, South, piece::bottles),
    ("bottles", 35.9, 3.0, East, piece::bottles),
    ("bottles", 20.0, 15.9, South, piece::bottles),
    ("wheel", 27.1, 6.0, West, piece::wheel),
    ("wheel", 27.1, 7.0, West, piece::wheel),
    ("wheel", 35.9, 7.0, East, piece::wheel),
    ("wheel", 35.9, 9.0, East, piece::wheel),
    ("wheel", 17.9, 9.0, East, piece::wheel),
    ("wheel", 8.9, 6.5, East, piece::wheel),
    ("wheel", 18.1, 9.0, West, piece::wheel),
];

/// Floor areas `[x0, z0, x1, z1]` that fill up with drums.
const STORES: [[f64; 4]; 5] = [
    [2.0, 12.4, 8.4, 14.8],
    [27.8, 12.8, 28.4, 15.6],
    [24.8, 7.6, 26.4, 8.8],
    [18.6, 14.6, 20.4, 15.2],
    [33.9, 0.6, 35.4, 1.9],
];

/// The ship, the body and the machines, then pipes, bolts and drums until the budget is met.
fn furnish(sink: &mut Sink, seed: u64, detail: u32, budget: u64, body: u64) {
    structure(sink);
    sink.begin(|| ("torpedo".into(), "torpedo".into()));
    piece::torpedo(
        sink,
        &Frame { origin: DVec3::new(BODY.x, BODY.y, NOSE), right: DVec3::X, away: DVec3::Z },
        body,
    );
    sink.begin(|| ("cradle".into(), "torpedo".into()));
    sink.paint(STEEL);
    for z in [5.5, 8.0, 10.5] {
        let at = Frame { origin: BODY.with_y(0.0).with_z(z), right: DVec3::X, away: DVec3::Z };
        block(sink, &at, [-0.7, 0.0, -0.15], [0.7, 0.84, 0.15]);
    }
    // Below 4 some parts would have too few cells.
    let detail = detail + 3;
    let rng = &mut Pcg32::new(seed, 2);
    for (k, &(name, x, z, back, draw)) in MACHINES.iter().enumerate() {
        let away = match back {
            North => -DVec3::Z,
            South => DVec3::Z,
            West => -DVec3::X,
            East => DVec3::X,
        };
        let frame = Frame { origin: DVec3::new(x, 0.0, z), right: DVec3::Y.cross(away), away };
        let (start, mut end) = (rng.clone(), rng.clone());
        let made = fit(sink, budget, |sink| {
            sink.begin(|| (format!("{name}_{k}"), format!("room_{}", (x / BAY) as u32)));
            end = start.clone();
            draw(sink, &frame, detail, &mut end);
        });
        if made {
            *rng = end;
        }
    }
    (0..12 * BAYS).for_each(|run| _ = fit(sink, budget, |sink| pipes(sink, run, detail)));
    (0..22 * DOORS.len() as u32).for_each(|k| _ = fit(sink, budget, |sink| bolted(sink, k, detail)));
    drums(sink, detail, budget, rng);
}

/// Makes a piece if it fits the budget; smaller ones that follow still may.
fn fit(sink: &mut Sink, budget: u64, mut make: impl FnMut(&mut Sink)) -> bool {
    let mut count = Sink::counting();
    make(&mut count);
    let fits = sink.triangles + count.triangles <= budget;
    if fits {
        make(sink);
    }
    fits
}

/// Rows of drums; a level on top of the other while the budget and the height allow.
fn drums(sink: &mut Sink, detail: u32, budget: u64, rng: &mut Pcg32) {
    for level in 0..3 {
        for (s, [x0, z0, x1, z1]) in STORES.iter().enumerate() {
            let (columns, rows) = (((x1 - x0) / 0.62) as u32 + 1, ((z1 - z0) / 0.62) as u32 + 1);
            for k in 0..columns * rows {
                if sink.triangles >= budget {
                    return;
                }
                let (x, z) = (x0 + 0.62 * f64::from(k % columns), z0 + 0.62 * f64::from(k / columns));
                sink.begin(|| (format!("drum_{level}_{k}"), format!("store_{s}")));
                let origin = DVec3::new(x, 0.9 * f64::from(level), z);
                piece::oil_drum(sink, &Frame { origin, right: DVec3::X, away: DVec3::Z }, detail, rng);
            }
        }
    }
}

/// The k-th run of pipe: in each room four along each of the long walls and four across, below the overhead.
fn pipes(sink: &mut Sink, run: u32, detail: u32) {
    let (bay, k) = (run % BAYS, run / BAYS);
    sink.begin(|| (format!("pipe_{k}"), format!("room_{bay}")));
    let (west, east) = (BAY * f64::from(bay) + 0.15, BAY * f64::from(bay + 1) - 0.15);
    let (row, lane) = (k / 4, f64::from(k % 4));
    let radius = 0.07 + 0.03 * f64::from(k % 3);
    let points = match row {
        0 | 1 => {
            let z = if row == 0 { 0.3 } else { WIDE - 0.3 };
            let y = 3.3 + 0.4 * lane;
            // Each comes down the wall at another place.
            let x = west + 0.6 + 0.5 * lane;
            vec![DVec3::new(x, 2.3, z), DVec3::new(x, y, z), DVec3::new(east, y, z)]
        }
        _ => {
            let x = west + 1.8 + 1.7 * lane;
            let (turn, y) = (WIDE * (0.3 + 0.15 * lane), HIGH - 0.25);
            vec![
                DVec3::new(x, y, 0.15),
                DVec3::new(x, y, turn),
                DVec3::new(x + 0.8, y, turn),
                DVec3::new(x + 0.8, y, WIDE - 0.15),
            ]
        }
    };
    piece::pipe(sink, &points, radius, k, detail);
}

/// The k-th frame with its bolts on a bulkhead.
fn bolted(sink: &mut Sink, k: u32, detail: u32) {
    let (wall, side, column) = (k / 22, (k / 11) % 2, k % 11);
    let out = DVec3::X * if side == 0 { -1.0 } else { 1.0 };
    let face = BAY * f64::from(wall + 1) + out.x * WALL * 0.5;
    let z = 0.8 + 1.44 * f64::from(column);
    // The frame before a door is left out.
    if (z - DOORS[wall as usize]).abs() < 0.85 {
        return;
    }
    sink.begin(|| (format!("frame_{side}_{column}"), format!("bulkhead_{wall}")));
    sink.paint(STEEL);
    let frame = Frame { origin: DVec3::new(face, 0.0, z), right: DVec3::Y.cross(-out), away: -out };
    block(sink, &frame, [-0.1, 0.0, -0.04], [0.1, HIGH, 0.0]);
    sink.paint(piece::BRASS);
    for row in 0..12 {
        for x in [-0.06, 0.06] {
            piece::bolt(sink, frame.at([x, 0.3 + 0.4 * f64::from(row), -0.04]), out, 0.02, detail);
        }
    }
}

fn structure(sink: &mut Sink) {
    let long = BAY * f64::from(BAYS);
    for bay in 0..BAYS {
        sink.begin(|| ("deck and overhead".into(), format!("room_{bay}")));
        slab(sink, [BAY * f64::from(bay), 0.0, BAY * f64::from(bay + 1), WIDE], [DECK, OVERHEAD], HIGH);
    }
    let hull = |along_x: bool, place: f64, to: f64| Wall { along_x, place, from: 0.0, to, opening: None };
    for (k, wall) in
        [hull(true, 0.0, long), hull(true, WIDE, long), hull(false, 0.0, WIDE), hull(false, long, WIDE)]
            .iter()
            .enumerate()
    {
        sink.begin(|| (format!("hull_{k}"), "hull".into()));
        sink.paint(HULL);
        build_wall(sink, wall, HIGH);
    }
    for (k, door) in DOORS.iter().enumerate() {
        sink.begin(|| (format!("bulkhead_{k}"), "bulkheads".into()));
        sink.paint(BULKHEAD);
        let opening = Some([door - 0.65, door + 0.65, 0.0, 2.2]);
        build_wall(
            sink,
            &Wall { along_x: false, place: BAY * f64::from(k as u32 + 1), from: 0.0, to: WIDE, opening },
            HIGH,
        );
    }
}

/// Through all doors, looking at the hidden body through the bulkheads, and then around it.
fn way(origin: DVec3) -> ViewPath<Solid> {
    let stops = [
        (1.5, 8.0),
        (4.5, 8.0),
        (6.4, 5.2),
        (8.0, 2.7),
        (10.0, 2.7),
        (12.2, 4.6),
        (13.5, 8.0),
        (15.0, 11.0),
        (17.0, 12.7),
        (19.0, 12.7),
        (21.0, 11.0),
        (22.6, 7.2),
        (24.0, 4.6),
        (26.0, 2.7),
        (28.0, 2.7),
        (29.3, 5.0),
        (29.3, 9.0),
        (29.6, 12.6),
        (32.0, 14.3),
        (34.8, 13.0),
        (34.9, 9.5),
        (34.9, 6.5),
    ];
    let stops = stops.map(|(x, z)| (DVec3::new(x, 1.6, z), BODY));
    flight(&stops, 220, 45.0, origin)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn room(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a machine room")).expect("a scene")
    }

    #[test]
    fn any_budget_is_met_within_two_percent_and_a_third_of_it_is_the_body() {
        for polygons in [30_000u32, 300_000, 630_000] {
            let scene = room(&format!("machine-room?polygons={polygons}"));
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.02 * want, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            let body = scene
                .live()
                .iter()
                .filter(|p| scene.objects()[scene.object_of(**p).at()].name == "torpedo")
                .count() as f64;
            assert!((body - want / 3.0).abs() < 0.02 * want / 3.0, "{body} of {want}");
        }
        let error = generate("machine-room?polygons=30000&body=20000", &LoadOptions::default(), &Quiet)
            .expect_err("too large a body");
        assert!(error.to_string().contains("more than half"), "{error}");
    }

    #[test]
    fn the_same_seed_gives_the_same_room_and_another_one_another() {
        let hash = |call: &str| room(call).hash_hex();
        assert_ne!(hash("machine-room?polygons=30000&seed=4"), hash("machine-room?polygons=30000&seed=5"));
        // Machines must agree, so the bits are written down.
        assert_eq!(
            hash("machine-room?polygons=30000&seed=4"),
            "b309a826f860e7d287cdf0f8ee1fbea7a3e7acd312321c846c05b948b42511c8"
        );
    }

    #[test]
    fn the_flight_touches_nothing() {
        let scene = room("machine-room?polygons=50000&body=5000&seed=3");
        assert_eq!(touched(&scene), None);
        assert!(scene.paths()[0].views.iter().all(|v| v.eye.fault().is_none()));
    }

    /// The names of the rooms' doors that a straight line can pass one after another: none.
    #[test]
    fn no_line_of_sight_passes_two_doors() {
        for pair in DOORS.windows(2) {
            // The flattest line through both openings leaves the width of the room before the next bulkhead.
            let rise = (pair[1] - pair[0]).abs() - 2.0 * 0.65;
            let reach = pair[0].max(pair[1]) - 0.65 + rise;
            assert!(reach > WIDE, "{reach}");
        }
        let names: BTreeSet<&str> = MACHINES.iter().map(|m| m.0).collect();
        assert!(names.len() >= 7, "{names:?}");
    }
}
