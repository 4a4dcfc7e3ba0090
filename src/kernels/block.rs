//! The first pass over a block of rays: valid ones are brought together, in order.

use super::Rays;
use super::groups::{GROUP, Ordered};
use super::prepare::{self, PreparedRays, ends_far, inverse, one};
use super::records::least_of;
use crate::rays::{Batch, MISS};
use crate::simd::Lanes;
use std::ops::Range;

/// What there is of the rays of a block besides [`Rays`].
#[derive(Clone, Copy)]
pub(crate) struct BlockStreams {
    pub ordered: Ordered,
    pub tmax: *mut f32,
    /// Where each ray stands in the batch.
    pub places: *mut u32,
}

/// The best t of a place without a ray: nothing is ever nearer.
const NOBODY: f32 = -1.0;

/// `L::N` numbers of rays of the batch: those from `at` on, or whatever stands there in an order.
#[inline(always)]
unsafe fn load<L: Lanes, const SORTED: bool>(
    from: &[f32],
    at: usize,
    id: L::U,
    lanes: L::M,
) -> L::F {
    // SAFETY: as promised.
    unsafe {
        match SORTED {
            true => L::gather(from.as_ptr(), id, lanes),
            false => prepare::load::<L>(from, at),
        }
    }
}

/// Brings rays of a batch to the front of their streams, with numbers from 0 on; invalid ones are left out. The last group is filled up.
///
/// # Safety
/// The processor has `L`'s instruction set; all streams have room for the range and a group.
#[inline(always)]
pub(crate) unsafe fn load_block<L: Lanes, const SORTED: bool>(
    batch: &Batch,
    range: Range<usize>,
    order: &[u32],
    rays: &Rays,
    streams: &BlockStreams,
) -> PreparedRays {
    let shared = rays.shared_origin.is_some();
    let s = &rays.active;
    // SAFETY: as promised; ids are of rays of the batch.
    unsafe {
        let infinity = L::splat(f32::INFINITY);
        let mut least_tmin = infinity;
        let mut special = L::first(0);
        let (mut first_tmax, mut last_tmax) = (infinity, L::splat(0.0));
        let mut n = 0;
        for at in range.clone().step_by(L::N) {
            let left = range.end - at;
            let lanes = L::first(left);
            let id = match SORTED {
                true => L::load_u(order.as_ptr().add(at)),
                false => L::count_from(at as u32),
            };
            let mut origin = [infinity; 3];
            let mut direction = [infinity; 3];
            for axis in 0..3 {
                origin[axis] = load::<L, SORTED>(&batch.origin[axis], at, id, lanes);
                direction[axis] = load::<L, SORTED>(&batch.direction[axis], at, id, lanes);
            }
            let tmin = load::<L, SORTED>(&batch.tmin, at, id, lanes);
            let tmax = load::<L, SORTED>(&batch.tmax, at, id, lanes);
            let valid = L::and(prepare::valid::<L>(&origin, &direction, tmin, tmax), lanes);
            least_tmin = L::select(valid, L::min(tmin, least_tmin), least_tmin);
            let mut d = direction;
            for axis in 0..3 {
                let (inverse, finite) = inverse::<L>(direction[axis], rays.precision);
                special = L::or(special, L::and_not(valid, finite));
                L::store(s.inverse[axis].add(n), L::compress(valid, inverse));
                if !shared {
                    L::store(s.origin[axis].add(n), L::compress(valid, origin[axis]));
                }
                d[axis] = L::compress(valid, direction[axis]);
                L::store(streams.ordered.direction[axis].add(n), d[axis]);
            }
            special = L::or(special, L::and(valid, ends_far::<L>(tmax)));
            first_tmax = L::select(valid, L::min(tmax, first_tmax), first_tmax);
            last_tmax = L::select(valid, L::max(tmax, last_tmax), last_tmax);
            let tmin = L::compress(valid, tmin);
            L::store(streams.ordered.tmin.add(n), tmin);
            L::store4(rays.directions.add(n), [d[0], d[1], d[2], tmin]);
            let tmax = L::compress(valid, tmax);
            L::store(rays.t.add(n), tmax);
            L::store(streams.tmax.add(n), tmax);
            if !rays.any_hit {
                L::store_u(rays.prim.add(n), L::splat_u(MISS));
            }
            L::store_u(streams.places.add(n), L::compress_u(valid, id));
            n += L::bits(valid).count_ones() as usize;
        }
        for i in n..n.next_multiple_of(GROUP) {
            for axis in 0..3 {
                *s.inverse[axis].add(i) = *s.inverse[axis].add(n - 1);
                if !shared {
                    *s.origin[axis].add(i) = *s.origin[axis].add(n - 1);
                }
                *streams.ordered.direction[axis].add(i) =
                    *streams.ordered.direction[axis].add(n - 1);
            }
            *rays.t.add(i) = NOBODY;
        }
        PreparedRays {
            valid: n,
            special: L::bits(special) != 0,
            least_tmin: least_of::<L>(least_tmin),
            one_tmax: one::<L>(first_tmax, last_tmax),
        }
    }
}
