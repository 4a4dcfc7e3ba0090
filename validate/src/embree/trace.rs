//! Nearest and any hit of a batch, from our arrays to our arrays.

use super::Scene;
use super::packets::{EIGHT, FOUR, Lanes, SIXTEEN};
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
    /// `rtcIntersect4` to `rtcIntersect16` and `rtcOccluded4` to `rtcOccluded16`, so many consecutive
    /// rays a call.
    Packet(Lanes),
    /// The same, told that the rays are coherent.
    CoherentPacket(Lanes),
}

impl Query {
    /// Those with packets of this width.
    pub const fn all(packet: Lanes) -> [Query; 3] {
        [
            Query::Single,
            Query::Packet(packet),
            Query::CoherentPacket(packet),
        ]
    }

    /// `1`, `16` or `16_coherent`, as in result files.
    pub fn name(self) -> &'static str {
        match self {
            Query::Single => "1",
            Query::Packet(Lanes::Four) => "4",
            Query::Packet(Lanes::Eight) => "8",
            Query::Packet(Lanes::Sixteen) => "16",
            Query::CoherentPacket(Lanes::Four) => "4_coherent",
            Query::CoherentPacket(Lanes::Eight) => "8_coherent",
            Query::CoherentPacket(Lanes::Sixteen) => "16_coherent",
        }
    }

    /// Width of the packets; `None` for single rays.
    pub(super) fn packet(self) -> Option<Lanes> {
        match self {
            Query::Single => None,
            Query::Packet(lanes) | Query::CoherentPacket(lanes) => Some(lanes),
        }
    }

    pub(super) fn flags(self) -> sys::RTCRayQueryFlags {
        match self {
            Query::Single | Query::Packet(_) => sys::RTCRayQueryFlags::INCOHERENT,
            Query::CoherentPacket(_) => sys::RTCRayQueryFlags::COHERENT,
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
        let flags = query.flags();
        match query.packet() {
            None => nearest1(self, batch, flags, from, t, prim),
            Some(Lanes::Four) => FOUR.nearest(self, batch, flags, from, t, prim),
            Some(Lanes::Eight) => EIGHT.nearest(self, batch, flags, from, t, prim),
            Some(Lanes::Sixteen) => SIXTEEN.nearest(self, batch, flags, from, t, prim),
        }
    }

    fn any_from(&self, batch: &Batch, query: Query, from: usize, occluded: &mut [u8]) {
        let flags = query.flags();
        match query.packet() {
            None => any1(self, batch, flags, from, occluded),
            Some(Lanes::Four) => FOUR.any(self, batch, flags, from, occluded),
            Some(Lanes::Eight) => EIGHT.any(self, batch, flags, from, occluded),
            Some(Lanes::Sixteen) => SIXTEEN.any(self, batch, flags, from, occluded),
        }
    }
}

/// Nearest hits of the rays from `from` on, one by one.
fn nearest1(
    scene: &Committed,
    batch: &Batch,
    flags: sys::RTCRayQueryFlags,
    from: usize,
    t: &mut [f32],
    prim: &mut [u32],
) {
    let mut args = sys::RTCIntersectArguments::new(flags);
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

/// Whether the rays from `from` on hit anything, one by one.
fn any1(
    scene: &Committed,
    batch: &Batch,
    flags: sys::RTCRayQueryFlags,
    from: usize,
    occluded: &mut [u8],
) {
    let mut args = sys::RTCOccludedArguments::new(flags);
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
pub(super) fn tnear(tmin: f32, robust: bool) -> f32 {
    f32::from_bits(tmin.abs().to_bits() + u32::from(robust))
}

pub(super) fn fill(lane: &mut sys::RTCRay, ray: &Ray, robust: bool) {
    [lane.org_x, lane.org_y, lane.org_z] = ray.origin.to_array();
    [lane.dir_x, lane.dir_y, lane.dir_z] = ray.direction.to_array();
    lane.tnear = tnear(ray.tmin, robust);
    lane.tfar = ray.tmax;
}
