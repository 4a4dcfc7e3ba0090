//! Space splitting: Mora 2011.

mod memory;
mod parameters;
mod trace;

pub(super) use memory::Memory;
pub use parameters::{SpaceParameters, Variant};
pub(super) use trace::trace;
