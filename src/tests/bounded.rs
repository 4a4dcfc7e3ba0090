//! Meshes and batches that must not cost more than clean ones: invalid rays, and triangles that are
//! dropped or stand in the same place a million times. Judged by counters, not by clocks.

mod common;

use common::Check;
use dacrt::random::{hash, unit_f64};
use dacrt::*;
use glam::Vec3;

/// As in a scene of a million, but for a test that ends soon.
const TRIANGLES: usize = 20_000;
const RAYS: usize = 10_000;

/// What makes a ray invalid.
type Spoil = fn(&mut Ray);

fn point(seed: u64, i: usize, k: u64) -> Vec3 {
    let number = |k| unit_f64(hash(seed, i as u64, k)) as f32;
    Vec3::new(number(k), number(k + 1), number(k + 2))
}

/// Small triangles all over the unit cube.
fn clean_triangle(i: usize) -> Triangle {
    let corner = |k| point(1, i, 0) + 0.02 * (point(1, i, k) - 0.5);
    Triangle::new(corner(3), corner(6), corner(9))
}

fn clean_ray(i: usize, shared: bool) -> Ray {
    let origin = match shared {
        true => Vec3::new(0.5, 0.5, -1.0),
        false => point(2, i, 0),
    };
    Ray::new(origin, point(2, i, 3) - origin)
}

fn mesh(triangle: impl Fn(usize) -> Triangle) -> Mesh {
    Mesh::new((0..TRIANGLES).map(triangle).collect())
}

/// A triangle that most rays meet.
fn big() -> Triangle {
    let corner = Vec3::new;
    Triangle::new(
        corner(-0.2, -0.2, 0.4),
        corner(1.5, -0.1, 0.6),
        corner(0.1, 1.6, 0.5),
    )
}

fn tiny() -> Triangle {
    Triangle::new(
        Vec3::splat(0.5),
        Vec3::splat(0.5) + 0.01 * Vec3::X,
        Vec3::splat(0.505),
    )
}

/// Tests of all kinds.
fn work(c: &Counters) -> u64 {
    c.ray_box
        + c.group_box
        + c.cone_box
        + c.triangle_box
        + c.ray_triangle
        + c.binned_triangles
        + c.sample_box
}

/// Nearest and any hits in each precision.
fn works(mesh: &Mesh, batch: &Batch, method: Method) -> Vec<u64> {
    let tracer = Tracer::new(method.parameters());
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let mut hits = Hits::misses(batch.len());
    let mut any = vec![0; batch.len()];
    let mut works = Vec::new();
    for precision in Precision::ALL {
        let tracer = tracer.with_precision(precision);
        let nearest = tracer.nearest(mesh, batch, &mut workspace, &mut hits);
        let any = tracer.any(mesh, batch, &mut workspace, &mut any);
        works.extend([nearest, any].map(|trace| work(&trace.counters)));
    }
    works
}

/// Whatever is traced in place of clean triangles or rays takes at most twice as many tests.
fn costs_at_most_twice(name: &str, mesh: &Mesh, batch: &Batch, shared: bool) {
    let clean = (
        self::mesh(clean_triangle),
        (0..RAYS).map(|i| clean_ray(i, shared)).collect(),
    );
    for method in Method::ALL {
        let allowed = works(&clean.0, &clean.1, method);
        let found = works(mesh, batch, method);
        for (found, allowed) in found.iter().zip(&allowed) {
            let ratio = *found as f64 / *allowed as f64;
            assert!(ratio <= 2.0, "{name}, {method}, shared {shared}: {ratio}");
        }
    }
}

#[test]
fn a_scene_of_copies_costs_at_most_twice_a_clean_one() {
    let b = big();
    let orders = [
        b,
        Triangle::new(b.b, b.c, b.a),
        Triangle::new(b.c, b.a, b.b),
        Triangle::new(b.a, b.c, b.b),
        Triangle::new(b.c, b.b, b.a),
        Triangle::new(b.b, b.a, b.c),
    ];
    let or_clean = |i: usize, one| {
        if i.is_multiple_of(2) {
            one
        } else {
            clean_triangle(i)
        }
    };
    let nan = Triangle::new(Vec3::NAN, Vec3::X, Vec3::Y);
    let flat = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::X);
    let meshes = [
        ("large copies", mesh(|_| big())),
        ("small copies", mesh(|_| tiny())),
        ("half large copies", mesh(|i| or_clean(i, big()))),
        ("half small copies", mesh(|i| or_clean(i, tiny()))),
        ("six orders of corners", mesh(|i| orders[i % 6])),
        ("copies of 16", mesh(|i| clean_triangle(i % 16))),
        ("copies of 1000", mesh(|i| clean_triangle(i % 1000))),
        ("NaN", mesh(|_| nan)),
        ("half NaN", mesh(|i| or_clean(i, nan))),
        ("no area", mesh(|_| flat)),
    ];
    for shared in [false, true] {
        let batch = (0..RAYS).map(|i| clean_ray(i, shared)).collect();
        for (name, mesh) in &meshes {
            costs_at_most_twice(name, mesh, &batch, shared);
        }
    }
}

#[test]
fn half_invalid_rays_cost_no_more_than_twice_as_much() {
    let kinds: [(&str, Spoil); 7] = [
        ("NaN direction", |ray| ray.direction.x = f32::NAN),
        ("infinite direction", |ray| ray.direction.y = f32::INFINITY),
        ("no direction", |ray| ray.direction = Vec3::ZERO),
        ("NaN origin", |ray| ray.origin.z = f32::NAN),
        ("infinite origin", |ray| ray.origin.y = f32::NEG_INFINITY),
        ("negative tmin", |ray| ray.tmin = -1.0),
        ("empty interval", |ray| ray.tmax = 0.0),
    ];
    let clean = mesh(clean_triangle);
    for shared in [false, true] {
        for (name, spoil) in kinds {
            let ray = |i: usize| {
                let mut ray = clean_ray(i, shared);
                if hash(3, i as u64, 0).is_multiple_of(2) {
                    spoil(&mut ray);
                }
                ray
            };
            let batch = (0..RAYS).map(ray).collect();
            costs_at_most_twice(name, &clean, &batch, shared);
        }
    }
}

#[test]
fn of_copies_the_lowest_number_is_hit_on_every_instruction_set() {
    for (groups, from) in [(1, 0), (5, 3), (16, 1), (1000, 0)] {
        for shared in [false, true] {
            let size = |t: Triangle| Triangle::new(t.a, t.a + 20.0 * (t.b - t.a), t.c);
            let triangle = |i: usize| match i < from {
                true => big(),
                false => size(clean_triangle(i % groups)),
            };
            let check = Check {
                mesh: Mesh::new((0..3000).map(triangle).collect()),
                batch: (0..1000).map(|i| clean_ray(i, shared)).collect(),
                parameters: common::presets_and_finest(),
                own_origins: false,
                grazing: false,
            };
            check.run();
        }
    }
}
