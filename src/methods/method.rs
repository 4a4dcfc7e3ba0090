//! The presets: what the papers' names stand for, and the best of all.

use super::object::{COMMON, SAMPLING};
use super::{BestParameters, ObjectParameters, Parameters, SpaceParameters, best};
use std::fmt;
use std::str::FromStr;

/// Parameters that only conic packets have.
const CONES: [&str; 2] = ["cone_limit", "widest_cone"];

/// A named preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// The baseline: Áfra 2012 as Nabata 2013, section 5, describes it.
    Afra2012,
    /// Ray sampling: Nabata 2013.
    Nabata2013,
    /// Cells and rays: Mora 2011, sections 3.2, 3.5 and 3.6.
    Mora2011,
    /// Cells and conic packets of rays: Mora 2011, section 3.3.
    Mora2011Cones,
    /// Cells and rays in no order: Mora 2011, section 3.4.
    Mora2011Random,
    /// Groups of rays, rays in order, clusters of triangles, splits that are kept: all that pays.
    Best,
}

impl Method {
    /// All methods, the baseline first.
    pub const ALL: [Method; 6] = [
        Method::Afra2012,
        Method::Nabata2013,
        Method::Mora2011,
        Method::Mora2011Cones,
        Method::Mora2011Random,
        Method::Best,
    ];

    /// The name used on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Method::Afra2012 => "afra2012",
            Method::Nabata2013 => "nabata2013",
            Method::Mora2011 => "mora2011",
            Method::Mora2011Cones => "mora2011-cones",
            Method::Mora2011Random => "mora2011-random",
            Method::Best => "best",
        }
    }

    /// The preset.
    pub const fn parameters(self) -> Parameters {
        match self {
            Method::Afra2012 => Parameters::Object(ObjectParameters::AFRA2012),
            Method::Nabata2013 => Parameters::Object(ObjectParameters::NABATA2013),
            Method::Mora2011 => Parameters::Space(SpaceParameters::MORA2011),
            Method::Mora2011Cones => Parameters::Space(SpaceParameters::MORA2011_CONES),
            Method::Mora2011Random => Parameters::Space(SpaceParameters::MORA2011_RANDOM),
            Method::Best => Parameters::Best(BestParameters::BEST),
        }
    }

    /// Whether a parameter, by the name of its field, means anything to the method: `sah_ratio` is
    /// the baseline's own, what speaks of samples is only for ray sampling, and so on.
    pub fn has(self, parameter: &str) -> bool {
        let object = COMMON.contains(&parameter);
        let space = SpaceParameters::FIELDS.contains(&parameter);
        match self {
            Method::Afra2012 => object || parameter == "sah_ratio",
            Method::Nabata2013 => object || SAMPLING.contains(&parameter),
            Method::Best => best::FIELDS.contains(&parameter),
            Method::Mora2011 => space && !CONES.contains(&parameter),
            Method::Mora2011Cones => space,
            Method::Mora2011Random => {
                space && !CONES.contains(&parameter) && parameter != "terminate_as_printed"
            }
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that is no method.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown method '{0}'")]
pub struct UnknownMethod(pub String);

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Method, UnknownMethod> {
        Method::ALL
            .into_iter()
            .find(|method| method.name() == name)
            .ok_or_else(|| UnknownMethod(name.to_owned()))
    }
}
