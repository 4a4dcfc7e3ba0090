//! PLACEHOLDER, being written: traces by object splitting.
use super::{Memory, SpaceParameters, Variant};
use crate::methods::tracer::{Answer, Job, Trace};
use crate::methods::{ObjectParameters, object};

pub(in crate::methods) fn trace(
    job: &Job,
    parameters: &SpaceParameters,
    memory: &mut Memory,
    answer: Answer,
) -> Trace {
    let trace = object::trace(job, &ObjectParameters::AFRA2012, &mut memory.0, answer);
    let variant = match job.shared_origin {
        Some(_) => parameters.variant,
        None => Variant::Random,
    };
    Trace {
        variant: Some(variant),
        ..trace
    }
}
