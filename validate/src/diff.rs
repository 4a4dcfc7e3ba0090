//! Every ray of a cell, ours against each reference.
//!
//! Rays on which the answers agree, up to what float32 rounding explains, are counted and done
//! with. All others go to the [`Judge`], and so do some random rays on which all may agree and be
//! wrong. The classes that need exact arithmetic stay empty until there is an exact arbiter;
//! `unexplained` stands in for them.

use crate::bounds::{Kernel, UNIT};
use crate::judge::{Answer, Answers, Judge, Verdict};
use crate::npy::ray_floats;
use dacrt::{Aabb, Batch, Mesh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Random rays judged in a cell, whether the answers differ or not.
const RANDOM_RAYS: usize = 1000;
/// Random rays are fewer where they would need more ray-triangle pairs than this.
const RANDOM_PAIRS: usize = 1_000_000_000;
/// Differing rays beyond this many ray-triangle pairs (minutes) are not judged and count as
/// unexplained: only a broken engine has so many.
const MOST_PAIRS: usize = 100_000_000_000;
/// Offending rays that are kept.
const MOST_OFFENDERS: usize = 100;
/// How many diameters from the origin a scene may be for [`Diff::is_finding`].
const FAR: f64 = 1e6;

/// What the validation of a cell found; `diff` of a result file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Diff {
    /// Against Embree's default mode.
    pub embree_fast: ReferenceDiff,
    /// Against Embree's robust mode.
    pub embree_robust: ReferenceDiff,
    /// Against the exact arbiter: not there yet.
    pub exact: Option<serde_json::Value>,
    /// Rays that differ from any reference.
    pub differing: u64,
    /// Rays that were judged: the differing ones and the random ones.
    pub judged: u64,
    /// How many of them were drawn at random.
    pub judged_random: u64,
    /// Judged rays that cannot be: float32 products may overflow.
    pub out_of_range: u64,
    /// Rays whose answer of ours the judge holds for wrong, or that it had no time for.
    pub unexplained: u64,
    /// The first of the unexplained rays.
    pub offending: Vec<Offender>,
}

/// Ours against one reference. Rays that differ are neither `same` nor `tie`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReferenceDiff {
    /// Same triangle and t apart by no more than our bound and the reference's, or no hit in both.
    /// Any hit: both occluded, or both free.
    pub same: u64,
    /// Same triangle, but our t is outside our bound.
    pub t_drift: Option<u64>,
    /// Two triangles, both hit up to the bounds, at distances closer than the bounds can tell.
    pub tie: u64,
    /// Float32 cannot tell which answer is right.
    pub edge: Option<u64>,
    /// Exact arithmetic sides with the reference.
    pub ours_wrong: Option<u64>,
    /// Exact arithmetic sides with us.
    pub reference_wrong: Option<u64>,
    /// Exact arithmetic sides with neither.
    pub both_wrong: Option<u64>,
    /// Rays that are neither same nor tie.
    pub differing: u64,
    /// Those of them for which the judge does not accept our answer.
    pub unexplained: u64,
    /// Greatest |t − t of the reference| / t of the reference where both hit the same triangle;
    /// `None` for any hit, or if there is no such ray.
    pub max_relative_t_error: Option<f64>,
    /// The 99.9th percentile of the same.
    pub p999_relative_t_error: Option<f64>,
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
    /// What the judge says of these three, in this order; `None` if it had no time.
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
    /// Whether there is something wrong that a run must report by its exit code: unexplained rays,
    /// on a scene within a million diameters of the origin (further away, float32 has no more than
    /// a few bits left for the scene, and "within the bounds" may mean anything).
    pub fn is_finding(&self, mesh: &Mesh) -> bool {
        self.unexplained > 0 && !is_far_away(&mesh.bounds())
    }
}

/// Whether a box is more than a million of its diameters from the origin.
fn is_far_away(bounds: &Aabb) -> bool {
    let distance = bounds.center().as_dvec3().length();
    distance > FAR * bounds.extent().as_dvec3().length()
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
    /// Takes the answers of both Embree modes for all rays of the batch and draws the random rays.
    ///
    /// # Panics
    /// If there are not as many answers as rays, or one is for nearest hits and one for any hit.
    pub fn new(
        judge: &'a Judge<'a>,
        batch: &'a Batch,
        embree_fast: Answers<'a>,
        embree_robust: Answers<'a>,
        seed: u64,
    ) -> Checker<'a> {
        assert_eq!(embree_fast.len(), batch.len());
        assert_eq!(embree_robust.len(), batch.len());
        assert_eq!(embree_fast.is_nearest(), embree_robust.is_nearest());
        let wanted = RANDOM_RAYS.min(RANDOM_PAIRS / judge.triangles().max(1));
        Checker {
            judge,
            batch,
            embree_fast,
            embree_robust,
            random: draw(batch.len(), wanted, seed),
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
        let (mut fast, fast_rays) = self.compare(ours, Kernel::EmbreeFast, self.embree_fast);
        let (mut robust, robust_rays) =
            self.compare(ours, Kernel::EmbreeRobust, self.embree_robust);
        let differing: BTreeSet<u32> = fast_rays.iter().chain(&robust_rays).copied().collect();

        let random = self.random.iter().copied();
        let all: BTreeSet<u32> = differing.iter().copied().chain(random).collect();
        let affordable = MOST_PAIRS / self.judge.triangles().max(1);
        let judged: Vec<u32> = all.iter().copied().take(affordable).collect();
        let answers = [
            (Kernel::Fast, ours),
            (Kernel::EmbreeFast, self.embree_fast),
            (Kernel::EmbreeRobust, self.embree_robust),
        ];
        let verdicts = self.judge.judge(self.batch, &judged, &answers);
        let verdicts: Vec<Option<[Verdict; 3]>> = verdicts
            .into_iter()
            .map(|v| Some([v[0], v[1], v[2]]))
            .chain(std::iter::repeat(None))
            .take(all.len())
            .collect();

        let wrong = |v: &Option<[Verdict; 3]>| v.is_none_or(|[ours, ..]| ours.is_wrong());
        let unexplained: Vec<(u32, Option<[Verdict; 3]>)> = all
            .into_iter()
            .zip(verdicts.iter().copied())
            .filter(|(_, v)| wrong(v))
            .collect();
        let among = |rays: &[u32]| {
            let found = unexplained
                .iter()
                .filter(|(i, _)| rays.binary_search(i).is_ok());
            found.count() as u64
        };
        fast.unexplained = among(&fast_rays);
        robust.unexplained = among(&robust_rays);
        Diff {
            embree_fast: fast,
            embree_robust: robust,
            exact: None,
            differing: differing.len() as u64,
            judged: judged.len() as u64,
            judged_random: self
                .random
                .iter()
                .filter(|i| judged.binary_search(i).is_ok())
                .count() as u64,
            out_of_range: verdicts
                .iter()
                .filter(|v| v.is_some_and(|v| v[0] == Verdict::OutOfRange))
                .count() as u64,
            unexplained: unexplained.len() as u64,
            offending: unexplained
                .iter()
                .take(MOST_OFFENDERS)
                .map(|&(index, verdicts)| self.offender(ours, index, verdicts))
                .collect(),
        }
    }

    /// Counts the rays of each class and lists, in order, those that differ.
    fn compare(
        &self,
        ours: Answers,
        kernel: Kernel,
        reference: Answers,
    ) -> (ReferenceDiff, Vec<u32>) {
        let mut diff = ReferenceDiff::default();
        let mut rays = Vec::new();
        let mut errors = Vec::new();
        for i in 0..self.batch.len() {
            let (ours, reference) = (ours.get(i), reference.get(i));
            match self.classify(i, ours, kernel, reference) {
                Class::Same => diff.same += 1,
                Class::Tie => diff.tie += 1,
                Class::Differs => rays.push(i as u32),
            }
            if let (
                Answer::Hit { t, prim },
                Answer::Hit {
                    t: other,
                    prim: same,
                },
            ) = (ours, reference)
                && prim == same
            {
                errors.push((t - other).abs() / other);
            }
        }
        diff.differing = rays.len() as u64;
        // NaN, of a reference at t = 0, is the greatest, and JSON has no number for it.
        let number = |error: f32| f64::from(error).min(f64::MAX);
        diff.max_relative_t_error = errors.iter().copied().max_by(f32::total_cmp).map(number);
        // Nearest rank.
        if let Some(rank) = (errors.len() * 999).div_ceil(1000).checked_sub(1) {
            let (_, error, _) = errors.select_nth_unstable_by(rank, f32::total_cmp);
            diff.p999_relative_t_error = Some(number(*error));
        }
        (diff, rays)
    }

    fn classify(&self, i: usize, ours: Answer, kernel: Kernel, reference: Answer) -> Class {
        let (
            Answer::Hit { t, prim },
            Answer::Hit {
                t: other,
                prim: other_prim,
            },
        ) = (ours, reference)
        else {
            return if ours == reference {
                Class::Same
            } else {
                Class::Differs
            };
        };
        let apart = (f64::from(t) - f64::from(other)).abs();
        // No bound is smaller than u|t| for ours and 6u|t| for Embree's, and mostly t is as near.
        if prim == other_prim && apart <= 5.0 * UNIT * f64::from(other) {
            return Class::Same;
        }
        let ray = self.batch.ray(i);
        let (Some(pair), Some(other_pair)) = (
            self.judge.pair(&ray, prim),
            self.judge.pair(&ray, other_prim),
        ) else {
            return Class::Differs;
        };
        let bounds = pair.t_bound + other_pair.t_bound_of(kernel);
        // Not being able to tell at all is no agreement.
        if !bounds.is_finite() || apart.is_nan() || apart > bounds {
            Class::Differs
        } else if prim == other_prim {
            Class::Same
        } else if pair.possible
            && pair.accepts(Kernel::Fast, t)
            && other_pair.possible
            && other_pair.accepts(kernel, other)
        {
            Class::Tie
        } else {
            Class::Differs
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

enum Class {
    Same,
    Tie,
    Differs,
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
    use glam::Vec3;

    #[test]
    fn draws_different_rays() {
        assert_eq!(draw(3, 5, 1), [0, 1, 2]);
        let drawn = draw(1001, 1000, 1);
        assert_eq!(drawn.len(), 1000);
        assert!(drawn.is_sorted() && drawn[999] <= 1000);
        assert_eq!(drawn, draw(1001, 1000, 1));
        assert_ne!(drawn, draw(1001, 1000, 2));
    }

    #[test]
    fn far_away_is_a_matter_of_diameters() {
        let at = |x: f32| Aabb {
            min: Vec3::new(x, 0.0, 0.0),
            max: Vec3::new(x + 2.0, 1.0, 1.0),
        };
        assert!(!is_far_away(&at(0.0)) && !is_far_away(&at(2e6)) && is_far_away(&at(3e6)));
    }
}
