//! One trace: the first pass over rays and triangles, then the recursion.

use super::divide::Divide;
use super::{Memory, ObjectParameters};
use crate::geometry::Aabb;
use crate::kernels::{List, Rays, Tmax};
use crate::methods::Counters;
use crate::methods::job::{Answer, Job, OCCLUDED, Trace};
use crate::methods::observer::Observer;
use crate::rays::MISS;
use crate::rays::active::ActiveRays;

/// Traces a batch by splitting lists of triangles.
pub(in crate::methods) fn trace(
    job: &Job,
    parameters: &ObjectParameters,
    memory: &mut Memory,
    mut answer: Answer,
    observer: Observer,
) -> Trace {
    let (n, kernels) = (job.batch.len(), job.kernels);
    let Observer {
        mut watch,
        log,
        stored,
        sent,
    } = observer;
    let (t, prim) = match &mut answer {
        Answer::Nearest(hits) => {
            hits.prim.fill(MISS);
            (hits.t.as_mut_ptr(), hits.prim.as_mut_ptr())
        }
        Answer::Any(_) => (memory.t.as_mut_ptr(), std::ptr::null_mut()),
    };
    let (active, scratch) = memory.active.streams();
    let mut rays = Rays {
        active,
        scratch,
        directions: memory.directions.as_mut_ptr(),
        t,
        prim,
        shared_origin: job.shared_origin,
        special: false,
        least_tmin: 0.0,
        any_hit: matches!(answer, Answer::Any(_)),
        precision: job.precision,
        tmax: Tmax::of(job.batch),
        ahead: true,
        scene: Aabb::EMPTY,
    };
    // SAFETY: the processor was checked; the memory has room for the batch.
    let prepared = unsafe { (kernels.prepare_rays)(job.batch, &rays) };
    rays.special = prepared.special;
    rays.least_tmin = prepared.least_tmin;
    rays.tmax.one = prepared.one_tmax;
    let items = &mut memory.items[..job.mesh.len()];
    // SAFETY: as above.
    let (items, bounds) = unsafe { (kernels.prepare_triangles)(job.mesh, 0, items) };
    rays.scene = bounds.bounds();
    if let Some(watch) = &mut watch {
        watch.ray.least_tmin = rays.least_tmin;
    }

    let mut divide = Divide {
        kernels,
        parameters,
        seed: job.seed,
        audit: job.audit,
        rays,
        triangles: job.mesh.triangles(),
        items: &mut memory.items[..items],
        item_scratch: &mut memory.item_scratch[..items],
        candidates: &mut memory.candidates,
        samples: &mut memory.samples,
        capacity: ActiveRays::capacity(memory.active.rays()),
        counters: Counters::default(),
        watch,
        log,
        stored,
    };
    let root = List {
        start: 0,
        len: prepared.valid,
    };
    match sent {
        None => divide.start(rays.scene, root),
        Some((stored, how)) => divide.send(stored, root, how),
    }
    let counters = divide.counters;
    match answer {
        Answer::Nearest(hits) => {
            for (t, &prim) in hits.t.iter_mut().zip(&hits.prim) {
                *t = if prim == MISS { f32::INFINITY } else { *t };
            }
            job.round(0, &hits.prim, &mut hits.t);
        }
        Answer::Any(occluded) => {
            for (occluded, &t) in occluded.iter_mut().zip(&memory.t) {
                *occluded = (t == OCCLUDED) as u8;
            }
        }
    }
    Trace {
        counters,
        shared_origin: job.shared_origin.is_some(),
        invalid_rays: (n - prepared.valid) as u64,
        variant: None,
    }
}
