//! Verdicts for people, 100 columns at most.

use crate::cli::text::{WIDTH, columns, counted};
use dacrt_validate::claims::{Document, Effect, Finding, SeedsOn, Verdict};
use dacrt_validate::machine::Machine;

/// The verdicts, contradicted claims first; `parts`: all numbers, too.
pub fn text(document: &Document, parts: bool) -> String {
    let mut text = counts(&document.findings) + &measured_on(&document.machines);
    let mut last = None;
    for finding in &document.findings {
        if last != Some(finding.verdict) {
            text += &format!("\n{}\n", finding.verdict.name().to_uppercase());
            last = Some(finding.verdict);
        }
        text += &of(finding, parts);
    }
    text
}

/// `7 contradicted, 3 undecided, 1 not testable, 10 supported`
fn counts(findings: &[Finding]) -> String {
    let all = [
        Verdict::Contradicted,
        Verdict::Undecided,
        Verdict::NotTestable,
        Verdict::Supported,
    ];
    let count = |verdict: &Verdict| {
        let n = findings.iter().filter(|f| f.verdict == *verdict).count();
        (n > 0).then(|| format!("{n} {}", verdict.name()))
    };
    all.iter().filter_map(count).collect::<Vec<_>>().join(", ") + "\n"
}

/// `measured on AMD EPYC, avx512 (seeds 1, 2); AMD EPYC, avx2 (seed 3)`
fn measured_on(machines: &[SeedsOn]) -> String {
    let machine = |on: &SeedsOn| {
        let Machine { cpu, isa, .. } = &on.machine;
        format!("{cpu}, {isa} ({})", on.seeds_in_words())
    };
    let all: Vec<String> = machines.iter().map(machine).collect();
    match all.is_empty() {
        true => String::new(),
        false => textwrap::fill(&format!("measured on {}", all.join("; ")), WIDTH) + "\n",
    }
}

fn of(finding: &Finding, parts: bool) -> String {
    let claim = &finding.claim;
    let paper = match claim.paper.as_str() {
        "nabata2013" => "Nabata",
        _ => "Mora",
    };
    let mut text = wrapped(
        &format!("{:<4}", claim.id),
        &format!("{} ({paper}, {})", claim.claim, claim.place),
    );
    if let Some(effect) = &finding.effect {
        text += &wrapped("", &format!("{}: {}", effect.name, number(effect)));
    }
    text += &wrapped("", &format!("falsified if {}", claim.falsified_if));
    let extent = extent(finding);
    if !extent.is_empty() {
        text += &wrapped("", &extent);
    }
    if parts {
        let rows: Vec<Vec<String>> = (finding.parts.iter())
            .map(|part| vec![format!("       {}", part.name), number(part)])
            .collect();
        text += &columns(&rows, &[]);
    }
    text
}

/// How much was measured, and what else there is to say: `17 cameras, 10 seeds, 5 repeats, 40 batches`.
pub fn extent(finding: &Finding) -> String {
    let mut extent = Vec::new();
    if finding.batches > 0 {
        extent.push(counted(finding.cameras as u64, "camera"));
        extent.push(counted(finding.seeds as u64, "seed"));
        if finding.repeats > 0 {
            extent.push(counted(finding.repeats as u64, "repeat"));
        }
        extent.push(counted(finding.batches as u64, "batch").replace("batchs", "batches"));
    }
    if !finding.why.is_empty() {
        extent.push(finding.why.clone());
    }
    extent.join(", ")
}

/// `1.02 [0.98, 1.05]`
pub fn number(effect: &Effect) -> String {
    let short = |x: f64| match x {
        _ if x == x.trunc() && x.abs() >= 1.0 => format!("{x:.0}"),
        _ if x.abs() >= 100.0 => format!("{x:.0}"),
        _ if x.abs() >= 10.0 => format!("{x:.1}"),
        _ if x.abs() >= 0.1 => format!("{x:.3}"),
        _ => format!("{x:.4}"),
    };
    match effect.interval {
        Some([low, high]) => format!("{} [{}, {}]", short(effect.value), short(low), short(high)),
        None => short(effect.value),
    }
}

/// Text after a mark, later lines under its beginning.
fn wrapped(mark: &str, text: &str) -> String {
    let first = format!("  {mark:<5}");
    let indent = " ".repeat(first.len());
    let options = textwrap::Options::new(WIDTH)
        .initial_indent(&first)
        .subsequent_indent(&indent);
    textwrap::fill(text, options) + "\n"
}
