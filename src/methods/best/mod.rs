//! All that pays on one batch: groups of rays, rays put in order, clusters of triangles, and splits
//! that are kept from one block of rays to the next.
//!
//! Rays and triangles are still split together, and a triangle is looked at beyond the first pass
//! only where rays come. But the batch goes through the splits in blocks that fit a cache, and a split,
//! once made, serves the blocks and threads that follow: what is kept in the end is a tree of the
//! scene as far as rays have come, forgotten after the trace, its memory in
//! [`Workspace::bytes`](crate::Workspace::bytes). The papers' presets keep nothing.

mod clusters;
mod divide;
mod first_pass;
mod memory;
mod order;
mod parameters;
mod splits;
mod trace;
mod watched;

pub(super) use memory::Memory;
pub(in crate::methods) use parameters::FIELDS;
pub use parameters::{BestParameters, Sort};
pub(super) use splits::Kept;
pub(super) use trace::trace;
