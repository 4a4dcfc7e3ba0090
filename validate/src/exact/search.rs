//! Boxes over triangles, to leave out those that a ray cannot hit.
//!
//! A triangle that a ray hits lies with its hit point in every box around it. For each axis with
//! d ≠ 0 the exact t is then within the slab interval (lo − o) / d … (hi − o) / d, and for d = 0 the
//! origin is within lo … hi. Float64 rounds the difference of two float32 and the division by at
//! most 2⁻⁵³ each, and nothing overflows or underflows: distances are between 1e-45 / 3.4e38 and
//! 6.8e38 / 1e-45. The interval is widened by far more: by what the kernel of record may round and
//! by which it pads its own boxes; before that the box is enlarged by what the watertight kernel may
//! move corners ([`crate::watertight`]). So what is left out is hit neither in exact arithmetic nor
//! by our kernels, which count a hit only within the padded interval of the triangle's box
//! ([`crate::bounds`]), and whose intervals are the greater the greater the box.

use crate::bounds::{BOX_PADDING, SLAB_ROUNDINGS, TINY};
use crate::watertight::ENLARGED;
use dacrt::{Aabb, Ray, Triangle};

/// Most triangles in a leaf.
const LEAF: usize = 4;
/// How far intervals are widened, relatively: (1 + p)(1 + q) < 1 + 2 (p + q).
const WIDER: f64 = 2.0 * (BOX_PADDING + SLAB_ROUNDINGS);

/// A tree of boxes, halved by number at each node, so its depth is the logarithm of it.
pub(super) struct Tree {
    /// The left child of an inner node stands behind it.
    nodes: Vec<Node>,
    prims: Vec<u32>,
}

struct Node {
    bounds: Aabb,
    content: Content,
}

enum Content {
    /// Place of the right child.
    Right(u32),
    /// First and behind the last in `prims`.
    Leaf(u32, u32),
}

impl Tree {
    /// The tree over valid triangles, given by their numbers.
    pub(super) fn new(triangles: &[Triangle], mut prims: Vec<u32>) -> Tree {
        let mut nodes = Vec::with_capacity(prims.len());
        if !prims.is_empty() {
            build(triangles, &mut prims, 0, &mut nodes);
        }
        Tree { nodes, prims }
    }

    /// Calls `visit` with every triangle that the ray may hit, except those that it can only hit
    /// beyond a distance that `visit` has returned.
    pub(super) fn visit(&self, ray: &Ray, mut visit: impl FnMut(u32) -> f64) {
        let slabs = Slabs::new(ray);
        let mut limit = f64::INFINITY;
        let mut stack = Vec::with_capacity(64);
        stack.extend(self.entry(0, &slabs));
        while let Some((near, place)) = stack.pop() {
            if near > limit {
                continue;
            }
            match self.nodes[place].content {
                Content::Leaf(first, end) => {
                    for &prim in &self.prims[first as usize..end as usize] {
                        limit = limit.min(visit(prim));
                    }
                }
                Content::Right(right) => {
                    let children = [place + 1, right as usize].map(|c| self.entry(c, &slabs));
                    match children {
                        // The nearer on top.
                        [Some(left), Some(right)] if left.0 <= right.0 => {
                            stack.extend([right, left]);
                        }
                        _ => stack.extend(children.into_iter().flatten()),
                    }
                }
            }
        }
    }

    /// Where the ray enters the node, if it may, with the node's place.
    fn entry(&self, place: usize, slabs: &Slabs) -> Option<(f64, usize)> {
        let near = slabs.near(&self.nodes.get(place)?.bounds)?;
        Some((near, place))
    }
}

fn build(triangles: &[Triangle], prims: &mut [u32], first: u32, nodes: &mut Vec<Node>) -> Aabb {
    let place = nodes.len();
    nodes.push(Node {
        bounds: Aabb::EMPTY,
        content: Content::Leaf(first, first + prims.len() as u32),
    });
    let of = |&prim: &u32| triangles[prim as usize].bounds();
    let bounds = if prims.len() <= LEAF {
        prims.iter().fold(Aabb::EMPTY, |b, prim| b.union(of(prim)))
    } else {
        let twice_centre = |prim: &u32| of(prim).min + of(prim).max;
        let (low, high) = prims.iter().map(twice_centre).fold(
            (glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY),
            |(low, high), x| (low.min(x), high.max(x)),
        );
        let axis = (high - low).max_position();
        let half = prims.len() / 2;
        prims.select_nth_unstable_by(half, |a, b| {
            twice_centre(a)[axis].total_cmp(&twice_centre(b)[axis])
        });
        let (left, right) = prims.split_at_mut(half);
        let left = build(triangles, left, first, nodes);
        nodes[place].content = Content::Right(nodes.len() as u32);
        left.union(build(triangles, right, first + half as u32, nodes))
    };
    nodes[place].bounds = bounds;
    bounds
}

/// A valid ray, ready to be held against boxes.
struct Slabs {
    axes: [Axis; 3],
    tmin: f64,
    tmax: f64,
}

struct Axis {
    origin: f64,
    direction: f64,
    /// Whether the kernel of record takes the ray for parallel to the slab.
    parallel: bool,
}

impl Slabs {
    fn new(ray: &Ray) -> Slabs {
        Slabs {
            axes: std::array::from_fn(|i| Axis {
                origin: ray.origin[i].into(),
                direction: ray.direction[i].into(),
                parallel: !(1.0 / ray.direction[i]).is_finite(),
            }),
            tmin: ray.tmin.into(),
            tmax: ray.tmax.into(),
        }
    }

    /// Where the ray enters the box at the earliest, widened as said above; none if it passes by.
    fn near(&self, bounds: &Aabb) -> Option<f64> {
        let ends: [[f64; 2]; 3] = std::array::from_fn(|i| {
            [bounds.min[i], bounds.max[i]].map(|x| f64::from(x) - self.axes[i].origin)
        });
        let largest = ends.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        let shift = ENLARGED * largest;
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for (axis, [lo, hi]) in self.axes.iter().zip(ends) {
            let (lo, hi) = (lo - shift, hi + shift);
            if axis.parallel && lo <= 0.0 && 0.0 <= hi {
                continue;
            }
            if axis.direction == 0.0 {
                return None;
            }
            let ends = [lo, hi].map(|x| x / axis.direction);
            near = near.max(ends[0].min(ends[1]));
            far = far.min(ends[0].max(ends[1]));
        }
        let near = near * (1.0 - WIDER) - TINY;
        let far = far * (1.0 + WIDER) + TINY;
        (near <= far && near <= self.tmax && far >= self.tmin).then_some(near)
    }
}
