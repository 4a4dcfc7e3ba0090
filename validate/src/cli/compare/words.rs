//! What was found, in words.

use crate::cli::text::{counted, thousands};
use dacrt_validate::compare::{
    CellComparison, Comparison, Finding, Grade, Origin, Quotient, Speed,
};
use serde_json::Value;

/// A finding: what, before, after, and how much that is.
pub type Row = [String; 4];

/// The rows of a cell: findings, and the times if they are slower or faster.
pub fn rows(cell: &CellComparison) -> Vec<Row> {
    let findings = cell.findings.iter().map(finding);
    let conspicuous = cell.speed.iter().filter(|speed| speed.grade != Grade::Same);
    findings.chain(conspicuous.flat_map(speed)).collect()
}

/// The same as lines with the name of the cell.
pub fn lines(cell: &CellComparison) -> Vec<String> {
    let line = |[what, before, after, change]: Row| {
        format!("{}: {what} {before} -> {after} {change}", cell.name)
            .trim_end()
            .to_owned()
    };
    rows(cell).into_iter().map(line).collect()
}

fn finding(finding: &Finding) -> Row {
    let change = match (finding.reference.as_u64(), finding.new.as_u64()) {
        (Some(a), Some(b)) if a > 0 => share((b as f64 - a as f64) / a as f64),
        _ => String::new(),
    };
    [
        finding.what.clone(),
        value(&finding.reference),
        value(&finding.new),
        graded(change, finding.grade),
    ]
}

/// How much something has changed, and whether that is for better or worse.
fn graded(change: String, grade: Grade) -> String {
    let grade = match grade {
        Grade::Regression => "REGRESSION",
        Grade::Improvement => "better",
        Grade::Changed | Grade::Same => "",
    };
    format!("{change} {grade}").trim().to_owned()
}

fn speed(speed: &Speed) -> Vec<Row> {
    let quotients = speed.quotients.iter();
    quotients
        .map(|q| {
            [
                format!("speed / {}", q.against),
                figure(q.reference),
                figure(q.new),
                graded(quotient(q), speed.grade),
            ]
        })
        .collect()
}

/// `x 0.77 [0.75, 0.79]`.
fn quotient(q: &Quotient) -> String {
    let interval = q.interval.map_or(String::new(), |[low, high]| {
        format!(" [{}, {}]", figure(low), figure(high))
    });
    format!("x {}{interval}", figure(q.quotient))
}

fn value(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        // The beginning of a hash tells it from others.
        Value::String(text) if text.len() > 12 => text.chars().take(12).chain(['…']).collect(),
        Value::String(text) => text.clone(),
        value => value.as_u64().map_or(value.to_string(), thousands),
    }
}

/// Three digits that count.
fn figure(x: f64) -> String {
    match x.abs() {
        x if x < 0.1 => format!("{x:.4}"),
        x if x < 1.0 => format!("{x:.3}"),
        x if x < 100.0 => format!("{x:.2}"),
        _ => format!("{x:.0}"),
    }
}

/// `+0.10 %`.
fn share(x: f64) -> String {
    let percent = 100.0 * x;
    match percent.abs() {
        p if p < 0.01 => format!("{percent:+.0e} %"),
        p if p < 10.0 => format!("{percent:+.2} %"),
        _ => format!("{percent:+.0} %"),
    }
}

/// `18 cells: 17 same, 1 regression`.
pub fn counts(comparison: &Comparison) -> String {
    let grades = [
        (Grade::Same, "same", "same"),
        (Grade::Changed, "changed", "changed"),
        (Grade::Improvement, "improvement", "improvements"),
        (Grade::Regression, "regression", "regressions"),
    ];
    let mut parts: Vec<String> = (grades.into_iter())
        .map(|(grade, one, many)| (comparison.count(grade), one, many))
        .filter(|(n, ..)| *n > 0)
        .map(|(n, one, many)| format!("{n} {}", if n == 1 { one } else { many }))
        .collect();
    let others = [
        (&comparison.only_in_reference, "reference"),
        (&comparison.only_in_new, "new file"),
    ];
    for (names, file) in others.into_iter().filter(|(names, _)| !names.is_empty()) {
        parts.push(format!("{} more only in the {file}", names.len()));
    }
    let cells = counted(comparison.cells.len() as u64, "cell");
    format!("{cells}: {}", parts.join(", "))
}

/// What was not judged, and why.
pub fn not_judged(comparison: &Comparison) -> Vec<String> {
    let reasons = [
        (
            "Counters of some cells are",
            &comparison.counters_not_judged,
        ),
        ("Times are", &comparison.times_not_judged),
        ("What depends on Embree is", &comparison.embree_not_judged),
    ];
    let known = reasons
        .into_iter()
        .filter_map(|(what, why)| Some((what, why.as_ref()?)));
    known
        .map(|(what, why)| format!("{what} shown and not judged: {why}."))
        .collect()
}

/// Commit, processor, instruction sets.
pub fn origin(origin: &Origin) -> String {
    let commit = match &origin.commit {
        Some(commit) => format!("commit {}", commit.chars().take(12).collect::<String>()),
        None => "commit unknown".to_owned(),
    };
    let dirty = match origin.dirty {
        Some(true) => " and changes",
        _ => "",
    };
    let embree = origin.embree.as_ref();
    let embree = embree.map_or("no Embree".to_owned(), |e| format!("Embree {e}"));
    format!("{commit}{dirty}, {}, {}, {embree}", origin.cpu, origin.isa)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_readable() {
        let text = [1.0, 0.05, 1e-3, -0.5, 1e-7].map(share);
        assert_eq!(text, ["+100 %", "+5.00 %", "+0.10 %", "-50 %", "+1e-5 %"]);
    }

    #[test]
    fn values_are_short() {
        let text = |v: Value| value(&v);
        assert_eq!(text(Value::Null), "none");
        assert_eq!(text(1_234_567u64.into()), "1,234,567");
        assert_eq!(text("0123456789abcdef".into()), "0123456789ab…");
        assert_eq!(text(true.into()), "true");
    }
}
