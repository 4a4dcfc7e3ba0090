//! The polynomials of a ray and a triangle in float64, each with a bound of its error.
//!
//! No product of up to six differences of float32 underflows or overflows in float64. A finite
//! float32 is a multiple of 2⁻¹⁴⁹ below 2¹²⁸. Sums and products of multiples of 2^−k are multiples
//! of 2^−k and 2^−2k, and rounding to 53 bits leaves them so: what is not zero is at least
//! 2^(−149·6) = 2⁻⁸⁹⁴ in size, above the least normal float64, 2⁻¹⁰²². The largest sum of six
//! factors is below 2^(129·6 + 7) = 2⁷⁸¹. So each operation is exact or has a relative error of at
//! most ε = 2⁻⁵³, and a result is zero only if it is exactly zero.
//!
//! A sum of products through whose terms at most k roundings go is within (1 + ε)^k − 1 of the sum
//! S of the sizes of the exact terms. S itself, computed in the same way from sizes, is at least
//! (1 − ε)^k of the exact S. So 10 ε times the computed S is a bound where k is at most 9:
//!
//! | polynomial | roundings |
//! |---|---|
//! | N·d | 2 of the edges, 1 product, 1 difference, 1 product, 2 sums: 7 |
//! | N·C | one more of C: 8 |
//! | (C × d)·e | 1 of C, 1 product, 1 difference, 1 of e, 1 product, 2 sums: 7 |
//! | what is left of N·d | 7, and 2 differences: 9 |

use crate::Triangle;
use glam::{DVec3, Vec3};

/// Half the distance of 1 from the next float64.
pub(super) const EPSILON: f64 = f64::EPSILON / 2.0;
/// Bound of the error of a polynomial, over the sum of the sizes of its terms.
pub(super) const BOUND: f64 = 10.0 * EPSILON;

/// A number in float64, and how far at most it is from the exact one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    pub value: f64,
    pub error: f64,
}

impl Estimate {
    /// A polynomial and the sum of the sizes of its terms.
    fn new(value: f64, sizes: f64) -> Estimate {
        Estimate {
            value,
            error: BOUND * sizes,
        }
    }

    fn is_negative(self) -> bool {
        self.value < -self.error
    }

    fn is_positive(self) -> bool {
        self.value > self.error
    }

    /// Whether the bound does not tell the sign. It does where it is zero: all terms are zero.
    fn is_open(self) -> bool {
        self.value.abs() <= self.error && self.error > 0.0
    }
}

/// |a_y b_z| + |a_z b_y| and so on: the sizes of the terms of a × b.
pub(super) fn cross_sizes(a: DVec3, b: DVec3) -> DVec3 {
    let (a, b) = (a.abs(), b.abs());
    DVec3::new(
        a.y * b.z + a.z * b.y,
        a.z * b.x + a.x * b.z,
        a.x * b.y + a.y * b.x,
    )
}

/// A ray and a triangle in float64.
pub(super) struct Estimates {
    ab: DVec3,
    ac: DVec3,
    /// From the origin of the ray to the first corner.
    corner: DVec3,
    direction: DVec3,
    /// ab × ac.
    normal: DVec3,
    /// The sizes of its terms.
    normal_sizes: DVec3,
    /// N·d.
    determinant: f64,
    determinant_sizes: f64,
}

impl Estimates {
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3, triangle: &Triangle) -> Estimates {
        let [o, direction] = [origin, direction].map(|v| v.as_dvec3());
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|v| v.as_dvec3());
        let (ab, ac, corner) = (b - a, c - a, a - o);
        let (normal, normal_sizes) = (ab.cross(ac), cross_sizes(ab, ac));
        Estimates {
            ab,
            ac,
            corner,
            direction,
            normal,
            normal_sizes,
            determinant: normal.dot(direction),
            determinant_sizes: normal_sizes.dot(direction.abs()),
        }
    }

    /// Whether the line of the ray meets the triangle, if the bounds tell.
    #[inline]
    pub fn meets(&self) -> Option<bool> {
        let moment = self.corner.cross(self.direction);
        let moment_sizes = cross_sizes(self.corner, self.direction);
        // The point is a + (u ab + v ac) / N·d.
        let (u, u_sizes) = (moment.dot(self.ac), moment_sizes.dot(self.ac.abs()));
        let (v, v_sizes) = (-moment.dot(self.ab), moment_sizes.dot(self.ab.abs()));
        let rest = self.determinant - u - v;
        let rest_sizes = self.determinant_sizes + u_sizes + v_sizes;
        let [u, v, rest] = [
            Estimate::new(u, u_sizes),
            Estimate::new(v, v_sizes),
            Estimate::new(rest, rest_sizes),
        ];
        // The three have N·d for a sum: with two of different signs the point is outside, or there
        // is none; with all of one sign or zero, N·d is zero only if they all are.
        let negative = u.is_negative() | v.is_negative() | rest.is_negative();
        let positive = u.is_positive() | v.is_positive() | rest.is_positive();
        if negative && positive {
            Some(false)
        } else if u.is_open() | v.is_open() | rest.is_open() {
            None
        } else {
            Some(negative || positive)
        }
    }

    /// t = N·C / N·d; the error is infinite where N·d may be zero for all the bound tells.
    #[inline]
    pub fn t(&self) -> Estimate {
        let sizes = self.normal_sizes.dot(self.corner.abs());
        let numerator = Estimate::new(self.normal.dot(self.corner), sizes);
        let determinant = Estimate::new(self.determinant, self.determinant_sizes);
        let value = numerator.value / determinant.value;
        let least = determinant.value.abs() - determinant.error;
        let error = if least > 0.0 {
            // n/d − n'/d' = ((n − n') + n'/d' (d' − d)) / d, with room for the roundings here and,
            // by the last term, for that of the quotient and of a later sum of value and error.
            (numerator.error + value.abs() * determinant.error) / least * (1.0 + 1e-12)
                + 4.0 * EPSILON * value.abs()
        } else {
            f64::INFINITY
        };
        Estimate { value, error }
    }
}
