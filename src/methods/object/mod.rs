//! Object splitting: ray sampling (Nabata 2013) and its baseline (Áfra 2012).

mod divide;
mod memory;
mod parameters;
mod split;
mod trace;
mod watched;

pub(super) use memory::Memory;
pub use parameters::{Axes, Cost, Draws, ObjectParameters, OneRay, Order};
pub(super) use parameters::{COMMON, SAMPLING};
pub(super) use trace::trace;
