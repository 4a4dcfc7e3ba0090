//! The validator.

pub mod atomic;
pub mod bounds;
pub mod diff;
pub mod embree;
pub mod hash;
pub mod json_float;
pub mod judge;
pub mod kernels;
pub mod machine;
pub mod measure;
pub mod merge;
pub mod npy;
pub mod results;
pub mod schema;
pub mod statistics;
pub mod sweep;
