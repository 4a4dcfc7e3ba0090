//! Other values of a parameter against the paper's, one at a time.

use super::pool::{Pool, preset};
use super::{Claim, Effect, Found, falsified_below};
use crate::estimate::{Estimate, View, estimate, geometric};
use dacrt::Method;
use serde_json::Value;

/// A value that the paper does not have.
pub struct OtherValue {
    /// The number; NaN if it is none.
    pub value: f64,
    /// Parameter and value.
    pub name: String,
    /// Times with it over those with the paper's.
    pub views: Vec<View>,
}

impl OtherValue {
    /// The mean of its times over the paper's.
    pub fn time(&self) -> Option<Estimate> {
        estimate(&self.views, geometric)
    }
}

/// The values of a parameter that the studies have.
pub fn other_values(pool: &Pool, method: Method, name: &str) -> Vec<OtherValue> {
    let lists = pool.studies.iter();
    let lists = lists.filter_map(|study| study.methods.get(method.name())?.get(name));
    let mut values: Vec<&Value> = lists.flatten().collect();
    values.dedup();
    let of = |value: &&Value| {
        let with = preset(method).with(name, (*value).clone());
        OtherValue {
            value: value.as_f64().unwrap_or(f64::NAN),
            name: format!("{name} {value}"),
            views: pool.times(&with, &preset(method)),
        }
    };
    values.iter().map(of).collect()
}

/// The mean time of each value that was measured.
pub fn effects(values: &[OtherValue]) -> Vec<Effect> {
    let effect = |other: &OtherValue| Some(Effect::new(other.name.clone(), other.time()?));
    values.iter().filter_map(effect).collect()
}

/// Time at the best other value of these parameters over that at the paper's.
pub fn best_other(claim: &Claim, pool: &Pool, method: Method, names: &[&str]) -> Found {
    let all: Vec<OtherValue> = (names.iter())
        .flat_map(|name| other_values(pool, method, name))
        .collect();
    let best = (all.iter())
        .filter_map(|other| Some((&other.name, other.time()?)))
        .min_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let Some((name, time)) = best else {
        return Found::not_testable("no other values");
    };
    Found {
        verdict: falsified_below(&time, 1.0 - claim.limits["gain"]),
        effect: Some(Effect::new(
            format!("time at {name} over the paper's"),
            time,
        )),
        parts: effects(&all),
        why: String::new(),
    }
}
