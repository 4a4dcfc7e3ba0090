//! Embree 4 as the reference: nearest and any hit of a batch, in the shapes of [`dacrt`].
//!
//! `embree4-rs` makes devices, scenes and meshes; packets, occlusion and everything that is timed
//! go through `embree4-sys`.

mod alone;
mod best;
mod device;
mod flush;
mod mode;
mod packed;
mod packets;
mod scene;
mod threads;
mod trace;

pub use best::{Best, Combination};
pub use device::{Device, Info, mxcsr};
pub use mode::Mode;
pub use packed::Packed;
pub use packets::Lanes;
pub use scene::{Committed, Quality, Scene};
pub use trace::Query;
