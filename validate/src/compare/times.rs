//! Times: ratios within each file, and how they compare.
//!
//! Milliseconds of two runs say little: the processor may have been busy, hot, or shared. Ratios to
//! contestants of the same run say more, but they stray as well, and a false alarm teaches people
//! to ignore alarms. So a method has become slower only
//!
//! - if each of its ratios says so: that to another method (the baseline; without one, and for the
//!   baseline itself, the first other method of the batch) and the two to Embree, each by more than
//!   [`SLACK`]. What differs between two runs of one program moves a method against Embree or
//!   against another method, seldom both;
//! - or if both ratios to Embree say so by more than [`FAR_SLACK`]: what slows all methods alike
//!   shows nowhere else. Our methods stream through memory, which other users of the last-level
//!   cache slow down and Embree's small trees hardly feel: two runs of one commit, hours apart on a
//!   quiet machine, had ratios 0.80 apart. Hence the large slack. Where a batch has one method
//!   only, it is [`LONE_SLACK`], for nothing else is there to judge by.
//!
//! A ratio says so if its whole interval does and the ratio of the least times does, too, which
//! disturbances hardly reach. The interval of a quotient is a bootstrap from a pool of the
//! deviations of all contestants of the batch ([`Noise`]). A bootstrap of the three or five samples
//! of each contestant alone takes for certain what happens to agree: of 2,772 cells of 132 pairs of
//! runs of one commit on a busy machine with two cores it called 9 slower (95 %, slack 0.1), and it
//! missed 4 of 18 cells of a quiet run whose samples had been multiplied by 1.3. The rule here
//! calls none slower and misses none.

use super::{Grade, Names, Speed};
use crate::embree::Best;
use crate::parameters::is_baseline;
use crate::results::{Cell, Document};
use crate::statistics::{Noise, least, median};
use dacrt::Method;
use serde::Serialize;
use std::fmt;

/// By how much each ratio must have changed, beyond its interval.
pub const SLACK: f64 = 0.05;
/// By how much the ratios to Embree must have changed where other methods tell nothing.
pub const FAR_SLACK: f64 = 0.4;
/// The same where there is no other method in the batch: nothing else could tell.
pub const LONE_SLACK: f64 = 0.2;
/// Share of the resamples within an interval. There are many cells in a file, and many files a day:
/// 95 % would be wrong too often.
pub const CONFIDENCE: f64 = 0.98;
/// So that 40 resamples lie beyond each end.
const RESAMPLES: usize = 4000;

/// Whose time is over ours.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Against {
    /// The baseline of the cell.
    Afra2012,
    /// Embree's best build + trace.
    EmbreeTotal,
    /// Embree's best trace.
    EmbreeTrace,
    /// Another cell of the same batch, by name.
    #[serde(untagged)]
    Cell(String),
}

impl Against {
    fn is_embree(&self) -> bool {
        matches!(self, Against::EmbreeTotal | Against::EmbreeTrace)
    }
}

impl fmt::Display for Against {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Against::Afra2012 => "afra2012",
            // The batch is that of the cell at hand.
            Against::Cell(name) => name.rsplit_once('/').map_or(name, |(_, method)| method),
            Against::EmbreeTotal => "Embree total",
            Against::EmbreeTrace => "Embree trace",
        })
    }
}

/// A ratio of times within a file, from its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Ratio {
    /// Against whom.
    pub against: Against,
    /// The other's time over ours, medians.
    pub value: f64,
    /// The same of the least times.
    pub of_least: f64,
    /// What chance may make of it; empty without repeats. In no order.
    pub resamples: Vec<f64>,
}

impl Ratio {
    /// Its bootstrap interval of [`CONFIDENCE`]; `None` without repeats.
    pub fn interval(&self) -> Option<[f64; 2]> {
        interval(self.resamples.clone())
    }
}

/// How a ratio has changed.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    /// The quotient of the ratios of the least times.
    pub of_least: f64,
}

/// The ratios of a cell to its baseline and to Embree, computed anew from the samples in its
/// document; none if it has no times.
pub fn ratios(document: &Document, cell: &Cell) -> Vec<Ratio> {
    let mut batch = Batch::of(document, cell, 1);
    let baseline = batch.baseline();
    let baseline = baseline.and_then(|other| batch.against_cell(Against::Afra2012, other));
    baseline.into_iter().chain(batch.against_embree()).collect()
}

/// Compares the times of a cell; each document is given for the other cells of the batch. `None` if
/// they have no ratio in common.
pub(super) fn speed(
    (reference, a): (&Document, &Cell),
    (new, b): (&Document, &Cell),
    names: &Names,
    judged: bool,
    same_embree: bool,
) -> Option<Speed> {
    // Two seeds, for the files were measured independently.
    let (mut before, mut after) = (Batch::of(reference, a, 1), Batch::of(new, b, 2));
    let baselines = before.baseline().zip(after.baseline());
    let other = match baselines {
        Some((x, y)) => Some((Against::Afra2012, x, y)),
        None => before.other_methods().find_map(|x| {
            let y = after.other_methods().find(|y| y.key.is(&x.key))?;
            Some((Against::Cell(names.name(&x.key)), x, y))
        }),
    };
    let (mut ratios_before, mut ratios_after) = (Vec::new(), Vec::new());
    if let Some((against, x, y)) = other {
        ratios_before.extend(before.against_cell(against.clone(), x));
        ratios_after.extend(after.against_cell(against, y));
    }
    ratios_before.extend(before.against_embree());
    ratios_after.extend(after.against_embree());
    let quotients: Vec<Quotient> = (ratios_before.iter())
        .filter_map(|x| {
            let same = ratios_after.iter().find(|y| y.against == x.against);
            Some(quotient(x, same?))
        })
        .collect();
    if quotients.is_empty() {
        return None;
    }
    let (embree, methods): (Vec<&Quotient>, Vec<&Quotient>) =
        (quotients.iter()).partition(|q| q.against.is_embree());
    let embree = if same_embree { embree } else { Vec::new() };
    let grade = grade(&methods, &embree, baselines.is_some());
    Some(Speed {
        grade: match grade {
            Grade::Regression | Grade::Improvement if !judged => Grade::Changed,
            grade => grade,
        },
        quotients,
    })
}

/// Slower, faster or the same, by the quotients that count.
fn grade(methods: &[&Quotient], embree: &[&Quotient], to_baseline: bool) -> Grade {
    // Of two methods alone nobody knows which has changed; the baseline is the one that does not.
    let enough = !methods.is_empty() && (to_baseline || !embree.is_empty());
    let all = |quotients: &[&Quotient], says: &dyn Fn(&Quotient) -> bool| {
        quotients.iter().all(|q| says(q))
    };
    let says = |changed: &dyn Fn(&Quotient, f64) -> bool| {
        let clear = |q: &Quotient| changed(q, SLACK);
        let far_slack = match methods.is_empty() {
            true => LONE_SLACK,
            false => FAR_SLACK,
        };
        let far = |q: &Quotient| changed(q, far_slack);
        let each = enough && all(methods, &clear) && all(embree, &clear);
        each || (!embree.is_empty() && all(embree, &far))
    };
    let greatest = |q: &Quotient| q.interval.map(|[_, high]| high.max(q.of_least));
    let smallest = |q: &Quotient| q.interval.map(|[low, _]| low.min(q.of_least));
    if says(&|q, slack| greatest(q).is_some_and(|x| x < 1.0 / (1.0 + slack))) {
        Grade::Regression
    } else if says(&|q, slack| smallest(q).is_some_and(|x| x > 1.0 + slack)) {
        Grade::Improvement
    } else {
        Grade::Same
    }
}

fn quotient(before: &Ratio, after: &Ratio) -> Quotient {
    let resamples = before.resamples.iter().zip(&after.resamples);
    Quotient {
        against: before.against.clone(),
        reference: before.value,
        new: after.value,
        quotient: after.value / before.value,
        interval: interval(resamples.map(|(x, y)| y / x).collect()),
        of_least: after.of_least / before.of_least,
    }
}

/// The interval that leaves out as many resamples at either end; `None` of nothing.
fn interval(mut resamples: Vec<f64>) -> Option<[f64; 2]> {
    resamples.sort_by(f64::total_cmp);
    let tail = (resamples.len() as f64 * (1.0 - CONFIDENCE) / 2.0) as usize;
    let last = resamples.len().checked_sub(1 + tail)?;
    Some([resamples[tail], resamples[last]])
}

/// A cell among all that took turns with it.
struct Batch<'a> {
    cell: &'a Cell,
    /// Those that have times, the cell itself among them.
    cells: Vec<&'a Cell>,
    noise: Option<Noise>,
    build_noise: Option<Noise>,
    random: fastrand::Rng,
}

impl<'a> Batch<'a> {
    fn of(document: &'a Document, cell: &'a Cell, seed: u64) -> Batch<'a> {
        let cells = document.cells.iter().filter(|c| took_turns(c, cell));
        let cells: Vec<&Cell> = cells.filter(|c| !samples(c).is_empty()).collect();
        let embree = cell.embree.iter().flat_map(|embree| &embree.samples_ms);
        let (traces, builds): (Vec<_>, Vec<_>) = embree.partition(|(name, _)| name.contains('_'));
        let of_embree = |list: Vec<(&'a String, &'a Vec<f64>)>| {
            let lists = list.into_iter().map(|(_, samples)| samples.as_slice());
            lists.collect::<Vec<_>>()
        };
        let ours = cells.iter().map(|c| samples(c));
        Batch {
            cell,
            noise: Noise::of(ours.chain(of_embree(traces))),
            build_noise: Noise::of(of_embree(builds)),
            cells,
            random: fastrand::Rng::with_seed(seed),
        }
    }

    /// The cell that the acceleration ratio of this one is against, if that is another.
    fn baseline(&self) -> Option<&'a Cell> {
        let key = &self.cell.key;
        let is_it = |c: &&Cell| {
            c.key.method == Method::Afra2012.name()
                && c.key.precision == key.precision
                && is_baseline(&c.key.parameters, &key.parameters)
        };
        let baseline = self.cells.iter().copied().find(is_it)?;
        (!std::ptr::eq(baseline, self.cell)).then_some(baseline)
    }

    /// The cells of other methods in the same precision.
    fn other_methods(&self) -> impl Iterator<Item = &'a Cell> {
        let (key, others) = (&self.cell.key, self.cells.iter().copied());
        others.filter(|c| c.key.method != key.method && c.key.precision == key.precision)
    }

    /// `None` if one of them has no times.
    fn against_cell(&mut self, against: Against, other: &Cell) -> Option<Ratio> {
        let rounds = samples(other).len();
        let theirs = [median(samples(other))?, least(samples(other))];
        self.ratio(against, theirs, |chance| chance.of_trace(rounds))
    }

    /// Both ratios, if there are times of Embree and of the cell.
    fn against_embree(&mut self) -> Vec<Ratio> {
        let embree = self.cell.embree.as_ref();
        let Some(Best { total, trace }) = embree.and_then(|e| Best::of(&e.samples_ms)) else {
            return Vec::new();
        };
        let build_share = total.build_ms / total.total_ms();
        let of_total = [total.total_ms(), least(total.builds) + least(total.traces)];
        let of_trace = [trace.trace_ms, least(trace.traces)];
        let ratios = [
            self.ratio(Against::EmbreeTotal, of_total, |chance| {
                build_share * chance.of_build(total.builds.len())
                    + (1.0 - build_share) * chance.of_trace(total.traces.len())
            }),
            self.ratio(Against::EmbreeTrace, of_trace, |chance| {
                chance.of_trace(trace.traces.len())
            }),
        ];
        ratios.into_iter().flatten().collect()
    }

    /// Times, median and least, over ours. `factor` draws what chance may make of the median.
    fn ratio(
        &mut self,
        against: Against,
        theirs: [f64; 2],
        factor: impl Fn(&mut Chance) -> f64,
    ) -> Option<Ratio> {
        let ours = samples(self.cell);
        let rounds = ours.len();
        let value = theirs[0] / median(ours)?;
        let mut chance = self.noise.as_ref().map(|noise| Chance {
            noise,
            build_noise: self.build_noise.as_ref(),
            random: &mut self.random,
        });
        let resamples = chance.iter_mut().flat_map(|chance| {
            (0..RESAMPLES).map(|_| value * factor(chance) / chance.of_trace(rounds))
        });
        Some(Ratio {
            against,
            value,
            of_least: theirs[1] / least(ours),
            resamples: resamples.collect(),
        })
    }
}

/// Draws factors that chance may put on medians.
struct Chance<'a> {
    noise: &'a Noise,
    build_noise: Option<&'a Noise>,
    random: &'a mut fastrand::Rng,
}

impl Chance<'_> {
    fn of_trace(&mut self, samples: usize) -> f64 {
        self.noise.of_median(samples, self.random)
    }

    fn of_build(&mut self, samples: usize) -> f64 {
        let noise = self.build_noise;
        noise.map_or(1.0, |noise| noise.of_median(samples, self.random))
    }
}

fn samples(cell: &Cell) -> &[f64] {
    cell.samples_ms.as_deref().unwrap_or_default()
}

/// Whether both were measured in turns: two cells of a batch may be of two runs that were merged,
/// but then the times of Embree are not the same to the last digit. (Cells that are set against
/// different modes of Embree do not count: nothing shows that they took turns.)
fn took_turns(a: &Cell, b: &Cell) -> bool {
    a.key.batch() == b.key.batch() && a.embree == b.embree
}
