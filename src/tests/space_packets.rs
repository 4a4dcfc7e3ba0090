//! Packets of rays of every shape, taken for cones: partial, wide, with invalid rays, and seen from
//! everywhere. The hits are those of the naive step.

mod common;

use common::{Check, brute_force, finest_space, soup};
use dacrt::random::{hash, unit_f64};
use dacrt::workloads::{Camera, Film, RayType, View, Workload};
use dacrt::*;
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use std::f32::consts::{PI, TAU};

/// Narrow cones down to where few are left; wide ones down to the last; and down to the last triangle
/// and ray too.
fn all_parameters() -> Vec<Parameters> {
    let preset = SpaceParameters::MORA2011_CONES;
    let to_the_last = SpaceParameters {
        cone_limit: 1,
        widest_cone: 60.0,
        ..preset
    };
    let [.., finest, _] = finest_space();
    assert_eq!(finest.variant, Variant::Cones);
    [preset, to_the_last, finest].map(Parameters::from).into()
}

/// The traces with [`all_parameters`].
fn check(mesh: &Mesh, batch: &Batch) -> Vec<Trace> {
    let check = Check {
        mesh: mesh.clone(),
        batch: batch.clone(),
        parameters: all_parameters(),
        own_origins: false,
        grazing: false,
    };
    let traces = check.run();
    for trace in &traces {
        let expected = match batch.shared_origin() {
            Some(_) => Variant::Cones,
            None => Variant::Random,
        };
        assert_eq!(trace.variant, Some(expected));
    }
    traces
}

fn unit(seed: u64, i: usize) -> f32 {
    unit_f64(hash(seed, i as u64, 0)) as f32
}

/// `n` unit vectors up to `half_angle` away from an axis, the first ones right at its edge.
fn cone(axis: Vec3, half_angle: f32, n: usize, seed: u64) -> impl Iterator<Item = Vec3> {
    let axis = axis.as_dvec3().normalize();
    let (u, v) = axis.any_orthonormal_pair();
    (0..n).map(move |i| {
        let angle = if i < 4 { 1.0 } else { unit(seed, 2 * i).sqrt() } * half_angle;
        let (sin, cos) = f64::from(angle).sin_cos();
        let (y, x) = f64::from(TAU * unit(seed, 2 * i + 1)).sin_cos();
        (cos * axis + sin * (x * u + y * v)).as_vec3()
    })
}

fn batch(origin: Vec3, directions: impl Iterator<Item = Vec3>) -> Batch {
    directions.map(|d| Ray::new(origin, d)).collect()
}

#[test]
fn pictures_of_any_size() {
    let mesh = soup(600, 1);
    let point_light = Some(Vec3::new(0.3, 2.0, 0.4));
    for (width, height) in [(1, 1), (7, 5), (8, 8), (9, 1), (20, 12), (37, 24), (64, 64)] {
        for (eye, fov) in [
            (DVec3::new(0.1, 0.2, 4.0), 40.0),
            (DVec3::new(0.1, 0.2, 0.9), 60.0),
            (DVec3::new(0.0, 0.0, 0.0), 150.0),
        ] {
            let camera = Camera::new(eye, DVec3::new(0.0, 0.1, -0.5), DVec3::Y, fov).unwrap();
            let film = Film::new(width, height, 1).unwrap();
            let view = View {
                point_light,
                ..View::of(camera)
            };
            let mut workload = Workload::new(&mesh, view, film, 0).unwrap();
            for ray_type in [RayType::Primary, RayType::ShadowPoint] {
                let rays = workload.rays(ray_type, &mut |batch| {
                    let mut hits = Hits::misses(batch.len());
                    let tracer = Tracer::new(brute_force());
                    let mut workspace = tracer.workspace(batch.len(), mesh.len());
                    tracer.nearest(&mesh, batch, &mut workspace, &mut hits);
                    hits
                });
                let batch = rays.unwrap().batch;
                let traces = check(&mesh, &batch);
                if (width, fov) == (64, 40.0) {
                    let tested = traces[1].counters.cone_box;
                    assert!(tested > 100, "{ray_type}: {tested} cones tested");
                }
            }
        }
    }
}

#[test]
fn cones_save_tests_of_rays() {
    let mesh = soup(600, 1);
    let eye = DVec3::new(0.1, 0.2, 4.0);
    let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, 35.0).unwrap();
    let film = Film::new(256, 256, 1).unwrap();
    let mut workload = Workload::new(&mesh, View::of(camera), film, 0).unwrap();
    let rays = workload.rays(RayType::Primary, &mut |_| unreachable!());
    let batch = rays.unwrap().batch;
    let tests = |parameters: SpaceParameters| {
        let tracer = Tracer::new(parameters);
        let mut workspace = tracer.workspace(batch.len(), mesh.len());
        let mut hits = Hits::misses(batch.len());
        let c = tracer
            .nearest(&mesh, &batch, &mut workspace, &mut hits)
            .counters;
        (c.ray_box, c.cone_box)
    };
    let (basic, no_cones) = tests(SpaceParameters::MORA2011);
    let (rays, cones) = tests(SpaceParameters::MORA2011_CONES);
    assert_eq!(no_cones, 0);
    assert!(2 * (rays + cones) < basic, "{rays} + {cones}, {basic}");
}

#[test]
fn numbers_of_rays_around_whole_packets() {
    let mesh = soup(300, 2);
    let origin = Vec3::new(0.2, -0.3, 2.5);
    for n in [1, 2, 15, 16, 17, 63, 64, 65, 127, 128, 129, 1000] {
        check(&mesh, &batch(origin, cone(-origin, 0.3, n, 3)));
    }
}

#[test]
fn packets_that_end_at_jumps() {
    let mesh = soup(300, 15);
    let origin = Vec3::new(0.2, -0.3, 2.5);
    for (len, n) in [
        (1, 100),
        (7, 200),
        (8, 199),
        (8, 200),
        (8, 201),
        (9, 300),
        (65, 300),
    ] {
        for half_angle in [0.0, 1e-4, 0.02] {
            let jumping = (0..n).map(|i| {
                let toward = Vec3::new(unit(16, i / len), unit(17, i / len), 0.5) - origin;
                let mut packet = cone(toward, half_angle, len, 18);
                packet.nth(i % len).unwrap()
            });
            check(&mesh, &batch(origin, jumping));
        }
    }
}

#[test]
fn packets_wider_than_cones_can_be() {
    let mesh = soup(300, 4);
    // All around, in turns that a packet is a part of, a whole or several of.
    for (turns, n) in [(8.0, 1000), (20.0, 1000), (200.0, 1000), (3.0, 64)] {
        let around = (0..n).map(|i| {
            let y = 1.0 - 2.0 * (i as f32 + 0.5) / n as f32;
            let (sin, cos) = (turns * TAU * i as f32 / n as f32).sin_cos();
            let radius = (1.0 - y * y).sqrt();
            Vec3::new(radius * cos, y, radius * sin)
        });
        let directions: Vec<Vec3> = around.collect();
        let widest = |packet: &[Vec3]| {
            let cosines = packet.iter().map(|&d| packet[0].dot(d));
            cosines.fold(1f32, f32::min)
        };
        let wide = directions.chunks(64).any(|packet| widest(packet) < -0.5);
        assert!(wide, "two rays are more than 120 degrees apart");
        for origin in [
            Vec3::ZERO,
            Vec3::new(1.0, 1.0, 1.0),
            Vec3::new(0.0, 0.0, 3.0),
        ] {
            check(&mesh, &batch(origin, directions.iter().copied()));
        }
    }
    // Rays straight against each other, which have no direction on average.
    let opposite = (0..128).map(|i| if i % 2 == 0 { Vec3::X } else { Vec3::NEG_X });
    check(&mesh, &batch(Vec3::new(0.0, 0.1, 0.2), opposite));
    let axes = [
        Vec3::X,
        Vec3::NEG_X,
        Vec3::Y,
        Vec3::NEG_Y,
        Vec3::Z,
        Vec3::NEG_Z,
    ];
    let along_axes = (0..128).map(|i| axes[i % 6]);
    check(&mesh, &batch(Vec3::new(0.0, 0.1, 0.2), along_axes));
}

#[test]
fn half_angles_from_nothing_to_all() {
    let mesh = soup(300, 5);
    for degrees in [
        0.0f32, 1e-6, 1e-3, 1.0, 45.0, 59.0, 59.999, 60.0, 60.001, 61.0, 89.9, 90.0, 91.0, 180.0,
    ] {
        for (k, axis) in [Vec3::Z, Vec3::NEG_Y, Vec3::new(1.0, -2.0, 3.0)]
            .into_iter()
            .enumerate()
        {
            for origin in [Vec3::new(0.05, 0.1, -0.2), -2.5 * axis.normalize()] {
                let packet = cone(axis, degrees.to_radians(), 200, 6 + k as u64);
                check(&mesh, &batch(origin, packet));
            }
        }
    }
}

#[test]
fn invalid_rays_in_packets() {
    let mesh = soup(300, 7);
    let origin = Vec3::new(0.2, -0.3, 2.5);
    let rays: Vec<Ray> = cone(-origin, 0.4, 400, 8)
        .map(|d| Ray::new(origin, d))
        .collect();
    let spoilt: [fn(&mut Ray); 5] = [
        |ray| ray.direction = Vec3::ZERO,
        |ray| ray.direction.y = f32::NAN,
        |ray| ray.direction.z = f32::INFINITY,
        |ray| ray.origin.x = f32::NAN,
        |ray| ray.tmin = -1.0,
    ];
    let choices: [fn(usize) -> bool; 6] = [
        |i| i % 3 == 0,
        |i| i % 2 == 1,
        |i| i % 64 == 0,
        |i| i % 64 != 5,
        |i| i / 64 == 1,
        |i| i / 64 != 2,
    ];
    for spoil in spoilt {
        for is_chosen in choices {
            let mut rays = rays.clone();
            let chosen = rays.iter_mut().enumerate().filter(|(i, _)| is_chosen(*i));
            chosen.for_each(|(_, ray)| spoil(ray));
            let invalid = rays.iter().filter(|ray| !ray.is_valid()).count();
            for trace in check(&mesh, &rays.into_iter().collect()) {
                assert_eq!(trace.invalid_rays, invalid as u64);
            }
        }
    }
}

#[test]
fn rays_of_any_length_and_interval_in_packets() {
    let mesh = soup(300, 9);
    for origin in [Vec3::new(0.2, -0.3, 2.5), Vec3::new(0.0, 0.0, 0.5)] {
        let directions = cone(-origin, 0.5, 500, 10);
        let rays = directions.enumerate().map(|(i, mut d)| {
            match i % 11 {
                0 => d.x = 0.0,
                1 => (d.x, d.y) = (-0.0, 0.0),
                2 => d.y = 1e-39,
                _ => {}
            }
            let length = 10f32.powf(16.0 * unit(11, i) - 8.0);
            let mut ray = Ray::new(origin, length * d);
            match i % 4 {
                0 => ray.tmax = 4.0 * unit(12, i) / length,
                1 => ray.tmin = 4.0 * unit(12, i) / length,
                _ => {}
            }
            ray
        });
        check(&mesh, &rays.collect());
    }
}

/// The box from each of the places below, in and above its planes on every axis: all contours that
/// it can have, and the limits between them.
#[test]
fn boxes_seen_from_all_sides() {
    let mesh = soup(200, 13);
    let bounds = mesh.bounds();
    for i in 0..5 * 5 * 5 {
        let place = [i % 5, i / 5 % 5, i / 25];
        let origin = Vec3::from([0, 1, 2].map(|axis| {
            let (low, high) = (bounds.min[axis], bounds.max[axis]);
            [
                2.0 * low - high,
                low,
                0.5 * (low + high),
                high,
                2.0 * high - low,
            ][place[axis]]
        }));
        // Narrow packets at corners and beside them, and a wider one at the middle.
        let at_corners = (0..8).flat_map(|corner| {
            let pick = |axis: usize| [bounds.min, bounds.max][corner >> axis & 1][axis];
            let corner = Vec3::from([pick(0), pick(1), pick(2)]);
            let beside = corner + 0.02 * bounds.extent();
            [corner, beside].map(|target| (target - origin, 0.01))
        });
        let packets = at_corners.chain([(bounds.center() - origin, 0.3)]);
        let directions = packets
            .filter(|(axis, _)| *axis != Vec3::ZERO)
            .flat_map(|(axis, angle)| cone(axis, angle, 64, 14 + i as u64));
        check(&mesh, &batch(origin, directions));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn packets_of_any_kind(
        origin in [-2f32..2.0, -2f32..2.0, -2f32..2.0],
        packets in prop::collection::vec(([-1f32..1.0, -1f32..1.0, -1f32..1.0], -14f32..1.2), 1..12),
        part in 1usize..=64,
        triangles in 1usize..300,
        seed in any::<u64>(),
    ) {
        let origin = Vec3::from(origin);
        let directions = packets.iter().flat_map(|(axis, log_angle)| {
            let axis = if Vec3::from(*axis) == Vec3::ZERO { Vec3::X } else { Vec3::from(*axis) };
            cone(axis, log_angle.exp().min(PI), part, seed)
        });
        check(&soup(triangles, seed), &batch(origin, directions));
    }
}
