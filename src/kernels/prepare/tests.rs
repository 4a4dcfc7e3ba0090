//! The pass over the rays on every instruction set.

use super::*;
use crate::geometry::{Aabb, Triangle};
use crate::kernels::Kernels;
use crate::kernels::Tmax;
use crate::rays::active::ActiveRays;
use crate::simd::{Isa, MAX_LANES};
use crate::{Ray, random};

/// Rays of which about a third are invalid, and the last one if `last` is.
fn batch(n: usize, last: bool) -> Batch {
    (0..n)
        .map(|i| {
            let mut ray = Ray::new(Vec3::new(i as f32, 1.0, 2.0), Vec3::new(1.0, 0.0, -3.0));
            ray.tmin = 0.5 + i as f32;
            if (last && i + 1 == n) || random::hash(1, 0, i as u64).is_multiple_of(3) {
                ray.tmin = -1.0;
            }
            ray
        })
        .collect()
}

/// Runs the pass and hands the streams, t and directions to a check.
fn prepared(isa: Isa, batch: &Batch, check: impl FnOnce(&Rays, PreparedRays, &[f32], &[[f32; 4]])) {
    let n = batch.len();
    let mut memory = ActiveRays::new(n);
    let (active, scratch) = memory.streams();
    let mut directions = vec![[0.0; 4]; n];
    let mut t = vec![0.0; n];
    let rays = Rays {
        active,
        scratch,
        directions: directions.as_mut_ptr(),
        t: t.as_mut_ptr(),
        prim: std::ptr::null_mut(),
        shared_origin: None,
        special: false,
        least_tmin: 0.0,
        any_hit: true,
        precision: Precision::Fast,
        ahead: true,
        tmax: Tmax::of(batch),
        scene: Aabb::EMPTY,
    };
    // SAFETY: the processor was checked; there is room for the batch.
    let found = unsafe { (Kernels::of(isa).prepare_rays)(batch, &rays) };
    check(&rays, found, &t, &directions);
}

#[test]
fn the_root_list_has_all_valid_rays_in_order() {
    for isa in Isa::available() {
        for n in 0..70 {
            let batch = batch(n, n % 2 == 0);
            let valid: Vec<usize> = (0..n).filter(|&i| batch.ray(i).is_valid()).collect();
            prepared(isa, &batch, |rays, found, t, directions| {
                assert_eq!(found.valid, valid.len());
                assert_eq!(found.special, !valid.is_empty(), "all have d.y = 0");
                let least = valid.first().map_or(f32::INFINITY, |&i| 0.5 + i as f32);
                assert_eq!(found.least_tmin, least);
                for (place, &i) in valid.iter().enumerate() {
                    let (ray, s) = (batch.ray(i), &rays.active);
                    // SAFETY: the list has so many rays.
                    unsafe {
                        assert_eq!(*s.id.add(place) as usize, i);
                        for axis in 0..3 {
                            assert_eq!(*s.origin[axis].add(place), ray.origin[axis]);
                        }
                        assert_eq!(*s.inverse[0].add(place), 1.0);
                        assert!((*s.inverse[1].add(place)).is_nan());
                        assert_eq!(*s.inverse[2].add(place), 1.0 / -3.0);
                    }
                    assert_eq!(t[i], ray.tmax);
                    assert_eq!(directions[i][..3], ray.direction.to_array());
                    assert_eq!(directions[i][3], ray.tmin);
                }
            });
        }
    }
}

#[test]
fn ids_behind_the_root_list_are_rays_of_the_batch() {
    // The naive step reads the directions of whole vectors of ids, so the last vector of a list
    // must not name rays that there are not.
    for isa in Isa::available() {
        for n in 1..70 {
            for last in [false, true] {
                prepared(isa, &batch(n, last), |rays, found, _, _| {
                    for place in 0..found.valid + MAX_LANES {
                        // SAFETY: the streams have room for a whole vector behind the list.
                        let id = unsafe { *rays.active.id.add(place) } as usize;
                        assert!(id < n, "{isa}: ray {id} of {n} at {place}");
                    }
                });
            }
        }
    }
}

#[test]
fn the_shared_origin_is_that_of_the_batch() {
    let differing = |n: usize, odd: usize, valid: bool| -> Batch {
        (0..n)
            .map(|i| {
                let mut ray = Ray::new(Vec3::new(0.0, 1.0, 2.0), Vec3::X);
                if i == odd {
                    ray.origin.x = -0.0;
                    ray.tmax = if valid { 1.0 } else { f32::NAN };
                }
                ray
            })
            .collect()
    };
    for isa in Isa::available() {
        for n in 0..40 {
            for odd in 0..=n {
                for valid in [false, true] {
                    let batch = differing(n, odd, valid);
                    // SAFETY: the processor was checked.
                    let found = unsafe { (Kernels::of(isa).shared_origin)(&batch) };
                    let bits = |o: Option<Vec3>| o.map(|o| o.to_array().map(f32::to_bits));
                    assert_eq!(bits(found), bits(batch.shared_origin()), "{isa} {n} {odd}");
                }
            }
        }
    }
}

#[test]
fn degenerate_and_invalid_triangles_get_no_item() {
    let (a, b, c) = (Vec3::X, Vec3::Y, Vec3::Z);
    let mesh = Mesh::new(vec![
        Triangle::new(a, b, c),
        Triangle::new(a, b, b),
        Triangle::new(a, 2.0 * a, 3.0 * a),
        Triangle::new(a, b, Vec3::NAN),
        Triangle::new(c, b, 2.0 * a),
    ]);
    for isa in Isa::available() {
        let mut items = vec![Item::ZERO; 5];
        // SAFETY: the processor was checked.
        let (n, bounds) = unsafe { (Kernels::of(isa).prepare_triangles)(&mesh, 0, &mut items) };
        let prims: Vec<u32> = items[..n].iter().map(Item::prim).collect();
        assert_eq!(prims, [0, 4]);
        assert_eq!(bounds.bounds().max, Vec3::new(2.0, 1.0, 1.0));
        assert_eq!(items[0].bounds(), mesh.triangles()[0].bounds());
    }
}
