//! What the test of a ray against a triangle promises.

use std::fmt;
use std::str::FromStr;

/// What the test of a ray against a triangle promises.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// Float32, right up to rounding: near an edge, or near `tmin` and `tmax`, rounding may decide.
    #[default]
    Fast,
    /// Whether a ray hits a triangle is decided as in exact arithmetic: no ray passes between two
    /// triangles that share an edge or a corner. t is rounded as in `fast`, or once where float32 is
    /// not sure. About 1.1 times the time of `fast`.
    Watertight,
    /// The hits of exact arithmetic on the float32 numbers, with t rounded once. About 1.2 times the
    /// time of `fast`.
    Exact,
}

impl Precision {
    /// All precisions, the fastest first.
    pub const ALL: [Precision; 3] = [Precision::Fast, Precision::Watertight, Precision::Exact];

    /// The name used on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Precision::Fast => "fast",
            Precision::Watertight => "watertight",
            Precision::Exact => "exact",
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no precision.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown precision '{0}': expected fast, watertight or exact")]
pub struct UnknownPrecision(pub String);

impl FromStr for Precision {
    type Err = UnknownPrecision;

    fn from_str(name: &str) -> Result<Precision, UnknownPrecision> {
        Precision::ALL
            .into_iter()
            .find(|precision| precision.name() == name)
            .ok_or_else(|| UnknownPrecision(name.to_owned()))
    }
}
