//! Rays put in order: by octant of the direction, then by where they start, along a Morton curve.
//!
//! In one pass over a window of the batch each ray becomes a record of 32 bytes at its place. To gather
//! the eight numbers of a ray from the streams of the batch by an index would touch eight cache lines a ray
//! in place of one.

use super::block::{self, Source};
use crate::geometry::Aabb;
use crate::rays::Batch;
use crate::simd::{Lanes, MAX_LANES};
use std::ops::Range;

/// Origin and tmin, direction and tmax.
pub(crate) type SortedRay = [[f32; 4]; 2];

/// Cells of an axis.
const CELLS: usize = 16;
/// Places of the order: eight octants of 16³ cells.
pub(crate) const BUCKETS: usize = 8 * CELLS * CELLS * CELLS;

/// Room for a window of the batch, in order.
pub(crate) struct Window<'a> {
    pub records: &'a mut [SortedRay],
    /// Where each record's ray stands in the batch.
    pub places: &'a mut [u32],
    pub keys: &'a mut [u16],
    /// [`BUCKETS`] of them.
    pub buckets: &'a mut [u32],
}

/// Puts rays `range` of the batch in order: by octant, then by origin within the scene (by direction if
/// the origin is shared). Those of one cell keep their order.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn put_in_order<L: Lanes>(
    batch: &Batch,
    range: Range<usize>,
    shared: bool,
    scene: &Aabb,
    to: Window,
) {
    let Window {
        records,
        places,
        keys,
        buckets,
    } = to;
    let keys = &mut keys[..range.len()];
    buckets.fill(0);
    // SAFETY: as promised.
    unsafe {
        for (keys, at) in keys.chunks_mut(L::N).zip(range.clone().step_by(L::N)) {
            let rays = block::load::<L>(&Source::Batch(batch), at, range.end - at);
            let cells = match shared {
                true => cells_of_directions::<L>(&rays.direction),
                false => cells_of_origins::<L>(&rays.origin, scene),
            };
            let mut cell = [[0f32; MAX_LANES]; 3];
            let mut negative = [0; 3];
            for axis in 0..3 {
                L::store(cell[axis].as_mut_ptr(), cells[axis]);
                negative[axis] = L::bits(L::lt(rays.direction[axis], L::splat(0.0)));
            }
            for (lane, key) in keys.iter_mut().enumerate() {
                let mut code = 0;
                for axis in 0..3 {
                    let at = cell[axis][lane].to_bits() as usize % CELLS;
                    let sign = (negative[axis] >> lane & 1) as u16;
                    code |= SPREAD[at] << axis | sign << (12 + axis);
                }
                *key = code;
                buckets[code as usize] += 1;
            }
        }
        let mut sum = 0;
        for bucket in buckets.iter_mut() {
            sum += std::mem::replace(bucket, sum);
        }
        for (keys, at) in keys.chunks(L::N).zip(range.clone().step_by(L::N)) {
            let rays = block::load::<L>(&Source::Batch(batch), at, range.end - at);
            let mut rows = [[[0f32; 4]; MAX_LANES]; 2];
            let ([ox, oy, oz], [dx, dy, dz]) = (rays.origin, rays.direction);
            L::store4(rows[0].as_mut_ptr(), [ox, oy, oz, rays.tmin]);
            L::store4(rows[1].as_mut_ptr(), [dx, dy, dz, rays.tmax]);
            for (lane, &key) in keys.iter().enumerate() {
                let place = &mut buckets[key as usize];
                records[*place as usize] = [rows[0][lane], rows[1][lane]];
                places[*place as usize] = (at + lane) as u32;
                *place += 1;
            }
        }
    }
}

/// Added to a number from 0 to 2²² it leaves the nearest whole number in the lower bits.
const WHOLE: f32 = (1 << 23) as f32;

/// The cell of each origin in the box of the scene, in the lower bits; 0 for NaN.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn cells_of_origins<L: Lanes>(origin: &[L::F; 3], scene: &Aabb) -> [L::F; 3] {
    let most = (CELLS - 1) as f32;
    let mut cells = *origin;
    for axis in 0..3 {
        let scale = most / (scene.max[axis] - scene.min[axis]);
        // SAFETY: as promised.
        unsafe {
            let x = L::sub(origin[axis], L::splat(scene.min[axis]));
            let x = L::max(L::mul(x, L::splat(scale)), L::splat(0.0));
            cells[axis] = L::add(L::min(x, L::splat(most)), L::splat(WHOLE));
        }
    }
    cells
}

/// Likewise for directions, by their sizes beside the largest component.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn cells_of_directions<L: Lanes>(direction: &[L::F; 3]) -> [L::F; 3] {
    let mut cells = *direction;
    // SAFETY: as promised.
    unsafe {
        let most = L::splat((CELLS - 1) as f32);
        let [x, y, z] = [
            L::abs(direction[0]),
            L::abs(direction[1]),
            L::abs(direction[2]),
        ];
        let scale = L::div(most, L::max(L::max(x, y), z));
        for (cell, d) in cells.iter_mut().zip([x, y, z]) {
            let x = L::max(L::mul(d, scale), L::splat(0.0));
            *cell = L::add(L::min(x, most), L::splat(WHOLE));
        }
    }
    cells
}

/// The four bits of a number, two places apart.
const SPREAD: [u16; CELLS] = {
    let mut spread = [0; CELLS];
    let mut i = 0;
    while i < CELLS as u16 {
        spread[i as usize] = i & 1 | (i & 2) << 2 | (i & 4) << 4 | (i & 8) << 6;
        i += 1;
    }
    spread
};

#[cfg(test)]
mod tests;
