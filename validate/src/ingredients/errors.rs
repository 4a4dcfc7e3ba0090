//! Errors of the tests against exact arithmetic.

use super::pairs::Source;
use crate::exact::meet;
use dacrt::bench::ingredients::{BOX_TESTS, Pairs, TRIANGLE_TESTS};
use dacrt::{Hits, Isa, Mesh, Method, Precision, Ray, Tracer, Triangle};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Errors on the pairs of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Set {
    /// The kind.
    pub name: String,
    /// How many.
    pub pairs: u64,
    /// How many of them are hits in exact arithmetic.
    pub hits: u64,
    /// The tests of [`TRIANGLE_TESTS`], then the kernels of record.
    pub triangle_tests: Vec<TriangleErrors>,
    /// Pairs of a ray without a component that has no finite inverse, with a hit in exact arithmetic.
    pub box_pairs: u64,
    /// The tests of [`BOX_TESTS`].
    pub box_tests: Vec<BoxErrors>,
}

/// Errors of a test of triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TriangleErrors {
    /// Its name.
    pub test: String,
    /// Whether it is the kernel of record of a precision.
    pub record: bool,
    /// Hits that it misses.
    pub lost: u64,
    /// Misses that it hits.
    pub false_hits: u64,
    /// How far t of right hits is off, relative to t.
    pub relative: Option<Spread>,
    /// The same in units in the last place of float32; 0.5 at most if correctly rounded.
    pub ulps: Option<Spread>,
}

/// How errors are spread.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Half of them are no larger.
    pub median: f64,
    /// All but one of a thousand are no larger.
    pub p999: f64,
    /// None is larger.
    pub max: f64,
}

/// Errors of a test of boxes, on triangles that are hit in exact arithmetic and their own boxes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoxErrors {
    /// Its name.
    pub test: String,
    /// Boxes that are missed.
    pub missed: u64,
    /// Hits outside of the interval of the box, those included whose box is missed; by t as `fast`
    /// computes it, where it hits.
    pub fast_t_outside: u64,
    /// The same by the exact t.
    pub exact_t_outside: u64,
}

/// The hit of a pair in exact arithmetic.
#[derive(Clone, Copy)]
struct Exact {
    t: f64,
    /// The distance from the next float32.
    ulp: f64,
}

impl Spread {
    /// That of some errors; none of nothing.
    pub fn of(mut errors: Vec<f64>) -> Option<Spread> {
        errors.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let place = (share * errors.len() as f64).ceil() as usize;
            errors[place.clamp(1, errors.len()) - 1]
        };
        (!errors.is_empty()).then(|| Spread {
            median: at(0.5),
            p999: at(0.999),
            max: at(1.0),
        })
    }
}

/// Errors of all tests, on one instruction set. Costs about 20 µs a pair and core.
///
/// # Panics
/// If this processor does not have the instruction set.
pub fn measure(source: &Source, isa: Isa) -> Set {
    let exact: Vec<Option<Exact>> = source
        .pairs
        .par_iter()
        .map(|(ray, triangle)| meet(ray, triangle).map(|t| Exact::new(t.to_f64(), t.to_f32())))
        .collect();
    let pairs = Pairs::new(&source.pairs);
    let tests = TRIANGLE_TESTS
        .iter()
        .map(|test| triangle_errors(test.name, false, &test.pairs(isa, &pairs), &exact));
    let records = Precision::ALL.into_iter().map(|precision| {
        let t = traced(&source.pairs, precision, isa);
        triangle_errors(precision.name(), true, &t, &exact)
    });

    let (in_boxes, exact_in_boxes): (Vec<_>, Vec<_>) = (source.pairs.iter().zip(&exact))
        .filter_map(|(&pair, &exact)| {
            let inverse = pair.0.direction.recip();
            inverse.is_finite().then_some((pair, exact?.t))
        })
        .unzip();
    let in_boxes = Pairs::new(&in_boxes);
    let fast = TRIANGLE_TESTS[0].pairs(isa, &in_boxes);
    let box_tests = BOX_TESTS.iter().map(|test| {
        let (near, far) = test.intervals(isa, &in_boxes);
        let count = |wrong: &dyn Fn(usize) -> bool| {
            (0..in_boxes.len()).filter(|&i| wrong(i)).count() as u64
        };
        BoxErrors {
            test: test.name.to_owned(),
            missed: count(&|i| near[i] > far[i]),
            fast_t_outside: count(&|i| {
                fast[i].is_finite() && !(near[i] <= fast[i] && fast[i] <= far[i])
            }),
            exact_t_outside: count(&|i| {
                let t = exact_in_boxes[i];
                !(f64::from(near[i]) <= t && t <= f64::from(far[i]))
            }),
        }
    });
    Set {
        name: source.name.clone(),
        pairs: source.pairs.len() as u64,
        hits: exact.iter().flatten().count() as u64,
        triangle_tests: tests.chain(records).collect(),
        box_pairs: in_boxes.len() as u64,
        box_tests: box_tests.collect(),
    }
}

impl Exact {
    fn new(t: f64, rounded: f32) -> Exact {
        let ulp = f64::from(rounded.next_up()) - f64::from(rounded);
        Exact { t, ulp }
    }
}

fn triangle_errors(test: &str, record: bool, t: &[f32], exact: &[Option<Exact>]) -> TriangleErrors {
    let (mut lost, mut false_hits) = (0, 0);
    let (mut relative, mut ulps) = (Vec::new(), Vec::new());
    for (&t, exact) in t.iter().zip(exact) {
        match (exact, t.is_finite()) {
            (Some(_), false) => lost += 1,
            (None, true) => false_hits += 1,
            (None, false) => {}
            (Some(exact), true) => {
                let error = (f64::from(t) - exact.t).abs();
                relative.push(error / exact.t);
                ulps.push(error / exact.ulp);
            }
        }
    }
    TriangleErrors {
        test: test.to_owned(),
        record,
        lost,
        false_hits,
        relative: Spread::of(relative),
        ulps: Spread::of(ulps),
    }
}

/// What the kernel of record of a precision says, each pair being a scene of its own.
fn traced(pairs: &[(Ray, Triangle)], precision: Precision, isa: Isa) -> Vec<f32> {
    let tracer = Tracer::new(Method::Afra2012.parameters())
        .with_precision(precision)
        .with_isa(isa)
        .with_own_origins(true);
    let part = |pairs: &[(Ray, Triangle)]| {
        let mut workspace = tracer.workspace(1, 1);
        let mut hits = Hits::misses(1);
        let t = |&(ray, triangle): &(Ray, Triangle)| {
            let (mesh, batch) = (Mesh::new(vec![triangle]), [ray].into_iter().collect());
            tracer.nearest(&mesh, &batch, &mut workspace, &mut hits);
            hits.t[0]
        };
        pairs.iter().map(t).collect::<Vec<_>>()
    };
    pairs.par_chunks(4096).flat_map_iter(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_made_of_its_errors() {
        assert_eq!(Spread::of(Vec::new()), None);
        let errors = (1..=2000).rev().map(f64::from).collect();
        let spread = Spread {
            median: 1000.0,
            p999: 1998.0,
            max: 2000.0,
        };
        assert_eq!(Spread::of(errors), Some(spread));
    }

    #[test]
    fn lost_and_false_hits_are_told_apart() {
        let exact = Some(Exact::new(1.0, 1.0));
        let hit = 1.0 + f32::EPSILON;
        let miss = f32::INFINITY;
        let errors = triangle_errors(
            "",
            false,
            &[hit, miss, hit, miss, miss],
            &[exact, exact, None, None, exact],
        );
        assert_eq!((errors.lost, errors.false_hits), (2, 1));
        assert_eq!(errors.ulps.unwrap().max, 1.0);
        assert_eq!(errors.relative.unwrap().max, f64::from(f32::EPSILON));
    }
}
