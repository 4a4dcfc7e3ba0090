//! What `dacrt hard` found, as a JSON document.

use crate::diff::Number;
use crate::json_file;
use crate::judge::{Answer, Verdict};
use crate::machine::{Machine, Software};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

/// What [`Document::kind`] says. There is no `schema`, so no command takes the file for the
/// [results](crate::results) of a run.
pub const KIND: &str = "hard";

/// All families, each with all contestants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Hard cases")]
pub struct Document {
    /// `hard`.
    #[schemars(extend("const" = KIND))]
    pub kind: String,
    /// Where it ran.
    pub machine: Machine,
    /// What ran.
    pub software: Software,
    /// Seed of all random choices.
    pub seed: u64,
    /// The command line, one string an argument.
    pub command: Vec<String>,
    /// Control bits of MXCSR during the queries of the Embree contestants whose names end in
    /// `_ftz`; `None` where there is no such register.
    pub mxcsr_ftz: Option<u32>,
    /// What was traced.
    pub families: Vec<FamilyResult>,
    /// The first rays of each kind of finding in each case.
    pub findings: Vec<Finding>,
}

/// One family.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FamilyResult {
    /// Its name.
    pub name: String,
    /// What is hard.
    pub what: String,
    /// Who found or described it.
    pub source: String,
    /// Rays, invalid ones included.
    pub rays: u64,
    /// Rays that hit something in exact arithmetic.
    pub hits: u64,
    /// Rays for which `fast` and `watertight` promise right hits: coordinates, edges and the largest
    /// component of the direction are zero or between 1e-9 and 1e9 in size.
    pub promised: u64,
    /// Rays for which the construction of the case says what must come out.
    pub expected: u64,
    /// Of these, rays for which exact arithmetic says otherwise: must be 0.
    pub arbiter_unexpected: u64,
    /// Time of all traces of ours, by all methods on all instruction sets, on all cores.
    pub milliseconds: f64,
    /// By name of the contestant: `fast`, `watertight`, `exact`, `embree_fast`, `embree_robust`,
    /// `embree_fast_ftz`, `embree_robust_ftz`.
    pub contestants: BTreeMap<String, Counts>,
    /// Findings, by contestant and kind.
    pub findings: Vec<Found>,
}

/// How many findings of a kind there are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Found {
    /// Name of the contestant, or `arbiter`.
    pub contestant: String,
    /// What is wrong.
    pub what: What,
    /// Rays for which it is.
    pub rays: u64,
}

/// One contestant's rays of a family, against exact arithmetic. Each ray is at most one of `lost`,
/// `false_hits` and `wrong`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Counts {
    /// Exact arithmetic hits something, the answer is a miss.
    pub lost: u64,
    /// The answer is a hit with a triangle that the ray does not meet in exact arithmetic.
    pub false_hits: u64,
    /// Any other answer that is not the exact one: a hit that is not the nearest (nor exactly as
    /// near), or whose t is off by more than the contestant's bound. In `exact`, and where float32
    /// computes without rounding: not the same bits.
    pub wrong: u64,
    /// Of all these, rays that no rounding of the contestant within its proven bounds explains.
    pub beyond_bounds: u64,
    /// Rays of which the judge says nothing, for products of float32 may overflow.
    pub not_judged: u64,
    /// Rays whose answer is not what the construction of the case says must come out.
    pub unexpected: u64,
    /// Ours: rays on which any other method, instruction set, or the any-hit query answers
    /// otherwise.
    pub methods_differ: u64,
}

impl Counts {
    /// Answers that are not the exact one.
    pub fn errors(&self) -> u64 {
        self.lost + self.false_hits + self.wrong
    }

    /// Adds the counts of another case.
    pub fn add(&mut self, other: &Counts) {
        self.lost += other.lost;
        self.false_hits += other.false_hits;
        self.wrong += other.wrong;
        self.beyond_bounds += other.beyond_bounds;
        self.not_judged += other.not_judged;
        self.unexpected += other.unexpected;
        self.methods_differ += other.methods_differ;
    }
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// `exact`, or any of ours where float32 computes without rounding: not the exact answer.
    NotExact,
    /// `watertight`: a miss, where the ray hits a closed mesh.
    Lost,
    /// Ours: wrong by more than its bounds explain, where its promise holds.
    BeyondBounds,
    /// Ours: methods, instruction sets, or nearest and any hit differ.
    MethodsDiffer,
    /// The arbiter: not what the construction says.
    Arbiter,
}

impl What {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            What::NotExact => "not the exact answer",
            What::Lost => "lost on a closed mesh",
            What::BeyondBounds => "wrong beyond its bounds",
            What::MethodsDiffer => "methods or instruction sets differ",
            What::Arbiter => "exact arithmetic is not as expected",
        }
    }
}

/// A ray that should not be in the document, ready to be traced again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    /// Name of the family.
    pub family: String,
    /// Name of the case.
    pub case: String,
    /// Name of the contestant, or `arbiter`.
    pub contestant: String,
    /// What is wrong.
    pub what: What,
    /// Number of the ray in the case.
    pub index: u32,
    /// Whether all rays of the case have one origin.
    pub shared_origin: bool,
    /// ox oy oz tmin dx dy dz tmax, in decimals that read back as the same float32.
    pub ray: [Number; 8],
    /// The same as hexadecimal bits.
    pub ray_bits: [String; 8],
    /// The contestant's answer.
    pub answer: Answer,
    /// What the judge says of it.
    pub verdict: Verdict,
    /// The answer of exact arithmetic.
    pub exact: Answer,
    /// Corners of the triangles of both answers, nine numbers each, as hexadecimal bits.
    pub triangles: BTreeMap<u32, [String; 9]>,
}

impl Document {
    /// Writes the file whole or not at all.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        json_file::write(path, self)
    }
}
