//! A tracer with its mesh and memory, for one batch after the other.

use dacrt::{Batch, Hits, Mesh, Trace, Tracer, Workspace};

/// Traces batches of any size; the workspace grows when a batch needs it.
pub struct Engine<'a> {
    tracer: Tracer,
    mesh: &'a Mesh,
    workspace: Workspace,
    rays: usize,
}

impl<'a> Engine<'a> {
    pub fn new(tracer: Tracer, mesh: &'a Mesh) -> Engine<'a> {
        Engine {
            tracer,
            mesh,
            workspace: Workspace::new(0, mesh.len()),
            rays: 0,
        }
    }

    /// The nearest hits, and what the traversal counted.
    pub fn nearest(&mut self, batch: &Batch) -> (Hits, Trace) {
        self.make_room(batch.len());
        let mut hits = Hits::misses(batch.len());
        let trace = (self.tracer).nearest(self.mesh, batch, &mut self.workspace, &mut hits);
        (hits, trace)
    }

    /// For each ray 1 if it hits anything, else 0.
    pub fn any(&mut self, batch: &Batch) -> Vec<u8> {
        self.make_room(batch.len());
        let mut occluded = vec![0; batch.len()];
        (self.tracer).any(self.mesh, batch, &mut self.workspace, &mut occluded);
        occluded
    }

    fn make_room(&mut self, rays: usize) {
        if rays > self.rays {
            self.workspace = Workspace::new(rays, self.mesh.len());
            self.rays = rays;
        }
    }
}
