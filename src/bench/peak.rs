//! How many multiply-adds the processor can do.

#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Isa, Lanes, MAX_LANES, Portable};
use std::hint::black_box;

/// Sums that do not wait for each other: more than latency times units of today's processors, and
/// no more than registers.
const CHAINS: usize = 12;

/// Does `rounds` rounds of independent fused multiply-adds of whole vectors in registers, and returns
/// how many float32 multiply-adds that was: the most that a kernel could do in the same time.
/// Portable code calls a function for each.
///
/// # Panics
/// If this processor does not have the instruction set.
pub fn multiply_adds(isa: Isa, rounds: u64) -> u64 {
    assert!(isa.is_available(), "this processor has no {isa}");
    let factor = black_box(0.5);
    // SAFETY: the processor was checked.
    let (sum, lanes) = unsafe {
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => (avx512(rounds, factor), Avx512::N),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => (avx2(rounds, factor), Avx2::N),
            _ => (chains::<Portable>(rounds, factor), Portable::N),
        }
    };
    black_box(sum);
    rounds * (CHAINS * lanes) as u64
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi2,popcnt")]
unsafe fn avx512(rounds: u64, factor: f32) -> f32 {
    // SAFETY: the caller's promise.
    unsafe { chains::<Avx512>(rounds, factor) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi2,popcnt")]
unsafe fn avx2(rounds: u64, factor: f32) -> f32 {
    // SAFETY: the caller's promise.
    unsafe { chains::<Avx2>(rounds, factor) }
}

/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
unsafe fn chains<L: Lanes>(rounds: u64, factor: f32) -> f32 {
    // SAFETY: as promised.
    unsafe {
        let (x, y) = (L::splat(factor), L::splat(1.0));
        let mut sums = [y; CHAINS];
        for _ in 0..rounds {
            for sum in &mut sums {
                *sum = L::mul_add(*sum, x, y);
            }
        }
        let mut total = y;
        for sum in sums {
            total = L::add(total, sum);
        }
        let mut lanes = [0f32; MAX_LANES];
        L::store(lanes.as_mut_ptr(), total);
        lanes.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiply_adds_are_counted_by_lane() {
        for isa in Isa::available() {
            let lanes = match isa {
                Isa::Avx512 => 16,
                Isa::Avx2 => 8,
                Isa::Portable => 4,
            };
            assert_eq!(multiply_adds(isa, 10), 10 * 12 * lanes, "{isa}");
        }
    }
}
