//! Divide-and-conquer ray tracing with conic packets: Algorithm 2 of Mora 2011 (section 3.3).

use super::cell::Cell;
use super::divide::{Divide, Part};
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
            return self.flush(cell, part);
        };
        self.counters.nodes += 1;
        let mut first_share = None;
        for side in self.sides(split, part.directions) {
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
    }

    /// C ∩ E and P ∩ E, for a half E on one side of its cell.
    fn filter_packets(&mut self, half: &Cell, side: Side, part: Part) -> Part {
        let list = Range {
            from: self.terminated_cones,
            to: part.rays,
        };
        self.counters.cone_box += list.len() as u64;
        let origin = self.origins.min;
        // SAFETY: the processor was checked, the list is one of cones around rays of this origin.
        let cones = unsafe { (self.kernels.keep_cones)(&self.cones, list, &half.bounds, origin) };
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

    /// FlushCones: goes on with the rays of the cones that are not done, then takes out the cones that
    /// are.
    fn flush(&mut self, cell: &Cell, part: Part) {
        let before = self.terminated;
        let cones = Range {
            from: self.terminated_cones,
            to: part.rays,
        };
        // SAFETY: the processor was checked. The rays have room in their list, for each is either
        // done or in one cone.
        let rays = unsafe { (self.kernels.flush)(&self.cones, cones, &self.rays, before) };
        self.divide(cell, Part { rays, ..part });
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
