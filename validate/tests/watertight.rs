//! The bounds of the watertight kernel hold for it, and a judge finds what it must not lose.

mod common;

use common::point;
use dacrt::{Batch, Hits, MISS, Mesh, Ray, Triangle};
use dacrt_validate::bounds::Kernel;
use dacrt_validate::judge::{Answers, Judge, Verdict, Wrong};
use dacrt_validate::watertight::Sheared;
use fastrand::Rng;
use glam::{DVec3, Vec2, Vec3};

/// How an edge function a·b − c·d may be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Product {
    /// With the exact sign.
    Exact,
    /// `fma(a, b, −(c·d))`, which is not antisymmetric.
    Fused,
}

/// When the division by d_z is done.
#[derive(Clone, Copy, Debug)]
enum Division {
    First,
    Last,
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

/// The distance at which the kernel of Woop, Benthin and Wald hits, if it does.
fn hit(ray: &Ray, triangle: &Triangle, product: Product, division: Division) -> Option<f32> {
    let d = ray.direction;
    let z = d.abs().max_position();
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let slope = Vec2::new(d[x] / d[z], d[y] / d[z]);
    let per_z = 1.0 / d[z];
    let corners = [triangle.a, triangle.b, triangle.c].map(|v| {
        let w = v - ray.origin;
        (Vec2::new(w[x], w[y]) - slope * w[z], w[z])
    });
    let [(a, az), (b, bz), (c, cz)] = corners;
    let [u, v, w] = [(c, b), (a, c), (b, a)].map(|(p, q)| edge(p, q, product));
    let all = |says: &dyn Fn(f32) -> bool| [u, v, w].into_iter().all(says);
    let sum = u + v + w;
    if sum == 0.0 || !(all(&|x| x >= 0.0) || all(&|x| x <= 0.0)) {
        return None;
    }
    let t = match division {
        Division::First => (u * (az * per_z) + v * (bz * per_z) + w * (cz * per_z)) / sum,
        Division::Last => (u * az + v * bz + w * cz) * per_z / sum,
    };
    let (near, far) = slab(ray, triangle, 0.0);
    let (wide_near, wide_far) = slab(ray, triangle, 8.0 / (1 << 24) as f64);
    if wide_near > wide_far {
        return None;
    }
    // Where the box is too thin to be passed, the enlarged one holds the hit.
    let t = match near <= far {
        true => t.clamp(near, far),
        false => t.clamp(wide_near, wide_far),
    };
    (t > ray.tmin && t <= ray.tmax).then_some(t)
}

/// The padded slab interval of the triangle's box, enlarged by a share of its distance.
fn slab(ray: &Ray, triangle: &Triangle, share: f64) -> (f32, f32) {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let bounds = triangle.bounds();
    let (lo, hi) = (bounds.min.as_dvec3() - o, bounds.max.as_dvec3() - o);
    let shift = DVec3::splat(share * lo.abs().max(hi.abs()).max_element());
    let (lo, hi) = (lo - shift, hi + shift);
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for k in 0..3 {
        if d[k] != 0.0 {
            near = near.max(f64::min(lo[k] / d[k], hi[k] / d[k]));
            far = far.min(f64::max(lo[k] / d[k], hi[k] / d[k]));
        } else if lo[k] > 0.0 || hi[k] < 0.0 {
            far = f64::NEG_INFINITY;
        }
    }
    let padding = f64::from(dacrt::PADDING);
    (
        (near * (1.0 - padding)) as f32,
        (far * (1.0 + padding)) as f32,
    )
}

fn nearest(mesh: &Mesh, batch: &Batch, product: Product) -> Hits {
    let mut hits = Hits::misses(batch.len());
    for (i, ray) in batch.iter().enumerate() {
        for (prim, triangle) in mesh.triangles().iter().enumerate() {
            if let Some(t) = hit(&ray, triangle, product, Division::Last)
                && t < hits.t[i]
            {
                (hits.t[i], hits.prim[i]) = (t, prim as u32);
            }
        }
    }
    hits
}

fn judge(mesh: &Mesh, batch: &Batch, kernel: Kernel, answers: Answers) -> Vec<Verdict> {
    let all: Vec<u32> = (0..batch.len() as u32).collect();
    let judgements = Judge::new(mesh).judge(batch, &all, &[(kernel, answers)]);
    judgements.into_iter().map(|j| j.verdicts[0]).collect()
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

/// A ray and a triangle that it meets or passes closely, of all shapes and sizes.
fn pair(random: &mut Rng) -> (Ray, Triangle) {
    let mut exponent = |from: i32, to: i32| 2.0_f32.powi(random.i32(from..=to));
    let (scale, width, distance, tilt, length) = (
        exponent(-20, 20),
        exponent(-12, 0),
        exponent(-10, 12),
        exponent(-14, 0),
        exponent(-8, 10),
    );
    let offset = point(random) * if random.bool() { 0.0 } else { distance };
    let a = point(random) + offset;
    let (long, short) = (point(random), point(random) * width);
    let (b, c) = (a + long, a + long * random.f32() + short);
    let target = match random.u8(0..4) {
        0 => a,
        1 => a + (b - a) * random.f32(),
        _ => a + (b - a) * random.f32() * 0.5 + (c - a) * random.f32() * 0.5,
    };
    let in_plane = (b - a) * (random.f32() - 0.5) + (c - a) * (random.f32() - 0.5);
    let mut d = in_plane + point(random) * tilt;
    if random.u8(0..8) == 0 {
        // Two components equally large: either may be z.
        d[random.usize(0..3)] = d.abs().max_element();
    }
    let eye = target - d * distance;
    let triangle = Triangle::new(a * scale, b * scale, c * scale);
    (Ray::new(eye * scale, d * scale * length), triangle)
}

#[test]
fn answers_lie_within_their_bounds() {
    let mut random = Rng::with_seed(1);
    let (mut worst, mut finite) = (0.0_f64, 0);
    for _ in 0..500_000 {
        let (ray, triangle) = pair(&mut random);
        if !ray.is_valid() || (triangle.b - triangle.a).cross(triangle.c - triangle.a) == Vec3::ZERO
        {
            continue;
        }
        let bounds = Sheared::new(&ray, &triangle);
        for division in [Division::First, Division::Last] {
            match hit(&ray, &triangle, Product::Exact, division) {
                Some(t) => {
                    assert!(
                        bounds.possible && bounds.within_bounds() && bounds.accepts(t),
                        "{t} {bounds:?} {ray:?} {triangle:?}"
                    );
                    assert!(f64::from(t) <= bounds.latest(), "{t} {bounds:?}");
                    if bounds.t_bound.is_finite() {
                        finite += 1;
                        worst = worst.max((f64::from(t) - bounds.t).abs() / bounds.t_bound);
                    }
                }
                None => assert!(!bounds.clear(), "{bounds:?} {ray:?} {triangle:?}"),
            }
        }
    }
    assert!(finite > 300_000, "{finite}");
    // Bounds that are never nearly reached would excuse too much.
    assert!(worst > 0.2 && worst <= 1.0, "{worst}");
}

#[test]
fn the_watertight_kernel_loses_no_ray() {
    let mut random = Rng::with_seed(2);
    for at in [Vec3::ZERO, Vec3::new(148.376, 1.234, -223.423)] {
        let mesh = ball(&mut random, 6, at);
        let batch = at_edges(&mut random, &mesh, at, 6000);
        let hits = nearest(&mesh, &batch, Product::Exact);
        let verdicts = judge(&mesh, &batch, Kernel::Watertight, Answers::Nearest(&hits));
        for (i, verdict) in verdicts.iter().enumerate() {
            let ray = batch.ray(i);
            assert!(
                !verdict.is_wrong(),
                "{ray:?} {} {}: {verdict:?}",
                hits.t[i],
                hits.prim[i]
            );
        }
        let right = verdicts.iter().filter(|v| **v == Verdict::Right).count();
        assert!(right > 2000 && right < 6000, "{right}");
    }
}

/// The plainly fused edge function is not antisymmetric: rays pass between its triangles.
#[test]
fn a_fused_edge_function_loses_rays_and_is_found_out() {
    let mut random = Rng::with_seed(3);
    let mesh = ball(&mut random, 6, Vec3::ZERO);
    let batch = at_edges(&mut random, &mesh, Vec3::ZERO, 20_000);
    let hits = nearest(&mesh, &batch, Product::Fused);
    let verdicts = judge(&mesh, &batch, Kernel::Watertight, Answers::Nearest(&hits));
    let leaks = verdicts
        .iter()
        .filter(|v| matches!(v, Verdict::Wrong(Wrong::Leak { .. })));
    assert!(leaks.count() > 10);
}

/// What is lost within a surface is wrong at its edges and corners, too; in precision `fast` it is
/// not, and at an outline or a hole it is in neither.
#[test]
fn a_lost_ray_is_wrong_where_no_rounding_opens_the_surface() {
    let mut random = Rng::with_seed(4);
    let mesh = ball(&mut random, 6, Vec3::ZERO);
    // From within: every ray leaves through the surface.
    let batch: Batch = (0..3000)
        .map(|i| {
            let t = mesh.triangles()[random.usize(..mesh.len())];
            let target = if i % 2 == 0 {
                t.a
            } else {
                t.a + 0.5 * (t.b - t.a)
            };
            let eye = point(&mut random) * 0.3;
            Ray::new(eye, target - eye)
        })
        .collect();
    let lost = Hits::misses(batch.len());
    let wrong = |mesh: &Mesh, kernel, answers| {
        let verdicts = judge(mesh, &batch, kernel, answers);
        verdicts.iter().filter(|v| v.is_wrong()).count()
    };
    assert_eq!(
        wrong(&mesh, Kernel::Watertight, Answers::Nearest(&lost)),
        3000
    );
    assert_eq!(
        wrong(&mesh, Kernel::Watertight, Answers::Any(&[0; 3000])),
        3000
    );
    assert!(wrong(&mesh, Kernel::Fast, Answers::Nearest(&lost)) < 100);
    // The same triangles in other orders of corners and one with another, far away.
    let turned = mesh
        .triangles()
        .iter()
        .enumerate()
        .map(|(i, t)| match i % 3 {
            0 => Triangle::new(t.b, t.a, t.c),
            1 => Triangle::new(t.c, t.a, t.b),
            _ => *t,
        });
    let far = Triangle::new(
        Vec3::splat(1e3),
        Vec3::splat(1e3) + Vec3::X,
        Vec3::splat(1e3) + Vec3::Y,
    );
    let turned = Mesh::new(turned.chain([far]).collect());
    assert_eq!(
        wrong(&turned, Kernel::Watertight, Answers::Nearest(&lost)),
        3000
    );
    // Every second triangle is gone, so there is a hole at every edge.
    let open: Vec<Triangle> = mesh.triangles().iter().copied().step_by(2).collect();
    let found = wrong(
        &Mesh::new(open),
        Kernel::Watertight,
        Answers::Nearest(&lost),
    );
    assert!(found < 300, "{found}");
}

#[test]
fn a_ray_that_brushes_an_outline_may_miss() {
    // A roof: two triangles with a common ridge, seen from the side at ridge height.
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let (p, q) = (Vec3::new(0.1, -0.7, 0.3), Vec3::new(0.1, 0.9, 0.3));
    let roof = |left: Vec3, right: Vec3| {
        Mesh::new(vec![Triangle::new(p, q, left), Triangle::new(q, p, right)])
    };
    let target = p + 0.5 * (q - p);
    let batch: Batch = [Ray::new(target - 3.0 * x, x)].into_iter().collect();
    let verdict = |mesh: &Mesh| {
        let lost = Hits::misses(1);
        judge(mesh, &batch, Kernel::Watertight, Answers::Nearest(&lost))[0]
    };
    let brushed = roof(target - x - z, target + x - z);
    assert_eq!(verdict(&brushed), Verdict::WithinBounds);
    // The same ridge with one side up: a wall with a fold.
    let wall = roof(target - 0.1 * x + z, target + 0.1 * x - z);
    assert!(matches!(verdict(&wall), Verdict::Wrong(Wrong::Leak { .. })));
    // Three triangles at the edge: the third closes nothing.
    let mut three = wall.triangles().to_vec();
    three.push(Triangle::new(p, q, target + x + y));
    assert_eq!(verdict(&Mesh::new(three)), Verdict::WithinBounds);
}

#[test]
fn a_hit_behind_a_surface_is_a_leak() {
    let mut random = Rng::with_seed(5);
    let mesh = ball(&mut random, 5, Vec3::ZERO);
    let batch = at_edges(&mut random, &mesh, Vec3::ZERO, 3000);
    let mut hits = nearest(&mesh, &batch, Product::Exact);
    let mut changed = Vec::new();
    for i in 0..batch.len() {
        let ray = batch.ray(i);
        let beyond = Ray {
            tmin: hits.t[i] * 1.01,
            ..ray
        };
        let next = nearest(&mesh, &[beyond].into_iter().collect(), Product::Exact);
        if hits.prim[i] != MISS && next.prim[0] != MISS {
            (hits.t[i], hits.prim[i]) = (next.t[0], next.prim[0]);
            changed.push(i);
        }
    }
    let verdicts = judge(&mesh, &batch, Kernel::Watertight, Answers::Nearest(&hits));
    let wrong = changed.iter().filter(|&&i| verdicts[i].is_wrong()).count();
    assert!(
        changed.len() > 500 && wrong * 100 >= changed.len() * 95,
        "{wrong}"
    );
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
