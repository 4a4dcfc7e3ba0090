//! No parameter changes a hit.

mod common;

use common::{Case, bits, brute_force, random_rays, soup, space_presets};
use dacrt::*;
use glam::Vec3;
use proptest::prelude::*;

fn cases() -> [Case; 3] {
    [
        Case::new(soup(1500, 3), random_rays(3000, 4, false)),
        Case::new(soup(1500, 3), random_rays(3000, 4, true)),
        Case::new(soup(200, 5), random_rays(6000, 6, false)),
    ]
}

/// Both presets with one parameter at a time set to each value that makes a difference.
fn single_object_changes() -> Vec<ObjectParameters> {
    let mut all = Vec::new();
    for p in [ObjectParameters::AFRA2012, ObjectParameters::NABATA2013] {
        all.extend([
            p,
            ObjectParameters {
                leaf_triangles: 1,
                ..p
            },
            ObjectParameters {
                leaf_triangles: 100,
                ..p
            },
            ObjectParameters { leaf_rays: 0, ..p },
            ObjectParameters {
                leaf_rays: 500,
                ..p
            },
            ObjectParameters { bins: 2, ..p },
            ObjectParameters { bins: 3, ..p },
            ObjectParameters { bins: 256, ..p },
            ObjectParameters {
                axes: Axes::Longest,
                ..p
            },
            ObjectParameters {
                axes: Axes::Centers,
                ..p
            },
            ObjectParameters {
                axes: Axes::All,
                ..p
            },
            ObjectParameters {
                axes: Axes::All,
                bins: 256,
                ..p
            },
            ObjectParameters {
                sah_ratio: 0.0,
                ..p
            },
            ObjectParameters {
                sah_ratio: f32::INFINITY,
                ..p
            },
            ObjectParameters {
                one_ray: OneRay::AxisSign,
                ..p
            },
            ObjectParameters {
                one_ray: OneRay::Entry,
                ..p
            },
            ObjectParameters {
                cost: Cost::Sah,
                ..p
            },
            ObjectParameters {
                cost: Cost::Sampled,
                ..p
            },
            ObjectParameters {
                order: Order::OneRay,
                ..p
            },
            ObjectParameters {
                order: Order::Sampled,
                ..p
            },
            ObjectParameters { skip: 0.0, ..p },
            ObjectParameters {
                skip: 0.0,
                min_rays: 0,
                sample_middle: true,
                ..p
            },
            ObjectParameters { skip: 0.9, ..p },
            ObjectParameters { skip: 1.0, ..p },
            ObjectParameters {
                threshold: 0.0,
                ..p
            },
            ObjectParameters {
                threshold: f32::INFINITY,
                ..p
            },
            ObjectParameters { samples: 1, ..p },
            ObjectParameters { samples: 4096, ..p },
            ObjectParameters { min_rays: 0, ..p },
            ObjectParameters {
                min_rays: u32::MAX,
                ..p
            },
            ObjectParameters {
                draws: Draws::Strata,
                ..p
            },
            ObjectParameters {
                draws: Draws::Replacement,
                ..p
            },
            ObjectParameters {
                sample_middle: !p.sample_middle,
                ..p
            },
            ObjectParameters {
                leaf_criterion: !p.leaf_criterion,
                ..p
            },
            ObjectParameters { box_cost: 0.0, ..p },
            ObjectParameters { box_cost: 8.0, ..p },
            ObjectParameters {
                order_unbiased: !p.order_unbiased,
                ..p
            },
            ObjectParameters {
                alpha_refresh: !p.alpha_refresh,
                ..p
            },
            ObjectParameters {
                second_sample: !p.second_sample,
                ..p
            },
        ]);
    }
    all
}

/// The same of Mora's method, but for `terminate_as_printed`, which is wrong.
fn single_space_changes() -> Vec<SpaceParameters> {
    let mut all = Vec::new();
    for p in space_presets() {
        all.push(p);
        let variants = [Variant::Basic, Variant::Cones, Variant::Random];
        all.extend(variants.map(|variant| SpaceParameters { variant, ..p }));
        all.extend([1, 500].map(|ray_limit| SpaceParameters { ray_limit, ..p }));
        all.extend([1, 200].map(|triangle_limit| SpaceParameters {
            triangle_limit,
            ..p
        }));
        all.extend([1, 4, 1000].map(|cone_limit| SpaceParameters { cone_limit, ..p }));
        for estimate_from in [0, u32::MAX] {
            all.extend([1, 50, 1000].map(|estimate_stride| SpaceParameters {
                estimate_from,
                estimate_stride,
                ..p
            }));
        }
        all.extend([0, u32::MAX].map(|nine_axes_below| SpaceParameters {
            nine_axes_below,
            ..p
        }));
        all.extend([0.0, 4.0, 60.0].map(|widest_cone| SpaceParameters { widest_cone, ..p }));
        all.push(SpaceParameters {
            plane_test: !p.plane_test,
            ..p
        });
        all.push(SpaceParameters {
            octants: !p.octants,
            ..p
        });
    }
    all
}

/// The hits are those of the naive step over everything; returns what the traces counted.
fn check(case: &Case, expected: &Hits, tracer: Tracer) -> [Counters; 2] {
    let (hits, trace) = case.nearest(tracer);
    assert_eq!(bits(&hits), bits(expected), "{tracer:?}");
    let (occluded, any) = case.any(tracer);
    for (&prim, occluded) in expected.prim.iter().zip(occluded) {
        assert_eq!(occluded, (prim != MISS) as u8, "{tracer:?}");
    }
    [trace.counters, any.counters]
}

#[test]
fn no_single_parameter_changes_a_hit() {
    for case in cases() {
        let (expected, _) = case.nearest(Tracer::new(brute_force()));
        for parameters in single_object_changes() {
            check(&case, &expected, Tracer::new(parameters));
        }
        for parameters in single_space_changes() {
            check(&case, &expected, Tracer::new(parameters));
        }
    }
}

#[test]
fn a_seed_changes_counters_but_no_hit() {
    let [case, ..] = cases();
    let (expected, _) = case.nearest(Tracer::new(brute_force()));
    let tracer = Tracer::new(Method::Nabata2013.parameters());
    let counted: Vec<_> = (0..4)
        .map(|seed| check(&case, &expected, tracer.with_seed(seed)))
        .collect();
    assert_ne!(counted[0], counted[1]);
    assert_eq!(
        counted[0],
        check(&case, &expected, tracer),
        "the seed is 0 by default"
    );
    // The baseline draws nothing.
    let tracer = Tracer::new(Method::Afra2012.parameters());
    let other = check(&case, &expected, tracer.with_seed(1));
    assert_eq!(other, check(&case, &expected, tracer));
}

#[test]
fn a_skip_of_one_never_skips_and_a_skip_of_zero_does() {
    let [case, ..] = cases();
    let sampling = ObjectParameters {
        min_rays: 0,
        sample_middle: true,
        ..ObjectParameters::NABATA2013
    };
    for leaf_criterion in [false, true] {
        let skips = |case: &Case, skip| {
            let tracer = Tracer::new(ObjectParameters {
                skip,
                leaf_criterion,
                ..sampling
            });
            let c = case.nearest(tracer.with_audit(true)).1.counters;
            assert!(c.skipped_rays_that_miss == 0 || c.skips_near + c.skips_far > 0);
            (c.skips_near + c.skips_far, c.skipped_rays_that_miss)
        };
        assert_eq!(skips(&case, 1.0), (0, 0));
        let (skipped, missed) = skips(&case, 0.0);
        assert!(skipped > 100 && missed > 100, "{skipped} {missed}");
    }
}

#[test]
fn an_audit_changes_one_counter_only() {
    let [case, ..] = cases();
    let tracer = Tracer::new(Method::Nabata2013.parameters());
    let plain = case.nearest(tracer);
    let mut audited = case.nearest(tracer.with_audit(true));
    assert!(audited.1.counters.skipped_rays_that_miss > 0);
    audited.1.counters.skipped_rays_that_miss = 0;
    assert_eq!(plain, audited);
}

/// As section 3.2 prints it, a ray ends at a hit with any triangle of the cell. Here the cell in
/// front has one large triangle, which the rays hit in the cell behind, where a wall stands before it.
#[test]
fn termination_as_printed_is_wrong_where_a_triangle_is_hit_outside_the_cell() {
    let large = Triangle::new(
        Vec3::new(2.0, -4.0, -4.0),
        Vec3::new(2.0, -4.0, 4.0),
        Vec3::new(16.0, 1.6, 0.0),
    );
    // The box is split at x = 9: the wall is behind, as is a heap beside the rays that makes the
    // root too large for the naive step.
    let wall = Triangle::new(
        Vec3::new(10.0, -2.0, -2.0),
        Vec3::new(10.0, 2.0, -2.0),
        Vec3::new(10.0, 0.0, 3.0),
    );
    let beside = (0..30).map(|i| {
        let corner = Vec3::new(15.0, -3.0 + 0.1 * i as f32, 3.5);
        Triangle::new(corner, corner + 0.1 * Vec3::X, corner + 0.1 * Vec3::Y)
    });
    let mesh = Mesh::new([large, wall].into_iter().chain(beside).collect());
    let rays = (0..100).map(|i| {
        let (y, z) = ((i % 10) as f32 - 4.5, (i / 10) as f32 - 4.5);
        Ray::new(
            Vec3::new(-1.0, 0.0, 0.0),
            Vec3::new(1.0, 0.005 * y, 0.005 * z),
        )
    });
    let case = Case::new(mesh, rays.collect());
    let (expected, _) = case.nearest(Tracer::new(brute_force()));
    assert!(expected.prim.iter().all(|&prim| prim == 1));
    let cones = SpaceParameters {
        cone_limit: 1,
        ..SpaceParameters::MORA2011_CONES
    };
    for parameters in [SpaceParameters::MORA2011, cones] {
        check(&case, &expected, Tracer::new(parameters));
        let as_printed = SpaceParameters {
            terminate_as_printed: true,
            ..parameters
        };
        for isa in Isa::available() {
            let (hits, _) = case.nearest(Tracer::new(as_printed).with_isa(isa));
            assert!(hits.prim.iter().all(|&prim| prim == 0), "{parameters:?}");
            // What any ray hits is the same.
            let (occluded, _) = case.any(Tracer::new(as_printed).with_isa(isa));
            assert!(occluded.iter().all(|&byte| byte == 1));
        }
    }
}

#[test]
fn parameters_out_of_range_are_named() {
    let p = ObjectParameters::NABATA2013;
    for (name, bad) in [
        (
            "leaf_triangles",
            ObjectParameters {
                leaf_triangles: 0,
                ..p
            },
        ),
        ("bins", ObjectParameters { bins: 1, ..p }),
        ("bins", ObjectParameters { bins: 257, ..p }),
        ("samples", ObjectParameters { samples: 0, ..p }),
        ("samples", ObjectParameters { samples: 4097, ..p }),
        ("skip", ObjectParameters { skip: -0.1, ..p }),
        ("skip", ObjectParameters { skip: 1.5, ..p }),
        (
            "skip",
            ObjectParameters {
                skip: f32::NAN,
                ..p
            },
        ),
        (
            "sah_ratio",
            ObjectParameters {
                sah_ratio: f32::NAN,
                ..p
            },
        ),
        (
            "threshold",
            ObjectParameters {
                threshold: -1.0,
                ..p
            },
        ),
        (
            "box_cost",
            ObjectParameters {
                box_cost: -1.0,
                ..p
            },
        ),
    ] {
        assert_eq!(Parameters::from(bad).check().unwrap_err().name, name);
    }
    let p = SpaceParameters::MORA2011;
    for (name, bad) in [
        ("ray_limit", SpaceParameters { ray_limit: 0, ..p }),
        (
            "triangle_limit",
            SpaceParameters {
                triangle_limit: 0,
                ..p
            },
        ),
        ("cone_limit", SpaceParameters { cone_limit: 0, ..p }),
        (
            "widest_cone",
            SpaceParameters {
                widest_cone: 61.0,
                ..p
            },
        ),
        (
            "estimate_stride",
            SpaceParameters {
                estimate_stride: 0,
                ..p
            },
        ),
    ] {
        assert_eq!(Parameters::from(bad).check().unwrap_err().name, name);
    }
}

fn object_parameters() -> impl Strategy<Value = ObjectParameters> {
    let counts = (1u32..40, 0u32..200, 2u32..=256, 1u32..300, 0u32..3000);
    let ratios = (0f32..4.0, 0f32..4.0, 0f32..=1.0, 0f32..4.0);
    (counts, ratios, any::<[bool; 8]>(), 0usize..3).prop_map(
        |((leaf_triangles, leaf_rays, bins, samples, min_rays), ratios, flags, axes)| {
            let (sah_ratio, threshold, skip, box_cost) = ratios;
            ObjectParameters {
                leaf_triangles,
                leaf_rays,
                bins,
                axes: [Axes::Longest, Axes::Centers, Axes::All][axes],
                lists: [Lists::Auto, Lists::Copied, Lists::InPlace][min_rays as usize % 3],
                sah_ratio,
                one_ray: if flags[0] {
                    OneRay::AxisSign
                } else {
                    OneRay::Entry
                },
                cost: if flags[1] { Cost::Sah } else { Cost::Sampled },
                order: if flags[2] {
                    Order::OneRay
                } else {
                    Order::Sampled
                },
                skip,
                threshold,
                samples,
                min_rays,
                draws: if flags[3] {
                    Draws::Strata
                } else {
                    Draws::Replacement
                },
                sample_middle: flags[4],
                leaf_criterion: flags[5],
                box_cost,
                order_unbiased: flags[6],
                alpha_refresh: flags[7],
                second_sample: samples % 2 == 0,
            }
        },
    )
}

fn space_parameters() -> impl Strategy<Value = SpaceParameters> {
    let variants = [Variant::Basic, Variant::Cones, Variant::Random];
    let limits = (
        prop::sample::select(vec![1, 3, 20, 500]),
        prop::sample::select(vec![1, 2, 16, 200]),
        prop::sample::select(vec![1, 4, 16, 1000]),
    );
    let splits = (
        prop::sample::select(vec![0, 100, 10_000, u32::MAX]),
        prop::sample::select(vec![1, 7, 50, 1000]),
        prop::sample::select(vec![0, 10, 100, u32::MAX]),
    );
    let variant = prop::sample::select(variants.to_vec());
    (variant, limits, splits, 0f32..=60.0, any::<[bool; 2]>()).prop_map(
        |(variant, limits, splits, widest_cone, [plane_test, octants])| SpaceParameters {
            variant,
            ray_limit: limits.0,
            triangle_limit: limits.1,
            cone_limit: limits.2,
            widest_cone,
            estimate_from: splits.0,
            estimate_stride: splits.1,
            nine_axes_below: splits.2,
            plane_test,
            // Wrong by design.
            terminate_as_printed: false,
            octants,
        },
    )
}

#[test]
fn no_combination_of_parameters_changes_a_hit() {
    let cases = cases();
    let expected = cases
        .each_ref()
        .map(|case| case.nearest(Tracer::new(brute_force())).0);
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(128));
    let parameters = prop_oneof![
        object_parameters().prop_map(Parameters::from),
        space_parameters().prop_map(Parameters::from),
    ];
    runner
        .run(
            &(parameters, any::<u64>(), 0..3usize),
            |(parameters, seed, which)| {
                let counted: Vec<_> = Isa::available()
                    .map(|isa| {
                        let tracer = Tracer::new(parameters).with_seed(seed).with_isa(isa);
                        check(&cases[which], &expected[which], tracer)
                    })
                    .collect();
                prop_assert!(counted.iter().all(|c| c == &counted[0]), "{counted:#?}");
                Ok(())
            },
        )
        .unwrap();
}

/// A method has the parameters of its family, by the names that they have as JSON.
#[test]
fn the_names_of_parameters_are_those_of_their_fields() {
    let names = |parameters: Parameters| -> Vec<String> {
        let json = serde_json::to_value(parameters).unwrap();
        json.as_object().unwrap().keys().cloned().collect()
    };
    let object = names(ObjectParameters::AFRA2012.into());
    let space = names(SpaceParameters::MORA2011.into());
    assert!(object.iter().all(|name| !space.contains(name)));
    let lacks = |method: Method, family: &[String]| -> Vec<String> {
        let lacking = family.iter().filter(|name| !method.has(name));
        lacking.cloned().collect()
    };
    for (family, other, method, missing) in [
        (&object, &space, Method::Nabata2013, &["sah_ratio"][..]),
        (
            &space,
            &object,
            Method::Mora2011,
            &["cone_limit", "widest_cone"],
        ),
        (&space, &object, Method::Mora2011Cones, &[]),
        (
            &space,
            &object,
            Method::Mora2011Random,
            &["cone_limit", "widest_cone", "terminate_as_printed"],
        ),
    ] {
        let mut missing = missing.to_vec();
        missing.sort();
        assert_eq!(lacks(method, family), missing, "{method}");
        assert_eq!(&lacks(method, other), other, "{method}");
    }
    // The baseline lacks what speaks of samples.
    let baseline: Vec<&str> = object
        .iter()
        .filter(|name| Method::Afra2012.has(name))
        .map(String::as_str)
        .collect();
    let [axes, bins, one_ray] = ["axes", "bins", "one_ray"];
    assert_eq!(
        baseline,
        [
            axes,
            bins,
            "leaf_rays",
            "leaf_triangles",
            "lists",
            one_ray,
            "sah_ratio"
        ]
    );
    assert!(Method::ALL.iter().all(|method| !method.has("colour")));
}
