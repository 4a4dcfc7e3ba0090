//! The memory of a trace that splits space.

use crate::kernels::{Cones, LEAST_PACKET, RayRecords, TriangleLists};
use crate::rays::Batch;
use crate::simd::MAX_LANES;
use glam::Vec3;

/// Memory for traces of up to a number of rays and triangles.
pub(in crate::methods) struct Memory {
    spans: [Vec<[f32; 2]>; 3],
    rest: Vec<[f32; 4]>,
    triangle_ids: Vec<u32>,
    /// Inverse direction and best t, direction and best triangle, origin of each ray.
    slabs: Vec<[f32; 4]>,
    directions: Vec<[f32; 4]>,
    origins: Vec<[f32; 4]>,
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
        let spans = || vec![[0.0; 2]; triangles];
        let records = || vec![[0.0; 4]; rays];
        let cones = most_cones(rays);
        Memory {
            spans: [spans(), spans(), spans()],
            rest: vec![[0.0; 4]; triangles],
            triangle_ids: vec![0; triangles + MAX_LANES],
            slabs: records(),
            directions: records(),
            origins: records(),
            ray_ids: vec![0; rays + MAX_LANES],
            cones: vec![[0.0; 4]; cones],
            cone_rays: vec![[0; 2]; cones],
            cone_ids: vec![0; cones + MAX_LANES],
            done: vec![0; rays / 64 + 2],
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
            + 3 * MAX_LANES * size_of::<u32>()
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
    pub(super) fn rays(
        &mut self,
        batch: &Batch,
        shared_origin: Option<Vec3>,
        any_hit: bool,
    ) -> RayRecords {
        RayRecords {
            slabs: self.slabs.as_mut_ptr(),
            directions: self.directions.as_mut_ptr(),
            origins: self.origins.as_mut_ptr(),
            tmin: batch.tmin.as_ptr(),
            ids: self.ray_ids.as_mut_ptr(),
            shared_origin,
            special: false,
            least_tmin: 0.0,
            one_tmin: false,
            any_hit,
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

    /// Best t and triangle of the rays in their order.
    pub(super) fn best(&self) -> impl Iterator<Item = (f32, u32)> + '_ {
        let records = self.slabs.iter().zip(&self.directions);
        records.map(|(slab, direction)| (slab[3], direction[3].to_bits()))
    }
}
