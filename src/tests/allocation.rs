//! A trace allocates nothing, and a workspace takes as much memory as its documentation says.

mod common;

use common::{random_rays, soup};
use dacrt::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator, with a record of what each thread asks for.
struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
    static BYTES: Cell<usize> = const { Cell::new(0) };
}

fn record(bytes: usize) {
    CALLS.set(CALLS.get() + 1);
    BYTES.set(BYTES.get() + bytes);
}

// SAFETY: all calls go to the system's allocator as they are; recording allocates nothing, as the
// cells need neither lazy initialisation nor a destructor.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        record(layout.size());
        // SAFETY: the caller keeps the trait's promises; so below.
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        record(layout.size());
        // SAFETY: as above.
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        record(size);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        CALLS.set(CALLS.get() + 1);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What `f` returns, how often it called the allocator, and the bytes it asked for.
fn counted<T>(f: impl FnOnce() -> T) -> (T, usize, usize) {
    let (calls, bytes) = (CALLS.get(), BYTES.get());
    let result = f();
    (result, CALLS.get() - calls, BYTES.get() - bytes)
}

#[test]
fn the_allocator_is_counted() {
    let (_, calls, bytes) = counted(|| drop(std::hint::black_box(vec![0u8; 1000])));
    assert_eq!((calls, bytes), (2, 1000));
}

#[test]
fn a_trace_allocates_nothing() {
    let sampling = ObjectParameters {
        axes: Axes::All,
        sample_middle: true,
        second_sample: true,
        alpha_refresh: true,
        ..ObjectParameters::NABATA2013
    };
    for shared in [false, true] {
        let (mesh, batch) = (soup(3000, 1), random_rays(10_000, 2, shared));
        let mut workspace = Workspace::new(batch.len(), mesh.len());
        let mut hits = Hits::misses(batch.len());
        let mut occluded = vec![0; batch.len()];
        for isa in Isa::available() {
            for parameters in Method::ALL
                .map(Method::parameters)
                .into_iter()
                .chain([sampling])
            {
                let tracer = Tracer::new(parameters).with_isa(isa).with_audit(true);
                let (trace, calls, _) =
                    counted(|| tracer.nearest(&mesh, &batch, &mut workspace, &mut hits));
                assert_eq!(calls, 0, "nearest, {isa}");
                assert!(trace.counters.nodes > 100);
                let (trace, calls, _) =
                    counted(|| tracer.any(&mesh, &batch, &mut workspace, &mut occluded));
                assert_eq!(calls, 0, "any, {isa}");
                assert!(trace.counters.nodes > 100);
            }
        }
    }
}

#[test]
fn a_workspace_allocates_the_bytes_that_it_says() {
    for (rays, triangles) in [
        (0, 0),
        (1, 0),
        (0, 1),
        (15, 3),
        (16, 3),
        (17, 3),
        (9999, 777),
    ] {
        let (workspace, _, bytes) = counted(|| Workspace::new(rays, triangles));
        assert_eq!(
            workspace.bytes(),
            bytes,
            "{rays} rays, {triangles} triangles"
        );
        assert_eq!(Workspace::bytes_for(rays, triangles), bytes);
    }
}

/// The formula of [`Workspace`]'s documentation.
#[test]
fn a_workspace_is_linear_in_rays_and_triangles() {
    let constant = Workspace::bytes_for(0, 0);
    assert!((700_000..740_000).contains(&constant), "{constant}");
    for (rays, triangles) in [(16, 0), (0, 1), (1 << 20, 12_345), (1 << 24, 30_000_000)] {
        let bytes = 104 * rays + 64 * triangles + constant;
        assert_eq!(Workspace::bytes_for(rays, triangles), bytes);
    }
    for rays in 1..100usize {
        let bytes = 84 * rays.next_multiple_of(16) + 20 * rays + constant;
        assert_eq!(Workspace::bytes_for(rays, 0), bytes);
    }
}

#[test]
#[should_panic(expected = "at most 10^9 rays")]
fn a_workspace_refuses_more_rays_than_gathers_can_name() {
    Workspace::new(1 << 30, 0);
}
