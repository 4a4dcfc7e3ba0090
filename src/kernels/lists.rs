//! Triangles in four lists (Mora 2011, section 3.5 and Fig. 4): the least and the greatest coordinate
//! of each axis in a list of its own, so that a triangle is held against a split plane by loading
//! eight bytes; what is between them, and which corner has which, in the fourth.

use super::naive::TriangleList;
use super::partition::{Test, partition};
use super::prepare::has_area;
use super::records::least_of;
use super::triangle::{Chunk, Corners, sub3};
use crate::geometry::{Aabb, COORDINATE_LIMIT, Mesh, Triangle};
use crate::simd::{Lanes, MAX_LANES};
use glam::Vec3;

/// The lists, by `prim`, and the index list. 44 bytes a triangle in all.
#[derive(Clone, Copy)]
pub(crate) struct TriangleLists {
    /// (least, greatest) coordinate on each axis.
    pub spans: [*mut [f32; 2]; 3],
    /// The coordinate between, on each axis, and as the bits of the fourth number: bit `6 axis + c`
    /// says that corner `c` has the least, bit `6 axis + 3 + c` that it has the greatest coordinate,
    /// [`MET`] that the triangle has been in a naive step.
    pub rest: *mut [f32; 4],
    /// Indices: triangles of the subproblem come first.
    pub ids: *mut u32,
}

/// Set once a triangle has been in a naive step.
const MET: u32 = 1 << 31;

/// What the pass over the mesh found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedLists {
    /// Triangles that can be hit: valid ones that have an area.
    pub len: usize,
    /// The box around them.
    pub bounds: Aabb,
}

/// Sorts the coordinates of all triangles into the lists, and enters those that can be hit into the
/// index list, in file order.
///
/// # Safety
/// The processor has `L`'s instruction set; the lists have room for the mesh, the index list for a
/// vector behind it.
#[inline(always)]
pub(crate) unsafe fn prepare_lists<L: Lanes>(mesh: &Mesh, lists: &TriangleLists) -> PreparedLists {
    let triangles = mesh.triangles();
    let mut len = 0;
    // SAFETY: as promised; the last triangles are read from a copy, and stored one by one.
    unsafe {
        let mut least = [L::splat(f32::INFINITY); 3];
        // Negated.
        let mut greatest = least;
        for at in (0..triangles.len()).step_by(L::N) {
            let left = triangles.len() - at;
            let mut last = [Triangle::new(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO); MAX_LANES];
            let from = if left >= L::N {
                triangles.as_ptr().add(at)
            } else {
                last[..left].copy_from_slice(&triangles[at..]);
                last.as_ptr()
            };
            let corners = load_corners::<L>(from);
            let mut code = L::splat_u(0);
            let mut middle = [L::splat(0.0); 3];
            let (mut lo, mut hi) = (middle, middle);
            for axis in 0..3 {
                let [a, b, c] = [corners[0][axis], corners[1][axis], corners[2][axis]];
                let sorted = in_order::<L>(a, b, c);
                (lo[axis], middle[axis], hi[axis]) = (sorted.least, sorted.middle, sorted.greatest);
                for (bit, whose) in sorted.whose.into_iter().enumerate() {
                    let bit = L::splat_u(1 << (6 * axis + bit));
                    code = L::or_u(code, L::select_u(whose, bit, L::splat_u(0)));
                }
            }
            let rest = [middle[0], middle[1], middle[2], L::from_bits(code)];
            if left >= L::N {
                for axis in 0..3 {
                    L::store2(lists.spans[axis].add(at), [lo[axis], hi[axis]]);
                }
                L::store4(lists.rest.add(at), rest);
            } else {
                let mut records = [[0f32; 4]; MAX_LANES];
                L::store4(records.as_mut_ptr(), rest);
                std::ptr::copy_nonoverlapping(records.as_ptr(), lists.rest.add(at), left);
                for axis in 0..3 {
                    let mut spans = [[0f32; 2]; MAX_LANES];
                    L::store2(spans.as_mut_ptr(), [lo[axis], hi[axis]]);
                    std::ptr::copy_nonoverlapping(spans.as_ptr(), lists.spans[axis].add(at), left);
                }
            }
            let hittable = L::and(hittable::<L>(from, &corners), L::first(left));
            for axis in 0..3 {
                let upper = L::sub(L::splat(0.0), hi[axis]);
                least[axis] = L::select(hittable, L::min(lo[axis], least[axis]), least[axis]);
                greatest[axis] = L::select(hittable, L::min(upper, greatest[axis]), greatest[axis]);
            }
            // Lanes behind the mesh name a triangle, too: compressing may leave any behind the list.
            let id = L::select_u(
                L::first(left),
                L::count_from(at as u32),
                L::splat_u(at as u32),
            );
            L::store_u(lists.ids.add(len), L::compress_u(hittable, id));
            len += L::bits(hittable).count_ones() as usize;
        }
        PreparedLists {
            len,
            bounds: Aabb {
                min: Vec3::from_array(least3::<L>(&least)),
                max: -Vec3::from_array(least3::<L>(&greatest)),
            },
        }
    }
}

/// Corners of `L::N` triangles in a row.
///
/// # Safety
/// The processor has `L`'s instruction set; there are so many.
#[inline(always)]
unsafe fn load_corners<L: Lanes>(from: *const Triangle) -> [[L::F; 3]; 3] {
    const FLOATS: usize = size_of::<Triangle>() / size_of::<f32>();
    const PLACES: [u32; MAX_LANES] = {
        let mut places = [0; MAX_LANES];
        let mut lane = 0;
        while lane < MAX_LANES {
            places[lane] = (FLOATS * lane) as u32;
            lane += 1;
        }
        places
    };
    // SAFETY: as promised.
    unsafe {
        let mut corners = [[L::splat(0.0); 3]; 3];
        let places = L::load_u(PLACES.as_ptr());
        for (corner, v) in corners.iter_mut().enumerate() {
            for (axis, v) in v.iter_mut().enumerate() {
                let base = from.cast::<f32>().add(3 * corner + axis);
                *v = L::gather(base, places, L::first(L::N));
            }
        }
        corners
    }
}

/// Three coordinates in order; the first three of `whose` say which of them is the least, the others
/// which is the greatest. Never the same one, and one of each.
struct InOrder<L: Lanes> {
    least: L::F,
    middle: L::F,
    greatest: L::F,
    whose: [L::M; 6],
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn in_order<L: Lanes>(a: L::F, b: L::F, c: L::F) -> InOrder<L> {
    // SAFETY: as promised.
    unsafe {
        // Of equal ones the first is the least and the last the greatest.
        let all = L::first(L::N);
        let (ba, cb, ca) = (L::lt(b, a), L::lt(c, b), L::lt(c, a));
        let least_a = L::and_not(L::and_not(all, ba), ca);
        let least_b = L::and_not(ba, cb);
        let least_c = L::and_not(L::and_not(all, least_a), least_b);
        let greatest_c = L::and_not(L::and_not(all, cb), ca);
        let greatest_b = L::and_not(cb, ba);
        let greatest_a = L::and_not(L::and_not(all, greatest_c), greatest_b);
        let least = L::select(least_a, a, L::select(least_b, b, c));
        let greatest = L::select(greatest_c, c, L::select(greatest_b, b, a));
        let taken_a = L::or(least_a, greatest_a);
        let taken_b = L::or(least_b, greatest_b);
        InOrder {
            least,
            middle: L::select(taken_a, L::select(taken_b, c, b), a),
            greatest,
            whose: [
                least_a, least_b, least_c, greatest_a, greatest_b, greatest_c,
            ],
        }
    }
}

/// Lanes of triangles that can be hit: valid ones whose cross product, in float64, is not zero.
///
/// # Safety
/// The processor has `L`'s instruction set; `L::N` triangles at `from`, `corners` are theirs.
#[inline(always)]
unsafe fn hittable<L: Lanes>(from: *const Triangle, corners: &[[L::F; 3]; 3]) -> L::M {
    // SAFETY: as promised.
    unsafe {
        let limit = L::splat(COORDINATE_LIMIT);
        let mut valid = L::first(L::N);
        for v in corners.iter().flatten() {
            valid = L::and(valid, L::lt(L::abs(*v), limit));
        }
        // In float32, a component that is larger than all roundings together cannot be zero.
        let (e, f) = (
            sub3::<L>(&corners[1], &corners[0]),
            sub3::<L>(&corners[2], &corners[0]),
        );
        let mut clear = L::first(0);
        for axis in 0..3 {
            let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
            let (p, q) = (L::mul(e[y], f[z]), L::mul(e[z], f[y]));
            let roundings = L::mul(
                L::add(L::abs(p), L::abs(q)),
                L::splat(8.0 / (1 << 24) as f32),
            );
            clear = L::or(clear, L::lt(roundings, L::abs(L::sub(p, q))));
        }
        let mut unclear = L::bits(L::and_not(valid, clear));
        let mut flat = [0u32; MAX_LANES];
        while unclear != 0 {
            let lane = unclear.trailing_zeros() as usize;
            unclear &= unclear - 1;
            flat[lane] = !has_area(&*from.add(lane)) as u32;
        }
        let flat = L::eq_u(L::load_u(flat.as_ptr()), L::splat_u(1));
        L::and_not(valid, flat)
    }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn least3<L: Lanes>(v: &[L::F; 3]) -> [f32; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            least_of::<L>(v[0]),
            least_of::<L>(v[1]),
            least_of::<L>(v[2]),
        ]
    }
}

/// The corners of the triangles at `ids`, put together again, and the bits of the fourth list.
///
/// # Safety
/// The processor has `L`'s instruction set; `L::N` indices of triangles at `ids`.
#[inline(always)]
pub(super) unsafe fn corners<L: Lanes>(
    lists: &TriangleLists,
    ids: *const u32,
) -> (Corners<L>, L::U) {
    // SAFETY: as promised.
    unsafe {
        let [x, y, z, code] = L::gather4::<1>(lists.rest, ids);
        let (middle, code) = ([x, y, z], L::to_bits(code));
        let zero = [L::splat(0.0); 3];
        let (mut a, mut b, mut c, mut lo, mut hi) = (zero, zero, zero, zero, zero);
        for axis in 0..3 {
            let [least, greatest] = L::gather2(lists.spans[axis], ids);
            (lo[axis], hi[axis]) = (least, greatest);
            for (corner, to) in [&mut a, &mut b, &mut c].into_iter().enumerate() {
                let has = |which: usize| L::splat_u(1 << (6 * axis + 3 * which + corner));
                let x = L::select(L::common_bits(code, has(1)), greatest, middle[axis]);
                to[axis] = L::select(L::common_bits(code, has(0)), least, x);
            }
        }
        (Corners { a, b, c, lo, hi }, code)
    }
}

/// One side of a plane across an axis, the plane included.
#[derive(Clone, Copy)]
pub(crate) struct Side {
    pub axis: usize,
    pub plane: f32,
    /// Whether it is the side of the greater coordinates.
    pub upper: bool,
}

impl Side {
    pub fn opposite(self) -> Side {
        Side {
            upper: !self.upper,
            ..self
        }
    }
}

/// Triangles that reach to a side of the split plane: all that is left of the box test for triangles
/// that reach into the cell that is split.
struct Reaches<L: Lanes> {
    spans: *const [f32; 2],
    plane: L::F,
    upper: bool,
}

impl<L: Lanes> Test<L> for Reaches<L> {
    #[inline(always)]
    unsafe fn pass(&mut self, ids: *const u32, active: L::M) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let [least, greatest] = L::gather2(self.spans, ids);
            let reaches = match self.upper {
                true => L::le(self.plane, greatest),
                false => L::le(least, self.plane),
            };
            L::and(reaches, active)
        }
    }

    #[inline(always)]
    unsafe fn prefetch(&self, ids: *const u32) {
        for lane in 0..MAX_LANES {
            // SAFETY: as promised.
            unsafe { L::prefetch(self.spans.wrapping_add(*ids.add(lane) as usize).cast()) }
        }
    }
}

/// Moves the triangles that reach to a side to the front of the index list; returns how many do.
///
/// # Safety
/// The processor has `L`'s instruction set; `len` indices.
#[inline(always)]
pub(crate) unsafe fn keep_side<L: Lanes>(lists: &TriangleLists, len: usize, side: Side) -> usize {
    // SAFETY: as promised.
    unsafe {
        let mut test = Reaches::<L> {
            spans: lists.spans[side.axis],
            plane: L::splat(side.plane),
            upper: side.upper,
        };
        partition::<L, _>(lists.ids, len, &mut test)
    }
}

/// The first `len` triangles of the index list.
pub(crate) struct Listed<'a> {
    pub lists: &'a TriangleLists,
    pub len: usize,
    /// How many of them had been in a naive step before.
    pub duplicates: &'a mut u64,
}

impl<L: Lanes> TriangleList<L> for Listed<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    unsafe fn prepare(&mut self, from: usize, chunk: &mut Chunk, shared_origin: Option<Vec3>) {
        let len = (self.len - from).min(MAX_LANES);
        for at in (0..len).step_by(L::N) {
            // SAFETY: as promised; behind the index list there are valid indices, too.
            unsafe {
                let ids = self.lists.ids.add(from + at);
                let (corners, code) = corners::<L>(self.lists, ids);
                chunk.prepare::<L>(at, &corners, shared_origin);
                L::store_u(chunk.prim.as_mut_ptr().add(at), L::load_u(ids));
                let met = L::common_bits(code, L::splat_u(MET));
                let active = L::first(len - at);
                *self.duplicates += L::bits(L::and(met, active)).count_ones() as u64;
                let mut new = L::bits(L::and_not(active, met));
                while new != 0 {
                    let lane = new.trailing_zeros() as usize;
                    new &= new - 1;
                    let code = &mut (*self.lists.rest.add(*ids.add(lane) as usize))[3];
                    *code = f32::from_bits(code.to_bits() | MET);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
