//! The methods: presets of one divide-and-conquer algorithm.

mod counters;
mod divide;
mod parameters;
mod split;
mod tracer;
mod workspace;

pub use counters::Counters;
pub use parameters::{
    Axes, BadParameter, Cost, Draws, Method, OneRay, Order, Parameters, UnknownMethod,
};
pub use tracer::{Trace, Tracer};
pub use workspace::Workspace;
