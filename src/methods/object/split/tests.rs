//! The choice of splits against plain re-implementations, and the depth of the recursion.

use super::*;
use crate::geometry::Aabb;
use crate::kernels::Tmax;
use crate::kernels::{Kernels, Rays};
use crate::methods::Counters;
use crate::methods::Precision;
use crate::methods::object::{Memory, ObjectParameters};
use crate::rays::active::ActiveRays;
use crate::simd::Isa;
use crate::{Batch, Mesh, PADDING, Ray, Triangle};
use glam::Vec3;

fn number(key: u64, i: u64) -> f32 {
    random::unit_f64(random::hash(9, key, i)) as f32 * 2.0 - 1.0
}

fn vector(key: u64, i: u64) -> Vec3 {
    Vec3::new(number(key, i), number(key + 1, i), number(key + 2, i))
}

fn mesh(n: u64) -> Mesh {
    let corner = |i, k| vector(0, i) + 0.1 * vector(k, i);
    Mesh::new(
        (0..n)
            .map(|i| Triangle::new(corner(i, 10), corner(i, 20), corner(i, 30)))
            .collect(),
    )
}

fn batch(n: u64) -> Batch {
    (0..n)
        .map(|i| Ray::new(2.0 * vector(40, i), vector(50, i)))
        .collect()
}

/// Prepares a trace as `Tracer` does, and hands the root to a check.
fn at_root(
    parameters: ObjectParameters,
    mesh: &Mesh,
    batch: &Batch,
    check: impl FnOnce(&mut Divide, Node, List),
) {
    let mut memory = Memory::new(batch.len(), mesh.len());
    let kernels = Kernels::of(Isa::best());
    let (active, scratch) = memory.active.streams();
    let mut prims = vec![crate::MISS; batch.len()];
    let mut rays = Rays {
        active,
        scratch,
        directions: memory.directions.as_mut_ptr(),
        t: memory.t.as_mut_ptr(),
        prim: prims.as_mut_ptr(),
        shared_origin: None,
        special: false,
        least_tmin: 0.0,
        any_hit: false,
        precision: Precision::Fast,
        ahead: true,
        tmax: Tmax::of(batch),
        scene: Aabb::EMPTY,
    };
    // SAFETY: the processor was checked; the memory has room for batch and mesh.
    let (prepared, (items, bounds)) = unsafe {
        (
            (kernels.prepare_rays)(batch, &rays),
            (kernels.prepare_triangles)(mesh, 0, &mut memory.items),
        )
    };
    rays.special = prepared.special;
    let mut divide = Divide {
        kernels,
        parameters: &parameters,
        seed: 0,
        audit: false,
        rays,
        triangles: mesh.triangles(),
        items: &mut memory.items[..items],
        item_scratch: &mut memory.item_scratch[..items],
        candidates: &mut memory.candidates,
        samples: &mut memory.samples,
        capacity: ActiveRays::capacity(batch.len()),
        counters: Counters::default(),
        watch: None,
        log: None,
        stored: None,
    };
    let root = Node {
        bounds: bounds.bounds(),
        from: 0,
        to: items,
        depth: 0,
        key: 1,
    };
    let list = List {
        start: 0,
        len: prepared.valid,
    };
    check(&mut divide, root, list);
}

/// Whether a ray meets a box, in plain words.
fn meets(ray: &Ray, b: &Aabb) -> bool {
    let (mut near, mut far) = (0f32, f32::INFINITY);
    for axis in 0..3 {
        let inverse = 1.0 / ray.direction[axis];
        let t0 = (b.min[axis] - ray.origin[axis]) * inverse;
        let t1 = (b.max[axis] - ray.origin[axis]) * inverse;
        (near, far) = (near.max(t0.min(t1)), far.min(t0.max(t1)));
    }
    near * (1.0 - PADDING) <= far * (1.0 + PADDING)
}

/// The last least of costs.
fn last_least(costs: &[f64]) -> usize {
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    costs.iter().rposition(|&cost| cost == least).unwrap()
}

#[test]
fn the_sampled_cost_is_that_of_equation_2() {
    for (triangles, rays, bins, axes) in [
        (300, 200, 32, Axes::All),
        (500, 1000, 256, Axes::Longest),
        (40, 77, 3, Axes::Centers),
        (60, 1, 32, Axes::All),
    ] {
        let (mesh, batch) = (mesh(triangles), batch(rays));
        let parameters = ObjectParameters {
            // As many strata as rays draw each ray once, so that the ratios are exact.
            samples: rays as u32,
            axes,
            ..ObjectParameters::NABATA2013
        };
        at_root(parameters, &mesh, &batch, |divide, root, list| {
            divide.find_candidates(&root, bins);
            divide.draw(list, root.key);
            let chosen = divide.least_sampled_cost(&root);
            let c = &*divide.candidates;
            assert!(c.len > 1);
            let ratio = |b: &Aabb| batch.iter().filter(|ray| meets(ray, b)).count() as f64;
            let costs: Vec<f64> = (0..c.len)
                .map(|j| {
                    let left = c.cuts[j].1 as f64;
                    let right = triangles as f64 - left;
                    ratio(&c.pairs[j].left) * left + ratio(&c.pairs[j].right) * right
                })
                .collect();
            assert_eq!(chosen, last_least(&costs), "{costs:?}");
            let counted = c.sampled[chosen];
            assert_eq!(counted.left as f64, ratio(&c.pairs[chosen].left));
            assert_eq!(counted.right as f64, ratio(&c.pairs[chosen].right));
        });
    }
}

#[test]
fn the_area_cost_is_that_of_equation_1() {
    for axes in [Axes::Longest, Axes::Centers, Axes::All] {
        let parameters = ObjectParameters {
            axes,
            ..ObjectParameters::AFRA2012
        };
        at_root(parameters, &mesh(400), &batch(10), |divide, root, _| {
            divide.find_candidates(&root, 32);
            let chosen = divide.least_area_cost(&root);
            let c = &*divide.candidates;
            let area = |b: &Aabb| {
                let e = b.max.as_dvec3() - b.min.as_dvec3();
                e.x * e.y + e.y * e.z + e.z * e.x
            };
            let cost = |j: usize| {
                let left = c.cuts[j].1 as f64;
                area(&c.pairs[j].left) * left + area(&c.pairs[j].right) * (400.0 - left)
            };
            let least = (0..c.len).map(cost).fold(f64::INFINITY, f64::min);
            // Costs are rounded to float32.
            approx::assert_relative_eq!(cost(chosen), least, max_relative = 1e-6);
        });
    }
}

#[test]
fn candidates_are_the_boxes_of_what_they_part() {
    for (bins, axes) in [(2, Axes::Longest), (32, Axes::All), (256, Axes::Centers)] {
        let parameters = ObjectParameters {
            axes,
            ..ObjectParameters::AFRA2012
        };
        at_root(parameters, &mesh(200), &batch(1), |divide, root, _| {
            divide.find_candidates(&root, bins);
            for j in 0..divide.candidates.len {
                let (cut, left) = divide.candidates.cuts[j];
                let pair = divide.candidates.pairs[j];
                let Cut::Bins(binning, last_left) = cut else {
                    panic!("the centres are spread");
                };
                let before = divide.items.to_vec();
                // SAFETY: the processor was checked.
                let n = unsafe {
                    (divide.kernels.partition)(
                        divide.items,
                        divide.item_scratch,
                        &binning,
                        last_left,
                    )
                };
                assert_eq!(n, left as usize);
                let around = |items: &[crate::kernels::Item]| {
                    items.iter().fold(Aabb::EMPTY, |b, i| b.union(i.bounds()))
                };
                assert_eq!(around(&divide.items[..n]), pair.left);
                assert_eq!(around(&divide.items[n..]), pair.right);
                // Both sides keep their order, and nothing is lost.
                let prims = |items: &[crate::kernels::Item]| -> Vec<u32> {
                    items.iter().map(|item| item.prim()).collect()
                };
                let (left, right) = (prims(&divide.items[..n]), prims(&divide.items[n..]));
                let of = |side: &[u32]| -> Vec<u32> {
                    let all = prims(&before).into_iter();
                    all.filter(|prim| side.contains(prim)).collect()
                };
                assert_eq!(of(&left), left);
                assert_eq!(of(&right), right);
                assert_eq!(left.len() + right.len(), before.len());
            }
        });
    }
}

/// The depth of the deepest node when all rays go everywhere.
fn depth(divide: &mut Divide, node: &Node, list: List) -> u32 {
    if node.len() <= 1 {
        return node.depth;
    }
    let mut node = *node;
    let Some([a, b]) = divide.split(&mut node, list) else {
        return node.depth;
    };
    assert_eq!(a.node.len() + b.node.len(), node.len());
    assert!(a.node.len() > 0 && b.node.len() > 0);
    depth(divide, &a.node, list).max(depth(divide, &b.node, list))
}

#[test]
fn the_depth_is_limited_however_triangles_are_spaced() {
    // One triangle at each power of two, along three axes one after the other: a split in the
    // middle takes off one at a time.
    let triangles: Vec<Triangle> = (0..480)
        .map(|i| {
            let size = 2f32.powi(60 - (i % 160));
            let center = [Vec3::X, Vec3::Y, Vec3::Z][i as usize / 160] * size;
            let corner = |d: Vec3| center + size / 64.0 * d;
            Triangle::new(corner(Vec3::X), corner(Vec3::Y), corner(Vec3::Z))
        })
        .collect();
    let mesh = Mesh::new(triangles);
    for parameters in [ObjectParameters::AFRA2012, ObjectParameters::NABATA2013] {
        at_root(parameters, &mesh, &batch(1), |divide, root, list| {
            assert!(root.len() > 300);
            let limit = MAX_DEPTH + root.len().next_power_of_two().ilog2();
            let depth = depth(divide, &root, list);
            assert!((MAX_DEPTH..=limit).contains(&depth), "{depth}, {limit}");
        });
    }
    let in_one_box = |i| {
        let c = Vec3::new(i as f32 / 1000.0, 0.5, 0.25);
        Triangle::new(Vec3::ZERO, Vec3::ONE, c)
    };
    let different = Mesh::new((0..1000).map(in_one_box).collect());
    let identical = Mesh::new(vec![mesh.triangles()[0]; 1000]);
    // 1000 triangles in leaves of eight.
    for (mesh, expected) in [(different, 7), (identical, 0)] {
        let parameters = ObjectParameters::AFRA2012;
        at_root(parameters, &mesh, &batch(100), |divide, root, list| {
            assert_eq!(depth(divide, &root, list), expected);
        });
    }
}
