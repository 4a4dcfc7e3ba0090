//! Ray filtering: keeping the active rays that meet a box (Nabata 2013, Algorithm 1, lines 29
//! and 34).

use super::slab::SlabBox;
use super::{List, Rays};
use crate::geometry::Aabb;
use crate::simd::{Lanes, load3};

/// Where the kept rays go.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Keep {
    /// To the places from this one on; the list stays as it is.
    Copy(usize),
    /// To the front of the list, the others behind them, both in their old order.
    InPlace,
}

/// One vector of a list, and which of its rays are kept.
struct Block<L: Lanes> {
    kept: L::M,
    inverse: [L::F; 3],
    /// Meaningless where the origin is shared.
    origin: [L::F; 3],
    id: L::U,
}

/// The block at `at`, of which the list has `left` rays: kept are those that meet the box no further
/// away than their best hit.
///
/// # Safety
/// As for [`filter`]; `at` is within the list.
#[inline(always)]
unsafe fn kept<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    rays: &Rays,
    slabs: &SlabBox<L>,
    at: usize,
    left: usize,
) -> Block<L> {
    let s = &rays.active;
    // SAFETY: whole vectors within the streams, which have room for them behind every list; ids
    // are gathered with only where a list entry is, so they are rays of the batch.
    unsafe {
        let inverse = load3::<L>(&s.inverse, at);
        let origin = if SHARED {
            inverse
        } else {
            load3::<L>(&s.origin, at)
        };
        let id = L::load_u(s.id.add(at));
        let tmin = L::splat(rays.least_tmin);
        let (near, far) = slabs.interval::<SHARED, SPECIAL>(&inverse, &origin, tmin);
        let mut kept = L::and(L::le(near, far), L::first(left));
        if !SHARED && rays.ahead {
            for lane in 0..L::N {
                let next = *s.id.add(at + 2 * L::N + lane) as usize;
                L::prefetch(rays.t.wrapping_add(next));
            }
        }
        if L::bits(kept) != 0 {
            // Rays next to each other in the batch need no gather.
            let first = *s.id.add(at);
            let neighbours = L::eq_u(id, L::count_from(first));
            let t = if left >= L::N && L::bits(neighbours) == L::bits(L::first(L::N)) {
                L::load(rays.t.add(first as usize))
            } else {
                L::gather(rays.t, id, kept)
            };
            kept = L::and(kept, L::le(near, t));
        }
        Block {
            kept,
            inverse,
            origin,
            id,
        }
    }
}

/// Keeps the rays of a list that meet a box; returns how many.
///
/// # Safety
/// The processor has `L`'s instruction set; `rays` keeps its promises; `list` is a list of it; a
/// copy has room for `list.len` records and a whole vector from its place on.
#[inline(always)]
pub(crate) unsafe fn filter<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    rays: &Rays,
    list: List,
    bounds: &Aabb,
    keep: Keep,
) -> usize {
    let (s, scratch) = (&rays.active, &rays.scratch);
    // SAFETY: see above. In place, whole vectors are stored only while the whole vector at
    // `list.start + i` has been read, so they end within it; the last, partial one is stored lane
    // by lane, for live rays of the parent's list stand behind it.
    unsafe {
        let slabs = SlabBox::<L>::new(bounds, rays.shared_origin);
        let start = match keep {
            Keep::Copy(place) => place,
            Keep::InPlace => list.start,
        };
        let mut n = 0;
        let mut rejected = 0;
        for i in (0..list.len).step_by(L::N) {
            let (at, left) = (list.start + i, list.len - i);
            let Block {
                kept,
                inverse,
                origin,
                id,
            } = kept::<L, SHARED, SPECIAL>(rays, &slabs, at, left);
            let count = L::bits(kept).count_ones() as usize;
            let to = start + n;
            n += count;
            if keep == Keep::InPlace {
                let lanes = left.min(L::N);
                if count == lanes && to == at {
                    continue;
                }
                let dropped = L::and_not(L::first(left), kept);
                for axis in 0..3 {
                    let v = L::compress(dropped, inverse[axis]);
                    L::store(scratch.inverse[axis].add(rejected), v);
                    if !SHARED {
                        let v = L::compress(dropped, origin[axis]);
                        L::store(scratch.origin[axis].add(rejected), v);
                    }
                }
                L::store_u(scratch.id.add(rejected), L::compress_u(dropped, id));
                rejected += lanes - count;
                if left < L::N {
                    for axis in 0..3 {
                        let v = L::compress(kept, inverse[axis]);
                        L::store_first(s.inverse[axis].add(to), v, count);
                        if !SHARED {
                            let v = L::compress(kept, origin[axis]);
                            L::store_first(s.origin[axis].add(to), v, count);
                        }
                    }
                    L::store_first_u(s.id.add(to), L::compress_u(kept, id), count);
                    continue;
                }
            }
            if count != 0 {
                for axis in 0..3 {
                    L::store(s.inverse[axis].add(to), L::compress(kept, inverse[axis]));
                    if !SHARED {
                        L::store(s.origin[axis].add(to), L::compress(kept, origin[axis]));
                    }
                }
                L::store_u(s.id.add(to), L::compress_u(kept, id));
            }
        }
        for i in (0..rejected).step_by(L::N) {
            let (to, lanes) = (start + n + i, (rejected - i).min(L::N));
            for axis in 0..3 {
                let v = L::load(scratch.inverse[axis].add(i));
                L::store_first(s.inverse[axis].add(to), v, lanes);
                if !SHARED {
                    let v = L::load(scratch.origin[axis].add(i));
                    L::store_first(s.origin[axis].add(to), v, lanes);
                }
            }
            L::store_first_u(s.id.add(to), L::load_u(scratch.id.add(i)), lanes);
        }
        n
    }
}

/// Keeps the rays of a list that meet each of two boxes, in copies from two places on; returns how many.
///
/// # Safety
/// The processor has `L`'s instruction set; `rays` keeps its promises; `list` is a list of it; from each
/// place on there is room for `list.len` records and a whole vector.
#[inline(always)]
pub(crate) unsafe fn filter_both<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    rays: &Rays,
    list: List,
    boxes: [&Aabb; 2],
    places: [usize; 2],
) -> [usize; 2] {
    let s = &rays.active;
    // SAFETY: as promised.
    unsafe {
        let slabs = [
            SlabBox::<L>::new(boxes[0], rays.shared_origin),
            SlabBox::<L>::new(boxes[1], rays.shared_origin),
        ];
        let tmin = L::splat(rays.least_tmin);
        let mut to = places;
        for i in (0..list.len).step_by(L::N) {
            let (at, left) = (list.start + i, list.len - i);
            let lanes = L::first(left);
            let id = L::load_u(s.id.add(at));
            if rays.ahead {
                for lane in 0..L::N {
                    let next = *s.id.add(at + 2 * L::N + lane) as usize;
                    L::prefetch(rays.t.wrapping_add(next));
                }
            }
            let t = L::gather(rays.t, id, lanes);
            let inverse = load3::<L>(&s.inverse, at);
            let origin = if SHARED {
                inverse
            } else {
                load3::<L>(&s.origin, at)
            };
            for side in 0..2 {
                let (near, far) = slabs[side].interval::<SHARED, SPECIAL>(&inverse, &origin, tmin);
                let kept = L::and(L::le(near, L::min(far, t)), lanes);
                let n = to[side];
                for axis in 0..3 {
                    L::store(s.inverse[axis].add(n), L::compress(kept, inverse[axis]));
                    if !SHARED {
                        L::store(s.origin[axis].add(n), L::compress(kept, origin[axis]));
                    }
                }
                L::store_u(s.id.add(n), L::compress_u(kept, id));
                to[side] = n + L::bits(kept).count_ones() as usize;
            }
        }
        [to[0] - places[0], to[1] - places[1]]
    }
}

/// Rays tested by one step of [`count`].
pub(crate) const BLOCK: usize = 16;

/// Counts the rays that [`filter`] would keep, in every `stride`-th block of [`BLOCK`] rays.
/// Returns (kept, tested).
///
/// # Safety
/// As for [`filter`].
#[inline(always)]
pub(crate) unsafe fn count<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    rays: &Rays,
    list: List,
    bounds: &Aabb,
    stride: usize,
) -> (usize, usize) {
    // SAFETY: as promised.
    unsafe {
        let slabs = SlabBox::<L>::new(bounds, rays.shared_origin);
        let (mut n, mut tested) = (0, 0);
        for block in (0..list.len).step_by(BLOCK * stride) {
            let end = (block + BLOCK).min(list.len);
            for i in (block..end).step_by(L::N) {
                let Block { kept, .. } =
                    kept::<L, SHARED, SPECIAL>(rays, &slabs, list.start + i, end - i);
                n += L::bits(kept).count_ones() as usize;
            }
            tested += end - block;
        }
        (n, tested)
    }
}

#[cfg(test)]
mod tests;
