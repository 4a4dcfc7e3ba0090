//! Kernels on their own: the same work in each pass, the same answers on each instruction set.

use dacrt::Isa;
use dacrt::bench::KERNELS;

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
