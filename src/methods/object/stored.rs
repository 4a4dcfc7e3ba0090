//! Algorithm 1 of Nabata 2013 without its splits, which another trace has made.

use super::divide::Divide;
use super::split::Node;
use crate::kernels::List;
use crate::methods::stored::{Sent, Stored};
use crate::simd::MAX_LANES;

impl Divide<'_> {
    /// Sends rays through a tree.
    pub fn send(&mut self, stored: &Stored, active: List, sent: Sent) {
        if stored.nodes.is_empty() {
            return;
        }
        let top = active.len.next_multiple_of(MAX_LANES);
        match sent {
            Sent::Together | Sent::Onward if active.len == 0 => {}
            Sent::Together => self.walk(stored, 0, active, top),
            Sent::Onward => self.walk_on(stored, (0, 0), active, top),
            Sent::OneByOne => {
                for start in active.start..active.start + active.len {
                    self.walk(stored, 0, List { start, len: 1 }, top);
                }
            }
        }
    }

    fn walk(&mut self, stored: &Stored, at: usize, active: List, top: usize) {
        self.counters.nodes += 1;
        let node = &stored.nodes[at];
        let Some(children) = &node.children else {
            self.counters.leaves += 1;
            self.counters.ray_triangle += (active.len * (node.to - node.from)) as u64;
            let items = &stored.items[node.from..node.to];
            // SAFETY: the processor was checked; items are of the mesh.
            return unsafe { (self.kernels.naive)(&self.rays, active, self.triangles, items) };
        };
        for child in children {
            if child.skipped {
                self.walk(stored, child.of_list(), active, top);
                continue;
            }
            let (kept, top) = self.filter(active, &child.bounds, top);
            if kept.len > 0 {
                self.walk(stored, child.of_list(), kept, top);
            }
        }
    }

    /// Through the splits of another batch, and on from its leaves.
    fn walk_on(&mut self, stored: &Stored, (at, depth): (usize, u32), active: List, top: usize) {
        let node = &stored.nodes[at];
        let Some(children) = &node.children else {
            let items = &stored.items[node.from..node.to];
            self.items[..items.len()].copy_from_slice(items);
            let leaf = Node {
                bounds: node.bounds,
                from: 0,
                to: items.len(),
                depth,
                key: at as u64,
            };
            return self.divide(&leaf, active, top);
        };
        self.counters.nodes += 1;
        for child in children {
            let (kept, top) = self.filter(active, &child.bounds, top);
            if kept.len > 0 {
                self.walk_on(stored, (child.of_list(), depth + 1), kept, top);
            }
        }
    }

    /// A leaf, if the splits are kept.
    #[inline]
    pub(super) fn store_leaf(&mut self, node: &Node) {
        if let Some(stored) = &mut self.stored {
            let from = stored.items.len();
            stored
                .items
                .extend_from_slice(&self.items[node.from..node.to]);
            stored.leaf(node.bounds, from, stored.items.len());
        }
    }
}
