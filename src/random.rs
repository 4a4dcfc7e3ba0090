//! Counter-based random numbers: a number is a function of a seed, a key and an index, so any of
//! them can be had in any order, on any machine and thread, and there is no state to carry along.

/// The odd integer nearest to 2⁶⁴ divided by the golden ratio: the increment of SplitMix64.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014, in Stafford's variant 13): a bijection in
/// which every input bit changes every output bit with a probability near one half.
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// 64 random bits. For a fixed seed and key, the numbers at index 0, 1, 2 … are the SplitMix64
/// sequence that starts at a hash of seed and key; different indices never give the same number.
///
/// `seed` is the user's, `key` says what the number is for (a node of the traversal, a kind of
/// ray), `index` counts within that.
#[inline]
pub const fn hash(seed: u64, key: u64, index: u64) -> u64 {
    let stream = mix(mix(seed.wrapping_add(GOLDEN)) ^ key);
    mix(stream.wrapping_add(index.wrapping_add(1).wrapping_mul(GOLDEN)))
}

/// A number in `[0, 1)` from the upper 53 of 64 random bits: all multiples of 2⁻⁵³ are equally likely.
#[inline]
pub const fn unit_f64(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

/// An integer in `0..n` from 64 random bits, by the upper half of a product (Lemire 2019, without
/// the rejection: the bias is below `n` · 2⁻³²). 0 for `n = 0`.
#[inline]
pub const fn below(bits: u64, n: u32) -> u32 {
    (((bits >> 32) * n as u64) >> 32) as u32
}

/// Numbers in [0, 1), one after the other.
#[cfg(test)]
pub fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut i = 0;
    move || {
        i += 1;
        unit_f64(hash(seed, 0, i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_numbers_are_fixed() {
        // SplitMix64 from the state 0 starts with this number (Vigna's reference code).
        assert_eq!(mix(GOLDEN), 0xe220_a839_7b1d_cdaf);
        assert_eq!(hash(0, 0, 0), 0x568a_9b0b_1a2c_05ec);
        assert_eq!(hash(1, 2, 3), hash(1, 2, 3));
    }

    #[test]
    fn seed_key_and_index_all_count() {
        let numbers: std::collections::HashSet<u64> = (0..10)
            .flat_map(|s| (0..10).flat_map(move |k| (0..10).map(move |i| hash(s, k, i))))
            .collect();
        assert_eq!(numbers.len(), 1000);
    }

    #[test]
    fn units_stay_below_one_and_reach_both_ends() {
        assert_eq!(unit_f64(0), 0.0);
        assert_eq!(unit_f64(u64::MAX), 1.0 - f64::EPSILON / 2.0);
    }

    #[test]
    fn each_bit_is_set_about_half_the_time() {
        let n = 10_000;
        let mut ones = [0u32; 64];
        for i in 0..n {
            let bits = hash(42, 7, i);
            for (b, count) in ones.iter_mut().enumerate() {
                *count += (bits >> b) as u32 & 1;
            }
        }
        // Five standard deviations of 50.
        assert!(ones.iter().all(|&c| c.abs_diff(5000) < 250), "{ones:?}");
    }

    #[test]
    fn below_is_even() {
        let mut counts = [0u32; 31];
        for i in 0..31_000 {
            counts[below(hash(3, 1, i), 31) as usize] += 1;
        }
        assert!(counts.iter().all(|&c| c.abs_diff(1000) < 160), "{counts:?}");
        assert_eq!(below(u64::MAX, 0), 0);
    }
}
