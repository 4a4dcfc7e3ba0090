//! Groups against the rays in them.

use super::*;
use crate::geometry::Aabb;
use crate::kernels::{BlockStreams, Keep, Kernels, List, Source, Tmax};
use crate::methods::Precision;
use crate::random::{hash, unit_f64};
use crate::rays::active::ActiveRays;
use crate::rays::{Batch, Ray};
use crate::simd::{Isa, MAX_LANES};

const RAYS: usize = 1000;

/// A number from −1 to 1.
fn unit(seed: u64, i: u64, j: u64) -> f32 {
    (2.0 * unit_f64(hash(seed, i, j)) - 1.0) as f32
}

/// Rays of which neighbours are alike, some with axes of no direction, some invalid.
fn batch(seed: u64, shared: bool, special: bool) -> Batch {
    let ray = |i: u64| {
        let at = |j: u64| Vec3::from([0, 1, 2].map(|axis| unit(seed, i / 90, 10 * j + axis)));
        let near = |j: u64| Vec3::from([0, 1, 2].map(|axis| unit(seed, i, 10 * j + axis)));
        let origin = if shared {
            Vec3::splat(0.1)
        } else {
            at(1) + 0.1 * near(2)
        };
        let mut direction = at(3) + 0.2 * near(4);
        if special && hash(seed, i, 5).is_multiple_of(5) {
            direction[(hash(seed, i, 6) % 3) as usize] = 0.0;
        }
        let mut ray = Ray::new(origin, direction);
        ray.tmax = 4.0 + near(7).x;
        if hash(seed, i, 8).is_multiple_of(40) {
            ray.tmax = f32::NAN;
        }
        ray
    };
    (0..RAYS as u64).map(ray).collect()
}

/// A block of rays and its groups.
struct Loaded {
    active: ActiveRays,
    directions: Vec<[f32; 4]>,
    floats: Vec<f32>,
    ids: Vec<u32>,
    len: usize,
    rays: Rays,
    groups: Groups,
}

impl Loaded {
    fn new(kernels: &Kernels, batch: &Batch, shared: bool) -> Loaded {
        let room = RAYS.next_multiple_of(GROUP) + MAX_LANES;
        let mut active = ActiveRays::new(2 * room);
        let mut directions = vec![[0.0; 4]; room];
        let (mut floats, mut ids) = (vec![0f32; 32 * room], vec![0; 2 * room]);
        let (streams, scratch) = active.streams();
        // SAFETY: there are 32 streams of `room` floats.
        let stream = |i: usize| unsafe { floats.as_ptr().cast_mut().add(i * room) };
        let three = |i: usize| [stream(i), stream(i + 1), stream(i + 2)];
        let mut rays = Rays {
            active: streams,
            scratch,
            directions: directions.as_mut_ptr(),
            t: stream(0),
            prim: ids.as_mut_ptr(),
            shared_origin: shared.then(|| batch.ray(0).origin),
            special: false,
            least_tmin: 0.0,
            any_hit: false,
            precision: Precision::Fast,
            tmax: Tmax {
                one: None,
                each: stream(1),
            },
            ahead: false,
            scene: Aabb::EMPTY,
        };
        let ordered = Ordered {
            direction: three(2),
            tmin: stream(5),
        };
        let block = BlockStreams {
            ordered,
            tmax: stream(1),
            // SAFETY: the second half.
            places: unsafe { ids.as_mut_ptr().add(room) },
        };
        let groups = Groups {
            origin_lo: three(6),
            origin_hi: three(9),
            inverse_lo: three(12),
            inverse_hi: three(15),
            far: stream(18),
        };
        floats[18 * room..].fill(0.0);
        // SAFETY: the processor was checked; there is room.
        let len = unsafe {
            let prepared = (kernels.load_block)(&Source::Batch(batch), 0..RAYS, &rays, &block);
            rays.special = prepared.special;
            rays.least_tmin = prepared.least_tmin;
            (kernels.bound_groups)(&rays, &groups, prepared.valid);
            prepared.valid
        };
        Loaded {
            active,
            directions,
            floats,
            ids,
            len,
            rays,
            groups,
        }
    }

    /// All groups.
    fn entries(&self) -> Vec<Entry> {
        let groups = self.len.div_ceil(GROUP);
        (0..groups.div_ceil(ENTRY))
            .map(|at| Entry {
                at: at as u32,
                mask: u32::MAX >> (32 - (groups - at * ENTRY).min(ENTRY)),
            })
            .collect()
    }
}

fn numbers(entries: &[Entry]) -> Vec<usize> {
    let of = |entry: &Entry| {
        let Entry { at, mask } = *entry;
        (0..ENTRY)
            .filter(move |bit| mask >> bit & 1 == 1)
            .map(move |bit| ENTRY * at as usize + bit)
    };
    entries.iter().flat_map(of).collect()
}

fn boxes(seed: u64) -> Vec<Aabb> {
    (0..40)
        .map(|i| {
            let corner = |j: u64| Vec3::from([0, 1, 2].map(|axis| unit(seed, i, 100 * j + axis)));
            let size = [0.0, 0.01, 0.3, 2.0][i as usize % 4];
            Aabb {
                min: 1.5 * corner(1),
                max: 1.5 * corner(1) + size * corner(2).abs(),
            }
        })
        .collect()
}

#[test]
fn no_ray_that_meets_a_box_is_in_a_group_that_does_not() {
    let mut culled = 0;
    for seed in 0..6 {
        for (shared, special) in [(false, false), (false, true), (true, false), (true, true)] {
            let batch = batch(seed, shared, special);
            let mut first = None;
            for isa in Isa::available() {
                let kernels = Kernels::of(isa);
                let loaded = Loaded::new(kernels, &batch, shared);
                let entries = loaded.entries();
                let mut found = Vec::new();
                for bounds in boxes(seed) {
                    let mut lists = [vec![Entry::ZERO; 9], vec![Entry::ZERO; 9]];
                    let mut rays = vec![Entry::ZERO; RAYS / ENTRY + 9];
                    // SAFETY: the processor was checked; there is room.
                    let (lens, (n, count)) = unsafe {
                        let to = lists.each_mut().map(|list| list.as_mut_ptr());
                        let (rays_of, groups_of) = (&loaded.rays, &loaded.groups);
                        let two = [&bounds, &bounds];
                        (
                            (kernels.filter_groups)(rays_of, groups_of, &entries, two, to),
                            (kernels.rays_of_groups)(rays_of, &entries, &bounds, rays.as_mut_ptr()),
                        )
                    };
                    let groups = numbers(&lists[0][..lens[0]]);
                    assert_eq!(groups, numbers(&lists[1][..lens[1]]));
                    let rays = numbers(&rays[..n]);
                    assert_eq!(rays.len(), count);
                    assert!(
                        rays.iter().all(|ray| groups.contains(&(ray / GROUP))),
                        "{isa}"
                    );
                    assert_eq!(rays, kept(kernels, &loaded, &bounds), "{isa}");
                    culled += loaded.len.div_ceil(GROUP) - groups.len();
                    found.push((groups, rays));
                }
                assert_eq!(found, *first.get_or_insert(found.clone()), "{isa}");
            }
        }
    }
    assert!(culled > 1000, "{culled}");
}

/// The rays that filtering keeps.
fn kept(kernels: &Kernels, loaded: &Loaded, bounds: &Aabb) -> Vec<usize> {
    let place = loaded.len.next_multiple_of(GROUP);
    let all = loaded.entries();
    let mut rays = Vec::new();
    for group in numbers(&all) {
        for at in GROUP / ENTRY * group..GROUP / ENTRY * (group + 1) {
            let left = loaded.len.saturating_sub(ENTRY * at).min(ENTRY);
            if left > 0 {
                rays.push(Entry {
                    at: at as u32,
                    mask: u32::MAX >> (32 - left),
                });
            }
        }
    }
    // SAFETY: the processor was checked; there is room for twice as many records.
    let ids = unsafe {
        let len = (kernels.flush_groups)(&loaded.rays, &rays, place);
        assert_eq!(len, loaded.len);
        let list = List { start: place, len };
        let to = (place + len).next_multiple_of(MAX_LANES);
        let n = (kernels.filter)(&loaded.rays, list, bounds, Keep::Copy(to));
        std::slice::from_raw_parts(loaded.rays.active.id.add(to), n)
    };
    let _memory = (
        &loaded.active,
        &loaded.directions,
        &loaded.floats,
        &loaded.ids,
    );
    ids.iter().map(|&id| id as usize).collect()
}

#[test]
fn a_group_is_as_far_as_its_furthest_ray() {
    let batch = batch(3, false, false);
    for isa in Isa::available() {
        let kernels = Kernels::of(isa);
        let loaded = Loaded::new(kernels, &batch, false);
        // SAFETY: rays and groups of the block.
        unsafe {
            for i in 0..loaded.len {
                *loaded.rays.t.add(i) = (i * 7 % 101) as f32;
            }
            (kernels.refresh_groups)(&loaded.rays, &loaded.groups, &loaded.entries());
            for group in 0..loaded.len.div_ceil(GROUP) {
                let rays = group * GROUP..((group + 1) * GROUP).min(loaded.len);
                let furthest = rays.map(|i| (i * 7 % 101) as f32).fold(-1.0, f32::max);
                assert_eq!(*loaded.groups.far.add(group), furthest, "{isa}");
            }
        }
    }
}
