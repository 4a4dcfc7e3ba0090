//! Makes the batches.

use super::surface::{SurfacePoint, diagonal, surface_points, two_units};
use super::{Camera, Film, MAX_BOUNCES, RayType, WorkloadError};
use crate::geometry::{Aabb, Mesh};
use crate::rays::{Batch, Hits, Ray};
use glam::{DVec3, Vec3};

/// Reach of ambient-occlusion rays, as a share of the scene's diagonal.
const OCCLUSION_REACH: f64 = 0.1;
/// How much of the way from the light to the point a shadow ray goes.
const SHADOW_REACH: f32 = 1.0 - 1e-4;

/// Keys of the random numbers; that of a bounce is its number, so these are beyond all bounces.
const KEY_OCCLUSION: u64 = 1 << 8;
const KEY_RANDOM_ORIGIN: u64 = 2 << 8;
const KEY_RANDOM_DIRECTION: u64 = 3 << 8;

/// A batch, and to which primary ray (and so to which pixel) each of its rays belongs.
#[derive(Clone, Debug)]
pub struct Rays {
    /// The rays.
    pub batch: Batch,
    /// Numbers of the primary rays; `None` where ray i belongs to primary ray i.
    primary: Option<Vec<u32>>,
}

impl Rays {
    /// Number of the primary ray at the start of the path of ray `i`: the argument of
    /// [`Film::pixel`]. It grows with `i`. Of `random` rays it is `i`.
    ///
    /// # Panics
    /// If a secondary ray is asked for that the batch does not have.
    pub fn primary(&self, i: usize) -> usize {
        match &self.primary {
            None => i,
            Some(numbers) => numbers[i] as usize,
        }
    }
}

/// The rays of one view of one scene.
///
/// * `primary`: unit directions from the eye, in the order of [`Film`], for all `t > 0`.
/// * Secondary rays start from the hits of the rays before: hit point plus 1e-4 × the scene's
///   diagonal along the geometric normal on the side of the incoming ray, in float64, rounded once.
///   They keep the order of their parents; where a ray misses, its path ends.
/// * `shadow-point`: from the light to those points of the primary rays; the direction is the way
///   to the point, and `tmax = 1 − 1e-4`. All share the light as origin. A point that is the light
///   makes an invalid ray.
/// * `ambient-occlusion`: one cosine-distributed unit direction for each hit of a primary ray,
///   `tmax` = a tenth of the scene's diagonal.
/// * `diffuse-n`: likewise without an end, from the hits of `diffuse-(n−1)`, or of `primary`.
/// * `random`: as many as primary rays, origins uniform in the box around the scene, unit
///   directions uniform on the sphere, without an end. None if no triangle is valid.
///
/// Random choices depend on the seed, the ray type and the number of the primary ray, not on how
/// many rays are left. So the batches are the same in whatever order they are asked for; but if
/// bounces are asked for in rising order, none is traced twice here.
///
/// Memory: 32 bytes for each ray handed out and 4 more if it is secondary. Kept for the next call
/// are 28 bytes for each hit of a primary ray and of the last bounce that was traced.
pub struct Workload<'a> {
    mesh: &'a Mesh,
    camera: Camera,
    film: Film,
    light: Option<Vec3>,
    seed: u64,
    /// What the primary rays hit.
    first: Option<Vec<SurfacePoint>>,
    /// The last bounce that was traced, and what it hit.
    last: Option<(u8, Vec<SurfacePoint>)>,
}

impl<'a> Workload<'a> {
    /// Rays of a picture of `mesh`. Only `shadow-point` needs the `light`. `seed` steers bounces
    /// and random rays.
    ///
    /// # Errors
    /// A light that is not finite.
    pub fn new(
        mesh: &'a Mesh,
        camera: Camera,
        film: Film,
        light: Option<Vec3>,
        seed: u64,
    ) -> Result<Workload<'a>, WorkloadError> {
        if let Some(position) = light.filter(|p| !p.is_finite()) {
            return Err(WorkloadError::Light(position));
        }
        Ok(Workload {
            mesh,
            camera,
            film,
            light,
            seed,
            first: None,
            last: None,
        })
    }

    /// The pixels and samples.
    pub fn film(&self) -> Film {
        self.film
    }

    /// Makes the rays of one type. `nearest` finds the nearest hits of the batches that come
    /// before, in the order of the batch; it is called for those that are not known already: once
    /// at most for secondary rays of the first bounce, `n` times at most for `diffuse-n`.
    ///
    /// # Errors
    /// `shadow-point` without a light; `Diffuse(n)` with `n` not from 1 to [`MAX_BOUNCES`].
    ///
    /// # Panics
    /// If `nearest` returns fewer records than rays, or a triangle that the mesh does not have.
    pub fn rays(
        &mut self,
        ray_type: RayType,
        nearest: &mut dyn FnMut(&Batch) -> Hits,
    ) -> Result<Rays, WorkloadError> {
        match ray_type {
            RayType::Primary => Ok(self.primary()),
            RayType::Random => Ok(self.random()),
            RayType::ShadowPoint => {
                let light = self.light.ok_or(WorkloadError::NoLight(ray_type))?;
                let ray = |point: &SurfacePoint| Ray {
                    origin: light,
                    tmin: 0.0,
                    direction: point.position - light,
                    tmax: SHADOW_REACH,
                };
                Ok(secondary(self.first_points(nearest), ray))
            }
            RayType::AmbientOcclusion => {
                let seed = self.seed;
                let tmax = (OCCLUSION_REACH * diagonal(self.mesh)) as f32;
                let ray = |point: &SurfacePoint| Ray {
                    origin: point.position,
                    tmin: 0.0,
                    direction: point.cosine_direction(seed, KEY_OCCLUSION),
                    tmax,
                };
                Ok(secondary(self.first_points(nearest), ray))
            }
            RayType::Diffuse(n) => {
                if n == 0 || n > MAX_BOUNCES {
                    return Err(WorkloadError::Bounce(n));
                }
                Ok(self.diffuse(n, nearest))
            }
        }
    }

    fn primary(&self) -> Rays {
        let aspect = f64::from(self.film.width()) / f64::from(self.film.height());
        let batch = (0..self.film.rays())
            .map(|i| {
                let (x, y) = self.film.place(i);
                Ray::new(self.camera.eye(), self.camera.direction(x, y, aspect))
            })
            .collect();
        Rays {
            batch,
            primary: None,
        }
    }

    fn random(&self) -> Rays {
        let bounds = self.mesh.bounds();
        let count = if bounds == Aabb::EMPTY {
            0
        } else {
            self.film.rays() as u64
        };
        let min = bounds.min.as_dvec3();
        let extent = bounds.max.as_dvec3() - min;
        let batch = (0..count)
            .map(|i| {
                let [x, y] = two_units(self.seed, KEY_RANDOM_ORIGIN, 2 * i);
                let [z, _] = two_units(self.seed, KEY_RANDOM_ORIGIN, 2 * i + 1);
                let origin = min + DVec3::new(x, y, z) * extent;
                let [u, v] = two_units(self.seed, KEY_RANDOM_DIRECTION, i);
                let height = 1.0 - 2.0 * u;
                let radius = (1.0 - height * height).sqrt();
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * v);
                let direction = DVec3::new(radius * cos, radius * sin, height);
                Ray::new(origin.as_vec3(), direction.as_vec3())
            })
            .collect();
        Rays {
            batch,
            primary: None,
        }
    }

    fn diffuse(&mut self, n: u8, nearest: &mut dyn FnMut(&Batch) -> Hits) -> Rays {
        let seed = self.seed;
        // The bounce whose hits are known; 0 is the primary rays, whose hits are kept apart.
        let (mut bounce, mut points) = self
            .last
            .take_if(|(bounce, _)| *bounce < n)
            .unwrap_or_default();
        loop {
            let from = match bounce {
                0 => self.first_points(nearest),
                _ => &points,
            };
            bounce += 1;
            let rays = secondary(from, |point| {
                Ray::new(
                    point.position,
                    point.cosine_direction(seed, u64::from(bounce)),
                )
            });
            if bounce == n {
                if n > 1 {
                    self.last = Some((n - 1, points));
                }
                return rays;
            }
            let hits = nearest(&rays.batch);
            points = surface_points(self.mesh, &rays.batch, &hits, |i| rays.primary(i) as u32);
        }
    }

    /// What the primary rays hit.
    fn first_points(&mut self, nearest: &mut dyn FnMut(&Batch) -> Hits) -> &[SurfacePoint] {
        if self.first.is_none() {
            let batch = self.primary().batch;
            let hits = nearest(&batch);
            self.first = Some(surface_points(self.mesh, &batch, &hits, |i| i as u32));
        }
        self.first.as_deref().unwrap_or_default()
    }
}

/// One ray from each point.
fn secondary(points: &[SurfacePoint], ray: impl Fn(&SurfacePoint) -> Ray) -> Rays {
    Rays {
        batch: points.iter().map(ray).collect(),
        primary: Some(points.iter().map(|p| p.primary).collect()),
    }
}
