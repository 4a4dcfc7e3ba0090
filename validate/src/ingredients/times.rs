//! Times of the tests, in turns.

use crate::statistics::{Ratio, paired_ratio};
use dacrt::bench::Bench;
use dacrt::bench::ingredients::{BOX_TESTS, BoxTest, PRECISIONS, TRIANGLE_TESTS, TriangleTest};
use dacrt::random::{hash, unit_f64};
use dacrt::{Batch, Isa, Ray, Triangle};
use glam::Vec3;
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::time::Instant;

/// Rays of the data, all from one origin, and triangles.
const RAYS: usize = 512;
const TRIANGLES: usize = 256;
/// Bytes of the data of the kernels of record.
const WORKING_SET: usize = 64 << 10;

/// What is measured, and how long.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Which instances; this processor has them all.
    pub isas: Vec<Isa>,
    /// Samples of each test, at least 1.
    pub repeats: usize,
    /// Nanoseconds of a sample at least.
    pub sample_ns: f64,
}

/// Times of all tests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Times {
    /// The tests of triangles, each against the first, `fast`.
    pub triangle_tests: Vec<Time>,
    /// The naive step of each precision, each against the first, `fast`.
    pub precisions: Vec<Time>,
    /// The tests of boxes, each against the first, ours.
    pub box_tests: Vec<Time>,
}

/// One test on one instruction set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Time {
    /// Its name.
    pub test: String,
    /// Name of the instruction set.
    pub isa: String,
    /// Nanoseconds of a pair, of each sample.
    pub samples_ns: Vec<f64>,
    /// Their median and its 95 % bootstrap interval.
    pub ns: Ratio,
    /// The same over the time of the first test on the same instruction set.
    pub over_first: Ratio,
}

/// Data in the nearest cache.
struct Data {
    rays: Batch,
    triangles: Vec<Triangle>,
    /// Least distances, or numbers of boxes.
    out: Vec<f32>,
}

/// Measures all tests. In each repeat, all of one kind take turns on all instruction sets.
///
/// # Panics
/// If this processor does not have one of the instruction sets.
pub fn time(plan: &Plan) -> Times {
    let data = || Data::new(RAYS, TRIANGLES);
    let of_triangles = |test: &'static TriangleTest| {
        let mut data = data();
        let pass = move |isa| {
            let Data {
                rays,
                triangles,
                out,
            } = &mut data;
            out.fill(f32::INFINITY);
            test.nearest(isa, rays, triangles, black_box(out));
            data.pairs()
        };
        Contestant::new(test.name, pass)
    };
    let of_boxes = |test: &'static BoxTest| {
        let mut data = data();
        let pass = move |isa| {
            let Data {
                rays,
                triangles,
                out,
            } = &mut data;
            test.met(isa, rays, triangles, black_box(out));
            data.pairs()
        };
        Contestant::new(test.name, pass)
    };
    let of_precision = |kernel: &dacrt::bench::Kernel| Contestant {
        name: kernel.name,
        work: Work::Kernel(kernel.prepare(WORKING_SET)),
    };
    Times {
        triangle_tests: take_turns(plan, TRIANGLE_TESTS.iter().map(of_triangles).collect()),
        precisions: take_turns(plan, PRECISIONS.iter().map(of_precision).collect()),
        box_tests: take_turns(plan, BOX_TESTS.iter().map(of_boxes).collect()),
    }
}

impl Data {
    /// Triangles of about the size of the unit cube that they reach into, and rays into it, as in the
    /// cells at the end of a trace.
    fn new(rays: usize, triangles: usize) -> Data {
        let point = |key: u64, i: usize| {
            let at = |axis| unit_f64(hash(1, key, 3 * i as u64 + axis)) as f32;
            Vec3::new(at(0), at(1), at(2))
        };
        let origin = Vec3::new(0.5, 0.5, -1.0);
        let ray = |i| Ray::new(origin, point(0, i) - origin);
        let triangle = |i| {
            let corner = |k| point(1, i) + 0.8 * (point(2, 3 * i + k) - Vec3::splat(0.5));
            Triangle::new(corner(0), corner(1), corner(2))
        };
        Data {
            rays: (0..rays).map(ray).collect(),
            triangles: (0..triangles).map(triangle).collect(),
            out: vec![0.0; rays],
        }
    }

    fn pairs(&self) -> u64 {
        (self.rays.len() * self.triangles.len()) as u64
    }
}

/// A test with its data.
struct Contestant {
    name: &'static str,
    work: Work,
}

enum Work {
    /// Does a pass, and returns the number of pairs.
    Pass(Box<dyn FnMut(Isa) -> u64>),
    /// Is reset before each pass.
    Kernel(Bench),
}

impl Contestant {
    fn new(name: &'static str, pass: impl FnMut(Isa) -> u64 + 'static) -> Contestant {
        Contestant {
            name,
            work: Work::Pass(Box::new(pass)),
        }
    }

    /// Nanoseconds of a pair, in passes that take so long together.
    fn sample(&mut self, isa: Isa, least_ns: f64) -> f64 {
        let (mut ns, mut pairs) = (0.0, 0);
        while ns < least_ns {
            if let Work::Kernel(bench) = &mut self.work {
                bench.reset();
            }
            let start = Instant::now();
            pairs += match &mut self.work {
                Work::Pass(pass) => pass(isa),
                Work::Kernel(bench) => bench.run(isa),
            };
            // A clock may be coarse; no pass takes no time.
            ns += (start.elapsed().as_nanos() as f64).max(1.0);
        }
        ns / pairs as f64
    }
}

fn take_turns(plan: &Plan, mut contestants: Vec<Contestant>) -> Vec<Time> {
    let mut times = Vec::new();
    for &isa in &plan.isas {
        let mut samples = vec![Vec::new(); contestants.len()];
        for repeat in 0..=plan.repeats {
            for (contestant, samples) in contestants.iter_mut().zip(&mut samples) {
                let ns = contestant.sample(isa, plan.sample_ns);
                // The first turn brings everything near.
                if repeat > 0 {
                    samples.push(ns);
                }
            }
        }
        for (contestant, of_test) in contestants.iter().zip(&samples) {
            times.push(Time {
                test: contestant.name.to_owned(),
                isa: isa.name().to_owned(),
                samples_ns: of_test.clone(),
                ns: ratio(of_test, &vec![1.0; of_test.len()]),
                over_first: ratio(of_test, &samples[0]),
            });
        }
    }
    times
}

/// As [`paired_ratio`] of samples that pair.
fn ratio(numerators: &[f64], denominators: &[f64]) -> Ratio {
    paired_ratio(numerators, denominators).expect("as many samples of both, at least one")
}
