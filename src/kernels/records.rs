//! Rays by number: records that stay where they are, and an index list of the active ones (Mora 2011,
//! section 3.2).

use super::Tmax;
use super::naive::{RayList, RayVector};
use super::partition::{Test, partition};
use super::prepare;
use super::slab::SlabBox;
use crate::geometry::Aabb;
use crate::methods::Precision;
use crate::rays::{Batch, MISS};
use crate::simd::{Lanes, MAX_LANES, OnLines};
use glam::Vec3;

/// The rays of one trace. All pointers are good for every ray of the batch.
#[derive(Clone, Copy)]
pub(crate) struct RayRecords {
    /// Inverse direction (NaN where that is not finite) and best t so far; at first `tmax`, and −1
    /// for an occluded any-hit ray. Where rays have origins of their own, each is followed by its
    /// origin, in the same cache line.
    pub slabs: *mut [f32; 4],
    /// Direction, and the bits of the best triangle so far (unused for any-hit rays).
    pub directions: *mut [f32; 4],
    /// tmin of each ray, if they are not all the same.
    pub tmin: *const f32,
    /// Indices of active rays, with [`RAYS_AHEAD`] valid indices behind their end.
    pub ids: *mut u32,
    /// The origin, if the batch has only one.
    pub shared_origin: Option<Vec3>,
    /// Whether some ray has an axis on which 1/d is not finite, or ends where t may overflow.
    pub special: bool,
    /// The least `tmin` of all valid rays.
    pub least_tmin: f32,
    /// Whether that is the tmin of all of them.
    pub one_tmin: bool,
    /// Whether any hit will do.
    pub any_hit: bool,
    pub precision: Precision,
    pub tmax: Tmax,
    /// The box around all triangles.
    pub scene: Aabb,
}

impl RayRecords {
    /// Inverse directions, origins (meaningless where they are shared) and best t of `L::N` rays.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `L::N` indices of rays at `ids`.
    #[inline(always)]
    unsafe fn slabs<L: Lanes, const SHARED: bool>(
        &self,
        ids: *const u32,
    ) -> ([L::F; 3], [L::F; 3], L::F) {
        // SAFETY: as promised.
        unsafe {
            if SHARED {
                let [x, y, z, t] = L::gather4::<1>(self.slabs, ids);
                ([x, y, z], [x, y, z], t)
            } else {
                let [x, y, z, t] = L::gather4::<2>(self.slabs, ids);
                let [ox, oy, oz, _] = L::gather4::<2>(self.slabs.add(1), ids);
                ([x, y, z], [ox, oy, oz], t)
            }
        }
    }

    /// Best t so far, and its triangle (none for any-hit rays).
    ///
    /// # Safety
    /// It is the number of a ray of the batch.
    pub unsafe fn best(&self, ray: usize) -> (f32, u32) {
        // SAFETY: as promised.
        let (slab, directed) = unsafe {
            let slab = *self.slabs.add(self.place(ray));
            (slab, *self.directions.add(ray))
        };
        match self.any_hit {
            true => (slab[3], MISS),
            false => (slab[3], directed[3].to_bits()),
        }
    }

    /// Place of the first record of a ray.
    #[inline(always)]
    fn place(&self, ray: usize) -> usize {
        match self.shared_origin {
            Some(_) => ray,
            None => 2 * ray,
        }
    }
}

/// A range of the index list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Range {
    pub from: usize,
    pub to: usize,
}

impl Range {
    pub fn len(self) -> usize {
        self.to - self.from
    }
}

/// What the pass over the rays found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PreparedRecords {
    /// Valid rays.
    pub valid: usize,
    /// Whether a valid ray has an axis on which 1/d is not finite, or ends where t may overflow.
    pub special: bool,
    /// The least tmin of the valid rays.
    pub least_tmin: f32,
    /// Whether all of them have that one.
    pub one_tmin: bool,
    /// The tmax of all of them, if it is the same.
    pub one_tmax: Option<f32>,
    /// The box around the origins of the valid rays.
    pub origins: Aabb,
}

/// Writes the records of all rays, the index list of the valid ones in their order, and misses.
///
/// # Safety
/// The processor has `L`'s instruction set; the records have room for the batch, the index list for
/// whole vectors behind it.
#[inline(always)]
pub(crate) unsafe fn prepare_records<L: Lanes>(
    batch: &Batch,
    rays: &RayRecords,
) -> PreparedRecords {
    // SAFETY: index places never pass ray places.
    unsafe {
        let infinity = L::splat(f32::INFINITY);
        let mut least = [infinity; 4];
        let mut greatest = [L::splat(f32::NEG_INFINITY); 4];
        let mut special = L::first(0);
        let (mut first_tmax, mut last_tmax) = (infinity, L::splat(0.0));
        let mut n = 0;
        for at in (0..batch.len()).step_by(L::N) {
            let left = batch.len() - at;
            let origin = prepare::load3::<L>(&batch.origin, at);
            let direction = prepare::load3::<L>(&batch.direction, at);
            let tmin = prepare::load::<L>(&batch.tmin, at);
            let tmax = prepare::load::<L>(&batch.tmax, at);
            let valid = prepare::valid::<L>(&origin, &direction, tmin, tmax);
            let valid = L::and(valid, L::first(left));
            least[3] = L::select(valid, L::min(tmin, least[3]), least[3]);
            greatest[3] = L::select(valid, L::max(tmin, greatest[3]), greatest[3]);
            let mut inverse = direction;
            for axis in 0..3 {
                let o = origin[axis];
                least[axis] = L::select(valid, L::min(o, least[axis]), least[axis]);
                greatest[axis] = L::select(valid, L::max(o, greatest[axis]), greatest[axis]);
                let (x, finite) = prepare::inverse::<L>(direction[axis], rays.precision);
                special = L::or(special, L::and_not(valid, finite));
                inverse[axis] = x;
            }
            let far = prepare::ends_far::<L>(tmax);
            special = L::or(special, L::and(valid, far));
            first_tmax = L::select(valid, L::min(tmax, first_tmax), first_tmax);
            last_tmax = L::select(valid, L::max(tmax, last_tmax), last_tmax);
            // An invalid ray's tmax may be the very mark of an occluded ray.
            let best = L::select(valid, tmax, infinity);
            let slab = [inverse[0], inverse[1], inverse[2], best];
            let miss = L::from_bits(L::splat_u(MISS));
            let directed = [direction[0], direction[1], direction[2], miss];
            let placed = [origin[0], origin[1], origin[2], tmin];
            let lanes = left.min(L::N);
            store_first4::<L, 1>(rays.directions.add(at), directed, lanes);
            if rays.shared_origin.is_some() {
                store_first4::<L, 1>(rays.slabs.add(at), slab, lanes);
            } else {
                store_first4::<L, 2>(rays.slabs.add(2 * at), slab, lanes);
                store_first4::<L, 2>(rays.slabs.add(2 * at + 1), placed, lanes);
            }
            // Lanes behind the batch name a ray, too: compressing may leave any lane behind the list.
            let id = L::select_u(
                L::first(left),
                L::count_from(at as u32),
                L::splat_u(at as u32),
            );
            L::store_u(rays.ids.add(n), L::compress_u(valid, id));
            n += L::bits(valid).count_ones() as usize;
        }
        let least_tmin = least_of::<L>(least[3]);
        PreparedRecords {
            valid: n,
            special: L::bits(special) != 0,
            least_tmin,
            one_tmax: prepare::one::<L>(first_tmax, last_tmax),
            one_tmin: least_tmin == -least_of::<L>(L::sub(L::splat(0.0), greatest[3])),
            origins: Aabb {
                min: Vec3::new(
                    least_of::<L>(least[0]),
                    least_of::<L>(least[1]),
                    least_of::<L>(least[2]),
                ),
                max: -Vec3::new(
                    least_of::<L>(L::sub(L::splat(0.0), greatest[0])),
                    least_of::<L>(L::sub(L::splat(0.0), greatest[1])),
                    least_of::<L>(L::sub(L::splat(0.0), greatest[2])),
                ),
            },
        }
    }
}

/// Stores the first `n` of `L::N` records, to every `STRIDE`-th place.
///
/// # Safety
/// The processor has `L`'s instruction set; there is room for so many, at most `L::N`.
#[inline(always)]
unsafe fn store_first4<L: Lanes, const STRIDE: usize>(p: *mut [f32; 4], v: [L::F; 4], n: usize) {
    // SAFETY: as promised.
    unsafe {
        if STRIDE == 1 && n == L::N {
            return L::store4(p, v);
        }
        let OnLines(records) = &mut OnLines([[0f32; 4]; MAX_LANES]);
        L::store4(records.as_mut_ptr(), v);
        for (i, record) in records.iter().enumerate().take(n) {
            *p.add(STRIDE * i) = *record;
        }
    }
}

/// The least lane.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(super) unsafe fn least_of<L: Lanes>(v: L::F) -> f32 {
    let mut lanes = [f32::INFINITY; MAX_LANES];
    // SAFETY: as promised.
    unsafe { L::store(lanes.as_mut_ptr(), v) };
    lanes
        .into_iter()
        .fold(f32::INFINITY, |a, b| if b < a { b } else { a })
}

/// How many rays of a list go up an axis, and how many go down; the rest does neither.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Directions {
    pub up: usize,
    pub down: usize,
}

/// Rays that meet a box no further away than their best hit.
struct Meets<'a, L: Lanes, const SHARED: bool, const SPECIAL: bool> {
    rays: &'a RayRecords,
    slabs: SlabBox<L>,
    /// Of the rays that pass, the directions on this axis are counted.
    axis: Option<usize>,
    directions: Directions,
}

impl<L: Lanes, const SHARED: bool, const SPECIAL: bool> Test<L> for Meets<'_, L, SHARED, SPECIAL> {
    #[inline(always)]
    unsafe fn pass(&mut self, ids: *const u32, active: L::M) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let (inverse, origin, t) = self.rays.slabs::<L, SHARED>(ids);
            let tmin = L::splat(self.rays.least_tmin);
            let (near, far) = (self.slabs).interval::<SHARED, SPECIAL>(&inverse, &origin, tmin);
            let meets = L::and(L::le(near, far), L::le(near, t));
            let passed = L::and(meets, active);
            if let Some(axis) = self.axis {
                let zero = L::splat(0.0);
                let up = L::and(passed, L::lt(zero, inverse[axis]));
                let down = L::and(passed, L::lt(inverse[axis], zero));
                self.directions.up += L::bits(up).count_ones() as usize;
                self.directions.down += L::bits(down).count_ones() as usize;
            }
            passed
        }
    }

    #[inline(always)]
    unsafe fn prefetch(&self, ids: *const u32) {
        // Rays of one origin are most often near each other in the batch: four share a cache line.
        for lane in (0..MAX_LANES).step_by(if SHARED { 4 } else { 1 }) {
            // SAFETY: as promised.
            unsafe {
                let next = *ids.add(lane) as usize;
                L::prefetch(self.rays.slabs.wrapping_add(self.rays.place(next)).cast());
            }
        }
    }
}

/// Moves the rays of a list that meet a box no further away than their best hit to its front; returns
/// how many do, and where they go on an axis, if there is one to be counted.
///
/// # Safety
/// The processor has `L`'s instruction set; the records are those of the batch.
#[inline(always)]
pub(crate) unsafe fn keep_meeting<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    rays: &RayRecords,
    list: Range,
    bounds: &Aabb,
    axis: Option<usize>,
) -> (usize, Directions) {
    // SAFETY: as promised.
    unsafe {
        let mut test = Meets::<L, SHARED, SPECIAL> {
            rays,
            slabs: SlabBox::new(bounds, rays.shared_origin),
            axis,
            directions: Directions::default(),
        };
        let n = partition::<L, _>(rays.ids.add(list.from), list.len(), &mut test);
        (n, test.directions)
    }
}

/// Rays of an octant of directions.
struct InOctant<'a, const SHARED: bool> {
    rays: &'a RayRecords,
    octant: usize,
}

impl<L: Lanes, const SHARED: bool> Test<L> for InOctant<'_, SHARED> {
    #[inline(always)]
    unsafe fn pass(&mut self, ids: *const u32, active: L::M) -> L::M {
        // SAFETY: as promised.
        unsafe {
            let (inverse, ..) = self.rays.slabs::<L, SHARED>(ids);
            let mut inside = active;
            for (axis, inverse) in inverse.into_iter().enumerate() {
                let down = L::lt(inverse, L::splat(0.0));
                inside = match self.octant >> axis & 1 {
                    0 => L::and_not(inside, down),
                    _ => L::and(inside, down),
                };
            }
            inside
        }
    }
}

/// Moves the rays of a list that belong to an octant of directions to its front; returns how many do.
/// A ray goes down the axes whose bits are set, and up the others, or along none of them.
///
/// # Safety
/// As for [`keep_meeting`].
#[inline(always)]
pub(crate) unsafe fn keep_octant<L: Lanes, const SHARED: bool>(
    rays: &RayRecords,
    list: Range,
    octant: usize,
) -> usize {
    let mut test = InOctant::<SHARED> { rays, octant };
    // SAFETY: as promised.
    unsafe { partition::<L, _>(rays.ids.add(list.from), list.len(), &mut test) }
}

/// When rays are done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Done {
    /// Not before the end.
    Never,
    /// Once every cell that comes later will turn them away, because their best t is before the exit
    /// of the cell whose triangles they have met.
    ///
    /// A later cell is behind a plane that this one is before, so a ray enters it, as computed, no
    /// sooner than it leaves this one: slabs are monotone in their planes. (One that starts on the plane
    /// and goes away from it may enter at t = 0, where nothing is hit.) A ray without a direction on
    /// an axis is not before or behind a plane across it; it is done only if its origin is
    /// strictly between this cell's.
    BeforeExit,
    /// Once they have hit anything, wherever: as section 3.2 prints it.
    Hit,
}

/// Places between the rays that are intersected and those that are fetched for later.
const AHEAD: usize = 8 * MAX_LANES;
/// Valid indices that stand behind the index list.
pub(crate) const RAYS_AHEAD: usize = AHEAD + MAX_LANES;

/// A range of the index list as the naive step takes it. Rays that are done come first when it is over.
pub(crate) struct Indexed<'a, L: Lanes> {
    rays: &'a RayRecords,
    list: Range,
    cell: SlabBox<L>,
    when: Done,
    /// Place behind the rays that are done.
    pub done: usize,
}

impl<'a, L: Lanes> Indexed<'a, L> {
    /// # Safety
    /// The processor has `L`'s instruction set; `rays` are those of the batch.
    #[inline(always)]
    pub unsafe fn new(rays: &'a RayRecords, list: Range, cell: &Aabb, when: Done) -> Self {
        Indexed {
            rays,
            list,
            // SAFETY: as promised.
            cell: unsafe { SlabBox::new(cell, rays.shared_origin) },
            when,
            done: list.from,
        }
    }
}

// SAFETY: an index list names rays of the batch, each once.
unsafe impl<L: Lanes> RayList<L> for Indexed<'_, L> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.list.len()
    }

    #[inline(always)]
    fn shared_origin(&self) -> Option<Vec3> {
        self.rays.shared_origin
    }

    #[inline(always)]
    unsafe fn tmax(&self, v: &RayVector<L>, lanes: L::M) -> L::F {
        // SAFETY: as promised.
        unsafe { self.rays.tmax.gather::<L>(v.id, lanes) }
    }

    #[inline(always)]
    fn scene(&self) -> &Aabb {
        &self.rays.scene
    }

    #[inline(always)]
    unsafe fn load<const SHARED: bool>(&self, i: usize) -> RayVector<L> {
        // SAFETY: as promised; behind a list there are valid indices, too.
        unsafe {
            let ids = self.rays.ids.add(self.list.from + i);
            for lane in (0..L::N).step_by(if SHARED { 4 } else { 1 }) {
                let next = *ids.add(AHEAD + lane) as usize;
                L::prefetch(self.rays.slabs.wrapping_add(self.rays.place(next)).cast());
                L::prefetch(self.rays.directions.wrapping_add(next).cast());
            }
            let (inverse, origin, t) = self.rays.slabs::<L, SHARED>(ids);
            let [x, y, z, prim] = L::gather4::<1>(self.rays.directions, ids);
            let (active, id) = (L::first(self.list.len() - i), L::load_u(ids));
            let tmin = match self.rays.one_tmin {
                true => L::splat(self.rays.least_tmin),
                false => L::gather(self.rays.tmin, id, active),
            };
            RayVector {
                active,
                id,
                inverse,
                origin,
                direction: [x, y, z],
                tmin,
                t,
                prim: L::to_bits(prim),
            }
        }
    }

    #[inline(always)]
    unsafe fn id(&self, i: usize) -> u32 {
        // SAFETY: as promised.
        unsafe { *self.rays.ids.add(self.list.from + i) }
    }

    #[inline(always)]
    unsafe fn found(&self, v: &RayVector<L>, _: L::M) -> L::U {
        v.prim
    }

    #[inline(always)]
    unsafe fn set<const ANY: bool>(&self, id: u32, t: f32, prim: u32) {
        // SAFETY: as promised.
        unsafe {
            let place = self.rays.place(id as usize);
            (*self.rays.slabs.add(place))[3] = t;
            if !ANY {
                (*self.rays.directions.add(id as usize))[3] = f32::from_bits(prim);
            }
        }
    }

    #[inline(always)]
    unsafe fn finish<const SHARED: bool, const SPECIAL: bool>(
        &mut self,
        i: usize,
        v: &RayVector<L>,
        t: L::F,
    ) {
        // SAFETY: as promised. Rays that are not done, between those that are and the vector, make
        // room for the new ones.
        unsafe {
            // An occluded ray's t is negative.
            let zero = L::splat(0.0);
            let done = match self.when {
                Done::Never => return,
                Done::BeforeExit => {
                    let exit = (self.cell).sure_exit::<SHARED, SPECIAL>(&v.inverse, &v.origin);
                    L::lt(t, L::max(exit, zero))
                }
                Done::Hit if self.rays.any_hit => L::lt(t, zero),
                Done::Hit => {
                    let ids = self.rays.ids.add(self.list.from + i);
                    let [.., prim] = L::gather4::<1>(self.rays.directions, ids);
                    L::and_not(v.active, L::eq_u(L::to_bits(prim), L::splat_u(MISS)))
                }
            };
            let mut bits = L::bits(L::and(done, v.active));
            while bits != 0 {
                let place = self.list.from + i + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                std::ptr::swap(self.rays.ids.add(place), self.rays.ids.add(self.done));
                self.done += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests;
