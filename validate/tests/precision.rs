//! Precision `exact` against the arbiter, and what `watertight` promises, on every method and
//! instruction set.

use dacrt::random::{hash, unit_f64};
use dacrt::*;
use dacrt_validate::exact::Arbiter;
use glam::Vec3;

fn number(seed: u64, i: u64, k: u64) -> f32 {
    unit_f64(hash(seed, i, k)) as f32 * 2.0 - 1.0
}

fn point(seed: u64, i: u64, k: u64) -> Vec3 {
    Vec3::new(
        number(seed, i, k),
        number(seed, i, k + 1),
        number(seed, i, k + 2),
    )
}

/// Triangles that share corners, some flat, some of them twice, some without an area.
fn mesh(n: usize, seed: u64, scale: f32) -> Mesh {
    let corners: Vec<Vec3> = (0..n as u64).map(|i| scale * point(seed, i, 0)).collect();
    let triangle = |i: u64| {
        let corner = |k| corners[(hash(seed, i, k) % corners.len() as u64) as usize];
        let (a, mut b, mut c) = (corner(30), corner(31), corner(32));
        match hash(seed, i, 33) % 16 {
            0 => c = b,
            1 => (b.z, c.z) = (a.z, a.z),
            2 => c = a + 0.5 * (b - a),
            3..8 => (b, c) = (a + 1e-2 * (b - a), a + 1e-2 * (c - a)),
            _ => {}
        }
        Triangle::new(a, b, c)
    };
    let mut triangles: Vec<Triangle> = (0..n as u64).map(triangle).collect();
    for i in 0..n / 8 {
        triangles[n - 1 - i] = triangles[i];
    }
    Mesh::new(triangles)
}

/// Rays at corners, edges and inner points of triangles, along axes, and anywhere.
fn rays(mesh: &Mesh, n: usize, seed: u64, shared: bool, scale: f32) -> Batch {
    let ray = |i: u64| {
        let origin = match shared {
            true => scale * Vec3::new(0.1, -0.2, 0.3),
            false => 1.5 * scale * point(seed, i, 40),
        };
        let t = mesh.triangles()[(hash(seed, i, 50) % mesh.len() as u64) as usize];
        let w = unit_f64(hash(seed, i, 51)) as f32;
        let target = match hash(seed, i, 52) % 8 {
            0 => t.a,
            1 => t.a + 0.5 * (t.b - t.a),
            2 => t.b + w * (t.c - t.b),
            3 | 4 => (t.a + t.b + t.c) / 3.0,
            _ => scale * point(seed, i, 60),
        };
        let mut ray = Ray::new(origin, target - origin);
        match hash(seed, i, 53) % 32 {
            0 => ray.tmax = 1.0,
            1 => ray.tmin = 1.0,
            2 => ray.tmax = 1f32.next_down(),
            3 => ray.direction.x = 0.0,
            4 => (ray.direction.x, ray.direction.y) = (-0.0, 0.0),
            5 => ray.direction.z = 1e-39,
            6 => ray.direction *= 1e-20,
            7 => ray.direction *= 1e18 / scale,
            8 => ray.origin = target,
            9 if !shared => ray.origin = t.b,
            _ => {}
        }
        ray
    };
    (0..n as u64).map(ray).collect()
}

/// Parameters of all methods, as they are and down to the smallest leaves.
fn parameters() -> Vec<Parameters> {
    let presets = Method::ALL.map(Method::parameters).into_iter();
    let finest = presets.clone().map(|preset| match preset {
        Parameters::Object(p) => Parameters::Object(ObjectParameters {
            leaf_triangles: 1,
            leaf_rays: 0,
            min_rays: 0,
            ..p
        }),
        Parameters::Space(p) => Parameters::Space(SpaceParameters {
            ray_limit: 1,
            triangle_limit: 1,
            cone_limit: 1,
            widest_cone: 60.0,
            plane_test: true,
            ..p
        }),
        Parameters::Best(_) => Parameters::Best(BestParameters {
            block: 64,
            sorted_block: 64,
            window: 64,
            sort: Sort::Always,
            flush: 0.5,
            cell_triangles: 1.0,
        }),
    });
    presets.chain(finest).collect()
}

fn check(mesh: &Mesh, batch: &Batch, isa: Isa, name: &str) {
    let arbiter = Arbiter::new(mesh);
    let expected: Vec<(u32, u32)> = batch
        .iter()
        .map(|ray| match arbiter.nearest(&ray) {
            Some(hit) => (hit.t.to_f32().to_bits(), hit.prim),
            None => (f32::INFINITY.to_bits(), MISS),
        })
        .collect();
    for parameters in parameters() {
        let tracer = Tracer::new(parameters)
            .with_precision(Precision::Exact)
            .with_isa(isa);
        let mut workspace = tracer.workspace(batch.len(), mesh.len());
        let mut hits = Hits::misses(batch.len());
        tracer.nearest(mesh, batch, &mut workspace, &mut hits);
        let mut occluded = vec![7; batch.len()];
        tracer.any(mesh, batch, &mut workspace, &mut occluded);
        let wrong: Vec<usize> = (0..batch.len())
            .filter(|&i| {
                (hits.t[i].to_bits(), hits.prim[i]) != expected[i]
                    || (occluded[i] == 1) != (expected[i].1 != MISS)
            })
            .collect();
        if let Some(&i) = wrong.first() {
            panic!(
                "{name} {parameters:?} {isa}: {} of {} wrong; ray {i} {:?} any {}: {:e} {} not {:e} {}",
                wrong.len(),
                batch.len(),
                batch.ray(i),
                occluded[i],
                hits.t[i],
                hits.prim[i],
                f32::from_bits(expected[i].0),
                expected[i].1
            );
        }
    }
}

#[test]
fn exact_is_what_the_arbiter_says() {
    for (seed, scale) in [
        (1, 1.0),
        (2, 1e-6),
        (3, 1e6),
        (4, 1e-38),
        (5, 1e18),
        (6, 1e-20),
    ] {
        for shared in [false, true] {
            let mesh = mesh(300, seed, scale);
            for isa in Isa::available() {
                let n = if isa == Isa::Portable { 150 } else { 600 };
                let batch = rays(&mesh, n, seed, shared, scale);
                check(
                    &mesh,
                    &batch,
                    isa,
                    &format!("scale {scale} shared {shared}"),
                );
            }
        }
    }
}

#[test]
fn exact_in_a_mixture_of_scales() {
    for shared in [false, true] {
        let scales = [1e-6, 1e-3, 1.0, 1e3, 1e6];
        let parts = scales.map(|scale| mesh(80, 9, scale).into_triangles());
        let mesh = Mesh::new(parts.concat());
        for isa in Isa::available().filter(|&isa| isa != Isa::Portable) {
            for scale in scales {
                let batch = rays(&mesh, 500, 9, shared, scale);
                check(
                    &mesh,
                    &batch,
                    isa,
                    &format!("rays of scale {scale} shared {shared}"),
                );
            }
        }
    }
}
