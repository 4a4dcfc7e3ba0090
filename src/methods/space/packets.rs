//! Divide-and-conquer ray tracing with conic packets: Algorithm 2 of Mora 2011 (section 3.3).

use super::cell::Cell;
use super::divide::{Divide, Part};
use crate::geometry::Aabb;
use crate::kernels::{Directions, Range, Side};

impl Divide<'_> {
    /// Algorithm 2. `part.rays` is the pivot of cones.
    pub fn divide_packets(&mut self, cell: &Cell, mut part: Part) {
        part.triangles = self.drop_copies(part.triangles);
        let few = part.rays - self.terminated_cones < self.parameters.cone_limit as usize
            || part.triangles < self.parameters.triangle_limit as usize;
        let split = if few {
            None
        } else {
            self.split(cell, part.triangles)
        };
        let Some(split) = split else {
            return self.flush(part.rays, |divide, rays| {
                divide.divide(cell, Part { rays, ..part });
            });
        };
        self.counters.nodes += 1;
        let mut first_share = None;
        let sides = self.sides(split, part.directions);
        self.store_split(cell, sides.map(|side| cell.half(side).bounds), true);
        for (place, side) in sides.into_iter().enumerate() {
            self.store_child(place);
            let all = Range {
                from: self.terminated_cones,
                to: part.rays,
            };
            let entered = self.enter(
                cell,
                side,
                part,
                all,
                Divide::filter_packets,
                &mut first_share,
            );
            self.watch_cones(&cell.half(side), part.triangles, all, &entered);
            if let Some((half, inside)) = entered {
                self.divide_packets(&half, inside);
            }
        }
        self.store_child(2);
    }

    /// C ∩ E and P ∩ E, for a half E on one side of its cell.
    fn filter_packets(&mut self, half: &Cell, side: Side, part: Part) -> Part {
        let list = Range {
            from: self.terminated_cones,
            to: part.rays,
        };
        let cones = self.filter_cones(&half.bounds, list);
        let triangles = match cones {
            0 => 0,
            _ => self.filter_triangles(half, side, part.triangles),
        };
        Part {
            rays: list.from + cones,
            triangles,
            directions: Directions::default(),
        }
    }

    /// The number of cones that meet a cell, which come first in the list from now on.
    pub(super) fn filter_cones(&mut self, cell: &Aabb, list: Range) -> usize {
        self.counters.cone_box += list.len() as u64;
        let origin = self.origins.min;
        // SAFETY: the processor was checked, the list is one of cones around rays of this origin.
        unsafe { (self.kernels.keep_cones)(&self.cones, list, cell, origin) }
    }

    /// FlushCones: goes on with the rays of the cones up to a pivot that are not done, which have a pivot of
    /// their own, then takes out the cones that are.
    pub(super) fn flush(&mut self, to: usize, go_on: impl FnOnce(&mut Self, usize)) {
        let before = self.terminated;
        let cones = Range {
            from: self.terminated_cones,
            to,
        };
        // SAFETY: the processor was checked. The rays have room in their list, for each is either
        // done or in one cone.
        let rays = unsafe { (self.kernels.flush)(&self.cones, cones, &self.rays, before) };
        go_on(self, rays);
        // SAFETY: indices are those of rays and cones of the batch.
        unsafe {
            for i in before..self.terminated {
                self.cones.end(*self.rays.ids.add(i));
            }
            for i in cones.from..cones.to {
                let cone = *self.cones.ids.add(i);
                if self.cones.bits(cone) == !0 {
                    let first = self.cones.ids.add(self.terminated_cones);
                    std::ptr::swap(self.cones.ids.add(i), first);
                    self.terminated_cones += 1;
                }
            }
        }
    }
}
