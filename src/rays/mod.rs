//! Batches of rays and the hits found for them.

pub(crate) mod active;
mod batch;
mod hits;

pub use batch::{Batch, Ray};
pub use hits::{Hits, MISS};
