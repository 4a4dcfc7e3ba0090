//! A result in Bencher's metric format: ratios and counters by cell, no milliseconds.

use dacrt_validate::compare::{Against, Names, ratios};
use dacrt_validate::results::Document;
use serde::Serialize;
use std::collections::BTreeMap;

/// One figure, and between what it may lie.
#[derive(Serialize)]
struct Metric {
    value: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    lower_value: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    upper_value: Option<f64>,
}

/// The ratios and counters of every cell.
pub fn bencher(document: &Document) -> anyhow::Result<String> {
    let names = Names::of(&[document]);
    let mut cells: BTreeMap<String, BTreeMap<String, Metric>> = BTreeMap::new();
    for cell in &document.cells {
        let metrics = cells.entry(names.name(&cell.key)).or_default();
        for ratio in ratios(document, cell) {
            let name = match ratio.against {
                Against::Afra2012 => "acceleration_ratio",
                Against::EmbreeTotal => "embree_total_ratio",
                Against::EmbreeTrace => "embree_trace_ratio",
                Against::Cell(_) => continue,
            };
            let interval = ratio.interval();
            let metric = Metric {
                value: ratio.value,
                lower_value: interval.map(|[low, _]| low),
                upper_value: interval.map(|[_, high]| high),
            };
            metrics.insert(name.to_owned(), metric);
        }
        for (name, value) in &cell.counters {
            let metric = value.as_f64().map(|value| Metric {
                value,
                lower_value: None,
                upper_value: None,
            });
            metrics.extend(metric.map(|metric| (name.clone(), metric)));
        }
    }
    Ok(serde_json::to_string_pretty(&cells)? + "\n")
}
