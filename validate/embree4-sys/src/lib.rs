//! The part of Embree 4's C interface that this workspace and `embree4-rs` 0.0.16 use.
//!
//! Written by hand in the place of the published `embree4-sys` 0.0.10, whose headers are 4.2: from
//! Embree 4.3 on a hit has one more field, `instPrimID`, and the library writes it past the end of
//! the structures that those bindings reserve. Here [`RTCRayHit`] and [`RTCRayHits`] have room
//! for it, so they are right for every 4.x. The names are those of the C headers with prefixes of
//! constants left out, as in the published crate; Embree's manual says what they mean.
//!
//! One difference to the published crate, for soundness: what is an `enum` in C is a number with
//! named values here, because a library newer than these bindings may return other values.

#![allow(non_camel_case_types, non_snake_case)]

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::fmt;

mod functions;
mod rays;

pub use functions::*;
pub use rays::*;

/// What `geomID` and `instID` are where there is none.
pub const RTC_INVALID_GEOMETRY_ID: u32 = u32::MAX;

/// What Embree's handles point to.
#[repr(C)]
pub struct Opaque {
    _data: [u8; 0],
}

/// Handle of a device.
pub type RTCDevice = *mut Opaque;
/// Handle of a scene.
pub type RTCScene = *mut Opaque;
/// Handle of a geometry.
pub type RTCGeometry = *mut Opaque;

/// A C enumeration: a number with named values.
macro_rules! values {
    ($(#[$doc:meta])* $name:ident { $($value:ident = $number:expr),* $(,)? }) => {
        $(#[$doc])*
        #[repr(transparent)]
        #[derive(Clone, Copy, PartialEq, Eq)]
        pub struct $name(pub c_uint);

        #[allow(missing_docs)]
        impl $name {
            $(pub const $value: $name = $name($number);)*
        }

        impl fmt::Debug for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match *self {
                    $($name::$value => f.write_str(stringify!($value)),)*
                    $name(other) => write!(f, "{}({other})", stringify!($name)),
                }
            }
        }
    };
}

values! {
    /// What went wrong.
    RTCError {
        NONE = 0,
        UNKNOWN = 1,
        INVALID_ARGUMENT = 2,
        INVALID_OPERATION = 3,
        OUT_OF_MEMORY = 4,
        UNSUPPORTED_CPU = 5,
        CANCELLED = 6,
    }
}

values! {
    /// What can be asked of a device.
    RTCDeviceProperty {
        VERSION_MAJOR = 1,
        VERSION_MINOR = 2,
        VERSION_PATCH = 3,
        NATIVE_RAY4_SUPPORTED = 32,
        NATIVE_RAY8_SUPPORTED = 33,
        NATIVE_RAY16_SUPPORTED = 34,
    }
}

values! {
    /// How much work a build puts into the tree.
    RTCBuildQuality { LOW = 0, MEDIUM = 1, HIGH = 2 }
}

impl Default for RTCBuildQuality {
    fn default() -> Self {
        Self::MEDIUM
    }
}

values! {
    /// Properties of a scene.
    RTCSceneFlags { NONE = 0, ROBUST = 4 }
}

impl Default for RTCSceneFlags {
    fn default() -> Self {
        Self::NONE
    }
}

values! {
    /// Kinds of geometry.
    RTCGeometryType { TRIANGLE = 0, USER = 120 }
}

values! {
    /// What a geometry's buffer is for.
    RTCBufferType { INDEX = 0, VERTEX = 1 }
}

values! {
    /// What a buffer's elements are.
    RTCFormat { UINT3 = 0x5003, FLOAT3 = 0x9003 }
}

values! {
    /// Hints about the rays of a query.
    RTCRayQueryFlags { INCOHERENT = 0, COHERENT = 1 << 16 }
}

values! {
    /// Features that a query needs.
    RTCFeatureFlags { ALL = 0xffff_ffff }
}

/// An axis-aligned box.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, Default)]
#[allow(missing_docs)]
pub struct RTCBounds {
    pub lower_x: f32,
    pub lower_y: f32,
    pub lower_z: f32,
    pub align0: f32,
    pub upper_x: f32,
    pub upper_y: f32,
    pub upper_z: f32,
    pub align1: f32,
}

/// What a query hands on to callbacks. Only ever made by Embree: from 4.3 on it has more fields
/// than are declared here.
#[repr(C)]
#[non_exhaustive]
#[allow(missing_docs)]
pub struct RTCRayQueryContext {
    pub instID: [u32; 1],
}

/// Arguments of a filter callback, which nobody here uses.
pub type RTCFilterFunctionN = Option<unsafe extern "C" fn(args: *const Opaque)>;

/// Callback of a user geometry: its bounds.
pub type RTCBoundsFunction = Option<unsafe extern "C" fn(args: *const RTCBoundsFunctionArguments)>;

/// Callback of a user geometry: the nearest hit of N rays.
pub type RTCIntersectFunctionN =
    Option<unsafe extern "C" fn(args: *const RTCIntersectFunctionNArguments)>;

/// Callback of a user geometry: any hit, which nobody here uses.
pub type RTCOccludedFunctionN = Option<unsafe extern "C" fn(args: *const Opaque)>;

/// Callback for Embree's allocations: bytes taken, or given back if negative. The result `false`
/// cancels the build.
pub type RTCMemoryMonitorFunction =
    Option<unsafe extern "C" fn(ptr: *mut c_void, bytes: isize, post: bool) -> bool>;

/// Arguments of [`RTCBoundsFunction`].
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(missing_docs)]
pub struct RTCBoundsFunctionArguments {
    pub geometryUserPtr: *mut c_void,
    pub primID: c_uint,
    pub timeStep: c_uint,
    pub bounds_o: *mut RTCBounds,
}

/// Arguments of [`RTCIntersectFunctionN`].
#[repr(C)]
#[derive(Clone, Copy)]
#[allow(missing_docs)]
pub struct RTCIntersectFunctionNArguments {
    pub valid: *mut c_int,
    pub geometryUserPtr: *mut c_void,
    pub primID: c_uint,
    pub context: *mut RTCRayQueryContext,
    pub rayhit: *mut Opaque,
    pub N: c_uint,
    pub geomID: c_uint,
}

/// Optional arguments of the nearest-hit queries.
#[repr(C)]
#[allow(missing_docs)]
pub struct RTCIntersectArguments {
    pub flags: RTCRayQueryFlags,
    pub feature_mask: RTCFeatureFlags,
    pub context: *mut RTCRayQueryContext,
    pub filter: RTCFilterFunctionN,
    pub intersect: RTCIntersectFunctionN,
    /// `minWidthDistanceFactor` of libraries built with that feature; 0.
    pub reserved: u64,
}

/// Optional arguments of the any-hit queries.
#[repr(C)]
#[allow(missing_docs)]
pub struct RTCOccludedArguments {
    pub flags: RTCRayQueryFlags,
    pub feature_mask: RTCFeatureFlags,
    pub context: *mut RTCRayQueryContext,
    pub filter: RTCFilterFunctionN,
    pub occluded: RTCOccludedFunctionN,
    /// `minWidthDistanceFactor` of libraries built with that feature; 0.
    pub reserved: u64,
}

impl RTCIntersectArguments {
    /// The defaults of `rtcInitIntersectArguments`, but for the flags.
    pub const fn new(flags: RTCRayQueryFlags) -> Self {
        RTCIntersectArguments {
            flags,
            feature_mask: RTCFeatureFlags::ALL,
            context: std::ptr::null_mut(),
            filter: None,
            intersect: None,
            reserved: 0,
        }
    }
}

impl RTCOccludedArguments {
    /// The defaults of `rtcInitOccludedArguments`, but for the flags.
    pub const fn new(flags: RTCRayQueryFlags) -> Self {
        RTCOccludedArguments {
            flags,
            feature_mask: RTCFeatureFlags::ALL,
            context: std::ptr::null_mut(),
            filter: None,
            occluded: None,
            reserved: 0,
        }
    }
}
