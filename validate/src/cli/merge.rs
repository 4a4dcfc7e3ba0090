//! `dacrt merge`: the pieces of a sweep in one file.

use super::Verdict;
use super::args::MergeArgs;
use super::plan::check_writable;
use super::text::{counted, print};
use anyhow::Context;
use dacrt_validate::merge::merge as merged;
use dacrt_validate::results::Document;
use std::path::Path;

/// Reads all, then writes all or nothing.
pub fn merge(args: &MergeArgs) -> anyhow::Result<Verdict> {
    let pieces: Vec<(&Path, Document)> = (args.files.iter())
        .map(|path| Ok((&**path, Document::read(path)?)))
        .collect::<anyhow::Result<_>>()?;
    check_writable(&args.out).context("--out")?;
    let command = super::command_line();
    let whole = merged(&pieces, command)?;
    whole.write(&args.out)?;
    let files = counted(pieces.len() as u64, "file");
    let cells = counted(whole.cells.len() as u64, "cell");
    print(&format!(
        "{cells} of {files}\nresults: {}\n",
        args.out.display()
    ))?;
    Ok(Verdict::Good)
}
