//! Every ray is counted once, differences that float32 explains are no findings, others are.

mod common;

use common::{Form, any, nearest, rays, soup};
use dacrt::{Batch, Hits, Mesh, Ray, Triangle};
use dacrt::{MISS, Precision};
use dacrt_validate::diff::{Checker, Class, Diff, MOST_JUDGED, ReferenceDiff};
use dacrt_validate::embree::Mode;
use dacrt_validate::hash::hit_hash;
use dacrt_validate::judge::{Answer, Answers, Judge, Verdict};
use fastrand::Rng;
use glam::Vec3;

/// Ours against two references.
fn diff(mesh: &Mesh, batch: &Batch, ours: Answers, fast: Answers, robust: Answers) -> Diff {
    let judge = Judge::new(mesh);
    Checker::new(&judge, batch, fast, robust, 1000, 1).check(
        Precision::Fast,
        ours,
        &hit_hash(&ours),
    )
}

fn total(diff: &ReferenceDiff) -> u64 {
    let known = [
        diff.t_drift,
        diff.edge,
        diff.ours_wrong,
        diff.reference_wrong,
        diff.both_wrong,
    ];
    let differing: u64 = known.into_iter().flatten().sum();
    assert_eq!(differing, diff.differing, "{diff:?}");
    diff.same + diff.tie + differing
}

/// A scene whose rays often meet two triangles at once: shared edges, duplicates.
fn scene(random: &mut Rng) -> (Mesh, Batch) {
    let mut triangles = soup(random, 200, 0.5, 1.0, Vec3::ZERO).triangles().to_vec();
    for i in 0..100 {
        let t = triangles[i];
        triangles.push(Triangle::new(t.b, t.a, t.a + t.b - t.c));
        triangles.push(t);
    }
    let batch = rays(random, 3000, 1.0, Vec3::ZERO, Form::Plain);
    (Mesh::new(triangles), batch)
}

#[test]
fn three_forms_of_the_kernel_explain_each_other() {
    let (mesh, batch) = scene(&mut Rng::with_seed(1));
    let [ours, fast, robust] = common::FORMS.map(|form| nearest(&mesh, &batch, form));
    let of = Answers::Nearest;
    let diff = diff(&mesh, &batch, of(&ours), of(&fast), of(&robust));
    for part in [&diff.embree_fast, &diff.embree_robust] {
        assert_eq!(total(part), 3000);
        assert!(part.same > 2900, "{part:?}");
        assert_eq!((part.wrong(), part.unexplained), (0, None));
        // The bounds hold for all forms, as if all were the kernel of record.
        assert_eq!(part.reference_wrong, Some(0), "{part:?}");
        let (max, p999) = (part.max_relative_t_error, part.p999_relative_t_error);
        assert!(
            p999 <= max && max < Some(1e-2) && p999 < Some(1e-3),
            "{max:?} {p999:?}"
        );
    }
    assert_eq!((diff.wrong(), diff.judged_random), (0, 1000));
    assert!(diff.judged >= 1000 && diff.offending.is_empty());
    let exact = diff.exact.unwrap();
    assert_eq!(
        (exact.rays, total(&exact.classes)),
        (diff.judged, exact.rays)
    );
    assert!(exact.classes.same > 950 && exact.classes.p999_relative_t_error < Some(1e-3));
}

#[test]
fn duplicates_are_ties() {
    let (mesh, batch) = scene(&mut Rng::with_seed(2));
    let ours = nearest(&mesh, &batch, Form::Plain);
    // A reference that keeps the last of equal hits.
    let mut last = ours.clone();
    let mut doubled = 0;
    for (prim, t) in last.prim.iter_mut().zip(&ours.t) {
        if *prim < 100 && t.is_finite() {
            *prim = 201 + 2 * *prim;
            doubled += 1;
        }
    }
    assert!(doubled > 100);
    let of = Answers::Nearest;
    let diff = diff(&mesh, &batch, of(&ours), of(&last), of(&ours));
    assert_eq!(diff.embree_fast.tie, doubled);
    assert_eq!(diff.embree_fast.differing, 0);
    assert_eq!(diff.embree_robust.same, 3000);
}

/// The other half of a parallelogram has the same t, but is not hit: that is no tie.
#[test]
fn a_coplanar_neighbour_is_no_tie() {
    let t = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
    let mesh = Mesh::new(vec![t, Triangle::new(Vec3::X, Vec3::Y, Vec3::X + Vec3::Y)]);
    let batch: Batch = std::iter::once(Ray::new(Vec3::new(0.25, 0.25, 1.0), -Vec3::Z)).collect();
    let hit = |prim| Hits {
        t: vec![1.0],
        prim: vec![prim],
    };
    let of = Answers::Nearest;
    let diff = diff(&mesh, &batch, of(&hit(1)), of(&hit(0)), of(&hit(0)));
    assert_eq!(
        (
            diff.embree_fast.tie,
            diff.embree_fast.ours_wrong,
            diff.wrong()
        ),
        (0, Some(1), 1)
    );
}

#[test]
fn wrong_answers_are_findings_ready_for_replay() {
    let (mesh, batch) = scene(&mut Rng::with_seed(3));
    let right = nearest(&mesh, &batch, Form::Plain);
    let mut ours = right.clone();
    let lost: Vec<usize> = (0..3000)
        .filter(|&i| right.prim[i] != MISS)
        .take(300)
        .collect();
    for &i in &lost {
        (ours.t[i], ours.prim[i]) = (f32::INFINITY, MISS);
    }
    let of = Answers::Nearest;
    let diff = diff(&mesh, &batch, of(&ours), of(&right), of(&right));
    assert_eq!(diff.embree_fast.differing, 300);
    // A few may be at edges, where either answer can be defended.
    assert!(diff.wrong() >= 298 && diff.embree_robust.ours_wrong >= Some(298));
    assert_eq!(total(&diff.embree_robust), 3000);
    assert_eq!(diff.offending.len(), 100);
    let first = &diff.offending[0];
    assert_eq!(first.index as usize, lost[0]);
    let ray = batch.ray(lost[0]);
    assert_eq!(first.ray[3].0, 0.0);
    assert_eq!(first.ray[4].0, ray.direction.x);
    assert_eq!(first.ray_bits[7], "0x7f800000");
    assert_eq!(first.ours, Answer::Miss);
    assert_eq!(first.embree_fast, of(&right).get(lost[0]));
    let [verdict, fast, robust] = first.verdicts.expect("judged");
    assert!(verdict.is_wrong() && fast == Verdict::Right && robust == Verdict::Right);
    // The ray is kept to the bit, also through JSON, infinity included.
    let text = serde_json::to_string(&diff).unwrap();
    assert_eq!(serde_json::from_str::<Diff>(&text).unwrap(), diff);
}

/// All three may be wrong together: the random rays find that.
#[test]
fn random_rays_catch_what_no_reference_shows() {
    let (mesh, batch) = scene(&mut Rng::with_seed(4));
    let wrong = Hits::misses(batch.len());
    let of = Answers::Nearest;
    let diff = diff(&mesh, &batch, of(&wrong), of(&wrong), of(&wrong));
    assert_eq!(
        (diff.differing, diff.judged, diff.embree_fast.wrong()),
        (0, 1000, 0)
    );
    assert!(diff.wrong() > 300 && diff.exact.unwrap().classes.ours_wrong > Some(300));
}

#[test]
fn occlusion_is_compared_alone() {
    let (mesh, batch) = scene(&mut Rng::with_seed(5));
    let right = any(&mesh, &batch, Form::Plain);
    let mut ours = right.clone();
    let i = ours.iter().position(|&o| o == 1).unwrap();
    let k = ours.iter().position(|&o| o == 0).unwrap();
    (ours[i], ours[k]) = (0, 1);
    let of = Answers::Any;
    let diff = diff(&mesh, &batch, of(&ours), of(&right), of(&right));
    assert_eq!((diff.embree_fast.same, diff.embree_fast.tie), (2998, 0));
    assert_eq!((diff.embree_fast.ours_wrong, diff.wrong()), (Some(2), 2));
    assert_eq!(diff.embree_fast.max_relative_t_error, None);
}

#[test]
fn equal_hits_are_judged_once() {
    let (mesh, batch) = scene(&mut Rng::with_seed(6));
    let hits = nearest(&mesh, &batch, Form::Plain);
    let misses = Hits::misses(batch.len());
    let judge = Judge::new(&mesh);
    let of = Answers::Nearest;
    let mut checker = Checker::new(&judge, &batch, of(&hits), of(&hits), 1000, 1);
    let diff = checker.check(Precision::Fast, of(&hits), "a");
    // Known by its hash, so what is given with it is not looked at.
    assert_eq!(checker.check(Precision::Fast, of(&misses), "a"), diff);
    assert_ne!(checker.check(Precision::Fast, of(&misses), "b"), diff);
}

#[test]
fn classes_of_rays_are_those_that_are_counted() {
    let (mesh, batch) = scene(&mut Rng::with_seed(7));
    let [ours, fast, robust] = common::FORMS.map(|form| nearest(&mesh, &batch, form));
    let of = Answers::Nearest;
    let judge = Judge::new(&mesh);
    let mut checker = Checker::new(&judge, &batch, of(&fast), of(&robust), 0, 1);
    for precision in Precision::ALL {
        let diff = checker.check(precision, of(&ours), precision.name());
        for (mode, part) in Mode::ALL
            .into_iter()
            .zip([diff.embree_fast, diff.embree_robust])
        {
            let classes = checker.classes(precision, of(&ours), mode);
            let count = |class| classes.iter().filter(|&&c| c == class).count() as u64;
            assert_eq!(classes.len(), batch.len());
            assert_eq!(count(Class::Same), part.same, "{precision}");
            assert_eq!(count(Class::Tie), part.tie, "{precision}");
            assert_eq!(Some(count(Class::Edge)), part.edge, "{precision}");
            assert_eq!(
                Some(count(Class::OursWrong)),
                part.ours_wrong,
                "{precision}"
            );
            assert_eq!(Some(count(Class::TDrift)), part.t_drift, "{precision}");
            assert_eq!(
                Some(count(Class::BothWrong)),
                part.both_wrong,
                "{precision}"
            );
        }
    }
}

#[test]
fn an_empty_batch_is_fine() {
    let mesh = Mesh::new(vec![]);
    let (batch, hits) = (Batch::default(), Hits::default());
    let of = Answers::Nearest;
    let diff = diff(&mesh, &batch, of(&hits), of(&hits), of(&hits));
    assert_eq!((diff.judged, diff.wrong()), (0, 0));
    assert_eq!(diff.embree_fast.p999_relative_t_error, None);
}

/// One triangle at t = 2 and one at t = 3 behind it, and a ray through both.
fn one_ray() -> (Mesh, Batch) {
    let at = |z: f32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + z * Vec3::Z);
    let triangles = [at(0.0), at(1.0)].map(|[a, b, c]| Triangle::new(a, b, c));
    let ray = Ray::new(Vec3::new(0.25, 0.25, -2.0), Vec3::Z);
    (Mesh::new(triangles.into()), std::iter::once(ray).collect())
}

/// The class of ours against the default mode, and against exact arithmetic.
fn classes(
    mesh: &Mesh,
    batch: &Batch,
    ours: (f32, u32),
    reference: (f32, u32),
) -> [&'static str; 2] {
    let hit = |(t, prim)| Hits {
        t: vec![t],
        prim: vec![prim],
    };
    let (ours, reference) = (hit(ours), hit(reference));
    let of = Answers::Nearest;
    let diff = diff(mesh, batch, of(&ours), of(&reference), of(&ours));
    let class = |part: &ReferenceDiff| {
        assert_eq!(total(part), 1);
        [
            ("same", Some(part.same)),
            ("t_drift", part.t_drift),
            ("tie", Some(part.tie)),
            ("edge", part.edge),
            ("ours_wrong", part.ours_wrong),
            ("reference_wrong", part.reference_wrong),
            ("both_wrong", part.both_wrong),
        ]
        .into_iter()
        .find(|(_, n)| *n == Some(1))
        .unwrap()
        .0
    };
    [
        class(&diff.embree_fast),
        class(&diff.exact.unwrap().classes),
    ]
}

#[test]
fn every_class_is_what_exact_arithmetic_says() {
    let (mesh, batch) = one_ray();
    let (right, behind, miss) = ((2.0, 0), (3.0, 1), (f32::INFINITY, MISS));
    let of = |ours, reference| classes(&mesh, &batch, ours, reference);
    assert_eq!(of(right, right), ["same", "same"]);
    assert_eq!(of(right, (2.001, 0)), ["reference_wrong", "same"]);
    assert_eq!(of((2.001, 0), right), ["t_drift", "t_drift"]);
    assert_eq!(of((2.001, 0), miss), ["both_wrong", "t_drift"]);
    // The right distance, to the wrong triangle; and one that both believe in.
    assert_eq!(of((3.1, 1), behind), ["t_drift", "ours_wrong"]);
    assert_eq!(of(behind, behind), ["same", "ours_wrong"]);
    for wrong in [behind, miss, (2.0, 7), (f32::NAN, 0)] {
        assert_eq!(of(right, wrong)[0], "reference_wrong", "{wrong:?}");
        if !wrong.0.is_nan() {
            assert_eq!(of(wrong, right), ["ours_wrong"; 2], "{wrong:?}");
        }
    }
    assert_eq!(of(behind, miss), ["both_wrong", "ours_wrong"]);
}

/// Meets the edge x = 0 of the first triangle of [`one_ray`], or passes it by a last digit of its
/// origin, less than float32 can tell; and then the second triangle, far from its edges.
fn at_the_edge(side: f32) -> Batch {
    let d = Vec3::new(0.3, 0.4, 1.0);
    let mut ray = Ray::new(Vec3::new(0.0, 0.25, 0.0) - 2.0 * d, d);
    ray.origin.x += side * 2.0_f32.powi(-24);
    assert_eq!(ray.origin.x + 2.0 * d.x, side * 2.0_f32.powi(-24));
    std::iter::once(ray).collect()
}

/// Hit and miss, near and far are both defensible, whichever side the ray passes by.
#[test]
fn at_an_edge_either_answer_is_defensible() {
    let (both, _) = one_ray();
    let first = Mesh::new(both.triangles()[..1].to_vec());
    let near = (2.0, 0);
    for (mesh, other) in [(&both, (3.0, 1)), (&first, (f32::INFINITY, MISS))] {
        for (side, exact) in [(1.0, near), (0.0, near), (-1.0, other)] {
            let batch = at_the_edge(side);
            for (ours, reference) in [(near, other), (other, near)] {
                let in_exact = if ours == exact { "same" } else { "edge" };
                let found = classes(mesh, &batch, ours, reference);
                assert_eq!(found, ["edge", in_exact], "{side} {ours:?} {reference:?}");
            }
        }
    }
}

/// Float32 may miss the first triangle, but not the second one, too.
#[test]
fn the_certain_hit_behind_an_uncertain_one_must_be_found() {
    let (mesh, _) = one_ray();
    let (near, far, miss) = ((2.0, 0), (3.0, 1), (f32::INFINITY, MISS));
    for (side, exact) in [(1.0, near), (0.0, near), (-1.0, far)] {
        let batch = at_the_edge(side);
        let classes = |ours, reference| classes(&mesh, &batch, ours, reference);
        for other in [near, far] {
            assert_eq!(classes(miss, other), ["ours_wrong"; 2], "{side} {other:?}");
            let in_exact = if other == exact { "same" } else { "edge" };
            assert_eq!(
                classes(other, miss),
                ["reference_wrong", in_exact],
                "{side} {other:?}"
            );
        }
    }
}

#[test]
fn at_the_ends_of_the_interval_either_answer_is_defensible() {
    let (both, batch) = one_ray();
    let mesh = Mesh::new(both.triangles()[..1].to_vec());
    let (near, miss) = ((2.0, 0), (f32::INFINITY, MISS));
    let up_to = |tmax, ours, reference| {
        let ray = Ray {
            tmax,
            ..batch.ray(0)
        };
        classes(&mesh, &std::iter::once(ray).collect(), ours, reference)
    };
    assert_eq!(up_to(2.0, miss, near), ["edge", "edge"]);
    assert_eq!(up_to(2.0, near, miss), ["edge", "same"]);
    let before = 2.0_f32.next_down();
    assert_eq!(up_to(before, miss, near), ["edge", "same"]);
    // Our t is beyond tmax, whatever the exact one; exact arithmetic has no hit.
    assert_eq!(up_to(before, near, miss), ["ours_wrong", "ours_wrong"]);
}

#[test]
fn as_many_random_rays_are_held_against_exact_arithmetic_as_one_says() {
    let (mesh, batch) = scene(&mut Rng::with_seed(9));
    let hits = nearest(&mesh, &batch, Form::Plain);
    let judge = Judge::new(&mesh);
    let of = Answers::Nearest(&hits);
    for (wanted, judged) in [(0, 0), (17, 17), (5000, 3000)] {
        let diff = Checker::new(&judge, &batch, of, of, wanted, 1).check(Precision::Fast, of, "");
        let exact = diff.exact.unwrap();
        assert_eq!((diff.judged_random, exact.rays), (judged, judged));
        assert_eq!(total(&exact.classes), judged);
    }
}

#[test]
fn rays_that_are_too_many_to_judge_count_as_wrong() {
    let (mesh, batch) = one_ray();
    let ray = Ray {
        direction: Vec3::X,
        ..batch.ray(0)
    };
    let n = MOST_JUDGED + 7;
    let batch: Batch = std::iter::repeat_n(ray, n).collect();
    // The reference sees what is not there, in all but one.
    let (ours, mut reference) = (vec![0; n], vec![1; n]);
    reference[3] = 0;
    let of = Answers::Any;
    let diff = diff(&mesh, &batch, of(&ours), of(&reference), of(&ours));
    assert_eq!(diff.differing as usize, MOST_JUDGED + 6);
    let judged = diff.embree_fast.reference_wrong.unwrap() as usize;
    // Some of the last ones may be among those drawn at random.
    assert!((MOST_JUDGED..=n).contains(&judged));
    let left = diff.not_judged.unwrap();
    assert_eq!(left as usize, n - 1 - judged);
    assert!(left > 0 && diff.wrong() == left && diff.offending.len() as u64 == left);
    assert_eq!(
        (diff.embree_robust.same as usize, diff.offending[0].verdicts),
        (n, None)
    );
}

/// What exact arithmetic has for all rays.
fn exact_hits(mesh: &Mesh, batch: &Batch) -> Hits {
    let all: Vec<u32> = (0..batch.len() as u32).collect();
    let mut hits = Hits::misses(batch.len());
    for (i, judgement) in Judge::new(mesh)
        .judge(batch, &all, &[])
        .into_iter()
        .enumerate()
    {
        if let Some(nearest) = judgement.nearest {
            (hits.t[i], hits.prim[i]) = (nearest.t.to_f32(), nearest.prim);
        }
    }
    hits
}

/// A tie excuses only the one who has the lowest triangle, and the last bit of t counts.
#[test]
fn nothing_is_excused_in_exact_but_the_exact_hit() {
    let (mesh, batch) = scene(&mut Rng::with_seed(2));
    let exact = exact_hits(&mesh, &batch);
    let mut last = exact.clone();
    let mut doubled = 0;
    for (prim, t) in last.prim.iter_mut().zip(&exact.t) {
        if *prim < 100 && t.is_finite() {
            *prim = 201 + 2 * *prim;
            doubled += 1;
        }
    }
    assert!(doubled > 100);
    let judge = Judge::new(&mesh);
    let of = Answers::Nearest;
    let diff = |ours: &Hits, reference: &Hits, random| {
        let [ours, reference] = [ours, reference].map(Answers::Nearest);
        Checker::new(&judge, &batch, reference, reference, random, 1).check(
            Precision::Exact,
            ours,
            "",
        )
    };
    let ours_right = diff(&exact, &last, 3000);
    let part = &ours_right.embree_fast;
    assert_eq!(
        (ours_right.wrong(), part.tie, part.differing),
        (0, doubled, 0)
    );
    assert_eq!(ours_right.exact.unwrap().classes.same, 3000);
    // No random ray is needed to find this.
    let ours_wrong = diff(&last, &exact, 0);
    let part = &ours_wrong.embree_robust;
    assert_eq!((part.ours_wrong, part.tie), (Some(doubled), 0));
    assert_eq!((ours_wrong.wrong(), total(part)), (doubled, 3000));
    // The other precisions are excused.
    let mut checker = Checker::new(&judge, &batch, of(&exact), of(&exact), 0, 1);
    for precision in [Precision::Fast, Precision::Watertight] {
        let diff = checker.check(precision, of(&last), "");
        assert_eq!(
            (diff.wrong(), diff.embree_fast.tie),
            (0, doubled),
            "{precision}"
        );
    }
    // One bit of t, where all agree: the rays that are drawn show it.
    let mut off = exact.clone();
    off.t.iter_mut().for_each(|t| *t = t.next_up());
    let hits = exact.hit_count() as u64;
    let of_bits = diff(&off, &off, 3000);
    assert_eq!(of_bits.embree_fast.same, 3000);
    assert_eq!(
        (of_bits.wrong(), of_bits.exact.unwrap().classes.t_drift),
        (hits, Some(hits))
    );
}

#[test]
fn errors_are_counted_for_ours_and_both_modes() {
    let (mesh, batch) = scene(&mut Rng::with_seed(10));
    let exact = exact_hits(&mesh, &batch);
    let (mut lossy, mut off) = (exact.clone(), exact.clone());
    let hit: Vec<usize> = (0..3000).filter(|&i| exact.prim[i] != MISS).collect();
    let missed: Vec<usize> = (0..3000).filter(|&i| exact.prim[i] == MISS).collect();
    for &i in &hit[..40] {
        (lossy.t[i], lossy.prim[i]) = (f32::INFINITY, MISS);
    }
    for &i in &missed[..3] {
        (lossy.t[i], lossy.prim[i]) = (1.0, 0);
    }
    for &i in &hit[40..47] {
        lossy.prim[i] = (lossy.prim[i] + 1) % 100;
    }
    for &i in &hit {
        off.t[i] = off.t[i].next_up().next_up();
    }
    let judge = Judge::new(&mesh);
    let of = Answers::Nearest;
    let mut checker = Checker::new(&judge, &batch, of(&lossy), of(&off), 3000, 1);
    let errors = checker
        .check(Precision::Fast, of(&exact), "")
        .errors
        .unwrap();
    assert_eq!(
        (errors.rays, errors.ours.all(), errors.ours.beyond_bounds),
        (3000, 0, 0)
    );
    // Rounded correctly: half a unit at most.
    let most = errors.ours.t.max_ulps.unwrap();
    assert!(most > 0.49 && most <= 0.500001, "{most}");
    let fast = &errors.embree_fast;
    assert_eq!((fast.wrong, fast.lost, fast.false_hits), (7, 40, 3));
    assert!(fast.beyond_bounds >= 48 && fast.within_bounds + fast.beyond_bounds == 50);
    let robust = &errors.embree_robust;
    assert_eq!(robust.all(), 0);
    let (p999, most) = (robust.t.p999_ulps.unwrap(), robust.t.max_ulps.unwrap());
    assert!(
        p999 > 2.4 && p999 <= most && most <= 2.500001,
        "{p999} {most}"
    );
    assert!(robust.t.p999_relative.unwrap() < 3.0 * f64::from(f32::EPSILON));
    // Of a part, only that part.
    let mut checker = Checker::new(&judge, &batch, of(&lossy), of(&off), 100, 1);
    let errors = checker
        .check(Precision::Fast, of(&exact), "")
        .errors
        .unwrap();
    assert!(errors.rays == 100 && errors.embree_fast.all() < 20);
}
