//! Eight lanes in arrays, which compilers turn into what SIMD the target is known to have.

use super::{Line, Vertex, Wide, Work};

/// Runs anywhere.
#[derive(Clone, Copy)]
pub(super) struct Portable;

const N: usize = 8;
type F = [f32; N];
type I = [i32; N];
type D = [f64; N];
type M = [bool; N];

macro_rules! lanes {
    ($(fn $name:ident($($a:ident: $t:ty),*) -> $r:ty = $e:expr;)*) => {
        $(#[inline(always)]
        fn $name(self, $($a: $t),*) -> [$r; N] {
            std::array::from_fn(|i| {
                $(let $a = $a[i];)*
                $e
            })
        })*
    };
}

impl Wide for Portable {
    const N: usize = N;
    type F = F;
    type I = I;
    type D = D;
    type M = M;
    #[inline(never)]
    fn apart<W: Work>(self, work: W) -> W::Output {
        work.run(self)
    }

    lanes! {
        fn add(a: F, b: F) -> f32 = a + b;
        fn sub(a: F, b: F) -> f32 = a - b;
        fn mul(a: F, b: F) -> f32 = a * b;
        fn div(a: F, b: F) -> f32 = a / b;
        fn min(a: F, b: F) -> f32 = if a < b { a } else { b };
        fn max(a: F, b: F) -> f32 = if a > b { a } else { b };
        fn abs(a: F) -> f32 = a.abs();
        fn gt(a: F, b: F) -> bool = a > b;
        fn ge(a: F, b: F) -> bool = a >= b;
        fn pick(m: M, a: F, b: F) -> f32 = if m { a } else { b };
        fn ceil(v: F) -> i32 = v.ceil() as i32;
        fn truncate(v: F) -> i32 = v as i32;
        fn add_i(a: I, b: I) -> i32 = a.wrapping_add(b);
        fn sub_i(a: I, b: I) -> i32 = a.wrapping_sub(b);
        fn mul_i(a: I, b: I) -> i32 = a.wrapping_mul(b);
        fn min_i(a: I, b: I) -> i32 = a.min(b);
        fn max_i(a: I, b: I) -> i32 = a.max(b);
        fn and(a: I, b: I) -> i32 = a & b;
        fn or(a: I, b: I) -> i32 = a | b;
        fn xor(a: I, b: I) -> i32 = a ^ b;
        fn shift_left(a: I, by: I) -> i32 = a.checked_shl(by as u32).unwrap_or(0);
        fn gt_i(a: I, b: I) -> bool = a > b;
        fn eq_i(a: I, b: I) -> bool = a == b;
        fn pick_i(m: M, a: I, b: I) -> i32 = if m { a } else { b };
        fn to_f(v: I) -> f32 = v as f32;
        fn bits_of(v: F) -> i32 = v.to_bits() as i32;
        fn of_bits(v: I) -> f32 = f32::from_bits(v as u32);
        fn both(a: M, b: M) -> bool = a & b;
        fn either(a: M, b: M) -> bool = a | b;
        fn without(a: M, b: M) -> bool = a & !b;
        fn int_to_d(v: I) -> f64 = f64::from(v);
        fn to_d(v: F) -> f64 = f64::from(v);
        fn add_d(a: D, b: D) -> f64 = a + b;
        fn sub_d(a: D, b: D) -> f64 = a - b;
        fn mul_d(a: D, b: D) -> f64 = a * b;
        fn div_d(a: D, b: D) -> f64 = a / b;
        fn min_d(a: D, b: D) -> f64 = if a < b { a } else { b };
        fn max_d(a: D, b: D) -> f64 = if a > b { a } else { b };
        fn abs_d(a: D) -> f64 = a.abs();
        fn floor_d(a: D) -> f64 = a.floor();
        fn ceil_d(a: D) -> f64 = a.ceil();
        fn gt_d(a: D, b: D) -> bool = a > b;
        fn pick_d(m: M, a: D, b: D) -> f64 = if m { a } else { b };
        fn narrow(v: D) -> f32 = v as f32;
        fn nearest(v: D) -> i32 = v.round_ties_even() as i32;
    }
    #[inline(always)]
    fn splat(self, v: f32) -> F {
        [v; N]
    }
    #[inline(always)]
    fn lanes(self) -> F {
        std::array::from_fn(|i| i as f32)
    }
    #[inline(always)]
    fn load(self, from: &[f32]) -> F {
        std::array::from_fn(|i| from[i])
    }
    #[inline(always)]
    fn store(self, to: &mut [f32], v: F) {
        to[..N].copy_from_slice(&v);
    }
    #[inline(always)]
    fn least(self, v: F) -> f32 {
        v.into_iter().fold(f32::INFINITY, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn greatest(self, v: F) -> f32 {
        v.into_iter().fold(f32::NEG_INFINITY, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn splat_i(self, v: i32) -> I {
        [v; N]
    }
    #[inline(always)]
    fn load_i(self, from: &[i32]) -> I {
        std::array::from_fn(|i| from[i])
    }
    #[inline(always)]
    fn store_i(self, to: &mut [i32], v: I) {
        to[..N].copy_from_slice(&v);
    }
    #[inline(always)]
    fn shift_right<const BY: i32>(self, a: I) -> I {
        a.map(|a| a >> BY)
    }
    #[inline(always)]
    fn shift_up<const BY: i32>(self, a: I) -> I {
        a.map(|a| a << BY)
    }
    #[inline(always)]
    fn transpose(self, v: I) -> I {
        std::array::from_fn(|i| {
            i32::from_le_bytes(std::array::from_fn(|r| v[(i & !3) + r].to_le_bytes()[i & 3]))
        })
    }
    #[inline(always)]
    fn first(self, n: usize) -> M {
        std::array::from_fn(|i| i < n)
    }
    #[inline(always)]
    fn bits(self, m: M) -> u32 {
        (0..N).map(|i| u32::from(m[i]) << i).sum()
    }
    #[inline(always)]
    fn splat_d(self, v: f64) -> D {
        [v; N]
    }
    #[inline(always)]
    fn lanes_d(self) -> D {
        std::array::from_fn(|i| i as f64)
    }
    #[inline(always)]
    fn store_d(self, to: &mut [f64], v: D) {
        to[..N].copy_from_slice(&v);
    }
    #[inline(always)]
    fn load_lines(self, from: &[Line]) -> (F, F, I, I) {
        (
            self.load_farthest(from),
            std::array::from_fn(|i| from[i / 4].near[i % 4]),
            std::array::from_fn(|i| from[i / 4].mask[i % 4] as i32),
            self.load_ever(from),
        )
    }
    #[inline(always)]
    fn store_lines(self, to: &mut [Line], z: F, zw: F, w: I, ever: I) {
        for i in 0..N {
            let line = &mut to[i / 4];
            (line.far[i % 4], line.near[i % 4]) = (z[i], zw[i]);
            (line.mask[i % 4], line.ever[i % 4]) = (w[i] as u32, ever[i] as u32);
        }
    }
    #[inline(always)]
    fn load_farthest(self, from: &[Line]) -> F {
        std::array::from_fn(|i| from[i / 4].far[i % 4])
    }
    #[inline(always)]
    fn load_ever(self, from: &[Line]) -> I {
        std::array::from_fn(|i| from[i / 4].ever[i % 4] as i32)
    }
    #[inline(always)]
    fn gather(self, corners: &[Vertex], words: &[u64], which: usize) -> [I; 4] {
        let mut to = [[0; N]; 4];
        for i in 0..N {
            let c = &corners[(words[i] >> (16 * which) & 0x1ff) as usize];
            (to[0][i], to[1][i]) = (c.x, c.y);
            (to[2][i], to[3][i]) = (c.z.to_bits() as i32, c.packed as i32);
        }
        to
    }
    #[inline(always)]
    fn store_corners(self, to: &mut [Vertex], v: [I; 4]) {
        for (i, to) in to[..N].iter_mut().enumerate() {
            let (z, packed) = (f32::from_bits(v[2][i] as u32), v[3][i] as u32);
            *to = Vertex { x: v[0][i], y: v[1][i], z, packed };
        }
    }
    #[inline(always)]
    fn tiles(self) -> (F, F) {
        (std::array::from_fn(|i| (i & 3) as f32), std::array::from_fn(|i| (i >> 2) as f32))
    }
    #[inline(always)]
    fn pixels(self) -> (I, I) {
        (std::array::from_fn(|i| (i & 7) as i32), std::array::from_fn(|i| (i >> 3) as i32))
    }
    #[inline(always)]
    fn compress(self, to: &mut [i32], m: M, v: I) {
        let mut at = 0;
        for i in 0..N {
            to[at] = v[i];
            at += usize::from(m[i]);
        }
    }
}
