//! A ray and a triangle in float32: what all precisions compute, and all that `fast` does.
//!
//! Möller and Trumbore's test in the form with a normal: with e1 = a − b, e2 = c − a, N = e2 × e1
//! and C = a − o, a ray hits where U = (C × d)·e2 and V = (C × d)·e1 have the sign of N·d and
//! |U| + |V| ≤ |N·d|, at t = N·C / N·d. In this form t of a far-away scene is about 150 times more
//! accurate at the 99.9th percentile than as e2·q / det.
//!
//! A batch that shares its origin has a kernel of record of its own: C is a constant of the
//! triangle, and U = d·(e2 × C), V = d·(e1 × C) take one dot product each.

use super::certain;
use super::naive::{RayVector, Record};
use super::slab::SlabBox;
use crate::geometry::Aabb;
use crate::simd::{Lanes, MAX_LANES};
use glam::Vec3;

/// Triangles of a chunk.
pub(crate) const CHUNK: usize = MAX_LANES;

/// One number a triangle.
type Numbers = [f32; CHUNK];

/// What the kernel needs of up to [`CHUNK`] triangles.
#[repr(C, align(64))]
pub(crate) struct Chunk {
    /// Unnormalised normal; where the origin is shared, towards the side that rays leave on.
    n: [Numbers; 3],
    /// Factor of U: e2, or e2 × C where the origin is shared.
    u: [Numbers; 3],
    /// Factor of V: e1, or e1 × C.
    v: [Numbers; 3],
    /// First corner; where the origin is shared, |N·C| in the first place, |C| in the second.
    a: [Numbers; 3],
    /// The boxes.
    lo: [Numbers; 3],
    hi: [Numbers; 3],
    /// No edge is longer; infinite where [`certain`](super::certain) has no bounds.
    size: Numbers,
    pub prim: [u32; CHUNK],
}

/// Triangles, a lane each: corners and box.
pub(crate) struct Corners<L: Lanes> {
    pub a: [L::F; 3],
    pub b: [L::F; 3],
    pub c: [L::F; 3],
    pub lo: [L::F; 3],
    pub hi: [L::F; 3],
}

/// What decides about a vector of rays and a triangle.
pub(crate) struct Edges<L: Lanes> {
    pub u: L::F,
    pub v: L::F,
    /// Numerator of t.
    pub num: L::F,
    /// Denominator of t.
    pub den: L::F,
}

impl Chunk {
    pub const ZERO: Chunk = Chunk {
        n: [[0.0; CHUNK]; 3],
        u: [[0.0; CHUNK]; 3],
        v: [[0.0; CHUNK]; 3],
        a: [[0.0; CHUNK]; 3],
        lo: [[0.0; CHUNK]; 3],
        hi: [[0.0; CHUNK]; 3],
        size: [0.0; CHUNK],
        prim: [0; CHUNK],
    };

    /// Makes the constants of `L::N` triangles from place `at` on, folding a shared origin in if
    /// there is one; what only bounds need if the precision has them. Cross products are not fused: exactly zero
    /// for parallel edges of equal length.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `at` is a multiple of `L::N` below [`CHUNK`].
    #[inline(always)]
    pub unsafe fn prepare<L: Lanes, R: Record<L>>(
        &mut self,
        at: usize,
        corners: &Corners<L>,
        shared_origin: Option<Vec3>,
    ) {
        // SAFETY: as promised.
        unsafe {
            let Corners { a, b, c, lo, hi } = corners;
            let (e1, e2) = (sub3::<L>(a, b), sub3::<L>(c, a));
            let n = cross3::<L>(&e2, &e1);
            store3::<L>(&mut self.lo, at, lo);
            store3::<L>(&mut self.hi, at, hi);
            let mut size = L::splat(0.0);
            if R::BOUNDED {
                let extent = sub3::<L>(hi, lo);
                size = certain::if_ordinary::<L>(L::sqrt(dot::<L>(&extent, &extent)));
            }
            match shared_origin {
                None => {
                    store3::<L>(&mut self.n, at, &n);
                    store3::<L>(&mut self.u, at, &e2);
                    store3::<L>(&mut self.v, at, &e1);
                    store3::<L>(&mut self.a, at, a);
                }
                Some(o) => {
                    let o = [L::splat(o.x), L::splat(o.y), L::splat(o.z)];
                    let c = sub3::<L>(a, &o);
                    let xy = L::add(L::mul(n[0], c[0]), L::mul(n[1], c[1]));
                    let nc = L::add(xy, L::mul(n[2], c[2]));
                    // Hits have t > 0, so N·d has the sign of N·C. With that sign taken from all of
                    // them, which changes no rounding, a hit has N·d, U and V of no sign.
                    store3::<L>(&mut self.n, at, &flip3::<L>(&n, nc));
                    store3::<L>(&mut self.u, at, &flip3::<L>(&cross3::<L>(&e2, &c), nc));
                    store3::<L>(&mut self.v, at, &flip3::<L>(&cross3::<L>(&e1, &c), nc));
                    L::store(self.a[0].as_mut_ptr().add(at), L::abs(nc));
                    if R::BOUNDED {
                        let distance = L::sqrt(dot::<L>(&c, &c));
                        L::store(self.a[1].as_mut_ptr().add(at), distance);
                        size = certain::if_sided::<L>(size, distance, L::abs(nc));
                    }
                }
            }
            if R::BOUNDED {
                L::store(self.size.as_mut_ptr().add(at), size);
            }
        }
    }

    /// No edge of triangle `j` is longer; infinite if there are no bounds for it.
    pub fn size(&self, j: usize) -> f32 {
        self.size[j]
    }

    /// How far triangle `j`'s first corner is from the origins of rays.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `j` is below [`CHUNK`].
    #[inline(always)]
    pub unsafe fn distance<L: Lanes, const SHARED: bool>(
        &self,
        j: usize,
        origin: &[L::F; 3],
    ) -> L::F {
        // SAFETY: as promised.
        unsafe {
            if SHARED {
                L::splat(*self.a[1].get_unchecked(j))
            } else {
                let c = sub3::<L>(&splat3::<L>(&self.a, j), origin);
                L::sqrt(dot::<L>(&c, &c))
            }
        }
    }

    fn bounds(&self, j: usize) -> Aabb {
        let corner = |of: &[Numbers; 3]| Vec3::new(of[0][j], of[1][j], of[2][j]);
        Aabb {
            min: corner(&self.lo),
            max: corner(&self.hi),
        }
    }

    /// U, V, and numerator and denominator of t, with the sign that makes U, V and the denominator
    /// positive where triangle `j` is hit.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `j` is below [`CHUNK`].
    #[inline(always)]
    pub unsafe fn edges<L: Lanes, const SHARED: bool>(
        &self,
        j: usize,
        origin: &[L::F; 3],
        direction: &[L::F; 3],
    ) -> Edges<L> {
        // SAFETY: as promised.
        unsafe {
            let n = splat3::<L>(&self.n, j);
            let den = dot::<L>(&n, direction);
            if SHARED {
                Edges {
                    u: dot::<L>(&splat3::<L>(&self.u, j), direction),
                    v: dot::<L>(&splat3::<L>(&self.v, j), direction),
                    num: L::splat(*self.a[0].get_unchecked(j)),
                    den,
                }
            } else {
                let a = splat3::<L>(&self.a, j);
                let c = sub3::<L>(&a, origin);
                let r = cross_lanes::<L>(&c, direction);
                let u = dot::<L>(&splat3::<L>(&self.u, j), &r);
                let v = dot::<L>(&splat3::<L>(&self.v, j), &r);
                Edges {
                    u: L::flip_sign(u, den),
                    v: L::flip_sign(v, den),
                    num: L::flip_sign(dot::<L>(&n, &c), den),
                    den: L::abs(den),
                }
            }
        }
    }

    /// The padded slab interval of triangle `j`'s own box.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `j` is below [`CHUNK`].
    #[inline(always)]
    pub unsafe fn clip<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
        &self,
        j: usize,
        v: &RayVector<L>,
        shared_origin: Option<Vec3>,
    ) -> (L::F, L::F) {
        // SAFETY: as promised.
        unsafe {
            let slabs = SlabBox::<L>::new(&self.bounds(j), shared_origin);
            slabs.interval::<SHARED, SPECIAL>(&v.inverse, &v.origin, v.tmin)
        }
    }
}

impl<L: Lanes> Edges<L> {
    /// Lanes whose ray meets the triangle on the inner side of all edges, wherever along it. NaN
    /// is outside.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    pub unsafe fn inside(&self) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let zero = L::splat(0.0);
            let inside = L::and(L::le(zero, self.u), L::le(zero, self.v));
            L::and(inside, L::le(L::add(self.u, self.v), self.den))
        }
    }
}

/// # Safety
/// The processor has `L`'s instruction set; `j` is below [`CHUNK`].
#[inline(always)]
unsafe fn splat3<L: Lanes>(of: &[Numbers; 3], j: usize) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            L::splat(*of[0].get_unchecked(j)),
            L::splat(*of[1].get_unchecked(j)),
            L::splat(*of[2].get_unchecked(j)),
        ]
    }
}

/// # Safety
/// As for [`Chunk::prepare`].
#[inline(always)]
unsafe fn store3<L: Lanes>(to: &mut [Numbers; 3], at: usize, v: &[L::F; 3]) {
    for (to, &v) in to.iter_mut().zip(v) {
        // SAFETY: as promised.
        unsafe { L::store(to.as_mut_ptr().add(at), v) }
    }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn sub3<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3]) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe { [L::sub(a[0], b[0]), L::sub(a[1], b[1]), L::sub(a[2], b[2])] }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn flip3<L: Lanes>(v: &[L::F; 3], sign: L::F) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            L::flip_sign(v[0], sign),
            L::flip_sign(v[1], sign),
            L::flip_sign(v[2], sign),
        ]
    }
}

/// Cross product without fused operations.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn cross3<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3]) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            L::sub(L::mul(a[1], b[2]), L::mul(a[2], b[1])),
            L::sub(L::mul(a[2], b[0]), L::mul(a[0], b[2])),
            L::sub(L::mul(a[0], b[1]), L::mul(a[1], b[0])),
        ]
    }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn dot<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3]) -> L::F {
    // SAFETY: as promised.
    unsafe { L::mul_add(a[2], b[2], L::mul_add(a[1], b[1], L::mul(a[0], b[0]))) }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn cross_lanes<L: Lanes>(a: &[L::F; 3], b: &[L::F; 3]) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            L::mul_sub(a[1], b[2], L::mul(a[2], b[1])),
            L::mul_sub(a[2], b[0], L::mul(a[0], b[2])),
            L::mul_sub(a[0], b[1], L::mul(a[1], b[0])),
        ]
    }
}
