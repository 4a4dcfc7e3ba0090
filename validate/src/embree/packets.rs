//! Packets: consecutive rays that Embree traces in one call.

use super::scene::Committed;
use super::trace::{record, tnear};
use dacrt::Batch;
use embree4_sys as sys;

/// Rays of a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Lanes {
    Four,
    Eight,
    Sixteen,
}

/// Embree's functions for packets of N rays. Those wider than its vectors go ray by ray.
pub(super) struct Functions<const N: usize> {
    pub intersect: sys::IntersectPacket<N>,
    pub occluded: sys::OccludedPacket<N>,
}

pub(super) static FOUR: Functions<4> = Functions {
    intersect: sys::rtcIntersect4,
    occluded: sys::rtcOccluded4,
};
pub(super) static EIGHT: Functions<8> = Functions {
    intersect: sys::rtcIntersect8,
    occluded: sys::rtcOccluded8,
};
pub(super) static SIXTEEN: Functions<16> = Functions {
    intersect: sys::rtcIntersect16,
    occluded: sys::rtcOccluded16,
};

impl<const N: usize> Functions<N> {
    /// Nearest hits of the rays from `from` on.
    pub fn nearest(
        &self,
        scene: &Committed,
        batch: &Batch,
        flags: sys::RTCRayQueryFlags,
        from: usize,
        t: &mut [f32],
        prim: &mut [u32],
    ) {
        let mut args = sys::RTCIntersectArguments::new(flags);
        let mut rayhit = sys::RTCRayHits::default();
        let records = t.chunks_mut(N).zip(prim.chunks_mut(N));
        for (start, (t, prim)) in (from..).step_by(N).zip(records) {
            let valid = fill(&mut rayhit.ray, batch, start, scene.robust);
            rayhit.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; N];
            // SAFETY: the scene is committed; the structures are alive, aligned and large enough.
            unsafe {
                (self.intersect)(valid.0.as_ptr(), scene.handle(), &mut rayhit, &mut args);
            }
            let hit = &rayhit.hit;
            for (i, (t, prim)) in t.iter_mut().zip(prim).enumerate() {
                (*t, *prim) = record(hit.geomID[i], hit.primID[i], rayhit.ray.tfar[i]);
            }
        }
    }

    /// Whether the rays from `from` on hit anything.
    pub fn any(
        &self,
        scene: &Committed,
        batch: &Batch,
        flags: sys::RTCRayQueryFlags,
        from: usize,
        occluded: &mut [u8],
    ) {
        let mut args = sys::RTCOccludedArguments::new(flags);
        let mut rays = sys::RTCRays::default();
        for (start, occluded) in (from..).step_by(N).zip(occluded.chunks_mut(N)) {
            let valid = fill(&mut rays, batch, start, scene.robust);
            // SAFETY: the scene is committed; the structures are alive and aligned.
            unsafe {
                (self.occluded)(valid.0.as_ptr(), scene.handle(), &mut rays, &mut args);
            }
            for (i, occluded) in occluded.iter_mut().enumerate() {
                // An invalid ray may have come with an infinite negative tmax of its own.
                *occluded = u8::from(valid.0[i] != 0) & u8::from(rays.tfar[i] < 0.0);
            }
        }
    }
}

/// N rays of the batch from `start` on, and which of them are valid; past the batch's end there are
/// lanes that are not.
pub(super) fn fill<const N: usize>(
    rays: &mut sys::RTCRays<N>,
    batch: &Batch,
    start: usize,
    robust: bool,
) -> sys::Valid<N> {
    [rays.org_x, rays.org_y, rays.org_z] = [0, 1, 2].map(|axis| some(&batch.origin[axis], start));
    [rays.dir_x, rays.dir_y, rays.dir_z] =
        [0, 1, 2].map(|axis| some(&batch.direction[axis], start));
    let tmin: [f32; N] = some(&batch.tmin, start);
    rays.tfar = some(&batch.tmax, start);
    rays.tnear = tmin.map(|tmin| tnear(tmin, robust));

    // `Ray::is_valid` without branches, so that it is done for several lanes at a time.
    let finite = |x: f32| x.abs() < f32::INFINITY;
    sys::Valid(std::array::from_fn(|i| {
        let (x, y, z) = (rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]);
        let origin = finite(rays.org_x[i]) & finite(rays.org_y[i]) & finite(rays.org_z[i]);
        let direction = finite(x) & finite(y) & finite(z) & ((x != 0.0) | (y != 0.0) | (z != 0.0));
        let interval = (tmin[i] >= 0.0) & (tmin[i] < rays.tfar[i]);
        -i32::from(origin & direction & interval)
    }))
}

/// N values from `start` on, filled up with zeros at the end.
fn some<const N: usize>(values: &[f32], start: usize) -> [f32; N] {
    if let Some(all) = values.get(start..start + N) {
        return all.try_into().expect("N values");
    }
    let mut some = [0.0; N];
    some[..values.len() - start].copy_from_slice(&values[start..]);
    some
}

#[cfg(test)]
mod tests {
    use super::*;
    use dacrt::Ray;
    use glam::Vec3;

    #[test]
    fn active_lanes_are_the_valid_rays() {
        active_lanes_are_valid::<4>();
        active_lanes_are_valid::<8>();
        active_lanes_are_valid::<16>();
    }

    fn active_lanes_are_valid<const N: usize>() {
        let special = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            1e-45,
            f32::MAX,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        let mut batch = Batch::default();
        for a in special {
            for b in special {
                let (usual, odd) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(a, b, 0.0));
                for axis in 0..3 {
                    let mut turned = odd;
                    turned.as_mut().rotate_right(axis);
                    batch.push(Ray::new(turned, usual));
                    batch.push(Ray::new(usual, turned));
                }
                batch.push(Ray {
                    tmin: a,
                    tmax: b,
                    ..Ray::new(usual, usual)
                });
            }
        }
        assert_ne!(batch.len() % N, 0, "the last block is to be a partial one");
        let mut rays = sys::RTCRays::<N>::default();
        for start in (0..batch.len()).step_by(N) {
            let valid = fill(&mut rays, &batch, start, true);
            for i in 0..N {
                let active = valid.0[i] == -1;
                let here = start + i;
                let expected = here < batch.len() && batch.ray(here).is_valid();
                assert_eq!(active, expected, "lane {here}");
                if active {
                    assert_eq!(rays.tnear[i], batch.tmin[here].next_up());
                }
            }
        }
    }
}
