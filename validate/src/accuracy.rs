//! Speed against error: what a result file says of time and of wrong answers, ours and Embree's.

use crate::diff::{Errors, SampleErrors};
use crate::embree::Mode;
use crate::results::{Cell, CellKey, Document};
use crate::statistics::Ratio;
use dacrt::Precision;
use std::fmt;

/// All that traced one batch of rays.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch<'a> {
    /// Of its first cell; only what cells of a batch have in common is meant.
    pub key: &'a CellKey,
    /// Rays of the batch.
    pub rays: u64,
    /// How many of them, drawn at random, were held against exact arithmetic.
    pub sample: u64,
    /// Our cells in the order of the file, then Embree's modes.
    pub tracers: Vec<Tracer<'a>>,
}

/// Who traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who<'a> {
    /// A method of ours.
    Ours {
        /// Its name.
        method: &'a str,
        /// In this precision.
        precision: Precision,
    },
    /// Embree at its best: build and trace.
    Embree(Mode),
}

impl fmt::Display for Who<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Who::Ours { method, precision } => write!(f, "{method} {precision}"),
            Who::Embree(mode) => write!(f, "Embree {}", mode.name()),
        }
    }
}

/// One who traced a batch: how long it took, and how many answers are not those of exact arithmetic.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracer<'a> {
    /// Who.
    pub who: Who<'a>,
    /// Median milliseconds; of Embree with its build. `None` if its hits are wrong or it was not
    /// timed.
    pub ms: Option<f64>,
    /// Time over that of our precision `fast`, or of Embree's default mode; without an interval of
    /// Embree, whose build is timed apart.
    pub over_fast: Option<Ratio>,
    /// Errors of the sample.
    pub errors: &'a Errors,
    /// Of all rays, those of which rounding explains that we differ from the mode of Embree that we
    /// are set against; `None` for Embree.
    pub edge: Option<u64>,
}

impl Batch<'_> {
    /// So many of the sample as a share of a million.
    pub fn per_million(&self, count: u64) -> f64 {
        count as f64 * 1e6 / self.sample as f64
    }

    /// What none of the sample means at 95 %: at most so many of a million.
    pub fn none_means(&self) -> f64 {
        // The share p for which (1 − p)ⁿ is 0.05.
        (1.0 - 0.05_f64.powf(1.0 / self.sample as f64)) * 1e6
    }

    /// The tracer of the plot: of our cells those of the method that is the fastest in `fast` (or in
    /// what there is).
    pub fn fastest_method(&self) -> Option<&str> {
        let mut timed: Vec<(Precision, f64, &str)> = (self.tracers.iter())
            .filter_map(|t| match t.who {
                Who::Ours { method, precision } => Some((precision, t.ms?, method)),
                Who::Embree(_) => None,
            })
            .collect();
        let place = |p: Precision| Precision::ALL.iter().position(|&q| q == p);
        timed.sort_by(|a, b| (place(a.0).cmp(&place(b.0))).then(a.1.total_cmp(&b.1)));
        timed.first().map(|(_, _, method)| *method)
    }
}

/// The batches of a document whose errors were counted, those with the most errors of ours beyond the
/// bounds first, then those with the most errors of ours at all.
pub fn batches(document: &Document) -> Vec<Batch<'_>> {
    let cells = document
        .cells
        .chunk_by(|a, b| a.key.batch() == b.key.batch());
    let mut batches: Vec<Batch> = cells.filter_map(batch).collect();
    let worst = |batch: &Batch| {
        let ours = batch
            .tracers
            .iter()
            .filter(|t| matches!(t.who, Who::Ours { .. }));
        let of =
            |t: &Tracer| [t.errors.beyond_bounds, t.errors.all()].map(|n| batch.per_million(n));
        ours.map(of)
            .fold([0.0_f64; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])])
    };
    batches.sort_by(|a, b| {
        let ([a0, a1], [b0, b1]) = (worst(a), worst(b));
        b0.total_cmp(&a0).then(b1.total_cmp(&a1))
    });
    batches
}

fn batch(cells: &[Cell]) -> Option<Batch<'_>> {
    let counted = |cell: &&Cell| sample(cell).is_some_and(|sample| sample.rays > 0);
    let cells: Vec<&Cell> = cells.iter().filter(counted).collect();
    let first = *cells.first()?;
    let sample = sample(first)?;
    let mut tracers: Vec<Tracer> = cells.iter().filter_map(|cell| ours(cell)).collect();
    let ms = Mode::ALL.map(|mode| {
        let mut embree = cells.iter().filter_map(|cell| cell.embree.as_ref());
        embree
            .find(|embree| embree.mode.unwrap_or_default() == mode)
            .map(|embree| embree.best_ms)
    });
    let [fast, robust] = ms;
    let over_fast = fast.zip(robust).map(|(fast, robust)| Ratio {
        ratio: robust / fast,
        interval: [robust / fast; 2],
    });
    tracers.push(Tracer {
        who: Who::Embree(Mode::Fast),
        ms: fast,
        over_fast: None,
        errors: &sample.embree_fast,
        edge: None,
    });
    tracers.push(Tracer {
        who: Who::Embree(Mode::Robust),
        ms: robust,
        over_fast,
        errors: &sample.embree_robust,
        edge: None,
    });
    Some(Batch {
        key: &first.key,
        rays: first.ray_count as u64,
        sample: sample.rays,
        tracers,
    })
}

fn sample(cell: &Cell) -> Option<&SampleErrors> {
    cell.diff.errors.as_ref()
}

fn ours(cell: &Cell) -> Option<Tracer<'_>> {
    let precision: Precision = cell.key.precision.parse().ok()?;
    let over_fast = cell.time_over_fast.zip(cell.time_over_fast_interval);
    let against = match Mode::against(precision) {
        Mode::Fast => &cell.diff.embree_fast,
        Mode::Robust => &cell.diff.embree_robust,
    };
    Some(Tracer {
        who: Who::Ours {
            method: &cell.key.method,
            precision,
        },
        ms: cell.median_ms,
        over_fast: over_fast.map(|(ratio, interval)| Ratio { ratio, interval }),
        errors: &sample(cell)?.ours,
        edge: against.edge,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn none_of_many_is_about_three_of_as_many() {
        let key = CellKey {
            scene: String::new(),
            camera: String::new(),
            resolution: [1, 1],
            spp: 1,
            rays: String::new(),
            method: String::new(),
            precision: String::new(),
            parameters: Default::default(),
        };
        let batch = Batch {
            key: &key,
            rays: 1_000_000,
            sample: 1_000_000,
            tracers: Vec::new(),
        };
        approx::assert_relative_eq!(batch.none_means(), 2.9957, max_relative = 1e-4);
        assert_eq!(batch.per_million(7), 7.0);
    }
}
