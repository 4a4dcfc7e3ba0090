//! Four lanes of plain Rust. It defines what the other instances must compute.

use super::Lanes;
use std::array::from_fn;

#[derive(Clone, Copy)]
pub(crate) struct Portable;

const N: usize = 4;

// SAFETY (whole file): no special instructions; pointers are used as the trait's contract says.
#[allow(clippy::undocumented_unsafe_blocks)]
impl Lanes for Portable {
    const N: usize = N;
    type F = [f32; N];
    type U = [u32; N];
    type M = [bool; N];

    #[inline(always)]
    unsafe fn splat(x: f32) -> Self::F {
        [x; N]
    }
    #[inline(always)]
    unsafe fn load(p: *const f32) -> Self::F {
        unsafe { p.cast::<Self::F>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn store(p: *mut f32, v: Self::F) {
        unsafe { p.cast::<Self::F>().write_unaligned(v) }
    }
    #[inline(always)]
    unsafe fn store_first(p: *mut f32, v: Self::F, n: usize) {
        for (i, x) in v.into_iter().enumerate().take(n) {
            unsafe { p.add(i).write(x) }
        }
    }
    #[inline(always)]
    unsafe fn gather(base: *const f32, index: Self::U, mask: Self::M) -> Self::F {
        from_fn(|i| {
            if mask[i] {
                unsafe { *base.add(index[i] as usize) }
            } else {
                0.0
            }
        })
    }
    #[inline(always)]
    unsafe fn gather4<const STRIDE: usize>(
        base: *const [f32; 4],
        index: *const u32,
    ) -> [Self::F; 4] {
        from_fn(|k| from_fn(|i| unsafe { (*base.add(STRIDE * *index.add(i) as usize))[k] }))
    }

    #[inline(always)]
    unsafe fn gather2(base: *const [f32; 2], index: *const u32) -> [Self::F; 2] {
        from_fn(|k| from_fn(|i| unsafe { (*base.add(*index.add(i) as usize))[k] }))
    }
    #[inline(always)]
    unsafe fn store4(p: *mut [f32; 4], v: [Self::F; 4]) {
        let records: [[f32; 4]; N] = from_fn(|i| from_fn(|k| v[k][i]));
        unsafe { p.cast::<[[f32; 4]; N]>().write(records) }
    }

    #[inline(always)]
    unsafe fn prefetch(_: *const f32) {}

    #[inline(always)]
    unsafe fn add(a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    unsafe fn sub(a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    unsafe fn mul(a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] * b[i])
    }
    #[inline(always)]
    unsafe fn div(a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| a[i] / b[i])
    }
    #[inline(always)]
    unsafe fn mul_add(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        from_fn(|i| a[i].mul_add(b[i], c[i]))
    }
    #[inline(always)]
    unsafe fn mul_sub(a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        from_fn(|i| a[i].mul_add(b[i], -c[i]))
    }
    #[inline(always)]
    unsafe fn min(a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    unsafe fn max(a: Self::F, b: Self::F) -> Self::F {
        from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    unsafe fn sqrt(a: Self::F) -> Self::F {
        a.map(f32::sqrt)
    }
    #[inline(always)]
    unsafe fn abs(a: Self::F) -> Self::F {
        a.map(f32::abs)
    }
    #[inline(always)]
    unsafe fn flip_sign(a: Self::F, s: Self::F) -> Self::F {
        from_fn(|i| f32::from_bits(a[i].to_bits() ^ (s[i].to_bits() & (1 << 31))))
    }

    #[inline(always)]
    unsafe fn lt(a: Self::F, b: Self::F) -> Self::M {
        from_fn(|i| a[i] < b[i])
    }
    #[inline(always)]
    unsafe fn le(a: Self::F, b: Self::F) -> Self::M {
        from_fn(|i| a[i] <= b[i])
    }
    #[inline(always)]
    unsafe fn eq(a: Self::F, b: Self::F) -> Self::M {
        from_fn(|i| a[i] == b[i])
    }
    #[inline(always)]
    unsafe fn is_nan(a: Self::F) -> Self::M {
        a.map(f32::is_nan)
    }
    #[inline(always)]
    unsafe fn select(m: Self::M, yes: Self::F, no: Self::F) -> Self::F {
        from_fn(|i| if m[i] { yes[i] } else { no[i] })
    }

    #[inline(always)]
    unsafe fn and(a: Self::M, b: Self::M) -> Self::M {
        from_fn(|i| a[i] & b[i])
    }
    #[inline(always)]
    unsafe fn or(a: Self::M, b: Self::M) -> Self::M {
        from_fn(|i| a[i] | b[i])
    }
    #[inline(always)]
    unsafe fn and_not(a: Self::M, b: Self::M) -> Self::M {
        from_fn(|i| a[i] & !b[i])
    }
    #[inline(always)]
    unsafe fn first(n: usize) -> Self::M {
        from_fn(|i| i < n)
    }
    #[inline(always)]
    unsafe fn bits(m: Self::M) -> u32 {
        m.iter()
            .rev()
            .fold(0, |bits, &lane| bits << 1 | lane as u32)
    }

    #[inline(always)]
    unsafe fn splat_u(x: u32) -> Self::U {
        [x; N]
    }
    #[inline(always)]
    unsafe fn load_u(p: *const u32) -> Self::U {
        unsafe { p.cast::<Self::U>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn store_u(p: *mut u32, v: Self::U) {
        unsafe { p.cast::<Self::U>().write_unaligned(v) }
    }
    #[inline(always)]
    unsafe fn store_first_u(p: *mut u32, v: Self::U, n: usize) {
        for (i, x) in v.into_iter().enumerate().take(n) {
            unsafe { p.add(i).write(x) }
        }
    }
    #[inline(always)]
    unsafe fn gather_u(base: *const u32, index: Self::U, mask: Self::M) -> Self::U {
        from_fn(|i| {
            if mask[i] {
                unsafe { *base.add(index[i] as usize) }
            } else {
                0
            }
        })
    }
    #[inline(always)]
    unsafe fn count_from(base: u32) -> Self::U {
        from_fn(|i| base.wrapping_add(i as u32))
    }
    #[inline(always)]
    unsafe fn lt_u(a: Self::U, b: Self::U) -> Self::M {
        from_fn(|i| a[i] < b[i])
    }
    #[inline(always)]
    unsafe fn eq_u(a: Self::U, b: Self::U) -> Self::M {
        from_fn(|i| a[i] == b[i])
    }
    #[inline(always)]
    unsafe fn select_u(m: Self::M, yes: Self::U, no: Self::U) -> Self::U {
        from_fn(|i| if m[i] { yes[i] } else { no[i] })
    }

    #[inline(always)]
    unsafe fn common_bits(a: Self::U, b: Self::U) -> Self::M {
        from_fn(|i| a[i] & b[i] != 0)
    }
    #[inline(always)]
    unsafe fn to_bits(a: Self::F) -> Self::U {
        a.map(f32::to_bits)
    }
    #[inline(always)]
    unsafe fn from_bits(a: Self::U) -> Self::F {
        a.map(f32::from_bits)
    }

    #[inline(always)]
    unsafe fn min8(a: &mut [f32; 8], b: &[f32; 8]) {
        for i in 0..8 {
            a[i] = if b[i] < a[i] { b[i] } else { a[i] };
        }
    }

    #[inline(always)]
    unsafe fn compress(m: Self::M, v: Self::F) -> Self::F {
        let mut out = v;
        let mut n = 0;
        for i in 0..N {
            if m[i] {
                out[n] = v[i];
                n += 1;
            }
        }
        out
    }
    #[inline(always)]
    unsafe fn compress_u(m: Self::M, v: Self::U) -> Self::U {
        let mut out = v;
        let mut n = 0;
        for i in 0..N {
            if m[i] {
                out[n] = v[i];
                n += 1;
            }
        }
        out
    }
}
