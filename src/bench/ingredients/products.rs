//! Ways to compute a·b − c·d.

use crate::simd::{Lanes, MAX_LANES};

/// A way.
pub(super) trait Products {
    /// a·b − c·d.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    unsafe fn difference<L: Lanes>(a: L::F, b: L::F, c: L::F, d: L::F) -> L::F;
}

/// Three roundings. The sign is right or, where the products are close, zero: rounding is monotone.
/// And a·b − c·d is −(c·d − a·b), so two triangles agree about their edge.
pub(super) struct Separate;

impl Products for Separate {
    #[inline(always)]
    unsafe fn difference<L: Lanes>(a: L::F, b: L::F, c: L::F, d: L::F) -> L::F {
        // SAFETY: as promised.
        unsafe { L::sub(L::mul(a, b), L::mul(c, d)) }
    }
}

/// Two roundings, one of c·d only: the same edge may be negative for both of its triangles.
pub(super) struct Fused;

impl Products for Fused {
    #[inline(always)]
    unsafe fn difference<L: Lanes>(a: L::F, b: L::F, c: L::F, d: L::F) -> L::F {
        // SAFETY: as promised.
        unsafe { L::mul_sub(a, b, L::mul(c, d)) }
    }
}

/// Kahan's: what c·d lost by rounding is added again. Within 1.5 units in the last place, so its sign
/// is exact (Jeannerod, Louvet, Muller 2013), unless it underflows.
pub(super) struct Kahan;

impl Products for Kahan {
    #[inline(always)]
    unsafe fn difference<L: Lanes>(a: L::F, b: L::F, c: L::F, d: L::F) -> L::F {
        // SAFETY: as promised.
        unsafe {
            let cd = L::mul(c, d);
            L::sub(L::mul_sub(a, b, cd), L::mul_sub(c, d, cd))
        }
    }
}

/// Products of float32 are exact in float64, and so is the sign of their difference.
pub(super) struct Float64;

impl Products for Float64 {
    #[inline(always)]
    unsafe fn difference<L: Lanes>(a: L::F, b: L::F, c: L::F, d: L::F) -> L::F {
        let [mut x, mut y, mut z, mut w] = [[0f32; MAX_LANES]; 4];
        // SAFETY: as promised; there is room for the longest vector.
        unsafe {
            L::store(x.as_mut_ptr(), a);
            L::store(y.as_mut_ptr(), b);
            L::store(z.as_mut_ptr(), c);
            L::store(w.as_mut_ptr(), d);
            for i in 0..L::N {
                let (ab, cd) = (x[i] as f64 * y[i] as f64, z[i] as f64 * w[i] as f64);
                x[i] = (ab - cd) as f32;
            }
            L::load(x.as_ptr())
        }
    }
}
