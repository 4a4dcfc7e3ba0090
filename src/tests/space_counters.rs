//! What traces of the methods that split space count: on meshes where it is known, and that every
//! switch switches something.

mod common;

use common::{Case, brute_force, random_rays, soup, space_presets};
use dacrt::*;
use glam::Vec3;

const VARIANTS: [Variant; 3] = [Variant::Basic, Variant::Cones, Variant::Random];

fn counters(case: &Case, parameters: SpaceParameters) -> Counters {
    case.nearest(Tracer::new(parameters)).1.counters
}

#[test]
fn a_root_below_a_limit_is_the_naive_step() {
    for shared in [false, true] {
        let case = Case::new(soup(200, 1), random_rays(300, 2, shared));
        let naive = case.nearest(Tracer::new(brute_force())).1.counters;
        for preset in space_presets() {
            let triangles = SpaceParameters {
                triangle_limit: u32::MAX,
                ..preset
            };
            let rays = SpaceParameters {
                ray_limit: u32::MAX,
                cone_limit: u32::MAX,
                ..preset
            };
            for parameters in [triangles, rays] {
                let c = counters(&case, parameters);
                assert_eq!(c.leaves, 1, "{parameters:?}");
                assert_eq!(c.duplicates, 0, "{parameters:?}");
                // Rays that miss the root may be left out.
                let (some, all) = (c.ray_triangle, naive.ray_triangle);
                assert!(
                    0.9 * all as f64 <= some as f64 && some <= all,
                    "{parameters:?}"
                );
            }
        }
    }
}

/// A triangle of edges along the axes y and x.
fn tile(x: f32, y: f32, size: f32) -> Triangle {
    let corner = Vec3::new(x, y, 0.01 * y);
    Triangle::new(corner, corner + size * Vec3::X, corner + size * Vec3::Y)
}

#[test]
fn a_triangle_in_two_cells_is_met_twice() {
    // The box is split at x = 8: ten triangles on each side, and three across.
    let left = (0..10).map(|i| tile(0.1 * i as f32, -3.0, 0.5));
    let right = (0..10).map(|i| tile(15.4 - 0.1 * i as f32, 3.0, 0.6));
    let across = (0..3).map(|i| tile(7.5, 1.0 + 0.5 * i as f32, 2.0));
    let mesh = Mesh::new(left.chain(right).chain(across).collect());
    let bounds = mesh.bounds();
    assert_eq!((bounds.min.x, bounds.max.x), (0.0, 16.0));
    for shared in [false, true] {
        // Through both cells and past all triangles.
        let rays = (0..50).map(|i| {
            let slope = 1e-4 * i as f32;
            let start = if shared { 0.0 } else { slope };
            Ray::new(Vec3::new(-5.0, start, 0.0), Vec3::new(1.0, slope, 0.0))
        });
        let case = Case::new(mesh.clone(), rays.collect());
        for preset in space_presets() {
            let (hits, trace) = case.nearest(Tracer::new(preset));
            assert_eq!(trace.shared_origin, shared);
            assert_eq!(hits.hit_count(), 0);
            let c = trace.counters;
            assert_eq!((c.nodes, c.leaves), (3, 2), "{preset:?}");
            assert_eq!(c.duplicates, 3, "{preset:?}");
            assert_eq!(c.ray_triangle, 50 * 13 * 2, "{preset:?}");
        }
    }
}

/// A wall of 32 × 32 quads at x = 0, and a soup behind it.
fn wall_and_soup(behind: usize) -> Mesh {
    let corner = |y: usize, z: usize| Vec3::new(0.0, y as f32 / 8.0 - 2.0, z as f32 / 8.0 - 2.0);
    let quad = |i: usize| {
        let (y, z) = (i % 32, i / 32);
        let [a, b] = [corner(y, z), corner(y + 1, z + 1)];
        [
            Triangle::new(a, b, corner(y + 1, z)),
            Triangle::new(a, b, corner(y, z + 1)),
        ]
    };
    let soup = soup(behind, 3).into_triangles().into_iter();
    let place = |p: Vec3| p + 4.0 * Vec3::X;
    let soup = soup.map(|t| Triangle::new(place(t.a), place(t.b), place(t.c)));
    Mesh::new((0..32 * 32).flat_map(quad).chain(soup).collect())
}

#[test]
fn rays_of_one_origin_end_at_what_they_hit_and_what_is_hidden_costs_little() {
    let origin = Vec3::new(-4.0, 0.1, 0.2);
    let rays = (0..64 * 64).map(|i| {
        let (y, z) = ((i % 64) as f32 / 32.0 - 1.0, (i / 64) as f32 / 32.0 - 1.0);
        Ray::new(origin, Vec3::new(0.0, 1.3 * y, 1.3 * z) - origin)
    });
    let rays: Batch = rays.collect();
    let few = Case::new(wall_and_soup(100), rays.clone());
    let many = Case::new(wall_and_soup(5000), rays);
    for parameters in [SpaceParameters::MORA2011, SpaceParameters::MORA2011_CONES] {
        let (few, many) = (counters(&few, parameters), counters(&many, parameters));
        assert_eq!(many.terminated_rays, 64 * 64, "{parameters:?}");
        let tests = |c: Counters| c.ray_box + c.cone_box + c.ray_triangle;
        assert!(tests(many) < 2 * tests(few), "{many:#?}\n{few:#?}");
    }
    let random = counters(&many, SpaceParameters::MORA2011_RANDOM);
    assert_eq!(random.terminated_rays, 0);
}

/// The name of a parameter, and parameters that differ in it.
type Change = (&'static str, SpaceParameters, SpaceParameters);

fn changes(variant: Variant) -> [Change; 11] {
    let p = SpaceParameters {
        variant,
        // So that 2,000 triangles are enough.
        estimate_from: 500,
        estimate_stride: 5,
        cone_limit: 2,
        widest_cone: 60.0,
        ..SpaceParameters::MORA2011
    };
    let all = [
        ("ray_limit", SpaceParameters { ray_limit: 40, ..p }),
        (
            "triangle_limit",
            SpaceParameters {
                triangle_limit: 32,
                ..p
            },
        ),
        ("cone_limit", SpaceParameters { cone_limit: 8, ..p }),
        (
            "widest_cone",
            SpaceParameters {
                widest_cone: 0.1,
                ..p
            },
        ),
        (
            "estimate_from",
            SpaceParameters {
                estimate_from: u32::MAX,
                ..p
            },
        ),
        (
            "estimate_stride",
            SpaceParameters {
                estimate_stride: 50,
                ..p
            },
        ),
        (
            "nine_axes_below",
            SpaceParameters {
                nine_axes_below: 0,
                ..p
            },
        ),
        (
            "nine_axes_below",
            SpaceParameters {
                nine_axes_below: u32::MAX,
                ..p
            },
        ),
        (
            "plane_test",
            SpaceParameters {
                plane_test: true,
                ..p
            },
        ),
        (
            "terminate_as_printed",
            SpaceParameters {
                terminate_as_printed: true,
                ..p
            },
        ),
        ("octants", SpaceParameters { octants: true, ..p }),
    ];
    all.map(|(name, changed)| (name, p, changed))
}

#[test]
fn every_switch_of_a_method_switches_something_and_no_other_does() {
    let methods = [
        Method::Mora2011,
        Method::Mora2011Cones,
        Method::Mora2011Random,
    ];
    let cases = [false, true].map(|shared| {
        // Narrow enough for cones where the origin is shared.
        let random = random_rays(8000, 4, shared);
        let rays = random.iter().enumerate().map(|(i, ray)| {
            if shared {
                let (x, y) = ((i / 64 % 12) as f32 - 5.5, (i / 64 / 12) as f32 - 5.0);
                let toward = Vec3::new(0.2 * x, 0.2 * y, -3.0);
                let origin = Vec3::new(0.0, 0.1, 3.0);
                Ray::new(origin, toward + 0.1 * ray.direction.normalize_or_zero())
            } else {
                ray
            }
        });
        Case::new(soup(2000, 5), rays.collect())
    });
    for (method, variant) in methods.into_iter().zip(VARIANTS) {
        for (name, before, after) in changes(variant) {
            let differs = cases.iter().any(|case| {
                let [before, after] = [before, after].map(|p| case.nearest(Tracer::new(p)));
                before.1 != after.1
            });
            assert_eq!(differs, method.has(name), "{method}: {name}");
        }
    }
}
