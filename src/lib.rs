//! Divide-and-conquer ray tracing (DACRT): finds the nearest hit, or any hit, of a whole batch of
//! rays against a triangle soup by splitting rays and triangles together, without building and
//! storing an acceleration structure.

pub mod geometry;
pub mod rays;

pub use geometry::{Aabb, Mesh, Triangle};
pub use rays::{Batch, Hits, Ray};
