//! The slab test: where a ray is inside a box. The one routine behind node tests, samples and the
//! box clip of the triangle kernel.

use crate::geometry::Aabb;
use crate::simd::Lanes;
use glam::Vec3;

/// How far slab intervals are widened, relative: `near * (1 - PADDING)`, `far * (1 + PADDING)`.
///
/// A flat box has no thickness, and t of a hit is rounded otherwise than its slabs. 64 units in the
/// last place; see the contract "one function of ray and triangle" in the README.
///
/// No hit of exact arithmetic is rejected: a slab distance `(x - o) / d` is rounded three times,
/// which is 3 units, or 6 where 1/d is denormal. Where the product underflows, 2⁻¹⁵⁰ are lost,
/// which a constant covers.
pub const PADDING: f32 = 64.0 / (1 << 24) as f32;

const SHRINK: f32 = 1.0 - PADDING;
const GROW: f32 = 1.0 + PADDING;

/// How far slab intervals are widened besides, for what underflow loses. Not denormal: Intel's processors
/// take about 150 clocks for a fused multiply-add with a denormal number.
pub(super) const UNDERFLOW: f32 = f32::MIN_POSITIVE;

/// A box, ready to be tested against vectors of rays.
#[derive(Clone, Copy)]
pub(crate) struct SlabBox<L: Lanes> {
    /// Lower planes; less the origin where that is shared.
    lo: [L::F; 3],
    /// Upper planes; likewise.
    hi: [L::F; 3],
    /// Whether the shared origin is outside the slab of an axis.
    outside: [bool; 3],
    /// Whether it is strictly inside.
    within: [bool; 3],
}

impl<L: Lanes> SlabBox<L> {
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    pub unsafe fn new(b: &Aabb, shared_origin: Option<Vec3>) -> Self {
        let o = shared_origin.unwrap_or(Vec3::ZERO);
        // x - 0 is x, so one expression serves both cases.
        let (lo, hi) = (b.min - o, b.max - o);
        let inside = b.min.cmple(o) & o.cmple(b.max);
        let within = b.min.cmplt(o) & o.cmplt(b.max);
        // SAFETY: as promised.
        unsafe {
            SlabBox {
                lo: [L::splat(lo.x), L::splat(lo.y), L::splat(lo.z)],
                hi: [L::splat(hi.x), L::splat(hi.y), L::splat(hi.z)],
                outside: [!inside.test(0), !inside.test(1), !inside.test(2)],
                within: [within.test(0), within.test(1), within.test(2)],
            }
        }
    }

    /// The padded interval in which rays are inside the box and `t >= tmin`; empty where
    /// `near > far`. Every step is monotone in the box's planes, so the interval of an enclosing
    /// box encloses it.
    ///
    /// With `SPECIAL`, an axis whose inverse is NaN is unbounded if the origin lies between the
    /// planes (inclusive) and empty otherwise; one whose inverse is [`CREEPING`] is always
    /// unbounded. `min` and `max` give their second operand where one is NaN, which passes over
    /// such an axis. And t near the largest float32 does not overflow.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    pub unsafe fn interval<const SHARED: bool, const SPECIAL: bool>(
        &self,
        inverse: &[L::F; 3],
        origin: &[L::F; 3],
        tmin: L::F,
    ) -> (L::F, L::F) {
        // SAFETY: as promised.
        unsafe {
            let mut near = tmin;
            let mut far = L::splat(f32::INFINITY);
            for axis in 0..3 {
                let (mut lo, mut hi) = (self.lo[axis], self.hi[axis]);
                if !SHARED {
                    lo = L::sub(lo, origin[axis]);
                    hi = L::sub(hi, origin[axis]);
                }
                let (t0, t1) = (L::mul(lo, inverse[axis]), L::mul(hi, inverse[axis]));
                near = L::max(L::min(t0, t1), near);
                far = if axis == 0 && !SPECIAL {
                    L::max(t0, t1)
                } else {
                    L::min(L::max(t0, t1), far)
                };
            }
            if SPECIAL {
                let empty = L::splat(f32::NEG_INFINITY);
                near = L::min(near, L::splat(f32::MAX));
                for axis in 0..3 {
                    let unbounded =
                        L::and_not(L::is_nan(inverse[axis]), creeps::<L>(inverse[axis]));
                    let outside = if SHARED {
                        L::first(if self.outside[axis] { L::N } else { 0 })
                    } else {
                        let o = origin[axis];
                        L::or(L::lt(o, self.lo[axis]), L::lt(self.hi[axis], o))
                    };
                    far = L::select(L::and(unbounded, outside), empty, far);
                }
            }
            padded::<L>(near, far)
        }
    }

    /// A t below which a ray is surely before everything that lies behind a plane of the box: a little
    /// before the ray leaves the box. Negative infinity for a ray that has no direction on an axis on
    /// which its origin is not strictly inside: the same is before and behind that plane.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    pub unsafe fn sure_exit<const SHARED: bool, const SPECIAL: bool>(
        &self,
        inverse: &[L::F; 3],
        origin: &[L::F; 3],
    ) -> L::F {
        // SAFETY: as promised.
        unsafe {
            // Where t overflows, the exit is at the largest float32: a hit may be behind it.
            let mut exit = L::splat(f32::MAX);
            for axis in 0..3 {
                let (mut lo, mut hi) = (self.lo[axis], self.hi[axis]);
                if !SHARED {
                    lo = L::sub(lo, origin[axis]);
                    hi = L::sub(hi, origin[axis]);
                }
                let (t0, t1) = (L::mul(lo, inverse[axis]), L::mul(hi, inverse[axis]));
                exit = L::min(L::max(t0, t1), exit);
                if SPECIAL {
                    let within = if SHARED {
                        L::first(if self.within[axis] { L::N } else { 0 })
                    } else {
                        let o = origin[axis];
                        L::and(L::lt(self.lo[axis], o), L::lt(o, self.hi[axis]))
                    };
                    let within = L::and_not(within, creeps::<L>(inverse[axis]));
                    let stays = L::and_not(L::is_nan(inverse[axis]), within);
                    exit = L::select(stays, L::splat(f32::NEG_INFINITY), exit);
                }
            }
            L::mul_sub(exit, L::splat(SHRINK), L::splat(UNDERFLOW))
        }
    }
}

/// A slab interval widened by [`PADDING`].
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn padded<L: Lanes>(near: L::F, far: L::F) -> (L::F, L::F) {
    // SAFETY: as promised.
    unsafe {
        let underflow = L::splat(UNDERFLOW);
        (
            L::mul_sub(near, L::splat(SHRINK), underflow),
            L::mul_add(far, L::splat(GROW), underflow),
        )
    }
}

/// The inverse of a component of a direction that is not zero, but so small that 1/d is infinite,
/// in precisions `watertight` and `exact`: over a long way the ray moves on that axis, too. A NaN with its sign bit
/// set; without it, the ray does not move.
pub(super) const CREEPING: f32 = f32::from_bits(0xffc0_0000);

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn creeps<L: Lanes>(inverse: L::F) -> L::M {
    // SAFETY: as promised.
    unsafe {
        let negative = L::common_bits(L::to_bits(inverse), L::splat_u(1 << 31));
        L::and(negative, L::is_nan(inverse))
    }
}

#[cfg(test)]
mod tests;
