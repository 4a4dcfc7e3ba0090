//! The face of the engine: a method, ready to trace batches.

use super::divide::Divide;
use super::{Counters, Parameters, Workspace};
use crate::geometry::Mesh;
use crate::kernels::{Kernels, List, Rays};
use crate::rays::{Batch, Hits, MISS};
use crate::simd::Isa;

/// Finds the hits of whole batches.
///
/// The hits are a function of mesh and batch alone: not of method, parameters, seed or
/// instruction set.
#[derive(Clone, Copy, Debug)]
pub struct Tracer {
    parameters: Parameters,
    isa: Isa,
    seed: u64,
    audit: bool,
    own_origins: bool,
}

/// What a trace was like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trace {
    /// Numbers of tests and decisions.
    pub counters: Counters,
    /// Whether all valid rays have the same origin, to the bit.
    pub shared_origin: bool,
    /// Rays that take no part; see [`crate::Ray::is_valid`].
    pub invalid_rays: u64,
}

impl Tracer {
    /// A tracer for the fastest instruction set at hand, with seed 0.
    ///
    /// # Panics
    /// If a parameter is outside its range; see [`Parameters::check`].
    pub fn new(parameters: Parameters) -> Tracer {
        if let Err(bad) = parameters.check() {
            panic!("{bad}");
        }
        Tracer {
            parameters,
            isa: Isa::best(),
            seed: 0,
            audit: false,
            own_origins: false,
        }
    }

    /// With another instruction set. The hits and counters stay the same.
    ///
    /// # Panics
    /// If this processor does not have it.
    pub fn with_isa(self, isa: Isa) -> Tracer {
        assert!(isa.is_available(), "this processor has no {isa}");
        Tracer { isa, ..self }
    }

    /// With another seed for the choice of sample rays. The hits stay the same.
    pub fn with_seed(self, seed: u64) -> Tracer {
        Tracer { seed, ..self }
    }

    /// Whether to count [`Counters::skipped_rays_that_miss`], which costs about what skipping saves:
    /// not for timing.
    pub fn with_audit(self, audit: bool) -> Tracer {
        Tracer { audit, ..self }
    }

    /// Whether to take the rays for ones with origins of their own even if they share one: for a part
    /// of a batch whose origins differ, traced apart.
    pub fn with_own_origins(self, own_origins: bool) -> Tracer {
        Tracer {
            own_origins,
            ..self
        }
    }

    /// Finds the nearest hit of every ray: the least (t, prim), misses as [`Hits`] has them.
    ///
    /// Allocates nothing.
    ///
    /// # Panics
    /// If the workspace is too small for the batch or the mesh, or `hits` has another length than
    /// the batch.
    pub fn nearest(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        hits: &mut Hits,
    ) -> Trace {
        let lengths = [hits.t.len(), hits.prim.len()];
        assert_eq!(lengths, [batch.len(); 2], "one hit record a ray");
        hits.prim.fill(MISS);
        let (t, prim) = (hits.t.as_mut_ptr(), hits.prim.as_mut_ptr());
        let trace = self.trace(mesh, batch, workspace, t, Some(prim));
        for (t, &prim) in hits.t.iter_mut().zip(&hits.prim) {
            *t = if prim == MISS { f32::INFINITY } else { *t };
        }
        trace
    }

    /// Finds for every ray whether it hits anything: 1 if it does, 0 if not.
    ///
    /// Allocates nothing.
    ///
    /// # Panics
    /// If the workspace is too small for the batch or the mesh, or `occluded` has another length
    /// than the batch.
    pub fn any(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        occluded: &mut [u8],
    ) -> Trace {
        assert_eq!(occluded.len(), batch.len(), "one byte a ray");
        let t = workspace.t.as_mut_ptr();
        let trace = self.trace(mesh, batch, workspace, t, None);
        for (occluded, &t) in occluded.iter_mut().zip(&workspace.t) {
            *occluded = (t == OCCLUDED) as u8;
        }
        trace
    }

    /// `t` is good for a float a ray, `prim` for an integer a ray; without it any hit will do.
    fn trace(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        t: *mut f32,
        prim: Option<*mut u32>,
    ) -> Trace {
        let n = batch.len();
        let lengths = batch
            .origin
            .iter()
            .chain(&batch.direction)
            .chain([&batch.tmin, &batch.tmax]);
        assert!(
            lengths.into_iter().all(|v| v.len() == n),
            "streams of one length"
        );
        assert!(
            n <= workspace.active.rays(),
            "the workspace is too small for {n} rays"
        );
        let triangles = mesh.len();
        assert!(
            triangles <= workspace.items.len(),
            "the workspace is too small for {triangles} triangles"
        );

        let kernels = Kernels::of(self.isa);
        let (active, scratch) = workspace.active.streams();
        let mut rays = Rays {
            active,
            scratch,
            directions: workspace.directions.as_mut_ptr(),
            t,
            prim: prim.unwrap_or(std::ptr::null_mut()),
            shared_origin: match self.own_origins {
                true => None,
                // SAFETY: `Kernels::of` has checked the processor; so for all that follow.
                false => unsafe { (kernels.shared_origin)(batch) },
            },
            special: false,
            least_tmin: 0.0,
            any_hit: prim.is_none(),
        };
        // SAFETY: the workspace has room for the batch.
        let prepared = unsafe { (kernels.prepare_rays)(batch, &rays) };
        rays.special = prepared.special;
        rays.least_tmin = prepared.least_tmin;
        // SAFETY: as above.
        let (items, bounds) =
            unsafe { (kernels.prepare_triangles)(mesh, &mut workspace.items[..triangles]) };

        let mut divide = Divide {
            kernels,
            parameters: &self.parameters,
            seed: self.seed,
            audit: self.audit,
            rays,
            triangles: mesh.triangles(),
            items: &mut workspace.items[..items],
            item_scratch: &mut workspace.item_scratch[..items],
            candidates: &mut workspace.candidates,
            samples: &mut workspace.samples,
            capacity: crate::rays::active::ActiveRays::capacity(workspace.active.rays()),
            counters: Counters::default(),
        };
        divide.start(
            bounds.bounds(),
            List {
                start: 0,
                len: prepared.valid,
            },
        );
        Trace {
            counters: divide.counters,
            shared_origin: rays.shared_origin.is_some(),
            invalid_rays: (n - prepared.valid) as u64,
        }
    }
}

/// The best t of an any-hit ray that has hit: below every tmin, so that no test passes any more.
const OCCLUDED: f32 = -1.0;
