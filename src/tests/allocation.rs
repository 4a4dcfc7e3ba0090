//! A trace allocates nothing, and a workspace takes as much memory as its documentation says.

mod common;

use common::{finest_best, finest_space, random_rays, soup, space_presets};
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

/// All presets, and switches that may want more memory.
fn all_parameters() -> Vec<Parameters> {
    let sampling = ObjectParameters {
        axes: Axes::All,
        sample_middle: true,
        second_sample: true,
        alpha_refresh: true,
        ..ObjectParameters::NABATA2013
    };
    let mut all = Vec::from(Method::ALL.map(Method::parameters));
    all.push(sampling.into());
    all.extend(finest_best().map(Parameters::from));
    for preset in space_presets().into_iter().chain(finest_space()) {
        let switched = SpaceParameters {
            estimate_from: 0,
            plane_test: true,
            octants: true,
            ..preset
        };
        all.extend([preset, switched].map(Parameters::from));
    }
    all
}

#[test]
fn a_trace_allocates_nothing() {
    for shared in [false, true] {
        let (mesh, batch) = (soup(1000, 1), random_rays(3000, 2, shared));
        let mut hits = Hits::misses(batch.len());
        let mut occluded = vec![0; batch.len()];
        for isa in Isa::available() {
            for parameters in all_parameters() {
                let tracer = Tracer::new(parameters).with_isa(isa).with_audit(true);
                let mut workspace = tracer.workspace(batch.len(), mesh.len());
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
    for parameters in all_parameters() {
        for (rays, triangles) in [
            (0, 0),
            (1, 0),
            (0, 1),
            (15, 3),
            (16, 3),
            (17, 3),
            (9999, 777),
        ] {
            for threads in [1, 3] {
                let (workspace, _, bytes) =
                    counted(|| Workspace::for_threads(&parameters, rays, triangles, threads));
                let at = format!("{rays} rays, {triangles} triangles, {parameters:?}, {threads}");
                let said = Workspace::bytes_for(&parameters, rays, triangles, threads);
                assert_eq!(workspace.bytes(), said, "{at}");
                // What threads have for themselves is not in it.
                let threads_own = match parameters.takes_threads() && threads > 1 {
                    true => 20_000 * threads,
                    false => 0,
                };
                assert!(
                    (said..=said + threads_own).contains(&bytes),
                    "{at}: {bytes}"
                );
            }
        }
    }
}

/// The formulas of [`Workspace`]'s documentation.
#[test]
fn a_workspace_is_linear_in_rays_and_triangles() {
    let object: fn(usize, usize) -> usize =
        |rays, triangles| 140 * rays.next_multiple_of(16) + 20 * rays + 64 * triangles;
    // Cones have at least 8 rays; of each 64 rays there is a word of termination bits.
    let space: fn(usize, usize) -> usize =
        |rays, triangles| 52 * rays + 28 * (rays / 8) + 8 * (rays / 64) + 44 * triangles;
    for (method, formula, constants) in [
        (Method::Afra2012, object, 700_000..740_000),
        (Method::Mora2011, space, 500..1000),
    ] {
        let parameters = method.parameters();
        let constant = Workspace::bytes_for(&parameters, 0, 0, 1);
        assert!(constants.contains(&constant), "{method}: {constant}");
        let check = |rays, triangles| {
            assert_eq!(
                Workspace::bytes_for(&parameters, rays, triangles, 1),
                formula(rays, triangles) + constant,
                "{method}: {rays} rays, {triangles} triangles"
            );
        };
        for (rays, triangles) in [(16, 0), (0, 1), (1 << 20, 12_345), (1 << 24, 30_000_000)] {
            check(rays, triangles);
        }
        for n in 0..200 {
            check(n, 0);
            check(0, n);
        }
    }
}

/// As above, for `best`.
#[test]
fn a_workspace_for_best_is_linear_in_triangles_and_in_the_rays_of_a_block() {
    let parameters = Method::Best.parameters();
    let bytes = |rays, triangles, threads| {
        Workspace::bytes_for(&parameters, rays, triangles, threads) as i64
    };
    let constant = bytes(0, 0, 1);
    assert!((700_000..800_000).contains(&constant), "{constant}");
    for triangles in [4, 4000, 30_000_000] {
        assert_eq!(bytes(0, triangles, 1) - constant, 271 * triangles as i64);
        let third = bytes(0, triangles, 3) - bytes(0, triangles, 2);
        assert_eq!(
            third - (bytes(0, 0, 3) - bytes(0, 0, 2)),
            9 * triangles as i64
        );
    }
    for rays in [64, 6400, 1 << 18] {
        let all = bytes(rays, 0, 1) - constant;
        let thread = bytes(rays, 0, 3) - bytes(rays, 0, 2) - (bytes(0, 0, 3) - bytes(0, 0, 2));
        assert!(thread <= 191 * rays as i64 + 4000, "{rays}");
        assert!(all - thread <= 38 * rays as i64, "{rays}");
    }
    let more = bytes(1 << 20, 0, 1) - bytes(1 << 18, 0, 1);
    assert_eq!(more, 38 * ((1 << 20) - (1 << 18)));
    assert_eq!(bytes(1 << 30, 7, 2), bytes(1 << 20, 7, 2));
}

#[test]
fn methods_of_one_family_share_workspaces() {
    let family = |method: Method| match method {
        Method::Afra2012 | Method::Nabata2013 => 0,
        Method::Best => 2,
        _ => 1,
    };
    for made_for in Method::ALL {
        let workspace = Workspace::new(&made_for.parameters(), 100, 30);
        for used_for in Method::ALL {
            let parameters = used_for.parameters();
            let same_family = family(made_for) == family(used_for);
            assert_eq!(
                workspace.suits(&parameters, 100, 30, 1),
                same_family,
                "{made_for}, {used_for}"
            );
            assert!(!workspace.suits(&parameters, 101, 30, 1));
            assert!(!workspace.suits(&parameters, 100, 31, 1));
            let one_thread = same_family && used_for != Method::Best;
            assert_eq!(workspace.suits(&parameters, 100, 30, 2), one_thread);
        }
    }
}

fn trace_in_workspace_of(made_for: Method, used_for: Method) {
    let mut workspace = Workspace::new(&made_for.parameters(), 10, 10);
    let (mesh, batch) = (Mesh::default(), Batch::default());
    let tracer = Tracer::new(used_for.parameters());
    tracer.nearest(&mesh, &batch, &mut workspace, &mut Hits::misses(0));
}

#[test]
#[should_panic(expected = "the workspace is for another kind of method")]
fn a_workspace_for_lists_of_triangles_is_none_for_cells() {
    trace_in_workspace_of(Method::Nabata2013, Method::Mora2011);
}

#[test]
#[should_panic(expected = "the workspace is for another kind of method")]
fn a_workspace_for_cells_is_none_for_lists_of_triangles() {
    trace_in_workspace_of(Method::Mora2011Cones, Method::Afra2012);
}

#[test]
#[should_panic(expected = "too small for 3 threads")]
fn a_workspace_for_two_threads_is_none_for_three() {
    let tracer = Tracer::new(Method::Best.parameters()).with_threads(2);
    let mut workspace = tracer.workspace(0, 0);
    let (mesh, batch) = (Mesh::default(), Batch::default());
    let more = tracer.with_threads(3);
    more.nearest(&mesh, &batch, &mut workspace, &mut Hits::misses(0));
}

#[test]
#[should_panic(expected = "at most 10^9 rays")]
fn a_workspace_refuses_more_rays_than_gathers_can_name() {
    Workspace::new(&Method::Afra2012.parameters(), 1 << 30, 0);
}

#[test]
#[should_panic(expected = "at most 10^9 rays")]
fn so_does_a_workspace_for_cells() {
    Workspace::new(&Method::Mora2011.parameters(), 1 << 30, 0);
}
