//! Kernels on their own: the same work in each pass, the same answers on each instruction set.

use dacrt::bench::KERNELS;
use dacrt::bench::ingredients::{BOX_TESTS, Pairs, TRIANGLE_TESTS};
use dacrt::random::{hash, unit_f64};
use dacrt::*;
use glam::Vec3;

#[test]
fn a_pass_does_the_same_work_each_time_and_on_each_instruction_set() {
    for kernel in KERNELS {
        let name = kernel.name;
        let mut bench = kernel.prepare(200_000);
        let before = bench.digest();
        let tests = bench.run(Isa::Portable);
        let after = bench.digest();
        assert!(tests > 0 && after != before, "{name}");
        for isa in Isa::available() {
            for _ in 0..2 {
                bench.reset();
                assert_eq!(bench.digest(), before, "{name}, {isa}");
                assert_eq!(bench.run(isa), tests, "{name}, {isa}");
                assert_eq!(bench.digest(), after, "{name}, {isa}");
            }
        }
    }
}

#[test]
fn tests_grow_with_the_working_set() {
    for kernel in KERNELS {
        let tests = |bytes| kernel.prepare(bytes).run(Isa::best());
        assert!(tests(0) > 0, "{}", kernel.name);
        let ratio = tests(2_000_000) as f64 / tests(500_000) as f64;
        assert!((3.0..5.0).contains(&ratio), "{}: {ratio}", kernel.name);
    }
}

/// The bound of a copy is made of them.
#[test]
fn bytes_are_those_of_the_layout() {
    for (name, least, most) in [
        ("triangle/plane, in order", 16.0, 16.0),
        ("triangle/cell, nine axes", 48.0, 48.0),
        ("cone/box", 24.0, 24.0),
        ("ray/box indexed, one origin", 24.0, 24.0),
        // About half of the records are copied.
        (
            "ray/box copied, one origin",
            20.0 + 0.3 * 16.0,
            20.0 + 0.7 * 16.0,
        ),
        ("ray/box in place, own origins", 60.0, 60.0),
        ("ray/triangle copied, one origin", 2.25, 2.25),
    ] {
        let kernel = KERNELS.iter().find(|k| k.name == name).unwrap();
        let bytes = kernel.prepare(100_000).bytes_per_test();
        assert!((least..=most).contains(&bytes), "{name}: {bytes}");
    }
}

#[test]
fn names_are_distinct() {
    let names: std::collections::HashSet<_> = KERNELS.iter().map(|k| k.name).collect();
    assert_eq!(names.len(), KERNELS.len());
}

/// Rays at and beside triangles near them, both of any size.
fn pairs(n: u64, origin: Option<Vec3>) -> Vec<(Ray, Triangle)> {
    let pair = |i| {
        let r = |k| unit_f64(hash(1, i, k)) as f32 * 2.0 - 1.0;
        let point = |k| Vec3::new(r(k), r(k + 1), r(k + 2));
        let triangle = Triangle::new(point(0), point(3), point(6));
        let Triangle { a, b, c } = triangle;
        let target = a + 1.2 * r(12).abs() * (b - a) + 1.2 * r(13).abs() * (c - a);
        let origin = origin.unwrap_or(2.0 * point(9));
        (Ray::new(origin, target - origin), triangle)
    };
    (0..n).map(pair).collect()
}

/// What the kernel of record of `fast` says, a trace a pair.
fn traced(pairs: &[(Ray, Triangle)], own_origins: bool) -> Vec<f32> {
    let tracer = Tracer::new(Method::Afra2012.parameters()).with_own_origins(own_origins);
    let mut workspace = tracer.workspace(1, 1);
    let mut hits = Hits::misses(1);
    let t = |&(ray, triangle): &(Ray, Triangle)| {
        let batch = [ray].into_iter().collect();
        tracer.nearest(
            &Mesh::new(vec![triangle]),
            &batch,
            &mut workspace,
            &mut hits,
        );
        hits.t[0]
    };
    pairs.iter().map(t).collect()
}

#[test]
fn the_test_that_others_differ_from_is_the_kernel_of_record() {
    for origin in [None, Some(Vec3::new(0.1, -0.2, 1.3))] {
        let pairs = pairs(2003, origin);
        let expected = traced(&pairs, origin.is_none());
        let name = if origin.is_some() {
            "folded origin"
        } else {
            "fast"
        };
        let test = TRIANGLE_TESTS.iter().find(|t| t.name == name).unwrap();
        let hits = expected.iter().filter(|t| t.is_finite()).count();
        assert!((500..1500).contains(&hits), "{hits}");
        for isa in Isa::available() {
            assert_eq!(
                test.pairs(isa, &Pairs::new(&pairs)),
                expected,
                "{name}, {isa}"
            );
        }
    }
}

#[test]
fn tests_of_triangles_agree_but_for_rounding() {
    let origin = Some(Vec3::new(0.1, -0.2, 1.3));
    let pairs = pairs(2000, origin);
    let expected = TRIANGLE_TESTS[0].pairs(Isa::Portable, &Pairs::new(&pairs));
    let rays: Batch = pairs.iter().map(|&(ray, _)| ray).collect();
    let triangles: Vec<Triangle> = pairs[..37].iter().map(|&(_, triangle)| triangle).collect();
    for test in TRIANGLE_TESTS {
        for isa in Isa::available() {
            let context = format!("{}, {isa}", test.name);
            let t = test.pairs(isa, &Pairs::new(&pairs));
            let close = |(x, y): &(&f32, &f32)| x == y || (*x / *y - 1.0).abs() < 1e-3;
            assert_eq!(
                t.iter().zip(&expected).filter(close).count(),
                2000,
                "{context}"
            );
            // Each ray against many is the least of pairs.
            let mut nearest = vec![f32::INFINITY; rays.len()];
            test.nearest(isa, &rays, &triangles, &mut nearest);
            for (ray, nearest) in rays.iter().zip(&nearest) {
                let with_all: Vec<_> = triangles.iter().map(|&t| (ray, t)).collect();
                let t = test.pairs(isa, &Pairs::new(&with_all));
                let least = t.iter().copied().fold(f32::INFINITY, f32::min);
                assert_eq!(*nearest, least, "{context}");
            }
        }
    }
}

#[test]
fn tests_of_boxes_agree_but_for_rounding() {
    let pairs = pairs(2000, None);
    let rays: Batch = pairs.iter().map(|&(ray, _)| ray).collect();
    let triangles: Vec<Triangle> = pairs[..37].iter().map(|&(_, triangle)| triangle).collect();
    let (near, far) = BOX_TESTS[0].intervals(Isa::Portable, &Pairs::new(&pairs));
    for test in BOX_TESTS {
        for isa in Isa::available() {
            let context = format!("{}, {isa}", test.name);
            let of_test = test.intervals(isa, &Pairs::new(&pairs));
            for (x, y) in [(&near, &of_test.0), (&far, &of_test.1)] {
                for (x, y) in x.iter().zip(y) {
                    assert!(
                        (x - y).abs() <= 1e-3 * (1.0 + x.abs()),
                        "{x} {y}, {context}"
                    );
                }
            }
            let mut met = vec![0.0; rays.len()];
            test.met(isa, &rays, &triangles, &mut met);
            for (ray, met) in rays.iter().zip(met) {
                let with_all: Vec<_> = triangles.iter().map(|&t| (ray, t)).collect();
                let (near, far) = test.intervals(isa, &Pairs::new(&with_all));
                let count = near
                    .iter()
                    .zip(&far)
                    .filter(|(near, far)| near <= far)
                    .count();
                assert_eq!(met, count as f32, "{context}");
            }
        }
    }
}
