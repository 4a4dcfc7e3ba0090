//! Whether and where a ray hits a triangle.

use super::distance::Distance;
use super::dyadic::Vector;
use crate::bounds::abs_cross;
use dacrt::{Ray, Triangle};
use dashu_int::IBig;
use std::cmp::Ordering;

/// Where the ray hits the triangle; about 5 µs.
///
/// Edges and corners belong to the triangle. Nothing is hit by an invalid ray or one within the
/// triangle's plane, by no ray a triangle that is invalid or has no area. A hit has tmin < t <=
/// tmax and a t that rounds to a finite float32.
pub fn meet(ray: &Ray, triangle: &Triangle) -> Option<Distance> {
    if !ray.is_valid() || !triangle.is_valid() {
        return None;
    }
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(Vector::new);
    let (o, d) = (Vector::new(ray.origin), Vector::new(ray.direction));
    let (ab, ac, corner) = (b.minus(&a), c.minus(&a), a.minus(&o));
    let normal = ab.cross(&ac);
    // Zero as well if the normal is zero.
    let determinant = normal.dot(&d);
    if determinant.is_zero() {
        return None;
    }
    // The hit point is a + (u ab + v ac) / determinant.
    let moment = corner.cross(&d);
    let (u, v) = (moment.dot(&ac), -moment.dot(&ab));
    let rest = &determinant - &u - &v;
    let outside = |x: &IBig| !x.is_zero() && x.sign() != determinant.sign();
    if [u, v, rest].iter().any(outside) {
        return None;
    }
    let t = Distance::ratio(normal.dot(&corner), determinant);
    let after_start = t.cmp_f32(ray.tmin) == Ordering::Greater;
    let before_end = t.cmp_f32(ray.tmax) != Ordering::Greater;
    (after_start && before_end && t.to_f32().is_finite()).then_some(t)
}

/// Whether the triangle has an area: its corners are not in one line.
///
/// # Panics
/// If a corner is not finite.
pub fn has_area(triangle: &Triangle) -> bool {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c];
    let (ab, ac) = (b.as_dvec3() - a.as_dvec3(), c.as_dvec3() - a.as_dvec3());
    // Two roundings of the differences, one of the products, one of their difference.
    let bound = abs_cross(ab, ac) * (8.0 * f64::EPSILON);
    if ab.cross(ac).abs().cmpgt(bound).any() {
        return true;
    }
    let [a, b, c] = [a, b, c].map(Vector::new);
    !b.minus(&a).cross(&c.minus(&a)).is_zero()
}
