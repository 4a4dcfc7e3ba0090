//! A watched trace is the trace that it watches, and tells what the kernels did.

mod common;

use common::{Case, bits, presets_and_finest, random_rays, soup};
use dacrt::*;

/// The best t and triangle that a ray has after its last leaf, by the tests that were told.
fn best_of_leaves(steps: &[Step], tmin: f32, tmax: f32) -> (f32, u32) {
    let mut best = (tmax, MISS);
    for step in steps {
        let Event::Leaf(tests) = &step.event else {
            continue;
        };
        assert_eq!(step.best.1, best.1);
        for test in tests {
            let inside = test.u >= 0.0 && test.v >= 0.0 && test.u + test.v <= test.den;
            let clipped = test.clip[0] <= test.t && test.t <= test.clip[1];
            let in_time = tmin < test.t && test.t <= tmax && test.t.is_finite();
            if inside && clipped && in_time && (test.t, test.prim) < best {
                best = (test.t, test.prim);
            }
        }
    }
    best
}

#[test]
fn watching_changes_nothing_and_tells_how_the_hit_was_found() {
    for shared in [false, true] {
        let case = Case::new(soup(300, 1), random_rays(2000, 2, shared));
        for parameters in presets_and_finest() {
            let tracer = Tracer::new(parameters).with_seed(3);
            let (expected, trace) = case.nearest(tracer);
            for ray in (0..2000).step_by(199) {
                let mut told = Vec::new();
                for isa in [Isa::best(), Isa::Portable] {
                    let tracer = tracer.with_isa(isa);
                    let mut workspace = tracer.workspace(2000, case.mesh.len());
                    let mut hits = Hits::misses(2000);
                    let (watched, steps) = tracer.watch_nearest(
                        &case.mesh,
                        &case.batch,
                        &mut workspace,
                        &mut hits,
                        ray,
                    );
                    assert_eq!(bits(&hits), bits(&expected));
                    assert_eq!(watched, trace);
                    told.push(format!("{steps:?}"));
                    let Ray { tmin, tmax, .. } = case.batch.ray(ray);
                    if case.batch.ray(ray).is_valid() {
                        let (t, prim) = best_of_leaves(&steps, tmin, tmax);
                        assert_eq!(prim, hits.prim[ray], "ray {ray} {parameters:?}");
                        assert!(prim == MISS || t == hits.t[ray]);
                        assert!(!steps.is_empty());
                    } else {
                        assert!(steps.is_empty());
                    }
                }
                assert_eq!(told[0], told[1], "instruction sets");
            }
        }
    }
}

#[test]
fn precise_hits_are_sure_or_exactly_met() {
    let case = Case::new(soup(300, 1), random_rays(500, 2, true));
    for precision in [Precision::Watertight, Precision::Exact] {
        let tracer = Tracer::new(Method::Mora2011.parameters()).with_precision(precision);
        let (hits, _) = case.nearest(tracer);
        let mut seen = 0;
        for ray in (0..500).filter(|&i| hits.prim[i] != MISS).step_by(5) {
            let mut workspace = tracer.workspace(500, case.mesh.len());
            let mut again = Hits::misses(500);
            let (_, steps) =
                tracer.watch_nearest(&case.mesh, &case.batch, &mut workspace, &mut again, ray);
            let mut tests = steps.iter().flat_map(|step| match &step.event {
                Event::Leaf(tests) => tests.as_slice(),
                _ => &[],
            });
            let test = tests.find(|test| test.prim == hits.prim[ray]).unwrap();
            assert!(test.sure != Sure::Miss && test.exact.is_some(), "{test:?}");
            if precision == Precision::Exact {
                assert_eq!(test.exact, Some(hits.t[ray]));
            }
            seen += 1;
        }
        assert!(seen > 20, "{seen}");
    }
}

#[test]
fn an_any_hit_ray_ends_at_its_first_hit() {
    let case = Case::new(soup(300, 1), random_rays(500, 2, false));
    for method in Method::ALL {
        let tracer = Tracer::new(method.parameters());
        let (expected, _) = case.any(tracer);
        let ray = expected.iter().position(|&o| o == 1).unwrap();
        let mut workspace = tracer.workspace(500, case.mesh.len());
        let mut occluded = vec![0; 500];
        let (_, steps) =
            tracer.watch_any(&case.mesh, &case.batch, &mut workspace, &mut occluded, ray);
        assert_eq!(occluded, expected);
        let leaf = |step: &Step| matches!(step.event, Event::Leaf(_));
        assert!(steps.iter().any(leaf));
        // Behind it, boxes turn the ray away.
        let behind = steps.iter().filter(|step| step.best.0 == -1.0);
        assert!(
            behind
                .clone()
                .all(|step| !matches!(step.event, Event::Kept)),
            "{method}"
        );
    }
}
