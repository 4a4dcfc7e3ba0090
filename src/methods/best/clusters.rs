//! The first pass over the triangles: their boxes, and clusters of those whose centres lie in one cell
//! of a grid. The upper splits then are of clusters.

use super::memory::SplitRoom;
use crate::geometry::{Aabb, Mesh};
use crate::kernels::{BinBox, Grid, Item, Kernels};
use std::ops::Range;

/// Part of the triangles, for one thread.
#[derive(Clone, Copy)]
pub(super) struct Part {
    /// The first of its items.
    pub from: usize,
    /// How many of its triangles can be hit.
    pub len: usize,
    pub bounds: BinBox,
}

impl Part {
    pub const NONE: Part = Part {
        from: 0,
        len: 0,
        bounds: BinBox::EMPTY,
    };

    pub fn range(&self) -> Range<usize> {
        self.from..self.from + self.len
    }
}

/// Makes the items of the triangles from `from` on, of as many as there is room for.
pub(super) fn prepare(kernels: &Kernels, mesh: &Mesh, from: usize, items: &mut [Item]) -> Part {
    // SAFETY: the processor was checked.
    let (len, bounds) = unsafe { (kernels.prepare_triangles)(mesh, from, items) };
    Part { from, len, bounds }
}

/// The box around the triangles of all parts, their number, and a grid of no more than so many cells.
pub(super) fn grid(parts: &[Part], cell_triangles: f32, most: usize) -> (Aabb, usize, Grid) {
    let bounds = parts
        .iter()
        .fold(BinBox::EMPTY, |all, part| all.merged(&part.bounds));
    let triangles = parts.iter().map(|part| part.len).sum::<usize>();
    let cells = cells(triangles, cell_triangles, most);
    let bounds = bounds.bounds();
    (bounds, triangles, Grid::new(&bounds, cells))
}

/// Cells for so many triangles.
pub(super) fn cells(triangles: usize, cell_triangles: f32, most: usize) -> usize {
    ((triangles as f64 / cell_triangles as f64) as usize).clamp(1, most)
}

impl SplitRoom {
    /// Writes down the cell of each item; returns how many cells have any.
    pub fn count(
        &mut self,
        kernels: &Kernels,
        grid: &Grid,
        items: &[Item],
        cells: &mut [u32],
    ) -> u32 {
        let counts = &mut self.counts[..grid.cells()];
        counts.fill(0);
        self.boxes[..grid.cells()].fill(BinBox::EMPTY);
        // SAFETY: the processor was checked.
        unsafe { (kernels.count_cells)(items, grid, cells, counts) };
        counts.iter().map(|&count| (count > 0) as u32).sum()
    }
}

/// Gives each cell that has triangles a range of places from `from` on, and the items counted in each room
/// theirs within it. Returns how many clusters there are.
pub(super) fn place(
    grid: &Grid,
    rooms: &mut [SplitRoom],
    mut from: u32,
    ranges: &mut [[u32; 2]],
) -> usize {
    let mut clusters = 0;
    for cell in 0..grid.cells() {
        let mut to = from;
        for room in &mut *rooms {
            to += std::mem::replace(&mut room.counts[cell], to);
        }
        if from < to {
            ranges[clusters] = [from, to];
            clusters += 1;
        }
        from = to;
    }
    clusters
}

/// Where items go, cell by cell.
#[derive(Clone, Copy)]
pub(super) struct Sorted(pub *mut Item);

// SAFETY: each place is written by the one thread that it was given to.
unsafe impl Sync for Sorted {}

/// Moves items to the places that [`place`] gave those counted in a room.
///
/// # Safety
/// The places are good for writing, and this thread's own.
pub(super) unsafe fn scatter(
    kernels: &Kernels,
    items: &[Item],
    cells: &[u32],
    room: &mut SplitRoom,
    to: &Sorted,
) {
    // SAFETY: the processor was checked; the rest is promised.
    unsafe { (kernels.scatter)(items, cells, &mut room.counts, &mut room.boxes, to.0) }
}

/// Makes the clusters of the cells that have triangles, numbered from `first` on.
pub(super) fn unite(
    grid: &Grid,
    rooms: &[SplitRoom],
    first: u32,
    ranges: &[[u32; 2]],
    clusters: &mut [Item],
) {
    let mut all = ranges.iter().zip(first..).zip(clusters);
    for cell in 0..grid.cells() {
        let bounds = rooms
            .iter()
            .fold(BinBox::EMPTY, |all, room| all.merged(&room.boxes[cell]));
        if !bounds.is_empty()
            && let Some(((&[from, to], number), cluster)) = all.next()
        {
            *cluster = Item::cluster(bounds, number, to - from);
        }
    }
}
