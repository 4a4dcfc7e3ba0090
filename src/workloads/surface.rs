//! What a batch of rays hit, and the directions in which light goes on from there.

use crate::geometry::{Mesh, Triangle};
use crate::random;
use crate::rays::{Batch, Hits, MISS};
use glam::{DVec3, Vec3};

/// Distance of secondary rays from the surface, as a share of the scene's diagonal.
const OFFSET: f64 = 1e-4;

/// The place where one ray hit.
#[derive(Clone, Copy)]
pub(super) struct SurfacePoint {
    /// The hit point, moved off the surface to the side that the ray came from.
    pub position: Vec3,
    /// Number of the primary ray at the start of the path.
    pub primary: u32,
    /// The triangle that was hit.
    pub prim: u32,
    /// Unit normal of the triangle on the side that the ray came from.
    normal: Vec3,
}

impl SurfacePoint {
    /// A cosine-distributed direction of unit length (rounded once from float64). `key` says what
    /// the direction is for; the draw depends on it, the seed and the primary ray alone.
    pub fn cosine_direction(&self, seed: u64, key: u64) -> Vec3 {
        let [u, v] = two_units(seed, key, u64::from(self.primary));
        let normal = self.normal.as_dvec3();
        let (tangent, bitangent) = tangents(normal);
        // A point of the unit disc, moved up to the hemisphere (Malley's method).
        let radius = u.sqrt();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * v);
        let direction =
            radius * cos * tangent + radius * sin * bitangent + (1.0 - u).sqrt() * normal;
        direction.normalize().as_vec3()
    }
}

/// Two numbers in `[0, 1)` for a primary ray.
pub(super) fn two_units(seed: u64, key: u64, primary: u64) -> [f64; 2] {
    [2 * primary, 2 * primary + 1].map(|i| random::unit_f64(random::hash(seed, key, i)))
}

/// Where the rays hit, in the order of the batch; rays that miss leave no point. `primary` gives
/// the number of the primary ray that stands at the start of a ray's path.
pub(super) fn surface_points(
    mesh: &Mesh,
    batch: &Batch,
    hits: &Hits,
    primary: impl Fn(usize) -> u32,
) -> Vec<SurfacePoint> {
    let offset = OFFSET * diagonal(mesh);
    let mut points = Vec::with_capacity(hits.hit_count());
    for (i, ray) in batch.iter().enumerate() {
        if hits.prim[i] == MISS {
            continue;
        }
        let triangle = &mesh.triangles()[hits.prim[i] as usize];
        let direction = ray.direction.as_dvec3();
        let normal = facing_normal(triangle, direction);
        let hit = ray.origin.as_dvec3() + f64::from(hits.t[i]) * direction;
        points.push(SurfacePoint {
            position: (hit + offset * normal).as_vec3(),
            primary: primary(i),
            prim: hits.prim[i],
            normal: normal.as_vec3(),
        });
    }
    points
}

/// Length of the diagonal of the box around the mesh's valid triangles; meaningless without any.
pub(super) fn diagonal(mesh: &Mesh) -> f64 {
    let bounds = mesh.bounds();
    (bounds.max.as_dvec3() - bounds.min.as_dvec3()).length()
}

/// The unit normal of a triangle on the side that a ray along `direction` comes from. A triangle
/// without a normal, which no ray can hit, turns straight back.
pub(super) fn facing_normal(triangle: &Triangle, direction: DVec3) -> DVec3 {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3());
    let normal = (b - a)
        .cross(c - a)
        .try_normalize()
        .unwrap_or_else(|| -direction.normalize());
    if normal.dot(direction) > 0.0 {
        -normal
    } else {
        normal
    }
}

/// Two unit vectors that form an orthonormal basis with the unit vector `n` (Duff et al. 2017).
fn tangents(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (
        DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        DVec3::new(b, sign + n.y * n.y * a, -n.y),
    )
}
