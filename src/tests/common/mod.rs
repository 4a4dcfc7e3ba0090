//! Triangles and rays of every nature, and a case to trace them in.
#![allow(dead_code)] // Each test binary uses some of it.

use dacrt::random::{hash, unit_f64};
use dacrt::*;
use glam::Vec3;

/// Random triangles: large, small, flat, degenerate and invalid ones, some of them twice.
pub fn soup(n: usize, seed: u64) -> Mesh {
    let mut triangles: Vec<Triangle> = (0..n as u64)
        .map(|i| {
            let r = |k| unit_f64(hash(seed, i, k)) as f32 * 2.0 - 1.0;
            let size = 10f32.powf(-2.0 * unit_f64(hash(seed, i, 20)) as f32);
            let center = Vec3::new(r(0), r(1), r(2));
            let corner = |k| center + size * Vec3::new(r(k), r(k + 1), r(k + 2));
            let (a, mut b, mut c) = (corner(3), corner(6), corner(9));
            match hash(seed, i, 21) % 16 {
                0 => c = b,
                1 => (b.z, c.z) = (a.z, a.z),
                2 => (b.x, c.x) = (a.x, a.x),
                3 => b.y = f32::NAN,
                _ => {}
            }
            Triangle::new(a, b, c)
        })
        .collect();
    for i in 0..n / 8 {
        triangles[n - 1 - i] = triangles[i];
    }
    Mesh::new(triangles)
}

pub fn direction(seed: u64, i: u64) -> Vec3 {
    let r = |k| unit_f64(hash(seed, i, k)) as f32 * 2.0 - 1.0;
    let mut d = Vec3::new(r(10), r(11), r(12));
    match hash(seed, i, 13) % 32 {
        0 => d.x = 0.0,
        1 => (d.x, d.y) = (-0.0, 0.0),
        2 => d.z = 1e-39,
        3 => d *= 1e5,
        _ => {}
    }
    d
}

pub fn random_rays(n: usize, seed: u64, shared: bool) -> Batch {
    (0..n as u64)
        .map(|i| {
            let r = |k| unit_f64(hash(seed, i, k)) as f32 * 2.4 - 1.2;
            let mut ray = Ray::new(Vec3::new(r(0), r(1), r(2)), direction(seed, i));
            if shared {
                ray.origin = Vec3::new(0.1, -0.2, 0.3);
            }
            match hash(seed, i, 14) % 16 {
                0 => ray.tmax = unit_f64(hash(seed, i, 15)) as f32,
                1 => ray.tmin = unit_f64(hash(seed, i, 15)) as f32,
                2 => ray.direction.y = f32::NAN,
                3 => ray.tmin = -1.0,
                _ => {}
            }
            ray
        })
        .collect()
}

/// One leaf: the naive step over everything.
pub fn brute_force() -> Parameters {
    Parameters {
        leaf_triangles: u32::MAX,
        ..ObjectParameters::AFRA2012
    }
}

pub struct Case {
    pub mesh: Mesh,
    pub batch: Batch,
    pub workspace: Workspace,
}

impl Case {
    pub fn new(mesh: Mesh, batch: Batch) -> Case {
        let workspace = Workspace::new(batch.len(), mesh.len());
        Case {
            mesh,
            batch,
            workspace,
        }
    }

    pub fn nearest(&mut self, tracer: Tracer) -> (Hits, Trace) {
        let mut hits = Hits::misses(self.batch.len());
        let trace = tracer.nearest(&self.mesh, &self.batch, &mut self.workspace, &mut hits);
        (hits, trace)
    }

    pub fn any(&mut self, tracer: Tracer) -> (Vec<u8>, Trace) {
        let mut occluded = vec![7; self.batch.len()];
        let trace = tracer.any(&self.mesh, &self.batch, &mut self.workspace, &mut occluded);
        (occluded, trace)
    }
}

pub fn bits(hits: &Hits) -> (Vec<u32>, &[u32]) {
    (hits.t.iter().map(|t| t.to_bits()).collect(), &hits.prim)
}
