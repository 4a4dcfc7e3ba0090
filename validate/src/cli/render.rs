//! `dacrt render`: pictures of a scene.

use super::Verdict;
use super::args::{RenderArgs, What};
use super::engine::Engine;
use super::picture::Picture;
use super::plan::{self, check_writable};
use super::shade;
use super::size::Spp;
use super::source::{SceneSource, Views, mesh_folders};
use super::text::print;
use anyhow::{Context, bail, ensure};
use dacrt::scene::Scene;
use dacrt::workloads::{RayType, Workload};
use std::path::{Path, PathBuf};

/// Traces and writes the pictures; says where they are.
pub fn render(args: &RenderArgs) -> anyhow::Result<Verdict> {
    let method = plan::method(&args.method)?;
    let parameters = args.knobs.single(method)?;
    let precision = plan::precision(&args.precision)?;
    let choice = plan::engine(&args.engine)?;
    let source = SceneSource::find(&args.scene)?;
    let one_sample = plan::film(args.resolution, Spp(1))?;
    let samples = plan::film(args.resolution, args.spp)?;
    let mesh_folders = mesh_folders(&args.meshes);
    if let Some(missing) = source.missing_mesh(&mesh_folders) {
        bail!(missing);
    }
    let files = files(args, &source.name())?;

    let scene = Scene::load(&source.json, &mesh_folders)?;
    let mut engine = Engine::new(choice.tracer(parameters, precision), &scene.mesh);
    let view = Views::new(&source, &scene.mesh).of(args.camera.as_deref())?;
    let workload = |film| Workload::new(&scene.mesh, view.clone(), film, choice.seed);

    // Depth, prim and boxes have one sample a pixel: a mean of two numbers of triangles is none.
    let mut plain = workload(one_sample)?;
    let primary = plain.rays(RayType::Primary, &mut |b| engine.nearest(b).0)?;
    let (hits, _) = engine.nearest(&primary.batch);
    for (what, file) in files {
        let mut note = String::new();
        let picture: Picture = match what {
            What::Shaded => {
                let mut workload = workload(samples)?;
                shade::shaded(&mut workload, &scene.mesh, &mut engine, &view)?
            }
            What::Depth => shade::depth(one_sample, &hits),
            What::Prim => shade::prim(one_sample, &hits),
            What::Boxes => {
                let (picture, most) = shade::boxes(one_sample, &primary.batch, &mut engine);
                note = format!(" (red: {most:.1} ray/box tests a ray)");
                picture
            }
        };
        picture.save(&file)?;
        print(&format!("{}{note}\n", file.display()))?;
    }
    Ok(Verdict::Good)
}

/// Where each picture goes: all places are proven writable.
fn files(args: &RenderArgs, scene: &str) -> anyhow::Result<Vec<(What, PathBuf)>> {
    let in_folder =
        |folder: &Path, what: &What| (*what, folder.join(format!("{scene}-{}.png", what.name())));
    let files: Vec<(What, PathBuf)> = match &args.out {
        Some(file)
            if file
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("png")) =>
        {
            ensure!(
                args.what.len() == 1,
                "--out {} is one file for {} pictures: name a folder",
                file.display(),
                args.what.len()
            );
            vec![(args.what[0], file.clone())]
        }
        Some(folder) => {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("--out: cannot make the folder {}", folder.display()))?;
            args.what.iter().map(|w| in_folder(folder, w)).collect()
        }
        None => args
            .what
            .iter()
            .map(|w| in_folder(Path::new(""), w))
            .collect(),
    };
    for (_, file) in &files {
        check_writable(file).context("--out")?;
    }
    Ok(files)
}
