//! What comes before any split: boxes of all triangles, and clusters of them.

use super::BestParameters;
use super::clusters::{self, Sorted};
use super::memory::{SplitRoom, TriangleMemory};
use super::splits::{Places, Splits};
use super::trace::{each, split_off};
use crate::methods::job::Job;
use rayon::ThreadPool;

/// Makes clusters of the triangles, with as many threads as there are rooms. Nothing is split yet.
pub(super) fn first_pass<'a>(
    job: &Job<'a>,
    parameters: &BestParameters,
    pool: Option<&ThreadPool>,
    memory: &'a mut TriangleMemory,
    rooms: &mut [SplitRoom],
) -> Splits<'a> {
    let (kernels, mesh, threads) = (job.kernels, job.mesh, rooms.len());
    let parts = &mut memory.parts[..threads];
    let share = |i: usize| mesh.len() * i / threads;

    let mut rest = &mut memory.items[..mesh.len()];
    let tasks = parts.iter_mut().enumerate().map(|(i, part)| {
        let items = split_off(&mut rest, share(i + 1) - share(i));
        (part, share(i), items)
    });
    each(pool, tasks, |(part, from, items)| {
        *part = clusters::prepare(kernels, mesh, from, items);
    });

    let (scene, triangles, grid) =
        clusters::grid(parts, parameters.cell_triangles, memory.clusters.len());
    let items = &memory.items;
    let mut cells = &mut *memory.cells;
    let tasks = rooms.iter_mut().zip(&*parts).enumerate();
    let tasks = tasks.map(|(i, (room, part))| {
        let cells = split_off(&mut cells, share(i + 1) - share(i));
        (room, part, cells)
    });
    each(pool, tasks, |(room, part, cells)| {
        room.count(kernels, &grid, &items[part.range()], cells);
    });
    let clusters = clusters::place(&grid, rooms, 0, &mut memory.ranges);
    let places = Sorted(memory.sorted.as_mut_ptr());
    let cells = &memory.cells;
    let tasks = rooms.iter_mut().zip(&*parts).enumerate();
    each(pool, tasks, |(i, (room, part))| {
        let cells = &cells[share(i)..];
        // SAFETY: there are as many places as items.
        unsafe { clusters::scatter(kernels, &items[part.range()], cells, room, &places) };
    });
    let ranges = &memory.ranges[..clusters];
    clusters::unite(&grid, rooms, 0, ranges, &mut memory.clusters);

    Splits::new(
        kernels,
        mesh.triangles(),
        scene,
        clusters,
        parameters.cell_triangles,
        Places {
            items: &mut memory.sorted[..triangles],
            scratch: &mut memory.items[..triangles],
            clusters: &mut memory.clusters,
            cluster_scratch: &mut memory.cluster_scratch,
            ranges: &mut memory.ranges,
            cells: &mut memory.cells,
            nodes: &mut memory.nodes,
            prepared: &mut memory.prepared,
        },
    )
}
