//! Every ray is counted once, differences that float32 explains are no findings, others are.

mod common;

use common::{Form, any, nearest, rays, soup};
use dacrt::MISS;
use dacrt::{Batch, Hits, Mesh, Ray, Triangle};
use dacrt_validate::diff::{Checker, Diff, ReferenceDiff};
use dacrt_validate::hash::hit_hash;
use dacrt_validate::judge::{Answer, Answers, Judge, Verdict};
use fastrand::Rng;
use glam::Vec3;

/// Ours against two references.
fn diff(mesh: &Mesh, batch: &Batch, ours: Answers, fast: Answers, robust: Answers) -> Diff {
    let judge = Judge::new(mesh);
    Checker::new(&judge, batch, fast, robust, 1).check(ours, &hit_hash(&ours))
}

fn total(diff: &ReferenceDiff) -> u64 {
    diff.same + diff.tie + diff.differing
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
        assert_eq!(part.unexplained, 0);
        let (max, p999) = (part.max_relative_t_error, part.p999_relative_t_error);
        assert!(
            p999 <= max && max < Some(1e-2) && p999 < Some(1e-3),
            "{max:?} {p999:?}"
        );
        // What needs exact arithmetic is not there yet.
        assert_eq!(
            (part.edge, part.ours_wrong, part.t_drift),
            (None, None, None)
        );
    }
    assert_eq!((diff.unexplained, diff.judged_random), (0, 1000));
    assert!(diff.judged >= 1000 && diff.offending.is_empty());
    assert!(!diff.is_finding(&mesh));
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
            diff.embree_fast.unexplained,
            diff.unexplained
        ),
        (0, 1, 1)
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
    assert!(diff.unexplained >= 298 && diff.embree_robust.unexplained >= 298);
    assert!(diff.is_finding(&mesh));
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
        (diff.differing, diff.judged, diff.embree_fast.unexplained),
        (0, 1000, 0)
    );
    assert!(diff.unexplained > 300 && diff.is_finding(&mesh));
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
    assert_eq!((diff.embree_fast.unexplained, diff.unexplained), (2, 2));
    assert_eq!(diff.embree_fast.max_relative_t_error, None);
}

#[test]
fn equal_hits_are_judged_once() {
    let (mesh, batch) = scene(&mut Rng::with_seed(6));
    let hits = nearest(&mesh, &batch, Form::Plain);
    let misses = Hits::misses(batch.len());
    let judge = Judge::new(&mesh);
    let of = Answers::Nearest;
    let mut checker = Checker::new(&judge, &batch, of(&hits), of(&hits), 1);
    let diff = checker.check(of(&hits), "a");
    // Known by its hash, so what is given with it is not looked at.
    assert_eq!(checker.check(of(&misses), "a"), diff);
    assert_ne!(checker.check(of(&misses), "b"), diff);
}

#[test]
fn an_empty_batch_is_fine() {
    let mesh = Mesh::new(vec![]);
    let (batch, hits) = (Batch::default(), Hits::default());
    let of = Answers::Nearest;
    let diff = diff(&mesh, &batch, of(&hits), of(&hits), of(&hits));
    assert_eq!((diff.judged, diff.unexplained), (0, 0));
    assert_eq!(diff.embree_fast.p999_relative_t_error, None);
}
