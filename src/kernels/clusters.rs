//! Clusters: triangles whose centres lie in one cell of a grid, brought together before the first
//! split, so that the upper splits are of clusters and not of triangles.

use super::bins::{BinBox, Item};
use crate::geometry::Aabb;
use crate::simd::Lanes;
use std::ptr;

/// How many items ahead the next are brought near, and where they go: the passes over all triangles are
/// bound by memory, which some processors fetch too late themselves.
const AHEAD: usize = 32;
const NEAR: usize = 16;

/// A grid of cubic cells over a box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Twice the lower corner.
    base: [f32; 3],
    /// Cells per doubled length.
    scale: f32,
    /// The last cell of each axis.
    last: [f32; 3],
    dims: [u32; 3],
}

impl Grid {
    /// About so many cells.
    pub fn new(bounds: &Aabb, cells: usize) -> Grid {
        let extent = bounds.extent();
        let longest = extent.max_element();
        // Flat scenes have cells of two axes.
        let e = extent.max(glam::Vec3::splat(longest / 1024.0));
        let volume = (e.x as f64 / longest as f64)
            * (e.y as f64 / longest as f64)
            * (e.z as f64 / longest as f64);
        let along = (cells as f64 / volume).cbrt().min(1024.0);
        let size = longest as f64 / along;
        let mut dims = [0, 1, 2].map(|axis| ((extent[axis] as f64 / size).ceil() as u32).max(1));
        while dims.iter().map(|&d| d as u64).product::<u64>() > cells as u64 {
            let most = (0..3).fold(
                0,
                |best, axis| if dims[axis] > dims[best] { axis } else { best },
            );
            dims[most] -= 1;
        }
        Grid {
            base: [0, 1, 2].map(|axis| 2.0 * bounds.min[axis]),
            scale: (0.5 / size) as f32,
            last: dims.map(|d| (d - 1) as f32),
            dims,
        }
    }

    pub fn cells(&self) -> usize {
        self.dims.iter().map(|&d| d as usize).product()
    }

    #[inline(always)]
    fn cell(&self, item: &Item) -> usize {
        let [x, y, z] = [
            self.along(0, item),
            self.along(1, item),
            self.along(2, item),
        ];
        ((z * self.dims[1] + y) * self.dims[0] + x) as usize
    }

    /// The slab of cells across an axis; NaN (a scene without extent) is in the last.
    #[inline(always)]
    fn along(&self, axis: usize, item: &Item) -> u32 {
        let x = (item.doubled_center(axis) - self.base[axis]) * self.scale;
        let x = if x < self.last[axis] {
            x
        } else {
            self.last[axis]
        };
        let x = if x > 0.0 { x } else { 0.0 };
        // SAFETY: 0 <= x <= last.
        unsafe { x.to_int_unchecked::<u32>() }
    }
}

/// Counts the items of each cell, and writes down where each belongs.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn count_cells<L: Lanes>(
    items: &[Item],
    grid: &Grid,
    cells: &mut [u32],
    counts: &mut [u32],
) {
    for (item, to) in items.iter().zip(cells) {
        // SAFETY: as promised; the address of a prefetch may be any.
        unsafe { L::prefetch(ptr::from_ref(item).wrapping_add(AHEAD).cast()) };
        let cell = grid.cell(item);
        *to = cell as u32;
        counts[cell] += 1;
    }
}

/// Moves items to the next places of their cells, and unites their boxes.
///
/// # Safety
/// The processor has `L`'s instruction set; there is such a cell for each item, and the places are good
/// for writing.
#[inline(always)]
pub(crate) unsafe fn scatter<L: Lanes>(
    items: &[Item],
    cells: &[u32],
    places: &mut [u32],
    boxes: &mut [BinBox],
    to: *mut Item,
) {
    for (i, (item, &cell)) in items.iter().zip(cells).enumerate() {
        let next = cells[(i + NEAR).min(cells.len() - 1)] as usize;
        let place = places[next] as usize;
        // SAFETY: as promised; the address of a prefetch may be any.
        unsafe {
            L::prefetch(ptr::from_ref(item).wrapping_add(AHEAD).cast());
            L::prefetch(to.wrapping_add(place).cast_const().cast());
            L::prefetch(ptr::from_ref(&boxes[next]).cast());
        }
        let place = &mut places[cell as usize];
        // SAFETY: as promised.
        unsafe {
            to.add(*place as usize).write(*item);
            boxes[cell as usize].add::<L>(item);
        }
        *place += 1;
    }
}

#[cfg(test)]
mod tests;
