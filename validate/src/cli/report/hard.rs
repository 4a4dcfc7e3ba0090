//! Hard cases: answers that are not the exact one, by family and contestant.

use super::Section;
use super::file::{Content, File};
use super::words::{distinct, table};
use crate::cli::text::{counted, thousands};
use dacrt_validate::hard::{Document, FamilyResult};
use maud::{Markup, html};

/// The counts of all files of `dacrt hard`.
pub fn section(files: &[File]) -> Option<Section> {
    let of = |file: &File| match &file.content {
        Content::Hard(document) => Some(families(document)),
        _ => None,
    };
    let parts: Vec<(&str, Markup)> = (files.iter())
        .filter_map(|file| Some((file.name.as_str(), of(file)?)))
        .collect();
    let introduction = html! {
        p {
            "Rays per million whose answer is not that of exact arithmetic (lost, false and wrong together); \
             in brackets those that no rounding within the proven bounds explains. Families with findings \
             come first."
        }
    };
    Section::by_file("hard", "Hard cases", introduction, parts)
}

fn families(document: &Document) -> Markup {
    let contestants = document
        .families
        .iter()
        .flat_map(|family| family.contestants.keys());
    let contestants: Vec<&String> = distinct(contestants);
    let found = |family: &FamilyResult| family.findings.iter().map(|f| f.rays).sum::<u64>();
    let mut families: Vec<&FamilyResult> = document.families.iter().collect();
    families.sort_by_key(|family| std::cmp::Reverse(found(family)));
    let entry = |family: &FamilyResult, contestant: &String| {
        let counts = family.contestants.get(contestant)?;
        let rate = |n: u64| thousands((n as f64 * 1e6 / family.rays.max(1) as f64).ceil() as u64);
        Some(match (counts.errors(), counts.beyond_bounds) {
            (0, _) => "0".to_owned(),
            (n, 0) => rate(n),
            (n, beyond) => format!("{} ({})", rate(n), rate(beyond)),
        })
    };
    let row = |family: &&FamilyResult| {
        let findings = family.findings.iter();
        let findings = findings.map(|f| format!("{} {}: {}", f.contestant, f.what.words(), f.rays));
        let findings: Vec<String> = findings.collect();
        let mut row = vec![
            html! { span title=(family.what) { (family.name) } },
            html! { (thousands(family.rays)) },
            html! { span.bad { (findings.join("; ")) } },
        ];
        let entries = contestants
            .iter()
            .map(|contestant| entry(family, contestant));
        row.extend(entries.map(|entry| html! { (entry.unwrap_or_default()) }));
        row
    };
    let rows: Vec<Vec<Markup>> = families.iter().map(row).collect();
    let names = contestants.iter().map(|name| name.as_str());
    let heads: Vec<&str> = ["family", "rays", "findings"]
        .into_iter()
        .chain(names)
        .collect();
    let right: Vec<usize> = [1].into_iter().chain(3..heads.len()).collect();
    html! {
        p { (counted(families.iter().map(|family| found(family)).sum(), "finding")) "." }
        (table(&heads, &right, &rows))
    }
}
