//! The methods: presets of two divide-and-conquer algorithms, one that splits lists of triangles and
//! one that splits space.

mod best;
mod counters;
mod job;
mod method;
mod object;
mod observer;
mod parameters;
mod precision;
mod space;
mod stored;
mod tracer;
mod watch;
mod workspace;

pub use best::{BestParameters, Sort};
pub use counters::Counters;
pub use job::Trace;
pub use method::{Method, UnknownMethod};
pub use object::{
    Axes, Cost, Draws, Lists, NodeRecord, ObjectParameters, OneRay, Order, SplitRecord,
};
pub use parameters::{BadParameter, Parameters};
pub use precision::{Precision, UnknownPrecision};
pub use space::{SpaceParameters, Variant};
pub use stored::{Sent, Stored};
pub use tracer::Tracer;
pub use watch::{Event, Step};
pub use workspace::Workspace;
