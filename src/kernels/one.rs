//! One ray against one box or one triangle: the numbers that the kernels see, for those who watch a
//! trace.

use super::certain::{self, Said};
use super::exact::Exact;
use super::naive::RayVector;
use super::prepare;
use super::slab::SlabBox;
use super::triangle::{Corners, Prepared};
use crate::exact;
use crate::geometry::{Aabb, Triangle};
use crate::methods::Precision;
use crate::rays::Ray;
use crate::simd::{Lanes, Portable};
use glam::Vec3;

/// What float32 with bounds on its errors says of a ray and a triangle, the ends of the ray's
/// interval left aside. Where it is not sure, `watertight` and `exact` ask exact arithmetic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sure {
    /// A hit.
    Hit,
    /// No hit.
    Miss,
    /// It may be either.
    Open,
}

/// A ray and a triangle in float32, all numbers as the kernels have them.
///
/// U, V and `w` = |den| − (U + V) have the sign that makes them positive on the inner side of the three
/// edges; of two triangles that share an edge each has its own scale.
#[derive(Clone, Copy, Debug)]
pub struct TriangleTest {
    /// Number of the triangle.
    pub prim: u32,
    /// Positive on the inner side of the first edge.
    pub u: f32,
    /// Positive on the inner side of the second edge.
    pub v: f32,
    /// Positive on the inner side of the third edge.
    pub w: f32,
    /// How far U, V and w may be off.
    pub edge_error: f32,
    /// Numerator of t.
    pub num: f32,
    /// Denominator of t; 0 for a ray that is parallel to the plane.
    pub den: f32,
    /// num / den.
    pub t: f32,
    /// The padded slab interval of the ray in the triangle's own box.
    pub clip: [f32; 2],
    /// Whether float32 decides.
    pub sure: Sure,
    /// Where the line of the ray meets the triangle by the engine's exact arithmetic, rounded once;
    /// `None` if it does not.
    pub exact: Option<f32>,
}

/// A ray of a batch.
pub(crate) struct OneRay {
    pub ray: Ray,
    pub shared_origin: Option<Vec3>,
    /// The least tmin of the batch, from which boxes are tested.
    pub least_tmin: f32,
    pub precision: Precision,
}

/// A number in all lanes.
fn splat(x: f32) -> <Portable as Lanes>::F {
    // SAFETY: portable code runs on every processor.
    unsafe { Portable::splat(x) }
}

fn splat3(v: Vec3) -> [<Portable as Lanes>::F; 3] {
    v.to_array().map(splat)
}

impl OneRay {
    /// The padded slab interval of the ray in a box, as filters compute it.
    pub fn interval(&self, bounds: &Aabb) -> [f32; 2] {
        let (inverse, origin) = (self.inverse(), splat3(self.ray.origin));
        let tmin = splat(self.least_tmin);
        // SAFETY: portable code runs on every processor.
        let (near, far) = unsafe {
            let slabs = SlabBox::<Portable>::new(bounds, self.shared_origin);
            // Taken for special, which changes nothing where the ray is not.
            match self.shared_origin {
                Some(_) => slabs.interval::<true, true>(&inverse, &origin, tmin),
                None => slabs.interval::<false, true>(&inverse, &origin, tmin),
            }
        };
        [near[0], far[0]]
    }

    /// What there is to say of the ray and a triangle.
    pub fn test(&self, prim: u32, triangle: &Triangle) -> TriangleTest {
        match self.shared_origin {
            Some(_) => self.test_as::<true>(prim, triangle),
            None => self.test_as::<false>(prim, triangle),
        }
    }

    fn test_as<const SHARED: bool>(&self, prim: u32, triangle: &Triangle) -> TriangleTest {
        let (bounds, far) = (triangle.bounds(), splat(f32::INFINITY));
        let corners = Corners::<Portable> {
            a: splat3(triangle.a),
            b: splat3(triangle.b),
            c: splat3(triangle.c),
            lo: splat3(bounds.min),
            hi: splat3(bounds.max),
        };
        let mut of = [Prepared::ZERO];
        // SAFETY: portable code runs on every processor.
        unsafe {
            let number = Portable::splat_u(prim);
            Prepared::prepare::<Portable, Exact>(&mut of, &corners, number, self.shared_origin);
            let [of] = &of;
            let v = RayVector::<Portable> {
                active: Portable::first(1),
                id: Portable::splat_u(0),
                inverse: self.inverse(),
                origin: splat3(self.ray.origin),
                direction: splat3(self.ray.direction),
                tmin: splat(self.ray.tmin),
                t: far,
                prim: Portable::splat_u(0),
            };
            let edges = of.edges::<Portable, SHARED>(&v.origin, &v.direction);
            let clip = of.clip::<Portable, SHARED, true>(&v, self.shared_origin);
            let Said {
                sure, open, error, ..
            } = certain::say::<Portable, SHARED>(of, &v, splat(f32::NEG_INFINITY), far);
            let [u, v, num, den] = [edges.u[0], edges.v[0], edges.num[0], edges.den[0]];
            TriangleTest {
                prim,
                u,
                v,
                w: den - (u + v),
                edge_error: error[0],
                num,
                den,
                t: num / den,
                clip: [clip.0[0], clip.1[0]],
                sure: match (sure[0], open[0]) {
                    (true, _) => Sure::Hit,
                    (_, true) => Sure::Open,
                    _ => Sure::Miss,
                },
                exact: exact::meet(self.ray.origin, self.ray.direction, triangle)
                    .map(|meeting| meeting.rounded()),
            }
        }
    }

    fn inverse(&self) -> [<Portable as Lanes>::F; 3] {
        let direction = splat3(self.ray.direction);
        // SAFETY: portable code runs on every processor.
        unsafe { direction.map(|d| prepare::inverse::<Portable>(d, self.precision).0) }
    }
}
