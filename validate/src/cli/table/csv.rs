//! A result as comma-separated values: a line a cell, a column a key.

use anyhow::Context;
use dacrt_validate::results::Document;
use serde_json::{Map, Value};

/// Keys of objects within objects are joined by dots; lists of numbers are joined by spaces, other
/// lists (offending rays) are given by their length. What a cell lacks is empty. `threads` is that of the
/// cell; that of the run is `embree.threads`.
pub fn text(document: &Document) -> anyhow::Result<String> {
    let mut about = Map::new();
    for (key, value) in [
        ("machine", serde_json::to_value(&document.machine)?),
        ("software", serde_json::to_value(&document.software)?),
        ("seed", document.seed.into()),
        ("embree.threads", document.threads.into()),
    ] {
        flatten(key, value, &mut about);
    }
    let mut rows = Vec::new();
    for cell in &document.cells {
        let mut row = Map::new();
        flatten("", serde_json::to_value(cell)?, &mut row);
        row.extend(about.clone());
        rows.push(row);
    }
    let mut heads: Vec<&String> = rows.iter().flat_map(Map::keys).collect();
    heads.sort_by_key(|head| (rank(head), *head));
    heads.dedup();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&heads)?;
    for row in &rows {
        let fields = heads.iter().map(|head| match row.get(*head) {
            None | Some(Value::Null) => String::new(),
            Some(Value::String(text)) => text.clone(),
            Some(value) => value.to_string(),
        });
        writer.write_record(fields)?;
    }
    let bytes = writer.into_inner().context("cannot be written")?;
    Ok(String::from_utf8(bytes)?)
}

/// What names a cell first, then what most people want to see, then the rest.
fn rank(head: &str) -> usize {
    const FIRST: [&str; 19] = [
        "scene",
        "camera",
        "resolution",
        "spp",
        "rays",
        "method",
        "precision",
        "parameters",
        "ray_count",
        "median_ms",
        "mrays_per_s",
        "acceleration_ratio",
        "acceleration_interval",
        "ratio_embree_total",
        "ratio_embree_total_interval",
        "ratio_embree_trace",
        "ratio_embree_trace_interval",
        "counters",
        "diff",
    ];
    let starts = |name: &&str| head == *name || head.starts_with(&format!("{name}."));
    let place = FIRST.iter().position(starts);
    place.unwrap_or(FIRST.len())
}

fn flatten(key: &str, value: Value, row: &mut Map<String, Value>) {
    let within = |name: &str| match key {
        "" => name.to_owned(),
        _ => format!("{key}.{name}"),
    };
    match value {
        Value::Object(object) => {
            for (name, value) in object {
                flatten(&within(&name), value, row);
            }
        }
        Value::Array(items) if items.iter().all(Value::is_number) => {
            let items: Vec<String> = items.iter().map(Value::to_string).collect();
            row.insert(key.to_owned(), items.join(" ").into());
        }
        Value::Array(items) => {
            row.insert(key.to_owned(), items.len().into());
        }
        value => {
            row.insert(key.to_owned(), value);
        }
    }
}
