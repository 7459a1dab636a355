//! Lanes: the operations that the tiles of depth are drawn and asked with.
//!
//! One kernel, written once over [`Wide`], runs on AVX2 and anywhere, in arrays; eight lanes at a time, on
//! machines with wider registers too. Both give the same bits: no operation is fused, none is approximate,
//! and lanes are independent. Masks hold one truth a lane.
#![cfg_attr(target_arch = "x86_64", expect(unsafe_code, reason = "instruction sets"))]

/// An array from an expression in a number, written out: closures are not compiled for the instruction set.
macro_rules! each {
    (3; $k:ident => $e:expr) => {
        [{ let $k = 0usize; $e }, { let $k = 1usize; $e }, { let $k = 2usize; $e }]
    };
    (4; $k:ident => $e:expr) => {
        [
            { let $k = 0usize; $e }, { let $k = 1usize; $e },
            { let $k = 2usize; $e }, { let $k = 3usize; $e },
        ]
    };
    (8; $k:ident => $e:expr) => {
        [
            { let $k = 0usize; $e }, { let $k = 1usize; $e },
            { let $k = 2usize; $e }, { let $k = 3usize; $e },
            { let $k = 4usize; $e }, { let $k = 5usize; $e },
            { let $k = 6usize; $e }, { let $k = 7usize; $e },
        ]
    };
}
pub(in crate::raster) use each;

// The contract of a token of an instruction set, on which every unsafe block of its module rests:
//
// 1. It proves its instruction set. Its field is private to its module, and only `run` there makes one,
//    whose callers promise the set. Intrinsics that take and give values, as most do, need nothing else.
// 2. What reads or writes memory first takes a part of the slice that is as long as the access, which panics
//    where the slice is too short. Unaligned forms are used, but for lines, which are aligned to 64 bytes.
macro_rules! ops {
    ($(fn $name:ident($($a:ident: $t:ty),*) -> $r:ty = $e:expr;)*) => {
        $(#[inline(always)]
        fn $name(self, $($a: $t),*) -> $r {
            // SAFETY: point 1 of the contract.
            unsafe { $e }
        })*
    };
}

/// An operation on both halves of the doubles.
macro_rules! halves {
    ($a:ident, $b:ident => $f:expr) => {
        [$f($a[0], $b[0]), $f($a[1], $b[1])]
    };
}
/// Byte `r` of lane `c` from byte `c` of lane `r`, in 16 bytes.
const TRANSPOSED: [u8; 16] = [0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15];

#[cfg(target_arch = "x86_64")]
mod avx2;
mod portable;

use super::Line;
use crate::raster::simd::Isa;
use crate::raster::vertex::Vertex;

/// Something to do on the lanes of an instruction set.
pub(in crate::raster) trait Work {
    type Output;
    fn run<L: Wide>(self, l: L) -> Self::Output;
}

/// Runs it on the best lanes of an instruction set that this machine has.
pub(in crate::raster) fn run<W: Work>(isa: Isa, work: W) -> W::Output {
    // Sets are ordered by width, and a machine with one has all narrower ones.
    match isa.min(Isa::best()) {
        Isa::Portable => work.run(portable::Portable),
        // SAFETY: `best` found it, or the wider one that a machine has besides.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 | Isa::Avx512 => unsafe { avx2::run(work) },
        #[cfg(not(target_arch = "x86_64"))]
        _ => work.run(portable::Portable),
    }
}

/// Lanes of floats `F`, integers `I`, doubles `D` and truths `M`.
pub(in crate::raster) trait Wide: Copy {
    /// How many: a divisor of 16, and at least 8.
    const N: usize;
    type F: Copy;
    type I: Copy;
    type D: Copy;
    type M: Copy;
    /// The same lanes in a function of its own, which is not copied into its caller.
    fn apart<W: Work>(self, work: W) -> W::Output;

    fn splat(self, v: f32) -> Self::F;
    /// 0, 1, 2, …
    fn lanes(self) -> Self::F;
    /// From the first `N` of a slice.
    fn load(self, from: &[f32]) -> Self::F;
    fn store(self, to: &mut [f32], v: Self::F);
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// `b` unless `a` is less.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// `b` unless `a` is greater.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    fn abs(self, a: Self::F) -> Self::F;
    fn gt(self, a: Self::F, b: Self::F) -> Self::M;
    fn ge(self, a: Self::F, b: Self::F) -> Self::M;
    /// `a` where the mask holds, else `b`.
    fn pick(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// The least integer that is no less; of 2³¹ and more, something that is at least 32 as an unsigned one.
    fn ceil(self, v: Self::F) -> Self::I;
    /// Toward zero; |v| < 2³¹.
    fn truncate(self, v: Self::F) -> Self::I;
    /// The least of all lanes.
    fn least(self, v: Self::F) -> f32;
    /// The greatest of all lanes.
    fn greatest(self, v: Self::F) -> f32;

    fn splat_i(self, v: i32) -> Self::I;
    fn load_i(self, from: &[i32]) -> Self::I;
    fn store_i(self, to: &mut [i32], v: Self::I);
    /// Wrapping, as the next two.
    fn add_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn sub_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn mul_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn min_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn max_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn and(self, a: Self::I, b: Self::I) -> Self::I;
    fn or(self, a: Self::I, b: Self::I) -> Self::I;
    fn xor(self, a: Self::I, b: Self::I) -> Self::I;
    /// Left by as many bits as each lane says; by 32 and more, as an unsigned number, 0 is left.
    fn shift_left(self, a: Self::I, by: Self::I) -> Self::I;
    /// Right, with the sign.
    fn shift_right<const BY: i32>(self, a: Self::I) -> Self::I;
    fn shift_up<const BY: i32>(self, a: Self::I) -> Self::I;
    fn gt_i(self, a: Self::I, b: Self::I) -> Self::M;
    fn eq_i(self, a: Self::I, b: Self::I) -> Self::M;
    fn pick_i(self, m: Self::M, a: Self::I, b: Self::I) -> Self::I;
    fn to_f(self, v: Self::I) -> Self::F;
    fn bits_of(self, v: Self::F) -> Self::I;
    fn of_bits(self, v: Self::I) -> Self::F;
    /// In each group of four lanes: byte `c` of lane `r` becomes byte `r` of lane `c`.
    fn transpose(self, v: Self::I) -> Self::I;

    /// The first `n` lanes.
    fn first(self, n: usize) -> Self::M;
    fn both(self, a: Self::M, b: Self::M) -> Self::M;
    fn either(self, a: Self::M, b: Self::M) -> Self::M;
    /// `a` and not `b`.
    fn without(self, a: Self::M, b: Self::M) -> Self::M;
    /// A bit for each lane.
    fn bits(self, m: Self::M) -> u32;

    fn splat_d(self, v: f64) -> Self::D;
    /// 0, 1, 2, …
    fn lanes_d(self) -> Self::D;
    fn store_d(self, to: &mut [f64], v: Self::D);
    fn int_to_d(self, v: Self::I) -> Self::D;
    fn to_d(self, v: Self::F) -> Self::D;
    fn add_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn sub_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn mul_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn div_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn min_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn max_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn abs_d(self, a: Self::D) -> Self::D;
    fn floor_d(self, a: Self::D) -> Self::D;
    fn ceil_d(self, a: Self::D) -> Self::D;
    fn gt_d(self, a: Self::D, b: Self::D) -> Self::M;
    fn pick_d(self, m: Self::M, a: Self::D, b: Self::D) -> Self::D;
    /// Rounded to f32.
    fn narrow(self, v: Self::D) -> Self::F;
    /// To the nearest integer, ties to even; |v| < 2³¹.
    fn nearest(self, v: Self::D) -> Self::I;

    /// The `N` tiles of `N / 4` lines: what they hold farthest, their working depths and masks, and what was
    /// ever covered.
    fn load_lines(self, from: &[Line]) -> (Self::F, Self::F, Self::I, Self::I);
    fn store_lines(self, to: &mut [Line], z: Self::F, zw: Self::F, w: Self::I, ever: Self::I);
    /// What the tiles hold farthest alone.
    fn load_farthest(self, from: &[Line]) -> Self::F;
    /// What was ever covered alone.
    fn load_ever(self, from: &[Line]) -> Self::I;
    /// Vertex `which` of `N` primitives: column, row, depth, the rest.
    fn gather(self, corners: &[Vertex], words: &[u64], which: usize) -> [Self::I; 4];
    /// The reverse of [`Wide::gather`]: `N` corners from their columns, rows, depths and the rest.
    fn store_corners(self, to: &mut [Vertex], v: [Self::I; 4]);
    /// Column and row of the tiles of a window, 0 to 3.
    fn tiles(self) -> (Self::F, Self::F);
    /// Column and row of the pixels of a tile, from its first row on.
    fn pixels(self) -> (Self::I, Self::I);
    /// Writes the lanes of a mask in order; what follows them, up to `N` in all, is undefined.
    fn compress(self, to: &mut [i32], m: Self::M, v: Self::I);
}
