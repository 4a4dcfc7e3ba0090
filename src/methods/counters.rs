//! What a trace did, in logical tests: the same on every instruction set.

use serde::{Deserialize, Serialize};

/// Numbers of tests and decisions of one trace.
///
/// Tests count rays and triangles, not vectors. `ray_box` leaves the sample rays out and
/// `sample_box` has them: a comparison without them flatters sampling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Counters {
    /// Subproblems, leaves included.
    pub nodes: u64,
    /// Subproblems solved by the naive step.
    pub leaves: u64,
    /// Rays tested against the box of a child, the probes that decide how to store a list included.
    pub ray_box: u64,
    /// Groups of rays tested against a box.
    pub group_box: u64,
    /// Cones tested against a box.
    pub cone_box: u64,
    /// Triangles tested against a cell.
    pub triangle_box: u64,
    /// Rays tested against triangles.
    pub ray_triangle: u64,
    /// Triangles sorted into bins, once for each axis tried.
    pub binned_triangles: u64,
    /// Sample rays tested against boxes.
    pub sample_box: u64,
    /// Nodes at which rays were sampled.
    pub sampled_nodes: u64,
    /// Nodes split by a cost function over bins: by the surface area heuristic or by samples.
    pub sah_nodes: u64,
    /// Nodes of lists of triangles that are split in the middle.
    pub middle_nodes: u64,
    /// First children that got all rays unfiltered.
    pub skips_near: u64,
    /// Second children that got all rays unfiltered.
    pub skips_far: u64,
    /// Rays so passed on that miss the child's box; 0 unless
    /// [`Tracer::with_audit`](crate::Tracer::with_audit) is on.
    pub skipped_rays_that_miss: u64,
    /// Rays taken out of all lists before the end.
    pub terminated_rays: u64,
    /// Triangles met in the naive step of a cell that had been met in another cell before.
    pub duplicates: u64,
    /// The most records that lists of active rays took at a time.
    pub peak_list: u64,
}

impl Counters {
    /// Adds those of another part of the trace.
    pub(super) fn add(&mut self, other: &Counters) {
        self.nodes += other.nodes;
        self.leaves += other.leaves;
        self.ray_box += other.ray_box;
        self.group_box += other.group_box;
        self.ray_triangle += other.ray_triangle;
        self.binned_triangles += other.binned_triangles;
        self.sample_box += other.sample_box;
        self.peak_list = self.peak_list.max(other.peak_list);
    }
}
