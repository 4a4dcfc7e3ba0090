//! Embree's two ways to intersect.

use dacrt::Precision;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How Embree intersects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Its default, which it calls fast.
    #[default]
    Fast,
    /// `RTC_SCENE_FLAG_ROBUST`: watertight at edges.
    Robust,
}

impl Mode {
    /// Both.
    pub const ALL: [Mode; 2] = [Mode::Fast, Mode::Robust];

    /// The mode that our precision is set against: the one that promises about as much.
    pub fn against(precision: Precision) -> Mode {
        match precision {
            Precision::Fast => Mode::Fast,
            Precision::Watertight | Precision::Exact => Mode::Robust,
        }
    }

    /// `fast` or `robust`, as in result files.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Fast => "fast",
            Mode::Robust => "robust",
        }
    }
}
