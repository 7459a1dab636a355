//! What stands in the machine room and under the hoods of the cars. One function a piece; the same piece at
//! any detail.

use glam::DVec3;
use rand_pcg::Pcg32;

use super::lathe::{Station, capsule, drum, lathe, sheet};
use super::plan::signed;
use super::shapes::{Frame, Sink, ball, block, circle, parts, rounded};

/// Materials of machines, in the order of their numbers.
pub(super) const MATERIALS: &[(&str, [f32; 3])] = &[
    ("hull", [0.56, 0.60, 0.58]),
    ("deck", [0.26, 0.28, 0.30]),
    ("overhead", [0.70, 0.72, 0.70]),
    ("bulkhead", [0.62, 0.66, 0.60]),
    ("steel", [0.46, 0.48, 0.51]),
    ("pipe green", [0.16, 0.42, 0.26]),
    ("pipe red", [0.55, 0.13, 0.10]),
    ("pipe blue", [0.15, 0.28, 0.52]),
    ("brass", [0.66, 0.50, 0.20]),
    ("tank", [0.72, 0.70, 0.62]),
    ("engine", [0.30, 0.38, 0.34]),
    ("rubber", [0.07, 0.07, 0.08]),
    ("console", [0.36, 0.40, 0.46]),
    ("dial", [0.90, 0.90, 0.84]),
    ("torpedo", [0.20, 0.30, 0.24]),
    ("yellow", [0.80, 0.62, 0.10]),
];
pub(super) const HULL: u32 = 0;
pub(super) const DECK: u32 = 1;
pub(super) const OVERHEAD: u32 = 2;
pub(super) const BULKHEAD: u32 = 3;
pub(super) const STEEL: u32 = 4;
pub(super) const PIPE: u32 = 5;
/// Colors of pipes.
pub(super) const PIPES: u32 = 3;
pub(super) const BRASS: u32 = 8;
const TANK: u32 = 9;
pub(super) const ENGINE: u32 = 10;
pub(super) const RUBBER: u32 = 11;
const CONSOLE: u32 = 12;
const DIAL: u32 = 13;
const TORPEDO: u32 = 14;
const YELLOW: u32 = 15;

/// A bolt's head on a surface at `at` that looks along `out`: a hexagon, on a washer where things are fine.
pub(super) fn bolt(sink: &mut Sink, at: DVec3, out: DVec3, size: f64, detail: u32) {
    if detail >= 8 {
        lathe(
            sink,
            at,
            out,
            &[[0.0, 1.5 * size], [0.2 * size, 1.5 * size], [0.2 * size, size]],
            parts(6, detail),
        );
    }
    lathe(sink, at, out, &[[0.0, size], [size, size], [size, 0.0]], 6);
}

/// Bolts around a circle.
fn bolts(sink: &mut Sink, center: DVec3, out: DVec3, radius: f64, count: u32, size: f64, detail: u32) {
    let u = out.cross(if out.y.abs() < 0.9 { DVec3::Y } else { DVec3::X }).normalize();
    for (c, s) in (0..count).map(|k| circle(k, count)) {
        bolt(sink, center + (u * c + out.cross(u) * s) * radius, out, size, detail);
    }
}

/// Two flanges face to face around a pipe, bolted.
fn flange(sink: &mut Sink, at: DVec3, along: DVec3, radius: f64, detail: u32) {
    let (wide, half) = (radius * 1.7, 0.025);
    let profile = [
        [-half, radius],
        [-half, wide],
        [-0.003, wide],
        [-0.003, 0.97 * wide],
        [0.003, 0.97 * wide],
        [0.003, wide],
        [half, wide],
        [half, radius],
    ];
    lathe(sink, at, along, &profile, parts(8, detail));
    for side in [-1.0, 1.0] {
        bolts(sink, at + along * (side * half), along * side, radius * 1.36, 6, radius * 0.16, detail);
    }
}

/// A run of pipe through points, with round joints and a flange on each long stretch.
pub(super) fn pipe(sink: &mut Sink, points: &[DVec3], radius: f64, color: u32, detail: u32) {
    for pair in points.windows(2) {
        let (way, length) = ((pair[1] - pair[0]).normalize(), pair[0].distance(pair[1]));
        sink.paint(PIPE + color % PIPES);
        lathe(sink, pair[0], way, &drum(length, radius, parts(1, detail)), parts(6, detail));
        if length > 1.5 {
            sink.paint(STEEL);
            let stretches = (length / 3.0).ceil();
            (0..stretches as u32).for_each(|k| {
                flange(sink, pair[0] + way * (length * (f64::from(k) + 0.5) / stretches), way, radius, detail)
            });
        }
    }
    sink.paint(STEEL);
    for at in points.iter().skip(1).take(points.len().saturating_sub(2)) {
        let size = radius * 1.35;
        lathe(
            sink,
            *at - DVec3::Y * size,
            DVec3::Y,
            &capsule(2.0 * size, size, size, parts(2, detail)),
            parts(6, detail),
        );
    }
}

/// A ring around the axis `out`: a torus of two radii.
fn ring(sink: &mut Sink, center: DVec3, out: DVec3, radii: [f64; 2], (around, through): (u32, u32)) {
    let u = out.cross(if out.y.abs() < 0.9 { DVec3::Y } else { DVec3::X }).normalize();
    let spoke = |i: u32| {
        let (c, s) = circle(i % around, around);
        u * c + out.cross(u) * s
    };
    let point = |i: u32, j: u32| {
        let (c, s) = circle(j % through, through);
        center + spoke(i) * (radii[0] + radii[1] * c) + out * (radii[1] * s)
    };
    sheet(sink, (around, through), point, |i, _| center + (spoke(i) + spoke(i + 1)) * (0.5 * radii[0]));
}

/// A hand wheel on a stem.
pub(super) fn wheel(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    let (center, out) = (frame.at([0.0, 1.3, -0.3]), -frame.away);
    sink.paint(PIPE + 1);
    ring(sink, center, out, [0.22, 0.018], (parts(10, detail), parts(3, detail)));
    for k in 0..5 {
        let (c, s) = circle(k, 5);
        lathe(sink, center, frame.right * c + DVec3::Y * s, &drum(0.22, 0.012, 1), parts(5, detail));
    }
    sink.paint(BRASS);
    lathe(sink, center + out * 0.04, -out, &drum(0.34, 0.03, parts(1, detail)), parts(6, detail));
}

/// A tank with domed ends on four legs, a manhole and bands.
pub(super) fn tank(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let (radius, height) = (0.85 + 0.04 * signed(rng), 2.9 + 0.2 * signed(rng));
    let foot = frame.at([0.0, 0.45, 0.0]);
    sink.paint(TANK);
    lathe(sink, foot, DVec3::Y, &capsule(height, radius, 0.45, parts(3, detail)), parts(10, detail));
    sink.paint(STEEL);
    for level in [0.3, 0.7] {
        let at = foot + DVec3::Y * (level * height);
        lathe(
            sink,
            at,
            DVec3::Y,
            &[[-0.05, radius], [-0.05, radius + 0.06], [0.05, radius + 0.06], [0.05, radius]],
            parts(10, detail),
        );
        bolts(sink, at + DVec3::Y * 0.05, DVec3::Y, radius + 0.03, 20, 0.018, detail);
    }
    for (c, s) in (0..4).map(|k| circle(2 * k + 1, 8)) {
        lathe(
            sink,
            frame.at([0.8 * radius * c, 0.0, 0.8 * radius * s]),
            DVec3::Y,
            &drum(0.8, 0.06, 1),
            parts(4, detail),
        );
    }
    let hatch = frame.at([0.0, 1.7, -radius]);
    lathe(
        sink,
        hatch,
        -frame.away,
        &[[-0.1, 0.32], [0.06, 0.32], [0.06, 0.26], [0.09, 0.22], [0.09, 0.0]],
        parts(8, detail),
    );
    bolts(sink, hatch - frame.away * 0.06, -frame.away, 0.29, 12, 0.014, detail);
}

/// A pump: a motor with cooling fins, a round housing, two flanged stubs.
pub(super) fn pump(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(STEEL);
    block(sink, frame, [-1.0, 0.0, -0.45], [1.0, 0.12, 0.45]);
    sink.paint(PIPE + 2);
    let fins = parts(6, detail);
    let mut profile: Vec<Station> = vec![[0.0, 0.0]];
    for k in 0..fins {
        let (from, wide) = (f64::from(k) / f64::from(fins), 1.0 / f64::from(fins));
        profile.extend(
            [(0.0, 0.34), (0.5, 0.34), (0.5, 0.28), (1.0, 0.28)].map(|(t, radius)| [from + t * wide, radius]),
        );
    }
    profile.push([1.0, 0.0]);
    lathe(sink, frame.at([-0.95, 0.52, 0.0]), frame.right, &profile, parts(6, detail));
    sink.paint(PIPE);
    ball(sink, &frame.moved([0.45, 0.55, 0.0]), [0.34, 0.42, 0.42], parts(8, detail), parts(5, detail));
    let (side, top) = (frame.at([0.45, 0.55, -0.3]), frame.at([0.45, 0.9, 0.0]));
    lathe(sink, side, -frame.away, &drum(0.4, 0.14, parts(1, detail)), parts(6, detail));
    lathe(sink, top, DVec3::Y, &drum(0.6, 0.12, parts(1, detail)), parts(6, detail));
    sink.paint(STEEL);
    flange(sink, side - frame.away * 0.38, -frame.away, 0.14, detail);
    flange(sink, top + DVec3::Y * 0.55, DVec3::Y, 0.12, detail);
}

/// A ship's engine of six cylinders, 3.2 m long.
pub(super) fn engine(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(ENGINE);
    block(sink, frame, [-1.6, 0.0, -0.55], [1.6, 0.25, 0.55]);
    rounded(sink, frame, [-1.5, 0.25, -0.42], [1.5, 1.1, 0.42], parts(4, detail), 0.04);
    for k in 0..6 {
        let x = -1.25 + 0.5 * f64::from(k);
        sink.paint(ENGINE);
        lathe(sink, frame.at([x, 1.05, 0.0]), DVec3::Y, &drum(0.5, 0.21, parts(2, detail)), parts(8, detail));
        sink.paint(STEEL);
        lathe(
            sink,
            frame.at([x, 1.52, 0.0]),
            DVec3::Y,
            &capsule(0.26, 0.17, 0.1, parts(1, detail)),
            parts(8, detail),
        );
        bolts(sink, frame.at([x, 1.55, 0.0]), DVec3::Y, 0.19, 8, 0.016, detail);
        sink.paint(BRASS);
        pipe(
            sink,
            &[frame.at([x, 1.4, -0.15]), frame.at([x, 1.4, -0.5]), frame.at([x, 0.8, -0.5])],
            0.035,
            k,
            detail,
        );
        sink.paint(STEEL);
        block(sink, frame, [x - 0.18, 0.4, -0.46], [x + 0.18, 0.85, -0.42]);
        for (dx, y) in [(-0.15, 0.43), (0.15, 0.43), (-0.15, 0.82), (0.15, 0.82)] {
            bolt(sink, frame.at([x + dx, y, -0.46]), -frame.away, 0.012, detail);
        }
    }
    sink.paint(RUBBER);
    lathe(
        sink,
        frame.at([-1.5, 1.5, 0.36]),
        frame.right,
        &capsule(3.0, 0.16, 0.16, parts(2, detail)),
        parts(8, detail),
    );
    sink.paint(STEEL);
    let rim = [
        [0.0, 0.0],
        [0.0, 0.2],
        [-0.03, 0.25],
        [-0.03, 0.55],
        [0.12, 0.55],
        [0.12, 0.25],
        [0.09, 0.2],
        [0.09, 0.0],
    ];
    lathe(sink, frame.at([1.55, 0.65, 0.0]), frame.right, &rim, parts(12, detail));
}

/// A console with a sloped board, dials and knobs.
pub(super) fn console(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    sink.paint(CONSOLE);
    block(sink, frame, [-0.8, 0.0, -0.7], [0.8, 0.8, 0.0]);
    block(sink, frame, [-0.8, 0.8, -0.25], [0.8, 1.7, 0.0]);
    for i in 0..4 {
        for j in 0..2 {
            let at = frame.at([-0.6 + 0.4 * f64::from(i), 1.1 + 0.38 * f64::from(j), -0.25]);
            dial(sink, at, -frame.away, 0.13, detail);
        }
    }
    let (columns, rows) = (10, 4);
    for i in 0..columns {
        for j in 0..rows {
            sink.paint(PIPE + (signed(rng) * 1e6).abs() as u32 % PIPES);
            let at = frame.at([-0.72 + 0.16 * f64::from(i), 0.8, -0.64 + 0.1 * f64::from(j)]);
            lathe(sink, at, DVec3::Y, &[[0.0, 0.02], [0.02, 0.018], [0.02, 0.0]], parts(6, detail));
        }
    }
}

/// A round dial with a rim and a hand.
fn dial(sink: &mut Sink, at: DVec3, out: DVec3, radius: f64, detail: u32) {
    sink.paint(DIAL);
    lathe(sink, at, out, &[[0.0, radius * 0.9], [0.02, radius * 0.9], [0.02, 0.0]], parts(6, detail));
    sink.paint(BRASS);
    ring(sink, at + out * 0.02, out, [radius * 0.92, radius * 0.08], (parts(8, detail), parts(3, detail)));
}

/// A plain cabinet with a vent and a grip: its sides are large occluders.
pub(super) fn cabinet(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(CONSOLE);
    block(sink, frame, [-0.5, 0.0, -0.6], [0.5, 2.1, 0.0]);
    sink.paint(STEEL);
    for k in 0..parts(4, detail) {
        let y = 1.5 + 0.4 * f64::from(k) / f64::from(parts(4, detail));
        block(sink, frame, [-0.35, y, -0.62], [0.35, y + 0.2 / f64::from(parts(4, detail)), -0.6]);
    }
    lathe(
        sink,
        frame.at([0.4, 0.9, -0.64]),
        DVec3::Y,
        &capsule(0.25, 0.015, 0.015, parts(1, detail)),
        parts(4, detail),
    );
}

/// Six gas bottles in a rack.
pub(super) fn bottles(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    for k in 0..6 {
        let foot = frame.at([-0.75 + 0.3 * f64::from(k), 0.02, -0.16]);
        sink.paint(PIPE + k % PIPES);
        lathe(sink, foot, DVec3::Y, &capsule(1.5, 0.125, 0.14, parts(2, detail)), parts(6, detail));
        sink.paint(BRASS);
        lathe(sink, foot + DVec3::Y * 1.48, DVec3::Y, &drum(0.12, 0.03, 1), parts(4, detail));
    }
    sink.paint(STEEL);
    for y in [0.5, 1.1] {
        block(sink, frame, [-0.95, y, -0.32], [0.95, y + 0.05, -0.3]);
    }
}

/// A steel drum with ribs.
pub(super) fn oil_drum(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let mut profile: Vec<Station> = vec![[0.02, 0.0], [0.02, 0.27], [0.0, 0.27], [0.0, 0.29]];
    for k in 1..parts(6, detail) {
        let t = f64::from(k) / f64::from(parts(6, detail));
        // Two ribs, at a third and two thirds.
        let near = (3.0 * t - (3.0 * t + 0.5).floor()).abs();
        profile.push([0.88 * t, 0.285 + if near < 0.08 && (0.2..0.8).contains(&t) { 0.012 } else { 0.0 }]);
    }
    profile.extend([[0.88, 0.29], [0.88, 0.27], [0.86, 0.27], [0.86, 0.0]]);
    sink.paint([YELLOW, PIPE, PIPE + 2][(signed(rng) * 1e6).abs() as usize % 3]);
    lathe(sink, frame.at([0.0; 3]), DVec3::Y, &profile, parts(8, detail));
    sink.paint(STEEL);
    lathe(sink, frame.at([0.16, 0.86, 0.0]), DVec3::Y, &drum(0.02, 0.035, 1), parts(6, detail));
}

/// The body with fins and a propeller, of about this many triangles, 9 m along `away`.
pub(super) fn torpedo(sink: &mut Sink, frame: &Frame, triangles: u64) {
    let (length, radius) = (9.0, 0.55);
    let (sides, rows) = super::lathe::grid(triangles.saturating_sub(84).max(60), 2.4);
    let round = |t: f64| match t {
        t if t < 0.12 => (1.0 - (1.0 - t / 0.12) * (1.0 - t / 0.12)).sqrt(),
        t if t > 0.7 => 1.0 - 0.85 * ((t - 0.7) / 0.3) * ((t - 0.7) / 0.3),
        _ => 1.0,
    };
    // Two of the rows end in points, of half as many triangles.
    let profile: Vec<Station> = (0..=rows + 1)
        .map(|k| f64::from(k) / f64::from(rows + 1))
        .map(|t| [length * t, if t == 0.0 || t == 1.0 { 0.0 } else { radius * round(t) }])
        .collect();
    sink.paint(TORPEDO);
    lathe(sink, frame.at([0.0; 3]), frame.away, &profile, sides);
    sink.paint(BRASS);
    for side in [-1.0, 1.0] {
        block(sink, frame, [side * 0.4 - 0.15, -0.012, 8.1], [side * 0.4 + 0.15, 0.012, 8.6]);
        block(sink, frame, [-0.012, side * 0.4 - 0.15, 8.1], [0.012, side * 0.4 + 0.15, 8.6]);
    }
    for k in 0..3 {
        let (c, s) = circle(k, 3);
        let (low, high) = ([0.2 * c - 0.1, 0.2 * s - 0.1, 8.8], [0.2 * c + 0.1, 0.2 * s + 0.1, 8.83]);
        block(sink, frame, low, high);
    }
}
