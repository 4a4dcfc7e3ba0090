//! `dacrt report`: one page of result files that needs nothing else.

mod ablation;
mod cells;
mod claims;
mod embree;
mod errors;
mod file;
mod growth;
mod hard;
mod page;
mod papers;
mod pictures;
mod scaling;
mod sources;
mod summary;
mod sweeps;
mod words;

use super::Verdict;
use super::args::ReportArgs;
use super::plan::check_writable;
use super::text::{counted, print};
use anyhow::Context;
use dacrt_validate::atomic;
use file::{File, read};
use maud::{Markup, html};
use std::io::Write;

/// A part of the page with a heading of its own.
struct Section {
    /// What addresses end in.
    id: &'static str,
    title: &'static str,
    body: Markup,
}

impl Section {
    /// What there is of each file, below an introduction; none if there is nothing.
    fn by_file(
        id: &'static str,
        title: &'static str,
        introduction: Markup,
        parts: Vec<(&str, Markup)>,
    ) -> Option<Section> {
        if parts.is_empty() {
            return None;
        }
        let body = html! { (introduction) (words::by_file(parts)) };
        Some(Section { id, title, body })
    }
}

/// Reads the files, makes the page and writes it; says how large it is.
pub fn report(args: &ReportArgs) -> anyhow::Result<Verdict> {
    check_writable(&args.out).context("--out")?;
    let files = read(&args.files)?;
    let pictures = pictures::section(args)?;
    let sections = sections(&files, pictures)?;
    let page = page::html(&files, &sections).into_string();
    atomic::write(&args.out, |out| out.write_all(page.as_bytes()))
        .with_context(|| format!("{}: cannot be written", args.out.display()))?;
    let cells: usize = files.iter().map(|file| file.cells().len()).sum();
    print(&format!(
        "{}: {} of {}, {:.1} MiB\n",
        args.out.display(),
        counted(cells as u64, "cell"),
        counted(files.len() as u64, "file"),
        page.len() as f64 / f64::from(1 << 20),
    ))?;
    Ok(Verdict::Good)
}

/// All parts of which there is something, in the order of the page.
fn sections(files: &[File], pictures: Option<Section>) -> anyhow::Result<Vec<Section>> {
    let parts = [
        summary::section(files),
        pictures,
        errors::section(files)?,
        scaling::resolution(files)?,
        scaling::bounce(files)?,
        embree::section(files)?,
        ablation::section(files),
        sweeps::section(files)?,
        growth::section(files)?,
        papers::section(files),
        claims::section(files),
        hard::section(files),
        cells::section(files),
        Some(sources::section(files)),
    ];
    Ok(parts.into_iter().flatten().collect())
}
