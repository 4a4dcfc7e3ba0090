//! The contract "one function of ray and triangle", as far as it rests on the slab test: what an
//! inner box passes every enclosing box passes, and a hit lies in the slabs of its triangle.

use super::*;
use crate::geometry::{Mesh, Triangle};
use crate::methods::{Method, Precision, Tracer};
use crate::rays::{Batch, Hits, MISS, Ray};
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, MAX_LANES, Portable};
use proptest::prelude::*;

/// One ray in the form that the kernels have it.
#[derive(Clone, Copy, Debug)]
struct Slim {
    origin: Vec3,
    direction: Vec3,
    tmin: f32,
    /// Whether it moves on an axis where 1/d is infinite, but d not zero.
    creeps: bool,
}

impl Slim {
    fn inverse(&self) -> [f32; 3] {
        let inverse = |x: f32| {
            let inverse = 1.0 / x;
            if inverse.is_finite() {
                inverse
            } else if self.creeps && x != 0.0 {
                CREEPING
            } else {
                f32::NAN
            }
        };
        self.direction.to_array().map(inverse)
    }

    fn is_special(&self) -> bool {
        self.inverse().iter().any(|x| x.is_nan())
    }
}

/// The interval of one ray on one instance, by way of own and of shared origins; all lanes agree.
///
/// # Safety
/// The processor has `L`'s instruction set.
unsafe fn interval_on<L: Lanes>(ray: &Slim, b: &Aabb) -> (f32, f32) {
    // SAFETY: as promised; the arrays have room for a whole vector.
    unsafe {
        let (inverse, origin) = (
            ray.inverse().map(|x| L::splat(x)),
            ray.origin.to_array().map(|x| L::splat(x)),
        );
        let tmin = L::splat(ray.tmin);
        let own = SlabBox::<L>::new(b, None);
        let shared = SlabBox::<L>::new(b, Some(ray.origin));
        let mut intervals = vec![
            own.interval::<false, true>(&inverse, &origin, tmin),
            shared.interval::<true, true>(&inverse, &origin, tmin),
        ];
        if !ray.is_special() {
            intervals.push(own.interval::<false, false>(&inverse, &origin, tmin));
            intervals.push(shared.interval::<true, false>(&inverse, &origin, tmin));
        }
        let mut found = None;
        for (near, far) in intervals {
            let mut lanes = [[0f32; MAX_LANES]; 2];
            L::store(lanes[0].as_mut_ptr(), near);
            L::store(lanes[1].as_mut_ptr(), far);
            for (near, far) in lanes[0].into_iter().zip(lanes[1]).take(L::N) {
                // Where something is special, near does not overflow.
                let interval = (near.min(f32::MAX * SHRINK), far);
                assert_eq!(interval, *found.get_or_insert(interval), "{ray:?} {b:?}");
            }
        }
        found.unwrap()
    }
}

/// The interval, the same on all instances.
fn interval(ray: &Slim, b: &Aabb) -> (f32, f32) {
    // SAFETY: each instance runs only where the processor has it.
    unsafe {
        let found = interval_on::<Portable>(ray, b);
        #[cfg(target_arch = "x86_64")]
        if Isa::Avx2.is_available() {
            assert_eq!(interval_on::<Avx2>(ray, b), found);
        }
        #[cfg(target_arch = "x86_64")]
        if Isa::Avx512.is_available() {
            assert_eq!(interval_on::<Avx512>(ray, b), found);
        }
        found
    }
}

fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        3 => -2f32..2.0,
        2 => (-4i8..=4).prop_map(|x| x as f32 / 2.0),
        1 => Just(-0.0),
        1 => -1e18f32..1e18,
        1 => -1e-38f32..1e-38,
        1 => -1e6f32..1e6,
    ]
}

fn point() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from)
}

fn ray() -> impl Strategy<Value = Slim> {
    let tmin = prop_oneof![Just(0.0), Just(-0.0), 0f32..2.0, Just(1e30)];
    (point(), point(), tmin, any::<bool>())
        .prop_filter("a direction", |(_, direction, ..)| *direction != Vec3::ZERO)
        .prop_map(|(origin, direction, tmin, creeps)| Slim {
            origin,
            direction,
            tmin,
            creeps,
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5000))]

    #[test]
    fn an_enclosing_box_has_an_enclosing_interval(
        ray in ray(),
        [a, b, c, d] in [point(), point(), point(), point()],
    ) {
        let inner = Aabb { min: a.min(b), max: a.max(b) };
        let outer = inner.with_point(c).with_point(d);
        let (near, far) = interval(&ray, &inner);
        let (outer_near, outer_far) = interval(&ray, &outer);
        prop_assert!(![near, far, outer_near, outer_far].iter().any(|x| x.is_nan()));
        // Where the inner one is empty nothing passes, so there is nothing to enclose.
        if near <= far {
            prop_assert!(outer_near <= near && far <= outer_far);
        }
        // A greater tmin, as a ray of its own has it, moves the near end only up.
        let later = Slim { tmin: 2.0 * ray.tmin + 0.5, ..ray };
        prop_assert!(near <= interval(&later, &inner).0);
    }

    #[test]
    fn a_hit_lies_in_the_slabs_of_its_triangle(
        origin in point(),
        corners in [point(), point(), point()],
        weights in [0f32..1.0, 0f32..1.0],
        tmin in 0f32..0.5,
        offset in point(),
    ) {
        let [a, b, c] = corners;
        let target = a + weights[0] * (b - a) + weights[1] * (1.0 - weights[0]) * (c - a);
        let ray = Slim { origin, direction: target - origin, tmin, creeps: false };
        prop_assume!(ray.direction != Vec3::ZERO && ray.direction.is_finite());
        let triangle = Triangle::new(a, b, c);
        let mesh = Mesh::new(vec![triangle]);
        let batch: Batch = [Ray { origin, direction: ray.direction, tmin, tmax: f32::INFINITY }]
            .into_iter()
            .collect();
        for (precision, own) in Precision::ALL.into_iter().flat_map(|p| [(p, false), (p, true)]) {
            let tracer = Tracer::new(Method::Afra2012.parameters())
                .with_precision(precision)
                .with_own_origins(own);
            let mut hits = Hits::misses(1);
            tracer.nearest(&mesh, &batch, &mut tracer.workspace(1, 1), &mut hits);
            if hits.prim[0] != MISS {
                let ray = Slim { creeps: precision != Precision::Fast, ..ray };
                let t = hits.t[0];
                prop_assert!(tmin < t && t < f32::INFINITY);
                let own = triangle.bounds();
                for b in [own, own.with_point(offset), own.with_point(origin)] {
                    let (near, far) = interval(&ray, &b);
                    prop_assert!(near <= t && t <= far, "{precision}: {near} {t} {far} {b:?}");
                    // As nodes are tested: with the least tmin of the batch.
                    let (near, far) = interval(&Slim { tmin: 0.0, ..ray }, &b);
                    prop_assert!(near <= t && t <= far);
                }
            }
        }
    }
}

#[test]
fn an_axis_of_no_direction_is_unbounded_between_the_planes_and_empty_outside() {
    let b = Aabb {
        min: Vec3::new(1.0, -1.0, -1.0),
        max: Vec3::new(2.0, 1.0, 1.0),
    };
    for zero in [0.0, -0.0, 1e-39, -1e-39] {
        for (y, inside) in [
            (0.0, true),
            (1.0, true),
            (-1.0, true),
            (1f32.next_up(), false),
            ((-1f32).next_down(), false),
            (5.0, false),
        ] {
            let ray = Slim {
                origin: Vec3::new(0.0, y, 0.0),
                direction: Vec3::new(1.0, zero, zero),
                tmin: 0.0,
                creeps: false,
            };
            let (near, far) = interval(&ray, &b);
            assert_eq!(near <= far, inside, "{zero} {y}");
            // A ray that creeps may come in from anywhere.
            let creeping = Slim {
                creeps: true,
                ..ray
            };
            let (near, far) = interval(&creeping, &b);
            assert_eq!(near <= far, inside || zero != 0.0, "{zero} {y}");
            if inside {
                assert_eq!((near, far), (1.0 * SHRINK, 2.0 * GROW));
            }
        }
    }
}

#[test]
fn the_padding_is_at_least_that_of_the_contract() {
    const { assert!(PADDING >= 16.0 / (1 << 24) as f32) }
    assert_eq!(
        (1.0 - SHRINK, GROW - 1.0),
        (PADDING, PADDING),
        "both are exact"
    );
}

/// It was 2⁻¹⁴⁰ once: on Intel's processors each vector of rays took 160 clocks longer.
#[test]
fn what_intervals_are_widened_by_is_not_denormal() {
    assert!(super::UNDERFLOW.is_normal());
}
