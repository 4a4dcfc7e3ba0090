//! A result seen along one parameter: a line a batch, a column a value.

use crate::cli::knobs::plain;
use crate::cli::text::{WIDTH, columns};
use dacrt::{Method, Precision};
use dacrt_validate::parameters::own_fields;
use dacrt_validate::results::{Cell, CellKey, Document};
use dacrt_validate::statistics::{Ratio, geometric_mean, paired_ratio};
use serde_json::{Map, Value};
use std::str::FromStr;

const LEGEND: &str = "
Above 1 is faster; `<` and `>`: the 95 % interval lies below or above 1.
";

/// The tables of all parameters that have more than one value; empty if none has.
pub fn all(document: &Document) -> String {
    let tables: Vec<String> = (document.varied().iter())
        .filter_map(|name| tables(document, name))
        .collect();
    match tables.is_empty() {
        true => String::new(),
        false => tables.join("\n") + LEGEND,
    }
}

/// The tables of one parameter, or of `method`; `None` if the cells do not differ in it.
pub fn one(document: &Document, name: &str) -> Option<String> {
    let text = match name {
        "method" => methods(document),
        _ => tables(document, name),
    };
    text.map(|text| text + LEGEND)
}

/// What a cell can be seen along: its parameters and its precision.
fn choices(key: &CellKey) -> Map<String, Value> {
    let parameters = key
        .choices()
        .map(|(name, value)| (name.clone(), value.clone()));
    let precision = ("precision".to_owned(), key.precision.as_str().into());
    parameters.chain([precision]).collect()
}

/// Cells of one method that have the same parameters but for one.
struct Group<'a> {
    method: &'a str,
    rest: Map<String, Value>,
    cells: Vec<&'a Cell>,
}

fn tables(document: &Document, name: &str) -> Option<String> {
    let mut groups: Vec<Group> = Vec::new();
    for cell in &document.cells {
        let mut rest = choices(&cell.key);
        if rest.remove(name).is_none() {
            continue;
        }
        let of_cell = |g: &&mut Group| g.method == cell.key.method && g.rest == rest;
        match groups.iter_mut().find(of_cell) {
            Some(group) => group.cells.push(cell),
            None => groups.push(Group {
                method: &cell.key.method,
                rest,
                cells: vec![cell],
            }),
        }
    }
    let other = document.varied();
    let texts = groups.iter().filter_map(|group| {
        let values = values(&group.cells, name);
        if values.len() < 2 {
            return None;
        }
        let rest = (group.rest.iter())
            .filter(|(key, _)| other.contains(key))
            .map(|(key, value)| format!(" {key}={}", plain(value)))
            .collect::<String>();
        let method = group.method;
        let reference = reference(method, name, &values);
        let heads: Vec<String> = values.iter().map(plain).collect();
        let with = |batch: &CellKey, value: &Value| {
            let of_batch = |c: &&&Cell| c.key.batch() == batch.batch();
            let mut cells = group.cells.iter().filter(of_batch);
            cells.find(|c| choices(&c.key)[name] == *value).copied()
        };
        let against_reference = |batch: &CellKey, column: usize| {
            let ours = with(batch, &values[column])?;
            Some(entry(ours, || {
                let reference = with(batch, reference)?.samples_ms.as_ref()?;
                paired_ratio(reference, ours.samples_ms.as_ref()?)
            }))
        };
        let against_baseline = |batch: &CellKey, column: usize| {
            let ours = with(batch, &values[column])?;
            Some(entry(ours, || acceleration(ours)))
        };
        let mut text = format!(
            "{method}{rest}: how many times as fast as with {name}={}\n",
            plain(reference)
        );
        text += &table(&group.cells, name, &heads, &against_reference);
        if group.cells.iter().any(|c| c.acceleration_ratio.is_some()) && method != "afra2012" {
            text += &format!("\n{method}{rest}: how many times as fast as afra2012\n");
            text += &table(&group.cells, name, &heads, &against_baseline);
        }
        Some(text)
    });
    let texts: Vec<String> = texts.collect();
    (!texts.is_empty()).then(|| texts.join("\n"))
}

/// The tables of all methods, one for each precision.
fn methods(document: &Document) -> Option<String> {
    let of = |precision: Precision| {
        let name = precision.name();
        let cells = document.cells.iter().filter(|c| c.key.precision == name);
        methods_of(&cells.collect::<Vec<_>>(), precision)
    };
    let tables: Vec<String> = Precision::ALL.into_iter().filter_map(of).collect();
    (!tables.is_empty()).then(|| tables.join("\n"))
}

/// One column for each method, the acceleration ratios of its cells with default parameters.
fn methods_of(cells: &[&Cell], precision: Precision) -> Option<String> {
    let presets = cells.iter().filter(|cell| cell.key.is_preset());
    let cells: Vec<&Cell> = presets.copied().collect();
    let mut names: Vec<String> = Vec::new();
    for cell in &cells {
        if !names.contains(&cell.key.method) && cell.key.method != "afra2012" {
            names.push(cell.key.method.clone());
        }
    }
    if names.is_empty() {
        return None;
    }
    let ratio = |batch: &CellKey, column: usize| {
        let of_batch = |c: &&&Cell| c.key.batch() == batch.batch();
        let mut cells = cells.iter().filter(of_batch);
        let cell = cells.find(|c| c.key.method == names[column])?;
        Some(entry(cell, || acceleration(cell)))
    };
    let heading = match precision {
        Precision::Fast => "how many times as fast as afra2012\n".to_owned(),
        _ => format!("{precision}: how many times as fast as afra2012\n"),
    };
    Some(heading + &table(&cells, "", &names, &ratio))
}

/// What stands in a column: a text for people, and a number for the mean.
struct Entry {
    text: String,
    number: Option<f64>,
}

fn entry(cell: &Cell, ratio: impl FnOnce() -> Option<Ratio>) -> Entry {
    if cell.is_wrong() {
        let text = "WRONG ".to_owned();
        return Entry { text, number: None };
    }
    match ratio() {
        None => Entry {
            text: "- ".to_owned(),
            number: None,
        },
        Some(Ratio { ratio, interval }) => {
            let mark = match interval {
                // Of one repeat.
                [low, high] if low == high => ' ',
                [_, high] if high < 1.0 => '<',
                [low, _] if low > 1.0 => '>',
                _ => ' ',
            };
            Entry {
                text: format!("{ratio:.2}{mark}"),
                number: Some(ratio),
            }
        }
    }
}

fn acceleration(cell: &Cell) -> Option<Ratio> {
    let ratio = cell.acceleration_ratio?;
    let interval = cell.acceleration_interval?;
    Some(Ratio { ratio, interval })
}

/// Gives the entry of a batch and a column.
type Entries<'a> = dyn Fn(&CellKey, usize) -> Option<Entry> + 'a;

/// A line for each batch, the means below; in several parts if the columns are too many.
fn table(cells: &[&Cell], corner: &str, heads: &[String], entries: &Entries) -> String {
    let mut batches: Vec<&CellKey> = Vec::new();
    for cell in cells {
        if !batches.iter().any(|key| key.batch() == cell.key.batch()) {
            batches.push(&cell.key);
        }
    }
    let label = |key: &CellKey| {
        let [width, height] = key.resolution;
        let spp = match key.spp {
            1 => String::new(),
            spp => format!(" x{spp}"),
        };
        format!("{} {} {width}x{height}{spp}", key.scene, key.rays)
    };
    let labels: Vec<String> = batches.iter().map(|key| label(key)).collect();
    let width = |text: &str| text.chars().count();
    let label_width = (labels.iter().map(|label| width(label)))
        .chain([width(corner), width("geometric mean")])
        .max()
        .unwrap_or(0);
    // With two spaces between, and room for a mark.
    let column_width = |head: &String| 2 + (width(head) + 1).max(width("10.00<"));
    let mut parts = Vec::new();
    let mut first = 0;
    while first < heads.len() {
        let mut line = label_width;
        let fits = heads[first..].iter().take_while(|head| {
            line += column_width(head);
            line <= WIDTH
        });
        let these = first..first + fits.count().max(1);
        first = these.end;
        let mut rows = vec![vec![corner.to_owned()]];
        // Flush with the digits: the marks stick out.
        rows[0].extend(heads[these.clone()].iter().map(|head| format!("{head} ")));
        let mut numbers = vec![Vec::new(); these.len()];
        for (batch, label) in batches.iter().zip(&labels) {
            let mut row = vec![label.clone()];
            for (column, numbers) in these.clone().zip(&mut numbers) {
                let entry = entries(batch, column);
                numbers.extend(entry.as_ref().and_then(|e| e.number));
                row.push(entry.map_or(String::new(), |e| e.text));
            }
            rows.push(row);
        }
        if batches.len() > 1 {
            let mean = |numbers: &Vec<f64>| match numbers.len() == batches.len() {
                true => format!("{:.2} ", geometric_mean(numbers).unwrap_or(f64::NAN)),
                false => String::new(),
            };
            let mut row = vec!["geometric mean".to_owned()];
            row.extend(numbers.iter().map(mean));
            rows.push(row);
        }
        let right: Vec<usize> = (1..=these.len()).collect();
        parts.push(columns(&rows, &right));
    }
    parts.join("\n")
}

/// The values of a parameter: numbers by size, words as they come.
fn values(cells: &[&Cell], name: &str) -> Vec<Value> {
    let mut values: Vec<Value> = Vec::new();
    for cell in cells {
        let value = choices(&cell.key)[name].clone();
        if !values.contains(&value) {
            values.push(value);
        }
    }
    let number = |v: &Value| v.as_f64().unwrap_or(f64::INFINITY);
    values.sort_by(|a, b| number(a).total_cmp(&number(b)));
    values
}

/// The default of the method if it is among the values, else the first.
fn reference<'a>(method: &str, name: &str, values: &'a [Value]) -> &'a Value {
    let preset = Method::from_str(method).ok();
    let preset = match name {
        "precision" => Some(Precision::default().name().into()),
        _ => preset.and_then(|m| own_fields(m, &m.parameters()).remove(name)),
    };
    let place = values.iter().position(|v| Some(v) == preset.as_ref());
    &values[place.unwrap_or(0)]
}
