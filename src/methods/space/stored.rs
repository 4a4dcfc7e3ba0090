//! Algorithms 1 and 2 of Mora 2011 without their splits, which another trace has made.

use super::cell::Cell;
use super::divide::{Divide, Order, Part};
use crate::geometry::Aabb;
use crate::kernels::{PreparedCones, Range};
use crate::methods::stored::{Sent, Stored};

impl Divide<'_> {
    /// Sends rays through a tree, of octants through one for each.
    pub fn send(&mut self, stored: &Stored, rays: usize, sent: Sent) {
        assert!(
            sent != Sent::Onward,
            "a cell that no ray has come to is not kept"
        );
        let mut roots = stored.roots.iter();
        match self.order {
            Order::FromOctant(_) => self.each_octant(rays, |divide, to| {
                let from = divide.terminated;
                divide.send_list(stored, roots.next(), Range { from, to }, sent);
            }),
            _ => self.send_list(stored, roots.next(), Range { from: 0, to: rays }, sent),
        }
    }

    /// Sends rays that are in no cone, then cones, through the trees of both.
    pub fn send_packets(&mut self, stored: &Stored, made: PreparedCones) {
        let mut roots = stored.roots.iter();
        if made.loose > 0 {
            let list = Range {
                from: 0,
                to: made.loose,
            };
            self.send_list(stored, roots.next(), list, Sent::Together);
        }
        if let (1.., Some(&root)) = (made.cones, roots.next()) {
            self.walk_packets(stored, root, made.cones);
        }
    }

    fn send_list(&mut self, stored: &Stored, root: Option<&usize>, list: Range, sent: Sent) {
        // Without any triangle there is none.
        let Some(&root) = root else {
            return;
        };
        let mut send = |list: Range| {
            self.terminated = list.from;
            let kept = match stored.filters_root {
                true => {
                    let bounds = stored.nodes[root].bounds;
                    self.filter_rays(&Cell::root(bounds), list).0
                }
                false => list.len(),
            };
            if kept > 0 {
                self.walk(stored, root, list.from + kept);
            }
        };
        match sent {
            Sent::OneByOne => {
                (list.from..list.to).for_each(|from| send(Range { from, to: from + 1 }))
            }
            Sent::Together | Sent::Onward => send(list),
        }
    }

    fn walk_packets(&mut self, stored: &Stored, at: usize, cones: usize) {
        let node = &stored.nodes[at];
        let Some(children) = node.children.as_ref().filter(|_| node.of_cones) else {
            return self.flush(cones, |divide, rays| divide.walk(stored, at, rays));
        };
        self.counters.nodes += 1;
        for child in children {
            let list = Range {
                from: self.terminated_cones,
                to: cones,
            };
            let kept = self.filter_cones(&child.bounds, list);
            // No triangle reaches into a cell that has no node.
            if let (1.., Some(node)) = (kept, child.node) {
                self.walk_packets(stored, node, list.from + kept);
            }
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
    pub(super) fn store_split(&mut self, cell: &Cell, halves: [Aabb; 2], of_cones: bool) {
        if let Some(stored) = &mut self.stored {
            stored.split(cell.bounds, halves.map(|half| (half, false)), of_cones);
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
