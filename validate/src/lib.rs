//! The validator.

pub mod atomic;
pub mod bounds;
pub mod embree;
pub mod json_float;
pub mod judge;
pub mod npy;
pub mod statistics;
