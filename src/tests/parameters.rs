//! No parameter changes a hit.

mod common;

use common::{Case, bits, brute_force, random_rays, soup};
use dacrt::*;
use proptest::prelude::*;

fn cases() -> [Case; 3] {
    [
        Case::new(soup(1500, 3), random_rays(3000, 4, false)),
        Case::new(soup(1500, 3), random_rays(3000, 4, true)),
        Case::new(soup(200, 5), random_rays(6000, 6, false)),
    ]
}

/// Both methods with one parameter at a time set to each value that makes a difference.
fn single_changes() -> Vec<Parameters> {
    let mut all = Vec::new();
    for method in Method::ALL {
        let p = Method::parameters(method);
        all.extend([
            p,
            Parameters {
                leaf_triangles: 1,
                ..p
            },
            Parameters {
                leaf_triangles: 100,
                ..p
            },
            Parameters { leaf_rays: 0, ..p },
            Parameters {
                leaf_rays: 500,
                ..p
            },
            Parameters { bins: 2, ..p },
            Parameters { bins: 3, ..p },
            Parameters { bins: 256, ..p },
            Parameters {
                axes: Axes::Longest,
                ..p
            },
            Parameters {
                axes: Axes::Centers,
                ..p
            },
            Parameters {
                axes: Axes::All,
                ..p
            },
            Parameters {
                axes: Axes::All,
                bins: 256,
                ..p
            },
            Parameters {
                sah_ratio: 0.0,
                ..p
            },
            Parameters {
                sah_ratio: f32::INFINITY,
                ..p
            },
            Parameters {
                one_ray: OneRay::AxisSign,
                ..p
            },
            Parameters {
                one_ray: OneRay::Entry,
                ..p
            },
            Parameters {
                cost: Cost::Sah,
                ..p
            },
            Parameters {
                cost: Cost::Sampled,
                ..p
            },
            Parameters {
                order: Order::OneRay,
                ..p
            },
            Parameters {
                order: Order::Sampled,
                ..p
            },
            Parameters { skip: 0.0, ..p },
            Parameters {
                skip: 0.0,
                min_rays: 0,
                sample_middle: true,
                ..p
            },
            Parameters { skip: 0.9, ..p },
            Parameters { skip: 1.0, ..p },
            Parameters {
                threshold: 0.0,
                ..p
            },
            Parameters {
                threshold: f32::INFINITY,
                ..p
            },
            Parameters { samples: 1, ..p },
            Parameters { samples: 4096, ..p },
            Parameters { min_rays: 0, ..p },
            Parameters {
                min_rays: u32::MAX,
                ..p
            },
            Parameters {
                draws: Draws::Strata,
                ..p
            },
            Parameters {
                draws: Draws::Replacement,
                ..p
            },
            Parameters {
                sample_middle: !p.sample_middle,
                ..p
            },
            Parameters {
                leaf_criterion: !p.leaf_criterion,
                ..p
            },
            Parameters { box_cost: 0.0, ..p },
            Parameters { box_cost: 8.0, ..p },
            Parameters {
                order_unbiased: !p.order_unbiased,
                ..p
            },
            Parameters {
                alpha_refresh: !p.alpha_refresh,
                ..p
            },
            Parameters {
                second_sample: !p.second_sample,
                ..p
            },
        ]);
    }
    all
}

/// The hits are those of the naive step over everything; returns what the traces counted.
fn check(case: &mut Case, expected: &Hits, tracer: Tracer) -> [Counters; 2] {
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
    for mut case in cases() {
        let (expected, _) = case.nearest(Tracer::new(brute_force()));
        for parameters in single_changes() {
            check(&mut case, &expected, Tracer::new(parameters));
        }
    }
}

#[test]
fn a_seed_changes_counters_but_no_hit() {
    let [mut case, ..] = cases();
    let (expected, _) = case.nearest(Tracer::new(brute_force()));
    let tracer = Tracer::new(Method::Nabata2013.parameters());
    let counted: Vec<_> = (0..4)
        .map(|seed| check(&mut case, &expected, tracer.with_seed(seed)))
        .collect();
    assert_ne!(counted[0], counted[1]);
    assert_eq!(
        counted[0],
        check(&mut case, &expected, tracer),
        "the seed is 0 by default"
    );
    // The baseline draws nothing.
    let tracer = Tracer::new(Method::Afra2012.parameters());
    let other = check(&mut case, &expected, tracer.with_seed(1));
    assert_eq!(other, check(&mut case, &expected, tracer));
}

#[test]
fn a_skip_of_one_never_skips_and_a_skip_of_zero_does() {
    let [mut case, ..] = cases();
    let sampling = ObjectParameters {
        min_rays: 0,
        sample_middle: true,
        ..ObjectParameters::NABATA2013
    };
    for leaf_criterion in [false, true] {
        let skips = |case: &mut Case, skip| {
            let tracer = Tracer::new(ObjectParameters {
                skip,
                leaf_criterion,
                ..sampling
            });
            let c = case.nearest(tracer.with_audit(true)).1.counters;
            assert!(c.skipped_rays_that_miss == 0 || c.skips_near + c.skips_far > 0);
            (c.skips_near + c.skips_far, c.skipped_rays_that_miss)
        };
        assert_eq!(skips(&mut case, 1.0), (0, 0));
        let (skipped, missed) = skips(&mut case, 0.0);
        assert!(skipped > 100 && missed > 100, "{skipped} {missed}");
    }
}

#[test]
fn an_audit_changes_one_counter_only() {
    let [mut case, ..] = cases();
    let tracer = Tracer::new(Method::Nabata2013.parameters());
    let plain = case.nearest(tracer);
    let mut audited = case.nearest(tracer.with_audit(true));
    assert!(audited.1.counters.skipped_rays_that_miss > 0);
    audited.1.counters.skipped_rays_that_miss = 0;
    assert_eq!(plain, audited);
}

#[test]
fn parameters_out_of_range_are_named() {
    let p = Method::Nabata2013.parameters();
    for (name, bad) in [
        (
            "leaf_triangles",
            Parameters {
                leaf_triangles: 0,
                ..p
            },
        ),
        ("bins", Parameters { bins: 1, ..p }),
        ("bins", Parameters { bins: 257, ..p }),
        ("samples", Parameters { samples: 0, ..p }),
        ("samples", Parameters { samples: 4097, ..p }),
        ("skip", Parameters { skip: -0.1, ..p }),
        ("skip", Parameters { skip: 1.5, ..p }),
        (
            "skip",
            Parameters {
                skip: f32::NAN,
                ..p
            },
        ),
        (
            "sah_ratio",
            Parameters {
                sah_ratio: f32::NAN,
                ..p
            },
        ),
        (
            "threshold",
            Parameters {
                threshold: -1.0,
                ..p
            },
        ),
        (
            "box_cost",
            Parameters {
                box_cost: -1.0,
                ..p
            },
        ),
    ] {
        assert_eq!(bad.check().unwrap_err().name, name);
    }
}

fn parameters() -> impl Strategy<Value = Parameters> {
    let counts = (1u32..40, 0u32..200, 2u32..=256, 1u32..300, 0u32..3000);
    let ratios = (0f32..4.0, 0f32..4.0, 0f32..=1.0, 0f32..4.0);
    (counts, ratios, any::<[bool; 8]>(), 0usize..3).prop_map(
        |((leaf_triangles, leaf_rays, bins, samples, min_rays), ratios, flags, axes)| {
            let (sah_ratio, threshold, skip, box_cost) = ratios;
            Parameters {
                leaf_triangles,
                leaf_rays,
                bins,
                axes: [Axes::Longest, Axes::Centers, Axes::All][axes],
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

#[test]
fn no_combination_of_parameters_changes_a_hit() {
    let mut cases = cases();
    let expected = cases
        .each_mut()
        .map(|case| case.nearest(Tracer::new(brute_force())).0);
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig::with_cases(64));
    let isas: Vec<Isa> = Isa::available().collect();
    let strategy = (parameters(), any::<u64>(), 0..3usize);
    let cases = std::cell::RefCell::new(&mut cases);
    runner
        .run(&strategy, |(parameters, seed, which)| {
            let mut cases = cases.borrow_mut();
            let mut counted = Vec::new();
            for &isa in &isas {
                let tracer = Tracer::new(parameters).with_seed(seed).with_isa(isa);
                counted.push(check(&mut cases[which], &expected[which], tracer));
            }
            prop_assert!(counted.iter().all(|c| c == &counted[0]), "{counted:#?}");
            Ok(())
        })
        .unwrap();
}
