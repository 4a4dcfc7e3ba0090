//! The camera: a pinhole, or a thin lens.

use super::WorkloadError;
use glam::{DVec3, Vec3};

/// Vertical fields of view are more than 0 and less than this, in degrees.
pub(crate) const FOV_LIMIT: f64 = 180.0;

/// A pinhole camera, which may have a lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: Vec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Tangent of half the vertical field of view.
    tan_half_fov: f64,
    lens: Option<Lens>,
}

/// A thin lens around the eye: what is in the plane of focus is sharp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// In the units of the scene; more than 0.
    pub radius: f64,
    /// Distance of the plane of focus from the eye, along the view; more than 0.
    pub focus: f64,
}

impl Camera {
    /// A camera at `eye` (rounded to float32, as rays start there) that looks at `look_at`, with
    /// `up` (any length, not along the view) up in the picture and a vertical field of view of
    /// `fov_degrees`.
    ///
    /// # Errors
    /// A value that float32 cannot hold, `eye = look_at`, `up` zero or within a millionth of a
    /// radian of the view direction, `fov_degrees` not between 0 and 180.
    pub fn new(
        eye: DVec3,
        look_at: DVec3,
        up: DVec3,
        fov_degrees: f64,
    ) -> Result<Camera, WorkloadError> {
        for (name, v) in [("eye", eye), ("look-at", look_at), ("up", up)] {
            if !v.as_vec3().is_finite() {
                return Err(WorkloadError::NotFinite(name));
            }
        }
        // NaN fails the comparison.
        if !(fov_degrees > 0.0 && fov_degrees < FOV_LIMIT) {
            return Err(WorkloadError::FieldOfView(fov_degrees));
        }
        let eye = eye.as_vec3();
        let view = look_at - eye.as_dvec3();
        if view == DVec3::ZERO {
            return Err(WorkloadError::NoDirection(look_at));
        }
        let forward = view.normalize();
        let right = forward.cross(up.normalize());
        let sine = right.length();
        // Vectors too short to have a length in float64 end here too.
        if sine.is_nan() || sine <= 1e-6 {
            return Err(WorkloadError::NoUp { up, view });
        }
        let right = right.normalize();
        Ok(Camera {
            eye,
            forward,
            right,
            up: right.cross(forward),
            tan_half_fov: libm::tan(fov_degrees.to_radians() / 2.0),
            lens: None,
        })
    }

    /// The same with a lens, for `dof` rays and all that start from what they hit.
    ///
    /// # Errors
    /// A radius or focus that is not a number greater than 0.
    pub fn with_lens(self, lens: Lens) -> Result<Camera, WorkloadError> {
        let is_length = |x: f64| x.is_finite() && x > 0.0;
        if !(is_length(lens.radius) && is_length(lens.focus)) {
            return Err(WorkloadError::Lens(lens));
        }
        Ok(Camera {
            lens: Some(lens),
            ..self
        })
    }

    /// The lens, if it has one.
    pub fn lens(&self) -> Option<Lens> {
        self.lens
    }

    /// Where all rays start.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// The direction of unit length (rounded once from float64) through a place in the picture:
    /// `x` from 0 at the left to 1 at the right, `y` from 0 at the top to 1 at the bottom;
    /// `aspect` is width over height.
    pub fn direction(&self, x: f64, y: f64, aspect: f64) -> Vec3 {
        self.way(x, y, aspect).normalize().as_vec3()
    }

    /// From the eye to the plane at distance 1, through a place in the picture.
    fn way(&self, x: f64, y: f64, aspect: f64) -> DVec3 {
        let across = (2.0 * x - 1.0) * aspect * self.tan_half_fov;
        let above = (1.0 - 2.0 * y) * self.tan_half_fov;
        self.forward + across * self.right + above * self.up
    }

    /// Origin and direction of unit length of the ray from a point of the `lens` to where a place in
    /// the picture, as of [`Camera::direction`], is in focus. `draw` are two shares, 0 to 1: points
    /// are uniform on the lens if they are uniform.
    pub(super) fn through_lens(
        &self,
        lens: Lens,
        [x, y]: [f64; 2],
        aspect: f64,
        draw: [f64; 2],
    ) -> (Vec3, Vec3) {
        let eye = self.eye.as_dvec3();
        let radius = lens.radius * draw[0].sqrt();
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * draw[1]);
        let origin = (eye + radius * (cos * self.right + sin * self.up)).as_vec3();
        let in_focus = eye + lens.focus * self.way(x, y, aspect);
        let direction = in_focus - origin.as_dvec3();
        (origin, direction.normalize().as_vec3())
    }
}
