//! Triangles in four lists (Mora 2011, section 3.5 and Fig. 4): the least and the greatest coordinate
//! of each axis in a list of its own, so that a triangle is held against a split plane by loading
//! eight bytes; what is between them, and which corner has which, in the fourth.

use super::naive::{Record, TriangleList};
use super::partition::{Test, partition};
use super::triangle::{Corners, Prepared};
use crate::exact::has_area;
use crate::geometry::{Aabb, Mesh, Triangle};
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

impl TriangleLists {
    /// Whether two triangles have the same corners in the same order.
    ///
    /// # Safety
    /// They are triangles of the mesh.
    #[inline(always)]
    pub(super) unsafe fn same(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        // SAFETY: as promised.
        unsafe {
            let [x, y, z] = self.spans;
            let spans = *x.add(a) == *x.add(b) && *y.add(a) == *y.add(b) && *z.add(a) == *z.add(b);
            spans && {
                let ([rest_a @ .., code_a], [rest_b @ .., code_b]) =
                    (*self.rest.add(a), *self.rest.add(b));
                rest_a == rest_b && (code_a.to_bits() ^ code_b.to_bits()) & !MET == 0
            }
        }
    }
}

/// What the pass over the mesh found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedLists {
    /// Triangles that can be hit: valid ones that have an area.
    pub len: usize,
    /// The box around them.
    pub bounds: Aabb,
}

/// Three coordinates in order, and the bits that say whose they are.
#[inline(always)]
fn in_order(x: [f32; 3]) -> ([f32; 3], u32) {
    let mut least = 0;
    let mut greatest = 2;
    for c in 1..3 {
        least = if x[c] < x[least] { c } else { least };
    }
    for c in [1, 0] {
        greatest = if x[c] > x[greatest] { c } else { greatest };
    }
    let middle = 3 - least - greatest;
    let bits = 1 << least | 8 << greatest;
    ([x[least], x[middle], x[greatest]], bits)
}

/// Sorts the coordinates of all triangles into the lists, and enters those that can be hit into the
/// index list, in file order.
///
/// # Safety
/// The lists have room for the mesh.
#[inline(always)]
pub(crate) unsafe fn prepare_lists(mesh: &Mesh, lists: &TriangleLists) -> PreparedLists {
    let mut bounds = Aabb::EMPTY;
    let mut len = 0;
    for (prim, t) in mesh.triangles().iter().enumerate() {
        let mut rest = [0.0; 4];
        let mut code = 0;
        let (mut lo, mut hi) = (Vec3::ZERO, Vec3::ZERO);
        for axis in 0..3 {
            let ([least, middle, greatest], bits) = in_order([t.a[axis], t.b[axis], t.c[axis]]);
            (lo[axis], hi[axis]) = (least, greatest);
            rest[axis] = middle;
            code |= bits << (6 * axis);
            // SAFETY: there is room for the mesh; so below.
            unsafe { *lists.spans[axis].add(prim) = [least, greatest] };
        }
        rest[3] = f32::from_bits(code);
        // SAFETY: as above.
        unsafe { *lists.rest.add(prim) = rest };
        if t.is_valid() && has_area(t) {
            bounds = bounds.union(Aabb { min: lo, max: hi });
            // SAFETY: no more indices than triangles.
            unsafe { *lists.ids.add(len) = prim as u32 };
            len += 1;
        }
    }
    PreparedLists { len, bounds }
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
    pub triangles: &'a [Triangle],
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
    fn triangle(&self, prim: u32) -> &Triangle {
        &self.triangles[prim as usize]
    }

    #[inline(always)]
    unsafe fn prepare<R: Record<L>>(
        &mut self,
        from: usize,
        to: &mut [Prepared],
        shared_origin: Option<Vec3>,
    ) {
        let len = (self.len - from).min(MAX_LANES);
        for at in (0..len).step_by(L::N) {
            // SAFETY: as promised; behind the index list there are valid indices, too.
            unsafe {
                let ids = self.lists.ids.add(from + at);
                let (corners, code) = corners::<L>(self.lists, ids);
                Prepared::prepare::<L, R>(&mut to[at..], &corners, L::load_u(ids), shared_origin);
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
