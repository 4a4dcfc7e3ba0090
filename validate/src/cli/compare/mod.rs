//! `dacrt compare`: reads two results, says what has become worse, and takes a new reference.

mod accept;
mod bencher;
mod junit;
mod markdown;
mod table;
mod words;

use super::Verdict;
use super::args::{CompareArgs, CompareFormat, Times};
use super::text;
use anyhow::Context;
use dacrt_validate::compare::{self, Comparison, Grade, Options, Tolerances};
use dacrt_validate::results::Document;

/// A comparison and the files that it is of.
struct Report<'a> {
    args: &'a CompareArgs,
    comparison: Comparison,
    new: &'a Document,
}

/// Compares, prints, and with `--accept` replaces the reference; a finding is a regression.
pub fn compare(args: &CompareArgs) -> anyhow::Result<Verdict> {
    if let Some(note) = &args.accept {
        accept::check_note(note)?;
    }
    let reference = Document::read(&args.reference)?;
    let new = Document::read(&args.new)?;
    let options = Options {
        // What is new may become part of the reference; what is missing is refused below.
        subset: args.subset || args.accept.is_some(),
        tolerances: tolerances(args),
        show_times: args.times == Times::Shown,
    };
    let both = || format!("{} and {}", args.reference.display(), args.new.display());
    let report = Report {
        args,
        comparison: compare::compare(&reference, &new, &options).with_context(both)?,
        new: &new,
    };
    if args.accept.is_some() {
        accept::check_cells(&report)?;
    }
    text::print(&match args.format {
        CompareFormat::Table => table::table(&report),
        CompareFormat::Markdown => markdown::markdown(&report),
        CompareFormat::Json => serde_json::to_string_pretty(&report.comparison)? + "\n",
        CompareFormat::Junit => junit::junit(&report)?,
        CompareFormat::Bencher => bencher::bencher(&new)?,
    })?;
    if let Some(note) = &args.accept {
        accept::accept(&report, &reference, note)?;
        return Ok(Verdict::Good);
    }
    Ok(match report.comparison.grade {
        Grade::Regression => Verdict::Finding,
        _ => Verdict::Good,
    })
}

fn tolerances(args: &CompareArgs) -> Tolerances {
    let mut tolerances = Tolerances::default();
    for tolerance in &args.tolerance {
        match tolerance.counter.as_str() {
            "all" => tolerances.all = tolerance.share,
            name => {
                tolerances.of.insert(name.to_owned(), tolerance.share);
            }
        }
    }
    tolerances
}
