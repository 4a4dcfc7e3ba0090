//! Two results of the same work: what has become worse.
//!
//! Hits are judged to the bit, counters by number, times only by ratios within each file. Nothing
//! here reads or writes files.

mod counters;
mod hits;
mod matching;
mod names;
mod times;

pub use counters::Tolerances;
pub use matching::CompareError;
pub use names::Names;
pub use times::{Against, CONFIDENCE, FAR_SLACK, Quotient, Ratio, SLACK, ratios};

use crate::results::{Cell, Document};
use serde::Serialize;
use serde_json::Value;

/// What a comparison is to be lenient about.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Compare the cells that both have; else a cell in one file only is an error.
    pub subset: bool,
    /// How much more of a counter is no regression.
    pub tolerances: Tolerances,
    /// Never judge times.
    pub show_times: bool,
}

/// What came of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// That of the gravest cell.
    pub grade: Grade,
    /// Where each file comes from.
    pub reference: Origin,
    /// Where each file comes from.
    pub new: Origin,
    /// Why the counters of some cells are shown and not judged; `None` if all are judged.
    pub counters_not_judged: Option<String>,
    /// Why times are shown and not judged; `None` if they are judged.
    pub times_not_judged: Option<String>,
    /// Why diff classes that depend on Embree, and Embree's times, are shown and not judged.
    pub embree_not_judged: Option<String>,
    /// The cells that both files have, in the order of the reference.
    pub cells: Vec<CellComparison>,
    /// Names of the others.
    pub only_in_reference: Vec<String>,
    /// Names of the others.
    pub only_in_new: Vec<String>,
}

/// Where a file comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Origin {
    /// Git commit.
    pub commit: Option<String>,
    /// Whether tracked files differed from it.
    pub dirty: Option<bool>,
    /// Model of the processor.
    pub cpu: String,
    /// Instruction set of the engine.
    pub isa: String,
    /// Version and instruction set of Embree.
    pub embree: Option<String>,
}

/// One cell in both files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellComparison {
    /// See [`Names`].
    pub name: String,
    /// The gravest of what was found.
    pub grade: Grade,
    /// What is not the same, times aside; the gravest first.
    pub findings: Vec<Finding>,
    /// How the times compare; `None` if one file has none.
    pub speed: Option<Speed>,
}

/// How grave something is, the least first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Nothing has changed.
    Same,
    /// Changed, but neither for better nor for worse, or nobody can tell.
    Changed,
    /// Better.
    Improvement,
    /// Worse, or changed where nothing may change.
    Regression,
}

/// One thing that is not the same.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its place in the cell, such as `hit_hash`, `diff.embree_fast.tie` or `counters.ray_box`.
    pub what: String,
    /// How grave it is.
    pub grade: Grade,
    /// What the reference has; null if nothing.
    pub reference: Value,
    /// What the new file has; null if nothing.
    pub new: Value,
}

/// The times of a cell in both files.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Speed {
    /// Slower, faster or the same; [`Grade::Changed`] if it would be one of the first two, but
    /// times are not judged.
    pub grade: Grade,
    /// Against whom.
    pub quotients: Vec<Quotient>,
}

impl Comparison {
    /// How many cells are of this grade.
    pub fn count(&self, grade: Grade) -> usize {
        self.of(grade).count()
    }

    /// The cells of this grade.
    pub fn of(&self, grade: Grade) -> impl Iterator<Item = &CellComparison> {
        self.cells.iter().filter(move |cell| cell.grade == grade)
    }
}

/// Sets `new` against `reference`.
///
/// # Errors
/// If the files are not about the same work: see [`CompareError`].
pub fn compare(
    reference: &Document,
    new: &Document,
    options: &Options,
) -> Result<Comparison, CompareError> {
    let names = Names::of(&[reference, new]);
    let matched = matching::matched(reference, new, options, &names)?;
    let differs = |what: &str, a: &str, b: &str| {
        (a != b).then(|| format!("{what} is {a} in the reference and {b} in the new file"))
    };
    let threads = [reference, new].map(|d| d.threads.to_string());
    let embree = [reference, new].map(embree_text);
    let repeats = |(a, b): &(&Cell, &Cell)| a.threads() == 1 && b.threads() == 1;
    let with_more = matched.pairs.iter().filter(|pair| !repeats(pair)).count();
    let mut comparison = Comparison {
        grade: Grade::Same,
        reference: Origin::of(reference),
        new: Origin::of(new),
        counters_not_judged: (with_more > 0).then(|| {
            let of = matched.pairs.len();
            format!("they repeat only with one thread, and {with_more} of {of} cells have more")
        }),
        times_not_judged: (options
            .show_times
            .then(|| "as --times shown asks".to_owned()))
        .or_else(|| differs("machine.cpu", &reference.machine.cpu, &new.machine.cpu))
        .or_else(|| differs("machine.isa", &reference.machine.isa, &new.machine.isa))
        .or_else(|| differs("threads", &threads[0], &threads[1])),
        embree_not_judged: match (&reference.software.embree, &new.software.embree) {
            // Its approximate reciprocals are the processor's.
            (Some(a), Some(b)) if a == b => {
                differs("machine.cpu", &reference.machine.cpu, &new.machine.cpu)
            }
            (None, None) => Some("neither file has an Embree".to_owned()),
            _ => differs("software.embree", &embree[0], &embree[1]),
        },
        cells: Vec::new(),
        only_in_reference: matched.only_in_reference,
        only_in_new: matched.only_in_new,
    };
    for (a, b) in matched.pairs {
        let mut findings = hits::findings(a, b, comparison.embree_not_judged.is_none());
        let judged = repeats(&(a, b));
        findings.extend(counters::findings(a, b, &options.tolerances, judged));
        findings.extend(shown(a, b));
        // The gravest first; what is as grave stays in its order.
        findings.sort_by_key(|finding| std::cmp::Reverse(finding.grade));
        let speed = times::speed(
            (reference, a),
            (new, b),
            &names,
            comparison.times_not_judged.is_none(),
            comparison.embree_not_judged.is_none(),
        );
        let grades = findings.iter().map(|f| f.grade);
        let grades = grades.chain(speed.as_ref().map(|s| s.grade));
        comparison.cells.push(CellComparison {
            name: names.name(&a.key),
            grade: grades.max().unwrap_or(Grade::Same),
            findings,
            speed,
        });
    }
    let grades = comparison.cells.iter().map(|cell| cell.grade);
    comparison.grade = grades.max().unwrap_or(Grade::Same);
    Ok(comparison)
}

impl Origin {
    fn of(document: &Document) -> Origin {
        let Document {
            machine, software, ..
        } = document;
        Origin {
            commit: software.commit.clone(),
            dirty: software.dirty,
            cpu: machine.cpu.clone(),
            isa: machine.isa.clone(),
            embree: (software.embree.as_ref()).map(|e| format!("{} {}", e.version, e.isa)),
        }
    }
}

fn embree_text(document: &Document) -> String {
    let embree = document.software.embree.as_ref();
    embree.map_or("none".to_owned(), |e| {
        format!("{} {} ({})", e.version, e.isa, e.library)
    })
}

/// What is worth knowing and nobody's fault.
fn shown(a: &Cell, b: &Cell) -> Vec<Finding> {
    let of = |cell: &Cell| {
        [
            ("threads", Value::from(cell.threads())),
            ("triangles", cell.triangles.into()),
            ("dropped_triangles", cell.dropped_triangles.into()),
            ("invalid_rays", cell.invalid_rays.into()),
            ("shared_origin", cell.shared_origin.into()),
            ("workspace_bytes", cell.workspace_bytes.into()),
        ]
    };
    of(a)
        .into_iter()
        .zip(of(b))
        .filter_map(|((what, a), (_, b))| Finding::if_changed(what, Grade::Changed, &a, &b))
        .collect()
}

impl Finding {
    /// `None` if both are the same.
    fn if_changed(what: &str, grade: Grade, reference: &Value, new: &Value) -> Option<Finding> {
        (reference != new).then(|| Finding {
            what: what.to_owned(),
            grade,
            reference: reference.clone(),
            new: new.clone(),
        })
    }
}
