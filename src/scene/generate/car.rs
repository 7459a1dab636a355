//! One car of `generate:cars`: a thin skin with open windows around seats, an engine and a drive train.
//!
//! Local coordinates: x ahead, y up, z to one side, m; 4.4 m long.

use glam::DVec3;

use super::lathe::{capsule, drum, grid, lathe, sheet};
use super::shapes::{Frame, Sink, ball, block, circle, parts, rounded};

/// Materials, in the order of their numbers.
pub(super) const MATERIALS: &[(&str, [f32; 3])] = &[
    ("ground", [0.34, 0.34, 0.35]),
    ("paint", [0.48, 0.06, 0.07]),
    ("lining", [0.24, 0.22, 0.21]),
    ("rubber", [0.05, 0.05, 0.055]),
    ("rim", [0.60, 0.61, 0.63]),
    ("iron", [0.30, 0.31, 0.33]),
    ("aluminum", [0.56, 0.57, 0.58]),
    ("seat", [0.12, 0.13, 0.17]),
    ("copper", [0.62, 0.34, 0.18]),
    ("plastic", [0.10, 0.10, 0.11]),
    ("lamp", [0.90, 0.88, 0.78]),
];
pub(super) const GROUND: u32 = 0;
const PAINT: u32 = 1;
const LINING: u32 = 2;
const RUBBER: u32 = 3;
const RIM: u32 = 4;
const IRON: u32 = 5;
const ALUMINUM: u32 = 6;
const SEAT: u32 = 7;
const COPPER: u32 = 8;
const PLASTIC: u32 = 9;
const LAMP: u32 = 10;

/// Half the car's length, m.
const HALF: f64 = 2.2;
/// Axles, m ahead of the middle; radius and half the track of the wheels.
const AXLES: [f64; 2] = [-1.3, 1.36];
const WHEEL: f64 = 0.31;
const TRACK: f64 = 0.72;

/// A car whose skin has about `skin` triangles (none if that is 0) and whose other parts are refined
/// by `detail`.
pub(super) fn car(sink: &mut Sink, frame: &Frame, detail: u32, skin: u64, group: &str) {
    let begin = |sink: &mut Sink, name: &str| sink.begin(|| (name.to_owned(), group.to_owned()));
    // Below 2 some parts would have too few cells.
    let detail = detail + 1;
    if skin > 0 {
        begin(sink, "body");
        body(sink, frame, skin);
    }
    for (name, part) in PARTS {
        begin(sink, name);
        part(sink, frame, detail);
    }
}

type Made = fn(&mut Sink, &Frame, u32);

const PARTS: [(&str, Made); 10] = [
    ("engine block", engine_block),
    ("valve train", valve_train),
    ("manifolds", manifolds),
    ("auxiliaries", auxiliaries),
    ("radiator", radiator),
    ("drive train", drive_train),
    ("exhaust", exhaust),
    ("wheels", wheels),
    ("seats", seats),
    ("dashboard", dashboard),
];

/// 3t² − 2t³ between two places, 0 before and 1 behind.
fn smooth(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Rounds the ends of a body: 1 in the middle, 0 at −1 and 1.
fn blunt(t: f64) -> f64 {
    let square = t * t;
    (1.0 - square * square * square * square).max(0.0).sqrt().sqrt()
}

/// A point of the circle moved out to a curve between circle and square.
fn boxy((c, s): (f64, f64)) -> (f64, f64) {
    let norm = (c * c * c * c + s * s * s * s).sqrt().sqrt();
    (c / norm, s / norm)
}

/// The lower body at `x` and an angle.
fn hull(x: f64, angle: (f64, f64)) -> DVec3 {
    let end = blunt(x / HALF);
    let top = 0.74 + 0.18 * smooth(1.9, 0.7, x) - 0.05 * smooth(-1.5, -2.2, x);
    let (c, s) = boxy(angle);
    DVec3::new(x, 0.24 + (top - 0.24) * 0.5 * (1.0 + s * end), 0.86 * c * (0.75 + 0.25 * end) * end)
}

/// The roof with its windows at `x` and an angle of the upper half.
fn cabin(x: f64, angle: (f64, f64)) -> DVec3 {
    let rise = smooth(0.95, 0.1, x) * smooth(-1.75, -1.0, x);
    let (c, s) = boxy(angle);
    // Never quite flat, or points at its ends would fall together.
    DVec3::new(x, 0.86 + 0.56 * (0.01 + rise) * s, 0.8 * c * (1.0 - 0.18 * s * rise))
}

/// Whether a cell of the lower body is there: not under the roof, and not where wheels are.
fn hull_is_solid(p: DVec3) -> bool {
    let open_top = p.x < 0.75 && p.x > -1.55 && p.y > 0.84 && p.z.abs() < 0.7;
    let in_arch = |axle: &f64| {
        p.z.abs() > 0.5 && (p.x - axle) * (p.x - axle) + (p.y - WHEEL) * (p.y - WHEEL) < 0.38 * 0.38
    };
    !open_top && !AXLES.iter().any(in_arch)
}

/// Whether a cell of the roof is there: not where windows are.
fn cabin_is_solid(p: DVec3) -> bool {
    let pillar = [0.62, -0.32, -1.22].iter().any(|x| (p.x - x).abs() < 0.05);
    let side = p.z.abs() > 0.58 && p.y > 0.93 && p.y < 1.3 && p.x < 0.5 && p.x > -1.35 && !pillar;
    let front = p.x > 0.2 && p.y > 0.93 && p.y < 1.37 && p.z.abs() < 0.6;
    let back = p.x < -1.15 && p.y > 0.97 && p.y < 1.34 && p.z.abs() < 0.56;
    !side && !front && !back
}

/// Skin and, a little within, lining: the lower body has two thirds of the triangles, the roof the rest.
fn body(sink: &mut Sink, frame: &Frame, triangles: u64) {
    let mut left = triangles;
    // The lining is coarser than the paint.
    for (share, inset, material) in [(0.3, 0.03, LINING), (0.7, 0.0, PAINT)] {
        let wanted = if inset > 0.0 { (triangles as f64 * share) as u64 } else { left };
        let before = sink.triangles;
        sink.paint(material);
        skin(sink, frame, wanted, inset);
        left = left.saturating_sub(sink.triangles - before);
    }
}

/// Both surfaces, with as many cells as give the triangles wanted although some are left out.
fn skin(sink: &mut Sink, frame: &Frame, wanted: u64, inset: f64) {
    let (mut low, mut high) = (wanted / 2, 3 * wanted);
    let count = |cells: u64| {
        let mut count = Sink::counting();
        surfaces(&mut count, frame, cells, inset);
        count.triangles
    };
    while high - low > 1 + wanted / 400 {
        let middle = low + (high - low) / 2;
        if count(middle) > wanted { high = middle } else { low = middle }
    }
    surfaces(sink, frame, low, inset);
}

fn surfaces(sink: &mut Sink, frame: &Frame, cells: u64, inset: f64) {
    let place = |p: DVec3| frame.at(p.to_array());
    // Along the car denser toward its ends, where it curves.
    let along = |i: u32, n: u32| circle(n - i, 2 * n).0;
    let (columns, around) = grid(cells * 2 / 3, 1.1);
    let shrink = 1.0 - inset / 0.5;
    let lower = |i: u32, j: u32| {
        let t = along(i, columns);
        let (p, core) = (hull(HALF * t, circle(j % around, around)), DVec3::new(HALF * t, 0.55, 0.0));
        let p = if t.abs() == 1.0 { core } else { core + (p - core) * shrink };
        p.with_x((HALF - inset) * t)
    };
    part_of_sheet(
        sink,
        (columns, around),
        &lower,
        |p| DVec3::new(p.x * 0.9, 0.55, 0.0),
        hull_is_solid,
        inset > 0.0,
        place,
    );
    let (columns, around) = grid(cells / 3, 0.8);
    let upper = |i: u32, j: u32| {
        let x = -0.4 + 1.35 * along(i, columns);
        let p = cabin(x, circle(j, 2 * around));
        let core = DVec3::new(x, 0.7, 0.0);
        core + (p - core) * shrink
    };
    part_of_sheet(
        sink,
        (columns, around),
        &upper,
        |p| DVec3::new(p.x * 0.5 - 0.2, 0.6, 0.0),
        cabin_is_solid,
        inset > 0.0,
        place,
    );
}

/// The cells of a surface that are there. A lining is turned inward.
fn part_of_sheet(
    sink: &mut Sink,
    (columns, rows): (u32, u32),
    point: &impl Fn(u32, u32) -> DVec3,
    core: impl Fn(DVec3) -> DVec3,
    solid: fn(DVec3) -> bool,
    inward: bool,
    place: impl Fn(DVec3) -> DVec3,
) {
    let column = |i: u32| -> Vec<DVec3> { (0..=rows).map(|j| point(i, j)).collect() };
    let mut left = column(0);
    for i in 0..columns {
        let right = column(i + 1);
        for j in 0..rows as usize {
            let quad = [left[j], right[j], right[j + 1], left[j + 1]];
            let middle = (quad[0] + quad[2]) * 0.5;
            if !solid(middle) {
                continue;
            }
            let outward = (place(middle) - place(core(middle))) * if inward { -1.0 } else { 1.0 };
            for [a, b, c] in [[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]] {
                if a != b && b != c && c != a {
                    sink.face(&[a, b, c].map(&place), outward);
                }
            }
        }
        left = right;
    }
}

/// A body of revolution between two local points.
fn turned(sink: &mut Sink, frame: &Frame, from: [f64; 3], to: [f64; 3], radius: f64, sides: u32, rows: u32) {
    let (from, to) = (frame.at(from), frame.at(to));
    lathe(sink, from, (to - from).normalize(), &drum(from.distance(to), radius, rows), sides);
}

/// A bent tube: a polyline whose corners are rounded by a parabola.
fn hose(sink: &mut Sink, frame: &Frame, stops: [[f64; 3]; 3], radius: f64, (sides, rows): (u32, u32)) {
    let [a, b, c] = stops.map(|p| frame.at(p));
    let axis = |j: u32| {
        let t = f64::from(j) / f64::from(rows);
        a * ((1.0 - t) * (1.0 - t)) + b * (2.0 * t * (1.0 - t)) + c * (t * t)
    };
    let across = (b - a).cross(c - b).normalize_or(DVec3::Y);
    let point = |i: u32, j: u32| {
        let t = f64::from(j) / f64::from(rows);
        let ahead = ((b - a) * (1.0 - t) + (c - b) * t).normalize();
        let (cosine, sine) = circle(i % sides, sides);
        axis(j) + (across * cosine + ahead.cross(across) * sine) * radius
    };
    sheet(sink, (sides, rows), point, |_, j| (axis(j) + axis(j + 1)) * 0.5);
}

/// Places of the cylinders along the engine, m ahead.
fn cylinders() -> impl Iterator<Item = f64> {
    (0..4).map(|k| 1.0 + 0.17 * f64::from(k))
}

fn engine_block(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(IRON);
    rounded(sink, frame, [0.88, 0.3, -0.17], [1.62, 0.56, 0.17], parts(10, detail), 0.05);
    rounded(sink, frame, [0.92, 0.24, -0.14], [1.58, 0.3, 0.14], parts(6, detail), 0.1);
    for x in cylinders() {
        let (low, high) = (0.33, 0.5);
        sink.paint(ALUMINUM);
        // Piston, rod and crank are inside of the block.
        turned(sink, frame, [x, high - 0.06, 0.0], [x, high, 0.0], 0.06, parts(16, detail), parts(3, detail));
        turned(sink, frame, [x, low, 0.0], [x, high - 0.06, 0.0], 0.018, parts(8, detail), parts(3, detail));
        sink.paint(IRON);
        turned(
            sink,
            frame,
            [x - 0.03, low, 0.0],
            [x + 0.03, low, 0.0],
            0.08,
            parts(16, detail),
            parts(2, detail),
        );
    }
}

fn valve_train(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(ALUMINUM);
    rounded(sink, frame, [0.9, 0.56, -0.15], [1.6, 0.66, 0.15], parts(8, detail), 0.05);
    for z in [-0.07, 0.07] {
        turned(sink, frame, [0.92, 0.63, z], [1.58, 0.63, z], 0.014, parts(8, detail), parts(6, detail));
        for x in cylinders().flat_map(|x| [x - 0.04, x + 0.04]) {
            sink.paint(IRON);
            turned(sink, frame, [x - 0.008, 0.635, z], [x + 0.008, 0.635, z], 0.024, parts(12, detail), 1);
            sink.paint(ALUMINUM);
            turned(sink, frame, [x, 0.5, z], [x, 0.61, z], 0.008, parts(8, detail), parts(4, detail));
        }
    }
    sink.paint(PLASTIC);
    rounded(sink, frame, [0.9, 0.67, -0.14], [1.6, 0.7, 0.14], parts(8, detail), 0.03);
}

fn manifolds(sink: &mut Sink, frame: &Frame, detail: u32) {
    for x in cylinders() {
        let size = (parts(10, detail), parts(12, detail));
        sink.paint(IRON);
        hose(sink, frame, [[x, 0.58, 0.14], [x, 0.56, 0.32], [0.96, 0.34, 0.26]], 0.022, size);
        sink.paint(ALUMINUM);
        hose(sink, frame, [[x, 0.6, -0.14], [x, 0.68, -0.3], [x, 0.5, -0.34]], 0.026, size);
    }
    sink.paint(ALUMINUM);
    let plenum = frame.at([0.92, 0.48, -0.34]);
    lathe(sink, plenum, frame.right, &capsule(0.7, 0.06, 0.06, parts(6, detail)), parts(16, detail));
}

fn auxiliaries(sink: &mut Sink, frame: &Frame, detail: u32) {
    for (y, z, radius) in [(0.42, 0.0, 0.09), (0.56, 0.2, 0.06), (0.34, -0.2, 0.07)] {
        sink.paint(IRON);
        turned(sink, frame, [1.64, y, z], [1.68, y, z], radius, parts(20, detail), parts(2, detail));
        sink.paint(COPPER);
        turned(sink, frame, [1.42, y, z], [1.64, y, z], 0.8 * radius, parts(16, detail), parts(8, detail));
    }
    sink.paint(PLASTIC);
    rounded(sink, frame, [0.8, 0.5, 0.4], [1.05, 0.72, 0.62], parts(6, detail), 0.05);
    rounded(sink, frame, [1.2, 0.5, 0.42], [1.5, 0.7, 0.64], parts(6, detail), 0.1);
    for k in 0..8 {
        let z = -0.2 + 0.05 * f64::from(k);
        sink.paint([COPPER, PLASTIC][k as usize % 2]);
        hose(
            sink,
            frame,
            [[0.9, 0.6, z], [1.1, 0.74, z * 1.4], [1.3, 0.66, z * 1.8]],
            0.008,
            (parts(6, detail), parts(16, detail)),
        );
    }
}

fn radiator(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(ALUMINUM);
    let fins = parts(40, detail);
    for k in 0..fins {
        let z = -0.45 + 0.9 * f64::from(k) / f64::from(fins);
        block(sink, frame, [1.82, 0.3, z], [1.86, 0.66, z + 0.3 / f64::from(fins)]);
    }
    sink.paint(PLASTIC);
    for y in [0.28, 0.66] {
        rounded(sink, frame, [1.81, y, -0.48], [1.87, y + 0.04, 0.48], parts(4, detail), 0.0);
    }
    for (c, s) in (0..7).map(|k| circle(k, 7)) {
        hose(
            sink,
            frame,
            [[1.76, 0.48, 0.0], [1.78, 0.48 + 0.08 * s, 0.08 * c], [1.76, 0.48 + 0.16 * s, 0.16 * c]],
            0.02,
            (parts(8, detail), parts(6, detail)),
        );
    }
}

fn drive_train(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(ALUMINUM);
    let box_profile = [[0.0, 0.0], [0.0, 0.2], [0.15, 0.17], [0.3, 0.11], [0.62, 0.09], [0.62, 0.0]];
    lathe(sink, frame.at([0.86, 0.4, 0.0]), -frame.right, &box_profile, parts(24, detail));
    sink.paint(IRON);
    turned(sink, frame, [0.24, 0.36, 0.0], [-1.15, 0.32, 0.0], 0.035, parts(12, detail), parts(20, detail));
    ball(sink, &frame.moved([AXLES[0], 0.31, 0.0]), [0.16, 0.14, 0.14], parts(16, detail), parts(10, detail));
    for x in AXLES {
        turned(
            sink,
            frame,
            [x, WHEEL, -TRACK],
            [x, WHEEL, TRACK],
            0.03,
            parts(10, detail),
            parts(12, detail),
        );
        for z in [-0.5, 0.5] {
            // A spring is a stack of rings here.
            for turn in 0..parts(7, detail) {
                let y = 0.36 + 0.3 * f64::from(turn) / f64::from(parts(7, detail));
                turned(sink, frame, [x, y, z], [x, y + 0.012, z], 0.06, parts(12, detail), 1);
            }
            turned(sink, frame, [x, WHEEL, z], [x, 0.7, z], 0.025, parts(8, detail), parts(4, detail));
        }
    }
}

fn exhaust(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(IRON);
    hose(
        sink,
        frame,
        [[0.96, 0.34, 0.26], [0.3, 0.2, 0.3], [-0.9, 0.24, 0.3]],
        0.028,
        (parts(10, detail), parts(30, detail)),
    );
    lathe(
        sink,
        frame.at([-0.9, 0.24, 0.3]),
        -frame.right,
        &capsule(0.7, 0.09, 0.06, parts(6, detail)),
        parts(14, detail),
    );
    hose(
        sink,
        frame,
        [[-1.6, 0.24, 0.3], [-1.9, 0.26, 0.32], [-2.15, 0.24, 0.34]],
        0.026,
        (parts(10, detail), parts(10, detail)),
    );
    sink.paint(PLASTIC);
    rounded(sink, frame, [-1.95, 0.3, -0.5], [-1.5, 0.45, 0.2], parts(8, detail), 0.15);
}

fn wheels(sink: &mut Sink, frame: &Frame, detail: u32) {
    for x in AXLES {
        for side in [-1.0, 1.0] {
            let (center, out) = (frame.at([x, WHEEL, side * TRACK]), frame.away * side);
            let tread = parts(8, detail);
            let mut profile = vec![[-0.09, 0.2], [-0.09, 0.27]];
            profile.extend((0..=tread).map(|k| {
                let t = f64::from(k) / f64::from(tread);
                [-0.07 + 0.14 * t, WHEEL - if k % 3 == 1 { 0.008 } else { 0.0 }]
            }));
            profile.extend([[0.09, 0.27], [0.09, 0.2]]);
            sink.paint(RUBBER);
            lathe(sink, center, out, &profile, parts(28, detail));
            sink.paint(RIM);
            lathe(
                sink,
                center,
                out,
                &[[-0.08, 0.19], [-0.08, 0.2], [0.08, 0.2], [0.08, 0.18], [-0.08, 0.18]],
                parts(28, detail),
            );
            lathe(
                sink,
                center + out * 0.02,
                out,
                &[[0.0, 0.0], [0.0, 0.06], [0.05, 0.05], [0.05, 0.0]],
                parts(16, detail),
            );
            let up = frame.right;
            for (c, s) in (0..6).map(|k| circle(k, 6)) {
                let spoke = up * c + out.cross(up) * s;
                lathe(
                    sink,
                    center + out * 0.04 + spoke * 0.05,
                    spoke,
                    &drum(0.13, 0.016, parts(2, detail)),
                    parts(6, detail),
                );
            }
            sink.paint(IRON);
            lathe(sink, center - out * 0.04, out, &drum(0.02, 0.14, 1), parts(24, detail));
        }
    }
}

fn seats(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(SEAT);
    for (x, z0, z1) in [(0.05, -0.62, -0.1), (0.05, 0.1, 0.62), (-0.95, -0.62, 0.62)] {
        rounded(sink, frame, [x - 0.25, 0.36, z0], [x + 0.27, 0.52, z1], parts(8, detail), 0.15);
        rounded(sink, frame, [x - 0.4, 0.48, z0], [x - 0.25, 1.02, z1], parts(8, detail), 0.15);
        for z in [0.75 * z0 + 0.25 * z1, 0.25 * z0 + 0.75 * z1] {
            rounded(sink, frame, [x - 0.39, 1.03, z - 0.1], [x - 0.31, 1.2, z + 0.1], parts(4, detail), 0.3);
        }
    }
    sink.paint(LINING);
    block(sink, frame, [-1.5, 0.3, -0.68], [0.8, 0.34, 0.68]);
}

fn dashboard(sink: &mut Sink, frame: &Frame, detail: u32) {
    sink.paint(PLASTIC);
    rounded(sink, frame, [0.5, 0.66, -0.66], [0.8, 0.88, 0.66], parts(8, detail), 0.2);
    let (around, through) = (parts(24, detail), parts(8, detail));
    let point = |i: u32, j: u32| {
        let ((c, s), (c2, s2)) = (circle(i % around, around), circle(j % through, through));
        frame.at([0.38 + 0.02 * s2, 0.8 + (0.17 + 0.015 * c2) * s, 0.36 + (0.17 + 0.015 * c2) * c])
    };
    let axis = |i: u32| {
        let (c, s) = circle(i % around, around);
        frame.at([0.38, 0.8 + 0.17 * s, 0.36 + 0.17 * c])
    };
    sheet(sink, (around, through), point, |i, _| (axis(i) + axis(i + 1)) * 0.5);
    turned(sink, frame, [0.38, 0.8, 0.36], [0.56, 0.76, 0.36], 0.02, parts(8, detail), 1);
    sink.paint(LAMP);
    for z in [-0.52, 0.52] {
        ball(sink, &frame.moved([2.02, 0.58, z]), [0.12, 0.08, 0.15], parts(12, detail), parts(8, detail));
    }
}
