//! What is done to triangles.

use super::{Bench, Work, best, number, point};
use crate::geometry::{Aabb, Mesh, Triangle};
use crate::kernels::{Binning, Bins, Item, Kernels, Overlap, Side, TriangleLists};
use crate::simd::MAX_LANES;
use glam::Vec3;
use std::ptr::null_mut;

/// Splits the unit cube in half.
const LOWER: Side = Side {
    axis: 0,
    plane: 0.5,
    upper: false,
};
pub(super) const CUBE: Aabb = Aabb {
    min: Vec3::ZERO,
    max: Vec3::ONE,
};
pub(super) const HALF: Aabb = Aabb {
    min: Vec3::ZERO,
    max: Vec3::new(0.5, 1.0, 1.0),
};

/// A triangle of about the size of the cube that it reaches into, as in the cells at the end of a
/// trace.
fn triangle(index: usize) -> Triangle {
    let center = point(0, index);
    let corner = |k| center + 0.8 * (point(1, 3 * index + k) - Vec3::splat(0.5));
    Triangle::new(corner(0), corner(1), corner(2))
}

pub(super) fn mesh(triangles: usize) -> Mesh {
    Mesh::new((0..triangles).map(triangle).collect())
}

/// An index list that passes reorder.
pub(super) struct Indices {
    /// With whole vectors of valid indices behind the end.
    pub ids: Vec<u32>,
    first: Vec<u32>,
}

impl Indices {
    pub fn new(first: Vec<u32>) -> Indices {
        Indices {
            ids: vec![0; first.len() + MAX_LANES],
            first,
        }
    }

    pub fn in_order(len: usize) -> Indices {
        Indices::new((0..len as u32).collect())
    }

    /// All indices, as good as random: a bijection of the numbers below a power of two, less those
    /// that are too large.
    fn in_random_order(len: usize) -> Indices {
        let bits = len.next_power_of_two().trailing_zeros().max(2);
        let (mask, shift) = ((1u64 << bits) - 1, bits.div_ceil(2));
        let mix = |x: u64| {
            let x = (x ^ x >> shift).wrapping_mul(0xbf58_476d_1ce4_e5b9) & mask;
            let x = (x ^ x >> shift).wrapping_mul(0x94d0_49bb_1331_11eb) & mask;
            (x ^ x >> shift) as u32
        };
        Indices::new(
            (0..=mask)
                .map(mix)
                .filter(|&x| (x as usize) < len)
                .collect(),
        )
    }

    pub fn len(&self) -> usize {
        self.first.len()
    }

    pub fn reset(&mut self) {
        self.ids[..self.first.len()].copy_from_slice(&self.first);
    }

    pub fn left(&self) -> Vec<u32> {
        self.ids[..self.first.len()].to_vec()
    }
}

/// Triangles against a split plane; only the list of spans on its axis is there.
struct SplitPlane {
    spans: Vec<[f32; 2]>,
    indices: Indices,
}

/// What a pass touches of a triangle: its span on the axis and its index.
const SPAN_AND_INDEX: usize = 8 + 4;

fn split_plane_of(indices: Indices) -> Bench {
    let span = |i| {
        let least = number(0, 2 * i);
        [least, least + 0.01 * number(0, 2 * i + 1)]
    };
    Bench {
        work: Box::new(SplitPlane {
            spans: (0..indices.len()).map(span).collect(),
            indices,
        }),
        // The index is written back.
        bytes_per_test: (SPAN_AND_INDEX + 4) as f64,
    }
}

pub(super) fn split_plane(bytes: usize) -> Bench {
    split_plane_of(Indices::in_order((bytes / SPAN_AND_INDEX).max(1000)))
}

pub(super) fn split_plane_in_random_order(bytes: usize) -> Bench {
    split_plane_of(Indices::in_random_order((bytes / SPAN_AND_INDEX).max(1000)))
}

impl Work for SplitPlane {
    fn reset(&mut self) {
        self.indices.reset();
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let lists = TriangleLists {
            spans: [self.spans.as_mut_ptr(), null_mut(), null_mut()],
            rest: null_mut(),
            ids: self.indices.ids.as_mut_ptr(),
        };
        // SAFETY: the processor is the caller's promise; the kernel looks only at the indices and at
        // the spans on the axis of the side, which are there for each index.
        unsafe { (kernels.keep_side)(&lists, self.indices.len(), LOWER) };
        self.indices.len()
    }

    fn left(&self) -> Vec<u32> {
        self.indices.left()
    }
}

/// Triangles in all four lists.
pub(super) struct Lists {
    spans: [Vec<[f32; 2]>; 3],
    rest: Vec<[f32; 4]>,
    pub indices: Indices,
}

impl Lists {
    pub fn new(mesh: &Mesh) -> Lists {
        let n = mesh.len();
        let mut lists = Lists {
            spans: [(); 3].map(|()| vec![[0.0; 2]; n]),
            rest: vec![[0.0; 4]; n],
            indices: Indices::in_order(n),
        };
        lists.prepare(mesh);
        lists
    }

    /// Writes the lists of all triangles.
    pub fn prepare(&mut self, mesh: &Mesh) {
        // SAFETY: the processor was checked; there is room for the mesh.
        let prepared = unsafe { (best().prepare_lists)(mesh, &self.pointers()) };
        assert_eq!(prepared.len, mesh.len(), "a triangle without an area");
    }

    pub fn pointers(&mut self) -> TriangleLists {
        TriangleLists {
            spans: self.spans.each_mut().map(|list| list.as_mut_ptr()),
            rest: self.rest.as_mut_ptr(),
            ids: self.indices.ids.as_mut_ptr(),
        }
    }
}

/// Triangles against half a cube by the split plane and the nine cross products.
struct NineAxes(Lists);

/// Triangles of a list: traces test that way what is fewer than 100.
const FEW: usize = 96;

pub(super) fn nine_axes(bytes: usize) -> Bench {
    let touched = 3 * 8 + 16 + 4;
    let lists = Lists::new(&mesh((bytes / touched / FEW).max(1) * FEW));
    Bench {
        work: Box::new(NineAxes(lists)),
        bytes_per_test: (touched + 4) as f64,
    }
}

impl Work for NineAxes {
    fn reset(&mut self) {
        self.0.indices.reset();
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let origin = Vec3::new(0.5, 0.5, -2.0);
        let by = Overlap {
            cell: HALF,
            side: LOWER,
            origins: Aabb {
                min: origin,
                max: origin,
            },
            plane: false,
        };
        let len = self.0.indices.len();
        let mut lists = self.0.pointers();
        for _ in 0..len / FEW {
            // SAFETY: the processor is the caller's promise; there are so many indices of triangles,
            // and a vector of them behind the last.
            unsafe {
                (kernels.keep_overlapping)(&lists, FEW, by);
                lists.ids = lists.ids.add(FEW);
            }
        }
        len
    }

    fn left(&self) -> Vec<u32> {
        self.0.indices.left()
    }
}

/// What is divided by object splitting.
pub(super) fn items(len: usize) -> Vec<Item> {
    let item = |i| Item::new(&triangle(i), i as u32);
    (0..len).map(item).collect()
}

const BINS: usize = 32;

/// Items to the bins of one axis.
struct Binned {
    items: Vec<Item>,
    bins: Box<[Bins; 3]>,
}

pub(super) fn binning(bytes: usize) -> Bench {
    Bench {
        work: Box::new(Binned {
            items: items((bytes / size_of::<Item>()).max(1000)),
            bins: Box::new([Bins::EMPTY; 3]),
        }),
        bytes_per_test: size_of::<Item>() as f64,
    }
}

impl Work for Binned {
    fn reset(&mut self) {
        self.bins[0].counts.fill(0);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let axes = [Binning::new(&CUBE, 0, BINS)];
        // SAFETY: the processor is the caller's promise.
        unsafe { (kernels.bin)(&self.items, &axes, &mut self.bins) };
        self.items.len()
    }

    fn left(&self) -> Vec<u32> {
        self.bins[0].counts[..BINS].to_vec()
    }
}

/// Items to the sides of the middle bin.
struct Partitioned {
    items: Vec<Item>,
    first: Vec<Item>,
    scratch: Vec<Item>,
}

pub(super) fn partition(bytes: usize) -> Bench {
    // Half of the items go to the scratch on the way.
    let touched = size_of::<Item>() * 3 / 2;
    let first = items((bytes / touched).max(1000));
    Bench {
        work: Box::new(Partitioned {
            items: first.clone(),
            scratch: first.clone(),
            first,
        }),
        bytes_per_test: 2.0 * size_of::<Item>() as f64,
    }
}

impl Work for Partitioned {
    fn reset(&mut self) {
        self.items.copy_from_slice(&self.first);
    }

    unsafe fn run(&mut self, kernels: &Kernels) -> usize {
        let by = Binning::new(&CUBE, 0, BINS);
        let (items, scratch) = (&mut self.items, &mut self.scratch);
        // SAFETY: the processor is the caller's promise.
        unsafe { (kernels.partition)(items, scratch, &by, BINS / 2 - 1) };
        items.len()
    }

    fn left(&self) -> Vec<u32> {
        self.items.iter().map(Item::prim).collect()
    }
}
