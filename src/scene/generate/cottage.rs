//! A wooden house with a tiled roof, windows with shutters and a porch: many small parts of one house.
//!
//! It stands around the origin of its frame, its front to local −z.

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::shapes::{Frame, Sink, ball, block, parts, tube};

/// Materials of the house, in the order of their numbers.
pub(super) const MATERIALS: &[(&str, [f32; 3])] = &[
    ("boards", [0.78, 0.66, 0.42]),
    ("trim", [0.90, 0.88, 0.82]),
    ("pane", [0.09, 0.13, 0.18]),
    ("shutter", [0.12, 0.30, 0.36]),
    ("brick", [0.45, 0.19, 0.13]),
    ("stone", [0.46, 0.45, 0.43]),
    ("tile red", [0.56, 0.17, 0.10]),
    ("tile rust", [0.48, 0.19, 0.11]),
    ("tile brown", [0.40, 0.16, 0.10]),
];
const BOARDS: u32 = 0;
const TRIM: u32 = 1;
const PANE: u32 = 2;
const SHUTTER: u32 = 3;
const BRICK: u32 = 4;
const STONE: u32 = 5;
const TILES: u32 = 6;
/// Colors of tiles.
const KINDS_OF_TILES: u32 = 3;

/// Half the width and half the depth, m.
pub(super) const HALF: [f64; 2] = [5.5, 4.0];
const EAVES: f64 = 3.5;
/// Height of the ridge, m.
pub(super) const RIDGE: f64 = 7.2;
/// How far the roof reaches out, m.
const OVERHANG: f64 = 0.5;
/// How far a board or tile stands out at its lower edge, m.
const LIP: f64 = 0.035;
/// Objects of the house are in this group.
pub(super) const GROUP: &str = "house";

/// The house; its parts are objects of the group [`GROUP`].
pub(super) fn cottage(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let part = |sink: &mut Sink, name: &str| sink.begin(|| (name.to_owned(), GROUP.into()));
    walls(sink, frame, detail, &part);
    for (side, name) in [(-1.0, "front roof"), (1.0, "back roof")] {
        part(sink, name);
        roof(sink, frame, side, detail, rng);
    }
    part(sink, "ridge");
    sink.paint(TILES);
    let caps = parts(22, detail);
    let wide = 2.0 * (HALF[0] + OVERHANG) / f64::from(caps);
    for k in 0..caps {
        let x = -HALF[0] - OVERHANG + wide * f64::from(k);
        block(sink, frame, [x, RIDGE - 0.06, -0.14], [x + 0.96 * wide, RIDGE + 0.1, 0.14]);
    }
    part(sink, "chimney");
    chimney(sink, &frame.moved([2.6, 0.0, 1.2]), detail);
    for (k, x) in [-4.0, -1.5, 3.9].into_iter().enumerate() {
        part(sink, &format!("front window {k}"));
        window(sink, &frame.moved([x, 1.0, -HALF[1]]), [0.55, 1.4], detail);
    }
    part(sink, "door");
    door(sink, &frame.moved([1.4, 0.0, -HALF[1]]), detail);
    part(sink, "porch");
    porch(sink, &frame.moved([1.4, 0.0, -HALF[1]]), detail);
    let turned = |right: DVec3, away: DVec3| Frame { right, away, ..*frame };
    let back = turned(-frame.right, -frame.away);
    for (k, x) in [-3.4, 0.0, 3.4].into_iter().enumerate() {
        part(sink, &format!("back window {k}"));
        window(sink, &back.moved([x, 1.0, -HALF[1]]), [0.55, 1.4], detail);
    }
    let (left, right) = (turned(-frame.away, frame.right), turned(frame.away, -frame.right));
    for (name, side) in [("left", left), ("right", right)] {
        part(sink, &format!("{name} window"));
        window(sink, &side.moved([-1.2, 1.0, -HALF[0]]), [0.55, 1.4], detail);
        part(sink, &format!("{name} attic window"));
        window(sink, &side.moved([0.0, 4.2, -HALF[0]]), [0.4, 0.9], detail);
    }
}

/// The half of a gable's width at a height, m; that of the wall below the eaves.
fn gable(y: f64) -> f64 {
    HALF[1] * ((RIDGE - y) / (RIDGE - EAVES)).clamp(0.0, 1.0)
}

/// Boards, each standing out over the one below; gables reach up to the ridge.
fn walls(sink: &mut Sink, frame: &Frame, detail: u32, part: &impl Fn(&mut Sink, &str)) {
    let (rows, columns) = (parts(12, detail), parts(4, detail));
    let sides = [
        ("front wall", frame.right, frame.away, false),
        ("right wall", frame.away, -frame.right, true),
        ("back wall", -frame.right, -frame.away, false),
        ("left wall", -frame.away, frame.right, true),
    ];
    for (name, right, away, gabled) in sides {
        part(sink, name);
        sink.paint(BOARDS);
        let side = Frame { right, away, ..*frame };
        let [half, out] = if gabled { [HALF[1], HALF[0]] } else { HALF };
        let top = if gabled { RIDGE } else { EAVES };
        let rows = if gabled { 2 * rows } else { rows };
        for row in 0..rows {
            let [low, high] = [row, row + 1].map(|k| top * f64::from(k) / f64::from(rows));
            let [wide, narrow] = [low, high].map(|y| if gabled { gable(y) } else { half });
            for k in 0..columns {
                let at = |k: u32, half: f64| half * (2.0 * f64::from(k) / f64::from(columns) - 1.0);
                let [a, b] = [at(k, wide), at(k + 1, wide)];
                let mut board = vec![
                    side.at([a, low, -out - LIP]),
                    side.at([b, low, -out - LIP]),
                    side.at([at(k + 1, narrow), high, -out]),
                ];
                if narrow > 0.0 {
                    board.push(side.at([at(k, narrow), high, -out]));
                }
                sink.face(&board, -away);
                let below = [[a, -out], [b, -out], [b, -out - LIP], [a, -out - LIP]];
                sink.face(&below.map(|[x, z]| side.at([x, low, z])), -DVec3::Y);
            }
        }
    }
}

/// One slope of the roof in tiles, and its plain lower side; `side` is −1 in front, 1 behind.
fn roof(sink: &mut Sink, frame: &Frame, side: f64, detail: u32, rng: &mut Pcg32) {
    let slope = (RIDGE - EAVES) / HALF[1];
    let (rows, columns) = (parts(14, detail), parts(32, detail));
    let long = HALF[1] + OVERHANG;
    let (half, up) = (HALF[0] + OVERHANG, 0.05);
    // A point of the roof by how far it lies from the ridge.
    let at = |x: f64, away: f64, over: f64| frame.at([x, RIDGE - slope * away + over, side * away]);
    let outward = DVec3::Y + frame.away * (side * slope);
    for row in 0..rows {
        let [low, high] = [row, row + 1].map(|k| long * (1.0 - f64::from(k) / f64::from(rows)));
        for k in 0..columns {
            let [a, b] = [k, k + 1].map(|k| half * (2.0 * f64::from(k) / f64::from(columns) - 1.0));
            sink.paint(TILES + rng.next_u32() % KINDS_OF_TILES);
            let lifted = up + LIP;
            let tile = [at(a, low, lifted), at(b, low, lifted), at(b, high, up), at(a, high, up)];
            sink.face(&tile, outward);
            let lip = [at(a, low, up), at(b, low, up), at(b, low, lifted), at(a, low, lifted)];
            sink.face(&lip, frame.away * side - DVec3::Y);
        }
    }
    sink.paint(TRIM);
    sink.face(
        &[at(-half, long, 0.0), at(half, long, 0.0), at(half, 0.0, 0.0), at(-half, 0.0, 0.0)],
        -outward,
    );
    // What closes the roof at its rims.
    let rim = |a: [f64; 2], b: [f64; 2]| {
        [at(a[0], a[1], 0.0), at(b[0], b[1], 0.0), at(b[0], b[1], up), at(a[0], a[1], up)]
    };
    sink.face(&rim([-half, long], [half, long]), frame.away * side);
    sink.face(&rim([-half, 0.0], [-half, long]), -frame.right);
    sink.face(&rim([half, 0.0], [half, long]), frame.right);
}

/// Bricks in courses, a cap and two pots.
fn chimney(sink: &mut Sink, frame: &Frame, detail: u32) {
    let (courses, low, high) = (parts(10, detail), 5.4, 8.3);
    let course = (high - low) / f64::from(courses);
    sink.paint(BRICK);
    for k in 0..courses {
        let (y, out) = (low + course * f64::from(k), if k % 2 == 0 { 0.0 } else { 0.012 });
        block(sink, frame, [-0.5 - out, y, -0.32 - out], [0.5 + out, y + course, 0.32 + out]);
    }
    sink.paint(STONE);
    block(sink, frame, [-0.6, high, -0.42], [0.6, high + 0.12, 0.42]);
    sink.paint(TILES);
    for x in [-0.24, 0.24] {
        tube(sink, &frame.moved([x, high + 0.12, 0.0]), 0.5, [0.15, 0.12], 4 + 2 * detail, detail);
    }
}

/// A window of this half width and height: pane, frame, bars, sill, and open shutters with slats.
fn window(sink: &mut Sink, frame: &Frame, [half, high]: [f64; 2], detail: u32) {
    let bar = |sink: &mut Sink, [x0, x1, y0, y1]: [f64; 4], out: f64| {
        block(sink, frame, [x0, y0, -out], [x1, y1, 0.0]);
    };
    sink.paint(PANE);
    bar(sink, [-half, half, 0.0, high], 0.06);
    sink.paint(TRIM);
    let rim = 0.08;
    for x in [-half - rim, half] {
        bar(sink, [x, x + rim, -rim, high + rim], 0.11);
    }
    bar(sink, [-half, half, high, high + rim], 0.11);
    bar(sink, [-half - 0.15, half + 0.15, -rim, 0.0], 0.2);
    for x in [-0.02, -half * 0.5 - 0.02, half * 0.5 - 0.02] {
        bar(sink, [x, x + 0.04, 0.0, high], 0.085);
    }
    let cross = parts(3, detail);
    for k in 1..cross {
        let y = high * f64::from(k) / f64::from(cross);
        bar(sink, [-half, half, y - 0.02, y + 0.02], 0.085);
    }
    sink.paint(SHUTTER);
    let slats = parts(8, detail);
    for x in [-half - rim - half, half + rim] {
        bar(sink, [x, x + half, -0.02, high + 0.02], 0.055);
        for k in 0..slats {
            let step = high / f64::from(slats);
            let y = step * f64::from(k);
            bar(sink, [x + 0.05, x + half - 0.05, y + 0.15 * step, y + 0.75 * step], 0.08);
        }
    }
}

/// A door with panels in a frame.
fn door(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(TRIM);
    for x in [-0.65, 0.53] {
        block(sink, frame, [x, 0.3, -0.12], [x + 0.12, 2.6, 0.0]);
    }
    block(sink, frame, [-0.53, 2.48, -0.12], [0.53, 2.6, 0.0]);
    sink.paint(SHUTTER);
    block(sink, frame, [-0.53, 0.3, -0.06], [0.53, 2.48, 0.0]);
    let rows = parts(3, detail);
    for k in 0..rows {
        let (y, step) = (0.4 + 2.0 * f64::from(k) / f64::from(rows), 2.0 / f64::from(rows));
        for x in [-0.45, 0.05] {
            block(sink, frame, [x, y + 0.1 * step, -0.085], [x + 0.4, y + 0.9 * step, -0.06]);
        }
    }
    sink.paint(STONE);
    ball(sink, &frame.moved([0.44, 1.35, -0.12]), [0.045; 3], 4 + detail, 2 + detail);
}

/// A floor with steps, posts that bear a roof, and rails.
fn porch(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(STONE);
    block(sink, frame, [-1.6, 0.0, -1.7], [1.6, 0.3, 0.0]);
    block(sink, frame, [-0.8, 0.0, -2.05], [0.8, 0.15, -1.7]);
    sink.paint(TRIM);
    for x in [-1.5, -0.75, 0.75, 1.5] {
        tube(sink, &frame.moved([x, 0.3, -1.6]), 2.4, [0.07, 0.055], 4 + detail, 2 * detail);
    }
    block(sink, frame, [-1.75, 2.7, -1.85], [1.75, 2.85, 0.0]);
    for (from, to) in [([-1.5, -1.6], [-0.75, -1.6]), ([0.75, -1.6], [1.5, -1.6])] {
        rail(sink, frame, from, to, detail);
    }
    for x in [-1.5, 1.5] {
        rail(sink, frame, [x, -1.6], [x, -0.1], detail);
    }
}

/// A rail on balusters from one (x, z) to another.
fn rail(sink: &mut Sink, frame: &Frame, from: [f64; 2], to: [f64; 2], detail: u32) {
    let thick = 0.04;
    block(sink, frame, [from[0] - thick, 1.15, from[1] - thick], [to[0] + thick, 1.22, to[1] + thick]);
    let long = (to[0] - from[0]) + (to[1] - from[1]);
    let count = ((long / 0.16) as u32).max(1);
    for k in 1..count {
        let t = f64::from(k) / f64::from(count);
        let at = [from[0] + (to[0] - from[0]) * t, 0.3, from[1] + (to[1] - from[1]) * t];
        tube(sink, &frame.moved(at), 0.85, [0.025, 0.02], 3 + detail / 2, detail.div_ceil(2));
    }
}
