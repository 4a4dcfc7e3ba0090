//! The stored twin of a trace: its splits kept as a tree, and its rays sent through that, together and one by
//! one.

use super::Answers;
use dacrt::{Batch, Mesh, Parameters, Sent, Stored, Trace, Tracer, Variant, Workspace};
use dacrt_validate::measure::milliseconds;
use dacrt_validate::results::Twin;
use dacrt_validate::statistics::{median, paired_ratio};

/// Whether a trace with these parameters can be stored.
pub fn has_twin(parameters: &Parameters, shared_origin: bool) -> bool {
    match parameters {
        Parameters::Object(_) => true,
        Parameters::Space(space) => {
            let takes_cones = shared_origin && space.variant == Variant::Cones;
            !takes_cones && !space.octants
        }
        Parameters::Best(_) => false,
    }
}

/// Traces, keeps the splits, and sends the rays through them; `answers` are those of the trace.
pub fn twin(
    tracer: &Tracer,
    mesh: &Mesh,
    batch: &Batch,
    workspace: &mut Workspace,
    answers: &Answers,
    repeats: u32,
) -> Twin {
    let mut room = Answers::room(batch.len(), matches!(answers, Answers::Any(_)));
    let (trace, stored) = store(tracer, mesh, batch, workspace, &mut room);
    let mut differing_rays = room.differing(answers);
    let mut send = |how, room: &mut Answers, workspace: &mut Workspace| {
        room.spoil();
        let traced = milliseconds(|| {
            let through = (&stored, how);
            match room {
                Answers::Nearest(hits) => {
                    tracer.send_nearest(mesh, batch, workspace, hits, through)
                }
                Answers::Any(occluded) => {
                    tracer.send_any(mesh, batch, workspace, occluded, through)
                }
            }
        });
        differing_rays += room.differing(answers);
        traced
    };
    let (one_by_one, one_by_one_ms) = send(Sent::OneByOne, &mut room, workspace);
    let (mut samples_ms, mut of_trace) = (Vec::new(), Vec::new());
    for _ in 0..repeats {
        samples_ms.push(send(Sent::Together, &mut room, workspace).1);
        let (_, ms) = milliseconds(|| room.trace(tracer, mesh, batch, workspace));
        of_trace.push(ms);
    }
    let over = paired_ratio(&of_trace, &samples_ms);
    Twin {
        nodes: stored.nodes(),
        triangles: stored.triangles(),
        ray_box: trace.counters.ray_box - stored.extra_box(),
        ray_triangle: trace.counters.ray_triangle,
        one_by_one_ray_box: one_by_one.counters.ray_box,
        one_by_one_ray_triangle: one_by_one.counters.ray_triangle,
        differing_rays,
        median_ms: median(&samples_ms).unwrap_or(f64::NAN),
        trace_over_twin: over.map_or(f64::NAN, |r| r.ratio),
        trace_over_twin_interval: over.map_or([f64::NAN; 2], |r| r.interval),
        one_by_one_ms,
        samples_ms,
    }
}

fn store(
    tracer: &Tracer,
    mesh: &Mesh,
    batch: &Batch,
    workspace: &mut Workspace,
    room: &mut Answers,
) -> (Trace, Stored) {
    match room {
        Answers::Nearest(hits) => tracer.store_nearest(mesh, batch, workspace, hits),
        Answers::Any(occluded) => tracer.store_any(mesh, batch, workspace, occluded),
    }
}
