//! The first pass over rays and triangles: validity, inverse directions, boxes.

use super::records::least_of;
use super::slab::CREEPING;
use super::{Item, Rays, bins::BinBox};
use crate::exact::has_area;
use crate::geometry::{COORDINATE_LIMIT, Mesh, Triangle};
use crate::methods::Precision;
use crate::rays::Batch;
use crate::simd::Lanes;
use glam::{Vec3, Vec4, Vec4Swizzles};

/// What the pass over the rays found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedRays {
    /// Number of valid rays: the length of the root list.
    pub valid: usize,
    /// Whether a valid ray has an axis on which 1/d is not finite, or ends where t may overflow.
    pub special: bool,
    /// The least tmin of the valid rays.
    pub least_tmin: f32,
    /// The tmax of all of them, if it is the same.
    pub one_tmax: Option<f32>,
}

/// Lanes of valid rays among the `left` rays from `at` on; see [`crate::Ray::is_valid`].
///
/// # Safety
/// As for [`prepare_rays`].
#[inline(always)]
pub(super) unsafe fn valid<L: Lanes>(
    origin: &[L::F; 3],
    direction: &[L::F; 3],
    tmin: L::F,
    tmax: L::F,
) -> L::M {
    // SAFETY: as promised. NaN fails every comparison.
    unsafe {
        let (zero, infinity) = (L::splat(0.0), L::splat(f32::INFINITY));
        let mut nonzero = L::lt(zero, zero);
        let mut valid = L::and(L::le(zero, tmin), L::lt(tmin, tmax));
        for axis in 0..3 {
            let d = L::abs(direction[axis]);
            nonzero = L::or(nonzero, L::lt(zero, d));
            valid = L::and(valid, L::lt(d, infinity));
            valid = L::and(valid, L::lt(L::abs(origin[axis]), infinity));
        }
        L::and(valid, nonzero)
    }
}

/// 1/d, and where that is finite; where not, what [`SlabBox::interval`](super::slab::SlabBox) takes
/// for it.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn inverse<L: Lanes>(d: L::F, precision: Precision) -> (L::F, L::M) {
    // SAFETY: as promised.
    unsafe {
        let inverse = L::div(L::splat(1.0), d);
        let finite = L::lt(L::abs(inverse), L::splat(f32::INFINITY));
        let mut otherwise = L::splat(f32::NAN);
        if precision != Precision::Fast {
            let zero = L::eq(d, L::splat(0.0));
            otherwise = L::select(zero, otherwise, L::splat(CREEPING));
        }
        (L::select(finite, inverse, otherwise), finite)
    }
}

/// The number that lanes have in common, given the least and the greatest of each.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn one<L: Lanes>(least: L::F, greatest: L::F) -> Option<f32> {
    // SAFETY: as promised.
    unsafe {
        let greatest = -least_of::<L>(L::sub(L::splat(0.0), greatest));
        Some(least_of::<L>(least)).filter(|&least| least == greatest)
    }
}

/// Rays that end, but so far away that a slab distance before the end may overflow.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn ends_far<L: Lanes>(tmax: L::F) -> L::M {
    // SAFETY: as promised.
    unsafe {
        let far = L::lt(L::splat(f32::MAX / 2.0), tmax);
        L::and(far, L::lt(tmax, L::splat(f32::INFINITY)))
    }
}

/// How many rays ahead the next are brought near: passes over all of a batch are bound by memory, which
/// some processors fetch too late themselves.
const RAYS_AHEAD: usize = 256;

/// Up to `L::N` floats from place `at` of a slice, zeros behind its end.
///
/// # Safety
/// The processor has `L`'s instruction set; `at` is within the slice.
#[inline(always)]
pub(super) unsafe fn load<L: Lanes>(from: &[f32], at: usize) -> L::F {
    // SAFETY: the whole vector is within the slice, or a copy of its end is read; the address of a
    // prefetch may be any.
    unsafe {
        L::prefetch(from.as_ptr().wrapping_add(at + RAYS_AHEAD));
        if at + L::N <= from.len() {
            L::load(from.as_ptr().add(at))
        } else {
            let mut end = [0f32; crate::simd::MAX_LANES];
            end[..from.len() - at].copy_from_slice(&from[at..]);
            L::load(end.as_ptr())
        }
    }
}

/// As [`load`], from three slices.
///
/// # Safety
/// As for [`load`].
#[inline(always)]
pub(super) unsafe fn load3<L: Lanes>(from: &[Vec<f32>; 3], at: usize) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            load::<L>(&from[0], at),
            load::<L>(&from[1], at),
            load::<L>(&from[2], at),
        ]
    }
}

/// The origin that all valid rays share to the bit; see [`Batch::shared_origin`].
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn shared_origin<L: Lanes>(batch: &Batch) -> Option<Vec3> {
    let first = batch.iter().find(|ray| ray.is_valid())?.origin;
    // SAFETY: as promised; whole vectors of bits are compared where the batch has them.
    unsafe {
        let bits = [
            L::splat_u(first.x.to_bits()),
            L::splat_u(first.y.to_bits()),
            L::splat_u(first.z.to_bits()),
        ];
        for at in (0..batch.len()).step_by(L::N) {
            let origin = load3::<L>(&batch.origin, at);
            let mut same = L::first(batch.len() - at);
            let all = same;
            for axis in 0..3 {
                let mut lanes = [0f32; crate::simd::MAX_LANES];
                L::store(lanes.as_mut_ptr(), origin[axis]);
                same = L::and(same, L::eq_u(L::load_u(lanes.as_ptr().cast()), bits[axis]));
            }
            if L::bits(same) != L::bits(all) {
                let direction = load3::<L>(&batch.direction, at);
                let valid = valid::<L>(
                    &origin,
                    &direction,
                    load::<L>(&batch.tmin, at),
                    load::<L>(&batch.tmax, at),
                );
                if L::bits(L::and(valid, L::and_not(all, same))) != 0 {
                    return None;
                }
            }
        }
    }
    Some(first)
}

/// Writes the root list of all valid rays, and for each ray the best hit so far: its tmax. Invalid
/// rays get into no list; their best hit is at infinity.
///
/// # Safety
/// The processor has `L`'s instruction set; `rays` has room for the batch and a whole vector.
#[inline(always)]
pub(crate) unsafe fn prepare_rays<L: Lanes>(batch: &Batch, rays: &Rays) -> PreparedRays {
    let shared = rays.shared_origin.is_some();
    let s = &rays.active;
    // SAFETY: list places never pass ray places, and the streams have room behind the last ray; t
    // is written for the rays that there are.
    unsafe {
        let infinity = L::splat(f32::INFINITY);
        let mut least_tmin = infinity;
        let mut special = L::first(0);
        let (mut first_tmax, mut last_tmax) = (infinity, L::splat(0.0));
        let mut n = 0;
        for at in (0..batch.len()).step_by(L::N) {
            let left = batch.len() - at;
            let origin = load3::<L>(&batch.origin, at);
            let direction = load3::<L>(&batch.direction, at);
            let (tmin, tmax) = (load::<L>(&batch.tmin, at), load::<L>(&batch.tmax, at));
            let valid = L::and(valid::<L>(&origin, &direction, tmin, tmax), L::first(left));
            least_tmin = L::select(valid, L::min(tmin, least_tmin), least_tmin);
            for axis in 0..3 {
                let (inverse, finite) = inverse::<L>(direction[axis], rays.precision);
                special = L::or(special, L::and_not(valid, finite));
                L::store(s.inverse[axis].add(n), L::compress(valid, inverse));
                if !shared {
                    L::store(s.origin[axis].add(n), L::compress(valid, origin[axis]));
                }
            }
            special = L::or(special, L::and(valid, ends_far::<L>(tmax)));
            first_tmax = L::select(valid, L::min(tmax, first_tmax), first_tmax);
            last_tmax = L::select(valid, L::max(tmax, last_tmax), last_tmax);
            // Lanes behind the batch name a ray too: compressing may leave any lane behind the list.
            let id = L::select_u(
                L::first(left),
                L::count_from(at as u32),
                L::splat_u(at as u32),
            );
            L::store_u(s.id.add(n), L::compress_u(valid, id));
            // An invalid ray's tmax may be the very mark of an occluded ray.
            let best = L::select(valid, tmax, infinity);
            L::store_first(rays.t.add(at), best, left.min(L::N));
            for i in at..batch.len().min(at + L::N) {
                let d = &batch.direction;
                *rays.directions.add(i) = [d[0][i], d[1][i], d[2][i], batch.tmin[i]];
            }
            n += L::bits(valid).count_ones() as usize;
        }
        PreparedRays {
            valid: n,
            special: L::bits(special) != 0,
            least_tmin: least_of::<L>(least_tmin),
            one_tmax: one::<L>(first_tmax, last_tmax),
        }
    }
}

/// The corners of a triangle; their fourth lanes are some other number of it.
#[inline(always)]
fn corners(triangle: &Triangle) -> [Vec4; 3] {
    // SAFETY: a triangle is nine floats in a row.
    let floats: &[f32; 9] = unsafe { &*std::ptr::from_ref(triangle).cast() };
    let four = |from| Vec4::from_slice(&floats[from..]);
    // Not copied number by number, which would have to reach the cache before it is a vector.
    [four(0), four(3), four(5).yzwx()]
}

/// The lanes of a mask that are coordinates.
const XYZ: u32 = 0b111;

/// See [`Triangle::is_valid`].
#[inline(always)]
fn are_valid([a, b, c]: [Vec4; 3]) -> bool {
    let limit = Vec4::splat(COORDINATE_LIMIT);
    let valid = a.abs().cmplt(limit) & b.abs().cmplt(limit) & c.abs().cmplt(limit);
    valid.bitmask() & XYZ == XYZ
}

/// How many triangles ahead the next are brought near.
const AHEAD: usize = 28;

/// Whether float32 is certain that a valid triangle has an area.
///
/// With u = 2⁻²⁴, each product of two rounded edges is within 3 u of the exact one, and their difference
/// is rounded once more: less than 5 u (|p| + |q|), and what underflow loses.
#[inline(always)]
fn surely_have_area([a, b, c]: [Vec4; 3]) -> bool {
    const BOUND: f32 = 8.0 / (1 << 24) as f32;
    let (ab, ac) = (b - a, c - a);
    let (p, q) = (ab.yzxw() * ac.zxyw(), ab.zxyw() * ac.yzxw());
    let error = (p.abs() + q.abs()) * BOUND + Vec4::splat(f32::MIN_POSITIVE);
    (p - q).abs().cmpgt(error).bitmask() & XYZ != 0
}

/// Writes the items of triangles that can be hit (valid and with an area), in file order, and the box
/// around them; returns how many there are. It looks at as many triangles from `from` on as there is room
/// for.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn prepare_triangles<L: Lanes>(
    mesh: &Mesh,
    from: usize,
    items: &mut [Item],
) -> (usize, BinBox) {
    let mut bounds = [Vec4::INFINITY; 2];
    let mut n = 0;
    let triangles = mesh.triangles()[from..].iter().take(items.len());
    for (prim, triangle) in (from as u32..).zip(triangles) {
        // SAFETY: as promised; the address of a prefetch may be any.
        unsafe { L::prefetch(std::ptr::from_ref(triangle).wrapping_add(AHEAD).cast()) };
        let corners = corners(triangle);
        if are_valid(corners) && (surely_have_area(corners) || has_area(triangle)) {
            let [lower, upper] = Item::halves(corners, prim);
            bounds = [lower.min(bounds[0]), upper.min(bounds[1])];
            items[n] = Item::of_halves([lower, upper]);
            n += 1;
        }
    }
    (n, BinBox::of_halves(bounds))
}

#[cfg(test)]
mod tests;
