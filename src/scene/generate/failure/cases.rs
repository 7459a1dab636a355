//! The plans of the catalogue. The eye mostly stands at the origin and looks along y; a wall at y = 6 then
//! covers what is in view, and what stands from y = 9 on is behind it.

use glam::DVec2;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::layout::{COLORS, GLASS, Layout, SHEET, STONE};

/// The wall at y = 6 and what it hides, seen from the origin.
pub(super) fn hidden(plan: &mut Layout) {
    plan.begin("wall");
    plan.wall([4.0, 6.0], [-4.0, 6.0]);
    behind(plan);
    plan.look([0.0, 0.0], [0.0, 6.0]);
}

fn behind(plan: &mut Layout) {
    plan.crates([-2.0, 9.0], [2.0, 13.0], [5, 4]);
}

pub(super) fn on_a_plane(plan: &mut Layout) {
    plan.begin("corner");
    plan.wall([0.0, 2.0], [0.0, 6.0]);
    plan.wall([3.0, 6.0], [0.0, 6.0]);
    plan.crates([0.4, 8.0], [2.4, 12.0], [4, 4]);
    for x in [-0.01, 0.0, 0.01] {
        plan.look([x, 0.0], [1.0, 6.0]);
    }
}

pub(super) fn on_an_edge(plan: &mut Layout) {
    plan.begin("fin");
    plan.piece([0.0, 0.0], [1.0, 3.0], [0.0, 1.5]);
    hidden(plan);
}

pub(super) fn grazing_walls(plan: &mut Layout) {
    plan.begin("long wall");
    plan.wall([0.0, 30.0], [0.0, -1.0]);
    plan.begin("end");
    plan.wall([20.0, 30.0], [0.0, 30.0]);
    plan.crates([-4.0, 4.0], [-0.5, 28.0], [3, 8]);
    for x in [0.1, 0.01, 0.001, 0.0001] {
        plan.look([x, 0.0], [x, 30.0]);
    }
}

pub(super) fn slivers(plan: &mut Layout) {
    plan.begin("slivers");
    let mut x = 4.0;
    for k in 0..128 {
        // Slivers of a tenth of a millimeter between others, every third column cut at half its height.
        let to = if k % 2 == 0 { x - 0.1249 } else { x - 0.0001 };
        if k % 3 == 0 {
            plan.piece([x, 6.0], [to, 6.0], [0.0, 1.5]);
            plan.piece([x, 6.0], [to, 6.0], [1.5, 3.0]);
        } else {
            plan.wall([x, 6.0], [to, 6.0]);
        }
        x = to;
    }
    // A wall that ends in the middle of a piece.
    plan.wall([0.03, 6.0], [0.03, 5.0]);
    behind(plan);
    plan.look([0.0, 0.0], [0.0, 6.0]);
    plan.look([0.05, 0.0], [0.05, 6.0]);
}

pub(super) fn doubled_faces(plan: &mut Layout) {
    for k in 0..7 {
        plan.begin(format!("copy {k}"));
        plan.paint(1 + k % 3);
        plan.wall([4.0, 6.0], [-4.0, 6.0]);
        // Coplanar and only partly the same.
        plan.wall([3.5 - f64::from(k), 6.0], [-4.0, 6.0]);
    }
    plan.paint(STONE);
    behind(plan);
    plan.look([0.0, 0.0], [0.0, 6.0]);
    plan.look([0.5, 0.0], [0.2, 6.0]);
}

pub(super) fn interpenetration(plan: &mut Layout) {
    plan.begin("cross");
    plan.wall([3.0, 8.0], [-3.0, 4.0]);
    plan.wall([3.0, 4.0], [-3.0, 8.0]);
    plan.crates([-3.5, 5.6], [3.5, 6.4], [10, 1]);
    hidden(plan);
    plan.look([1.0, 0.0], [0.5, 6.0]);
}

pub(super) fn pixel_holes(plan: &mut Layout) {
    plan.begin("wall with slots");
    for k in 0..16 {
        let x = 4.0 - 0.5 * f64::from(k);
        plan.wall([x, 6.0], [x - 0.45, 6.0]);
    }
    plan.row(9.0, -6.0, 80, [0.15, 0.14]);
    plan.look([0.0, 0.0], [0.0, 6.0]);
    plan.look([0.02, 0.0], [0.02, 6.0]);
}

pub(super) fn far_off(plan: &mut Layout) {
    hidden(plan);
    plan.offset = DVec2::new(100_000.3, -70_000.7);
}

pub(super) fn tiny_scale(plan: &mut Layout) {
    hidden(plan);
    plan.scale = 1.0 / 8192.0;
}

pub(super) fn huge_scale(plan: &mut Layout) {
    hidden(plan);
    plan.scale = 8192.0;
}

pub(super) fn near_plane(plan: &mut Layout) {
    plan.begin("wall past the eye");
    plan.wall([-0.01, 3.0], [-0.4, -0.5]);
    plan.crates([-3.0, 5.0], [-0.4, 11.0], [4, 5]);
    // It holds the eye.
    plan.begin("around the eye");
    plan.wall([0.5, -1.0], [0.6, 1.0]);
    plan.look([0.0, 0.0], [0.0, 6.0]);
    plan.look([0.0, 0.1], [0.0, 6.0]);
}

pub(super) fn not_convex(plan: &mut Layout) {
    plan.begin("folded wall");
    let folds = [[4.0, 6.0], [2.0, 4.0], [0.0, 7.0], [-2.0, 4.0], [-4.0, 6.0]];
    folds.windows(2).for_each(|w| plan.wall(w[0], w[1]));
    // Wider than what a single part of it hides.
    for k in 0..6 {
        plan.crate_at([0.0, 9.0 + f64::from(k)], [1.8, 0.3]);
    }
    plan.look([0.0, 0.0], [0.0, 6.0]);
}

pub(super) fn disconnected(plan: &mut Layout) {
    plan.begin("left");
    plan.wall([0.2, 6.0], [-4.0, 6.0]);
    plan.begin("right");
    plan.wall([4.0, 5.0], [-0.2, 5.0]);
    for k in 0..6 {
        plan.crate_at([0.0, 9.0 + f64::from(k)], [1.8, 0.3]);
    }
    plan.look([0.0, 0.0], [0.0, 6.0]);
}

pub(super) fn car_behind_a_car(plan: &mut Layout) {
    for (name, at) in [("first car", [0.0, 4.0]), ("second car", [0.9, 6.5])] {
        plan.begin(name);
        plan.block(at, [0.8, 0.4], [0.0, 3.0]);
    }
    for k in 0..4 {
        plan.crate_at([0.8, 10.5 + f64::from(k)], [1.6, 0.4]);
    }
    plan.look([0.0, 0.0], [0.0, 6.0]);
}

pub(super) fn subpixel_slabs(plan: &mut Layout) {
    plan.row(40.0, -12.0, 120, [0.2, 0.14]);
    // Others over them at the same depth.
    plan.row(40.0, -11.93, 60, [0.4, 0.14]);
    plan.crates([-10.0, 44.0], [10.0, 50.0], [12, 3]);
    for x in [0.0, 0.05, 0.1] {
        plan.look([x, 0.0], [x, 40.0]);
    }
}

pub(super) fn leaves(plan: &mut Layout) {
    foliage(plan);
    plan.crates([-3.0, 10.0], [3.0, 14.0], [8, 4]);
    for x in [0.0, 0.1, 0.2] {
        plan.look([x, 0.0], [x, 6.0]);
    }
}

/// Leaves between y = 5 and y = 8.
fn foliage(plan: &mut Layout) {
    let mut rng = Pcg32::new(11, 7);
    let mut unit = move || f64::from(rng.next_u32() >> 8) / f64::from(1u32 << 24);
    plan.begin("leaves");
    plan.paint(SHEET);
    for _ in 0..400 {
        let (x, y, level) = (8.0 * unit() - 4.0, 5.0 + 3.0 * unit(), 0.3 + 2.2 * unit());
        let (u, v) = (0.5 * unit() - 0.25, 0.5 * unit() - 0.25);
        plan.piece([x, y], [x + u, y + v], [level, level + 0.3]);
    }
    plan.paint(STONE);
}

pub(super) fn tearing(plan: &mut Layout) {
    plan.begin("slanting wall");
    plan.paint(SHEET);
    for k in 0..64 {
        let [from, to] = [k, k + 1].map(|k| 0.125 * f64::from(k) - 4.0);
        plan.wall([from, from + 6.0], [to, to + 6.0]);
    }
    plan.row(13.0, -9.0, 72, [0.25, 0.25]);
    for x in [-0.5, 0.0, 0.5] {
        plan.look([x, 0.0], [x, 6.0]);
    }
}

pub(super) fn translucent_intersection(plan: &mut Layout) {
    foliage(plan);
    for (k, color) in (0..4).zip(COLORS.into_iter().cycle()) {
        let x = 2.0 * f64::from(k) - 4.0;
        plan.begin(format!("panel {k}"));
        plan.paint(color);
        plan.wall([x + 1.9, 5.5], [x, 7.5]);
    }
    plan.paint(STONE);
    for x in [-0.2, -0.1, 0.0, 0.1, 0.2] {
        plan.look([x, 0.0], [x, 6.0]);
    }
}

pub(super) fn blind(plan: &mut Layout) {
    plan.begin("blind");
    plan.paint(SHEET);
    for k in 0..32 {
        let x = -4.0 + 0.25 * (f64::from(k) + 0.5);
        plan.wall([x, 6.0], [x, 6.25]);
    }
    plan.row(7.3125, -5.0, 80, [0.125, 0.125]);
    for x in [-6.0, -3.0, -1.0, 0.0, 0.1] {
        plan.look([x, 0.0], [0.0, 6.0]);
    }
}

pub(super) fn see_through(plan: &mut Layout) {
    plan.begin("glass");
    plan.paint(GLASS);
    plan.wall([4.0, 5.0], [-4.0, 5.0]);
    plan.begin("sheet");
    plan.paint(SHEET);
    // It shows its back, which is there as well.
    plan.wall([-4.0, 6.0], [0.0, 6.0]);
    plan.paint(STONE);
    plan.crates([-3.0, 8.0], [3.0, 12.0], [6, 4]);
    plan.look([0.0, 0.0], [0.0, 6.0]);
    plan.look([0.0, 7.0], [0.0, 0.0]);
}

pub(super) fn bottleneck(plan: &mut Layout) {
    for (name, y, slit) in [("first wall", 6.0, 0.0), ("second wall", 8.0, 0.5)] {
        plan.begin(name);
        plan.wall([7.0, y], [slit + 0.15, y]);
        plan.wall([slit - 0.15, y], [-7.0, y]);
    }
    plan.crates([-4.0, 10.0], [4.0, 14.0], [8, 4]);
    for x in [-0.6, 0.0, 0.6] {
        plan.look([x, 0.0], [0.0, 6.0]);
    }
}

pub(super) fn outside_the_cells(plan: &mut Layout) {
    plan.fov_degrees = 8.0;
    hidden(plan);
    plan.look([0.0, -60.0], [0.0, 6.0]);
    plan.look([40.0, -50.0], [0.0, 6.0]);
}

pub(super) fn closed_building(plan: &mut Layout) {
    plan.begin("house");
    plan.block([0.0, 8.0], [3.0, 3.0], [0.0, 3.0]);
    plan.crates([-2.7, 5.3], [2.7, 10.7], [6, 6]);
    plan.look([0.0, 0.0], [0.0, 8.0]);
    plan.look([10.0, 2.0], [0.0, 8.0]);
    plan.look_from([0.0, -2.0], 14.0, [0.0, 8.0], 0.0);
}

pub(super) fn low_occlusion(plan: &mut Layout) {
    plan.row(10.0, -5.5, 64, [0.17, 0.15]);
    plan.look([0.0, 0.0], [0.0, 6.0]);
    plan.look([0.5, -1.0], [0.5, 6.0]);
}

pub(super) fn moving_occluder(plan: &mut Layout) {
    plan.begin("left");
    plan.wall([-1.0, 6.0], [-4.0, 6.0]);
    plan.begin("right");
    plan.wall([4.0, 6.0], [1.0, 6.0]);
    plan.begin("door");
    plan.paint(SHEET);
    plan.wall([1.0, 5.9], [-1.0, 5.9]);
    plan.moves((0..8).map(|k| [0.3 * f64::from(k), 0.0]).collect());
    plan.paint(STONE);
    behind(plan);
    for _ in 0..8 {
        plan.look([0.0, 0.0], [0.0, 6.0]);
    }
}
