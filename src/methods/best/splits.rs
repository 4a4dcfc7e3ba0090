//! Splits of the triangles, made where rays first come and kept for the blocks and threads that follow.

use super::clusters::{self, Sorted};
use super::memory::SplitRoom;
use crate::geometry::{Aabb, Triangle};
use crate::kernels::{
    BinBox, Binning, Bins, CHUNK, Copies, Grid, Item, ItemList, Kernels, MAX_BINS, Prepared, Rays,
};
use crate::methods::job::Job;
use crate::room::room_with;
use std::marker::PhantomData;
use std::ptr::NonNull;
use std::slice;
use std::sync::atomic::{AtomicU32, Ordering};

/// Triangles of a leaf: as many as are prepared together.
pub(super) const LEAF: usize = CHUNK;
/// Bins of a split; fewer where there are few triangles.
const BINS: usize = 16;
/// Clusters of more triangles than this are made into smaller ones.
const GATHERED: usize = 1024;
/// From this depth on nodes are halved by number, first of clusters and then of triangles, so that the
/// recursion ends: of 2²⁹ triangles in 2²⁷ clusters before depth 100.
const MAX_DEPTH: u8 = 40;

/// A subproblem's triangles.
pub(super) struct Node {
    pub bounds: Aabb,
    part: Part,
    /// What has become of it: [`NEW`], [`BUSY`], or an encoded [`State`].
    state: AtomicU32,
    /// On which it was split.
    pub axis: u8,
    pub depth: u8,
}

/// Part of the triangles.
#[derive(Clone, Copy)]
struct Part {
    /// Range of the clusters, or of the items.
    from: u32,
    to: u32,
    /// How many triangles they are.
    weight: u32,
    of_clusters: bool,
}

const NEW: u32 = 0;
/// Some thread is at it.
const BUSY: u32 = 1;

/// What has become of a node that rays have come to.
#[derive(Clone, Copy)]
pub(super) enum State {
    /// Number of the left child; the right one follows.
    Split(usize),
    /// Number of the first of its prepared triangles, of which it has [`Node::weight`].
    Leaf(usize),
}

impl State {
    fn encode(self) -> u32 {
        match self {
            State::Split(at) => 2 + 2 * at as u32,
            State::Leaf(at) => 3 + 2 * at as u32,
        }
    }

    fn decode(code: u32) -> Option<State> {
        let at = (code.wrapping_sub(2) / 2) as usize;
        match code {
            NEW | BUSY => None,
            code if code & 1 == 0 => Some(State::Split(at)),
            _ => Some(State::Leaf(at)),
        }
    }
}

impl Node {
    /// The most nodes that there can be: each leaf has a triangle.
    pub fn most(triangles: usize) -> usize {
        2 * triangles + 1
    }

    /// Room for all nodes.
    ///
    /// # Panics
    /// If there are more than 2²⁹ triangles.
    pub fn room(triangles: usize) -> Vec<Node> {
        assert!(triangles <= 1 << 29, "at most 2^29 triangles");
        let nothing = Part {
            from: 0,
            to: 0,
            weight: 0,
            of_clusters: false,
        };
        room_with(|| Node::new(Aabb::EMPTY, nothing, 0), Node::most(triangles))
    }

    fn new(bounds: Aabb, part: Part, depth: u8) -> Node {
        Node {
            bounds,
            part,
            state: AtomicU32::new(NEW),
            axis: 0,
            depth,
        }
    }

    fn copy(&self) -> Node {
        Node {
            state: AtomicU32::new(self.state.load(Ordering::Acquire)),
            ..*self
        }
    }

    /// Number of triangles; of a leaf that was opened, without the copies that were dropped.
    pub fn weight(&self) -> usize {
        self.part.weight as usize
    }
}

/// All splits of one trace.
///
/// The items, clusters and scratch places of a node belong to the thread that has made it [`BUSY`]; what
/// stands in a node is not changed any more once another state is there to be seen.
pub(super) struct Splits<'a> {
    pub kernels: &'static Kernels,
    pub triangles: &'a [Triangle],
    /// Items by cluster, then by leaf.
    items: *mut Item,
    scratch: *mut Item,
    clusters: *mut Item,
    cluster_scratch: *mut Item,
    cluster_count: AtomicU32,
    most_clusters: u32,
    /// Items of each cluster.
    ranges: *mut [u32; 2],
    /// The cell of each item.
    cells: *mut u32,
    /// Triangles for each cell.
    cell_triangles: f32,
    nodes: *mut Node,
    node_count: AtomicU32,
    prepared: *mut Prepared,
    prepared_count: AtomicU32,
    /// Whether they are those of an earlier trace, to which nothing is added.
    are_kept: bool,
    _memory: PhantomData<&'a mut Node>,
}

// SAFETY: see the rule above; all else is read only.
unsafe impl Sync for Splits<'_> {}

/// The splits of a trace that is over.
pub(in crate::methods) struct Kept {
    nodes: Vec<Node>,
    prepared: Vec<Prepared>,
}

impl Kept {
    /// Number of nodes; some of them no ray has come to.
    pub fn nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Number of triangles of the leaves that rays have come to.
    pub fn triangles(&self) -> usize {
        self.prepared.len()
    }
}

/// Where splits are made.
pub(super) struct Places<'a> {
    pub items: &'a mut [Item],
    pub scratch: &'a mut [Item],
    /// The first ones, numbered by their place, and room for more.
    pub clusters: &'a mut [Item],
    pub cluster_scratch: &'a mut [Item],
    pub ranges: &'a mut [[u32; 2]],
    pub cells: &'a mut [u32],
    pub nodes: &'a mut [Node],
    pub prepared: &'a mut [Prepared],
}

/// Where to part the items of a node.
struct Cut {
    binning: Binning,
    last_left: usize,
    cost: f32,
    left: Aabb,
    right: Aabb,
    /// Triangles on the left.
    weight: u32,
}

impl<'a> Splits<'a> {
    /// Nothing is split yet; there are so many clusters.
    pub fn new(
        kernels: &'static Kernels,
        triangles: &'a [Triangle],
        bounds: Aabb,
        clusters: usize,
        cell_triangles: f32,
        places: Places<'a>,
    ) -> Splits<'a> {
        let weight = places.items.len() as u32;
        assert_eq!(places.items.len(), places.scratch.len());
        let lens = [places.cluster_scratch.len(), places.ranges.len()];
        assert_eq!(lens, [places.clusters.len(); 2]);
        assert!(clusters <= places.clusters.len() && places.cells.len() >= places.items.len());
        assert!(places.nodes.len() >= Node::most(weight as usize));
        assert!(places.prepared.len() >= weight as usize);
        let all = Part {
            from: 0,
            to: clusters as u32,
            weight,
            of_clusters: true,
        };
        places.nodes[0] = Node::new(bounds, all, 0);
        Splits {
            kernels,
            triangles,
            items: places.items.as_mut_ptr(),
            scratch: places.scratch.as_mut_ptr(),
            clusters: places.clusters.as_mut_ptr(),
            cluster_scratch: places.cluster_scratch.as_mut_ptr(),
            cluster_count: AtomicU32::new(clusters as u32),
            most_clusters: places.clusters.len() as u32,
            ranges: places.ranges.as_mut_ptr(),
            cells: places.cells.as_mut_ptr(),
            cell_triangles,
            nodes: places.nodes.as_mut_ptr(),
            node_count: AtomicU32::new(1),
            prepared: places.prepared.as_mut_ptr(),
            prepared_count: AtomicU32::new(0),
            are_kept: false,
            _memory: PhantomData,
        }
    }

    /// The splits that a trace has made, for the same rays.
    pub fn kept(job: &Job<'a>, kept: &'a Kept) -> Splits<'a> {
        Splits {
            kernels: job.kernels,
            triangles: job.mesh.triangles(),
            items: NonNull::dangling().as_ptr(),
            scratch: NonNull::dangling().as_ptr(),
            clusters: NonNull::dangling().as_ptr(),
            cluster_scratch: NonNull::dangling().as_ptr(),
            cluster_count: AtomicU32::new(0),
            most_clusters: 0,
            ranges: NonNull::dangling().as_ptr(),
            cells: NonNull::dangling().as_ptr(),
            cell_triangles: 0.0,
            nodes: kept.nodes.as_ptr().cast_mut(),
            node_count: AtomicU32::new(kept.nodes.len() as u32),
            prepared: kept.prepared.as_ptr().cast_mut(),
            prepared_count: AtomicU32::new(kept.prepared.len() as u32),
            are_kept: true,
            _memory: PhantomData,
        }
    }

    /// A copy of what has been made so far, when no thread is at work.
    pub fn keep(&self) -> Kept {
        let of = |count: &AtomicU32| count.load(Ordering::Acquire) as usize;
        // SAFETY: all nodes and prepared triangles that were given out have been written.
        let (nodes, prepared) = unsafe {
            (
                slice::from_raw_parts(self.nodes, of(&self.node_count)),
                slice::from_raw_parts(self.prepared, of(&self.prepared_count)),
            )
        };
        Kept {
            nodes: nodes.iter().map(Node::copy).collect(),
            prepared: prepared.to_vec(),
        }
    }

    /// A node that was given out.
    #[inline(always)]
    pub fn node(&self, at: usize) -> &Node {
        debug_assert!(at < self.node_count.load(Ordering::Relaxed) as usize);
        // SAFETY: there is room for as many nodes as can be.
        unsafe { &*self.nodes.add(at) }
    }

    /// Triangles of a leaf.
    #[inline(always)]
    pub fn leaf(&self, first: usize, node: &Node) -> &[Prepared] {
        // SAFETY: they were written before the state was, and are not changed.
        unsafe { slice::from_raw_parts(self.prepared.add(first), node.weight()) }
    }

    /// Splits a node, or prepares its triangles, if no rays have come to it before. Counts the items that
    /// it bins.
    #[inline]
    pub fn open(&self, at: usize, rays: &Rays, room: &mut SplitRoom, binned: &mut u64) -> State {
        match State::decode(self.node(at).state.load(Ordering::Acquire)) {
            Some(state) => state,
            None => self.open_new(at, rays, room, binned),
        }
    }

    #[cold]
    #[inline(never)]
    fn open_new(&self, at: usize, rays: &Rays, room: &mut SplitRoom, binned: &mut u64) -> State {
        assert!(!self.are_kept, "no ray has come here before");
        let state = &self.node(at).state;
        let taken = state.compare_exchange(NEW, BUSY, Ordering::Acquire, Ordering::Acquire);
        if taken.is_err() {
            let mut rounds = 0;
            loop {
                if let Some(state) = State::decode(state.load(Ordering::Acquire)) {
                    return state;
                }
                // The other thread may have no processor.
                rounds += 1;
                match rounds % 1024 {
                    0 => std::thread::yield_now(),
                    _ => std::hint::spin_loop(),
                }
            }
        }
        let part = self.node(at).part;
        let made = match part.weight as usize <= LEAF {
            true => self.prepare(part, rays),
            false => self.split(at, rays, room, binned),
        };
        state.store(made.encode(), Ordering::Release);
        made
    }

    /// Brings near what rays will need that are about to come to a node.
    #[inline]
    pub fn prefetch(&self, at: usize) {
        let node = self.node(at);
        let (p, len): (*const f32, usize) = match State::decode(node.state.load(Ordering::Acquire))
        {
            None => return,
            // SAFETY: within the room for both.
            Some(State::Split(first)) => unsafe {
                (self.nodes.add(first).cast(), 2 * size_of::<Node>())
            },
            // SAFETY: as above.
            Some(State::Leaf(first)) => unsafe {
                let len = node.weight() * size_of::<Prepared>();
                (self.prepared.add(first).cast(), len)
            },
        };
        // SAFETY: the processor was checked.
        unsafe { (self.kernels.prefetch)(p, len) }
    }

    /// Items of a part, and as much scratch.
    ///
    /// # Safety
    /// The part is that of a node of this thread.
    #[allow(clippy::mut_from_ref)]
    unsafe fn items_of(&self, part: Part) -> (&mut [Item], &mut [Item]) {
        let (items, scratch) = match part.of_clusters {
            true => (self.clusters, self.cluster_scratch),
            false => (self.items, self.scratch),
        };
        let (from, len) = (part.from as usize, (part.to - part.from) as usize);
        // SAFETY: nodes that are not each other's ancestors have other items, and those of the ancestors
        // are not looked at any more.
        unsafe {
            (
                slice::from_raw_parts_mut(items.add(from), len),
                slice::from_raw_parts_mut(scratch.add(from), len),
            )
        }
    }

    /// Prepares the triangles of a leaf.
    fn prepare(&self, part: Part, rays: &Rays) -> State {
        let mut together = [Item::ZERO; LEAF];
        let mut n = 0;
        // SAFETY: the node is this thread's.
        let (items, _) = unsafe { self.items_of(part) };
        let items = match part.of_clusters {
            false => &*items,
            true => {
                for cluster in items {
                    let [from, to] = self.range(cluster).map(|i| i as usize);
                    // SAFETY: items of a cluster of this node.
                    let of = unsafe { slice::from_raw_parts(self.items.add(from), to - from) };
                    together[n..n + of.len()].copy_from_slice(of);
                    n += of.len();
                }
                &together[..n]
            }
        };
        let n = items.len() as u32;
        let first = self.prepared_count.fetch_add(n, Ordering::Relaxed) as usize;
        // SAFETY: the processor was checked; each triangle is in one leaf, so there is room.
        unsafe {
            let to = slice::from_raw_parts_mut(self.prepared.add(first), items.len());
            (self.kernels.prepare_leaf)(rays, self.triangles, items, to);
        }
        State::Leaf(first)
    }

    /// Splits a node.
    fn split(&self, at: usize, rays: &Rays, room: &mut SplitRoom, binned: &mut u64) -> State {
        let node = self.node(at);
        let (bounds, depth, mut part) = (node.bounds, node.depth, node.part);
        if part.of_clusters && part.to - part.from == 1 {
            // SAFETY: the clusters of the node are this thread's until its state is written.
            let cluster = unsafe { &*self.clusters.add(part.from as usize) };
            [part.from, part.to] = self.range(cluster);
            part.of_clusters = false;
            if part.weight as usize > GATHERED && depth < MAX_DEPTH {
                part = self.gather(&bounds, part, room);
            }
        }
        // SAFETY: as above.
        let (items, scratch) = unsafe { self.items_of(part) };
        let cut = match depth < MAX_DEPTH {
            true => self.cut(items, &bounds, part, room, binned),
            false => None,
        };
        let mut axis = 0;
        let (n, left, right, weight) = match cut {
            Some(cut) => {
                axis = cut.binning.axis;
                // SAFETY: as above.
                let n = unsafe {
                    (self.kernels.partition)(items, scratch, &cut.binning, cut.last_left)
                };
                (n, cut.left, cut.right, cut.weight)
            }
            None => {
                if !part.of_clusters {
                    let mut list = ItemList {
                        triangles: self.triangles,
                        len: items.len(),
                        items: &mut *items,
                    };
                    list.drop_copies(LEAF + 1);
                    part.weight = list.len as u32;
                    part.to = part.from + part.weight;
                    if list.len <= LEAF {
                        // SAFETY: the node is this thread's, and nobody else looks at its part.
                        unsafe { (*self.nodes.add(at)).part = part };
                        return self.prepare(part, rays);
                    }
                }
                let items = &items[..(part.to - part.from) as usize];
                let (left, right) = items.split_at(items.len() / 2);
                // SAFETY: as above.
                let unite = |items| unsafe { (self.kernels.unite)(items) }.bounds();
                let weight = left.iter().map(Item::weight).sum();
                (left.len(), unite(left), unite(right), weight)
            }
        };
        let mid = part.from + n as u32;
        let parts = [
            Part {
                to: mid,
                weight,
                ..part
            },
            Part {
                from: mid,
                weight: part.weight - weight,
                ..part
            },
        ];
        let first = self.node_count.fetch_add(2, Ordering::Relaxed) as usize;
        for ((i, part), bounds) in parts.into_iter().enumerate().zip([left, right]) {
            if !part.of_clusters && part.weight as usize <= LEAF {
                self.prefetch_corners(part);
            }
            // SAFETY: there is room for as many nodes as can be, and these two are nobody else's.
            unsafe {
                self.nodes
                    .add(first + i)
                    .write(Node::new(bounds, part, depth + 1))
            };
        }
        // SAFETY: the node is this thread's, and nobody else looks at its axis.
        unsafe { (*self.nodes.add(at)).axis = axis as u8 };
        State::Split(first)
    }

    /// Where to part items by the surface area heuristic: clusters on the best of three axes, triangles on
    /// that on which their centres are spread furthest. Three axes for triangles, too, took 0.90 to 1.06
    /// times as long, around the dragon 1.03 to 1.06.
    fn cut(
        &self,
        items: &[Item],
        bounds: &Aabb,
        part: Part,
        room: &mut SplitRoom,
        binned: &mut u64,
    ) -> Option<Cut> {
        let bins = BINS.min(items.len().max(4) / 2);
        let mut axes = [0, 1, 2].map(|axis| Binning::new(bounds, axis, bins));
        let mut n = 3;
        if !part.of_clusters {
            // SAFETY: the processor was checked.
            let extent = unsafe { (self.kernels.spread_of_centers)(items) };
            let axis = (1..3).fold(0, |best, axis| match extent[axis] > extent[best] {
                true => axis,
                false => best,
            });
            (axes[0], n) = (axes[axis], (extent[axis] > 0.0) as usize);
            if n == 0 {
                return None;
            }
        }
        *binned += items.len() as u64;
        // SAFETY: as above.
        unsafe { (self.kernels.bin)(items, &axes[..n], &mut room.bins) };
        let mut best: Option<Cut> = None;
        for (binning, bins) in axes[..n].iter().zip(&room.bins) {
            if let Some(cut) = least_cost(bins, &mut room.suffix, *binning, part.weight)
                && best.as_ref().is_none_or(|best| cut.cost < best.cost)
            {
                best = Some(cut);
            }
        }
        best
    }

    /// Items of a cluster.
    fn range(&self, cluster: &Item) -> [u32; 2] {
        // SAFETY: ranges are written before their clusters.
        unsafe { *self.ranges.add(cluster.prim() as usize) }
    }

    /// Makes clusters of the items of a part, if they are in more than one cell of a grid and there is room
    /// for more clusters.
    fn gather(&self, bounds: &Aabb, part: Part, room: &mut SplitRoom) -> Part {
        // SAFETY: the node is this thread's, and so are the cells of its items.
        let ((items, scratch), cells) = unsafe {
            let cells = self.cells.add(part.from as usize);
            let len = part.weight as usize;
            (self.items_of(part), slice::from_raw_parts_mut(cells, len))
        };
        let most = self.most_clusters as usize;
        let cells_wanted = clusters::cells(items.len(), self.cell_triangles, most);
        let grid = Grid::new(bounds, cells_wanted);
        let parts = room.count(self.kernels, &grid, items, cells);
        let full = |count: u32| Some(count + parts).filter(|&n| n <= self.most_clusters);
        let order = Ordering::Relaxed;
        let first = match parts {
            0 | 1 => return part,
            _ => self.cluster_count.fetch_update(order, order, full),
        };
        let Ok(first) = first else { return part };
        // SAFETY: the processor was checked; the clusters from `first` on are this thread's.
        unsafe {
            let ranges = slice::from_raw_parts_mut(self.ranges.add(first as usize), parts as usize);
            let clusters =
                slice::from_raw_parts_mut(self.clusters.add(first as usize), parts as usize);
            clusters::place(&grid, slice::from_mut(room), part.from, ranges);
            clusters::scatter(self.kernels, items, cells, room, &Sorted(self.scratch));
            items.copy_from_slice(scratch);
            clusters::unite(&grid, slice::from_ref(room), first, ranges, clusters);
        }
        Part {
            from: first,
            to: first + parts,
            of_clusters: true,
            ..part
        }
    }

    /// Brings near the corners of what will be a leaf.
    fn prefetch_corners(&self, part: Part) {
        // SAFETY: the node is this thread's.
        let (items, _) = unsafe { self.items_of(part) };
        for item in items {
            let triangle = &self.triangles[item.prim() as usize];
            // SAFETY: the processor was checked.
            unsafe {
                let p = std::ptr::from_ref(triangle).cast();
                (self.kernels.prefetch)(p, size_of::<Triangle>());
            }
        }
    }
}

/// The cut between bins with the least surface area heuristic; none if all items are in one bin.
fn least_cost(
    bins: &Bins,
    suffix: &mut [BinBox; MAX_BINS],
    binning: Binning,
    triangles: u32,
) -> Option<Cut> {
    let mut right = BinBox::EMPTY;
    for j in (1..binning.bins()).rev() {
        right = right.merged(&bins.boxes[j]);
        suffix[j] = right;
    }
    let mut left = BinBox::EMPTY;
    let mut best: Option<Cut> = None;
    let mut weight = 0;
    for j in 0..binning.bins() - 1 {
        if bins.counts[j] == 0 {
            continue;
        }
        left = left.merged(&bins.boxes[j]);
        weight += bins.counts[j];
        if weight == triangles {
            break;
        }
        let (l, r) = (left.bounds(), suffix[j + 1].bounds());
        let cost = l.half_area() * weight as f32 + r.half_area() * (triangles - weight) as f32;
        if best.as_ref().is_none_or(|best| cost < best.cost) {
            best = Some(Cut {
                binning,
                last_left: j,
                cost,
                left: l,
                right: r,
                weight,
            });
        }
    }
    best
}
