//! What is measured for claims.

use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Batches of rays and who traces them: each combination of the lists, by each method as the paper has it,
/// and with each other value of a parameter, one at a time.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// One line for people.
    pub about: String,
    /// What is done with the batches.
    #[serde(default)]
    pub kind: Kind,
    /// Names.
    pub scenes: Vec<String>,
    /// Pixels a side.
    pub resolution: Vec<u32>,
    /// Samples a pixel, square numbers.
    #[serde(default = "one_sample")]
    pub spp: Vec<u32>,
    /// Sizes instead of these, where the full ones are too large: products of the two lists, too.
    #[serde(default)]
    pub also: Vec<[u32; 2]>,
    /// Ray types.
    pub rays: Vec<String>,
    /// Methods with their parameters.
    pub methods: BTreeMap<String, Variants>,
    /// Whether the scene's own camera is the only one.
    #[serde(default)]
    pub own_camera: bool,
    /// Pixels a side, and samples a pixel, of a quick run; as above if left out.
    #[serde(default)]
    pub quick: Option<Vec<[u32; 2]>>,
}

/// For each parameter the values besides the paper's.
pub type Variants = BTreeMap<String, Vec<Value>>;

/// What is done with a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// It is checked and timed, as by `dacrt run`, but for Embree.
    #[default]
    Cells,
    /// Likewise, and so is Embree.
    Embree,
    /// As cells, and the rays are sent through stored splits.
    Twins,
    /// Its nodes are written down.
    Nodes,
    /// Its stack and its workspace are measured.
    Memory,
}

impl Study {
    /// Pixels a side and samples a pixel, each once.
    pub fn sizes(&self, quick: bool) -> Vec<[u32; 2]> {
        if let (true, Some(sizes)) = (quick, &self.quick) {
            return sizes.clone();
        }
        let product =
            (self.resolution.iter()).flat_map(|&side| self.spp.iter().map(move |&spp| [side, spp]));
        product.chain(self.also.iter().copied()).collect()
    }

    /// Whether it has this size, in a full run or in a quick one.
    pub(super) fn has_size(&self, size: [u32; 2]) -> bool {
        self.sizes(false).contains(&size) || self.sizes(true).contains(&size)
    }
}

fn one_sample() -> Vec<u32> {
    vec![1]
}
