//! Where each file comes from: machine, software, command, and the parameters that all of its cells have.

use super::Section;
use super::file::File;
use super::words::distinct;
use crate::cli::knobs::plain;
use dacrt_validate::machine::{Machine, Software};
use dacrt_validate::results::Cell;
use maud::{Markup, html};

/// More files than these are folded.
const UNFOLDED: usize = 3;

/// All files.
pub fn section(files: &[File]) -> Section {
    let body = html! { @for file in files { (of(file, files.len() <= UNFOLDED)) } };
    Section {
        id: "files",
        title: "Files",
        body,
    }
}

fn of(file: &File, is_open: bool) -> Markup {
    let (software, command) = file.origin();
    let parameters = constant_parameters(file.cells());
    html! {
        details open[is_open] {
            summary { (file.name) " (" (file.kind()) ")" }
            pre { (command.join(" ")) }
            @for (part, machine) in file.machines() {
                p { @if let Some(part) = part { (part) ": " } (machine_in_words(machine)) }
            }
            p { (software_in_words(software)) }
            @if let Some((threads, seed)) = file.threads_and_seed() {
                p { "Threads of best and of Embree: " (threads) ". Seed: " (seed) "." }
            }
            @if let Some(document) = file.results() {
                @if !document.pieces.is_empty() {
                    p { "Merged of:" }
                    @for piece in &document.pieces {
                        pre { (piece.command.join(" ")) }
                        p { (piece.cells) " cells; " (machine_in_words(&piece.machine)) }
                    }
                }
                @for accepted in &document.accepted { p { "Accepted: " (accepted.note) } }
            }
            @if !parameters.is_empty() {
                details {
                    summary { "parameters that all cells of a method have" }
                    dl { @for (method, values) in parameters { dt { (method) } dd { (values) } } }
                }
            }
        }
    }
}

fn machine_in_words(machine: &Machine) -> String {
    let gib = machine.memory_bytes as f64 / f64::from(1 << 30);
    let [one, five, fifteen] = machine.load;
    format!(
        "{}, {}, {} hardware threads, {gib:.0} GiB; load at the start {one:.2} {five:.2} {fifteen:.2}.",
        machine.cpu, machine.isa, machine.cores
    )
}

fn software_in_words(software: &Software) -> String {
    let commit = software.commit.as_deref().unwrap_or("unknown");
    let dirty = match software.dirty {
        Some(true) => " with changes",
        _ => "",
    };
    let embree = software
        .embree
        .as_ref()
        .map_or("no Embree".to_owned(), |embree| {
            format!(
                "Embree {} ({}, {})",
                embree.version, embree.isa, embree.library
            )
        });
    format!("Commit {commit}{dirty}; {}; {embree}.", software.rustc)
}

/// For each method those parameters that have one value, as text.
fn constant_parameters(cells: &[Cell]) -> Vec<(&str, String)> {
    let methods = distinct(cells.iter().map(|cell| cell.key.method.as_str()));
    let of_method = |method| {
        let keys = || {
            cells
                .iter()
                .map(|cell| &cell.key)
                .filter(|key| key.method == method)
        };
        let first = keys().next()?;
        let same = first
            .choices()
            .filter(|&(name, value)| keys().all(|key| key.parameters.get(name) == Some(value)));
        let values = same.map(|(name, value)| format!("{name}={}", plain(value)));
        Some((method, values.collect::<Vec<_>>().join(" ")))
    };
    let all = methods.into_iter().filter_map(of_method);
    all.filter(|(_, values)| !values.is_empty()).collect()
}
