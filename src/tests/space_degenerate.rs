//! Meshes and batches that are hard on the splitting of space: its traces end, and are right.

mod common;

use common::{Check, finest_space, soup, space_presets};
use dacrt::random::{hash, unit_f64};
use dacrt::*;
use glam::Vec3;

/// A number from −1 to 1.
fn unit(seed: u64, i: usize, k: u64) -> f32 {
    unit_f64(hash(seed, i as u64, k)) as f32 * 2.0 - 1.0
}

fn vector(seed: u64, i: usize, k: u64) -> Vec3 {
    Vec3::new(unit(seed, i, k), unit(seed, i, k + 1), unit(seed, i, k + 2))
}

/// Presets; down to single triangles, rays and cones; and so with every test of triangles against
/// cells and with octants.
fn all_parameters() -> Vec<SpaceParameters> {
    let mut all = Vec::from(space_presets());
    for fine in finest_space() {
        let tested = SpaceParameters {
            nine_axes_below: u32::MAX,
            plane_test: true,
            octants: true,
            ..fine
        };
        all.extend([fine, tested]);
    }
    all
}

/// Presets, and down to the smallest with splits at the estimate; triangles are held against cells
/// by their boxes alone.
fn by_boxes() -> Vec<SpaceParameters> {
    let presets = space_presets().into_iter();
    let finest = finest_space().into_iter().map(|fine| SpaceParameters {
        estimate_from: 0,
        estimate_stride: 1,
        ..fine
    });
    let by_boxes = presets.chain(finest).map(|p| SpaceParameters {
        nine_axes_below: 0,
        ..p
    });
    by_boxes.collect()
}

/// Checks a batch as it is, and with origins of its own. However hard the case, the work is bounded
/// by a multiple of that of the naive step.
fn check_batch(mesh: &Mesh, batch: &Batch) {
    check_as(mesh, batch, true);
    if batch.shared_origin().is_some() {
        check_as(mesh, batch, false);
    }
}

fn check_as(mesh: &Mesh, batch: &Batch, own_origins: bool) {
    // Cones bring all of their rays into a cell.
    let rays = batch.len().next_multiple_of(64) as u64;
    let most = 1024 * rays * (mesh.len() as u64 + 1);
    for (mut parameters, grazing) in [(all_parameters(), true), (by_boxes(), false)] {
        if own_origins {
            // The presets are one.
            parameters.retain(|p| p.variant == Variant::Random);
        }
        let check = Check {
            mesh: mesh.clone(),
            batch: batch.clone(),
            parameters: parameters.iter().copied().map(Parameters::from).collect(),
            own_origins,
            grazing,
        };
        for (trace, parameters) in check.run().into_iter().zip(parameters) {
            let c = trace.counters;
            let work = c.nodes + c.ray_box + c.cone_box + c.triangle_box + c.ray_triangle;
            assert!(work <= most, "{c:#?}\n{parameters:?}");
        }
    }
}

/// A point on a triangle: inside, on an edge, or a corner.
fn target(mesh: &Mesh, i: usize) -> Vec3 {
    let triangles = mesh.triangles();
    let Triangle { a, b, c } = triangles[hash(1, i as u64, 0) as usize % triangles.len()];
    let [u, v] = [1, 2].map(|k| unit_f64(hash(1, i as u64, k)) as f32);
    match i % 8 {
        0 => a,
        1 => b,
        2 => a + u * (c - a),
        _ => a + 0.5 * u * (b - a) + 0.5 * v * (c - a),
    }
}

/// Rays from one point to places on the mesh.
fn rays_from(origin: Vec3, mesh: &Mesh, n: usize) -> Batch {
    let ray = |i| Ray::new(origin, target(mesh, i) - origin);
    (0..n).map(ray).collect()
}

/// Checks rays at places on the mesh from all around it and from within; from one point outside,
/// in the middle, and at a corner of a triangle.
fn check(mesh: &Mesh) {
    let bounds = mesh.bounds();
    let (center, reach) = (bounds.center(), bounds.extent().max_element());
    let own = (0..100).map(|i| {
        let origin = center + reach * vector(2, i, 0) * if i % 2 == 0 { 0.5 } else { 2.0 };
        Ray::new(origin, target(mesh, i) - origin)
    });
    check_batch(mesh, &own.collect());
    let outside = center + Vec3::new(1.5, -0.9, 0.7) * reach;
    let straight = center - Vec3::new(0.0, 0.0, 2.0 * reach);
    let corner = mesh.triangles()[mesh.len() / 2].b;
    for origin in [outside, straight, center, corner] {
        check_batch(mesh, &rays_from(origin, mesh, 70));
    }
}

#[test]
fn all_triangles_through_one_point() {
    let point = Vec3::new(0.25, -0.5, 0.125);
    for n in [20, 200] {
        let corner = |i, k| point + vector(3, i, k);
        let fan = (0..n).map(|i| Triangle::new(point, corner(i, 0), corner(i, 3)));
        check(&Mesh::new(fan.collect()));
        // And all through their middles: the third corner mirrors the others.
        let star = (0..n).map(|i| {
            let [a, b] = [0, 3].map(|k| vector(4, i, k));
            Triangle::new(point + a, point + b, point - (a + b))
        });
        check(&Mesh::new(star.collect()));
    }
    // Rays at the very point.
    let fan = (0..300).map(|i| {
        let corner = |k| point + vector(3, i, k);
        Triangle::new(point, corner(0), corner(3))
    });
    let at_point = (0..200).map(|i| {
        let origin = point + 2.0 * vector(5, i, 0);
        Ray::new(origin, point - origin)
    });
    check_batch(&Mesh::new(fan.collect()), &at_point.collect());
}

#[test]
fn identical_triangles() {
    let triangle = Triangle::new(
        Vec3::new(-1.0, -1.0, 0.25),
        Vec3::new(1.0, -1.0, -0.5),
        Vec3::new(0.0, 1.0, 0.125),
    );
    for n in [2, 16, 100] {
        check(&Mesh::new(vec![triangle; n]));
    }
    // In a flat box of no extent on two axes as well: a triangle without an area, and so no mesh.
    let line = Triangle::new(Vec3::ZERO, Vec3::X, 2.0 * Vec3::X);
    check(&Mesh::new(vec![line; 100]));
}

#[test]
fn triangles_larger_than_the_cells() {
    // All through the middle of the box, and as large as it.
    for n in [20, 200] {
        let large = (0..n).map(|i| {
            let shift = 0.1 * vector(6, i, 9);
            let [a, b] = [0, 3].map(|k| 100.0 * vector(6, i, k).normalize());
            Triangle::new(shift + a, shift + b, shift - (a + b))
        });
        let mesh = Mesh::new(large.collect());
        check(&mesh);
        // Rays that stay in the middle.
        let short = (0..200).map(|i| Ray {
            tmax: 0.5,
            ..Ray::new(vector(7, i, 0), vector(7, i, 3))
        });
        check_batch(&mesh, &short.collect());
    }
}

/// Triangles of a soup, with a function applied to their corners.
fn moved_soup(n: usize, f: impl Fn(Vec3) -> Vec3) -> Mesh {
    let triangles = soup(n, 8).into_triangles().into_iter();
    let moved = triangles.map(|t| Triangle::new(f(t.a), f(t.b), f(t.c)));
    Mesh::new(moved.filter(Triangle::is_valid).collect())
}

#[test]
fn zero_thickness_on_an_axis() {
    for axis in 0..3 {
        for place in [[0.0, 0.5], [-0.0, 1e4], [0.0, -1e-3]][axis] {
            let flat = moved_soup(60, |mut p| {
                p[axis] = place;
                p
            });
            check(&flat);
        }
    }
    // On two axes there is no area.
    check(&moved_soup(100, |p| Vec3::new(p.x, 1.0, -2.0)));
}

#[test]
fn all_triangles_in_one_tilted_plane() {
    // On a grid, in the plane x + y + z = 4, to the bit.
    let on_grid = |p: Vec3| {
        let p = (p * 64.0).round() / 64.0;
        Vec3::new(p.x, p.y, 4.0 - p.x - p.y)
    };
    check(&moved_soup(300, on_grid));
    // In a plane to within rounding.
    check(&moved_soup(300, |p| {
        Vec3::new(p.x, p.y, 0.3 * p.x - 0.7 * p.y)
    }));
}

#[test]
fn rays_in_the_plane_of_a_flat_mesh() {
    for axis in 0..3 {
        let in_plane = |mut v: Vec3| {
            v[axis] = 0.0;
            v
        };
        // Large triangles over each other: every cell has all of them, and no ray ends before.
        let large = (0..100).map(|i| {
            let corner = |k| in_plane(Vec3::splat(0.25) + vector(9, i, k));
            Triangle::new(corner(0), corner(3), corner(6))
        });
        let mesh = Mesh::new(large.collect());
        let direction = |i| {
            let mut d = in_plane(vector(10, i, 3));
            d[axis] = [0.0, -0.0, 1e-39, -1e-39, 1e-20][i % 5];
            d
        };
        let own = (0..100).map(|i| Ray::new(in_plane(1.5 * vector(10, i, 0)), direction(i)));
        check_batch(&mesh, &own.collect());
        for origin in [Vec3::ZERO, in_plane(Vec3::splat(-3.0))] {
            let shared = (0..100).map(|i| Ray::new(origin, direction(i)));
            check_batch(&mesh, &shared.collect());
        }
    }
}

#[test]
fn many_rays_in_the_plane_of_many_large_triangles_end() {
    let large = (0..2000).map(|i| {
        let corner = |k| vector(11, i, k).with_z(0.0);
        Triangle::new(corner(0), corner(3), corner(6))
    });
    let mesh = Mesh::new(large.collect());
    let own =
        (0..2000).map(|i| Ray::new(vector(12, i, 0).with_z(0.0), vector(12, i, 3).with_z(0.0)));
    let shared = (0..2000).map(|i| Ray::new(Vec3::ZERO, vector(12, i, 3).with_z(0.0)));
    let (own, shared): (Batch, Batch) = (own.collect(), shared.collect());
    let parameters = space_presets().into_iter().chain(finest_space());
    for tracer in parameters.map(Tracer::new) {
        for batch in [&own, &shared] {
            let mut hits = Hits::misses(batch.len());
            let mut workspace = tracer.workspace(batch.len(), mesh.len());
            let c = tracer
                .nearest(&mesh, batch, &mut workspace, &mut hits)
                .counters;
            assert_eq!(hits.hit_count(), 0, "{tracer:?}");
            let work = c.ray_box + c.cone_box + c.triangle_box + c.ray_triangle;
            assert!(work <= 64 * 2000 * 2000, "{c:#?}\n{tracer:?}");
        }
    }
}

#[test]
fn one_and_none() {
    let triangle = Triangle::new(Vec3::X, Vec3::Y, Vec3::Z);
    let meshes = [
        Mesh::default(),
        Mesh::new(vec![triangle]),
        Mesh::new(vec![Triangle::new(Vec3::NAN, Vec3::X, Vec3::Y)]),
        Mesh::new(vec![Triangle::new(Vec3::X, Vec3::X, Vec3::Y); 40]),
        soup(100, 1),
    ];
    let at = Ray::new(Vec3::ZERO, Vec3::ONE);
    let batches: [Vec<Ray>; 5] = [
        vec![],
        vec![at],
        vec![Ray::new(Vec3::ZERO, -Vec3::ONE)],
        vec![Ray::new(Vec3::NAN, Vec3::Z)],
        vec![Ray { tmin: -1.0, ..at }, at, Ray::new(Vec3::X, Vec3::ZERO)],
    ];
    for mesh in &meshes {
        for batch in &batches {
            check_batch(mesh, &batch.iter().copied().collect());
        }
    }
}

/// Walls of triangles on the planes x, y, z = −1, −1/2, 0, 1/2, 1, which are the places where the
/// box is split in the middle; with some left out, and slanted triangles on the same grid.
fn lattice() -> Mesh {
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for cell in 0..5 * 16 {
            let [plane, u, v] = [cell / 16, cell / 4 % 4, cell % 4].map(|i| i as f32 / 2.0 - 1.0);
            let corner = |du: f32, dv: f32| {
                let mut p = Vec3::ZERO;
                p[axis] = plane;
                p[(axis + 1) % 3] = u + du;
                p[(axis + 2) % 3] = v + dv;
                p
            };
            let [a, b] = [corner(0.0, 0.0), corner(0.5, 0.5)];
            let halves = [
                Triangle::new(a, b, corner(0.5, 0.0)),
                Triangle::new(b, a, corner(0.0, 0.5)),
            ];
            for (half, triangle) in halves.into_iter().enumerate() {
                if !hash(13, 16 * 5 * axis as u64 + cell as u64, half as u64).is_multiple_of(3) {
                    triangles.push(triangle);
                }
            }
        }
    }
    let on_grid = |i, k| (4.0 * vector(14, i, k)).round() / 4.0;
    triangles.extend((0..60).map(|i| Triangle::new(on_grid(i, 0), on_grid(i, 3), on_grid(i, 6))));
    // Whatever was left out, the box is that of the lattice.
    let (low, high) = (Vec3::NEG_ONE, Vec3::ONE);
    triangles.push(Triangle::new(low, high, Vec3::new(1.0, -1.0, 1.0)));
    Mesh::new(triangles)
}

/// Components of directions that run in a plane of the lattice, leave it, and hardly leave it.
const STEPS: [f32; 9] = [0.0, -0.0, 1.0, -1.0, 0.5, -0.25, 1e-6, -1e-6, 1e-39];

/// Directions of these components: each, or every so-manieth.
fn directions(step: usize) -> impl Iterator<Item = Vec3> {
    let all = (0..9 * 9 * 9)
        .step_by(step)
        .map(|i| Vec3::from([i % 9, i / 9 % 9, i / 81].map(|k| STEPS[k])));
    all.filter(|d| d.abs().max_element() > 1e-9)
}

#[test]
fn rays_that_start_on_or_run_in_planes_where_cells_are_split() {
    for (scale, shift) in [
        (Vec3::ONE, Vec3::ZERO),
        // The axes in another order of length; splits in the middle stay exact.
        (Vec3::new(1.0, 4.0, 2.0), Vec3::new(0.0, 0.0, 2.0)),
        (Vec3::new(0.5, 0.25, 1.0), Vec3::new(16.0, -8.0, 0.0)),
    ] {
        let at = |p: Vec3| p * scale + shift;
        let triangles = lattice().into_triangles().into_iter();
        let mesh = triangles.map(|t| Triangle::new(at(t.a), at(t.b), at(t.c)));
        let mesh = Mesh::new(mesh.collect());
        let own = directions(1).enumerate().map(|(i, d)| {
            let grid = [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 0.25];
            let place = [0, 1, 2].map(|k| grid[hash(15, i as u64, k) as usize % grid.len()]);
            Ray::new(at(Vec3::from(place)), d * scale)
        });
        check_batch(&mesh, &own.collect());
        for origin in [
            Vec3::ZERO,
            Vec3::new(-0.0, -0.0, -0.0),
            Vec3::new(0.0, 0.125, -0.375),
            Vec3::new(0.5, 0.0, 0.25),
            Vec3::new(-1.0, 0.0, 0.5),
            Vec3::new(0.0, -3.0, 0.0),
            Vec3::new(2.0, 2.0, 2.0),
        ] {
            let shared = directions(4).map(|d| Ray::new(at(origin), d * scale));
            check_batch(&mesh, &shared.collect());
        }
    }
}

#[test]
fn rays_that_are_all_the_same() {
    let mesh = soup(500, 16);
    let hits = Ray::new(Vec3::new(0.3, -2.0, 0.1), Vec3::Y);
    let misses = Ray::new(Vec3::new(0.3, -2.0, 0.1), -Vec3::Y);
    let short = Ray { tmax: 2.0, ..hits };
    for ray in [hits, misses, short] {
        check_batch(&mesh, &std::iter::repeat_n(ray, 300).collect());
    }
}

#[test]
fn sizes_from_a_millionth_to_a_million_in_one_mesh() {
    let size = |i: usize| 10f32.powf(6.0 * unit(17, i, 20));
    let triangles = (0..400).map(|i| {
        let center = size(i + 1000) * vector(17, i, 0);
        let corner = |k| center + size(i) * vector(17, i, k);
        Triangle::new(corner(3), corner(6), corner(9))
    });
    check(&Mesh::new(triangles.collect()));
}

/// A closed room of 12 triangles around the origin.
fn room(half: Vec3) -> impl Iterator<Item = Triangle> {
    (0..3).flat_map(move |axis| {
        [-1.0, 1.0].into_iter().flat_map(move |side| {
            let corner = |u: f32, v: f32| {
                let mut p = Vec3::ZERO;
                p[axis] = side;
                p[(axis + 1) % 3] = u;
                p[(axis + 2) % 3] = v;
                p * half
            };
            let [a, c] = [corner(-1.0, -1.0), corner(1.0, 1.0)];
            [
                Triangle::new(a, corner(1.0, -1.0), c),
                Triangle::new(a, c, corner(-1.0, 1.0)),
            ]
        })
    })
}

#[test]
fn a_teapot_in_a_stadium() {
    let teapot = |scale: f32| {
        let place = Vec3::new(37.0, -11.0, 5.0);
        let small = soup(1500, 18).into_triangles().into_iter();
        let small = small.map(|t| [t.a, t.b, t.c].map(|p| place + scale * p));
        let small: Vec<Triangle> = small.map(|[a, b, c]| Triangle::new(a, b, c)).collect();
        (place, small)
    };
    for scale in [0.1, 1e-3] {
        let (place, mut triangles) = teapot(scale);
        triangles.extend(room(Vec3::new(100.0, 60.0, 20.0)));
        let mesh = Mesh::new(triangles);
        check(&mesh);
        // From beside the teapot.
        check_batch(
            &mesh,
            &rays_from(place + scale * Vec3::new(1.0, 2.0, -3.0), &mesh, 300),
        );
    }
}

#[test]
fn meshes_far_from_the_origin() {
    let far = Vec3::new(148_376.0, 1234.0, -223_423.0);
    for scale in [1.0, 100.0] {
        let mesh = moved_soup(300, |p| far + scale * p);
        check(&mesh);
        // And from the origin.
        check_batch(&mesh, &rays_from(Vec3::ZERO, &mesh, 200));
    }
}
