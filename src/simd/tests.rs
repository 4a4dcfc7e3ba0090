//! Every operation of every instance against its definition, lane by lane.

use super::*;

/// Everything special about float32: signed zeros, denormals, infinities, NaN, the largest numbers.
const VALUES: [f32; 17] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    1.5,
    -3.25,
    1e-45,
    -1e-39,
    f32::MIN_POSITIVE,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    1.0 + f32::EPSILON,
    16_777_217.0,
    -1e-20,
];

const INTEGERS: [u32; 7] = [0, 1, 2, 0x7fff_ffff, 0x8000_0000, 0x8000_0001, u32::MAX];

/// Runs a generic test for every instance that this processor can run.
macro_rules! on_all {
    ($($test:ident),* $(,)?) => {
        $(
            #[test]
            fn $test() {
                // SAFETY: each instance runs only where the processor has it.
                unsafe {
                    of::$test::<Portable>();
                    #[cfg(target_arch = "x86_64")]
                    if Isa::Avx2.is_available() {
                        of::$test::<Avx2>();
                    }
                    #[cfg(target_arch = "x86_64")]
                    if Isa::Avx512.is_available() {
                        of::$test::<Avx512>();
                    }
                }
            }
        )*
    };
}

on_all!(
    arithmetic_is_rounded_once,
    min_and_max_give_the_second_operand_for_nan,
    the_least_of_eight_in_memory,
    signs,
    comparisons_are_false_for_nan,
    comparisons_of_integers_are_unsigned,
    masks_combine_lane_by_lane,
    first_lanes,
    select_takes_lanes_by_the_mask,
    compress_keeps_the_order_for_every_mask,
    loads_and_stores,
    stores_of_the_first_lanes_leave_the_rest,
    gathers,
);

mod of {
    #![allow(clippy::undocumented_unsafe_blocks)] // The processor was checked, arrays are long enough.

    use super::*;
    use std::array::from_fn;

    const GUARD: f32 = 12345.0;

    unsafe fn floats<L: Lanes>(v: L::F) -> Vec<f32> {
        let mut lanes = [GUARD; MAX_LANES];
        unsafe { L::store(lanes.as_mut_ptr(), v) }
        assert!(lanes[L::N..].iter().all(|&x| x == GUARD));
        lanes[..L::N].to_vec()
    }

    unsafe fn integers<L: Lanes>(v: L::U) -> Vec<u32> {
        let mut lanes = [7; MAX_LANES];
        unsafe { L::store_u(lanes.as_mut_ptr(), v) }
        assert!(lanes[L::N..].iter().all(|&x| x == 7));
        lanes[..L::N].to_vec()
    }

    unsafe fn load<L: Lanes>(from: impl Fn(usize) -> f32) -> L::F {
        let lanes: [f32; MAX_LANES] = from_fn(from);
        unsafe { L::load(lanes.as_ptr()) }
    }

    unsafe fn load_u<L: Lanes>(from: impl Fn(usize) -> u32) -> L::U {
        let lanes: [u32; MAX_LANES] = from_fn(from);
        unsafe { L::load_u(lanes.as_ptr()) }
    }

    /// The mask of the bits set.
    unsafe fn mask<L: Lanes>(bits: u32) -> L::M {
        unsafe { L::eq_u(load_u::<L>(|i| bits >> i & 1), L::splat_u(1)) }
    }

    fn lane_bits(n: usize, lane: impl Fn(usize) -> bool) -> u32 {
        (0..n).fold(0, |bits, i| bits | (lane(i) as u32) << i)
    }

    /// The very bits; any NaN is as good as any other where arithmetic makes one.
    fn same(a: f32, b: f32) -> bool {
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
    }

    /// Calls `check(a, b)` with functions of a lane that bring all pairs of values together, each
    /// in every lane.
    fn for_pairs(mut check: impl FnMut(&dyn Fn(usize) -> f32, &dyn Fn(usize) -> f32)) {
        for i in 0..VALUES.len() {
            for j in 0..VALUES.len() {
                check(&|lane| VALUES[(i + lane) % VALUES.len()], &|lane| {
                    VALUES[(j + 3 * lane) % VALUES.len()]
                });
            }
        }
    }

    pub unsafe fn arithmetic_is_rounded_once<L: Lanes>() {
        unsafe {
            for_pairs(|a, b| {
                let (va, vb) = (load::<L>(a), load::<L>(b));
                let (add, sub) = (floats::<L>(L::add(va, vb)), floats::<L>(L::sub(va, vb)));
                let (mul, div) = (floats::<L>(L::mul(va, vb)), floats::<L>(L::div(va, vb)));
                for i in 0..L::N {
                    let (a, b) = (a(i), b(i));
                    assert!(same(add[i], a + b), "{a} + {b} is {}", add[i]);
                    assert!(same(sub[i], a - b), "{a} - {b} is {}", sub[i]);
                    assert!(same(mul[i], a * b), "{a} * {b} is {}", mul[i]);
                    assert!(same(div[i], a / b), "{a} / {b} is {}", div[i]);
                }
                for c in VALUES {
                    let fused = floats::<L>(L::mul_add(va, vb, L::splat(c)));
                    let less = floats::<L>(L::mul_sub(va, vb, L::splat(c)));
                    for i in 0..L::N {
                        let (a, b) = (a(i), b(i));
                        assert!(same(fused[i], a.mul_add(b, c)), "{a} * {b} + {c}");
                        assert!(same(less[i], a.mul_add(b, -c)), "{a} * {b} - {c}");
                    }
                }
            });
        }
    }

    pub unsafe fn min_and_max_give_the_second_operand_for_nan<L: Lanes>() {
        unsafe {
            for_pairs(|a, b| {
                let (va, vb) = (load::<L>(a), load::<L>(b));
                let (min, max) = (floats::<L>(L::min(va, vb)), floats::<L>(L::max(va, vb)));
                for i in 0..L::N {
                    let (a, b) = (a(i), b(i));
                    let less = if a < b { a } else { b };
                    let more = if a > b { a } else { b };
                    assert_eq!(min[i].to_bits(), less.to_bits(), "min({a}, {b})");
                    assert_eq!(max[i].to_bits(), more.to_bits(), "max({a}, {b})");
                }
            });
        }
    }

    pub unsafe fn the_least_of_eight_in_memory<L: Lanes>() {
        #[repr(align(32))]
        struct Aligned([f32; 8]);
        for_pairs(|a, b| {
            let (mut least, other) = (Aligned(from_fn(a)), Aligned(from_fn(b)));
            unsafe { L::min8(&mut least.0, &other.0) }
            for (i, least) in least.0.into_iter().enumerate() {
                let expected = if b(i) < a(i) { b(i) } else { a(i) };
                assert_eq!(least.to_bits(), expected.to_bits(), "{} {}", a(i), b(i));
            }
        });
    }

    pub unsafe fn signs<L: Lanes>() {
        unsafe {
            for_pairs(|a, s| {
                let flipped = floats::<L>(L::flip_sign(load::<L>(a), load::<L>(s)));
                let abs = floats::<L>(L::abs(load::<L>(a)));
                let bits = integers::<L>(L::to_bits(load::<L>(a)));
                let back = floats::<L>(L::from_bits(L::to_bits(load::<L>(a))));
                let roots = floats::<L>(L::sqrt(load::<L>(a)));
                for i in 0..L::N {
                    let expected = if s(i).is_sign_negative() { -a(i) } else { a(i) };
                    assert_eq!(
                        flipped[i].to_bits(),
                        expected.to_bits(),
                        "{} {}",
                        a(i),
                        s(i)
                    );
                    assert_eq!(abs[i].to_bits(), a(i).to_bits() & 0x7fff_ffff);
                    assert_eq!(bits[i], a(i).to_bits());
                    assert_eq!(back[i].to_bits(), a(i).to_bits());
                    assert!(same(roots[i], a(i).sqrt()));
                }
            });
        }
    }

    pub unsafe fn comparisons_are_false_for_nan<L: Lanes>() {
        unsafe {
            for_pairs(|a, b| {
                let (va, vb) = (load::<L>(a), load::<L>(b));
                let n = L::N;
                assert_eq!(L::bits(L::lt(va, vb)), lane_bits(n, |i| a(i) < b(i)));
                assert_eq!(L::bits(L::le(va, vb)), lane_bits(n, |i| a(i) <= b(i)));
                assert_eq!(L::bits(L::eq(va, vb)), lane_bits(n, |i| a(i) == b(i)));
                assert_eq!(L::bits(L::is_nan(va)), lane_bits(n, |i| a(i).is_nan()));
            });
        }
    }

    pub unsafe fn comparisons_of_integers_are_unsigned<L: Lanes>() {
        unsafe {
            for (i, &a) in INTEGERS.iter().enumerate() {
                let b = |lane| INTEGERS[(i + lane) % INTEGERS.len()];
                let (va, vb) = (L::splat_u(a), load_u::<L>(b));
                assert_eq!(L::bits(L::lt_u(va, vb)), lane_bits(L::N, |i| a < b(i)));
                assert_eq!(L::bits(L::eq_u(va, vb)), lane_bits(L::N, |i| a == b(i)));
                let counted: Vec<u32> = (0..L::N as u32).map(|i| a.wrapping_add(i)).collect();
                assert_eq!(integers::<L>(L::count_from(a)), counted);
                assert_eq!(integers::<L>(va), vec![a; L::N]);
                let common = L::bits(L::common_bits(va, vb));
                assert_eq!(common, lane_bits(L::N, |i| a & b(i) != 0));
            }
        }
    }

    pub unsafe fn masks_combine_lane_by_lane<L: Lanes>() {
        unsafe {
            let all = (1u32 << L::N) - 1;
            for a in [0, 1, 0b1010, 0b0110, 0x5a5a & all, all] {
                assert_eq!(L::bits(mask::<L>(a)), a);
                for b in [0, 0b1000, 0b0011, 0x33cc & all, all] {
                    let (va, vb) = (mask::<L>(a), mask::<L>(b));
                    assert_eq!(L::bits(L::and(va, vb)), a & b);
                    assert_eq!(L::bits(L::or(va, vb)), a | b);
                    assert_eq!(L::bits(L::and_not(va, vb)), a & !b);
                }
            }
        }
    }

    pub unsafe fn first_lanes<L: Lanes>() {
        unsafe {
            for n in (0..40).chain([1 << 31, (1 << 32) + 1, usize::MAX]) {
                let lanes = n.min(L::N) as u32;
                assert_eq!(L::bits(L::first(n)), (1u32 << lanes) - 1, "{n}");
            }
        }
    }

    pub unsafe fn select_takes_lanes_by_the_mask<L: Lanes>() {
        unsafe {
            for bits in (0..1u32 << L::N).step_by(7) {
                let m = mask::<L>(bits);
                let (yes, no) = (load::<L>(|i| i as f32), L::splat(f32::NAN));
                let (yes_u, no_u) = (L::count_from(100), L::splat_u(5));
                let picked = floats::<L>(L::select(m, yes, no));
                let picked_u = integers::<L>(L::select_u(m, yes_u, no_u));
                for i in 0..L::N {
                    let set = bits >> i & 1 == 1;
                    assert!(same(picked[i], if set { i as f32 } else { f32::NAN }));
                    assert_eq!(picked_u[i], if set { 100 + i as u32 } else { 5 });
                }
            }
        }
    }

    pub unsafe fn compress_keeps_the_order_for_every_mask<L: Lanes>() {
        unsafe {
            let (v, u) = (load::<L>(|i| VALUES[i]), L::count_from(0xffff_fff8));
            let (all, all_u) = (floats::<L>(v), integers::<L>(u));
            for bits in 0..1u32 << L::N {
                let m = mask::<L>(bits);
                let (f, g) = (
                    floats::<L>(L::compress(m, v)),
                    integers::<L>(L::compress_u(m, u)),
                );
                let kept = (0..L::N).filter(|i| bits >> i & 1 == 1);
                // The rest is unspecified, but never a new number.
                assert!(g.iter().all(|x| *x == 0 || all_u.contains(x)), "{bits:b}");
                for (place, lane) in kept.enumerate() {
                    assert_eq!(f[place].to_bits(), all[lane].to_bits(), "{bits:b}");
                    assert_eq!(g[place], all_u[lane], "{bits:b}");
                }
            }
        }
    }

    pub unsafe fn loads_and_stores<L: Lanes>() {
        let values: [f32; 2 * MAX_LANES] = from_fn(|i| VALUES[i % VALUES.len()]);
        unsafe {
            for at in 0..MAX_LANES {
                let lanes = floats::<L>(L::load(values.as_ptr().add(at)));
                let bits = |v: &[f32]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&lanes), bits(&values[at..at + L::N]));
            }
            let streams = [0, 1, 2].map(|i| values.as_ptr().cast_mut().add(i));
            for (axis, v) in load3::<L>(&streams, 2).into_iter().enumerate() {
                let v = floats::<L>(v);
                assert!((0..L::N).all(|i| same(v[i], values[axis + 2 + i])));
            }
            for (axis, v) in splat3::<L>(&[1.0, 2.0, 3.0]).into_iter().enumerate() {
                assert_eq!(floats::<L>(v), vec![axis as f32 + 1.0; L::N]);
            }
        }
    }

    pub unsafe fn stores_of_the_first_lanes_leave_the_rest<L: Lanes>() {
        unsafe {
            for n in 0..=L::N + 1 {
                let mut f = [GUARD; MAX_LANES];
                let mut u = [9; MAX_LANES];
                L::store_first(f.as_mut_ptr(), load::<L>(|i| i as f32), n);
                L::store_first_u(u.as_mut_ptr(), L::count_from(20), n);
                for i in 0..MAX_LANES {
                    let stored = i < n.min(L::N);
                    assert_eq!(f[i], if stored { i as f32 } else { GUARD });
                    assert_eq!(u[i], if stored { 20 + i as u32 } else { 9 });
                }
            }
        }
    }

    pub unsafe fn gathers<L: Lanes>() {
        let base: [f32; 100] = from_fn(|i| i as f32 + 0.5);
        let base_u: [u32; 100] = from_fn(|i| i as u32 | 0x8000_0000);
        let records: [[f32; 4]; 100] = from_fn(|i| from_fn(|k| (4 * i + k) as f32));
        let at = |i: usize| (i * 37 + 99) as u32 % 100;
        unsafe {
            for bits in [0, 1, 0b1001, 0xa5a5 & ((1 << L::N) - 1), (1 << L::N) - 1] {
                // Lanes that are not set must not be read at all.
                let far = |i: usize| {
                    if bits >> i & 1 == 1 {
                        at(i)
                    } else {
                        0x7fff_ffff
                    }
                };
                let (index, m) = (load_u::<L>(far), mask::<L>(bits));
                let f = floats::<L>(L::gather(base.as_ptr(), index, m));
                let u = integers::<L>(L::gather_u(base_u.as_ptr(), index, m));
                for i in 0..L::N {
                    let set = bits >> i & 1 == 1;
                    assert_eq!(f[i], if set { base[at(i) as usize] } else { 0.0 });
                    assert_eq!(u[i], if set { base_u[at(i) as usize] } else { 0 });
                }
            }
            let index: [u32; MAX_LANES] = from_fn(at);
            let quads = L::gather4::<1>(records.as_ptr(), index.as_ptr());
            for (k, v) in quads.into_iter().enumerate() {
                let expected: Vec<f32> = (0..L::N).map(|i| records[at(i) as usize][k]).collect();
                assert_eq!(floats::<L>(v), expected);
            }
            let half = index.map(|i| i / 2);
            let other = L::gather4::<2>(records.as_ptr(), half.as_ptr());
            for (k, v) in other.into_iter().enumerate() {
                let expected: Vec<f32> = (0..L::N)
                    .map(|i| records[2 * half[i] as usize][k])
                    .collect();
                assert_eq!(floats::<L>(v), expected);
            }
            let pairs: Vec<[f32; 2]> = records.iter().map(|r| [r[1], r[3]]).collect();
            let gathered = L::gather2(pairs.as_ptr(), index.as_ptr());
            for (k, v) in gathered.into_iter().enumerate() {
                let expected: Vec<f32> = (0..L::N).map(|i| pairs[at(i) as usize][k]).collect();
                assert_eq!(floats::<L>(v), expected);
            }
            let mut stored = [[GUARD; 4]; MAX_LANES + 1];
            L::store4(stored.as_mut_ptr(), quads);
            for (i, record) in stored.iter().enumerate() {
                let expected = match i < L::N {
                    true => records[at(i) as usize],
                    false => [GUARD; 4],
                };
                assert_eq!(*record, expected);
            }
        }
    }
}
