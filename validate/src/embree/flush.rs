//! Nearest hits with denormal numbers taken for zero, as Embree's manual recommends.

use super::Scene;
use super::trace::{fill, record};
use dacrt::{Batch, Hits, Ray};
use embree4_sys as sys;

/// Flush to zero, and denormals are zero.
#[cfg(target_arch = "x86_64")]
const FTZ_DAZ: u32 = 1 << 15 | 1 << 6;

/// Sets both bits in this thread's MXCSR for as long as it lives.
///
/// Rust code must not compute with floats meanwhile: its results would be others.
#[cfg(target_arch = "x86_64")]
struct Flushing(u32);

#[cfg(target_arch = "x86_64")]
impl Flushing {
    fn new() -> Flushing {
        let mut before = 0_u32;
        // SAFETY: stores four bytes to `before` and changes nothing else.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut before, options(nostack, preserves_flags));
        }
        load(before | FTZ_DAZ);
        Flushing(before)
    }
}

#[cfg(target_arch = "x86_64")]
impl Drop for Flushing {
    fn drop(&mut self) {
        load(self.0);
    }
}

#[cfg(target_arch = "x86_64")]
fn load(mxcsr: u32) {
    // SAFETY: reads four bytes. The value is one that the register had, with or without two bits
    // that every x86-64 processor has.
    unsafe {
        std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const mxcsr, options(nostack, preserves_flags));
    }
}

impl Scene {
    /// The hits of [`Scene::nearest`] by `rtcIntersect1` with flush-to-zero and denormals-are-zero
    /// set around each call, and restored; and the control bits of MXCSR that the calls ran with.
    /// Embree sets both itself while it builds. `None` where there is no such register.
    ///
    /// # Panics
    /// If there are not as many hits as rays.
    pub fn nearest_flushing(&self, batch: &Batch, hits: &mut Hits) -> Option<u32> {
        assert_eq!(hits.len(), batch.len(), "one hit record a ray");
        #[cfg(target_arch = "x86_64")]
        {
            let mut args = sys::RTCIntersectArguments::new(sys::RTCRayQueryFlags::INCOHERENT);
            let mut mxcsr = super::mxcsr();
            let mut rayhit = sys::RTCRayHit::default();
            for (i, ray) in batch.iter().enumerate() {
                (hits.t[i], hits.prim[i]) = (f32::INFINITY, dacrt::MISS);
                // Under these bits a denormal direction would be a zero one, so this comes before.
                if !Ray::is_valid(&ray) {
                    continue;
                }
                fill(&mut rayhit.ray, &ray, self.robust());
                // In robust mode the end is inclusive, and zero is the next float below the least
                // normal one.
                if self.robust() {
                    rayhit.ray.tnear = rayhit.ray.tnear.max(f32::MIN_POSITIVE);
                }
                rayhit.hit.geomID = sys::RTC_INVALID_GEOMETRY_ID;
                {
                    let _flushing = Flushing::new();
                    mxcsr = super::mxcsr();
                    // SAFETY: the scene is committed; the structures are alive and large enough.
                    unsafe { sys::rtcIntersect1(self.handle(), &mut rayhit, &mut args) };
                }
                let (hit, t) = (rayhit.hit, rayhit.ray.tfar);
                (hits.t[i], hits.prim[i]) = record(hit.geomID, hit.primID, t);
            }
            mxcsr
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            self.nearest(batch, super::Query::Single, hits);
            None
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use std::hint::black_box;

    #[test]
    fn the_register_is_as_before_and_differs_meanwhile() {
        let half = || black_box(f32::MIN_POSITIVE) * black_box(0.5);
        let before = super::super::mxcsr();
        assert!(half() > 0.0);
        let meanwhile = {
            let _flushing = Flushing::new();
            (super::super::mxcsr(), half().to_bits())
        };
        assert_eq!(meanwhile.0, before.map(|bits| bits | FTZ_DAZ));
        assert_eq!(meanwhile.1, 0, "a denormal product is flushed");
        assert_eq!(super::super::mxcsr(), before);
        assert!(half() > 0.0);
    }
}
