//! The validator.
pub mod embree;
