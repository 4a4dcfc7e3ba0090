//! The library in use writes nothing past the structures that `embree4-sys` declares.

use embree4_sys::*;

const GUARD: u32 = 0xa5a5_a5a5;

/// A structure with words behind it that nobody may write.
#[repr(C)]
struct Guarded<T> {
    inner: T,
    guard: [u32; 64],
}

impl<T: Default> Guarded<T> {
    fn new() -> Guarded<T> {
        Guarded {
            inner: T::default(),
            guard: [GUARD; 64],
        }
    }

    fn check(&self) {
        assert_eq!(self.guard, [GUARD; 64], "written past the structure");
    }
}

/// A scene with one triangle around the z axis at z = 2, and its library's minor version.
struct Fixture {
    device: RTCDevice,
    scene: RTCScene,
    minor: isize,
}

impl Fixture {
    fn new() -> Fixture {
        // SAFETY: handles are used while alive; the buffers have the sizes just asked for.
        unsafe {
            let device = rtcNewDevice(c"threads=1,start_threads=0".as_ptr());
            let geometry = rtcNewGeometry(device, RTCGeometryType::TRIANGLE);
            let vertices = rtcSetNewGeometryBuffer(
                geometry,
                RTCBufferType::VERTEX,
                0,
                RTCFormat::FLOAT3,
                12,
                3,
            );
            let corners = [-8.0_f32, -8.0, 2.0, 8.0, -8.0, 2.0, 0.0, 8.0, 2.0];
            vertices.cast::<[f32; 9]>().write(corners);
            let indices =
                rtcSetNewGeometryBuffer(geometry, RTCBufferType::INDEX, 0, RTCFormat::UINT3, 12, 1);
            indices.cast::<[u32; 3]>().write([0, 1, 2]);
            rtcCommitGeometry(geometry);
            let scene = rtcNewScene(device);
            rtcAttachGeometry(scene, geometry);
            rtcReleaseGeometry(geometry);
            rtcCommitScene(scene);
            assert_eq!(rtcGetDeviceError(device), RTCError::NONE);
            let minor = rtcGetDeviceProperty(device, RTCDeviceProperty::VERSION_MINOR);
            Fixture {
                device,
                scene,
                minor,
            }
        }
    }
}

impl Drop for Fixture {
    fn drop(&mut self) {
        // SAFETY: both are alive and not used again.
        unsafe {
            rtcReleaseScene(self.scene);
            rtcReleaseDevice(self.device);
        }
    }
}

/// Embree divides by an estimate of the reciprocal, whose last bit depends on the processor (1.9999999 on a
/// Zen 3).
fn is_two(t: f32) -> bool {
    (t - 2.0).abs() <= 2.0 * f32::EPSILON
}

#[test]
fn single_queries_stay_inside() {
    let fixture = Fixture::new();
    for flags in [RTCRayQueryFlags::INCOHERENT, RTCRayQueryFlags::COHERENT] {
        let mut nearest = Guarded::<RTCRayHit>::new();
        nearest.inner.ray.dir_z = 1.0;
        let mut any = Guarded::<RTCRay>::new();
        any.inner.dir_z = 1.0;
        // SAFETY: the scene is committed, the structures are alive.
        unsafe {
            rtcIntersect1(
                fixture.scene,
                &mut nearest.inner,
                &mut RTCIntersectArguments::new(flags),
            );
            rtcOccluded1(
                fixture.scene,
                &mut any.inner,
                &mut RTCOccludedArguments::new(flags),
            );
        }
        nearest.check();
        any.check();
        assert_eq!(nearest.inner.hit.primID, 0);
        assert!(is_two(nearest.inner.ray.tfar));
        assert_eq!(any.inner.tfar, f32::NEG_INFINITY);
    }
}

/// Calls both functions for packets of N rays, and looks at what they have written.
fn packets_stay_inside<const N: usize>(intersect: IntersectPacket<N>, occluded: OccludedPacket<N>) {
    let fixture = Fixture::new();
    let valid = Valid([-1; N]);
    for flags in [RTCRayQueryFlags::INCOHERENT, RTCRayQueryFlags::COHERENT] {
        let mut nearest = Guarded::<RTCRayHits<N>>::new();
        nearest.inner.ray.dir_z = [1.0; N];
        let mut any = Guarded::<RTCRays<N>>::new();
        any.inner.dir_z = [1.0; N];
        // SAFETY: the scene is committed, the structures are alive and aligned.
        unsafe {
            intersect(
                valid.0.as_ptr(),
                fixture.scene,
                &mut nearest.inner,
                &mut RTCIntersectArguments::new(flags),
            );
            occluded(
                valid.0.as_ptr(),
                fixture.scene,
                &mut any.inner,
                &mut RTCOccludedArguments::new(flags),
            );
        }
        nearest.check();
        any.check();
        assert_eq!(nearest.inner.hit.primID, [0; N]);
        assert!(nearest.inner.ray.tfar.into_iter().all(is_two));
        assert_eq!(any.inner.tfar, [f32::NEG_INFINITY; N]);
    }
}

#[test]
fn packets_of_all_widths_stay_inside() {
    packets_stay_inside::<4>(rtcIntersect4, rtcOccluded4);
    packets_stay_inside::<8>(rtcIntersect8, rtcOccluded8);
    packets_stay_inside::<16>(rtcIntersect16, rtcOccluded16);
}

/// That the tests above can fail: with the 80 bytes of the published bindings they would, from
/// Embree 4.3 on.
#[test]
fn the_layout_of_embree_4_2_would_be_overrun() {
    const OLD_WORDS: usize = 80 / 4;
    #[repr(C, align(64))]
    struct Words([u32; 64]);

    let fixture = Fixture::new();
    let mut words = Words([GUARD; 64]);
    let old = words.0.as_mut_ptr();
    // SAFETY: the words are larger than the structures and at least as aligned; Embree, which
    // knows its own version's layout, writes 96 bytes at most.
    unsafe {
        let ray = RTCRay {
            dir_z: 1.0,
            ..RTCRay::default()
        };
        old.cast::<RTCRay>().write(ray);
        old.add(12).cast::<RTCHit>().write(RTCHit::default());
        rtcIntersect1(fixture.scene, old.cast(), std::ptr::null_mut());
    }
    let overrun = words.0[OLD_WORDS] != GUARD;
    assert_eq!(overrun, fixture.minor >= 3, "Embree 4.{}", fixture.minor);
    assert_eq!(words.0[size_of::<RTCRayHit>() / 4..], [GUARD; 40]);
}
