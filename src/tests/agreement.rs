//! Every method and instruction set gives the same bits, and those of a brute force.

mod common;

use common::{Case, bits, brute_force, random_rays, soup};
use dacrt::*;

#[test]
fn all_methods_and_instruction_sets_agree_with_the_naive_step() {
    for (rays, triangles, shared) in [
        (3000, 2000, false),
        (3000, 2000, true),
        (20_000, 700, false),
        (20_000, 700, true),
        (70, 3000, false),
    ] {
        for precision in Precision::ALL {
            agree(rays, triangles, shared, precision);
        }
    }
}

fn agree(rays: usize, triangles: usize, shared: bool, precision: Precision) {
    let case = Case::new(soup(triangles, 1), random_rays(rays, 2, shared));
    let (expected, trace) = case.nearest(Tracer::new(brute_force()).with_precision(precision));
    assert_eq!(trace.shared_origin, shared);
    assert!(trace.invalid_rays > 0);
    assert!(
        expected.hit_count() > rays / 4,
        "{} of {rays} hit",
        expected.hit_count()
    );
    let occluded: Vec<u8> = expected.prim.iter().map(|&p| (p != MISS) as u8).collect();
    for method in Method::ALL {
        let mut counters = Vec::new();
        for isa in Isa::available() {
            let tracer = Tracer::new(method.parameters())
                .with_isa(isa)
                .with_precision(precision);
            let (hits, trace) = case.nearest(tracer);
            assert_eq!(bits(&hits), bits(&expected), "{method} {isa} {precision}");
            let (any, any_trace) = case.any(tracer);
            assert_eq!(any, occluded, "{method} {isa} any");
            counters.push((trace, any_trace));
        }
        assert!(
            counters.iter().all(|c| c == &counters[0]),
            "{method}: {counters:#?}"
        );
    }
}

#[test]
fn a_part_of_a_batch_gives_the_hits_of_the_whole() {
    let case = Case::new(soup(2000, 1), random_rays(3000, 2, false));
    let tracer = Tracer::new(Method::Nabata2013.parameters());
    let (whole, _) = case.nearest(tracer);
    for i in (0..case.batch.len()).step_by(7) {
        let ray: Batch = [case.batch.ray(i)].into_iter().collect();
        let part = Case::new(case.mesh.clone(), ray);
        let (hits, trace) = part.nearest(tracer.with_own_origins(true));
        assert!(!trace.shared_origin);
        let (t, prim) = (hits.t[0].to_bits(), hits.prim[0]);
        assert_eq!((t, prim), (whole.t[i].to_bits(), whole.prim[i]), "ray {i}");
    }
}

#[test]
fn without_a_shared_origin_mora_s_presets_are_one() {
    let presets = [
        Method::Mora2011,
        Method::Mora2011Cones,
        Method::Mora2011Random,
    ];
    let variants = [Variant::Basic, Variant::Cones, Variant::Random];
    for shared in [false, true] {
        let case = Case::new(soup(2000, 1), random_rays(3000, 2, shared));
        let own = presets.map(|method| {
            let tracer = Tracer::new(method.parameters()).with_own_origins(true);
            (case.nearest(tracer), case.any(tracer))
        });
        assert!(own.iter().all(|found| found == &own[0]), "{own:?}");
        assert_eq!(own[0].0.1.variant, Some(Variant::Random));
        for (method, variant) in presets.into_iter().zip(variants) {
            let tracer = Tracer::new(method.parameters());
            let expected = if shared { variant } else { Variant::Random };
            for trace in [case.nearest(tracer).1, case.any(tracer).1] {
                assert_eq!(trace.variant, Some(expected), "{method}");
                assert_eq!(trace.shared_origin, shared);
            }
        }
        for method in [Method::Afra2012, Method::Nabata2013] {
            let trace = case.nearest(Tracer::new(method.parameters())).1;
            assert_eq!(trace.variant, None, "{method}");
        }
    }
}
