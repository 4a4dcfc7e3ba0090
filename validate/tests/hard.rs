//! The hard cases: the same every time, as they say they are, and errors are found.

use dacrt::{Batch, Hits, Mesh, Precision, Ray};
use dacrt_validate::exact::{Arbiter, has_area, meet};
use dacrt_validate::hard::trial::{Answered, Contestant, Outcome, ours};
use dacrt_validate::hard::{Case, Expected, FAMILIES, Family, FamilyResult, What};
use dacrt_validate::hash::ray_hash;
use glam::Vec3;
use std::collections::HashMap;

const RAYS: usize = 512;

fn family(name: &str) -> Family {
    *FAMILIES.iter().find(|f| f.name == name).unwrap()
}

/// The answers of exact arithmetic.
fn exact(case: &Case) -> Hits {
    let arbiter = Arbiter::new(&case.mesh);
    let mut hits = Hits::misses(case.batch.len());
    for (i, ray) in case.batch.iter().enumerate() {
        if let Some(nearest) = arbiter.nearest(&ray) {
            (hits.t[i], hits.prim[i]) = (nearest.t.to_f32(), nearest.prim);
        }
    }
    hits
}

fn answered(precision: Precision, hits: Hits) -> Answered {
    Answered {
        contestant: Contestant::Ours(precision),
        differs: vec![false; hits.len()],
        hits,
    }
}

/// The result of one case with these answers.
fn result(family: &Family, case: &Case, answers: &[Answered]) -> FamilyResult {
    let mut outcome = Outcome::new(family);
    outcome.enter(case, answers);
    assert_eq!(
        outcome.findings.is_empty(),
        outcome.result.findings.is_empty()
    );
    outcome.result
}

fn findings(result: &FamilyResult) -> Vec<(&str, What, u64)> {
    let of = result.findings.iter();
    of.map(|f| (&*f.contestant, f.what, f.rays)).collect()
}

fn bits(mesh: &Mesh) -> Vec<u32> {
    let corners = mesh.triangles().iter().flat_map(|t| [t.a, t.b, t.c]);
    corners
        .flat_map(|p| p.to_array().map(f32::to_bits))
        .collect()
}

#[test]
fn the_same_seed_gives_the_same_cases_and_another_does_not() {
    for family in FAMILIES {
        let (a, b) = (family.cases(RAYS, 1), family.cases(RAYS, 1));
        let other = family.cases(RAYS, 2);
        let hashes = |cases: &[Case]| -> Vec<String> {
            cases.iter().map(|case| ray_hash(&case.batch)).collect()
        };
        assert_eq!(hashes(&a), hashes(&b), "{}", family.name);
        assert!(
            a.iter()
                .zip(&b)
                .all(|(a, b)| bits(&a.mesh) == bits(&b.mesh))
        );
        assert_eq!(
            hashes(&a) == hashes(&other),
            family.name == "issues",
            "{}",
            family.name
        );
    }
}

#[test]
fn names_and_sizes_are_as_said() {
    for family in FAMILIES {
        let same_name = |f: &&Family| f.name == family.name;
        assert_eq!(FAMILIES.iter().filter(same_name).count(), 1);
        let rays: usize = family.cases(4096, 1).iter().map(|c| c.batch.len()).sum();
        assert!((1..=4096).contains(&rays), "{}: {rays}", family.name);
    }
}

/// By position, each edge of a closed mesh is in exactly two triangles of non-zero area.
#[test]
fn closed_meshes_are_closed() {
    let mut closed = 0;
    for family in FAMILIES {
        for case in family.cases(RAYS, 1).iter().filter(|case| case.closed) {
            let mut edges: HashMap<[[u32; 3]; 2], u32> = HashMap::new();
            for t in case.mesh.triangles() {
                assert!(has_area(t), "{}, {}", family.name, case.name);
                // -0 and 0 are one place.
                let corners =
                    [t.a, t.b, t.c].map(|p| (p + Vec3::ZERO).to_array().map(f32::to_bits));
                for k in 0..3 {
                    let mut edge = [corners[k], corners[(k + 1) % 3]];
                    edge.sort();
                    *edges.entry(edge).or_default() += 1;
                }
            }
            assert!(
                edges.values().all(|&n| n == 2),
                "{}, {}",
                family.name,
                case.name
            );
            closed += 1;
        }
    }
    assert!(closed > 20);
}

/// The constructions know what must come out, and exact arithmetic says the same.
#[test]
fn exact_arithmetic_meets_every_expectation() {
    let mut expected = 0;
    for family in FAMILIES {
        let mut outcome = Outcome::new(&family);
        for case in family.cases(2048, 3) {
            assert_eq!(case.batch.len(), case.expected.len());
            outcome.enter(&case, &[]);
        }
        let first = outcome.findings.first();
        assert_eq!(findings(&outcome.result), [], "{}: {first:#?}", family.name);
        expected += outcome.result.expected;
    }
    assert!(expected > 20_000, "{expected}");
}

#[test]
fn an_expectation_that_is_not_met_is_a_finding() {
    let family = family("interval");
    let mut case = family.cases(RAYS, 1).remove(0);
    let is_hit = |e: &Expected| matches!(e, Expected::Is(..));
    let place = case.expected.iter().position(is_hit).unwrap();
    case.expected[place] = Expected::Miss;
    let result = result(&family, &case, &[]);
    assert_eq!(findings(&result), [("arbiter", What::Arbiter, 1)]);
    assert_eq!(result.arbiter_unexpected, 1);
}

/// Right answers are no findings, each kind of wrong answer is one.
#[test]
fn a_hit_that_is_dropped_or_changed_is_found() {
    use Precision::{Exact, Fast, Watertight};
    let family = family("inside");
    let case = &family.cases(RAYS, 1)[0];
    let right = exact(case);
    let all = Precision::ALL.map(|precision| answered(precision, right.clone()));
    assert_eq!(findings(&result(&family, case, &all)), []);

    let changed = |precision, change: fn(&mut f32, &mut u32)| {
        let mut hits = right.clone();
        change(&mut hits.t[7], &mut hits.prim[7]);
        let name = precision_name(precision);
        let result = result(&family, case, &[answered(precision, hits)]);
        let found = findings(&result)
            .iter()
            .map(|&(who, what, n)| (who == name, what, n))
            .collect();
        let count = result.contestants[name];
        (
            found,
            [
                count.lost,
                count.false_hits,
                count.wrong,
                count.beyond_bounds,
            ],
        )
    };
    let one = |what| vec![(true, what, 1)];
    let drop = |t: &mut f32, prim: &mut u32| (*t, *prim) = (f32::INFINITY, dacrt::MISS);
    assert_eq!(changed(Fast, drop), (one(What::BeyondBounds), [1, 0, 0, 1]));
    assert_eq!(changed(Watertight, drop), (one(What::Lost), [1, 0, 0, 1]));
    assert_eq!(changed(Exact, drop), (one(What::NotExact), [1, 0, 0, 1]));
    let far = |t: &mut f32, _: &mut u32| *t *= 1.01;
    assert_eq!(changed(Fast, far), (one(What::BeyondBounds), [0, 0, 1, 1]));
    assert_eq!(changed(Exact, far), (one(What::NotExact), [0, 0, 1, 1]));
    let ulp = |t: &mut f32, _: &mut u32| *t = t.next_up();
    assert_eq!(changed(Exact, ulp).0, one(What::NotExact));
    let other = |_: &mut f32, prim: &mut u32| *prim ^= 1024;
    assert_eq!(
        changed(Fast, other),
        (one(What::BeyondBounds), [0, 1, 0, 1])
    );
}

fn precision_name(precision: Precision) -> &'static str {
    Contestant::Ours(precision).name()
}

/// Where float32 does not round, every precision has to give the exact bits.
#[test]
fn one_ulp_is_a_finding_where_float32_does_not_round() {
    let family = family("grid");
    let case = &family.cases(RAYS, 1)[0];
    let mut hits = exact(case);
    let place = hits.t.iter().position(|t| t.is_finite()).unwrap();
    hits.t[place] = hits.t[place].next_up();
    let result = result(&family, case, &[answered(Precision::Fast, hits)]);
    assert_eq!(findings(&result), [("fast", What::NotExact, 1)]);
}

#[test]
fn methods_that_differ_are_a_finding() {
    let family = family("inside");
    let case = &family.cases(RAYS, 1)[1];
    let mut fast = ours(case, Precision::Fast);
    assert!(!fast.differs.contains(&true));
    fast.differs[3] = true;
    let result = result(&family, case, &[fast]);
    assert_eq!(findings(&result), [("fast", What::MethodsDiffer, 1)]);
}

/// Along a ray from inside a closed mesh lies an odd number of hits, unless it meets an edge.
#[test]
fn parity_of_exact_hits_is_odd() {
    let mut rays = 0;
    for case in family("inside").cases(60, 5) {
        for ray in case.batch.iter() {
            let hits = case.mesh.triangles().iter().filter_map(|t| meet(&ray, t));
            let mut hits: Vec<_> = hits.collect();
            let all = hits.len();
            hits.sort();
            hits.dedup();
            if all == hits.len() {
                assert_eq!(all % 2, 1, "{}: {ray:?}", case.name);
                rays += 1;
            }
        }
    }
    assert!(rays > 30, "{rays}");
}

/// Scaling by a power of two changes neither triangles nor t, in any precision.
#[test]
fn scaled_cases_have_the_same_hits() {
    for case in family("edges").cases(RAYS, 1) {
        let plain = ours(&case, Precision::Fast).hits;
        let truth = exact(&case);
        for by in [2f32.powi(20), 2f32.powi(-20)] {
            let scale = |t: &dacrt::Triangle| dacrt::Triangle::new(t.a * by, t.b * by, t.c * by);
            let scaled = Case {
                mesh: Mesh::new(case.mesh.triangles().iter().map(scale).collect()),
                batch: scaled_batch(&case.batch, by),
                expected: case.expected.clone(),
                ..case
            };
            assert_eq!(ours(&scaled, Precision::Fast).hits, plain, "{}", case.name);
            assert_eq!(exact(&scaled), truth, "{}", case.name);
        }
    }
}

fn scaled_batch(batch: &Batch, by: f32) -> Batch {
    let scaled = |ray: Ray| Ray {
        origin: ray.origin * by,
        direction: ray.direction * by,
        ..ray
    };
    batch.iter().map(scaled).collect()
}

/// Half of a batch invalid: the other half is as if it were alone.
#[test]
fn invalid_rays_change_no_other_hit() {
    for case in family("invalid").cases(2 * RAYS, 7) {
        let valid = |i: &usize| case.batch.ray(*i).is_valid();
        let places: Vec<usize> = (0..case.batch.len()).filter(valid).collect();
        let alone = Case {
            batch: places.iter().map(|&i| case.batch.ray(i)).collect(),
            expected: places.iter().map(|&i| case.expected[i]).collect(),
            mesh: case.mesh.clone(),
            ..case
        };
        for precision in Precision::ALL {
            let all = ours(&case, precision).hits;
            let some = ours(&alone, precision).hits;
            let of_all: Vec<_> = places.iter().map(|&i| (all.t[i], all.prim[i])).collect();
            let of_some: Vec<_> = some.t.into_iter().zip(some.prim).collect();
            assert_eq!(of_all, of_some, "{}, {precision}", case.name);
        }
    }
}
