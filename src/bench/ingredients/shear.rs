//! Woop, Benthin and Wald 2013: corners relative to the origin of the ray, sheared so that the ray
//! runs along an axis; the edge functions are then differences of two products.

use super::products::Products;
use super::{Crossing, Estimate, RayVector};
use crate::kernels::sub3;
use crate::simd::Lanes;
use std::marker::PhantomData;

/// The test, with edge functions computed in one way or another. Zero is inside, for both triangles
/// of an edge: no float64 for what is zero, as the paper has it.
pub(super) struct Test<P>(PhantomData<P>);

/// What is computed of rays.
#[derive(Clone, Copy)]
pub(super) struct Sheared<L: Lanes> {
    origin: [L::F; 3],
    /// Whether the largest component of the direction is x; or y.
    along_x: L::M,
    along_y: L::M,
    shear: [L::F; 3],
}

impl<L: Lanes> Sheared<L> {
    /// The axes in turn, so that the one along which the ray runs comes last.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; so for all that follow.
    #[inline(always)]
    unsafe fn turn(along_x: L::M, along_y: L::M, [x, y, z]: [L::F; 3]) -> [L::F; 3] {
        // SAFETY: as promised.
        unsafe {
            [
                L::select(along_x, y, L::select(along_y, z, x)),
                L::select(along_x, z, L::select(along_y, x, y)),
                L::select(along_x, x, L::select(along_y, y, z)),
            ]
        }
    }

    #[inline(always)]
    unsafe fn corner(&self, corner: &[L::F; 3]) -> [L::F; 3] {
        // SAFETY: as promised.
        unsafe {
            let corner = sub3::<L>(corner, &self.origin);
            let [x, y, z] = Self::turn(self.along_x, self.along_y, corner);
            [
                L::sub(x, L::mul(self.shear[0], z)),
                L::sub(y, L::mul(self.shear[1], z)),
                L::mul(self.shear[2], z),
            ]
        }
    }
}

impl<P: Products> super::Test for Test<P> {
    type Ray<L: Estimate> = Sheared<L>;
    type Triangle<L: Estimate> = [[L::F; 3]; 3];

    #[inline(always)]
    unsafe fn ray<L: Estimate>(ray: &RayVector<L>) -> Sheared<L> {
        // SAFETY: as promised.
        unsafe {
            let d = ray.direction;
            let [x, y, z] = [L::abs(d[0]), L::abs(d[1]), L::abs(d[2])];
            let along_x = L::and(L::lt(y, x), L::lt(z, x));
            let along_y = L::and_not(L::lt(z, y), along_x);
            let [x, y, z] = Sheared::<L>::turn(along_x, along_y, d);
            Sheared {
                origin: ray.origin,
                along_x,
                along_y,
                shear: [L::div(x, z), L::div(y, z), L::div(L::splat(1.0), z)],
            }
        }
    }

    #[inline(always)]
    unsafe fn triangle<L: Estimate>(corners: &[[L::F; 3]; 3], _: &[L::F; 3]) -> [[L::F; 3]; 3] {
        *corners
    }

    #[inline(always)]
    unsafe fn crossing<L: Estimate>(ray: &Sheared<L>, corners: &[[L::F; 3]; 3]) -> Crossing<L> {
        // SAFETY: as promised.
        unsafe {
            let [ax, ay, az] = ray.corner(&corners[0]);
            let [bx, by, bz] = ray.corner(&corners[1]);
            let [cx, cy, cz] = ray.corner(&corners[2]);
            let u = P::difference::<L>(cx, by, cy, bx);
            let v = P::difference::<L>(ax, cy, ay, cx);
            let w = P::difference::<L>(bx, ay, by, ax);
            let zero = L::splat(0.0);
            let least = L::min(L::min(u, v), w);
            let most = L::max(L::max(u, v), w);
            let num = L::mul_add(w, cz, L::mul_add(v, bz, L::mul(u, az)));
            Crossing {
                inside: L::or(L::le(zero, least), L::le(most, zero)),
                num,
                den: L::add(L::add(u, v), w),
            }
        }
    }
}
