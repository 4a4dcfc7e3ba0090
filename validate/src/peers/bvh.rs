//! `bvh` (svenstaro): a binary tree by the surface area heuristic, traversed by iterators.
//!
//! The library has one builder on one thread. Its iterator asks a query whether to enter a box:
//! ours also asks whether the box begins before the nearest hit so far. Its triangle test drops
//! back faces, so the test of Möller and Trumbore without that is here, as a user would write it.

use super::{Numbered, Peer, Tree, bytes_of, timed};
use bvh::aabb::{Aabb, Bounded, IntersectsAabb};
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::Bvh;
use dacrt::{Ray, Triangle};
use std::cell::Cell;

pub const BVH: Peer = Peer {
    name: "bvh",
    version: "0.13.0",
    builder: "sah",
    build: |triangles| {
        let shape = |&(prim, triangle): &Numbered| Shape {
            triangle,
            prim,
            node: 0,
        };
        let mut shapes: Vec<Shape> = triangles.iter().map(shape).collect();
        timed(|| Built {
            tree: Bvh::build(&mut shapes),
            shapes,
        })
    },
};

struct Shape {
    triangle: Triangle,
    prim: u32,
    node: usize,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        let Triangle { a, b, c } = self.triangle;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        Aabb::with_bounds(low.to_array().into(), high.to_array().into())
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

struct Built {
    tree: Bvh<f32, 3>,
    shapes: Vec<Shape>,
}

impl Tree for Built {
    fn first(&self, ray: &Ray) -> Option<(f32, u32)> {
        let query = Query::new(ray);
        let mut nearest = None;
        for shape in self.tree.traverse_iterator(&query, &self.shapes) {
            let Some(t) = intersect(ray, &shape.triangle) else {
                continue;
            };
            if t < query.far.get() || (nearest.is_none() && t <= query.far.get()) {
                query.far.set(t);
                nearest = Some((t, shape.prim));
            }
        }
        nearest
    }

    fn occluded(&self, ray: &Ray) -> bool {
        let query = Query::new(ray);
        (self.tree.traverse_iterator(&query, &self.shapes))
            .any(|shape| intersect(ray, &shape.triangle).is_some_and(|t| t <= ray.tmax))
    }

    fn bytes(&self) -> Option<usize> {
        Some(bytes_of(&self.tree.nodes) + bytes_of(&self.shapes))
    }
}

/// A ray that ends at the nearest hit so far.
struct Query {
    ray: bvh::ray::Ray<f32, 3>,
    far: Cell<f32>,
}

impl Query {
    fn new(ray: &Ray) -> Query {
        let direction = ray.direction.to_array();
        Query {
            // Not by `new`, which would normalise the direction, and t with it.
            ray: bvh::ray::Ray {
                origin: ray.origin.to_array().into(),
                direction: direction.into(),
                inv_direction: direction.map(|x| 1.0 / x).into(),
            },
            far: Cell::new(ray.tmax),
        }
    }
}

impl IntersectsAabb<f32, 3> for Query {
    fn intersects_aabb(&self, aabb: &Aabb<f32, 3>) -> bool {
        let interval = self.ray.intersection_slice_for_aabb(aabb);
        interval.is_some_and(|(near, _)| near <= self.far.get())
    }
}

/// Distance beyond `tmin` at which the line of a ray hits, by Möller and Trumbore, from both sides.
fn intersect(ray: &Ray, triangle: &Triangle) -> Option<f32> {
    let (e1, e2) = (triangle.b - triangle.a, triangle.c - triangle.a);
    let p = ray.direction.cross(e2);
    let inverse = 1.0 / e1.dot(p);
    let to_origin = ray.origin - triangle.a;
    let u = to_origin.dot(p) * inverse;
    // A triangle without area has an infinite or undefined `inverse`: u, v or t is undefined then,
    // or u + v infinite.
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = to_origin.cross(e1);
    let v = ray.direction.dot(q) * inverse;
    if !(v >= 0.0 && u + v <= 1.0) {
        return None;
    }
    let t = e2.dot(q) * inverse;
    (t > ray.tmin).then_some(t)
}
