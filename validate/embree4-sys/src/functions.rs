//! The functions. All are unsafe: handles must be alive, pointers must point to what they say.

use super::*;

#[allow(missing_docs)]
unsafe extern "C" {
    pub fn rtcNewDevice(config: *const c_char) -> RTCDevice;
    pub fn rtcReleaseDevice(device: RTCDevice);
    pub fn rtcGetDeviceProperty(device: RTCDevice, prop: RTCDeviceProperty) -> isize;
    pub fn rtcGetDeviceError(device: RTCDevice) -> RTCError;
    pub fn rtcSetDeviceMemoryMonitorFunction(
        device: RTCDevice,
        monitor: RTCMemoryMonitorFunction,
        userPtr: *mut c_void,
    );

    pub fn rtcNewGeometry(device: RTCDevice, kind: RTCGeometryType) -> RTCGeometry;
    pub fn rtcReleaseGeometry(geometry: RTCGeometry);
    pub fn rtcCommitGeometry(geometry: RTCGeometry);
    pub fn rtcSetGeometryBuildQuality(geometry: RTCGeometry, quality: RTCBuildQuality);
    pub fn rtcSetNewGeometryBuffer(
        geometry: RTCGeometry,
        kind: RTCBufferType,
        slot: c_uint,
        format: RTCFormat,
        byteStride: usize,
        itemCount: usize,
    ) -> *mut c_void;
    pub fn rtcSetGeometryUserPrimitiveCount(geometry: RTCGeometry, count: c_uint);
    pub fn rtcSetGeometryUserData(geometry: RTCGeometry, ptr: *mut c_void);
    pub fn rtcSetGeometryBoundsFunction(
        geometry: RTCGeometry,
        bounds: RTCBoundsFunction,
        userPtr: *mut c_void,
    );
    pub fn rtcSetGeometryIntersectFunction(geometry: RTCGeometry, intersect: RTCIntersectFunctionN);

    pub fn rtcNewScene(device: RTCDevice) -> RTCScene;
    pub fn rtcReleaseScene(scene: RTCScene);
    /// The caller has to release the device.
    pub fn rtcGetSceneDevice(scene: RTCScene) -> RTCDevice;
    pub fn rtcSetSceneBuildQuality(scene: RTCScene, quality: RTCBuildQuality);
    pub fn rtcSetSceneFlags(scene: RTCScene, flags: RTCSceneFlags);
    pub fn rtcAttachGeometry(scene: RTCScene, geometry: RTCGeometry) -> c_uint;
    pub fn rtcCommitScene(scene: RTCScene);
    pub fn rtcGetSceneBounds(scene: RTCScene, bounds: *mut RTCBounds);

    pub fn rtcIntersect1(scene: RTCScene, rayhit: *mut RTCRayHit, args: *mut RTCIntersectArguments);
    pub fn rtcIntersect4(
        valid: *const c_int,
        scene: RTCScene,
        rayhit: *mut RTCRayHits<4>,
        args: *mut RTCIntersectArguments,
    );
    pub fn rtcIntersect8(
        valid: *const c_int,
        scene: RTCScene,
        rayhit: *mut RTCRayHits<8>,
        args: *mut RTCIntersectArguments,
    );
    pub fn rtcIntersect16(
        valid: *const c_int,
        scene: RTCScene,
        rayhit: *mut RTCRayHits<16>,
        args: *mut RTCIntersectArguments,
    );
    pub fn rtcOccluded1(scene: RTCScene, ray: *mut RTCRay, args: *mut RTCOccludedArguments);
    pub fn rtcOccluded4(
        valid: *const c_int,
        scene: RTCScene,
        ray: *mut RTCRays<4>,
        args: *mut RTCOccludedArguments,
    );
    pub fn rtcOccluded8(
        valid: *const c_int,
        scene: RTCScene,
        ray: *mut RTCRays<8>,
        args: *mut RTCOccludedArguments,
    );
    pub fn rtcOccluded16(
        valid: *const c_int,
        scene: RTCScene,
        ray: *mut RTCRays<16>,
        args: *mut RTCOccludedArguments,
    );
}

/// `rtcIntersect4`, `rtcIntersect8` or `rtcIntersect16`, as N says.
pub type IntersectPacket<const N: usize> = unsafe extern "C" fn(
    valid: *const c_int,
    scene: RTCScene,
    rayhit: *mut RTCRayHits<N>,
    args: *mut RTCIntersectArguments,
);

/// `rtcOccluded4`, `rtcOccluded8` or `rtcOccluded16`, as N says.
pub type OccludedPacket<const N: usize> = unsafe extern "C" fn(
    valid: *const c_int,
    scene: RTCScene,
    ray: *mut RTCRays<N>,
    args: *mut RTCOccludedArguments,
);
