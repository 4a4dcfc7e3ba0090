//! Batches in Embree's own structures, to time its functions alone.

use super::threads::BLOCK;
use super::trace::{fill, fill16};
use super::{Query, Scene};
use dacrt::{Batch, Ray};
use embree4_sys as sys;

/// A batch, filled into Embree's structures by [`Scene::pack`]. About 100 bytes a ray.
pub struct Packed {
    lanes: Lanes,
    /// What tracing overwrites, lane by lane.
    tmax: Vec<f32>,
    query: Query,
}

enum Lanes {
    /// Valid rays only.
    Single(Vec<sys::RTCRayHit>),
    Packets(Vec<Packet>),
}

struct Packet {
    valid: sys::Valid16,
    rayhit: sys::RTCRayHit16,
}

impl Packed {
    /// Takes away what tracing wrote. Must come between two calls of [`Scene::trace_packed`], for
    /// a ray that was traced ends at its hit.
    pub fn reset(&mut self) {
        match &mut self.lanes {
            Lanes::Single(rays) => {
                for (rayhit, tmax) in rays.iter_mut().zip(&self.tmax) {
                    rayhit.ray.tfar = *tmax;
                    rayhit.hit.geomID = sys::RTC_INVALID_GEOMETRY_ID;
                }
            }
            Lanes::Packets(packets) => {
                for (Packet { rayhit, .. }, tmax) in packets.iter_mut().zip(self.tmax.chunks(16)) {
                    rayhit.ray.tfar.copy_from_slice(tmax);
                    rayhit.hit.geomID = [sys::RTC_INVALID_GEOMETRY_ID; 16];
                }
            }
        }
    }

    /// Number of rays that hit something in the last nearest-hit trace.
    pub fn hit_count(&self) -> usize {
        let hit = |geom: &&u32| **geom != sys::RTC_INVALID_GEOMETRY_ID;
        match &self.lanes {
            Lanes::Single(rays) => rays.iter().map(|r| &r.hit.geomID).filter(hit).count(),
            Lanes::Packets(packets) => {
                let lanes = packets.iter().flat_map(|p| &p.rayhit.hit.geomID);
                lanes.filter(hit).count()
            }
        }
    }
}

impl Scene {
    /// Fills the batch into the structures that a query of this scene takes.
    pub fn pack(&self, batch: &Batch, query: Query) -> Packed {
        let mut tmax = Vec::with_capacity(batch.len().next_multiple_of(16));
        let lanes = if query == Query::Single {
            let mut rays = Vec::with_capacity(batch.len());
            for ray in batch.iter().filter(Ray::is_valid) {
                let mut rayhit = sys::RTCRayHit::default();
                fill(&mut rayhit.ray, &ray, self.robust());
                rays.push(rayhit);
                tmax.push(ray.tmax);
            }
            Lanes::Single(rays)
        } else {
            let mut packets = Vec::with_capacity(batch.len().div_ceil(16));
            for start in (0..batch.len()).step_by(16) {
                let mut rayhit = sys::RTCRayHit16::default();
                let valid = fill16(&mut rayhit.ray, batch, start, self.robust());
                tmax.extend(rayhit.ray.tfar);
                packets.push(Packet { valid, rayhit });
            }
            Lanes::Packets(packets)
        };
        Packed { lanes, tmax, query }
    }

    /// Calls Embree for each ray or packet and does nothing else: nearest hits, or any hit. The device's
    /// threads take blocks of 4,096 rays.
    pub fn trace_packed(&self, packed: &mut Packed, any: bool) {
        let (scene, flags) = (self.committed(), packed.query.flags());
        match &mut packed.lanes {
            Lanes::Single(rays) => (self.threads()).deal(rays.chunks_mut(BLOCK), |rays| {
                let mut nearest = sys::RTCIntersectArguments::new(flags);
                let mut occluded = sys::RTCOccludedArguments::new(flags);
                for rayhit in rays {
                    // SAFETY: the scene is committed; the structures are alive and large enough.
                    unsafe {
                        if any {
                            sys::rtcOccluded1(scene.handle(), &mut rayhit.ray, &mut occluded);
                        } else {
                            sys::rtcIntersect1(scene.handle(), rayhit, &mut nearest);
                        }
                    }
                }
            }),
            Lanes::Packets(packets) => {
                let blocks = packets.chunks_mut(BLOCK / 16);
                self.threads().deal(blocks, |packets| {
                    let mut nearest = sys::RTCIntersectArguments::new(flags);
                    let mut occluded = sys::RTCOccludedArguments::new(flags);
                    for Packet { valid, rayhit } in packets {
                        let (valid, scene) = (valid.0.as_ptr(), scene.handle());
                        // SAFETY: as above, and both are aligned to 64 bytes.
                        unsafe {
                            if any {
                                sys::rtcOccluded16(valid, scene, &mut rayhit.ray, &mut occluded);
                            } else {
                                sys::rtcIntersect16(valid, scene, rayhit, &mut nearest);
                            }
                        }
                    }
                });
            }
        }
    }
}
