//! What float32 is sure of: bounds on the errors of [`Edges`], for the precisions that leave nothing
//! to rounding.
//!
//! With u = 2⁻²⁴, e the length of the longest edge, C the way from the origin to the first corner
//! and lengths in the 2-norm, each operation (x ∘ y)(1 + δ), |δ| ≤ u, and Cauchy and Schwarz's
//! inequality give, to the first order:
//!
//! * U and V, either way they are computed: two differences, a cross product, a dot product;
//!   (1 + 1 + 2 + 3) u e |C| |d|.
//! * N: two differences and an unfused cross product; (2 + √2 + 1) u e². N·d: 7.5 u e² |d|. N·C:
//!   8.5 u e² |C|.
//! * |den| − (|U| + |V|): the three errors above, and two roundings of sums; less than
//!   u e |d| (18.3 |C| + 8.5 e).
//! * Where the sign of den is not certain, |den| ≤ 7.5 u e² |d|, and a hit has U and V no larger.
//!
//! So a ray that hits has U, V and |den| − (U + V) of at least −u e |d| (24 |C| + 12 e), and one for
//! which they are larger than that number is certain to be on the inner side of all edges. The slack
//! (from 18.3 to 24) is more than terms of second order and the rounding of the bounds.
//!
//! All that holds while nothing over- or underflows, which lengths between 2⁻⁴⁰ and 2⁴⁰
//! ([`ordinary`]) make sure: what underflow loses is 2²⁰ times less than the bound, and
//! products of four stay below 2¹²⁸. Other triangles and rays have infinite bounds.

use super::naive::{RayList, RayVector};
use super::triangle::{Edges, Prepared};
use crate::simd::Lanes;

/// Unit roundoff of float32.
const UNIT: f32 = 1.0 / (1 << 24) as f32;

/// How far t, where it is sure, may be from the exact one, relative: two errors of at most 2⁻¹³,
/// the division, and some slack.
pub(super) const WITHIN: f32 = 1.0625 / (1 << 12) as f32;

/// The least and the greatest length for which there are bounds.
const ORDINARY: [f32; 2] = [1.0 / (1u64 << 40) as f32, (1u64 << 40) as f32];

/// Where a length is ordinary.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn ordinary<L: Lanes>(length: L::F) -> L::M {
    // SAFETY: as promised.
    unsafe {
        L::and(
            L::le(L::splat(ORDINARY[0]), length),
            L::le(length, L::splat(ORDINARY[1])),
        )
    }
}

/// A length, or infinity where it is not ordinary.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn if_ordinary<L: Lanes>(length: L::F) -> L::F {
    // SAFETY: as promised.
    unsafe { L::select(ordinary::<L>(length), length, L::splat(f32::INFINITY)) }
}

/// The size of a triangle, or infinity where a shared origin, at a distance from it, is not certain
/// to be on one side of its plane.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn if_sided<L: Lanes>(size: L::F, distance: L::F, num: L::F) -> L::F {
    // SAFETY: as promised.
    unsafe {
        let error = num_error::<L>(size, distance);
        let sided = L::and(L::lt(error, num), ordinary::<L>(distance));
        L::select(sided, size, L::splat(f32::INFINITY))
    }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn num_error<L: Lanes>(size: L::F, distance: L::F) -> L::F {
    // SAFETY: as promised.
    unsafe { L::mul(L::mul(size, size), L::mul(distance, L::splat(9.0 * UNIT))) }
}

/// For each ray, what a triangle's size is to be multiplied with to bound U, V and |den| − (U + V) of
/// hits from below: −48 u |C| |d|, with |C| the way to the furthest corner of the scene, for e is
/// at most 2 |C|. Minus infinity where that is not ordinary.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn margin<L: Lanes, const SHARED: bool>(
    v: &RayVector<L>,
    rays: &impl RayList<L>,
) -> L::F {
    // SAFETY: as promised.
    unsafe {
        let scene = rays.scene();
        let mut way = L::splat(0.0);
        let mut direction = L::splat(0.0);
        for axis in 0..3 {
            let o = match rays.shared_origin() {
                Some(o) if SHARED => L::splat(o[axis]),
                _ => v.origin[axis],
            };
            let below = L::abs(L::sub(o, L::splat(scene.min[axis])));
            let above = L::abs(L::sub(o, L::splat(scene.max[axis])));
            let furthest = L::max(below, above);
            way = L::mul_add(furthest, furthest, way);
            direction = L::mul_add(v.direction[axis], v.direction[axis], direction);
        }
        // Squares of ordinary lengths are from 2⁻⁸⁰ to 2⁸⁰.
        let least = L::splat(ORDINARY[0] * ORDINARY[0]);
        let greatest = L::splat(ORDINARY[1] * ORDINARY[1]);
        let bounded = L::and(
            L::and(L::le(least, way), L::le(way, greatest)),
            L::and(L::le(least, direction), L::le(direction, greatest)),
        );
        // In two roots: the product may be up to 2¹⁶⁰.
        let product = L::mul(L::sqrt(way), L::sqrt(direction));
        let margin = L::mul(product, L::splat(-48.0 * UNIT));
        L::select(bounded, margin, L::splat(f32::NEG_INFINITY))
    }
}

/// Lanes that may be on the inner side of all edges of a triangle. NaN may.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn may_hit<L: Lanes, const SHARED: bool>(
    of: &Prepared,
    v: &RayVector<L>,
    margin: L::F,
) -> L::M {
    // SAFETY: as promised.
    unsafe {
        let edges = of.edges::<L, SHARED>(&v.origin, &v.direction);
        let least = L::mul(margin, L::splat(of.size));
        let outside = edges.below(least);
        L::and_not(v.active, outside)
    }
}

impl<L: Lanes> Edges<L> {
    /// Lanes in which U, V or |den| − (U + V) is less than a number; none of them NaN.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    unsafe fn below(&self, least: L::F) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let w = L::sub(self.den, L::add(self.u, self.v));
            let outside = L::or(L::lt(self.u, least), L::lt(self.v, least));
            L::or(outside, L::lt(w, least))
        }
    }

    /// Lanes in which U, V and |den| − (U + V) are all greater than a number.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    unsafe fn above(&self, most: L::F) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let w = L::sub(self.den, L::add(self.u, self.v));
            let inside = L::and(L::lt(most, self.u), L::lt(most, self.v));
            L::and(inside, L::lt(most, w))
        }
    }
}

/// What float32 says of rays and a triangle.
pub(super) struct Said<L: Lanes> {
    /// Lanes that are sure to meet the triangle, with t within [`WITHIN`] of the exact one.
    pub sure: L::M,
    /// Lanes about which nothing is sure. Those in neither mask do not hit, or no nearer than what
    /// they have.
    pub open: L::M,
    pub t: L::F,
    /// Bound on the errors of U, V and |den| − (U + V).
    pub error: L::F,
}

/// What float32 is sure of. No interval is tested but that t is positive.
///
/// # Safety
/// As for [`may_hit`].
#[inline(always)]
pub(super) unsafe fn say<L: Lanes, const SHARED: bool>(
    of: &Prepared,
    v: &RayVector<L>,
    margin: L::F,
    best: L::F,
) -> Said<L> {
    // SAFETY: as promised.
    unsafe {
        let edges = of.edges::<L, SHARED>(&v.origin, &v.direction);
        let size = L::splat(of.size);
        let possible = L::and_not(v.active, edges.below(L::mul(margin, size)));

        let distance = of.distance::<L, SHARED>(&v.origin);
        let d = &v.direction;
        let speed = L::sqrt(L::mul_add(
            d[2],
            d[2],
            L::mul_add(d[1], d[1], L::mul(d[0], d[0])),
        ));
        let bounded = L::and(ordinary::<L>(distance), ordinary::<L>(speed));
        let around = L::mul_add(
            distance,
            L::splat(24.0 * UNIT),
            L::mul(size, L::splat(12.0 * UNIT)),
        );
        let error = L::mul(L::mul(size, speed), around);
        let outside = edges.below(L::sub(L::splat(0.0), error));
        let inside = edges.above(error);

        // Relative errors of at most 2⁻¹³.
        let num_error = num_error::<L>(size, distance);
        let den_error = L::mul(L::mul(size, size), L::mul(speed, L::splat(8.0 * UNIT)));
        let precise = L::splat((1 << 13) as f32);
        let sided = L::lt(L::mul(den_error, precise), edges.den);
        let behind = L::and(sided, L::lt(edges.num, L::sub(L::splat(0.0), num_error)));
        let t = L::div(edges.num, edges.den);
        let near_or_far = L::splat(1.0 / (1u128 << 100) as f32);
        let within = L::and(
            L::lt(near_or_far, t),
            L::lt(t, L::splat((1u128 << 100) as f32)),
        );
        let sided = L::and(sided, L::lt(L::mul(num_error, precise), edges.num));
        let known = L::and(L::and(sided, within), bounded);

        let late = L::lt(best, L::mul(t, L::splat(1.0 - WITHIN)));
        let no = L::or(L::and(bounded, L::or(outside, behind)), L::and(known, late));
        let yes = L::and_not(possible, no);
        let sure = L::and(yes, L::and(inside, known));
        Said {
            sure,
            open: L::and_not(yes, sure),
            t,
            error,
        }
    }
}
