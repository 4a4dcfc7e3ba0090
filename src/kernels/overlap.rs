//! Whether a triangle reaches into a cell, by separating axes (Akenine-Möller 2001, as Mora 2011,
//! section 3.5, takes it): the split plane, the nine cross products of edges, the triangle's plane.
//!
//! The split plane needs no margin: t of a hit lies in the slab interval of its triangle's box, and
//! slab intervals are monotone in their planes, so a ray that is on a side of the plane at t finds
//! the triangle there. The other axes hold the triangle itself against the cell, and a hit need not
//! lie on it: t is rounded. [`MARGIN`] covers that for rays whose angle to the triangle's normal has a
//! cosine of at least 2⁻¹⁰; for more grazing rays there is no bound.
//!
//! In precision `exact` a hit lies on the triangle, whatever the angle. What remains is the rounding of
//! these axes themselves: with a corner p relative to the cell's centre and an edge e, five roundings
//! of products |p| |e|, which [`ROUNDING`] |p| on each side of the cell covers; and of the plane's,
//! nine of |e| |f| (|p| + half the cell).

use super::lists::{Side, TriangleLists, corners};
use super::partition::{Test, partition};
use super::triangle::{Corners, cross3, dot, sub3};
use crate::geometry::Aabb;
use crate::simd::{Lanes, splat3};

/// How far from its triangle a hit may be, over the sum of the distances from the ray's origin to the
/// triangle's corner and to the hit: eight roundings of 2⁻²⁴ over the least cosine, 2⁻¹⁰.
const MARGIN: f32 = 1.0 / (1 << 11) as f32;

/// Of the axes, over the 1-norm of what is multiplied.
const ROUNDING: f32 = 12.0 / (1 << 24) as f32;

/// More than what underflow may take from the products of an axis.
const UNDERFLOW: f32 = f32::MIN_POSITIVE;

/// What triangles are held against.
#[derive(Clone, Copy)]
pub(crate) struct Overlap {
    pub cell: Aabb,
    /// The side of the split plane that the cell is on.
    pub side: Side,
    /// The box around all origins of rays.
    pub origins: Aabb,
    /// Whether the triangle's plane is an axis, too.
    pub plane: bool,
}

struct Reaches<'a, L: Lanes> {
    lists: &'a TriangleLists,
    by: Overlap,
    center: [L::F; 3],
    half: [L::F; 3],
    origins: [[L::F; 3]; 2],
    /// What the far corner of the cell adds to the margin.
    margin: L::F,
    plane: L::F,
}

impl<L: Lanes> Reaches<'_, L> {
    /// Triangles that none of the axes separates from the cell.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    unsafe fn overlaps(&self, t: &Corners<L>) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let mut far = L::splat(0.0);
            for axis in 0..3 {
                let x = t.a[axis];
                let distance = L::max(
                    L::abs(L::sub(x, self.origins[0][axis])),
                    L::abs(L::sub(x, self.origins[1][axis])),
                );
                far = L::add(far, distance);
            }
            let corners = [
                sub3::<L>(&t.a, &self.center),
                sub3::<L>(&t.b, &self.center),
                sub3::<L>(&t.c, &self.center),
            ];
            let size = L::max(
                sum_of_sizes::<L>(&corners[0]),
                L::max(
                    sum_of_sizes::<L>(&corners[1]),
                    sum_of_sizes::<L>(&corners[2]),
                ),
            );
            let margin = L::mul_add(far, L::splat(MARGIN), self.margin);
            let margin = L::mul_add(size, L::splat(ROUNDING), margin);
            let half = [
                L::add(self.half[0], margin),
                L::add(self.half[1], margin),
                L::add(self.half[2], margin),
            ];
            let edges = [
                sub3::<L>(&t.b, &t.a),
                sub3::<L>(&t.c, &t.b),
                sub3::<L>(&t.a, &t.c),
            ];
            let mut apart = L::first(0);
            for (k, e) in edges.iter().enumerate() {
                // The corners at either end of the edge have the same place on its axes.
                let (from, other) = (&corners[k], &corners[(k + 2) % 3]);
                for axis in 0..3 {
                    let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
                    let p = L::mul_sub(from[y], e[z], L::mul(from[z], e[y]));
                    let q = L::mul_sub(other[y], e[z], L::mul(other[z], e[y]));
                    let r = L::mul_add(half[z], L::abs(e[y]), L::splat(UNDERFLOW));
                    let r = L::mul_add(half[y], L::abs(e[z]), r);
                    let (least, greatest) = (L::min(p, q), L::max(p, q));
                    apart = L::or(apart, L::lt(r, least));
                    apart = L::or(apart, L::lt(greatest, L::sub(L::splat(0.0), r)));
                }
            }
            if self.by.plane {
                let (e, f) = (&edges[0], &edges[2]);
                let n = cross3::<L>(e, f);
                let size = [L::abs(n[0]), L::abs(n[1]), L::abs(n[2])];
                let reach = L::add(sum_of_sizes::<L>(&corners[0]), sum_of_sizes::<L>(&half));
                let rounding = L::mul(
                    L::mul(sum_of_sizes::<L>(e), sum_of_sizes::<L>(f)),
                    L::mul(reach, L::splat(ROUNDING)),
                );
                let rounding = L::add(rounding, L::splat(UNDERFLOW));
                let r = L::add(dot::<L>(&half, &size), rounding);
                apart = L::or(apart, L::lt(r, L::abs(dot::<L>(&n, &corners[0]))));
            }
            // NaN, where numbers overflow, is not apart.
            L::and_not(L::first(L::N), apart)
        }
    }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn sum_of_sizes<L: Lanes>(v: &[L::F; 3]) -> L::F {
    // SAFETY: as promised.
    unsafe { L::add(L::abs(v[0]), L::add(L::abs(v[1]), L::abs(v[2]))) }
}

impl<L: Lanes> Test<L> for Reaches<'_, L> {
    #[inline(always)]
    unsafe fn pass(&mut self, ids: *const u32, active: L::M) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let (corners, _) = corners::<L>(self.lists, ids);
            let Side { axis, upper, .. } = self.by.side;
            let reaches = match upper {
                true => L::le(self.plane, corners.hi[axis]),
                false => L::le(corners.lo[axis], self.plane),
            };
            let reaches = L::and(reaches, active);
            if L::bits(reaches) == 0 {
                return reaches;
            }
            L::and(reaches, self.overlaps(&corners))
        }
    }
}

/// Moves the triangles that reach into a cell to the front of the index list; returns how many do.
///
/// # Safety
/// The processor has `L`'s instruction set; `len` indices.
#[inline(always)]
pub(crate) unsafe fn keep_overlapping<L: Lanes>(
    lists: &TriangleLists,
    len: usize,
    by: Overlap,
) -> usize {
    let (center, half) = (by.cell.center(), 0.5 * by.cell.extent());
    let (o, cell) = (by.origins, by.cell);
    let far = (cell.max - o.min).abs().max((o.max - cell.min).abs());
    // Of the center and of what is taken relative to it.
    let rounding = (cell.min.abs() + cell.max.abs()) * (4.0 / (1 << 24) as f32);
    // SAFETY: as promised.
    unsafe {
        let mut test = Reaches::<L> {
            lists,
            by,
            center: splat3::<L>(&center.to_array()),
            half: splat3::<L>(&half.to_array()),
            origins: [
                splat3::<L>(&o.min.to_array()),
                splat3::<L>(&o.max.to_array()),
            ],
            margin: L::splat(MARGIN * far.element_sum() + rounding.element_sum()),
            plane: L::splat(by.side.plane),
        };
        partition::<L, _>(lists.ids, len, &mut test)
    }
}

#[cfg(test)]
mod tests;
