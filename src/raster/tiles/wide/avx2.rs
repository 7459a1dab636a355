//! AVX2: eight lanes.
#![expect(unsafe_code, reason = "intrinsics")]

use std::arch::x86_64::*;

use super::{Line, TRANSPOSED, Vertex, Wide, Work};

/// # Safety
/// The machine has AVX2.
#[inline(never)]
#[target_feature(enable = "avx2")]
pub(super) unsafe fn run<W: Work>(work: W) -> W::Output {
    work.run(Avx2(()))
}

/// Exists only inside [`run`]; see the contract in the module above.
#[derive(Clone, Copy)]
pub(super) struct Avx2(());

/// For each mask of eight lanes their numbers in order.
static IN_ORDER: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut at) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][at] = lane as u32;
                at += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

type D = [__m256d; 2];

impl Wide for Avx2 {
    const N: usize = 8;
    type F = __m256;
    type I = __m256i;
    type D = D;
    type M = __m256i;
    #[inline(always)]
    fn apart<W: Work>(self, work: W) -> W::Output {
        // SAFETY: the token proves the instruction set.
        unsafe { run(work) }
    }
    ops! {
        fn splat(v: f32) -> __m256 = _mm256_set1_ps(v);
        fn lanes() -> __m256 = _mm256_setr_ps(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0);
        fn load(from: &[f32]) -> __m256 = _mm256_loadu_ps(from[..8].as_ptr());
        fn store(to: &mut [f32], v: __m256) -> () = _mm256_storeu_ps(to[..8].as_mut_ptr(), v);
        fn add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        fn sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps(a, b);
        fn mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        fn div(a: __m256, b: __m256) -> __m256 = _mm256_div_ps(a, b);
        fn min(a: __m256, b: __m256) -> __m256 = _mm256_min_ps(a, b);
        fn max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps(a, b);
        fn abs(a: __m256) -> __m256 = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        fn gt(a: __m256, b: __m256) -> __m256i = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GT_OQ>(a, b));
        fn ge(a: __m256, b: __m256) -> __m256i = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GE_OQ>(a, b));
        fn pick(m: __m256i, a: __m256, b: __m256) -> __m256 = _mm256_blendv_ps(b, a, _mm256_castsi256_ps(m));
        fn ceil(v: __m256) -> __m256i = _mm256_cvtps_epi32(_mm256_ceil_ps(v));
        fn truncate(v: __m256) -> __m256i = _mm256_cvttps_epi32(v);
        fn least(v: __m256) -> f32 = {
            let v = _mm_min_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps::<1>(v));
            let v = _mm_min_ps(v, _mm_movehl_ps(v, v));
            _mm_cvtss_f32(_mm_min_ss(v, _mm_shuffle_ps::<1>(v, v)))
        };
        fn greatest(v: __m256) -> f32 = {
            let v = _mm_max_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps::<1>(v));
            let v = _mm_max_ps(v, _mm_movehl_ps(v, v));
            _mm_cvtss_f32(_mm_max_ss(v, _mm_shuffle_ps::<1>(v, v)))
        };
        fn splat_i(v: i32) -> __m256i = _mm256_set1_epi32(v);
        fn load_i(from: &[i32]) -> __m256i = _mm256_loadu_si256(from[..8].as_ptr().cast());
        fn store_i(to: &mut [i32], v: __m256i) -> () = _mm256_storeu_si256(to[..8].as_mut_ptr().cast(), v);
        fn add_i(a: __m256i, b: __m256i) -> __m256i = _mm256_add_epi32(a, b);
        fn sub_i(a: __m256i, b: __m256i) -> __m256i = _mm256_sub_epi32(a, b);
        fn mul_i(a: __m256i, b: __m256i) -> __m256i = _mm256_mullo_epi32(a, b);
        fn min_i(a: __m256i, b: __m256i) -> __m256i = _mm256_min_epi32(a, b);
        fn max_i(a: __m256i, b: __m256i) -> __m256i = _mm256_max_epi32(a, b);
        fn and(a: __m256i, b: __m256i) -> __m256i = _mm256_and_si256(a, b);
        fn or(a: __m256i, b: __m256i) -> __m256i = _mm256_or_si256(a, b);
        fn xor(a: __m256i, b: __m256i) -> __m256i = _mm256_xor_si256(a, b);
        fn shift_left(a: __m256i, by: __m256i) -> __m256i = _mm256_sllv_epi32(a, by);
        fn gt_i(a: __m256i, b: __m256i) -> __m256i = _mm256_cmpgt_epi32(a, b);
        fn eq_i(a: __m256i, b: __m256i) -> __m256i = _mm256_cmpeq_epi32(a, b);
        fn pick_i(m: __m256i, a: __m256i, b: __m256i) -> __m256i = _mm256_blendv_epi8(b, a, m);
        fn to_f(v: __m256i) -> __m256 = _mm256_cvtepi32_ps(v);
        fn bits_of(v: __m256) -> __m256i = _mm256_castps_si256(v);
        fn of_bits(v: __m256i) -> __m256 = _mm256_castsi256_ps(v);
        fn transpose(v: __m256i) -> __m256i = {
            let table = _mm_loadu_si128(TRANSPOSED.as_ptr().cast());
            _mm256_shuffle_epi8(v, _mm256_broadcastsi128_si256(table))
        };
        fn first(n: usize) -> __m256i =
            _mm256_cmpgt_epi32(_mm256_set1_epi32(n as i32), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
        fn both(a: __m256i, b: __m256i) -> __m256i = _mm256_and_si256(a, b);
        fn either(a: __m256i, b: __m256i) -> __m256i = _mm256_or_si256(a, b);
        fn without(a: __m256i, b: __m256i) -> __m256i = _mm256_andnot_si256(b, a);
        fn bits(m: __m256i) -> u32 = _mm256_movemask_ps(_mm256_castsi256_ps(m)) as u32;
        fn splat_d(v: f64) -> D = [_mm256_set1_pd(v); 2];
        fn lanes_d() -> D = [_mm256_setr_pd(0.0, 1.0, 2.0, 3.0), _mm256_setr_pd(4.0, 5.0, 6.0, 7.0)];
        fn store_d(to: &mut [f64], v: D) -> () = {
            _mm256_storeu_pd(to[..4].as_mut_ptr(), v[0]);
            _mm256_storeu_pd(to[4..8].as_mut_ptr(), v[1]);
        };
        fn int_to_d(v: __m256i) -> D = [
            _mm256_cvtepi32_pd(_mm256_castsi256_si128(v)),
            _mm256_cvtepi32_pd(_mm256_extracti128_si256::<1>(v)),
        ];
        fn to_d(v: __m256) -> D =
            [_mm256_cvtps_pd(_mm256_castps256_ps128(v)), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(v))];
        fn add_d(a: D, b: D) -> D = halves!(a, b => _mm256_add_pd);
        fn sub_d(a: D, b: D) -> D = halves!(a, b => _mm256_sub_pd);
        fn mul_d(a: D, b: D) -> D = halves!(a, b => _mm256_mul_pd);
        fn div_d(a: D, b: D) -> D = halves!(a, b => _mm256_div_pd);
        fn min_d(a: D, b: D) -> D = halves!(a, b => _mm256_min_pd);
        fn max_d(a: D, b: D) -> D = halves!(a, b => _mm256_max_pd);
        fn abs_d(a: D) -> D =
            [_mm256_andnot_pd(_mm256_set1_pd(-0.0), a[0]), _mm256_andnot_pd(_mm256_set1_pd(-0.0), a[1])];
        fn floor_d(a: D) -> D = [_mm256_floor_pd(a[0]), _mm256_floor_pd(a[1])];
        fn ceil_d(a: D) -> D = [_mm256_ceil_pd(a[0]), _mm256_ceil_pd(a[1])];
        fn gt_d(a: D, b: D) -> __m256i = {
            let low = _mm256_castpd_ps(_mm256_cmp_pd::<_CMP_GT_OQ>(a[0], b[0]));
            let high = _mm256_castpd_ps(_mm256_cmp_pd::<_CMP_GT_OQ>(a[1], b[1]));
            // Both halves of a 64-bit lane are alike: every other 32 bits, then in order again.
            let every_other = _mm256_castps_si256(_mm256_shuffle_ps::<0x88>(low, high));
            _mm256_permute4x64_epi64::<0xd8>(every_other)
        };
        fn pick_d(m: __m256i, a: D, b: D) -> D = {
            let low = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(m));
            let high = _mm256_cvtepi32_epi64(_mm256_extracti128_si256::<1>(m));
            [
                _mm256_blendv_pd(b[0], a[0], _mm256_castsi256_pd(low)),
                _mm256_blendv_pd(b[1], a[1], _mm256_castsi256_pd(high)),
            ]
        };
        fn narrow(v: D) -> __m256 = _mm256_set_m128(_mm256_cvtpd_ps(v[1]), _mm256_cvtpd_ps(v[0]));
        fn nearest(v: D) -> __m256i = _mm256_set_m128i(_mm256_cvtpd_epi32(v[1]), _mm256_cvtpd_epi32(v[0]));
        fn load_lines(from: &[Line]) -> (__m256, __m256, __m256i, __m256i) = {
            let [a, b] = [&from[0], &from[1]];
            (
                _mm256_set_m128(_mm_load_ps(b.far.as_ptr()), _mm_load_ps(a.far.as_ptr())),
                _mm256_set_m128(_mm_load_ps(b.near.as_ptr()), _mm_load_ps(a.near.as_ptr())),
                _mm256_set_m128i(
                    _mm_load_si128(b.mask.as_ptr().cast()),
                    _mm_load_si128(a.mask.as_ptr().cast()),
                ),
                _mm256_set_m128i(
                    _mm_load_si128(b.ever.as_ptr().cast()),
                    _mm_load_si128(a.ever.as_ptr().cast()),
                ),
            )
        };
        fn store_lines(to: &mut [Line], z: __m256, zw: __m256, w: __m256i, ever: __m256i) -> () = {
            let [a, b] = &mut to[..2] else { unreachable!() };
            _mm_store_ps(a.far.as_mut_ptr(), _mm256_castps256_ps128(z));
            _mm_store_ps(a.near.as_mut_ptr(), _mm256_castps256_ps128(zw));
            _mm_store_si128(a.mask.as_mut_ptr().cast(), _mm256_castsi256_si128(w));
            _mm_store_si128(a.ever.as_mut_ptr().cast(), _mm256_castsi256_si128(ever));
            _mm_store_ps(b.far.as_mut_ptr(), _mm256_extractf128_ps::<1>(z));
            _mm_store_ps(b.near.as_mut_ptr(), _mm256_extractf128_ps::<1>(zw));
            _mm_store_si128(b.mask.as_mut_ptr().cast(), _mm256_extracti128_si256::<1>(w));
            _mm_store_si128(b.ever.as_mut_ptr().cast(), _mm256_extracti128_si256::<1>(ever));
        };
        fn load_farthest(from: &[Line]) -> __m256 =
            _mm256_set_m128(_mm_load_ps(from[1].far.as_ptr()), _mm_load_ps(from[0].far.as_ptr()));
        fn load_ever(from: &[Line]) -> __m256i = _mm256_set_m128i(
            _mm_load_si128(from[1].ever.as_ptr().cast()),
            _mm_load_si128(from[0].ever.as_ptr().cast()),
        );
        fn gather(corners: &[Vertex], words: &[u64], which: usize) -> [__m256i; 4] = {
            let words = &words[..8];
            macro_rules! corner { ($i:expr) => {{
                let at = (words[$i] >> (16 * which) & 0x1ff) as usize;
                _mm_loadu_si128(std::ptr::from_ref(&corners[at]).cast())
            }}; }
            let rows = each!(4; i => _mm256_set_m128i(corner!(i + 4), corner!(i)));
            let (a, b) = (_mm256_unpacklo_epi32(rows[0], rows[1]), _mm256_unpackhi_epi32(rows[0], rows[1]));
            let (c, d) = (_mm256_unpacklo_epi32(rows[2], rows[3]), _mm256_unpackhi_epi32(rows[2], rows[3]));
            [
                _mm256_unpacklo_epi64(a, c),
                _mm256_unpackhi_epi64(a, c),
                _mm256_unpacklo_epi64(b, d),
                _mm256_unpackhi_epi64(b, d),
            ]
        };
        fn store_corners(to: &mut [Vertex], v: [__m256i; 4]) -> () = {
            let to = &mut to[..8];
            let (a, b) = (_mm256_unpacklo_epi32(v[0], v[1]), _mm256_unpackhi_epi32(v[0], v[1]));
            let (c, d) = (_mm256_unpacklo_epi32(v[2], v[3]), _mm256_unpackhi_epi32(v[2], v[3]));
            let rows = [
                _mm256_unpacklo_epi64(a, c),
                _mm256_unpackhi_epi64(a, c),
                _mm256_unpacklo_epi64(b, d),
                _mm256_unpackhi_epi64(b, d),
            ];
            for (i, row) in rows.into_iter().enumerate() {
                _mm_storeu_si128(std::ptr::from_mut(&mut to[i]).cast(), _mm256_castsi256_si128(row));
                let upper = _mm256_extracti128_si256::<1>(row);
                _mm_storeu_si128(std::ptr::from_mut(&mut to[i + 4]).cast(), upper);
            }
        };
        fn tiles() -> (__m256, __m256) = (
            _mm256_setr_ps(0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0),
            _mm256_setr_ps(0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0),
        );
        fn pixels() -> (__m256i, __m256i) =
            (_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), _mm256_setzero_si256());
    }
    #[inline(always)]
    fn compress(self, to: &mut [i32], m: __m256i, v: __m256i) {
        let order = &IN_ORDER[self.bits(m) as usize & 255];
        // SAFETY: point 1 of the contract, and the table's rows are as long as the access.
        let v = unsafe { _mm256_permutevar8x32_epi32(v, _mm256_loadu_si256(order.as_ptr().cast())) };
        self.store_i(to, v);
    }
    #[inline(always)]
    fn shift_right<const BY: i32>(self, a: __m256i) -> __m256i {
        // SAFETY: point 1 of the contract.
        unsafe { _mm256_srai_epi32::<BY>(a) }
    }
    #[inline(always)]
    fn shift_up<const BY: i32>(self, a: __m256i) -> __m256i {
        // SAFETY: point 1 of the contract.
        unsafe { _mm256_slli_epi32::<BY>(a) }
    }
}
