//! One result out of several: the shards of a sweep, or runs of other scenes.

use crate::compare::Names;
use crate::results::{Cell, Document, Piece, difference};
use crate::sweep::SweepRun;
use std::path::{Path, PathBuf};

/// Why files cannot be one.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// Cells that cannot stand in one file.
    #[error(
        "{}: cannot be merged with {}: its {what} is {found}, there it is {expected}",
        path.display(),
        first.display()
    )]
    Differ {
        /// The file that does not fit.
        path: PathBuf,
        /// The first file.
        first: PathBuf,
        /// Name of what differs.
        what: &'static str,
        /// In the file.
        found: String,
        /// In the first file.
        expected: String,
    },
    /// A cell that two files have.
    #[error(
        "{}: has a cell that {} has, too: {cell}; give each file once",
        path.display(),
        other.display()
    )]
    Twice {
        /// The later file.
        path: PathBuf,
        /// The earlier file.
        other: PathBuf,
        /// Which cell.
        cell: String,
    },
    /// Batches of one name with other rays.
    #[error(
        "{}: has other rays than {} for {cell}: ray_hash is {found}, there it is {expected}",
        path.display(),
        other.display()
    )]
    OtherRays {
        /// The later file.
        path: PathBuf,
        /// The earlier file.
        other: PathBuf,
        /// Which cell.
        cell: String,
        /// In the later file.
        found: String,
        /// In the earlier file.
        expected: String,
    },
    /// Files of a sweep and others, or of several sweeps.
    #[error(
        "{}: cannot be merged with {}: {problem}",
        path.display(),
        first.display()
    )]
    Sweeps {
        /// The file that does not fit.
        path: PathBuf,
        /// The first file.
        first: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A part of a sweep that is not there.
    #[error("{}: is shard {i} of {n}, and shard {missing} is missing; give all shards", path.display())]
    Missing {
        /// The first file.
        path: PathBuf,
        /// Its place.
        i: u32,
        /// The number of shards.
        n: u32,
        /// The place of the missing one.
        missing: u32,
    },
}

/// All cells in one document, in the order of the files, shards by their number.
///
/// # Errors
/// If they were not made under the same circumstances (program, processor, instruction set, seed,
/// threads), two have the same cell, cells of one batch have other rays, or they are shards of
/// different sweeps or not all of them.
///
/// # Panics
/// If there is no file.
pub fn merge(files: &[(&Path, Document)], command: Vec<String>) -> Result<Document, MergeError> {
    let (first_path, first) = &files[0];
    for (path, file) in &files[1..] {
        if let Some((what, found, expected)) = difference(file, first) {
            return Err(MergeError::Differ {
                path: path.to_path_buf(),
                first: first_path.to_path_buf(),
                what,
                found,
                expected,
            });
        }
    }
    let documents: Vec<&Document> = files.iter().map(|(_, file)| file).collect();
    let names = Names::of(&documents);
    let order = shards_in_order(files)?;
    let mut cells: Vec<(usize, Cell)> = Vec::new();
    for &i in &order {
        let (path, file) = &files[i];
        for cell in &file.cells {
            let same_batch = |(_, c): &&(usize, Cell)| c.key.batch() == cell.key.batch();
            for (j, other) in cells.iter().filter(same_batch) {
                let paths = || (path.to_path_buf(), files[*j].0.to_path_buf());
                if other.ray_hash != cell.ray_hash {
                    let (path, other_path) = paths();
                    return Err(MergeError::OtherRays {
                        path,
                        other: other_path,
                        cell: names.name(&cell.key),
                        found: cell.ray_hash.clone(),
                        expected: other.ray_hash.clone(),
                    });
                }
                if other.key.is(&cell.key) {
                    let (path, other) = paths();
                    return Err(MergeError::Twice {
                        path,
                        other,
                        cell: names.name(&cell.key),
                    });
                }
            }
            cells.push((i, cell.clone()));
        }
    }
    let sweep = first.sweep.as_ref();
    Ok(Document {
        command,
        sweep: sweep.map(|sweep| SweepRun {
            shard: None,
            ..sweep.clone()
        }),
        pieces: (order.iter())
            .map(|&i| Piece {
                machine: files[i].1.machine.clone(),
                command: files[i].1.command.clone(),
                cells: files[i].1.cells.len(),
            })
            .collect(),
        cells: cells.into_iter().map(|(_, cell)| cell).collect(),
        ..first.clone()
    })
}

/// The places of the files in the order of their shards; files that are no shards as they come.
fn shards_in_order(files: &[(&Path, Document)]) -> Result<Vec<usize>, MergeError> {
    let (first_path, first) = &files[0];
    let problem = |path: &Path, problem: String| MergeError::Sweeps {
        path: path.to_owned(),
        first: first_path.to_path_buf(),
        problem,
    };
    let shard = |file: &Document| file.sweep.as_ref().and_then(|sweep| sweep.shard);
    let mut places = Vec::new();
    for (i, (path, file)) in files.iter().enumerate() {
        let (ours, theirs) = (shard(file), shard(first));
        match (ours, theirs) {
            (None, None) => places.push((0, i)),
            (Some([_, n]), Some([_, expected])) if n != expected => {
                return Err(problem(
                    path,
                    format!("it is one of {n} shards, there it is one of {expected}"),
                ));
            }
            (Some([place, _]), Some(_)) => {
                if file.sweep.as_ref().map(|s| &s.file) != first.sweep.as_ref().map(|s| &s.file) {
                    return Err(problem(path, "they are shards of two sweeps".to_owned()));
                }
                if places.iter().any(|&(p, _)| p == place) {
                    return Err(problem(path, format!("shard {place} is given twice")));
                }
                places.push((place, i));
            }
            _ => {
                let text = "one is a shard of a sweep, the other is not".to_owned();
                return Err(problem(path, text));
            }
        }
    }
    if let Some([i, n]) = shard(first)
        && let Some(missing) = (1..=n).find(|place| !places.iter().any(|(p, _)| p == place))
    {
        let path = first_path.to_path_buf();
        return Err(MergeError::Missing {
            path,
            i,
            n,
            missing,
        });
    }
    places.sort();
    Ok(places.into_iter().map(|(_, i)| i).collect())
}
