//! The last pass on every instruction set.

use super::{FAMILIES, pair};
use crate::exact::Meeting;
use crate::kernels::Kernels;
use crate::simd::Isa;
use crate::{Batch, MISS, Ray};

#[test]
fn each_t_is_that_of_its_meeting_and_misses_stay() {
    for isa in Isa::available() {
        for family in 0..FAMILIES {
            for n in (0..40).chain([500]) {
                let pairs: Vec<_> = (0..n).map(|i| pair(family, i)).collect();
                let batch: Batch = pairs
                    .iter()
                    .map(|p| Ray::new(p.origin, p.direction))
                    .collect();
                let triangles: Vec<_> = pairs.iter().map(|p| p.triangle).collect();
                let is_hit = |i: u64| {
                    let pair = &pairs[i as usize];
                    !i.is_multiple_of(3) && super::oracle::plane(pair).is_some()
                };
                let prim: Vec<u32> = (0..n)
                    .map(|i| if is_hit(i) { i as u32 } else { MISS })
                    .collect();
                let mut t = vec![-7.0; n as usize];
                // SAFETY: the processor was checked.
                unsafe { (Kernels::of(isa).round_hits)(&batch, 0, &triangles, &prim, &mut t) };
                for (i, p) in pairs.iter().enumerate() {
                    let expected = match prim[i] {
                        MISS => -7.0,
                        _ => Meeting::known(p.origin, p.direction, &p.triangle)
                            .exact()
                            .rounded(),
                    };
                    assert_eq!(t[i].to_bits(), expected.to_bits(), "{isa} {family} {i}");
                }
            }
        }
    }
}
