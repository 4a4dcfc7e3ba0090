//! Tells a watch what becomes of its ray where space is split.

use super::cell::Cell;
use super::divide::{Divide, Part};
use crate::kernels::Range;
use crate::methods::watch::{Event, Place};
use std::slice;

/// A half of a cell, and what is in it.
type Entered = Option<(Cell, Part)>;

impl Divide<'_> {
    /// All of some rays have come to a cell: the first `kept` of them go on.
    #[inline]
    pub(super) fn watch_cell(&mut self, cell: &Cell, triangles: usize, all: Range, kept: usize) {
        if self.watch.is_none() {
            return;
        }
        let (among, best) = (self.ids(all), self.watched_best());
        if let Some(watch) = &mut self.watch {
            watch.box_of(place(cell, triangles), among, best, |id| {
                match among[..kept].contains(&id) {
                    true => Event::Kept,
                    false => Event::Rejected,
                }
            });
        }
    }

    /// Rays have come to a half of a cell with so many triangles.
    #[inline]
    pub(super) fn watch_half(
        &mut self,
        half: &Cell,
        triangles: usize,
        all: Range,
        entered: &Entered,
    ) {
        if self.watch.is_none() {
            return;
        }
        let (among, best) = (self.ids(all), self.watched_best());
        if let Some(watch) = &mut self.watch {
            let [near, far] = watch.ray.interval(&half.bounds);
            let triangles = entered.map_or(triangles, |(_, part)| part.triangles);
            watch.box_of(place(half, triangles), among, best, |id| match entered {
                Some((_, part)) if among[..part.rays - all.from].contains(&id) => Event::Kept,
                None if near <= far && near <= best.0 => Event::Empty,
                _ => Event::Rejected,
            });
        }
    }

    /// Cones have come to a half of a cell with so many triangles.
    #[inline]
    pub(super) fn watch_cones(
        &mut self,
        half: &Cell,
        triangles: usize,
        all: Range,
        entered: &Entered,
    ) {
        let Some(watch) = &self.watch else { return };
        let id = watch.id;
        // SAFETY: a range of the list, which is there for the whole trace; its numbers are of cones.
        let (cones, ours) = unsafe {
            let cones = slice::from_raw_parts(self.cones.ids.add(all.from), all.len());
            let ours = |&&cone: &&u32| {
                let [first, len] = *self.cones.rays.add(cone as usize);
                let place = id.wrapping_sub(first);
                place < len && self.cones.bits(cone) >> place & 1 == 0
            };
            (cones, cones.iter().find(ours))
        };
        let (Some(cone), best) = (ours, self.watched_best()) else {
            return;
        };
        let event = match entered {
            Some((_, part)) if cones[..part.rays - all.from].contains(cone) => Event::KeptWithCone,
            _ => Event::RejectedWithCone,
        };
        if let Some(watch) = &mut self.watch {
            let triangles = entered.map_or(triangles, |(_, part)| part.triangles);
            watch.push(place(half, triangles), all.len(), best, event);
        }
    }

    /// Rays have come to a leaf.
    #[inline]
    pub(super) fn watch_leaf(&mut self, cell: &Cell, triangles: usize, list: Range) {
        if self.watch.is_none() {
            return;
        }
        let (among, best) = (self.ids(list), self.watched_best());
        // SAFETY: the list of triangles is there for the whole trace.
        let prims = unsafe { slice::from_raw_parts(self.lists.ids, triangles) };
        if let Some(watch) = &mut self.watch {
            let prims = prims.iter().copied();
            watch.leaf(place(cell, triangles), among, best, self.triangles, prims);
        }
    }

    /// The rays of a list are done with.
    #[inline]
    pub(super) fn watch_end(&mut self, cell: &Cell, triangles: usize, done: Range) {
        if self.watch.is_none() {
            return;
        }
        let (among, best) = (self.ids(done), self.watched_best());
        if let Some(watch) = &mut self.watch {
            watch.box_of(place(cell, triangles), among, best, |_| Event::Terminated);
        }
    }

    /// The rays of a list.
    fn ids<'i>(&self, list: Range) -> &'i [u32] {
        // SAFETY: a range of the list, which is there for the whole trace; nobody writes to it while
        // somebody watches.
        unsafe { slice::from_raw_parts(self.rays.ids.add(list.from), list.len()) }
    }

    fn watched_best(&self) -> (f32, u32) {
        let id = self.watch.as_ref().map_or(0, |watch| watch.id as usize);
        // SAFETY: a ray of the batch.
        unsafe { self.rays.best(id) }
    }
}

fn place(cell: &Cell, triangles: usize) -> Place {
    Place {
        depth: cell.depth,
        bounds: cell.bounds,
        triangles,
    }
}
