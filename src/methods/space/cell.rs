//! Cells: how space is subdivided (Mora 2011, section 3.6), and where that ends.

use super::divide::Divide;
use super::growth::Growth;
use crate::geometry::Aabb;
use crate::kernels::Side;

/// Cells at this depth are not split. From a box of the size of the largest valid scene, a third of
/// it halves an axis down to less than the rounding of its middle.
const MAX_DEPTH: u32 = 128;

/// A part of space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub bounds: Aabb,
    depth: u32,
    /// What splitting has cost on the way here.
    pub growth: Growth,
}

/// A plane that splits a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    pub axis: usize,
    pub plane: f32,
}

impl Cell {
    pub fn root(bounds: Aabb) -> Cell {
        Cell {
            bounds,
            depth: 0,
            growth: Growth::NONE,
        }
    }

    /// The axis of the longest edge.
    pub fn longest_axis(&self) -> usize {
        let extent = self.bounds.extent();
        let longer = |best, axis| {
            if extent[axis] > extent[best] {
                axis
            } else {
                best
            }
        };
        (0..3).fold(0, longer)
    }

    /// The half on one side of a plane.
    pub fn half(&self, side: Side) -> Cell {
        let mut bounds = self.bounds;
        match side.upper {
            true => bounds.min[side.axis] = side.plane,
            false => bounds.max[side.axis] = side.plane,
        }
        Cell {
            bounds,
            depth: self.depth + 1,
            ..*self
        }
    }

    /// The plane that splits the cell, if it can be split: across the longest axis, in the middle or,
    /// with many triangles, at the mean of the middles of every so-manieth triangle's extent in the
    /// cell.
    pub fn split(&self, by: &Divide, triangles: usize) -> Option<Split> {
        if self.depth == MAX_DEPTH || self.growth.is_too_much() {
            return None;
        }
        let axis = self.longest_axis();
        let (lo, hi) = (self.bounds.min[axis], self.bounds.max[axis]);
        let inside = |plane: &f32| lo < *plane && *plane < hi;
        let estimated = triangles >= by.parameters.estimate_from as usize;
        let estimate = estimated.then(|| by.mean_middle(axis, lo, hi, triangles));
        let middle = 0.5 * lo + 0.5 * hi;
        let plane = estimate.filter(inside).or(Some(middle).filter(inside))?;
        Some(Split { axis, plane })
    }
}

impl Divide<'_> {
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
}
