//! Keeps Embree's task scheduler from starting threads that nobody asked for.

/// Calls `start`, which makes the first Embree device of the process, with this thread bound to one
/// processor. TBB, Embree's scheduler, counts its processors once and for all when it is first used; if
/// there are two or more and the device has one thread, it starts a second all the same, which does
/// nothing but yield, over and over, for as long as the process lives (seen with Embree 4.4.0 and its
/// TBB 2021; on two processors, Sibenik, our traces took 1.15 to 1.2 times and Embree's 1.0 to 1.1 times as
/// long beside it).
/// If the system does not let itself be asked, `start` is called as it is.
#[cfg(target_os = "linux")]
pub(super) fn on_one_processor<T>(start: impl FnOnce() -> T) -> T {
    let size = size_of::<libc::cpu_set_t>();
    // SAFETY: a set of processors is plain bits, and the calls read or write one of that size.
    unsafe {
        let mut all: libc::cpu_set_t = std::mem::zeroed();
        if libc::sched_getaffinity(0, size, &mut all) != 0 {
            return start();
        }
        let own = libc::sched_getcpu().max(0) as usize;
        let mut one: libc::cpu_set_t = std::mem::zeroed();
        libc::CPU_SET(own, &mut one);
        libc::sched_setaffinity(0, size, &one);
        let started = start();
        libc::sched_setaffinity(0, size, &all);
        started
    }
}

#[cfg(not(target_os = "linux"))]
pub(super) fn on_one_processor<T>(start: impl FnOnce() -> T) -> T {
    start()
}
