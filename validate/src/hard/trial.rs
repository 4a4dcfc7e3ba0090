//! Traces the cases of a family with every contestant, and counts.

use super::results::{Counts, FamilyResult, Finding, Found, What};
use super::{Case, Expected, Family};
use crate::bounds::Kernel;
use crate::diff::Number;
use crate::embree::{Device, Quality, Query, Scene};
use crate::exact::{Nearest, meet};
use crate::judge::{Answer, Answers, Judge, Verdict};
use crate::npy::ray_floats;
use dacrt::{Hits, Isa, MISS, Mesh, Method, Precision, Ray, Tracer, Triangle, Workspace};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::time::Instant;

/// Findings of one kind that are kept of a case.
const MOST_FINDINGS: u64 = 3;

/// Who answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contestant {
    /// All methods on all instruction sets.
    Ours(Precision),
    /// `rtcIntersect1` on a tree of medium quality.
    Embree {
        /// In robust mode.
        robust: bool,
        /// With denormals taken for zero around its queries.
        ftz: bool,
    },
}

impl Contestant {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Contestant> {
        let modes = [(false, false), (true, false), (false, true), (true, true)];
        let embree = modes.map(|(robust, ftz)| Contestant::Embree { robust, ftz });
        Precision::ALL
            .map(Contestant::Ours)
            .into_iter()
            .chain(embree)
    }

    /// The name in results.
    pub fn name(self) -> &'static str {
        match self {
            Contestant::Ours(precision) => precision.name(),
            Contestant::Embree { robust, ftz } => match (robust, ftz) {
                (false, false) => "embree_fast",
                (true, false) => "embree_robust",
                (false, true) => "embree_fast_ftz",
                (true, true) => "embree_robust_ftz",
            },
        }
    }

    fn kernel(self) -> Kernel {
        match self {
            Contestant::Ours(precision) => Kernel::of(precision),
            Contestant::Embree { robust: false, .. } => Kernel::EmbreeFast,
            Contestant::Embree { robust: true, .. } => Kernel::EmbreeRobust,
        }
    }
}

/// One contestant's answers to a case.
#[derive(Clone, Debug)]
pub struct Answered {
    /// Who.
    pub contestant: Contestant,
    /// The nearest hits.
    pub hits: Hits,
    /// Ours: for each ray whether another method, instruction set or the any-hit query says
    /// otherwise.
    pub differs: Vec<bool>,
}

/// Traces a family and judges all answers.
///
/// # Errors
/// If Embree fails.
pub fn run(family: &Family, rays: usize, seed: u64, device: &Device) -> anyhow::Result<Outcome> {
    let mut outcome = Outcome::new(family);
    for case in family.cases(rays, seed) {
        let mut answers = Vec::new();
        for contestant in Contestant::all() {
            answers.push(match contestant {
                Contestant::Ours(precision) => {
                    let start = Instant::now();
                    let answered = ours(&case, precision);
                    outcome.result.milliseconds += start.elapsed().as_secs_f64() * 1e3;
                    answered
                }
                Contestant::Embree { robust, ftz } => {
                    let scene = Scene::build(device, &case.mesh, Quality::Medium, robust)?;
                    let mut hits = Hits::misses(case.batch.len());
                    match ftz {
                        true => outcome.mxcsr_ftz = scene.nearest_flushing(&case.batch, &mut hits),
                        false => scene.nearest(&case.batch, Query::Single, &mut hits),
                    }
                    Answered {
                        contestant,
                        hits,
                        differs: vec![false; case.batch.len()],
                    }
                }
            });
        }
        outcome.enter(&case, &answers);
    }
    Ok(outcome)
}

/// The answers of one precision by all methods on all instruction sets, nearest and any hit.
pub fn ours(case: &Case, precision: Precision) -> Answered {
    let (mesh, batch) = (&case.mesh, &case.batch);
    let by_method = |method: &Method| {
        let parameters = method.parameters();
        let mut workspace = Workspace::new(&parameters, batch.len(), mesh.len());
        let mut by_isa = Vec::new();
        for isa in Isa::available() {
            let tracer = Tracer::new(parameters)
                .with_isa(isa)
                .with_precision(precision);
            let mut hits = Hits::misses(batch.len());
            let mut occluded = vec![0; batch.len()];
            tracer.nearest(mesh, batch, &mut workspace, &mut hits);
            tracer.any(mesh, batch, &mut workspace, &mut occluded);
            by_isa.push((hits, occluded));
        }
        by_isa
    };
    let all: Vec<(Hits, Vec<u8>)> = Method::ALL.par_iter().flat_map_iter(by_method).collect();
    let first = all[0].0.clone();
    let same = |(hits, occluded): &(Hits, Vec<u8>), i: usize| {
        hits.prim[i] == first.prim[i]
            && hits.t[i].to_bits() == first.t[i].to_bits()
            && occluded[i] == u8::from(first.prim[i] != MISS)
    };
    let differs = (0..batch.len())
        .map(|i| !all.iter().all(|answers| same(answers, i)))
        .collect();
    Answered {
        contestant: Contestant::Ours(precision),
        hits: first,
        differs,
    }
}

/// What became of a family.
pub struct Outcome {
    /// The counts.
    pub result: FamilyResult,
    /// The first findings of each kind in each case.
    pub findings: Vec<Finding>,
    /// Control bits of MXCSR in the queries with denormals taken for zero.
    pub mxcsr_ftz: Option<u32>,
}

impl Outcome {
    /// Nothing counted so far.
    pub fn new(family: &Family) -> Outcome {
        Outcome {
            result: FamilyResult {
                name: family.name.to_owned(),
                what: family.what.to_owned(),
                source: family.source.to_owned(),
                rays: 0,
                hits: 0,
                promised: 0,
                expected: 0,
                arbiter_unexpected: 0,
                milliseconds: 0.0,
                contestants: BTreeMap::new(),
                findings: Vec::new(),
            },
            findings: Vec::new(),
            mxcsr_ftz: None,
        }
    }

    /// Judges the answers to a case, and counts.
    ///
    /// # Panics
    /// If there are not as many answers as rays.
    pub fn enter(&mut self, case: &Case, answers: &[Answered]) {
        let judge = Judge::new(&case.mesh);
        let all: Vec<u32> = (0..case.batch.len() as u32).collect();
        let of = |a: &Answered| a.contestant.kernel();
        let given: Vec<(Kernel, Answers)> = answers
            .iter()
            .map(|a| (of(a), Answers::Nearest(&a.hits)))
            .collect();
        let judgements = judge.judge(&case.batch, &all, &given);

        let mesh_promised = case.mesh.triangles().iter().all(triangle_promised);
        let mut counts = vec![Counts::default(); answers.len()];
        let before = self.result.findings.clone();
        for (i, (judgement, &expected)) in judgements.iter().zip(&case.expected).enumerate() {
            let ray = case.batch.ray(i);
            let nearest = judgement.nearest.as_ref();
            let exact = exact_answer(nearest);
            let promised = mesh_promised && ray_promised(&ray);
            self.result.rays += 1;
            self.result.hits += u64::from(nearest.is_some());
            self.result.promised += u64::from(promised);
            self.result.expected += u64::from(expected != Expected::Unknown);

            let mut found: Vec<(&'static str, What, Answer, Verdict)> = Vec::new();
            if !expected.met_by(exact) {
                self.result.arbiter_unexpected += 1;
                found.push(("arbiter", What::Arbiter, exact, Verdict::Right));
            }
            for (a, answered) in answers.iter().enumerate() {
                let (answer, verdict) = (given[a].1.get(i), judgement.verdicts[a]);
                let ours = match answered.contestant {
                    Contestant::Ours(precision) => Some(precision),
                    Contestant::Embree { .. } => None,
                };
                let to_the_bit =
                    ours == Some(Precision::Exact) || ours.is_some() && case.without_rounding;
                let error = match to_the_bit {
                    true => differs(answer, exact).then(|| kind(judge.mesh(), &ray, answer, exact)),
                    false => error(&judge, given[a].0, &ray, answer, nearest),
                };
                let count = &mut counts[a];
                match error {
                    None => {}
                    Some(Error::Lost) => count.lost += 1,
                    Some(Error::FalseHit) => count.false_hits += 1,
                    Some(Error::Wrong) => count.wrong += 1,
                }
                let beyond = error.is_some() && verdict.is_wrong();
                count.beyond_bounds += u64::from(beyond);
                count.not_judged += u64::from(verdict == Verdict::OutOfRange);
                count.unexpected += u64::from(!expected.met_by(answer));
                count.methods_differ += u64::from(answered.differs[i]);

                let name = answered.contestant.name();
                if to_the_bit && error.is_some() {
                    found.push((name, What::NotExact, answer, verdict));
                } else if ours == Some(Precision::Watertight)
                    && (case.closed && promised && error == Some(Error::Lost))
                {
                    found.push((name, What::Lost, answer, verdict));
                } else if ours.is_some() && promised && verdict.is_wrong() {
                    found.push((name, What::BeyondBounds, answer, verdict));
                }
                let excused = ours == Some(Precision::Fast)
                    && (!promised || is_grazing(&ray, judge.mesh(), answer));
                if answered.differs[i] && !excused {
                    found.push((name, What::MethodsDiffer, answer, verdict));
                }
            }
            for (contestant, what, answer, verdict) in found {
                if self.count(contestant, what)
                    <= rays_of(&before, contestant, what) + MOST_FINDINGS
                {
                    self.findings.push(Finding {
                        family: self.result.name.clone(),
                        case: case.name.to_owned(),
                        contestant: contestant.to_owned(),
                        what,
                        index: i as u32,
                        shared_origin: case.batch.shared_origin().is_some(),
                        ray: ray_floats(&ray).map(Number),
                        ray_bits: ray_floats(&ray).map(hexadecimal),
                        answer,
                        verdict,
                        exact,
                        triangles: corners(&case.mesh, [answer, exact]),
                    });
                }
            }
        }
        for (answered, count) in answers.iter().zip(&counts) {
            let name = answered.contestant.name().to_owned();
            self.result.contestants.entry(name).or_default().add(count);
        }
    }
}

impl Outcome {
    /// Counts a finding, and says how many of the kind there are now.
    fn count(&mut self, contestant: &str, what: What) -> u64 {
        let all = &mut self.result.findings;
        let is = |f: &Found| f.contestant == contestant && f.what == what;
        let place = all.iter().position(is).unwrap_or_else(|| {
            all.push(Found {
                contestant: contestant.to_owned(),
                what,
                rays: 0,
            });
            all.len() - 1
        });
        all[place].rays += 1;
        all[place].rays
    }
}

fn rays_of(found: &[Found], contestant: &str, what: What) -> u64 {
    let is = |f: &&Found| f.contestant == contestant && f.what == what;
    found.iter().find(is).map_or(0, |f| f.rays)
}

/// How an answer is not the exact one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Error {
    Lost,
    FalseHit,
    Wrong,
}

/// Whether the answer is not the exact one, t within the bound of the kernel.
fn error(
    judge: &Judge,
    kernel: Kernel,
    ray: &Ray,
    answer: Answer,
    nearest: Option<&Nearest>,
) -> Option<Error> {
    let Answer::Hit { t, prim } = answer else {
        return nearest.map(|_| Error::Lost);
    };
    let triangle = judge.mesh().triangles().get(prim as usize);
    let Some(met) = triangle.and_then(|triangle| meet(ray, triangle)) else {
        return Some(Error::FalseHit);
    };
    let claim = judge.claim(kernel, ray, t, prim);
    let bound = claim.map_or(0.0, |claim| claim.bound);
    // An infinite bound allows every t.
    let near = f64::abs(f64::from(t) - met.to_f64()) <= bound;
    let nearest = nearest.is_some_and(|nearest| nearest.t == met);
    (!near || !nearest).then_some(Error::Wrong)
}

/// What kind of error an answer is that is not the exact one to the bit.
fn kind(mesh: &Mesh, ray: &Ray, answer: Answer, exact: Answer) -> Error {
    let Answer::Hit { prim, .. } = answer else {
        return Error::Lost;
    };
    let triangle = mesh.triangles().get(prim as usize);
    match triangle.and_then(|triangle| meet(ray, triangle)) {
        Some(_) if exact != Answer::Miss => Error::Wrong,
        _ => Error::FalseHit,
    }
}

/// Whether a ray is so near to the plane of the triangle that it is said to hit (|cos| < 2⁻¹⁰ to the
/// normal) that no margin covers the error of t in `fast`: Mora's methods hold the triangle itself
/// against cells, and may lose the hit.
fn is_grazing(ray: &Ray, mesh: &Mesh, answer: Answer) -> bool {
    let Answer::Hit { prim, .. } = answer else {
        return false;
    };
    let triangle = &mesh.triangles()[prim as usize];
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
    let (normal, d) = ((b - a).cross(c - a), ray.direction.as_dvec3());
    normal.dot(d).abs() < normal.length() * d.length() / 1024.0
}

/// Whether two answers differ in any bit.
fn differs(a: Answer, b: Answer) -> bool {
    match (a, b) {
        (Answer::Hit { t, prim }, Answer::Hit { t: s, prim: other }) => {
            t.to_bits() != s.to_bits() || prim != other
        }
        _ => a != b,
    }
}

/// The exact hit as `exact` has to give it: t rounded once.
fn exact_answer(nearest: Option<&Nearest>) -> Answer {
    match nearest {
        None => Answer::Miss,
        Some(Nearest { prim, t }) => Answer::Hit {
            t: t.to_f32(),
            prim: *prim,
        },
    }
}

/// Whether a size is zero or within what `fast` and `watertight` promise right hits for.
fn size_promised(vector: Vec3) -> bool {
    let size = vector.abs().max_element();
    size == 0.0 || (1e-9..=1e9).contains(&size)
}

fn triangle_promised(t: &Triangle) -> bool {
    let of = [t.a, t.b, t.c, t.b - t.a, t.c - t.b, t.a - t.c];
    // Invalid ones are never hit, whatever their size.
    !t.is_valid() || of.into_iter().all(size_promised)
}

fn ray_promised(ray: &Ray) -> bool {
    !ray.is_valid() || size_promised(ray.origin) && size_promised(ray.direction)
}

fn corners(mesh: &Mesh, answers: [Answer; 2]) -> BTreeMap<u32, [String; 9]> {
    let triangle = |answer| match answer {
        Answer::Hit { prim, .. } => Some((prim, mesh.triangles().get(prim as usize)?)),
        _ => None,
    };
    let numbers = |t: &Triangle| {
        let corners = [t.a, t.b, t.c].map(|p| p.to_array());
        std::array::from_fn(|k| hexadecimal(corners[k / 3][k % 3]))
    };
    let hit = answers.into_iter().filter_map(triangle);
    hit.map(|(prim, t)| (prim, numbers(t))).collect()
}

fn hexadecimal(x: f32) -> String {
    format!("{:#010x}", x.to_bits())
}
