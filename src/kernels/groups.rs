//! Groups: 64 consecutive rays with bounds on their origins and inverse directions, tested against a
//! box as one ray is, sixteen groups at a time.
//!
//! Mora 2011 has conic packets, which need a shared origin, and Nabata 2013 sample rays. A group holds
//! for rays of any origin, and sample rays say where it no longer pays.

use super::Rays;
use super::naive::{RayList, RayVector};
use super::slab::{SlabBox, padded};
use crate::geometry::Aabb;
use crate::simd::{Lanes, MAX_LANES, lanes_of_bits, load3};
use glam::Vec3;

/// Rays of a group.
pub(crate) const GROUP: usize = 64;
/// Rays, or groups, that an entry speaks of.
pub(crate) const ENTRY: usize = 16;

/// Some of [`ENTRY`] neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    /// The first of them is number `16 * at`.
    pub at: u32,
    /// Which of them: never none.
    pub mask: u32,
}

impl Entry {
    pub const ZERO: Entry = Entry { at: 0, mask: 0 };
}

/// Bounds of groups: element `i` of each stream belongs to group `i`.
#[derive(Clone, Copy)]
pub(crate) struct Groups {
    pub origin_lo: [*mut f32; 3],
    pub origin_hi: [*mut f32; 3],
    pub inverse_lo: [*mut f32; 3],
    pub inverse_hi: [*mut f32; 3],
    /// The furthest of the best t so far.
    pub far: *mut f32,
}

impl Groups {
    /// How many streams there are.
    pub const STREAMS: usize = 13;

    /// With its streams one behind the other.
    pub fn new(bounds: &mut [f32]) -> Groups {
        let s: [*mut f32; Groups::STREAMS] = streams(bounds);
        Groups {
            origin_lo: [s[0], s[1], s[2]],
            origin_hi: [s[3], s[4], s[5]],
            inverse_lo: [s[6], s[7], s[8]],
            inverse_hi: [s[9], s[10], s[11]],
            far: s[12],
        }
    }
}

/// Streams of equal length, one behind the other.
pub(crate) fn streams<const N: usize>(of: &mut [f32]) -> [*mut f32; N] {
    let len = of.len() / N;
    let base = of.as_mut_ptr();
    // SAFETY: there are N times as many numbers.
    std::array::from_fn(|i| unsafe { base.add(i * len) })
}

/// Directions and tmin of the rays of a block, by number.
#[derive(Clone, Copy)]
pub(crate) struct Ordered {
    pub direction: [*mut f32; 3],
    pub tmin: *mut f32,
}

/// The least of 16 numbers.
#[inline(always)]
fn least(mut of: [f32; ENTRY]) -> f32 {
    let mut width = ENTRY / 2;
    while width > 0 {
        for i in 0..width {
            of[i] = if of[i + width] < of[i] {
                of[i + width]
            } else {
                of[i]
            };
        }
        width /= 2;
    }
    of[0]
}

/// The least and the greatest of a group's numbers.
///
/// # Safety
/// The processor has `L`'s instruction set; a group of numbers from `p` on.
#[inline(always)]
unsafe fn range<L: Lanes>(p: *const f32) -> (f32, f32) {
    // SAFETY: as promised.
    unsafe {
        let zero = L::splat(0.0);
        let (mut lo, mut hi) = ([0f32; ENTRY], [0f32; ENTRY]);
        for part in (0..ENTRY).step_by(L::N) {
            let v = L::load(p.add(part));
            let (mut a, mut b) = (v, v);
            for at in (ENTRY..GROUP).step_by(ENTRY) {
                let v = L::load(p.add(part + at));
                a = L::min(v, a);
                b = L::max(v, b);
            }
            L::store(lo.as_mut_ptr().add(part), a);
            L::store(hi.as_mut_ptr().add(part), L::sub(zero, b));
        }
        (least(lo), -least(hi))
    }
}

/// Makes the bounds of the groups of `len` rays, which are in their streams in order.
///
/// # Safety
/// The processor has `L`'s instruction set; behind the last ray its group is filled up with rays like
/// it.
#[inline(always)]
pub(crate) unsafe fn bound_groups<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    rays: &Rays,
    groups: &Groups,
    len: usize,
) {
    // SAFETY: as promised.
    unsafe {
        for g in 0..len.div_ceil(GROUP) {
            for axis in 0..3 {
                let inverse = rays.active.inverse[axis].add(g * GROUP);
                let (mut lo, mut hi) = range::<L>(inverse);
                let mixed = lo < 0.0 && hi > 0.0;
                let unbounded = SPECIAL && (0..GROUP).any(|i| (*inverse.add(i)).is_nan());
                if mixed || unbounded {
                    (lo, hi) = (f32::NEG_INFINITY, f32::INFINITY);
                }
                *groups.inverse_lo[axis].add(g) = lo;
                *groups.inverse_hi[axis].add(g) = hi;
                if !SHARED {
                    let (lo, hi) = range::<L>(rays.active.origin[axis].add(g * GROUP));
                    *groups.origin_lo[axis].add(g) = lo;
                    *groups.origin_hi[axis].add(g) = hi;
                }
            }
            *groups.far.add(g) = range::<L>(rays.t.add(g * GROUP)).1;
        }
    }
}

/// Groups of which no ray meets the box no further away than its best hit.
///
/// # Safety
/// The processor has `L`'s instruction set; groups from `at` on.
#[inline(always)]
unsafe fn missing<L: Lanes, const SHARED: bool>(
    groups: &Groups,
    bounds: &Aabb,
    origin: Vec3,
    tmin: f32,
    at: usize,
) -> L::M {
    let (lo, hi) = (bounds.min - origin, bounds.max - origin);
    // SAFETY: as promised. The operations on each corner of the bounds are those of
    // `SlabBox::interval`, and all of them are monotone. A NaN is passed over, or lets the group pass.
    unsafe {
        let (i0, i1) = (
            load3::<L>(&groups.inverse_lo, at),
            load3::<L>(&groups.inverse_hi, at),
        );
        let mut near = L::splat(tmin);
        let mut far = L::splat(f32::INFINITY);
        for axis in 0..3 {
            let (mut lo, mut hi) = (L::splat(lo[axis]), L::splat(hi[axis]));
            if !SHARED {
                lo = L::sub(lo, L::load(groups.origin_hi[axis].add(at)));
                hi = L::sub(hi, L::load(groups.origin_lo[axis].add(at)));
            }
            let (a, b) = (L::mul(lo, i0[axis]), L::mul(lo, i1[axis]));
            let (c, d) = (L::mul(hi, i0[axis]), L::mul(hi, i1[axis]));
            near = L::max(L::min(L::min(a, b), L::min(c, d)), near);
            far = L::min(L::max(L::max(a, b), L::max(c, d)), far);
        }
        let (near, far) = padded::<L>(near, far);
        L::or(L::lt(far, near), L::lt(L::load(groups.far.add(at)), near))
    }
}

/// Which groups of a list may meet each of two boxes; returns the lengths of both lists.
///
/// # Safety
/// The processor has `L`'s instruction set; entries are of groups that there are; both lists are as long
/// as the entries.
#[inline(always)]
pub(crate) unsafe fn filter_groups<L: Lanes, const SHARED: bool>(
    rays: &Rays,
    groups: &Groups,
    entries: &[Entry],
    boxes: [&Aabb; 2],
    to: [*mut Entry; 2],
) -> [usize; 2] {
    let origin = rays.shared_origin.unwrap_or(Vec3::ZERO);
    let mut n = [0; 2];
    for entry in entries {
        for side in 0..2 {
            let mut mask = entry.mask;
            for part in (0..ENTRY).step_by(L::N) {
                let at = ENTRY * entry.at as usize + part;
                // SAFETY: as promised.
                unsafe {
                    let out =
                        missing::<L, SHARED>(groups, boxes[side], origin, rays.least_tmin, at);
                    mask &= !(L::bits(out) << part);
                }
            }
            // SAFETY: as promised; n is no larger than the number of entries seen.
            unsafe { *to[side].add(n[side]) = Entry { mask, ..*entry } };
            n[side] += (mask != 0) as usize;
        }
    }
    n
}

/// Rays of a vector that meet the box no further away than their best hit, of those in order.
///
/// # Safety
/// The processor has `L`'s instruction set; rays from `at` on.
#[inline(always)]
unsafe fn meeting<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    rays: &Rays,
    slabs: &SlabBox<L>,
    at: usize,
) -> ([L::F; 3], [L::F; 3], L::M) {
    // SAFETY: as promised.
    unsafe {
        let inverse = load3::<L>(&rays.active.inverse, at);
        let origin = if SHARED {
            inverse
        } else {
            load3::<L>(&rays.active.origin, at)
        };
        let tmin = L::splat(rays.least_tmin);
        let (near, far) = slabs.interval::<SHARED, SPECIAL>(&inverse, &origin, tmin);
        let t = L::load(rays.t.add(at));
        (inverse, origin, L::and(L::le(near, far), L::le(near, t)))
    }
}

/// The rays of groups that meet a box, sixteen to an entry; returns how many entries and rays.
///
/// # Safety
/// The processor has `L`'s instruction set; entries are of groups that there are; `to` has room for four times as many as there are groups.
#[inline(always)]
pub(crate) unsafe fn rays_of_groups<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    rays: &Rays,
    entries: &[Entry],
    bounds: &Aabb,
    to: *mut Entry,
) -> (usize, usize) {
    let (mut n, mut count) = (0, 0);
    // SAFETY: as promised.
    unsafe {
        let slabs = SlabBox::<L>::new(bounds, rays.shared_origin);
        for entry in entries {
            let mut mask = entry.mask;
            while mask != 0 {
                let group = ENTRY * entry.at as usize + mask.trailing_zeros() as usize;
                mask &= mask - 1;
                for at in (group * GROUP..(group + 1) * GROUP).step_by(ENTRY) {
                    let mut kept = 0;
                    for part in (0..ENTRY).step_by(L::N) {
                        let (_, _, m) = meeting::<L, SHARED, SPECIAL>(rays, &slabs, at + part);
                        kept |= L::bits(m) << part;
                    }
                    *to.add(n) = Entry {
                        at: (at / ENTRY) as u32,
                        mask: kept,
                    };
                    n += (kept != 0) as usize;
                    count += kept.count_ones() as usize;
                }
            }
        }
    }
    (n, count)
}

/// Copies the records of rays to the places from `place` on; returns how many.
///
/// # Safety
/// The processor has `L`'s instruction set; there is room for all of them and a whole vector.
#[inline(always)]
pub(crate) unsafe fn flush_groups<L: Lanes, const SHARED: bool>(
    rays: &Rays,
    entries: &[Entry],
    place: usize,
) -> usize {
    let s = &rays.active;
    let mut n = place;
    // SAFETY: as promised.
    unsafe {
        for entry in entries {
            for part in (0..ENTRY).step_by(L::N) {
                let at = ENTRY * entry.at as usize + part;
                let bits = (entry.mask >> part) & ((1u64 << L::N) - 1) as u32;
                let kept = lanes_of_bits::<L>(bits);
                for axis in 0..3 {
                    let v = L::load(s.inverse[axis].add(at));
                    L::store(s.inverse[axis].add(n), L::compress(kept, v));
                    if !SHARED {
                        let v = L::load(s.origin[axis].add(at));
                        L::store(s.origin[axis].add(n), L::compress(kept, v));
                    }
                }
                let id = L::count_from(at as u32);
                L::store_u(s.id.add(n), L::compress_u(kept, id));
                n += bits.count_ones() as usize;
            }
        }
    }
    n - place
}

/// Takes the furthest best t of groups anew.
///
/// # Safety
/// The processor has `L`'s instruction set; entries are of groups that there are.
#[inline(always)]
pub(crate) unsafe fn refresh_groups<L: Lanes>(rays: &Rays, groups: &Groups, entries: &[Entry]) {
    for entry in entries {
        let mut mask = entry.mask;
        while mask != 0 {
            let group = ENTRY * entry.at as usize + mask.trailing_zeros() as usize;
            mask &= mask - 1;
            // SAFETY: as promised.
            unsafe { *groups.far.add(group) = range::<L>(rays.t.add(group * GROUP)).1 }
        }
    }
}

/// Rays in order, sixteen to an entry.
#[derive(Clone, Copy)]
pub(crate) struct InOrder<'a> {
    pub rays: &'a Rays,
    pub ordered: &'a Ordered,
    pub entries: &'a [Entry],
}

impl InOrder<'_> {
    #[inline(always)]
    fn place(&self, i: usize) -> usize {
        // SAFETY: places are below the length.
        let entry = unsafe { self.entries.get_unchecked(i / ENTRY) };
        ENTRY * entry.at as usize + i % ENTRY
    }
}

// SAFETY: entries are of rays of the block, each once.
unsafe impl<L: Lanes> RayList<L> for InOrder<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        ENTRY * self.entries.len()
    }

    #[inline(always)]
    fn shared_origin(&self) -> Option<Vec3> {
        self.rays.shared_origin
    }

    #[inline(always)]
    unsafe fn tmax(&self, v: &RayVector<L>, lanes: L::M) -> L::F {
        // SAFETY: as promised.
        unsafe { self.rays.tmax.gather::<L>(v.id, lanes) }
    }

    #[inline(always)]
    fn scene(&self) -> &Aabb {
        &self.rays.scene
    }

    #[inline(always)]
    unsafe fn load<const SHARED: bool>(&self, i: usize) -> RayVector<L> {
        let rays = self.rays;
        let at = self.place(i);
        // SAFETY: as promised.
        unsafe {
            let mask = self.entries.get_unchecked(i / ENTRY).mask >> (i % ENTRY);
            let inverse = load3::<L>(&rays.active.inverse, at);
            let id = L::count_from(at as u32);
            RayVector {
                active: lanes_of_bits::<L>(mask),
                id,
                inverse,
                origin: if SHARED {
                    inverse
                } else {
                    load3::<L>(&rays.active.origin, at)
                },
                direction: load3::<L>(&self.ordered.direction, at),
                tmin: L::load(self.ordered.tmin.add(at)),
                t: L::load(rays.t.add(at)),
                prim: id,
            }
        }
    }

    #[inline(always)]
    unsafe fn id(&self, i: usize) -> u32 {
        self.place(i) as u32
    }

    #[inline(always)]
    unsafe fn found(&self, v: &RayVector<L>, lanes: L::M) -> L::U {
        // SAFETY: as promised.
        unsafe { self.rays.found::<L>(v.id, lanes) }
    }

    #[inline(always)]
    unsafe fn set<const ANY: bool>(&self, id: u32, t: f32, prim: u32) {
        // SAFETY: as promised.
        unsafe { self.rays.set::<ANY>(id, t, prim) }
    }
}

const _: () = assert!(ENTRY == MAX_LANES);

#[cfg(test)]
mod tests;
