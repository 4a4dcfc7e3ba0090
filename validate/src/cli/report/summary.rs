//! What a reader has to know first: wrong hits, then lost cells, then how often each file won.

use super::Section;
use super::file::File;
use super::words::{acceleration, batch_name, embree_total, embree_trace, ratio, table};
use crate::cli::text::{counted, thousands};
use dacrt_validate::claims::Verdict;
use dacrt_validate::results::Cell;
use dacrt_validate::statistics::{Ratio, geometric_mean};
use maud::{Markup, html};

/// Lost cells that are shown at once; more are folded.
const SHOWN: usize = 12;

/// A cell and a ratio of it that decides something.
struct Contest<'a> {
    file: &'a File,
    cell: &'a Cell,
    ratio: Ratio,
}

impl Contest<'_> {
    /// The whole interval is below 1. Of one repeat there is no interval.
    fn is_lost(&self) -> bool {
        let [low, high] = self.ratio.interval;
        low < high && high < 1.0
    }

    /// The whole interval is above 1.
    fn is_won(&self) -> bool {
        let [low, high] = self.ratio.interval;
        low < high && low > 1.0
    }
}

/// A question that a file answers batch by batch.
struct Question {
    title: &'static str,
    contests: for<'a> fn(&'a File) -> Vec<Contest<'a>>,
}

const QUESTIONS: [Question; 3] = [
    Question {
        title: "our fastest against Embree, its build included",
        contests: |file| fastest(file, embree_total),
    },
    Question {
        title: "our fastest against Embree's trace alone",
        contests: |file| fastest(file, embree_trace),
    },
    Question {
        title: "nabata2013 against afra2012",
        contests: sampling,
    },
];

/// Wrong hits, lost cells, and the score of each file.
pub fn section(files: &[File]) -> Option<Section> {
    let scored: Vec<&File> = files
        .iter()
        .filter(|file| !file.cells().is_empty())
        .collect();
    let body = html! {
        @if !scored.is_empty() { (wrong(&scored)) (lost(&scored)) (scores(&scored)) }
        @for file in files { (verdicts(file)) (hard_findings(file)) }
    };
    Some(Section {
        id: "summary",
        title: "Summary",
        body,
    })
}

/// Cells with wrong hits, or that there is none.
fn wrong(files: &[&File]) -> Markup {
    let all = files
        .iter()
        .flat_map(|file| file.cells().iter().map(move |cell| (*file, cell)));
    let rays: u64 = all.clone().map(|(_, cell)| cell.ray_count as u64).sum();
    let wrong: Vec<(&File, &Cell)> = all.clone().filter(|(_, cell)| is_wrong(cell)).collect();
    let rows: Vec<Vec<Markup>> = (wrong.iter())
        .map(|(file, cell)| {
            let batch = html! { (batch_name(file, &cell.key)) };
            let rays = html! { (thousands(cell.diff.wrong())) };
            let who = html! { (cell.key.method) " " (cell.key.precision) };
            vec![batch, who, rays, html! { (file.name) }]
        })
        .collect();
    html! {
        @if wrong.is_empty() {
            p.good { "No wrong hit in " (counted(all.count() as u64, "cell")) " (" (counted(rays, "ray")) ")." }
        } @else {
            p.bad { "Wrong hits in " (counted(wrong.len() as u64, "cell")) ":" }
            (table(&["batch", "method", "wrong rays", "file"], &[2], &rows))
        }
    }
}

/// Whether hits of a cell are wrong.
pub fn is_wrong(cell: &Cell) -> bool {
    cell.is_wrong() || cell.diff.wrong() > 0
}

/// The lost cells of each question but that of the trace alone, the worst first.
fn lost(files: &[&File]) -> Markup {
    let of = |question: &Question| {
        let all = files.iter().flat_map(|file| (question.contests)(file));
        let mut lost: Vec<Contest> = all.filter(Contest::is_lost).collect();
        lost.sort_by(|a, b| a.ratio.ratio.total_cmp(&b.ratio.ratio));
        lost
    };
    let [total, _, sampling] = &QUESTIONS;
    html! {
        @for question in [total, sampling] {
            @let lost = of(question);
            @if !lost.is_empty() {
                h3 { "Lost: " (question.title) }
                p { (counted(lost.len() as u64, "cell")) " with the whole 95 % interval of the ratio below 1, the worst first." }
                @let (first, rest) = lost.split_at(lost.len().min(SHOWN));
                (losses(first))
                @if !rest.is_empty() {
                    details { summary { (rest.len()) " more" } (losses(rest)) }
                }
            }
        }
    }
}

fn losses(lost: &[Contest]) -> Markup {
    let row = |contest: &Contest| {
        let key = &contest.cell.key;
        let who = match key.precision.as_str() {
            "fast" => key.method.clone(),
            precision => format!("{} {precision}", key.method),
        };
        [
            batch_name(contest.file, key),
            who,
            ratio(contest.ratio),
            contest.file.name.clone(),
        ]
        .map(|text| html! { (text) })
        .to_vec()
    };
    let rows: Vec<Vec<Markup>> = lost.iter().map(row).collect();
    table(
        &["batch", "method", "times as fast [95 %]", "file"],
        &[2],
        &rows,
    )
}

/// How often each file lost, was even and won.
fn scores(files: &[&File]) -> Markup {
    let score = |contests: Vec<Contest>| {
        let ratios: Vec<f64> = contests.iter().map(|c| c.ratio.ratio).collect();
        let lost = contests.iter().filter(|c| c.is_lost()).count();
        let won = contests.iter().filter(|c| c.is_won()).count();
        let even = contests.len() - lost - won;
        let mean = geometric_mean(&ratios);
        html! {
            @if let Some(mean) = mean {
                span.(if lost > 0 { "bad" } else { "even" }) { (lost) }
                " / " (even) " / " span.good { (won) } " · " b { (format!("{mean:.2}")) }
            } @else { "–" }
        }
    };
    let row = |file: &&File| {
        let wrong = file.cells().iter().filter(|cell| is_wrong(cell)).count();
        let mut row = vec![
            html! { (file.name) },
            html! { (thousands(file.cells().len() as u64)) },
            html! { span.(if wrong > 0 { "bad" } else { "good" }) { (wrong) } },
        ];
        row.extend(
            QUESTIONS
                .iter()
                .map(|question| score((question.contests)(file))),
        );
        row
    };
    let rows: Vec<Vec<Markup>> = files.iter().map(row).collect();
    let heads = [
        "file",
        "cells",
        "wrong",
        "Embree with its build",
        "Embree's trace",
        "ray sampling",
    ];
    html! {
        h3 { "Each file" }
        p {
            "Lost / even / won · geometric mean of the ratios, above 1 where we are faster. Even: the 95 % \
             interval has 1 in it, or there is but one repeat. To Embree: our fastest of each batch and \
             precision, which is the method and the parameters with the least median. Ray sampling: \
             nabata2013 to afra2012 with default parameters."
        }
        (table(&heads, &[1, 2, 3, 4, 5], &rows))
    }
}

/// Of each batch and precision the fastest of ours, where it has the ratio.
fn fastest<'a>(file: &'a File, ratio: fn(&Cell) -> Option<Ratio>) -> Vec<Contest<'a>> {
    let batches = file.cells().chunk_by(|a, b| a.key.batch() == b.key.batch());
    let fastest_of = |batch: &'a [Cell]| {
        let precisions = super::words::distinct(batch.iter().map(|cell| &cell.key.precision));
        precisions.into_iter().filter_map(move |precision| {
            let timed = batch.iter().filter(|cell| cell.key.precision == *precision);
            let timed = timed.filter_map(|cell| Some((cell.median_ms?, cell)));
            let (_, cell) = timed.min_by(|a, b| a.0.total_cmp(&b.0))?;
            Some(Contest {
                file,
                cell,
                ratio: ratio(cell)?,
            })
        })
    };
    batches.flat_map(fastest_of).collect()
}

/// Ray sampling as the paper has it, against the baseline.
fn sampling(file: &File) -> Vec<Contest<'_>> {
    let cells = file.cells().iter();
    let cells = cells.filter(|cell| cell.key.method == "nabata2013" && cell.key.is_preset());
    let contest = |cell| {
        let ratio = acceleration(cell)?;
        Some(Contest { file, cell, ratio })
    };
    cells.filter_map(contest).collect()
}

/// How many claims came out how.
fn verdicts(file: &File) -> Markup {
    let super::file::Content::Claims(document) = &file.content else {
        return html! {};
    };
    let all = [
        Verdict::Contradicted,
        Verdict::Undecided,
        Verdict::NotTestable,
        Verdict::Supported,
    ];
    let count = |verdict: Verdict| {
        document
            .findings
            .iter()
            .filter(|f| f.verdict == verdict)
            .count()
    };
    html! {
        p {
            a href="#claims" { "Claims" } " of the papers: "
            @for (i, verdict) in all.into_iter().filter(|v| count(*v) > 0).enumerate() {
                @if i > 0 { ", " }
                (count(verdict)) " " (verdict.name())
            }
            " (" (file.name) ")."
        }
    }
}

/// Findings among the hard cases.
fn hard_findings(file: &File) -> Markup {
    let super::file::Content::Hard(document) = &file.content else {
        return html! {};
    };
    let findings: u64 = (document.families.iter())
        .flat_map(|family| &family.findings)
        .map(|found| found.rays)
        .sum();
    html! {
        p.(if findings > 0 { "bad" } else { "good" }) {
            a href="#hard" { "Hard cases" } ": " (counted(findings, "finding")) " in "
            (counted(document.families.len() as u64, "family").replace("familys", "families"))
            " (" (file.name) ")."
        }
    }
}
