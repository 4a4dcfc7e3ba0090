//! Rays and hits, single and 4, 8 or 16 wide.

use super::RTC_INVALID_GEOMETRY_ID;
use std::mem::offset_of;

/// A single ray. `tfar` becomes the distance of the nearest hit, or `-inf` if a query for any hit
/// finds one.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub struct RTCRay {
    pub org_x: f32,
    pub org_y: f32,
    pub org_z: f32,
    pub tnear: f32,
    pub dir_x: f32,
    pub dir_y: f32,
    pub dir_z: f32,
    pub time: f32,
    pub tfar: f32,
    pub mask: u32,
    pub id: u32,
    pub flags: u32,
}

impl Default for RTCRay {
    /// All zero, with an infinite `tfar` and all bits of `mask` set.
    fn default() -> Self {
        RTCRay {
            org_x: 0.0,
            org_y: 0.0,
            org_z: 0.0,
            tnear: 0.0,
            dir_x: 0.0,
            dir_y: 0.0,
            dir_z: 0.0,
            time: 0.0,
            tfar: f32::INFINITY,
            mask: u32::MAX,
            id: 0,
            flags: 0,
        }
    }
}

/// What a single ray hits, as far as Embree 4.0 knew it. Never hand one of these alone to Embree:
/// see [`RTCRayHit`].
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub struct RTCHit {
    pub Ng_x: f32,
    pub Ng_y: f32,
    pub Ng_z: f32,
    pub u: f32,
    pub v: f32,
    pub primID: u32,
    pub geomID: u32,
    pub instID: [u32; 1],
}

impl Default for RTCHit {
    /// No hit.
    fn default() -> Self {
        RTCHit {
            Ng_x: 0.0,
            Ng_y: 0.0,
            Ng_z: 0.0,
            u: 0.0,
            v: 0.0,
            primID: RTC_INVALID_GEOMETRY_ID,
            geomID: RTC_INVALID_GEOMETRY_ID,
            instID: [RTC_INVALID_GEOMETRY_ID],
        }
    }
}

/// A single ray and what it hits.
///
/// From Embree 4.3 on the library writes `instPrimID` behind the declared fields. `embree4-rs`
/// names the fields of both parts in literals, so no field can be added; the alignment of 32 makes
/// the size 96 bytes, the same as in C from 4.3 on, and the padding takes that word.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, Default)]
#[allow(missing_docs)]
pub struct RTCRayHit {
    pub ray: RTCRay,
    pub hit: RTCHit,
}

const _: () = assert!(size_of::<RTCRay>() == 48);
const _: () = assert!(size_of::<RTCHit>() == 32);
const _: () = assert!(size_of::<RTCRayHit>() == 96);

/// `RTCRay4`, `RTCRay8` or `RTCRay16`, as N says; see [`RTCRay`].
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub struct RTCRays<const N: usize> {
    pub org_x: [f32; N],
    pub org_y: [f32; N],
    pub org_z: [f32; N],
    pub tnear: [f32; N],
    pub dir_x: [f32; N],
    pub dir_y: [f32; N],
    pub dir_z: [f32; N],
    pub time: [f32; N],
    pub tfar: [f32; N],
    pub mask: [u32; N],
    pub id: [u32; N],
    pub flags: [u32; N],
}

impl<const N: usize> Default for RTCRays<N> {
    /// N times [`RTCRay::default`].
    fn default() -> Self {
        RTCRays {
            org_x: [0.0; N],
            org_y: [0.0; N],
            org_z: [0.0; N],
            tnear: [0.0; N],
            dir_x: [0.0; N],
            dir_y: [0.0; N],
            dir_z: [0.0; N],
            time: [0.0; N],
            tfar: [f32::INFINITY; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
        }
    }
}

/// `RTCHit4`, `RTCHit8` or `RTCHit16`. `instPrimID` is written from Embree 4.3 on.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub struct RTCHits<const N: usize> {
    pub Ng_x: [f32; N],
    pub Ng_y: [f32; N],
    pub Ng_z: [f32; N],
    pub u: [f32; N],
    pub v: [f32; N],
    pub primID: [u32; N],
    pub geomID: [u32; N],
    pub instID: [[u32; N]; 1],
    pub instPrimID: [[u32; N]; 1],
}

impl<const N: usize> Default for RTCHits<N> {
    /// No hits.
    fn default() -> Self {
        RTCHits {
            Ng_x: [0.0; N],
            Ng_y: [0.0; N],
            Ng_z: [0.0; N],
            u: [0.0; N],
            v: [0.0; N],
            primID: [RTC_INVALID_GEOMETRY_ID; N],
            geomID: [RTC_INVALID_GEOMETRY_ID; N],
            instID: [[RTC_INVALID_GEOMETRY_ID; N]],
            instPrimID: [[RTC_INVALID_GEOMETRY_ID; N]],
        }
    }
}

/// `RTCRayHit4`, `RTCRayHit8` or `RTCRayHit16`: rays and what they hit.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
#[allow(missing_docs)]
pub struct RTCRayHits<const N: usize> {
    pub ray: RTCRays<N>,
    pub hit: RTCHits<N>,
}

// Fields lie where C has them, whatever padding the alignment of 64 adds at the end.
const _: () = assert!(offset_of!(RTCRayHits<4>, hit) == 12 * 4 * 4);
const _: () = assert!(offset_of!(RTCRayHits<8>, hit) == 12 * 4 * 8);
const _: () = assert!(offset_of!(RTCRayHits<16>, hit) == 12 * 4 * 16);
const _: () = assert!(size_of::<RTCHits<16>>() == 9 * 4 * 16);

/// Which of N rays take part: -1 for yes, 0 for no. Aligned as Embree wants it.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct Valid<const N: usize>(pub [i32; N]);
