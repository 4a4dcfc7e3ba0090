//! The memory of a trace that splits space.

use crate::geometry::Aabb;
use crate::kernels::{Cones, LEAST_PACKET, RAYS_AHEAD, RayRecords, Tmax, TriangleLists};
use crate::methods::job::Job;
use crate::room;
use crate::simd::MAX_LANES;

/// Two records in one cache line.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
struct Pair([[f32; 4]; 2]);

/// Memory for traces of up to a number of rays and triangles.
pub(in crate::methods) struct Memory {
    spans: [Vec<[f32; 2]>; 3],
    rest: Vec<[f32; 4]>,
    triangle_ids: Vec<u32>,
    /// Inverse direction and best t of each ray, and where it is its own, its origin.
    slabs: Vec<Pair>,
    /// Direction and best triangle of each ray.
    directions: Vec<[f32; 4]>,
    ray_ids: Vec<u32>,
    cones: Vec<[f32; 4]>,
    cone_rays: Vec<[u32; 2]>,
    cone_ids: Vec<u32>,
    done: Vec<u64>,
}

/// The most cones that so many rays make.
fn most_cones(rays: usize) -> usize {
    rays / LEAST_PACKET + 1
}

impl Memory {
    pub fn new(rays: usize, triangles: usize) -> Memory {
        let spans = || room([0.0; 2], triangles);
        let cones = most_cones(rays);
        Memory {
            spans: [spans(), spans(), spans()],
            rest: room([0.0; 4], triangles),
            triangle_ids: room(0, triangles + MAX_LANES),
            slabs: room(Pair([[0.0; 4]; 2]), rays),
            directions: room([0.0; 4], rays),
            ray_ids: room(0, rays + RAYS_AHEAD),
            cones: room([0.0; 4], cones),
            cone_rays: room([0; 2], cones),
            cone_ids: room(0, cones + MAX_LANES),
            done: room(0, rays / 64 + 2),
        }
    }

    pub fn bytes(rays: usize, triangles: usize) -> usize {
        let a_triangle = 3 * size_of::<[f32; 2]>() + size_of::<[f32; 4]>() + size_of::<u32>();
        let a_ray = 3 * size_of::<[f32; 4]>() + size_of::<u32>();
        let a_cone = size_of::<[f32; 4]>() + size_of::<[u32; 2]>() + size_of::<u32>();
        let words = rays / 64 + 2;
        triangles * a_triangle
            + rays * a_ray
            + most_cones(rays) * a_cone
            + words * size_of::<u64>()
            + (2 * MAX_LANES + RAYS_AHEAD) * size_of::<u32>()
    }

    /// The lists of triangles.
    pub(super) fn lists(&mut self) -> TriangleLists {
        TriangleLists {
            spans: self.spans.each_mut().map(|list| list.as_mut_ptr()),
            rest: self.rest.as_mut_ptr(),
            ids: self.triangle_ids.as_mut_ptr(),
        }
    }

    /// The records of rays, of which nothing is known yet.
    pub(super) fn rays(&mut self, job: &Job, any_hit: bool) -> RayRecords {
        RayRecords {
            slabs: self.slabs.as_mut_ptr().cast(),
            directions: self.directions.as_mut_ptr(),
            tmin: job.batch.tmin.as_ptr(),
            ids: self.ray_ids.as_mut_ptr(),
            shared_origin: job.shared_origin,
            special: false,
            least_tmin: 0.0,
            one_tmin: false,
            any_hit,
            precision: job.precision,
            tmax: Tmax::of(job.batch),
            scene: Aabb::EMPTY,
        }
    }

    /// The cones.
    pub(super) fn cones(&mut self) -> Cones {
        Cones {
            cones: self.cones.as_mut_ptr(),
            rays: self.cone_rays.as_mut_ptr(),
            ids: self.cone_ids.as_mut_ptr(),
            done: self.done.as_mut_ptr(),
        }
    }

    /// Best t and triangle of the rays in their order, after a trace of a batch that shares its origin
    /// or not.
    pub(super) fn best(&self, shared_origin: bool) -> impl Iterator<Item = (f32, u32)> + '_ {
        // SAFETY: a pair is two records.
        let slabs = unsafe {
            std::slice::from_raw_parts(self.slabs.as_ptr().cast::<[f32; 4]>(), 2 * self.slabs.len())
        };
        let records = slabs.iter().step_by(if shared_origin { 1 } else { 2 });
        let records = records.zip(&self.directions);
        records.map(|(slab, direction)| (slab[3], direction[3].to_bits()))
    }
}
