//! Parameters of `best`, and its preset.

use crate::kernels::GROUP;
use crate::methods::BadParameter;
use crate::methods::parameters::first_bad;
use serde::{Deserialize, Serialize};

/// Which batches are put in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Sort {
    /// Those in which neighbours go different ways, as a sample of the batch says.
    Auto,
    /// None.
    Never,
    /// All.
    Always,
}

/// Parameters of `best`. As JSON, the names of the fields.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BestParameters {
    /// Rays that go through the splits together, where neighbours go the same way; 64 to 262,144, fewer if
    /// that leaves threads without any.
    pub block: u32,
    /// Likewise, at least, of rays that were put in order; a quarter as many as there are triangles if that is
    /// more; 64 to 262,144.
    pub sorted_block: u32,
    /// Rays that are put in order together; 64 to 1,048,576.
    pub window: u32,
    /// Which batches are put in order.
    pub sort: Sort,
    /// Groups are left for lists of rays at a node whose box no more than this share of their rays
    /// meets, as a few groups say; 0 never leaves them, 1 has lists from the root on.
    pub flush: f32,
    /// Triangles for each cell of the grid that gathers them into clusters, at least 1; with more than
    /// the mesh has there is one cluster.
    pub cell_triangles: f32,
}

/// Names of the parameters.
pub(in crate::methods) const FIELDS: [&str; 6] = [
    "block",
    "sorted_block",
    "window",
    "sort",
    "flush",
    "cell_triangles",
];

/// The largest block.
pub(super) const MAX_BLOCK: usize = 1 << 18;
/// The largest window.
pub(super) const MAX_WINDOW: usize = 1 << 20;

impl BestParameters {
    /// The preset.
    pub const BEST: BestParameters = BestParameters {
        block: 1 << 14,
        sorted_block: 1 << 15,
        window: 1 << 20,
        sort: Sort::Auto,
        flush: 0.2,
        cell_triangles: 8.0,
    };

    /// Rays of a block, where each thread has so many, put in order or not.
    pub(super) fn size_of_block(&self, triangles: usize, each: usize, sorted: bool) -> usize {
        let size = match sorted {
            false => self.block as usize,
            true => (triangles / 4)
                .next_power_of_two()
                .max(self.sorted_block as usize),
        };
        size.min(each.next_multiple_of(GROUP)).min(MAX_BLOCK)
    }

    /// Checks all ranges.
    ///
    /// # Errors
    /// The first parameter that is outside its own.
    pub fn check(&self) -> Result<(), BadParameter> {
        let block = |size: u32| (64..=MAX_BLOCK).contains(&(size as usize));
        first_bad(&[
            (
                "block",
                self.block as f64,
                block(self.block),
                "64 to 262144",
            ),
            (
                "sorted_block",
                self.sorted_block as f64,
                block(self.sorted_block),
                "64 to 262144",
            ),
            (
                "window",
                self.window as f64,
                (64..=MAX_WINDOW).contains(&(self.window as usize)),
                "64 to 1048576",
            ),
            (
                "flush",
                self.flush as f64,
                (0.0..=1.0).contains(&self.flush),
                "0 to 1",
            ),
            (
                "cell_triangles",
                self.cell_triangles as f64,
                self.cell_triangles >= 1.0,
                "a number of at least 1",
            ),
        ])
    }
}
