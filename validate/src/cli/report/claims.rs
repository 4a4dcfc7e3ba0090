//! The papers' claims with their verdicts, contradicted ones first.

use super::Section;
use super::file::{Content, File};
use super::words::text_table;
use crate::cli::claims::text::{extent, number};
use crate::cli::text::counted;
use dacrt_validate::claims::{Finding, Verdict};
use maud::{Markup, html};

/// The findings of all files of `dacrt claims`.
pub fn section(files: &[File]) -> Option<Section> {
    let of = |file: &File| match &file.content {
        Content::Claims(document) => Some(findings(&document.findings)),
        _ => None,
    };
    let parts: Vec<(&str, Markup)> = (files.iter())
        .filter_map(|file| Some((file.name.as_str(), of(file)?)))
        .collect();
    let introduction = html! {
        p {
            "Contradicted: the whole 95 % interval is where the claim is falsified; supported: none of it is; \
             undecided: some of it. Limits were fixed before the runs."
        }
    };
    Section::by_file("claims", "The papers' claims", introduction, parts)
}

fn findings(all: &[Finding]) -> Markup {
    let mut sorted: Vec<&Finding> = all.iter().collect();
    sorted.sort_by_key(|finding| finding.verdict);
    html! { @for finding in sorted { (of(finding)) } }
}

fn of(finding: &Finding) -> Markup {
    let claim = &finding.claim;
    let paper = match claim.paper.as_str() {
        "nabata2013" => "Nabata",
        _ => "Mora",
    };
    let class = match finding.verdict {
        Verdict::Contradicted => "bad",
        Verdict::Supported => "good",
        Verdict::Undecided | Verdict::NotTestable => "even",
    };
    let parts: Vec<Vec<String>> = (finding.parts.iter())
        .map(|part| vec![part.name.clone(), number(part)])
        .collect();
    html! {
        article.claim.(class) {
            p { span.verdict { (finding.verdict.name()) } " " b { (claim.id) } " " (claim.claim)
                " (" (paper) ", " (claim.place) ")" }
            @if let Some(effect) = &finding.effect { p { (effect.name) ": " b { (number(effect)) } } }
            p.small { "Falsified if " (claim.falsified_if) ". " (extent(finding)) }
            @if !parts.is_empty() {
                details { summary { (counted(parts.len() as u64, "number")) } (text_table(&["", ""], &[1], &parts)) }
            }
        }
    }
}
