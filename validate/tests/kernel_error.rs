//! A million random and degenerate pairs of a ray and a triangle, through the engine itself, on every
//! instruction set: t lies within the bound that [`dacrt_validate::bounds`] states, by exact arithmetic,
//! and no hit is found or missed that the bounds on the edges do not leave open.

use dacrt::*;
use dacrt_validate::bounds::Pair;
use dacrt_validate::exact::meet;
use fastrand::Rng;
use glam::Vec3;

/// Rays of a batch, all for one triangle.
const RAYS: usize = 64;
/// Pairs with origins of their own, and as many with shared ones.
const PAIRS: usize = 1_000_000;

fn point(random: &mut Rng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| random.f32() * 2.0 - 1.0))
}

/// A power of two.
fn power(random: &mut Rng, from: i32, to: i32) -> f32 {
    2f32.powi(random.i32(from..=to))
}

/// A triangle of one of the families, and its size.
fn triangle(random: &mut Rng, family: usize) -> Triangle {
    let a = point(random);
    let (long, short) = (point(random), point(random));
    let thin = power(random, -22, -6);
    let [a, b, c] = match family {
        // Any shape.
        0 => [a, a + long, a + short],
        // A needle: one short edge.
        1 => [a, a + long, a + long + thin * short],
        // A sliver: a corner near the middle of the edge across.
        2 => [a, a + long, a + random.f32() * long + thin * short],
        // As near to no area as rounding leaves it.
        3 => [a, a + long, a + random.f32() * long],
        // In a plane across an axis, edges along the others.
        4 => [a, a.with_x(a.x + long.x), a.with_y(a.y + short.y)],
        // Small and far away.
        5 => {
            let a = a + Vec3::new(148376.0, 1234.0, -223423.0);
            let size = power(random, -4, 8);
            [a, a + size * long, a + size * short]
        }
        // Edges and places of different sizes.
        _ => {
            let a = a * power(random, -20, 20);
            [
                a,
                a + long * power(random, -20, 20),
                a + short * power(random, -20, 20),
            ]
        }
    };
    Triangle::new(a, b, c)
}

/// A ray at a point of the triangle, an edge or a corner of it, or near it; steep or grazing.
fn ray(random: &mut Rng, t: &Triangle, origin: Option<Vec3>) -> Ray {
    let (ab, ac) = (t.b - t.a, t.c - t.a);
    let (mut u, mut v) = (random.f32(), random.f32());
    match random.u32(..8) {
        0 => u = 0.0,
        1 => v = 1.0 - u,
        2 => (u, v) = (0.0, 0.0),
        3 => u *= 1.5,
        _ if u + v > 1.0 => (u, v) = (1.0 - u, 1.0 - v),
        _ => {}
    }
    let target = t.a + u * ab + v * ac;
    let origin = origin.unwrap_or_else(|| {
        let tilt = power(random, -16, 2);
        let along = (random.f32() - 0.5) * ab + (random.f32() - 0.5) * ac;
        let size = ab.length() + ac.length();
        target + power(random, -6, 12) * (along + tilt * size * point(random))
    });
    let mut ray = Ray::new(origin, (target - origin) * power(random, -10, 10));
    match random.u32(..16) {
        0 => ray.direction[random.usize(..3)] = 0.0,
        1 => ray.tmin = random.f32(),
        2 => ray.tmax = random.f32(),
        _ => {}
    }
    ray
}

/// Whether precision `fast` promises something: coordinates, edges and the largest component of the
/// direction are 0 or between 1e-9 and 1e9, in size.
fn is_promised(ray: &Ray, t: &Triangle) -> bool {
    let good = |x: f32| x == 0.0 || (1e-9..=1e9).contains(&x.abs());
    let points = [ray.origin, t.a, t.b, t.c];
    let edges = [t.b - t.a, t.c - t.b, t.a - t.c];
    points.iter().flat_map(|p| p.to_array()).all(good)
        && edges.iter().all(|e| good(e.length()))
        && good(ray.direction.abs().max_element())
}

/// The hits of a batch, which are the same on all instruction sets.
fn hits(
    mesh: &Mesh,
    batch: &Batch,
    precision: Precision,
    own_origins: bool,
    workspace: &mut Workspace,
) -> Hits {
    let mut first: Option<Hits> = None;
    for isa in Isa::available() {
        let tracer = Tracer::new(Method::Afra2012.parameters())
            .with_isa(isa)
            .with_precision(precision)
            .with_own_origins(own_origins);
        let mut hits = Hits::misses(batch.len());
        let trace = tracer.nearest(mesh, batch, workspace, &mut hits);
        let none = trace.invalid_rays == RAYS as u64;
        assert!(none || trace.shared_origin != own_origins);
        assert_eq!(*first.get_or_insert_with(|| hits.clone()), hits, "{isa}");
    }
    first.unwrap()
}

/// Batches of rays at one triangle each, of all families in turn.
fn for_all_pairs(
    precision: Precision,
    own_origins: bool,
    mut judge: impl FnMut(usize, &Ray, &Triangle, Option<f32>),
) {
    let mut random = Rng::with_seed(own_origins as u64);
    let mut workspace = Workspace::new(&Method::Afra2012.parameters(), RAYS, 1);
    for i in 0..PAIRS / RAYS {
        let family = i % 7;
        let triangle = triangle(&mut random, family);
        let origin = (!own_origins).then(|| ray(&mut random, &triangle, None).origin);
        let batch: Batch = (0..RAYS)
            .map(|_| ray(&mut random, &triangle, origin))
            .collect();
        let mesh = Mesh::new(vec![triangle]);
        let hits = hits(&mesh, &batch, precision, own_origins, &mut workspace);
        for (i, ray) in batch.iter().enumerate() {
            let t = (hits.prim[i] != MISS).then_some(hits.t[i]);
            judge(family, &ray, &triangle, t);
        }
    }
}

#[test]
fn fast_keeps_its_bounds() {
    for own_origins in [true, false] {
        let (mut worst, mut bounded, mut hits) = (0f64, 0, [0; 7]);
        for_all_pairs(Precision::Fast, own_origins, |family, ray, triangle, t| {
            if !ray.is_valid() || !is_promised(ray, triangle) {
                return;
            }
            let pair = Pair::new(ray, triangle);
            let context = || format!("{t:?} {pair:?} {ray:?} {triangle:?}");
            let Some(t) = t else {
                return assert!(!pair.clear(), "{}", context());
            };
            hits[family] += 1;
            assert!(pair.within_bounds(), "{}", context());
            if pair.t_bound.is_finite() {
                let exact = meet(ray, triangle).map_or(pair.t, |t| t.to_f64());
                let error = (t as f64 - exact).abs();
                assert!(error <= pair.t_bound, "{error:e} {}", context());
                worst = worst.max(error / pair.t_bound);
                bounded += 1;
            }
        });
        println!("own origins {own_origins}: {worst:.3} of the bound, {hits:?}, {bounded} bounded");
        assert!(bounded > PAIRS / 4, "{bounded}");
        assert!(hits.iter().all(|&n| n > PAIRS / 1000), "{hits:?}");
        // Bounds that are never nearly reached would excuse too much.
        assert!(worst > 0.3, "{worst}");
    }
}

/// What the watertight kernel states: relative to the exact t.
const WATERTIGHT: f64 = 1.0625 / 4096.0;

#[test]
fn watertight_hits_as_in_exact_arithmetic_with_t_within_its_bound() {
    for own_origins in [true, false] {
        let mut worst = 0f64;
        for_all_pairs(Precision::Watertight, own_origins, |_, ray, triangle, t| {
            let exact = meet(ray, triangle).map(|t| t.to_f64());
            let context = || format!("{t:?} {exact:?} {ray:?} {triangle:?}");
            assert_eq!(t.is_some(), exact.is_some(), "{}", context());
            let (Some(t), Some(exact)) = (t, exact) else {
                return;
            };
            // Half of the least float32 is lost to rounding in any case.
            let error = (t as f64 - exact).abs() - 1e-45;
            assert!(error <= WATERTIGHT * exact, "{error:e} {}", context());
            worst = worst.max(error / exact);
        });
        println!("own origins {own_origins}: {worst:e}");
    }
}

#[test]
fn exact_is_exact_arithmetic_rounded_once() {
    for own_origins in [true, false] {
        for_all_pairs(Precision::Exact, own_origins, |_, ray, triangle, t| {
            let exact = meet(ray, triangle).map(|t| t.to_f32());
            assert_eq!(t, exact, "{ray:?} {triangle:?}");
        });
    }
}
