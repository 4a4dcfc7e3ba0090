//! Object splitting: ray sampling (Nabata 2013) and its baseline (Áfra 2012).

mod divide;
mod memory;
mod nodes;
mod parameters;
mod split;
mod stored;
mod trace;
mod watched;

pub(super) use memory::Memory;
pub(super) use nodes::Log;
pub use nodes::{NodeRecord, SplitRecord};
pub use parameters::{Axes, Cost, Draws, Lists, ObjectParameters, OneRay, Order};
pub(super) use parameters::{COMMON, SAMPLING};
pub(super) use trace::trace;
