//! Times: ratios within each file, and how they compare.
//!
//! Milliseconds of two runs say little, for one may have had the processor to itself. Ratios to
//! contestants of the same run say more, but they stray as well, and a wrong alarm teaches people
//! to ignore alarms. So a method is slower only if each ratio that it has says so (that against
//! `afra2012` and the two against Embree), by more than [`SLACK`], at a confidence of
//! [`CONFIDENCE`]. The interval is a bootstrap from a pool of the deviations of all contestants of
//! the batch ([`Noise`]): a bootstrap of three or five samples of one contestant alone takes those
//! that happen to agree for certain.

use super::{Grade, Speed};
use crate::embree::Best;
use crate::parameters::is_baseline;
use crate::results::{Cell, Document};
use crate::statistics::{Noise, median};
use serde::Serialize;

/// By how much a ratio must have changed, whatever its interval: two runs of one program differ by
/// where its memory lies and how warm the processor is, which no interval from within a run shows.
pub const SLACK: f64 = 0.10;
/// Share of the resamples within the interval of a quotient. There are many cells in a file and
/// many files a day, so 95 % would be wrong too often.
pub const CONFIDENCE: f64 = 0.99;
/// So that 20 resamples lie beyond each end.
const RESAMPLES: usize = 4000;

/// Whose time is over ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Against {
    /// The baseline of the cell.
    Afra2012,
    /// Embree's best build + trace.
    EmbreeTotal,
    /// Embree's best trace.
    EmbreeTrace,
}

/// A ratio of times within a file, from its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratio {
    /// Against whom.
    pub against: Against,
    /// The other's time over ours, medians.
    pub value: f64,
    /// What it may be as well; empty if there is a single round. In no order.
    pub resamples: Vec<f64>,
}

/// How a ratio has changed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quotient {
    /// Against whom the ratios are.
    pub against: Against,
    /// The other's time over ours in the reference.
    pub reference: f64,
    /// The same in the new file.
    pub new: f64,
    /// `new / reference`: below 1, the method is slower than it was.
    pub quotient: f64,
    /// Its bootstrap interval of [`CONFIDENCE`]; `None` without repeats.
    pub interval: Option<[f64; 2]>,
}

/// Compares the times of a cell; each document is given for the other cells of the batch. `None` if
/// one of them has no times, or they have no ratio in common.
pub(super) fn speed(
    (reference, a): (&Document, &Cell),
    (new, b): (&Document, &Cell),
    judged: bool,
    same_embree: bool,
) -> Option<Speed> {
    let (before, after) = (ratios(reference, a, 1), ratios(new, b, 2));
    let quotients: Vec<Quotient> = (before.iter())
        .filter_map(|x| Some(quotient(x, after.iter().find(|y| y.against == x.against)?)))
        .collect();
    if quotients.is_empty() {
        return None;
    }
    let evidence: Vec<&Quotient> = (quotients.iter())
        .filter(|q| same_embree || q.against == Against::Afra2012)
        .collect();
    let all = |says: fn([f64; 2]) -> bool| {
        let all = evidence.iter().all(|q| q.interval.is_some_and(says));
        all && !evidence.is_empty()
    };
    let grade = if all(|[_, high]| high < 1.0 / (1.0 + SLACK)) {
        Grade::Regression
    } else if all(|[low, _]| low > 1.0 + SLACK) {
        Grade::Improvement
    } else {
        Grade::Same
    };
    Some(Speed {
        grade: match grade {
            Grade::Regression | Grade::Improvement if !judged => Grade::Changed,
            grade => grade,
        },
        quotients,
    })
}

fn quotient(before: &Ratio, after: &Ratio) -> Quotient {
    let resamples = before.resamples.iter().zip(&after.resamples);
    Quotient {
        against: before.against,
        reference: before.value,
        new: after.value,
        quotient: after.value / before.value,
        interval: interval(resamples.map(|(x, y)| y / x).collect()),
    }
}

/// The interval that leaves out as many resamples at either end; `None` of nothing.
pub(super) fn interval(mut resamples: Vec<f64>) -> Option<[f64; 2]> {
    resamples.sort_by(f64::total_cmp);
    let tail = (resamples.len() as f64 * (1.0 - CONFIDENCE) / 2.0) as usize;
    let last = resamples.len().checked_sub(1 + tail)?;
    Some([resamples[tail], resamples[last]])
}

impl Ratio {
    /// Its bootstrap interval of [`CONFIDENCE`]; `None` without repeats.
    pub fn interval(&self) -> Option<[f64; 2]> {
        interval(self.resamples.clone())
    }
}

/// The ratios of a cell, computed anew from the samples in its document; none if it has no times.
/// Ratios of two files that are to be compared need different seeds.
pub fn ratios(document: &Document, cell: &Cell, seed: u64) -> Vec<Ratio> {
    let Some((ours, ours_ms)) = timed(cell) else {
        return Vec::new();
    };
    let batch = document.cells.iter().filter(|c| same_batch(c, cell));
    let batch: Vec<(&Cell, &[f64])> = batch
        .filter_map(|c| Some((c, c.samples_ms.as_deref()?)))
        .collect();
    let embree = cell.embree.as_ref().map(|embree| &embree.samples_ms);
    let (traces, builds): (Vec<_>, Vec<_>) = (embree.into_iter().flatten())
        .map(|(name, samples)| (name.contains('_'), samples.as_slice()))
        .partition(|(is_trace, _)| *is_trace);
    let traces = traces.into_iter().map(|(_, samples)| samples);
    let noise = Noise::of(batch.iter().map(|(_, samples)| *samples).chain(traces));
    let build_noise = Noise::of(builds.into_iter().map(|(_, samples)| samples));

    let mut random = fastrand::Rng::with_seed(seed);
    let mut resample = |value: f64, other: &dyn Fn(&mut Factors) -> f64| {
        let Some(noise) = &noise else {
            return Vec::new();
        };
        let mut factors = Factors {
            noise,
            build_noise: build_noise.as_ref(),
            random: &mut random,
        };
        (0..RESAMPLES)
            .map(|_| value * other(&mut factors) / factors.trace(ours.len()))
            .collect()
    };
    let mut ratios = Vec::new();
    let is_baseline = |c: &Cell| {
        c.key.method == dacrt::Method::Afra2012.name()
            && c.key.precision == cell.key.precision
            && is_baseline(&c.key.parameters, &cell.key.parameters)
    };
    let baseline = batch.iter().find(|(c, _)| is_baseline(c));
    let baseline = baseline.filter(|(c, _)| !std::ptr::eq(*c, cell));
    if let Some((baseline, median)) = baseline.and_then(|(c, _)| timed(c)) {
        let value = median / ours_ms;
        ratios.push(Ratio {
            against: Against::Afra2012,
            value,
            resamples: resample(value, &|factors| factors.trace(baseline.len())),
        });
    }
    if let Some(best) = embree.and_then(Best::of) {
        let (total, trace) = (best.total, best.trace);
        let value = total.total_ms() / ours_ms;
        let share = total.build_ms / total.total_ms();
        ratios.push(Ratio {
            against: Against::EmbreeTotal,
            value,
            resamples: resample(value, &|factors| {
                share * factors.build(total.builds.len())
                    + (1.0 - share) * factors.trace(total.traces.len())
            }),
        });
        let value = trace.trace_ms / ours_ms;
        ratios.push(Ratio {
            against: Against::EmbreeTrace,
            value,
            resamples: resample(value, &|factors| factors.trace(trace.traces.len())),
        });
    }
    ratios
}

/// What chance may make of medians.
struct Factors<'a> {
    noise: &'a Noise,
    build_noise: Option<&'a Noise>,
    random: &'a mut fastrand::Rng,
}

impl Factors<'_> {
    fn trace(&mut self, samples: usize) -> f64 {
        self.noise.of_median(samples, self.random)
    }

    fn build(&mut self, samples: usize) -> f64 {
        let noise = self.build_noise;
        noise.map_or(1.0, |noise| noise.of_median(samples, self.random))
    }
}

fn timed(cell: &Cell) -> Option<(&[f64], f64)> {
    let samples = cell.samples_ms.as_deref()?;
    Some((samples, median(samples)?))
}

fn same_batch(a: &Cell, b: &Cell) -> bool {
    let of = |c: &Cell| (c.key.resolution, c.key.spp);
    of(a) == of(b)
        && (&a.key.scene, &a.key.camera, &a.key.rays) == (&b.key.scene, &b.key.camera, &b.key.rays)
}
