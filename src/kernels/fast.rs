//! The kernel of record of `fast`: float32 decides.

use super::naive::{Best, RayList, RayVector, Record, TriangleList};
use super::triangle::Prepared;
use crate::simd::Lanes;

/// Precision `fast`.
pub(crate) struct Fast;

impl<L: Lanes> Record<L> for Fast {
    const BOUNDED: bool = false;
    const BY_STORED_T: bool = true;
    type Margin = ();

    #[inline(always)]
    unsafe fn margin<const SHARED: bool>(_: &RayVector<L>, _: &impl RayList<L>) {}

    #[inline(always)]
    unsafe fn may_hit<const SHARED: bool>(of: &Prepared, v: &RayVector<L>, _: ()) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let edges = of.edges::<L, SHARED>(&v.origin, &v.direction);
            edges.inside()
        }
    }

    #[inline(always)]
    unsafe fn hit<const SHARED: bool, const SPECIAL: bool, const ANY: bool>(
        of: &Prepared,
        v: &RayVector<L>,
        _: (),
        best: &mut Best<L>,
        rays: &impl RayList<L>,
        _: &impl TriangleList<L>,
    ) {
        // SAFETY: as promised.
        unsafe {
            let edges = of.edges::<L, SHARED>(&v.origin, &v.direction);
            // A ray in the plane has a denominator of 0, so that t is NaN or infinite: a miss.
            let t = L::div(edges.num, edges.den);
            let in_reach = L::and(L::lt(v.tmin, t), L::le(t, best.t));
            let in_reach = L::and(in_reach, L::lt(t, L::splat(f32::INFINITY)));
            let hit = L::and(L::and(edges.inside(), v.active), in_reach);
            if L::bits(hit) == 0 {
                return;
            }
            let (near, far) = of.clip::<L, SHARED, SPECIAL>(v, rays.shared_origin());
            let hit = L::and(hit, L::and(L::le(near, t), L::le(t, far)));
            best.take::<ANY>(hit, t, of.prim);
        }
    }
}
