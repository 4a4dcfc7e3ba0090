//! Triangles, boxes and meshes.

mod aabb;
mod mesh;

pub use aabb::Aabb;
pub use mesh::{COORDINATE_LIMIT, Mesh, Triangle};
