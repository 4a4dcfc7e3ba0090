//! The naive step: every active ray against every triangle of the subproblem.

use super::triangle::Prepared;
use super::{Item, List, Rays};
use crate::geometry::Triangle;
use crate::simd::{Lanes, load3};

/// Triangles whose constants are held ready at a time.
const CHUNK: usize = 16;

/// Intersects a list of rays with triangles and keeps the least (t, prim) of each ray; an any-hit
/// ray that hits gets t = −1, which ends every later test.
///
/// # Safety
/// The processor has `L`'s instruction set; `rays` keeps its promises; `list` is a list of it; the
/// items are of `triangles`.
#[inline(always)]
pub(crate) unsafe fn naive<L: Lanes, const SHARED: bool, const SPECIAL: bool, const ANY: bool>(
    rays: &Rays,
    list: List,
    triangles: &[Triangle],
    items: &[Item],
) {
    let mut chunk = [Prepared::ZERO; CHUNK];
    for items in items.chunks(CHUNK) {
        for (prepared, item) in chunk.iter_mut().zip(items) {
            let triangle = &triangles[item.prim() as usize];
            *prepared = Prepared::new(triangle, item, rays.shared_origin);
        }
        let chunk = &chunk[..items.len()];
        for i in (0..list.len).step_by(L::N) {
            let (at, left) = (list.start + i, list.len - i);
            // SAFETY: whole vectors within the streams, as in `filter`; ids are those of rays of
            // the batch where `active` is set.
            unsafe {
                let s = &rays.active;
                let active = L::first(left);
                let id = L::load_u(s.id.add(at));
                let inverse = load3::<L>(&s.inverse, at);
                let origin = if SHARED {
                    inverse
                } else {
                    load3::<L>(&s.origin, at)
                };
                // The rays of the vector after next; 5 to 10 % of the time of incoherent batches.
                for lane in 0..L::N {
                    let next = *s.id.add(at + 2 * L::N + lane) as usize;
                    L::prefetch(rays.directions.wrapping_add(next).cast());
                    L::prefetch(rays.t.wrapping_add(next));
                }
                // What stands behind the list are old ids, so there are directions for them too.
                let [x, y, z, tmin] = L::gather4(rays.directions, s.id.add(at));
                let direction = [x, y, z];
                let mut t = L::gather(rays.t, id, active);
                let mut prim = L::splat_u(0);
                let mut changed = L::first(0);
                for triangle in chunk {
                    let (mut hit, t_hit) = triangle.intersect::<L, SHARED, SPECIAL>(
                        &origin,
                        &direction,
                        &inverse,
                        rays.shared_origin,
                        tmin,
                        t,
                        active,
                    );
                    if L::bits(hit) == 0 {
                        continue;
                    }
                    if ANY {
                        t = L::select(hit, L::splat(-1.0), t);
                    } else {
                        let new = L::splat_u(triangle.prim);
                        let tie = L::and(hit, L::eq(t_hit, t));
                        if L::bits(tie) != 0 {
                            // Of equal t the lowest prim wins; at t = tmax the old one is a miss's.
                            let found_before = L::gather_u(rays.prim, id, L::and_not(tie, changed));
                            let old = L::select_u(changed, prim, found_before);
                            hit = L::and_not(hit, L::and_not(tie, L::lt_u(new, old)));
                        }
                        t = L::select(hit, t_hit, t);
                        prim = L::select_u(hit, new, prim);
                    }
                    changed = L::or(changed, hit);
                }
                let mut bits = L::bits(changed);
                if bits != 0 {
                    let mut lane_t = [0f32; crate::simd::MAX_LANES];
                    let mut lane_prim = [0u32; crate::simd::MAX_LANES];
                    L::store(lane_t.as_mut_ptr(), t);
                    L::store_u(lane_prim.as_mut_ptr(), prim);
                    while bits != 0 {
                        let lane = bits.trailing_zeros() as usize;
                        bits &= bits - 1;
                        let ray = *s.id.add(at + lane) as usize;
                        *rays.t.add(ray) = lane_t[lane];
                        if !ANY {
                            *rays.prim.add(ray) = lane_prim[lane];
                        }
                    }
                }
            }
        }
    }
}
