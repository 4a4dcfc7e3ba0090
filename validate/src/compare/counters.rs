//! Counters: more work is worse.

use super::{Finding, Grade};
use crate::results::{Cell, Document};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Counters of which more is not worse.
const NO_COST: [&str; 4] = ["leaves", "skips_near", "skips_far", "terminated_rays"];

/// How much more of a counter is no regression, as a share of it.
#[derive(Clone, Debug, Default)]
pub struct Tolerances {
    /// For counters that have none of their own.
    pub all: f64,
    /// By the name of the counter.
    pub of: BTreeMap<String, f64>,
}

impl Tolerances {
    fn get(&self, counter: &str) -> f64 {
        self.of.get(counter).copied().unwrap_or(self.all)
    }

    /// A counter that has a tolerance and that no cell of these has, and those that there are.
    pub(super) fn unknown(&self, documents: [&Document; 2]) -> Option<(String, Vec<String>)> {
        let cells = documents.into_iter().flat_map(|d| &d.cells);
        let known: BTreeSet<&String> = cells.flat_map(|cell| cell.counters.keys()).collect();
        let unknown = self.of.keys().find(|name| !known.contains(name))?;
        Some((unknown.clone(), known.into_iter().cloned().collect()))
    }
}

/// What is not the same; no change at all ([`Grade::Same`]) if counters are not judged.
pub(super) fn findings(a: &Cell, b: &Cell, tolerances: &Tolerances, judged: bool) -> Vec<Finding> {
    let names: BTreeSet<&String> = a.counters.keys().chain(b.counters.keys()).collect();
    let grade = |name: &str, a: &Value, b: &Value| {
        let (Some(a), Some(b)) = (a.as_u64(), b.as_u64()) else {
            return Grade::Changed;
        };
        if !judged {
            Grade::Same
        } else if NO_COST.contains(&name) {
            Grade::Changed
        } else if b < a {
            Grade::Improvement
        } else if (b - a) as f64 > tolerances.get(name) * a as f64 {
            Grade::Regression
        } else {
            Grade::Changed
        }
    };
    names
        .into_iter()
        .filter_map(|name| {
            let [a, b] = [a, b].map(|cell| cell.counters.get(name).unwrap_or(&Value::Null));
            Finding::if_changed(&format!("counters.{name}"), grade(name, a, b), a, b)
        })
        .collect()
}
