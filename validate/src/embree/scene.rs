//! One mesh, built by Embree.

use super::Device;
use super::threads::Threads;
use anyhow::{Context, ensure};
use dacrt::Mesh;
use embree4_rs::geometry::TriangleMeshGeometry;
use embree4_rs::{CommittedScene, SceneOptions};
use embree4_sys as sys;
use std::ffi::c_void;
use std::marker::PhantomData;
use std::mem::offset_of;
use std::sync::Arc;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::time::{Duration, Instant};

/// How much work Embree puts into the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quality {
    /// Sorted along a space-filling curve: fastest build.
    Low,
    /// Embree's default: binned surface area heuristic.
    Medium,
    /// With spatial splits: fastest to trace.
    High,
}

impl Quality {
    /// All of them, fastest build first.
    pub const ALL: [Quality; 3] = [Quality::Low, Quality::Medium, Quality::High];

    /// `low`, `medium` or `high`, as in result files.
    pub fn name(self) -> &'static str {
        match self {
            Quality::Low => "low",
            Quality::Medium => "medium",
            Quality::High => "high",
        }
    }

    fn embree(self) -> sys::RTCBuildQuality {
        match self {
            Quality::Low => sys::RTCBuildQuality::LOW,
            Quality::Medium => sys::RTCBuildQuality::MEDIUM,
            Quality::High => sys::RTCBuildQuality::HIGH,
        }
    }
}

/// One mesh as a single geometry, so that Embree's `primID` is our `prim`; triangles that are not
/// valid keep their number and are never hit.
pub struct Scene {
    // Before the counter that its memory monitor writes to: fields are dropped in this order.
    scene: CommittedScene,
    bytes: Arc<AtomicIsize>,
    robust: bool,
    build_time: Duration,
    threads: Threads,
}

/// A committed scene as threads take it that trace.
#[derive(Clone, Copy)]
pub struct Committed<'a> {
    handle: sys::RTCScene,
    pub(super) robust: bool,
    _scene: PhantomData<&'a Scene>,
}

// SAFETY: Embree lets any number of threads trace a committed scene at a time, and nothing else is done
// with the handle while it is borrowed.
unsafe impl Sync for Committed<'_> {}

impl Committed<'_> {
    pub(super) fn handle(&self) -> sys::RTCScene {
        self.handle
    }
}

impl Scene {
    /// Copies the triangles to Embree and builds its tree, in robust or in default ("fast") mode, with the
    /// device's threads.
    ///
    /// Besides Embree's own memory takes 48 bytes a triangle while it copies.
    ///
    /// # Errors
    /// If Embree runs out of memory, or the vertices fill more than its 16 GiB.
    pub fn build(
        device: &Device,
        mesh: &Mesh,
        quality: Quality,
        robust: bool,
    ) -> anyhow::Result<Scene> {
        let options = SceneOptions {
            build_quality: quality.embree(),
            flags: if robust {
                sys::RTCSceneFlags::ROBUST
            } else {
                sys::RTCSceneFlags::NONE
            },
        };
        // Declared before the scene, so that it is dropped after it on every way out.
        let bytes = Arc::new(AtomicIsize::new(0));
        let scene = embree4_rs::Scene::try_new(device.open()?, options)?;
        // SAFETY: the device is alive, and the counter outlives it.
        unsafe {
            sys::rtcSetDeviceMemoryMonitorFunction(
                RawDevice::of(&scene).handle(),
                Some(count_bytes),
                Arc::as_ptr(&bytes).cast_mut().cast(),
            );
        }
        if !mesh.is_empty() {
            let geometry = geometry(&scene.device, mesh, quality)
                .with_context(|| format!("Embree does not take {} triangles", mesh.len()))?;
            scene.attach_geometry(&geometry)?;
        }
        let start = Instant::now();
        let scene = scene
            .commit()
            .with_context(|| format!("Embree fails to build {} triangles", mesh.len()))?;
        let build_time = start.elapsed();
        Ok(Scene {
            scene,
            bytes,
            robust,
            build_time,
            threads: device.tracing(),
        })
    }

    /// Memory that Embree holds for this scene, its copies of vertices and indices included
    /// (48 bytes a triangle), as it reports it itself.
    pub fn bytes(&self) -> usize {
        usize::try_from(self.bytes.load(Ordering::Relaxed)).unwrap_or(0)
    }

    /// Time that Embree took to build the tree; copying the triangles is not in it.
    pub fn build_time(&self) -> Duration {
        self.build_time
    }

    pub(super) fn robust(&self) -> bool {
        self.robust
    }

    pub(super) fn handle(&self) -> sys::RTCScene {
        handle(&self.scene.scene)
    }

    /// For threads to trace.
    pub fn committed(&self) -> Committed<'_> {
        Committed {
            handle: self.handle(),
            robust: self.robust,
            _scene: PhantomData,
        }
    }

    /// Those that trace it.
    pub(super) fn threads(&self) -> &Threads {
        &self.threads
    }
}

fn geometry(
    device: &embree4_rs::Device,
    mesh: &Mesh,
    quality: Quality,
) -> anyhow::Result<TriangleMeshGeometry> {
    let corners = 3 * mesh.len();
    ensure!(corners <= u32::MAX as usize, "more than 2^32 vertices");
    let vertices: Vec<(f32, f32, f32)> = mesh
        .triangles()
        .iter()
        .flat_map(|t| [t.a, t.b, t.c].map(Into::into))
        .collect();
    let indices: Vec<(u32, u32, u32)> = (0..corners as u32)
        .step_by(3)
        .map(|i| (i, i + 1, i + 2))
        .collect();
    let geometry = TriangleMeshGeometry::try_new(device, &vertices, &indices)?;
    // In a scene of low quality each geometry has a tree of its own quality, which is medium
    // unless told; without this a low build takes twice as long.
    // SAFETY: the geometry is alive.
    unsafe {
        sys::rtcSetGeometryBuildQuality(geometry.handle, quality.embree());
        sys::rtcCommitGeometry(geometry.handle);
    }
    device.error_or(geometry, "cannot set the build quality")
}

/// Called by Embree for each allocation, on any thread.
unsafe extern "C" fn count_bytes(counter: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: this is the counter given with the callback; it outlives the device.
    let counter = unsafe { &*counter.cast::<AtomicIsize>() };
    counter.fetch_add(bytes, Ordering::Relaxed);
    true
}

/// The handle of an `embree4-rs` scene, which is private there.
///
/// A scene of version 0.0.16, the only one that `Cargo.toml` admits, consists of two fields of a
/// pointer's size: the public `device`, whose place is known, and the handle, which therefore is
/// at the other place.
fn handle(scene: &embree4_rs::Scene) -> sys::RTCScene {
    const POINTER: usize = size_of::<sys::RTCScene>();
    const DEVICE: usize = offset_of!(embree4_rs::Scene, device);
    const {
        assert!(size_of::<embree4_rs::Scene>() == 2 * POINTER);
        assert!(size_of::<embree4_rs::Device>() == POINTER);
        assert!(align_of::<embree4_rs::Scene>() == align_of::<sys::RTCScene>());
        assert!(DEVICE == 0 || DEVICE == POINTER);
    }
    let start = std::ptr::from_ref(scene).cast::<u8>();
    // SAFETY: inside the scene and aligned by the assertions above; the field there is the handle.
    unsafe { start.add(POINTER - DEVICE).cast::<sys::RTCScene>().read() }
}

/// The device of a scene, as `embree4-sys` takes it; released on drop.
pub(super) struct RawDevice(sys::RTCDevice);

impl RawDevice {
    pub(super) fn of(scene: &embree4_rs::Scene) -> RawDevice {
        // SAFETY: the scene is alive.
        RawDevice(unsafe { sys::rtcGetSceneDevice(handle(scene)) })
    }

    pub(super) fn handle(&self) -> sys::RTCDevice {
        self.0
    }
}

impl Drop for RawDevice {
    fn drop(&mut self) {
        // SAFETY: `rtcGetSceneDevice` retained the device for us.
        unsafe { sys::rtcReleaseDevice(self.0) }
    }
}
