//! Tracers with their memory.

use dacrt::{Batch, Hits, Mesh, Parameters, Trace, Tracer, Workspace};

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
            workspace: tracer.workspace(0, mesh.len()),
            tracer,
            mesh,
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
            self.workspace = self.tracer.workspace(rays, self.mesh.len());
            self.rays = rays;
        }
    }
}

/// Memory for traces of one size by any method and so many threads: a workspace for each kind of
/// parameters, made when it is first needed.
pub struct Workspaces {
    rays: usize,
    triangles: usize,
    threads: usize,
    made: Vec<Workspace>,
}

impl Workspaces {
    pub fn new(rays: usize, triangles: usize, threads: usize) -> Workspaces {
        Workspaces {
            rays,
            triangles,
            threads,
            made: Vec::new(),
        }
    }

    /// Bytes of all that are made.
    pub fn bytes(&self) -> usize {
        self.made.iter().map(Workspace::bytes).sum()
    }

    /// The one for these parameters.
    pub fn of(&mut self, parameters: &Parameters) -> &mut Workspace {
        let (rays, triangles, threads) = (self.rays, self.triangles, self.threads);
        let suits = |w: &Workspace| w.suits(parameters, rays, triangles, threads);
        let place = self.made.iter().position(suits).unwrap_or_else(|| {
            let made = Workspace::for_threads(parameters, rays, triangles, threads);
            self.made.push(made);
            self.made.len() - 1
        });
        &mut self.made[place]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dacrt::Method;

    #[test]
    fn each_kind_of_parameters_has_one_workspace() {
        for threads in [1, 3] {
            let mut workspaces = Workspaces::new(100, 1000, threads);
            for method in Method::ALL {
                let parameters = method.parameters();
                let bytes = workspaces.of(&parameters).bytes();
                let expected = Workspace::bytes_for(&parameters, 100, 1000, threads);
                assert_eq!(bytes, expected, "{method}");
            }
            assert_eq!(workspaces.made.len(), 3);
        }
    }
}
