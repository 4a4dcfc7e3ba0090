//! Rays and hits, single and 16 wide.

use super::RTC_INVALID_GEOMETRY_ID;

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

/// 16 rays; see [`RTCRay`].
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub struct RTCRay16 {
    pub org_x: [f32; 16],
    pub org_y: [f32; 16],
    pub org_z: [f32; 16],
    pub tnear: [f32; 16],
    pub dir_x: [f32; 16],
    pub dir_y: [f32; 16],
    pub dir_z: [f32; 16],
    pub time: [f32; 16],
    pub tfar: [f32; 16],
    pub mask: [u32; 16],
    pub id: [u32; 16],
    pub flags: [u32; 16],
}

impl Default for RTCRay16 {
    /// 16 times [`RTCRay::default`].
    fn default() -> Self {
        RTCRay16 {
            org_x: [0.0; 16],
            org_y: [0.0; 16],
            org_z: [0.0; 16],
            tnear: [0.0; 16],
            dir_x: [0.0; 16],
            dir_y: [0.0; 16],
            dir_z: [0.0; 16],
            time: [0.0; 16],
            tfar: [f32::INFINITY; 16],
            mask: [u32::MAX; 16],
            id: [0; 16],
            flags: [0; 16],
        }
    }
}

/// What 16 rays hit. `instPrimID` is written from Embree 4.3 on.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)]
pub struct RTCHit16 {
    pub Ng_x: [f32; 16],
    pub Ng_y: [f32; 16],
    pub Ng_z: [f32; 16],
    pub u: [f32; 16],
    pub v: [f32; 16],
    pub primID: [u32; 16],
    pub geomID: [u32; 16],
    pub instID: [[u32; 16]; 1],
    pub instPrimID: [[u32; 16]; 1],
}

impl Default for RTCHit16 {
    /// No hits.
    fn default() -> Self {
        RTCHit16 {
            Ng_x: [0.0; 16],
            Ng_y: [0.0; 16],
            Ng_z: [0.0; 16],
            u: [0.0; 16],
            v: [0.0; 16],
            primID: [RTC_INVALID_GEOMETRY_ID; 16],
            geomID: [RTC_INVALID_GEOMETRY_ID; 16],
            instID: [[RTC_INVALID_GEOMETRY_ID; 16]],
            instPrimID: [[RTC_INVALID_GEOMETRY_ID; 16]],
        }
    }
}

/// 16 rays and what they hit.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
#[allow(missing_docs)]
pub struct RTCRayHit16 {
    pub ray: RTCRay16,
    pub hit: RTCHit16,
}

const _: () = assert!(size_of::<RTCRay16>() == 12 * 64);
const _: () = assert!(size_of::<RTCHit16>() == 9 * 64);

/// Which of 16 rays take part: -1 for yes, 0 for no. Aligned as Embree wants it.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct Valid16(pub [i32; 16]);
