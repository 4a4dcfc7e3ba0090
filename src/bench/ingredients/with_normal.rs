//! Möller and Trumbore's test: in the form with a normal, which precision `fast` has, with one thing
//! changed at a time, and as printed.

use super::{Crossing, Estimate, RayVector};
use crate::kernels::{dot, sub3};
use crate::simd::Lanes;
use std::marker::PhantomData;

/// What is done how: by default as in `fast`.
pub(super) trait Recipe {
    /// Whether sums of products are fused.
    const FUSED: bool = true;
    /// Whether those of the normal are.
    const FUSED_NORMAL: bool = false;
    /// Whether the origin is folded into the constants of triangles.
    const FOLDED: bool = false;
    /// Whether 1/den is an estimate with a Newton step.
    const RECIPROCAL: bool = false;
    /// Whether the numerator of t is e2·q.
    const EDGE_AND_Q: bool = false;
}

pub(super) struct Fast;
impl Recipe for Fast {}

pub(super) struct Separate;
impl Recipe for Separate {
    const FUSED: bool = false;
}

pub(super) struct FusedNormal;
impl Recipe for FusedNormal {
    const FUSED_NORMAL: bool = true;
}

pub(super) struct Folded;
impl Recipe for Folded {
    const FOLDED: bool = true;
}

pub(super) struct Reciprocal;
impl Recipe for Reciprocal {
    const RECIPROCAL: bool = true;
}

pub(super) struct EdgeAndQ;
impl Recipe for EdgeAndQ {
    const EDGE_AND_Q: bool = true;
}

/// The form with a normal: e1 = a − b, e2 = c − a, N = e2 × e1, C = a − o, and
/// t = N·C / N·d where U = (C × d)·e2 and V = (C × d)·e1 have the sign of N·d and are together no
/// larger.
pub(super) struct Test<R>(PhantomData<R>);

/// Constants of triangles.
#[derive(Clone, Copy)]
pub(super) struct Constants<L: Lanes> {
    n: [L::F; 3],
    /// e2, or e2 × C if the origin is folded in.
    u: [L::F; 3],
    /// e1, or e1 × C.
    v: [L::F; 3],
    /// The first corner, or N·C in all places.
    a: [L::F; 3],
}

impl<R: Recipe> super::Test for Test<R> {
    const ONE_ORIGIN: bool = R::FOLDED;
    type Ray<L: Estimate> = RayVector<L>;
    type Triangle<L: Estimate> = Constants<L>;

    #[inline(always)]
    unsafe fn ray<L: Estimate>(ray: &RayVector<L>) -> RayVector<L> {
        *ray
    }

    #[inline(always)]
    unsafe fn triangle<L: Estimate>(
        [a, b, c]: &[[L::F; 3]; 3],
        origin: &[L::F; 3],
    ) -> Constants<L> {
        // SAFETY: as promised.
        unsafe {
            let (e1, e2) = (sub3::<L>(a, b), sub3::<L>(c, a));
            let n = cross::<L>(&e2, &e1, R::FUSED_NORMAL);
            if !R::FOLDED {
                return Constants {
                    n,
                    u: e2,
                    v: e1,
                    a: *a,
                };
            }
            let c = sub3::<L>(a, origin);
            Constants {
                n,
                u: cross::<L>(&e2, &c, false),
                v: cross::<L>(&e1, &c, false),
                a: [scalar::<L>(&n, &c, false); 3],
            }
        }
    }

    #[inline(always)]
    unsafe fn crossing<L: Estimate>(ray: &RayVector<L>, triangle: &Constants<L>) -> Crossing<L> {
        // SAFETY: as promised.
        unsafe {
            let Constants { n, u, v, a } = triangle;
            let d = &ray.direction;
            let den = scalar::<L>(n, d, R::FUSED);
            let (u, v, num) = if R::FOLDED {
                let (u, v) = (scalar::<L>(u, d, R::FUSED), scalar::<L>(v, d, R::FUSED));
                (u, v, a[0])
            } else {
                let c = sub3::<L>(a, &ray.origin);
                let r = cross::<L>(&c, d, R::FUSED);
                let num = match R::EDGE_AND_Q {
                    true => scalar::<L>(u, &cross::<L>(v, &c, R::FUSED), R::FUSED),
                    false => scalar::<L>(n, &c, R::FUSED),
                };
                let (u, v) = (scalar::<L>(u, &r, R::FUSED), scalar::<L>(v, &r, R::FUSED));
                (u, v, num)
            };
            Crossing {
                inside: inside::<L>(u, v, den),
                num,
                den,
            }
        }
    }

    #[inline(always)]
    unsafe fn t<L: Estimate>(crossing: &Crossing<L>) -> L::F {
        let &Crossing { num, den, .. } = crossing;
        // SAFETY: as promised.
        unsafe {
            if !R::RECIPROCAL {
                return L::div(num, den);
            }
            // r + r (1 − den r), each step fused, as Embree has it.
            let r = L::reciprocal(den);
            let minus = L::sub(L::splat(0.0), den);
            let r = L::mul_add(L::mul_add(minus, r, L::splat(1.0)), r, r);
            L::mul(num, r)
        }
    }
}

/// As printed: e1 = b − a, e2 = c − a, p = d × e2, det = e1·p, T = o − a, u = T·p, q = T × e1,
/// v = d·q, t = e2·q / det; products fused.
pub(super) struct MollerTrumbore;

impl super::Test for MollerTrumbore {
    type Ray<L: Estimate> = RayVector<L>;
    /// a, e1, e2.
    type Triangle<L: Estimate> = [[L::F; 3]; 3];

    #[inline(always)]
    unsafe fn ray<L: Estimate>(ray: &RayVector<L>) -> RayVector<L> {
        *ray
    }

    #[inline(always)]
    unsafe fn triangle<L: Estimate>([a, b, c]: &[[L::F; 3]; 3], _: &[L::F; 3]) -> [[L::F; 3]; 3] {
        // SAFETY: as promised.
        unsafe { [*a, sub3::<L>(b, a), sub3::<L>(c, a)] }
    }

    #[inline(always)]
    unsafe fn crossing<L: Estimate>(
        ray: &RayVector<L>,
        [a, e1, e2]: &[[L::F; 3]; 3],
    ) -> Crossing<L> {
        // SAFETY: as promised.
        unsafe {
            let p = cross::<L>(&ray.direction, e2, true);
            let det = dot::<L>(e1, &p);
            let t = sub3::<L>(&ray.origin, a);
            let u = dot::<L>(&t, &p);
            let q = cross::<L>(&t, e1, true);
            let v = dot::<L>(&ray.direction, &q);
            Crossing {
                inside: inside::<L>(u, v, det),
                num: dot::<L>(e2, &q),
                den: det,
            }
        }
    }
}

/// Lanes in which u and v have the sign of `den` and are together no larger.
///
/// # Safety
/// The processor has `L`'s instruction set; so for all that follow.
#[inline(always)]
unsafe fn inside<L: Lanes>(u: L::F, v: L::F, den: L::F) -> L::M {
    // SAFETY: as promised.
    unsafe {
        let (u, v) = (L::flip_sign(u, den), L::flip_sign(v, den));
        let zero = L::splat(0.0);
        let inside = L::and(L::le(zero, u), L::le(zero, v));
        L::and(inside, L::le(L::add(u, v), L::abs(den)))
    }
}

/// Dot product.
#[inline(always)]
unsafe fn scalar<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3], fused: bool) -> L::F {
    // SAFETY: as promised.
    unsafe {
        if fused {
            return dot::<L>(a, b);
        }
        let xy = L::add(L::mul(a[0], b[0]), L::mul(a[1], b[1]));
        L::add(xy, L::mul(a[2], b[2]))
    }
}

/// Cross product.
#[inline(always)]
unsafe fn cross<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3], fused: bool) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            component::<L>(a[1], b[2], a[2], b[1], fused),
            component::<L>(a[2], b[0], a[0], b[2], fused),
            component::<L>(a[0], b[1], a[1], b[0], fused),
        ]
    }
}

/// a·b − c·d.
#[inline(always)]
unsafe fn component<L: Lanes>(a: L::F, b: L::F, c: L::F, d: L::F, fused: bool) -> L::F {
    // SAFETY: as promised.
    unsafe {
        match fused {
            true => L::mul_sub(a, b, L::mul(c, d)),
            false => L::sub(L::mul(a, b), L::mul(c, d)),
        }
    }
}
