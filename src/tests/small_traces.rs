//! Small but complete traces through every kernel, with memory that ends where batch and mesh end:
//! what `scripts/test-unsafe` runs under Miri, AddressSanitizer and Valgrind.

mod common;

use common::{bits, brute_force, finest_best, finest_object, finest_space, random_rays, soup};
use dacrt::*;
use glam::Vec3;

/// The presets, and switches that reach kernels which these reach in large batches only, or not at
/// all.
fn all_parameters() -> Vec<Parameters> {
    let [afra, nabata] = finest_object().map(|fine| ObjectParameters {
        samples: 7,
        bins: 4,
        ..fine
    });
    let [basic, cones, random] = finest_space();
    let object = |fine: ObjectParameters| -> Parameters {
        let switched = ObjectParameters {
            axes: Axes::All,
            sample_middle: true,
            second_sample: true,
            alpha_refresh: true,
            one_ray: OneRay::Entry,
            draws: Draws::Replacement,
            ..fine
        };
        switched.into()
    };
    let space = |fine: SpaceParameters| -> Parameters {
        let switched = SpaceParameters {
            estimate_from: 0,
            estimate_stride: 3,
            nine_axes_below: 3,
            plane_test: true,
            octants: true,
            ..fine
        };
        switched.into()
    };
    let [groups, rays, both] = finest_best();
    let mut all = vec![nabata.into(), object(nabata), cones.into(), space(random)];
    all.push(both.into());
    // What is left reaches no other kernel: not in Miri, which is a thousand times as slow.
    if !cfg!(miri) {
        all.extend([afra.into(), object(afra), basic.into(), space(basic)]);
        all.extend([space(cones), random.into(), groups.into(), rays.into()]);
        all.extend(Method::ALL.map(Method::parameters));
    }
    all
}

/// Rays of all kinds, or only such with three finite inverse directions.
fn rays(n: usize, seed: u64, shared: bool, special: bool) -> Batch {
    let mut batch = random_rays(n, seed, shared);
    for direction in batch.direction.iter_mut().filter(|_| !special) {
        let tame = |d: &mut f32| *d = if d.abs() < 1e-30 { 0.5 } else { *d };
        direction.iter_mut().for_each(tame);
    }
    batch
}

/// Nearest and any hits are those of the naive step over everything, on all instruction sets, with
/// the same counters.
fn check(mesh: &Mesh, batch: &Batch, own_origins: bool, parameters: &[Parameters]) {
    let mut hits = Hits::misses(batch.len());
    let mut any = vec![7; batch.len()];
    // One for each family, for in Miri their making takes longer than a trace.
    let mut workspaces = [Method::Nabata2013, Method::Mora2011, Method::Best]
        .map(|method| Workspace::new(&method.parameters(), batch.len(), mesh.len()));
    for precision in Precision::ALL {
        let mut expected: Option<Hits> = None;
        for parameters in [brute_force().into()].iter().chain(parameters) {
            let workspace = workspaces
                .iter_mut()
                .find(|w| w.suits(parameters, batch.len(), mesh.len(), 1))
                .unwrap();
            let mut first = None;
            for isa in Isa::available() {
                let tracer = Tracer::new(*parameters)
                    .with_isa(isa)
                    .with_precision(precision)
                    .with_own_origins(own_origins)
                    .with_audit(true);
                let found = (
                    tracer.nearest(mesh, batch, workspace, &mut hits),
                    tracer.any(mesh, batch, workspace, &mut any),
                );
                let expected = expected.get_or_insert_with(|| hits.clone());
                assert_eq!(bits(&hits), bits(expected), "{tracer:?}");
                let occluded = expected.prim.iter().map(|&p| (p != MISS) as u8);
                assert!(occluded.eq(any.iter().copied()), "{tracer:?}");
                assert_eq!(found, *first.get_or_insert(found), "{tracer:?}");
            }
        }
    }
}

#[test]
fn every_kind_of_batch() {
    let sizes = match cfg!(miri) {
        true => vec![(5, 4)],
        false => vec![(1, 1), (15, 3), (16, 16), (37, 21), (200, 130)],
    };
    for (n, triangles) in sizes {
        for (shared, own_origins) in [(false, false), (true, false), (true, true)] {
            for special in [false, true] {
                // Each const parameter of the kernels once.
                if cfg!(miri) && (own_origins || shared == special) {
                    continue;
                }
                let (mesh, batch) = (soup(triangles, 1), rays(n, 2, shared, special));
                check(&mesh, &batch, own_origins, &all_parameters());
            }
        }
    }
}

#[test]
#[cfg_attr(miri, ignore = "too slow; the tests of the filter have it in small")]
fn long_lists_kept_in_place() {
    // More than 1,024 rays of which a filter keeps more than three quarters, and a last vector that is not full.
    for shared in [false, true] {
        let batch: Batch = (0..3003)
            .map(|i| {
                let (x, y) = ((i % 32) as f32 / 40.0 - 0.4, (i / 32) as f32 / 160.0 - 0.3);
                let (eye, target) = (Vec3::new(0.1, 0.2, -4.0), Vec3::new(x, y, 0.0));
                let origin = if shared { eye } else { eye + 0.1 * target };
                Ray::new(origin, target - origin)
            })
            .collect();
        check(&soup(12, 5), &batch, false, &all_parameters());
    }
}

#[test]
fn identical_and_dropped_triangles() {
    let one = Triangle::new(Vec3::X, Vec3::Y, Vec3::new(-1.0, -1.0, 0.25));
    let nan = Triangle::new(Vec3::NAN, Vec3::X, Vec3::Y);
    let batch = rays(if cfg!(miri) { 2 } else { 21 }, 3, false, true);
    for mesh in [vec![one; 9], vec![nan; 9], vec![]] {
        check(&Mesh::new(mesh), &batch, false, &all_parameters());
    }
}
