//! Sixteen lanes: AVX-512 F, VL, DQ and BW.

use super::Lanes;
use super::avx2::two;
use std::arch::x86_64::*;

#[derive(Clone, Copy)]
pub(crate) struct Avx512;

const N: usize = 16;

/// The records of the indices at 0, 4, 8 and 12.
///
/// # Safety
/// As for [`Lanes::gather4`].
#[inline(always)]
unsafe fn quad<const STRIDE: usize>(base: *const [f32; 4], index: *const u32) -> __m512 {
    // SAFETY: as promised.
    unsafe {
        let v = _mm512_castps128_ps512(_mm_loadu_ps(base.add(STRIDE * *index as usize).cast()));
        let v = _mm512_insertf32x4::<1>(
            v,
            _mm_loadu_ps(base.add(STRIDE * *index.add(4) as usize).cast()),
        );
        let v = _mm512_insertf32x4::<2>(
            v,
            _mm_loadu_ps(base.add(STRIDE * *index.add(8) as usize).cast()),
        );
        _mm512_insertf32x4::<3>(
            v,
            _mm_loadu_ps(base.add(STRIDE * *index.add(12) as usize).cast()),
        )
    }
}

/// The records of the indices at 0 and 1, 4 and 5, 8 and 9, 12 and 13.
///
/// # Safety
/// As for [`Lanes::gather2`].
#[inline(always)]
unsafe fn pairs(base: *const [f32; 2], index: *const u32) -> __m512 {
    // SAFETY: as promised.
    unsafe {
        let v = _mm512_castps128_ps512(two(base, index));
        let v = _mm512_insertf32x4::<1>(v, two(base, index.add(4)));
        let v = _mm512_insertf32x4::<2>(v, two(base, index.add(8)));
        _mm512_insertf32x4::<3>(v, two(base, index.add(12)))
    }
}

// SAFETY (whole file): the caller runs on a processor with these instruction sets, and pointers
// are good for the lanes that the trait's contract names.
#[allow(clippy::undocumented_unsafe_blocks)]
impl Lanes for Avx512 {
    const N: usize = N;
    type F = __m512;
    type U = __m512i;
    type M = __mmask16;

    #[inline(always)]
    unsafe fn splat(x: f32) -> __m512 {
        unsafe { _mm512_set1_ps(x) }
    }
    #[inline(always)]
    unsafe fn load(p: *const f32) -> __m512 {
        unsafe { _mm512_loadu_ps(p) }
    }
    #[inline(always)]
    unsafe fn store(p: *mut f32, v: __m512) {
        unsafe { _mm512_storeu_ps(p, v) }
    }
    #[inline(always)]
    unsafe fn store_first(p: *mut f32, v: __m512, n: usize) {
        unsafe { _mm512_mask_storeu_ps(p, Self::first(n), v) }
    }
    #[inline(always)]
    unsafe fn gather(base: *const f32, index: __m512i, mask: __mmask16) -> __m512 {
        unsafe { _mm512_mask_i32gather_ps::<4>(_mm512_setzero_ps(), mask, index, base) }
    }
    #[inline(always)]
    unsafe fn gather4<const STRIDE: usize>(
        base: *const [f32; 4],
        index: *const u32,
    ) -> [__m512; 4] {
        unsafe {
            // Row j has records j, 4 + j, 8 + j, 12 + j; a transposition within its quarters sorts
            // the lanes.
            let a = quad::<STRIDE>(base, index);
            let b = quad::<STRIDE>(base, index.add(1));
            let c = quad::<STRIDE>(base, index.add(2));
            let d = quad::<STRIDE>(base, index.add(3));
            let (ab_lo, ab_hi) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
            let (cd_lo, cd_hi) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
            [
                _mm512_shuffle_ps::<0b01_00_01_00>(ab_lo, cd_lo),
                _mm512_shuffle_ps::<0b11_10_11_10>(ab_lo, cd_lo),
                _mm512_shuffle_ps::<0b01_00_01_00>(ab_hi, cd_hi),
                _mm512_shuffle_ps::<0b11_10_11_10>(ab_hi, cd_hi),
            ]
        }
    }

    #[inline(always)]
    unsafe fn gather2(base: *const [f32; 2], index: *const u32) -> [__m512; 2] {
        unsafe {
            let (a, b) = (pairs(base, index), pairs(base, index.add(2)));
            [
                _mm512_shuffle_ps::<0b10_00_10_00>(a, b),
                _mm512_shuffle_ps::<0b11_01_11_01>(a, b),
            ]
        }
    }
    #[inline(always)]
    unsafe fn store4(p: *mut [f32; 4], [x, y, z, w]: [__m512; 4]) {
        unsafe {
            // Pairs of two vectors, then pairs of pairs: 64-bit lanes (x, y) and (z, w).
            let lo = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            let hi = _mm512_add_epi32(lo, Self::splat_u(8));
            let first = _mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11);
            let second = _mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15);
            let p = p.cast::<f64>();
            for (half, order) in [lo, hi].into_iter().enumerate() {
                let xy = _mm512_castps_pd(_mm512_permutex2var_ps(x, order, y));
                let zw = _mm512_castps_pd(_mm512_permutex2var_ps(z, order, w));
                let at = p.add(16 * half);
                _mm512_storeu_pd(at, _mm512_permutex2var_pd(xy, first, zw));
                _mm512_storeu_pd(at.add(8), _mm512_permutex2var_pd(xy, second, zw));
            }
        }
    }

    #[inline(always)]
    unsafe fn prefetch(p: *const f32) {
        unsafe { _mm_prefetch::<_MM_HINT_T0>(p.cast()) }
    }

    #[inline(always)]
    unsafe fn add(a: __m512, b: __m512) -> __m512 {
        unsafe { _mm512_add_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn sub(a: __m512, b: __m512) -> __m512 {
        unsafe { _mm512_sub_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn mul(a: __m512, b: __m512) -> __m512 {
        unsafe { _mm512_mul_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn div(a: __m512, b: __m512) -> __m512 {
        unsafe { _mm512_div_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn mul_add(a: __m512, b: __m512, c: __m512) -> __m512 {
        unsafe { _mm512_fmadd_ps(a, b, c) }
    }
    #[inline(always)]
    unsafe fn mul_sub(a: __m512, b: __m512, c: __m512) -> __m512 {
        unsafe { _mm512_fmsub_ps(a, b, c) }
    }
    #[inline(always)]
    unsafe fn min(a: __m512, b: __m512) -> __m512 {
        unsafe { _mm512_min_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn max(a: __m512, b: __m512) -> __m512 {
        unsafe { _mm512_max_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn sqrt(a: __m512) -> __m512 {
        unsafe { _mm512_sqrt_ps(a) }
    }
    #[inline(always)]
    unsafe fn abs(a: __m512) -> __m512 {
        unsafe { _mm512_abs_ps(a) }
    }
    #[inline(always)]
    unsafe fn flip_sign(a: __m512, s: __m512) -> __m512 {
        unsafe { _mm512_xor_ps(a, _mm512_and_ps(s, _mm512_set1_ps(-0.0))) }
    }

    #[inline(always)]
    unsafe fn lt(a: __m512, b: __m512) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
    }
    #[inline(always)]
    unsafe fn le(a: __m512, b: __m512) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
    }
    #[inline(always)]
    unsafe fn eq(a: __m512, b: __m512) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, b) }
    }
    #[inline(always)]
    unsafe fn is_nan(a: __m512) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_UNORD_Q>(a, a) }
    }
    #[inline(always)]
    unsafe fn select(m: __mmask16, yes: __m512, no: __m512) -> __m512 {
        unsafe { _mm512_mask_blend_ps(m, no, yes) }
    }

    #[inline(always)]
    unsafe fn and(a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }
    #[inline(always)]
    unsafe fn or(a: __mmask16, b: __mmask16) -> __mmask16 {
        a | b
    }
    #[inline(always)]
    unsafe fn and_not(a: __mmask16, b: __mmask16) -> __mmask16 {
        a & !b
    }
    #[inline(always)]
    unsafe fn first(n: usize) -> __mmask16 {
        if n >= N { !0 } else { (1 << n) - 1 }
    }
    #[inline(always)]
    unsafe fn bits(m: __mmask16) -> u32 {
        m as u32
    }

    #[inline(always)]
    unsafe fn splat_u(x: u32) -> __m512i {
        unsafe { _mm512_set1_epi32(x as i32) }
    }
    #[inline(always)]
    unsafe fn load_u(p: *const u32) -> __m512i {
        unsafe { _mm512_loadu_si512(p.cast()) }
    }
    #[inline(always)]
    unsafe fn store_u(p: *mut u32, v: __m512i) {
        unsafe { _mm512_storeu_si512(p.cast(), v) }
    }
    #[inline(always)]
    unsafe fn store_first_u(p: *mut u32, v: __m512i, n: usize) {
        unsafe { _mm512_mask_storeu_epi32(p.cast(), Self::first(n), v) }
    }
    #[inline(always)]
    unsafe fn gather_u(base: *const u32, index: __m512i, mask: __mmask16) -> __m512i {
        unsafe {
            _mm512_mask_i32gather_epi32::<4>(_mm512_setzero_si512(), mask, index, base.cast())
        }
    }
    #[inline(always)]
    unsafe fn count_from(base: u32) -> __m512i {
        unsafe {
            let iota = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
            _mm512_add_epi32(Self::splat_u(base), iota)
        }
    }
    #[inline(always)]
    unsafe fn lt_u(a: __m512i, b: __m512i) -> __mmask16 {
        unsafe { _mm512_cmplt_epu32_mask(a, b) }
    }
    #[inline(always)]
    unsafe fn eq_u(a: __m512i, b: __m512i) -> __mmask16 {
        unsafe { _mm512_cmpeq_epu32_mask(a, b) }
    }
    #[inline(always)]
    unsafe fn select_u(m: __mmask16, yes: __m512i, no: __m512i) -> __m512i {
        unsafe { _mm512_mask_blend_epi32(m, no, yes) }
    }

    #[inline(always)]
    unsafe fn common_bits(a: __m512i, b: __m512i) -> __mmask16 {
        unsafe { _mm512_test_epi32_mask(a, b) }
    }
    #[inline(always)]
    unsafe fn to_bits(a: __m512) -> __m512i {
        unsafe { _mm512_castps_si512(a) }
    }
    #[inline(always)]
    unsafe fn from_bits(a: __m512i) -> __m512 {
        unsafe { _mm512_castsi512_ps(a) }
    }

    #[inline(always)]
    unsafe fn min8(a: &mut [f32; 8], b: &[f32; 8]) {
        unsafe {
            let least = _mm256_min_ps(_mm256_loadu_ps(b.as_ptr()), _mm256_loadu_ps(a.as_ptr()));
            _mm256_storeu_ps(a.as_mut_ptr(), least);
        }
    }

    #[inline(always)]
    unsafe fn compress(m: __mmask16, v: __m512) -> __m512 {
        unsafe { _mm512_maskz_compress_ps(m, v) }
    }
    #[inline(always)]
    unsafe fn compress_u(m: __mmask16, v: __m512i) -> __m512i {
        unsafe { _mm512_maskz_compress_epi32(m, v) }
    }
}
