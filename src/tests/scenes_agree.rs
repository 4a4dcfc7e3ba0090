//! On every scene and for every ray type, nearest and any hit: the same bits from all methods on
//! all instruction sets, the same counters on all instruction sets.

use dacrt::scene::{self, Scene, SceneError};
use dacrt::workloads::{Film, RayType, Workload};
use dacrt::*;
use std::path::{Path, PathBuf};

/// Scenes of more triangles get 64² pixels instead of 128².
const LARGE: usize = 1_000_000;

/// Whether portable code traces rays of this type in a scene of so many triangles. It is slow.
fn portable_traces(ray_type: RayType, triangles: usize) -> bool {
    let few = [RayType::ShadowPoint, RayType::Diffuse(2)].contains(&ray_type);
    triangles < 100_000 || ray_type == RayType::Primary || (triangles < LARGE && few)
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

fn load(name: &str) -> Option<Scene> {
    let mesh_folders: Vec<PathBuf> = std::env::var_os("DACRT_MESHES")
        .map(|list| std::env::split_paths(&list).collect())
        .unwrap_or_default();
    match Scene::load(&scene::find(name, &folder()).unwrap(), &mesh_folders) {
        Ok(scene) => Some(scene),
        Err(SceneError::MissingMesh { file, .. }) => {
            println!("notice: mesh {} not at hand", file.display());
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// What a trace found: the bits of the nearest hits, or which rays are occluded.
struct Found {
    t: Vec<u32>,
    prim: Vec<u32>,
    occluded: Vec<u8>,
    /// Of the nearest and of the any-hit trace.
    traces: [Trace; 2],
}

fn trace(tracer: Tracer, mesh: &Mesh, batch: &Batch, workspace: &mut Workspace) -> Found {
    let mut hits = Hits::misses(batch.len());
    let mut occluded = vec![2; batch.len()];
    let traces = [
        tracer.nearest(mesh, batch, workspace, &mut hits),
        tracer.any(mesh, batch, workspace, &mut occluded),
    ];
    Found {
        t: hits.t.iter().map(|t| t.to_bits()).collect(),
        prim: hits.prim,
        occluded,
        traces,
    }
}

fn different<T: PartialEq>(a: &[T], b: &[T]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

fn check(name: &str) {
    let Some(scene) = load(name) else { return };
    let mesh = &scene.mesh;
    let edge = if mesh.len() > LARGE { 64 } else { 128 };
    let film = Film::new(edge, edge, 1).unwrap();
    let workspace =
        |method: Method| Tracer::new(method.parameters()).workspace(film.rays(), mesh.len());
    let mut object_workspace = workspace(Method::Afra2012);
    let mut space_workspace = workspace(Method::Mora2011);
    let camera = scene.description.cameras[0].camera().unwrap();
    let view = scene.description.view(camera);
    let mut workload = Workload::new(mesh, view.clone(), film, 0).unwrap();

    let mut all_hits = 0;
    let allowed = |ray_type: &RayType| view.allows(*ray_type).is_ok();
    for ray_type in RayType::ALL.into_iter().filter(allowed) {
        let batch = workload
            .rays(ray_type, &mut |batch| {
                let mut hits = Hits::misses(batch.len());
                let tracer = Tracer::new(Method::Afra2012.parameters());
                tracer.nearest(mesh, batch, &mut object_workspace, &mut hits);
                hits
            })
            .unwrap()
            .batch;
        let isas = Isa::available()
            .filter(|isa| *isa != Isa::Portable || portable_traces(ray_type, mesh.len()));
        let isas: Vec<Isa> = isas.collect();
        let traced = |methods: &[Method], workspace: &mut Workspace| -> Vec<(Method, Vec<Found>)> {
            let found = |method: &Method| {
                let tracers = isas
                    .iter()
                    .map(|&isa| Tracer::new(method.parameters()).with_isa(isa));
                let found = tracers.map(|tracer| trace(tracer, mesh, &batch, workspace));
                (*method, found.collect())
            };
            methods.iter().map(found).collect()
        };
        // Without a shared origin Mora's presets are one; see `agreement.rs`.
        let space: &[Method] = match batch.shared_origin() {
            Some(_) => &[
                Method::Mora2011,
                Method::Mora2011Cones,
                Method::Mora2011Random,
            ],
            None => &[Method::Mora2011Random],
        };
        // One thread a family, so that the largest scene, the last to end, uses two processors.
        let object = &[Method::Afra2012, Method::Nabata2013];
        let all = std::thread::scope(|scope| {
            let other = scope.spawn(|| traced(space, &mut space_workspace));
            let mut all = traced(object, &mut object_workspace);
            all.extend(other.join().unwrap());
            all
        });

        let first = &all[0].1[0];
        for (&prim, &occluded) in first.prim.iter().zip(&first.occluded) {
            assert_eq!(occluded, (prim != MISS) as u8, "{name} {ray_type}");
        }
        all_hits += first.prim.iter().filter(|&&p| p != MISS).count();
        for (method, found) in &all {
            for (isa, f) in isas.iter().zip(found) {
                let at = format!("{name} {ray_type} {method} {isa}");
                assert_eq!(f.traces, found[0].traces, "{at}");
                assert_eq!(different(&f.prim, &first.prim), 0, "prim, {at}");
                assert_eq!(different(&f.t, &first.t), 0, "t, {at}");
                assert_eq!(different(&f.occluded, &first.occluded), 0, "any hit, {at}");
            }
        }
    }
    assert!(all_hits > film.rays() / 2, "{name}: only {all_hits} hits");
}

/// One test a scene, so that they run at the same time.
macro_rules! scenes {
    ($($test:ident: $name:literal,)*) => {
        $(
            #[test]
            fn $test() {
                check($name);
            }
        )*

        #[test]
        fn no_scene_is_left_out() {
            assert_eq!(scene::names(&folder()).unwrap(), [$($name),*]);
        }
    };
}

scenes! {
    armadillo: "armadillo",
    buddha: "buddha",
    bunny: "bunny",
    conference: "conference",
    cornell: "cornell",
    dragon: "dragon",
    hall: "hall",
    hand: "hand",
    kitchen: "kitchen",
    lucy: "lucy",
    relief: "relief",
    sanmiguel: "sanmiguel",
    sanmiguel_tables: "sanmiguel-tables",
    sibenik: "sibenik",
    soup: "soup",
    sponza: "sponza",
    sponza_crytek: "sponza-crytek",
    sponza_dabrovic: "sponza-dabrovic",
    toasters: "toasters",
}

#[test]
fn instruction_sets() {
    for isa in Isa::ALL {
        if !isa.is_available() {
            println!("notice: this processor has no {isa}");
        }
    }
}
