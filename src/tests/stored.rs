//! C16 of Mora 2011, section 3.2: each ray/box test is one visit of a node of a stored tree with the same
//! splits. Rays that are sent through the splits of a trace one by one have its tests, to the last one.

mod common;

use common::{random_rays, soup};
use dacrt::{Batch, Hits, Lists, Mesh, Method, ObjectParameters, Sent, SpaceParameters, Tracer};

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

#[test]
#[should_panic(expected = "no tree is kept")]
fn of_cones_no_tree_is_kept() {
    let (mesh, batch, _) = rays_of_all_kinds().swap_remove(0);
    let tracer = Tracer::new(Method::Mora2011Cones.parameters());
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    tracer.store_nearest(
        &mesh,
        &batch,
        &mut workspace,
        &mut Hits::misses(batch.len()),
    );
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
