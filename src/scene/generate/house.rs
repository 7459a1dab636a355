//! The houses of the city: walls, roofs, floors, and the windows and doors on the walls.
//!
//! A wall is one polygon from the ground to the eaves. Where a lower house joins, the wall's corner at that
//! height is a corner of both, so that walls that meet share whole edges; a wall between two houses shows
//! only above the lower one. What lies between them below is a wall of its own, drawn back from the street.

use glam::DVec3;

use super::blocks::{CURB, House, Neighbor, RISE, Roof, STOREY};
use super::plan::{HEIGHT, corners};
use super::shapes::{Frame, Sink};
use super::{furniture, paint};

/// How far a wall inside stays away from the walls outside, m.
const DRAWN_BACK: f64 = 0.06;
/// Mean width of the wall that a window gets, m.
const BAY: f64 = 2.7;

/// Walls, roof and floors.
pub(super) fn shell(sink: &mut Sink, house: &House, group: &impl Fn() -> String) {
    sink.begin(|| ("walls".into(), group()));
    sink.paint(paint::FACADE + house.paint % paint::FACADES);
    for side in 0..4 {
        wall(sink, house, side);
    }
    sink.begin(|| ("roof".into(), group()));
    roof(sink, house);
    let middle = house.ground.iter().sum::<DVec3>() * 0.25;
    let corners = house.ground.map(|c| c + (middle - c).normalize() * DRAWN_BACK);
    for storey in 0..house.storeys {
        sink.begin(|| (format!("floor_{storey}"), group()));
        let low = CURB + STOREY * f64::from(storey);
        for (material, y, outward) in
            [(furniture::FLOOR, low + 0.01, DVec3::Y), (furniture::CEILING, low + HEIGHT + 0.01, -DVec3::Y)]
        {
            // The ground floor lies on the pavement's slab.
            if storey > 0 || outward.y < 0.0 {
                sink.paint(material);
                sink.face(&corners.map(|c| c.with_y(y)), outward);
            }
        }
    }
}

/// The two lower corners of a side, and its outward direction.
fn side_of(house: &House, side: usize) -> (DVec3, DVec3, DVec3) {
    let (a, b) = (house.ground[side], house.ground[(side + 1) % 4]);
    (a, b, DVec3::Y.cross(b - a).normalize())
}

fn wall(sink: &mut Sink, house: &House, side: usize) {
    let (a, b, outward) = side_of(house, side);
    let top = house.eaves();
    let bottom = house.joined[side].map_or(CURB, |n| n.eaves);
    if let Some(neighbor) = house.joined[side].filter(|_| side == house.ends[1]) {
        let (inset, high) = ((b - a).normalize() * DRAWN_BACK, top.min(neighbor.eaves) - DRAWN_BACK);
        let (a, b) = (a + inset, b - inset);
        sink.face(&[a.with_y(CURB), b.with_y(CURB), b.with_y(high), a.with_y(high)], outward);
    }
    if bottom >= top {
        return;
    }
    // Clockwise sides seen from above: b is on the left seen from outside.
    let between = |n: Option<Neighbor>| n.map(|n| n.eaves).filter(|y| *y > bottom && *y < top);
    let (at_a, at_b) = (between(house.joined[(side + 3) % 4]), between(house.joined[(side + 1) % 4]));
    let mut ring = Vec::with_capacity(6);
    // A fan from a corner within a straight edge, if there is one, leaves no triangle without area.
    ring.extend(at_a.map(|y| a.with_y(y)));
    ring.extend([a.with_y(top), b.with_y(top)]);
    ring.extend(at_b.map(|y| b.with_y(y)));
    ring.extend([b.with_y(bottom), a.with_y(bottom)]);
    if at_a.is_none() && at_b.is_some() {
        ring.rotate_left(2);
    }
    sink.fan(&mut ring, outward);
}

fn roof(sink: &mut Sink, house: &House) {
    let eaves = house.eaves();
    let c = house.ground.map(|c| c.with_y(eaves));
    let middle = (c[0] + c[1] + c[2] + c[3]) * 0.25;
    let tile = paint::ROOF + (house.paint >> 8) % paint::ROOFS;
    match house.roof {
        Roof::Flat => {
            sink.paint(paint::FLAT_ROOF);
            sink.face(&c, DVec3::Y);
        }
        Roof::Tent => {
            sink.paint(tile);
            let tip = middle + DVec3::Y * RISE;
            (0..4).for_each(|k| sink.face(&[c[k], c[(k + 1) % 4], tip], DVec3::Y));
        }
        Roof::Gabled => {
            sink.paint(tile);
            let ridge = |side: usize| (c[side] + c[(side + 1) % 4]) * 0.5 + DVec3::Y * RISE;
            for (from, to) in [house.ends, [house.ends[1], house.ends[0]]].map(|[a, b]| (a, b)) {
                let (low, next) = (c[(from + 1) % 4], c[(from + 2) % 4]);
                sink.face(&[low, next, ridge(to)], DVec3::Y);
                sink.face(&[low, ridge(to), ridge(from)], DVec3::Y);
            }
            sink.paint(paint::FACADE + house.paint % paint::FACADES);
            for side in house.ends {
                let hidden =
                    |n: Neighbor| n.eaves > eaves + RISE || (n.eaves >= eaves && n.roof == Roof::Gabled);
                if !house.joined[side].is_some_and(hidden) {
                    sink.face(&[c[side], c[(side + 1) % 4], ridge(side)], side_of(house, side).2);
                }
            }
        }
    }
}

/// Where a window or door sits on a side: its frame looks out of the wall along −z.
fn bays(house: &House, side: usize) -> (u32, impl Fn(u32) -> Frame) {
    let (a, b, outward) = side_of(house, side);
    let count = (a.distance(b) / BAY).floor().max(1.0) as u32;
    let right = (b - a).normalize();
    let at = move |k: u32| Frame {
        origin: a.lerp(b, (f64::from(k) + 0.5) / f64::from(count)),
        right,
        away: -outward,
    };
    (count, at)
}

/// A quad parallel to the wall: from, to, bottom, top, and how far before it.
fn sheet(sink: &mut Sink, frame: &Frame, [x0, x1, y0, y1]: [f64; 4], before: f64) {
    sink.face(&corners([x0, y0, x1, y1]).map(|[x, y]| frame.at([x, y, -before])), -frame.away);
}

/// The windows of a storey on one side, and the house's door. None where there is a neighbor.
pub(super) fn windows(
    sink: &mut Sink,
    house: &House,
    side: usize,
    storey: u32,
    detail: u32,
    group: &impl Fn() -> String,
) {
    if house.joined[side].is_some() {
        return;
    }
    sink.begin(|| (format!("windows_{storey}_{}", ["north", "east", "south", "west"][side]), group()));
    let (count, at) = bays(house, side);
    let rows = detail.min(4);
    for k in 0..count {
        let frame = at(k).moved([0.0, CURB + STOREY * f64::from(storey), 0.0]);
        if storey == 0 && k == house.paint / 7 % count && house.street[side] {
            sink.paint(paint::DOOR + house.paint / 5 % paint::DOORS);
            sheet(sink, &frame, [-0.55, 0.55, 0.0, 2.3], 0.03);
            sink.paint(paint::GLASS);
            sheet(sink, &frame, [-0.4, 0.4, 1.7, 2.1], 0.05);
            continue;
        }
        sink.paint(paint::FRAME);
        sheet(sink, &frame, [-0.7, 0.7, 0.8, 2.5], 0.03);
        sink.paint(paint::GLASS);
        for column in 0..2 {
            for row in 0..rows {
                let (x, high) = (-0.58 + 0.61 * f64::from(column), 1.46 / f64::from(rows));
                let y = 0.92 + high * f64::from(row);
                sheet(
                    sink,
                    &frame,
                    [x, x + 0.55, y, y + high - if row + 1 < rows { 0.05 } else { 0.0 }],
                    0.05,
                );
            }
        }
    }
}
