//! What rays of a picture need of a scene besides its triangles: camera, lights, mirrors.

use super::{Camera, RayType, WorkloadError};
use crate::geometry::Triangle;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// How far a triangle of a mirror's plane may be from it, as a share of the scene's diagonal.
const FLATNESS: f64 = 1e-5;

/// A view of a scene. What no ray type asks for can be left out.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Where the picture is taken from.
    pub camera: Camera,
    /// Of `shadow-point` rays.
    pub point_light: Option<Vec3>,
    /// Of `shadow-area` rays.
    pub area_light: Option<AreaLight>,
    /// Of `reflection` rays.
    pub mirrors: Vec<Mirror>,
}

/// A parallelogram that shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaLight {
    /// One of its corners.
    pub corner: DVec3,
    /// From there to the two corners beside it.
    pub edges: [DVec3; 2],
}

/// Triangles that reflect.
#[derive(Clone, Debug, PartialEq)]
pub enum Mirror {
    /// Those in a plane: no corner further from it than 10⁻⁵ of the scene's diagonal.
    Plane {
        /// A point of the plane.
        point: DVec3,
        /// Of any length but 0.
        normal: DVec3,
    },
    /// Those with these numbers, for example all of one mesh.
    Triangles(Range<u32>),
}

impl View {
    /// A view without lights and mirrors.
    pub fn of(camera: Camera) -> View {
        View {
            camera,
            point_light: None,
            area_light: None,
            mirrors: Vec::new(),
        }
    }

    /// The rays whose hits the first secondary rays start from: `dof` with a lens, else `primary`.
    pub fn camera_rays(&self) -> RayType {
        match self.camera.lens() {
            Some(_) => RayType::Dof,
            None => RayType::Primary,
        }
    }

    /// Whether there is all that rays of this type need.
    ///
    /// # Errors
    /// What there is not, or a bounce that no ray type has.
    pub fn allows(&self, rays: RayType) -> Result<(), WorkloadError> {
        let (is_there, what) = match rays {
            RayType::ShadowPoint => (self.point_light.is_some(), "a point light"),
            RayType::ShadowArea => (self.area_light.is_some(), "an area light"),
            RayType::Reflection => (!self.mirrors.is_empty(), "mirrors"),
            RayType::Dof => (self.camera.lens().is_some(), "a camera with a lens"),
            RayType::Diffuse(n) if !(1..=super::MAX_BOUNCES).contains(&n) => {
                return Err(WorkloadError::Bounce(n));
            }
            _ => (true, ""),
        };
        match is_there {
            true => Ok(()),
            false => Err(WorkloadError::Lacks(rays, what)),
        }
    }

    /// Whether lights and mirrors are somewhere.
    pub(super) fn check(&self) -> Result<(), WorkloadError> {
        if let Some(position) = self.point_light.filter(|p| !p.is_finite()) {
            return Err(WorkloadError::Light(position));
        }
        let corners = self.area_light.iter().flat_map(AreaLight::corners);
        if let Some(corner) = corners.map(|c| c.as_vec3()).find(|c| !c.is_finite()) {
            return Err(WorkloadError::Light(corner));
        }
        for mirror in &self.mirrors {
            if let Mirror::Plane { point, normal } = mirror
                && !(point.is_finite() && normal.is_finite() && *normal != DVec3::ZERO)
            {
                return Err(WorkloadError::Mirror(*point, *normal));
            }
        }
        Ok(())
    }
}

impl AreaLight {
    fn corners(&self) -> [DVec3; 4] {
        let [a, b] = self.edges;
        [DVec3::ZERO, a, b, a + b].map(|way| self.corner + way)
    }

    /// The point at two shares, 0 to 1, of the edges.
    pub(super) fn point(&self, [u, v]: [f64; 2]) -> DVec3 {
        self.corner + u * self.edges[0] + v * self.edges[1]
    }
}

impl Mirror {
    /// Whether a triangle is one of the mirror's; `diagonal` is the scene's.
    pub(super) fn has(&self, prim: u32, triangle: &Triangle, diagonal: f64) -> bool {
        match self {
            Mirror::Triangles(range) => range.contains(&prim),
            Mirror::Plane { point, normal } => {
                let normal = normal.normalize();
                [triangle.a, triangle.b, triangle.c]
                    .map(|corner| normal.dot(corner.as_dvec3() - *point).abs())
                    .into_iter()
                    .all(|distance| distance <= FLATNESS * diagonal)
            }
        }
    }
}
