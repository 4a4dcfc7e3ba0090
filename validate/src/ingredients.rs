//! What each numerical ingredient of the tests of rays, triangles and boxes does alone: errors
//! against exact arithmetic on pairs of a ray and a triangle, and times.

mod errors;
mod pairs;
mod times;

pub use errors::{BoxErrors, Set, Spread, TriangleErrors, measure};
pub use pairs::{Source, hard, of_rays};
pub use times::{Plan, Time, Times, time};

use crate::json_file;
use crate::machine::{Machine, Software};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// What [`Document::kind`] says. There is no `schema`, so no command takes the file for the
/// [results](crate::results) of a run.
pub const KIND: &str = "ingredients";

/// All that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// [`KIND`].
    pub kind: String,
    /// Where it ran.
    pub machine: Machine,
    /// What ran.
    pub software: Software,
    /// The command line, one string an argument.
    pub command: Vec<String>,
    /// Name of the instruction set that the errors are of.
    pub isa: String,
    /// Errors, for each set of pairs.
    pub sets: Vec<Set>,
    /// Times.
    pub times: Times,
}

impl Document {
    /// Writes the file whole or not at all.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        json_file::write(path, self)
    }

    /// What `watertight` and `exact` got wrong, which they promise not to.
    pub fn broken_promises(&self) -> Vec<String> {
        // Half a unit, and what float64 may add to it.
        const ROUNDED_ONCE: f64 = 0.5 + 1e-6;
        let of_set = |set: &Set| {
            let of_test = |e: &TriangleErrors| {
                let late =
                    e.test == "exact" && e.ulps.as_ref().is_some_and(|s| s.max > ROUNDED_ONCE);
                let promised = e.record && e.test != "fast";
                (promised && (e.lost + e.false_hits > 0 || late)).then(|| {
                    let ulps = e.ulps.as_ref().map_or(0.0, |s| s.max);
                    format!(
                        "{}, {}: {} lost, {} false, t off by up to {ulps} ulp",
                        set.name, e.test, e.lost, e.false_hits
                    )
                })
            };
            set.triangle_tests
                .iter()
                .filter_map(of_test)
                .collect::<Vec<_>>()
        };
        self.sets.iter().flat_map(of_set).collect()
    }
}
