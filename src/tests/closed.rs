//! No ray leaves a closed mesh through its edges and corners in precisions `watertight` and `exact`.
//!
//! `DACRT_TEST_BATCHES` is how many batches of half a million rays are traced, instead of 2: with 200
//! it is a hundred million rays for each precision.

use dacrt::random::{hash, unit_f64};
use dacrt::*;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

const ROWS: u64 = 64;
const COLUMNS: u64 = 128;
const RAYS: u64 = 500_000;

/// A sphere with dents around a place, of about 16,000 triangles.
fn sphere(place: DVec3) -> Mesh {
    let corner = |row: u64, column: u64| {
        // The poles are one corner each.
        let column = if row.is_multiple_of(ROWS) {
            0
        } else {
            column % COLUMNS
        };
        let radius = 0.9 + 0.2 * unit_f64(hash(1, row, column));
        let down = PI * row as f64 / ROWS as f64;
        let around = 2.0 * PI * column as f64 / COLUMNS as f64;
        let unit = DVec3::new(
            libm::sin(down) * libm::cos(around),
            libm::sin(down) * libm::sin(around),
            libm::cos(down),
        );
        (place + 10.0 * radius * unit).as_vec3()
    };
    let mut triangles = Vec::new();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let [a, b] = [corner(row, column), corner(row, column + 1)];
            let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
            if row > 0 {
                triangles.push(Triangle::new(a, b, c));
            }
            if row + 1 < ROWS {
                triangles.push(Triangle::new(b, d, c));
            }
        }
    }
    Mesh::new(triangles)
}

/// Rays from within to corners and to points of edges, as well as float32 can aim at them.
fn rays(mesh: &Mesh, place: DVec3, batch: u64, shared: bool) -> Batch {
    let eye = |i| {
        let number = |k| unit_f64(hash(batch, i, k)) - 0.5;
        (place + 6.0 * DVec3::new(number(0), number(1), number(2))).as_vec3()
    };
    let ray = |i| {
        let eye = eye(if shared { 0 } else { i });
        let triangle = &mesh.triangles()[(hash(batch, i, 3) % mesh.len() as u64) as usize];
        let along = match hash(batch, i, 4) % 4 {
            0 => 0.0,
            1 => 0.5,
            _ => unit_f64(hash(batch, i, 5)) as f32,
        };
        let target: Vec3 = triangle.a + along * (triangle.b - triangle.a);
        Ray::new(eye, target - eye)
    };
    (0..RAYS).map(ray).collect()
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let batches = std::env::var("DACRT_TEST_BATCHES").map_or(2, |n| n.parse().unwrap());
    let places = [DVec3::ZERO, DVec3::new(148376.0, 1234.0, -223423.0)];
    let meshes = places.map(sphere);
    for batch in 0..batches {
        let which = batch as usize % 2;
        let mesh = &meshes[which];
        let rays = rays(mesh, places[which], batch, batch % 4 < 2);
        let method = Method::ALL[batch as usize % Method::ALL.len()];
        for precision in [Precision::Watertight, Precision::Exact] {
            let tracer = Tracer::new(method.parameters()).with_precision(precision);
            let mut hits = Hits::misses(rays.len());
            let mut workspace = tracer.workspace(rays.len(), mesh.len());
            tracer.nearest(mesh, &rays, &mut workspace, &mut hits);
            let lost = hits.prim.iter().position(|&prim| prim == MISS);
            assert_eq!(
                lost.map(|i| rays.ray(i)),
                None,
                "{method} {precision}, batch {batch}"
            );
        }
    }
    println!("{batches} batches of {RAYS} rays: none lost");
}
