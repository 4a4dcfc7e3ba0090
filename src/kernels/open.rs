//! Lanes that float32 leaves open, one at a time: float64 with bounds and exact arithmetic
//! ([`crate::exact`]) decide.

use super::naive::{RayList, RayVector};
use crate::exact::{self, Meeting};
use crate::geometry::Triangle;
use crate::simd::{Lanes, MAX_LANES};
use glam::Vec3;
use std::cmp::Ordering;

/// A vector of rays, lane by lane.
pub(super) struct OpenLanes {
    origin: [[f32; MAX_LANES]; 3],
    direction: [[f32; MAX_LANES]; 3],
    tmin: [f32; MAX_LANES],
}

impl OpenLanes {
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    pub unsafe fn new<L: Lanes, const SHARED: bool>(
        v: &RayVector<L>,
        rays: &impl RayList<L>,
    ) -> OpenLanes {
        let mut lanes = OpenLanes {
            origin: [[0.0; MAX_LANES]; 3],
            direction: [[0.0; MAX_LANES]; 3],
            tmin: [0.0; MAX_LANES],
        };
        // SAFETY: as promised.
        unsafe {
            for axis in 0..3 {
                L::store(lanes.direction[axis].as_mut_ptr(), v.direction[axis]);
                match rays.shared_origin() {
                    Some(o) if SHARED => lanes.origin[axis] = [o[axis]; MAX_LANES],
                    _ => L::store(lanes.origin[axis].as_mut_ptr(), v.origin[axis]),
                }
            }
            L::store(lanes.tmin.as_mut_ptr(), v.tmin);
        }
        lanes
    }

    /// Where the ray of a lane hits a triangle behind its tmin and no later than tmax, at a t that
    /// float32 can hold.
    #[cold]
    #[inline(never)]
    pub fn until(&self, lane: usize, triangle: &Triangle, tmax: f32) -> Option<f32> {
        let meeting = self.meet(lane, triangle)?;
        let in_time = meeting.cmp_t(tmax) != Ordering::Greater;
        Some(meeting.rounded()).filter(|t| in_time && t.is_finite())
    }

    /// Where it hits a triangle before another one that it is known to hit, or as early if its own
    /// number is the `lower` one.
    #[cold]
    #[inline(never)]
    pub fn before(
        &self,
        lane: usize,
        triangle: &Triangle,
        known: &Triangle,
        lower: bool,
    ) -> Option<f32> {
        let meeting = self.meet(lane, triangle)?;
        let (origin, direction) = (at(&self.origin, lane), at(&self.direction, lane));
        let closer = match meeting.cmp(&Meeting::known(origin, direction, known)) {
            Ordering::Less => true,
            Ordering::Equal => lower,
            Ordering::Greater => false,
        };
        closer.then(|| meeting.rounded())
    }

    fn meet(&self, lane: usize, triangle: &Triangle) -> Option<Meeting> {
        let (origin, direction) = (at(&self.origin, lane), at(&self.direction, lane));
        let meeting = exact::meet(origin, direction, triangle)?;
        (meeting.cmp_t(self.tmin[lane]) == Ordering::Greater).then_some(meeting)
    }
}

fn at(of: &[[f32; MAX_LANES]; 3], lane: usize) -> Vec3 {
    Vec3::new(of[0][lane], of[1][lane], of[2][lane])
}
