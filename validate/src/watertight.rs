//! What the watertight kernel (Woop, Benthin, Wald 2013) may make of a ray, with bounds.
//!
//! Let z be the axis of the largest component of d, x and y the two others, u = 2⁻²⁴. The kernel
//! moves the origin to 0 and shears space so that the ray runs along z; with w = v − o for a corner v
//!
//! ```text
//! S = (d_x, d_y) / d_z,   p = (w_x, w_y) − S w_z,   z = w_z / d_z
//! U = p_C × p_B,   V = p_A × p_C,   W = p_B × p_A            (signs exact on the rounded p)
//! hit:  U, V, W all ≥ 0 or all ≤ 0, not all 0;   t = (U z_A + V z_B + W z_C) / (U + V + W),
//!       clamped into the padded slab interval of the triangle's box;   tmin < t ≤ tmax
//! ```
//!
//! **Edges.** Rounding `w` costs p_x an error of u |w_x| and of u |S_x w_z|, rounding `S` and the
//! product u |S_x w_z| each, rounding the difference u |p_x|; an fma leaves one out. Together
//!
//! δ_x = u (|w_x| + 3 |S_x w_z| + |p_x|),   never more than 6u |v − o|∞, for |S_x| ≤ 1,
//!
//! and likewise for y. Moving a corner by δ_x along x moves p_x by as much: so the kernel answers
//! *exactly*, but for a mesh whose corners are moved across z by at most δ, each of them the same way
//! in all triangles that have it. Where two components of d are equally large, the kernel may take
//! either as z: moved along the other axis, a corner moves p by up to 6u |v − o|∞ in both x and y, so
//! δ is 12u |v − o|∞ there.
//!
//! **Distance.** U, V, W of the moved corners are off by ΔU … (the products of δ and p), so t of the
//! moved triangle is off by Σ ΔU |z − t| / (|U + V + W| − Σ ΔU). Kahan's difference of products has
//! a relative error of 2u; with the difference w_z, the products and sums, the division by d_z before
//! or behind the sum and the last one, rounding adds u (8 Σ |U z| / |U + V + W| + 8 |t|) at most.
//!
//! **Surfaces.** Corners that move together keep a surface closed. Take the triangles that the ray
//! may hit when corners move by δ, and of these a part that hangs together by shared edges. If the
//! ray is not within δ of the part's rim (the edges that an odd number of its triangles have), then
//! the number of its triangles that the ray crosses is odd for all such moves or even for all. If it
//! is odd, the ray hits one of them, however the kernel rounds: a miss is a lost ray ([`Surfaces`]).
//! This holds for every shared edge, whether or not the whole mesh is closed; where it is even, the
//! ray only brushes an outline, and a miss is as good as a hit.
//!
//! All bounds are multiplied by 1.001 for terms of second order and for the rounding of float64.

use crate::bounds::{BOX_PADDING, SLAB_ROUNDINGS, TINY, UNIT};
use dacrt::{Ray, Triangle};
use glam::{BVec3, DVec2, DVec3, Vec3};

const SLACK: f64 = 1.001;
/// How far a box that suits the kernel may be enlarged, relative to the largest |v − o|∞ of its
/// corners: at least δ, generously.
const BOX_SHIFT: f64 = 32.0 * UNIT;

/// A valid ray, ready to shear corners.
struct Shear {
    origin: DVec3,
    axes: [usize; 3],
    slope: DVec2,
    per_z: f64,
    /// Whether another component of the direction is as large.
    tie: bool,
}

/// A sheared corner, how far it may be off in x and y, and its z.
#[derive(Clone, Copy)]
struct Corner {
    at: DVec2,
    off: DVec2,
    z: f64,
}

/// An edge function and how far it may be off.
#[derive(Clone, Copy)]
struct Edge {
    value: f64,
    bound: f64,
}

impl Shear {
    fn new(ray: &Ray) -> Shear {
        let (origin, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let z = d.abs().max_position();
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        Shear {
            origin,
            axes,
            slope: DVec2::new(d[axes[0]], d[axes[1]]) / d[z],
            per_z: 1.0 / d[z],
            tie: axes[..2].iter().any(|&k| d[k].abs() == d[z].abs()),
        }
    }

    fn corner(&self, v: Vec3) -> Corner {
        let w = v.as_dvec3() - self.origin;
        let [x, y, z] = self.axes.map(|k| w[k]);
        let (xy, sheared) = (DVec2::new(x, y), self.slope * z);
        let at = xy - sheared;
        let off = match self.tie {
            false => UNIT * (xy.abs() + 3.0 * sheared.abs() + at.abs()),
            true => DVec2::splat(12.0 * UNIT * w.abs().max_element()),
        };
        Corner {
            at,
            off: SLACK * off + TINY * (2.0 + z.abs()),
            z: z * self.per_z,
        }
    }
}

impl Corner {
    fn edge(&self, to: &Corner) -> Edge {
        let (p, q) = (self.at.abs(), to.at.abs());
        let bound = (p.x + self.off.x) * to.off.y
            + q.y * self.off.x
            + (p.y + self.off.y) * to.off.x
            + q.x * self.off.y;
        Edge {
            value: self.at.perp_dot(to.at),
            bound: SLACK * bound + TINY,
        }
    }
}

/// What float64 says about a ray and a triangle for the watertight kernel.
#[derive(Clone, Copy, Debug)]
pub struct Sheared {
    /// Distance of the plane; not finite if the ray is parallel to it.
    pub t: f64,
    /// Unclamped, the kernel's distance lies within `t ± t_bound`; infinite if some moving of the
    /// corners makes the ray parallel to the plane.
    pub t_bound: f64,
    /// Some moving of the corners puts the ray inside all edges.
    pub possible: bool,
    /// Every moving of the corners puts the ray inside all edges.
    pub inside: bool,
    /// Least and greatest distance that the kernel may give, clamped; none if it may give none.
    range: Option<(f64, f64)>,
    /// Whether the box lets the ray pass, not enlarged.
    in_box: bool,
    interval: (f64, f64),
}

impl Sheared {
    /// Evaluates a valid ray and a valid triangle of non-zero area, about 100 ns.
    pub fn new(ray: &Ray, triangle: &Triangle) -> Sheared {
        let shear = Shear::new(ray);
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|v| shear.corner(v));
        let edges = [c.edge(&b), a.edge(&c), b.edge(&a)];
        let all = |says: &dyn Fn(&Edge) -> bool| edges.iter().all(says);
        let possible = all(&|e| e.value >= -e.bound) || all(&|e| e.value <= e.bound);
        let inside = all(&|e| e.value > e.bound) || all(&|e| e.value < -e.bound);

        let sum: f64 = edges.iter().map(|e| e.value).sum();
        let left = sum.abs() - SLACK * edges.iter().map(|e| e.bound).sum::<f64>();
        let with_z = || edges.iter().zip([a.z, b.z, c.z]);
        let t = with_z().map(|(e, z)| e.value * z).sum::<f64>() / sum;
        let t_bound = if left > 0.0 {
            let moved: f64 = with_z().map(|(e, z)| e.bound * (z - t).abs()).sum();
            let sizes: f64 = with_z()
                .map(|(e, z)| (e.value.abs() + e.bound) * z.abs())
                .sum();
            let underflow = TINY * (1.0 + shear.per_z.abs()) * (1.0 + t.abs() + sizes / left);
            SLACK * ((moved + 8.0 * UNIT * sizes + 8.0 * underflow) / left + 8.0 * UNIT * t.abs())
                + TINY
        } else {
            f64::INFINITY
        };
        let clip = Clip::new(ray, triangle);
        let range = clip.widest.map(|(near, far)| {
            // What it is clamped to lies between the narrowest and the widest interval.
            let (first, last) = match t_bound.is_finite() {
                true => (t - t_bound, t + t_bound),
                false => (f64::NEG_INFINITY, f64::INFINITY),
            };
            let (latest_near, earliest_far) = clip.narrowest.unwrap_or((far, near));
            (
                near.max(first.min(earliest_far)),
                far.min(last.max(latest_near)),
            )
        });
        Sheared {
            t,
            t_bound,
            possible,
            inside,
            range,
            in_box: clip.narrowest.is_some(),
            interval: (ray.tmin.into(), ray.tmax.into()),
        }
    }

    /// The greatest distance that the kernel may give.
    pub fn latest(&self) -> f64 {
        self.range.map_or(f64::INFINITY, |(_, last)| last)
    }

    /// Whether the kernel must find this hit.
    pub fn clear(&self) -> bool {
        self.inside && self.counts()
    }

    /// Whether the kernel, once it finds the ray inside the edges, must count it as a hit: box and
    /// interval leave no doubt.
    fn counts(&self) -> bool {
        let (tmin, tmax) = self.interval;
        let certain = |(first, last)| first > tmin && last <= tmax && last < f32::MAX.into();
        self.in_box && self.range.is_some_and(certain)
    }

    /// Whether the kernel may find this hit.
    pub fn within_bounds(&self) -> bool {
        let (tmin, tmax) = self.interval;
        self.possible && (self.range).is_some_and(|(first, last)| last > tmin && first <= tmax)
    }

    /// Whether the kernel may give the distance `t`.
    pub fn accepts(&self, t: f32) -> bool {
        let (t, (tmin, tmax)) = (f64::from(t), self.interval);
        let in_range = |(first, last)| first <= t && t <= last;
        t.is_finite() && t > tmin && t <= tmax && self.range.is_some_and(in_range)
    }
}

/// The padded slab interval of a triangle's box.
struct Clip {
    /// Latest start and earliest end that float32 may compute; none if it may be empty.
    narrowest: Option<(f64, f64)>,
    /// Earliest start and latest end of the enlarged box; none if no `t > 0` passes.
    widest: Option<(f64, f64)>,
}

impl Clip {
    fn new(ray: &Ray, triangle: &Triangle) -> Clip {
        let bounds = triangle.bounds();
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let ends = [bounds.min.as_dvec3() - o, bounds.max.as_dvec3() - o];
        let largest = ends[0].abs().max(ends[1].abs()).max_element();
        let parallel = BVec3::from_array(ray.direction.to_array().map(|x| !(1.0 / x).is_finite()));
        let interval = |shift: f64| {
            let (mut near, mut far) = (0.0_f64, f64::INFINITY);
            for k in 0..3 {
                let (lo, hi) = (ends[0][k] - shift, ends[1][k] + shift);
                if !parallel.test(k) {
                    let slab = [lo / d[k], hi / d[k]];
                    near = near.max(slab[0].min(slab[1]));
                    far = far.min(slab[0].max(slab[1]));
                } else if lo > 0.0 || hi < 0.0 {
                    far = f64::NEG_INFINITY;
                }
            }
            (near * (1.0 - BOX_PADDING), far * (1.0 + BOX_PADDING))
        };
        let (near, far) = interval(0.0);
        let narrowest = (
            near * (1.0 + SLAB_ROUNDINGS) + TINY,
            far * (1.0 - SLAB_ROUNDINGS) - TINY,
        );
        let (near, far) = interval(BOX_SHIFT * largest);
        let widest = (
            near * (1.0 - SLAB_ROUNDINGS) - TINY,
            far * (1.0 + SLAB_ROUNDINGS) + TINY,
        );
        let some = |(near, far): (f64, f64)| (near <= far && far > 0.0).then_some((near, far));
        Clip {
            narrowest: some(narrowest),
            widest: some(widest),
        }
    }
}

/// How far a box must be enlarged so that it holds whatever the kernel may hit of a triangle within,
/// relative to the largest |corner − o|∞ of the box.
pub(crate) const ENLARGED: f64 = 2.0 * BOX_SHIFT;

/// The triangles that a ray may hit, to find the surfaces that it cannot pass.
pub struct Surfaces {
    shear: Shear,
    triangles: Vec<(Triangle, Sheared)>,
}

impl Surfaces {
    /// Of those triangles that the ray may hit.
    pub fn new(ray: &Ray, triangles: Vec<(Triangle, Sheared)>) -> Surfaces {
        Surfaces {
            shear: Shear::new(ray),
            triangles,
        }
    }

    /// The distance at which, at the latest, the kernel finds a hit on a surface that no rounding
    /// lets the ray pass; `None` if there is no such surface.
    pub fn latest(&self) -> Option<f64> {
        let parts = self.parts().into_iter();
        parts
            .filter_map(|part| self.latest_of(&part))
            .reduce(f64::min)
    }

    /// The triangles in parts that hang together by edges, equal positions taken as one corner.
    fn parts(&self) -> Vec<Vec<usize>> {
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for i in 0..self.triangles.len() {
            let edges = edges(&self.triangles[i].0);
            let touches = |&k: &usize| {
                let others = self::edges(&self.triangles[k].0);
                others.iter().any(|edge| edges.contains(edge))
            };
            let (touched, apart): (Vec<_>, Vec<_>) =
                (parts.into_iter()).partition(|part| part.iter().any(touches));
            parts = apart;
            parts.push(touched.into_iter().flatten().chain([i]).collect());
        }
        parts
    }

    fn latest_of(&self, part: &[usize]) -> Option<f64> {
        if !part.iter().all(|&i| self.triangles[i].1.counts()) {
            return None;
        }
        let all: Vec<[Bits; 2]> = (part.iter())
            .flat_map(|&i| edges(&self.triangles[i].0))
            .collect();
        let mut crossings = 0;
        for (i, edge) in all.iter().enumerate() {
            let times = all.iter().filter(|other| *other == edge).count();
            if times % 2 == 0 || all[..i].contains(edge) {
                continue;
            }
            let [p, q] = edge.map(|v| self.shear.corner(Vec3::from_array(v.map(f32::from_bits))));
            if is_near(&p, &q) {
                return None;
            }
            // The half-axis y = 0 < x, seen from the ray.
            crossings += ((p.at.y <= 0.0) != (q.at.y <= 0.0)
                && (p.at.perp_dot(q.at) > 0.0) == (p.at.y <= 0.0))
                as usize;
        }
        let latest = part.iter().map(|&i| self.triangles[i].1.latest());
        (crossings % 2 == 1).then(|| latest.fold(f64::NEG_INFINITY, f64::max))
    }
}

/// Coordinates to the bit, −0 as 0.
type Bits = [u32; 3];

/// The edges, each with its lesser corner first.
fn edges(triangle: &Triangle) -> [[Bits; 2]; 3] {
    let corner = |v: Vec3| v.to_array().map(|x| (x + 0.0).to_bits());
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(corner);
    [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])
}

/// Whether some moving of the corners may put the ray on the edge.
fn is_near(p: &Corner, q: &Corner) -> bool {
    let edge = p.edge(q);
    let lowest = (p.at - p.off).min(q.at - q.off);
    let highest = (p.at + p.off).max(q.at + q.off);
    edge.value.abs() <= edge.bound
        && lowest.cmple(DVec2::ZERO).all()
        && highest.cmpge(DVec2::ZERO).all()
}
