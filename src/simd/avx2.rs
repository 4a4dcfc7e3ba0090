//! Eight lanes: AVX2 and FMA.

use super::Lanes;
use std::arch::x86_64::*;

#[derive(Clone, Copy)]
pub(crate) struct Avx2;

const N: usize = 8;

/// `COMPRESS[bits]` moves the lanes set in `bits` to the front.
static COMPRESS: [[u32; N]; 1 << N] = {
    let mut table = [[0; N]; 1 << N];
    let mut bits = 0;
    while bits < table.len() {
        let (mut lane, mut n) = (0, 0);
        while lane < N {
            if bits >> lane & 1 == 1 {
                table[bits][n] = lane as u32;
                n += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// The records of the indices at 0 and 4.
///
/// # Safety
/// As for [`Lanes::gather4`].
#[inline(always)]
unsafe fn pair<const STRIDE: usize>(base: *const [f32; 4], index: *const u32) -> __m256 {
    // SAFETY: as promised.
    unsafe {
        let v = _mm256_castps128_ps256(_mm_loadu_ps(base.add(STRIDE * *index as usize).cast()));
        _mm256_insertf128_ps::<1>(
            v,
            _mm_loadu_ps(base.add(STRIDE * *index.add(4) as usize).cast()),
        )
    }
}

/// The records of two floats of the indices at 0 and 1.
///
/// # Safety
/// As for [`Lanes::gather2`].
#[inline(always)]
pub(super) unsafe fn two(base: *const [f32; 2], index: *const u32) -> __m128 {
    // SAFETY: as promised.
    unsafe {
        let first = _mm_load_sd(base.add(*index as usize).cast());
        let both = _mm_loadh_pd(first, base.add(*index.add(1) as usize).cast());
        _mm_castpd_ps(both)
    }
}

/// The records of two floats of the indices at 0 and 1, 4 and 5.
///
/// # Safety
/// As for [`Lanes::gather2`].
#[inline(always)]
unsafe fn pairs(base: *const [f32; 2], index: *const u32) -> __m256 {
    // SAFETY: as promised.
    unsafe {
        let v = _mm256_castps128_ps256(two(base, index));
        _mm256_insertf128_ps::<1>(v, two(base, index.add(4)))
    }
}

// SAFETY (whole file): the caller runs on a processor with AVX2 and FMA, and pointers are good for
// the lanes that the trait's contract names.
#[allow(clippy::undocumented_unsafe_blocks)]
impl Lanes for Avx2 {
    const N: usize = N;
    type F = __m256;
    type U = __m256i;
    type M = __m256;

    #[inline(always)]
    unsafe fn splat(x: f32) -> __m256 {
        unsafe { _mm256_set1_ps(x) }
    }
    #[inline(always)]
    unsafe fn load(p: *const f32) -> __m256 {
        unsafe { _mm256_loadu_ps(p) }
    }
    #[inline(always)]
    unsafe fn store(p: *mut f32, v: __m256) {
        unsafe { _mm256_storeu_ps(p, v) }
    }
    #[inline(always)]
    unsafe fn store_first(p: *mut f32, v: __m256, n: usize) {
        unsafe { _mm256_maskstore_ps(p, _mm256_castps_si256(Self::first(n)), v) }
    }
    #[inline(always)]
    unsafe fn gather(base: *const f32, index: __m256i, mask: __m256) -> __m256 {
        unsafe { _mm256_mask_i32gather_ps::<4>(_mm256_setzero_ps(), base, index, mask) }
    }
    #[inline(always)]
    unsafe fn gather4<const STRIDE: usize>(
        base: *const [f32; 4],
        index: *const u32,
    ) -> [__m256; 4] {
        unsafe {
            // Row j has records j and 4 + j; a transposition within its halves sorts the lanes.
            let a = pair::<STRIDE>(base, index);
            let b = pair::<STRIDE>(base, index.add(1));
            let c = pair::<STRIDE>(base, index.add(2));
            let d = pair::<STRIDE>(base, index.add(3));
            let (ab_lo, ab_hi) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let (cd_lo, cd_hi) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            [
                _mm256_shuffle_ps::<0b01_00_01_00>(ab_lo, cd_lo),
                _mm256_shuffle_ps::<0b11_10_11_10>(ab_lo, cd_lo),
                _mm256_shuffle_ps::<0b01_00_01_00>(ab_hi, cd_hi),
                _mm256_shuffle_ps::<0b11_10_11_10>(ab_hi, cd_hi),
            ]
        }
    }

    #[inline(always)]
    unsafe fn gather2(base: *const [f32; 2], index: *const u32) -> [__m256; 2] {
        unsafe {
            let (a, b) = (pairs(base, index), pairs(base, index.add(2)));
            [
                _mm256_shuffle_ps::<0b10_00_10_00>(a, b),
                _mm256_shuffle_ps::<0b11_01_11_01>(a, b),
            ]
        }
    }
    #[inline(always)]
    unsafe fn store4(p: *mut [f32; 4], [x, y, z, w]: [__m256; 4]) {
        unsafe {
            let (xy_lo, xy_hi) = (_mm256_unpacklo_ps(x, y), _mm256_unpackhi_ps(x, y));
            let (zw_lo, zw_hi) = (_mm256_unpacklo_ps(z, w), _mm256_unpackhi_ps(z, w));
            // Records j and 4 + j.
            let a = _mm256_shuffle_ps::<0b01_00_01_00>(xy_lo, zw_lo);
            let b = _mm256_shuffle_ps::<0b11_10_11_10>(xy_lo, zw_lo);
            let c = _mm256_shuffle_ps::<0b01_00_01_00>(xy_hi, zw_hi);
            let d = _mm256_shuffle_ps::<0b11_10_11_10>(xy_hi, zw_hi);
            let p = p.cast::<f32>();
            _mm256_storeu_ps(p, _mm256_permute2f128_ps::<0x20>(a, b));
            _mm256_storeu_ps(p.add(8), _mm256_permute2f128_ps::<0x20>(c, d));
            _mm256_storeu_ps(p.add(16), _mm256_permute2f128_ps::<0x31>(a, b));
            _mm256_storeu_ps(p.add(24), _mm256_permute2f128_ps::<0x31>(c, d));
        }
    }

    #[inline(always)]
    unsafe fn prefetch(p: *const f32) {
        unsafe { _mm_prefetch::<_MM_HINT_T0>(p.cast()) }
    }

    #[inline(always)]
    unsafe fn add(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_add_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn sub(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_sub_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn mul(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_mul_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn div(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_div_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn mul_add(a: __m256, b: __m256, c: __m256) -> __m256 {
        unsafe { _mm256_fmadd_ps(a, b, c) }
    }
    #[inline(always)]
    unsafe fn mul_sub(a: __m256, b: __m256, c: __m256) -> __m256 {
        unsafe { _mm256_fmsub_ps(a, b, c) }
    }
    #[inline(always)]
    unsafe fn min(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_min_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn max(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_max_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn sqrt(a: __m256) -> __m256 {
        unsafe { _mm256_sqrt_ps(a) }
    }
    #[inline(always)]
    unsafe fn abs(a: __m256) -> __m256 {
        unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), a) }
    }
    #[inline(always)]
    unsafe fn flip_sign(a: __m256, s: __m256) -> __m256 {
        unsafe { _mm256_xor_ps(a, _mm256_and_ps(s, _mm256_set1_ps(-0.0))) }
    }

    #[inline(always)]
    unsafe fn lt(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) }
    }
    #[inline(always)]
    unsafe fn le(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a, b) }
    }
    #[inline(always)]
    unsafe fn eq(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(a, b) }
    }
    #[inline(always)]
    unsafe fn is_nan(a: __m256) -> __m256 {
        unsafe { _mm256_cmp_ps::<_CMP_UNORD_Q>(a, a) }
    }
    #[inline(always)]
    unsafe fn select(m: __m256, yes: __m256, no: __m256) -> __m256 {
        unsafe { _mm256_blendv_ps(no, yes, m) }
    }

    #[inline(always)]
    unsafe fn and(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_and_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn or(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_or_ps(a, b) }
    }
    #[inline(always)]
    unsafe fn and_not(a: __m256, b: __m256) -> __m256 {
        unsafe { _mm256_andnot_ps(b, a) }
    }
    #[inline(always)]
    unsafe fn first(n: usize) -> __m256 {
        unsafe {
            let n = _mm256_set1_epi32(n.min(N) as i32);
            _mm256_castsi256_ps(_mm256_cmpgt_epi32(n, Self::count_from(0)))
        }
    }
    #[inline(always)]
    unsafe fn bits(m: __m256) -> u32 {
        unsafe { _mm256_movemask_ps(m) as u32 }
    }

    #[inline(always)]
    unsafe fn splat_u(x: u32) -> __m256i {
        unsafe { _mm256_set1_epi32(x as i32) }
    }
    #[inline(always)]
    unsafe fn load_u(p: *const u32) -> __m256i {
        unsafe { _mm256_loadu_si256(p.cast()) }
    }
    #[inline(always)]
    unsafe fn store_u(p: *mut u32, v: __m256i) {
        unsafe { _mm256_storeu_si256(p.cast(), v) }
    }
    #[inline(always)]
    unsafe fn store_first_u(p: *mut u32, v: __m256i, n: usize) {
        unsafe { _mm256_maskstore_epi32(p.cast(), _mm256_castps_si256(Self::first(n)), v) }
    }
    #[inline(always)]
    unsafe fn gather_u(base: *const u32, index: __m256i, mask: __m256) -> __m256i {
        unsafe {
            let mask = _mm256_castps_si256(mask);
            _mm256_mask_i32gather_epi32::<4>(_mm256_setzero_si256(), base.cast(), index, mask)
        }
    }
    #[inline(always)]
    unsafe fn count_from(base: u32) -> __m256i {
        unsafe {
            let iota = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
            _mm256_add_epi32(Self::splat_u(base), iota)
        }
    }
    #[inline(always)]
    unsafe fn lt_u(a: __m256i, b: __m256i) -> __m256 {
        unsafe {
            // Signed comparison of values moved by 2^31.
            let top = _mm256_set1_epi32(i32::MIN);
            let (a, b) = (_mm256_xor_si256(a, top), _mm256_xor_si256(b, top));
            _mm256_castsi256_ps(_mm256_cmpgt_epi32(b, a))
        }
    }
    #[inline(always)]
    unsafe fn eq_u(a: __m256i, b: __m256i) -> __m256 {
        unsafe { _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b)) }
    }
    #[inline(always)]
    unsafe fn select_u(m: __m256, yes: __m256i, no: __m256i) -> __m256i {
        unsafe { _mm256_blendv_epi8(no, yes, _mm256_castps_si256(m)) }
    }

    #[inline(always)]
    unsafe fn common_bits(a: __m256i, b: __m256i) -> __m256 {
        unsafe {
            let none = _mm256_cmpeq_epi32(_mm256_and_si256(a, b), _mm256_setzero_si256());
            _mm256_castsi256_ps(_mm256_xor_si256(none, _mm256_set1_epi32(-1)))
        }
    }
    #[inline(always)]
    unsafe fn to_bits(a: __m256) -> __m256i {
        unsafe { _mm256_castps_si256(a) }
    }
    #[inline(always)]
    unsafe fn from_bits(a: __m256i) -> __m256 {
        unsafe { _mm256_castsi256_ps(a) }
    }

    #[inline(always)]
    unsafe fn min8(a: &mut [f32; 8], b: &[f32; 8]) {
        unsafe {
            let least = _mm256_min_ps(_mm256_loadu_ps(b.as_ptr()), _mm256_loadu_ps(a.as_ptr()));
            _mm256_storeu_ps(a.as_mut_ptr(), least);
        }
    }

    #[inline(always)]
    unsafe fn compress(m: __m256, v: __m256) -> __m256 {
        unsafe {
            let order = Self::load_u(COMPRESS[Self::bits(m) as usize].as_ptr());
            _mm256_permutevar8x32_ps(v, order)
        }
    }
    #[inline(always)]
    unsafe fn compress_u(m: __m256, v: __m256i) -> __m256i {
        unsafe {
            let order = Self::load_u(COMPRESS[Self::bits(m) as usize].as_ptr());
            _mm256_permutevar8x32_epi32(v, order)
        }
    }
}
