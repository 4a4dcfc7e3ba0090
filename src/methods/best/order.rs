//! The order in which rays are traced: neighbours in an incoherent batch go different ways, so they are
//! sorted by octant of the direction and then by where they start.

use super::memory::BUCKETS;
use crate::geometry::Aabb;
use crate::kernels::GROUP;
use crate::rays::Batch;
use std::ops::Range;

/// Groups that tell whether a batch is coherent.
const SAMPLE: usize = 64;
/// Of how many rays of a group the octant must be that of the first for the batch to be coherent.
const COHERENT: f32 = 0.75;
/// Cells of an axis.
const CELLS: f32 = 16.0;

/// Whether neighbours go different ways.
pub(super) fn is_incoherent(batch: &Batch) -> bool {
    let groups = batch.len() / GROUP;
    let samples = groups.min(SAMPLE);
    let mut same = 0;
    for sample in 0..samples {
        let from = (sample * groups / samples) * GROUP;
        let first = octant(batch, from);
        same += (from..from + GROUP)
            .filter(|&ray| octant(batch, ray) == first)
            .count();
    }
    (same as f32) < COHERENT * (samples * GROUP) as f32
}

#[inline(always)]
fn octant(batch: &Batch, ray: usize) -> u32 {
    let sign = |axis: usize| batch.direction[axis][ray].to_bits() >> 31;
    sign(0) | sign(1) << 1 | sign(2) << 2
}

/// Rays `range` of the batch, sorted: by octant, then by origin along a Morton curve through the box of the
/// scene (by direction if the origin is shared). `order`, `keys` are those of the range.
pub(super) fn sort(
    batch: &Batch,
    range: Range<usize>,
    shared: bool,
    scene: &Aabb,
    order: &mut [u32],
    keys: &mut [u16],
    buckets: &mut [u32],
) {
    buckets.fill(0);
    let extent = scene.extent();
    for (key, ray) in keys.iter_mut().zip(range.clone()) {
        let mut cell = [0.0; 3];
        if shared {
            let d = [0, 1, 2].map(|axis| batch.direction[axis][ray].abs());
            let scale = (CELLS - 1.0) / d[0].max(d[1]).max(d[2]);
            cell = d.map(|d| d * scale);
        } else {
            for axis in 0..3 {
                let scale = CELLS / extent[axis];
                cell[axis] = (batch.origin[axis][ray] - scene.min[axis]) * scale;
            }
        }
        // NaN is in the first cell.
        let cell = cell.map(|x| x.clamp(0.0, CELLS - 1.0) as usize);
        let place = SPREAD[cell[0]] | SPREAD[cell[1]] << 1 | SPREAD[cell[2]] << 2;
        *key = (octant(batch, ray) << 12) as u16 | place;
        buckets[*key as usize] += 1;
    }
    let mut sum = 0;
    for bucket in buckets.iter_mut() {
        sum += std::mem::replace(bucket, sum);
    }
    for (&key, ray) in keys.iter().zip(range) {
        let place = &mut buckets[key as usize];
        order[*place as usize] = ray as u32;
        *place += 1;
    }
}

/// The four bits of a number, two places apart.
const SPREAD: [u16; 16] = {
    let mut spread = [0; 16];
    let mut i = 0;
    while i < 16 {
        spread[i] = (i & 1 | (i & 2) << 2 | (i & 4) << 4 | (i & 8) << 6) as u16;
        i += 1;
    }
    spread
};

const _: () = assert!(BUCKETS == 8 * (CELLS * CELLS * CELLS) as usize);
