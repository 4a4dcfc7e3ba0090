//! C16 of Mora 2011, section 3.2: each ray/box test is one visit of a node of a stored tree with the same
//! splits. Rays that are sent through the splits of a trace one by one have its tests, to the last one.

mod common;

use common::{random_rays, soup};
use dacrt::{
    Batch, BestParameters, Hits, Lists, Mesh, Method, ObjectParameters, Ray, Sent, SpaceParameters,
    Trace, Tracer,
};
use glam::Vec3;

fn rays_of_all_kinds() -> Vec<(Mesh, Batch, String)> {
    let sizes = [
        (2000, 1500, true),
        (2000, 1500, false),
        (20_000, 300, true),
        (20_000, 300, false),
    ];
    let batch = |(rays, triangles, shared)| {
        let name = format!("{rays} rays, {triangles} triangles, shared {shared}");
        (soup(triangles, 3), random_rays(rays, 4, shared), name)
    };
    sizes.map(batch).into()
}

/// Rays of one origin, neighbours beside each other, rows of 200.
fn fan_of_rays(n: usize) -> Batch {
    let ray = |i: usize| {
        let (x, y) = ((i % 200) as f32 / 200.0, (i / 200) as f32 / 200.0);
        Ray::new(Vec3::splat(-1.0), Vec3::new(1.0, x + 0.5, y + 0.5))
    };
    (0..n).map(ray).collect()
}

fn check(mesh: &Mesh, batch: &Batch, parameters: impl Into<dacrt::Parameters>, what: &str) {
    let tracer = Tracer::new(parameters);
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let room = || Hits::misses(batch.len());
    let (mut hits, mut kept, mut sent) = (room(), room(), room());
    let plain = tracer.nearest(mesh, batch, &mut workspace, &mut hits);
    let (trace, stored) = tracer.store_nearest(mesh, batch, &mut workspace, &mut kept);
    assert_eq!(
        (&hits, plain),
        (&kept, trace),
        "{what}: keeping changes nothing"
    );
    let tests = trace.counters.ray_box - stored.extra_box();
    for how in [Sent::OneByOne, Sent::Together] {
        sent.t.fill(f32::NAN);
        let through = (&stored, how);
        let counters = tracer
            .send_nearest(mesh, batch, &mut workspace, &mut sent, through)
            .counters;
        assert_eq!(hits, sent, "{what} {how:?}");
        assert_eq!(
            counters.ray_triangle, trace.counters.ray_triangle,
            "{what} {how:?}"
        );
        if how == Sent::OneByOne {
            assert_eq!(counters.ray_box, tests, "{what}");
        }
    }
    // Rays that stop at any hit.
    let (mut any, mut again) = (vec![0; batch.len()], vec![2; batch.len()]);
    let (trace, stored) = tracer.store_any(mesh, batch, &mut workspace, &mut any);
    let through = (&stored, Sent::OneByOne);
    let counters = tracer
        .send_any(mesh, batch, &mut workspace, &mut again, through)
        .counters;
    assert_eq!(any, again, "{what}");
    let tests = trace.counters.ray_box - stored.extra_box();
    let expected = (tests, trace.counters.ray_triangle);
    assert_eq!(
        (counters.ray_box, counters.ray_triangle),
        expected,
        "{what}, any hit"
    );
}

#[test]
fn rays_sent_one_by_one_have_the_tests_of_the_trace() {
    for (mesh, batch, name) in rays_of_all_kinds() {
        for lists in [Lists::Auto, Lists::Copied, Lists::InPlace] {
            for preset in [ObjectParameters::AFRA2012, ObjectParameters::NABATA2013] {
                let parameters = ObjectParameters {
                    lists,
                    min_rays: 50,
                    ..preset
                };
                check(&mesh, &batch, parameters, &format!("{name} {parameters:?}"));
            }
        }
        for method in [Method::Mora2011, Method::Mora2011Random] {
            check(
                &mesh,
                &batch,
                method.parameters(),
                &format!("{name} {method}"),
            );
        }
        let printed = SpaceParameters {
            terminate_as_printed: true,
            estimate_from: u32::MAX,
            ..SpaceParameters::MORA2011
        };
        check(&mesh, &batch, printed, &format!("{name} as printed"));
    }
}

/// The tests of a trace by groups or conic packets are not those of one ray; hits and tests of triangles are
/// those of the trace all the same.
#[test]
fn cones_octants_and_blocks_go_through_their_splits_together() {
    let octants = SpaceParameters {
        octants: true,
        ..SpaceParameters::MORA2011
    };
    // As many as make several blocks of `best`.
    let blocks = BestParameters {
        block: 4096,
        ..BestParameters::BEST
    };
    let batches = rays_of_all_kinds().into_iter().chain([
        (
            soup(2000, 5),
            fan_of_rays(30_000),
            "rays in cones".to_owned(),
        ),
        (
            Mesh::new(vec![]),
            random_rays(100, 1, true),
            "no triangles".to_owned(),
        ),
    ]);
    for (mesh, batch, name) in batches {
        for parameters in [
            Method::Mora2011Cones.parameters(),
            octants.into(),
            Method::Best.parameters(),
            blocks.into(),
        ] {
            let what = format!("{name} {parameters:?}");
            let tracer = Tracer::new(parameters);
            let mut workspace = tracer.workspace(batch.len(), mesh.len());
            let (mut hits, mut sent) = (Hits::misses(batch.len()), Hits::misses(batch.len()));
            let plain = tracer.nearest(&mesh, &batch, &mut workspace, &mut hits);
            let (trace, stored) = tracer.store_nearest(&mesh, &batch, &mut workspace, &mut sent);
            assert_eq!(
                (&hits, plain),
                (&sent, trace),
                "{what}: keeping changes nothing"
            );
            assert!(mesh.is_empty() || stored.nodes() > 1, "{what}");
            sent.t.fill(f32::NAN);
            let through = (&stored, Sent::Together);
            let again = tracer.send_nearest(&mesh, &batch, &mut workspace, &mut sent, through);
            assert_eq!(hits, sent, "{what}");
            let tests = |trace: &Trace| (trace.counters.leaves, trace.counters.ray_triangle);
            assert_eq!(tests(&trace), tests(&again), "{what}");
            assert_eq!(again.counters.binned_triangles, 0, "{what}");
            let (mut any, mut through_any) = (vec![0; batch.len()], vec![2; batch.len()]);
            let (_, stored) = tracer.store_any(&mesh, &batch, &mut workspace, &mut any);
            let through = (&stored, Sent::Together);
            tracer.send_any(&mesh, &batch, &mut workspace, &mut through_any, through);
            assert_eq!(any, through_any, "{what}, any hit");
        }
    }
}

#[test]
fn threads_share_the_splits_of_a_trace() {
    let (mesh, batch) = (soup(5000, 3), random_rays(50_000, 4, false));
    let tracer = Tracer::new(Method::Best.parameters()).with_threads(3);
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let (mut hits, mut sent) = (Hits::misses(batch.len()), Hits::misses(batch.len()));
    let (_, stored) = tracer.store_nearest(&mesh, &batch, &mut workspace, &mut hits);
    let through = (&stored, Sent::Together);
    tracer.send_nearest(&mesh, &batch, &mut workspace, &mut sent, through);
    assert_eq!(hits, sent);
}

#[test]
#[should_panic(expected = "sent together")]
fn cones_cannot_be_sent_one_by_one() {
    let (mesh, batch) = (soup(2000, 5), fan_of_rays(1000));
    let tracer = Tracer::new(Method::Mora2011Cones.parameters());
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let mut hits = Hits::misses(batch.len());
    let (_, stored) = tracer.store_nearest(&mesh, &batch, &mut workspace, &mut hits);
    let through = (&stored, Sent::OneByOne);
    tracer.send_nearest(&mesh, &batch, &mut workspace, &mut hits, through);
}

#[test]
#[should_panic(expected = "sent together")]
fn blocks_cannot_be_sent_one_by_one() {
    let (mesh, batch, _) = rays_of_all_kinds().swap_remove(0);
    let tracer = Tracer::new(Method::Best.parameters());
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let mut hits = Hits::misses(batch.len());
    let (_, stored) = tracer.store_nearest(&mesh, &batch, &mut workspace, &mut hits);
    let through = (&stored, Sent::OneByOne);
    tracer.send_nearest(&mesh, &batch, &mut workspace, &mut hits, through);
}

/// Rays of another batch find their hits by splits that end where no ray has come before.
#[test]
fn rays_of_another_batch_go_on_where_the_splits_end() {
    let mesh = soup(3000, 3);
    let (first, second) = (random_rays(500, 4, true), random_rays(4000, 5, false));
    for method in [Method::Afra2012, Method::Nabata2013] {
        let tracer = Tracer::new(method.parameters());
        let mut workspace = tracer.workspace(second.len(), mesh.len());
        let (mut of_first, mut hits) = (Hits::misses(first.len()), Hits::misses(second.len()));
        let (_, stored) = tracer.store_nearest(&mesh, &first, &mut workspace, &mut of_first);
        tracer.nearest(&mesh, &second, &mut workspace, &mut hits);
        let mut sent = Hits::misses(second.len());
        let through = (&stored, Sent::Onward);
        tracer.send_nearest(&mesh, &second, &mut workspace, &mut sent, through);
        assert_eq!(hits, sent, "{method}");
        let (mut any, mut again) = (vec![0; second.len()], vec![2; second.len()]);
        tracer.any(&mesh, &second, &mut workspace, &mut any);
        tracer.send_any(&mesh, &second, &mut workspace, &mut again, through);
        assert_eq!(any, again, "{method}, any hit");
    }
}

/// The splits of a larger mesh were once taken for those of a smaller one, beyond the end of its lists.
#[test]
#[should_panic(expected = "the mesh that the splits are of")]
fn splits_of_another_mesh_are_refused() {
    let (mesh, batch, _) = rays_of_all_kinds().swap_remove(0);
    let tracer = Tracer::new(Method::Mora2011.parameters());
    let mut hits = Hits::misses(batch.len());
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let (_, stored) = tracer.store_nearest(&mesh, &batch, &mut workspace, &mut hits);
    let through = (&stored, Sent::Together);
    tracer.send_nearest(&soup(20, 1), &batch, &mut workspace, &mut hits, through);
}
