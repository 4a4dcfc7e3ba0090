//! Whether a triangle has an area, exactly.

use super::estimate::{BOUND, cross_sizes};
use super::whole;
use crate::Triangle;
use glam::{DVec3, Vec3};

/// Whether the corners of a triangle of finite coordinates are not in one line; about 5 ns.
///
/// Float64 tells for all triangles of the Conference scene, a sixth of which have no area.
#[inline]
pub(crate) fn has_area(triangle: &Triangle) -> bool {
    match decide(triangle) {
        Some(has_area) => has_area,
        None => whole::has_area(triangle),
    }
}

/// Whether it has an area, if float64 tells.
#[inline]
pub(super) fn decide(triangle: &Triangle) -> Option<bool> {
    let &Triangle { a, b, c } = triangle;
    let (ab, ac) = (b.as_dvec3() - a.as_dvec3(), c.as_dvec3() - a.as_dvec3());
    // Four roundings: of both edges, the products and their difference.
    let (normal, sizes) = (ab.cross(ac), cross_sizes(ab, ac));
    if normal.abs().cmpgt(BOUND * sizes).any() {
        return Some(true);
    }
    let none = sizes == DVec3::ZERO
        || b == c
        || (normal == DVec3::ZERO && is_exact(b, a, ab) && is_exact(c, a, ac));
    none.then_some(false)
}

/// Whether `difference` is exactly `x − y` and has at most 26 significant bits, so that products of
/// two such numbers are exact in float64.
fn is_exact(x: Vec3, y: Vec3, difference: DVec3) -> bool {
    let (x, y) = (x.as_dvec3(), y.as_dvec3());
    // One of the two is exact itself: that with the larger one of x and y (Dekker).
    let exact = x - difference == y && y + difference == x;
    let short = |v: f64| v.to_bits().trailing_zeros() >= 27;
    exact && short(difference.x) && short(difference.y) && short(difference.z)
}
