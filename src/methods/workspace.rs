//! All memory of a trace, made beforehand.

use super::split::Candidates;
use crate::kernels::{Item, Samples};
use crate::rays::active::ActiveRays;

/// Memory for traces of up to a number of rays and triangles; reused from trace to trace.
///
/// [`Workspace::bytes`] is 104 a ray + 64 a triangle + a constant of about 0.72 MB (exactly: see
/// [`Workspace::bytes_for`]). A trace allocates nothing beyond it.
pub struct Workspace {
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

impl Workspace {
    /// Memory for batches of up to `rays` rays and meshes of up to `triangles` triangles.
    ///
    /// # Panics
    /// If there are more than 10⁹ rays.
    pub fn new(rays: usize, triangles: usize) -> Workspace {
        // Gathers take places of records, of which there are twice as many, as signed 32-bit numbers.
        assert!(rays <= 1_000_000_000, "a batch has at most 10^9 rays");
        Workspace {
            active: ActiveRays::new(rays),
            directions: vec![[0.0; 4]; rays],
            t: vec![0.0; rays],
            items: vec![Item::ZERO; triangles],
            item_scratch: vec![Item::ZERO; triangles],
            candidates: Candidates::boxed(),
            samples: Samples::boxed(),
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        Workspace::bytes_for(self.active.rays(), self.items.len())
    }

    /// Bytes that a workspace for so many rays and triangles takes: 84 a ray, with the rays rounded
    /// up to a multiple of 16, + 20 a ray + 64 a triangle + `bytes_for(0, 0)`.
    pub fn bytes_for(rays: usize, triangles: usize) -> usize {
        ActiveRays::bytes(rays)
            + rays * size_of::<[f32; 5]>()
            + 2 * triangles * size_of::<Item>()
            + size_of::<Candidates>()
            + size_of::<Samples>()
    }
}
