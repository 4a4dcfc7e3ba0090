//! Algorithm 1 of Mora 2011 without its splits, which another trace has made.

use super::cell::Cell;
use super::divide::{Divide, Part};
use crate::geometry::Aabb;
use crate::kernels::Range;
use crate::methods::stored::{Sent, Stored};

impl Divide<'_> {
    /// Sends rays through a tree.
    pub fn send(&mut self, stored: &Stored, rays: usize, sent: Sent) {
        let Some(root) = stored.nodes.first() else {
            return;
        };
        let mut send = |from: usize, to: usize| {
            self.terminated = from;
            let list = Range { from, to };
            let kept = match stored.filters_root {
                true => self.filter_rays(&Cell::root(root.bounds), list).0,
                false => list.len(),
            };
            if kept > 0 {
                self.walk(stored, 0, from + kept);
            }
        };
        match sent {
            Sent::Together => send(0, rays),
            Sent::OneByOne => (0..rays).for_each(|ray| send(ray, ray + 1)),
            Sent::Onward => panic!("a cell that no ray has come to is not kept"),
        }
    }

    fn walk(&mut self, stored: &Stored, at: usize, rays: usize) {
        self.counters.nodes += 1;
        let node = &stored.nodes[at];
        let Some(children) = &node.children else {
            let prims = &stored.prims[node.from..node.to];
            // SAFETY: the list has room for all triangles of a mesh of this size, of which these are some.
            unsafe { self.lists.ids.copy_from(prims.as_ptr(), prims.len()) };
            let part = Part {
                rays,
                triangles: prims.len(),
                directions: Default::default(),
            };
            return self.naive(&Cell::root(node.bounds), part);
        };
        for child in children {
            let list = Range {
                from: self.terminated,
                to: rays,
            };
            let (kept, _) = self.filter_rays(&Cell::root(child.bounds), list);
            // No triangle reaches into a cell that has no node.
            if let (1.., Some(node)) = (kept, child.node) {
                self.walk(stored, node, list.from + kept);
            }
        }
    }

    /// A leaf, if the splits are kept.
    #[inline]
    pub(super) fn store_leaf(&mut self, cell: &Cell, triangles: usize) {
        if let Some(stored) = &mut self.stored {
            let from = stored.prims.len();
            // SAFETY: the first indices of the list are triangles of the mesh.
            let prims = unsafe { std::slice::from_raw_parts(self.lists.ids, triangles) };
            stored.prims.extend_from_slice(prims);
            stored.leaf(cell.bounds, from, stored.prims.len());
        }
    }

    /// A split into two cells, the first one first, if the splits are kept.
    #[inline]
    pub(super) fn store_split(&mut self, cell: &Cell, halves: [Aabb; 2]) {
        if let Some(stored) = &mut self.stored {
            stored.split(cell.bounds, halves.map(|half| (half, false)));
        }
    }

    /// The child of this place is next; 2 after both.
    #[inline]
    pub(super) fn store_child(&mut self, place: usize) {
        match (&mut self.stored, place) {
            (Some(stored), 1) => stored.second(),
            (Some(stored), 2) => stored.close(),
            _ => {}
        }
    }
}
