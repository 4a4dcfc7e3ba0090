//! Every ray of a cell, ours against each reference.
//!
//! Rays on which the answers agree, up to what float32 rounding explains, are counted and done
//! with. All others go to the [`Judge`], who says by exact arithmetic who is right, and so do some
//! random rays on which all may agree and be wrong. In precision `exact` nothing explains another
//! triangle, so ties are judged, too.
//!
//! The random rays are a fair sample, so it is they that say how many answers of ours and of Embree
//! are not those of exact arithmetic, and how far off t is ([`Errors`]).

use crate::bounds::{Kernel, UNIT};
use crate::embree::Mode;
use crate::exact::{Nearest, meet};
use crate::judge::{Answer, Answers, Claim, Judge, Verdict, Wrong};
use crate::npy::ray_floats;
use dacrt::{Batch, Precision};
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
    /// Rays that were judged: the differing ones (in precision `exact` the ties, too) and the random
    /// ones.
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
    /// The random rays against exact arithmetic; `None` in files from before this was counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub errors: Option<SampleErrors>,
    /// The first of the rays that our answer is wrong for, then of those not judged.
    pub offending: Vec<Offender>,
}

/// Ours against one reference. Each ray is in one class, but for those not judged. "The bounds" are
/// those of the rounding of float32 in our kernel: in precision `watertight` of t alone, in `exact`
/// there are none, so that `tie` and `edge` excuse the reference only. `None`: in files from before
/// there was an exact arbiter.
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

/// How often answers for random rays are not those of exact arithmetic, bounds or not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampleErrors {
    /// How many rays were drawn; if as many as the batch has, it is all of them.
    pub rays: u64,
    /// Ours.
    pub ours: Errors,
    /// Of Embree's default mode.
    pub embree_fast: Errors,
    /// Of Embree's robust mode.
    pub embree_robust: Errors,
}

/// Answers that are not those of exact arithmetic, and how far off t is in those that are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Errors {
    /// Hits of a triangle that is not the nearest; of equally near ones each is right.
    pub wrong: u64,
    /// No hit, where there is one.
    pub lost: u64,
    /// A hit (any hit: occluded), where there is none.
    #[serde(rename = "false")]
    pub false_hits: u64,
    /// Those of these three to which rounding within the bounds may lead.
    pub within_bounds: u64,
    /// All answers to which it may not, distances of the right triangle included.
    pub beyond_bounds: u64,
    /// t where the right triangle is hit.
    #[serde(flatten)]
    pub t: DistanceErrors,
}

impl Errors {
    /// Answers that are not those of exact arithmetic, t aside.
    pub fn all(&self) -> u64 {
        self.wrong + self.lost + self.false_hits
    }
}

/// How far t is from the exact one; `None` for any hit, or if there is no hit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DistanceErrors {
    /// Greatest |t − exact t| / exact t.
    pub max_relative: Option<f64>,
    /// The 99.9th percentile of the same.
    pub p999_relative: Option<f64>,
    /// Greatest |t − exact t| over the distance of two neighbouring float32 there; at most 0.5 if t is
    /// rounded correctly.
    pub max_ulps: Option<f64>,
    /// The 99.9th percentile of the same.
    pub p999_ulps: Option<f64>,
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
    fn enter(&mut self, errors: Vec<f32>) {
        [self.max_relative_t_error, self.p999_relative_t_error] = largest(errors);
    }
}

/// The greatest value and the 99.9th percentile.
fn largest(mut errors: Vec<f32>) -> [Option<f64>; 2] {
    // NaN, of a reference at t = 0, is the greatest, and JSON has no number for it.
    let number = |error: f32| f64::from(error).min(f64::MAX);
    let greatest = errors.iter().copied().max_by(f32::total_cmp).map(number);
    // Nearest rank.
    let p999 = (errors.len() * 999)
        .div_ceil(1000)
        .checked_sub(1)
        .map(|rank| number(*errors.select_nth_unstable_by(rank, f32::total_cmp).1));
    [greatest, p999]
}

/// Checks the answers of several methods on one batch against one pair of references.
pub struct Checker<'a> {
    judge: &'a Judge<'a>,
    batch: &'a Batch,
    embree_fast: Answers<'a>,
    embree_robust: Answers<'a>,
    random: Vec<u32>,
    /// By precision and hit hash: methods give the same bits, so all but the first check are free.
    known: Vec<(Precision, String, Diff)>,
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

    /// Diffs every ray and judges those that differ, by what the precision promises. `hit_hash` is
    /// that of `ours` (see [`crate::hash`]): answers that were checked before are not checked again.
    ///
    /// # Panics
    /// If there are not as many answers as rays, or they are for the other kind of query.
    pub fn check(&mut self, precision: Precision, ours: Answers, hit_hash: &str) -> Diff {
        let known = |(p, hash, _): &&(Precision, String, Diff)| *p == precision && hash == hit_hash;
        if let Some((.., diff)) = self.known.iter().find(known) {
            return diff.clone();
        }
        let diff = self.check_anew(Kernel::of(precision), ours);
        let known = (precision, hit_hash.to_owned(), diff.clone());
        self.known.push(known);
        diff
    }

    /// The class of each ray against this mode of Embree, as they are counted in [`Diff`].
    ///
    /// # Panics
    /// If there are not as many answers as rays, or they are for the other kind of query.
    pub fn classes(&self, precision: Precision, ours: Answers, mode: Mode) -> Vec<Class> {
        assert_eq!(ours.len(), self.batch.len());
        assert_eq!(ours.is_nearest(), self.embree_fast.is_nearest());
        let by = (Kernel::of(precision), ours);
        let reference = match mode {
            Mode::Fast => (Kernel::EmbreeFast, self.embree_fast),
            Mode::Robust => (Kernel::EmbreeRobust, self.embree_robust),
        };
        let agreements: Vec<Option<Class>> = (0..self.batch.len())
            .map(|i| self.agreement(i, (by.0, ours.get(i)), (reference.0, reference.1.get(i))))
            .collect();
        let is_open = |class: &Option<Class>| match class {
            Some(Class::Tie) => by.0 == Kernel::Exact,
            class => class.is_none(),
        };
        let open = (0..).zip(&agreements).filter(|(_, class)| is_open(class));
        let open: Vec<u32> = open.map(|(i, _)| i).collect();
        let judgements = self.judge.judge(self.batch, &open, &[by, reference]);
        let judged = open.iter().zip(&judgements).map(|(&i, judgement)| {
            let of =
                |who: usize, answers: Answers| (answers.get(i as usize), judgement.verdicts[who]);
            let (ours, other) = (of(0, ours), of(1, reference.1));
            match agreements[i as usize] {
                Some(Class::Tie) if !ours.1.is_wrong() => Class::Tie,
                _ => class(ours, other),
            }
        });
        let mut judged = judged.collect::<Vec<Class>>().into_iter();
        let settled = agreements.iter().map(|class| match is_open(class) {
            true => judged.next(),
            false => *class,
        });
        settled.flatten().collect()
    }

    fn check_anew(&self, kernel: Kernel, ours: Answers) -> Diff {
        assert_eq!(ours.len(), self.batch.len());
        assert_eq!(ours.is_nearest(), self.embree_fast.is_nearest());
        let by = (kernel, ours);
        let fast = self.compare(by, (Kernel::EmbreeFast, self.embree_fast));
        let robust = self.compare(by, (Kernel::EmbreeRobust, self.embree_robust));
        let mut references = [fast, robust];
        let open: BTreeSet<u32> = (references.iter())
            .flat_map(|r| r.rays.iter().chain(&r.ties))
            .copied()
            .collect();

        let random = self.random.iter().copied();
        let judged = open.iter().copied().take(MOST_JUDGED).chain(random);
        let judged: BTreeSet<u32> = judged.collect();
        let judged: Vec<u32> = judged.into_iter().collect();
        let not_judged = open.iter().filter(|i| judged.binary_search(i).is_err());
        let answers = [
            by,
            (Kernel::EmbreeFast, self.embree_fast),
            (Kernel::EmbreeRobust, self.embree_robust),
        ];
        let judgements = self.judge.judge(self.batch, &judged, &answers);

        let mut sample: [ErrorCount; 3] = Default::default();
        let mut exact = ExactDiff {
            rays: judged.len() as u64,
            classes: ReferenceDiff::none(),
        };
        let (mut errors, mut offending, mut out_of_range) = (Vec::new(), Vec::new(), 0);
        for (&index, judgement) in judged.iter().zip(&judgements) {
            let i = index as usize;
            let verdicts: [Verdict; 3] = std::array::from_fn(|k| judgement.verdicts[k]);
            let nearest = judgement.nearest.as_ref();
            let of_ours = (ours.get(i), verdicts[0]);
            for (reference, verdict) in references.iter_mut().zip(&verdicts[1..]) {
                reference.judge(index, of_ours, *verdict);
            }
            let class = self.class_in_exact(i, kernel, of_ours, nearest);
            exact.classes.count(class);
            exact.classes.differing += !matches!(class, Class::Same | Class::Tie) as u64;
            errors.extend(distance_error(of_ours.0, nearest).map(|error| error.relative));
            if self.random.binary_search(&index).is_ok() {
                for ((count, (_, answers)), verdict) in sample.iter_mut().zip(answers).zip(verdicts)
                {
                    let also_nearest = |prim| self.also_nearest(i, prim, nearest);
                    count.add(answers.get(i), verdict, nearest, also_nearest);
                }
            }
            out_of_range += (verdicts[0] == Verdict::OutOfRange) as u64;
            if verdicts[0].is_wrong() && offending.len() < MOST_OFFENDERS {
                offending.push(self.offender(ours, index, Some(verdicts)));
            }
        }
        exact.classes.enter(errors);
        for &index in not_judged.clone().take(MOST_OFFENDERS - offending.len()) {
            offending.push(self.offender(ours, index, None));
        }
        let differing: BTreeSet<&u32> = references.iter().flat_map(|r| &r.rays).collect();
        let differing = differing.len() as u64;
        let [fast, robust] = references;
        let [of_ours, of_fast, of_robust] = sample.map(ErrorCount::errors);
        Diff {
            embree_fast: fast.diff,
            embree_robust: robust.diff,
            exact: Some(exact),
            differing,
            judged: judged.len() as u64,
            judged_random: self.random.len() as u64,
            not_judged: Some(not_judged.count() as u64),
            out_of_range,
            unexplained: None,
            errors: Some(SampleErrors {
                rays: self.random.len() as u64,
                ours: of_ours,
                embree_fast: of_fast,
                embree_robust: of_robust,
            }),
            offending,
        }
    }

    /// Counts the rays on which float32 agrees, and lists, in order, those that differ.
    fn compare<'b>(
        &self,
        (our_kernel, ours): (Kernel, Answers),
        (kernel, answers): (Kernel, Answers<'b>),
    ) -> Compared<'b> {
        let mut diff = ReferenceDiff::none();
        let (mut rays, mut ties) = (Vec::new(), Vec::new());
        let mut errors = Vec::new();
        for i in 0..self.batch.len() {
            let (ours, reference) = (ours.get(i), answers.get(i));
            match self.agreement(i, (our_kernel, ours), (kernel, reference)) {
                Some(Class::Tie) if our_kernel == Kernel::Exact => ties.push(i as u32),
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
        Compared {
            answers,
            diff,
            rays,
            ties,
        }
    }

    /// [`Class::Same`] or [`Class::Tie`]; none if the answers differ.
    fn agreement(
        &self,
        i: usize,
        (our_kernel, ours): (Kernel, Answer),
        (kernel, reference): (Kernel, Answer),
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
        // Embree's bound is no smaller than 6u|t|, and mostly t is as near.
        if prim == other_prim && apart <= 5.0 * UNIT * f64::from(other) {
            return Some(Class::Same);
        }
        let ray = self.batch.ray(i);
        let claim = self.judge.claim(our_kernel, &ray, t, prim)?;
        let other_claim = self.judge.claim(kernel, &ray, other, other_prim)?;
        let bounds = claim.bound + other_claim.bound;
        // Not being able to tell at all is no agreement.
        if !bounds.is_finite() || apart.is_nan() || apart > bounds {
            None
        } else if prim == other_prim {
            Some(Class::Same)
        } else {
            let hits = |claim: &Claim| claim.possible && claim.accepted;
            (hits(&claim) && hits(&other_claim)).then_some(Class::Tie)
        }
    }

    /// The class of a ray with exact arithmetic as the reference.
    fn class_in_exact(
        &self,
        i: usize,
        kernel: Kernel,
        (ours, verdict): (Answer, Verdict),
        nearest: Option<&Nearest>,
    ) -> Class {
        match (verdict, ours, nearest) {
            (Verdict::Right, ..) => Class::Same,
            (Verdict::WithinBounds, Answer::Hit { t, prim }, Some(nearest)) => {
                let ray = self.batch.ray(i);
                let claims = [prim, nearest.prim].map(|p| self.judge.claim(kernel, &ray, t, p));
                let bounds: f64 = claims.iter().flatten().map(|claim| claim.bound).sum();
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

    /// Whether another triangle is hit exactly as near as the nearest.
    fn also_nearest(&self, i: usize, prim: u32, nearest: Option<&Nearest>) -> bool {
        let triangle = self.judge.mesh().triangles().get(prim as usize);
        let t = triangle.and_then(|triangle| meet(&self.batch.ray(i), triangle));
        t.is_some() && t.as_ref() == nearest.map(|nearest| &nearest.t)
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

/// Ours against one reference, as it grows.
struct Compared<'a> {
    answers: Answers<'a>,
    diff: ReferenceDiff,
    /// Rays that are neither same nor tie, in order.
    rays: Vec<u32>,
    /// Rays that are a tie if ours is right, in order.
    ties: Vec<u32>,
}

impl Compared<'_> {
    /// Takes in what the judge says of the answers for a ray.
    fn judge(&mut self, index: u32, ours: (Answer, Verdict), verdict: Verdict) {
        let listed = |rays: &[u32]| rays.binary_search(&index).is_ok();
        let tie = listed(&self.ties);
        if tie && !ours.1.is_wrong() {
            self.diff.count(Class::Tie);
        } else if tie || listed(&self.rays) {
            let other = (self.answers.get(index as usize), verdict);
            self.diff.count(class(ours, other));
            self.diff.differing += tie as u64;
        }
    }
}

/// Errors as they are counted.
#[derive(Default)]
struct ErrorCount {
    errors: Errors,
    distances: Vec<DistanceError>,
}

impl ErrorCount {
    fn add(
        &mut self,
        answer: Answer,
        verdict: Verdict,
        nearest: Option<&Nearest>,
        also_nearest: impl FnOnce(u32) -> bool,
    ) {
        let errors = &mut self.errors;
        errors.beyond_bounds += verdict.is_wrong() as u64;
        let count = match (answer, nearest) {
            (Answer::Miss | Answer::Free, Some(_)) => &mut errors.lost,
            (Answer::Hit { .. } | Answer::Occluded, None) => &mut errors.false_hits,
            (Answer::Hit { prim, .. }, Some(exact))
                if prim != exact.prim && !also_nearest(prim) =>
            {
                &mut errors.wrong
            }
            _ => return self.distances.extend(distance_error(answer, nearest)),
        };
        *count += 1;
        errors.within_bounds += !verdict.is_wrong() as u64;
    }

    fn errors(self) -> Errors {
        let of = |error: fn(&DistanceError) -> f32| self.distances.iter().map(error).collect();
        let [max_relative, p999_relative] = largest(of(|error| error.relative));
        let [max_ulps, p999_ulps] = largest(of(|error| error.ulps));
        let t = DistanceErrors {
            max_relative,
            p999_relative,
            max_ulps,
            p999_ulps,
        };
        Errors { t, ..self.errors }
    }
}

/// What becomes of a ray: the fields of [`ReferenceDiff`], which say what they mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Class {
    Same,
    TDrift,
    Tie,
    Edge,
    OursWrong,
    ReferenceWrong,
    BothWrong,
}

impl Class {
    /// All but [`Class::Same`].
    pub const PARTED: [Class; 6] = [
        Class::Tie,
        Class::Edge,
        Class::ReferenceWrong,
        Class::OursWrong,
        Class::TDrift,
        Class::BothWrong,
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Class::Same => "same",
            Class::TDrift => "t drift",
            Class::Tie => "tie",
            Class::Edge => "edge",
            Class::OursWrong => "ours wrong",
            Class::ReferenceWrong => "Embree wrong",
            Class::BothWrong => "both wrong",
        }
    }
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

/// How far t is from the exact one.
#[derive(Clone, Copy, Debug)]
struct DistanceError {
    relative: f32,
    ulps: f32,
}

/// How far off the t of a hit is, if the nearest triangle is hit.
fn distance_error(answer: Answer, nearest: Option<&Nearest>) -> Option<DistanceError> {
    let (Answer::Hit { t, prim }, Some(nearest)) = (answer, nearest) else {
        return None;
    };
    let exact = nearest.t.to_f64();
    let off = (f64::from(t) - exact).abs();
    (prim == nearest.prim).then(|| DistanceError {
        relative: (off / exact) as f32,
        ulps: (off / ulp(exact)) as f32,
    })
}

/// The distance of two neighbouring float32 at `x` > 0: between the powers of two around it.
fn ulp(x: f64) -> f64 {
    const LEAST: f64 = f32::from_bits(1) as f64;
    let power = f64::from_bits(x.to_bits() & !((1 << 52) - 1));
    (power * f64::from(f32::EPSILON)).max(LEAST)
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
