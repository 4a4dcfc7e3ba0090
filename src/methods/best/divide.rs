//! A block of rays on its way through the splits: first as groups, then as lists of rays.

use super::BestParameters;
use super::memory::SplitRoom;
use super::splits::{Node, Splits, State};
use super::watched::Watched;
use crate::kernels::{ENTRY, Entry, GROUP, Groups, Keep, Kernels, List, Ordered, Rays};
use crate::methods::Counters;
use crate::simd::MAX_LANES;

/// Groups that tell whether groups still pay at a node.
const SAMPLE: usize = 4;

/// One block under way.
pub(super) struct Divide<'a, 'w> {
    pub kernels: &'static Kernels,
    pub parameters: &'a BestParameters,
    pub splits: &'a Splits<'a>,
    pub room: &'a mut SplitRoom,
    /// Records and whatever else there is of each ray of the block, by number.
    pub rays: Rays,
    pub ordered: Ordered,
    pub groups: Groups,
    /// Room for lists of groups.
    pub entries: &'a mut [Entry],
    /// Room for the rays of a list of groups.
    pub in_groups: &'a mut [Entry],
    /// Records that lists may use in all.
    pub capacity: usize,
    pub counters: &'a mut Counters,
    /// Who watches a ray of the block, if somebody does.
    pub watch: Option<Watched<'w>>,
}

impl Divide<'_, '_> {
    /// Traces rays 0 to `len` of the block.
    pub fn start(&mut self, len: usize) {
        let groups = len.div_ceil(GROUP);
        let entries = groups.div_ceil(ENTRY);
        for (at, entry) in self.entries[..entries].iter_mut().enumerate() {
            let left = (groups - at * ENTRY).min(ENTRY);
            *entry = Entry {
                at: at as u32,
                mask: u32::MAX >> (32 - left),
            };
        }
        self.divide_groups(0, [0, entries], len.next_multiple_of(GROUP));
    }

    /// What has become of a node that rays have come to.
    fn open(&mut self, at: usize) -> State {
        let Counters {
            nodes,
            binned_triangles,
            ..
        } = &mut *self.counters;
        *nodes += 1;
        self.splits
            .open(at, &self.rays, self.room, binned_triangles)
    }

    /// Algorithm 1 with groups in the place of rays: those of a list of entries. Records from `top` on
    /// are free.
    fn divide_groups(&mut self, at: usize, [from, to]: [usize; 2], top: usize) {
        let (splits, state) = (self.splits, self.open(at));
        let node = splits.node(at);
        let first = match state {
            State::Leaf(first) => return self.naive_groups(node, first, [from, to]),
            State::Split(first) => first,
        };
        if self.parameters.flush > 0.0 && self.leaves_groups(node, [from, to]) {
            return self.flush(at, [from, to], top);
        }
        let children = self.in_order(node, first, self.first_of_groups(from));
        let boxes = children.map(|child| &splits.node(child).bounds);
        let (all, free) = self.entries.split_at_mut(to);
        let (far, near) = free.split_at_mut(to - from);
        assert!(near.len() >= to - from, "room for both lists");
        self.counters.group_box += 2 * (ENTRY * (to - from)) as u64;
        // SAFETY: the processor was checked; both lists have room for as many entries.
        let [n_near, n_far] = unsafe {
            let to = [near.as_mut_ptr(), far.as_mut_ptr()];
            (self.kernels.filter_groups)(&self.rays, &self.groups, &all[from..], boxes, to)
        };
        let lists = [[2 * to - from, 2 * to - from + n_near], [to, to + n_far]];
        for (child, list) in children.into_iter().zip(lists) {
            self.watch_groups(child, [from, to], list);
        }
        for (child, list) in children.into_iter().zip(lists) {
            if list[0] < list[1] {
                self.divide_groups(child, list, top);
            }
        }
    }

    /// The naive step with the rays of groups that meet the leaf's box.
    fn naive_groups(&mut self, node: &Node, first: usize, [from, to]: [usize; 2]) {
        let (n, rays) = self.rays_of_groups(node, [from, to]);
        if n == 0 {
            return;
        }
        let leaf = self.splits.leaf(first, node);
        self.counters.leaves += 1;
        self.counters.ray_triangle += (rays * leaf.len()) as u64;
        self.watch_leaf(node, leaf, rays, |divide| {
            divide.has_ray(&divide.in_groups[..n])
        });
        let (rays, triangles) = (&self.rays, self.splits.triangles);
        // SAFETY: the processor was checked; entries are of rays and groups of the block.
        unsafe {
            let list = &self.in_groups[..n];
            (self.kernels.naive_in_order)(rays, &self.ordered, list, triangles, leaf);
            (self.kernels.refresh_groups)(rays, &self.groups, &self.entries[from..to]);
        }
    }

    /// Whether so few rays of some groups meet a node's box that lists of rays are better.
    fn leaves_groups(&mut self, node: &Node, [from, to]: [usize; 2]) -> bool {
        let entries = &self.entries[from..to];
        let mut sample = [Entry::ZERO; SAMPLE];
        let mut n = 0;
        for entry in entries.iter().step_by(entries.len().div_ceil(SAMPLE)) {
            let first = entry.mask & entry.mask.wrapping_neg();
            sample[n] = Entry {
                mask: first,
                ..*entry
            };
            n += 1;
        }
        let mut rays = [Entry::ZERO; SAMPLE * GROUP / ENTRY + 1];
        // SAFETY: the processor was checked; there is room for all rays of the sample.
        let (_, kept) = unsafe {
            let rays = rays.as_mut_ptr();
            (self.kernels.rays_of_groups)(&self.rays, &sample[..n], &node.bounds, rays)
        };
        self.counters.sample_box += (n * GROUP) as u64;
        kept as f32 <= self.parameters.flush * (n * GROUP) as f32
    }

    /// Goes on with lists of rays.
    fn flush(&mut self, at: usize, list: [usize; 2], top: usize) {
        let (n, len) = self.rays_of_groups(self.splits.node(at), list);
        self.watch_flush(at, list, n);
        if len == 0 {
            return;
        }
        // SAFETY: the processor was checked; there is always room for the block once more.
        unsafe { (self.kernels.flush_groups)(&self.rays, &self.in_groups[..n], top) };
        let active = List { start: top, len };
        self.divide_rays(at, active, (top + len).next_multiple_of(MAX_LANES));
        // SAFETY: the processor was checked.
        unsafe {
            let entries = &self.entries[list[0]..list[1]];
            (self.kernels.refresh_groups)(&self.rays, &self.groups, entries);
        }
    }

    /// Rays of groups that meet a node's box: entries and rays.
    fn rays_of_groups(&mut self, node: &Node, [from, to]: [usize; 2]) -> (usize, usize) {
        let entries = &self.entries[from..to];
        let groups = entries.iter().map(|entry| entry.mask.count_ones() as u64);
        self.counters.ray_box += groups.sum::<u64>() * GROUP as u64;
        // SAFETY: the processor was checked; there is room for all rays of the block.
        unsafe {
            let to = self.in_groups.as_mut_ptr();
            (self.kernels.rays_of_groups)(&self.rays, entries, &node.bounds, to)
        }
    }

    /// Algorithm 1. Records from `top` on are free.
    fn divide_rays(&mut self, at: usize, active: List, top: usize) {
        let (splits, state) = (self.splits, self.open(at));
        let node = splits.node(at);
        let first = match state {
            State::Leaf(first) => return self.naive_rays(node, first, active),
            State::Split(first) => first,
        };
        // SAFETY: the list is not empty.
        let first_ray = unsafe { *self.rays.active.id.add(active.start) };
        let children = self.in_order(node, first, first_ray as usize);
        for child in children {
            splits.prefetch(child);
        }
        let near = (top + active.len).next_multiple_of(MAX_LANES);
        let end = near + active.len + MAX_LANES;
        if end > self.capacity {
            return self.divide_in_place(children, active);
        }
        self.counters.ray_box += 2 * active.len as u64;
        self.counters.peak_list = self.counters.peak_list.max(end as u64);
        let boxes = children.map(|child| &splits.node(child).bounds);
        // SAFETY: the processor was checked; there is room for both copies.
        let lens = unsafe { (self.kernels.filter_both)(&self.rays, active, boxes, [near, top]) };
        let lists = [[near, lens[0]], [top, lens[1]]].map(|[start, len]| List { start, len });
        for (child, kept) in children.into_iter().zip(lists) {
            self.watch_rays(child, active, kept);
        }
        for (child, kept) in children.into_iter().zip(lists) {
            if kept.len > 0 {
                let top = (kept.start + kept.len).next_multiple_of(MAX_LANES);
                self.divide_rays(child, kept, top);
            }
        }
    }

    /// One child after the other, where there is no room for copies.
    #[cold]
    fn divide_in_place(&mut self, children: [usize; 2], active: List) {
        for child in children {
            let bounds = &self.splits.node(child).bounds;
            self.counters.ray_box += active.len as u64;
            // SAFETY: the processor was checked.
            let len = unsafe { (self.kernels.filter)(&self.rays, active, bounds, Keep::InPlace) };
            let kept = List { len, ..active };
            self.watch_rays(child, active, kept);
            if len > 0 {
                self.divide_rays(child, kept, self.capacity);
            }
        }
    }

    /// The naive step.
    fn naive_rays(&mut self, node: &Node, first: usize, active: List) {
        let leaf = self.splits.leaf(first, node);
        self.counters.leaves += 1;
        self.counters.ray_triangle += (active.len * leaf.len()) as u64;
        self.watch_leaf(node, leaf, active.len, |divide| divide.has(active));
        // SAFETY: the processor was checked.
        unsafe { (self.kernels.naive_kept)(&self.rays, active, self.splits.triangles, leaf) }
    }

    /// The children, the one first that a ray comes to first by the sign of its direction.
    fn in_order(&self, node: &Node, first: usize, ray: usize) -> [usize; 2] {
        // SAFETY: a ray of the block.
        let inverse = unsafe { *self.rays.active.inverse[node.axis as usize].add(ray) };
        match inverse < 0.0 {
            true => [first + 1, first],
            false => [first, first + 1],
        }
    }

    /// The first ray of a list of groups.
    fn first_of_groups(&self, from: usize) -> usize {
        let Entry { at, mask } = self.entries[from];
        (ENTRY * at as usize + mask.trailing_zeros() as usize) * GROUP
    }
}
