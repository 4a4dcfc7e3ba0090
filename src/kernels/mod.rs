//! The inner loops, each written once over [`Lanes`](crate::simd::Lanes) and instantiated for
//! every instruction set by the thin shells of [`Kernels`].

mod bins;
mod block;
mod certain;
mod clusters;
mod cone;
mod copies;
mod exact;
mod fast;
mod filter;
mod groups;
mod lists;
mod naive;
mod one;
mod open;
mod order;
mod overlap;
mod partition;
mod prepare;
mod records;
mod sample;
mod shells;
mod slab;
mod triangle;
mod watertight;

pub(crate) use bins::{BinBox, Binning, Bins, Item, MAX_BINS};
pub(crate) use block::{BlockStreams, Source};
pub(crate) use clusters::Grid;
pub(crate) use cone::{Cones, LEAST_PACKET, PreparedCones};
pub(crate) use copies::{Copies, IndexList, ItemList};
pub(crate) use filter::{BLOCK, Keep};
pub(crate) use groups::{ENTRY, Entry, GROUP, Groups, Ordered, streams};
pub(crate) use lists::{Listed, Side, TriangleLists};
pub(crate) use one::OneRay;
pub use one::{Sure, TriangleTest};
pub(crate) use order::{BUCKETS, SortedRay, Window, place_keys};
pub(crate) use overlap::Overlap;
pub(crate) use records::{Directions, Done, RAYS_AHEAD, Range, RayRecords};
pub(crate) use sample::{Candidate, Draw, SampleCounts, Samples, first_enters_left};
pub(crate) use shells::Kernels;
pub use slab::PADDING;
pub(crate) use triangle::{CHUNK, Prepared};
pub(crate) use triangle::{dot, sub3};

use crate::geometry::Aabb;
use crate::methods::Precision;
use crate::rays::Batch;
use crate::rays::active::Streams;
use crate::simd::Lanes;
use glam::Vec3;

/// The rays of one trace as the kernels see them.
///
/// All pointers are good for the whole trace: `directions`, `t` and `prim` for every ray id in a
/// list, `active` and `scratch` for the lists of [`crate::rays::active`].
#[derive(Clone, Copy)]
pub(crate) struct Rays {
    /// Where the lists of active rays live.
    pub active: Streams,
    /// Room for the rejected rays of one list.
    pub scratch: Streams,
    /// Direction and tmin by ray id: four floats each, so that a leaf touches one cache line a ray.
    pub directions: *mut [f32; 4],
    /// Best t so far by ray id; at first `tmax`, and −1 for an occluded any-hit ray.
    pub t: *mut f32,
    /// Best triangle so far by ray id; unused for any-hit rays.
    pub prim: *mut u32,
    /// The origin, if the batch has only one.
    pub shared_origin: Option<Vec3>,
    /// Whether some ray has an axis on which 1/d is not finite (stored as NaN), or ends where t may
    /// overflow.
    pub special: bool,
    /// The least `tmin` of all valid rays: the lower end of every node test.
    pub least_tmin: f32,
    /// Whether any hit will do.
    pub any_hit: bool,
    pub precision: Precision,
    pub tmax: Tmax,
    /// Whether what is looked up by ray id may be far away.
    pub ahead: bool,
    /// The box around all triangles.
    pub scene: Aabb,
}

impl Rays {
    /// The best triangles so far of some lanes.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; in these lanes are ids of rays, which are not any-hit rays.
    #[inline(always)]
    unsafe fn found<L: Lanes>(&self, id: L::U, lanes: L::M) -> L::U {
        // SAFETY: as promised.
        unsafe { L::gather_u(self.prim, id, lanes) }
    }

    /// A new best hit; of any-hit rays only t counts.
    ///
    /// # Safety
    /// The id of a ray.
    #[inline(always)]
    unsafe fn set<const ANY: bool>(&self, id: u32, t: f32, prim: u32) {
        // SAFETY: as promised.
        unsafe {
            *self.t.add(id as usize) = t;
            if !ANY {
                *self.prim.add(id as usize) = prim;
            }
        }
    }
}

/// Upper ends of the intervals of rays.
#[derive(Clone, Copy)]
pub(crate) struct Tmax {
    /// That of all valid rays, if they have the same.
    pub one: Option<f32>,
    /// By ray id, as the batch has it.
    pub each: *const f32,
}

impl Tmax {
    pub fn of(batch: &Batch) -> Tmax {
        Tmax {
            one: None,
            each: batch.tmax.as_ptr(),
        }
    }

    /// Those of some lanes.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; in these lanes are ids of rays of the batch.
    #[inline(always)]
    unsafe fn gather<L: Lanes>(&self, id: L::U, lanes: L::M) -> L::F {
        // SAFETY: as promised.
        unsafe {
            match self.one {
                Some(tmax) => L::splat(tmax),
                None => L::gather(self.each, id, lanes),
            }
        }
    }
}

/// A list of active rays: a range of the streams. Starts are multiples of
/// [`MAX_LANES`](crate::simd::MAX_LANES).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct List {
    pub start: usize,
    pub len: usize,
}
