//! The alternative to visiting cells in no order that Mora 2011, section 3.4, names and does not take:
//! eight sets of rays by octant of direction, each front to back.

use super::cell::Cell;
use super::divide::{Divide, Order, Part};
use crate::kernels::Range;

impl Divide<'_> {
    /// Traces the rays of one octant after the other, each with early termination.
    pub fn divide_octants(&mut self, root: &Cell, all: Part) {
        self.each_octant(all.rays, |divide, rays| {
            divide.divide(root, Part { rays, ..all });
        });
    }

    /// Goes on with the rays of one octant after the other, as far as it has any.
    pub(super) fn each_octant(&mut self, rays: usize, mut go_on: impl FnMut(&mut Self, usize)) {
        let mut from = 0;
        for octant in 0..8 {
            let list = Range { from, to: rays };
            // SAFETY: the processor was checked, the list is one of rays of the batch.
            let n = unsafe { (self.kernels.keep_octant)(&self.rays, list, octant) };
            self.terminated = from;
            from += n;
            if n > 0 {
                self.order = Order::FromOctant(octant);
                go_on(self, from);
            }
        }
    }
}
