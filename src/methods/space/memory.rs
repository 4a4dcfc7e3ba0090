//! The memory of a trace that splits space.

use crate::methods::object;

/// Memory for traces of up to a number of rays and triangles.
pub(in crate::methods) struct Memory(pub(super) object::Memory);

impl Memory {
    pub fn new(rays: usize, triangles: usize) -> Memory {
        Memory(object::Memory::new(rays, triangles))
    }
    pub fn bytes(rays: usize, triangles: usize) -> usize {
        object::Memory::bytes(rays, triangles)
    }
}
