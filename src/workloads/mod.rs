//! The ray batches of an experiment: which rays are asked for, and how they are made.
//!
//! Nothing here knows how rays are traced: the batches of later bounces need the hits of earlier
//! ones, and the caller hands in the function that finds them. The same view, mesh, hits and seed
//! give the same bits on every machine.

mod camera;
mod cameras;
mod film;
mod ray_type;
mod surface;
mod view;
mod workload;

#[cfg(feature = "schema")]
pub(crate) use camera::FOV_LIMIT;
pub use camera::{Camera, Lens};
pub use cameras::{GENERATED_CAMERAS, generated_cameras};
pub use film::{Film, TILE};
pub use ray_type::{MAX_BOUNCES, RayType};
pub use view::{AreaLight, Mirror, View};
pub use workload::{Rays, Workload};

/// What keeps rays from being made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorkloadError {
    /// A camera coordinate is NaN or infinite.
    #[error("the camera's {0} is not finite in float32")]
    NotFinite(&'static str),
    /// The camera has no view direction.
    #[error("the camera's eye and look-at are the same point, {0}")]
    NoDirection(glam::DVec3),
    /// The camera does not know where up is.
    #[error("the camera's up, {up}, is zero or parallel to its view direction, {view}")]
    NoUp {
        /// The up vector.
        up: glam::DVec3,
        /// From the eye to the look-at.
        view: glam::DVec3,
    },
    /// The field of view is not an angle of a pinhole camera.
    #[error("the camera's field of view is {0} degrees, expected more than 0 and less than 180")]
    FieldOfView(f64),
    /// An image without pixels.
    #[error("the resolution is {0}x{1}, expected at least 1x1")]
    Resolution(u32, u32),
    /// Samples that do not fill a square of sub-pixels.
    #[error("{0} samples per pixel, expected a square number: 1, 4, 9, 16, …")]
    Samples(u32),
    /// More rays than 32-bit numbers count.
    #[error("{0} rays, expected less than 2^32 - 1: lower the resolution or the samples per pixel")]
    TooMany(u128),
    /// The lens is none.
    #[error("the camera's lens has radius {} and focus {}, expected numbers greater than 0", .0.radius, .0.focus)]
    Lens(Lens),
    /// Rays without what they come from or go to.
    #[error("{0} rays need {1}, and there is none")]
    Lacks(RayType, &'static str),
    /// The light is nowhere.
    #[error("the light's position, {0}, is not finite")]
    Light(glam::Vec3),
    /// The mirror is nowhere.
    #[error("the mirror's plane, through {0} with normal {1}, is none")]
    Mirror(glam::DVec3, glam::DVec3),
    /// A bounce number that no ray type has.
    #[error("bounce {0}, expected 1 to {MAX_BOUNCES}")]
    Bounce(u8),
    /// A name that no ray type has.
    #[error("no ray type is called `{0}`, expected one of {names}", names = RayType::names())]
    Name(String),
}
