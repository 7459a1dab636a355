//! What stands in the streets of the city, and furniture of its houses that an office lacks.

use rand_pcg::Pcg32;

use super::plan::signed;
use super::shapes::{Frame, Sink, ball, block, rounded, tube};
use super::{furniture, paint};

/// A lamp post.
pub(super) fn lamp_post(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(furniture::METAL);
    tube(sink, frame, 4.2, [0.08, 0.05], 6, detail);
    sink.paint(furniture::LAMP);
    ball(sink, &frame.moved([0.0, 4.35, 0.0]), [0.24, 0.2, 0.24], 6 * detail, 3 * detail);
}

/// A tree with a round crown.
pub(super) fn tree(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let size = 1.0 + 0.2 * signed(rng);
    sink.paint(paint::BARK);
    tube(sink, frame, 2.4 * size, [0.14, 0.1], 5, detail);
    sink.paint(furniture::LEAF);
    let crown = frame.moved([0.0, 3.6 * size, 0.0]);
    ball(sink, &crown, [1.25 * size, 1.6 * size, 1.25 * size], 8 * detail, 5 * detail);
}

/// A parked car, along local x.
pub(super) fn car(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    sink.paint(paint::CAR + (signed(rng) * 1e6).abs() as u32 % paint::CARS);
    rounded(sink, frame, [-2.05, 0.28, -0.85], [2.05, 0.95, 0.85], 2 * detail, 0.12);
    sink.paint(paint::GLASS);
    rounded(sink, frame, [-1.25, 0.9, -0.74], [0.95, 1.42, 0.74], 2 * detail, 0.25);
    sink.paint(furniture::SCREEN);
    for x in [-1.3, 1.3] {
        for z in [-0.8, 0.8] {
            ball(sink, &frame.moved([x, 0.32, z]), [0.32, 0.32, 0.12], 4 * detail, 3 * detail);
        }
    }
}

/// A table with four legs.
pub(super) fn table(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    let (w, d) = (0.7 + 0.15 * signed(rng), 0.45 + 0.05 * signed(rng));
    sink.paint(furniture::WOOD);
    block(sink, frame, [-w, 0.71, -d], [w, 0.75, d]);
    for (x, z) in [(-w, -d), (-w, d), (w, -d), (w, d)] {
        tube(sink, &frame.moved([0.92 * x, 0.0, 0.9 * z]), 0.71, [0.03, 0.03], 4 * detail, detail);
    }
}

/// A bed, its head to the wall.
pub(super) fn bed(sink: &mut Sink, frame: &Frame, detail: u32, rng: &mut Pcg32) {
    sink.paint(furniture::WOOD);
    block(sink, frame, [-0.8, 0.1, -2.05], [0.8, 0.34, -0.06]);
    block(sink, frame, [-0.8, 0.0, -0.06], [0.8, 0.95, 0.0]);
    sink.paint(furniture::FABRIC);
    rounded(sink, frame, [-0.76, 0.34, -2.0], [0.76, 0.55, -0.1], 2 * detail, 0.1);
    sink.paint(furniture::PAPER);
    let x = 0.35 + 0.04 * signed(rng);
    for x in [-x, x] {
        rounded(sink, &frame.moved([x, 0.55, -0.35]), [-0.3, 0.0, -0.2], [0.3, 0.12, 0.2], detail, 0.0);
    }
}

/// A wardrobe with two doors.
pub(super) fn wardrobe(sink: &mut Sink, frame: &Frame, detail: u32, _: &mut Pcg32) {
    sink.paint(furniture::WOOD);
    block(sink, frame, [-0.75, 0.05, -0.6], [0.75, 2.1, 0.0]);
    for x in [-0.74, 0.01] {
        block(sink, frame, [x, 0.08, -0.62], [x + 0.73, 2.07, -0.6]);
    }
    sink.paint(furniture::METAL);
    for x in [-0.06, 0.06] {
        ball(sink, &frame.moved([x, 1.05, -0.64]), [0.025; 3], 4 * detail, 2 * detail);
    }
}
