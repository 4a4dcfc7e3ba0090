//! The validator.

pub mod accuracy;
pub mod atomic;
pub mod bounds;
pub mod compare;
pub mod diff;
pub mod embree;
pub mod exact;
pub mod growth;
pub mod hard;
pub mod hash;
pub mod ingredients;
mod json_file;
pub mod json_float;
pub mod judge;
pub mod kernels;
pub mod machine;
pub mod measure;
pub mod merge;
pub mod npy;
pub mod parameters;
pub mod peers;
pub mod results;
pub mod schema;
pub mod statistics;
pub mod sweep;
pub mod throughput;
