//! Times against values of parameters: a curve for one that varies, a heat map for two.

use super::Section;
use super::file::File;
use super::words::{distinct, legend_of, look, plots};
use crate::cli::knobs::plain;
use crate::cli::plot::axes::Axis;
use crate::cli::plot::heat_map;
use crate::cli::plot::lines::{Line, panel};
use dacrt_validate::results::{Cell, CellKey};
use dacrt_validate::statistics::geometric_mean;
use maud::{Markup, html};
use serde_json::Value;

/// The plots of all files in which parameters vary.
pub fn section(files: &[File]) -> anyhow::Result<Option<Section>> {
    let (mut parts, mut methods) = (Vec::new(), Vec::new());
    for file in files {
        let sweeps = sweeps(file);
        if !sweeps.is_empty() {
            methods.extend(sweeps.iter().map(|sweep| sweep.method));
            parts.push((file.name.as_str(), of_file(&sweeps)?));
        }
    }
    let introduction = html! {
        p {
            "Time over the best time of the same method on the same batch; 1 is the best value there is. \
             Curves: pale each batch, bold the geometric mean over batches; where more than two parameters \
             vary, the others are the same for all values, or at their best for each. Heat maps: geometric means over batches."
        }
        (legend_of(&methods))
    };
    Ok(Section::by_file("sweeps", "Sweeps", introduction, parts))
}

/// The cells of one method in one precision, and the parameters that vary among them.
struct Sweep<'a> {
    method: &'a str,
    precision: &'a str,
    batches: Vec<Vec<&'a Cell>>,
    parameters: Vec<&'a str>,
}

fn sweeps(file: &File) -> Vec<Sweep<'_>> {
    let timed = || file.cells().iter().filter(|cell| cell.median_ms.is_some());
    let kinds = distinct(timed().map(|cell| (&*cell.key.method, &*cell.key.precision)));
    let sweep = |(method, precision)| {
        let is_of = |cell: &&Cell| (&*cell.key.method, &*cell.key.precision) == (method, precision);
        let cells: Vec<&Cell> = timed().filter(is_of).collect();
        let batches: Vec<Vec<&Cell>> = (cells.chunk_by(|a, b| a.key.batch() == b.key.batch()))
            .filter(|batch| batch.len() > 1)
            .map(<[&Cell]>::to_vec)
            .collect();
        let of_batches: Vec<&Cell> = batches.iter().flatten().copied().collect();
        let names = distinct(
            of_batches
                .iter()
                .flat_map(|cell| cell.key.choices())
                .map(|(name, _)| name),
        );
        let varies = |name: &&String| values(&of_batches, name).len() > 1;
        let parameters = names.into_iter().filter(varies).map(String::as_str);
        Sweep {
            method,
            precision,
            parameters: parameters.collect(),
            batches,
        }
    };
    let sweeps = kinds.into_iter().map(sweep);
    sweeps
        .filter(|sweep| !sweep.parameters.is_empty())
        .collect()
}

/// The values of a parameter: numbers by size, words as they come.
fn values(cells: &[&Cell], name: &str) -> Vec<Value> {
    let mut values = distinct(
        cells
            .iter()
            .filter_map(|cell| cell.key.parameters.get(name).cloned()),
    );
    let number = |value: &Value| value.as_f64().unwrap_or(f64::INFINITY);
    values.sort_by(|a, b| number(a).total_cmp(&number(b)));
    values
}

fn of_file(sweeps: &[Sweep]) -> anyhow::Result<Markup> {
    let mut svgs = Vec::new();
    for sweep in sweeps {
        match sweep.parameters[..] {
            [x, y] => svgs.push(sweep.heat_map(x, y)?),
            _ => {
                for name in &sweep.parameters {
                    svgs.push(sweep.curves(name)?);
                }
            }
        }
    }
    Ok(plots(svgs))
}

impl Sweep<'_> {
    /// `nabata2013`, or with a precision that is not the usual one.
    fn name(&self) -> String {
        match self.precision {
            "fast" => self.method.to_owned(),
            precision => format!("{} {precision}", self.method),
        }
    }

    fn values(&self, name: &str) -> Vec<Value> {
        let all: Vec<&Cell> = self.batches.iter().flatten().copied().collect();
        values(&all, name)
    }

    fn curves(&self, name: &str) -> anyhow::Result<String> {
        let batches = self.batches.iter().map(|batch| comparable(batch, name));
        let batches: Vec<Vec<&Cell>> = batches.filter(|batch| !batch.is_empty()).collect();
        let values = self.values(name);
        let by_value: Vec<Vec<Option<f64>>> = (values.iter())
            .map(|value| over_best(&batches, &|key| key.parameters.get(name) == Some(value)))
            .collect();
        let (color, shape) = look(self.method);
        let line = |points, shape| Line {
            color,
            shape,
            label: String::new(),
            points,
        };
        let numbered = || (0..).map(f64::from).zip(&by_value);
        let of_batch = |batch: usize| numbered().filter_map(move |(x, of)| Some((x, of[batch]?)));
        let pale = (0..batches.len()).map(|batch| line(of_batch(batch).collect(), None));
        let mut lines: Vec<Line> = pale.collect();
        let mean = |(x, of): (f64, &Vec<Option<f64>>)| {
            // A mean of other batches says nothing beside it.
            let all: Vec<f64> = of.iter().copied().collect::<Option<_>>()?;
            Some((x, geometric_mean(&all)?))
        };
        lines.push(line(numbered().filter_map(mean).collect(), Some(shape)));
        let names: Vec<String> = values.iter().map(plain).collect();
        let axis = Axis::names(name, &names);
        panel(&self.name(), axis, "time over the best", &lines)
    }

    fn heat_map(&self, x: &str, y: &str) -> anyhow::Result<String> {
        let both = [x, y].map(|name| self.values(name));
        let field = |i: usize, j: usize| {
            let (a, b) = (&both[0][i], &both[1][j]);
            let is = |key: &CellKey| {
                key.parameters.get(x) == Some(a) && key.parameters.get(y) == Some(b)
            };
            let all: Vec<f64> = over_best(&self.batches, &is)
                .into_iter()
                .collect::<Option<_>>()?;
            geometric_mean(&all)
        };
        let names = both
            .each_ref()
            .map(|values| values.iter().map(plain).collect::<Vec<_>>());
        heat_map::panel(&self.name(), [x, y], [&names[0], &names[1]], &field)
    }
}

/// Of the cells of a batch those beside which stand others that differ in this parameter only, with the most
/// values that there are; none if it does not vary.
fn comparable<'a>(batch: &[&'a Cell], name: &str) -> Vec<&'a Cell> {
    let others = |cell: &'a Cell| {
        let choices = cell.key.choices();
        choices
            .filter(|(other, _)| *other != name)
            .collect::<Vec<_>>()
    };
    let groups = distinct(batch.iter().map(|cell| others(cell)));
    let groups: Vec<Vec<&Cell>> = (groups.iter())
        .map(|group| {
            let of_group = batch.iter().filter(|cell| others(cell) == *group);
            of_group.copied().collect()
        })
        .collect();
    let most = groups.iter().map(|cells| values(cells, name).len()).max();
    let Some(most) = most.filter(|&most| most > 1) else {
        return Vec::new();
    };
    let whole = groups
        .into_iter()
        .filter(|cells| values(cells, name).len() == most);
    whole.flatten().collect()
}

/// For each batch the least time of cells that `is` takes, over the least of all.
fn over_best(batches: &[Vec<&Cell>], is: &dyn Fn(&CellKey) -> bool) -> Vec<Option<f64>> {
    let least = |cells: &mut dyn Iterator<Item = &&Cell>| {
        cells
            .filter_map(|cell| cell.median_ms)
            .min_by(f64::total_cmp)
    };
    let of_batch = |batch: &Vec<&Cell>| {
        let best = least(&mut batch.iter())?;
        Some(least(&mut batch.iter().filter(|cell| is(&cell.key)))? / best)
    };
    batches.iter().map(of_batch).collect()
}
