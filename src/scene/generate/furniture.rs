//! What stands in the rooms of the building. One function a piece; the same piece at any detail.

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::plan::{HEIGHT, signed};
use super::shapes::{Frame, Sink, ball, block, circle, rounded, tube};

/// Materials of the building, in the order of their numbers.
pub(super) const MATERIALS: &[(&str, [f32; 3])] = &[
    ("wall", [0.80, 0.78, 0.72]),
    ("floor", [0.35, 0.36, 0.38]),
    ("ceiling", [0.90, 0.90, 0.88]),
    ("wood", [0.55, 0.36, 0.20]),
    ("metal", [0.45, 0.47, 0.50]),
    ("fabric", [0.15, 0.25, 0.45]),
    ("screen", [0.05, 0.06, 0.08]),
    ("lamp", [0.98, 0.93, 0.75]),
    ("leaf", [0.16, 0.42, 0.14]),
    ("pot", [0.62, 0.30, 0.20]),
    ("book red", [0.60, 0.14, 0.12]),
    ("book green", [0.14, 0.38, 0.26]),
    ("book blue", [0.16, 0.22, 0.52]),
    ("blind", [0.86, 0.84, 0.78]),
    ("paper", [0.93, 0.92, 0.86]),
];
pub(super) const WALL: u32 = 0;
pub(super) const FLOOR: u32 = 1;
pub(super) const CEILING: u32 = 2;
pub(super) const WOOD: u32 = 3;
pub(super) const METAL: u32 = 4;
pub(super) const FABRIC: u32 = 5;
pub(super) const SCREEN: u32 = 6;
pub(super) const LAMP: u32 = 7;
pub(super) const LEAF: u32 = 8;
const POT: u32 = 9;
pub(super) const BOOKS: u32 = 10;
pub(super) const BLIND: u32 = 13;
pub(super) const PAPER: u32 = 14;

/// Top of a desk, m.
const DESK: f64 = 0.74;

/// What draws a piece at the origin of its frame, its back to local +z.
pub(super) type Piece = fn(&mut Sink, &Frame, u32, &mut Pcg32);

/// The leaf of a door that stands open at a right angle: hinge at the origin, along local +z.
pub(super) fn door(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(WOOD);
    block(sink, frame, [0.0, 0.0, 0.0], [0.04, 2.08, 0.93]);
    sink.paint(METAL);
    for x in [-0.05, 0.09] {
        ball(sink, &frame.moved([x, 1.0, 0.86]), [0.035; 3], 4 * detail, 2 * detail);
    }
}

/// A desk 1.6 m wide and 0.8 m deep with drawers.
pub(super) fn desk(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(WOOD);
    block(sink, frame, [-0.8, DESK - 0.03, -0.8], [0.8, DESK, 0.0]);
    block(sink, frame, [-0.78, 0.08, -0.04], [0.78, DESK - 0.03, -0.02]);
    for drawer in 0..3 {
        let low = 0.08 + 0.21 * f64::from(drawer);
        block(sink, frame, [0.35, low, -0.75], [0.75, low + 0.19, -0.06]);
    }
    sink.paint(METAL);
    for drawer in 0..3 {
        let grip = frame.moved([0.55, 0.18 + 0.21 * f64::from(drawer), -0.77]);
        ball(sink, &grip, [0.06, 0.012, 0.02], 4 * detail, 2 * detail);
    }
    for (x, z) in [(-0.74, -0.74), (-0.74, -0.1), (0.3, -0.74), (0.3, -0.1)] {
        tube(sink, &frame.moved([x, 0.0, z]), DESK - 0.03, [0.025, 0.025], 4 * detail, detail);
    }
}

/// A swivel chair in front of a desk.
pub(super) fn chair(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let at = frame.moved([0.12 * signed(rng), 0.0, -1.05 + 0.1 * signed(rng)]);
    sink.paint(FABRIC);
    rounded(sink, &at, [-0.24, 0.42, -0.24], [0.24, 0.52, 0.24], 2 * detail, 0.45);
    rounded(sink, &at, [-0.22, 0.6, -0.3], [0.22, 1.05, -0.22], 2 * detail, 0.45);
    sink.paint(METAL);
    tube(sink, &at.moved([0.0, 0.08, 0.0]), 0.36, [0.03, 0.03], 4 * detail, detail);
    block(sink, &at, [-0.03, 0.45, -0.28], [0.03, 0.7, -0.24]);
    for leg in 0..5 {
        let (c, s) = circle(leg, 5);
        let foot = at.moved([0.26 * c, 0.03, 0.26 * s]);
        ball(sink, &foot, [0.03; 3], 4 * detail, 2 * detail);
        let arm = Frame { right: at.right * c + at.away * s, away: at.away * c - at.right * s, ..at };
        block(sink, &arm, [0.0, 0.05, -0.02], [0.26, 0.09, 0.02]);
    }
}

/// A monitor and a keyboard with its keys, on a desk.
pub(super) fn computer(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let at = frame.moved([-0.3 + 0.1 * signed(rng), DESK, -0.25]);
    sink.paint(SCREEN);
    rounded(sink, &at, [-0.28, 0.12, -0.03], [0.28, 0.46, 0.03], detail, 0.0);
    sink.paint(METAL);
    tube(sink, &at, 0.14, [0.1, 0.03], 4 * detail, detail);
    block(sink, &at, [-0.22, 0.0, -0.42], [0.22, 0.015, -0.26]);
    sink.paint(PAPER);
    let (columns, rows) = (4 * detail.min(5), 2 * detail.min(3));
    for i in 0..columns {
        for j in 0..rows {
            let (w, d) = (0.42 / f64::from(columns), 0.14 / f64::from(rows));
            let (x, z) = (-0.21 + w * f64::from(i), -0.41 + d * f64::from(j));
            block(sink, &at, [x + 0.1 * w, 0.015, z + 0.1 * d], [x + 0.9 * w, 0.025, z + 0.9 * d]);
        }
    }
}

/// A lamp that hangs from the ceiling.
pub(super) fn hanging_lamp(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(METAL);
    tube(sink, &frame.moved([0.0, HEIGHT - 0.4, 0.0]), 0.4, [0.008, 0.008], 4, 1);
    sink.paint(LAMP);
    ball(sink, &frame.moved([0.0, HEIGHT - 0.52, 0.0]), [0.2, 0.13, 0.2], 8 * detail, 4 * detail);
}

/// A lamp on a desk.
pub(super) fn desk_lamp(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    let at = frame.moved([0.62, DESK, -0.2]);
    sink.paint(METAL);
    tube(sink, &at, 0.02, [0.09, 0.09], 6 * detail, 1);
    tube(sink, &at, 0.4, [0.01, 0.01], 4 * detail, detail);
    sink.paint(LAMP);
    tube(sink, &at.moved([0.0, 0.34, 0.0]), 0.14, [0.11, 0.06], 8 * detail, 2 * detail);
}

/// A shelf 1.2 m wide with books.
pub(super) fn shelf(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    sink.paint(WOOD);
    for x in [-0.6, 0.57] {
        block(sink, frame, [x, 0.0, -0.3], [x + 0.03, 2.0, 0.0]);
    }
    block(sink, frame, [-0.57, 0.0, -0.015], [0.57, 2.0, 0.0]);
    let boards = 5;
    for board in 0..=boards {
        let y = f64::from(board) * 1.98 / f64::from(boards);
        block(sink, frame, [-0.57, y, -0.3], [0.57, y + 0.02, -0.015]);
        if board == boards {
            break;
        }
        let count = 4 + 3 * detail.min(8);
        let mut x = -0.56;
        for _ in 0..count {
            let width = 1.1 / f64::from(count) * (0.75 + 0.2 * signed(rng));
            let (tall, deep) = (0.27 + 0.06 * signed(rng), 0.2 + 0.05 * signed(rng));
            sink.paint(BOOKS + rng.next_u32() % 3);
            rounded(
                sink,
                frame,
                [x, y + 0.02, -0.02 - deep],
                [x + width, y + 0.02 + tall, -0.02],
                detail.div_ceil(4),
                0.0,
            );
            x += 1.1 / f64::from(count);
        }
        sink.paint(WOOD);
    }
}

/// A plant in a pot.
pub(super) fn plant(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let at = frame.moved([0.0, 0.0, -0.25]);
    sink.paint(POT);
    tube(sink, &at, 0.32, [0.12, 0.18], 6 * detail, detail);
    sink.paint(LEAF);
    for leaf in 0..8 * detail {
        let (c, s) = circle(leaf * 13 % (8 * detail), 8 * detail);
        let reach = 0.2 + 0.08 * signed(rng);
        let high = 0.75 + 0.35 * signed(rng);
        let point = |r: f64, y: f64, side: f64| at.at([r * c - side * s, y, r * s + side * c]);
        let corners = [
            point(0.03, 0.34, 0.0),
            point(reach * 0.6, high * 0.8, 0.05),
            point(reach, high, 0.0),
            point(reach * 0.6, high * 0.8, -0.05),
        ];
        let outward = DVec3::Y;
        sink.face(&[corners[0], corners[1], corners[2]], outward);
        sink.face(&[corners[0], corners[2], corners[3]], outward);
    }
}

/// The slats of a blind 2.4 m wide before a window.
pub(super) fn blind(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    sink.paint(BLIND);
    let slats = 6 * detail;
    let drawn = 0.55 + 0.35 * signed(rng);
    for k in 0..slats {
        let y = 2.28 - 1.3 * drawn * f64::from(k) / f64::from(slats);
        block(sink, frame, [-1.2, y, -0.12], [1.2, y + 0.004, -0.09]);
    }
}

/// A picture on a wall.
pub(super) fn picture(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let (w, h) = (0.4 + 0.15 * signed(rng), 0.3 + 0.1 * signed(rng));
    sink.paint(WOOD);
    block(sink, frame, [-w, 1.5 - h, -0.03], [w, 1.5 + h, -0.001]);
    sink.paint(BOOKS + rng.next_u32() % 3);
    rounded(sink, frame, [-w * 0.9, 1.5 - h * 0.9, -0.035], [w * 0.9, 1.5 + h * 0.9, -0.03], detail, 0.0);
}

/// A waste paper basket.
pub(super) fn basket(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let at = frame.moved([0.0, 0.0, -0.2]);
    sink.paint(METAL);
    tube(sink, &at, 0.35, [0.12, 0.16], 6 * detail, 2 * detail);
    sink.paint(PAPER);
    ball(sink, &at.moved([0.03 * signed(rng), 0.37, 0.0]), [0.06, 0.05, 0.06], 4 * detail, 2 * detail);
}

/// A cushioned bench along a wall, 0.4 m deep.
pub(super) fn bench(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(FABRIC);
    rounded(sink, frame, [-0.7, 0.38, -0.4], [0.7, 0.48, -0.02], 2 * detail, 0.15);
    sink.paint(METAL);
    for x in [-0.6, 0.6] {
        for z in [-0.34, -0.08] {
            tube(sink, &frame.moved([x, 0.0, z]), 0.39, [0.02, 0.02], 4 * detail, detail);
        }
    }
}
