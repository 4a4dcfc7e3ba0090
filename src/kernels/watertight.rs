//! The kernel of record of `watertight`: whether a ray hits a triangle is decided as in exact
//! arithmetic, t is rounded as in `fast`.
//!
//! Two triangles that share an edge so leave no gap there and none where many share a corner, and no
//! box of a triangle that is hit is passed over ([`PADDING`](super::PADDING)). Float32 with bounds
//! ([`certain`]) decides about most rays and triangles, [`open`](super::open) about the rest, whose t
//! it rounds once.
//!
//! Woop, Benthin and Wald 2013 get the same by the exact signs of edge functions of corners that were
//! rounded relative to the origin of the ray. That moves a triangle by up to 5 u |v − o|, so that
//! boxes must be larger by as much, and from afar the mesh that is hit is another one.

use super::certain::{self, Said, WITHIN};
use super::naive::{Best, RayList, RayVector, Record, TriangleList};
use super::open::OpenLanes;
use super::triangle::Prepared;
use crate::simd::{Lanes, MAX_LANES, lanes_of_bits};

/// Precision `watertight`.
pub(crate) struct Watertight;

impl<L: Lanes> Record<L> for Watertight {
    const BOUNDED: bool = true;
    const BY_STORED_T: bool = true;
    type Margin = L::F;

    #[inline(always)]
    unsafe fn margin<const SHARED: bool>(v: &RayVector<L>, rays: &impl RayList<L>) -> L::F {
        // SAFETY: as promised.
        unsafe { certain::margin::<L, SHARED>(v, rays) }
    }

    #[inline(always)]
    unsafe fn may_hit<const SHARED: bool>(of: &Prepared, v: &RayVector<L>, margin: L::F) -> L::M {
        // SAFETY: as promised.
        unsafe { certain::may_hit::<L, SHARED>(of, v, margin) }
    }

    #[inline(always)]
    unsafe fn hit<const SHARED: bool, const SPECIAL: bool, const ANY: bool>(
        of: &Prepared,
        v: &RayVector<L>,
        margin: L::F,
        best: &mut Best<L>,
        rays: &impl RayList<L>,
        triangles: &impl TriangleList<L>,
    ) {
        let prim = of.prim;
        // SAFETY: as promised.
        unsafe {
            let Said { sure, open, t, .. } = certain::say::<L, SHARED>(of, v, margin, best.t);
            let some = L::or(sure, open);
            if L::bits(some) == 0 {
                return;
            }
            // Near the ends of the interval only the exact t tells. It must not depend on what was hit
            // before whether it is asked, so the ray's own tmax counts here.
            let tmax = rays.tmax(v, some);
            let earliest = L::mul(t, L::splat(1.0 - WITHIN));
            let latest = L::mul(t, L::splat(1.0 + WITHIN));
            let never = L::or(L::le(latest, v.tmin), L::lt(tmax, earliest));
            let sure = L::and_not(sure, never);
            let hit = L::and(sure, L::and(L::lt(v.tmin, earliest), L::le(latest, tmax)));
            let open = L::or(open, L::and_not(sure, hit));

            if L::bits(hit) != 0 {
                let shared = rays.shared_origin();
                let (near, far) = of.clip::<L, SHARED, SPECIAL>(v, shared);
                best.take::<ANY>(hit, L::max(near, L::min(t, far)), prim);
            }
            let mut bits = L::bits(open);
            if bits != 0 {
                let lanes = OpenLanes::new::<L, SHARED>(v, rays);
                let triangle = triangles.triangle(prim);
                let (mut t, mut last) = ([0f32; MAX_LANES], [0f32; MAX_LANES]);
                L::store(last.as_mut_ptr(), tmax);
                let mut hit = 0;
                while bits != 0 {
                    let lane = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    if let Some(at) = lanes.until(lane, triangle, last[lane]) {
                        t[lane] = at;
                        hit |= 1 << lane;
                    }
                }
                best.take::<ANY>(lanes_of_bits::<L>(hit), L::load(t.as_ptr()), prim);
            }
        }
    }
}
