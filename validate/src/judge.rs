//! Says whether answers are right, by the exact arbiter ([`crate::exact`]).
//!
//! An answer is right if it is that of exact arithmetic, t rounded within the bounds of the kernel
//! that gave it. If it is not, it may still be one to which float32 rounds: at an edge, at an end of
//! the interval, or between hits closer than the bounds of the kernel can tell ([`crate::bounds`],
//! [`crate::watertight`]). It is wrong if no rounding within these bounds leads to it. Of a watertight
//! kernel a lost ray is wrong, too, wherever it passes: one that goes through a surface that no
//! rounding opens. The exact kernel has no bounds: what is not right is wrong.

use crate::bounds::{Formula, Kernel, Pair};
use crate::exact::{Arbiter, Found, Nearest, Reach, can_be_hit, meet};
use crate::watertight::Sheared;
use dacrt::MISS;
use dacrt::{Batch, Hits, Mesh, Ray};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What was answered for all rays of a batch.
#[derive(Clone, Copy, Debug)]
pub enum Answers<'a> {
    /// Nearest hits.
    Nearest(&'a Hits),
    /// Any hit: 0 for a free ray, anything else for an occluded one.
    Any(&'a [u8]),
}

impl Answers<'_> {
    /// Number of rays.
    pub fn len(&self) -> usize {
        match self {
            Answers::Nearest(hits) => hits.len(),
            Answers::Any(occluded) => occluded.len(),
        }
    }

    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether these are nearest hits.
    pub fn is_nearest(&self) -> bool {
        matches!(self, Answers::Nearest(_))
    }

    /// The answer for ray `i`.
    ///
    /// # Panics
    /// If there is no such ray.
    pub fn get(&self, i: usize) -> Answer {
        match self {
            Answers::Nearest(hits) => match (hits.t[i], hits.prim[i]) {
                (f32::INFINITY, MISS) => Answer::Miss,
                (t, prim) => Answer::Hit { t, prim },
            },
            Answers::Any(occluded) if occluded[i] == 0 => Answer::Free,
            Answers::Any(_) => Answer::Occluded,
        }
    }
}

/// What was answered for one ray.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// The nearest hit: none.
    Miss,
    /// The nearest hit.
    Hit {
        /// Distance in units of the direction's length.
        #[serde(with = "crate::json_float")]
        #[schemars(schema_with = "crate::json_float::json_schema")]
        t: f32,
        /// Number of the triangle.
        prim: u32,
    },
    /// Any hit: none.
    Free,
    /// Any hit: there is one.
    Occluded,
}

/// What the judge says of one answer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// That of exact arithmetic, t within the bounds.
    Right,
    /// Not that of exact arithmetic, but float32 may round to it: at an edge, at an end of the
    /// interval, or between hits closer than the bounds can tell.
    WithinBounds,
    /// Wrong by more than the bounds.
    Wrong(Wrong),
    /// Not judged: float32 products may overflow for this ray and scene.
    OutOfRange,
}

impl Verdict {
    /// Whether the answer is wrong.
    pub fn is_wrong(self) -> bool {
        matches!(self, Verdict::Wrong(_))
    }
}

/// Why an answer is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wrong {
    /// Neither a hit nor a miss: no such triangle, or one that is invalid or has no area.
    NoSuchTriangle,
    /// The ray is invalid, so it misses.
    InvalidRay,
    /// The ray does not meet this triangle.
    NotHit,
    /// The ray meets the triangle, but not at this t; or this t is outside the ray's interval or
    /// the triangle's box.
    Distance {
        /// Where it does; `None` if it is parallel to the plane.
        t: Option<f64>,
        /// How far off float32 may be; `None` if there is no limit but interval and box.
        bound: Option<f64>,
    },
    /// There is a nearer hit.
    Nearer {
        /// The triangle.
        prim: u32,
        /// Where it is hit.
        t: f64,
    },
    /// Occluded by nothing.
    NothingHit,
    /// Lost by a watertight kernel: the ray goes through a surface at an edge or a corner.
    Leak {
        /// Where the kernel hits that surface at the latest.
        t: f64,
    },
}

/// What is said of the answers for one ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The nearest hit in exact arithmetic.
    pub nearest: Option<Nearest>,
    /// What the judge says of each answer.
    pub verdicts: Vec<Verdict>,
}

/// What there is to say of the claim that a kernel hits a triangle at some t.
#[derive(Clone, Copy, Debug)]
pub struct Claim {
    /// Where the triangle's plane is.
    pub t: f64,
    /// How far from it the kernel's t may be.
    pub bound: f64,
    /// Whether the kernel may find the ray inside all edges.
    pub possible: bool,
    /// Whether the kernel may give this t.
    pub accepted: bool,
}

/// A hit that a kernel must find.
#[derive(Clone, Copy, Debug)]
struct Clear {
    prim: u32,
    t: f64,
    /// The greatest t that it may give.
    latest: f64,
}

impl Clear {
    fn wrong(&self) -> Wrong {
        let &Clear { prim, t, .. } = self;
        Wrong::Nearer { prim, t }
    }
}

/// Judges answers on one mesh.
pub struct Judge<'m> {
    arbiter: Arbiter<'m>,
    /// Largest coordinate in size.
    size: f64,
}

impl<'m> Judge<'m> {
    /// Looks through the triangles, as long as [`Arbiter::new`].
    pub fn new(mesh: &'m Mesh) -> Judge<'m> {
        let bounds = mesh.bounds();
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        Judge {
            arbiter: Arbiter::new(mesh),
            // That of a mesh without triangles is infinite.
            size: if largest.is_finite() {
                largest.into()
            } else {
                0.0
            },
        }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'m Mesh {
        self.arbiter.mesh()
    }

    /// The claim that a kernel hits a triangle at `t`; none if the ray or the triangle is invalid,
    /// the triangle has no area or does not exist.
    pub fn claim(&self, kernel: Kernel, ray: &Ray, t: f32, prim: u32) -> Option<Claim> {
        let mesh = self.mesh();
        if !ray.is_valid() || !can_be_hit(mesh, prim) {
            return None;
        }
        let triangle = &mesh.triangles()[prim as usize];
        let by_formula = |formula| {
            let pair = Pair::new(ray, triangle);
            Claim {
                t: pair.t,
                bound: pair.t_bound_of(formula),
                possible: pair.possible,
                accepted: pair.accepts(formula, t),
            }
        };
        Some(match kernel {
            Kernel::Fast => by_formula(Formula::Fast),
            Kernel::EmbreeFast => by_formula(Formula::EmbreeFast),
            Kernel::EmbreeRobust => by_formula(Formula::EmbreeRobust),
            Kernel::Watertight => {
                let sheared = Sheared::new(ray, triangle);
                Claim {
                    t: sheared.t,
                    bound: sheared.t_bound,
                    possible: sheared.possible,
                    accepted: sheared.accepts(t),
                }
            }
            Kernel::Exact => {
                let exact = meet(ray, triangle);
                Claim {
                    t: exact.as_ref().map_or(f64::NAN, |exact| exact.to_f64()),
                    bound: 0.0,
                    possible: exact.is_some(),
                    accepted: exact.is_some_and(|exact| exact.to_f32() == t),
                }
            }
        })
    }

    /// Judges the answers for some rays of a batch: for each of `rays` (numbers in the batch) a
    /// judgement with a verdict on each of `answers`, in their order.
    ///
    /// Costs about 10 µs a ray and core, on all cores; half as much again for the watertight kernel.
    ///
    /// # Panics
    /// If a number of a ray or the length of the answers does not fit the batch.
    pub fn judge(
        &self,
        batch: &Batch,
        rays: &[u32],
        answers: &[(Kernel, Answers)],
    ) -> Vec<Judgement> {
        let of = |&i: &u32| {
            let ray = batch.ray(i as usize);
            let found = self.arbiter.find(&ray);
            let verdicts = answers.iter().map(|(kernel, answers)| {
                self.verdict(&ray, *kernel, answers.get(i as usize), &found)
            });
            Judgement {
                verdicts: verdicts.collect(),
                nearest: found.nearest,
            }
        };
        rays.par_iter().map(of).collect()
    }

    /// Whether no float32 product of the kernel can overflow: six products of an edge, a distance
    /// to a corner, and the direction or another edge, well below 3.4e38. Holds wherever the
    /// precision `fast` promises right hits (sizes up to 1e9).
    fn in_range(&self, ray: &Ray) -> bool {
        let edge = 2.0 * self.size;
        let corner = self.size + ray.origin.abs().max_element() as f64;
        let direction = ray.direction.abs().max_element() as f64;
        let product = edge * corner.max(edge) * direction.max(corner).max(edge);
        6.0 * product < 1e37 && direction < 1e37 && corner < 1e37
    }

    fn verdict(&self, ray: &Ray, kernel: Kernel, answer: Answer, found: &Found) -> Verdict {
        if !ray.is_valid() {
            return match answer {
                Answer::Miss | Answer::Free => Verdict::Right,
                _ => Verdict::Wrong(Wrong::InvalidRay),
            };
        }
        if kernel == Kernel::Exact {
            let nearest = found.nearest.as_ref();
            let wrong = self.not_exact(ray, answer, nearest);
            return wrong.map_or(Verdict::Right, Verdict::Wrong);
        }
        // The watertight kernel divides by the largest component.
        let divisible = kernel != Kernel::Watertight || ray.direction.abs().max_element() >= 1e-9;
        if !self.in_range(ray) || !divisible {
            return Verdict::OutOfRange;
        }
        if kernel != Kernel::Watertight {
            let clear = found.clear.as_ref().map(|&(prim, ref pair)| Clear {
                prim,
                t: pair.t,
                latest: pair.latest(),
            });
            return self.in_float32(ray, kernel, answer, found, clear, found.possible);
        }
        let reach = self.arbiter.reach(ray);
        let clear = reach.clear.map(|(prim, sheared)| Clear {
            prim,
            t: sheared.t,
            latest: sheared.latest(),
        });
        match self.in_float32(ray, kernel, answer, found, clear, reach.possible) {
            Verdict::WithinBounds => match self.leak(ray, answer, &reach) {
                Some(leak) => Verdict::Wrong(leak),
                None => Verdict::WithinBounds,
            },
            verdict => verdict,
        }
    }

    /// The verdict by the bounds of a kernel that rounds: `clear` is a hit that it must find, and it
    /// may find one if `possible`.
    fn in_float32(
        &self,
        ray: &Ray,
        kernel: Kernel,
        answer: Answer,
        found: &Found,
        clear: Option<Clear>,
        possible: bool,
    ) -> Verdict {
        match (answer, &found.nearest, clear) {
            (Answer::Miss | Answer::Free, None, _) | (Answer::Occluded, Some(_), _) => {
                Verdict::Right
            }
            (Answer::Miss | Answer::Free, _, Some(clear)) => Verdict::Wrong(clear.wrong()),
            (Answer::Miss | Answer::Free, Some(_), None) => Verdict::WithinBounds,
            (Answer::Occluded, None, _) if possible => Verdict::WithinBounds,
            (Answer::Occluded, None, _) => Verdict::Wrong(Wrong::NothingHit),
            (Answer::Hit { t, prim }, nearest, clear) => {
                if let Some(wrong) = self.wrong_hit(ray, kernel, t, prim, clear) {
                    return Verdict::Wrong(wrong);
                }
                match nearest {
                    Some(nearest) if nearest.prim == prim => Verdict::Right,
                    _ => Verdict::WithinBounds,
                }
            }
        }
    }

    /// Why no rounding within the bounds leads to this hit, if so.
    fn wrong_hit(
        &self,
        ray: &Ray,
        kernel: Kernel,
        t: f32,
        prim: u32,
        clear: Option<Clear>,
    ) -> Option<Wrong> {
        let Some(claim) = self.claim(kernel, ray, t, prim) else {
            return Some(Wrong::NoSuchTriangle);
        };
        if !claim.possible {
            return Some(Wrong::NotHit);
        }
        if !claim.accepted {
            let finite = |x: f64| x.is_finite().then_some(x);
            return Some(Wrong::Distance {
                t: finite(claim.t),
                bound: finite(claim.bound),
            });
        }
        // Our kernels find a clear hit at `latest` at the latest, and keep the least t: so their t
        // must not be greater. A reference rounds otherwise.
        let earliest = match kernel {
            Kernel::EmbreeFast | Kernel::EmbreeRobust => f64::from(t) - claim.bound,
            _ => f64::from(t),
        };
        clear.filter(|c| c.latest < earliest).map(|c| c.wrong())
    }

    /// The surface that the ray passes though no rounding opens it, if there is one.
    fn leak(&self, ray: &Ray, answer: Answer, reach: &Reach) -> Option<Wrong> {
        let ours = match answer {
            Answer::Hit { t, .. } => t.into(),
            Answer::Occluded => return None,
            Answer::Miss | Answer::Free => f64::INFINITY,
        };
        let t = self.arbiter.surface(ray, reach)?;
        (t < ours).then_some(Wrong::Leak { t })
    }

    /// Why this is not the answer of exact arithmetic, if so.
    fn not_exact(&self, ray: &Ray, answer: Answer, nearest: Option<&Nearest>) -> Option<Wrong> {
        let nearer = |n: &Nearest| Wrong::Nearer {
            prim: n.prim,
            t: n.t.to_f64(),
        };
        match (answer, nearest) {
            (Answer::Miss | Answer::Free, nearest) => nearest.map(nearer),
            (Answer::Occluded, Some(_)) => None,
            (Answer::Occluded, None) => Some(Wrong::NothingHit),
            (Answer::Hit { t, prim }, nearest) => {
                let wrong = self.wrong_hit(ray, Kernel::Exact, t, prim, None);
                wrong.or_else(|| nearest.filter(|n| n.prim != prim).map(nearer))
            }
        }
    }
}
