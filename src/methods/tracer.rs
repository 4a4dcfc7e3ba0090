//! The face of the engine: a method, ready to trace batches.

use super::job::{Answer, Job, Trace};
use super::object::{Log, NodeRecord};
use super::observer::Observer;
use super::stored::{Sent, Stored};
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
        self.trace(
            mesh,
            batch,
            workspace,
            Answer::Nearest(hits),
            Observer::default(),
        )
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
        self.trace(
            mesh,
            batch,
            workspace,
            Answer::Any(occluded),
            Observer::default(),
        )
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
        self.watch(mesh, batch, workspace, Answer::Nearest(hits), ray)
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
        self.watch(mesh, batch, workspace, Answer::Any(occluded), ray)
    }

    /// As [`Tracer::nearest`] by `afra2012` or `nabata2013`, and each node as it was split, or solved.
    ///
    /// Tests all rays of each node against all candidates: some 60 times the time. Allocates the records.
    ///
    /// # Panics
    /// As [`Tracer::nearest`], and if it is another method.
    pub fn log_nearest(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        hits: &mut Hits,
    ) -> (Trace, Vec<NodeRecord>) {
        self.log(mesh, batch, workspace, Answer::Nearest(hits))
    }

    /// As [`Tracer::any`], and each node; see [`Tracer::log_nearest`].
    ///
    /// # Panics
    /// As [`Tracer::any`], and if it is another method.
    pub fn log_any(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        occluded: &mut [u8],
    ) -> (Trace, Vec<NodeRecord>) {
        self.log(mesh, batch, workspace, Answer::Any(occluded))
    }

    /// As [`Tracer::nearest`], and the splits that were made.
    ///
    /// Allocates the tree.
    ///
    /// # Panics
    /// As [`Tracer::nearest`].
    pub fn store_nearest(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        hits: &mut Hits,
    ) -> (Trace, Stored) {
        self.store(mesh, batch, workspace, Answer::Nearest(hits))
    }

    /// As [`Tracer::any`], and the splits that were made; see [`Tracer::store_nearest`].
    ///
    /// # Panics
    /// As [`Tracer::store_nearest`].
    pub fn store_any(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        occluded: &mut [u8],
    ) -> (Trace, Stored) {
        self.store(mesh, batch, workspace, Answer::Any(occluded))
    }

    /// Finds the hits by the splits of a trace of the same mesh by the same tracer, with the same kernels,
    /// without making any; the batch is the same, too, but for [`Sent::Onward`].
    ///
    /// # Panics
    /// As [`Tracer::nearest`]; and if the splits are those of another kind of method, or the mesh has another
    /// number of triangles; if rays are sent [`Sent::Onward`] through a tree of cells, or otherwise than
    /// [`Sent::Together`] through one of conic packets or of `best`; and it may if rays of another batch are
    /// sent through one of `best`. Elsewhere these take longer, and may lose their hits where cells are split.
    pub fn send_nearest(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        hits: &mut Hits,
        through: (&Stored, Sent),
    ) -> Trace {
        let observer = Observer {
            sent: Some(through),
            ..Default::default()
        };
        self.trace(mesh, batch, workspace, Answer::Nearest(hits), observer)
    }

    /// As [`Tracer::send_nearest`], whether each ray hits anything.
    ///
    /// # Panics
    /// As [`Tracer::send_nearest`].
    pub fn send_any(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        occluded: &mut [u8],
        through: (&Stored, Sent),
    ) -> Trace {
        let observer = Observer {
            sent: Some(through),
            ..Default::default()
        };
        self.trace(mesh, batch, workspace, Answer::Any(occluded), observer)
    }

    fn store(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        answer: Answer,
    ) -> (Trace, Stored) {
        let mut stored = Stored::new();
        let observer = Observer {
            stored: Some(&mut stored),
            ..Default::default()
        };
        let trace = self.trace(mesh, batch, workspace, answer, observer);
        (trace, stored)
    }

    fn watch(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        answer: Answer,
        ray: usize,
    ) -> (Trace, Vec<Step>) {
        let mut watch = Watch {
            id: ray as u32,
            ray: OneRay {
                ray: batch.ray(ray),
                shared_origin: None,
                least_tmin: 0.0,
                precision: self.precision,
            },
            steps: Vec::new(),
        };
        let observer = Observer {
            watch: Some(&mut watch),
            ..Default::default()
        };
        let trace = self.trace(mesh, batch, workspace, answer, observer);
        (trace, watch.steps)
    }

    fn log(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        answer: Answer,
    ) -> (Trace, Vec<NodeRecord>) {
        let is_logged = matches!(self.parameters, Parameters::Object(_));
        assert!(is_logged, "nodes are those of afra2012 and nabata2013");
        let mut log = Log::new();
        let observer = Observer {
            log: Some(&mut log),
            ..Default::default()
        };
        let trace = self.trace(mesh, batch, workspace, answer, observer);
        (trace, log.records)
    }

    fn trace(
        &self,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
        answer: Answer,
        mut observer: Observer,
    ) -> Trace {
        let n = batch.len();
        match &answer {
            Answer::Nearest(hits) => {
                let lengths = [hits.t.len(), hits.prim.len()];
                assert_eq!(lengths, [n; 2], "one hit record a ray");
            }
            Answer::Any(occluded) => assert_eq!(occluded.len(), n, "one byte a ray"),
        }
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
        if let Some(watch) = &mut observer.watch {
            watch.ray.shared_origin = job.shared_origin;
        }
        if let Some(stored) = &mut observer.stored {
            stored.mesh = mesh.len();
        }
        if let Some((stored, _)) = observer.sent {
            assert_eq!(stored.mesh, mesh.len(), "the mesh that the splits are of");
        }
        match (&self.parameters, memory) {
            (Parameters::Object(p), Memory::Object(memory)) => {
                object::trace(&job, p, memory, answer, observer)
            }
            (Parameters::Space(p), Memory::Space(memory)) => {
                space::trace(&job, p, memory, answer, observer)
            }
            (Parameters::Best(p), Memory::Best(memory)) => {
                best::trace(&job, p, memory, self.threads, answer, observer)
            }
            _ => panic!("the workspace is for another kind of method"),
        }
    }
}
