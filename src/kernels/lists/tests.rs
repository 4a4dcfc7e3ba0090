//! The lists against the triangles that went into them.

use super::*;
use crate::geometry::Triangle;
use crate::kernels::Kernels;
use crate::kernels::fast::Fast;
use crate::kernels::triangle::{CHUNK, Prepared};
use crate::random::{below, hash};
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Portable};
use std::collections::HashSet;

/// Memory of the lists of a mesh, with room for whole vectors of indices.
struct Memory {
    spans: [Vec<[f32; 2]>; 3],
    rest: Vec<[f32; 4]>,
    ids: Vec<u32>,
}

impl Memory {
    fn prepared(isa: Isa, triangles: &[Triangle]) -> (Memory, PreparedLists) {
        let n = triangles.len();
        let mut memory = Memory {
            spans: [0, 1, 2].map(|_| vec![[f32::NAN; 2]; n]),
            rest: vec![[f32::NAN; 4]; n],
            ids: vec![0; n + 2 * MAX_LANES],
        };
        let mesh = Mesh::new(triangles.to_vec());
        // SAFETY: the processor was checked; there is room for the mesh.
        let found = unsafe { (Kernels::of(isa).prepare_lists)(&mesh, &memory.lists()) };
        (memory, found)
    }

    fn lists(&mut self) -> TriangleLists {
        TriangleLists {
            spans: self.spans.each_mut().map(|list| list.as_mut_ptr()),
            rest: self.rest.as_mut_ptr(),
            ids: self.ids.as_mut_ptr(),
        }
    }
}

fn of_corners(corners: [[f32; 3]; 3]) -> Triangle {
    let [a, b, c] = corners.map(Vec3::from);
    Triangle::new(a, b, c)
}

/// Triangles on a grid, so that coordinates are often equal; some are without area, some invalid.
fn grid(seed: u64, n: usize) -> Vec<Triangle> {
    (0..n as u64)
        .map(|i| {
            let number = |k: u64| hash(seed, i, k);
            let mut corners = [0, 1, 2].map(|corner| {
                [0, 1, 2].map(|axis| below(number(3 * corner + axis), 9) as f32 - 4.0)
            });
            match below(number(9), 8) {
                0 => corners[1] = corners[0],
                1 => corners[2] = [f32::NAN, 1.0, 2.0],
                2 => corners[0][1] = f32::INFINITY,
                3 => corners[2][0] = -1e19,
                _ => {}
            }
            of_corners(corners)
        })
        .collect()
}

fn bits(v: Vec3) -> [u32; 3] {
    v.to_array().map(f32::to_bits)
}

/// a, b, c and the box of each triangle, as bits, as an instance puts them together.
///
/// # Safety
/// The processor has `L`'s instruction set; whole vectors of indices behind `len`.
unsafe fn put_together<L: Lanes>(lists: &TriangleLists, len: usize) -> Vec<[[u32; 3]; 5]> {
    let mut all = vec![];
    for at in (0..len).step_by(L::N) {
        let mut lanes = [[[0f32; MAX_LANES]; 3]; 5];
        // SAFETY: as promised.
        unsafe {
            let (t, _) = corners::<L>(lists, lists.ids.add(at));
            for (to, of) in lanes.iter_mut().zip([t.a, t.b, t.c, t.lo, t.hi]) {
                for axis in 0..3 {
                    L::store(to[axis].as_mut_ptr(), of[axis]);
                }
            }
        }
        for lane in 0..L::N.min(len - at) {
            all.push(lanes.map(|v| v.map(|x| x[lane].to_bits())));
        }
    }
    all
}

/// The same on one instruction set.
fn put_together_on(isa: Isa, lists: &TriangleLists, len: usize) -> Vec<[[u32; 3]; 5]> {
    assert!(isa.is_available());
    // SAFETY: the processor was checked; all memory here has room for whole vectors.
    unsafe {
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => put_together::<Avx512>(lists, len),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => put_together::<Avx2>(lists, len),
            _ => put_together::<Portable>(lists, len),
        }
    }
}

#[test]
fn triangles_are_put_together_again_to_the_bit() {
    // All orders and equalities of three coordinates, a different one on each axis.
    const VALUES: [f32; 9] = [
        -0.0,
        0.0,
        1.0,
        -1.0,
        1e-40,
        1e18,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    const N: usize = 729;
    let choice = |i: usize| [i / 81, i / 9 % 9, i % 9].map(|k| VALUES[k]);
    let triangles: Vec<Triangle> = (0..N)
        .map(|i| {
            let [x, y, z] = [i, (7 * i + 300) % N, (N - 1) - i].map(choice);
            of_corners([0, 1, 2].map(|corner| [x[corner], y[corner], z[corner]]))
        })
        .collect();
    for isa in Isa::available() {
        let (mut memory, _) = Memory::prepared(isa, &triangles);
        // The triangles that cannot be hit, too.
        for (i, id) in memory.ids.iter_mut().enumerate() {
            *id = (i * 37 % N) as u32;
        }
        let all = put_together_on(isa, &memory.lists(), N);
        for (i, [a, b, c, lo, hi]) in all.into_iter().enumerate() {
            let t = &triangles[i * 37 % N];
            assert_eq!([a, b, c], [t.a, t.b, t.c].map(bits), "{isa}, {t:?}");
            if t.is_valid() {
                let [lo, hi] = [lo, hi].map(|v| Vec3::from(v.map(f32::from_bits)));
                assert_eq!((lo, hi), (t.bounds().min, t.bounds().max), "{isa}");
            }
        }
    }
}

#[test]
fn the_index_list_has_what_can_be_hit_in_file_order() {
    for isa in Isa::available() {
        for n in (0..70).chain([255, 256, 257]) {
            let triangles = grid(1, n);
            let (memory, found) = Memory::prepared(isa, &triangles);
            let mut bounds = Aabb::EMPTY;
            let mut expected = vec![];
            for (prim, t) in triangles.iter().enumerate() {
                let (e, f) = ((t.b - t.a).as_dvec3(), (t.c - t.a).as_dvec3());
                if t.is_valid() && e.cross(f).length() > 0.0 {
                    expected.push(prim as u32);
                    bounds = bounds.union(t.bounds());
                }
            }
            assert!(n < 40 || (n / 4..n * 3 / 4).contains(&expected.len()));
            assert_eq!((found.len, found.bounds), (expected.len(), bounds), "{n}");
            assert_eq!(memory.ids[..found.len], expected, "{n} triangles");
        }
    }
}

#[test]
fn a_side_keeps_the_triangles_that_reach_to_its_plane() {
    let triangles = grid(2, 400);
    let valid: Vec<u32> = (0..400)
        .filter(|&i| triangles[i as usize].is_valid())
        .collect();
    for len in (0..70).chain([128, 200, valid.len()]) {
        for (axis, upper) in [0, 1, 2]
            .into_iter()
            .flat_map(|axis| [(axis, false), (axis, true)])
        {
            // On the grid, between, and on either end.
            for plane in [0.0, -0.0, -1.5, 2.0, -4.0, 4.0, 4.5] {
                let side = Side { axis, plane, upper };
                let reaches = |&id: &u32| {
                    let b = triangles[id as usize].bounds();
                    if upper {
                        b.max[axis] >= plane
                    } else {
                        b.min[axis] <= plane
                    }
                };
                let mut first: Option<Vec<u32>> = None;
                for isa in Isa::available() {
                    let at = format!("{isa}, axis {axis}, {plane}, {upper}, {len} triangles");
                    let (mut memory, _) = Memory::prepared(isa, &triangles);
                    for (i, id) in memory.ids.iter_mut().enumerate() {
                        *id = valid[i * 31 % valid.len()];
                    }
                    let before = memory.ids.clone();
                    // SAFETY: the processor was checked; so many indices, with vectors behind them.
                    let n = unsafe { (Kernels::of(isa).keep_side)(&memory.lists(), len, side) };
                    let list = &memory.ids[..len];
                    assert!(list[..n].iter().all(reaches), "{at}");
                    assert!(!list[n..].iter().any(reaches), "{at}");
                    assert_eq!(memory.ids[len..], before[len..], "{at}");
                    let sorted = |list: &[u32]| {
                        let mut list = list.to_vec();
                        list.sort();
                        list
                    };
                    assert_eq!(sorted(list), sorted(&before[..len]), "{at}");
                    let order = first.get_or_insert_with(|| list.to_vec());
                    assert_eq!(list, order, "{at}");
                }
            }
        }
    }
}

/// What a naive step with the first `len` triangles would be given: their numbers, and how many it
/// is told have been in one before.
///
/// # Safety
/// The processor has `L`'s instruction set; whole vectors of indices behind `len`.
unsafe fn step<L: Lanes>(lists: &TriangleLists, len: usize) -> (Vec<u32>, u64) {
    let mut duplicates = 0;
    let mut prims = vec![];
    let mut chunk = [Prepared::ZERO; CHUNK];
    let mut listed = Listed {
        lists,
        triangles: &[],
        len,
        duplicates: &mut duplicates,
    };
    assert_eq!(TriangleList::<L>::len(&listed), len);
    for from in (0..len).step_by(CHUNK) {
        // SAFETY: as promised.
        unsafe { TriangleList::<L>::prepare::<Fast>(&mut listed, from, &mut chunk, None) };
        prims.extend(chunk[..CHUNK.min(len - from)].iter().map(|of| of.prim));
    }
    (prims, duplicates)
}

fn step_on(isa: Isa, lists: &TriangleLists, len: usize) -> (Vec<u32>, u64) {
    assert!(isa.is_available());
    // SAFETY: the processor was checked; all memory here has room for whole vectors.
    unsafe {
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => step::<Avx512>(lists, len),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => step::<Avx2>(lists, len),
            _ => step::<Portable>(lists, len),
        }
    }
}

#[test]
fn triangles_met_again_are_counted_and_keep_their_corners() {
    let triangles = grid(3, 120);
    for isa in Isa::available() {
        for len in 0..70 {
            let (mut memory, found) = Memory::prepared(isa, &triangles);
            let n = found.len;
            assert!(n > 0);
            // Behind the list there are indices of triangles that are not in the step.
            for (i, id) in memory.ids[n..].iter_mut().enumerate() {
                *id = (*id).max(i as u32 % 100);
            }
            let len = len.min(n);
            let before = put_together_on(isa, &memory.lists(), n);
            let prims = memory.ids[..n].to_vec();
            let mut met = HashSet::new();
            for (round, rotation) in [0, 0, len / 2, 17 % n, n / 2, 0].into_iter().enumerate() {
                for i in 0..n {
                    memory.ids[i] = prims[(i + rotation) % n];
                }
                let expected = memory.ids[..len].to_vec();
                let again = expected.iter().filter(|&&id| !met.insert(id)).count() as u64;
                let (prims, duplicates) = step_on(isa, &memory.lists(), len);
                assert_eq!(prims, expected, "{isa}, round {round} of {len}");
                assert_eq!(duplicates, again, "{isa}, round {round} of {len}");
            }
            memory.ids[..n].copy_from_slice(&prims);
            assert_eq!(put_together_on(isa, &memory.lists(), n), before, "{isa}");
        }
    }
}
