//! `generate:building`: a furnished floor of an office building.
//!
//! Modeled on the floors of Soda Hall that the papers of visibility culling walked through: rooms with doors
//! and windows around corridors in the shape of an 8, desks, chairs, shelves and lamps in them. The number of
//! triangles is met by refining the furniture and then leaving off the last pieces. Cost: O(polygons).

use glam::DVec3;
use rand_pcg::Pcg32;

use super::furniture::{self as piece, Piece};
use super::plan::{CORRIDOR, HEIGHT, Plan, Rect, Room, Side, Wall, corners};
use super::shapes::{Frame, Sink};
use super::stand::{Inside, Spot};
use super::walk::{EYE, Manner, figure_8};
use super::{Generator, GeneratorParam, LoadOptions, Part, Parts, Progress, SceneError, Values, detail_for};
use crate::geometry::{Solid, ViewPath};
use crate::scene::Report;
use crate::scene::assemble::assemble;

pub(super) const GENERATOR: Generator = Generator {
    name: "building",
    meaning: "a furnished floor of offices around corridors in the shape of an 8, after the Soda Hall floor \
              of the papers",
    params: &[
        GeneratorParam {
            name: "polygons",
            default: 135_000,
            min: 1_000,
            max: 8_000_000,
            meaning: "triangles, met within a few percent",
        },
        GeneratorParam {
            name: "seed",
            default: 1,
            min: 0,
            max: u32::MAX as u64,
            meaning: "chooses widths of rooms, sides of doors and furniture",
        },
        GeneratorParam {
            name: "rooms",
            default: 0,
            min: 0,
            max: 2_000,
            meaning: "rooms, at least 22; 0 chooses them by the number of polygons (62 for 135,000)",
        },
    ],
    make,
};

/// Thickness of a wall, m.
pub(super) const WALL: f64 = 0.15;

fn make(
    values: &Values,
    source: &str,
    options: &LoadOptions,
    progress: &dyn Progress,
) -> Result<Parts<Solid>, SceneError> {
    let (polygons, seed) = (values.get("polygons"), values.get("seed"));
    let rooms = match values.get("rooms") {
        // As many again as the furniture of one gets finer: both grow with the square root.
        0 => (62.0 * (polygons as f64 / 135_000.0).sqrt()) as u64,
        given => given,
    };
    let plan = Plan::new(rooms, seed);
    let detail =
        detail_for(polygons, source, progress, |sink, detail| furnish(sink, &plan, seed, detail, polygons))?;
    progress.report(0.3, "furnishing");
    let mut sink = Sink::keeping(piece::MATERIALS);
    furnish(&mut sink, &plan, seed, detail, polygons);
    let rest = Part { whole: progress, start: 0.5, length: 0.5 };
    let mut parts = assemble(sink.into_mesh(), "building", source, options, Report::default(), &rest)?;
    parts.paths.push(walk(&plan, parts.origin));
    Ok(parts)
}

/// Walls and floors first, then the furniture in rounds through all rooms until the budget is met.
fn furnish(sink: &mut Sink, plan: &Plan, seed: u64, detail: u32, budget: u64) {
    structure(sink, plan);
    for round in 0..ROUNDS.len() + 1 {
        for (k, room) in plan.rooms.iter().chain(&plan.corridors).enumerate() {
            let rng = &mut Pcg32::new(seed.wrapping_mul(1_000_003).wrapping_add(k as u64), round as u64 + 2);
            let group = || {
                if k < plan.rooms.len() {
                    format!("room_{k}")
                } else {
                    format!("corridor_{}", k - plan.rooms.len())
                }
            };
            if sink.triangles >= budget {
                return;
            }
            match (room.door, ROUNDS.get(round)) {
                (Some(door), Some(what)) => place(sink, room, door, what, detail, rng, group),
                (None, None) => corridor(sink, room, detail, rng, group),
                _ => {}
            }
        }
    }
}

/// Where a piece stands in a room.
#[derive(Clone, Copy)]
enum Place {
    /// In the doorway, on its hinge.
    Hinge,
    /// Before the window, if there is one.
    Window,
    /// Anywhere else.
    At(Spot),
}

/// The pieces of a room, in the order in which all rooms get them.
const ROUNDS: [(&str, Place, Piece); 17] = [
    ("door", Place::Hinge, piece::door),
    ("desk", Place::At(Spot::Right(0.62)), piece::desk),
    ("chair", Place::At(Spot::Right(0.62)), piece::chair),
    ("lamp", Place::At(Spot::Middle), piece::hanging_lamp),
    ("shelf", Place::At(Spot::Left(0.6)), piece::shelf),
    ("computer", Place::At(Spot::Right(0.62)), piece::computer),
    ("blind", Place::Window, piece::blind),
    ("picture", Place::At(Spot::Right(0.3)), piece::picture),
    ("plant", Place::At(Spot::Back(0.75)), piece::plant),
    ("desk lamp", Place::At(Spot::Right(0.62)), piece::desk_lamp),
    ("basket", Place::At(Spot::Right(0.36)), piece::basket),
    ("second desk", Place::At(Spot::Left(0.84)), piece::desk),
    ("second chair", Place::At(Spot::Left(0.84)), piece::chair),
    ("second computer", Place::At(Spot::Left(0.84)), piece::computer),
    ("second shelf", Place::At(Spot::Left(0.33)), piece::shelf),
    ("second plant", Place::At(Spot::Back(-0.8)), piece::plant),
    ("second lamp", Place::At(Spot::Left(0.84)), piece::desk_lamp),
];

fn place(
    sink: &mut Sink,
    room: &Room,
    (side, door_at): (Side, f64),
    (name, spot, draw): &(&str, Place, Piece),
    detail: u32,
    rng: &mut Pcg32,
    group: impl FnOnce() -> String,
) {
    let Some(frame) = stand(room, side, door_at, *spot) else { return };
    sink.begin(|| ((*name).to_owned(), group()));
    draw(sink, &frame, detail, rng);
}

/// The frame of a place: its back (local +z) to the wall. `None` where the room has no such place.
fn stand(room: &Room, door: Side, door_at: f64, place: Place) -> Option<Frame> {
    let [x0, z0, x1, z1] = room.rect;
    let outward = |side: Side| match side {
        Side::North => -DVec3::Z,
        Side::South => DVec3::Z,
        Side::West => -DVec3::X,
        Side::East => DVec3::X,
    };
    let into = -outward(door);
    let extent = |axis: DVec3| (axis.x.abs() * (x1 - x0) + axis.z.abs() * (z1 - z0)) * 0.5;
    let right = into.cross(DVec3::Y);
    let middle = DVec3::new((x0 + x1) * 0.5, 0.0, (z0 + z1) * 0.5);
    let inside =
        Inside { middle, into, right, deep: extent(into), wide: extent(right), plaster: WALL * 0.5 + 0.01 };
    Some(match place {
        Place::At(spot) => inside.frame(spot),
        Place::Window => {
            let outside = outward(room.window?);
            inside.against(outside, extent(outside), DVec3::ZERO)
        }
        Place::Hinge => {
            let along = if matches!(door, Side::North | Side::South) { DVec3::X } else { DVec3::Z };
            let offset = along * (door_at + 0.475 - (middle * along).element_sum());
            Frame {
                origin: middle - into * (inside.deep - inside.plaster) + offset,
                right: along,
                away: into,
            }
        }
    })
}

/// Lamps, benches, plants and pictures along a stretch of corridor; the middle stays free.
fn corridor(sink: &mut Sink, stretch: &Room, detail: u32, rng: &mut Pcg32, group: impl Fn() -> String) {
    let [x0, z0, x1, z1] = stretch.rect;
    let along_x = x1 - x0 > z1 - z0;
    let (length, ahead) = if along_x { (x1 - x0, DVec3::X) } else { (z1 - z0, DVec3::Z) };
    let start = DVec3::new(
        if along_x { x0 } else { (x0 + x1) * 0.5 },
        0.0,
        if along_x { (z0 + z1) * 0.5 } else { z0 },
    );
    let side = ahead.cross(DVec3::Y);
    let lamps = (length / 4.0).ceil();
    for k in 0..lamps as u32 {
        sink.begin(|| (format!("lamp_{k}"), group()));
        let origin = start + ahead * (length * (f64::from(k) + 0.5) / lamps);
        piece::hanging_lamp(sink, &Frame { origin, right: ahead, away: side }, detail, rng);
    }
    // The aisles have blank walls to stand against; the lanes are lined with doors.
    if along_x {
        return;
    }
    let wall = Frame {
        origin: start + side * (CORRIDOR * 0.5 - WALL * 0.5 - 0.01),
        right: DVec3::Y.cross(side),
        away: side,
    };
    let spots: [(&str, Piece, f64); 4] = [
        ("bench", piece::bench, 0.3),
        ("picture", piece::picture, 0.3),
        ("plant", piece::plant, 0.5),
        ("bench", piece::bench, 0.7),
    ];
    for (name, draw, t) in spots {
        sink.begin(|| (name.to_owned(), group()));
        draw(sink, &Frame { origin: wall.origin + ahead * (length * t), ..wall }, detail, rng);
    }
}

fn structure(sink: &mut Sink, plan: &Plan) {
    for (k, room) in plan.rooms.iter().chain(&plan.corridors).enumerate() {
        let name = if k < plan.rooms.len() { "room" } else { "corridor" };
        let number = if k < plan.rooms.len() { k } else { k - plan.rooms.len() };
        sink.begin(|| ("floor and ceiling".into(), format!("{name}_{number}")));
        slab(sink, room.rect, [piece::FLOOR, piece::CEILING], HEIGHT);
    }
    for (k, wall) in plan.walls.iter().enumerate() {
        sink.begin(|| (format!("wall_{k}"), "walls".into()));
        sink.paint(piece::WALL);
        build_wall(sink, wall, HEIGHT);
    }
}

/// Floor and ceiling of a rectangle, of two materials.
pub(super) fn slab(sink: &mut Sink, rect: Rect, [floor, ceiling]: [u32; 2], height: f64) {
    for (material, y, outward) in [(floor, 0.0, DVec3::Y), (ceiling, height, -DVec3::Y)] {
        sink.paint(material);
        sink.face(&corners(rect).map(|[x, z]| DVec3::new(x, y, z)), outward);
    }
}

/// Both faces of a wall around its opening, and the reveal.
pub(super) fn build_wall(sink: &mut Sink, wall: &Wall, height: f64) {
    let point = |along: f64, y: f64, across: f64| {
        let (a, b) = (along, wall.place + across);
        if wall.along_x { DVec3::new(a, y, b) } else { DVec3::new(b, y, a) }
    };
    let normal = if wall.along_x { DVec3::Z } else { DVec3::X };
    let ahead = if wall.along_x { DVec3::X } else { DVec3::Z };
    let mut panes = Vec::with_capacity(4);
    match wall.opening {
        None => panes.push([wall.from, wall.to, 0.0, height]),
        Some([from, to, bottom, top]) => {
            panes.extend([
                [wall.from, from, 0.0, height],
                [from, to, top, height],
                [to, wall.to, 0.0, height],
            ]);
            if bottom > 0.0 {
                panes.push([from, to, 0.0, bottom]);
            }
        }
    }
    let half = WALL * 0.5;
    for [from, to, bottom, top] in panes {
        for across in [-half, half] {
            let corners = [
                point(from, bottom, across),
                point(to, bottom, across),
                point(to, top, across),
                point(from, top, across),
            ];
            sink.face(&corners, normal * across);
        }
    }
    let Some([from, to, bottom, top]) = wall.opening else { return };
    let mut reveal = |a: (f64, f64), b: (f64, f64), outward: DVec3| {
        sink.face(
            &[point(a.0, a.1, -half), point(b.0, b.1, -half), point(b.0, b.1, half), point(a.0, a.1, half)],
            outward,
        );
    };
    reveal((from, bottom), (from, top), ahead);
    reveal((to, bottom), (to, top), -ahead);
    reveal((from, top), (to, top), -DVec3::Y);
    if bottom > 0.0 {
        reveal((from, bottom), (to, bottom), DVec3::Y);
    }
}

/// Along the middles of the corridors in the shape of an 8, once, corners rounded.
fn walk(plan: &Plan, origin: DVec3) -> ViewPath<Solid> {
    let ([west, middle, east], [north, south]) = (plan.aisles(), plan.lanes());
    let stops = [
        (middle, north),
        (west, north),
        (west, south),
        (middle, south),
        (middle, north),
        (east, north),
        (east, south),
        (middle, south),
    ];
    let stops = stops.map(|(x, z)| DVec3::new(x, EYE, z));
    let far = (plan.size[0] * plan.size[0] + plan.size[1] * plan.size[1]).sqrt();
    figure_8(&stops, &Manner { round: 1.0, ahead: 1.5, far }, origin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::generate;
    use crate::scene::generate::walk::touched;
    use crate::scene::{Quiet, Scene};

    fn building(call: &str) -> Scene<Solid> {
        Scene::new(generate(call, &LoadOptions::default(), &Quiet).expect("a building")).expect("a scene")
    }

    #[test]
    fn any_budget_is_met_within_two_percent() {
        for polygons in [1_000u32, 2_000, 5_000, 20_000, 60_000, 135_000] {
            let scene = building(&format!("building?polygons={polygons}"));
            let (got, want) = (scene.prim_count() as f64, f64::from(polygons));
            assert!((got - want).abs() < 0.02 * want + 100.0, "{got} instead of {want}");
            assert_eq!(scene.report().dropped_total(), 0, "{:?}", scene.report());
            assert!(scene.paths()[0].views.iter().all(|v| v.eye.fault().is_none()));
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_building_and_another_one_another() {
        let hash = |call: &str| building(call).hash_hex();
        assert_eq!(hash("building?polygons=3000&seed=4"), hash("building?seed=4&polygons=3000"));
        assert_ne!(hash("building?polygons=3000&seed=4"), hash("building?polygons=3000&seed=5"));
        // Machines must agree, so the bits are written down.
        assert_eq!(
            hash("building?polygons=3000&seed=4"),
            "c63f824e01f626c1a6fd857ae65e9ddae7e8c1a677fbefb97cba2cf91a1bb38e"
        );
    }

    #[test]
    fn the_walk_touches_nothing() {
        for seed in [1, 2, 3] {
            let scene = building(&format!("building?polygons=20000&seed={seed}"));
            assert_eq!(touched(&scene), None, "seed {seed}");
        }
    }
}
