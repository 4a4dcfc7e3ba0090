//! The memory of a trace: what its threads share, and what each has for the block at hand.

use super::clusters::Part;
use super::parameters::{MAX_BLOCK, MAX_WINDOW};
use super::splits::Node;
use crate::kernels::{
    BUCKETS, BinBox, Bins, ENTRY, Entry, GROUP, Groups, Item, MAX_BINS, Ordered, Prepared,
    SortedRay, streams,
};
use crate::methods::Counters;
use crate::rays::active::ActiveRays;
use crate::room;
use crate::simd::MAX_LANES;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Streams of the directions and tmin of a block.
const ORDERED: usize = 4;
/// Lists of groups that are there at a time: two at each of the levels of the recursion.
const LEVELS: usize = 2 * 100;

/// Memory for traces of up to a number of rays and triangles with a number of threads.
pub(in crate::methods) struct Memory {
    pub(super) triangles: TriangleMemory,
    /// A window of the batch, in order.
    pub(super) records: Vec<SortedRay>,
    pub(super) record_places: Vec<u32>,
    pub(super) keys: Vec<u16>,
    /// Rays of each key for each thread, and where they go.
    pub(super) buckets: Vec<u32>,
    pub(super) rooms: Vec<SplitRoom>,
    pub(super) workers: Vec<Worker>,
    /// The threads but for the caller's, if there are any; started beforehand.
    pub(super) pool: Option<ThreadPool>,
}

/// Where triangles are split.
pub(super) struct TriangleMemory {
    pub items: Vec<Item>,
    /// The items by cell.
    pub sorted: Vec<Item>,
    /// The cell of each item.
    pub cells: Vec<u32>,
    pub clusters: Vec<Item>,
    pub cluster_scratch: Vec<Item>,
    /// Items of each cluster.
    pub ranges: Vec<[u32; 2]>,
    pub nodes: Vec<Node>,
    pub prepared: Vec<Prepared>,
    /// The triangles of each thread.
    pub parts: Vec<Part>,
}

/// The memory of one thread.
pub(super) struct Worker {
    /// The records of the block, then lists.
    pub active: ActiveRays,
    pub directions: Vec<[f32; 4]>,
    ordered: Vec<f32>,
    pub t: Vec<f32>,
    pub tmax: Vec<f32>,
    pub prim: Vec<u32>,
    /// Where the rays of the block stand in the batch.
    pub places: Vec<u32>,
    bounds: Vec<f32>,
    /// Lists of groups.
    pub entries: Vec<Entry>,
    /// The rays of one list.
    pub in_groups: Vec<Entry>,
    pub counters: Counters,
    pub invalid_rays: u64,
}

/// Room to split nodes, of one thread.
pub(super) struct SplitRoom {
    /// Items of each cell, and where they go.
    pub counts: Vec<u32>,
    /// The box of each cell.
    pub boxes: Vec<BinBox>,
    pub bins: [Bins; 3],
    /// `suffix[j]` is the box around bins j and up.
    pub suffix: [BinBox; MAX_BINS],
}

/// The most cells of a grid, and clusters in all.
fn cells(triangles: usize) -> usize {
    triangles / 4 + 1024
}

/// Rays of a block in a batch of so many: whole groups, and as many places as a vector may touch behind
/// them.
fn block(rays: usize) -> usize {
    rays.min(MAX_BLOCK).next_multiple_of(GROUP)
}

impl Memory {
    pub fn new(rays: usize, triangles: usize, threads: usize) -> Memory {
        Memory {
            triangles: TriangleMemory {
                items: room(Item::ZERO, triangles),
                sorted: room(Item::ZERO, triangles),
                cells: room(0, triangles),
                clusters: room(Item::ZERO, cells(triangles)),
                cluster_scratch: room(Item::ZERO, cells(triangles)),
                ranges: room([0; 2], cells(triangles)),
                nodes: Node::room(triangles),
                prepared: room(Prepared::ZERO, triangles),
                parts: room(Part::NONE, threads),
            },
            records: room([[0.0; 4]; 2], rays.min(MAX_WINDOW)),
            record_places: room(0, rays.min(MAX_WINDOW)),
            keys: room(0, rays.min(MAX_WINDOW)),
            buckets: room(0, threads * BUCKETS),
            rooms: (0..threads).map(|_| SplitRoom::new(triangles)).collect(),
            workers: (0..threads).map(|_| Worker::new(rays)).collect(),
            pool: (threads > 1).then(|| {
                let pool = ThreadPoolBuilder::new().num_threads(threads - 1);
                pool.build().expect("threads can be started")
            }),
        }
    }

    pub fn bytes(rays: usize, triangles: usize, threads: usize) -> usize {
        let items = 2 * triangles + 2 * cells(triangles);
        let window = rays.min(MAX_WINDOW);
        items * size_of::<Item>()
            + window * (size_of::<SortedRay>() + size_of::<u32>() + size_of::<u16>())
            + triangles * (size_of::<u32>() + size_of::<Prepared>())
            + cells(triangles) * size_of::<[u32; 2]>()
            + Node::most(triangles) * size_of::<Node>()
            + threads * BUCKETS * size_of::<u32>()
            + threads * (size_of::<Part>() + SplitRoom::bytes(triangles) + Worker::bytes(rays))
    }
}

impl SplitRoom {
    fn new(triangles: usize) -> SplitRoom {
        SplitRoom {
            counts: room(0, cells(triangles)),
            boxes: room(BinBox::EMPTY, cells(triangles)),
            bins: [Bins::EMPTY; 3],
            suffix: [BinBox::EMPTY; MAX_BINS],
        }
    }

    fn bytes(triangles: usize) -> usize {
        size_of::<SplitRoom>() + cells(triangles) * (size_of::<u32>() + size_of::<BinBox>())
    }
}

impl Worker {
    fn new(rays: usize) -> Worker {
        let block = block(rays);
        let len = block + MAX_LANES;
        Worker {
            active: ActiveRays::new(block),
            directions: room([0.0; 4], len),
            ordered: room(0.0, ORDERED * len),
            t: room(0.0, len),
            tmax: room(0.0, len),
            prim: room(0, len),
            places: room(0, len),
            bounds: room(0.0, Groups::STREAMS * Self::bounds_len(block)),
            entries: room(Entry::ZERO, Self::entries(block)),
            in_groups: room(Entry::ZERO, Self::ray_entries(block)),
            counters: Counters::default(),
            invalid_rays: 0,
        }
    }

    fn bytes(rays: usize) -> usize {
        let block = block(rays);
        let len = block + MAX_LANES;
        size_of::<Worker>()
            + ActiveRays::bytes(block)
            + len * (size_of::<[f32; 4]>() + (ORDERED + 4) * size_of::<f32>())
            + Groups::STREAMS * Self::bounds_len(block) * size_of::<f32>()
            + (Self::entries(block) + Self::ray_entries(block)) * size_of::<Entry>()
    }

    /// Groups of a block, up to a whole entry.
    fn bounds_len(block: usize) -> usize {
        (block / GROUP).next_multiple_of(ENTRY)
    }

    fn entries(block: usize) -> usize {
        (LEVELS + 1) * Self::bounds_len(block) / ENTRY
    }

    /// One more than there can be, for the place behind the last is written to.
    fn ray_entries(block: usize) -> usize {
        block / ENTRY + 1
    }

    pub fn ordered(&mut self) -> Ordered {
        let [x, y, z, tmin]: [*mut f32; ORDERED] = streams(&mut self.ordered);
        Ordered {
            direction: [x, y, z],
            tmin,
        }
    }

    pub fn groups(&mut self) -> Groups {
        Groups::new(&mut self.bounds)
    }
}
