//! The first pass over the triangles: their boxes, and clusters of those whose centres lie in one cell
//! of a grid. The upper splits then are of clusters.

use super::memory::Worker;
use crate::geometry::{Aabb, Mesh};
use crate::kernels::{BinBox, Grid, Item, Kernels};
use std::marker::PhantomData;
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

/// The grid of all parts together.
pub(super) fn grid(parts: &[Part], cell_triangles: f32) -> (Aabb, usize, Grid) {
    let bounds = parts
        .iter()
        .fold(BinBox::EMPTY, |all, part| all.merged(&part.bounds));
    let triangles = parts.iter().map(|part| part.len).sum::<usize>();
    let cells = (triangles as f64 / cell_triangles as f64).max(1.0) as usize;
    let bounds = bounds.bounds();
    (bounds, triangles, Grid::new(&bounds, cells))
}

/// Counts the items of each cell in a part.
pub(super) fn count(
    kernels: &Kernels,
    grid: &Grid,
    items: &[Item],
    cells: &mut [u32],
    worker: &mut Worker,
) {
    let counts = &mut worker.counts[..grid.cells()];
    counts.fill(0);
    worker.boxes[..grid.cells()].fill(BinBox::EMPTY);
    // SAFETY: the processor was checked.
    unsafe { (kernels.count_cells)(items, grid, cells, counts) }
}

/// Gives each cell that has triangles a number, and each thread's items of it their places. Returns how
/// many clusters there are.
pub(super) fn place(grid: &Grid, workers: &mut [Worker], ranges: &mut [[u32; 2]]) -> usize {
    let (mut clusters, mut from) = (0, 0);
    for cell in 0..grid.cells() {
        let mut to = from;
        for worker in &mut *workers {
            to += std::mem::replace(&mut worker.counts[cell], to);
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
pub(super) struct Sorted<'a> {
    items: *mut Item,
    _memory: PhantomData<&'a mut [Item]>,
}

// SAFETY: each place is written by the one thread that it was given to.
unsafe impl Sync for Sorted<'_> {}

impl<'a> Sorted<'a> {
    pub fn new(items: &'a mut [Item]) -> Sorted<'a> {
        Sorted {
            items: items.as_mut_ptr(),
            _memory: PhantomData,
        }
    }
}

/// Moves the items of a part to the places that [`place`] gave them.
pub(super) fn scatter(
    kernels: &Kernels,
    items: &[Item],
    cells: &[u32],
    worker: &mut Worker,
    to: &Sorted,
) {
    let Worker { counts, boxes, .. } = worker;
    // SAFETY: the processor was checked; the places are this thread's own.
    unsafe { (kernels.scatter)(items, cells, counts, boxes, to.items) }
}

/// Makes the clusters, numbered by their place.
pub(super) fn unite(grid: &Grid, workers: &[Worker], ranges: &[[u32; 2]], clusters: &mut [Item]) {
    let mut n = 0;
    for cell in 0..grid.cells() {
        let bounds = workers
            .iter()
            .fold(BinBox::EMPTY, |all, worker| all.merged(&worker.boxes[cell]));
        if !bounds.is_empty() {
            let [from, to] = ranges[n];
            clusters[n] = Item::cluster(bounds, n as u32, to - from);
            n += 1;
        }
    }
}
