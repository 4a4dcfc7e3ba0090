//! The papers' claims one by one: what is measured of each, what would falsify it, and what came of it.
//!
//! `claims.json`, beside this package's manifest, has all that was fixed before the runs: the claims with
//! their limits, and the studies that they need. [`verdicts()`] judges what was measured.

mod evidence;
mod mora;
mod nabata;
mod pool;
mod study;
mod values;

pub use evidence::{Evidence, MemoryUse, NodeStatistics, list, write_list};
pub use study::{Kind, Study, Variants};

use crate::estimate::{Estimate, grouped};
use crate::json_file;
use crate::machine::{Machine, Software};
use crate::results;
use anyhow::ensure;
use pool::Pool;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::Path;

/// What [`Document::kind`] says. There is no `schema`, so no command takes the file for the
/// [results] of a run.
pub const KIND: &str = "claims";

/// All claims, and the studies that they need, by name.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claims {
    /// What is measured; claims share studies.
    pub studies: BTreeMap<String, Study>,
    /// In the order of the papers.
    pub claims: Vec<Claim>,
}

/// A sentence of a paper that can be tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// C1, C2, ...
    pub id: String,
    /// `nabata2013` or `mora2011`.
    pub paper: String,
    /// Section or figure.
    pub place: String,
    /// What it says.
    pub claim: String,
    /// What is measured of it.
    pub measure: String,
    /// Of the measure, what would falsify the claim.
    pub falsified_if: String,
    /// The numbers in that.
    pub limits: BTreeMap<String, f64>,
    /// Names of the studies that it needs.
    pub studies: Vec<String>,
}

/// What came of a claim, in the order in which they are told: what speaks against the papers first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Verdict {
    /// The whole 95 % interval is where the claim is falsified.
    #[serde(rename = "contradicted")]
    Contradicted,
    /// The interval is on both sides of the limit.
    #[serde(rename = "undecided")]
    Undecided,
    /// What it needs was not measured.
    #[serde(rename = "not testable")]
    NotTestable,
    /// The whole interval is where the claim holds.
    #[serde(rename = "supported")]
    Supported,
}

impl Verdict {
    /// As people read it.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Contradicted => "contradicted",
            Verdict::Undecided => "undecided",
            Verdict::NotTestable => "not testable",
            Verdict::Supported => "supported",
        }
    }
}

/// A number that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Effect {
    /// What it is.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its 95 % bootstrap interval, or the 5 to 95 % range where the claim is about one; `None` of a count.
    pub interval: Option<[f64; 2]>,
}

impl Effect {
    fn new(name: impl Into<String>, estimate: Estimate) -> Effect {
        Effect {
            name: name.into(),
            value: estimate.value,
            interval: Some(estimate.interval),
        }
    }

    fn count(name: impl Into<String>, value: f64) -> Effect {
        Effect {
            name: name.into(),
            value,
            interval: None,
        }
    }
}

/// A claim and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// The claim.
    #[serde(flatten)]
    pub claim: Claim,
    /// What came of it.
    pub verdict: Verdict,
    /// The number that decides; `None` if it is not testable.
    pub effect: Option<Effect>,
    /// What it is made of, or what else there is to know: by scene, by bounce, by value of a parameter.
    pub parts: Vec<Effect>,
    /// Different cameras, over all scenes.
    pub cameras: usize,
    /// Different seeds.
    pub seeds: usize,
    /// Least number of repeats of a time; 0 where only tests were counted.
    pub repeats: usize,
    /// Batches of rays.
    pub batches: usize,
    /// Why it is not testable, or how large the pictures were; may be empty.
    pub why: String,
}

/// What a claim's rule has found.
struct Found {
    verdict: Verdict,
    effect: Option<Effect>,
    parts: Vec<Effect>,
    why: String,
}

impl Found {
    fn not_testable(why: &str) -> Found {
        Found {
            verdict: Verdict::NotTestable,
            effect: None,
            parts: Vec::new(),
            why: why.to_owned(),
        }
    }
}

/// What an interval says of a claim that is falsified above a limit.
fn falsified_above(estimate: &Estimate, limit: f64) -> Verdict {
    let [low, high] = estimate.interval;
    match () {
        _ if low > limit => Verdict::Contradicted,
        _ if high <= limit => Verdict::Supported,
        _ => Verdict::Undecided,
    }
}

/// Likewise of one that is falsified below it.
fn falsified_below(estimate: &Estimate, limit: f64) -> Verdict {
    let [low, high] = estimate.interval;
    match () {
        _ if high < limit => Verdict::Contradicted,
        _ if low >= limit => Verdict::Supported,
        _ => Verdict::Undecided,
    }
}

/// Falsified where a quotient is further from 1 than this, either way.
fn apart(quotient: &Estimate, difference: f64) -> Verdict {
    let limits = [1.0 / (1.0 + difference), 1.0 + difference];
    let [low, high] = quotient.interval;
    match () {
        _ if low > limits[1] || high < limits[0] => Verdict::Contradicted,
        _ if low >= limits[0] && high <= limits[1] => Verdict::Supported,
        _ => Verdict::Undecided,
    }
}

/// A machine and what it measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeedsOn {
    /// As it was at the first of them.
    pub machine: Machine,
    /// Their seeds.
    pub seeds: BTreeSet<u64>,
}

impl SeedsOn {
    /// Each machine that the evidence names; those with the same processor and instruction set are one.
    pub fn of(evidence: &Evidence) -> Vec<SeedsOn> {
        let kind = |document: &results::Document| {
            let Machine { cpu, isa, .. } = &document.machine;
            (cpu.clone(), isa.clone())
        };
        let seeds_on = |documents: &Vec<&results::Document>| SeedsOn {
            machine: documents[0].machine.clone(),
            seeds: documents.iter().map(|document| document.seed).collect(),
        };
        let machines = grouped(evidence.documents.iter(), kind);
        machines.iter().map(seeds_on).collect()
    }

    /// `seeds 1, 2, 3`
    pub fn seeds_in_words(&self) -> String {
        let seeds: Vec<String> = self.seeds.iter().map(u64::to_string).collect();
        let s = if seeds.len() == 1 { "" } else { "s" };
        format!("seed{s} {}", seeds.join(", "))
    }
}

/// The verdicts of one evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// [`KIND`].
    pub kind: String,
    /// Where it was measured: each machine with its seeds, that of the first seed first.
    pub machines: Vec<SeedsOn>,
    /// What measured the first seed.
    pub software: Software,
    /// The command line, one string an argument.
    pub command: Vec<String>,
    /// Contradicted claims first.
    pub findings: Vec<Finding>,
}

impl Document {
    /// Writes it as JSON, whole or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        json_file::write(path, self)
    }
}

impl Claims {
    /// Those of this repository, or those of them that are asked for by id.
    ///
    /// # Errors
    /// If an id is unknown.
    ///
    /// # Panics
    /// If `claims.json` is damaged, which a test rules out.
    pub fn load(only: Option<&[String]>) -> anyhow::Result<Claims> {
        let text = include_str!("../../claims.json");
        let mut all: Claims = serde_json::from_str(text).expect("claims.json as it was tested");
        let Some(only) = only else {
            return Ok(all);
        };
        let known: Vec<&str> = all.claims.iter().map(|claim| claim.id.as_str()).collect();
        for id in only {
            let text = || dacrt::scene::no_such("claim", id, &known);
            ensure!(known.contains(&id.as_str()), "--only: {}", text());
        }
        all.claims.retain(|claim| only.contains(&claim.id));
        let claims = all.claims.iter();
        let needed: BTreeSet<String> = claims.flat_map(|c| c.studies.iter().cloned()).collect();
        all.studies.retain(|name, _| needed.contains(name));
        Ok(all)
    }
}

/// Judges each claim by the evidence; contradicted ones first, else in the order of the papers.
pub fn verdicts(claims: &Claims, evidence: &Evidence) -> Vec<Finding> {
    let mut findings: Vec<Finding> = (claims.claims.iter())
        .map(|claim| {
            let pool = Pool::new(claims, claim, evidence);
            let found = rule(&claim.id)(claim, &pool);
            let extent = pool.extent();
            Finding {
                claim: claim.clone(),
                verdict: found.verdict,
                effect: found.effect,
                parts: found.parts,
                cameras: extent.cameras,
                seeds: extent.seeds,
                repeats: extent.repeats,
                batches: extent.batches,
                why: found.why,
            }
        })
        .collect();
    findings.sort_by_key(|finding| finding.verdict);
    findings
}

type Rule = fn(&Claim, &Pool) -> Found;

fn rule(id: &str) -> Rule {
    match id {
        "C1" => nabata::small_loss,
        "C2" => nabata::overhead,
        "C3" => nabata::construction,
        "C4" => nabata::reuse,
        "C5" => nabata::order_by_bounce,
        "C6" => nabata::area_by_bounce,
        "C7" => nabata::best_skip,
        "C8" => nabata::leaf_criterion,
        "C9" => nabata::printed_values,
        "C10" => nabata::every_bounce,
        "C11" => nabata::up_to_two,
        "C12" => nabata::samples_as_pixels,
        "C13" => mora::estimate_of_split,
        "C14" => mora::limits,
        "C15" => mora::tests_a_ray,
        "C16" => mora::stored_twin,
        "C17" => mora::triangle_tests,
        "C18" => mora::point_light,
        "C19" => mora::stored_tree,
        "C22" => mora::memory,
        "C23" => mora::octants,
        _ => |_, _| Found::not_testable("there is no rule for it"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(interval: [f64; 2]) -> Estimate {
        Estimate {
            value: 1.0,
            interval,
        }
    }

    #[test]
    fn every_claim_has_a_rule_and_every_study_a_claim() {
        let all = Claims::load(None).unwrap();
        let ids: Vec<&str> = all.claims.iter().map(|c| c.id.as_str()).collect();
        let mut expected: Vec<String> = (1..=19).map(|n| format!("C{n}")).collect();
        expected.extend(["C22", "C23"].map(str::to_owned));
        assert_eq!(ids, expected);
        let nothing = Evidence::default();
        for finding in verdicts(&all, &nothing) {
            assert_eq!(
                finding.verdict,
                Verdict::NotTestable,
                "{}",
                finding.claim.id
            );
            assert_ne!(
                finding.why, "there is no rule for it",
                "{}",
                finding.claim.id
            );
        }
        for claim in &all.claims {
            for study in &claim.studies {
                assert!(all.studies.contains_key(study), "{}: {study}", claim.id);
            }
        }
        for name in all.studies.keys() {
            assert!(
                all.claims.iter().any(|claim| claim.studies.contains(name)),
                "nobody needs {name}"
            );
        }
    }

    #[test]
    fn an_interval_on_both_sides_of_a_limit_decides_nothing() {
        assert_eq!(falsified_above(&of([1.1, 1.2]), 1.0), Verdict::Contradicted);
        assert_eq!(falsified_above(&of([0.9, 1.2]), 1.0), Verdict::Undecided);
        assert_eq!(falsified_above(&of([0.9, 1.0]), 1.0), Verdict::Supported);
        assert_eq!(falsified_below(&of([1.1, 1.2]), 1.0), Verdict::Supported);
        assert_eq!(falsified_below(&of([0.8, 0.9]), 1.0), Verdict::Contradicted);
    }

    #[test]
    fn a_quotient_is_apart_either_way() {
        assert_eq!(apart(&of([1.06, 1.1]), 0.05), Verdict::Contradicted);
        assert_eq!(apart(&of([0.8, 0.9]), 0.05), Verdict::Contradicted);
        assert_eq!(apart(&of([0.97, 1.03]), 0.05), Verdict::Supported);
        assert_eq!(apart(&of([0.9, 1.03]), 0.05), Verdict::Undecided);
    }

    #[test]
    fn only_the_studies_of_the_claims_asked_for() {
        let one = Claims::load(Some(&["C13".to_owned()])).unwrap();
        assert_eq!(one.claims.len(), 1);
        assert_eq!(
            one.studies.keys().collect::<Vec<_>>(),
            one.claims[0].studies.iter().collect::<Vec<_>>()
        );
        let error = Claims::load(Some(&["C99".to_owned()])).unwrap_err();
        assert!(error.to_string().contains("C99"), "{error}");
    }
}
