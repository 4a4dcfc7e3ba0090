//! Judged by what each precision promises: our traces are right, and what is not allowed is found.

mod common;

use common::{Form, nearest, point};
use dacrt::{Batch, Hits, MISS, Mesh, Method, Precision, Ray, Tracer, Triangle};
use dacrt_validate::bounds::Kernel;
use dacrt_validate::judge::{Answers, Judge, Verdict, Wrong};
use fastrand::Rng;
use glam::Vec3;

fn judge(mesh: &Mesh, batch: &Batch, kernel: Kernel, answers: Answers) -> Vec<Verdict> {
    let all: Vec<u32> = (0..batch.len() as u32).collect();
    let judgements = Judge::new(mesh).judge(batch, &all, &[(kernel, answers)]);
    judgements.into_iter().map(|j| j.verdicts[0]).collect()
}

fn trace(mesh: &Mesh, batch: &Batch, precision: Precision) -> (Hits, Vec<u8>) {
    let tracer = Tracer::new(Method::Nabata2013.parameters()).with_precision(precision);
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let (mut hits, mut occluded) = (Hits::misses(batch.len()), vec![0; batch.len()]);
    tracer.nearest(mesh, batch, &mut workspace, &mut hits);
    tracer.any(mesh, batch, &mut workspace, &mut occluded);
    (hits, occluded)
}

/// A closed, bumpy ball of `4 n²` and some triangles, moved.
fn ball(random: &mut Rng, n: usize, at: Vec3) -> Mesh {
    let radii: Vec<f32> = (0..=n * 2 * n).map(|_| 1.0 + 0.2 * random.f32()).collect();
    let corner = |row: usize, column: usize| {
        let (row, column) = (row.min(n), column % (2 * n));
        let (sin, cos) = (std::f32::consts::PI * row as f32 / n as f32).sin_cos();
        let (y, x) = (std::f32::consts::PI * column as f32 / n as f32).sin_cos();
        // The poles are one corner each.
        let (radius, x, y) = match row {
            0 => (radii[0], 0.0, 0.0),
            _ if row == n => (radii[1], 0.0, 0.0),
            _ => (radii[row * 2 * n + column - n], x, y),
        };
        at + radius * Vec3::new(sin * x, sin * y, cos)
    };
    let mut triangles = Vec::new();
    for row in 0..n {
        for column in 0..2 * n {
            let [a, b] = [corner(row, column), corner(row, column + 1)];
            let [c, d] = [corner(row + 1, column), corner(row + 1, column + 1)];
            if row > 0 {
                triangles.push(Triangle::new(a, b, c));
            }
            if row + 1 < n {
                triangles.push(Triangle::new(b, d, c));
            }
        }
    }
    Mesh::new(triangles)
}

/// Rays at corners and at points of edges, from within and from outside.
fn at_edges(random: &mut Rng, mesh: &Mesh, from: Vec3, n: usize) -> Batch {
    (0..n)
        .map(|i| {
            let t = mesh.triangles()[random.usize(..mesh.len())];
            let target = t.a + (t.b - t.a) * (random.u8(0..=4) as f32 / 4.0);
            let reach = [0.3, 3.0, 100.0][i % 3];
            let eye = from + point(random) * reach;
            Ray::new(eye, (target - eye) * [1.0, 1e-3, 7.3][i % 3])
        })
        .collect()
}

#[test]
fn our_traces_are_what_their_precision_promises() {
    let mut random = Rng::with_seed(1);
    for at in [Vec3::ZERO, Vec3::new(148.376, 1.234, -223.423)] {
        let mesh = ball(&mut random, 8, at);
        let batch = at_edges(&mut random, &mesh, at, 20_000);
        for precision in Precision::ALL {
            let (hits, occluded) = trace(&mesh, &batch, precision);
            for answers in [Answers::Nearest(&hits), Answers::Any(&occluded)] {
                let verdicts = judge(&mesh, &batch, Kernel::of(precision), answers);
                for (i, verdict) in verdicts.iter().enumerate() {
                    let ray = batch.ray(i);
                    assert!(!verdict.is_wrong(), "{precision} {ray:?}: {verdict:?}");
                    let certain = precision == Precision::Exact || !answers.is_nearest();
                    if precision != Precision::Fast && certain {
                        assert_eq!(*verdict, Verdict::Right, "{precision} {ray:?}");
                    }
                }
            }
        }
    }
}

/// At an edge float32 may lose a ray or hit beside the triangle: in `fast` that is excused, in
/// `watertight` it is not.
#[test]
fn rounding_at_edges_excuses_fast_alone() {
    let mut random = Rng::with_seed(2);
    let mesh = ball(&mut random, 6, Vec3::ZERO);
    let batch = at_edges(&mut random, &mesh, Vec3::ZERO, 20_000);
    let hits = nearest(&mesh, &batch, Form::Plain);
    let wrong = |kernel| {
        let verdicts = judge(&mesh, &batch, kernel, Answers::Nearest(&hits));
        let lost = |v: &&Verdict| matches!(v, Verdict::Wrong(Wrong::Nearer { .. }));
        let beside = |v: &&Verdict| matches!(v, Verdict::Wrong(Wrong::NotHit));
        [
            verdicts.iter().filter(lost).count(),
            verdicts.iter().filter(beside).count(),
        ]
    };
    assert_eq!(wrong(Kernel::Fast), [0, 0]);
    let [lost, beside] = wrong(Kernel::Watertight);
    assert!(lost > 10 && beside > 10, "{lost} {beside}");
}

/// What `watertight` may round is t, and with it the order of hits that are as near as that.
#[test]
fn watertight_may_round_t() {
    let mut random = Rng::with_seed(3);
    let (x, y) = (Vec3::X, Vec3::Y);
    let wall = |z: f32| Triangle::new(Vec3::new(0.0, 0.0, z), x + z * Vec3::Z, y + z * Vec3::Z);
    let z = 0.7_f32;
    let mesh = Mesh::new(vec![wall(z.next_up()), wall(z), wall(0.69)]);
    let eye = Vec3::new(0.3, 0.2, 0.1) + point(&mut random) * 0.05 + Vec3::Z;
    let batch: Batch = [Ray::new(eye, 0.37 * (Vec3::new(0.31, 0.22, 0.0) - eye))]
        .into_iter()
        .collect();
    let all = Judge::new(&mesh).judge(&batch, &[0], &[]);
    let exact = all[0].nearest.clone().unwrap();
    assert_eq!(exact.prim, 0);
    let t = exact.t.to_f32();
    let verdict = |kernel, t: f32, prim| {
        let hits = Hits {
            t: vec![t],
            prim: vec![prim],
        };
        judge(&mesh, &batch, kernel, Answers::Nearest(&hits))[0]
    };
    let watertight = |t, prim| verdict(Kernel::Watertight, t, prim);
    assert_eq!(watertight(t.next_up(), 0), Verdict::Right);
    assert!(matches!(
        watertight(t * 1.0001, 0),
        Verdict::Wrong(Wrong::Distance { .. })
    ));
    // The wall right behind it is as near as rounding can tell, the third is not.
    assert_eq!(watertight(t, 1), Verdict::WithinBounds);
    let third = (f64::from(t) * (f64::from(eye.z) - 0.69) / (f64::from(eye.z) - 0.7)) as f32;
    assert!(matches!(
        watertight(third, 2),
        Verdict::Wrong(Wrong::Nearer { .. })
    ));
    assert!(matches!(
        watertight(f32::INFINITY, MISS),
        Verdict::Wrong(Wrong::Nearer { prim: 0, .. })
    ));
    assert!(verdict(Kernel::Exact, t.next_up(), 0).is_wrong());
    assert_eq!(verdict(Kernel::Exact, t, 0), Verdict::Right);
}

#[test]
fn exact_is_the_bits_of_exact_arithmetic_and_nothing_else() {
    let mut random = Rng::with_seed(6);
    let mut triangles = ball(&mut random, 5, Vec3::ZERO).triangles().to_vec();
    triangles.extend_from_within(..);
    let half = triangles.len() as u32 / 2;
    let mesh = Mesh::new(triangles);
    let batch = at_edges(&mut random, &mesh, Vec3::ZERO, 2000);
    let judge_of = Judge::new(&mesh);
    let all: Vec<u32> = (0..batch.len() as u32).collect();
    let mut exact = Hits::misses(batch.len());
    for (i, judgement) in judge_of.judge(&batch, &all, &[]).into_iter().enumerate() {
        if let Some(nearest) = judgement.nearest {
            (exact.t[i], exact.prim[i]) = (nearest.t.to_f32(), nearest.prim);
        }
    }
    let verdicts = |hits: &Hits| judge(&mesh, &batch, Kernel::Exact, Answers::Nearest(hits));
    assert!(verdicts(&exact).iter().all(|v| *v == Verdict::Right));
    // One bit of t, the copy of the triangle, or nothing: each is wrong.
    let hit: Vec<usize> = (0..batch.len())
        .filter(|&i| exact.prim[i] != MISS)
        .collect();
    assert!(hit.len() > 1000);
    let mut changed = exact.clone();
    for (k, &i) in hit.iter().enumerate() {
        match k % 4 {
            0 => changed.t[i] = changed.t[i].next_up(),
            1 => changed.t[i] = changed.t[i].next_down(),
            2 => changed.prim[i] += half,
            _ => (changed.t[i], changed.prim[i]) = (f32::INFINITY, MISS),
        }
    }
    let found = verdicts(&changed);
    for (k, &i) in hit.iter().enumerate() {
        let expected = match (k % 4, found[i]) {
            (0 | 1, Verdict::Wrong(Wrong::Distance { bound, .. })) => bound == Some(0.0),
            (2 | 3, Verdict::Wrong(Wrong::Nearer { prim, .. })) => prim == exact.prim[i],
            _ => false,
        };
        assert!(expected, "{}: {:?}", k % 4, found[i]);
    }
}
