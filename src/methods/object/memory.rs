//! The memory of a trace that splits lists of triangles.

use super::split::Candidates;
use crate::kernels::{Item, Samples};
use crate::rays::active::ActiveRays;
use crate::room;

/// Memory for traces of up to a number of rays and triangles.
pub(in crate::methods) struct Memory {
    pub(super) active: ActiveRays,
    /// Direction and tmin of each ray.
    pub(super) directions: Vec<[f32; 4]>,
    /// Best t so far of any-hit rays.
    pub(super) t: Vec<f32>,
    pub(super) items: Vec<Item>,
    pub(super) item_scratch: Vec<Item>,
    pub(super) candidates: Box<Candidates>,
    pub(super) samples: Box<Samples>,
}

impl Memory {
    pub fn new(rays: usize, triangles: usize) -> Memory {
        Memory {
            active: ActiveRays::new(rays),
            directions: room([0.0; 4], rays),
            t: room(0.0, rays),
            items: room(Item::ZERO, triangles),
            item_scratch: room(Item::ZERO, triangles),
            candidates: Candidates::boxed(),
            samples: Samples::boxed(),
        }
    }

    pub fn bytes(rays: usize, triangles: usize) -> usize {
        ActiveRays::bytes(rays)
            + rays * size_of::<[f32; 5]>()
            + 2 * triangles * size_of::<Item>()
            + size_of::<Candidates>()
            + size_of::<Samples>()
    }
}
