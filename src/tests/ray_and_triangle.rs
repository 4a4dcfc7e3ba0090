//! Whether and where a ray hits a triangle: the contracts "Ray", "Triangle" and "Hit", on every
//! instruction set, by all methods, with own and with shared origins.

mod common;

use common::presets_and_finest;
use dacrt::*;
use glam::Vec3;
use proptest::prelude::*;

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A large triangle in the plane z = `z`.
fn wall(z: f32) -> Triangle {
    Triangle::new(v(-64.0, -64.0, z), v(64.0, -64.0, z), v(0.0, 96.0, z))
}

/// The nearest hits, the same of all methods, and what the trace was like; any-hit traces are
/// checked against them.
fn nearest(mesh: &Mesh, rays: &[Ray]) -> (Vec<(f32, u32)>, Trace) {
    let batch: Batch = rays.iter().copied().collect();
    let mut found = None;
    for parameters in presets_and_finest() {
        let mut workspace = Workspace::new(&parameters, batch.len(), mesh.len());
        for isa in Isa::available() {
            let tracer = Tracer::new(parameters).with_isa(isa);
            let mut hits = Hits::misses(batch.len());
            let trace = tracer.nearest(mesh, &batch, &mut workspace, &mut hits);
            let mut occluded = vec![2; batch.len()];
            tracer.any(mesh, &batch, &mut workspace, &mut occluded);
            for (&prim, &occluded) in hits.prim.iter().zip(&occluded) {
                assert_eq!(occluded, (prim != MISS) as u8, "any hit, {tracer:?}");
            }
            for (&t, &prim) in hits.t.iter().zip(&hits.prim) {
                assert_eq!(t == f32::INFINITY, prim == MISS, "{tracer:?}");
            }
            let records: Vec<(f32, u32)> = hits.t.iter().copied().zip(hits.prim).collect();
            let (first, first_trace) = found.get_or_insert_with(|| (records.clone(), trace));
            assert_eq!(&records, first, "{tracer:?}");
            let about_the_rays = |t: &Trace| (t.shared_origin, t.invalid_rays);
            assert_eq!(about_the_rays(&trace), about_the_rays(first_trace));
            if trace.invalid_rays == batch.len() as u64 {
                let c = trace.counters;
                assert_eq!(c.ray_box + c.cone_box + c.ray_triangle, 0, "{tracer:?}");
            }
        }
    }
    found.unwrap()
}

/// The hit of one ray, with a shared origin, and with origins of their own thanks to another ray.
fn hit(triangles: &[Triangle], ray: Ray) -> Option<(f32, u32)> {
    let mesh = Mesh::new(triangles.to_vec());
    let (shared, trace) = nearest(&mesh, &[ray]);
    assert_eq!(trace.shared_origin, ray.is_valid());
    let other = Ray::new(v(1e3, 1e3, 1e3), Vec3::ONE);
    let (own, trace) = nearest(&mesh, &[ray, other]);
    assert_eq!(trace.shared_origin, !ray.is_valid());
    assert_eq!(own[0], shared[0], "own and shared origins");
    assert_eq!(own[1].1, MISS);
    let (t, prim) = shared[0];
    (prim != MISS).then_some((t, prim))
}

fn ray(origin: Vec3, direction: Vec3, tmin: f32, tmax: f32) -> Ray {
    Ray {
        origin,
        tmin,
        direction,
        tmax,
    }
}

/// Directions that meet the wall at z = 2 at t = 2 from the origin, exactly; with zero components.
const TO_THE_WALL: [Vec3; 5] = [
    v(0.0, 0.0, 1.0),
    v(-0.0, 0.25, 1.0),
    v(0.5, 0.0, 1.0),
    v(0.5, -0.25, 1.0),
    v(1e-39, -1e-39, 1.0),
];

#[test]
fn tmin_is_exclusive_and_tmax_inclusive() {
    for d in TO_THE_WALL {
        let at = |tmin, tmax| hit(&[wall(2.0)], ray(Vec3::ZERO, d, tmin, tmax));
        assert_eq!(at(0.0, f32::INFINITY), Some((2.0, 0)));
        assert_eq!(at(0.0, 2.0), Some((2.0, 0)));
        assert_eq!(at(0.0, 2f32.next_down()), None);
        assert_eq!(at(2.0, 3.0), None);
        assert_eq!(at(2f32.next_down(), 2.0), Some((2.0, 0)));
        assert_eq!(at(2f32.next_up(), 3.0), None);
    }
}

#[test]
fn a_hit_at_the_origin_is_none() {
    for d in TO_THE_WALL {
        let from_the_wall = ray(v(0.0, 0.0, 2.0), d, 0.0, f32::INFINITY);
        assert_eq!(hit(&[wall(2.0)], from_the_wall), None);
        let negative_zero = Ray {
            tmin: -0.0,
            ..from_the_wall
        };
        assert_eq!(hit(&[wall(2.0)], negative_zero), None);
    }
}

#[test]
fn t_is_in_units_of_the_direction_s_length() {
    for k in [-20, -3, 0, 5, 20] {
        let scale = 2f32.powi(k);
        for d in TO_THE_WALL {
            let ray = Ray::new(Vec3::ZERO, d * scale);
            assert_eq!(hit(&[wall(2.0)], ray), Some((2.0 / scale, 0)));
        }
    }
}

#[test]
fn both_sides_count() {
    let Triangle { a, b, c } = wall(2.0);
    for triangle in [Triangle::new(a, b, c), Triangle::new(c, b, a)] {
        let front = Ray::new(Vec3::ZERO, Vec3::Z);
        let back = Ray::new(v(0.0, 0.0, 4.0), -Vec3::Z);
        assert_eq!(hit(&[triangle], front), Some((2.0, 0)));
        assert_eq!(hit(&[triangle], back), Some((2.0, 0)));
    }
}

#[test]
fn a_triangle_behind_is_not_hit() {
    assert_eq!(hit(&[wall(-2.0)], Ray::new(Vec3::ZERO, Vec3::Z)), None);
}

#[test]
fn a_ray_in_the_plane_of_a_triangle_misses() {
    let triangle = Triangle::new(v(1.0, -1.0, 2.0), v(3.0, 0.0, 2.0), v(1.0, 1.0, 2.0));
    for d in [v(1.0, 0.0, 0.0), v(1.0, 0.25, 0.0), v(2.0, -0.125, -0.0)] {
        for x in [0.0, 1.5, 5.0] {
            assert_eq!(hit(&[triangle], Ray::new(v(x, 0.0, 2.0), d)), None);
        }
    }
    // A tilted plane on a grid, x + y + z = 4.
    let tilted = Triangle::new(v(4.0, 0.0, 0.0), v(0.0, 4.0, 0.0), v(0.0, 0.0, 4.0));
    assert_eq!(
        hit(&[tilted], Ray::new(v(8.0, -2.0, -2.0), v(-2.0, 1.0, 1.0))),
        None
    );
}

#[test]
fn degenerate_triangles_are_never_hit() {
    let (a, b) = (v(-1.0, 0.0, 2.0), v(3.0, 0.0, 2.0));
    let degenerate = [
        Triangle::new(a, a, a),
        Triangle::new(a, a, b),
        Triangle::new(a, b, a),
        Triangle::new(b, a, a),
        // Collinear on a grid.
        Triangle::new(a, b, v(1.0, 0.0, 2.0)),
        Triangle::new(v(-1.0, -2.0, 1.0), v(0.0, 0.0, 2.0), v(3.0, 6.0, 5.0)),
    ];
    for triangle in degenerate {
        for target in [a, b, v(0.0, 0.0, 2.0), v(1.0, 0.0, 2.0)] {
            for origin in [Vec3::ZERO, v(0.0, -1.0, 0.0), v(-1.0, 0.0, -5.0)] {
                assert_eq!(hit(&[triangle], Ray::new(origin, target - origin)), None);
            }
        }
    }
    // They keep their number.
    let mut triangles = degenerate.to_vec();
    triangles.push(wall(2.0));
    let number = degenerate.len() as u32;
    let ray = Ray::new(Vec3::ZERO, v(0.25, 0.25, 1.0));
    assert_eq!(hit(&triangles, ray), Some((2.0, number)));
}

#[test]
fn invalid_triangles_are_never_hit_and_keep_their_number() {
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, 1.844e18, -2e18] {
        let mut triangle = wall(1.0);
        triangle.b.x = bad;
        let mesh = [triangle, wall(2.0)];
        assert_eq!(Mesh::new(mesh.to_vec()).dropped(), 1);
        let ray = Ray::new(Vec3::ZERO, v(0.125, 0.0, 1.0));
        assert_eq!(hit(&mesh, ray), Some((2.0, 1)));
    }
}

#[test]
fn a_hit_at_infinite_t_is_none() {
    let far = 1e9;
    let triangle = Triangle::new(v(-far, -far, far), v(far, -far, far), v(0.0, far, far));
    let with_length = |length| hit(&[triangle], Ray::new(Vec3::ZERO, Vec3::Z * length));
    assert!(with_length(1e-9).is_some());
    assert!(with_length(1e-29).is_some());
    assert_eq!(with_length(1e-30), None);
    assert_eq!(with_length(1e-35), None);
}

#[test]
fn of_equal_t_the_lowest_prim_wins_in_any_order() {
    let rays: Vec<Ray> = (0..200)
        .map(|i| {
            Ray::new(
                v((i % 20) as f32 / 2.0 - 5.0, (i / 20) as f32 / 2.0, 0.0),
                Vec3::Z,
            )
        })
        .collect();
    // Walls at exactly two depths, of many sizes, all around the middle.
    let walls: Vec<Triangle> = (0..40)
        .map(|i| {
            let scale = 1.0 / (1 + i % 4) as f32;
            let Triangle { a, b, c } = wall(if i % 3 == 0 { 2.0 } else { 3.0 });
            let shrunk = |p: Vec3| v(p.x * scale, p.y * scale, p.z);
            Triangle::new(shrunk(a), shrunk(b), shrunk(c))
        })
        .collect();
    for step in [1, 3, 7, 39] {
        for start in [0, 11, 25] {
            let order: Vec<usize> = (0..40).map(|i| (start + i * step) % 40).collect();
            let mesh = Mesh::new(order.iter().map(|&i| walls[i]).collect());
            // All rays are inside every wall, so that the nearest are those at z = 2.
            let lowest = order.iter().position(|&i| i % 3 == 0).unwrap() as u32;
            let (hits, _) = nearest(&mesh, &rays);
            assert!(hits.iter().all(|&h| h == (2.0, lowest)), "{hits:?}");
        }
    }
}

#[test]
fn every_kind_of_invalid_ray_is_a_counted_miss() {
    let good = Ray::new(Vec3::ZERO, v(0.125, 0.25, 1.0));
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    let mut invalid = vec![
        Ray {
            direction: Vec3::ZERO,
            ..good
        },
        Ray {
            direction: v(-0.0, 0.0, -0.0),
            ..good
        },
        Ray { tmin: -1.0, ..good },
        Ray {
            tmin: -f32::MIN_POSITIVE,
            ..good
        },
        Ray { tmin: nan, ..good },
        Ray { tmax: nan, ..good },
        Ray { tmax: -1.0, ..good },
        Ray { tmax: 0.0, ..good },
        Ray { tmax: -0.0, ..good },
        Ray {
            tmin: 5.0,
            tmax: 5.0,
            ..good
        },
        Ray {
            tmin: 5.0,
            tmax: 4.0,
            ..good
        },
        Ray {
            tmin: inf,
            tmax: inf,
            ..good
        },
        Ray {
            tmin: 0.0,
            tmax: -inf,
            ..good
        },
    ];
    for axis in 0..3 {
        for bad in [nan, inf, -inf] {
            let (mut in_origin, mut in_direction) = (good, good);
            in_origin.origin[axis] = bad;
            in_direction.direction[axis] = bad;
            invalid.extend([in_origin, in_direction]);
        }
    }
    let mesh = Mesh::new((0..50).map(|i| wall(2.0 + i as f32)).collect());
    for &bad in &invalid {
        assert!(!bad.is_valid(), "{bad:?}");
        let (hits, trace) = nearest(&mesh, &[bad]);
        assert_eq!((hits[0].1, trace.invalid_rays), (MISS, 1), "{bad:?}");
    }
    // Among good rays they change nothing.
    let mut rays = Vec::new();
    for &bad in &invalid {
        rays.extend([bad, good, bad, good]);
    }
    let (hits, trace) = nearest(&mesh, &rays);
    assert_eq!(trace.invalid_rays, 2 * invalid.len() as u64);
    assert!(trace.shared_origin, "invalid rays have no say");
    for (i, &h) in hits.iter().enumerate() {
        assert_eq!(
            h,
            if i % 2 == 0 {
                (f32::INFINITY, MISS)
            } else {
                (2.0, 0)
            }
        );
    }
}

#[test]
fn an_invalid_any_hit_ray_with_tmax_minus_one_is_not_occluded() {
    // −1 is also the mark of an occluded ray in the kernels.
    let mesh = Mesh::new(vec![wall(2.0)]);
    let invalid = ray(Vec3::ZERO, Vec3::Z, 0.0, -1.0);
    let (hits, _) = nearest(&mesh, &[invalid, Ray::new(Vec3::ZERO, Vec3::Z)]);
    assert_eq!((hits[0].1, hits[1].1), (MISS, 0));
}

#[test]
fn a_shared_origin_is_bit_equal_over_the_valid_rays() {
    let mesh = Mesh::new(vec![wall(2.0)]);
    for n in [1, 2, 15, 16, 17, 100] {
        for odd_one in 0..n {
            let mut rays = vec![Ray::new(v(0.5, 0.0, -1.0), Vec3::Z); n];
            let shared = |rays: &[Ray]| {
                let trace = nearest(&mesh, rays).1;
                let batch: Batch = rays.iter().copied().collect();
                assert_eq!(trace.shared_origin, batch.shared_origin().is_some());
                trace.shared_origin
            };
            assert!(shared(&rays));
            rays[odd_one].origin.y = -0.0;
            assert_eq!(shared(&rays), n == 1, "0 and −0 differ");
            rays[odd_one].origin.y = 1.0;
            assert_eq!(shared(&rays), n == 1);
            rays[odd_one].tmin = -1.0;
            assert_eq!(shared(&rays), n > 1, "an invalid ray has no say");
            rays[odd_one].origin.y = f32::NAN;
            assert_eq!(shared(&rays), n > 1);
            if n > 17 && odd_one > 20 {
                break;
            }
        }
    }
}

#[test]
#[should_panic(expected = "one hit record a ray")]
fn hits_with_fewer_prims_than_rays_are_refused() {
    let mesh = Mesh::new(vec![wall(2.0)]);
    let batch: Batch = [Ray::new(Vec3::ZERO, Vec3::Z); 2].into_iter().collect();
    let mut hits = Hits::misses(2);
    hits.prim.pop();
    let tracer = Tracer::new(Method::Afra2012.parameters());
    tracer.nearest(&mesh, &batch, &mut tracer.workspace(2, 1), &mut hits);
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -2f32..2.0,
        2 => (-4i8..=4).prop_map(|x| x as f32 / 2.0),
        1 => Just(-0.0),
        1 => -1e6f32..1e6,
        1 => -1e-6f32..1e-6,
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// One function of ray and triangle: alone, each ray with each triangle gives the same as all
    /// together, if the origins are shared or not in both.
    #[test]
    fn neighbours_change_nothing(
        triangles in prop::collection::vec([point(), point(), point()], 1..40),
        rays in prop::collection::vec((point(), point()), 2..40),
        shared in any::<bool>(),
    ) {
        let triangles: Vec<Triangle> =
            triangles.into_iter().map(|[a, b, c]| Triangle::new(a, b, c)).collect();
        let mut rays: Vec<Ray> = rays.into_iter().map(|(o, d)| Ray::new(o, d)).collect();
        if shared {
            let origin = rays[0].origin;
            rays.iter_mut().for_each(|r| r.origin = origin);
        } else {
            // Two rays that keep origins from being shared, also of what is left alone.
            rays[0] = Ray::new(Vec3::ZERO, Vec3::X);
            rays[1] = Ray::new(Vec3::ONE, Vec3::X);
        }
        let (all, trace) = nearest(&Mesh::new(triangles.clone()), &rays);
        let mut expected = vec![(f32::INFINITY, MISS); rays.len()];
        let tracer = Tracer::new(Method::Afra2012.parameters());
        let mut workspace = tracer.workspace(3, 1);
        for (prim, &triangle) in triangles.iter().enumerate() {
            let mesh = Mesh::new(vec![triangle]);
            for (ray, expected) in rays.iter().zip(&mut expected) {
                let alone: Batch = if trace.shared_origin {
                    [*ray].into_iter().collect()
                } else {
                    [*ray, rays[0], rays[1]].into_iter().collect()
                };
                let mut hits = Hits::misses(alone.len());
                tracer.nearest(&mesh, &alone, &mut workspace, &mut hits);
                if hits.t[0] < expected.0 {
                    *expected = (hits.t[0], prim as u32);
                }
            }
        }
        prop_assert_eq!(all, expected);
    }
}
