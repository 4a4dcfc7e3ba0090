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

/// Memory for traces of one size by any method: a workspace for each kind of parameters, made when
/// it is first needed.
pub struct Workspaces {
    rays: usize,
    triangles: usize,
    made: Vec<Workspace>,
}

impl Workspaces {
    pub fn new(rays: usize, triangles: usize) -> Workspaces {
        Workspaces {
            rays,
            triangles,
            made: Vec::new(),
        }
    }

    /// The one for these parameters.
    pub fn of(&mut self, parameters: &Parameters) -> &mut Workspace {
        let (rays, triangles) = (self.rays, self.triangles);
        let suits = |w: &Workspace| w.suits(parameters, rays, triangles, 1);
        let place = self.made.iter().position(suits).unwrap_or_else(|| {
            self.made.push(Workspace::new(parameters, rays, triangles));
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
        let mut workspaces = Workspaces::new(100, 1000);
        for method in Method::ALL {
            let parameters = method.parameters();
            let bytes = workspaces.of(&parameters).bytes();
            assert_eq!(
                bytes,
                Workspace::bytes_for(&parameters, 100, 1000, 1),
                "{method}"
            );
        }
        assert_eq!(workspaces.made.len(), 3);
    }
}
