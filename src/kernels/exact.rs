//! The kernel of record of `exact`: the least (t, prim) of exact arithmetic.
//!
//! Float32 with bounds ([`certain`]) decides about most rays and triangles, [`open`](super::open)
//! about the rest. A best t is stored a little too great, [`LATER`] times what it was computed as:
//! no sooner than the exact one, so that no box is passed over, and so near that two hits further
//! apart are in the order of their t. When all is over, each final hit's t is computed anew, rounded
//! once ([`round_hits`](crate::exact::round_hits)).

use super::certain::{self, Said, WITHIN};
use super::naive::{Best, RayList, RayVector, Record, TriangleList};
use super::open::OpenLanes;
use super::triangle::Prepared;
use crate::rays::MISS;
use crate::simd::{Lanes, MAX_LANES, lanes_of_bits};

/// Precision `exact`.
pub(crate) struct Exact;

/// What t is multiplied with before it is stored.
const LATER: f32 = 1.0 + WITHIN;

/// A t that, times this, is before a stored one is before the exact one: WITHIN for either
/// computed t, and twice for the stored one, whose second is by how much it is late.
const BEFORE: f32 = 1.0 + 4.0 * WITHIN;

/// A t of exact arithmetic, rounded to `t`, as it is stored.
fn later(t: f32) -> f32 {
    (t * LATER).next_up()
}

impl<L: Lanes> Record<L> for Exact {
    const BOUNDED: bool = true;
    const BY_STORED_T: bool = false;
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
            let earliest = L::mul(t, L::splat(1.0 - WITHIN));
            let latest = L::mul(t, L::splat(LATER));
            let too_early = L::and(sure, L::le(latest, v.tmin));
            let before = L::le(L::mul(t, L::splat(BEFORE)), best.t);
            let closer = L::and(sure, L::and(before, L::lt(v.tmin, earliest)));
            best.prim = L::select_u(closer, L::splat_u(prim), best.prim);
            best.t = match ANY {
                true => L::select(closer, L::splat(-1.0), best.t),
                false => L::select(closer, latest, best.t),
            };
            let open = L::or(open, L::and_not(L::and_not(sure, too_early), closer));
            best.changed = L::or(best.changed, closer);
            if L::bits(open) != 0 {
                decide::<L, SHARED, ANY>(of, v, open, best, rays, triangles);
            }
        }
    }
}

/// Decides about the open lanes.
///
/// # Safety
/// As for [`Record::hit`].
#[inline(always)]
unsafe fn decide<L: Lanes, const SHARED: bool, const ANY: bool>(
    of: &Prepared,
    v: &RayVector<L>,
    open: L::M,
    best: &mut Best<L>,
    rays: &impl RayList<L>,
    triangles: &impl TriangleList<L>,
) {
    let prim = of.prim;
    let triangle = triangles.triangle(prim);
    let (mut t, mut found) = ([0f32; MAX_LANES], [MISS; MAX_LANES]);
    // SAFETY: as promised.
    unsafe {
        let lanes = OpenLanes::new::<L, SHARED>(v, rays);
        L::store(t.as_mut_ptr(), best.t);
        if !ANY {
            let before = rays.found(v, open);
            let before = L::select_u(best.changed, best.prim, before);
            L::store_u(found.as_mut_ptr(), before);
        }
        let (mut bits, mut closer) = (L::bits(open), 0);
        while bits != 0 {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let hit = match found[lane] {
                MISS => lanes.until(lane, triangle, t[lane]),
                found => lanes.before(lane, triangle, triangles.triangle(found), prim < found),
            };
            if let Some(hit) = hit {
                t[lane] = if ANY { -1.0 } else { later(hit) };
                closer |= 1 << lane;
            }
        }
        let closer = lanes_of_bits::<L>(closer);
        best.t = L::load(t.as_ptr());
        best.prim = L::select_u(closer, L::splat_u(prim), best.prim);
        best.changed = L::or(best.changed, closer);
    }
}
