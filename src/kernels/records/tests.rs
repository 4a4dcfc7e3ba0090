//! Records and index lists against plain code, ray by ray; and when a ray may be taken out.

use super::*;
use crate::geometry::{Mesh, Triangle};
use crate::kernels::Kernels;
use crate::kernels::lists::{Listed, TriangleLists};
use crate::kernels::slab::{PADDING, UNDERFLOW};
use crate::random::{below, hash, unit_f64};
use crate::rays::Ray;
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Portable, splat3};
use proptest::prelude::*;

/// Memory of the records of a batch.
struct Memory {
    slabs: Vec<[f32; 4]>,
    directions: Vec<[f32; 4]>,
    ids: Vec<u32>,
}

/// What stands in memory that nothing should be written to.
const UNTOUCHED: [f32; 4] = [-77.0; 4];

impl Memory {
    fn new(rays: usize) -> Memory {
        Memory {
            slabs: vec![UNTOUCHED; 2 * rays + 1],
            directions: vec![UNTOUCHED; rays + 1],
            ids: vec![0; rays + RAYS_AHEAD],
        }
    }

    fn prepared(isa: Isa, batch: &Batch, any_hit: bool) -> (Memory, RayRecords, PreparedRecords) {
        let mut memory = Memory::new(batch.len());
        let mut rays = RayRecords {
            slabs: memory.slabs.as_mut_ptr(),
            directions: memory.directions.as_mut_ptr(),
            tmin: batch.tmin.as_ptr(),
            ids: memory.ids.as_mut_ptr(),
            shared_origin: batch.shared_origin(),
            special: false,
            least_tmin: 0.0,
            one_tmin: false,
            any_hit,
            precision: Precision::Fast,
            tmax: Tmax::of(batch),
            scene: Aabb::EMPTY,
        };
        // SAFETY: the processor was checked; there is room for the batch.
        let found = unsafe { (Kernels::of(isa).prepare_records)(batch, &rays) };
        (rays.special, rays.least_tmin, rays.one_tmin) =
            (found.special, found.least_tmin, found.one_tmin);
        (memory, rays, found)
    }
}

/// 1/d as records have it.
fn inverse(d: f32) -> f32 {
    let inverse = 1.0 / d;
    if inverse.is_finite() {
        inverse
    } else {
        f32::NAN
    }
}

/// What rays of a batch are like.
#[derive(Clone, Copy, Debug)]
struct Kind {
    shared: bool,
    special: bool,
    one_tmin: bool,
}

const KINDS: [Kind; 8] = {
    let mut kinds = [Kind {
        shared: true,
        special: true,
        one_tmin: true,
    }; 8];
    let mut i = 0;
    while i < 8 {
        kinds[i] = Kind {
            shared: i & 1 == 0,
            special: i & 2 == 0,
            one_tmin: i & 4 == 0,
        };
        i += 1;
    }
    kinds
};

/// Rays of which about a quarter is invalid.
fn batch(seed: u64, n: usize, kind: Kind) -> Batch {
    (0..n as u64)
        .map(|i| {
            let number = |k: u64| 4.0 * unit_f64(hash(seed, i, k)) as f32 - 2.0;
            let choice = |k: u64, of: u32| below(hash(seed, i, k), of);
            let mut origin = Vec3::new(0.25, -0.5, 0.0);
            let mut direction = Vec3::new(number(0), number(1), number(2));
            if !kind.shared {
                origin = Vec3::new(number(3), number(4), choice(5, 3) as f32 - 1.0);
            }
            if kind.special {
                for axis in 0..3 {
                    if let Some(&x) = [0.0, -0.0, 1e-39, -1e-40].get(choice(6 + axis, 12) as usize)
                    {
                        direction[axis as usize] = x;
                    }
                }
            }
            let mut ray = Ray::new(origin, direction);
            ray.tmax = [f32::INFINITY, 1.0, 0.5, 3.0][choice(10, 4) as usize];
            ray.tmin = if kind.one_tmin {
                0.125
            } else {
                0.1 * choice(11, 5) as f32
            };
            match choice(12, 24) {
                0 => ray.tmin = -1.0,
                1 => ray.tmax = -1.0,
                2 => ray.direction = Vec3::ZERO,
                3 => ray.origin.y = f32::NAN,
                4 => ray.direction.z = f32::INFINITY,
                5 => ray.origin = Vec3::new(1e30, -1e30, 0.0) / 0.0,
                _ => {}
            }
            ray
        })
        .collect()
}

fn lengths() -> impl Iterator<Item = usize> {
    (0..70).chain([127, 128, 129, 300])
}

#[test]
fn records_are_what_the_rays_are() {
    for isa in Isa::available() {
        for kind in KINDS {
            for n in lengths() {
                let batch = batch(1, n, kind);
                let at = format!("{isa}, {n} rays, {kind:?}");
                let (memory, rays, found) = Memory::prepared(isa, &batch, false);
                let valid: Vec<usize> = (0..n).filter(|&i| batch.ray(i).is_valid()).collect();
                let of_valid = || valid.iter().map(|&i| batch.ray(i));
                assert_eq!(found.valid, valid.len(), "{at}");
                let ids = memory.ids[..found.valid].iter().map(|&id| id as usize);
                assert!(ids.eq(valid.iter().copied()), "{at}");
                let behind = &memory.ids[found.valid..];
                assert!(behind.iter().all(|&id| (id as usize) < n.max(1)), "{at}");

                let special = |ray: Ray| {
                    ray.direction
                        .to_array()
                        .iter()
                        .any(|&d| inverse(d).is_nan())
                };
                assert_eq!(found.special, of_valid().any(special), "{at}");
                let least = of_valid().map(|ray| ray.tmin).fold(f32::INFINITY, f32::min);
                assert_eq!(found.least_tmin, least, "{at}");
                let one = n > 0 && !valid.is_empty() && of_valid().all(|ray| ray.tmin == least);
                assert_eq!(found.one_tmin, one, "{at}");
                let origins = of_valid().fold(Aabb::EMPTY, |b, ray| b.with_point(ray.origin));
                assert_eq!(found.origins, origins, "{at}");

                let shared = rays.shared_origin.is_some();
                assert!(shared == kind.shared || valid.len() < 2, "{at}");
                let bits = |x: [f32; 4]| x.map(f32::to_bits);
                for (i, ray) in batch.iter().enumerate() {
                    let [dx, dy, dz] = ray.direction.to_array();
                    let miss = f32::from_bits(MISS);
                    assert_eq!(bits(memory.directions[i]), bits([dx, dy, dz, miss]), "{at}");
                    let best = if ray.is_valid() {
                        ray.tmax
                    } else {
                        f32::INFINITY
                    };
                    let slab = memory.slabs[if shared { i } else { 2 * i }];
                    for (axis, d) in [dx, dy, dz].into_iter().enumerate() {
                        let inverse = inverse(d);
                        assert!(slab[axis] == inverse || slab[axis].is_nan() && inverse.is_nan());
                    }
                    assert_eq!(slab[3], best, "{at}");
                    if !shared {
                        let [x, y, z] = ray.origin.to_array();
                        assert_eq!(
                            bits(memory.slabs[2 * i + 1]),
                            bits([x, y, z, ray.tmin]),
                            "{at}"
                        );
                    }
                }
                let rest = if shared { n } else { 2 * n };
                assert!(
                    memory.slabs[rest..]
                        .iter()
                        .all(|record| *record == UNTOUCHED),
                    "{at}"
                );
                assert_eq!(memory.directions[n], UNTOUCHED, "{at}");
            }
        }
    }
}

/// The list in the middle of which a filter works, and what became of it: those kept, in order.
fn filtered(
    isa: Isa,
    batch: &Batch,
    at: &str,
    keep: impl Fn(&RayRecords, Range) -> usize,
    best: impl Fn(usize) -> Option<f32>,
    keeps: impl Fn(&RayRecords, usize) -> bool,
) -> (Vec<u32>, usize) {
    let (mut memory, rays, found) = Memory::prepared(isa, batch, false);
    for i in 0..batch.len() {
        if let Some(t) = best(i) {
            let place = rays.place(i);
            memory.slabs[place][3] = t;
        }
    }
    let list = Range {
        from: found.valid / 5,
        to: found.valid,
    };
    let before = memory.ids.clone();
    let n = keep(&rays, list);
    let after = memory.ids;
    assert_eq!(after[..list.from], before[..list.from], "{at}");
    assert_eq!(after[list.to..], before[list.to..], "{at}");
    let sorted = |ids: &[u32]| {
        let mut ids = ids.to_vec();
        ids.sort();
        ids
    };
    let ids = &after[list.from..list.to];
    assert_eq!(sorted(ids), before[list.from..list.to], "{at}");
    assert!(ids[..n].iter().all(|&id| keeps(&rays, id as usize)), "{at}");
    assert!(
        !ids[n..].iter().any(|&id| keeps(&rays, id as usize)),
        "{at}"
    );
    (after[..list.to].to_vec(), n)
}

/// What of a ray is inside a box, by the slab routine, one ray at a time.
fn interval(ray: &Ray, b: &Aabb, tmin: f32) -> (f32, f32) {
    // SAFETY: portable code runs everywhere.
    unsafe {
        let slabs = SlabBox::<Portable>::new(b, None);
        let inverse = ray.direction.to_array().map(|d| [inverse(d); 4]);
        let origin = ray.origin.to_array().map(|o| [o; 4]);
        let (near, far) = slabs.interval::<false, true>(&inverse, &origin, [tmin; 4]);
        (near[0], far[0])
    }
}

#[test]
fn rays_that_meet_a_box_are_kept_and_their_directions_counted() {
    let bounds = Aabb {
        min: Vec3::new(-1.5, -1.5, -0.5),
        max: Vec3::new(0.125, 1.0, 1.0),
    };
    let (mut kept, mut rejected) = (0, 0);
    for kind in KINDS {
        for n in lengths() {
            let batch = batch(2, n, kind);
            // Some have a hit, some of these right where they enter.
            let best = |i: usize| {
                let ray = batch.ray(i);
                match hash(3, 0, i as u64) % 4 {
                    0 => Some(interval(&ray, &bounds, 0.0).0),
                    1 => Some(0.2),
                    2 => Some(interval(&ray, &bounds, 0.0).0.next_down()),
                    _ => None,
                }
            };
            let meets = |rays: &RayRecords, i: usize| {
                let ray = batch.ray(i);
                let (near, far) = interval(&ray, &bounds, rays.least_tmin);
                near <= far && near <= best(i).unwrap_or(ray.tmax)
            };
            for axis in [None, Some(0), Some(1), Some(2)] {
                let mut first = None;
                for isa in Isa::available() {
                    let at = format!("{isa}, {n} rays, {kind:?}");
                    let directions = std::cell::Cell::new(Directions::default());
                    let keep = |rays: &RayRecords, list| {
                        // SAFETY: the processor was checked; the records are those of the batch.
                        let (n, found) =
                            unsafe { (Kernels::of(isa).keep_meeting)(rays, list, &bounds, axis) };
                        directions.set(found);
                        n
                    };
                    let (ids, n) = filtered(isa, &batch, &at, keep, best, meets);
                    let (_, _, found) = Memory::prepared(isa, &batch, false);
                    let mut expected = Directions::default();
                    for &id in &ids[found.valid / 5..][..n] {
                        if let Some(axis) = axis {
                            let d = inverse(batch.ray(id as usize).direction[axis]);
                            expected.up += (d > 0.0) as usize;
                            expected.down += (d < 0.0) as usize;
                        }
                    }
                    assert_eq!(directions.get(), expected, "{at}");
                    kept += n;
                    rejected += found.valid - found.valid / 5 - n;
                    assert_eq!(first.get_or_insert_with(|| ids.clone()), &ids, "{at}");
                }
            }
        }
    }
    assert!(
        kept > rejected / 8 && rejected > kept / 8,
        "{kept} {rejected}"
    );
}

#[test]
fn rays_are_in_one_octant() {
    for kind in KINDS {
        for n in lengths() {
            let batch = batch(4, n, kind);
            let mut in_all = 0;
            for octant in 0..8 {
                // A direction too short for 1/d goes neither up nor down.
                let inside = |_: &RayRecords, i: usize| {
                    let d = batch.ray(i).direction.to_array();
                    (0..3).all(|axis| (inverse(d[axis]) < 0.0) == (octant >> axis & 1 == 1))
                };
                let mut first = None;
                for isa in Isa::available() {
                    let at = format!("{isa}, {n} rays, octant {octant}, {kind:?}");
                    let keep = |rays: &RayRecords, list| {
                        // SAFETY: as above.
                        unsafe { (Kernels::of(isa).keep_octant)(rays, list, octant) }
                    };
                    let found = filtered(isa, &batch, &at, keep, |_| None, inside);
                    assert_eq!(first.get_or_insert_with(|| found.clone()), &found, "{at}");
                }
                in_all += first.unwrap().1;
            }
            let valid = batch.iter().filter(Ray::is_valid).count();
            assert_eq!(in_all, valid - valid / 5);
        }
    }
}

/// The sure exit of a ray from the first of two cells, and what of it is inside the second: with the
/// origin shared or its own, all instances agree.
///
/// # Safety
/// The processor has `L`'s instruction set.
unsafe fn two_cells<L: Lanes, const SHARED: bool, const SPECIAL: bool>(
    ray: &Ray,
    cells: &[Aabb; 2],
) -> (f32, f32, f32) {
    // SAFETY: as promised.
    unsafe {
        let shared = SHARED.then_some(ray.origin);
        let [first, second] = [0, 1].map(|i| SlabBox::<L>::new(&cells[i], shared));
        let inverse = splat3::<L>(&ray.direction.to_array().map(inverse));
        let origin = splat3::<L>(&ray.origin.to_array());
        let exit = first.sure_exit::<SHARED, SPECIAL>(&inverse, &origin);
        let (near, far) = second.interval::<SHARED, SPECIAL>(&inverse, &origin, L::splat(0.0));
        let mut lanes = [[0f32; MAX_LANES]; 3];
        for (to, v) in lanes.iter_mut().zip([exit, near, far]) {
            L::store(to.as_mut_ptr(), v);
        }
        let [exit, near, far] = lanes.map(|v| v[L::N - 1]);
        // Where something is special, near does not overflow.
        (exit, near.min(f32::MAX * (1.0 - PADDING)), far)
    }
}

fn two_cells_on(ray: &Ray, cells: &[Aabb; 2]) -> (f32, f32, f32) {
    let special = ray
        .direction
        .to_array()
        .iter()
        .any(|&d| inverse(d).is_nan());
    // SAFETY: each instance runs only where the processor has it.
    unsafe {
        let found = two_cells::<Portable, true, true>(ray, cells);
        assert_eq!(two_cells::<Portable, false, true>(ray, cells), found);
        if !special {
            assert_eq!(two_cells::<Portable, true, false>(ray, cells), found);
            assert_eq!(two_cells::<Portable, false, false>(ray, cells), found);
        }
        #[cfg(target_arch = "x86_64")]
        if Isa::Avx2.is_available() {
            assert_eq!(two_cells::<Avx2, true, true>(ray, cells), found);
            assert_eq!(two_cells::<Avx2, false, true>(ray, cells), found);
        }
        #[cfg(target_arch = "x86_64")]
        if Isa::Avx512.is_available() {
            assert_eq!(two_cells::<Avx512, true, true>(ray, cells), found);
            assert_eq!(two_cells::<Avx512, false, true>(ray, cells), found);
        }
        found
    }
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -2f32..2.0,
        4 => (-2i8..=2).prop_map(|x| x as f32 / 2.0),
        1 => Just(-0.0),
        1 => Just(0.0),
        1 => -1e18f32..1e18,
        1 => -1e-38f32..1e-38,
        1 => -1e6f32..1e6,
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from)
}

/// Two boxes on either side of a plane across an axis, the lower one first; some touch it.
fn cells_apart() -> impl Strategy<Value = (usize, f32, [Aabb; 2])> {
    (
        0..3usize,
        coordinate(),
        [point(), point(), point(), point()],
        0..9u8,
    )
        .prop_map(|(axis, plane, [a, b, c, d], touching)| {
            let around = |a: Vec3, b: Vec3| Aabb {
                min: a.min(b),
                max: a.max(b),
            };
            let (mut lower, mut upper) = (around(a, b), around(c, d));
            lower.max[axis] = lower.max[axis].min(plane);
            lower.min[axis] = lower.min[axis].min(plane);
            upper.min[axis] = upper.min[axis].max(plane);
            upper.max[axis] = upper.max[axis].max(plane);
            // Most cells of the recursion lie at the plane.
            if touching % 3 != 0 {
                lower.max[axis] = plane;
            }
            if touching / 3 != 0 {
                upper.min[axis] = plane;
            }
            (axis, plane, [lower, upper])
        })
}

/// Whether the second cell has nothing for a ray whose best t is before its sure exit from the first.
/// A ray that goes away from the plane on which it begins touches the second cell at t = 0 (and as
/// much as intervals are widened), where there are no hits.
fn is_done_with(ray: &Ray, cells: &[Aabb; 2], t: f32) -> bool {
    let (exit, near, far) = two_cells_on(ray, cells);
    t >= exit || near > far || near > t || far <= UNDERFLOW
}

/// Best t that matter for an exit: right before it, half-way, at once.
fn before(exit: f32) -> impl Iterator<Item = f32> {
    [
        exit.next_down(),
        0.999999 * exit,
        0.5 * exit,
        f32::MIN_POSITIVE,
    ]
    .into_iter()
    .filter(move |&t| 0.0 < t && t < exit)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn a_hit_before_the_sure_exit_is_before_all_cells_behind_a_plane(
        (axis, plane, [lower, upper]) in cells_apart(),
        origin in point(),
        on_plane in 0..4u8,
        direction in point(),
    ) {
        prop_assume!(direction != Vec3::ZERO);
        let mut ray = Ray::new(origin, direction);
        if on_plane == 0 {
            ray.origin[axis] = plane;
        }
        // A shared origin: the cell on its side of the plane comes first.
        let cells = match plane < ray.origin[axis] {
            true => [upper, lower],
            false => [lower, upper],
        };
        for t in before(two_cells_on(&ray, &cells).0) {
            prop_assert!(is_done_with(&ray, &cells, t), "{ray:?} {cells:?} {t:e}");
        }
        // Octants: the cell where the ray comes from.
        let cells = match inverse(direction[axis]) < 0.0 {
            true => [upper, lower],
            false => [lower, upper],
        };
        for t in before(two_cells_on(&ray, &cells).0) {
            prop_assert!(is_done_with(&ray, &cells, t), "{ray:?} {cells:?} {t:e}");
        }
    }
}

#[test]
fn a_ray_that_leaves_a_cell_beyond_the_largest_t_is_not_done_before_it() {
    let far = -8.901813e17;
    let near_cell = Aabb {
        min: Vec3::new(far, -0.12106231, 0.0),
        max: Vec3::new(0.0, 0.0, 1.74368),
    };
    let far_cell = Aabb {
        min: Vec3::new(far, -8.550188e17, 0.0),
        max: Vec3::new(far, 0.0, 0.6320445),
    };
    let origin = Vec3::new(0.0, -6.322612e-39, 0.5);
    let ray = Ray::new(origin, Vec3::new(-7.546155e-39, 0.0, -0.0));
    let cells = [near_cell, far_cell];
    let exit = two_cells_on(&ray, &cells).0;
    assert!(exit < f32::MAX, "{exit:e}");
    assert!(before(exit).all(|t| is_done_with(&ray, &cells, t)));
}

#[test]
fn a_ray_that_leaves_a_cell_where_t_overflows_has_a_finite_exit_on_all_instances() {
    let lower = Aabb {
        min: Vec3::splat(-1e18),
        max: Vec3::new(1e18, 1e18, 1e16),
    };
    let upper = Aabb {
        min: Vec3::new(-1e18, -1e18, 1e16),
        max: Vec3::splat(1e18),
    };
    let ray = Ray::new(Vec3::ZERO, Vec3::splat(5e-39));
    let exit = two_cells_on(&ray, &[lower, upper]).0;
    assert_eq!(exit, f32::MAX * (1.0 - PADDING));
    assert!(before(exit).all(|t| is_done_with(&ray, &[lower, upper], t)));
}

#[test]
fn a_ray_within_the_plane_between_two_cells_is_not_done() {
    let lower = Aabb {
        min: Vec3::splat(-1.0),
        max: Vec3::new(0.0, 1.0, 1.0),
    };
    let upper = Aabb {
        min: Vec3::new(0.0, -1.0, -1.0),
        max: Vec3::splat(1.0),
    };
    for zero in [0.0, -0.0, 1e-39, -1e-40] {
        let ray = Ray::new(Vec3::new(0.0, -3.0, 0.25), Vec3::new(zero, 1.0, 0.01));
        for cells in [[lower, upper], [upper, lower]] {
            assert_eq!(two_cells_on(&ray, &cells).0, f32::NEG_INFINITY);
        }
        let inside = Ray::new(Vec3::new(-0.5, -3.0, 0.25), ray.direction);
        assert_eq!(
            two_cells_on(&inside, &[lower, upper]).0,
            4.0 * (1.0 - PADDING)
        );
    }
}

/// One large triangle at x = 2, and what becomes of rays and their list in a naive step with it.
#[test]
fn rays_that_are_done_come_first() {
    let mesh = Mesh::new(vec![Triangle::new(
        Vec3::new(2.0, -10.0, -10.0),
        Vec3::new(2.0, 30.0, -10.0),
        Vec3::new(2.0, -10.0, 30.0),
    )]);
    // All origins are inside, or on the upper plane of y.
    let cells = [1.0, 0.0].map(|y| Aabb {
        min: Vec3::new(0.0, -1.0, -20.0),
        max: Vec3::new(3.0, y, 20.0),
    });
    for isa in Isa::available() {
        for (n, shared) in (0..70).chain([300]).flat_map(|n| [(n, false), (n, true)]) {
            let (cell, on_plane) = (cells[n % 2], n % 2 == 1);
            let batch: Batch = (0..n as u64)
                .map(|i| {
                    let mut ray = Ray::new(Vec3::new(0.5, 0.0, 0.0), Vec3::X);
                    if !shared {
                        ray.origin.x += i as f32 / 1024.0;
                    }
                    match hash(n as u64, 5, i) % 7 {
                        // Misses; hits behind the cell's exit.
                        0 => ray.direction.z = -20.0,
                        1 => ray.direction.y = 2.0,
                        // The hit is too far away, or too near.
                        2 => ray.tmax = 0.25,
                        3 => ray.tmin = 1.75,
                        4 => {}
                        _ => ray.direction.y = 0.25,
                    }
                    ray
                })
                .collect();
            let hits = |i: usize| {
                let ray = batch.ray(i);
                ray.direction.z == 0.0 && ray.tmax > 1.0 && ray.tmin < 1.0
            };
            for (any_hit, when) in [false, true]
                .into_iter()
                .flat_map(|any| [Done::Never, Done::BeforeExit, Done::Hit].map(|when| (any, when)))
            {
                let at = format!("{isa}, {n} rays, shared {shared}, any {any_hit}, {when:?}");
                let (mut memory, rays, found) = Memory::prepared(isa, &batch, any_hit);
                assert_eq!(found.valid, n);
                let mut spans = [[[0f32; 2]; 1]; 3];
                let (mut rest, mut ids) = ([[0f32; 4]; 1], [0u32; 2 * MAX_LANES]);
                let lists = TriangleLists {
                    spans: spans.each_mut().map(|list| list.as_mut_ptr()),
                    rest: rest.as_mut_ptr(),
                    ids: ids.as_mut_ptr(),
                };
                // Any order; those before the list have been done before.
                memory.ids[..n].sort_by_key(|&id| hash(6, 0, id as u64));
                let ids = memory.ids.clone();
                let list = Range { from: n / 7, to: n };
                // SAFETY: the processor was checked; all memory has room for whole vectors.
                let done = unsafe {
                    (Kernels::of(isa).prepare_lists)(&mesh, &lists);
                    let triangles = Listed {
                        lists: &lists,
                        triangles: mesh.triangles(),
                        len: 1,
                        duplicates: &mut 0,
                    };
                    (Kernels::of(isa).naive_indexed)(&rays, list, triangles, &cell, when)
                };
                let is_done = |&id: &u32| {
                    let (i, ray) = (id as usize, batch.ray(id as usize));
                    match when {
                        Done::Never => false,
                        Done::BeforeExit if hits(i) && any_hit => true,
                        // They leave at once, or may hit the same in another cell.
                        Done::BeforeExit if on_plane => false,
                        // Or the ray's reach ends in the cell.
                        Done::BeforeExit => hits(i) && ray.direction.y < 2.0 || ray.tmax == 0.25,
                        Done::Hit => hits(i),
                    }
                };
                assert!(memory.ids[list.from..done].iter().all(is_done), "{at}");
                assert!(!memory.ids[done..n].iter().any(is_done), "{at}");
                assert_eq!(memory.ids[..list.from], ids[..list.from], "{at}");
                assert_eq!(memory.ids[n..], ids[n..], "{at}");
                let mut sorted = memory.ids[..n].to_vec();
                sorted.sort();
                assert!(sorted.into_iter().eq(0..n as u32), "{at}");
                for (place, &id) in memory.ids[..n].iter().enumerate() {
                    let (i, ray) = (id as usize, batch.ray(id as usize));
                    let t = memory.slabs[rays.place(i)][3];
                    let prim = memory.directions[i][3].to_bits();
                    if place < list.from || !hits(i) {
                        assert_eq!((t, prim), (ray.tmax, MISS), "{at}");
                    } else if any_hit {
                        assert_eq!(t, -1.0, "{at}");
                    } else {
                        assert_eq!((t, prim), (2.0 - ray.origin.x, 0), "{at}");
                    }
                }
            }
        }
    }
}
