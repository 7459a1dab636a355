//! SIMD chosen at run time: one generic kernel, thin shells for each instruction set.
//!
//! 1. A piece of [`Work`] is generic over [`Lanes`] and inlined into one function for each instruction set
//!    ([`run`]), so that the whole loop is compiled for it, not only the operations.
//! 2. [`Lanes`] is a token that exists only where its instruction set does, so its operations are safe to
//!    call.
//! 3. Every operation is the same IEEE or integer operation per lane on every set (no fused multiply-add), so
//!    the width leaves no trace in the image.
#![cfg_attr(target_arch = "x86_64", expect(unsafe_code, reason = "intrinsics"))]

/// An instruction set for filling pixels, ascending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// Plain code that every machine runs.
    Portable,
    /// 8 pixels at a time.
    Avx2,
    /// 16 pixels at a time.
    Avx512,
}

impl Isa {
    /// The best that this machine has, which is the widest.
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            // F for the arithmetic, DQ for masks from signs, VL since compilers mix in its shorter vectors.
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
            {
                return Self::Avx512;
            }
            if is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Portable
    }
    /// One word for tables.
    pub fn label(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

/// Work that is compiled once for each instruction set; `run` must be inlined.
pub(super) trait Work {
    fn run<L: Lanes>(self, lanes: L);
}

/// Runs the work on the best instruction set that the machine has.
pub(super) fn run_best<W: Work>(work: W) {
    // The widest of all; `run` looks for what is there, once.
    run(Isa::Avx512, work);
}

/// Runs the work on `isa` or, where that is missing, on the best there is.
pub(super) fn run<W: Work>(isa: Isa, work: W) {
    // Sets are ordered by width, and a machine with one has all narrower ones.
    match isa.min(Isa::best()) {
        Isa::Portable => work.run(portable::Portable),
        // SAFETY: `best` found the instruction set.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => unsafe { x86::run_avx2(work) },
        // SAFETY: `best` found the instruction set.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => unsafe { x86::run_avx512(work) },
        #[cfg(not(target_arch = "x86_64"))]
        _ => work.run(portable::Portable),
    }
}

/// A row of `N` neighboring pixels.
pub(super) trait Lanes: Copy {
    const N: usize;
    type F: Copy;
    type I: Copy;
    type M: Copy;
    fn splat(self, v: f32) -> Self::F;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// The greater of `low` and the lesser of `v` and `high`; none is NaN.
    fn clamp(self, v: Self::F, low: Self::F, high: Self::F) -> Self::F;
    /// As floats, exact below 2²⁴.
    fn to_f(self, v: Self::I) -> Self::F;
    /// `start + lane · step`, wrapping.
    fn ramp(self, start: i32, step: i32) -> Self::I;
    fn splat_i(self, v: i32) -> Self::I;
    fn add_i(self, a: Self::I, b: Self::I) -> Self::I;
    /// The lanes of `among` where none of the three is negative.
    fn none_negative(self, a: Self::I, b: Self::I, c: Self::I, among: Self::M) -> Self::M;
    /// The first lanes, at most `N`.
    fn first(self, lanes: usize) -> Self::M;
    /// Puts `z` and `ids` where `inside` and nearer than what is there, or as near with a lower id. Of slices
    /// that are longer than `N` the first `N` elements are read, and those outside written as they were.
    fn merge(self, depth: &mut [f32], item: &mut [u32], inside: Self::M, z: Self::F, ids: Self::I);
}

mod portable {
    //! Four lanes in arrays, which compilers turn into what SIMD the target is known to have.
    use super::Lanes;

    #[derive(Clone, Copy)]
    /// Runs anywhere.
    pub struct Portable;
    /// The width of SSE2 and NEON, which every x86-64 and every 64-bit ARM machine has: more lanes would take
    /// several registers, fewer would leave them empty.
    const N: usize = 4;

    impl Lanes for Portable {
        const N: usize = N;
        type F = [f32; N];
        type I = [i32; N];
        type M = [bool; N];
        #[inline(always)]
        fn splat(self, v: f32) -> Self::F {
            [v; N]
        }
        #[inline(always)]
        fn add(self, a: Self::F, b: Self::F) -> Self::F {
            std::array::from_fn(|i| a[i] + b[i])
        }
        #[inline(always)]
        fn mul(self, a: Self::F, b: Self::F) -> Self::F {
            std::array::from_fn(|i| a[i] * b[i])
        }
        #[inline(always)]
        fn clamp(self, v: Self::F, low: Self::F, high: Self::F) -> Self::F {
            std::array::from_fn(|i| {
                // Comparisons are one instruction; `f32::max` and `min`, which mind NaN, are several.
                let v = if v[i] > low[i] { v[i] } else { low[i] };
                if v < high[i] { v } else { high[i] }
            })
        }
        #[inline(always)]
        fn to_f(self, v: Self::I) -> Self::F {
            v.map(|v| v as f32)
        }
        #[inline(always)]
        fn ramp(self, start: i32, step: i32) -> Self::I {
            std::array::from_fn(|i| start.wrapping_add((i as i32).wrapping_mul(step)))
        }
        #[inline(always)]
        fn splat_i(self, v: i32) -> Self::I {
            [v; N]
        }
        #[inline(always)]
        fn add_i(self, a: Self::I, b: Self::I) -> Self::I {
            std::array::from_fn(|i| a[i].wrapping_add(b[i]))
        }
        #[inline(always)]
        fn none_negative(self, a: Self::I, b: Self::I, c: Self::I, among: Self::M) -> Self::M {
            // The sign bit of the three together is clear where all are clear.
            std::array::from_fn(|i| (a[i] | b[i] | c[i] >= 0) & among[i])
        }
        #[inline(always)]
        fn first(self, lanes: usize) -> Self::M {
            std::array::from_fn(|i| i < lanes)
        }
        #[inline(always)]
        fn merge(self, depth: &mut [f32], item: &mut [u32], inside: Self::M, z: Self::F, ids: Self::I) {
            for ((((depth, item), inside), z), id) in depth.iter_mut().zip(item).zip(inside).zip(z).zip(ids) {
                let id = id as u32;
                // `&` and `|` instead of `&&` and `||`: without branches the loop becomes SIMD.
                let wins = inside & ((z > *depth) | ((z == *depth) & (id < *item)));
                *depth = if wins { z } else { *depth };
                *item = if wins { id } else { *item };
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Lanes, Work};
    use std::arch::x86_64::*;

    /// # Safety
    /// The machine has AVX2.
    #[target_feature(enable = "avx2")]
    pub unsafe fn run_avx2<W: Work>(work: W) {
        work.run(Avx2(()));
    }
    /// # Safety
    /// The machine has AVX-512 F, DQ and VL.
    #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
    pub unsafe fn run_avx512<W: Work>(work: W) {
        work.run(Avx512(()));
    }

    /// Exists only inside [`run_avx2`].
    #[derive(Clone, Copy)]
    pub struct Avx2(());
    /// Exists only inside [`run_avx512`].
    #[derive(Clone, Copy)]
    pub struct Avx512(());

    // The contract of both tokens, on which every unsafe block below rests:
    //
    // 1. A token proves its instruction set. Its field is private to this module, and only `run_avx2` and
    //    `run_avx512` make one, whose callers promise the set. Intrinsics that take and give values, as most
    //    here do, need nothing else.
    // 2. `merge` alone touches memory: a whole vector where each slice has at least as many
    //    elements, which it borrows alone and so may write back as they were; else through masks, a lane only
    //    where its number is below the length of each slice. The unaligned forms are used throughout.
    impl Lanes for Avx2 {
        const N: usize = 8;
        type F = __m256;
        type I = __m256i;
        type M = __m256i;
        #[inline(always)]
        fn splat(self, v: f32) -> __m256 {
            unsafe { _mm256_set1_ps(v) }
        }
        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_add_ps(a, b) }
        }
        #[inline(always)]
        fn mul(self, a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_mul_ps(a, b) }
        }
        #[inline(always)]
        fn clamp(self, v: __m256, low: __m256, high: __m256) -> __m256 {
            unsafe { _mm256_min_ps(_mm256_max_ps(v, low), high) }
        }
        #[inline(always)]
        fn to_f(self, v: __m256i) -> __m256 {
            unsafe { _mm256_cvtepi32_ps(v) }
        }
        #[inline(always)]
        fn ramp(self, start: i32, step: i32) -> __m256i {
            unsafe {
                let lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
                _mm256_add_epi32(_mm256_set1_epi32(start), _mm256_mullo_epi32(lane, _mm256_set1_epi32(step)))
            }
        }
        #[inline(always)]
        fn splat_i(self, v: i32) -> __m256i {
            unsafe { _mm256_set1_epi32(v) }
        }
        #[inline(always)]
        fn add_i(self, a: __m256i, b: __m256i) -> __m256i {
            unsafe { _mm256_add_epi32(a, b) }
        }
        #[inline(always)]
        fn none_negative(self, a: __m256i, b: __m256i, c: __m256i, among: __m256i) -> __m256i {
            // As in the portable code: a set sign bit takes the lane out.
            unsafe {
                _mm256_andnot_si256(_mm256_srai_epi32::<31>(_mm256_or_si256(_mm256_or_si256(a, b), c)), among)
            }
        }
        #[inline(always)]
        fn first(self, lanes: usize) -> __m256i {
            unsafe {
                let lane = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
                _mm256_cmpgt_epi32(_mm256_set1_epi32(lanes as i32), lane)
            }
        }
        #[inline(always)]
        fn merge(self, depth: &mut [f32], item: &mut [u32], inside: __m256i, z: __m256, ids: __m256i) {
            let lanes = depth.len().min(item.len());
            let (whole, depth, item) = (lanes >= 8, depth.as_mut_ptr(), item.as_mut_ptr().cast::<i32>());
            unsafe {
                // 1. The lanes of short slices that are masked out are never touched.
                let inside = if whole { inside } else { _mm256_and_si256(inside, self.first(lanes)) };
                // 2. The depth test. Where a lane is out, `old` is 0, and the mask keeps it out.
                let old = if whole { _mm256_loadu_ps(depth) } else { _mm256_maskload_ps(depth, inside) };
                let nearer = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GT_OQ>(z, old));
                let equal = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_EQ_OQ>(z, old));
                let mut wins = _mm256_and_si256(nearer, inside);
                let tied = _mm256_and_si256(equal, inside);
                // 3. Ties go to the lower id. They are rare, so items are read only here.
                if _mm256_testz_si256(tied, tied) == 0 {
                    // Unsigned comparison by a flip of the sign bits.
                    let flip = _mm256_set1_epi32(i32::MIN);
                    let old_ids = if whole {
                        _mm256_loadu_si256(item.cast())
                    } else {
                        _mm256_maskload_epi32(item, tied)
                    };
                    let lower =
                        _mm256_cmpgt_epi32(_mm256_xor_si256(old_ids, flip), _mm256_xor_si256(ids, flip));
                    wins = _mm256_or_si256(wins, _mm256_and_si256(tied, lower));
                }
                // 4. Most vectors of hidden surfaces end without a store. Masked stores are microcode on many
                // machines, so a whole vector is put together first.
                if _mm256_testz_si256(wins, wins) != 0 {
                    return;
                }
                if whole {
                    _mm256_storeu_ps(depth, _mm256_blendv_ps(old, z, _mm256_castsi256_ps(wins)));
                    let old_ids = _mm256_loadu_si256(item.cast());
                    _mm256_storeu_si256(item.cast(), _mm256_blendv_epi8(old_ids, ids, wins));
                } else {
                    _mm256_maskstore_ps(depth, wins, z);
                    _mm256_maskstore_epi32(item, wins, ids);
                }
            }
        }
    }

    impl Lanes for Avx512 {
        const N: usize = 16;
        type F = __m512;
        type I = __m512i;
        type M = __mmask16;
        #[inline(always)]
        fn splat(self, v: f32) -> __m512 {
            unsafe { _mm512_set1_ps(v) }
        }
        #[inline(always)]
        fn add(self, a: __m512, b: __m512) -> __m512 {
            unsafe { _mm512_add_ps(a, b) }
        }
        #[inline(always)]
        fn mul(self, a: __m512, b: __m512) -> __m512 {
            unsafe { _mm512_mul_ps(a, b) }
        }
        #[inline(always)]
        fn clamp(self, v: __m512, low: __m512, high: __m512) -> __m512 {
            unsafe { _mm512_min_ps(_mm512_max_ps(v, low), high) }
        }
        #[inline(always)]
        fn to_f(self, v: __m512i) -> __m512 {
            unsafe { _mm512_cvtepi32_ps(v) }
        }
        #[inline(always)]
        fn ramp(self, start: i32, step: i32) -> __m512i {
            unsafe {
                let lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
                _mm512_add_epi32(_mm512_set1_epi32(start), _mm512_mullo_epi32(lane, _mm512_set1_epi32(step)))
            }
        }
        #[inline(always)]
        fn splat_i(self, v: i32) -> __m512i {
            unsafe { _mm512_set1_epi32(v) }
        }
        #[inline(always)]
        fn add_i(self, a: __m512i, b: __m512i) -> __m512i {
            unsafe { _mm512_add_epi32(a, b) }
        }
        #[inline(always)]
        fn none_negative(self, a: __m512i, b: __m512i, c: __m512i, among: __mmask16) -> __mmask16 {
            // A mask of the sign bits, turned around.
            unsafe { !_mm512_movepi32_mask(_mm512_or_si512(_mm512_or_si512(a, b), c)) & among }
        }
        #[inline(always)]
        fn first(self, lanes: usize) -> __mmask16 {
            // A shift of 32 bits, since all 16 lanes may be in.
            ((1u32 << lanes) - 1) as u16
        }
        #[inline(always)]
        fn merge(self, depth: &mut [f32], item: &mut [u32], inside: __mmask16, z: __m512, ids: __m512i) {
            // 1 to 4 as for AVX2, whose masks are cheap in this set.
            let inside = inside & self.first(depth.len().min(item.len()).min(16));
            unsafe {
                let old = _mm512_maskz_loadu_ps(inside, depth.as_ptr());
                let mut wins = _mm512_mask_cmp_ps_mask::<_CMP_GT_OQ>(inside, z, old);
                let tied = _mm512_mask_cmp_ps_mask::<_CMP_EQ_OQ>(inside, z, old);
                if tied != 0 {
                    let old_id = _mm512_maskz_loadu_epi32(tied, item.as_ptr().cast());
                    wins |= _mm512_mask_cmplt_epu32_mask(tied, ids, old_id);
                }
                if wins != 0 {
                    _mm512_mask_storeu_ps(depth.as_mut_ptr(), wins, z);
                    _mm512_mask_storeu_epi32(item.as_mut_ptr().cast(), wins, ids);
                }
            }
        }
    }
}
