//! Hits and what the validation says of them.

use super::{Finding, Grade};
use crate::results::Cell;
use serde_json::Value;

/// Classes that depend on our hits alone.
const EXACT: [&str; 4] = ["ours_wrong", "both_wrong", "t_drift", "unexplained"];
/// Classes that depend on what Embree answers, too. Which rays are held against exact arithmetic
/// depends on it as well.
const BY_EMBREE: [&str; 5] = ["same", "tie", "edge", "reference_wrong", "differing"];

/// What is not the same. Classes that depend on Embree are judged if both files have the same one.
/// A class that one file does not know (`null`) is not judged.
pub(super) fn findings(a: &Cell, b: &Cell, same_embree: bool) -> Vec<Finding> {
    let mut findings = Vec::new();
    let hash = |cell: &Cell| Value::from(cell.hit_hash.as_str());
    let mut add = |what: &str, grade, a: &Value, b: &Value| {
        findings.extend(Finding::if_changed(what, grade, a, b))
    };
    add("hit_hash", Grade::Regression, &hash(a), &hash(b));
    let [diff_a, diff_b] = [a, b].map(|cell| serde_json::to_value(&cell.diff).unwrap_or_default());
    let embree = match same_embree {
        true => Grade::Regression,
        false => Grade::Changed,
    };
    for reference in ["embree_fast", "embree_robust", "exact"] {
        let as_many = diff_a[reference]["rays"] == diff_b[reference]["rays"];
        let by_embree = if as_many { embree } else { Grade::Changed };
        let exact = EXACT.iter().map(|class| (class, Grade::Regression));
        let others = BY_EMBREE.iter().map(|class| (class, by_embree));
        for (class, grade) in exact.chain(others) {
            let (a, b) = (&diff_a[reference][class], &diff_b[reference][class]);
            if !a.is_null() && !b.is_null() {
                add(&format!("diff.{reference}.{class}"), grade, a, b);
            }
        }
    }
    for what in ["not_judged", "unexplained"] {
        let (a, b) = (&diff_a[what], &diff_b[what]);
        if !a.is_null() && !b.is_null() {
            add(&format!("diff.{what}"), Grade::Regression, a, b);
        }
    }
    if let (Some(a), Some(b)) = (a.printed_rule_wrong, b.printed_rule_wrong) {
        add(
            "printed_rule_wrong",
            Grade::Regression,
            &a.into(),
            &b.into(),
        );
    }
    // No times: hits that are wrong, or that were once others than those that had been checked.
    let has_times = |cell: &Cell| Value::from(cell.samples_ms.is_some());
    let grade = match b.samples_ms {
        Some(_) => Grade::Improvement,
        None => Grade::Regression,
    };
    add("has_times", grade, &has_times(a), &has_times(b));
    findings
}
