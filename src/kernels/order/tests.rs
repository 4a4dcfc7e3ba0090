//! The order of rays.

use super::*;
use crate::kernels::Kernels;
use crate::random::{hash, unit_f64};
use crate::rays::Ray;
use crate::simd::Isa;
use glam::Vec3;

fn ordered(
    isa: Isa,
    batch: &Batch,
    range: Range<usize>,
    shared: bool,
) -> (Vec<SortedRay>, Vec<u32>) {
    let scene = Aabb {
        min: Vec3::ZERO,
        max: Vec3::ONE,
    };
    let mut records = vec![[[0.0; 4]; 2]; range.len()];
    let mut places = vec![u32::MAX; range.len()];
    let to = Window {
        records: records.as_mut_ptr(),
        places: places.as_mut_ptr(),
    };
    let kernels = Kernels::of(isa);
    let mid = range.start + range.len() / 3;
    let parts = [range.start..mid, mid..range.end];
    let mut keys = parts.clone().map(|part| vec![0; part.len()]);
    let mut counts = vec![1; 2 * BUCKETS];
    let each = counts.chunks_mut(BUCKETS);
    for ((part, keys), counts) in parts.iter().zip(&mut keys).zip(each) {
        // SAFETY: the processor was checked.
        unsafe { (kernels.count_keys)(batch, part.clone(), shared, &scene, keys, counts) }
    }
    place_keys(&mut counts);
    // The parts in any order.
    let each = counts.chunks_mut(BUCKETS);
    for ((part, keys), next) in parts.into_iter().zip(&keys).zip(each).rev() {
        // SAFETY: as above; there is room for the window.
        unsafe { (kernels.put_in_order)(batch, part, keys, next, to) }
    }
    (records, places)
}

#[test]
fn each_ray_is_there_once_by_octant_and_cell() {
    let value = |i: u64, j: u64| unit_f64(hash(1, i, j)) as f32;
    let batch: Batch = (0..777)
        .map(|i| {
            let origin = Vec3::new(value(i, 0), value(i, 1), value(i, 2)) * 1.2 - 0.1;
            let direction = Vec3::new(value(i, 3), value(i, 4), value(i, 5)) - 0.5;
            match i % 50 {
                0 => Ray::new(Vec3::NAN, direction),
                1 => Ray::new(origin, Vec3::new(f32::NAN, 0.0, f32::INFINITY)),
                _ => Ray::new(origin, direction),
            }
        })
        .collect();
    for (range, shared) in [
        (0..777, false),
        (100..131, false),
        (3..700, true),
        (5..5, false),
    ] {
        let mut first = None;
        for isa in Isa::available() {
            let (records, places) = ordered(isa, &batch, range.clone(), shared);
            let mut sorted = places.clone();
            sorted.sort_unstable();
            assert!(
                sorted.iter().map(|&p| p as usize).eq(range.clone()),
                "{isa}"
            );
            let mut octants = Vec::new();
            for (record, &place) in records.iter().zip(&places) {
                let ray = batch.ray(place as usize);
                let [[x, y, z, tmin], [dx, dy, dz, tmax]] = record.map(|row| row.map(f32::to_bits));
                let bits = |v: Vec3| v.to_array().map(f32::to_bits);
                assert_eq!(
                    ([x, y, z], [dx, dy, dz]),
                    (bits(ray.origin), bits(ray.direction))
                );
                assert_eq!((tmin, tmax), (ray.tmin.to_bits(), ray.tmax.to_bits()));
                octants.push(ray.direction.cmplt(Vec3::ZERO).bitmask());
            }
            assert!(octants.is_sorted(), "{isa}");
            assert_eq!(places, *first.get_or_insert(places.clone()), "{isa}");
        }
    }
}
