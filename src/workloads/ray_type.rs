//! Names of the kinds of rays.

use super::WorkloadError;
use std::fmt;
use std::str::FromStr;

/// Number of diffuse bounces that have a name.
pub const MAX_BOUNCES: u8 = 8;

/// A kind of rays. `Display` and `FromStr` use the names of the command line and the result files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RayType {
    /// `primary`: from the camera through the pixels.
    Primary,
    /// `shadow-point`: from the point light to what the primary rays hit.
    ShadowPoint,
    /// `shadow-area`: from what the primary rays hit to a random point of the area light.
    ShadowArea,
    /// `reflection`: off the mirrors that the primary rays hit.
    Reflection,
    /// `ambient-occlusion`: one short cosine-distributed ray from what each primary ray hit.
    AmbientOcclusion,
    /// `dof`: from random points of the camera's lens through the pixels, for depth of field.
    Dof,
    /// `diffuse-1` … `diffuse-8`: the n-th cosine-distributed bounce.
    Diffuse(u8),
    /// `random`: uniform origins in the scene's box, uniform directions.
    Random,
}

impl RayType {
    /// Every ray type that has a name.
    pub const ALL: [RayType; 15] = [
        RayType::Primary,
        RayType::ShadowPoint,
        RayType::ShadowArea,
        RayType::Reflection,
        RayType::AmbientOcclusion,
        RayType::Dof,
        RayType::Diffuse(1),
        RayType::Diffuse(2),
        RayType::Diffuse(3),
        RayType::Diffuse(4),
        RayType::Diffuse(5),
        RayType::Diffuse(6),
        RayType::Diffuse(7),
        RayType::Diffuse(8),
        RayType::Random,
    ];

    /// Whether it only matters if there is a hit, not which.
    pub fn is_any_hit(self) -> bool {
        matches!(
            self,
            RayType::ShadowPoint | RayType::ShadowArea | RayType::AmbientOcclusion
        )
    }

    /// All names, separated by commas.
    pub(super) fn names() -> String {
        RayType::ALL.map(|r| r.to_string()).join(", ")
    }
}

impl fmt::Display for RayType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RayType::Primary => f.pad("primary"),
            RayType::ShadowPoint => f.pad("shadow-point"),
            RayType::ShadowArea => f.pad("shadow-area"),
            RayType::Reflection => f.pad("reflection"),
            RayType::AmbientOcclusion => f.pad("ambient-occlusion"),
            RayType::Dof => f.pad("dof"),
            RayType::Diffuse(n) => f.pad(&format!("diffuse-{n}")),
            RayType::Random => f.pad("random"),
        }
    }
}

impl FromStr for RayType {
    type Err = WorkloadError;

    fn from_str(name: &str) -> Result<RayType, WorkloadError> {
        RayType::ALL
            .into_iter()
            .find(|r| r.to_string() == name)
            .ok_or_else(|| WorkloadError::Name(name.to_string()))
    }
}
