//! The pinhole camera.

use super::WorkloadError;
use glam::{DVec3, Vec3};

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
    /// A camera at `eye` that looks at `look_at`, with `up` (any length, not along the view) up in
    /// the picture and a vertical field of view of `fov` degrees.
    ///
    /// # Errors
    /// A value that is not finite, `eye = look_at`, `up` zero or within a millionth of a radian of
    /// the view direction, `fov` not between 0 and 180.
    pub fn new(eye: Vec3, look_at: Vec3, up: Vec3, fov: f32) -> Result<Camera, WorkloadError> {
        for (name, v) in [("eye", eye), ("look-at", look_at), ("up", up)] {
            if !v.is_finite() {
                return Err(WorkloadError::NotFinite(name));
            }
        }
        // NaN fails the comparison.
        if !(fov > 0.0 && fov < 180.0) {
            return Err(WorkloadError::FieldOfView(fov));
        }
        let view = look_at.as_dvec3() - eye.as_dvec3();
        if view == DVec3::ZERO {
            return Err(WorkloadError::NoDirection(eye));
        }
        let no_up = WorkloadError::NoUp {
            up,
            view: view.as_vec3(),
        };
        if up == Vec3::ZERO {
            return Err(no_up);
        }
        let forward = view.normalize();
        let right = forward.cross(up.as_dvec3().normalize());
        if right.length() < 1e-6 {
            return Err(no_up);
        }
        let right = right.normalize();
        Ok(Camera {
            eye,
            forward,
            right,
            up: right.cross(forward),
            tan_half_fov: libm::tan(f64::from(fov).to_radians() / 2.0),
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
