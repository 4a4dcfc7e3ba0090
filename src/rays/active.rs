//! Lists of active rays: whole records (inverse direction, origin, id) in seven streams, so that
//! filtering reads and writes memory in order.
//!
//! The root list takes the first n places. A filter that keeps up to three quarters of its rays
//! copies them behind the lists of its ancestors; one that keeps more partitions its parent's list
//! in place, kept rays first. So lists take n + 3/4 n + 9/16 n + …, and there is room for 4n records
//! and a constant; a list that might not fit is partitioned in place, so memory stays linear
//! whatever the rays do.

use crate::room;
use crate::simd::MAX_LANES;

/// Streams of floats or integers that a record is spread over.
const STREAMS: usize = 7;
/// Records beyond 4n: alignment of list starts, and room to copy lists of any small batch.
const SLACK: usize = 16_384;
/// Distance of the streams beyond their length, so that equal places do not share a cache set.
const STAGGER: usize = 9 * MAX_LANES;

/// One cache line of floats.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([f32; MAX_LANES]);

/// Pointers to the streams of records: element `i` of each belongs to record `i`.
#[derive(Clone, Copy)]
pub(crate) struct Streams {
    /// 1/direction by axis; NaN where that is not finite.
    pub inverse: [*mut f32; 3],
    /// Origin by axis; not written where the batch shares its origin.
    pub origin: [*mut f32; 3],
    /// Place of the ray in its batch.
    pub id: *mut u32,
}

/// The memory behind the streams.
pub(crate) struct ActiveRays {
    lines: Vec<Line>,
    rays: usize,
}

impl ActiveRays {
    /// Records that lists may use in all, for a batch of `rays`.
    pub fn capacity(rays: usize) -> usize {
        4 * rays.next_multiple_of(MAX_LANES) + SLACK
    }

    fn scratch_capacity(rays: usize) -> usize {
        rays.next_multiple_of(MAX_LANES) + MAX_LANES
    }

    fn stream_len(records: usize) -> usize {
        (records + STAGGER).next_multiple_of(MAX_LANES)
    }

    /// Bytes for a batch of `rays`: 140 a ray and a constant.
    pub fn bytes(rays: usize) -> usize {
        let floats =
            Self::stream_len(Self::capacity(rays)) + Self::stream_len(Self::scratch_capacity(rays));
        floats * STREAMS * size_of::<f32>()
    }

    /// Memory for a batch of up to `rays`.
    pub fn new(rays: usize) -> ActiveRays {
        let lines = Self::bytes(rays) / size_of::<Line>();
        ActiveRays {
            lines: room(Line([0.0; MAX_LANES]), lines),
            rays,
        }
    }

    /// How many rays a batch may have.
    pub fn rays(&self) -> usize {
        self.rays
    }

    /// Ids of all places of the lists.
    pub fn ids(&self) -> &[u32] {
        let len = Self::stream_len(Self::capacity(self.rays));
        // SAFETY: the fourth stream of so many floats, written as integers.
        unsafe { std::slice::from_raw_parts(self.lines.as_ptr().cast::<u32>().add(3 * len), len) }
    }

    /// The streams for lists and those for one list's rejected rays.
    pub fn streams(&mut self) -> (Streams, Streams) {
        let active = Self::stream_len(Self::capacity(self.rays));
        let scratch = Self::stream_len(Self::scratch_capacity(self.rays));
        let base = self.lines.as_mut_ptr().cast::<f32>();
        // SAFETY: `bytes` is the sum of both sets of streams.
        unsafe {
            let behind = base.add(STREAMS * active);
            (Streams::at(base, active), Streams::at(behind, scratch))
        }
    }
}

impl Streams {
    /// Seven streams of `len` floats each from `base` on.
    ///
    /// # Safety
    /// `base` must be good for `7 * len` floats.
    unsafe fn at(base: *mut f32, len: usize) -> Streams {
        // SAFETY: by the caller's promise.
        let stream = |i: usize| unsafe { base.add(i * len) };
        Streams {
            inverse: [stream(0), stream(1), stream(2)],
            id: stream(3).cast(),
            origin: [stream(4), stream(5), stream(6)],
        }
    }
}
