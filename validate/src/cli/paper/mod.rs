//! `dacrt paper`: what a paper prints, measured here and set beside it.

mod fig8;

use super::Verdict;
use super::args::{Paper, PaperArgs};
use super::knobs::KnobLists;
use super::plan::{
    Round, RunPlan, add_scene, check_writable, contestants, distinct, engine, film, precision,
};
use super::run;
use super::size::Spp;
use super::source::{SceneSource, mesh_folders};
use super::text::print;
use anyhow::{Context, ensure};
use dacrt::Method;
use dacrt::workloads::{Film, RayType};
use dacrt_validate::diff::RANDOM_RAYS;
use dacrt_validate::embree::Quality;
use dacrt_validate::results::Document;
use fig8::{Figure, Scene};
use std::path::Path;

/// Interiors and a scan whose meshes are at hand; of Mora's own scenes only Conference is, in
/// another version.
const SCENES: [&str; 4] = ["sibenik", "conference", "sponza", "bunny"];

/// Measures through the same path as `run` and prints the paper's table.
pub fn paper(args: &PaperArgs) -> anyhow::Result<Verdict> {
    let Paper::Mora2011 = args.paper;
    if let Some(path) = &args.from {
        return print_from(path);
    }
    let mut figure = Figure::default();
    let film = film(args.resolution, Spp(1))?;
    let plan = plan(args, film, &mut figure)?;
    let progress = plan.progress();
    plan.warnings.iter().for_each(|w| progress.warn(w));
    let (document, findings) = run::execute(&plan, &progress, &mut |_, _, cells, _| {
        cells.iter().for_each(|cell| figure.take(cell));
        Ok(())
    })?;
    progress.finish();
    let results = format!("\nresults: {}\n", plan.out.display());
    print(
        &(figure.text([film.width(), film.height()]) + &results + &findings.text(&document, &plan)),
    )?;
    Ok(findings.verdict())
}

/// Prints the table of a result file.
fn print_from(path: &Path) -> anyhow::Result<Verdict> {
    let document = Document::read(path)?;
    let figure = Figure::of(&document);
    ensure!(
        !figure.is_empty(),
        "{}: has no scene with primary rays by mora2011 and mora2011-cones, and shadow-point rays \
         by mora2011-cones",
        path.display()
    );
    print(&figure.text(document.cells[0].key.resolution))?;
    Ok(Verdict::Good)
}

/// The batches that the three columns of Fig. 8 are made of. `figure` gets the scenes, those without
/// a mesh included.
fn plan(args: &PaperArgs, film: Film, figure: &mut Figure) -> anyhow::Result<RunPlan> {
    let engine = engine(&args.engine)?;
    let precision = precision(&args.precision)?;
    let mesh_folders = mesh_folders(&args.meshes);
    let names = match &args.scenes {
        Some(names) => distinct(names).collect(),
        None => SCENES.to_vec(),
    };
    let round = |rays, methods: &[Method]| -> anyhow::Result<Round> {
        let contestants = contestants(methods, &[precision], &KnobLists::default())?;
        Ok(Round {
            camera: None,
            film,
            rays,
            contestants,
        })
    };
    let (mut scenes, mut warnings) = (Vec::new(), Vec::new());
    for name in names {
        let source = SceneSource::find(name)?;
        if let Some(missing) = source.missing_mesh(&mesh_folders) {
            ensure!(args.scenes.is_none(), "{missing}");
            warnings.push(format!("left out: {missing}"));
            figure.scenes.push(Scene::missing(source.name()));
            continue;
        }
        figure.scenes.push(Scene::new(source.name()));
        let rounds = [
            round(RayType::Primary, &[Method::Mora2011, Method::Mora2011Cones])?,
            round(RayType::ShadowPoint, &[Method::Mora2011Cones])?,
        ];
        add_scene(&mut scenes, source, rounds.into())?;
    }
    ensure!(
        !scenes.is_empty(),
        "none of the meshes of {} is there; --meshes or DACRT_MESHES names folders, and \
         --scenes hall measures a generated scene",
        SCENES.join(", ")
    );
    check_writable(&args.out).context("--out")?;
    Ok(RunPlan {
        scenes,
        repeats: args.repeats.repeats,
        qualities: &Quality::ALL,
        exact_all: RANDOM_RAYS,
        engine,
        mesh_folders,
        out: args.out.clone(),
        resume: args.resume,
        peers: false,
        sweep: None,
        warnings,
    })
}
