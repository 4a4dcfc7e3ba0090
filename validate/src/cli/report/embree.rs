//! Ratios to Embree, a row a batch, or a scene and ray type where these are too many.

use super::Section;
use super::file::File;
use super::words::{batch_name, distinct, embree_total, embree_trace, legend_of, look, plots};
use crate::cli::plot::dots::{Dot, Row, panel};
use dacrt_validate::results::{Cell, CellKey};
use dacrt_validate::statistics::{Ratio, geometric_mean};
use maud::html;

/// More rows than these are put together.
const ROWS: usize = 64;

/// Two panels a file: with Embree's build, and against its trace alone.
pub fn section(files: &[File]) -> anyhow::Result<Option<Section>> {
    let (mut parts, mut methods) = (Vec::new(), Vec::new());
    for file in files {
        let cells: Vec<&Cell> = (file.cells().iter())
            .filter(|cell| cell.ratio_embree_total.is_some())
            .collect();
        if cells.is_empty() {
            continue;
        }
        methods.extend(cells.iter().map(|cell| cell.key.method.as_str()));
        let name = naming(file, &cells);
        let rows = |ratio| rows(&cells, &*name, ratio);
        let (total, trace) = (rows(embree_total), rows(embree_trace));
        let ends = |rows: &[Row]| -> Vec<f64> {
            let dots = rows.iter().flat_map(|row| &row.dots);
            dots.flat_map(|dot| dot.ratio.interval).collect()
        };
        let all = [ends(&total), ends(&trace)].concat();
        let axis = "times as fast as Embree";
        let panels = vec![
            panel("with Embree's build", axis, &total, &all)?,
            panel("against Embree's trace alone", axis, &trace, &all)?,
        ];
        parts.push((file.name.as_str(), plots(panels)));
    }
    let introduction = html! {
        p {
            "Right of the line at 1 we are faster. Embree is the best of its builds and queries on the same \
             rays in the same run, with its build on the left, without on the right; ours always builds. \
             Lines through dots: 95 % intervals. Where several cells make a row, dots are geometric \
             means, and lines go from the least to the greatest."
        }
        (legend_of(&methods))
    };
    Ok(Section::by_file(
        "embree",
        "Ratio to Embree",
        introduction,
        parts,
    ))
}

/// Names rows: batches if these are few, else scenes with ray types, or scenes.
fn naming<'a>(file: &'a File, cells: &[&Cell]) -> Box<dyn Fn(&CellKey) -> String + 'a> {
    let count = |name: &dyn Fn(&CellKey) -> String| {
        distinct(cells.iter().map(|cell| name(&cell.key))).len()
    };
    let batch = |key: &CellKey| batch_name(file, key);
    let rays = |key: &CellKey| format!("{} {}", key.scene, key.rays);
    if count(&batch) <= ROWS {
        Box::new(batch)
    } else if count(&rays) <= ROWS {
        Box::new(rays)
    } else {
        Box::new(|key| key.scene.clone())
    }
}

fn rows(
    cells: &[&Cell],
    name: &dyn Fn(&CellKey) -> String,
    ratio: fn(&Cell) -> Option<Ratio>,
) -> Vec<Row> {
    let named: Vec<(String, &Cell)> = cells.iter().map(|cell| (name(&cell.key), *cell)).collect();
    let methods = distinct(cells.iter().map(|cell| &cell.key.method));
    let row = |name: &String| {
        let of_row = named.iter().filter(|(other, _)| other == name);
        let dot = |method: &&String| {
            let of_method = of_row
                .clone()
                .filter(|(_, cell)| cell.key.method == **method);
            let ratios: Vec<Ratio> = of_method.filter_map(|(_, cell)| ratio(cell)).collect();
            let (color, shape) = look(method);
            let ratio = pooled(&ratios)?;
            Some(Dot {
                color,
                shape,
                ratio,
            })
        };
        Row {
            name: name.clone(),
            dots: methods.iter().filter_map(dot).collect(),
        }
    };
    let names = distinct(named.iter().map(|(name, _)| name));
    names.into_iter().map(row).collect()
}

/// One ratio as it is; of several the geometric mean, and the least and the greatest.
fn pooled(ratios: &[Ratio]) -> Option<Ratio> {
    if let [one] = ratios {
        return Some(*one);
    }
    let values: Vec<f64> = ratios.iter().map(|r| r.ratio).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(0.0, f64::max);
    let ratio = geometric_mean(&values)?;
    Some(Ratio {
        ratio,
        interval: [least, greatest],
    })
}
