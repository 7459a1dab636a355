//! Edge functions of primitives over pixel centers (Pineda 1988), as windows need them; see `window`.

use super::ready::{Corners, Pixels, Ready, SMALL};
use super::setup::Draw;
use super::wide::Wide;

/// Between the rounding of a quotient and the least distance of one that is no whole number from a whole
/// number; see `window`.
const BIAS: f32 = 1.0 / (1 << 17) as f32;
/// The same in doubles.
const WIDE_BIAS: f64 = 1.0 / (1 << 26) as f64;

impl<L: Wide> Draw<'_, L> {
    /// Edge functions of primitives of up to 256 pixels, from the center of the first pixel of the first
    /// block. Returns those of at most 2×2 pixels that cover none of their centers.
    #[inline(always)]
    pub(super) fn edges<const SIZE: u8>(
        &self,
        t: &mut Ready,
        first: usize,
        c: &Corners<L>,
        p: &Pixels<L>,
    ) -> L::M {
        let l = self.l;
        let zero = l.splat_i(0);
        let (left, top) = (l.and(p.x0, l.splat_i(!31)), l.and(p.y0, l.splat_i(!15)));
        let (ox, oy) = (center(l, left), center(l, top));
        let (column, row) = (l.to_f(l.sub_i(p.x0, left)), l.to_f(l.sub_i(p.y0, top)));
        let mut covered = [l.first(16); 4];
        for k in 0..4 {
            let m = (k + 1) % 4;
            let (ex, ey) = (l.sub_i(c.x[m], c.x[k]), l.sub_i(c.y[m], c.y[k]));
            let (is_up, is_flat) = (l.gt_i(zero, ey), l.eq_i(ey, zero));
            // The top-left rule in one subtraction. An edge without length has all on its inner side.
            let top_left = l.either(is_up, l.without(is_flat, l.gt_i(zero, ex)));
            let owed = l.pick_i(top_left, zero, l.splat_i(1));
            let (rx, ry) = (l.sub_i(ox, c.x[k]), l.sub_i(oy, c.y[k]));
            let e = self.value::<SIZE>([ex, ey], [rx, ry], owed);
            let (ef, exf, eyf) = (l.to_f(e), l.to_f(ex), l.to_f(ey));
            // Rows of a level edge are in or out as a whole: the crossing is far to the left or to the right.
            let per = l.pick(is_flat, l.splat(-1024.0), l.div(l.splat(1.0), eyf));
            let is_left = l.either(is_up, is_flat);
            l.store_i(&mut t.e[k][first..], e);
            l.store_i(&mut t.ex[k][first..], ex);
            l.store_i(&mut t.ey[k][first..], ey);
            l.store(&mut t.ef[k][first..], ef);
            l.store(&mut t.exf[k][first..], exf);
            l.store(&mut t.per_ey[k][first..], per);
            l.store(&mut t.bias[k][first..], l.pick(is_left, l.splat(-BIAS), l.splat(BIAS)));
            l.store_i(&mut t.flip[k][first..], l.pick_i(is_left, zero, l.splat_i(-1)));
            // Four centers. Whole numbers below 2²⁴ near a small primitive, so exact.
            let a = l.sub(l.add(ef, l.mul(row, exf)), l.mul(column, eyf));
            let b = l.sub(a, eyf);
            for (to, v) in covered.iter_mut().zip([a, b, l.add(a, exf), l.add(b, exf)]) {
                *to = l.both(*to, l.ge(v, l.splat(0.0)));
            }
        }
        let three = l.splat_i(3);
        let tiny = l.both(l.gt_i(three, l.sub_i(p.x1, p.x0)), l.gt_i(three, l.sub_i(p.y1, p.y0)));
        let [a, b, c, d] = covered;
        l.without(tiny, l.either(l.either(a, b), l.either(c, d)))
    }

    /// The value of an edge function at a center that lies so far from its beginning, less what is owed,
    /// divided by 256 and rounded down.
    #[inline(always)]
    fn value<const SIZE: u8>(&self, [ex, ey]: [L::I; 2], [rx, ry]: [L::I; 2], owed: L::I) -> L::I {
        let l = self.l;
        if SIZE == SMALL {
            // Below 2·2¹⁴·2¹⁴, since the first block begins at most 32 pixels before.
            let e = l.sub_i(l.mul_i(ex, ry), l.mul_i(ey, rx));
            return l.shift_right::<8>(l.sub_i(e, owed));
        }
        let [ex, ey, rx, ry] = [l.int_to_d(ex), l.int_to_d(ey), l.int_to_d(rx), l.int_to_d(ry)];
        let e = l.sub_d(l.sub_d(l.mul_d(ex, ry), l.mul_d(ey, rx)), l.int_to_d(owed));
        l.nearest(l.floor_d(l.mul_d(e, l.splat_d(1.0 / 256.0))))
    }

    /// Edge functions of larger primitives, from the first pixel of the image.
    #[inline(always)]
    pub(super) fn wide_edges(&self, t: &mut Ready, first: usize, c: &Corners<L>) {
        let l = self.l;
        let (zero, half) = (l.splat_d(0.0), l.splat_d(128.0));
        for k in 0..4 {
            let m = (k + 1) % 4;
            let ex = l.int_to_d(l.sub_i(c.x[m], c.x[k]));
            let ey = l.int_to_d(l.sub_i(c.y[m], c.y[k]));
            let (is_up, is_down) = (l.gt_d(zero, ey), l.gt_d(ey, zero));
            let is_flat = l.without(l.without(l.first(16), is_up), is_down);
            let top_left = l.either(is_up, l.without(is_flat, l.gt_d(zero, ex)));
            let owed = l.pick_d(top_left, zero, l.splat_d(1.0));
            // Below 2⁵³, so exact.
            let (rx, ry) = (l.sub_d(half, l.int_to_d(c.x[k])), l.sub_d(half, l.int_to_d(c.y[k])));
            let e = l.sub_d(l.sub_d(l.mul_d(ex, ry), l.mul_d(ey, rx)), owed);
            let e = l.floor_d(l.mul_d(e, l.splat_d(1.0 / 256.0)));
            let per = l.pick_d(is_flat, l.splat_d(-f64::from(1 << 20)), l.div_d(l.splat_d(1.0), ey));
            let is_left = l.either(is_up, is_flat);
            let bias = l.pick_d(is_left, l.splat_d(-WIDE_BIAS), l.splat_d(WIDE_BIAS));
            l.store_d(&mut t.wide_e[k][first..], e);
            l.store_d(&mut t.wide_ex[k][first..], ex);
            l.store_d(&mut t.wide_per_ey[k][first..], per);
            l.store_d(&mut t.wide_bias[k][first..], bias);
            l.store_i(&mut t.flip[k][first..], l.pick_i(is_left, l.splat_i(0), l.splat_i(-1)));
        }
    }
}

/// Grid coordinates of pixels' centers.
#[inline(always)]
pub(super) fn center<L: Wide>(l: L, pixel: L::I) -> L::I {
    l.add_i(l.shift_up::<8>(pixel), l.splat_i(128))
}
