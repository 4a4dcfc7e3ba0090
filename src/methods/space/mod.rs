//! Space splitting: Mora 2011.

mod cell;
mod divide;
mod growth;
mod halves;
mod memory;
mod octants;
mod packets;
mod parameters;
mod stored;
mod trace;
mod watched;

pub(super) use memory::Memory;
pub use parameters::{SpaceParameters, Variant};
pub(super) use trace::trace;
