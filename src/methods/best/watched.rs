//! Tells a watch what becomes of its ray.

use super::divide::Divide;
use super::splits::Node;
use crate::kernels::{ENTRY, Entry, GROUP, List, Prepared};
use crate::methods::watch::{Event, Place, Watch};
use crate::rays::MISS;
use std::slice;

/// Who watches a ray of the block.
pub(super) struct Watched<'a> {
    pub watch: &'a mut Watch,
    /// Its number in the block.
    pub ray: usize,
}

impl Divide<'_, '_> {
    /// Groups have come to a child; those of `kept` go on.
    #[inline]
    pub(super) fn watch_groups(&mut self, child: usize, all: [usize; 2], kept: [usize; 2]) {
        if self.watch.is_some() && self.has_group(all) {
            let event = match self.has_group(kept) {
                true => Event::KeptWithGroup,
                false => Event::RejectedWithGroup,
            };
            self.push(child, self.rays_in(all), event);
        }
    }

    /// Groups are left at a node: some of their rays, in so many entries, go on.
    #[inline]
    pub(super) fn watch_flush(&mut self, at: usize, list: [usize; 2], entries: usize) {
        let kept = &self.in_groups[..entries];
        if self.watch.is_some() && self.has_group(list) && !self.has_ray(kept) {
            self.push(at, self.rays_in(list), Event::Rejected);
        }
    }

    /// Active rays have come to a child; those of `kept` go on.
    #[inline]
    pub(super) fn watch_rays(&mut self, child: usize, active: List, kept: List) {
        if self.watch.is_some() && (self.has(active) || self.has(kept)) {
            let event = match self.has(kept) {
                true => Event::Kept,
                false => Event::Rejected,
            };
            self.push(child, active.len, event);
        }
    }

    /// Rays have come to a leaf.
    #[inline]
    pub(super) fn watch_leaf(
        &mut self,
        node: &Node,
        leaf: &[Prepared],
        rays: usize,
        is_there: impl Fn(&Self) -> bool,
    ) {
        if self.watch.is_none() || !is_there(self) {
            return;
        }
        let (best, mesh) = (self.watched_best(), self.splits.triangles);
        if let Some(Watched { watch, .. }) = &mut self.watch {
            let tests = leaf
                .iter()
                .map(|of| watch.ray.test(of.prim, &mesh[of.prim as usize]))
                .collect();
            watch.push(place(node), rays, best, Event::Leaf(tests));
        }
    }

    fn push(&mut self, at: usize, rays: usize, event: Event) {
        let (best, node) = (self.watched_best(), self.splits.node(at));
        if let Some(Watched { watch, .. }) = &mut self.watch {
            watch.push(place(node), rays, best, event);
        }
    }

    /// Whether the ray is in a list of active rays.
    pub(super) fn has(&self, list: List) -> bool {
        // SAFETY: a list of the streams, to which nobody writes while somebody watches.
        let ids = unsafe { slice::from_raw_parts(self.rays.active.id.add(list.start), list.len) };
        ids.contains(&(self.watched() as u32))
    }

    /// Whether it is among rays, sixteen to an entry.
    pub(super) fn has_ray(&self, entries: &[Entry]) -> bool {
        is_in(entries, self.watched())
    }

    /// Whether its group is in a list.
    fn has_group(&self, [from, to]: [usize; 2]) -> bool {
        is_in(&self.entries[from..to], self.watched() / GROUP)
    }

    fn rays_in(&self, [from, to]: [usize; 2]) -> usize {
        let groups = self.entries[from..to]
            .iter()
            .map(|entry| entry.mask.count_ones() as usize);
        GROUP * groups.sum::<usize>()
    }

    fn watched(&self) -> usize {
        self.watch.as_ref().map_or(usize::MAX, |watch| watch.ray)
    }

    fn watched_best(&self) -> (f32, u32) {
        let ray = self.watched();
        // SAFETY: a ray of the block.
        unsafe {
            let prim = match self.rays.any_hit {
                true => MISS,
                false => *self.rays.prim.add(ray),
            };
            (*self.rays.t.add(ray), prim)
        }
    }
}

fn is_in(entries: &[Entry], number: usize) -> bool {
    let has = |entry: &Entry| {
        entry.at as usize == number / ENTRY && entry.mask >> (number % ENTRY) & 1 == 1
    };
    entries.iter().any(has)
}

fn place(node: &Node) -> Place {
    Place {
        depth: node.depth as u32,
        bounds: node.bounds,
        triangles: node.weight(),
    }
}
