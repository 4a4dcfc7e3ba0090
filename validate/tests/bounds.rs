//! Float32 distances lie within their bounds, and the bounds are not much wider than that.

mod common;

use common::{FORMS, hit, point};
use dacrt::{Ray, Triangle};
use dacrt_validate::bounds::{Formula, Pair};
use fastrand::Rng;
use glam::{Vec3, Vec3Swizzles};

/// A ray and a triangle that it meets: well shaped or needles, near or far, steep or grazing, of
/// all sizes.
fn pair(random: &mut Rng) -> (Ray, Triangle) {
    let mut exponent = |from: i32, to: i32| 2.0_f32.powi(random.i32(from..=to));
    let (scale, width, distance, tilt, length) = (
        exponent(-20, 20),
        exponent(-12, 0),
        exponent(-10, 12),
        exponent(-14, 0),
        exponent(-10, 10),
    );
    let offset = point(random) * if random.bool() { 0.0 } else { distance };
    let a = point(random) + offset;
    let (long, short) = (point(random), point(random) * width);
    let (b, c) = (a + long, a + long * random.f32() + short);
    let target = a + (b - a) * random.f32() * 0.5 + (c - a) * random.f32() * 0.5;
    let in_plane = (b - a) * (random.f32() - 0.5) + (c - a) * (random.f32() - 0.5);
    let d = in_plane + point(random) * tilt;
    let eye = target - d * distance;
    let triangle = Triangle::new(a * scale, b * scale, c * scale);
    (Ray::new(eye * scale, d * scale * length), triangle)
}

/// t as Embree's robust mode computes it, with a true division.
fn robust_t(ray: &Ray, triangle: &Triangle) -> f32 {
    let [v0, v1, v2] = [triangle.a, triangle.b, triangle.c].map(|p| p - ray.origin);
    let (e0, e1, e2) = (v2 - v0, v0 - v1, v1 - v2);
    let (n1, n2) = (e0.cross(e1), e1.cross(e2));
    // Embree takes of each component the cross product with the smaller first term.
    let smaller = e0.abs().yzx().cmple(e2.abs().yzx());
    let n = Vec3::select(smaller, n1, n2);
    n.dot(v0) / n.dot(ray.direction)
}

#[test]
fn distances_lie_within_their_bounds() {
    let mut random = Rng::with_seed(1);
    let (mut worst, mut worst_robust, mut finite) = (0.0_f64, 0.0_f64, 0);
    for _ in 0..1_000_000 {
        let (ray, triangle) = pair(&mut random);
        let bounds = Pair::new(&ray, &triangle);
        for form in FORMS {
            if let Some(t) = hit(&ray, &triangle, form) {
                assert!(
                    bounds.possible && bounds.within_bounds(),
                    "{ray:?} {triangle:?}"
                );
                assert!(
                    bounds.accepts(Formula::Fast, t),
                    "{t} {bounds:?} {ray:?} {triangle:?}"
                );
                if bounds.t_bound.is_finite() {
                    finite += 1;
                    worst = worst.max((t as f64 - bounds.t).abs() / bounds.t_bound);
                }
            } else {
                assert!(!bounds.clear(), "{form:?} {bounds:?} {ray:?} {triangle:?}");
            }
        }
        let bound = bounds.t_bound_of(Formula::EmbreeRobust);
        let t = robust_t(&ray, &triangle) as f64;
        if bound.is_finite() {
            worst_robust = worst_robust.max((t - bounds.t).abs() / bound);
        }
    }
    assert!(finite > 500_000);
    assert!(
        worst <= 1.0 && worst_robust <= 1.0,
        "{worst} {worst_robust}"
    );
    // Bounds that are never nearly reached would excuse too much.
    assert!(worst > 0.3 && worst_robust > 0.2, "{worst} {worst_robust}");
}
