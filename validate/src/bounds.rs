//! One ray against one triangle in float64, with bounds on what float32 may make of the pair.
//!
//! The kernel of record (precision `fast`) computes in float32, with unit roundoff u = 2⁻²⁴,
//!
//! ```text
//! e1 = a − b,  e2 = c − a,  N = e2 × e1,  C = a − o,  den = N·d,  T = N·C,  t = T / den
//! U = (C × d)·e2,  V = (C × d)·e1                 (origins of their own)
//! U = d·(e2 × C),  V = d·(e1 × C)                 (shared origin: the same in real numbers)
//! hit:  den ≠ 0,  sU ≥ 0,  sV ≥ 0,  sU + sV ≤ |den|  with s = sign(den),  tmin < t ≤ tmax,
//!       and t within the padded slab interval of the triangle's own box
//! ```
//!
//! The bounds below follow from (x ∘ y)(1 + δ), |δ| ≤ u, for each operation; |v| is taken per
//! component, R = C × d, S = e × C, and `abs(x, y)` is the cross product with both terms of each
//! component taken as positive, for example |x_y||y_z| + |x_z||y_y|.
//!
//! * `e1`, `e2` and `C` are differences of exact numbers: relative error u, whatever the
//!   distance from the origin.
//! * `U`: rounding `C` costs u |C|·|d × e|, rounding `e` costs u |e|·|R|, rounding the products
//!   in the first cross product costs u |C|·abs(d, e) (the same six products in both forms), the
//!   subtraction in it u and the dot product 3u of |R|·|e| or of |S|·|d|. Together
//!   u (|C|·abs(d, e) + |C|·|d × e| + |e|·|R| + 4 max(|R|·|e|, |S|·|d|)). It is never more than 7u
//!   times the sum of the absolute products, and mostly much less.
//! * `N`: δN = u (3 abs(e2, e1) + |N|), two differences, the products, the subtraction.
//! * `den`: δN·|d| + 3u N̂·|d| with N̂ = |N| + δN.
//! * `sU + sV ≤ |den|`: the three errors above and one more rounding of the sum.
//! * `t`: `T` and `den` contain the same rounded normal N + δ, |δ| ≤ δN. In
//!   T̂ − t·dên = (N + δ)·(C − t d) + roundings, N·(C − t d) is zero by definition of t, so the
//!   normal's error is multiplied by q = C − t d, the way from the hit point to the corner `a`,
//!   which is as short as the triangle, not as long as the ray. What remains is the rounding of
//!   `C` and of the dot products: (δN·|q| + 4u N̂·|C| + 3u |t| N̂·|d|) / (|den| − bound of den),
//!   and u |t| for the division.
//! * Box: (lo − o) · (1/d) and the multiplication by the padding factor are four roundings.
//!
//! All are multiplied by 1.001 for terms of second order (where these can be large, N̂ holds
//! them already) and for the rounding of float64, 2⁻²⁹ of ours. Gradual underflow adds an absolute
//! error of at most 2⁻¹⁵⁰ a product. An fma only leaves roundings out. Float64 itself neither
//! overflows nor underflows: products of four float32 numbers stay within 10^±180. Where float32
//! would overflow there is no bound; [`crate::judge`] holds nothing against such rays.
//!
//! The bounds of the watertight kernel stand in [`crate::watertight`]; the exact one has none.

use dacrt::{Precision, Ray, Triangle};
use glam::DVec3;

/// Unit roundoff of float32.
pub const UNIT: f64 = 1.0 / (1u64 << 24) as f64;
/// Covers terms of second order and the rounding of float64.
const SLACK: f64 = 1.001;
/// Two products that underflow: 2 · 2⁻¹⁵⁰.
pub(crate) const TINY: f64 = 1.0 / (1u128 << 100) as f64 / (1u64 << 49) as f64;
/// Relative padding of a slab interval: near · (1 − p), far · (1 + p).
pub(crate) const BOX_PADDING: f64 = dacrt::PADDING as f64;
/// Roundings in a padded slab distance (one more than there are, for the second order).
pub(crate) const SLAB_ROUNDINGS: f64 = 5.0 * UNIT;

/// Who answered: decides how far from the exact answer it may lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Ours of precision `fast`.
    Fast,
    /// Ours of precision `watertight`, see [`crate::watertight`].
    Watertight,
    /// Ours of precision `exact`: t is the exact one rounded to nearest, of equals the lowest triangle
    /// is hit, and nothing else is right.
    Exact,
    /// Embree's default mode.
    EmbreeFast,
    /// Embree's robust mode.
    EmbreeRobust,
}

impl Kernel {
    /// That of one of our precisions.
    pub fn of(precision: Precision) -> Kernel {
        match precision {
            Precision::Fast => Kernel::Fast,
            Precision::Watertight => Kernel::Watertight,
            Precision::Exact => Kernel::Exact,
        }
    }
}

/// By which formula a distance was computed. Edges are judged by the bounds of the kernel of record,
/// whoever answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formula {
    /// The kernel of record of precision `fast`.
    Fast,
    /// Embree's default mode: the same formula, but T times an estimate of 1/den improved by one
    /// Newton step, which is off by up to 4.3u (`rcp_ps`) before the multiplication; we allow 6u.
    /// No box clip.
    EmbreeFast,
    /// Embree's robust mode: the normal from corners that were rounded relative to the ray's
    /// origin (each corner v off by u |v − o|), the same reciprocal, no box clip.
    EmbreeRobust,
}

/// What float64 says about a ray and a triangle for the formula of precision `fast` and of Embree.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// Distance of the plane in units of the direction's length; not finite if the ray is
    /// parallel to it.
    pub t: f64,
    /// The kernel's distance lies within `t ± t_bound`; infinite if float32 may take the ray for
    /// parallel to the plane.
    pub t_bound: f64,
    /// Some float32 rounding within the bounds puts the ray inside all edges.
    pub possible: bool,
    /// Every float32 rounding within the bounds puts the ray inside all edges.
    pub inside: bool,
    /// Ends of the padded slab interval, each as (least, greatest) value that float32 may give.
    clip: Option<[(f64, f64); 2]>,
    interval: (f64, f64),
    robust_t_bound: f64,
}

impl Pair {
    /// Evaluates a valid ray and a valid triangle of non-zero area, about 100 ns.
    pub fn new(ray: &Ray, triangle: &Triangle) -> Pair {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let (e1, e2, corner) = (a - b, c - a, a - o);
        let normal = e2.cross(e1);
        let den = normal.dot(d);
        let r = corner.cross(d);
        let (u, v) = (r.dot(e2), r.dot(e1));

        let edge_bound = |e: DVec3| {
            let products = corner.abs().dot(abs_cross(d, e))
                + corner.abs().dot(d.cross(e).abs())
                + e.abs().dot(r.abs())
                + 4.0 * f64::max(r.abs().dot(e.abs()), e.cross(corner).abs().dot(d.abs()));
            SLACK * UNIT * products + TINY * (e.abs().element_sum() + d.abs().element_sum() + 2.0)
        };
        let (u_bound, v_bound) = (edge_bound(e2), edge_bound(e1));

        let normal_bound = SLACK * UNIT * (3.0 * abs_cross(e2, e1) + normal.abs()) + TINY;
        let den_bound_for = |normal_bound: DVec3| {
            let rounded = normal.abs() + normal_bound;
            normal_bound.dot(d.abs()) + SLACK * 3.0 * UNIT * rounded.dot(d.abs()) + 2.0 * TINY
        };
        let den_bound = den_bound_for(normal_bound);
        let w_bound = u_bound + v_bound + den_bound + SLACK * UNIT * (u + v).abs();

        let inside_up_to = |sign: f64, slack: f64| {
            sign * u >= -slack * u_bound
                && sign * v >= -slack * v_bound
                && den.abs() - sign * (u + v) >= -slack * w_bound
        };
        let certain_sign = den.abs() > den_bound;
        let (possible, inside) = if certain_sign {
            let sign = den.signum();
            (inside_up_to(sign, 1.0), inside_up_to(sign, -1.0))
        } else {
            (inside_up_to(1.0, 1.0) || inside_up_to(-1.0, 1.0), false)
        };

        let t = normal.dot(corner) / den;
        let to_corner = corner - t * d;
        let t_bound_for = |normal_bound: DVec3, division: f64| {
            let den_left = den.abs() - den_bound_for(normal_bound);
            if den_left <= 0.0 {
                return f64::INFINITY;
            }
            let rounded = normal.abs() + normal_bound;
            let numerator = normal_bound.dot(to_corner.abs())
                + SLACK * UNIT * rounded.dot(4.0 * corner.abs() + 3.0 * t.abs() * d.abs())
                + 2.0 * TINY * (1.0 + t.abs());
            SLACK * (numerator / den_left + division * UNIT * t.abs()) + TINY
        };
        // Moving corner i by u |v_i| moves the normal by at most u abs(v_i, edge opposite).
        let e0 = c - b;
        let moved = UNIT * (abs_cross(corner, e0) + abs_cross(b - o, e2) + abs_cross(c - o, e1));
        let products = abs_cross(e2, e1).max(abs_cross(e1, e0));
        let robust_normal_bound = SLACK * (moved + UNIT * (3.0 * products + normal.abs())) + TINY;

        Pair {
            t,
            t_bound: t_bound_for(normal_bound, 1.0),
            possible,
            inside,
            clip: clip(ray, triangle),
            interval: (ray.tmin as f64, ray.tmax as f64),
            robust_t_bound: t_bound_for(robust_normal_bound, RECIPROCAL),
        }
    }

    /// How far the distance that `formula` gives may lie from `t`.
    pub fn t_bound_of(&self, formula: Formula) -> f64 {
        match formula {
            Formula::Fast => self.t_bound,
            Formula::EmbreeFast => self.t_bound + (RECIPROCAL - 1.0) * UNIT * self.t.abs(),
            Formula::EmbreeRobust => self.robust_t_bound,
        }
    }

    /// The least distance that the kernel of record may give.
    pub fn earliest(&self) -> f64 {
        // NaN if the ray is parallel to the plane: then it may be anywhere.
        let t = self.t - self.t_bound;
        if t.is_nan() { f64::NEG_INFINITY } else { t }
    }

    /// The greatest distance that the kernel of record may give.
    pub fn latest(&self) -> f64 {
        self.t + self.t_bound
    }

    /// Whether the kernel of record must find this hit: inside all edges, the interval and the
    /// box by more than the bounds.
    pub fn clear(&self) -> bool {
        let (first, last) = (self.t - self.t_bound, self.t + self.t_bound);
        // Every comparison fails for NaN and an infinite bound.
        self.inside
            && first > self.interval.0
            && last <= self.interval.1
            && last < f32::MAX as f64
            && self
                .clip
                .is_some_and(|[near, far]| first >= near.1 && last <= far.0)
    }

    /// Whether the kernel of record may find this hit.
    pub fn within_bounds(&self) -> bool {
        let (first, last) = if self.t_bound.is_finite() {
            (self.t - self.t_bound, self.t + self.t_bound)
        } else {
            (f64::NEG_INFINITY, f64::INFINITY)
        };
        self.possible
            && last > self.interval.0
            && first <= self.interval.1
            && self
                .clip
                .is_some_and(|[near, far]| last >= near.0 && first <= far.1)
    }

    /// Whether `formula` may give the distance `t` for this pair.
    pub fn accepts(&self, formula: Formula, t: f32) -> bool {
        let t = t as f64;
        let bound = self.t_bound_of(formula);
        if !t.is_finite() || (bound.is_finite() && (t - self.t).abs() > bound) {
            return false;
        }
        match formula {
            Formula::Fast => {
                t > self.interval.0
                    && t <= self.interval.1
                    && self
                        .clip
                        .is_some_and(|[near, far]| t >= near.0 && t <= far.1)
            }
            // Embree compares T with den · tnear and rounds t afterwards.
            Formula::EmbreeFast | Formula::EmbreeRobust => {
                let slack = 1.0 + 2.0 * RECIPROCAL * UNIT;
                t * slack >= self.interval.0 && t <= self.interval.1 * slack
            }
        }
    }
}

/// Roundings, in u, of Embree's multiplication by a reciprocal.
const RECIPROCAL: f64 = 6.0;

/// The cross product with every term taken as positive.
pub(crate) fn abs_cross(x: DVec3, y: DVec3) -> DVec3 {
    let (x, y) = (x.abs(), y.abs());
    DVec3::new(
        x.y * y.z + x.z * y.y,
        x.z * y.x + x.x * y.z,
        x.x * y.y + x.y * y.x,
    )
}

/// The padded slab interval of the triangle's box, `[near, far]`, each as the least and greatest
/// value that float32 may compute; `None` if no `t > 0` can pass.
fn clip(ray: &Ray, triangle: &Triangle) -> Option<[(f64, f64); 2]> {
    let bounds = triangle.bounds();
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (o, d) = (ray.origin[axis], ray.direction[axis]);
        let (lo, hi) = (bounds.min[axis], bounds.max[axis]);
        if (1.0 / d).is_finite() {
            let slab = [lo, hi].map(|x| (x as f64 - o as f64) / d as f64);
            near = near.max(slab[0].min(slab[1]));
            far = far.min(slab[0].max(slab[1]));
        } else if o < lo || o > hi {
            return None;
        }
    }
    if far < 0.0 {
        return None;
    }
    let near = near.max(0.0) * (1.0 - BOX_PADDING);
    let far = far * (1.0 + BOX_PADDING);
    let rounded = |x: f64| {
        (
            x * (1.0 - SLAB_ROUNDINGS) - TINY,
            x * (1.0 + SLAB_ROUNDINGS) + TINY,
        )
    };
    Some([rounded(near), rounded(far)])
}
