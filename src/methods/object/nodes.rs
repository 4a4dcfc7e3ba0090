//! A log of the nodes of a trace, for research: the split that was chosen beside those that the surface area
//! heuristic and all rays would choose; intersection ratios as estimated and as they are.

use super::divide::Divide;
use super::split::{Child, Node};
use crate::geometry::Aabb;
use crate::kernels::{List, SampleCounts};

/// A node of a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeRecord {
    /// The way from the root: a 1, then for each split a 0 for the left child or a 1 for the right one.
    pub path: u128,
    /// How many splits there are above it.
    pub depth: u32,
    /// Its active rays, those that were not filtered among them.
    pub rays: u32,
    /// Its triangles.
    pub triangles: u32,
    /// The box around them.
    pub bounds: Aabb,
    /// How it was split; none of a leaf.
    pub split: Option<SplitRecord>,
}

/// A split. Of two numbers for the children the left one's is the first.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitRecord {
    /// Whether there were enough rays a triangle for a cost function (section 5 of Nabata 2013); if not,
    /// the split is in the middle.
    pub by_cost: bool,
    /// Whether no plane between slabs parts the triangles, so that they are halved by number.
    pub halved: bool,
    /// How many candidates there were.
    pub candidates: u32,
    /// Places among the candidates: the one taken, the one of the surface area heuristic (eq. 1), and the one
    /// of eq. 2 with all active rays in place of samples.
    pub chosen: u32,
    /// See `chosen`.
    pub by_area: u32,
    /// See `chosen`.
    pub by_rays: u32,
    /// Of these three what eq. 2 is with all rays: pairs of a ray and a triangle in its children.
    pub costs: [u64; 3],
    /// How many sample rays there were, and how many meet the left child, the right one, enter the left one
    /// first, and the right one; none if none were drawn.
    pub samples: Option<[u32; 5]>,
    /// The surface area of each child over that of the node: what eq. 1 takes for the intersection ratios.
    /// NaN of a node without area.
    pub areas: [f32; 2],
    /// The share of active rays that meet each child, before either is traversed.
    pub ratios: [f32; 2],
    /// Whether the left child is traversed first.
    pub left_first: bool,
    /// The share that meets the child that is second, when the first has been traversed.
    pub second_ratio: f32,
    /// Whether a child gets all rays unfiltered (section 4.4).
    pub skipped: [bool; 2],
    /// Ray/box tests of sample rays, and of the filters of both children.
    pub sample_box: u64,
    /// See `sample_box`.
    pub ray_box: u64,
}

impl SplitRecord {
    /// The estimated intersection ratios; none without samples.
    pub fn estimated(&self) -> Option<[f32; 2]> {
        let [n, left, right, ..] = self.samples?;
        Some([left, right].map(|meet| meet as f32 / n as f32))
    }
}

/// Records in the order in which nodes are come to.
pub(in crate::methods) struct Log {
    pub records: Vec<NodeRecord>,
    /// Places of the nodes above the one that is next.
    open: Vec<usize>,
    /// Its path.
    path: u128,
}

impl Log {
    pub fn new() -> Log {
        Log {
            records: Vec::new(),
            open: Vec::new(),
            path: 1,
        }
    }

    fn split(&mut self) -> Option<&mut SplitRecord> {
        self.records[*self.open.last()?].split.as_mut()
    }

    fn push(&mut self, node: &Node, active: List, split: Option<SplitRecord>) {
        self.records.push(NodeRecord {
            path: self.path,
            depth: node.depth,
            rays: active.len as u32,
            triangles: node.len() as u32,
            bounds: node.bounds,
            split,
        });
    }
}

impl Divide<'_> {
    /// A node is solved by the naive step.
    #[inline]
    pub(super) fn note_leaf(&mut self, node: &Node, active: List) {
        self.store_leaf(node);
        if let Some(log) = &mut self.log {
            log.push(node, active, None);
        }
    }

    /// A node has been split at a candidate, after so many tests of sample rays.
    #[inline]
    pub(super) fn note_split(
        &mut self,
        node: &Node,
        active: List,
        chosen: usize,
        samples: Option<SampleCounts>,
        sample_box: u64,
        [first, second]: [&Child; 2],
    ) {
        if self.log.is_none() && self.stored.is_none() {
            return;
        }
        let skipped = [first, second].map(|child| self.skips(child));
        if let Some(stored) = &mut self.stored {
            let bounds = [first, second].map(|child| child.node.bounds);
            let [a, b] = [0, 1].map(|i| (bounds[i], skipped[i]));
            stored.split(node.bounds, [a, b], false);
        }
        if self.log.is_some() {
            let mut split = self.compare(node, active, chosen);
            split.by_cost = self.splits_by_cost(node, active);
            split.samples = samples.map(|counts| {
                let n = self.samples.len() as u32;
                [
                    n,
                    counts.left,
                    counts.right,
                    counts.left_first,
                    counts.right_first,
                ]
            });
            split.sample_box = sample_box;
            split.left_first = first.node.from == node.from;
            let [a, b] = skipped;
            split.skipped = if split.left_first { [a, b] } else { [b, a] };
            if let Some(log) = &mut self.log {
                log.open.push(log.records.len());
                let left_first = split.left_first;
                log.push(node, active, Some(split));
                log.path = log.path << 1 | u128::from(!left_first);
            }
        }
    }

    /// The first child of a node has been traversed.
    #[inline]
    pub(super) fn note_second(&mut self, second: &Child, active: List) {
        if let Some(stored) = &mut self.stored {
            stored.second();
        }
        if self.log.is_some() {
            let ratio = self.true_ratio(active, &second.node.bounds);
            if let Some(log) = &mut self.log {
                log.path ^= 1;
                if let Some(split) = log.split() {
                    split.second_ratio = ratio;
                }
            }
        }
    }

    /// Both children of a node have been traversed.
    #[inline]
    pub(super) fn note_end(&mut self) {
        if let Some(stored) = &mut self.stored {
            stored.close();
        }
        if let Some(log) = &mut self.log {
            log.open.pop();
            log.path >>= 1;
        }
    }

    /// A list was held against the box of a child, in so many tests.
    #[inline]
    pub(super) fn note_filter(&mut self, active: List, tests: u64) {
        if let Some(stored) = &mut self.stored {
            stored.extra_box += tests - active.len as u64;
        }
        if let Some(split) = self.log.as_mut().and_then(|log| log.split()) {
            split.ray_box += tests;
        }
    }

    /// All candidates by all rays: twice as many ray/box tests as there are candidates and rays.
    #[cold]
    fn compare(&self, node: &Node, active: List, chosen: usize) -> SplitRecord {
        let met = |bounds: &Aabb| self.count(active, bounds, 1).0 as u64;
        let costs: Vec<u64> = (self.candidates.pairs())
            .map(|(pair, left)| {
                let right = node.len() as u64 - left;
                met(&pair.left) * left + met(&pair.right) * right
            })
            .collect();
        // The last of equals, as in the choice by samples.
        let by_rays = (1..costs.len()).fold(0, |a, b| if costs[b] <= costs[a] { b } else { a });
        let by_area = self.least_area_cost(node);
        let (pair, _) = self.candidates.pairs().nth(chosen).expect("a candidate");
        let children = [&pair.left, &pair.right];
        let ratios = children.map(|bounds| self.true_ratio(active, bounds));
        SplitRecord {
            by_cost: false,
            halved: self.candidates.is_halved(chosen),
            candidates: costs.len() as u32,
            chosen: chosen as u32,
            by_area: by_area as u32,
            by_rays: by_rays as u32,
            costs: [chosen, by_area, by_rays].map(|place| costs[place]),
            samples: None,
            areas: children.map(|bounds| bounds.half_area() / node.bounds.half_area()),
            ratios,
            left_first: false,
            second_ratio: f32::NAN,
            skipped: [false; 2],
            sample_box: 0,
            ray_box: 0,
        }
    }

    fn true_ratio(&self, active: List, bounds: &Aabb) -> f32 {
        self.count(active, bounds, 1).0 as f32 / active.len as f32
    }
}
