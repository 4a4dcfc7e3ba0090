//! The result document of a run: one JSON file, its reading, writing and resuming.

use crate::diff::Diff;
use crate::embree::Mode;
use crate::json_file;
use crate::machine::{Machine, Software};
use crate::parameters::own_fields;
use crate::sweep::SweepRun;
use dacrt::Method;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The version of the document that this program writes and reads.
pub const SCHEMA: u32 = 1;

/// One run of divide-and-conquer ray tracing, checked against Embree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Results")]
pub struct Document {
    /// The version of this format.
    #[schemars(extend("const" = SCHEMA))]
    pub schema: u32,
    /// Where it ran.
    pub machine: Machine,
    /// What ran.
    pub software: Software,
    /// Seed of all random choices.
    pub seed: u64,
    /// Threads of Embree, and of the methods that take more than one.
    pub threads: usize,
    /// The command line, one string an argument.
    pub command: Vec<String>,
    /// The sweep that it is, or is a shard of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepRun>,
    /// The files that were merged into it; then `command` is that of the merge, and `machine` that
    /// of the first piece.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pieces: Vec<Piece>,
    /// What was measured.
    pub cells: Vec<Cell>,
    /// Changes that were accepted on purpose, oldest first, where this file is a reference for
    /// comparisons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub accepted: Vec<Acceptance>,
}

/// Why a reference was replaced by a newer result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Acceptance {
    /// Whoever accepted it says why.
    pub note: String,
    /// Commit of the reference until then.
    pub from_commit: Option<String>,
    /// Commit of the result that took its place.
    pub to_commit: Option<String>,
    /// What had changed, a line each, with the name of the cell.
    pub findings: Vec<String>,
}

/// One of the files that were merged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Piece {
    /// Where it ran.
    pub machine: Machine,
    /// Its command line.
    pub command: Vec<String>,
    /// How many cells it brought.
    pub cells: usize,
}

/// One scene × camera × size × ray type × method × parameters.
///
/// Times are `None` unless the validation of the same hits passed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cell {
    /// Which cell this is.
    #[serde(flatten)]
    pub key: CellKey,
    /// Threads that traced it: those of the run by `best`, one by any other method; `None` in files from
    /// before there could be more than one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub threads: Option<usize>,
    /// Triangles, dropped ones included.
    pub triangles: usize,
    /// Triangles with a NaN, an infinite or a too large coordinate.
    pub dropped_triangles: usize,
    /// Rays of the batch, invalid ones included.
    pub ray_count: usize,
    /// Rays that miss because they are invalid.
    pub invalid_rays: u64,
    /// SHA-256 of the eight little-endian float32 of each ray, in order; see
    /// [`crate::hash::ray_hash`].
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub ray_hash: String,
    /// Whether rays stop at any hit.
    pub any_hit: bool,
    /// Whether the batch was traced as one with a shared origin.
    pub shared_origin: bool,
    /// Milliseconds of each repeat.
    pub samples_ms: Option<Vec<f64>>,
    /// Their median.
    pub median_ms: Option<f64>,
    /// Million rays a second, of the median.
    pub mrays_per_s: Option<f64>,
    /// Time of `afra2012` in the same precision over ours; `None` without it in the run.
    pub acceleration_ratio: Option<f64>,
    /// Its 95 % bootstrap interval.
    pub acceleration_interval: Option<[f64; 2]>,
    /// Time over that of precision `fast` by the same method with the same parameters; `None` for
    /// `fast` itself, or without it in the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_over_fast: Option<f64>,
    /// Its 95 % bootstrap interval.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_over_fast_interval: Option<[f64; 2]>,
    /// What the trace did, in logical tests; the same on every instruction set, and with one thread each
    /// time.
    #[schemars(schema_with = "crate::schema::counters")]
    pub counters: Map<String, Value>,
    /// Median milliseconds of a pass that gives each ray a grey by what it hits, where it was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shade_ms: Option<f64>,
    /// Size of the workspace.
    pub workspace_bytes: usize,
    /// Rays that hit something.
    pub hits: usize,
    /// SHA-256 of t (little-endian float32), then prim (uint32), in ray order; of any-hit rays, of
    /// the bytes that say whether each is occluded. See [`crate::hash::hit_hash`].
    #[schemars(regex(pattern = "^[0-9a-f]{64}$"))]
    pub hit_hash: String,
    /// Validation.
    pub diff: Diff,
    /// With `terminate_as_printed`: rays whose hit is another than without, which are wrong.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub printed_rule_wrong: Option<u64>,
    /// Embree's times on the same rays: of its default mode for precision `fast`, of its robust mode
    /// for the others.
    pub embree: Option<EmbreeTimes>,
    /// `embree.best_ms / median_ms`.
    pub ratio_embree_total: Option<f64>,
    /// Its 95 % bootstrap interval.
    pub ratio_embree_total_interval: Option<[f64; 2]>,
    /// `embree.best_trace_ms / median_ms`.
    pub ratio_embree_trace: Option<f64>,
    /// Its 95 % bootstrap interval.
    pub ratio_embree_trace_interval: Option<[f64; 2]>,
    /// Other libraries on the same rays, where they were asked for; an entry for each builder.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peers: Vec<PeerTimes>,
    /// The same rays through the stored splits of this trace, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twin: Option<Twin>,
}

impl Cell {
    /// Threads that traced it.
    pub fn threads(&self) -> usize {
        self.threads.unwrap_or(1)
    }

    /// Whether it has rays, but no times, for its hits were found wrong.
    pub fn is_wrong(&self) -> bool {
        self.mrays_per_s.is_none() && self.ray_count > 0
    }
}

/// What names a cell: equal keys, same rays and same work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellKey {
    /// Name of the scene.
    pub scene: String,
    /// Name of the camera.
    pub camera: String,
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// Samples a pixel.
    pub spp: u32,
    /// Name of the ray type.
    pub rays: String,
    /// Name of the method.
    pub method: String,
    /// Name of the precision.
    pub precision: String,
    /// All parameters of the method; of Mora's also the `variant` that was taken.
    #[schemars(schema_with = "crate::schema::parameters")]
    pub parameters: Map<String, Value>,
}

impl CellKey {
    /// Adds what the method has and the file does not say, for it is older: parameters that came later,
    /// with the value that was the only one then.
    fn complete(&mut self) {
        const LATER: [(&str, &str); 1] = [("lists", "auto")];
        let Ok(method) = self.method.parse::<Method>() else {
            return;
        };
        for (name, value) in LATER {
            if method.has(name) && !self.parameters.contains_key(name) {
                self.parameters.insert(name.to_owned(), value.into());
            }
        }
    }

    /// Whether all parameters are the defaults of the method.
    pub fn is_preset(&self) -> bool {
        self.method.parse::<Method>().is_ok_and(|method| {
            let preset = CellKey {
                parameters: own_fields(method, &method.parameters()),
                ..self.clone()
            };
            preset.is(self)
        })
    }

    /// What all cells of one batch have in common: scene, camera, size, samples, ray type.
    pub fn batch(&self) -> (&str, &str, [u32; 2], u32, &str) {
        let size = (self.resolution, self.spp);
        (&self.scene, &self.camera, size.0, size.1, &self.rays)
    }

    /// The parameters that are somebody's choice: all but the variant, which method and rays decide;
    /// only the trace shows whether the rays share an origin.
    pub fn choices(&self) -> impl Iterator<Item = (&String, &Value)> {
        self.parameters
            .iter()
            .filter(|(name, _)| *name != "variant")
    }

    /// Whether both name the same cell: the same batch, method, precision and choices.
    pub fn is(&self, other: &CellKey) -> bool {
        self.batch() == other.batch()
            && (&self.method, &self.precision) == (&other.method, &other.precision)
            && self.choices().eq(other.choices())
    }
}

/// Embree on the rays of a cell. Keys: of `build_ms` the quality; of the traces quality and query.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EmbreeTimes {
    /// The mode that all of this is of; `None` in files from before there was another than `fast`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mode: Option<Mode>,
    /// Least of median build + median trace.
    pub best_ms: f64,
    /// Least median trace.
    pub best_trace_ms: f64,
    /// Medians of the builds.
    pub build_ms: BTreeMap<String, f64>,
    /// Medians of the traces, by quality and query: `low_1`, `medium_16`, `high_16_coherent`; 8 in the place of
    /// 16 where Embree's vectors have 8 lanes, 4 where they have 4.
    pub trace_ms: BTreeMap<String, f64>,
    /// All samples, of builds and of traces.
    pub samples_ms: BTreeMap<String, Vec<f64>>,
    /// Medians without filling Embree's ray structures and reading hits back, for each query on
    /// the quality that it is fastest on.
    pub trace_prepacked_ms: BTreeMap<String, f64>,
    /// Memory of the scene in Embree.
    pub bytes: usize,
}

/// The splits of a trace kept as a tree, and its rays sent through that by the same kernels: what is left
/// without building.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Twin {
    /// Nodes of the tree.
    pub nodes: usize,
    /// Triangles of all leaves; a cell's may be in others, too.
    pub triangles: usize,
    /// Ray/box tests of the trace that the way of a ray depended on: without probes of long lists, and
    /// without filters that only tell whether splitting goes on.
    pub ray_box: u64,
    /// Ray/triangle tests of the trace.
    pub ray_triangle: u64,
    /// Ray/box tests of rays sent one by one. Mora 2011, section 3.2: as many. `None` where boxes are held
    /// against conic packets, or groups, which cannot be sent so.
    pub one_by_one_ray_box: Option<u64>,
    /// Ray/triangle tests of these.
    pub one_by_one_ray_triangle: Option<u64>,
    /// Hits that are not those of the trace, over all times that rays were sent; 0.
    pub differing_rays: usize,
    /// Median milliseconds of all rays sent together.
    pub median_ms: f64,
    /// Time of the trace over that, measured in turns.
    pub trace_over_twin: f64,
    /// Its 95 % bootstrap interval.
    pub trace_over_twin_interval: [f64; 2],
    /// Milliseconds of all rays sent one by one, once, by kernels that are made for many.
    pub one_by_one_ms: Option<f64>,
    /// Milliseconds of each repeat.
    pub samples_ms: Vec<f64>,
    /// The same rays through the splits of the primary rays; `None` of primary rays, and of cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reuse: Option<Reuse>,
}

/// Secondary rays through the splits of the primary ones, which are split further where they end (Nabata
/// 2013, section 5). To make those splits is not in the times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reuse {
    /// Median milliseconds.
    pub median_ms: f64,
    /// Time of the trace over that, measured in turns.
    pub trace_over_reuse: f64,
    /// Its 95 % bootstrap interval.
    pub trace_over_reuse_interval: [f64; 2],
    /// Milliseconds of each repeat, of the trace and of the reused splits.
    pub samples_ms: [Vec<f64>; 2],
}

impl Twin {
    /// Whether a ray that is sent alone has the tests that it had among others, if it can be, and its hit.
    pub fn is_equal(&self) -> bool {
        let equal = |sent: Option<u64>, of_trace| sent.is_none_or(|n| n == of_trace);
        equal(self.one_by_one_ray_box, self.ray_box)
            && equal(self.one_by_one_ray_triangle, self.ray_triangle)
            && self.differing_rays == 0
    }
}

/// A builder of another library on the rays of a cell, with one thread.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PeerTimes {
    /// Name of the crate.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Layout of the tree and quality of the build.
    pub builder: String,
    /// The widest instruction set that this program was compiled for: `sse2`, `avx2` or `avx512`.
    pub compiled_for: String,
    /// Median milliseconds of a build.
    pub build_ms: f64,
    /// Median milliseconds of a trace.
    pub trace_ms: f64,
    /// Milliseconds of each build.
    pub build_samples_ms: Vec<f64>,
    /// Milliseconds of each trace.
    pub trace_samples_ms: Vec<f64>,
    /// Rays whose hit is not ours: another triangle, or t apart by more than 10⁻⁴ of it. A number,
    /// not a finding: the precision of a library is its own.
    pub differing_rays: usize,
    /// Memory of the tree and the triangles in it; `None` if the library does not tell.
    pub bytes: Option<usize>,
}

/// Why a result file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ResultError {
    /// The operating system refuses.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The operating system refuses.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Damaged gzip.
    #[error(
        "{}: is damaged, make or copy it anew: its gzip ends in error after {byte} bytes of text: \
         {source}",
        path.display()
    )]
    Gzip {
        /// The file.
        path: PathBuf,
        /// How much could be unpacked.
        byte: usize,
        /// Why no more.
        source: io::Error,
    },
    /// Not JSON, or not the JSON of a result.
    #[error(
        "{}: is not a result file as `dacrt run` writes it: {source}",
        path.display()
    )]
    Json {
        /// The file.
        path: PathBuf,
        /// What and at which line and column.
        source: serde_json::Error,
    },
    /// Written by another version of this program.
    #[error(
        "{}: has schema {found}, this program reads schema {SCHEMA}; use the dacrt that wrote it",
        path.display()
    )]
    Schema {
        /// The file.
        path: PathBuf,
        /// Its schema.
        found: u64,
    },
    /// Cells of two runs that cannot stand side by side.
    #[error(
        "{}: cannot be resumed: its {what} is {found}, here it is {here}; give another --out",
        path.display()
    )]
    Mismatch {
        /// The file.
        path: PathBuf,
        /// Name of what differs.
        what: &'static str,
        /// In the file.
        found: String,
        /// In this run.
        here: String,
    },
}

/// What must be the same for cells to stand in one document, each with its name.
fn circumstances(document: &Document) -> [(&'static str, String); 8] {
    let Document {
        machine, software, ..
    } = document;
    let embree = software.embree.as_ref();
    [
        ("cpu", machine.cpu.clone()),
        ("instruction set", machine.isa.clone()),
        ("seed", document.seed.to_string()),
        ("number of threads", document.threads.to_string()),
        (
            "commit",
            software.commit.clone().unwrap_or("unknown".to_owned()),
        ),
        (
            "state of the source",
            format!("dirty: {:?}", software.dirty),
        ),
        ("compiler", software.rustc.clone()),
        (
            "Embree",
            embree.map_or("none".to_owned(), |e| format!("{} {}", e.version, e.isa)),
        ),
    ]
}

/// The first circumstance in which two documents differ: its name, and what each has.
pub fn difference(a: &Document, b: &Document) -> Option<(&'static str, String, String)> {
    let pairs = circumstances(a).into_iter().zip(circumstances(b));
    pairs
        .map(|((what, a), (_, b))| (what, a, b))
        .find(|(_, a, b)| a != b)
}

/// Which part of a sweep it is.
fn part(document: &Document) -> String {
    match &document.sweep {
        None => "none".to_owned(),
        Some(SweepRun { shard: None, .. }) => "all".to_owned(),
        Some(SweepRun {
            shard: Some([i, n]),
            ..
        }) => format!("shard {i} of {n}"),
    }
}

impl Document {
    /// Reads a result file, plain or gzip (told by its first bytes, not by its name).
    ///
    /// # Errors
    /// If it cannot be read, or is not a result file of this [`SCHEMA`].
    pub fn read(path: &Path) -> Result<Document, ResultError> {
        let read = |source| ResultError::Read {
            path: path.to_owned(),
            source,
        };
        let bytes = fs::read(path).map_err(read)?;
        let bytes = json_file::text(bytes).map_err(|(byte, source)| ResultError::Gzip {
            path: path.to_owned(),
            byte,
            source,
        })?;
        let json = |source| ResultError::Json {
            path: path.to_owned(),
            source,
        };
        // The schema first: a file of another one may lack keys, and that is not what is wrong.
        #[derive(Deserialize)]
        struct Version {
            schema: u64,
        }
        let Version { schema } = serde_json::from_slice(&bytes).map_err(json)?;
        if schema != SCHEMA as u64 {
            return Err(ResultError::Schema {
                path: path.to_owned(),
                found: schema,
            });
        }
        let mut document: Document = serde_json::from_slice(&bytes).map_err(json)?;
        document
            .cells
            .iter_mut()
            .for_each(|cell| cell.key.complete());
        Ok(document)
    }

    /// Writes the file whole or not at all: to a temporary file beside it, which is then renamed.
    /// Gzip if the name ends in `.gz`.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), ResultError> {
        crate::atomic::write(path, |file| {
            if path.extension().is_some_and(|extension| extension == "gz") {
                let mut gzip = flate2::write::GzEncoder::new(file, Default::default());
                json_file::write_text(&mut gzip, self)?;
                gzip.finish().map(drop)
            } else {
                json_file::write_text(file, self)
            }
        })
        .map_err(|source| ResultError::Write {
            path: path.to_owned(),
            source,
        })
    }

    /// Takes over the finished cells of an earlier run of the same program on the same machine
    /// with the same seed and threads; a file that does not exist has none.
    ///
    /// # Errors
    /// If the file cannot be read, or its cells were made under other circumstances.
    pub fn resume(&mut self, path: &Path) -> Result<(), ResultError> {
        if !path.exists() {
            return Ok(());
        }
        let earlier = Document::read(path)?;
        let parts = ("part of a sweep", part(&earlier), part(self));
        let other_part = (parts.1 != parts.2).then_some(parts);
        if let Some((what, found, here)) = other_part.or_else(|| difference(&earlier, self)) {
            let path = path.to_owned();
            return Err(ResultError::Mismatch {
                path,
                what,
                found,
                here,
            });
        }
        self.cells = earlier.cells;
        self.accepted = earlier.accepted;
        Ok(())
    }

    /// The parameters that have more than one value among the cells of one method, `precision`
    /// among them.
    pub fn varied(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for (i, a) in self.cells.iter().enumerate() {
            let of_method = |b: &&Cell| b.key.method == a.key.method;
            let Some(b) = self.cells[..i].iter().find(of_method) else {
                continue;
            };
            for (name, value) in a.key.choices() {
                let differs = b.key.parameters.get(name).is_some_and(|v| v != value);
                if differs && !names.contains(name) {
                    names.push(name.clone());
                }
            }
            let precision = "precision".to_owned();
            if a.key.precision != b.key.precision && !names.contains(&precision) {
                names.push(precision);
            }
        }
        names
    }

    /// The cell of this key, if it is finished.
    pub fn finished(&self, key: &CellKey) -> Option<&Cell> {
        self.cells.iter().find(|cell| cell.key.is(key))
    }
}
