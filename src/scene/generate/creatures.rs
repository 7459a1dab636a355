//! Two bodies of many small triangles: an animal with a long neck, and a teapot. Both are of their own
//! design, and each is made of closed surfaces that look outward.
//!
//! Both are about 2 m long, stand around the origin and look along x.

use glam::{DVec3, DVec4};

use super::lathe::{grid, lathe, sweep};
use super::shapes::{Frame, Sink, ball};
use super::walk::spline;

/// What the parts of a body are painted with: skin or glaze, and eyes or the lid's knob.
pub(super) type Paints = [u32; 2];

const MIDDLE: Frame = Frame { origin: DVec3::ZERO, right: DVec3::X, away: DVec3::Z };

/// Stops from (x, y, half the height, half the width).
fn stops<const N: usize>(stops: [[f64; 4]; N]) -> [DVec4; N] {
    stops.map(DVec4::from_array)
}

/// The animal of about so many triangles: from tail to head one body, four legs, eyes.
pub(super) fn saurian(sink: &mut Sink, triangles: u64, [skin, eye]: Paints) {
    let share = |part: f64| (triangles as f64 * part) as u64;
    let body = stops([
        [-1.06, 0.16, 0.012, 0.012],
        [-0.92, 0.05, 0.04, 0.035],
        [-0.72, -0.02, 0.08, 0.07],
        [-0.50, 0.0, 0.17, 0.14],
        [-0.28, 0.05, 0.33, 0.29],
        [-0.02, 0.05, 0.41, 0.38],
        [0.24, 0.05, 0.38, 0.34],
        [0.44, 0.15, 0.22, 0.18],
        [0.56, 0.34, 0.12, 0.10],
        [0.62, 0.54, 0.09, 0.08],
        [0.70, 0.70, 0.09, 0.085],
        [0.82, 0.74, 0.12, 0.10],
        [0.94, 0.70, 0.09, 0.08],
        [1.04, 0.66, 0.05, 0.06],
    ]);
    sink.paint(skin);
    let (around, rows) = grid(share(0.62), 2.6);
    sweep(sink, &MIDDLE, &body, (around, rows + 1));
    for (x, z) in [(-0.24, -0.22), (-0.24, 0.22), (0.24, -0.21), (0.24, 0.21)] {
        let leg = stops([
            [x, 0.05, 0.14, 0.10],
            [x, -0.20, 0.13, 0.11],
            [x + 0.01, -0.42, 0.09, 0.085],
            [x + 0.03, -0.58, 0.10, 0.09],
            [x + 0.04, -0.64, 0.11, 0.095],
        ]);
        let (around, rows) = grid(share(0.085), 1.0);
        sweep(sink, &MIDDLE.moved([0.0, 0.0, z]), &leg, (around, rows + 1));
    }
    sink.paint(eye);
    let (around, rows) = grid(share(0.02), 0.5);
    for z in [-0.078, 0.078] {
        ball(sink, &MIDDLE.moved([0.84, 0.80, z]), [0.028; 3], around, rows + 1);
    }
}

/// The teapot of about so many triangles: belly, lid, spout and handle.
pub(super) fn teapot(sink: &mut Sink, triangles: u64, [glaze, knob]: Paints) {
    let share = |part: f64| (triangles as f64 * part) as u64;
    let up = |y: f64| DVec3::Y * y;
    // A profile is a curve of stops (height, radius) between two points of the axis.
    let turned = |sink: &mut Sink, profile: &[[f64; 2]], triangles: u64, ratio: f64| {
        let (sides, rows) = grid(triangles, ratio);
        let on = |k: u32| {
            let t = f64::from(k) / f64::from(rows - 1);
            let [x, y] = [0, 1].map(|axis| spline(profile.len(), |k| profile[k][axis], t));
            [x, y]
        };
        let (first, last) = (profile[0][0], profile[profile.len() - 1][0]);
        let mut stations = vec![[first, 0.0]];
        stations.extend((0..rows).map(on));
        stations.push([last, 0.0]);
        lathe(sink, up(-0.48), DVec3::Y, &stations, sides);
    };
    let belly = [
        [0.0, 0.36],
        [0.0, 0.40],
        [0.04, 0.44],
        [0.22, 0.68],
        [0.48, 0.74],
        [0.72, 0.58],
        [0.82, 0.44],
        [0.86, 0.40],
        [0.84, 0.36],
    ];
    let lid = [[0.83, 0.37], [0.88, 0.37], [0.94, 0.24], [0.98, 0.10], [0.99, 0.07]];
    let grip = [[0.96, 0.05], [1.0, 0.05], [1.04, 0.11], [1.10, 0.12], [1.15, 0.05], [1.155, 0.02]];
    sink.paint(glaze);
    turned(sink, &belly, share(0.46), 0.55);
    turned(sink, &lid, share(0.12), 0.25);
    let spout = stops([
        [0.44, -0.26, 0.13, 0.13],
        [0.68, -0.22, 0.14, 0.12],
        [0.86, -0.04, 0.09, 0.08],
        [0.94, 0.18, 0.06, 0.06],
        [1.04, 0.34, 0.06, 0.055],
        [1.09, 0.38, 0.06, 0.055],
    ]);
    let handle = stops([
        [-0.58, 0.20, 0.05, 0.06],
        [-0.78, 0.28, 0.05, 0.06],
        [-1.04, 0.24, 0.05, 0.06],
        [-1.10, 0.0, 0.05, 0.06],
        [-0.96, -0.20, 0.045, 0.055],
        [-0.62, -0.28, 0.04, 0.05],
    ]);
    for (curve, part, ratio) in [(&spout, 0.17, 1.2), (&handle, 0.19, 2.6)] {
        let (around, rows) = grid(share(part), ratio);
        sweep(sink, &MIDDLE, curve, (around, rows + 1));
    }
    sink.paint(knob);
    turned(sink, &grip, share(0.06), 0.4);
}
