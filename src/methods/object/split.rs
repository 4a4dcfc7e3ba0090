//! How a node is split, and which child goes first.

use super::divide::Divide;
use super::{Axes, Cost, Draws, OneRay, Order};
use crate::geometry::Aabb;
use crate::kernels::{
    BinBox, Binning, Bins, Candidate, Copies, Draw, ItemList, List, MAX_BINS, SampleCounts,
    first_enters_left,
};
use crate::random;

/// From this depth on nodes are halved by number, so that recursion ends at this depth plus the
/// binary logarithm of the number of triangles, whatever their boxes are like.
const MAX_DEPTH: u32 = 64;

/// Candidates of three axes.
const MAX_CANDIDATES: usize = 3 * (MAX_BINS - 1);

/// A subproblem's triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// The box around them: V of Algorithm 1.
    pub bounds: Aabb,
    /// Range of the items.
    pub from: usize,
    pub to: usize,
    pub depth: u32,
    /// What its random numbers are keyed by: a hash of the path from the root.
    pub key: u64,
}

impl Node {
    pub fn len(&self) -> usize {
        self.to - self.from
    }

    fn child(&self, side: u64, bounds: Aabb, from: usize, to: usize) -> Node {
        let key = random::hash(self.key, side, 0);
        Node {
            bounds,
            from,
            to,
            depth: self.depth + 1,
            key,
        }
    }
}

/// A child, and the estimate of its intersection ratio if rays were sampled.
pub(super) struct Child {
    pub node: Node,
    pub ratio: Option<f32>,
}

/// How the items of a candidate are told apart.
#[derive(Clone, Copy)]
enum Cut {
    /// Items of bins up to this one go left.
    Bins(Binning, usize),
    /// The first half goes left.
    Halves,
}

/// Room for the bins and all candidates of one node.
pub(super) struct Candidates {
    bins: [Bins; 3],
    /// `suffix[j]` is the box around bins j and up.
    suffix: [BinBox; MAX_BINS],
    pairs: [Candidate; MAX_CANDIDATES],
    cuts: [(Cut, u32); MAX_CANDIDATES],
    sampled: [SampleCounts; MAX_CANDIDATES],
    len: usize,
}

impl Candidates {
    pub fn boxed() -> Box<Candidates> {
        let nothing = Candidate {
            left: Aabb::EMPTY,
            right: Aabb::EMPTY,
        };
        Box::new(Candidates {
            bins: [Bins::EMPTY; 3],
            suffix: [BinBox::EMPTY; MAX_BINS],
            pairs: [nothing; MAX_CANDIDATES],
            cuts: [(Cut::Halves, 0); MAX_CANDIDATES],
            sampled: [SampleCounts::default(); MAX_CANDIDATES],
            len: 0,
        })
    }

    /// Each with the number of triangles on its left.
    pub fn pairs(&self) -> impl Iterator<Item = (&Candidate, u64)> {
        let pairs = self.pairs.iter().zip(&self.cuts).take(self.len);
        pairs.map(|(pair, (_, left))| (pair, u64::from(*left)))
    }

    /// Whether a candidate parts the triangles by number.
    pub fn is_halved(&self, place: usize) -> bool {
        matches!(self.cuts[place].0, Cut::Halves)
    }

    fn push(&mut self, pair: Candidate, cut: Cut, left_count: usize) {
        self.pairs[self.len] = pair;
        self.cuts[self.len] = (cut, left_count as u32);
        self.len += 1;
    }

    /// The candidates between the bins of one axis; those with an empty side are left out, and so are
    /// repetitions where a bin is empty.
    fn sweep(&mut self, place: usize, binning: Binning, items: usize) {
        let bins = binning.bins();
        let mut right = BinBox::EMPTY;
        for j in (1..bins).rev() {
            right = right.merged(&self.bins[place].boxes[j]);
            self.suffix[j] = right;
        }
        let mut left = BinBox::EMPTY;
        let mut left_count = 0;
        for j in 0..bins - 1 {
            let count = self.bins[place].counts[j] as usize;
            if count == 0 {
                continue;
            }
            left = left.merged(&self.bins[place].boxes[j]);
            left_count += count;
            if left_count == items {
                break;
            }
            let pair = Candidate {
                left: left.bounds(),
                right: self.suffix[j + 1].bounds(),
            };
            self.push(pair, Cut::Bins(binning, j), left_count);
        }
    }
}

impl Divide<'_> {
    /// Splits the node's items; the children in traversal order. None if copies were dropped and what is
    /// left is a leaf.
    pub(super) fn split(&mut self, node: &mut Node, active: List) -> Option<[Child; 2]> {
        let by_cost = self.splits_by_cost(node, active);
        let sample_box = self.counters.sample_box;
        self.find_candidates(
            node,
            if by_cost {
                self.parameters.bins as usize
            } else {
                2
            },
        );
        if self.candidates.len == 0 {
            self.drop_copies(node);
            if self.is_leaf(node, active) {
                return None;
            }
            self.halve(node);
        }
        if by_cost {
            self.counters.sah_nodes += 1;
        } else {
            self.counters.middle_nodes += 1;
        }
        let samples = by_cost || self.parameters.sample_middle;
        let sampled = samples
            && self.parameters.uses_samples()
            && active.len > self.parameters.min_rays as usize;
        if sampled {
            self.counters.sampled_nodes += 1;
            self.draw(active, node.key);
        }
        let chosen = match self.parameters.cost {
            Cost::Sampled if sampled => self.least_sampled_cost(node),
            _ => self.least_area_cost(node),
        };
        let pair = self.candidates.pairs[chosen];
        let counts = sampled.then(|| {
            if self.parameters.second_sample {
                self.draw(active, random::hash(node.key, 2, 0));
                self.count_samples(chosen, chosen + 1);
            } else if self.parameters.cost == Cost::Sah {
                self.count_samples(chosen, chosen + 1);
            }
            self.candidates.sampled[chosen]
        });

        let (cut, left_count) = self.candidates.cuts[chosen];
        let mid = node.from + left_count as usize;
        if let Cut::Bins(binning, last_left) = cut {
            let items = &mut self.items[node.from..node.to];
            // SAFETY: the processor was checked.
            let n =
                unsafe { (self.kernels.partition)(items, self.item_scratch, &binning, last_left) };
            debug_assert_eq!(n, left_count as usize);
        }
        let ratio = |n: u32| n as f32 / self.samples.len() as f32;
        let left = Child {
            node: node.child(0, pair.left, node.from, mid),
            ratio: counts.map(|c| ratio(c.left)),
        };
        let right = Child {
            node: node.child(1, pair.right, mid, node.to),
            ratio: counts.map(|c| ratio(c.right)),
        };
        let children = if self.left_goes_first(active, &pair, cut, counts) {
            [left, right]
        } else {
            [right, left]
        };
        let sample_box = self.counters.sample_box - sample_box;
        self.note_split(
            node,
            active,
            chosen,
            counts,
            sample_box,
            children.each_ref(),
        );
        Some(children)
    }

    /// Section 5: whether there are enough rays a triangle for a cost function.
    pub(super) fn splits_by_cost(&self, node: &Node, active: List) -> bool {
        let ratio = match self.parameters.cost {
            Cost::Sah => self.parameters.sah_ratio,
            Cost::Sampled => self.parameters.threshold,
        };
        active.len as f64 > ratio as f64 * node.len() as f64
    }

    /// Lines 5 and 6: candidates between equal slabs of the node's box; two slabs are a split in the
    /// middle. None where no plane separates the triangles.
    fn find_candidates(&mut self, node: &Node, bins: usize) {
        self.candidates.len = 0;
        let items = &self.items[node.from..node.to];
        let extent = match self.parameters.axes {
            // SAFETY: the processor was checked.
            Axes::Centers => unsafe { (self.kernels.spread_of_centers)(items) },
            Axes::Longest | Axes::All => node.bounds.extent(),
        };
        let longest = (0..3).fold(0, |best, axis| {
            if extent[axis] > extent[best] {
                axis
            } else {
                best
            }
        });
        let all = self.parameters.axes == Axes::All && bins > 2;
        let axes = if all { 0..3 } else { longest..longest + 1 };
        let binnings = [0, 1, 2].map(|axis| Binning::new(&node.bounds, axis, bins));
        if extent[longest] > 0.0 && node.depth < MAX_DEPTH {
            let binnings = &binnings[axes];
            self.counters.binned_triangles += (binnings.len() * items.len()) as u64;
            // SAFETY: the processor was checked.
            unsafe { (self.kernels.bin)(items, binnings, &mut self.candidates.bins) };
            for (place, &binning) in binnings.iter().enumerate() {
                self.candidates.sweep(place, binning, items.len());
            }
        }
    }

    fn drop_copies(&mut self, node: &mut Node) {
        let mut list = ItemList {
            triangles: self.triangles,
            len: node.len(),
            items: &mut self.items[node.from..node.to],
        };
        list.drop_copies(self.parameters.leaf_triangles as usize + 1);
        node.to = node.from + list.len;
    }

    /// Two halves by number.
    fn halve(&mut self, node: &Node) {
        let items = &self.items[node.from..node.to];
        let (left, right) = items.split_at(items.len() / 2);
        // SAFETY: the processor was checked.
        let unite = |items| unsafe { (self.kernels.unite)(items) }.bounds();
        let pair = Candidate {
            left: unite(left),
            right: unite(right),
        };
        self.candidates.push(pair, Cut::Halves, left.len());
    }

    /// Eq. 2 (without C_T and C_I, which do not change the choice); the last of equals, as printed.
    fn least_sampled_cost(&mut self, node: &Node) -> usize {
        self.count_samples(0, self.candidates.len);
        let c = &*self.candidates;
        let cost = |j: usize| {
            let (sampled, left) = (c.sampled[j], c.cuts[j].1 as u64);
            sampled.left as u64 * left + sampled.right as u64 * (node.len() as u64 - left)
        };
        (1..c.len).fold(0, |best, j| if cost(j) <= cost(best) { j } else { best })
    }

    /// Eq. 1, the surface area heuristic, likewise.
    pub(super) fn least_area_cost(&self, node: &Node) -> usize {
        let c = &*self.candidates;
        let cost = |j: usize| {
            let (pair, left) = (&c.pairs[j], c.cuts[j].1 as usize);
            pair.left.half_area() * left as f32
                + pair.right.half_area() * (node.len() - left) as f32
        };
        let (mut best, mut least) = (0, f32::INFINITY);
        for j in 0..c.len {
            let cost = cost(j);
            if cost <= least {
                (best, least) = (j, cost);
            }
        }
        best
    }

    /// Section 4.1: draws the sample rays of a node.
    fn draw(&mut self, active: List, key: u64) {
        let draw = Draw {
            count: self.parameters.samples as usize,
            replacement: self.parameters.draws == Draws::Replacement,
            seed: self.seed,
            node: key,
        };
        // SAFETY: the processor was checked.
        unsafe { (self.kernels.draw_samples)(self.samples, &self.rays, active, draw) }
    }

    /// Algorithm 2 for candidates `from..to`.
    fn count_samples(&mut self, from: usize, to: usize) {
        self.counters.sample_box += 2 * ((to - from) * self.samples.len()) as u64;
        let c = &mut *self.candidates;
        let (pairs, counts) = (&c.pairs[from..to], &mut c.sampled[from..to]);
        // SAFETY: the processor was checked.
        unsafe { (self.kernels.count_samples)(self.samples, &self.rays, pairs, counts) }
    }

    /// Section 4.3, and lines 19 to 25.
    fn left_goes_first(
        &self,
        active: List,
        pair: &Candidate,
        cut: Cut,
        counts: Option<SampleCounts>,
    ) -> bool {
        if let (Order::Sampled, Some(counts)) = (self.parameters.order, counts) {
            return if self.parameters.order_unbiased {
                counts.left_first >= counts.right_first
            } else {
                2 * counts.left_first as usize >= self.samples.len()
            };
        }
        match (self.parameters.one_ray, cut) {
            (OneRay::AxisSign, Cut::Bins(binning, _)) => {
                // SAFETY: the list is not empty.
                let inverse = unsafe { *self.rays.active.inverse[binning.axis].add(active.start) };
                // NaN: no direction on this axis.
                inverse >= 0.0 || inverse.is_nan()
            }
            // SAFETY: the list is not empty.
            _ => unsafe { first_enters_left(&self.rays, active, pair) },
        }
    }

    /// Takes a sampled child's ratio anew, now that its sibling has been traversed.
    pub(super) fn refresh_ratio(&mut self, child: &mut Child, active: List) {
        if child.ratio.is_none() {
            return;
        }
        self.draw(active, random::hash(child.node.key, 3, 0));
        let bounds = child.node.bounds;
        self.candidates.pairs[0] = Candidate {
            left: bounds,
            right: Aabb::EMPTY,
        };
        self.count_samples(0, 1);
        self.counters.sample_box -= self.samples.len() as u64;
        let kept = self.candidates.sampled[0].left;
        child.ratio = Some(kept as f32 / self.samples.len() as f32);
    }
}

#[cfg(test)]
mod tests;
