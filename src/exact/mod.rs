//! Exact answers about a ray and a triangle: float64 with proven bounds first, whole numbers of a
//! fixed size where those leave it open. Nothing here allocates. A question takes about 20 ns in
//! float64 and 0.5 to 1.5 µs in whole numbers (Zen 5).
//!
//! A line meets a triangle in the point a + (u ab + v ac) / N·d, at t = N·C / N·d, with N = ab × ac,
//! C = a − o, u = (C × d)·ac and v = −(C × d)·ab: inside or on the border if u, v and N·d − u − v
//! have the sign of N·d or are zero. All are polynomials of the float32 given, which are whole
//! multiples of 2⁻¹⁴⁹; so their signs can be had exactly.

mod area;
mod estimate;
mod hits;
mod meeting;
mod whole;
mod wide;

#[cfg(test)]
mod tests;

pub(crate) use area::has_area;
pub(crate) use hits::round_hits;
pub(crate) use meeting::{Meeting, meet};
