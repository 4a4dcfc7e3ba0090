//! `obvhs`: PLOC builds of binary and of compressed eight-way trees.
//!
//! As in its examples, the triangles stand in the order of the tree, ready to be tested by the
//! library's own test. That test has an inclusive lower end of the interval, where ours is
//! exclusive.

use super::{Build, Numbered, Peer, Tree, bytes_of, timed};
use dacrt::Ray;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use std::time::Duration;

const fn peer(builder: &'static str, build: Build) -> Peer {
    Peer {
        name: "obvhs",
        version: "0.4.0",
        builder,
        build,
    }
}

pub const BVH2_FASTEST: Peer = peer("bvh2 fastest", |triangles| {
    build(
        triangles,
        build_bvh2_from_tris,
        BvhBuildParams::fastest_build(),
    )
});
/// The preset of its examples.
pub const BVH2_MEDIUM: Peer = peer("bvh2 medium", |triangles| {
    build(
        triangles,
        build_bvh2_from_tris,
        BvhBuildParams::medium_build(),
    )
});
pub const BVH2_VERY_SLOW: Peer = peer("bvh2 very slow", |triangles| {
    let params = BvhBuildParams::very_slow_build();
    build(triangles, build_bvh2_from_tris, params)
});
pub const CWBVH_FASTEST: Peer = peer("cwbvh fastest", |triangles| {
    let params = BvhBuildParams::fastest_build();
    build(triangles, build_cwbvh_from_tris, params)
});
/// The preset of its examples.
pub const CWBVH_MEDIUM: Peer = peer("cwbvh medium", |triangles| {
    build(
        triangles,
        build_cwbvh_from_tris,
        BvhBuildParams::medium_build(),
    )
});
pub const CWBVH_VERY_SLOW: Peer = peer("cwbvh very slow", |triangles| {
    let params = BvhBuildParams::very_slow_build();
    build(triangles, build_cwbvh_from_tris, params)
});

type Builder<B> = fn(&[Triangle], BvhBuildParams, &mut Duration) -> B;

fn build<B: Layout + 'static>(
    triangles: &[Numbered],
    builder: Builder<B>,
    params: BvhBuildParams,
) -> (Box<dyn Tree>, f64) {
    let corner = |p: glam::Vec3| p.to_array().into();
    let theirs = |(_, t): &Numbered| Triangle {
        v0: corner(t.a),
        v1: corner(t.b),
        v2: corner(t.c),
    };
    let theirs: Vec<Triangle> = triangles.iter().map(theirs).collect();
    timed(|| {
        let tree = builder(&theirs, params, &mut Duration::default());
        let order = tree.order().iter().map(|&i| i as usize);
        Ordered {
            triangles: order.clone().map(|i| (&theirs[i]).into()).collect(),
            prims: order.map(|i| triangles[i].0).collect(),
            tree,
        }
    })
}

/// A tree, and the triangles in its order.
struct Ordered<B> {
    tree: B,
    triangles: Vec<RtTriangle>,
    /// Their numbers in the mesh.
    prims: Vec<u32>,
}

impl<B: Layout> Tree for Ordered<B> {
    fn first(&self, ray: &Ray) -> Option<(f32, u32)> {
        let hit = self.tree.first(theirs(ray), &self.triangles)?;
        Some((hit.t, self.prims[hit.primitive_id as usize]))
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.tree.occluded(theirs(ray), &self.triangles)
    }

    fn bytes(&self) -> Option<usize> {
        let order = bytes_of(self.tree.order());
        let triangles = bytes_of(&self.triangles) + bytes_of(&self.prims);
        Some(self.tree.node_bytes() + order + triangles)
    }
}

fn theirs(ray: &Ray) -> obvhs::ray::Ray {
    let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
    obvhs::ray::Ray::new(origin.into(), direction.into(), ray.tmin, ray.tmax)
}

/// What its two trees have in common.
trait Layout {
    /// The number of each triangle in the order of the tree.
    fn order(&self) -> &[u32];
    fn node_bytes(&self) -> usize;
    fn first(&self, ray: obvhs::ray::Ray, triangles: &[RtTriangle]) -> Option<RayHit>;
    fn occluded(&self, ray: obvhs::ray::Ray, triangles: &[RtTriangle]) -> bool;
}

/// Both trees have these by the same names, but no trait.
macro_rules! layout {
    ($tree:ty) => {
        impl Layout for $tree {
            fn order(&self) -> &[u32] {
                &self.primitive_indices
            }

            fn node_bytes(&self) -> usize {
                bytes_of(&self.nodes)
            }

            fn first(&self, ray: obvhs::ray::Ray, triangles: &[RtTriangle]) -> Option<RayHit> {
                let mut hit = RayHit::none();
                self.ray_traverse(ray, &mut hit, |ray, i| triangles[i].intersect(ray))
                    .then_some(hit)
            }

            fn occluded(&self, ray: obvhs::ray::Ray, triangles: &[RtTriangle]) -> bool {
                !self.ray_traverse_miss(ray, |ray, i| triangles[i].intersect(ray))
            }
        }
    };
}

layout!(Bvh2);
layout!(CwBvh);
