//! Every ray of a cell, ours against each reference.
//!
//! Rays on which the answers agree, up to what float32 rounding explains, are counted and done
//! with. All others go to the [`Judge`], who says by exact arithmetic who is right, and so do some
//! random rays on which all may agree and be wrong.

use crate::bounds::{Kernel, UNIT};
use crate::exact::Nearest;
use crate::judge::{Answer, Answers, Judge, Verdict, Wrong};
use crate::npy::ray_floats;
use dacrt::Batch;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Random rays judged in a cell, whether the answers differ or not, unless one says otherwise.
pub const RANDOM_RAYS: u32 = 1000;
/// Differing rays beyond this many (a minute's work) are not judged, which counts as wrong: only a
/// broken engine has so many.
pub const MOST_JUDGED: usize = 1_000_000;
/// Offending rays that are kept.
const MOST_OFFENDERS: usize = 100;

/// What the validation of a cell found; `diff` of a result file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Diff {
    /// Against Embree's default mode.
    pub embree_fast: ReferenceDiff,
    /// Against Embree's robust mode.
    pub embree_robust: ReferenceDiff,
    /// Against exact arithmetic, all rays that were judged; `None` in files from before there was an
    /// exact arbiter.
    pub exact: Option<ExactDiff>,
    /// Rays that differ from any reference.
    pub differing: u64,
    /// Rays that were judged: the differing ones and the random ones.
    pub judged: u64,
    /// How many of them were drawn at random.
    pub judged_random: u64,
    /// Rays that differ and were not judged, for there were more than 1,000,000; `None` in files from
    /// before there was an exact arbiter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_judged: Option<u64>,
    /// Judged rays of which float32 promises nothing, for products may overflow: each is `edge`.
    pub out_of_range: u64,
    /// Only in files from before there was an exact arbiter: rays whose answer of ours was not
    /// shown to be right within the bounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unexplained: Option<u64>,
    /// The first of the rays that our answer is wrong for, then of those not judged.
    pub offending: Vec<Offender>,
}

/// Ours against one reference. Each ray is in one class, but for those not judged. "The bounds" are
/// those of the rounding of float32 in our kernel. `None`: in files from before there was an exact
/// arbiter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferenceDiff {
    /// Same triangle and t apart by no more than our bound and the reference's, or no hit in both.
    /// Any hit: both occluded, or both free.
    pub same: u64,
    /// Same triangle, t further apart, and ours is outside our bound.
    pub t_drift: Option<u64>,
    /// Two triangles, both hit up to the bounds, at distances closer than the bounds can tell.
    pub tie: u64,
    /// Where the answers part, the ray is closer to an edge or corner, or t to an end of the
    /// interval, than the bounds: float32 may give either answer.
    pub edge: Option<u64>,
    /// Ours is wrong by more than the bounds, the reference's is not.
    pub ours_wrong: Option<u64>,
    /// The reference's is wrong by more than the bounds, ours is not.
    pub reference_wrong: Option<u64>,
    /// Both are wrong by more than the bounds.
    pub both_wrong: Option<u64>,
    /// Rays that are neither same nor tie.
    pub differing: u64,
    /// Only in files from before there was an exact arbiter: those of them for which our answer was
    /// not shown to be right within the bounds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unexplained: Option<u64>,
    /// Greatest |t − t of the reference| / t of the reference where both hit the same triangle;
    /// `None` for any hit, or if there is no such ray.
    pub max_relative_t_error: Option<f64>,
    /// The 99.9th percentile of the same.
    pub p999_relative_t_error: Option<f64>,
}

/// Ours against exact arithmetic, which is never wrong and has no bound of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExactDiff {
    /// Rays that were held against it: all that were judged.
    pub rays: u64,
    /// Classes and errors.
    #[serde(flatten)]
    pub classes: ReferenceDiff,
}

/// A ray with a wrong answer, ready to be traced again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Offender {
    /// Number in the batch.
    pub index: u32,
    /// ox oy oz tmin dx dy dz tmax, in decimals that read back as the same float32.
    pub ray: [Number; 8],
    /// The same as hexadecimal bits.
    pub ray_bits: [String; 8],
    /// Our answer.
    pub ours: Answer,
    /// That of Embree's default mode.
    pub embree_fast: Answer,
    /// That of Embree's robust mode.
    pub embree_robust: Answer,
    /// What the judge says of these three, in this order; `None` if there were too many.
    pub verdicts: Option<[Verdict; 3]>,
}

/// A float32 that JSON can hold, whatever it is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Number(
    #[serde(with = "crate::json_float")]
    #[schemars(schema_with = "crate::json_float::json_schema")]
    pub f32,
);

impl Diff {
    /// Rays that a run must report by its exit code: those for which our answer is wrong, and those
    /// that were too many to be judged.
    pub fn wrong(&self) -> u64 {
        match &self.exact {
            Some(exact) => exact.classes.wrong() + self.not_judged.unwrap_or(0),
            None => self.unexplained.unwrap_or(0),
        }
    }
}

impl ReferenceDiff {
    /// Rays for which our answer is wrong, whatever the reference's.
    pub fn wrong(&self) -> u64 {
        let classes = [self.t_drift, self.ours_wrong, self.both_wrong];
        classes.into_iter().flatten().sum()
    }

    /// Nothing counted, and nothing unknown.
    fn none() -> ReferenceDiff {
        ReferenceDiff {
            t_drift: Some(0),
            edge: Some(0),
            ours_wrong: Some(0),
            reference_wrong: Some(0),
            both_wrong: Some(0),
            ..ReferenceDiff::default()
        }
    }

    fn count(&mut self, class: Class) {
        let of = match class {
            Class::Same => return self.same += 1,
            Class::Tie => return self.tie += 1,
            Class::TDrift => &mut self.t_drift,
            Class::Edge => &mut self.edge,
            Class::OursWrong => &mut self.ours_wrong,
            Class::ReferenceWrong => &mut self.reference_wrong,
            Class::BothWrong => &mut self.both_wrong,
        };
        *of.get_or_insert(0) += 1;
    }

    /// Enters the relative errors of t.
    fn enter(&mut self, mut errors: Vec<f32>) {
        // NaN, of a reference at t = 0, is the greatest, and JSON has no number for it.
        let number = |error: f32| f64::from(error).min(f64::MAX);
        self.max_relative_t_error = errors.iter().copied().max_by(f32::total_cmp).map(number);
        // Nearest rank.
        if let Some(rank) = (errors.len() * 999).div_ceil(1000).checked_sub(1) {
            let (_, error, _) = errors.select_nth_unstable_by(rank, f32::total_cmp);
            self.p999_relative_t_error = Some(number(*error));
        }
    }
}

/// Checks the answers of several methods on one batch against one pair of references.
pub struct Checker<'a> {
    judge: &'a Judge<'a>,
    batch: &'a Batch,
    embree_fast: Answers<'a>,
    embree_robust: Answers<'a>,
    random: Vec<u32>,
    /// By hit hash: methods give the same bits, so all but the first check are free.
    known: Vec<(String, Diff)>,
}

impl<'a> Checker<'a> {
    /// Takes the answers of both Embree modes for all rays of the batch and draws so many random
    /// rays (all if there are no more).
    ///
    /// # Panics
    /// If there are not as many answers as rays, or one is for nearest hits and one for any hit.
    pub fn new(
        judge: &'a Judge<'a>,
        batch: &'a Batch,
        embree_fast: Answers<'a>,
        embree_robust: Answers<'a>,
        random_rays: u32,
        seed: u64,
    ) -> Checker<'a> {
        assert_eq!(embree_fast.len(), batch.len());
        assert_eq!(embree_robust.len(), batch.len());
        assert_eq!(embree_fast.is_nearest(), embree_robust.is_nearest());
        Checker {
            judge,
            batch,
            embree_fast,
            embree_robust,
            random: draw(batch.len(), random_rays as usize, seed),
            known: Vec::new(),
        }
    }

    /// Diffs every ray and judges those that differ. `hit_hash` is that of `ours` (see
    /// [`crate::hash`]): answers that were checked before are not checked again.
    ///
    /// # Panics
    /// If there are not as many answers as rays, or they are for the other kind of query.
    pub fn check(&mut self, ours: Answers, hit_hash: &str) -> Diff {
        if let Some((_, diff)) = self.known.iter().find(|(hash, _)| hash == hit_hash) {
            return diff.clone();
        }
        let diff = self.check_anew(ours);
        self.known.push((hit_hash.to_owned(), diff.clone()));
        diff
    }

    fn check_anew(&self, ours: Answers) -> Diff {
        assert_eq!(ours.len(), self.batch.len());
        assert_eq!(ours.is_nearest(), self.embree_fast.is_nearest());
        let (fast, fast_rays) = self.compare(ours, Kernel::EmbreeFast, self.embree_fast);
        let (robust, robust_rays) = self.compare(ours, Kernel::EmbreeRobust, self.embree_robust);
        let differing: BTreeSet<u32> = fast_rays.iter().chain(&robust_rays).copied().collect();

        let random = self.random.iter().copied();
        let judged = differing.iter().copied().take(MOST_JUDGED).chain(random);
        let judged: BTreeSet<u32> = judged.collect();
        let judged: Vec<u32> = judged.into_iter().collect();
        let not_judged = differing
            .iter()
            .filter(|i| judged.binary_search(i).is_err());
        let answers = [
            (Kernel::Fast, ours),
            (Kernel::EmbreeFast, self.embree_fast),
            (Kernel::EmbreeRobust, self.embree_robust),
        ];
        let judgements = self.judge.judge(self.batch, &judged, &answers);

        let mut references = [
            (fast, fast_rays, self.embree_fast),
            (robust, robust_rays, self.embree_robust),
        ];
        let mut exact = ExactDiff {
            rays: judged.len() as u64,
            classes: ReferenceDiff::none(),
        };
        let (mut errors, mut offending, mut out_of_range) = (Vec::new(), Vec::new(), 0);
        for (&index, judgement) in judged.iter().zip(&judgements) {
            let i = index as usize;
            let verdicts: [Verdict; 3] = std::array::from_fn(|k| judgement.verdicts[k]);
            let of_ours = (ours.get(i), verdicts[0]);
            for ((diff, rays, answers), verdict) in references.iter_mut().zip(&verdicts[1..]) {
                if rays.binary_search(&index).is_ok() {
                    diff.count(class(of_ours, (answers.get(i), *verdict)));
                }
            }
            let class = self.class_in_exact(i, of_ours, judgement.nearest.as_ref());
            exact.classes.count(class);
            exact.classes.differing += !matches!(class, Class::Same | Class::Tie) as u64;
            errors.extend(relative_error(of_ours.0, judgement.nearest.as_ref()));
            out_of_range += (verdicts[0] == Verdict::OutOfRange) as u64;
            if verdicts[0].is_wrong() && offending.len() < MOST_OFFENDERS {
                offending.push(self.offender(ours, index, Some(verdicts)));
            }
        }
        exact.classes.enter(errors);
        for &index in not_judged.clone().take(MOST_OFFENDERS - offending.len()) {
            offending.push(self.offender(ours, index, None));
        }
        let [(fast, ..), (robust, ..)] = references;
        Diff {
            embree_fast: fast,
            embree_robust: robust,
            exact: Some(exact),
            differing: differing.len() as u64,
            judged: judged.len() as u64,
            judged_random: self.random.len() as u64,
            not_judged: Some(not_judged.count() as u64),
            out_of_range,
            unexplained: None,
            offending,
        }
    }

    /// Counts the rays on which float32 agrees, and lists, in order, those that differ.
    fn compare(
        &self,
        ours: Answers,
        kernel: Kernel,
        reference: Answers,
    ) -> (ReferenceDiff, Vec<u32>) {
        let mut diff = ReferenceDiff::none();
        let mut rays = Vec::new();
        let mut errors = Vec::new();
        for i in 0..self.batch.len() {
            let (ours, reference) = (ours.get(i), reference.get(i));
            match self.agreement(i, ours, kernel, reference) {
                Some(class) => diff.count(class),
                None => rays.push(i as u32),
            }
            if let (Answer::Hit { t, .. }, Answer::Hit { t: other, .. }) = (ours, reference)
                && of_one_triangle(ours, reference)
            {
                errors.push((t - other).abs() / other);
            }
        }
        diff.differing = rays.len() as u64;
        diff.enter(errors);
        (diff, rays)
    }

    /// [`Class::Same`] or [`Class::Tie`]; none if the answers differ.
    fn agreement(
        &self,
        i: usize,
        ours: Answer,
        kernel: Kernel,
        reference: Answer,
    ) -> Option<Class> {
        let (
            Answer::Hit { t, prim },
            Answer::Hit {
                t: other,
                prim: other_prim,
            },
        ) = (ours, reference)
        else {
            return (ours == reference).then_some(Class::Same);
        };
        let apart = (f64::from(t) - f64::from(other)).abs();
        // No bound is smaller than u|t| for ours and 6u|t| for Embree's, and mostly t is as near.
        if prim == other_prim && apart <= 5.0 * UNIT * f64::from(other) {
            return Some(Class::Same);
        }
        let ray = self.batch.ray(i);
        let pair = self.judge.pair(&ray, prim)?;
        let other_pair = self.judge.pair(&ray, other_prim)?;
        let bounds = pair.t_bound + other_pair.t_bound_of(kernel);
        // Not being able to tell at all is no agreement.
        if !bounds.is_finite() || apart.is_nan() || apart > bounds {
            None
        } else if prim == other_prim {
            Some(Class::Same)
        } else {
            let both_hit = pair.possible
                && pair.accepts(Kernel::Fast, t)
                && other_pair.possible
                && other_pair.accepts(kernel, other);
            both_hit.then_some(Class::Tie)
        }
    }

    /// The class of a ray with exact arithmetic as the reference.
    fn class_in_exact(
        &self,
        i: usize,
        (ours, verdict): (Answer, Verdict),
        nearest: Option<&Nearest>,
    ) -> Class {
        match (verdict, ours, nearest) {
            (Verdict::Right, ..) => Class::Same,
            (Verdict::WithinBounds, Answer::Hit { t, prim }, Some(nearest)) => {
                let ray = self.batch.ray(i);
                let pairs = [prim, nearest.prim].map(|prim| self.judge.pair(&ray, prim));
                let bounds: f64 = pairs.iter().flatten().map(|pair| pair.t_bound).sum();
                let apart = (f64::from(t) - nearest.t.to_f64()).abs();
                match bounds.is_finite() && apart <= bounds {
                    true => Class::Tie,
                    false => Class::Edge,
                }
            }
            _ => {
                let exact = nearest.map_or(Answer::Miss, |nearest| Answer::Hit {
                    t: nearest.t.to_f32(),
                    prim: nearest.prim,
                });
                class((ours, verdict), (exact, Verdict::Right))
            }
        }
    }

    fn offender(&self, ours: Answers, index: u32, verdicts: Option<[Verdict; 3]>) -> Offender {
        let i = index as usize;
        let floats = ray_floats(&self.batch.ray(i));
        Offender {
            index,
            ray: floats.map(Number),
            ray_bits: floats.map(|x| format!("{:#010x}", x.to_bits())),
            ours: ours.get(i),
            embree_fast: self.embree_fast.get(i),
            embree_robust: self.embree_robust.get(i),
            verdicts,
        }
    }
}

/// What becomes of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Class {
    Same,
    TDrift,
    Tie,
    Edge,
    OursWrong,
    ReferenceWrong,
    BothWrong,
}

/// The class of a ray on which two answers differ, by what the judge says of them. Where neither is
/// wrong, float32 may give either.
fn class((ours, verdict): (Answer, Verdict), (other, of_other): (Answer, Verdict)) -> Class {
    let of_one_triangle = of_one_triangle(ours, other);
    match (verdict, of_other) {
        (Verdict::Wrong(Wrong::Distance { .. }), _) if of_one_triangle => Class::TDrift,
        (Verdict::Wrong(_), Verdict::Wrong(_)) => Class::BothWrong,
        (Verdict::Wrong(_), _) => Class::OursWrong,
        (_, Verdict::Wrong(_)) => Class::ReferenceWrong,
        _ => Class::Edge,
    }
}

fn of_one_triangle(a: Answer, b: Answer) -> bool {
    matches!((a, b), (Answer::Hit { prim, .. }, Answer::Hit { prim: other, .. }) if prim == other)
}

/// How far off our t is where we hit the right triangle.
fn relative_error(ours: Answer, nearest: Option<&Nearest>) -> Option<f32> {
    let (Answer::Hit { t, prim }, Some(nearest)) = (ours, nearest) else {
        return None;
    };
    let exact = nearest.t.to_f64();
    (prim == nearest.prim).then(|| ((f64::from(t) - exact) / exact).abs() as f32)
}

/// Up to `wanted` different numbers below `n`, in order.
fn draw(n: usize, wanted: usize, seed: u64) -> Vec<u32> {
    if wanted >= n {
        return (0..n as u32).collect();
    }
    let mut random = fastrand::Rng::with_seed(seed);
    let mut drawn = BTreeSet::new();
    while drawn.len() < wanted {
        drawn.insert(random.u32(0..n as u32));
    }
    drawn.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_different_rays() {
        assert_eq!(draw(3, 5, 1), [0, 1, 2]);
        let drawn = draw(1001, 1000, 1);
        assert_eq!(drawn.len(), 1000);
        assert!(drawn.is_sorted() && drawn[999] <= 1000);
        assert_eq!(drawn, draw(1001, 1000, 1));
        assert_ne!(drawn, draw(1001, 1000, 2));
    }
}
