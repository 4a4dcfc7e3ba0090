//! What watertight answers may and may not be, and that an edge function which does not have the
//! exact sign loses rays.

mod common;

use common::point;
use dacrt::{Batch, Hits, MISS, Mesh, Method, Precision, Ray, Tracer, Triangle};
use dacrt_validate::bounds::Kernel;
use dacrt_validate::exact::Arbiter;
use dacrt_validate::judge::{Answers, Judge, Verdict, Wrong};
use fastrand::Rng;
use glam::{Vec2, Vec3};

/// How an edge function a·b − c·d may be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Product {
    /// With the exact sign.
    Exact,
    /// `fma(a, b, −(c·d))`, which is not antisymmetric.
    Fused,
}

fn edge(p: Vec2, q: Vec2, product: Product) -> f32 {
    match product {
        // Products of float32 are exact in float64.
        Product::Exact => {
            (f64::from(p.x) * f64::from(q.y) - f64::from(p.y) * f64::from(q.x)) as f32
        }
        Product::Fused => p.x.mul_add(q.y, -(p.y * q.x)),
    }
}

/// Whether the line of a ray meets a triangle, by the edge functions of Woop, Benthin and Wald 2013.
fn sheared(ray: &Ray, triangle: &Triangle, product: Product) -> bool {
    let d = ray.direction;
    let z = d.abs().max_position();
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let slope = Vec2::new(d[x] / d[z], d[y] / d[z]);
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|v| {
        let w = v - ray.origin;
        Vec2::new(w[x], w[y]) - slope * w[z]
    });
    let [u, v, w] = [(c, b), (a, c), (b, a)].map(|(p, q)| edge(p, q, product));
    let all = |says: &dyn Fn(f32) -> bool| [u, v, w].into_iter().all(says);
    u + v + w != 0.0 && (all(&|x| x >= 0.0) || all(&|x| x <= 0.0))
}

fn lost(mesh: &Mesh, batch: &Batch, product: Product) -> usize {
    let meets = |ray: &Ray| mesh.triangles().iter().any(|t| sheared(ray, t, product));
    batch.iter().filter(|ray| !meets(ray)).count()
}

/// A closed, bumpy ball of `4 n²` and some triangles, of a size and moved.
fn ball(random: &mut Rng, n: usize, size: f32, at: Vec3) -> Mesh {
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
        at + size * radius * Vec3::new(sin * x, sin * y, cos)
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

/// Rays from within a ball at its corners and at points of its edges.
fn from_within(random: &mut Rng, mesh: &Mesh, size: f32, at: Vec3, n: usize) -> Batch {
    (0..n)
        .map(|i| {
            let t = mesh.triangles()[random.usize(..mesh.len())];
            let target = t.a + (t.b - t.a) * (random.u8(0..=4) as f32 / 4.0);
            let eye = at + point(random) * 0.3 * size;
            Ray::new(eye, (target - eye) * [1.0, 1e-3, 7.3][i % 3])
        })
        .collect()
}

fn trace(mesh: &Mesh, batch: &Batch, precision: Precision) -> Hits {
    let tracer = Tracer::new(Method::Nabata2013.parameters()).with_precision(precision);
    let mut hits = Hits::misses(batch.len());
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    tracer.nearest(mesh, batch, &mut workspace, &mut hits);
    hits
}

#[test]
fn a_plainly_fused_edge_function_loses_rays_and_an_exact_sign_none() {
    let mut random = Rng::with_seed(3);
    let mesh = ball(&mut random, 6, 1.0, Vec3::ZERO);
    let batch = from_within(&mut random, &mesh, 1.0, Vec3::ZERO, 100_000);
    let found = lost(&mesh, &batch, Product::Fused);
    assert!(found > 10, "{found}");
    assert_eq!(lost(&mesh, &batch, Product::Exact), 0);
    for precision in [Precision::Watertight, Precision::Exact] {
        let hits = trace(&mesh, &batch, precision);
        assert_eq!(hits.hit_count(), batch.len(), "{precision}");
    }
}

/// From afar, corners that are rounded relative to the origin of the ray make another mesh.
#[test]
fn exact_signs_on_rounded_corners_lose_rays_from_afar() {
    let mut random = Rng::with_seed(4);
    let mesh = ball(&mut random, 6, 1.0, Vec3::ZERO);
    let arbiter = Arbiter::new(&mesh);
    let batch: Batch = (0..20_000)
        .map(|_| {
            let eye = 1e7 * point(&mut random);
            Ray::new(eye, 0.5 * point(&mut random) - eye)
        })
        .filter(|ray| arbiter.nearest(ray).is_some())
        .collect();
    assert!(batch.len() > 1000, "{}", batch.len());
    let found = lost(&mesh, &batch, Product::Exact);
    assert!(found > batch.len() / 100, "{found} of {}", batch.len());
    let hits = trace(&mesh, &batch, Precision::Watertight);
    assert_eq!(hits.hit_count(), batch.len());
}

fn judge(mesh: &Mesh, batch: &Batch, kernel: Kernel, answers: Answers) -> Vec<Verdict> {
    let all: Vec<u32> = (0..batch.len() as u32).collect();
    let judgements = Judge::new(mesh).judge(batch, &all, &[(kernel, answers)]);
    judgements.into_iter().map(|j| j.verdicts[0]).collect()
}

#[test]
fn nothing_excuses_a_watertight_answer_that_is_lost() {
    let mut random = Rng::with_seed(5);
    let mesh = ball(&mut random, 6, 1.0, Vec3::ZERO);
    let batch = from_within(&mut random, &mesh, 1.0, Vec3::ZERO, 3000);
    let misses = Hits::misses(batch.len());
    let wrong = |kernel, answers| {
        let verdicts = judge(&mesh, &batch, kernel, answers);
        verdicts.iter().filter(|v| v.is_wrong()).count()
    };
    assert_eq!(wrong(Kernel::Watertight, Answers::Nearest(&misses)), 3000);
    assert_eq!(wrong(Kernel::Watertight, Answers::Any(&[0; 3000])), 3000);
    assert!(wrong(Kernel::Fast, Answers::Nearest(&misses)) < 2000);
    let hits = trace(&mesh, &batch, Precision::Watertight);
    assert_eq!(wrong(Kernel::Watertight, Answers::Nearest(&hits)), 0);
    assert_eq!(wrong(Kernel::Watertight, Answers::Any(&[1; 3000])), 0);
    // The triangle on the other side, t too great by more than the bound.
    let mut far = hits.clone();
    far.t.iter_mut().for_each(|t| *t *= 1.001);
    assert_eq!(wrong(Kernel::Watertight, Answers::Nearest(&far)), 3000);
    let mut other = hits.clone();
    other.prim.iter_mut().for_each(|p| *p = (*p + 70) % 132);
    let found = wrong(Kernel::Watertight, Answers::Nearest(&other));
    assert!(found > 2900, "{found}");
}

#[test]
fn exact_is_the_bits_of_exact_arithmetic_and_nothing_else() {
    let mut random = Rng::with_seed(6);
    let mut triangles = ball(&mut random, 5, 1.0, Vec3::ZERO).triangles().to_vec();
    triangles.extend_from_within(..);
    let half = triangles.len() as u32 / 2;
    let mesh = Mesh::new(triangles);
    let batch = from_within(&mut random, &mesh, 1.0, Vec3::ZERO, 2000);
    let exact = trace(&mesh, &batch, Precision::Exact);
    let verdicts = |hits: &Hits| judge(&mesh, &batch, Kernel::Exact, Answers::Nearest(hits));
    assert!(verdicts(&exact).iter().all(|v| *v == Verdict::Right));
    // One bit of t, the copy of the triangle, or nothing: each is wrong.
    let mut changed = exact.clone();
    for i in 0..batch.len() {
        match i % 4 {
            0 => changed.t[i] = changed.t[i].next_up(),
            1 => changed.t[i] = changed.t[i].next_down(),
            2 => changed.prim[i] += half,
            _ => (changed.t[i], changed.prim[i]) = (f32::INFINITY, MISS),
        }
    }
    for (i, verdict) in verdicts(&changed).into_iter().enumerate() {
        let expected = match (i % 4, verdict) {
            (0 | 1, Verdict::Wrong(Wrong::Distance { bound, .. })) => bound == Some(0.0),
            (2 | 3, Verdict::Wrong(Wrong::Nearer { prim, .. })) => prim == exact.prim[i],
            _ => false,
        };
        assert!(expected, "{i}: {verdict:?}");
    }
}
