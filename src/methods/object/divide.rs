//! Divide-and-conquer ray tracing: Algorithm 1 of Nabata 2013.

use super::nodes::Log;
use super::split::{Candidates, Child, Node};
use super::{Lists, ObjectParameters};
use crate::geometry::{Aabb, Triangle};
use crate::kernels::{BLOCK, Item, Keep, Kernels, List, Rays, Samples};
use crate::methods::Counters;
use crate::methods::stored::Stored;
use crate::methods::watch::Watch;
use crate::simd::MAX_LANES;

/// Lists up to this length are copied without a probe: they are in the nearest cache anyway.
const PROBED: usize = 1024;
/// A probe tests every so-manieth block of rays.
const PROBE_STRIDE: usize = 64;

/// One trace under way.
pub(super) struct Divide<'a> {
    pub kernels: &'a Kernels,
    pub parameters: &'a ObjectParameters,
    pub seed: u64,
    pub audit: bool,
    pub rays: Rays,
    pub triangles: &'a [Triangle],
    pub items: &'a mut [Item],
    pub item_scratch: &'a mut [Item],
    pub candidates: &'a mut Candidates,
    pub samples: &'a mut Samples,
    /// Records that lists may use in all.
    pub capacity: usize,
    pub counters: Counters,
    /// Who watches a ray, if somebody does.
    pub watch: Option<&'a mut Watch>,
    /// Where nodes are written down, if they are.
    pub log: Option<&'a mut Log>,
    /// Where the splits are kept, if they are.
    pub stored: Option<&'a mut Stored>,
}

impl Divide<'_> {
    /// Traces the root list through all items.
    pub fn start(&mut self, bounds: Aabb, active: List) {
        let root = Node {
            bounds,
            from: 0,
            to: self.items.len(),
            depth: 0,
            key: 1,
        };
        self.counters.peak_list = active.len as u64;
        if root.from < root.to && active.len > 0 {
            self.watch_node(&root, active, active, None);
            self.divide(&root, active, active.len.next_multiple_of(MAX_LANES));
        }
    }

    /// Algorithm 1. Records from `top` on are free.
    pub(super) fn divide(&mut self, node: &Node, active: List, top: usize) {
        self.counters.nodes += 1;
        if self.is_leaf(node, active) {
            return self.naive(node, active);
        }
        let mut node = *node;
        let Some([first, mut second]) = self.split(&mut node, active) else {
            return self.naive(&node, active);
        };
        self.visit(&first, active, top, |counters| &mut counters.skips_near);
        if self.parameters.alpha_refresh {
            self.refresh_ratio(&mut second, active);
        }
        self.note_second(&second, active);
        self.visit(&second, active, top, |counters| &mut counters.skips_far);
        self.note_end();
    }

    pub(super) fn is_leaf(&self, node: &Node, active: List) -> bool {
        node.len() <= self.parameters.leaf_triangles as usize
            || active.len <= self.parameters.leaf_rays as usize
    }

    /// Lines 26 to 35: with the rays that meet the child's box, or with all of them.
    fn visit(
        &mut self,
        child: &Child,
        active: List,
        top: usize,
        skips: fn(&mut Counters) -> &mut u64,
    ) {
        if self.skips(child) {
            *skips(&mut self.counters) += 1;
            if self.audit {
                let (kept, all) = self.count(active, &child.node.bounds, 1);
                self.counters.skipped_rays_that_miss += (all - kept) as u64;
            }
            self.watch_node(&child.node, active, active, child.ratio);
            self.divide(&child.node, active, top);
        } else {
            let (kept, top) = self.filter(active, &child.node.bounds, top);
            self.watch_node(&child.node, active, kept, None);
            match kept.len {
                0 => self.store_leaf(&child.node),
                _ => self.divide(&child.node, kept, top),
            }
        }
    }

    /// Section 4.4: whether filtering would cost more than it saves, eq. 6; eq. 5 for a leaf.
    pub(super) fn skips(&self, child: &Child) -> bool {
        let Some(ratio) = child.ratio else {
            return false;
        };
        let triangles = child.node.len();
        if self.parameters.leaf_criterion && triangles <= self.parameters.leaf_triangles as usize {
            // A limit of 1 turns all skipping off.
            self.parameters.skip < 1.0 && ratio > 1.0 - self.parameters.box_cost / triangles as f32
        } else {
            ratio > self.parameters.skip
        }
    }

    /// Filters a list by a box; returns the list of the rays kept and where free records begin.
    ///
    /// With [`Lists::Auto`], a list that keeps few rays is copied, one that keeps many is partitioned in
    /// place, which then moves less memory. A probe tells them apart.
    pub(super) fn filter(&mut self, active: List, bounds: &Aabb, top: usize) -> (List, usize) {
        let before = self.counters.ray_box;
        self.counters.ray_box += active.len as u64;
        let fits = top + active.len + MAX_LANES <= self.capacity;
        let copies = fits
            && match self.parameters.lists {
                Lists::Copied => true,
                Lists::InPlace => false,
                Lists::Auto if active.len <= PROBED => true,
                Lists::Auto => {
                    let (kept, probed) = self.count(active, bounds, PROBE_STRIDE);
                    self.counters.ray_box += probed as u64;
                    4 * kept <= 3 * probed
                }
            };
        self.note_filter(active, self.counters.ray_box - before);
        let keep = if copies {
            Keep::Copy(top)
        } else {
            Keep::InPlace
        };
        // SAFETY: the processor was checked; there is room for a copy.
        let len = unsafe { (self.kernels.filter)(&self.rays, active, bounds, keep) };
        if copies {
            let end = (top + len).next_multiple_of(MAX_LANES);
            self.counters.peak_list = self.counters.peak_list.max(end as u64);
            (List { start: top, len }, end)
        } else {
            (
                List {
                    start: active.start,
                    len,
                },
                top,
            )
        }
    }

    /// (kept, tested) of every `stride`-th block of rays.
    pub(super) fn count(&self, active: List, bounds: &Aabb, stride: usize) -> (usize, usize) {
        // SAFETY: the processor was checked.
        unsafe { (self.kernels.count)(&self.rays, active, bounds, stride) }
    }

    /// The naive step.
    fn naive(&mut self, node: &Node, active: List) {
        self.counters.leaves += 1;
        self.counters.ray_triangle += (active.len * node.len()) as u64;
        self.watch_leaf(node, active);
        self.note_leaf(node, active);
        let items = &self.items[node.from..node.to];
        // SAFETY: the processor was checked; items are of the mesh.
        unsafe { (self.kernels.naive)(&self.rays, active, self.triangles, items) }
    }
}

const _: () = assert!(BLOCK * PROBE_STRIDE <= PROBED);
