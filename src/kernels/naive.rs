//! The naive step: every active ray against every triangle of the subproblem.

use super::triangle::{CHUNK, Corners, Prepared};
use super::{Item, List, Rays};
use crate::geometry::{Aabb, Triangle};
use crate::simd::{Lanes, MAX_LANES, OnLines, load3};
use glam::Vec3;

/// A vector of active rays.
pub(crate) struct RayVector<L: Lanes> {
    pub active: L::M,
    /// Numbers of the rays.
    pub id: L::U,
    pub inverse: [L::F; 3],
    /// Meaningless where the origin is shared.
    pub origin: [L::F; 3],
    pub direction: [L::F; 3],
    pub tmin: L::F,
    /// Best t so far.
    pub t: L::F,
    /// Best triangle so far; meaningless where [`RayList::found`] looks it up.
    pub prim: L::U,
}

/// A list of active rays, however it is stored.
///
/// # Safety
/// [`RayList::id`] gives numbers of rays of the batch, no two of them equal.
pub(crate) unsafe trait RayList<L: Lanes> {
    fn len(&self) -> usize;
    fn shared_origin(&self) -> Option<Vec3>;

    /// Upper ends of the intervals of some lanes of a vector.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; the vector is one of the list.
    unsafe fn tmax(&self, v: &RayVector<L>, lanes: L::M) -> L::F;

    /// The box around all triangles of the trace.
    fn scene(&self) -> &Aabb;

    /// The vector from place `i` on.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `i` is a multiple of `L::N` below the length.
    unsafe fn load<const SHARED: bool>(&self, i: usize) -> RayVector<L>;

    /// The number of the ray at a place.
    ///
    /// # Safety
    /// The place is below the length.
    unsafe fn id(&self, i: usize) -> u32;

    /// The best triangles so far of some lanes of a vector.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; the vector is one of the list.
    unsafe fn found(&self, v: &RayVector<L>, lanes: L::M) -> L::U;

    /// A new best hit; of any-hit rays only t counts.
    ///
    /// # Safety
    /// `id` is one of the list.
    unsafe fn set<const ANY: bool>(&self, id: u32, t: f32, prim: u32);

    /// Called when a vector of rays has met all triangles, with the best t there is now. From here on
    /// the places up to the end of the vector are not looked at again.
    ///
    /// # Safety
    /// As for [`RayList::load`].
    #[inline(always)]
    unsafe fn finish<const SHARED: bool, const SPECIAL: bool>(
        &mut self,
        _i: usize,
        _v: &RayVector<L>,
        _t: L::F,
    ) {
    }
}

/// Triangles, however they are stored.
pub(crate) trait TriangleList<L: Lanes> {
    fn len(&self) -> usize;

    /// Prepares the (up to [`CHUNK`]) triangles from place `from` on.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `from` is below the length.
    unsafe fn prepare<R: Record<L>>(
        &mut self,
        from: usize,
        to: &mut [Prepared],
        shared_origin: Option<Vec3>,
    );

    /// The triangles, prepared before, if that are all.
    #[inline(always)]
    fn kept(&self) -> Option<&[Prepared]> {
        None
    }

    /// A triangle of the mesh.
    fn triangle(&self, prim: u32) -> &Triangle;
}

/// The best hits of a vector of rays so far.
pub(crate) struct Best<L: Lanes> {
    pub t: L::F,
    /// Meaningless where nothing has changed.
    pub prim: L::U,
    /// Lanes that have found a better hit since they were loaded.
    pub changed: L::M,
}

/// The kernel of record of a precision: whether and where rays hit a triangle, and which of two hits
/// comes first.
pub(crate) trait Record<L: Lanes> {
    /// Whether chunks need what bounds are made of.
    const BOUNDED: bool;
    /// Whether t is compared as it is stored. If not, [`Record::hit`] looks up what was found before.
    const BY_STORED_T: bool;
    /// What [`Record::may_hit`] needs of a vector of rays.
    type Margin: Copy;

    /// # Safety
    /// The processor has `L`'s instruction set.
    unsafe fn margin<const SHARED: bool>(v: &RayVector<L>, rays: &impl RayList<L>) -> Self::Margin;

    /// Lanes that may hit a triangle, wherever along the ray.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    unsafe fn may_hit<const SHARED: bool>(
        of: &Prepared,
        v: &RayVector<L>,
        margin: Self::Margin,
    ) -> L::M;

    /// Takes over the hits of a triangle that come before the best ones so far.
    ///
    /// # Safety
    /// As for [`Record::may_hit`]; the vector is one of `rays`, and the triangle of `triangles`.
    unsafe fn hit<const SHARED: bool, const SPECIAL: bool, const ANY: bool>(
        of: &Prepared,
        v: &RayVector<L>,
        margin: Self::Margin,
        best: &mut Best<L>,
        rays: &impl RayList<L>,
        triangles: &impl TriangleList<L>,
    );
}

/// Intersects a list of rays with triangles and keeps the least (t, prim) of each ray; an any-hit
/// ray that hits gets t = −1, which ends every later test.
///
/// # Safety
/// The processor has `L`'s instruction set, and both lists keep their promises.
#[inline(always)]
pub(crate) unsafe fn naive<
    L: Lanes,
    R: Record<L>,
    const SHARED: bool,
    const SPECIAL: bool,
    const ANY: bool,
>(
    rays: &mut impl RayList<L>,
    mut triangles: impl TriangleList<L>,
) {
    let mut room = [Prepared::ZERO; CHUNK];
    let shared_origin = rays.shared_origin();
    for from in (0..triangles.len()).step_by(CHUNK) {
        let len = (triangles.len() - from).min(CHUNK);
        let last = from + len == triangles.len();
        if triangles.kept().is_none() {
            // SAFETY: as promised; so below.
            unsafe { triangles.prepare::<R>(from, &mut room, shared_origin) };
        }
        let chunk = &triangles.kept().unwrap_or(&room)[..len];
        for i in (0..rays.len()).step_by(L::N) {
            // SAFETY: as above.
            unsafe {
                let v = rays.load::<SHARED>(i);
                let margin = R::margin::<SHARED>(&v, rays);
                let mut best = Best {
                    t: v.t,
                    prim: L::splat_u(0),
                    changed: L::first(0),
                };
                // Two loops: the first has no branch to be mispredicted, the second few rounds.
                let mut candidates = 0u32;
                for (j, of) in chunk.iter().enumerate() {
                    let may = R::may_hit::<SHARED>(of, &v, margin);
                    candidates |= ((L::bits(L::and(may, v.active)) != 0) as u32) << j;
                }
                while candidates != 0 {
                    let j = candidates.trailing_zeros() as usize;
                    candidates &= candidates - 1;
                    let of = chunk.get_unchecked(j);
                    R::hit::<SHARED, SPECIAL, ANY>(of, &v, margin, &mut best, rays, &triangles);
                }
                let Best {
                    t,
                    prim,
                    mut changed,
                } = best;
                if !ANY && R::BY_STORED_T {
                    // Often the very triangle that was hit before, met again. At t = tmax the one before
                    // is a miss's.
                    let tie = L::and(changed, L::eq(t, v.t));
                    if L::bits(tie) != 0 {
                        let before = rays.found(&v, tie);
                        changed = L::and_not(changed, L::and_not(tie, L::lt_u(prim, before)));
                    }
                }
                let mut bits = L::bits(changed);
                if bits != 0 {
                    let mut lane_t = [0f32; MAX_LANES];
                    let mut lane_prim = [0u32; MAX_LANES];
                    L::store(lane_t.as_mut_ptr(), t);
                    L::store_u(lane_prim.as_mut_ptr(), prim);
                    while bits != 0 {
                        let lane = bits.trailing_zeros() as usize;
                        bits &= bits - 1;
                        rays.set::<ANY>(rays.id(i + lane), lane_t[lane], lane_prim[lane]);
                    }
                }
                if last {
                    rays.finish::<SHARED, SPECIAL>(i, &v, t);
                }
            }
        }
    }
}

impl<L: Lanes> Best<L> {
    /// Takes over hits at t where they come before the best so far, by t and prim as they are. What
    /// was found before the vector was loaded is looked at once, in the end.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    pub unsafe fn take<const ANY: bool>(&mut self, mut hit: L::M, t: L::F, prim: u32) {
        // SAFETY: as promised.
        unsafe {
            hit = L::and(hit, L::le(t, self.t));
            if ANY {
                self.t = L::select(hit, L::splat(-1.0), self.t);
            } else {
                let new = L::splat_u(prim);
                let tie = L::and(L::and(hit, self.changed), L::eq(t, self.t));
                hit = L::and_not(hit, L::and_not(tie, L::lt_u(new, self.prim)));
                self.t = L::select(hit, t, self.t);
                self.prim = L::select_u(hit, new, self.prim);
            }
            self.changed = L::or(self.changed, hit);
        }
    }
}

/// A list of copied records.
#[derive(Clone, Copy)]
pub(crate) struct Copied<'a> {
    pub rays: &'a Rays,
    pub list: List,
}

// SAFETY: lists of active rays name rays of the batch, each once.
unsafe impl<L: Lanes> RayList<L> for Copied<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.list.len
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
        let (rays, s) = (self.rays, &self.rays.active);
        let at = self.list.start + i;
        // SAFETY: whole vectors within the streams, as in `filter`; ids are those of rays of the
        // batch where `active` is set.
        unsafe {
            let active = L::first(self.list.len - i);
            let id = L::load_u(s.id.add(at));
            let inverse = load3::<L>(&s.inverse, at);
            let origin = if SHARED {
                inverse
            } else {
                load3::<L>(&s.origin, at)
            };
            // The rays of the vector after next; 5 to 10 % of the time of incoherent batches.
            if rays.ahead {
                for lane in 0..L::N {
                    let next = *s.id.add(at + 2 * L::N + lane) as usize;
                    L::prefetch(rays.directions.wrapping_add(next).cast());
                    L::prefetch(rays.t.wrapping_add(next));
                }
            }
            // What stands behind the list are old ids, so there are directions for them too.
            let [x, y, z, tmin] = L::gather4::<1>(rays.directions, s.id.add(at));
            RayVector {
                active,
                id,
                inverse,
                origin,
                direction: [x, y, z],
                tmin,
                t: L::gather(rays.t, id, active),
                prim: id,
            }
        }
    }

    #[inline(always)]
    unsafe fn id(&self, i: usize) -> u32 {
        // SAFETY: as promised.
        unsafe { *self.rays.active.id.add(self.list.start + i) }
    }

    #[inline(always)]
    unsafe fn found(&self, v: &RayVector<L>, lanes: L::M) -> L::U {
        // SAFETY: as promised.
        unsafe { self.rays.found::<L>(v.id, lanes) }
    }

    #[inline(always)]
    unsafe fn set<const ANY: bool>(&self, id: u32, t: f32, prim: u32) {
        // SAFETY: as promised.
        unsafe { self.rays.set::<ANY>(id, t, prim) }
    }
}

/// Items and the mesh that they are of.
pub(crate) struct Items<'a> {
    pub triangles: &'a [Triangle],
    pub items: &'a [Item],
}

impl<L: Lanes> TriangleList<L> for Items<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.items.len()
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
        let items = &self.items[from..];
        // Corners, one number a triangle.
        let OnLines(rows) = &mut OnLines([[0f32; CHUNK]; 9]);
        let mut prims = [0; CHUNK];
        for (j, item) in items.iter().take(CHUNK).enumerate() {
            let Triangle { a, b, c } = &self.triangles[item.prim() as usize];
            for axis in 0..3 {
                rows[axis][j] = a[axis];
                rows[3 + axis][j] = b[axis];
                rows[6 + axis][j] = c[axis];
            }
            prims[j] = item.prim();
        }
        for at in (0..items.len().min(CHUNK)).step_by(L::N) {
            // SAFETY: as promised; rows are as long as a chunk.
            unsafe {
                let a = row3::<L>(rows, 0, at);
                let b = row3::<L>(rows, 3, at);
                let c = row3::<L>(rows, 6, at);
                let (mut lo, mut hi) = (a, a);
                for axis in 0..3 {
                    lo[axis] = L::min(L::min(a[axis], b[axis]), c[axis]);
                    hi[axis] = L::max(L::max(a[axis], b[axis]), c[axis]);
                }
                let corners = Corners { a, b, c, lo, hi };
                let prim = L::load_u(prims.as_ptr().add(at));
                Prepared::prepare::<L, R>(&mut to[at..], &corners, prim, shared_origin);
            }
        }
    }
}

/// Triangles prepared before.
pub(crate) struct Kept<'a> {
    pub triangles: &'a [Triangle],
    pub kept: &'a [Prepared],
}

impl<L: Lanes> TriangleList<L> for Kept<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.kept.len()
    }

    #[inline(always)]
    fn triangle(&self, prim: u32) -> &Triangle {
        &self.triangles[prim as usize]
    }

    #[inline(always)]
    fn kept(&self) -> Option<&[Prepared]> {
        Some(self.kept)
    }

    #[inline(always)]
    unsafe fn prepare<R: Record<L>>(&mut self, _: usize, _: &mut [Prepared], _: Option<Vec3>) {}
}

/// # Safety
/// The processor has `L`'s instruction set; whole vectors of three rows from `row` on.
#[inline(always)]
unsafe fn row3<L: Lanes>(rows: &[[f32; CHUNK]; 9], row: usize, at: usize) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            L::load(rows[row].as_ptr().add(at)),
            L::load(rows[row + 1].as_ptr().add(at)),
            L::load(rows[row + 2].as_ptr().add(at)),
        ]
    }
}
