//! Divide-and-conquer ray tracing (DACRT): finds the nearest hit, or any hit, of a whole batch of
//! rays against a triangle soup by splitting rays and triangles together, without building and
//! storing an acceleration structure.
//!
//! ```
//! use dacrt::{Batch, Hits, Mesh, Method, Ray, Tracer, Triangle, Workspace};
//! use glam::Vec3;
//!
//! let mesh = Mesh::new(vec![Triangle::new(Vec3::X, Vec3::Y, Vec3::Z)]);
//! let batch: Batch = [Ray::new(Vec3::ZERO, Vec3::ONE), Ray::new(Vec3::ZERO, -Vec3::ONE)]
//!     .into_iter()
//!     .collect();
//! let mut workspace = Workspace::new(batch.len(), mesh.len());
//! let mut hits = Hits::misses(batch.len());
//! Tracer::new(Method::Nabata2013.parameters()).nearest(&mesh, &batch, &mut workspace, &mut hits);
//! assert_eq!(hits.prim, [0, dacrt::MISS]);
//! assert_eq!(hits.t[0], 1.0 / 3.0);
//! ```

pub mod geometry;
mod kernels;
mod methods;
pub mod random;
pub mod rays;
pub mod scene;
mod simd;
pub mod workloads;

pub use geometry::{Aabb, Mesh, Triangle};
pub use kernels::PADDING;
pub use methods::*;
pub use rays::{Batch, Hits, MISS, Ray};
pub use simd::{Isa, UnknownIsa};
