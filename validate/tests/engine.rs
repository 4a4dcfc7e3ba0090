//! The engine and both Embree modes on the generated scenes: what differs must be explained.

use dacrt::scene::generators::generate;
use dacrt::workloads::{Camera, Film, RayType, View, Workload};
use dacrt::{Batch, Hits, Mesh, Method, Precision, Tracer};
use dacrt_validate::diff::{Checker, Diff};
use dacrt_validate::embree::{Device, Lanes, Quality, Query, Scene};
use dacrt_validate::hash::hit_hash;
use dacrt_validate::judge::{Answers, Judge};
use glam::DVec3;

fn trace(mesh: &Mesh, batch: &Batch) -> Hits {
    let mut hits = Hits::misses(batch.len());
    let tracer = Tracer::new(Method::Nabata2013.parameters());
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    tracer.nearest(mesh, batch, &mut workspace, &mut hits);
    hits
}

fn check(judge: &Judge, [fast, robust]: &[Scene; 2], batch: &Batch, any_hit: bool) -> Diff {
    let n = batch.len();
    if any_hit {
        let [mut ours, mut of_fast, mut of_robust] = [(); 3].map(|()| vec![0; n]);
        let tracer = Tracer::new(Method::Nabata2013.parameters());
        let mut workspace = tracer.workspace(n, judge.mesh().len());
        tracer.any(judge.mesh(), batch, &mut workspace, &mut ours);
        fast.any(batch, Query::Packet(Lanes::Sixteen), &mut of_fast);
        robust.any(batch, Query::Packet(Lanes::Sixteen), &mut of_robust);
        let ours = Answers::Any(&ours);
        let (of_fast, of_robust) = (Answers::Any(&of_fast), Answers::Any(&of_robust));
        Checker::new(judge, batch, of_fast, of_robust, 1000, 1).check(
            Precision::Fast,
            ours,
            &hit_hash(&ours),
        )
    } else {
        let ours = trace(judge.mesh(), batch);
        let [mut of_fast, mut of_robust] = [(); 2].map(|()| Hits::misses(n));
        fast.nearest(batch, Query::Packet(Lanes::Sixteen), &mut of_fast);
        robust.nearest(batch, Query::Packet(Lanes::Sixteen), &mut of_robust);
        let ours = Answers::Nearest(&ours);
        let (of_fast, of_robust) = (Answers::Nearest(&of_fast), Answers::Nearest(&of_robust));
        Checker::new(judge, batch, of_fast, of_robust, 1000, 1).check(
            Precision::Fast,
            ours,
            &hit_hash(&ours),
        )
    }
}

#[test]
fn every_difference_is_explained() {
    let device = Device::new(1).unwrap();
    for name in ["relief", "soup"] {
        let mesh = generate(name, 20_000, 1).unwrap();
        assert!(mesh.len() >= 19_999, "{name}");
        let bounds = mesh.bounds();
        let middle = bounds.center().as_dvec3();
        let eye = middle + 0.4 * bounds.extent().as_dvec3() * DVec3::new(1.0, 0.3, 0.9);
        let camera = Camera::new(eye, middle, DVec3::Y, 60.0).unwrap();
        let film = Film::new(128, 128, 1).unwrap();
        let light = (middle + 0.1 * bounds.extent().as_dvec3()).as_vec3();
        let view = View {
            point_light: Some(light),
            ..View::of(camera)
        };
        let mut workload = Workload::new(&mesh, view, film, 1).unwrap();
        let judge = Judge::new(&mesh);
        let scenes = [false, true]
            .map(|robust| Scene::build(&device, &mesh, Quality::Medium, robust).unwrap());
        for rays in [
            RayType::Primary,
            RayType::ShadowPoint,
            RayType::AmbientOcclusion,
            RayType::Diffuse(1),
            RayType::Random,
        ] {
            let batch = workload.rays(rays, &mut |b| trace(&mesh, b)).unwrap().batch;
            let diff = check(&judge, &scenes, &batch, rays.is_any_hit());
            assert_eq!(diff.wrong(), 0, "{name}, {rays}: {:#?}", diff.offending);
            assert_eq!(
                diff.judged_random as usize,
                batch.len().min(1000),
                "{name}, {rays}"
            );
            for part in [&diff.embree_fast, &diff.embree_robust] {
                assert_eq!(
                    (part.same + part.tie + part.differing) as usize,
                    batch.len()
                );
                assert!(part.differing <= 5, "{name}, {rays}: {part:?}");
            }
        }
    }
}
