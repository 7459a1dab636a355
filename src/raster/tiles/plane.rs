//! Bounds on the depth of primitives in tiles.
//!
//! The plane goes through the diagonals of a quadrangle; if that is bent, the other two corners are as far
//! off the plane as each other. The exact depth of a half at a covered center (`raster::setup`) lies within
//! these bounds of it:
//!
//! - The half's own plane, through the same unsnapped corners, differs by nothing to the bend, on one side;
//!   and by up to a sixth more, on both, up to a step outside it: the height of each half is at least 8/√2
//!   steps on the grid, and more than four before snapping. [`BENT`] of the bend holds both, with the next.
//! - Centers lie up to half a step outside the half along each axis, and its depth is cut to that of its
//!   corners there, or comes from a plane through snapped corners, which has the depth of a point half a step
//!   away. The change over half a step ([`OUTSIDE`]) holds this.
//! - f32, here and in the exact formula, rounds by a few 2⁻²⁴ of the changes over the primitive and the
//!   windows around it, of the tiles' bounds, and of the depth: 2⁻²⁰ of both is added. Where rounding may
//!   make up a sixteenth of the area by which slopes are divided, or a half is lower than that, nothing is
//!   said of slopes: the corners' own depths are bounds.

use super::edges::center;
use super::ready::{Corners, Pixels, Ready, SMALL, greatest4, least4};
use super::setup::Draw;
use super::wide::{Wide, each};

const BENT: f32 = 0.4;
/// A little more than half.
const OUTSIDE: f32 = 0.51;
const ROUNDING: f32 = 1.0 / (1 << 20) as f32;
/// Share of the sum of its two products that the area may be off by.
const AREA_ROUNDING: f32 = 1.0 / (1 << 22) as f32;

/// A plane over the image as far as it is known: slopes a grid step.
#[derive(Clone, Copy)]
struct Plane<L: Wide> {
    known: L::M,
    /// Depth at the center of the first pixel of the first block.
    at: L::F,
    along: L::F,
    down: L::F,
    /// Of two of the corners off the plane.
    bent: L::F,
    /// What is rounded.
    rounding: L::F,
}

impl<L: Wide> Draw<'_, L> {
    /// Depth of primitives of up to 256 pixels in their first tile.
    #[inline(always)]
    pub(super) fn plane<const SIZE: u8>(
        &self,
        t: &mut Ready,
        first: usize,
        c: &Corners<L>,
        p: &Pixels<L>,
        thin: L::M,
    ) {
        let l = self.l;
        let rest = c.rests(l);
        // Places relative to other corners in steps, before snapping: one rounding.
        let (ux, uy) = (c.way(l, &rest, 0, 2, 0), c.way(l, &rest, 1, 2, 0));
        let (wx, wy) = (c.way(l, &rest, 0, 3, 1), c.way(l, &rest, 1, 3, 1));
        let (one, other) = (l.mul(ux, wy), l.mul(uy, wx));
        let area = l.sub(one, other);
        let wrong = l.mul(l.add(l.abs(one), l.abs(other)), l.splat(AREA_ROUNDING));
        let known = l.without(l.gt(area, l.mul(wrong, l.splat(16.0))), thin);
        let per = l.div(l.splat(1.0), l.pick(known, area, l.splat(1.0)));
        // Cramer's rule, and the size of its terms.
        let (z1, z2) = (l.sub(c.z[2], c.z[0]), l.sub(c.z[3], c.z[1]));
        let (a1, a2) = (l.mul(l.mul(z1, wy), per), l.mul(l.mul(z2, uy), per));
        let (b1, b2) = (l.mul(l.mul(z2, ux), per), l.mul(l.mul(z1, wx), per));
        let (along, down) = (l.sub(a1, a2), l.sub(b1, b2));
        let steep = l.add(l.add(l.abs(a1), l.abs(a2)), l.add(l.abs(b1), l.abs(b2)));
        // The primitive and the windows about it.
        let moved = l.mul(steep, l.splat(if SIZE == SMALL { 128.0 * 256.0 } else { 384.0 * 256.0 }));
        let rounding = l.mul(l.add(moved, c.ends(l).1), l.splat(ROUNDING));
        let rounding = l.add(rounding, l.mul(moved, l.mul(l.mul(wrong, per), l.splat(2.0))));
        let (bx, by) = (c.way(l, &rest, 0, 1, 0), c.way(l, &rest, 1, 1, 0));
        let bent = l.sub(l.sub(c.z[1], c.z[0]), l.add(l.mul(along, bx), l.mul(down, by)));
        // From the first corner to the center of the first pixel of the first block.
        let (left, top) = (l.and(p.x0, l.splat_i(!31)), l.and(p.y0, l.splat_i(!15)));
        let part = l.splat(1.0 / 1024.0);
        let x = l.sub(l.to_f(l.sub_i(center(l, left), c.x[0])), l.mul(l.to_f(rest[0][0]), part));
        let y = l.sub(l.to_f(l.sub_i(center(l, top), c.y[0])), l.mul(l.to_f(rest[1][0]), part));
        let at = l.add(c.z[0], l.add(l.mul(along, x), l.mul(down, y)));
        self.store(t, first, c, &Plane { known, at, along, down, bent, rounding });
    }

    /// The same for larger primitives, in doubles.
    #[inline(always)]
    pub(super) fn wide_plane(&self, t: &mut Ready, first: usize, c: &Corners<L>, p: &Pixels<L>, thin: L::M) {
        let l = self.l;
        let rest = c.rests(l);
        let x = each!(4; k => place(l, c.x[k], rest[0][k]));
        let y = each!(4; k => place(l, c.y[k], rest[1][k]));
        let z = each!(4; k => l.to_d(c.z[k]));
        let (ux, uy) = (l.sub_d(x[2], x[0]), l.sub_d(y[2], y[0]));
        let (wx, wy) = (l.sub_d(x[3], x[1]), l.sub_d(y[3], y[1]));
        let (one, other) = (l.mul_d(ux, wy), l.mul_d(uy, wx));
        let area = l.sub_d(one, other);
        let terms = l.add_d(l.abs_d(one), l.abs_d(other));
        let known = l.without(l.gt_d(area, l.mul_d(terms, l.splat_d(1.0 / f64::from(1 << 18)))), thin);
        let per = l.div_d(l.splat_d(1.0), l.pick_d(known, area, l.splat_d(1.0)));
        let (z1, z2) = (l.sub_d(z[2], z[0]), l.sub_d(z[3], z[1]));
        let along = l.mul_d(l.sub_d(l.mul_d(z1, wy), l.mul_d(z2, uy)), per);
        let down = l.mul_d(l.sub_d(l.mul_d(z2, ux), l.mul_d(z1, wx)), per);
        // The primitive, whether in the image or not, and two windows.
        let windows = l.splat_d(64.0 * 256.0);
        let across = l.add_d(l.int_to_d(l.sub_i(greatest4(l, c.x), least4(l, c.x))), windows);
        let high = l.add_d(l.int_to_d(l.sub_i(greatest4(l, c.y), least4(l, c.y))), windows);
        let moved = l.add_d(l.mul_d(l.abs_d(along), across), l.mul_d(l.abs_d(down), high));
        let rounding = l.mul(l.add(l.narrow(moved), c.ends(l).1), l.splat(ROUNDING));
        let (bx, by) = (l.sub_d(x[1], x[0]), l.sub_d(y[1], y[0]));
        let bent = l.sub_d(l.sub_d(z[1], z[0]), l.add_d(l.mul_d(along, bx), l.mul_d(down, by)));
        let (left, top) = (l.and(p.x0, l.splat_i(!31)), l.and(p.y0, l.splat_i(!15)));
        let cx = l.sub_d(l.int_to_d(center(l, left)), x[0]);
        let cy = l.sub_d(l.int_to_d(center(l, top)), y[0]);
        let at = l.narrow(l.add_d(z[0], l.add_d(l.mul_d(along, cx), l.mul_d(down, cy))));
        let [along, down, bent] = [l.narrow(along), l.narrow(down), l.narrow(bent)];
        self.store(t, first, c, &Plane { known, at, along, down, bent, rounding });
    }

    /// The bounds that windows read.
    #[inline(always)]
    fn store(&self, t: &mut Ready, first: usize, c: &Corners<L>, plane: &Plane<L>) {
        let (l, Plane { known, at, along, down, bent, rounding }) = (self.l, *plane);
        let zero = l.splat(0.0);
        let outside = l.mul(l.add(l.abs(along), l.abs(down)), l.splat(OUTSIDE));
        let spare = l.add(l.add(rounding, outside), l.mul(l.abs(bent), l.splat(BENT)));
        let (low, high) = (l.sub(l.min(bent, zero), spare), l.add(l.max(bent, zero), spare));
        // Over the centers of a tile, 7 columns and 3 rows on.
        let (mx, my) = (l.mul(along, l.splat(7.0 * 256.0)), l.mul(down, l.splat(3.0 * 256.0)));
        let lower = l.add(l.min(mx, zero), l.min(my, zero));
        let upper = l.add(l.max(mx, zero), l.max(my, zero));
        let (farthest, nearest) = c.ends(l);
        l.store(&mut t.floor[first..], l.pick(known, l.add(at, low), farthest));
        l.store(&mut t.far[first..], l.pick(known, l.add(at, l.add(low, lower)), farthest));
        l.store(&mut t.near[first..], l.pick(known, l.add(at, l.add(high, upper)), nearest));
        // To the next tile.
        l.store(&mut t.along[first..], l.pick(known, l.mul(along, l.splat(2048.0)), zero));
        l.store(&mut t.down[first..], l.pick(known, l.mul(down, l.splat(1024.0)), zero));
        l.store(&mut t.farthest[first..], farthest);
        l.store(&mut t.nearest[first..], nearest);
    }
}

/// A coordinate before snapping, in steps.
#[inline(always)]
fn place<L: Wide>(l: L, v: L::I, rest: L::I) -> L::D {
    l.add_d(l.int_to_d(v), l.mul_d(l.int_to_d(rest), l.splat_d(1.0 / 1024.0)))
}
