//! All cells as one JSON block, of which the page makes a table.

use super::Section;
use super::file::File;
use super::words::{acceleration, distinct, embree_total, embree_trace, size};
use crate::cli::knobs::plain;
use dacrt_validate::results::Cell;
use dacrt_validate::statistics::Ratio;
use maud::{PreEscaped, html};
use serde_json::{Value, json};

/// A column of the table.
struct Column {
    /// As in addresses.
    name: &'static str,
    title: &'static str,
    kind: Kind,
    of: fn(&Cell, &Context) -> Value,
}

/// What the script does with the entries of a column.
#[derive(Clone, Copy)]
enum Kind {
    Text,
    Number,
    /// `[value, low, high]`.
    Ratio,
}

impl Column {
    /// As the script takes it.
    fn in_words(&self) -> Value {
        let kind = match self.kind {
            Kind::Text => "text",
            Kind::Number => "number",
            Kind::Ratio => "ratio",
        };
        json!({ "name": self.name, "title": self.title, "kind": kind })
    }
}

/// What a cell does not know of itself.
struct Context<'a> {
    file: &'a str,
    /// The parameters that vary in the file.
    varied: &'a [&'a String],
}

const COLUMNS: [Column; 20] = [
    column("scene", "scene", Kind::Text, |cell, _| {
        cell.key.scene.as_str().into()
    }),
    column("camera", "camera", Kind::Text, |cell, _| {
        cell.key.camera.as_str().into()
    }),
    column("size", "size", Kind::Text, |cell, _| size(&cell.key).into()),
    column("rays", "rays", Kind::Text, |cell, _| {
        cell.key.rays.as_str().into()
    }),
    column("method", "method", Kind::Text, |cell, _| {
        cell.key.method.as_str().into()
    }),
    column("precision", "precision", Kind::Text, |cell, _| {
        cell.key.precision.as_str().into()
    }),
    column("parameters", "parameters", Kind::Text, |cell, context| {
        parameters(cell, context.varied).into()
    }),
    column("count", "number of rays", Kind::Number, |cell, _| {
        cell.ray_count.into()
    }),
    column("ms", "ms", Kind::Number, |cell, _| rounded(cell.median_ms)),
    column("mrays", "Mrays/s", Kind::Number, |cell, _| {
        rounded(cell.mrays_per_s)
    }),
    column("afra", "vs afra2012", Kind::Ratio, |cell, _| {
        of_ratio(acceleration(cell))
    }),
    column("total", "vs Embree, total", Kind::Ratio, |cell, _| {
        of_ratio(embree_total(cell))
    }),
    column("trace", "vs Embree, trace", Kind::Ratio, |cell, _| {
        of_ratio(embree_trace(cell))
    }),
    column("boxes", "ray/box a ray", Kind::Number, |cell, _| {
        a_ray(cell, &["ray_box", "sample_box"])
    }),
    column("triangles", "ray/tri. a ray", Kind::Number, |cell, _| {
        a_ray(cell, &["ray_triangle"])
    }),
    column("wrong", "wrong rays", Kind::Number, |cell, _| {
        cell.diff.wrong().into()
    }),
    column("differ", "Embree differs", Kind::Number, |cell, _| {
        cell.diff.differing.into()
    }),
    column("errors", "errors/million", Kind::Number, |cell, _| {
        errors(cell)
    }),
    column("threads", "threads", Kind::Number, |cell, _| {
        cell.threads().into()
    }),
    column("file", "file", Kind::Text, |_, context| context.file.into()),
];

const fn column(
    name: &'static str,
    title: &'static str,
    kind: Kind,
    of: fn(&Cell, &Context) -> Value,
) -> Column {
    Column {
        name,
        title,
        kind,
        of,
    }
}

/// The table of all cells, without columns that are empty; none if no file has any.
pub fn section(files: &[File]) -> Option<Section> {
    let rows: Vec<Vec<Value>> = files.iter().flat_map(rows).collect();
    if rows.is_empty() {
        return None;
    }
    let is_there = |value: &Value| !value.is_null() && value != "";
    let used = (0..COLUMNS.len()).filter(|&i| rows.iter().any(|row| is_there(&row[i])));
    let used: Vec<usize> = used.collect();
    let columns: Vec<Value> = used.iter().map(|&i| COLUMNS[i].in_words()).collect();
    let of_used = |row: &Vec<Value>| used.iter().map(|&i| row[i].clone()).collect();
    let rows: Vec<Value> = rows.iter().map(of_used).collect();
    let data = json!({ "columns": columns, "rows": rows }).to_string();
    // Nothing in a script element is markup but its end.
    let data = data.replace('<', "\\u003c");
    let body = html! {
        p {
            "A click on a head sorts, another one turns the order round; cells without a value come last. All \
             words of the filter have to be in a row. The address of the page has the view. Ratios are how \
             many times as fast we are, with 95 % intervals; box tests with those of samples; errors: of \
             randomly drawn rays, those whose answer is not that of exact arithmetic."
        }
        form #filters {
            label { "filter " input #filter type="search" autocomplete="off"; }
            @for name in ["scene", "rays", "method"] {
                label { (name) " " select data-column=(name) { option value="" { "all" } } }
            }
            button type="reset" { "clear" }
            output #shown {}
        }
        div.scroll #cells-box { table #cells-table { thead {} tbody {} } }
        noscript { p { "The table needs JavaScript." } }
        script #cells-data type="application/json" { (PreEscaped(data)) }
    };
    Some(Section {
        id: "cells",
        title: "All cells",
        body,
    })
}

fn rows(file: &File) -> Vec<Vec<Value>> {
    let cells = file.cells();
    let varied = varied(cells);
    let context = Context {
        file: &file.name,
        varied: &varied,
    };
    let row = |cell| {
        COLUMNS
            .iter()
            .map(|column| (column.of)(cell, &context))
            .collect()
    };
    cells.iter().map(row).collect()
}

/// The parameters that have more than one value among the cells of a method.
fn varied(cells: &[Cell]) -> Vec<&String> {
    let choices = cells.iter().flat_map(|cell| cell.key.choices());
    let names = distinct(choices.map(|(name, _)| name));
    let methods = distinct(cells.iter().map(|cell| &cell.key.method));
    let varies = |name: &&String, method: &String| {
        let of_method = cells.iter().filter(|cell| cell.key.method == *method);
        distinct(of_method.map(|cell| cell.key.parameters.get(*name))).len() > 1
    };
    let is_varied = |name: &&String| methods.iter().any(|m| varies(name, m));
    names.into_iter().filter(is_varied).collect()
}

/// `bins=8 samples=50`.
fn parameters(cell: &Cell, varied: &[&String]) -> String {
    let values = varied.iter().filter_map(|name| {
        let value = cell.key.parameters.get(*name)?;
        Some(format!("{name}={}", plain(value)))
    });
    values.collect::<Vec<_>>().join(" ")
}

/// With four digits that count, which is more than times repeat to.
fn rounded(x: Option<f64>) -> Value {
    match x {
        Some(x) if x.is_finite() && x != 0.0 => {
            let digits = 3 - x.abs().log10().floor() as i32;
            let text = format!("{x:.*}", digits.max(0) as usize);
            text.parse::<f64>().map_or(Value::Null, Value::from)
        }
        x => x.map_or(Value::Null, Value::from),
    }
}

fn of_ratio(ratio: Option<Ratio>) -> Value {
    ratio.map_or(
        Value::Null,
        |Ratio {
             ratio,
             interval: [low, high],
         }| { [ratio, low, high].map(|x| rounded(Some(x))).to_vec().into() },
    )
}

fn a_ray(cell: &Cell, names: &[&str]) -> Value {
    let counts = names
        .iter()
        .filter_map(|name| cell.counters.get(*name)?.as_f64());
    rounded((cell.ray_count > 0).then(|| counts.sum::<f64>() / cell.ray_count as f64))
}

/// Answers of the judged rays that are not exact, per million.
fn errors(cell: &Cell) -> Value {
    let sample = cell.diff.errors.as_ref().filter(|sample| sample.rays > 0);
    rounded(sample.map(|sample| sample.ours.all() as f64 * 1e6 / sample.rays as f64))
}
