//! What each numerical ingredient of the ray/triangle and ray/box tests does alone: tests that
//! differ from precision `fast` in one thing each, for `dacrt bench ingredients`.
//!
//! None of them is used by a trace. They are written over the same vectors as the kernels that are,
//! and no box but the tests of boxes has a part in them. The reciprocals are estimates of the
//! processor, so [`TRIANGLE_TESTS`] are exempt from giving the same bits on each instruction set.

mod boxes;
mod products;
mod shear;
mod with_normal;

use super::{Kernel, rays};
use crate::geometry::Triangle;
use crate::rays::{Batch, Ray};
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Lanes, MAX_LANES, Portable};
use glam::Vec3;

pub use boxes::{BOX_TESTS, BoxTest};

/// Triangles that are prepared together.
const LEAF: usize = 16;

/// A test of a ray and a triangle.
pub struct TriangleTest {
    /// What it is called.
    pub name: &'static str,
    /// In what it differs from `fast`.
    pub change: &'static str,
    /// Whether [`TriangleTest::nearest`] takes only rays of one origin.
    pub one_origin: bool,
    pairs: fn(Isa, &Pairs) -> Vec<f32>,
    nearest: fn(Isa, &Batch, &[Triangle], &mut [f32]),
}

/// All tests; the first one is `fast`, without its box.
pub const TRIANGLE_TESTS: &[TriangleTest] = &[
    TriangleTest::new::<with_normal::Test<with_normal::Fast>>("fast", "float32, without the box"),
    TriangleTest::new::<with_normal::Test<with_normal::Separate>>(
        "separate products",
        "nothing fused",
    ),
    TriangleTest::new::<with_normal::Test<with_normal::FusedNormal>>(
        "fused normal",
        "a·b − c·d of the normal fused, too",
    ),
    TriangleTest::new::<with_normal::Test<with_normal::Folded>>(
        "folded origin",
        "U, V, N·C from constants of triangle and origin",
    ),
    TriangleTest::new::<with_normal::Test<with_normal::Reciprocal>>(
        "reciprocal",
        "estimate of 1/den and a Newton step",
    ),
    TriangleTest::new::<with_normal::Test<with_normal::EdgeAndQ>>(
        "e2·q / N·d",
        "another numerator of t",
    ),
    TriangleTest::new::<with_normal::MollerTrumbore>(
        "Möller-Trumbore",
        "as printed in 1997: e2·q / det",
    ),
    TriangleTest::new::<shear::Test<products::Separate>>(
        "shear, separate",
        "Woop 2013, edges not fused",
    ),
    TriangleTest::new::<shear::Test<products::Fused>>(
        "shear, fused",
        "Woop 2013, edges plainly fused",
    ),
    TriangleTest::new::<shear::Test<products::Kahan>>(
        "shear, Kahan",
        "Woop 2013, Kahan's a·b − c·d",
    ),
    TriangleTest::new::<shear::Test<products::Float64>>(
        "shear, float64",
        "Woop 2013, edges in float64",
    ),
];

/// The naive step of each precision, on the same copied rays with origins of their own: what the
/// kernels of record take with their boxes, of which the first is that of `fast`.
pub const PRECISIONS: &[Kernel] = &[
    Kernel {
        name: "fast",
        test: "ray/triangle",
        make: rays::copied_triangles::<false>,
    },
    Kernel {
        name: "watertight",
        test: "ray/triangle",
        make: rays::watertight_triangles,
    },
    Kernel {
        name: "exact",
        test: "ray/triangle",
        make: rays::exact_triangles,
    },
];

impl TriangleTest {
    const fn new<T: Test>(name: &'static str, change: &'static str) -> TriangleTest {
        TriangleTest {
            name,
            change,
            one_origin: T::ONE_ORIGIN,
            pairs: of_pairs::<T>,
            nearest: nearest::<T>,
        }
    }

    /// The distance of each pair; infinite for a miss.
    ///
    /// # Panics
    /// If this processor does not have the instruction set.
    pub fn pairs(&self, isa: Isa, pairs: &Pairs) -> Vec<f32> {
        (self.pairs)(isa, pairs)
    }

    /// All rays against all triangles: `t` is tmax before, and the least distance after. A vector of
    /// rays meets 16 triangles, prepared beforehand, before the next one does: the naive step of a
    /// trace.
    ///
    /// # Panics
    /// If this processor does not have the instruction set, the number of rays is no multiple of 16
    /// or not that of `t`, or the origins of the rays differ where they must not.
    pub fn nearest(&self, isa: Isa, rays: &Batch, triangles: &[Triangle], t: &mut [f32]) {
        (self.nearest)(isa, rays, triangles, t);
    }
}

/// Rays, each with a triangle.
pub struct Pairs {
    len: usize,
    /// The last pair is repeated to fill a vector.
    rays: Batch,
    /// By corner and axis.
    corners: [[Vec<f32>; 3]; 3],
}

impl Pairs {
    /// As many as are given.
    pub fn new(pairs: &[(Ray, Triangle)]) -> Pairs {
        let full = pairs.len().next_multiple_of(MAX_LANES);
        let last = pairs.last();
        let all = || pairs.iter().chain(last.into_iter().cycle()).take(full);
        let numbers = |corner: fn(&Triangle) -> Vec3| {
            [0, 1, 2].map(|axis| all().map(|(_, triangle)| corner(triangle)[axis]).collect())
        };
        Pairs {
            len: pairs.len(),
            rays: all().map(|&(ray, _)| ray).collect(),
            corners: [numbers(|t| t.a), numbers(|t| t.b), numbers(|t| t.c)],
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The corners of the triangles from place `i` on.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; `i` is a multiple of `L::N` below the length.
    #[inline(always)]
    unsafe fn corners<L: Lanes>(&self, i: usize) -> [[L::F; 3]; 3] {
        // SAFETY: as promised.
        unsafe {
            [
                load3::<L>(&self.corners[0], i),
                load3::<L>(&self.corners[1], i),
                load3::<L>(&self.corners[2], i),
            ]
        }
    }
}

/// A vector of rays.
#[derive(Clone, Copy)]
struct RayVector<L: Lanes> {
    origin: [L::F; 3],
    direction: [L::F; 3],
    tmin: L::F,
    tmax: L::F,
}

impl<L: Lanes> RayVector<L> {
    /// # Safety
    /// The processor has `L`'s instruction set; there are `L::N` rays from place `i` on.
    #[inline(always)]
    unsafe fn load(rays: &Batch, i: usize) -> RayVector<L> {
        // SAFETY: as promised.
        unsafe {
            RayVector {
                origin: load3::<L>(&rays.origin, i),
                direction: load3::<L>(&rays.direction, i),
                tmin: L::load(rays.tmin.as_ptr().add(i)),
                tmax: L::load(rays.tmax.as_ptr().add(i)),
            }
        }
    }
}

/// # Safety
/// As for [`Lanes::load`].
#[inline(always)]
unsafe fn load3<L: Lanes>(of: &[Vec<f32>; 3], i: usize) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            L::load(of[0].as_ptr().add(i)),
            L::load(of[1].as_ptr().add(i)),
            L::load(of[2].as_ptr().add(i)),
        ]
    }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn splat3<L: Lanes>(v: Vec3) -> [L::F; 3] {
    // SAFETY: as promised.
    unsafe { [L::splat(v.x), L::splat(v.y), L::splat(v.z)] }
}

/// Where rays cross the planes of triangles.
struct Crossing<L: Lanes> {
    /// On the inner side of all edges.
    inside: L::M,
    num: L::F,
    den: L::F,
}

/// A test of vectors of rays and of triangles.
trait Test {
    const ONE_ORIGIN: bool = false;
    /// What is computed of a ray beforehand.
    type Ray<L: Estimate>: Copy;
    /// What is computed of a triangle beforehand.
    type Triangle<L: Estimate>: Copy;

    /// # Safety
    /// The processor has `L`'s instruction set; so for all that follow.
    unsafe fn ray<L: Estimate>(ray: &RayVector<L>) -> Self::Ray<L>;

    /// `origin` is that of the rays, and meaningless without [`Test::ONE_ORIGIN`].
    unsafe fn triangle<L: Estimate>(
        corners: &[[L::F; 3]; 3],
        origin: &[L::F; 3],
    ) -> Self::Triangle<L>;

    unsafe fn crossing<L: Estimate>(
        ray: &Self::Ray<L>,
        triangle: &Self::Triangle<L>,
    ) -> Crossing<L>;

    /// Distance of a crossing.
    #[inline(always)]
    unsafe fn t<L: Estimate>(crossing: &Crossing<L>) -> L::F {
        // SAFETY: as promised.
        unsafe { L::div(crossing.num, crossing.den) }
    }
}

/// Vectors with estimates of reciprocals.
trait Estimate: Lanes {
    /// 1/x by the estimate of the processor, or by a division in portable code.
    ///
    /// # Safety
    /// The processor has the instruction set.
    unsafe fn reciprocal(x: Self::F) -> Self::F;
}

impl Estimate for Portable {
    #[inline(always)]
    unsafe fn reciprocal(x: Self::F) -> Self::F {
        // SAFETY: as promised.
        unsafe { Self::div(Self::splat(1.0), x) }
    }
}

#[cfg(target_arch = "x86_64")]
impl Estimate for Avx2 {
    #[inline(always)]
    unsafe fn reciprocal(x: Self::F) -> Self::F {
        // SAFETY: as promised.
        unsafe { std::arch::x86_64::_mm256_rcp_ps(x) }
    }
}

#[cfg(target_arch = "x86_64")]
impl Estimate for Avx512 {
    #[inline(always)]
    unsafe fn reciprocal(x: Self::F) -> Self::F {
        // SAFETY: as promised.
        unsafe { std::arch::x86_64::_mm512_rcp14_ps(x) }
    }
}

/// Lanes of a crossing that are hits, and where.
///
/// # Safety
/// As for [`Test`].
#[inline(always)]
unsafe fn hits<L: Estimate, T: Test>(
    crossing: &Crossing<L>,
    tmin: L::F,
    tmax: L::F,
) -> (L::M, L::F) {
    // SAFETY: as promised.
    unsafe {
        let t = T::t::<L>(crossing);
        let in_reach = L::and(L::lt(tmin, t), L::le(t, tmax));
        let in_reach = L::and(in_reach, L::lt(t, L::splat(f32::INFINITY)));
        (L::and(crossing.inside, in_reach), t)
    }
}

/// # Safety
/// As for [`Test`]; `t` is as long as the rays of the pairs.
#[inline(always)]
unsafe fn pairs_of<L: Estimate, T: Test>(pairs: &Pairs, t: &mut [f32]) {
    for i in (0..t.len()).step_by(L::N) {
        // SAFETY: as promised; lengths are multiples of that of any vector.
        unsafe {
            let v = RayVector::<L>::load(&pairs.rays, i);
            let triangle = T::triangle::<L>(&pairs.corners::<L>(i), &v.origin);
            let crossing = T::crossing::<L>(&T::ray::<L>(&v), &triangle);
            let (hit, at) = hits::<L, T>(&crossing, v.tmin, v.tmax);
            let at = L::select(hit, at, L::splat(f32::INFINITY));
            L::store(t.as_mut_ptr().add(i), at);
        }
    }
}

/// # Safety
/// As for [`Test`]; as many rays as `t` has room for, a multiple of the longest vector.
#[inline(always)]
unsafe fn nearest_of<L: Estimate, T: Test>(rays: &Batch, triangles: &[Triangle], t: &mut [f32]) {
    let Some(first) = triangles.first() else {
        return;
    };
    let origin = rays.ray(0).origin;
    // SAFETY: as promised.
    unsafe {
        let origin = splat3::<L>(origin);
        let mut leaf = [T::triangle::<L>(&splat9::<L>(first), &origin); LEAF];
        for triangles in triangles.chunks(LEAF) {
            for (prepared, triangle) in leaf.iter_mut().zip(triangles) {
                *prepared = T::triangle::<L>(&splat9::<L>(triangle), &origin);
            }
            for i in (0..t.len()).step_by(L::N) {
                let v = RayVector::<L>::load(rays, i);
                let ray = T::ray::<L>(&v);
                let mut best = L::load(t.as_ptr().add(i));
                for triangle in &leaf[..triangles.len()] {
                    let crossing = T::crossing::<L>(&ray, triangle);
                    if L::bits(crossing.inside) != 0 {
                        let (hit, at) = hits::<L, T>(&crossing, v.tmin, best);
                        best = L::select(hit, at, best);
                    }
                }
                L::store(t.as_mut_ptr().add(i), best);
            }
        }
    }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn splat9<L: Lanes>(triangle: &Triangle) -> [[L::F; 3]; 3] {
    // SAFETY: as promised.
    unsafe {
        [
            splat3::<L>(triangle.a),
            splat3::<L>(triangle.b),
            splat3::<L>(triangle.c),
        ]
    }
}

/// Calls a generic function as an instance of an instruction set.
macro_rules! instance {
    ($isa:expr, $name:ident::<$of:ident>($($arg:expr),*)) => {{
        let isa: Isa = $isa;
        assert!(isa.is_available(), "this processor has no {isa}");
        // SAFETY: the processor was checked; the rest is the caller's promise.
        unsafe {
            match isa {
                #[cfg(target_arch = "x86_64")]
                Isa::Avx512 => $crate::bench::ingredients::avx512::$name::<$of>($($arg),*),
                #[cfg(target_arch = "x86_64")]
                Isa::Avx2 => $crate::bench::ingredients::avx2::$name::<$of>($($arg),*),
                _ => $crate::bench::ingredients::portable::$name::<$of>($($arg),*),
            }
        }
    }};
}

fn of_pairs<T: Test>(isa: Isa, pairs: &Pairs) -> Vec<f32> {
    let mut t = vec![0.0; pairs.rays.len()];
    instance!(isa, pairs_of::<T>(pairs, &mut t));
    t.truncate(pairs.len);
    t
}

fn nearest<T: Test>(isa: Isa, rays: &Batch, triangles: &[Triangle], t: &mut [f32]) {
    assert_whole_vectors(rays, t.len());
    let one_origin = rays.is_empty() || rays.shared_origin().is_some();
    assert!(one_origin || !T::ONE_ORIGIN, "rays of several origins");
    instance!(isa, nearest_of::<T>(rays, triangles, t))
}

fn assert_whole_vectors(rays: &Batch, len: usize) {
    let whole = rays.len() == len && len.is_multiple_of(MAX_LANES);
    assert!(whole, "{} rays and {len} results", rays.len());
}

/// # Safety
/// As for [`pairs_of`] and its like.
macro_rules! instances {
    ($isa:ident, $lanes:ty $(, #[$feature:meta])?) => {
        mod $isa {
            use super::*;

            $(#[$feature])?
            pub(super) unsafe fn pairs_of<T: Test>(pairs: &Pairs, t: &mut [f32]) {
                // SAFETY: as promised; so in all that follow.
                unsafe { super::pairs_of::<$lanes, T>(pairs, t) }
            }

            $(#[$feature])?
            pub(super) unsafe fn nearest_of<T: Test>(
                rays: &Batch,
                triangles: &[Triangle],
                t: &mut [f32],
            ) {
                // SAFETY: as above.
                unsafe { super::nearest_of::<$lanes, T>(rays, triangles, t) }
            }

            $(#[$feature])?
            pub(super) unsafe fn intervals_of<S: boxes::Slab>(pairs: &Pairs, near: &mut [f32], far: &mut [f32]) {
                // SAFETY: as above.
                unsafe { boxes::intervals_of::<$lanes, S>(pairs, near, far) }
            }

            $(#[$feature])?
            pub(super) unsafe fn met_of<S: boxes::Slab>(rays: &Batch, triangles: &[Triangle], met: &mut [f32]) {
                // SAFETY: as above.
                unsafe { boxes::met_of::<$lanes, S>(rays, triangles, met) }
            }
        }
    };
}

instances!(portable, Portable);
#[cfg(target_arch = "x86_64")]
instances!(avx2, Avx2, #[target_feature(enable = "avx2,fma,bmi2,popcnt")]);
#[cfg(target_arch = "x86_64")]
instances!(
    avx512,
    Avx512,
    #[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi2,popcnt")]
);

use instance;
