//! Which Embree this is and how many threads it builds and traces with.

use super::alone::on_one_processor;
use super::packets::Lanes;
use super::threads::Threads;
use super::trace::Query;
use anyhow::{Context, bail, ensure};
use embree4_sys as sys;
use std::ffi::{CStr, c_void};
use std::path::Path;

/// Makes scenes that are built and traced by a given number of threads.
///
/// An `embree4-rs` scene owns its device, so this one holds what is needed to make them, and what
/// was asked of a first one.
#[derive(Clone, Debug)]
pub struct Device {
    info: Info,
    /// Rays of its native packets.
    packet: Lanes,
    tracing: Threads,
}

/// What is logged about the library in use.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Info {
    /// For instance `4.4.0`.
    pub version: String,
    /// The widest instruction set that Embree uses here: `avx512`, `avx2`, `avx`, `sse` (2 or
    /// 4.2; NEON elsewhere).
    pub isa: String,
    /// The library's file name, without its folder.
    pub library: String,
    /// Threads that build a scene, and as many others that trace it; at least 1.
    pub threads: usize,
}

impl Device {
    /// Loads Embree for builds and traces with `threads` threads, 0 for as many as the machine has. Those
    /// that trace are started here; those that build are Embree's own. If the first device of a process
    /// has one thread, builds of later ones have one, too.
    ///
    /// # Errors
    /// If the library is older than 4.0, or does not support the processor, or no threads can be started.
    pub fn new(threads: usize) -> anyhow::Result<Device> {
        let threads = match threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            n => n,
        };
        let device = match threads {
            1 => on_one_processor(|| open(1))?,
            _ => open(threads)?,
        };
        // A scene is the public way from an `embree4-rs` device to what `embree4-sys` takes.
        let scene = embree4_rs::Scene::try_new(device, Default::default())?;
        let device = super::scene::RawDevice::of(&scene);
        // SAFETY: the device is alive; the call reads a number.
        let property = |p| unsafe { sys::rtcGetDeviceProperty(device.handle(), p) };
        let version = [
            sys::RTCDeviceProperty::VERSION_MAJOR,
            sys::RTCDeviceProperty::VERSION_MINOR,
            sys::RTCDeviceProperty::VERSION_PATCH,
        ]
        .map(property);
        let library = library();
        ensure!(
            version[0] == 4,
            "{library} is Embree {}.{}.{}, but Embree 4 is needed: unset EMBREE_DIR and run \
             scripts/dacrt, or set EMBREE_DIR to the folder of an Embree 4",
            version[0],
            version[1],
            version[2],
        );
        // Embree tells how wide its native packets are; AVX and AVX2 packets are equally wide.
        let (isa, packet) = if property(sys::RTCDeviceProperty::NATIVE_RAY16_SUPPORTED) != 0 {
            ("avx512", Lanes::Sixteen)
        } else if property(sys::RTCDeviceProperty::NATIVE_RAY8_SUPPORTED) != 0 {
            (if has_avx2() { "avx2" } else { "avx" }, Lanes::Eight)
        } else {
            ("sse", Lanes::Four)
        };
        Ok(Device {
            info: Info {
                version: version.map(|n| n.to_string()).join("."),
                isa: isa.to_owned(),
                library,
                threads,
            },
            packet,
            tracing: Threads::new(threads)?,
        })
    }

    /// The library in use.
    pub fn info(&self) -> &Info {
        &self.info
    }

    /// All queries that may be the fastest here: ray by ray, and packets as wide as its vectors.
    pub fn queries(&self) -> [Query; 3] {
        Query::all(self.packet)
    }

    /// The threads that trace.
    pub(super) fn tracing(&self) -> Threads {
        self.tracing.clone()
    }

    /// An `embree4-rs` device for one scene.
    pub(super) fn open(&self) -> anyhow::Result<embree4_rs::Device> {
        open(self.info.threads)
    }
}

fn open(threads: usize) -> anyhow::Result<embree4_rs::Device> {
    // embree4-rs hands the string on as it is, so it has to end with a NUL.
    let config = format!("threads={threads},start_threads=0\0");
    let device = embree4_rs::Device::try_new(Some(&config)).context("Embree does not start")?;
    if let Some(error) = device.error() {
        bail!("Embree does not take {threads} threads: {error:?}");
    }
    Ok(device)
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_avx2() -> bool {
    false
}

/// File name of the library that the dynamic linker found.
fn library() -> String {
    let mut found = libc::Dl_info {
        dli_fname: std::ptr::null(),
        dli_fbase: std::ptr::null_mut(),
        dli_sname: std::ptr::null(),
        dli_saddr: std::ptr::null_mut(),
    };
    let function = sys::rtcNewDevice as *const c_void;
    // SAFETY: `found` may be written; the address is that of a function.
    let status = unsafe { libc::dladdr(function, &mut found) };
    if status == 0 || found.dli_fname.is_null() {
        return "unknown".to_owned();
    }
    // SAFETY: dladdr reported success, so this is a C string that lives as long as the library.
    let path = unsafe { CStr::from_ptr(found.dli_fname) }.to_string_lossy();
    Path::new(&*path).file_name().map_or_else(
        || path.to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}

/// The control bits of this thread's MXCSR: rounding, flush-to-zero, denormals-are-zero, masked
/// exceptions; the sticky flags of past exceptions are cleared in the answer. `None` where there
/// is no such register. For the log: nothing here changes it.
pub fn mxcsr() -> Option<u32> {
    #[cfg(target_arch = "x86_64")]
    {
        let mut value = 0_u32;
        // SAFETY: stores four bytes to `value` and changes nothing else.
        unsafe {
            std::arch::asm!(
                "stmxcsr [{}]",
                in(reg) &raw mut value,
                options(nostack, preserves_flags)
            );
        }
        Some(value & !0x3f)
    }
    #[cfg(not(target_arch = "x86_64"))]
    None
}
