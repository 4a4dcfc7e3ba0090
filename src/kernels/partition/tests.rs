//! Lists of every length, and everything around them.

use super::*;
use crate::random::hash;
use crate::simd::{Isa, Portable};

/// Indices whose hash has no bit in common with the mask.
struct Some {
    mask: u64,
    tested: usize,
}

impl<L: Lanes> Test<L> for Some {
    #[inline(always)]
    unsafe fn pass(&mut self, ids: *const u32, active: L::M) -> L::M {
        let mut lanes = [0u32; MAX_LANES];
        for (lane, x) in lanes.iter_mut().enumerate().take(L::N) {
            // SAFETY: as promised.
            let id = unsafe { *ids.add(lane) };
            assert!(id < 1000, "{id} is no index");
            *x = (hash(1, id as u64, 0) & self.mask == 0) as u32;
        }
        // SAFETY: as promised.
        unsafe {
            self.tested += L::bits(active).count_ones() as usize;
            L::and(active, L::eq_u(L::load_u(lanes.as_ptr()), L::splat_u(1)))
        }
    }
}

/// The list after the partition, from a list of `len` indices with others around it.
unsafe fn partitioned<L: Lanes>(len: usize, mask: u64) -> Vec<u32> {
    let before = 5;
    let mut ids: Vec<u32> = (0..(before + len + 40) as u32).collect();
    let original = ids.clone();
    let mut test = Some { mask, tested: 0 };
    // SAFETY: the caller has checked the processor; there are indices behind the list.
    let n = unsafe { partition::<L, _>(ids.as_mut_ptr().add(before), len, &mut test) };
    assert_eq!(test.tested, len);
    let passes = |&id: &u32| hash(1, id as u64, 0) & mask == 0;
    let list = &ids[before..before + len];
    assert!(list[..n].iter().all(passes) && !list[n..].iter().any(passes));
    let mut sorted = list.to_vec();
    sorted.sort();
    assert_eq!(sorted, original[before..before + len]);
    assert_eq!(ids[..before], original[..before]);
    assert_eq!(ids[before + len..], original[before + len..]);
    ids
}

#[test]
fn lists_of_every_length_in_the_same_order_on_every_instruction_set() {
    let stride = if cfg!(miri) { 23 } else { 1 };
    for len in (0..140).step_by(stride).chain([255, 256, 257, 600]) {
        // All pass, half, a quarter, few, none.
        for mask in [0, 1, 3, 0x3f, u64::MAX] {
            // SAFETY: each instance runs only where the processor has it.
            unsafe {
                let expected = partitioned::<Portable>(len, mask);
                #[cfg(target_arch = "x86_64")]
                if Isa::Avx2.is_available() {
                    assert_eq!(partitioned::<crate::simd::Avx2>(len, mask), expected);
                }
                #[cfg(target_arch = "x86_64")]
                if Isa::Avx512.is_available() {
                    assert_eq!(partitioned::<crate::simd::Avx512>(len, mask), expected);
                }
            }
        }
    }
}
