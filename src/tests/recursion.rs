//! Meshes and batches that are hard on the recursion and on the memory of a trace.

mod common;

use common::{
    Case, Check, bits, brute_force, finest_object, finest_space, random_rays, soup, space_presets,
};
use dacrt::*;
use glam::Vec3;

/// Presets, and lists of triangles down to single ones.
fn object_parameters() -> Vec<ObjectParameters> {
    let mut all = vec![ObjectParameters::AFRA2012, ObjectParameters::NABATA2013];
    for fine in finest_object() {
        let longest = ObjectParameters {
            axes: Axes::Longest,
            bins: 2,
            ..fine
        };
        all.extend([fine, longest]);
    }
    all
}

/// The same of all methods; with cells that are always split in the middle, and always at the
/// estimate.
fn all_parameters() -> Vec<Parameters> {
    let mut all: Vec<Parameters> = object_parameters().into_iter().map(Into::into).collect();
    all.extend(space_presets().map(Parameters::from));
    for fine in finest_space() {
        let estimated = SpaceParameters {
            estimate_from: 0,
            estimate_stride: 1,
            ..fine
        };
        all.extend([fine, estimated].map(Parameters::from));
    }
    all
}

/// Checks all methods; returns the counters.
fn check(mesh: Mesh, batch: Batch) -> Vec<Counters> {
    let check = Check {
        mesh,
        batch,
        parameters: all_parameters(),
        own_origins: false,
        grazing: false,
    };
    let traces = check.run().into_iter();
    traces.map(|trace| trace.counters).collect()
}

/// A triangle at `center`, about `size` large.
fn small(center: Vec3, size: f32) -> Triangle {
    let corner = |x, y, z| center + size * Vec3::new(x, y, z);
    Triangle::new(
        corner(-1.0, -1.0, 0.25),
        corner(1.0, -1.0, -0.5),
        corner(0.0, 1.0, 0.125),
    )
}

#[test]
fn exponentially_spaced_triangles_end() {
    // Each split of the box in the middle takes off one size only: 150 levels of them.
    for step in [1.0, 0.5, 0.125] {
        let triangles = (0..(150.0 / step) as i32)
            .map(|i| {
                let x = 2f32.powf(60.0 - step * i as f32);
                small(Vec3::new(x, 0.1 * x, -0.1 * x), x / 64.0)
            })
            .collect();
        let batch = (0..300)
            .map(|i| {
                let x = 2f32.powi(60 - i / 2);
                let y = (i % 5) as f32 * 0.003;
                let target = Vec3::new(x, (0.1 + y) * x, -0.1 * x);
                Ray::new(Vec3::ZERO, target / x)
            })
            .collect();
        let counters = check(Mesh::new(triangles), batch);
        assert!(counters.iter().any(|c| c.nodes > 200), "{counters:#?}");
    }
}

#[test]
fn identical_triangles_end() {
    let batch = random_rays(200, 1, false);
    for n in [2, 9, 1000, 5000] {
        check(Mesh::new(vec![small(Vec3::ZERO, 0.7); n]), batch.clone());
    }
}

#[test]
fn centers_in_one_bin_end() {
    // Large triangles whose centres are closer to each other than any bin is wide.
    let triangles = (0..2000)
        .map(|i| {
            let center = Vec3::new(i as f32, (i % 7) as f32, (i % 13) as f32) * 1e-6;
            small(center, 1.0)
        })
        .collect();
    check(Mesh::new(triangles), random_rays(300, 2, true));
}

#[test]
fn flat_and_thin_meshes_end() {
    // All in one plane, then all around one line.
    for squash in [Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, 1e-30, 1e-30)] {
        let triangles = soup(1000, 3).into_triangles().into_iter();
        let squashed = triangles.map(|t| Triangle::new(t.a * squash, t.b * squash, t.c * squash));
        check(Mesh::new(squashed.collect()), random_rays(500, 4, false));
    }
}

#[test]
fn coordinates_of_the_largest_size_end() {
    let huge = soup(500, 5).into_triangles().into_iter();
    let huge = huge.map(|t| Triangle::new(t.a * 5e17, t.b * 5e17, t.c * 5e17));
    check(Mesh::new(huge.collect()), random_rays(500, 6, false));
}

#[test]
fn nothing_and_next_to_nothing() {
    let meshes = [
        Mesh::default(),
        Mesh::new(vec![small(Vec3::ZERO, 1.0)]),
        Mesh::new(vec![Triangle::new(Vec3::NAN, Vec3::X, Vec3::Y)]),
        Mesh::new(vec![Triangle::new(Vec3::X, Vec3::X, Vec3::Y); 20]),
        soup(50, 1),
    ];
    let batches = [
        Batch::default(),
        [Ray::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z)]
            .into_iter()
            .collect(),
        [Ray::new(Vec3::NAN, Vec3::Z)].into_iter().collect(),
        random_rays(100, 1, false),
    ];
    for mesh in &meshes {
        for batch in &batches {
            check(mesh.clone(), batch.clone());
        }
    }
    let case = Case::new(meshes[1].clone(), batches[1].clone());
    for method in Method::ALL {
        let (hits, trace) = case.nearest(Tracer::new(method.parameters()));
        assert_eq!(hits.prim, [0]);
        let counters = trace.counters;
        assert_eq!((counters.nodes, counters.leaves), (1, 1), "{method}");
        assert_eq!(counters.ray_triangle, 1, "{method}");
    }
}

#[test]
fn a_workspace_serves_smaller_batches_and_meshes() {
    for shared in [false, true] {
        let large = Case::new(soup(2000, 1), random_rays(5000, 2, shared));
        let small = Case::new(soup(300, 3), random_rays(77, 4, shared));
        let (expected, _) = small.nearest(Tracer::new(brute_force()));
        for method in Method::ALL {
            for isa in Isa::available() {
                let tracer = Tracer::new(method.parameters()).with_isa(isa);
                let mut used = tracer.workspace(5000, 2000);
                let first = large.nearest_in(tracer, &mut used);
                let in_used = small.nearest_in(tracer, &mut used);
                assert_eq!(bits(&in_used.0), bits(&expected), "{method} {isa}");
                assert_eq!(in_used, small.nearest(tracer), "{method} {isa}");
                let again = large.nearest_in(tracer, &mut used);
                assert_eq!(again, first, "{method} {isa}");
            }
        }
    }
}

/// Records that lists may use, as the workspace's memory has them: 4n and a constant.
fn capacity(rays: usize) -> u64 {
    4 * rays.next_multiple_of(16) as u64 + 16_384
}

#[test]
fn lists_stay_within_their_memory() {
    let n = 60_000;
    // All rays in the same direction through everything: each filter keeps all or nearly all.
    let beam: Batch = (0..n)
        .map(|i| {
            let (x, y) = ((i % 250) as f32, (i / 250) as f32);
            let origin = Vec3::new(-5.0, x / 500.0 - 0.25, y / 500.0 - 0.25);
            Ray::new(origin, Vec3::new(1.0, 1e-3, -1e-3))
        })
        .collect();
    // Walls that never stop a ray (it hits nothing but the last), behind each other.
    let frame = |x: f32| {
        let corner = |y, z| Vec3::new(x, y, z);
        [
            Triangle::new(corner(-3.0, -3.0), corner(3.0, -3.0), corner(0.0, -2.9)),
            Triangle::new(corner(-3.0, 3.0), corner(3.0, 3.0), corner(0.0, 2.9)),
        ]
    };
    let frames = Mesh::new((0..400).flat_map(|i| frame(i as f32 / 100.0)).collect());
    let parallel = check_lists(frames, beam, n);
    assert_eq!(parallel, n as u64, "nothing is copied");
    // And rays of all kinds: filters keep every share there is.
    check_lists(soup(3000, 7), random_rays(n, 8, false), n);
    check_lists(soup(3000, 7), random_rays(n, 8, true), n);
}

#[test]
fn lists_that_keep_up_to_three_quarters_are_copied() {
    // Frames around rays that hit nothing: the first ones are as wide as some of the rays, those
    // behind them as all.
    let n = 32_000;
    let peak = |share: f32| {
        let frame = |z: f32, width: f32| {
            let corner = |x, y| Vec3::new(x * width, y, z);
            [
                Triangle::new(corner(0.0, -3.0), corner(1.0, -3.0), corner(0.5, -2.9)),
                Triangle::new(corner(0.0, 3.0), corner(1.0, 3.0), corner(0.5, 2.9)),
            ]
        };
        let frames = (0..8).flat_map(|i| {
            let z = i as f32 * 0.01;
            [frame(z, share), frame(z + 10.0, 1.0)]
        });
        let batch: Batch = (0..n)
            .map(|i| {
                let x = (i as f32 + 0.5) / n as f32;
                Ray::new(Vec3::new(x, 0.0, -1.0), Vec3::new(1e-6, 1e-6, 1.0))
            })
            .collect();
        let case = Case::new(Mesh::new(frames.flatten().collect()), batch);
        let (_, trace) = case.nearest(Tracer::new(Method::Afra2012.parameters()));
        trace.counters.peak_list
    };
    assert_eq!(peak(0.8), n as u64, "in place");
    let copied = peak(0.7) as f32 / n as f32;
    assert!((1.69..1.71).contains(&copied), "{copied}");
}

#[test]
fn short_lists_that_keep_all_rays_stay_within_their_memory() {
    // Lists this short are copied at every level, and there are more levels than memory for them.
    let n = 1000;
    let batch: Batch = (0..n)
        .map(|i| {
            Ray::new(
                Vec3::new(-1.0, 0.0, 0.0),
                Vec3::new(1.0, i as f32 * 1e-6, 1e-6),
            )
        })
        .collect();
    // Above and below the rays, at each power of two: a split in the middle takes off one pair.
    let pair = |i: i32| {
        let x = 2f32.powi(60 - i);
        let corner = |y, z| x * Vec3::new(1.0, y, z);
        [
            Triangle::new(corner(0.25, -0.5), corner(0.25, 0.5), corner(0.5, 0.0)),
            Triangle::new(corner(-0.25, -0.5), corner(-0.25, 0.5), corner(-0.5, 0.0)),
        ]
    };
    let mesh = Mesh::new((0..100).flat_map(pair).collect());
    let most = check_lists(mesh, batch, n);
    assert!(
        most > capacity(n) - 2048,
        "{most}: the limit was not reached"
    );
}

/// Checks the peak of all methods that split lists of triangles; returns the largest.
fn check_lists(mesh: Mesh, batch: Batch, n: usize) -> u64 {
    let case = Case::new(mesh, batch);
    let mut most = 0;
    let mut reference = None;
    for parameters in object_parameters() {
        for skip in [0.5, 1.0] {
            let tracer = Tracer::new(ObjectParameters { skip, ..parameters });
            let (hits, trace) = case.nearest(tracer);
            let peak = trace.counters.peak_list;
            assert!(peak <= capacity(n), "{peak} {tracer:?}");
            most = most.max(peak);
            assert_eq!(&hits, reference.get_or_insert(hits.clone()), "{tracer:?}");
        }
    }
    most
}
