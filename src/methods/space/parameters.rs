//! Parameters of the method that splits space, and its three presets.

use crate::methods::BadParameter;
use crate::methods::parameters::first_bad;
use serde::{Deserialize, Serialize};

/// How rays go through the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// Rays of one origin, cells front to back, early termination (Mora 2011, section 3.2).
    Basic,
    /// The same in conic packets, down to where few are left (section 3.3).
    Cones,
    /// Rays of any origin, cells in no order (section 3.4).
    Random,
}

/// Parameters of Mora 2011. As JSON, the names of the fields.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpaceParameters {
    /// Which variant a batch with a shared origin is traced by. Any other batch takes
    /// [`Variant::Random`].
    pub variant: Variant,
    /// rLimit: a cell with fewer rays than this is solved by the naive step; 20 in section 3.2.
    pub ray_limit: u32,
    /// pLimit: a cell with fewer triangles than this is solved by the naive step; 16 in section 3.2.
    pub triangle_limit: u32,
    /// cLimit: a cell with fewer cones than this goes on with their rays. No value in the paper.
    pub cone_limit: u32,
    /// The widest half-angle of a cone, in degrees from 0 to 60; a packet whose rays need a wider one
    /// is traced as rays, before the cones. Not in the paper.
    pub widest_cone: f32,
    /// A cell with at least so many triangles is split at the estimate of section 3.6, any other in
    /// the middle; 10,000 there.
    pub estimate_from: u32,
    /// The estimate looks at every so-manieth triangle; 50 in section 3.6.
    pub estimate_stride: u32,
    /// Triangles of cells with fewer than this are held against the new cells by the nine axes of
    /// section 3.5; 100 there, 0 never does.
    pub nine_axes_below: u32,
    /// Whether they are also held against the cells by their planes, which section 3.5 leaves out.
    pub plane_test: bool,
    /// Whether a ray ends at any hit with a triangle of the cell, as section 3.2 prints it. That is
    /// wrong: the hit may lie outside the cell, behind another triangle. No is ours: at a hit inside.
    pub terminate_as_printed: bool,
    /// Whether the random variant goes through the cells once for each of the eight octants of
    /// direction, front to back and with early termination, as section 3.4 suggests; no there.
    pub octants: bool,
}

impl SpaceParameters {
    /// Names of the fields.
    pub(in crate::methods) const FIELDS: [&str; 11] = [
        "variant",
        "ray_limit",
        "triangle_limit",
        "cone_limit",
        "widest_cone",
        "estimate_from",
        "estimate_stride",
        "nine_axes_below",
        "plane_test",
        "terminate_as_printed",
        "octants",
    ];

    /// Cells and rays (sections 3.2, 3.5 and 3.6).
    pub const MORA2011: SpaceParameters = SpaceParameters {
        variant: Variant::Basic,
        ray_limit: 20,
        triangle_limit: 16,
        cone_limit: 32,
        widest_cone: 4.0,
        estimate_from: 10_000,
        estimate_stride: 50,
        nine_axes_below: 100,
        plane_test: false,
        terminate_as_printed: false,
        octants: false,
    };

    /// The same with conic packets (section 3.3).
    pub const MORA2011_CONES: SpaceParameters = SpaceParameters {
        variant: Variant::Cones,
        ..SpaceParameters::MORA2011
    };

    /// Rays of any origin (section 3.4).
    pub const MORA2011_RANDOM: SpaceParameters = SpaceParameters {
        variant: Variant::Random,
        ..SpaceParameters::MORA2011
    };

    /// Checks all ranges.
    ///
    /// # Errors
    /// The first parameter that is outside its own.
    pub fn check(&self) -> Result<(), BadParameter> {
        let count = "a whole number of at least 1";
        let counts = [
            ("ray_limit", self.ray_limit),
            ("triangle_limit", self.triangle_limit),
            ("cone_limit", self.cone_limit),
            ("estimate_stride", self.estimate_stride),
        ];
        first_bad(&counts.map(|(name, value)| (name, value as f64, value >= 1, count)))?;
        let angle = self.widest_cone;
        let in_range = (0.0..=60.0).contains(&angle);
        first_bad(&[("widest_cone", angle as f64, in_range, "0 to 60")])
    }
}
