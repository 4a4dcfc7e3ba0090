//! What a trace answers: nearest hits, or for each ray whether there is one.

use dacrt::{Batch, Hits, Mesh, NodeRecord, Trace, Tracer, Workspace};
use dacrt_validate::embree::{Committed, Query, Scene};
use dacrt_validate::judge;
use dacrt_validate::peers::Tree;

/// The answers to one batch.
#[derive(Clone, Debug, PartialEq)]
pub enum Answers {
    Nearest(Hits),
    /// 1 for a ray that hits anything, else 0.
    Any(Vec<u8>),
}

impl Answers {
    /// Room for the answers to `rays` rays.
    pub fn room(rays: usize, any: bool) -> Answers {
        match any {
            false => Answers::Nearest(Hits::misses(rays)),
            true => Answers::Any(vec![0; rays]),
        }
    }

    /// Makes all of them such as no trace gives, so that one which writes none is found out.
    pub fn spoil(&mut self) {
        match self {
            Answers::Nearest(hits) => hits.t.fill(f32::NAN),
            Answers::Any(occluded) => occluded.fill(u8::MAX),
        }
    }

    /// The same, borrowed, as the judge takes it.
    pub fn view(&self) -> judge::Answers<'_> {
        match self {
            Answers::Nearest(hits) => judge::Answers::Nearest(hits),
            Answers::Any(occluded) => judge::Answers::Any(occluded),
        }
    }

    /// Number of rays whose answers are not the same, to the bit.
    pub fn differing(&self, other: &Answers) -> usize {
        match (self, other) {
            (Answers::Nearest(ours), Answers::Nearest(theirs)) => (0..ours.len())
                .filter(|&i| {
                    let of = |hits: &Hits| (hits.t[i].to_bits(), hits.prim[i]);
                    of(ours) != of(theirs)
                })
                .count(),
            (Answers::Any(ours), Answers::Any(theirs)) => {
                ours.iter().zip(theirs).filter(|(a, b)| a != b).count()
            }
            _ => unreachable!("answers to one batch are of one kind"),
        }
    }

    /// Number of rays that hit something.
    pub fn hit_count(&self) -> usize {
        match self {
            Answers::Nearest(hits) => hits.hit_count(),
            Answers::Any(occluded) => occluded.iter().filter(|&&o| o != 0).count(),
        }
    }

    /// Fills in what our tracer finds.
    pub fn trace(
        &mut self,
        tracer: &Tracer,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
    ) -> Trace {
        match self {
            Answers::Nearest(hits) => tracer.nearest(mesh, batch, workspace, hits),
            Answers::Any(occluded) => tracer.any(mesh, batch, workspace, occluded),
        }
    }

    /// Likewise, and the nodes of the trace.
    pub fn log(
        &mut self,
        tracer: &Tracer,
        mesh: &Mesh,
        batch: &Batch,
        workspace: &mut Workspace,
    ) -> (Trace, Vec<NodeRecord>) {
        match self {
            Answers::Nearest(hits) => tracer.log_nearest(mesh, batch, workspace, hits),
            Answers::Any(occluded) => tracer.log_any(mesh, batch, workspace, occluded),
        }
    }

    /// Fills in what Embree finds.
    pub fn trace_embree(&mut self, scene: &Scene, batch: &Batch, query: Query) {
        match self {
            Answers::Nearest(hits) => scene.nearest(batch, query, hits),
            Answers::Any(occluded) => scene.any(batch, query, occluded),
        }
    }

    /// Fills in what Embree finds, as fast as this machine can and not to be timed.
    pub fn trace_embree_untimed(&mut self, scene: &Scene, batch: &Batch) {
        match self {
            Answers::Nearest(hits) => scene.nearest_untimed(batch, hits),
            Answers::Any(occluded) => scene.any_untimed(batch, occluded),
        }
    }

    /// Fills in what Embree finds, on the thread that calls.
    pub fn trace_embree_alone(&mut self, scene: &Committed, batch: &Batch, query: Query) {
        match self {
            Answers::Nearest(hits) => scene.nearest(batch, query, hits),
            Answers::Any(occluded) => scene.any(batch, query, occluded),
        }
    }

    /// Fills in what the tree of another library finds.
    pub fn trace_peer(&mut self, tree: &dyn Tree, batch: &Batch) {
        match self {
            Answers::Nearest(hits) => tree.nearest(batch, hits),
            Answers::Any(occluded) => tree.any(batch, occluded),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_that_differ_are_counted_once() {
        let mut hits = Hits::misses(4);
        let ours = Answers::Nearest(hits.clone());
        (hits.t[1], hits.prim[1]) = (1.0, 2);
        hits.prim[3] = 7;
        assert_eq!(ours.differing(&Answers::Nearest(hits)), 2);
        assert_eq!(ours.differing(&ours), 0);
        let any = |occluded: &[u8]| Answers::Any(occluded.to_vec());
        assert_eq!(any(&[0, 1, 1]).differing(&any(&[1, 1, 0])), 2);
    }
}
