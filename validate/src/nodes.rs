//! The nodes of a trace as a table: a row a node, as CSV or as columns in an `.npz` archive.

use crate::npy::{self, NpyError};
use anyhow::{Context, bail};
use dacrt::NodeRecord;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// The rule that a node was split by, or that it was not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Regime {
    /// Solved by the naive step.
    Leaf,
    /// Halved by number: no plane parts its triangles.
    Halved,
    /// In the middle, for there were few rays a triangle.
    Middle,
    /// Likewise, and rays were sampled for order and ratios.
    MiddleSampled,
    /// By a cost function, without samples.
    Cost,
    /// By a cost function, with samples.
    CostSampled,
}

impl Regime {
    /// All, in the order of their numbers in `.npz` files.
    pub const ALL: [Regime; 6] = [
        Regime::Leaf,
        Regime::Halved,
        Regime::Middle,
        Regime::MiddleSampled,
        Regime::Cost,
        Regime::CostSampled,
    ];

    /// As it stands in CSV files.
    pub fn name(self) -> &'static str {
        match self {
            Regime::Leaf => "leaf",
            Regime::Halved => "halved",
            Regime::Middle => "middle",
            Regime::MiddleSampled => "middle-sampled",
            Regime::Cost => "cost",
            Regime::CostSampled => "cost-sampled",
        }
    }
}

/// A node. Of a leaf, all from `candidates` on is empty; of a node without samples their counts and the
/// estimates are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The way from the root: `L` and `R` for each split; empty for the root.
    pub path: String,
    /// Its length.
    pub depth: u32,
    /// Active rays.
    pub rays: u32,
    /// Triangles.
    pub triangles: u32,
    /// Which rule.
    pub regime: Regime,
    /// How many splits there were to choose from.
    pub candidates: Option<u32>,
    /// Places of the split taken, of that of the surface area heuristic, and of the one that is best by
    /// all rays.
    pub chosen: Option<u32>,
    /// See `chosen`.
    pub by_area: Option<u32>,
    /// See `chosen`.
    pub by_rays: Option<u32>,
    /// Cost by all rays (pairs of a ray and a triangle in the children) of the split taken.
    pub cost: Option<u64>,
    /// Of the split of the surface area heuristic.
    pub cost_by_area: Option<u64>,
    /// The least cost by all rays.
    pub least_cost: Option<u64>,
    /// `cost` over `least_cost`, infinite where only the latter is 0.
    pub regret: Option<f64>,
    /// `cost_by_area` over `least_cost`.
    pub regret_by_area: Option<f64>,
    /// Sample rays.
    pub samples: Option<u32>,
    /// Samples that enter the left child first, and the right one.
    pub samples_left_first: Option<u32>,
    /// See `samples_left_first`.
    pub samples_right_first: Option<u32>,
    /// Intersection ratios by the samples.
    pub estimated_left: Option<f32>,
    /// See `estimated_left`.
    pub estimated_right: Option<f32>,
    /// Surface area of each child over the node's: the ratios that the surface area heuristic takes.
    pub area_left: Option<f32>,
    /// See `area_left`.
    pub area_right: Option<f32>,
    /// Intersection ratios by all rays, before the first child is traversed.
    pub true_left: Option<f32>,
    /// See `true_left`.
    pub true_right: Option<f32>,
    /// That of the second child after the first has been traversed.
    pub true_second: Option<f32>,
    /// Whether the left child is the first: 1 or 0.
    pub left_first: Option<u8>,
    /// Whether a child gets all rays unfiltered: 1 or 0.
    pub skipped_left: Option<u8>,
    /// See `skipped_left`.
    pub skipped_right: Option<u8>,
    /// Ray/box tests of sample rays, and of the filters of both children.
    pub sample_box: Option<u64>,
    /// See `sample_box`.
    pub ray_box: Option<u64>,
}

impl Row {
    /// The row of a node.
    pub fn of(node: &NodeRecord) -> Row {
        let split = node.split.as_ref();
        let costs = split.map(|split| split.costs);
        // Where no ray meets any child, no split is worse than another.
        let regret = |cost: u64, least: u64| match (cost, least) {
            (0, 0) => 1.0,
            (cost, least) => cost as f64 / least as f64,
        };
        let samples = split.and_then(|split| split.samples);
        let estimated = split.and_then(|split| split.estimated());
        Row {
            path: path(node.path),
            depth: node.depth,
            rays: node.rays,
            triangles: node.triangles,
            regime: match split {
                None => Regime::Leaf,
                Some(split) => match (split.halved, split.by_cost, split.samples.is_some()) {
                    (true, ..) => Regime::Halved,
                    (_, false, false) => Regime::Middle,
                    (_, false, true) => Regime::MiddleSampled,
                    (_, true, false) => Regime::Cost,
                    (_, true, true) => Regime::CostSampled,
                },
            },
            candidates: split.map(|split| split.candidates),
            chosen: split.map(|split| split.chosen),
            by_area: split.map(|split| split.by_area),
            by_rays: split.map(|split| split.by_rays),
            cost: costs.map(|[chosen, ..]| chosen),
            cost_by_area: costs.map(|[_, by_area, _]| by_area),
            least_cost: costs.map(|[.., least]| least),
            regret: costs.map(|[chosen, _, least]| regret(chosen, least)),
            regret_by_area: costs.map(|[_, by_area, least]| regret(by_area, least)),
            samples: samples.map(|[n, ..]| n),
            samples_left_first: samples.map(|[.., left, _]| left),
            samples_right_first: samples.map(|[.., right]| right),
            estimated_left: estimated.map(|[left, _]| left),
            estimated_right: estimated.map(|[_, right]| right),
            area_left: split.map(|split| split.areas[0]),
            area_right: split.map(|split| split.areas[1]),
            true_left: split.map(|split| split.ratios[0]),
            true_right: split.map(|split| split.ratios[1]),
            true_second: split.map(|split| split.second_ratio),
            left_first: split.map(|split| split.left_first.into()),
            skipped_left: split.map(|split| split.skipped[0].into()),
            skipped_right: split.map(|split| split.skipped[1].into()),
            sample_box: split.map(|split| split.sample_box),
            ray_box: split.map(|split| split.ray_box),
        }
    }

    /// (estimated, true, skipped) of both children; none without samples.
    pub fn children(&self) -> Option<[(f32, f32, bool); 2]> {
        let left = (
            self.estimated_left?,
            self.true_left?,
            self.skipped_left? != 0,
        );
        let right = (
            self.estimated_right?,
            self.true_right?,
            self.skipped_right? != 0,
        );
        Some([left, right])
    }

    /// Ray/box tests, sample rays among them.
    pub fn box_tests(&self) -> u64 {
        self.sample_box.unwrap_or(0) + self.ray_box.unwrap_or(0)
    }
}

/// `L` and `R` for each bit below the first.
fn path(bits: u128) -> String {
    let length = 127 - bits.max(1).leading_zeros();
    let of = |i: u32| if bits >> i & 1 == 0 { 'L' } else { 'R' };
    (0..length).rev().map(of).collect()
}

/// The kind of a table by its name's end.
pub enum Format {
    /// Comma-separated values with a line of heads.
    Csv,
    /// An array a column; see [`write()`].
    Npz,
}

impl Format {
    /// By `.csv` or `.npz`.
    ///
    /// # Errors
    /// Another end.
    pub fn of(path: &Path) -> anyhow::Result<Format> {
        match path.extension().and_then(|end| end.to_str()) {
            Some("csv") => Ok(Format::Csv),
            Some("npz") => Ok(Format::Npz),
            _ => bail!(
                "{}: expected a name that ends in .csv or .npz",
                path.display()
            ),
        }
    }
}

/// Writes the table. In an `.npz` archive what is empty is NaN, all numbers but `depth`, `rays` and
/// `triangles` are float64; `regime` is the number in [`Regime::ALL`], and there is no `path`.
///
/// # Errors
/// If the file cannot be written; an old file of this name then stays as it was.
pub fn write(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    match Format::of(path)? {
        Format::Csv => crate::atomic::write(path, |file| {
            let mut csv = csv::Writer::from_writer(file);
            for row in rows {
                csv.serialize(row).map_err(io::Error::other)?;
            }
            csv.flush()
        })
        .with_context(|| format!("{}: cannot be written", path.display())),
        Format::Npz => Ok(write_npz(path, rows)?),
    }
}

fn write_npz(path: &Path, rows: &[Row]) -> Result<(), NpyError> {
    let number = |x: Option<u64>| x.map_or(f64::NAN, |x| x as f64);
    let float = |x: Option<f32>| x.map_or(f64::NAN, f64::from);
    type Column = fn(&Row, &dyn Fn(Option<u64>) -> f64, &dyn Fn(Option<f32>) -> f64) -> f64;
    let columns: [(&str, Column); 24] = [
        ("candidates", |r, n, _| n(r.candidates.map(u64::from))),
        ("chosen", |r, n, _| n(r.chosen.map(u64::from))),
        ("by_area", |r, n, _| n(r.by_area.map(u64::from))),
        ("by_rays", |r, n, _| n(r.by_rays.map(u64::from))),
        ("regret", |r, _, _| r.regret.unwrap_or(f64::NAN)),
        ("regret_by_area", |r, _, _| {
            r.regret_by_area.unwrap_or(f64::NAN)
        }),
        ("cost", |r, n, _| n(r.cost)),
        ("cost_by_area", |r, n, _| n(r.cost_by_area)),
        ("least_cost", |r, n, _| n(r.least_cost)),
        ("samples", |r, n, _| n(r.samples.map(u64::from))),
        ("samples_left_first", |r, n, _| {
            n(r.samples_left_first.map(u64::from))
        }),
        ("samples_right_first", |r, n, _| {
            n(r.samples_right_first.map(u64::from))
        }),
        ("estimated_left", |r, _, f| f(r.estimated_left)),
        ("estimated_right", |r, _, f| f(r.estimated_right)),
        ("area_left", |r, _, f| f(r.area_left)),
        ("area_right", |r, _, f| f(r.area_right)),
        ("true_left", |r, _, f| f(r.true_left)),
        ("true_right", |r, _, f| f(r.true_right)),
        ("true_second", |r, _, f| f(r.true_second)),
        ("left_first", |r, n, _| n(r.left_first.map(u64::from))),
        ("skipped_left", |r, n, _| n(r.skipped_left.map(u64::from))),
        ("skipped_right", |r, n, _| n(r.skipped_right.map(u64::from))),
        ("sample_box", |r, n, _| n(r.sample_box)),
        ("ray_box", |r, n, _| n(r.ray_box)),
    ];
    npy::write_archive(path, |archive| {
        let whole = [
            ("depth", (|r| r.depth) as fn(&Row) -> u32),
            ("rays", |r| r.rays),
            ("triangles", |r| r.triangles),
        ];
        for (name, of) in whole {
            archive.array(name, "<u4", rows.iter().map(|row| of(row).to_le_bytes()))?;
        }
        let place = |row: &Row| Regime::ALL.iter().position(|&r| r == row.regime);
        let regimes = rows.iter().map(|row| [place(row).unwrap_or(0) as u8]);
        archive.array("regime", "|u1", regimes)?;
        for (name, of) in columns {
            let values = rows
                .iter()
                .map(|row| of(row, &number, &float).to_le_bytes());
            archive.array(name, "<f8", values)?;
        }
        Ok(())
    })
}

/// Reads a table that [`write()`] has written as CSV.
///
/// # Errors
/// If it cannot be read, or is none.
pub fn read(path: &Path) -> anyhow::Result<Vec<Row>> {
    let what = || path.display().to_string();
    if let Format::Npz = Format::of(path)? {
        bail!("{}: only tables of nodes as .csv can be read", what());
    }
    let mut csv =
        csv::Reader::from_path(path).with_context(|| format!("{}: cannot be read", what()))?;
    let mut rows = Vec::new();
    for (i, row) in csv.deserialize().enumerate() {
        let Ok(row) = row else {
            bail!("{}: row {} is none of a table of nodes", what(), i + 1);
        };
        rows.push(row);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_read_from_the_root() {
        assert_eq!([1, 2, 3, 0b1011].map(path), ["", "L", "R", "LRR"]);
    }
}
