//! `dacrt table`: a result file for people, or as CSV.

pub mod ablation;
mod csv;
mod errors;
mod lines;
mod memory;
pub mod over;
mod report;
mod twins;

pub use report::{Many, Report};

use super::Verdict;
use super::args::TableArgs;
use super::text::print;
use anyhow::{Context, ensure};
use dacrt_validate::compare::Names;
use dacrt_validate::results::{Cell, Document};

/// Prints what was asked for.
pub fn table(args: &TableArgs) -> anyhow::Result<Verdict> {
    let document = Document::read(&args.file)?;
    let path = args.file.display();
    ensure!(!document.cells.is_empty(), "{path}: has no cells");
    let text = match &args.over {
        Some(name) => over::one(&document, name)
            .with_context(|| format!("{path}: --over {name}: {}", nothing_over(&document)))?,
        None if args.csv => csv::text(&document)?,
        None if args.ablation => ablation::text(&document.cells).with_context(|| {
            format!("{path}: --ablation: no batch has all combinations of cost, order and skip")
        })?,
        None if args.twins => twins::text(&document.cells)
            .with_context(|| format!("{path}: --twins: `dacrt run --twins` measures them"))?,
        None if args.memory => memory::text(&document),
        None if args.errors => errors::text(&document).with_context(|| {
            format!("{path}: --errors: its errors were not counted; `dacrt run` counts them")
        })?,
        None => whole(&document),
    };
    print(&text)?;
    Ok(Verdict::Good)
}

/// The table that `run` printed.
fn whole(document: &Document) -> String {
    let cells = &document.cells;
    let size = |cell: &Cell| (cell.key.resolution, cell.key.spp);
    let other_camera =
        |a: &Cell, b: &Cell| a.key.scene == b.key.scene && a.key.camera != b.key.camera;
    let many = Many {
        sizes: cells.iter().any(|c| size(c) != size(&cells[0])),
        cameras: cells
            .iter()
            .any(|a| cells.iter().any(|b| other_camera(a, b))),
    };
    let mut report = Report::new(many, document.threads);
    let names = Names::of(&[document]);
    let mut text = String::new();
    for batch in cells.chunk_by(|a, b| a.key.batch() == b.key.batch()) {
        let labels: Vec<String> = (batch.iter())
            .map(|cell| names.label(&cell.key, " "))
            .collect();
        text += &report.section(batch, &labels);
    }
    text + &report.end()
}

fn nothing_over(document: &Document) -> String {
    let varied = document.varied().join(", ");
    match varied.is_empty() {
        true => {
            "cells of one method differ in no parameter; `--over method` compares methods".into()
        }
        false => format!("cells of one method do not differ in it; they do in {varied}"),
    }
}
