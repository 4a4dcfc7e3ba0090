//! The first pass over a block of rays: valid ones are brought together, in order. And the last: their
//! hits go where they belong.

use super::Rays;
use super::groups::{GROUP, Ordered};
use super::order::SortedRay;
use super::prepare::{self, PreparedRays, ends_far, inverse, one};
use super::records::least_of;
use crate::rays::{Batch, MISS};
use crate::simd::{Lanes, MAX_LANES};
use std::ops::Range;

/// What there is of the rays of a block besides [`Rays`].
#[derive(Clone, Copy)]
pub(crate) struct BlockStreams {
    pub ordered: Ordered,
    pub tmax: *mut f32,
    /// Where each ray stands in the batch.
    pub places: *mut u32,
}

/// Where rays come from.
pub(crate) enum Source<'a> {
    Batch(&'a Batch),
    /// Records, and where their rays stand in the batch.
    Records(&'a [SortedRay], &'a [u32]),
}

/// A vector of rays as they are.
pub(super) struct Loaded<L: Lanes> {
    pub origin: [L::F; 3],
    pub direction: [L::F; 3],
    pub tmin: L::F,
    pub tmax: L::F,
    /// Places in the batch.
    pub place: L::U,
}

/// Up to `L::N` rays from place `at` of a source on, of which there are `left`; the other lanes are
/// anything.
///
/// # Safety
/// The processor has `L`'s instruction set; there are as many rays.
#[inline(always)]
pub(super) unsafe fn load<L: Lanes>(from: &Source, at: usize, left: usize) -> Loaded<L> {
    const IN_A_ROW: [u32; MAX_LANES] = {
        let mut row = [0; MAX_LANES];
        let mut i = 0;
        while i < MAX_LANES {
            row[i] = i as u32;
            i += 1;
        }
        row
    };
    // SAFETY: as promised; where whole vectors would pass the end, its last rays are read from a copy.
    unsafe {
        match from {
            Source::Batch(batch) => Loaded {
                origin: prepare::load3::<L>(&batch.origin, at),
                direction: prepare::load3::<L>(&batch.direction, at),
                tmin: prepare::load::<L>(&batch.tmin, at),
                tmax: prepare::load::<L>(&batch.tmax, at),
                place: L::count_from(at as u32),
            },
            Source::Records(records, places) => {
                let (mut last, mut last_places);
                let (records, places) = match left >= L::N {
                    true => (records[at..].as_ptr(), places[at..].as_ptr()),
                    false => {
                        last = [[[0f32; 4]; 2]; MAX_LANES];
                        last_places = [0; MAX_LANES];
                        last[..left].copy_from_slice(&records[at..at + left]);
                        last_places[..left].copy_from_slice(&places[at..at + left]);
                        (last.as_ptr(), last_places.as_ptr())
                    }
                };
                let base: *const [f32; 4] = records.cast();
                let [ox, oy, oz, tmin] = L::gather4::<2>(base, IN_A_ROW.as_ptr());
                let [dx, dy, dz, tmax] = L::gather4::<2>(base.add(1), IN_A_ROW.as_ptr());
                Loaded {
                    origin: [ox, oy, oz],
                    direction: [dx, dy, dz],
                    tmin,
                    tmax,
                    place: L::load_u(places),
                }
            }
        }
    }
}

/// The best t of a place without a ray: nothing is ever nearer.
const NOBODY: f32 = -1.0;

/// Brings rays `range` of a source to the front of their streams, with numbers from 0 on; invalid ones are
/// left out. The last group is filled up.
///
/// # Safety
/// The processor has `L`'s instruction set; all streams have room for the range, a group and a vector.
#[inline(always)]
pub(crate) unsafe fn load_block<L: Lanes>(
    from: &Source,
    range: Range<usize>,
    rays: &Rays,
    streams: &BlockStreams,
) -> PreparedRays {
    let shared = rays.shared_origin.is_some();
    let (s, ordered) = (&rays.active, &streams.ordered);
    // SAFETY: as promised.
    unsafe {
        let infinity = L::splat(f32::INFINITY);
        let mut least_tmin = infinity;
        let mut special = L::first(0);
        let (mut first_tmax, mut last_tmax) = (infinity, L::splat(0.0));
        let mut n = 0;
        for at in range.clone().step_by(L::N) {
            let left = range.end - at;
            let Loaded {
                origin,
                direction,
                tmin,
                tmax,
                place,
            } = load::<L>(from, at, left);
            let valid = prepare::valid::<L>(&origin, &direction, tmin, tmax);
            let valid = L::and(valid, L::first(left));
            least_tmin = L::select(valid, L::min(tmin, least_tmin), least_tmin);
            special = L::or(special, L::and(valid, ends_far::<L>(tmax)));
            first_tmax = L::select(valid, L::min(tmax, first_tmax), first_tmax);
            last_tmax = L::select(valid, L::max(tmax, last_tmax), last_tmax);
            let mut d = direction;
            for axis in 0..3 {
                let (inverse, finite) = inverse::<L>(direction[axis], rays.precision);
                special = L::or(special, L::and_not(valid, finite));
                L::store(s.inverse[axis].add(n), L::compress(valid, inverse));
                if !shared {
                    L::store(s.origin[axis].add(n), L::compress(valid, origin[axis]));
                }
                d[axis] = L::compress(valid, direction[axis]);
                L::store(ordered.direction[axis].add(n), d[axis]);
            }
            let (tmin, tmax) = (L::compress(valid, tmin), L::compress(valid, tmax));
            L::store(ordered.tmin.add(n), tmin);
            L::store4(rays.directions.add(n), [d[0], d[1], d[2], tmin]);
            L::store(rays.t.add(n), tmax);
            L::store(streams.tmax.add(n), tmax);
            L::store_u(rays.prim.add(n), L::splat_u(MISS));
            L::store_u(streams.places.add(n), L::compress_u(valid, place));
            n += L::bits(valid).count_ones() as usize;
        }
        for i in n..n.next_multiple_of(GROUP) {
            for axis in 0..3 {
                *s.inverse[axis].add(i) = *s.inverse[axis].add(n - 1);
                if !shared {
                    *s.origin[axis].add(i) = *s.origin[axis].add(n - 1);
                }
                *ordered.direction[axis].add(i) = *ordered.direction[axis].add(n - 1);
            }
            *ordered.tmin.add(i) = 0.0;
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

/// How many rays ahead the places of their answers are brought near.
const NEAR: usize = 16;

/// Writes the best hits of rays to their places in the batch.
///
/// # Safety
/// The processor has `L`'s instruction set; the best hits in `rays` are there for each place, and the places
/// are good for writing.
#[inline(always)]
pub(crate) unsafe fn store_hits<L: Lanes>(
    rays: &Rays,
    places: &[u32],
    t: *mut f32,
    prim: *mut u32,
) {
    for (i, &place) in places.iter().enumerate() {
        let next = places[(i + NEAR).min(places.len() - 1)] as usize;
        // SAFETY: as promised; the address of a prefetch may be any.
        unsafe {
            L::prefetch(t.wrapping_add(next));
            L::prefetch(prim.wrapping_add(next).cast_const().cast());
            let found = *rays.prim.add(i);
            *t.add(place as usize) = match found {
                MISS => f32::INFINITY,
                _ => *rays.t.add(i),
            };
            *prim.add(place as usize) = found;
        }
    }
}
