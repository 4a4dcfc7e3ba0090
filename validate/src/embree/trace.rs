//! Nearest and any hit of a batch, from our arrays to our arrays.

use super::Scene;
use super::scene::Committed;
use super::threads::{BLOCK, Threads};
use dacrt::rays::MISS;
use dacrt::{Batch, Hits, Ray};
use embree4_sys as sys;

/// Which of Embree's functions traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Query {
    /// `rtcIntersect1` and `rtcOccluded1`.
    Single,
    /// `rtcIntersect16` and `rtcOccluded16`, 16 consecutive rays a call.
    Packet16,
    /// The same, told that the rays are coherent.
    Packet16Coherent,
}

impl Query {
    /// All of them.
    pub const ALL: [Query; 3] = [Query::Single, Query::Packet16, Query::Packet16Coherent];

    /// `1`, `16` or `16_coherent`, as in result files.
    pub fn name(self) -> &'static str {
        match self {
            Query::Single => "1",
            Query::Packet16 => "16",
            Query::Packet16Coherent => "16_coherent",
        }
    }

    pub(super) fn flags(self) -> sys::RTCRayQueryFlags {
        match self {
            Query::Single | Query::Packet16 => sys::RTCRayQueryFlags::INCOHERENT,
            Query::Packet16Coherent => sys::RTCRayQueryFlags::COHERENT,
        }
    }
}

impl Scene {
    /// Nearest hits of all rays; of hits at the same distance Embree's choice. Rays that are not
    /// valid never reach Embree and miss. The device's threads take blocks of 4,096 rays.
    ///
    /// Filling Embree's structures and reading the hits back is part of this, as every user of
    /// batches pays it.
    ///
    /// # Panics
    /// If there are not as many hits as rays.
    pub fn nearest(&self, batch: &Batch, query: Query, hits: &mut Hits) {
        self.nearest_by(self.threads(), batch, query, hits);
    }

    /// Whether each ray hits anything: 1 for yes, 0 for no. Rays that are not valid never reach
    /// Embree and hit nothing. The device's threads take blocks of 4,096 rays.
    ///
    /// Filling Embree's structures and reading the answers back is part of this, as every user of
    /// batches pays it.
    ///
    /// # Panics
    /// If there are not as many answers as rays.
    pub fn any(&self, batch: &Batch, query: Query, occluded: &mut [u8]) {
        self.any_by(self.threads(), batch, query, occluded);
    }

    /// As [`Scene::nearest`], ray by ray, with a thread on each processor whatever threads the device
    /// has: for what is not timed.
    ///
    /// # Panics
    /// If there are not as many hits as rays.
    pub fn nearest_untimed(&self, batch: &Batch, hits: &mut Hits) {
        self.nearest_by(&Threads::All, batch, Query::Single, hits);
    }

    /// As [`Scene::any`], ray by ray, with a thread on each processor whatever threads the device has:
    /// for what is not timed.
    ///
    /// # Panics
    /// If there are not as many answers as rays.
    pub fn any_untimed(&self, batch: &Batch, occluded: &mut [u8]) {
        self.any_by(&Threads::All, batch, Query::Single, occluded);
    }

    fn nearest_by(&self, threads: &Threads, batch: &Batch, query: Query, hits: &mut Hits) {
        assert_eq!(hits.len(), batch.len(), "one hit record a ray");
        let scene = self.committed();
        let records = hits.t.chunks_mut(BLOCK).zip(hits.prim.chunks_mut(BLOCK));
        let blocks = (0..).step_by(BLOCK).zip(records);
        threads.deal(blocks, |(from, (t, prim))| {
            scene.nearest_from(batch, query, from, t, prim);
        });
    }

    fn any_by(&self, threads: &Threads, batch: &Batch, query: Query, occluded: &mut [u8]) {
        assert_eq!(occluded.len(), batch.len(), "one answer a ray");
        let scene = self.committed();
        let blocks = (0..).step_by(BLOCK).zip(occluded.chunks_mut(BLOCK));
        threads.deal(blocks, |(from, occluded)| {
            scene.any_from(batch, query, from, occluded);
        });
    }
}

impl Committed<'_> {
    /// As [`Scene::nearest`], on the thread that calls, whatever threads the device has.
    ///
    /// # Panics
    /// If there are not as many hits as rays.
    pub fn nearest(&self, batch: &Batch, query: Query, hits: &mut Hits) {
        assert_eq!(hits.len(), batch.len(), "one hit record a ray");
        self.nearest_from(batch, query, 0, &mut hits.t, &mut hits.prim);
    }

    /// As [`Scene::any`], on the thread that calls, whatever threads the device has.
    ///
    /// # Panics
    /// If there are not as many answers as rays.
    pub fn any(&self, batch: &Batch, query: Query, occluded: &mut [u8]) {
        assert_eq!(occluded.len(), batch.len(), "one answer a ray");
        self.any_from(batch, query, 0, occluded);
    }

    fn nearest_from(
        &self,
        batch: &Batch,
        query: Query,
        from: usize,
        t: &mut [f32],
        prim: &mut [u32],
    ) {
        let trace = match query {
            Query::Single => nearest1,
            Query::Packet16 | Query::Packet16Coherent => nearest16,
        };
        trace(self, batch, query, from, t, prim);
    }

    fn any_from(&self, batch: &Batch, query: Query, from: usize, occluded: &mut [u8]) {
        let trace = match query {
            Query::Single => any1,
            Query::Packet16 | Query::Packet16Coherent => any16,
        };
        trace(self, batch, query, from, occluded);
    }
}

/// Nearest hits of the rays from `from` on, one by one.
fn nearest1(
    scene: &Committed,
    batch: &Batch,
    query: Query,
    from: usize,
    t: &mut [f32],
    prim: &mut [u32],
) {
    let mut args = sys::RTCIntersectArguments::new(query.flags());
    let mut rayhit = sys::RTCRayHit::default();
    for (i, (t, prim)) in (from..).zip(t.iter_mut().zip(prim)) {
        let ray = batch.ray(i);
        (*t, *prim) = (f32::INFINITY, MISS);
        if ray.is_valid() {
            fill(&mut rayhit.ray, &ray, scene.robust);
            rayhit.hit.geomID = sys::RTC_INVALID_GEOMETRY_ID;
            // SAFETY: the scene is committed; the structures are alive and large enough.
            unsafe { sys::rtcIntersect1(scene.handle(), &mut rayhit, &mut args) };
            let (hit, at) = (rayhit.hit, rayhit.ray.tfar);
            (*t, *prim) = record(hit.geomID, hit.primID, at);
        }
    }
}

/// Nearest hits of the rays from `from` on, 16 at a time.
fn nearest16(
    scene: &Committed,
    batch: &Batch,
    query: Query,
    from: usize,
    t: &mut [f32],
    prim: &mut [u32],
) {
    let mut args = sys::RTCIntersectArguments::new(query.flags());
    let mut rayhit = sys::RTCRayHit16::default();
    let records = t.chunks_mut(16).zip(prim.chunks_mut(16));
    for (start, (t, prim)) in (from..).step_by(16).zip(records) {
        let valid = fill16(&mut rayhit.ray, batch, start, scene.robust);
        rayhit.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; 16];
        // SAFETY: the scene is committed; the structures are alive, aligned and large enough.
        unsafe {
            sys::rtcIntersect16(valid.0.as_ptr(), scene.handle(), &mut rayhit, &mut args);
        }
        let hit = &rayhit.hit;
        for (i, (t, prim)) in t.iter_mut().zip(prim).enumerate() {
            (*t, *prim) = record(hit.geomID[i], hit.primID[i], rayhit.ray.tfar[i]);
        }
    }
}

/// Whether the rays from `from` on hit anything, one by one.
fn any1(scene: &Committed, batch: &Batch, query: Query, from: usize, occluded: &mut [u8]) {
    let mut args = sys::RTCOccludedArguments::new(query.flags());
    let mut lane = sys::RTCRay::default();
    for (i, occluded) in (from..).zip(occluded) {
        let ray = batch.ray(i);
        *occluded = 0;
        if ray.is_valid() {
            fill(&mut lane, &ray, scene.robust);
            // SAFETY: the scene is committed; the structures are alive.
            unsafe { sys::rtcOccluded1(scene.handle(), &mut lane, &mut args) };
            *occluded = u8::from(lane.tfar == f32::NEG_INFINITY);
        }
    }
}

/// Whether the rays from `from` on hit anything, 16 at a time.
fn any16(scene: &Committed, batch: &Batch, query: Query, from: usize, occluded: &mut [u8]) {
    let mut args = sys::RTCOccludedArguments::new(query.flags());
    let mut lanes = sys::RTCRay16::default();
    for (start, occluded) in (from..).step_by(16).zip(occluded.chunks_mut(16)) {
        let valid = fill16(&mut lanes, batch, start, scene.robust);
        // SAFETY: the scene is committed; the structures are alive and aligned.
        unsafe {
            sys::rtcOccluded16(valid.0.as_ptr(), scene.handle(), &mut lanes, &mut args);
        }
        for (i, occluded) in occluded.iter_mut().enumerate() {
            // An invalid ray may have come with an infinite negative tmax of its own.
            *occluded = u8::from(valid.0[i] != 0) & u8::from(lanes.tfar[i] < 0.0);
        }
    }
}

/// Our record of what Embree left in a lane. Overflow can make a hit of infinite or undefined t,
/// which is none; NaN fails the comparison.
pub(super) fn record(geom: u32, prim: u32, t: f32) -> (f32, u32) {
    let hit = (geom != sys::RTC_INVALID_GEOMETRY_ID) & (t < f32::INFINITY);
    if hit {
        (t, prim)
    } else {
        (f32::INFINITY, MISS)
    }
}

/// Our lower end is exclusive, and so is Embree's in default mode. In robust mode Embree's is
/// inclusive: there it gets the next float. For `tmin >= 0`, which all valid rays have.
fn tnear(tmin: f32, robust: bool) -> f32 {
    f32::from_bits(tmin.abs().to_bits() + u32::from(robust))
}

pub(super) fn fill(lane: &mut sys::RTCRay, ray: &Ray, robust: bool) {
    [lane.org_x, lane.org_y, lane.org_z] = ray.origin.to_array();
    [lane.dir_x, lane.dir_y, lane.dir_z] = ray.direction.to_array();
    lane.tnear = tnear(ray.tmin, robust);
    lane.tfar = ray.tmax;
}

/// Rays `start` to `start + 16` of the batch, and which of them are valid; past the batch's end
/// there are lanes that are not.
pub(super) fn fill16(
    lanes: &mut sys::RTCRay16,
    batch: &Batch,
    start: usize,
    robust: bool,
) -> sys::Valid16 {
    [lanes.org_x, lanes.org_y, lanes.org_z] =
        [0, 1, 2].map(|axis| sixteen(&batch.origin[axis], start));
    [lanes.dir_x, lanes.dir_y, lanes.dir_z] =
        [0, 1, 2].map(|axis| sixteen(&batch.direction[axis], start));
    let tmin = sixteen(&batch.tmin, start);
    lanes.tfar = sixteen(&batch.tmax, start);
    lanes.tnear = tmin.map(|tmin| tnear(tmin, robust));

    // `Ray::is_valid` without branches, so that it is done for several lanes at a time.
    let finite = |x: f32| x.abs() < f32::INFINITY;
    sys::Valid16(std::array::from_fn(|i| {
        let (x, y, z) = (lanes.dir_x[i], lanes.dir_y[i], lanes.dir_z[i]);
        let origin = finite(lanes.org_x[i]) & finite(lanes.org_y[i]) & finite(lanes.org_z[i]);
        let direction = finite(x) & finite(y) & finite(z) & ((x != 0.0) | (y != 0.0) | (z != 0.0));
        let interval = (tmin[i] >= 0.0) & (tmin[i] < lanes.tfar[i]);
        -i32::from(origin & direction & interval)
    }))
}

/// 16 values from `start` on, filled up with zeros at the end.
fn sixteen(values: &[f32], start: usize) -> [f32; 16] {
    if let Some(all) = values.get(start..start + 16) {
        return all.try_into().expect("16 values");
    }
    let mut some = [0.0; 16];
    some[..values.len() - start].copy_from_slice(&values[start..]);
    some
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn active_lanes_are_the_valid_rays() {
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
        assert_ne!(batch.len() % 16, 0, "the last block is to be a partial one");
        let mut lanes = sys::RTCRay16::default();
        for start in (0..batch.len()).step_by(16) {
            let valid = fill16(&mut lanes, &batch, start, true);
            for i in 0..16 {
                let active = valid.0[i] == -1;
                let here = start + i;
                let expected = here < batch.len() && batch.ray(here).is_valid();
                assert_eq!(active, expected, "lane {here}");
                if active {
                    assert_eq!(lanes.tnear[i], batch.tmin[here].next_up());
                }
            }
        }
    }
}
