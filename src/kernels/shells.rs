//! One instance of every kernel for each instruction set, behind a table of functions.

use super::bins::{self, BinBox, Binning, Bins, Item};
use super::block::{self, BlockStreams, Source};
use super::clusters::{self, Grid};
use super::cone::{self, Cones, PreparedCones};
use super::exact::Exact;
use super::fast::Fast;
use super::filter::{self, Keep};
use super::groups::{self, Entry, Groups, InOrder, Ordered};
use super::lists::{self, Listed, PreparedLists, Side, TriangleLists};
use super::naive::{self, Copied, Items, Kept, TriangleList};
use super::order::{self, Window};
use super::overlap::{self, Overlap};
use super::prepare::{self, PreparedRays};
use super::records::{self, Directions, Done, Indexed, PreparedRecords, Range, RayRecords};
use super::sample::{Candidate, Draw, SampleCounts, Samples};
use super::triangle::Prepared;
use super::watertight::Watertight;
use super::{List, Rays};
use crate::exact;
use crate::geometry::{Aabb, Mesh, Triangle};
use crate::methods::Precision;
use crate::rays::Batch;
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Lanes, Portable};
use glam::Vec3;
use std::ops;

/// The kernels of one instruction set.
///
/// # Safety
/// Each function may be called only on a processor that has the instruction set, which
/// [`Kernels::of`] checks, and with arguments that keep the promises of the generic function that
/// it instantiates.
#[allow(clippy::type_complexity)]
pub(crate) struct Kernels {
    pub shared_origin: unsafe fn(&Batch) -> Option<Vec3>,
    pub prepare_rays: unsafe fn(&Batch, &Rays) -> PreparedRays,
    pub prepare_triangles: unsafe fn(&Mesh, usize, &mut [Item]) -> (usize, BinBox),
    pub bin: unsafe fn(&[Item], &[Binning], &mut [Bins; 3]),
    pub partition: unsafe fn(&mut [Item], &mut [Item], &Binning, usize) -> usize,
    pub unite: unsafe fn(&[Item]) -> BinBox,
    pub spread_of_centers: unsafe fn(&[Item]) -> Vec3,
    pub draw_samples: unsafe fn(&mut Samples, &Rays, List, Draw),
    pub count_samples: unsafe fn(&Samples, &Rays, &[Candidate], &mut [SampleCounts]),
    pub filter: unsafe fn(&Rays, List, &Aabb, Keep) -> usize,
    pub filter_both: unsafe fn(&Rays, List, [&Aabb; 2], [usize; 2]) -> [usize; 2],
    pub count: unsafe fn(&Rays, List, &Aabb, usize) -> (usize, usize),
    pub naive: unsafe fn(&Rays, List, &[Triangle], &[Item]),
    pub count_keys: unsafe fn(&Batch, ops::Range<usize>, bool, &Aabb, &mut [u16], &mut [u32]),
    pub put_in_order: unsafe fn(&Batch, ops::Range<usize>, &[u16], &mut [u32], Window),
    pub load_block: unsafe fn(&Source, ops::Range<usize>, &Rays, &BlockStreams) -> PreparedRays,
    pub store_hits: unsafe fn(&Rays, &[u32], *mut f32, *mut u32),
    pub bound_groups: unsafe fn(&Rays, &Groups, usize),
    pub filter_groups:
        unsafe fn(&Rays, &Groups, &[Entry], [&Aabb; 2], [*mut Entry; 2]) -> [usize; 2],
    pub rays_of_groups: unsafe fn(&Rays, &[Entry], &Aabb, *mut Entry) -> (usize, usize),
    pub flush_groups: unsafe fn(&Rays, &[Entry], usize) -> usize,
    pub refresh_groups: unsafe fn(&Rays, &Groups, &[Entry]),
    pub naive_in_order: unsafe fn(&Rays, &Ordered, &[Entry], &[Triangle], &[Prepared]),
    pub naive_kept: unsafe fn(&Rays, List, &[Triangle], &[Prepared]),
    pub prepare_leaf: unsafe fn(&Rays, &[Triangle], &[Item], &mut [Prepared]),
    /// Brings so many bytes near.
    pub prefetch: unsafe fn(*const f32, usize),
    pub count_cells: unsafe fn(&[Item], &Grid, &mut [u32], &mut [u32]),
    pub scatter: unsafe fn(&[Item], &[u32], &mut [u32], &mut [BinBox], *mut Item),
    pub prepare_lists: unsafe fn(&Mesh, &TriangleLists) -> PreparedLists,
    pub keep_side: unsafe fn(&TriangleLists, usize, Side) -> usize,
    pub keep_overlapping: unsafe fn(&TriangleLists, usize, Overlap) -> usize,
    pub prepare_records: unsafe fn(&Batch, &RayRecords) -> PreparedRecords,
    pub keep_meeting: unsafe fn(&RayRecords, Range, &Aabb, Option<usize>) -> (usize, Directions),
    pub keep_octant: unsafe fn(&RayRecords, Range, usize) -> usize,
    /// Also given the cosine of the widest half-angle.
    pub prepare_cones: unsafe fn(&Batch, &RayRecords, &Cones, f32) -> PreparedCones,
    pub flush: unsafe fn(&Cones, Range, &RayRecords, usize) -> usize,
    pub keep_cones: unsafe fn(&Cones, Range, &Aabb, Vec3) -> usize,
    /// Also given the cell and when rays are done; returns the place behind those that are.
    pub naive_indexed: unsafe fn(&RayRecords, Range, Listed, &Aabb, Done) -> usize,
    pub round_hits: unsafe fn(&Batch, usize, &[Triangle], &[u32], &mut [f32]),
}

impl Kernels {
    /// The kernels for an instruction set.
    ///
    /// # Panics
    /// If this processor does not have it.
    pub fn of(isa: Isa) -> &'static Kernels {
        assert!(isa.is_available(), "this processor has no {isa}");
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => &avx512::KERNELS,
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => &avx2::KERNELS,
            _ => &portable::KERNELS,
        }
    }
}

/// Calls `$kernel::<L, SHARED, SPECIAL>` with what the batch is as constants.
macro_rules! by_batch {
    ($rays:expr, |$shared:ident, $special:ident| $call:expr) => {
        match ($rays.shared_origin.is_some(), $rays.special) {
            (true, false) => by_batch!(@ true, false, $shared, $special, $call),
            (true, true) => by_batch!(@ true, true, $shared, $special, $call),
            (false, false) => by_batch!(@ false, false, $shared, $special, $call),
            (false, true) => by_batch!(@ false, true, $shared, $special, $call),
        }
    };
    (@ $a:literal, $b:literal, $shared:ident, $special:ident, $call:expr) => {{
        const $shared: bool = $a;
        const $special: bool = $b;
        $call
    }};
}

/// Calls `$kernel::<L, Record, SPECIAL, ANY>` with the kernel of record of the precision. Only `fast`
/// has instances for batches in which nothing is special: the others would gain nothing by it.
macro_rules! by_record {
    ($rays:expr, $usual:ident, |$record:ident, $special:ident, $any:ident| $call:expr) => {
        match ($rays.precision, $rays.any_hit) {
            (Precision::Fast, false) => {
                by_record!(@ Fast, $usual, false, $record, $special, $any, $call)
            }
            (Precision::Fast, true) => {
                by_record!(@ Fast, $usual, true, $record, $special, $any, $call)
            }
            (Precision::Watertight, false) => {
                by_record!(@ Watertight, true, false, $record, $special, $any, $call)
            }
            (Precision::Watertight, true) => {
                by_record!(@ Watertight, true, true, $record, $special, $any, $call)
            }
            (Precision::Exact, false) => {
                by_record!(@ Exact, true, false, $record, $special, $any, $call)
            }
            (Precision::Exact, true) => {
                by_record!(@ Exact, true, true, $record, $special, $any, $call)
            }
        }
    };
    (@ $a:ty, $b:expr, $c:literal, $record:ident, $special:ident, $any:ident, $call:expr) => {{
        type $record = $a;
        const $special: bool = $b;
        const $any: bool = $c;
        $call
    }};
}

macro_rules! shells {
    ($isa:ident, $lanes:ty $(, #[$feature:meta])?) => {
        mod $isa {
            use super::*;

            pub(super) static KERNELS: Kernels = Kernels {
                shared_origin,
                prepare_rays,
                prepare_triangles,
                bin,
                partition,
                unite,
                spread_of_centers,
                draw_samples,
                count_samples,
                filter,
                filter_both,
                count,
                naive,
                count_keys,
                put_in_order,
                load_block,
                store_hits,
                bound_groups,
                filter_groups,
                rays_of_groups,
                flush_groups,
                refresh_groups,
                naive_in_order,
                naive_kept,
                prepare_leaf,
                prefetch,
                count_cells,
                scatter,
                prepare_lists,
                keep_side,
                keep_overlapping,
                prepare_records,
                keep_meeting,
                keep_octant,
                prepare_cones,
                flush,
                keep_cones,
                naive_indexed,
                round_hits,
            };

            type L = $lanes;

            $(#[$feature])?
            unsafe fn shared_origin(batch: &Batch) -> Option<Vec3> {
                // SAFETY: as `Kernels` promises; so in all that follow.
                unsafe { prepare::shared_origin::<L>(batch) }
            }

            $(#[$feature])?
            unsafe fn prepare_rays(batch: &Batch, rays: &Rays) -> PreparedRays {
                // SAFETY: as above.
                unsafe { prepare::prepare_rays::<L>(batch, rays) }
            }

            $(#[$feature])?
            unsafe fn prepare_triangles(
                mesh: &Mesh,
                from: usize,
                items: &mut [Item],
            ) -> (usize, BinBox) {
                // SAFETY: as above.
                unsafe { prepare::prepare_triangles::<L>(mesh, from, items) }
            }

            $(#[$feature])?
            unsafe fn bin(items: &[Item], axes: &[Binning], bins: &mut [Bins; 3]) {
                // SAFETY: as above.
                unsafe { bins::bin::<L>(items, axes, bins) }
            }

            $(#[$feature])?
            unsafe fn partition(
                items: &mut [Item],
                scratch: &mut [Item],
                by: &Binning,
                last_left: usize,
            ) -> usize {
                bins::partition(items, scratch, by, last_left)
            }

            $(#[$feature])?
            unsafe fn unite(items: &[Item]) -> BinBox {
                // SAFETY: as above.
                unsafe { bins::unite::<L>(items) }
            }

            $(#[$feature])?
            unsafe fn spread_of_centers(items: &[Item]) -> Vec3 {
                bins::spread_of_centers(items)
            }

            $(#[$feature])?
            unsafe fn draw_samples(samples: &mut Samples, rays: &Rays, list: List, draw: Draw) {
                // SAFETY: as above.
                unsafe { samples.draw::<L>(rays, list, draw) }
            }

            $(#[$feature])?
            unsafe fn count_samples(
                samples: &Samples,
                rays: &Rays,
                candidates: &[Candidate],
                counts: &mut [SampleCounts],
            ) {
                by_batch!(rays, |SHARED, SPECIAL| {
                    // SAFETY: as above.
                    unsafe { samples.count::<L, SHARED, SPECIAL>(rays, candidates, counts) }
                })
            }

            $(#[$feature])?
            unsafe fn filter(rays: &Rays, list: List, bounds: &Aabb, keep: Keep) -> usize {
                by_batch!(rays, |SHARED, SPECIAL| {
                    // SAFETY: as above.
                    unsafe { filter::filter::<L, SHARED, SPECIAL>(rays, list, bounds, keep) }
                })
            }

            $(#[$feature])?
            unsafe fn filter_both(
                rays: &Rays,
                list: List,
                boxes: [&Aabb; 2],
                places: [usize; 2],
            ) -> [usize; 2] {
                by_batch!(rays, |SHARED, SPECIAL| {
                    // SAFETY: as above.
                    unsafe { filter::filter_both::<L, SHARED, SPECIAL>(rays, list, boxes, places) }
                })
            }

            $(#[$feature])?
            unsafe fn count(
                rays: &Rays,
                list: List,
                bounds: &Aabb,
                stride: usize,
            ) -> (usize, usize) {
                by_batch!(rays, |SHARED, SPECIAL| {
                    // SAFETY: as above.
                    unsafe { filter::count::<L, SHARED, SPECIAL>(rays, list, bounds, stride) }
                })
            }

            $(#[$feature])?
            unsafe fn naive(rays: &Rays, list: List, triangles: &[Triangle], items: &[Item]) {
                let (mut list, triangles) = (Copied { rays, list }, Items { triangles, items });
                by_batch!(rays, |SHARED, USUAL| {
                    // SAFETY: as above.
                    unsafe {
                        by_record!(rays, USUAL, |Record, SPECIAL, ANY| {
                            naive::naive::<L, Record, SHARED, SPECIAL, ANY>(&mut list, triangles)
                        })
                    }
                });
            }

            $(#[$feature])?
            unsafe fn count_keys(
                batch: &Batch,
                range: ops::Range<usize>,
                shared: bool,
                scene: &Aabb,
                keys: &mut [u16],
                counts: &mut [u32],
            ) {
                // SAFETY: as above.
                unsafe { order::count_keys::<L>(batch, range, shared, scene, keys, counts) }
            }

            $(#[$feature])?
            unsafe fn put_in_order(
                batch: &Batch,
                range: ops::Range<usize>,
                keys: &[u16],
                next: &mut [u32],
                to: Window,
            ) {
                // SAFETY: as above.
                unsafe { order::put_in_order::<L>(batch, range, keys, next, to) }
            }

            $(#[$feature])?
            unsafe fn load_block(
                from: &Source,
                range: ops::Range<usize>,
                rays: &Rays,
                streams: &BlockStreams,
            ) -> PreparedRays {
                // SAFETY: as above.
                unsafe { block::load_block::<L>(from, range, rays, streams) }
            }

            $(#[$feature])?
            unsafe fn store_hits(rays: &Rays, places: &[u32], t: *mut f32, prim: *mut u32) {
                // SAFETY: as above.
                unsafe { block::store_hits::<L>(rays, places, t, prim) }
            }

            $(#[$feature])?
            unsafe fn bound_groups(rays: &Rays, groups: &Groups, len: usize) {
                by_batch!(rays, |SHARED, SPECIAL| {
                    // SAFETY: as above.
                    unsafe { groups::bound_groups::<L, SHARED, SPECIAL>(rays, groups, len) }
                })
            }

            $(#[$feature])?
            unsafe fn filter_groups(
                rays: &Rays,
                groups: &Groups,
                entries: &[Entry],
                boxes: [&Aabb; 2],
                to: [*mut Entry; 2],
            ) -> [usize; 2] {
                // SAFETY: as above.
                unsafe {
                    match rays.shared_origin {
                        Some(_) => groups::filter_groups::<L, true>(rays, groups, entries, boxes, to),
                        None => groups::filter_groups::<L, false>(rays, groups, entries, boxes, to),
                    }
                }
            }

            $(#[$feature])?
            unsafe fn rays_of_groups(
                rays: &Rays,
                entries: &[Entry],
                bounds: &Aabb,
                to: *mut Entry,
            ) -> (usize, usize) {
                by_batch!(rays, |SHARED, SPECIAL| {
                    // SAFETY: as above.
                    unsafe { groups::rays_of_groups::<L, SHARED, SPECIAL>(rays, entries, bounds, to) }
                })
            }

            $(#[$feature])?
            unsafe fn flush_groups(rays: &Rays, entries: &[Entry], place: usize) -> usize {
                // SAFETY: as above.
                unsafe {
                    match rays.shared_origin {
                        Some(_) => groups::flush_groups::<L, true>(rays, entries, place),
                        None => groups::flush_groups::<L, false>(rays, entries, place),
                    }
                }
            }

            $(#[$feature])?
            unsafe fn refresh_groups(rays: &Rays, groups: &Groups, entries: &[Entry]) {
                // SAFETY: as above.
                unsafe { groups::refresh_groups::<L>(rays, groups, entries) }
            }

            $(#[$feature])?
            unsafe fn naive_in_order(
                rays: &Rays,
                ordered: &Ordered,
                entries: &[Entry],
                triangles: &[Triangle],
                kept: &[Prepared],
            ) {
                let (mut list, triangles) = (InOrder { rays, ordered, entries }, Kept { triangles, kept });
                by_batch!(rays, |SHARED, USUAL| {
                    // SAFETY: as above.
                    unsafe {
                        by_record!(rays, USUAL, |Record, SPECIAL, ANY| {
                            naive::naive::<L, Record, SHARED, SPECIAL, ANY>(&mut list, triangles)
                        })
                    }
                });
            }

            $(#[$feature])?
            unsafe fn naive_kept(
                rays: &Rays,
                list: List,
                triangles: &[Triangle],
                kept: &[Prepared],
            ) {
                let (mut list, triangles) = (Copied { rays, list }, Kept { triangles, kept });
                by_batch!(rays, |SHARED, USUAL| {
                    // SAFETY: as above.
                    unsafe {
                        by_record!(rays, USUAL, |Record, SPECIAL, ANY| {
                            naive::naive::<L, Record, SHARED, SPECIAL, ANY>(&mut list, triangles)
                        })
                    }
                });
            }

            $(#[$feature])?
            unsafe fn prepare_leaf(
                rays: &Rays,
                triangles: &[Triangle],
                items: &[Item],
                to: &mut [Prepared],
            ) {
                let mut list = Items { triangles, items };
                // SAFETY: as above.
                unsafe {
                    match rays.precision {
                        Precision::Fast => TriangleList::<L>::prepare::<Fast>(&mut list, 0, to, rays.shared_origin),
                        _ => TriangleList::<L>::prepare::<Exact>(&mut list, 0, to, rays.shared_origin),
                    }
                }
            }

            $(#[$feature])?
            unsafe fn prefetch(p: *const f32, bytes: usize) {
                for line in 0..bytes.div_ceil(64) {
                    // SAFETY: as above; the address may be any.
                    unsafe { <L as Lanes>::prefetch(p.wrapping_add(16 * line)) }
                }
            }

            $(#[$feature])?
            unsafe fn count_cells(items: &[Item], grid: &Grid, cells: &mut [u32], counts: &mut [u32]) {
                // SAFETY: as above.
                unsafe { clusters::count_cells::<L>(items, grid, cells, counts) }
            }

            $(#[$feature])?
            unsafe fn scatter(
                items: &[Item],
                cells: &[u32],
                places: &mut [u32],
                boxes: &mut [BinBox],
                to: *mut Item,
            ) {
                // SAFETY: as above.
                unsafe { clusters::scatter::<L>(items, cells, places, boxes, to) }
            }

            $(#[$feature])?
            unsafe fn prepare_lists(mesh: &Mesh, lists: &TriangleLists) -> PreparedLists {
                // SAFETY: as above.
                unsafe { lists::prepare_lists(mesh, lists) }
            }

            $(#[$feature])?
            unsafe fn keep_side(lists: &TriangleLists, len: usize, side: Side) -> usize {
                // SAFETY: as above.
                unsafe { lists::keep_side::<L>(lists, len, side) }
            }

            $(#[$feature])?
            unsafe fn keep_overlapping(lists: &TriangleLists, len: usize, by: Overlap) -> usize {
                // SAFETY: as above.
                unsafe { overlap::keep_overlapping::<L>(lists, len, by) }
            }

            $(#[$feature])?
            unsafe fn prepare_records(batch: &Batch, rays: &RayRecords) -> PreparedRecords {
                // SAFETY: as above.
                unsafe { records::prepare_records::<L>(batch, rays) }
            }

            $(#[$feature])?
            unsafe fn keep_meeting(
                rays: &RayRecords,
                list: Range,
                bounds: &Aabb,
                axis: Option<usize>,
            ) -> (usize, Directions) {
                by_batch!(rays, |SHARED, SPECIAL| {
                    // SAFETY: as above.
                    unsafe { records::keep_meeting::<L, SHARED, SPECIAL>(rays, list, bounds, axis) }
                })
            }

            $(#[$feature])?
            unsafe fn keep_octant(rays: &RayRecords, list: Range, octant: usize) -> usize {
                // SAFETY: as above.
                unsafe {
                    match rays.shared_origin {
                        Some(_) => records::keep_octant::<L, true>(rays, list, octant),
                        None => records::keep_octant::<L, false>(rays, list, octant),
                    }
                }
            }

            $(#[$feature])?
            unsafe fn prepare_cones(
                batch: &Batch,
                rays: &RayRecords,
                cones: &Cones,
                least_cosine: f32,
            ) -> PreparedCones {
                // SAFETY: as above.
                unsafe { cone::prepare_cones::<L>(batch, rays, cones, least_cosine) }
            }

            $(#[$feature])?
            unsafe fn flush(cones: &Cones, list: Range, rays: &RayRecords, to: usize) -> usize {
                // SAFETY: as above.
                unsafe { cone::flush::<L>(cones, list, rays, to) }
            }

            $(#[$feature])?
            unsafe fn keep_cones(
                cones: &Cones,
                list: Range,
                bounds: &Aabb,
                origin: Vec3,
            ) -> usize {
                // SAFETY: as above.
                unsafe { cone::keep_cones::<L>(cones, list, bounds, origin) }
            }

            $(#[$feature])?
            unsafe fn naive_indexed(
                rays: &RayRecords,
                list: Range,
                triangles: Listed,
                cell: &Aabb,
                when: Done,
            ) -> usize {
                // SAFETY: as above.
                let mut list = unsafe { Indexed::<L>::new(rays, list, cell, when) };
                by_batch!(rays, |SHARED, USUAL| {
                    // SAFETY: as above.
                    unsafe {
                        by_record!(rays, USUAL, |Record, SPECIAL, ANY| {
                            naive::naive::<L, Record, SHARED, SPECIAL, ANY>(&mut list, triangles)
                        })
                    }
                });
                list.done
            }

            $(#[$feature])?
            unsafe fn round_hits(
                batch: &Batch,
                from: usize,
                triangles: &[Triangle],
                prim: &[u32],
                t: &mut [f32],
            ) {
                // SAFETY: as above.
                unsafe { exact::round_hits::<L>(batch, from, triangles, prim, t) }
            }
        }
    };
}

shells!(portable, Portable);
#[cfg(target_arch = "x86_64")]
shells!(avx2, Avx2, #[target_feature(enable = "avx2,fma,bmi2,popcnt")]);
#[cfg(target_arch = "x86_64")]
shells!(
    avx512,
    Avx512,
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi2,popcnt")]
);
