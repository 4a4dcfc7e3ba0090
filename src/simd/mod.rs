//! A small abstraction over vector instruction sets: every kernel is written once over [`Lanes`].
//!
//! All instances compute the same bits: only correctly rounded operations, fused only in
//! [`Lanes::mul_add`] and [`Lanes::mul_sub`], and `min`/`max` by the x86 rule.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod isa;
mod portable;
#[cfg(test)]
mod tests;

#[cfg(target_arch = "x86_64")]
pub(crate) use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub(crate) use avx512::Avx512;
pub use isa::{Isa, UnknownIsa};
pub(crate) use portable::Portable;

/// What begins where a cache line does. A vector that was stored across two lines has to reach the
/// cache before its parts can be read.
#[repr(align(64))]
pub(crate) struct OnLines<T>(pub T);

/// A vector of `N` float32, the matching vector of 32-bit unsigned integers, and a mask.
///
/// # Safety
/// Every function may be called only where the processor has the instruction set of the
/// implementing type. Loads and stores of whole vectors touch `N` values from the pointer on;
/// pointers need no alignment beyond that of their type.
pub(crate) trait Lanes: Copy {
    /// Number of lanes, a power of two, at most [`MAX_LANES`].
    const N: usize;
    /// `N` floats.
    type F: Copy;
    /// `N` unsigned integers.
    type U: Copy;
    /// One truth value a lane.
    type M: Copy;

    unsafe fn splat(x: f32) -> Self::F;
    unsafe fn load(p: *const f32) -> Self::F;
    unsafe fn store(p: *mut f32, v: Self::F);
    /// Stores the first `n` lanes only.
    unsafe fn store_first(p: *mut f32, v: Self::F, n: usize);
    /// Lane `i` is `base[index[i]]` where the mask is set, 0 elsewhere; indices are below 2^31.
    unsafe fn gather(base: *const f32, index: Self::U, mask: Self::M) -> Self::F;
    /// Four vectors from records of four floats: lane `i` of vector `k` is
    /// `base[STRIDE * index[i]][k]`, with `N` indices from memory.
    unsafe fn gather4<const STRIDE: usize>(
        base: *const [f32; 4],
        index: *const u32,
    ) -> [Self::F; 4];
    /// Two vectors from records of two floats: lane `i` of vector `k` is `base[index[i]][k]`, with `N`
    /// indices from memory.
    unsafe fn gather2(base: *const [f32; 2], index: *const u32) -> [Self::F; 2];
    /// `N` records of four floats: the inverse of a [`Lanes::gather4`] in order.
    unsafe fn store4(p: *mut [f32; 4], v: [Self::F; 4]);
    /// Starts to bring a cache line near; the address may be any.
    unsafe fn prefetch(p: *const f32);

    unsafe fn add(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn sub(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn mul(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn div(a: Self::F, b: Self::F) -> Self::F;
    /// `a * b + c`, rounded once.
    unsafe fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `a * b - c`, rounded once.
    unsafe fn mul_sub(a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// `if a < b { a } else { b }`: the second operand where one is NaN.
    unsafe fn min(a: Self::F, b: Self::F) -> Self::F;
    /// `if a > b { a } else { b }`: the second operand where one is NaN.
    unsafe fn max(a: Self::F, b: Self::F) -> Self::F;
    unsafe fn sqrt(a: Self::F) -> Self::F;
    unsafe fn abs(a: Self::F) -> Self::F;
    /// `a` with its sign flipped where that of `s` is negative.
    unsafe fn flip_sign(a: Self::F, s: Self::F) -> Self::F;

    /// `a < b`, false for NaN.
    unsafe fn lt(a: Self::F, b: Self::F) -> Self::M;
    /// `a <= b`, false for NaN.
    unsafe fn le(a: Self::F, b: Self::F) -> Self::M;
    /// `a == b`, false for NaN.
    unsafe fn eq(a: Self::F, b: Self::F) -> Self::M;
    unsafe fn is_nan(a: Self::F) -> Self::M;
    unsafe fn select(m: Self::M, yes: Self::F, no: Self::F) -> Self::F;

    unsafe fn and(a: Self::M, b: Self::M) -> Self::M;
    unsafe fn or(a: Self::M, b: Self::M) -> Self::M;
    /// `a` where `b` is not set.
    unsafe fn and_not(a: Self::M, b: Self::M) -> Self::M;
    /// The first `n` lanes; all of them for `n >= N`.
    unsafe fn first(n: usize) -> Self::M;
    /// Lane `i` as bit `i`.
    unsafe fn bits(m: Self::M) -> u32;

    unsafe fn splat_u(x: u32) -> Self::U;
    unsafe fn load_u(p: *const u32) -> Self::U;
    unsafe fn store_u(p: *mut u32, v: Self::U);
    unsafe fn store_first_u(p: *mut u32, v: Self::U, n: usize);
    unsafe fn gather_u(base: *const u32, index: Self::U, mask: Self::M) -> Self::U;
    /// `base, base + 1, …`
    unsafe fn count_from(base: u32) -> Self::U;
    unsafe fn lt_u(a: Self::U, b: Self::U) -> Self::M;
    unsafe fn eq_u(a: Self::U, b: Self::U) -> Self::M;
    unsafe fn select_u(m: Self::M, yes: Self::U, no: Self::U) -> Self::U;
    /// Lanes in which `a` and `b` have a bit in common.
    unsafe fn common_bits(a: Self::U, b: Self::U) -> Self::M;
    /// The bits of the floats, and back.
    unsafe fn to_bits(a: Self::F) -> Self::U;
    unsafe fn from_bits(a: Self::U) -> Self::F;

    /// `a = min(b, a)` of eight floats in memory, aligned to 32 bytes, by the rule of [`Lanes::min`].
    ///
    /// Left to itself, the compiler makes a comparison and a masked store of it on AVX-512, which
    /// cannot be forwarded to the next load: twice the time of binning.
    unsafe fn min8(a: &mut [f32; 8], b: &[f32; 8]);

    /// The set lanes moved to the front in their order; what follows them are lanes of `v` or zeros.
    unsafe fn compress(m: Self::M, v: Self::F) -> Self::F;
    /// As [`Lanes::compress`].
    unsafe fn compress_u(m: Self::M, v: Self::U) -> Self::U;
}

/// Three vectors from three streams, at the same place of each.
///
/// This and its like are functions, not closures: a closure that is not inlined loses the
/// instruction set of the function around it, and each operation in it becomes a call.
///
/// # Safety
/// As for [`Lanes::load`].
#[inline(always)]
pub(crate) unsafe fn load3<L: Lanes>(streams: &[*mut f32; 3], at: usize) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            L::load(streams[0].add(at)),
            L::load(streams[1].add(at)),
            L::load(streams[2].add(at)),
        ]
    }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn splat3<L: Lanes>(v: &[f32; 3]) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe { [L::splat(v[0]), L::splat(v[1]), L::splat(v[2])] }
}

/// Lanes whose bits are set.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn lanes_of_bits<L: Lanes>(bits: u32) -> L::M {
    const ONE: [u32; MAX_LANES] = {
        let mut one = [0; MAX_LANES];
        let mut lane = 0;
        while lane < MAX_LANES {
            one[lane] = 1 << lane;
            lane += 1;
        }
        one
    };
    // SAFETY: as promised.
    unsafe { L::common_bits(L::splat_u(bits), L::load_u(ONE.as_ptr())) }
}

/// The widest vector of any instance: lists start at multiples of it, and memory that kernels
/// read by whole vectors has as much room behind its end.
pub(crate) const MAX_LANES: usize = 16;
