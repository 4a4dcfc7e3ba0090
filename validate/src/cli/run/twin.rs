//! The stored twin of a trace: its splits kept as a tree, and its rays sent through that, together and one by
//! one; and the same rays sent through the splits of the primary ones.

use super::Answers;
use dacrt::{Batch, Mesh, Parameters, Sent, Stored, Trace, Tracer, Variant, Workspace};
use dacrt_validate::measure::milliseconds;
use dacrt_validate::results::{Reuse, Twin};
use dacrt_validate::statistics::{median, paired_ratio};

/// Whether rays can be sent one by one through the splits of a trace: boxes are held against rays, and neither
/// conic packets nor groups.
fn is_of_rays(parameters: &Parameters, shared_origin: bool) -> bool {
    match parameters {
        Parameters::Object(_) => true,
        Parameters::Space(space) => !shared_origin || space.variant != Variant::Cones,
        Parameters::Best(_) => false,
    }
}

/// A trace whose answers have been validated.
pub struct Original<'a> {
    pub tracer: &'a Tracer,
    pub parameters: &'a Parameters,
    pub mesh: &'a Mesh,
    pub batch: &'a Batch,
    pub answers: &'a Answers,
    pub repeats: u32,
}

impl Original<'_> {
    /// Traces, keeps the splits, and sends the rays through them; then through the splits of the primary
    /// rays, if they are given.
    pub fn twin(&self, workspace: &mut Workspace, primary: Option<&Batch>) -> Twin {
        let any = matches!(self.answers, Answers::Any(_));
        let mut room = Answers::room(self.batch.len(), any);
        let (trace, stored) = self.store(self.batch, workspace, &mut room);
        let mut differing_rays = room.differing(self.answers);
        let one_by_one = is_of_rays(self.parameters, trace.shared_origin).then(|| {
            let sent = self.send(&stored, Sent::OneByOne, workspace, &mut room);
            differing_rays += room.differing(self.answers);
            sent
        });
        let counters = one_by_one.as_ref().map(|(sent, _)| sent.counters);
        let [of_trace, samples_ms] =
            self.in_turns(&stored, Sent::Together, workspace, &mut differing_rays);
        let over = paired_ratio(&of_trace, &samples_ms);
        let reuse = primary.map(|primary| {
            let mut room = Answers::room(primary.len(), false);
            let mut own = self.tracer.workspace(primary.len(), self.mesh.len());
            let (_, stored) = self.store(primary, &mut own, &mut room);
            let samples_ms = self.in_turns(&stored, Sent::Onward, workspace, &mut differing_rays);
            let over = paired_ratio(&samples_ms[0], &samples_ms[1]);
            Reuse {
                median_ms: median(&samples_ms[1]).unwrap_or(f64::NAN),
                trace_over_reuse: over.map_or(f64::NAN, |r| r.ratio),
                trace_over_reuse_interval: over.map_or([f64::NAN; 2], |r| r.interval),
                samples_ms,
            }
        });
        Twin {
            nodes: stored.nodes(),
            triangles: stored.triangles(),
            ray_box: trace.counters.ray_box - stored.extra_box(),
            ray_triangle: trace.counters.ray_triangle,
            one_by_one_ray_box: counters.map(|c| c.ray_box),
            one_by_one_ray_triangle: counters.map(|c| c.ray_triangle),
            one_by_one_ms: one_by_one.map(|(_, ms)| ms),
            differing_rays,
            median_ms: median(&samples_ms).unwrap_or(f64::NAN),
            trace_over_twin: over.map_or(f64::NAN, |r| r.ratio),
            trace_over_twin_interval: over.map_or([f64::NAN; 2], |r| r.interval),
            samples_ms,
            reuse,
        }
    }

    /// Milliseconds of each repeat, of the trace and of its rays sent through a tree. Adds the rays whose
    /// answers were others.
    fn in_turns(
        &self,
        stored: &Stored,
        how: Sent,
        workspace: &mut Workspace,
        differing_rays: &mut usize,
    ) -> [Vec<f64>; 2] {
        let any = matches!(self.answers, Answers::Any(_));
        let mut room = Answers::room(self.batch.len(), any);
        let (mut of_trace, mut of_tree) = (Vec::new(), Vec::new());
        for _ in 0..self.repeats {
            of_tree.push(self.send(stored, how, workspace, &mut room).1);
            *differing_rays += room.differing(self.answers);
            let trace = || room.trace(self.tracer, self.mesh, self.batch, workspace);
            of_trace.push(milliseconds(trace).1);
        }
        [of_trace, of_tree]
    }

    fn store(
        &self,
        batch: &Batch,
        workspace: &mut Workspace,
        room: &mut Answers,
    ) -> (Trace, Stored) {
        match room {
            Answers::Nearest(hits) => self.tracer.store_nearest(self.mesh, batch, workspace, hits),
            Answers::Any(any) => self.tracer.store_any(self.mesh, batch, workspace, any),
        }
    }

    fn send(
        &self,
        stored: &Stored,
        how: Sent,
        workspace: &mut Workspace,
        room: &mut Answers,
    ) -> (Trace, f64) {
        room.spoil();
        let (mesh, batch, through) = (self.mesh, self.batch, (stored, how));
        milliseconds(|| match room {
            Answers::Nearest(hits) => {
                (self.tracer).send_nearest(mesh, batch, workspace, hits, through)
            }
            Answers::Any(any) => self.tracer.send_any(mesh, batch, workspace, any, through),
        })
    }
}
