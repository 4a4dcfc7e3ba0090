//! One trace: the first pass over rays and triangles, then the recursion.

use super::cell::Cell;
use super::divide::{Divide, Order, Part};
use super::{Memory, SpaceParameters, Variant};
use crate::kernels::{Directions, Range};
use crate::methods::Counters;
use crate::methods::job::{Answer, Job, OCCLUDED, Trace};
use crate::methods::observer::Observer;
use crate::methods::stored::Sent;
use crate::rays::MISS;

/// Traces a batch by splitting space.
pub(in crate::methods) fn trace(
    job: &Job,
    parameters: &SpaceParameters,
    memory: &mut Memory,
    answer: Answer,
    observer: Observer,
) -> Trace {
    let (batch, kernels) = (job.batch, job.kernels);
    let Observer {
        mut watch,
        stored,
        sent,
        ..
    } = observer;
    let variant = match job.shared_origin {
        Some(_) => parameters.variant,
        None => Variant::Random,
    };
    let any_hit = matches!(answer, Answer::Any(_));
    let (lists, cones) = (memory.lists(), memory.cones());
    let mut rays = memory.rays(job, any_hit);
    // SAFETY: the processor was checked; the memory has room for batch and mesh.
    let (of_rays, of_triangles) = unsafe {
        (
            (kernels.prepare_records)(batch, &rays),
            (kernels.prepare_lists)(job.mesh, &lists),
        )
    };
    rays.special = of_rays.special;
    rays.least_tmin = of_rays.least_tmin;
    rays.one_tmin = of_rays.one_tmin;
    rays.tmax.one = of_rays.one_tmax;
    rays.scene = of_triangles.bounds;
    if let Some(watch) = &mut watch {
        watch.ray.least_tmin = rays.least_tmin;
    }

    let mut divide = Divide {
        kernels,
        parameters,
        rays,
        lists,
        triangles: job.mesh.triangles(),
        cones,
        origins: of_rays.origins,
        order: match (variant, parameters.octants) {
            (Variant::Random, true) => Order::FromOctant(0),
            (Variant::Random, false) => Order::Majority,
            _ => Order::FromOrigin,
        },
        terminated: 0,
        terminated_cones: 0,
        counters: Counters::default(),
        watch,
        stored,
    };
    let all = Part {
        rays: of_rays.valid,
        triangles: of_triangles.len,
        directions: Directions::default(),
    };
    if all.rays > 0 && all.triangles > 0 {
        let root = Cell::root(of_triangles.bounds);
        let list = Range {
            from: 0,
            to: all.rays,
        };
        let filters_root = variant == Variant::Random && !parameters.octants;
        if !filters_root {
            divide.watch_cell(&root, all.triangles, list, all.rays);
        }
        if let Some(stored) = &mut divide.stored {
            stored.filters_root = filters_root;
        }
        let prepare_cones = || {
            let least_cosine = libm::cos((parameters.widest_cone as f64).to_radians());
            // SAFETY: as above; the batch shares its origin where there are cones.
            unsafe { (kernels.prepare_cones)(batch, &rays, &cones, least_cosine as f32) }
        };
        match (variant, sent) {
            (Variant::Cones, Some((tree, how))) => {
                assert_eq!(how, Sent::Together, "conic packets are sent together");
                divide.send_packets(tree, prepare_cones());
            }
            (_, Some((tree, how))) => divide.send(tree, all.rays, how),
            (Variant::Basic, None) => divide.divide(&root, all),
            (Variant::Cones, None) => {
                let made = prepare_cones();
                let with = |rays| Part { rays, ..all };
                if made.loose > 0 {
                    divide.divide(&root, with(made.loose));
                }
                if made.cones > 0 {
                    divide.divide_packets(&root, with(made.cones));
                }
            }
            (Variant::Random, None) if parameters.octants => divide.divide_octants(&root, all),
            (Variant::Random, None) => {
                let (rays, directions) = divide.filter_rays(&root, list);
                divide.watch_cell(&root, all.triangles, list, rays);
                if rays > 0 {
                    let part = Part {
                        rays,
                        directions,
                        ..all
                    };
                    divide.divide(&root, part);
                }
            }
        }
    }
    let counters = divide.counters;
    let shared = job.shared_origin.is_some();
    match answer {
        Answer::Nearest(hits) => {
            let records = hits.t.iter_mut().zip(&mut hits.prim);
            for ((t, prim), (best, found)) in records.zip(memory.best(shared)) {
                *prim = found;
                *t = if found == MISS { f32::INFINITY } else { best };
            }
            job.round(0, &hits.prim, &mut hits.t);
        }
        Answer::Any(occluded) => {
            for (occluded, (best, _)) in occluded.iter_mut().zip(memory.best(shared)) {
                *occluded = (best == OCCLUDED) as u8;
            }
        }
    }
    Trace {
        counters,
        shared_origin: shared,
        invalid_rays: (batch.len() - of_rays.valid) as u64,
        variant: Some(variant),
    }
}
