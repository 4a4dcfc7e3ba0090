//! Ray sampling: intersection ratios and order of the candidate splits from sample rays (Nabata
//! 2013, section 4.1 and Algorithm 2).

use super::slab::SlabBox;
use super::{List, Rays};
use crate::geometry::Aabb;
use crate::random;
use crate::simd::{Lanes, MAX_LANES, load3, splat3};

/// The most sample rays a node may have.
pub(crate) const MAX_SAMPLES: usize = 4096;

/// How sample rays are drawn.
#[derive(Clone, Copy)]
pub(crate) struct Draw {
    pub count: usize,
    pub replacement: bool,
    pub seed: u64,
    /// Key of the node.
    pub node: u64,
}

/// A set of sample rays, gathered from a list.
pub(crate) struct Samples {
    inverse: [[f32; MAX_SAMPLES + MAX_LANES]; 3],
    origin: [[f32; MAX_SAMPLES + MAX_LANES]; 3],
    t: [f32; MAX_SAMPLES + MAX_LANES],
    index: [u32; MAX_SAMPLES + MAX_LANES],
    len: usize,
}

/// Two boxes that a node could be split into.
#[derive(Clone, Copy)]
pub(crate) struct Candidate {
    pub left: Aabb,
    pub right: Aabb,
}

/// What the sample rays say of a candidate; all numbers of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct SampleCounts {
    /// Meet the left box (c_L of Algorithm 2).
    pub left: u32,
    /// Meet the right box (c_R).
    pub right: u32,
    /// Enter the left box strictly first, or it alone (n_L). All others count to the right in the
    /// paper (n_R).
    pub left_first: u32,
    /// Enter the right box strictly first, or it alone.
    pub right_first: u32,
}

impl Samples {
    /// No samples, on the heap: about 115 KiB.
    pub fn boxed() -> Box<Samples> {
        let mut samples = Box::<Samples>::new_uninit();
        // SAFETY: all-zero bytes are valid floats and integers.
        unsafe {
            samples.as_mut_ptr().write_bytes(0, 1);
            samples.assume_init()
        }
    }

    /// Number of sample rays.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Draws `draw.count` rays of a list (fewer if it has fewer): one from each of so many equal parts
    /// of the list, so without replacement, or each from the whole list with replacement.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `rays` keeps its promises; `list` is a list of it.
    #[inline(always)]
    pub unsafe fn draw<L: Lanes>(&mut self, rays: &Rays, list: List, draw: Draw) {
        let count = draw.count.min(list.len).min(MAX_SAMPLES);
        self.len = count;
        for i in 0..count {
            let bits = random::hash(draw.seed, draw.node, i as u64);
            let (from, to) = if draw.replacement {
                (0, list.len)
            } else {
                let cut = |i: usize| (i as u64 * list.len as u64 / count as u64) as usize;
                (cut(i), cut(i + 1))
            };
            let place = from + random::below(bits, (to - from) as u32) as usize;
            self.index[i] = (list.start + place) as u32;
        }
        // SAFETY: indices are places of the list; ids are rays of the batch.
        unsafe {
            for i in (0..count).step_by(L::N) {
                let active = L::first(count - i);
                let index = L::load_u(self.index.as_ptr().add(i));
                for axis in 0..3 {
                    let inverse = L::gather(rays.active.inverse[axis], index, active);
                    L::store(self.inverse[axis].as_mut_ptr().add(i), inverse);
                    if rays.shared_origin.is_none() {
                        let origin = L::gather(rays.active.origin[axis], index, active);
                        L::store(self.origin[axis].as_mut_ptr().add(i), origin);
                    }
                }
                let id = L::gather_u(rays.active.id, index, active);
                L::store(self.t.as_mut_ptr().add(i), L::gather(rays.t, id, active));
            }
        }
    }

    /// Tests the sample rays against both boxes of every candidate.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `rays` are those of the draw.
    #[inline(always)]
    pub unsafe fn count<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
        &self,
        rays: &Rays,
        candidates: &[Candidate],
        counts: &mut [SampleCounts],
    ) {
        // SAFETY: as promised; the arrays have room for a whole vector behind the last sample.
        unsafe {
            let tmin = L::splat(rays.least_tmin);
            let (inverse, origin) = (streams(&self.inverse), streams(&self.origin));
            for (candidate, counts) in candidates.iter().zip(counts) {
                let left = SlabBox::<L>::new(&candidate.left, rays.shared_origin);
                let right = SlabBox::<L>::new(&candidate.right, rays.shared_origin);
                *counts = SampleCounts::default();
                for i in (0..self.len).step_by(L::N) {
                    let active = L::first(self.len - i);
                    let ray = SampleBlock::<L> {
                        inverse: load3::<L>(&inverse, i),
                        origin: if SHARED {
                            splat3::<L>(&[0.0; 3])
                        } else {
                            load3::<L>(&origin, i)
                        },
                        tmin,
                        t: L::load(self.t.as_ptr().add(i)),
                        active,
                    };
                    let (hit_left, near_left) = ray.entry::<SHARED, SPECIAL>(&left);
                    let (hit_right, near_right) = ray.entry::<SHARED, SPECIAL>(&right);
                    counts.left += L::bits(hit_left).count_ones();
                    counts.right += L::bits(hit_right).count_ones();
                    counts.left_first += L::bits(L::lt(near_left, near_right)).count_ones();
                    counts.right_first += L::bits(L::lt(near_right, near_left)).count_ones();
                }
            }
        }
    }
}

/// Pointers to three arrays, for reading only.
fn streams(arrays: &[[f32; MAX_SAMPLES + MAX_LANES]; 3]) -> [*mut f32; 3] {
    [
        arrays[0].as_ptr().cast_mut(),
        arrays[1].as_ptr().cast_mut(),
        arrays[2].as_ptr().cast_mut(),
    ]
}

/// One vector of sample rays.
struct SampleBlock<L: Lanes> {
    inverse: [L::F; 3],
    origin: [L::F; 3],
    tmin: L::F,
    t: L::F,
    active: L::M,
}

impl<L: Lanes> SampleBlock<L> {
    /// Which rays meet a box no further away than their best hit, and where they enter it: at
    /// infinity where they do not.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    unsafe fn entry<const SHARED: bool, const SPECIAL: bool>(
        &self,
        slabs: &SlabBox<L>,
    ) -> (L::M, L::F) {
        // SAFETY: as promised.
        unsafe {
            let (near, far) =
                slabs.interval::<SHARED, SPECIAL>(&self.inverse, &self.origin, self.tmin);
            let hit = L::and(L::and(L::le(near, far), L::le(near, self.t)), self.active);
            (hit, L::select(hit, near, L::splat(f32::INFINITY)))
        }
    }
}

/// Whether the first ray of a list enters the left box before the right one; a miss is as far away
/// as can be.
///
/// # Safety
/// `rays` keeps its promises; `list` is a list of it and not empty.
pub(crate) unsafe fn first_enters_left(rays: &Rays, list: List, pair: &Candidate) -> bool {
    type L = crate::simd::Portable;
    // SAFETY: portable code runs everywhere; one record is read, from a list that has one.
    unsafe {
        let at = list.start;
        let s = &rays.active;
        let inverse = s.inverse.map(|p| L::splat(*p.add(at)));
        let origin = match rays.shared_origin {
            Some(o) => o.to_array().map(|x| L::splat(x)),
            None => s.origin.map(|p| L::splat(*p.add(at))),
        };
        let ray = SampleBlock::<L> {
            inverse,
            origin,
            tmin: L::splat(rays.least_tmin),
            t: L::splat(*rays.t.add(*s.id.add(at) as usize)),
            active: L::first(1),
        };
        let (_, left) = ray.entry::<false, true>(&SlabBox::new(&pair.left, None));
        let (_, right) = ray.entry::<false, true>(&SlabBox::new(&pair.right, None));
        left[0] < right[0]
    }
}
