//! The parameters of any method.
//!
//! Every technique is a switch, and so is every place where a paper is silent; the doc comment of
//! each field says which section it comes from and what its default is.

use super::{BestParameters, ObjectParameters, SpaceParameters};
use serde::Serialize;

/// Parameters of one of the families of methods. As JSON, the names of the fields.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Parameters {
    /// Triangles are split into two lists: Áfra 2012, Nabata 2013.
    Object(ObjectParameters),
    /// Space is split into two cells: Mora 2011.
    Space(SpaceParameters),
    /// All that pays.
    Best(BestParameters),
}

impl From<ObjectParameters> for Parameters {
    fn from(parameters: ObjectParameters) -> Parameters {
        Parameters::Object(parameters)
    }
}

impl From<SpaceParameters> for Parameters {
    fn from(parameters: SpaceParameters) -> Parameters {
        Parameters::Space(parameters)
    }
}

impl From<BestParameters> for Parameters {
    fn from(parameters: BestParameters) -> Parameters {
        Parameters::Best(parameters)
    }
}

/// A parameter outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} is {value}: expected {expected}")]
pub struct BadParameter {
    /// Name of the field.
    pub name: &'static str,
    /// What it was.
    pub value: f64,
    /// What it may be.
    pub expected: &'static str,
}

/// The first of some (name, value, whether it is good, what is expected) that is not good.
pub(super) fn first_bad(
    checks: &[(&'static str, f64, bool, &'static str)],
) -> Result<(), BadParameter> {
    match checks.iter().find(|check| !check.2) {
        None => Ok(()),
        Some(&(name, value, _, expected)) => Err(BadParameter {
            name,
            value,
            expected,
        }),
    }
}

impl Parameters {
    /// Checks all ranges.
    ///
    /// # Errors
    /// The first parameter that is outside its own.
    pub fn check(&self) -> Result<(), BadParameter> {
        match self {
            Parameters::Object(parameters) => parameters.check(),
            Parameters::Space(parameters) => parameters.check(),
            Parameters::Best(parameters) => parameters.check(),
        }
    }

    /// Whether a trace can use more than one thread: of the methods `best` alone. The others follow
    /// their papers.
    pub fn takes_threads(&self) -> bool {
        matches!(self, Parameters::Best(_))
    }
}
