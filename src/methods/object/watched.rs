//! Tells a watch what becomes of its ray where lists of triangles are split.

use super::divide::Divide;
use super::split::Node;
use crate::kernels::List;
use crate::methods::watch::{Event, Place};
use crate::rays::MISS;
use std::slice;

impl Divide<'_> {
    /// Active rays have come to a node: those of `kept` go on, all if it was skipped for its ratio.
    #[inline]
    pub(super) fn watch_node(
        &mut self,
        node: &Node,
        active: List,
        kept: List,
        skipped: Option<f32>,
    ) {
        if self.watch.is_none() {
            return;
        }
        let (active, kept) = (self.ids(active), self.ids(kept));
        let best = self.watched_best();
        if let Some(watch) = &mut self.watch {
            watch.box_of(place(node), active, best, |id| match skipped {
                Some(ratio) => Event::Skipped { ratio },
                None if kept.contains(&id) => Event::Kept,
                None => Event::Rejected,
            });
        }
    }

    /// Active rays have come to a leaf.
    #[inline]
    pub(super) fn watch_leaf(&mut self, node: &Node, active: List) {
        if self.watch.is_none() {
            return;
        }
        let (active, best) = (self.ids(active), self.watched_best());
        let (items, mesh) = (&self.items[node.from..node.to], self.triangles);
        if let Some(watch) = &mut self.watch {
            let prims = items.iter().map(|item| item.prim());
            watch.leaf(place(node), active, best, mesh, prims);
        }
    }

    /// The rays of a list.
    fn ids<'i>(&self, list: List) -> &'i [u32] {
        // SAFETY: a list of the streams, which are there for the whole trace; nobody writes to them
        // while somebody watches.
        unsafe { slice::from_raw_parts(self.rays.active.id.add(list.start), list.len) }
    }

    fn watched_best(&self) -> (f32, u32) {
        let id = self.watch.as_ref().map_or(0, |watch| watch.id as usize);
        // SAFETY: a ray of the batch.
        unsafe {
            let prim = match self.rays.any_hit {
                true => MISS,
                false => *self.rays.prim.add(id),
            };
            (*self.rays.t.add(id), prim)
        }
    }
}

fn place(node: &Node) -> Place {
    Place {
        depth: node.depth,
        bounds: node.bounds,
        triangles: node.len(),
    }
}
