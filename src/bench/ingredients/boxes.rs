//! Slab tests that differ in how distances of planes are computed and padded.
//!
//! For rays without a component of zero, or so small that 1/d is infinite: there all of them would
//! need more than a slab test.

use super::{LEAF, Pairs, RayVector, assert_whole_vectors, instance, splat3};
use crate::geometry::Triangle;
use crate::kernels::PADDING;
use crate::rays::Batch;
use crate::simd::{Isa, Lanes};

/// Nearest and furthest t of each pair.
type Intervals = fn(Isa, &Pairs) -> (Vec<f32>, Vec<f32>);

/// A test of a ray and a box.
pub struct BoxTest {
    /// What it is called.
    pub name: &'static str,
    /// What it does.
    pub change: &'static str,
    intervals: Intervals,
    met: fn(Isa, &Batch, &[Triangle], &mut [f32]),
}

/// All tests; the first one is that of all precisions.
pub const BOX_TESTS: &[BoxTest] = &[
    BoxTest::new::<Padded>("padded, 64 u", "(x − o)·(1/d), both ends padded: ours"),
    BoxTest::new::<Plain>("plain", "no padding"),
    BoxTest::new::<Ize>("far end, 2 ulp", "only the far end padded: Ize 2013"),
    BoxTest::new::<Division>("division", "(x − o)/d, no padding"),
    BoxTest::new::<Fused>("fused", "x·(1/d) − o·(1/d) fused, no padding"),
    BoxTest::new::<FusedPadded>("fused, 64 u", "the same, both ends padded"),
];

impl BoxTest {
    const fn new<S: Slab>(name: &'static str, change: &'static str) -> BoxTest {
        BoxTest {
            name,
            change,
            intervals: intervals::<S>,
            met: met::<S>,
        }
    }

    /// For each pair where the ray enters and leaves the box of the triangle. It misses the box where
    /// it leaves before it enters.
    ///
    /// # Panics
    /// If this processor does not have the instruction set.
    pub fn intervals(&self, isa: Isa, pairs: &Pairs) -> (Vec<f32>, Vec<f32>) {
        (self.intervals)(isa, pairs)
    }

    /// All rays against the boxes of all triangles: adds to `met` the number that each ray meets.
    ///
    /// # Panics
    /// As for [`TriangleTest::nearest`](super::TriangleTest::nearest).
    pub fn met(&self, isa: Isa, rays: &Batch, triangles: &[Triangle], met: &mut [f32]) {
        (self.met)(isa, rays, triangles, met);
    }
}

/// How distances are computed: by default (x − o)·(1/d), which are not padded.
pub(super) trait Slab {
    /// What near and far are multiplied with.
    const PADDING: [f32; 2] = [1.0; 2];
    const FUSED: bool = false;
    const DIVISION: bool = false;
}

struct Plain;
impl Slab for Plain {}

struct Padded;
impl Slab for Padded {
    const PADDING: [f32; 2] = [1.0 - PADDING, 1.0 + PADDING];
}

struct Ize;
impl Slab for Ize {
    const PADDING: [f32; 2] = [1.0, 1.0 + 2.0 * f32::EPSILON];
}

struct Division;
impl Slab for Division {
    const DIVISION: bool = true;
}

struct Fused;
impl Slab for Fused {
    const FUSED: bool = true;
}

struct FusedPadded;
impl Slab for FusedPadded {
    const PADDING: [f32; 2] = Padded::PADDING;
    const FUSED: bool = true;
}

/// What is computed of rays beforehand.
struct Rays<L: Lanes> {
    origin: [L::F; 3],
    /// 1/d, or d for a division.
    scale: [L::F; 3],
    /// o · (1/d).
    offset: [L::F; 3],
    tmin: L::F,
    tmax: L::F,
}

impl<L: Lanes> Rays<L> {
    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    unsafe fn new<S: Slab>(v: &RayVector<L>) -> Rays<L> {
        // SAFETY: as promised.
        unsafe {
            let (mut scale, mut offset) = (v.direction, v.origin);
            for axis in 0..3 {
                if !S::DIVISION {
                    scale[axis] = L::div(L::splat(1.0), scale[axis]);
                }
                offset[axis] = L::mul(offset[axis], scale[axis]);
            }
            Rays {
                origin: v.origin,
                scale,
                offset,
                tmin: v.tmin,
                tmax: v.tmax,
            }
        }
    }

    /// Distance of the plane at `x`.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; so for all that follow.
    #[inline(always)]
    unsafe fn distance<S: Slab>(&self, axis: usize, x: L::F) -> L::F {
        // SAFETY: as promised.
        unsafe {
            if S::FUSED {
                return L::mul_sub(x, self.scale[axis], self.offset[axis]);
            }
            let way = L::sub(x, self.origin[axis]);
            match S::DIVISION {
                true => L::div(way, self.scale[axis]),
                false => L::mul(way, self.scale[axis]),
            }
        }
    }

    #[inline(always)]
    unsafe fn interval<S: Slab>(&self, lo: &[L::F; 3], hi: &[L::F; 3]) -> (L::F, L::F) {
        // SAFETY: as promised.
        unsafe {
            let (mut near, mut far) = (self.tmin, self.tmax);
            for axis in 0..3 {
                let t0 = self.distance::<S>(axis, lo[axis]);
                let t1 = self.distance::<S>(axis, hi[axis]);
                near = L::max(L::min(t0, t1), near);
                far = L::min(L::max(t0, t1), far);
            }
            if S::PADDING[0] != 1.0 {
                near = L::mul(near, L::splat(S::PADDING[0]));
            }
            if S::PADDING[1] != 1.0 {
                far = L::mul(far, L::splat(S::PADDING[1]));
            }
            (near, far)
        }
    }
}

/// # Safety
/// The processor has `L`'s instruction set; there is room for all rays of the pairs.
#[inline(always)]
pub(super) unsafe fn intervals_of<L: Lanes, S: Slab>(
    pairs: &Pairs,
    near: &mut [f32],
    far: &mut [f32],
) {
    for i in (0..near.len()).step_by(L::N) {
        // SAFETY: as promised; lengths are multiples of that of any vector.
        unsafe {
            let rays = Rays::<L>::new::<S>(&RayVector::load(&pairs.rays, i));
            let [a, b, c] = pairs.corners::<L>(i);
            let (mut lo, mut hi) = (a, a);
            for axis in 0..3 {
                lo[axis] = L::min(L::min(a[axis], b[axis]), c[axis]);
                hi[axis] = L::max(L::max(a[axis], b[axis]), c[axis]);
            }
            let (from, to) = rays.interval::<S>(&lo, &hi);
            L::store(near.as_mut_ptr().add(i), from);
            L::store(far.as_mut_ptr().add(i), to);
        }
    }
}

/// # Safety
/// The processor has `L`'s instruction set; there is room for all rays, as many as whole vectors have.
#[inline(always)]
pub(super) unsafe fn met_of<L: Lanes, S: Slab>(
    rays: &Batch,
    triangles: &[Triangle],
    met: &mut [f32],
) {
    // Each ray is read once for a leaf of boxes, as triangles are.
    for triangles in triangles.chunks(LEAF) {
        // SAFETY: as promised.
        unsafe {
            let mut leaf = [[[L::splat(0.0); 3]; 2]; LEAF];
            for (prepared, triangle) in leaf.iter_mut().zip(triangles) {
                let bounds = triangle.bounds();
                *prepared = [splat3::<L>(bounds.min), splat3::<L>(bounds.max)];
            }
            for i in (0..met.len()).step_by(L::N) {
                let rays = Rays::<L>::new::<S>(&RayVector::load(rays, i));
                let mut count = L::load(met.as_ptr().add(i));
                for [lo, hi] in &leaf[..triangles.len()] {
                    let (near, far) = rays.interval::<S>(lo, hi);
                    let one = L::select(L::le(near, far), L::splat(1.0), L::splat(0.0));
                    count = L::add(count, one);
                }
                L::store(met.as_mut_ptr().add(i), count);
            }
        }
    }
}

fn intervals<S: Slab>(isa: Isa, pairs: &Pairs) -> (Vec<f32>, Vec<f32>) {
    let full = pairs.rays.len();
    let (mut near, mut far) = (vec![0.0; full], vec![0.0; full]);
    instance!(isa, intervals_of::<S>(pairs, &mut near, &mut far));
    near.truncate(pairs.len);
    far.truncate(pairs.len);
    (near, far)
}

fn met<S: Slab>(isa: Isa, rays: &Batch, triangles: &[Triangle], met: &mut [f32]) {
    assert_whole_vectors(rays, met.len());
    instance!(isa, met_of::<S>(rays, triangles, met))
}
