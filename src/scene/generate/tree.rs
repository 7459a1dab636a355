//! Trees with leaves: a trunk, branches and twigs as tubes, and leaves of two triangles around the twigs.
//!
//! All that a tree has is drawn by lot from its own sequence; how many triangles its wood has depends only on
//! the detail, so that what a budget leaves for leaves is known before.

use glam::DVec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;

use super::lathe::{across, sheet};
use super::plan::signed;
use super::shapes::{Sink, circle};
use super::walk::spline;

/// A tree, or a bush, by its measures in m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tree {
    pub(super) foot: DVec3,
    /// The crown is an ellipsoid between these heights above the foot.
    pub(super) crown: [f64; 2],
    /// Its greatest radius.
    pub(super) radius: f64,
    /// Radius of the trunk.
    pub(super) trunk: f64,
    pub(super) branches: u32,
    /// Twigs of a branch.
    pub(super) twigs: u32,
}

/// A place that leaves grow around: a line from where a twig leaves its branch to its end.
pub(super) struct Twig([DVec3; 2]);

/// Area of a leaf, a kite, by the square of its length.
pub(super) const KITE: f64 = 0.3;

/// Steps of a turn in which directions are drawn by lot.
const STEPS: u32 = 1 << 16;
/// The golden section of a turn: so far apart branches leave the trunk.
const GOLDEN: u32 = 40_503;

/// Share of the leaves that hang anywhere in the crown, on twigs too thin to be drawn.
const LOOSE: f64 = 0.35;

impl Tree {
    /// Cross-section of the crown, m².
    pub(super) fn shade(&self) -> f64 {
        std::f64::consts::PI * self.radius * (self.crown[1] - self.crown[0]) * 0.5
    }
    fn center(&self) -> DVec3 {
        self.foot + DVec3::Y * ((self.crown[0] + self.crown[1]) * 0.5)
    }
    /// The point of the crown for one of the unit ball.
    fn in_crown(&self, unit: DVec3) -> DVec3 {
        let half = (self.crown[1] - self.crown[0]) * 0.5;
        self.center() + unit * DVec3::new(self.radius, half, self.radius)
    }
    /// The nearest point on the way to the crown's center that lies in the crown.
    fn kept(&self, p: DVec3) -> DVec3 {
        let half = (self.crown[1] - self.crown[0]) * 0.5;
        let unit = (p - self.center()) / DVec3::new(self.radius, half, self.radius);
        self.in_crown(unit / unit.length().max(1.0))
    }

    /// The trunk, branches and twigs; where leaves grow.
    pub(super) fn wood(&self, sink: &mut Sink, detail: u32, rng: &mut Pcg32) -> Vec<Twig> {
        let top = self.crown[0] + 0.8 * (self.crown[1] - self.crown[0]);
        let sway = |share: f64, rng: &mut Pcg32| {
            let aside = DVec3::new(signed(rng), 0.0, signed(rng)) * (0.12 * self.radius);
            self.foot + DVec3::Y * (top * share) + aside
        };
        // From just below the ground, so that the trunk's open end is not seen.
        let foot = self.foot - DVec3::Y * 0.05;
        let trunk = [foot, sway(0.25, rng), sway(0.5, rng), sway(0.75, rng), sway(1.0, rng)];
        // Thicker where it enters the ground.
        let flare = |t: f64| {
            let low = (1.0 - 8.0 * t).max(0.0);
            self.trunk * (1.0 - 0.85 * t + 0.7 * low * low)
        };
        limb(sink, &trunk, flare, (4 + detail, 2 * detail));
        let mut grown = Vec::new();
        let turn = rng.next_u32();
        for k in 0..self.branches {
            let share = (f64::from(k) + 0.5) / f64::from(self.branches);
            let (c, s) = circle(turn.wrapping_add(k.wrapping_mul(GOLDEN)) % STEPS, STEPS);
            // The lowest reach out, the highest up.
            let up = 1.8 * share - 0.85 + 0.1 * signed(rng);
            let out = (1.0 - up * up).max(0.0).sqrt();
            let end = self.in_crown(DVec3::new(out * c, up, out * s) * (0.78 + 0.1 * signed(rng)));
            let from = (self.crown[0] / top).max(0.15) * 0.8;
            let leaves_at = from + (0.9 - from) * share;
            let start = spline(trunk.len(), |k| trunk[k], leaves_at);
            let bend = start.lerp(end, 0.5) + DVec3::Y * (0.12 * start.distance(end));
            let thick = 0.5 * flare(leaves_at);
            limb(sink, &[start, bend, end], |t| thick * (1.0 - 0.85 * t), (2 + detail, 1 + detail));
            for n in 0..self.twigs {
                let t = 0.35 + 0.65 * f64::from(n + 1) / f64::from(self.twigs);
                let here = spline(3, |k| [start, bend, end][k], t);
                let ahead = direction(rng) + (end - start).normalize() * 0.7 + DVec3::Y * 0.15;
                let tip = self.kept(here + ahead.normalize() * (self.radius * (0.34 + 0.1 * signed(rng))));
                let thin = 0.6 * thick * (1.0 - 0.85 * t);
                let rows = (detail / 2).max(1);
                limb(sink, &[here, here.lerp(tip, 0.5), tip], |t| thin * (1.0 - 0.7 * t), (3, rows));
                grown.push(Twig([here, tip]));
            }
        }
        grown
    }

    /// So many leaves of this mean length in m around the twigs, of `paints` materials from `first` on.
    pub(super) fn leaves(
        &self,
        sink: &mut Sink,
        twigs: &[Twig],
        (count, length): (u64, f64),
        (first, paints): (u32, u32),
        rng: &mut Pcg32,
    ) {
        for _ in 0..count {
            let Some(Twig([from, to])) = twigs.get(rng.next_u32() as usize % twigs.len().max(1)) else {
                return;
            };
            let ball = direction(rng) * within(rng);
            let at = if part(rng) < LOOSE {
                self.in_crown(ball)
            } else {
                self.kept(from.lerp(*to, 0.2 + 0.8 * part(rng)) + ball * (0.35 * self.radius))
            };
            let outward = (at - self.center()).normalize_or(DVec3::Y);
            // Leaves turn their faces up and outward, and hang a little.
            let face = direction(rng) + DVec3::Y * 0.5 + outward * 0.4;
            let ahead = (direction(rng) + outward * 0.5 - DVec3::Y * 0.3).normalize();
            let side = face.cross(ahead).normalize_or(DVec3::X);
            let long = ahead * (length * (1.0 + 0.25 * signed(rng)));
            sink.paint(first + rng.next_u32() % paints);
            leaf(sink, at, long, side, ahead.cross(side));
        }
    }

    /// Leaves of exactly so many triangles, two each and a half leaf where the number is odd, of the size
    /// with which they have `density` times the area of the crown's cross-section whatever their number.
    pub(super) fn foliage(
        &self,
        sink: &mut Sink,
        twigs: &[Twig],
        (triangles, density): (u64, f64),
        paints: (u32, u32),
        rng: &mut Pcg32,
    ) {
        let leaves = triangles / 2;
        let length = (density * self.shade() / (KITE * leaves.max(1) as f64)).sqrt();
        self.leaves(sink, twigs, (leaves, length), paints, rng);
        if triangles % 2 == 1 {
            let top = self.foot + DVec3::Y * self.crown[1];
            sink.face(&[top, top + DVec3::X * (0.5 * length), top + DVec3::Y * length], DVec3::Z);
        }
    }
}

/// A leaf from its stalk along `long`, folded along the middle; its upper side looks along `up`.
fn leaf(sink: &mut Sink, stalk: DVec3, long: DVec3, side: DVec3, up: DVec3) {
    /// Half the width and height of the rims over the middle, as shares of the length.
    const WIDE: f64 = 0.3;
    const FOLD: f64 = 0.06;
    let length = long.length();
    let widest = stalk + long * 0.42 + up * (FOLD * length);
    for half in [-WIDE, WIDE] {
        sink.face(&[stalk, widest + side * (half * length), stalk + long], up);
    }
}

/// A tube along a curve of stops, open where it begins; `radius` at 0..1 of the way.
fn limb(sink: &mut Sink, stops: &[DVec3], radius: impl Fn(f64) -> f64, (sides, rows): (u32, u32)) {
    let (first, last) = (stops[0], stops[stops.len() - 1]);
    let (u, v) = across((last - first).normalize_or(DVec3::Y));
    let share = |j: u32| f64::from(j) / f64::from(rows);
    let center = |j: u32| spline(stops.len(), |k| stops[k], share(j));
    let point = |i: u32, j: u32| {
        let (c, s) = circle(i % sides, sides);
        // The last row is the tip.
        let radius = if j == rows { 0.0 } else { radius(share(j)) };
        center(j) + (u * c + v * s) * radius
    };
    sheet(sink, (sides, rows), point, |_, j| (center(j) + center(j + 1)) * 0.5);
}

/// A direction, each equally likely.
pub(super) fn direction(rng: &mut Pcg32) -> DVec3 {
    let y = signed(rng);
    let (c, s) = circle(rng.next_u32() % STEPS, STEPS);
    let out = (1.0 - y * y).max(0.0).sqrt();
    DVec3::new(out * c, y, out * s)
}

/// From 0 to 1.
fn part(rng: &mut Pcg32) -> f64 {
    (signed(rng) + 1.0) * 0.5
}

/// How far from the center of the unit ball a point of it lies, each equally likely: the greatest of three
/// numbers from 0 to 1 is below r as often as all three are, which is r³.
fn within(rng: &mut Pcg32) -> f64 {
    part(rng).max(part(rng)).max(part(rng))
}
