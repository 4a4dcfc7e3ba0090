//! Batches in Embree's own structures, to time its functions alone.

use super::packets::{self, EIGHT, FOUR, Functions, Lanes, SIXTEEN};
use super::threads::BLOCK;
use super::trace::fill;
use super::{Query, Scene};
use dacrt::{Batch, Ray};
use embree4_sys as sys;

/// A batch, filled into Embree's structures by [`Scene::pack`]. About 100 bytes a ray.
pub struct Packed {
    rays: Box<dyn Structures>,
    query: Query,
}

impl Packed {
    /// Takes away what tracing wrote. Must come between two calls of [`Scene::trace_packed`], for
    /// a ray that was traced ends at its hit.
    pub fn reset(&mut self) {
        self.rays.reset();
    }

    /// Number of rays that hit something in the last nearest-hit trace.
    pub fn hit_count(&self) -> usize {
        self.rays.hit_count()
    }
}

impl Scene {
    /// Fills the batch into the structures that a query of this scene takes.
    pub fn pack(&self, batch: &Batch, query: Query) -> Packed {
        let robust = self.robust();
        let rays: Box<dyn Structures> = match query.packet() {
            None => Box::new(Singles::new(batch, robust)),
            Some(Lanes::Four) => Box::new(Packets::new(&FOUR, batch, robust)),
            Some(Lanes::Eight) => Box::new(Packets::new(&EIGHT, batch, robust)),
            Some(Lanes::Sixteen) => Box::new(Packets::new(&SIXTEEN, batch, robust)),
        };
        Packed { rays, query }
    }

    /// Calls Embree for each ray or packet and does nothing else: nearest hits, or any hit. The device's
    /// threads take blocks of 4,096 rays.
    pub fn trace_packed(&self, packed: &mut Packed, any: bool) {
        packed.rays.trace(self, packed.query.flags(), any);
    }
}

/// Rays as a query takes them.
trait Structures {
    fn reset(&mut self);
    fn hit_count(&self) -> usize;
    fn trace(&mut self, scene: &Scene, flags: sys::RTCRayQueryFlags, any: bool);
}

/// Valid rays, one by one.
struct Singles {
    rays: Vec<sys::RTCRayHit>,
    /// What tracing overwrites.
    tmax: Vec<f32>,
}

impl Singles {
    fn new(batch: &Batch, robust: bool) -> Singles {
        let structure = |ray: Ray| {
            let mut rayhit = sys::RTCRayHit::default();
            fill(&mut rayhit.ray, &ray, robust);
            (rayhit, ray.tmax)
        };
        let (rays, tmax) = batch.iter().filter(Ray::is_valid).map(structure).unzip();
        Singles { rays, tmax }
    }
}

impl Structures for Singles {
    fn reset(&mut self) {
        for (rayhit, tmax) in self.rays.iter_mut().zip(&self.tmax) {
            rayhit.ray.tfar = *tmax;
            rayhit.hit.geomID = sys::RTC_INVALID_GEOMETRY_ID;
        }
    }

    fn hit_count(&self) -> usize {
        (self.rays.iter()).filter(|r| is_hit(&r.hit.geomID)).count()
    }

    fn trace(&mut self, scene: &Scene, flags: sys::RTCRayQueryFlags, any: bool) {
        let committed = scene.committed();
        scene.threads().deal(self.rays.chunks_mut(BLOCK), |rays| {
            let mut nearest = sys::RTCIntersectArguments::new(flags);
            let mut occluded = sys::RTCOccludedArguments::new(flags);
            for rayhit in rays {
                // SAFETY: the scene is committed; the structures are alive and large enough.
                unsafe {
                    if any {
                        sys::rtcOccluded1(committed.handle(), &mut rayhit.ray, &mut occluded);
                    } else {
                        sys::rtcIntersect1(committed.handle(), rayhit, &mut nearest);
                    }
                }
            }
        });
    }
}

/// All rays, N at a time.
struct Packets<const N: usize> {
    functions: &'static Functions<N>,
    packets: Vec<Packet<N>>,
    /// What tracing overwrites.
    tmax: Vec<[f32; N]>,
}

struct Packet<const N: usize> {
    valid: sys::Valid<N>,
    rayhit: sys::RTCRayHits<N>,
}

impl<const N: usize> Packets<N> {
    fn new(functions: &'static Functions<N>, batch: &Batch, robust: bool) -> Packets<N> {
        let packet = |start| {
            let mut rayhit = sys::RTCRayHits::default();
            let valid = packets::fill(&mut rayhit.ray, batch, start, robust);
            let tmax = rayhit.ray.tfar;
            (Packet { valid, rayhit }, tmax)
        };
        let (packets, tmax) = (0..batch.len()).step_by(N).map(packet).unzip();
        Packets {
            functions,
            packets,
            tmax,
        }
    }
}

impl<const N: usize> Structures for Packets<N> {
    fn reset(&mut self) {
        for (Packet { rayhit, .. }, tmax) in self.packets.iter_mut().zip(&self.tmax) {
            rayhit.ray.tfar = *tmax;
            rayhit.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; N];
        }
    }

    fn hit_count(&self) -> usize {
        let lanes = self.packets.iter().flat_map(|p| &p.rayhit.hit.geomID);
        lanes.filter(|geom| is_hit(geom)).count()
    }

    fn trace(&mut self, scene: &Scene, flags: sys::RTCRayQueryFlags, any: bool) {
        let (committed, functions) = (scene.committed(), self.functions);
        let blocks = self.packets.chunks_mut(BLOCK / N);
        scene.threads().deal(blocks, |packets| {
            let mut nearest = sys::RTCIntersectArguments::new(flags);
            let mut occluded = sys::RTCOccludedArguments::new(flags);
            for Packet { valid, rayhit } in packets {
                let (valid, scene) = (valid.0.as_ptr(), committed.handle());
                // SAFETY: the scene is committed; the structures are alive, aligned and large enough.
                unsafe {
                    if any {
                        (functions.occluded)(valid, scene, &mut rayhit.ray, &mut occluded);
                    } else {
                        (functions.intersect)(valid, scene, rayhit, &mut nearest);
                    }
                }
            }
        });
    }
}

fn is_hit(geom: &u32) -> bool {
    *geom != sys::RTC_INVALID_GEOMETRY_ID
}
