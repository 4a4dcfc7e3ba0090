//! What method `best` adds: groups, both children at once, rays in order, clusters, prepared leaves.

use super::rays::{Copied, RAYS, batch, whole_lists};
use super::triangles::{CUBE, HALF, items, mesh};
use super::{Bench, Work, best, number, point};
use crate::geometry::{Aabb, Mesh, Triangle};
use crate::kernels::{
    BUCKETS, BinBox, BlockStreams, CHUNK, ENTRY, Entry, GROUP, Grid, Groups, Item, Kernels, List,
    Ordered, Prepared, Rays, SortedRay, Source, Tmax, Window, place_keys, streams,
};
use crate::methods::{BestParameters, Precision};
use crate::rays::active::ActiveRays;
use crate::rays::{Batch, Ray};
use crate::simd::MAX_LANES;
use glam::Vec3;
use std::slice;

/// The children of the unit cube.
const CHILDREN: [Aabb; 2] = [
    HALF,
    Aabb {
        min: Vec3::new(0.5, 0.0, 0.0),
        max: Vec3::ONE,
    },
];
/// Triangles of a leaf.
const LEAF: usize = CHUNK;
/// Triangles of a cell of the grid, on average.
const CELL: usize = BestParameters::BEST.cell_triangles as usize;
/// Leaves; the next list of rays takes the next of these.
const LEAVES: usize = 64;

/// Rays into the unit cube, 64 neighbours of which start and end close together.
fn coherent_batch(len: usize, shared: bool) -> Batch {
    let ray = |i: usize| {
        let group = i / GROUP;
        let origin = match shared {
            true => Vec3::splat(0.5),
            false => point(2, group) + 0.05 * point(6, i),
        };
        let origin = origin - Vec3::new(0.0, 0.0, 1.5);
        let d = point(3, group) + 0.1 * (point(7, i) - Vec3::splat(0.5)) - origin;
        Ray::new(origin, Vec3::select(d.cmpeq(Vec3::ZERO), Vec3::ONE, d))
    };
    (0..len).map(ray).collect()
}

/// A block of rays as `best` has it, and the bounds of its groups.
struct Block<const SHARED: bool> {
    batch: Batch,
    active: ActiveRays,
    directions: Vec<[f32; 4]>,
    /// One behind the other: t, tmax, three of directions, tmin.
    floats: Vec<f32>,
    prim: Vec<u32>,
    places: Vec<u32>,
    bounds: Vec<f32>,
}

impl<const SHARED: bool> Block<SHARED> {
    /// Of whole entries of groups.
    fn new(batch: Batch) -> Block<SHARED> {
        let len = batch.len();
        assert!(len.is_multiple_of(GROUP * ENTRY));
        let room = len + GROUP + MAX_LANES;
        Block {
            batch,
            active: ActiveRays::new(len / 2),
            directions: vec![[0.0; 4]; room],
            floats: vec![0.0; 6 * room],
            prim: vec![0; room],
            places: vec![0; room],
            bounds: vec![0.0; Groups::STREAMS * len / GROUP],
        }
    }

    fn pointers(&mut self) -> (Rays, BlockStreams) {
        let (active, scratch) = self.active.streams();
        let [t, tmax, x, y, z, tmin] = streams(&mut self.floats);
        let rays = Rays {
            active,
            scratch,
            directions: self.directions.as_mut_ptr(),
            t,
            prim: self.prim.as_mut_ptr(),
            shared_origin: SHARED.then(|| self.batch.ray(0).origin),
            special: false,
            least_tmin: 0.0,
            any_hit: false,
            precision: Precision::Fast,
            tmax: Tmax {
                one: None,
                each: tmax,
            },
            ahead: false,
            scene: CUBE,
        };
        let direction = [x, y, z];
        let block = BlockStreams {
            ordered: Ordered { direction, tmin },
            tmax,
            places: self.places.as_mut_ptr(),
        };
        (rays, block)
    }

    fn load(&mut self) {
        let (rays, block) = self.pointers();
        let len = self.batch.len();
        let groups = Groups::new(&mut self.bounds);
        // SAFETY: the processor was checked; there is room for the batch and its groups.
        let prepared = unsafe {
            let source = Source::Batch(&self.batch);
            let prepared = (best().load_block)(&source, 0..len, &rays, &block);
            (best().bound_groups)(&rays, &groups, len);
            prepared
        };
        let as_said = prepared.least_tmin == 0.0 && !prepared.special;
        assert!(as_said && prepared.valid == len);
    }
}

/// All of so many rays or groups, whole entries of them.
fn entries(len: usize) -> Vec<Entry> {
    let entry = |at| Entry {
        at: at as u32,
        mask: u32::MAX >> (32 - ENTRY),
    };
    (0..len / ENTRY).map(entry).collect()
}

/// Groups against both children.
struct GroupBox<const SHARED: bool> {
    /// Whose groups they are, over and over.
    block: Block<SHARED>,
    bounds: Vec<f32>,
    entries: Vec<Entry>,
    kept: [Vec<Entry>; 2],
}

/// Groups of a list: those of a block of `best`.
const GROUPS: usize = BestParameters::BEST.block as usize / GROUP;
/// Lists of different groups.
const GROUP_LISTS: usize = 16;

pub(super) fn group_box<const SHARED: bool>(bytes: usize) -> Bench {
    let bounds = 4 * if SHARED { 7 } else { Groups::STREAMS };
    // An entry is read and one of each child is written.
    let touched = bounds + 3 * size_of::<Entry>() / ENTRY;
    let len = (bytes / touched / GROUPS).max(1) * GROUPS;
    let different = len.min(GROUP_LISTS * GROUPS);
    let mut block = Block::<SHARED>::new(coherent_batch(different * GROUP, SHARED));
    block.load();
    let cycled = |stream: &[f32]| stream.iter().copied().cycle().take(len).collect::<Vec<_>>();
    let entries = entries(len);
    Bench {
        work: Box::new(GroupBox {
            bounds: block.bounds.chunks(different).flat_map(cycled).collect(),
            block,
            kept: [(); 2].map(|()| entries.clone()),
            entries,
        }),
        bytes_per_test: touched as f64 / 2.0,
    }
}

impl<const SHARED: bool> Work for GroupBox<SHARED> {
    fn reset(&mut self) {
        self.kept.iter_mut().for_each(|kept| kept.fill(Entry::ZERO));
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let (rays, _) = self.block.pointers();
        let groups = Groups::new(&mut self.bounds);
        let boxes = CHILDREN.each_ref();
        let [left, right] = &mut self.kept;
        let step = GROUPS / ENTRY;
        let lists = self.entries.chunks(step);
        for (list, to) in lists.zip(left.chunks_mut(step).zip(right.chunks_mut(step))) {
            let to = [to.0.as_mut_ptr(), to.1.as_mut_ptr()];
            // SAFETY: the processor is the caller's promise; there is such a group for each entry, and
            // both lists are as long as the entries.
            unsafe { (kernels.filter_groups)(&rays, &groups, list, boxes, to) };
        }
        2 * ENTRY * self.entries.len()
    }

    fn left(&self) -> Vec<u32> {
        let kept = self.kept.iter().flatten();
        kept.flat_map(|entry| [entry.at, entry.mask]).collect()
    }
}

/// Copied rays against both children.
struct BothBoxes<const SHARED: bool> {
    rays: Copied,
    kept: [usize; 2],
}

pub(super) fn both_boxes<const SHARED: bool>(bytes: usize) -> Bench {
    let record = if SHARED { 12 } else { 24 } + 4;
    // With t. The kept records go somewhere else.
    let touched = record + 4 + record;
    let len = (bytes / touched).max(1000);
    let mut work = BothBoxes::<SHARED> {
        rays: Copied::with_room(len, 3 * len / 2 + MAX_LANES, SHARED),
        kept: [0; 2],
    };
    work.reset();
    // SAFETY: the processor was checked.
    unsafe { work.run(best()) };
    let copied = work.kept.iter().sum::<usize>() as f64 / len as f64;
    Bench {
        work: Box::new(work),
        bytes_per_test: ((record + 4) as f64 + copied * record as f64) / 2.0,
    }
}

impl<const SHARED: bool> BothBoxes<SHARED> {
    /// Where the copies begin.
    fn places(&self) -> [usize; 2] {
        let list = self.rays.len().next_multiple_of(MAX_LANES) + MAX_LANES;
        [list, 2 * list]
    }
}

impl<const SHARED: bool> Work for BothBoxes<SHARED> {
    fn reset(&mut self) {
        self.rays.reset(SHARED);
        self.kept = [0; 2];
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        // Blocks of `best` are too small to fetch ahead.
        let rays = Rays {
            ahead: false,
            ..self.rays.pointers(SHARED)
        };
        let len = self.rays.len();
        let list = List { start: 0, len };
        let boxes = CHILDREN.each_ref();
        // SAFETY: the processor is the caller's promise; the list is that of the batch, and there is
        // room for two more of its length.
        self.kept = unsafe { (kernels.filter_both)(&rays, list, boxes, self.places()) };
        2 * len
    }

    fn left(&self) -> Vec<u32> {
        let ids = self.rays.ids();
        let of = |(place, kept): (usize, usize)| ids[place..place + kept].to_vec();
        let lists = self.places().into_iter().zip(self.kept);
        lists.flat_map(of).collect()
    }
}

/// Rays put in order.
struct InOrder {
    batch: Batch,
    records: Vec<SortedRay>,
    places: Vec<u32>,
    keys: Vec<u16>,
    buckets: Vec<u32>,
}

/// Rays that are sorted together.
const WINDOW: usize = BestParameters::BEST.window as usize;

pub(super) fn put_in_order(bytes: usize) -> Bench {
    // A ray is read and written; where it stood and its key are written.
    let touched = 32 + 32 + 4 + 2;
    let len = (bytes / touched).max(1000);
    let window = len.min(WINDOW);
    Bench {
        work: Box::new(InOrder {
            batch: batch(len, false),
            records: vec![[[0.0; 4]; 2]; window],
            places: vec![0; window],
            keys: vec![0; window],
            buckets: vec![0; BUCKETS],
        }),
        bytes_per_test: touched as f64,
    }
}

impl Work for InOrder {
    fn reset(&mut self) {
        self.places.fill(0);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        // Where the rays start.
        let away = Vec3::new(0.0, 0.0, 1.5);
        let scene = Aabb {
            min: CUBE.min - away,
            max: CUBE.max - away,
        };
        let len = self.batch.len();
        for from in (0..len).step_by(WINDOW) {
            let range = from..len.min(from + WINDOW);
            let window = Window {
                records: self.records.as_mut_ptr(),
                places: self.places.as_mut_ptr(),
            };
            let keys = &mut self.keys[..range.len()];
            // SAFETY: the processor is the caller's promise; there is room for the window.
            unsafe {
                let (batch, next) = (&self.batch, &mut self.buckets);
                (kernels.count_keys)(batch, range.clone(), false, &scene, keys, next);
                place_keys(next);
                (kernels.put_in_order)(batch, range, keys, next, window);
            }
        }
        len
    }

    fn left(&self) -> Vec<u32> {
        self.places.clone()
    }
}

/// Triangles gathered into the cells of a grid.
struct Clusters {
    items: Vec<Item>,
    grid: Grid,
    cells: Vec<u32>,
    counts: Vec<u32>,
    boxes: Vec<BinBox>,
    sorted: Vec<Item>,
}

/// What is touched of a triangle, with its part of a cell.
const CLUSTERED: usize =
    2 * size_of::<Item>() + size_of::<u32>() + (size_of::<u32>() + size_of::<BinBox>()) / CELL;

fn clusters_of(items: Vec<Item>) -> Bench {
    let n = items.len();
    let grid = Grid::new(&CUBE, (n / CELL).max(1));
    Bench {
        work: Box::new(Clusters {
            cells: vec![0; n],
            counts: vec![0; grid.cells()],
            boxes: vec![BinBox::EMPTY; grid.cells()],
            sorted: vec![Item::ZERO; n],
            items,
            grid,
        }),
        bytes_per_test: CLUSTERED as f64,
    }
}

/// Neighbours in memory are mostly neighbours in space, as in meshes.
pub(super) fn clusters(bytes: usize) -> Bench {
    let n = (bytes / CLUSTERED).max(1000);
    let side = (n as f64).cbrt().ceil() as usize;
    let item = |i: usize| {
        let place = [i % side, i / side % side, i / (side * side)];
        let size = 1.0 / side as f32;
        let corner = size * Vec3::from(place.map(|at| at as f32));
        let [x, y] = [0, 1].map(|k| size * number(8, 2 * i + k));
        let triangle = Triangle::new(corner, corner + x * Vec3::X, corner + y * Vec3::Y);
        Item::new(&triangle, i as u32)
    };
    clusters_of((0..n).map(item).collect())
}

pub(super) fn clusters_in_random_order(bytes: usize) -> Bench {
    clusters_of(items((bytes / CLUSTERED).max(1000)))
}

impl Work for Clusters {
    fn reset(&mut self) {
        self.sorted.fill(Item::ZERO);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let (items, cells) = (&self.items, &mut self.cells);
        self.counts.fill(0);
        self.boxes.fill(BinBox::EMPTY);
        // SAFETY: the processor is the caller's promise; all cells are of the grid, and places are
        // those of as many items.
        unsafe {
            (kernels.count_cells)(items, &self.grid, cells, &mut self.counts);
            let mut sum = 0;
            for count in &mut self.counts {
                sum += std::mem::replace(count, sum);
            }
            let to = self.sorted.as_mut_ptr();
            (kernels.scatter)(items, cells, &mut self.counts, &mut self.boxes, to);
        }
        items.len()
    }

    fn left(&self) -> Vec<u32> {
        self.sorted.iter().map(Item::prim).collect()
    }
}

/// Triangles prepared, a leaf at a time.
struct Leaves<const SHARED: bool> {
    mesh: Mesh,
    items: Vec<Item>,
    prepared: Vec<Prepared>,
    /// A ray, for its origin.
    rays: Copied,
}

impl<const SHARED: bool> Leaves<SHARED> {
    fn new(leaves: usize) -> Leaves<SHARED> {
        let n = leaves.max(1) * LEAF;
        Leaves {
            mesh: mesh(n),
            items: items(n),
            prepared: vec![Prepared::ZERO; n],
            rays: Copied::new(1, SHARED),
        }
    }
}

pub(super) fn prepare<const SHARED: bool>(bytes: usize) -> Bench {
    let touched = size_of::<Item>() + size_of::<Triangle>() + size_of::<Prepared>();
    Bench {
        work: Box::new(Leaves::<SHARED>::new(bytes / touched / LEAF)),
        bytes_per_test: touched as f64,
    }
}

impl<const SHARED: bool> Work for Leaves<SHARED> {
    fn reset(&mut self) {
        self.prepared.fill(Prepared::ZERO);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let rays = self.rays.pointers(SHARED);
        let triangles = self.mesh.triangles();
        let leaves = self.items.chunks(LEAF);
        for (items, to) in leaves.zip(self.prepared.chunks_mut(LEAF)) {
            // SAFETY: the processor is the caller's promise.
            unsafe { (kernels.prepare_leaf)(&rays, triangles, items, to) };
        }
        self.items.len()
    }

    fn left(&self) -> Vec<u32> {
        const NUMBERS: usize = size_of::<Prepared>() / size_of::<u32>();
        // Each is numbers of four bytes, and there is nothing between them.
        const _: () = assert!(NUMBERS == 20);
        let len = NUMBERS * self.prepared.len();
        // SAFETY: any bits are a number.
        unsafe { slice::from_raw_parts(self.prepared.as_ptr().cast(), len) }.to_vec()
    }
}

/// The leaves that rays meet.
fn prepared_leaves<const SHARED: bool>() -> Leaves<SHARED> {
    let mut leaves = Leaves::new(LEAVES);
    // SAFETY: the processor was checked.
    unsafe { leaves.run(best()) };
    leaves
}

/// Rays of groups against prepared leaves.
struct GroupLeaves<const SHARED: bool> {
    block: Block<SHARED>,
    entries: Vec<Entry>,
    leaves: Leaves<SHARED>,
}

pub(super) fn group_leaves<const SHARED: bool>(bytes: usize) -> Bench {
    // Inverse direction, direction, tmin and t.
    let touched = if SHARED { 12 } else { 24 } + 12 + 4 + 4;
    let whole = GROUP * ENTRY;
    let len = (bytes / touched / whole).max(1) * whole;
    Bench {
        work: Box::new(GroupLeaves {
            block: Block::<SHARED>::new(coherent_batch(len, SHARED)),
            entries: entries(len),
            leaves: prepared_leaves(),
        }),
        bytes_per_test: touched as f64 / LEAF as f64,
    }
}

impl<const SHARED: bool> Work for GroupLeaves<SHARED> {
    fn reset(&mut self) {
        self.block.load();
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let (rays, block) = self.block.pointers();
        let triangles = self.leaves.mesh.triangles();
        let leaves = self.leaves.prepared.chunks(LEAF).cycle();
        for (list, leaf) in self.entries.chunks(RAYS / ENTRY).zip(leaves) {
            // SAFETY: the processor is the caller's promise; entries are of rays of the block.
            unsafe { (kernels.naive_in_order)(&rays, &block.ordered, list, triangles, leaf) };
        }
        ENTRY * self.entries.len() * LEAF
    }

    fn left(&self) -> Vec<u32> {
        self.block.prim[..self.block.batch.len()].to_vec()
    }
}

/// Lists of rays against prepared leaves.
struct CopiedLeaves<const SHARED: bool> {
    rays: Copied,
    leaves: Leaves<SHARED>,
}

pub(super) fn copied_leaves<const SHARED: bool>(bytes: usize) -> Bench {
    // With t, direction and tmin.
    let touched = if SHARED { 12 } else { 24 } + 4 + 4 + 16;
    Bench {
        work: Box::new(CopiedLeaves {
            rays: Copied::new(whole_lists(bytes / touched), SHARED),
            leaves: prepared_leaves::<SHARED>(),
        }),
        bytes_per_test: touched as f64 / LEAF as f64,
    }
}

impl<const SHARED: bool> Work for CopiedLeaves<SHARED> {
    fn reset(&mut self) {
        self.rays.reset(SHARED);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let rays = Rays {
            ahead: false,
            ..self.rays.pointers(SHARED)
        };
        let len = self.rays.len();
        let triangles = self.leaves.mesh.triangles();
        let leaves = self.leaves.prepared.chunks(LEAF).cycle();
        for (start, leaf) in (0..len).step_by(RAYS).zip(leaves) {
            let list = List { start, len: RAYS };
            // SAFETY: the processor is the caller's promise; the list is a part of that of the batch.
            unsafe { (kernels.naive_kept)(&rays, list, triangles, leaf) };
        }
        len * LEAF
    }

    fn left(&self) -> Vec<u32> {
        self.rays.found().to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::MISS;
    use crate::simd::Isa;

    fn bits(entries: &[Entry]) -> usize {
        entries.iter().map(|e| e.mask.count_ones() as usize).sum()
    }

    /// Groups that are all kept, or none, would be easier than those of a trace.
    #[test]
    fn about_half_of_the_groups_meet_each_child() {
        let mut block = Block::<false>::new(coherent_batch(GROUPS * GROUP, false));
        block.load();
        let bounds = block.bounds.clone();
        let entries = entries(GROUPS);
        let mut bench = GroupBox {
            block,
            bounds,
            kept: [entries.clone(), entries.clone()],
            entries,
        };
        bench.reset();
        // SAFETY: the processor has what is best.
        unsafe { bench.run(Kernels::of(Isa::best())) };
        for kept in &bench.kept {
            let share = bits(kept) as f64 / GROUPS as f64;
            assert!((0.3..0.9).contains(&share), "{share}");
        }
    }

    #[test]
    fn rays_hit_some_triangles_of_leaves() {
        for mut bench in [
            group_leaves::<false>(1 << 20),
            copied_leaves::<false>(1 << 20),
        ] {
            bench.reset();
            bench.run(Isa::best());
            let found = bench.work.left();
            let hits = found.iter().filter(|&&prim| prim != MISS).count();
            let share = hits as f64 / found.len() as f64;
            assert!((0.1..0.95).contains(&share), "{share}");
        }
    }
}
