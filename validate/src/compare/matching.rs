//! Which cells of two files are the same work, and why two files cannot be compared.

use super::names::{Group, group};
use super::{Names, Options};
use crate::results::{Cell, Document};
use std::collections::BTreeMap;

/// Why two results cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// Random rays, and hits of secondary ones, are others.
    #[error(
        "the seeds differ: {reference} in the first file, {new} in the second, so the rays are \
         others; run one of them again with the --seed of the other"
    )]
    Seed {
        /// Of the reference.
        reference: u64,
        /// Of the new file.
        new: u64,
    },
    /// Equal keys, other rays.
    #[error(
        "the rays differ (ray_hash) in {}: {}; is it another mesh, camera or light?",
        cells(.0), listed(.0)
    )]
    Rays(Vec<String>),
    /// Cells that only one file has.
    #[error(
        "{}; --subset compares what both have",
        only(only_in_reference, only_in_new)
    )]
    Unmatched {
        /// Names of cells.
        only_in_reference: Vec<String>,
        /// Names of cells.
        only_in_new: Vec<String>,
    },
    /// Nothing to compare.
    #[error("they have no cell in common{}", example(.0))]
    NothingInCommon(Option<[String; 2]>),
    /// A file that was put together wrongly.
    #[error("the {file} file has cell {name} twice; take one of them out")]
    Twice {
        /// `first` or `second`.
        file: &'static str,
        /// Name of the cell.
        name: String,
    },
    /// A counter that cannot be one.
    #[error(
        "the {file} file is damaged: cell {name}, counter {counter}: expected a whole number, \
         found {found}"
    )]
    Counter {
        /// `first` or `second`.
        file: &'static str,
        /// Name of the cell.
        name: String,
        /// Name of the counter.
        counter: String,
        /// What stands there.
        found: String,
    },
    /// A tolerance for nothing.
    #[error("--tolerance: {}", dacrt::scene::no_such("counter", name, known))]
    Tolerance {
        /// What it was for.
        name: String,
        /// Counters that there are.
        known: Vec<String>,
    },
}

/// Cells of two files, side by side.
pub(super) struct Matched<'a> {
    pub pairs: Vec<(&'a Cell, &'a Cell)>,
    pub only_in_reference: Vec<String>,
    pub only_in_new: Vec<String>,
}

pub(super) fn matched<'a>(
    reference: &'a Document,
    new: &'a Document,
    options: &Options,
    names: &Names,
) -> Result<Matched<'a>, CompareError> {
    check(reference, "first", names)?;
    check(new, "second", names)?;
    if reference.seed != new.seed {
        return Err(CompareError::Seed {
            reference: reference.seed,
            new: new.seed,
        });
    }
    let (in_reference, in_new) = (Groups::of(reference), Groups::of(new));
    let mut matched = Matched {
        pairs: Vec::new(),
        only_in_reference: Vec::new(),
        only_in_new: Vec::new(),
    };
    for cell in &reference.cells {
        match in_new.find(cell) {
            Some(other) => matched.pairs.push((cell, other)),
            None => matched.only_in_reference.push(names.name(&cell.key)),
        }
    }
    let unmatched = new.cells.iter().filter(|c| in_reference.find(c).is_none());
    matched.only_in_new = unmatched.map(|cell| names.name(&cell.key)).collect();

    let complete = matched.only_in_reference.is_empty() && matched.only_in_new.is_empty();
    if !options.subset && !complete {
        return Err(CompareError::Unmatched {
            only_in_reference: matched.only_in_reference,
            only_in_new: matched.only_in_new,
        });
    }
    if matched.pairs.is_empty() {
        let first = |names: &[String]| names.first().cloned();
        let examples = first(&matched.only_in_reference).zip(first(&matched.only_in_new));
        let examples = examples.map(|(a, b)| [a, b]);
        return Err(CompareError::NothingInCommon(examples));
    }
    let other_rays = matched
        .pairs
        .iter()
        .filter(|(a, b)| a.ray_hash != b.ray_hash);
    let other_rays: Vec<String> = other_rays.map(|(a, _)| names.name(&a.key)).collect();
    if !other_rays.is_empty() {
        return Err(CompareError::Rays(other_rays));
    }
    if let Some((name, known)) = options.tolerances.unknown([reference, new]) {
        return Err(CompareError::Tolerance { name, known });
    }
    Ok(matched)
}

/// The cells of a document by method and batch.
struct Groups<'a>(BTreeMap<Group<'a>, Vec<&'a Cell>>);

impl<'a> Groups<'a> {
    fn of(document: &'a Document) -> Groups<'a> {
        let mut groups: BTreeMap<Group, Vec<&Cell>> = BTreeMap::new();
        for cell in &document.cells {
            groups.entry(group(&cell.key)).or_default().push(cell);
        }
        Groups(groups)
    }

    fn find(&self, cell: &Cell) -> Option<&'a Cell> {
        let group = self.0.get(&group(&cell.key))?;
        group.iter().find(|other| other.key.is(&cell.key)).copied()
    }
}

/// What cannot come from a run.
fn check(document: &Document, file: &'static str, names: &Names) -> Result<(), CompareError> {
    for group in Groups::of(document).0.values() {
        for (i, cell) in group.iter().enumerate() {
            let name = || names.name(&cell.key);
            if group[..i].iter().any(|other| other.key.is(&cell.key)) {
                return Err(CompareError::Twice { file, name: name() });
            }
            if let Some((counter, found)) = cell.counters.iter().find(|(_, n)| !n.is_u64()) {
                return Err(CompareError::Counter {
                    file,
                    name: name(),
                    counter: counter.clone(),
                    found: found.to_string(),
                });
            }
        }
    }
    Ok(())
}

fn cells(names: &[String]) -> String {
    match names.len() {
        1 => "1 cell".to_owned(),
        n => format!("{n} cells"),
    }
}

/// All names, or the first ten.
fn listed(names: &[String]) -> String {
    const MOST: usize = 10;
    let shown = names[..names.len().min(MOST)].join(", ");
    match names.len() {
        ..=MOST => shown,
        n => format!("{shown} and {} more", n - MOST),
    }
}

fn only(in_reference: &[String], in_new: &[String]) -> String {
    let side = |which: &str, names: &[String]| {
        let first = names.first()?;
        let first = if names.len() == 1 {
            format!(": {first}")
        } else {
            format!(", the first: {first}")
        };
        Some(format!("{} only in the {which} file{first}", cells(names)))
    };
    let sides = [side("first", in_reference), side("second", in_new)];
    sides.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

fn example(names: &Option<[String; 2]>) -> String {
    names.as_ref().map_or(String::new(), |[a, b]| {
        format!(": the first file has {a}, the second {b}")
    })
}
