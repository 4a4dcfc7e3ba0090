//! Cells: how space is subdivided (Mora 2011, section 3.6), and where that ends.

use super::growth::Growth;
use crate::geometry::Aabb;
use crate::kernels::Side;

/// Cells at this depth are not split: enough for sizes that differ by 2⁴² on each axis.
const MAX_DEPTH: u32 = 128;

/// A part of space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub bounds: Aabb,
    pub depth: u32,
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

    /// The plane that splits the cell, if it can be split: across the longest axis, where the estimate
    /// puts it between two coordinates, or in the middle.
    pub fn split(&self, estimate: Option<impl FnOnce(usize, f32, f32) -> f32>) -> Option<Split> {
        if self.depth == MAX_DEPTH || self.growth.is_too_much() {
            return None;
        }
        let axis = self.longest_axis();
        let (lo, hi) = (self.bounds.min[axis], self.bounds.max[axis]);
        let inside = |plane: &f32| lo < *plane && *plane < hi;
        let estimate = estimate.map(|estimate| estimate(axis, lo, hi));
        let middle = 0.5 * lo + 0.5 * hi;
        let plane = estimate.filter(inside).or(Some(middle).filter(inside))?;
        Some(Split { axis, plane })
    }
}
