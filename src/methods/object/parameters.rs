//! Parameters of the methods that split lists of triangles, and their two presets.

use crate::methods::BadParameter;
use crate::methods::parameters::first_bad;
use serde::{Deserialize, Serialize};

/// Which cost function chooses among the candidates of a node with many rays a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Cost {
    /// Surface area heuristic (Nabata 2013, eq. 1).
    Sah,
    /// Intersection ratios of the sample rays (eq. 2).
    Sampled,
}

/// Who decides which child goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// The first active ray (Nabata 2013, section 4.3, of Áfra 2012).
    OneRay,
    /// The majority of the sample rays (section 4.3).
    Sampled,
}

/// How the one ray decides. The papers do not say.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum OneRay {
    /// By the sign of its direction on the axis of the split.
    AxisSign,
    /// By the nearer entry into the two boxes; the right child on a tie, as in Algorithm 2.
    Entry,
}

/// Which axes are binned. Nabata 2013 does not say.
///
/// It matters more than anything else here: on Crytek Sponza (1024², primary) the baseline takes 387
/// million ray/box tests with [`Axes::Longest`], 109 with [`Axes::Centers`], 107 with [`Axes::All`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Axes {
    /// The longest of the node's box.
    Longest,
    /// The one on which the triangles' centres are spread furthest, as in Wald 2007, from where the
    /// paper has its bins.
    Centers,
    /// All three, for three times the candidates.
    All,
}

/// Where the active rays of a child are kept. Nabata 2013 does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Lists {
    /// As a list of their own where a probe says that few are kept, else in place.
    #[default]
    Auto,
    /// As a list of their own, as long as there is room: memory is linear in the rays, so deep down there
    /// may be none.
    Copied,
    /// At the front of their parent's list, the others behind them.
    InPlace,
}

/// How sample rays are drawn. The paper says "randomly".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Draws {
    /// One from each of as many equal parts of the list as there are samples: without replacement.
    Strata,
    /// Each from the whole list: with replacement.
    Replacement,
}

/// Parameters of ray sampling (Nabata 2013) and of its baseline. As JSON, the names of the fields.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ObjectParameters {
    /// A node with no more triangles than this is a leaf. "Small" in Algorithm 1; 8 is ours.
    pub leaf_triangles: u32,
    /// A node with no more active rays than this is a leaf. "Small" in Algorithm 1; 16 is ours.
    pub leaf_rays: u32,
    /// K, the number of bins, 2 to 256; 32 in section 5.
    pub bins: u32,
    /// Which axes are binned.
    pub axes: Axes,
    /// With [`Cost::Sah`], a node with more rays than this times its triangles is split by cost,
    /// any other in the middle. The baseline's own; 1.5 is ours, for the paper does not state it.
    pub sah_ratio: f32,
    /// How the one ray decides where one ray decides the order.
    pub one_ray: OneRay,
    /// Where the active rays of a child are kept; [`Lists::Auto`] where results do not say.
    #[serde(default)]
    pub lists: Lists,

    /// The cost function (section 4.2).
    pub cost: Cost,
    /// The traversal order (section 4.3).
    pub order: Order,
    /// A child whose intersection ratio is above this gets all rays unfiltered (section 4.4,
    /// eq. 6); 0.5 in the paper, 1 never skips.
    pub skip: f32,
    /// As `sah_ratio`, with [`Cost::Sampled`]; 1.5 in section 5.
    pub threshold: f32,
    /// Sample rays a sampled node, 1 to 4096; 100 in section 4.1.
    pub samples: u32,
    /// Only nodes with more active rays than this are sampled; 1000 in section 4.1.
    pub min_rays: u32,
    /// How sample rays are drawn; strata are ours.
    pub draws: Draws,
    /// Whether nodes split in the middle are sampled for order and ratio. Silent; no is ours.
    pub sample_middle: bool,
    /// Whether a child that will be a leaf is held to eq. 5 with its number of triangles, as
    /// Algorithm 1 prints it, rather than to eq. 6.
    pub leaf_criterion: bool,
    /// C_bv / C_child of eq. 5 for triangles: the cost of a ray/box over that of a ray/triangle
    /// test. No value in the paper; 0.5 is ours.
    pub box_cost: f32,
    /// Whether the order leaves out rays that miss both boxes or enter both at once, which
    /// Algorithm 2 counts to the right child. No is as printed.
    pub order_unbiased: bool,
    /// Whether the second child's ratio is taken anew after the first was traversed. Algorithm 1
    /// takes it before; no is as printed.
    pub alpha_refresh: bool,
    /// Whether a second, independent sample estimates the ratios of the chosen split. The paper has
    /// one sample, which makes the winner's ratio too small; no is as printed.
    pub second_sample: bool,
}

/// Parameters that both methods have.
pub(in crate::methods) const COMMON: [&str; 6] = [
    "leaf_triangles",
    "leaf_rays",
    "bins",
    "axes",
    "one_ray",
    "lists",
];

/// Parameters that only ray sampling has.
pub(in crate::methods) const SAMPLING: [&str; 13] = [
    "cost",
    "order",
    "skip",
    "threshold",
    "samples",
    "min_rays",
    "draws",
    "sample_middle",
    "leaf_criterion",
    "box_cost",
    "order_unbiased",
    "alpha_refresh",
    "second_sample",
];

impl ObjectParameters {
    /// The baseline: Áfra 2012 as Nabata 2013, section 5, describes it.
    pub const AFRA2012: ObjectParameters = ObjectParameters {
        leaf_triangles: 8,
        leaf_rays: 16,
        bins: 32,
        axes: Axes::Centers,
        sah_ratio: 1.5,
        one_ray: OneRay::AxisSign,
        lists: Lists::Auto,
        cost: Cost::Sah,
        order: Order::OneRay,
        skip: 1.0,
        threshold: 1.5,
        samples: 100,
        min_rays: 1000,
        draws: Draws::Strata,
        sample_middle: false,
        leaf_criterion: true,
        box_cost: 0.5,
        order_unbiased: false,
        alpha_refresh: false,
        second_sample: false,
    };

    /// Ray sampling: Nabata 2013.
    pub const NABATA2013: ObjectParameters = ObjectParameters {
        cost: Cost::Sampled,
        order: Order::Sampled,
        skip: 0.5,
        ..ObjectParameters::AFRA2012
    };

    /// Checks all ranges.
    ///
    /// # Errors
    /// The first parameter that is outside its own.
    pub fn check(&self) -> Result<(), BadParameter> {
        let count = "a whole number of at least 1";
        let ratio = "a number of at least 0";
        let checks = [
            (
                "leaf_triangles",
                self.leaf_triangles as f64,
                self.leaf_triangles >= 1,
                count,
            ),
            (
                "bins",
                self.bins as f64,
                (2..=256).contains(&self.bins),
                "2 to 256",
            ),
            (
                "samples",
                self.samples as f64,
                (1..=4096).contains(&self.samples),
                "1 to 4096",
            ),
            (
                "skip",
                self.skip as f64,
                (0.0..=1.0).contains(&self.skip),
                "0 to 1",
            ),
            (
                "sah_ratio",
                self.sah_ratio as f64,
                self.sah_ratio >= 0.0,
                ratio,
            ),
            (
                "threshold",
                self.threshold as f64,
                self.threshold >= 0.0,
                ratio,
            ),
            (
                "box_cost",
                self.box_cost as f64,
                self.box_cost >= 0.0,
                ratio,
            ),
        ];
        first_bad(&checks)
    }

    /// Whether anything is decided by sample rays.
    pub(crate) fn uses_samples(&self) -> bool {
        self.cost == Cost::Sampled || self.order == Order::Sampled || self.skip < 1.0
    }
}
