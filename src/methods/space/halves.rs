//! The halves of a split cell: which comes first, and what of the subproblem is in each.

use super::cell::{Cell, Split};
use super::divide::{Divide, Order, Part};
use crate::kernels::{Directions, Range, Side};

/// What finds the part of a subproblem that is in a half on one side of its cell.
type Filter<'a> = fn(&mut Divide<'a>, &Cell, Side, Part) -> Part;

impl<'a> Divide<'a> {
    /// The plane that splits a cell with so many triangles (section 3.6), if it can be split.
    pub(super) fn split(&self, cell: &Cell, triangles: usize) -> Option<Split> {
        let estimated = triangles >= self.parameters.estimate_from as usize;
        let estimate = |axis, lo, hi| self.mean_middle(axis, lo, hi, triangles);
        cell.split(estimated.then_some(estimate))
    }

    /// Section 3.6, Fig. 5. In float64, in the order of the list.
    fn mean_middle(&self, axis: usize, lo: f32, hi: f32, triangles: usize) -> f32 {
        let stride = self.parameters.estimate_stride as usize;
        let mut sum = 0.0;
        for i in (0..triangles).step_by(stride) {
            // SAFETY: the first `triangles` indices of the list are triangles of the mesh.
            let [least, greatest] = unsafe {
                let prim = *self.lists.ids.add(i) as usize;
                *self.lists.spans[axis].add(prim)
            };
            sum += least.max(lo) as f64 + greatest.min(hi) as f64;
        }
        (sum / (2 * triangles.div_ceil(stride)) as f64) as f32
    }

    /// Both sides of a split, the first one first.
    pub(super) fn sides(&self, split: Split, directions: Directions) -> [Side; 2] {
        let Split { axis, plane } = split;
        let upper_first = match self.order {
            Order::FromOrigin => plane < self.origins.min[axis],
            Order::FromOctant(down) => down >> axis & 1 == 1,
            Order::Majority => directions.down > directions.up,
        };
        [upper_first, !upper_first].map(|upper| Side { axis, plane, upper })
    }

    /// The half of a cell on one side, charged with its share of the work, and what of the subproblem
    /// is in it; none if that is nothing. `all` are the subproblem's rays or cones; the share of the
    /// first half is handed on to the second.
    pub(super) fn enter(
        &mut self,
        cell: &Cell,
        side: Side,
        part: Part,
        all: Range,
        filter: Filter<'a>,
        first_share: &mut Option<f32>,
    ) -> Option<(Cell, Part)> {
        let share = |inside: Part| {
            let rays = (inside.rays - all.from) as f32 / all.len() as f32;
            rays * (inside.triangles as f32 / part.triangles as f32)
        };
        let mut half = cell.half(side);
        let inside = filter(self, &half, side, part);
        if inside.rays == all.from || inside.triangles == 0 {
            *first_share = Some(0.0);
            return None;
        }
        let own = share(inside);
        let other = first_share.unwrap_or_else(|| {
            if !half.growth.needs_other(own) {
                return 0.0;
            }
            // Filtering for the other half reorders the lists.
            let across = side.opposite();
            let before = self.counters.ray_box;
            let other = share(filter(self, &cell.half(across), across, part));
            filter(self, &half, side, part);
            if let Some(stored) = &mut self.stored {
                stored.extra_box += self.counters.ray_box - before;
            }
            other
        });
        half.growth.charge(own, other);
        *first_share = Some(own);
        Some((half, inside))
    }
}
