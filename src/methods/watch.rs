//! What becomes of one ray in a trace, step by step.

use crate::geometry::{Aabb, Triangle};
use crate::kernels::{OneRay, TriangleTest};

/// A step of one ray: a box that it came to, or a leaf.
#[derive(Clone, Debug)]
pub struct Step {
    /// How many splits there are above the box; 0 for that of the whole scene.
    pub depth: u32,
    /// The box of a node, or the cell.
    pub bounds: Aabb,
    /// Triangles of the subproblem; where the ray does not enter a cell, of the one that this is half
    /// of.
    pub triangles: usize,
    /// Active rays (or cones) that the box was held against.
    pub rays: usize,
    /// The padded slab interval of the ray in the box, from the least tmin of the batch on; empty if
    /// the first number is greater than the second.
    pub interval: [f32; 2],
    /// Best t until then, and its triangle ([`MISS`](crate::MISS) if there is none, and for any-hit
    /// rays). At first t is the ray's tmax; an occluded any-hit ray has −1. In precision `exact` t is
    /// a little later than the hit.
    pub best: (f32, u32),
    /// What happened.
    pub event: Event,
}

/// What happened to a ray at a box.
#[derive(Clone, Debug)]
pub enum Event {
    /// It goes on.
    Kept,
    /// The filter took it out: the interval is empty or begins behind the best t.
    Rejected,
    /// It goes on untested, for so many of the sample rays meet the box (Nabata 2013, section 4.4).
    Skipped {
        /// The intersection ratio.
        ratio: f32,
    },
    /// It goes on with its cone (Mora 2011, section 3.3).
    KeptWithCone,
    /// Its cone does not meet the box.
    RejectedWithCone,
    /// It goes on with its group (`best`).
    KeptWithGroup,
    /// Its group does not meet the box, or each of its rays hits something nearer.
    RejectedWithGroup,
    /// The ray meets the cell, in which there is no triangle.
    Empty,
    /// The naive step: all triangles of the leaf.
    Leaf(Vec<TriangleTest>),
    /// It is done, for it hits something before it leaves the cell (Mora 2011, section 3.2).
    Terminated,
}

/// Where a ray comes to.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub depth: u32,
    pub bounds: Aabb,
    pub triangles: usize,
}

/// Watches one ray.
pub(super) struct Watch {
    pub id: u32,
    pub ray: OneRay,
    pub steps: Vec<Step>,
}

impl Watch {
    /// Rays come to a box; nothing happens if the one that is watched is not among them.
    #[cold]
    pub fn box_of(
        &mut self,
        place: Place,
        among: &[u32],
        best: (f32, u32),
        event: impl FnOnce(u32) -> Event,
    ) {
        if among.contains(&self.id) {
            self.push(place, among.len(), best, event(self.id));
        }
    }

    /// Rays come to a leaf with these triangles of the mesh.
    #[cold]
    pub fn leaf(
        &mut self,
        place: Place,
        among: &[u32],
        best: (f32, u32),
        mesh: &[Triangle],
        prims: impl Iterator<Item = u32>,
    ) {
        if among.contains(&self.id) {
            let tests = prims.map(|prim| self.ray.test(prim, &mesh[prim as usize]));
            let tests = Event::Leaf(tests.collect());
            self.push(place, among.len(), best, tests);
        }
    }

    pub fn push(&mut self, place: Place, rays: usize, best: (f32, u32), event: Event) {
        let Place {
            depth,
            bounds,
            triangles,
        } = place;
        self.steps.push(Step {
            depth,
            bounds,
            triangles,
            rays,
            interval: self.ray.interval(&bounds),
            best,
            event,
        });
    }
}
