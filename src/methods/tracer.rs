//! The face of the engine: a method, ready to trace batches.

use super::job::{Answer, Job, Trace};
use super::watch::{Step, Watch};
use super::workspace::Memory;
use super::{Parameters, Precision, Workspace, best, object, space};
use crate::geometry::Mesh;
use crate::kernels::{Kernels, OneRay};
use crate::rays::{Batch, Hits};
use crate::simd::Isa;

/// Finds the hits of whole batches.
///
/// The hits are a function of mesh, batch and precision alone: not of method, parameters, seed or
/// instruction set.
#[derive(Clone, Copy, Debug)]
pub struct Tracer {
    parameters: Parameters,
    isa: Isa,
    precision: Precision,
    seed: u64,
    audit: bool,
    own_origins: bool,
    threads: usize,
}

impl Tracer {
    /// A tracer for the fastest instruction set at hand, with seed 0.
    ///
    /// # Panics
    /// If a parameter is outside its range; see [`Parameters::check`].
    pub fn new(parameters: impl Into<Parameters>) -> Tracer {
        let parameters = parameters.into();
        if let Err(bad) = parameters.check() {
            panic!("{bad}");
        }
        Tracer {
            parameters,
            isa: Isa::best(),
            precision: Precision::Fast,
            seed: 0,
            audit: false,
            own_origins: false,
            threads: 1,
        }
    }

    /// Memory for traces of up to so many rays and triangles.
    ///
    /// # Panics
    /// If there are more than 10⁹ rays.
    pub fn workspace(&self, rays: usize, triangles: usize) -> Workspace {
        Workspace::for_threads(&self.parameters, rays, triangles, self.threads)
    }

    /// With another instruction set. The hits and counters stay the same.
    ///
    /// # Panics
    /// If this processor does not have it.
    pub fn with_isa(self, isa: Isa) -> Tracer {
        assert!(isa.is_available(), "this processor has no {isa}");
        Tracer { isa, ..self }
    }

    /// With so many threads, at least 1. Only [`best`](Parameters::takes_threads) has use for more than one;
    /// other methods trace with one. The hits stay the same to the bit, the counters do not quite.
    pub fn with_threads(self, threads: usize) -> Tracer {
        Tracer {
            threads: threads.max(1),
            ..self
        }
    }

    /// With another precision, which the hits depend on.
    pub fn with_precision(self, precision: Precision) -> Tracer {
        Tracer { precision, ..self }
    }

    /// With another seed for the choice of sample rays. The hits stay the same.
    pub fn with_seed(self, seed: u64) -> Tracer {
        Tracer { seed, ..self }
    }

    /// Whether to count [`Counters::skipped_rays_that_miss`](super::Counters::skipped_rays_that_miss), which costs about what skipping saves:
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
    /// Allocates nothing with one thread; what queues of more need is allocated as they are used.
    ///
    /// # Panics
    /// If the workspace is too small for the batch, the mesh or the threads, or for another kind of
    /// method, or `hits` has another length than the batch.
    pub fn nearest(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        hits: &mut Hits,
    ) -> Trace {
        let lengths = [hits.t.len(), hits.prim.len()];
        assert_eq!(lengths, [batch.len(); 2], "one hit record a ray");
        self.trace(mesh, batch, workspace, Answer::Nearest(hits), None)
            .0
    }

    /// Finds for every ray whether it hits anything: 1 if it does, 0 if not.
    ///
    /// Allocates nothing with one thread; what queues of more need is allocated as they are used.
    ///
    /// # Panics
    /// If the workspace is too small for the batch, the mesh or the threads, or for another kind of
    /// method, or `occluded` has another length than the batch.
    pub fn any(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        occluded: &mut [u8],
    ) -> Trace {
        assert_eq!(occluded.len(), batch.len(), "one byte a ray");
        self.trace(mesh, batch, workspace, Answer::Any(occluded), None)
            .0
    }

    /// As [`Tracer::nearest`], and what becomes of one ray, step by step; no step for an invalid ray.
    ///
    /// Looks for the ray in the list of each node: up to twice the time. Allocates the steps. Traces with
    /// one thread.
    ///
    /// # Panics
    /// As [`Tracer::nearest`], and if there is no such ray.
    pub fn watch_nearest(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        hits: &mut Hits,
        ray: usize,
    ) -> (Trace, Vec<Step>) {
        let lengths = [hits.t.len(), hits.prim.len()];
        assert_eq!(lengths, [batch.len(); 2], "one hit record a ray");
        self.trace(mesh, batch, workspace, Answer::Nearest(hits), Some(ray))
    }

    /// As [`Tracer::any`], and what becomes of one ray; see [`Tracer::watch_nearest`].
    ///
    /// # Panics
    /// As [`Tracer::any`], and if there is no such ray.
    pub fn watch_any(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        occluded: &mut [u8],
        ray: usize,
    ) -> (Trace, Vec<Step>) {
        assert_eq!(occluded.len(), batch.len(), "one byte a ray");
        self.trace(mesh, batch, workspace, Answer::Any(occluded), Some(ray))
    }

    fn trace(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        answer: Answer,
        watched: Option<usize>,
    ) -> (Trace, Vec<Step>) {
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
        let memory = workspace.memory(n, mesh.len(), self.threads);
        let kernels = Kernels::of(self.isa);
        let job = Job {
            kernels,
            mesh,
            batch,
            shared_origin: match self.own_origins {
                true => None,
                // SAFETY: `Kernels::of` has checked the processor.
                false => unsafe { (kernels.shared_origin)(batch) },
            },
            precision: self.precision,
            seed: self.seed,
            audit: self.audit,
        };
        let mut watch = watched.map(|ray| Watch {
            id: ray as u32,
            ray: OneRay {
                ray: batch.ray(ray),
                shared_origin: job.shared_origin,
                least_tmin: 0.0,
                precision: self.precision,
            },
            steps: Vec::new(),
        });
        let trace = match (&self.parameters, memory) {
            (Parameters::Object(p), Memory::Object(memory)) => {
                object::trace(&job, p, memory, answer, watch.as_mut())
            }
            (Parameters::Space(p), Memory::Space(memory)) => {
                space::trace(&job, p, memory, answer, watch.as_mut())
            }
            (Parameters::Best(p), Memory::Best(memory)) => {
                best::trace(&job, p, memory, self.threads, answer, watch.as_mut())
            }
            _ => panic!("the workspace is for another kind of method"),
        };
        (trace, watch.map_or(Vec::new(), |watch| watch.steps))
    }
}
