//! AVX-512: sixteen lanes.
#![expect(unsafe_code, reason = "intrinsics")]

use std::arch::x86_64::*;

use super::{Line, TRANSPOSED, Vertex, Wide, Work};

/// # Safety
/// The machine has AVX-512 F, DQ, BW and VL, and with them BMI, LZCNT and POPCNT.
#[inline(never)]
#[target_feature(enable = "avx512f,avx512dq,avx512bw,avx512vl,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn run<W: Work>(work: W) -> W::Output {
    work.run(Avx512(()))
}

/// Exists only inside [`run`]; see the contract in the module above.
#[derive(Clone, Copy)]
pub(super) struct Avx512(());

/// The compiler does not find this instruction behind the intrinsic's definition, and compares first.
#[inline]
#[target_feature(enable = "avx512f")]
fn shift_left_512(a: __m512i, by: __m512i) -> __m512i {
    let shifted: __m512i;
    // SAFETY: it touches nothing but the three registers.
    unsafe {
        std::arch::asm!(
            "vpsllvd {o}, {a}, {n}",
            o = lateout(zmm_reg) shifted, a = in(zmm_reg) a, n = in(zmm_reg) by,
            options(pure, nomem, nostack, preserves_flags)
        );
    }
    shifted
}

type D = [__m512d; 2];

impl Wide for Avx512 {
    const N: usize = 16;
    type F = __m512;
    type I = __m512i;
    type D = D;
    type M = __mmask16;
    #[inline(always)]
    fn apart<W: Work>(self, work: W) -> W::Output {
        // SAFETY: the token proves the instruction set.
        unsafe { run(work) }
    }
    ops! {
        fn splat(v: f32) -> __m512 = _mm512_set1_ps(v);
        fn lanes() -> __m512 = _mm512_setr_ps(
            0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0,
        );
        fn load(from: &[f32]) -> __m512 = _mm512_loadu_ps(from[..16].as_ptr());
        fn store(to: &mut [f32], v: __m512) -> () = _mm512_storeu_ps(to[..16].as_mut_ptr(), v);
        fn add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        fn sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        fn mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        fn div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        fn min(a: __m512, b: __m512) -> __m512 = _mm512_min_ps(a, b);
        fn max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        fn abs(a: __m512) -> __m512 = _mm512_abs_ps(a);
        fn gt(a: __m512, b: __m512) -> __mmask16 = _mm512_cmp_ps_mask::<_CMP_GT_OQ>(a, b);
        fn ge(a: __m512, b: __m512) -> __mmask16 = _mm512_cmp_ps_mask::<_CMP_GE_OQ>(a, b);
        fn pick(m: __mmask16, a: __m512, b: __m512) -> __m512 = _mm512_mask_blend_ps(m, b, a);
        fn ceil(v: __m512) -> __m512i =
            _mm512_cvt_roundps_epi32::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(v);
        fn truncate(v: __m512) -> __m512i = _mm512_cvttps_epi32(v);
        fn least(v: __m512) -> f32 = _mm512_reduce_min_ps(v);
        fn greatest(v: __m512) -> f32 = _mm512_reduce_max_ps(v);
        fn splat_i(v: i32) -> __m512i = _mm512_set1_epi32(v);
        fn load_i(from: &[i32]) -> __m512i = _mm512_loadu_si512(from[..16].as_ptr().cast());
        fn store_i(to: &mut [i32], v: __m512i) -> () = _mm512_storeu_si512(to[..16].as_mut_ptr().cast(), v);
        fn add_i(a: __m512i, b: __m512i) -> __m512i = _mm512_add_epi32(a, b);
        fn sub_i(a: __m512i, b: __m512i) -> __m512i = _mm512_sub_epi32(a, b);
        fn mul_i(a: __m512i, b: __m512i) -> __m512i = _mm512_mullo_epi32(a, b);
        fn min_i(a: __m512i, b: __m512i) -> __m512i = _mm512_min_epi32(a, b);
        fn max_i(a: __m512i, b: __m512i) -> __m512i = _mm512_max_epi32(a, b);
        fn and(a: __m512i, b: __m512i) -> __m512i = _mm512_and_si512(a, b);
        fn or(a: __m512i, b: __m512i) -> __m512i = _mm512_or_si512(a, b);
        fn xor(a: __m512i, b: __m512i) -> __m512i = _mm512_xor_si512(a, b);
        fn shift_left(a: __m512i, by: __m512i) -> __m512i = shift_left_512(a, by);
        fn gt_i(a: __m512i, b: __m512i) -> __mmask16 = _mm512_cmpgt_epi32_mask(a, b);
        fn eq_i(a: __m512i, b: __m512i) -> __mmask16 = _mm512_cmpeq_epi32_mask(a, b);
        fn pick_i(m: __mmask16, a: __m512i, b: __m512i) -> __m512i = _mm512_mask_blend_epi32(m, b, a);
        fn to_f(v: __m512i) -> __m512 = _mm512_cvtepi32_ps(v);
        fn bits_of(v: __m512) -> __m512i = _mm512_castps_si512(v);
        fn of_bits(v: __m512i) -> __m512 = _mm512_castsi512_ps(v);
        fn transpose(v: __m512i) -> __m512i = {
            let table = _mm_loadu_si128(TRANSPOSED.as_ptr().cast());
            _mm512_shuffle_epi8(v, _mm512_broadcast_i32x4(table))
        };
        fn splat_d(v: f64) -> D = [_mm512_set1_pd(v); 2];
        fn lanes_d() -> D = [
            _mm512_setr_pd(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0),
            _mm512_setr_pd(8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0),
        ];
        fn store_d(to: &mut [f64], v: D) -> () = {
            _mm512_storeu_pd(to[..8].as_mut_ptr(), v[0]);
            _mm512_storeu_pd(to[8..16].as_mut_ptr(), v[1]);
        };
        fn int_to_d(v: __m512i) -> D = [
            _mm512_cvtepi32_pd(_mm512_castsi512_si256(v)),
            _mm512_cvtepi32_pd(_mm512_extracti64x4_epi64::<1>(v)),
        ];
        fn to_d(v: __m512) -> D =
            [_mm512_cvtps_pd(_mm512_castps512_ps256(v)), _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(v))];
        fn add_d(a: D, b: D) -> D = halves!(a, b => _mm512_add_pd);
        fn sub_d(a: D, b: D) -> D = halves!(a, b => _mm512_sub_pd);
        fn mul_d(a: D, b: D) -> D = halves!(a, b => _mm512_mul_pd);
        fn div_d(a: D, b: D) -> D = halves!(a, b => _mm512_div_pd);
        fn min_d(a: D, b: D) -> D = halves!(a, b => _mm512_min_pd);
        fn max_d(a: D, b: D) -> D = halves!(a, b => _mm512_max_pd);
        fn abs_d(a: D) -> D = [_mm512_abs_pd(a[0]), _mm512_abs_pd(a[1])];
        fn floor_d(a: D) -> D = [
            _mm512_roundscale_pd::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a[0]),
            _mm512_roundscale_pd::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a[1]),
        ];
        fn ceil_d(a: D) -> D = [
            _mm512_roundscale_pd::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(a[0]),
            _mm512_roundscale_pd::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(a[1]),
        ];
        fn gt_d(a: D, b: D) -> __mmask16 = u16::from(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(a[0], b[0]))
            | u16::from(_mm512_cmp_pd_mask::<_CMP_GT_OQ>(a[1], b[1])) << 8;
        fn pick_d(m: __mmask16, a: D, b: D) -> D = [
            _mm512_mask_blend_pd(m as u8, b[0], a[0]),
            _mm512_mask_blend_pd((m >> 8) as u8, b[1], a[1]),
        ];
        fn narrow(v: D) -> __m512 = _mm512_insertf32x8::<1>(
            _mm512_castps256_ps512(_mm512_cvtpd_ps(v[0])),
            _mm512_cvtpd_ps(v[1]),
        );
        fn nearest(v: D) -> __m512i = _mm512_inserti64x4::<1>(
            _mm512_castsi256_si512(_mm512_cvtpd_epi32(v[0])),
            _mm512_cvtpd_epi32(v[1]),
        );
        fn load_lines(from: &[Line]) -> (__m512, __m512, __m512i, __m512i) = {
            let from = &from[..4];
            let [a, b, c, d] =
                each!(4; i => _mm512_load_si512(std::ptr::from_ref(&from[i]).cast()));
            // A transposition of four by four parts of 16 bytes.
            let (p, q) = (_mm512_shuffle_i32x4::<0x44>(a, b), _mm512_shuffle_i32x4::<0x44>(c, d));
            let (r, s) = (_mm512_shuffle_i32x4::<0xee>(a, b), _mm512_shuffle_i32x4::<0xee>(c, d));
            (
                _mm512_castsi512_ps(_mm512_shuffle_i32x4::<0x88>(p, q)),
                _mm512_castsi512_ps(_mm512_shuffle_i32x4::<0xdd>(p, q)),
                _mm512_shuffle_i32x4::<0x88>(r, s),
                _mm512_shuffle_i32x4::<0xdd>(r, s),
            )
        };
        fn store_lines(to: &mut [Line], z: __m512, zw: __m512, w: __m512i, ever: __m512i) -> () = {
            let to = &mut to[..4];
            let (z, zw) = (_mm512_castps_si512(z), _mm512_castps_si512(zw));
            let (p, q) = (_mm512_shuffle_i32x4::<0x44>(z, zw), _mm512_shuffle_i32x4::<0xee>(z, zw));
            let (r, s) = (_mm512_shuffle_i32x4::<0x44>(w, ever), _mm512_shuffle_i32x4::<0xee>(w, ever));
            let lines = [
                _mm512_shuffle_i32x4::<0x88>(p, r),
                _mm512_shuffle_i32x4::<0xdd>(p, r),
                _mm512_shuffle_i32x4::<0x88>(q, s),
                _mm512_shuffle_i32x4::<0xdd>(q, s),
            ];
            for (to, v) in to.iter_mut().zip(lines) {
                _mm512_store_si512(std::ptr::from_mut(to).cast(), v);
            }
        };
        fn load_farthest(from: &[Line]) -> __m512 = {
            let from = &from[..4];
            let [a, b, c, d] = each!(4; i => _mm_load_ps(from[i].far.as_ptr()));
            let v = _mm512_insertf32x4::<1>(_mm512_castps128_ps512(a), b);
            _mm512_insertf32x4::<3>(_mm512_insertf32x4::<2>(v, c), d)
        };
        fn load_ever(from: &[Line]) -> __m512i = {
            let from = &from[..4];
            let [a, b, c, d] = each!(4; i => _mm_load_si128(from[i].ever.as_ptr().cast()));
            let v = _mm512_inserti32x4::<1>(_mm512_castsi128_si512(a), b);
            _mm512_inserti32x4::<3>(_mm512_inserti32x4::<2>(v, c), d)
        };
        fn gather(corners: &[Vertex], words: &[u64], which: usize) -> [__m512i; 4] = {
            let words = &words[..16];
            macro_rules! corner { ($i:expr) => {{
                let at = (words[$i] >> (16 * which) & 0x1ff) as usize;
                _mm_loadu_si128(std::ptr::from_ref(&corners[at]).cast())
            }}; }
            let rows = each!(4; i => {
                let v = _mm512_inserti32x4::<1>(_mm512_castsi128_si512(corner!(i)), corner!(i + 4));
                _mm512_inserti32x4::<3>(_mm512_inserti32x4::<2>(v, corner!(i + 8)), corner!(i + 12))
            });
            let (a, b) = (_mm512_unpacklo_epi32(rows[0], rows[1]), _mm512_unpackhi_epi32(rows[0], rows[1]));
            let (c, d) = (_mm512_unpacklo_epi32(rows[2], rows[3]), _mm512_unpackhi_epi32(rows[2], rows[3]));
            [
                _mm512_unpacklo_epi64(a, c),
                _mm512_unpackhi_epi64(a, c),
                _mm512_unpacklo_epi64(b, d),
                _mm512_unpackhi_epi64(b, d),
            ]
        };
        fn store_corners(to: &mut [Vertex], v: [__m512i; 4]) -> () = {
            let to = &mut to[..16];
            let (a, b) = (_mm512_unpacklo_epi32(v[0], v[1]), _mm512_unpackhi_epi32(v[0], v[1]));
            let (c, d) = (_mm512_unpacklo_epi32(v[2], v[3]), _mm512_unpackhi_epi32(v[2], v[3]));
            let rows = [
                _mm512_unpacklo_epi64(a, c),
                _mm512_unpackhi_epi64(a, c),
                _mm512_unpacklo_epi64(b, d),
                _mm512_unpackhi_epi64(b, d),
            ];
            for (i, row) in rows.into_iter().enumerate() {
                let parts = [
                    _mm512_castsi512_si128(row),
                    _mm512_extracti32x4_epi32::<1>(row),
                    _mm512_extracti32x4_epi32::<2>(row),
                    _mm512_extracti32x4_epi32::<3>(row),
                ];
                for (k, part) in parts.into_iter().enumerate() {
                    _mm_storeu_si128(std::ptr::from_mut(&mut to[i + 4 * k]).cast(), part);
                }
            }
        };
        fn tiles() -> (__m512, __m512) = (
            _mm512_setr_ps(
                0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0,
            ),
            _mm512_setr_ps(
                0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0, 3.0, 3.0,
            ),
        );
        fn pixels() -> (__m512i, __m512i) = (
            _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7),
            _mm512_setr_epi32(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1),
        );
        fn compress(to: &mut [i32], m: __mmask16, v: __m512i) -> () =
            _mm512_storeu_si512(to[..16].as_mut_ptr().cast(), _mm512_maskz_compress_epi32(m, v));
    }
    #[inline(always)]
    fn first(self, n: usize) -> __mmask16 {
        ((1u32 << n.min(16)) - 1) as u16
    }
    #[inline(always)]
    fn both(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }
    #[inline(always)]
    fn either(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        a | b
    }
    #[inline(always)]
    fn without(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        a & !b
    }
    #[inline(always)]
    fn bits(self, m: __mmask16) -> u32 {
        u32::from(m)
    }
    #[inline(always)]
    fn shift_right<const BY: i32>(self, a: __m512i) -> __m512i {
        // SAFETY: point 1 of the contract.
        unsafe { _mm512_sra_epi32(a, _mm_cvtsi32_si128(BY)) }
    }
    #[inline(always)]
    fn shift_up<const BY: i32>(self, a: __m512i) -> __m512i {
        // SAFETY: point 1 of the contract.
        unsafe { _mm512_sll_epi32(a, _mm_cvtsi32_si128(BY)) }
    }
}
