//! `--accept`: the new file becomes the reference.

use super::{Report, words};
use crate::cli::text;
use anyhow::ensure;
use dacrt_validate::results::{Acceptance, Document};

/// Refuses a note that says nothing.
pub fn check_note(note: &str) -> anyhow::Result<()> {
    ensure!(
        !note.trim().is_empty(),
        "--accept: expected a note that says why the change is right"
    );
    Ok(())
}

/// Refuses a new reference that lacks cells of the old one.
pub fn check_cells(report: &Report) -> anyhow::Result<()> {
    let missing = &report.comparison.only_in_reference;
    ensure!(
        missing.is_empty(),
        "--accept: {} lacks {} of {}, the first: {}; run them, too",
        report.args.new.display(),
        text::counted(missing.len() as u64, "cell"),
        report.args.reference.display(),
        missing[0]
    );
    Ok(())
}

/// Writes the new file to the place of the reference, with the history of that and a new entry.
pub fn accept(report: &Report, reference: &Document, note: &str) -> anyhow::Result<()> {
    let mut findings: Vec<String> = report
        .comparison
        .cells
        .iter()
        .flat_map(words::lines)
        .collect();
    let added = report.comparison.only_in_new.iter();
    findings.extend(added.map(|name| format!("{name}: new")));
    let count = text::counted(findings.len() as u64, "change");
    let mut document = report.new.clone();
    document.accepted = reference.accepted.clone();
    document.accepted.push(Acceptance {
        note: note.trim().to_owned(),
        from_commit: reference.software.commit.clone(),
        to_commit: document.software.commit.clone(),
        findings,
    });
    document.write(&report.args.reference)?;
    // On standard error, as a report that programs read may stand on standard output.
    text::complain(&format!(
        "accepted: {} now has the results of {} ({count}): {}",
        report.args.reference.display(),
        report.args.new.display(),
        note.trim()
    ));
    Ok(())
}
