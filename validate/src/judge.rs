//! Says whether answers are right: float64 brute force of rays against all triangles.
//!
//! Nothing here knows of boxes over triangles, of batches or of orders: every ray is held against
//! every triangle. A first pass in float64 lanes keeps the pairs that float32 could possibly take
//! for hits; [`Pair`] then decides each within proven bounds. An answer is wrong only if no
//! rounding within the bounds of the kernel of record leads to it.

use crate::bounds::{Kernel, Pair, UNIT};
use dacrt::MISS;
use dacrt::{Batch, Hits, Mesh, Ray, Triangle};
use glam::DVec3;
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
    /// Right, whatever float32 rounds within the bounds.
    Right,
    /// Right or not, float32 may round to it: at an edge, at an end of the interval, or between
    /// hits closer than the bounds can tell.
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
}

/// Judges answers on one mesh.
pub struct Judge<'m> {
    mesh: &'m Mesh,
    /// Numbers of the triangles that can be hit.
    solid: Vec<u32>,
    /// Largest coordinate in size.
    size: f64,
}

/// Rays that go through the triangles together.
const LANES: usize = 32;

/// A pair that float32 could take for a hit.
struct Candidate {
    prim: u32,
    pair: Pair,
}

impl<'m> Judge<'m> {
    /// Looks through the triangles once.
    pub fn new(mesh: &'m Mesh) -> Judge<'m> {
        let triangles = mesh.triangles();
        let solid: Vec<u32> = (0..triangles.len() as u32)
            .filter(|&i| can_be_hit(&triangles[i as usize]))
            .collect();
        let size = solid
            .iter()
            .map(|&i| &triangles[i as usize])
            .flat_map(|t| [t.a, t.b, t.c])
            .map(|p| p.abs().max_element() as f64)
            .fold(0.0, f64::max);
        Judge { mesh, solid, size }
    }

    /// Number of triangles that each ray is held against.
    pub fn triangles(&self) -> usize {
        self.solid.len()
    }

    /// The mesh.
    pub fn mesh(&self) -> &'m Mesh {
        self.mesh
    }

    /// The pair of a ray and a triangle; none if one of them is invalid, the triangle has no area
    /// or does not exist.
    pub fn pair(&self, ray: &Ray, prim: u32) -> Option<Pair> {
        let triangle = self.mesh.triangles().get(prim as usize)?;
        (ray.is_valid() && can_be_hit(triangle)).then(|| Pair::new(ray, triangle))
    }

    /// Judges the answers for some rays of a batch: for each of `rays` (numbers in the batch) one
    /// verdict on each of `answers`, in their order.
    ///
    /// Costs about a nanosecond a ray and triangle and core, on all cores.
    ///
    /// # Panics
    /// If a number of a ray or the length of the answers does not fit the batch.
    pub fn judge(
        &self,
        batch: &Batch,
        rays: &[u32],
        answers: &[(Kernel, Answers)],
    ) -> Vec<Vec<Verdict>> {
        rays.par_chunks(LANES)
            .flat_map_iter(|numbers| {
                let rays: Vec<Ray> = numbers.iter().map(|&i| batch.ray(i as usize)).collect();
                let candidates = self.candidates(&rays);
                numbers
                    .iter()
                    .zip(rays)
                    .zip(candidates)
                    .map(|((&i, ray), candidates)| {
                        answers
                            .iter()
                            .map(|(kernel, answers)| {
                                let answer = answers.get(i as usize);
                                self.verdict(&ray, *kernel, answer, candidates.as_deref())
                            })
                            .collect()
                    })
                    .collect::<Vec<_>>()
            })
            .collect()
    }

    /// For each ray all triangles that float32 may take for hits; none for a ray out of range.
    fn candidates(&self, rays: &[Ray]) -> Vec<Option<Vec<Candidate>>> {
        let in_range = |ray: &Ray| !ray.is_valid() || self.in_range(ray);
        let mut found: Vec<_> = rays.iter().map(|r| in_range(r).then(Vec::new)).collect();
        let block = Block::new(rays, |ray| ray.is_valid() && self.in_range(ray));
        sweep(&block, self.mesh.triangles(), &self.solid, |lane, prim| {
            let pair = Pair::new(&rays[lane], &self.mesh.triangles()[prim as usize]);
            if pair.possible
                && let Some(found) = &mut found[lane]
            {
                found.push(Candidate { prim, pair });
            }
        });
        found
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

    fn verdict(
        &self,
        ray: &Ray,
        kernel: Kernel,
        answer: Answer,
        candidates: Option<&[Candidate]>,
    ) -> Verdict {
        let Some(candidates) = candidates else {
            return Verdict::OutOfRange;
        };
        if !ray.is_valid() {
            return match answer {
                Answer::Miss | Answer::Free => Verdict::Right,
                _ => Verdict::Wrong(Wrong::InvalidRay),
            };
        }
        let hits = || candidates.iter().filter(|c| c.pair.within_bounds());
        let nearest_clear = candidates
            .iter()
            .filter(|c| c.pair.clear())
            .min_by(|x, y| x.latest().total_cmp(&y.latest()));
        match answer {
            Answer::Miss | Answer::Free => match nearest_clear {
                Some(c) => Verdict::Wrong(c.nearer()),
                None if hits().next().is_none() => Verdict::Right,
                None => Verdict::WithinBounds,
            },
            Answer::Occluded => match nearest_clear {
                Some(_) => Verdict::Right,
                None if hits().next().is_some() => Verdict::WithinBounds,
                None => Verdict::Wrong(Wrong::NothingHit),
            },
            Answer::Hit { t, prim } => {
                let Some(pair) = self.pair(ray, prim) else {
                    return Verdict::Wrong(Wrong::NoSuchTriangle);
                };
                if !pair.possible {
                    return Verdict::Wrong(Wrong::NotHit);
                }
                if !pair.accepts(kernel, t) {
                    let finite = |x: f64| x.is_finite().then_some(x);
                    return Verdict::Wrong(Wrong::Distance {
                        t: finite(pair.t),
                        bound: finite(pair.t_bound_of(kernel)),
                    });
                }
                // The kernel of record finds a clear hit at `latest` at the latest, and keeps the
                // least t: so its t must not be greater. A reference rounds otherwise.
                let earliest = match kernel {
                    Kernel::Fast => t as f64,
                    _ => t as f64 - pair.t_bound_of(kernel),
                };
                if let Some(c) = nearest_clear
                    && c.latest() < earliest
                {
                    return Verdict::Wrong(c.nearer());
                }
                let alone = hits().all(|c| c.prim == prim || c.earliest() > t as f64);
                if pair.clear() && alone {
                    Verdict::Right
                } else {
                    Verdict::WithinBounds
                }
            }
        }
    }
}

impl Candidate {
    fn earliest(&self) -> f64 {
        // NaN if the ray is parallel to the plane: then it may be anywhere.
        let t = self.pair.t - self.pair.t_bound;
        if t.is_nan() { f64::NEG_INFINITY } else { t }
    }

    fn latest(&self) -> f64 {
        self.pair.t + self.pair.t_bound
    }

    fn nearer(&self) -> Wrong {
        Wrong::Nearer {
            prim: self.prim,
            t: self.pair.t,
        }
    }
}

/// Valid, and with an area: the float64 cross product of the edges is not zero.
fn can_be_hit(triangle: &Triangle) -> bool {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
    triangle.is_valid() && (b - a).cross(c - a) != DVec3::ZERO
}

/// Rays in lanes. Lanes without a ray hold NaN, which fails every comparison.
struct Block {
    origin: [[f64; LANES]; 3],
    direction: [[f64; LANES]; 3],
    /// Sum of the sizes of the direction's components.
    length: [f64; LANES],
}

impl Block {
    fn new(rays: &[Ray], takes_part: impl Fn(&Ray) -> bool) -> Block {
        let mut block = Block {
            origin: [[f64::NAN; LANES]; 3],
            direction: [[f64::NAN; LANES]; 3],
            length: [f64::NAN; LANES],
        };
        for (i, ray) in rays.iter().enumerate().filter(|(_, r)| takes_part(r)) {
            for axis in 0..3 {
                block.origin[axis][i] = ray.origin[axis] as f64;
                block.direction[axis][i] = ray.direction[axis] as f64;
            }
            block.length[i] = ray.direction.as_dvec3().abs().element_sum();
        }
        block
    }

    /// Which rays could hit the triangle in float32: a coarse, cheap bound on the edge functions.
    ///
    /// With C = a − o and L the longer of the two edges, in 1-norms, the bounds of [`Pair`] are at
    /// most 7.1u |C||d|L for U and V and 7.1u L²|d| for den, so at most 17u L|d| (|C| + L) for
    /// U + V <= |den|. If the sign of den is uncertain, |den| is at most its bound and a hit for
    /// the other sign has U and V within the sum of all these of zero. So 64u holds in all cases.
    #[inline(always)]
    fn test(&self, triangle: &Triangle, flags: &mut [u64; LANES]) -> bool {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
        let (e1, e2) = (a - b, c - a);
        let n = e2.cross(e1);
        let edge = e1.abs().element_sum().max(e2.abs().element_sum());
        let bound = 64.0 * UNIT * edge;
        let mut any = 0;
        for (i, flag) in flags.iter_mut().enumerate() {
            let [cx, cy, cz] = [
                a.x - self.origin[0][i],
                a.y - self.origin[1][i],
                a.z - self.origin[2][i],
            ];
            let [dx, dy, dz] = [
                self.direction[0][i],
                self.direction[1][i],
                self.direction[2][i],
            ];
            let (rx, ry, rz) = (cy * dz - cz * dy, cz * dx - cx * dz, cx * dy - cy * dx);
            let den = n.x * dx + n.y * dy + n.z * dz;
            let sign = den.to_bits() & (1 << 63);
            let with_sign = |x: f64| f64::from_bits(x.to_bits() ^ sign);
            let u = with_sign(rx * e2.x + ry * e2.y + rz * e2.z);
            let v = with_sign(rx * e1.x + ry * e1.y + rz * e1.z);
            let slack = bound * self.length[i] * (cx.abs() + cy.abs() + cz.abs() + edge);
            *flag = ((u >= -slack) & (v >= -slack) & (u + v <= den.abs() + slack)) as u64;
            any |= *flag;
        }
        any != 0
    }
}

/// Calls `found(lane, prim)` for every pair that may be a hit, with the widest lanes there are.
fn sweep(block: &Block, triangles: &[Triangle], solid: &[u32], mut found: impl FnMut(usize, u32)) {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
        fn avx512(b: &Block, t: &[Triangle], s: &[u32], f: &mut dyn FnMut(usize, u32)) {
            sweep_lanes(b, t, s, f);
        }
        #[target_feature(enable = "avx2")]
        fn avx2(b: &Block, t: &[Triangle], s: &[u32], f: &mut dyn FnMut(usize, u32)) {
            sweep_lanes(b, t, s, f);
        }
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            // SAFETY: the processor has these instruction sets.
            return unsafe { avx512(block, triangles, solid, &mut found) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has this instruction set.
            return unsafe { avx2(block, triangles, solid, &mut found) };
        }
    }
    sweep_lanes(block, triangles, solid, &mut found);
}

#[inline(always)]
fn sweep_lanes(
    block: &Block,
    triangles: &[Triangle],
    solid: &[u32],
    found: &mut dyn FnMut(usize, u32),
) {
    let mut flags = [0; LANES];
    for &prim in solid {
        if block.test(&triangles[prim as usize], &mut flags) {
            for (lane, _) in flags.iter().enumerate().filter(|&(_, &flag)| flag != 0) {
                found(lane, prim);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;
    use glam::Vec3;

    /// Triangles of all shapes, and rays of which many pass close by.
    fn scene(random: &mut Rng) -> (Vec<Triangle>, Vec<Ray>) {
        let mut point = |size: i32| {
            let component = |random: &mut Rng| random.f32() * 2.0 - 1.0;
            let p = Vec3::from_array(std::array::from_fn(|_| component(random)));
            p * 2.0_f32.powi(random.i32(-size..=0))
        };
        let triangles: Vec<Triangle> = (0..500)
            .map(|i| {
                let (a, long) = (point(2), point(8));
                let needle = long * 0.4 + point(22);
                let c = if i % 2 == 0 { a + needle } else { a + point(8) };
                Triangle::new(a, a + long, c)
            })
            .collect();
        let rays = (0..LANES)
            .map(|i| {
                let t = triangles[7 * i];
                let target = t.a + (t.b - t.a) * 0.5 + point(24);
                let d = if i % 3 == 0 {
                    t.b - t.a + point(20)
                } else {
                    point(3)
                };
                Ray::new(target - 4.0 * d, d)
            })
            .collect();
        (triangles, rays)
    }

    #[test]
    fn the_first_pass_keeps_every_possible_pair_on_every_instruction_set() {
        let mut random = Rng::with_seed(1);
        let mut possible = 0;
        for _ in 0..50 {
            let (triangles, rays) = scene(&mut random);
            let solid: Vec<u32> = (0..triangles.len() as u32)
                .filter(|&i| can_be_hit(&triangles[i as usize]))
                .collect();
            let block = Block::new(&rays, |_| true);
            let mut kept = Vec::new();
            sweep(&block, &triangles, &solid, |lane, prim| {
                kept.push((prim, lane))
            });
            let mut portable = Vec::new();
            sweep_lanes(&block, &triangles, &solid, &mut |lane, prim| {
                portable.push((prim, lane));
            });
            assert_eq!(kept, portable);
            for &prim in &solid {
                for (lane, ray) in rays.iter().enumerate() {
                    if Pair::new(ray, &triangles[prim as usize]).possible {
                        possible += 1;
                        assert!(kept.binary_search(&(prim, lane)).is_ok(), "{prim} {ray:?}");
                    }
                }
            }
        }
        assert!(possible > 1000, "{possible}");
    }

    #[test]
    fn blocks_that_are_not_full_or_have_invalid_rays_keep_their_places() {
        let mesh = Mesh::new(vec![Triangle::new(Vec3::X, Vec3::Y, Vec3::Z)]);
        let hit = Ray::new(Vec3::ZERO, Vec3::ONE);
        let invalid = Ray::new(Vec3::ZERO, Vec3::ZERO);
        let found = Judge::new(&mesh).candidates(&[invalid, hit, Ray::new(Vec3::ZERO, -Vec3::X)]);
        let counts: Vec<usize> = found
            .iter()
            .map(|c| c.as_ref().map_or(9, Vec::len))
            .collect();
        assert_eq!(counts[..2], [0, 1]);
    }
}
