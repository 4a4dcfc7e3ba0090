//! The exact arbiter: what rays hit, in exact arithmetic on their float32 numbers.
//!
//! Every float32 is a whole number of units of 2⁻¹⁴⁹, so vectors of whole numbers ([`dyadic`])
//! give every sum and product without rounding, and a distance is a ratio of two of them
//! ([`distance`]). [`meet`] decides a ray and a triangle; [`Arbiter`] finds the nearest hit of a
//! ray over a mesh: a search by boxes with proven bounds (`search`) and float64 bounds
//! ([`crate::bounds`]) leave out most triangles, exact arithmetic decides the rest.
//!
//! No arithmetic is shared with the engine, and none uses `o + t d`, which no float type holds
//! exactly: all predicates are on differences of corners and origin.

pub mod distance;
pub mod dyadic;
mod every;
mod nearest;
mod pair;
mod search;

pub use every::every_hit;
pub(crate) use nearest::can_be_hit;
pub use nearest::{Arbiter, Found, Nearest};
pub use pair::{has_area, meet};
