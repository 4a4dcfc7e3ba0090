//! The pinhole camera.

use super::WorkloadError;
use glam::{DVec3, Vec3};

/// Vertical fields of view are more than 0 and less than this, in degrees.
pub(crate) const FOV_LIMIT: f64 = 180.0;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: Vec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Tangent of half the vertical field of view.
    tan_half_fov: f64,
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
        })
    }

    /// Where all rays start.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// The direction of unit length (rounded once from float64) through a place in the picture:
    /// `x` from 0 at the left to 1 at the right, `y` from 0 at the top to 1 at the bottom;
    /// `aspect` is width over height.
    pub fn direction(&self, x: f64, y: f64, aspect: f64) -> Vec3 {
        let across = (2.0 * x - 1.0) * aspect * self.tan_half_fov;
        let above = (1.0 - 2.0 * y) * self.tan_half_fov;
        (self.forward + across * self.right + above * self.up)
            .normalize()
            .as_vec3()
    }
}
