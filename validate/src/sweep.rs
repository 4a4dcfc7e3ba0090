//! Sweep files: which cells to measure, as a product of lists.
//!
//! ```json
//! {
//!   "about": "Bins: 4 to 128 around the paper's 32",
//!   "scenes": ["sibenik", "sponza"],
//!   "resolution": [512, [1280, 800]],
//!   "rays": ["primary", "diffuse-1"],
//!   "methods": ["afra2012", "nabata2013"],
//!   "parameters": { "bins": [4, 8, 16, 32, 64, 128] }
//! }
//! ```
//!
//! | key | meaning |
//! |---|---|
//! | `$schema` | for editors: where `results/sweep.schema.json` is; not read here, and may be left out |
//! | `about` | one line for people; may be left out |
//! | `scenes` | names, or paths of scene descriptions |
//! | `cameras` | names of cameras of these scenes, as of `dacrt run --cameras`; the first of each scene if left out |
//! | `resolution` | pixels: a number for a square, or `[width, height]` |
//! | `spp` | samples a pixel, square numbers; `[1]` if left out |
//! | `rays` | ray types |
//! | `methods` | methods |
//! | `precision` | precisions of the triangle test; `["fast"]` if left out |
//! | `parameters` | values of method parameters, by the names that they have in result files; may be left out. Each combination is a cell. A parameter that a method lacks makes no cells of it; one that no method has is an error |
//!
//! Every list has at least one entry. An unknown key is an error. How it is measured (repeats, seed,
//! instruction set) is said on the command line, not here.

use crate::schema::parameter_kinds;
use dacrt::workloads::RayType;
use dacrt::{Method, Precision};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// What to measure: each combination of the entries of these lists.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Sweep")]
pub struct Sweep {
    /// Where the JSON Schema of this format is, for editors; nothing else looks at it.
    #[serde(rename = "$schema", default, skip_serializing)]
    pub schema: Option<String>,
    /// One line for people.
    #[serde(default)]
    pub about: String,
    /// Names, or paths of scene descriptions.
    #[schemars(length(min = 1))]
    pub scenes: Vec<String>,
    /// Names of cameras of these scenes; the first of each if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub cameras: Option<Vec<String>>,
    /// Sizes of the picture in pixels.
    #[schemars(length(min = 1))]
    pub resolution: Vec<Size>,
    /// Samples a pixel.
    #[serde(default = "one_sample")]
    #[schemars(length(min = 1), inner(range(min = 1)))]
    pub spp: Vec<u32>,
    /// Ray types.
    #[schemars(length(min = 1), extend("items" = names(RayType::ALL.map(|r| r.to_string()))))]
    pub rays: Vec<String>,
    /// Methods.
    #[schemars(length(min = 1), extend("items" = names(Method::ALL.map(|m| m.to_string()))))]
    pub methods: Vec<String>,
    /// Precisions of the triangle test.
    #[serde(default = "fast", skip_serializing_if = "is_fast")]
    #[schemars(length(min = 1), extend("items" = names(Precision::ALL.map(Precision::name))))]
    pub precision: Vec<String>,
    /// Values of method parameters, by the names that they have in result files.
    #[serde(default)]
    #[schemars(schema_with = "parameter_lists")]
    pub parameters: BTreeMap<String, Vec<Value>>,
}

/// A size of a picture in pixels, each side at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "expected a number of pixels or [width, height], such as 512 or [640, 480]"
)]
pub enum Size {
    /// As wide as high.
    Square(#[schemars(range(min = 1))] u32),
    /// Width and height.
    Sides(#[schemars(inner(range(min = 1)))] [u32; 2]),
}

impl Size {
    /// Width and height.
    pub fn sides(self) -> [u32; 2] {
        match self {
            Size::Square(side) => [side, side],
            Size::Sides(sides) => sides,
        }
    }
}

/// The schema of one of these names.
fn names(names: impl Serialize) -> Value {
    json!({ "type": "string", "enum": names })
}

/// The schema of lists of values of the parameters that there are.
fn parameter_lists(generator: &mut SchemaGenerator) -> Schema {
    let mut lists = Map::new();
    for (name, kind) in parameter_kinds(generator) {
        // The method decides it.
        if name != "variant" {
            lists.insert(
                name,
                json!({ "type": "array", "minItems": 1, "items": kind }),
            );
        }
    }
    json_schema!({ "type": "object", "properties": lists, "additionalProperties": false })
}

fn one_sample() -> Vec<u32> {
    vec![1]
}

fn fast() -> Vec<String> {
    vec![Precision::Fast.to_string()]
}

fn is_fast(names: &[String]) -> bool {
    names == fast()
}

/// Says in a result file which sweep it is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SweepRun {
    /// What was to be measured.
    pub file: Sweep,
    /// `[i, n]`: the i-th (from 1) of n parts of the batches; `None` for all of them.
    pub shard: Option<[u32; 2]>,
}

/// Why a sweep file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The operating system refuses.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// No JSON of this format.
    #[error("{}: is not a sweep file: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What, and at which line and column.
        source: serde_json::Error,
    },
    /// A list without entries: there would be no cell.
    #[error(
        "{}: {key}: expected at least one entry, found none, which makes no cells",
        path.display()
    )]
    Empty {
        /// The file.
        path: PathBuf,
        /// The list.
        key: String,
    },
}

impl Sweep {
    /// Reads a sweep file. Names and values are not looked at: they are for whoever knows them.
    ///
    /// # Errors
    /// If it cannot be read, is no JSON of this format, or has an empty list.
    pub fn load(path: &Path) -> Result<Sweep, SweepError> {
        let bytes = fs::read(path).map_err(|source| SweepError::Read {
            path: path.to_owned(),
            source,
        })?;
        let sweep: Sweep = serde_json::from_slice(&bytes).map_err(|source| SweepError::Json {
            path: path.to_owned(),
            source,
        })?;
        match sweep.empty_list() {
            None => Ok(sweep),
            Some(key) => Err(SweepError::Empty {
                path: path.to_owned(),
                key,
            }),
        }
    }

    fn empty_list(&self) -> Option<String> {
        let lists = [
            ("scenes", self.scenes.is_empty()),
            ("cameras", self.cameras.as_ref().is_some_and(Vec::is_empty)),
            ("resolution", self.resolution.is_empty()),
            ("spp", self.spp.is_empty()),
            ("rays", self.rays.is_empty()),
            ("methods", self.methods.is_empty()),
            ("precision", self.precision.is_empty()),
        ];
        let lists = lists.map(|(key, empty)| (key.to_owned(), empty));
        let parameters = self.parameters.iter();
        let parameters = parameters.map(|(key, v)| (format!("parameters.{key}"), v.is_empty()));
        let mut all = lists.into_iter().chain(parameters);
        all.find(|(_, empty)| *empty).map(|(key, _)| key)
    }
}
