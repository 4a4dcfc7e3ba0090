//! Whether rays are to be put in order: neighbours in an incoherent batch go different ways.

use crate::kernels::GROUP;
use crate::rays::Batch;

/// Groups that tell whether a batch is coherent.
const SAMPLE: usize = 64;
/// Of how many rays of a group the octant must be that of the first for the batch to be coherent.
const COHERENT: f32 = 0.75;

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
