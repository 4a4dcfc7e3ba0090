//! Makes the batches.

use super::surface::{SurfacePoint, diagonal, facing_normal, surface_points, two_units};
use super::{Film, RayType, View, WorkloadError};
use crate::geometry::{Aabb, Mesh};
use crate::rays::{Batch, Hits, Ray};
use glam::DVec3;

/// Reach of ambient-occlusion rays, as a share of the scene's diagonal.
const OCCLUSION_REACH: f64 = 0.1;
/// How much of the way between light and point a shadow ray goes.
const SHADOW_REACH: f32 = 1.0 - 1e-4;

/// Keys of the random numbers; that of a bounce is its number, so these are beyond all bounces.
const KEY_OCCLUSION: u64 = 1 << 8;
const KEY_RANDOM_ORIGIN: u64 = 2 << 8;
const KEY_RANDOM_DIRECTION: u64 = 3 << 8;
const KEY_LIGHT: u64 = 4 << 8;
const KEY_LENS: u64 = 5 << 8;

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
/// * `dof`: likewise from points of the lens, one a ray, uniform on it, to where its sample is in
///   focus.
/// * Secondary rays start from the hits of the rays before; of the first, these are `dof` rays if
///   the camera has a lens, else `primary` rays. They start at the hit point plus 1e-4 × the scene's
///   diagonal along the geometric normal on the side of the incoming ray, in float64, rounded once.
///   They keep the order of their parents; where a ray misses, its path ends.
/// * `shadow-point`: from the light to those points of the camera's rays; the direction is the way
///   to the point, and `tmax = 1 − 1e-4`. All share the light as origin. A point that is the light
///   makes an invalid ray.
/// * `shadow-area`: from those points to points of the area light, one a ray, uniform on it; the
///   direction is the way there, and `tmax = 1 − 1e-4`. A point on the light may make an invalid
///   ray.
/// * `reflection`: from those points that are on mirrors, in the mirrored unit direction.
/// * `ambient-occlusion`: one cosine-distributed unit direction for each hit of a camera's ray,
///   `tmax` = a tenth of the scene's diagonal.
/// * `diffuse-n`: likewise without an end, from the hits of `diffuse-(n−1)`, or of the camera's rays.
/// * `random`: as many as primary rays, origins uniform in the box around the scene, unit
///   directions uniform on the sphere, without an end. None if no triangle is valid.
///
/// Random choices depend on the seed, the ray type and the number of the primary ray, not on how
/// many rays are left. So the batches are the same in whatever order they are asked for; but if
/// bounces are asked for in rising order, none is traced twice here.
///
/// Memory: 32 bytes for each ray handed out and 4 more if it is secondary. Kept for the next call
/// are 32 bytes for each hit of a primary ray and of the last bounce that was traced.
pub struct Workload<'a> {
    mesh: &'a Mesh,
    view: View,
    film: Film,
    seed: u64,
    /// What the camera's rays hit.
    first: Option<Vec<SurfacePoint>>,
    /// The last bounce that was traced, and what it hit.
    last: Option<(u8, Vec<SurfacePoint>)>,
}

impl<'a> Workload<'a> {
    /// Rays of a picture of `mesh`. `seed` steers all that is drawn: bounces, random rays, points
    /// of lens and light.
    ///
    /// # Errors
    /// A light or mirror that is not finite, or a mirror without a normal.
    pub fn new(
        mesh: &'a Mesh,
        view: View,
        film: Film,
        seed: u64,
    ) -> Result<Workload<'a>, WorkloadError> {
        view.check()?;
        Ok(Workload {
            mesh,
            view,
            film,
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
    /// A view that lacks what the rays need ([`View::allows`]).
    ///
    /// # Panics
    /// If `nearest` returns fewer records than rays, or a triangle that the mesh does not have.
    pub fn rays(
        &mut self,
        ray_type: RayType,
        nearest: &mut dyn FnMut(&Batch) -> Hits,
    ) -> Result<Rays, WorkloadError> {
        self.view.allows(ray_type)?;
        Ok(match ray_type {
            RayType::Primary => self.of_all(|i| self.pinhole_ray(i)),
            RayType::Dof => self.of_all(|i| self.camera_ray(i)),
            RayType::Random => self.random(),
            RayType::ShadowPoint => self.shadow_point(nearest),
            RayType::ShadowArea => self.shadow_area(nearest),
            RayType::Reflection => self.reflection(nearest),
            RayType::AmbientOcclusion => self.ambient_occlusion(nearest),
            RayType::Diffuse(n) => self.diffuse(n, nearest),
        })
    }

    /// A ray for each sample of the film.
    fn of_all(&self, ray: impl Fn(usize) -> Ray) -> Rays {
        Rays {
            batch: (0..self.film.rays()).map(ray).collect(),
            primary: None,
        }
    }

    fn aspect(&self) -> f64 {
        f64::from(self.film.width()) / f64::from(self.film.height())
    }

    fn pinhole_ray(&self, i: usize) -> Ray {
        let camera = &self.view.camera;
        let [x, y] = self.film.place(i);
        Ray::new(camera.eye(), camera.direction(x, y, self.aspect()))
    }

    /// Through the lens, if there is one.
    fn camera_ray(&self, i: usize) -> Ray {
        let Some(lens) = self.view.camera.lens() else {
            return self.pinhole_ray(i);
        };
        let draw = two_units(self.seed, KEY_LENS, i as u64);
        let place = self.film.place(i);
        let camera = &self.view.camera;
        let (origin, direction) = camera.through_lens(lens, place, self.aspect(), draw);
        Ray::new(origin, direction)
    }

    fn shadow_point(&mut self, nearest: &mut dyn FnMut(&Batch) -> Hits) -> Rays {
        let light = self.view.point_light.unwrap_or_default();
        secondary(self.first_points(nearest), |point| Ray {
            origin: light,
            tmin: 0.0,
            direction: point.position - light,
            tmax: SHADOW_REACH,
        })
    }

    fn shadow_area(&mut self, nearest: &mut dyn FnMut(&Batch) -> Hits) -> Rays {
        let (light, seed) = (self.view.area_light, self.seed);
        secondary(self.first_points(nearest), |point| {
            let draw = two_units(seed, KEY_LIGHT, u64::from(point.primary));
            let target = light.map_or(DVec3::ZERO, |light| light.point(draw));
            Ray {
                origin: point.position,
                tmin: 0.0,
                direction: (target - point.position.as_dvec3()).as_vec3(),
                tmax: SHADOW_REACH,
            }
        })
    }

    fn reflection(&mut self, nearest: &mut dyn FnMut(&Batch) -> Hits) -> Rays {
        let (mesh, diagonal) = (self.mesh, diagonal(self.mesh));
        self.find_first_points(nearest);
        let on_mirrors: Vec<SurfacePoint> = (self.first.iter().flatten())
            .filter(|point| {
                let triangle = &mesh.triangles()[point.prim as usize];
                let mut mirrors = self.view.mirrors.iter();
                mirrors.any(|mirror| mirror.has(point.prim, triangle, diagonal))
            })
            .copied()
            .collect();
        secondary(&on_mirrors, |point| {
            let incoming = self.camera_ray(point.primary as usize).direction.as_dvec3();
            let normal = facing_normal(&mesh.triangles()[point.prim as usize], incoming);
            let mirrored = incoming - 2.0 * incoming.dot(normal) * normal;
            Ray::new(point.position, mirrored.normalize().as_vec3())
        })
    }

    fn ambient_occlusion(&mut self, nearest: &mut dyn FnMut(&Batch) -> Hits) -> Rays {
        let seed = self.seed;
        let tmax = (OCCLUSION_REACH * diagonal(self.mesh)) as f32;
        secondary(self.first_points(nearest), |point| Ray {
            origin: point.position,
            tmin: 0.0,
            direction: point.cosine_direction(seed, KEY_OCCLUSION),
            tmax,
        })
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

    /// What the camera's rays hit.
    fn first_points(&mut self, nearest: &mut dyn FnMut(&Batch) -> Hits) -> &[SurfacePoint] {
        self.find_first_points(nearest);
        self.first.as_deref().unwrap_or_default()
    }

    fn find_first_points(&mut self, nearest: &mut dyn FnMut(&Batch) -> Hits) {
        if self.first.is_none() {
            let batch = self.of_all(|i| self.camera_ray(i)).batch;
            let hits = nearest(&batch);
            self.first = Some(surface_points(self.mesh, &batch, &hits, |i| i as u32));
        }
    }
}

/// One ray from each point.
fn secondary(points: &[SurfacePoint], ray: impl Fn(&SurfacePoint) -> Ray) -> Rays {
    Rays {
        batch: points.iter().map(ray).collect(),
        primary: Some(points.iter().map(|p| p.primary).collect()),
    }
}
