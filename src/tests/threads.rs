//! `best` gives the same bits with any number of threads.

mod common;

use common::{Case, bits, finest_best, random_rays, soup};
use dacrt::*;
use glam::Vec3;

/// Numbers of threads, some of them of more than there are blocks.
const THREADS: [usize; 4] = [1, 2, 3, 7];

/// Meshes of no, one and many triangles: of all natures, and many copies with some that are dropped.
fn meshes() -> [Mesh; 4] {
    let one = Triangle::new(Vec3::X, Vec3::Y, Vec3::new(-1.0, -1.0, 0.25));
    let nan = Triangle::new(Vec3::NAN, Vec3::X, Vec3::Y);
    let copies = (0..1000).map(|i| if i % 3 == 1 { nan } else { one });
    [
        Mesh::default(),
        Mesh::new(vec![one]),
        soup(1000, 1),
        Mesh::new(copies.collect()),
    ]
}

/// The preset, and parameters with so small blocks that there are some for each thread.
fn parameters() -> Vec<Parameters> {
    let fine = finest_best().into_iter();
    fine.chain([BestParameters::BEST])
        .map(Parameters::from)
        .collect()
}

/// The answers of one thread are those of others, in memory that was made for the most.
fn check(case: &Case, precision: Precision) {
    let Case { mesh, batch } = case;
    let reference = Tracer::new(Method::Afra2012.parameters()).with_precision(precision);
    let (expected, expected_any) = (case.nearest(reference), case.any(reference).0);
    let mut hits = Hits::misses(batch.len());
    let mut any = vec![7; batch.len()];
    for parameters in parameters() {
        let most = Tracer::new(parameters).with_threads(7);
        let mut workspace = most.workspace(batch.len(), mesh.len());
        for isa in Isa::available() {
            for threads in THREADS {
                let tracer = Tracer::new(parameters)
                    .with_isa(isa)
                    .with_precision(precision)
                    .with_threads(threads);
                // What was there before must not shine through.
                hits.t.fill(f32::NAN);
                hits.prim.fill(7);
                any.fill(7);
                let trace = tracer.nearest(mesh, batch, &mut workspace, &mut hits);
                assert_eq!(bits(&hits), bits(&expected.0), "{tracer:?}");
                assert_eq!(trace.invalid_rays, expected.1.invalid_rays, "{tracer:?}");
                assert_eq!(trace.shared_origin, expected.1.shared_origin, "{tracer:?}");
                tracer.any(mesh, batch, &mut workspace, &mut any);
                assert_eq!(any, expected_any, "{tracer:?}");
            }
        }
    }
}

fn check_all(precision: Precision) {
    for rays in [0, 1, 63, 64, 65, 5000] {
        for shared in [false, true] {
            for mesh in meshes() {
                check(&Case::new(mesh, random_rays(rays, 2, shared)), precision);
            }
        }
    }
    let batch = random_rays(5000, 2, false);
    assert!(batch.iter().filter(|ray| !ray.is_valid()).count() > 100);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    check_all(Precision::Fast);
}

#[test]
fn likewise_watertight() {
    check_all(Precision::Watertight);
}

#[test]
fn likewise_exact() {
    check_all(Precision::Exact);
}

#[test]
fn threads_that_meet_in_the_same_splits_give_the_same_bits_each_time() {
    let case = Case::new(soup(3000, 4), random_rays(20_000, 5, false));
    let tracer = Tracer::new(finest_best()[0]);
    let expected = case.nearest(tracer).0;
    for _ in 0..20 {
        let found = case.nearest(tracer.with_threads(4)).0;
        assert_eq!(bits(&found), bits(&expected));
    }
}

#[test]
fn a_watched_trace_is_of_one_thread() {
    let case = Case::new(soup(200, 1), random_rays(300, 2, false));
    let one = Tracer::new(finest_best()[0]);
    let three = one.with_threads(3);
    let valid = case.batch.iter().position(|ray| ray.is_valid());
    let ray = valid.unwrap();
    let watch = |tracer: Tracer| {
        let mut hits = Hits::misses(case.batch.len());
        let mut workspace = tracer.workspace(case.batch.len(), case.mesh.len());
        tracer.watch_nearest(&case.mesh, &case.batch, &mut workspace, &mut hits, ray)
    };
    let (trace, steps) = watch(three);
    assert_eq!((trace, steps.len()), (watch(one).0, watch(one).1.len()));
    assert!(!steps.is_empty());
}

#[test]
fn methods_of_papers_take_one_thread() {
    let case = Case::new(soup(500, 1), random_rays(500, 2, true));
    for method in Method::ALL {
        let parameters = method.parameters();
        assert_eq!(parameters.takes_threads(), method == Method::Best);
        if !parameters.takes_threads() {
            let one = Tracer::new(parameters);
            let (found, trace) = case.nearest(one.with_threads(4));
            let (expected, as_one) = case.nearest(one);
            assert_eq!((bits(&found), trace), (bits(&expected), as_one), "{method}");
            assert_eq!(
                Workspace::bytes_for(&parameters, 10, 10, 4),
                Workspace::bytes_for(&parameters, 10, 10, 1)
            );
        }
    }
}
