//! `dacrt sweep`: the product of a sweep file, measured batch by batch, going on where it was.

use super::Verdict;
use super::args::SweepArgs;
use super::knobs::KnobLists;
use super::plan::{
    Request, Round, RunPlan, SceneJob, check_writable, distinct, engine, films, method, scene_jobs,
};
use super::run::{self, Origin};
use super::shard::Shard;
use super::size::{Resolution, Spp};
use super::source::mesh_folders;
use super::table::over;
use super::text::{counted, print};
use anyhow::{Context, ensure};
use dacrt::Method;
use dacrt_validate::atomic;
use dacrt_validate::sweep::{Size, Sweep, SweepRun};
use std::path::PathBuf;

/// Measures what the file says and is not there yet.
pub fn sweep(args: &SweepArgs) -> anyhow::Result<Verdict> {
    let plan = plan(args)?;
    let progress = plan.progress();
    plan.warnings.iter().for_each(|w| progress.warn(w));
    let mut resumed = 0;
    let (document, findings) = run::execute(&plan, &progress, &mut |key, round, cells, origin| {
        if origin == Origin::Resumed {
            resumed += cells.len();
            return Ok(());
        }
        let (done, to_go) = (progress.done(), progress.to_go());
        let comma = if to_go.is_empty() { "" } else { ", " };
        progress.note(&format!(
            "{done} {} {} {}: {}{comma}{to_go}",
            key.scene,
            key.rays,
            size_text(round),
            counted(cells.len() as u64, "cell"),
        ));
        Ok(())
    })?;
    progress.finish();
    let mut text = over::all(&document);
    text += &format!("results: {}", plan.out.display());
    if resumed > 0 {
        text += &format!(" ({} of an earlier run)", counted(resumed as u64, "cell"));
    }
    print(&(text + "\n" + &findings.text(&document, &plan)))?;
    Ok(findings.verdict())
}

fn size_text(round: &Round) -> String {
    let film = &round.film;
    match film.spp() {
        1 => format!("{}x{}", film.width(), film.height()),
        spp => format!("{}x{}x{spp}", film.width(), film.height()),
    }
}

fn plan(args: &SweepArgs) -> anyhow::Result<RunPlan> {
    let mut file = Sweep::load(&args.file)?;
    if let Some(scenes) = &args.scenes {
        file.scenes = scenes.clone();
    }
    if let Some(sizes) = &args.resolution {
        let sides = |r: &Resolution| Size::Sides([r.width, r.height]);
        file.resolution = sizes.iter().map(sides).collect();
    }
    if let Some(precisions) = &args.precision {
        file.precision = precisions.clone();
    }
    let engine = engine(&args.engine)?;
    let mesh_folders = mesh_folders(&args.meshes);
    let (mut scenes, warnings) =
        (jobs(&file, &mesh_folders)).with_context(|| args.file.display().to_string())?;
    if let Some(shard) = args.shard {
        only_shard(&mut scenes, shard)?;
    }
    let out = args.out.clone().unwrap_or_else(|| default_out(args));
    check_writable(&out).context("--out")?;
    atomic::remove_leftovers(&out);
    Ok(RunPlan {
        mesh_folders,
        resume: true,
        sweep: Some(SweepRun {
            file,
            shard: args.shard.map(|s| [s.place, s.of]),
        }),
        warnings,
        ..RunPlan::of(scenes, args.repeats.repeats, engine, out)
    })
}

/// The batches that a sweep file asks for, and warnings.
fn jobs(file: &Sweep, mesh_folders: &[PathBuf]) -> anyhow::Result<(Vec<SceneJob>, Vec<String>)> {
    let size = |size: &Size| {
        let [width, height] = size.sides();
        Resolution { width, height }
    };
    let sizes: Vec<Resolution> = file.resolution.iter().map(size).collect();
    let samples: Vec<Spp> = (file.spp.iter())
        .map(|n| n.to_string().parse())
        .collect::<Result<_, String>>()
        .map_err(|problem| anyhow::anyhow!("spp: {problem}"))?;
    let methods: Vec<Method> = distinct(&file.methods)
        .map(method)
        .collect::<anyhow::Result<_>>()?;
    let knobs = KnobLists::of_sweep(&file.parameters, &methods)?;
    let request = Request {
        scenes: Some(&file.scenes),
        cameras: file.cameras.as_deref(),
        rays: Some(&file.rays),
        methods: Some(&file.methods),
        precisions: &file.precision,
        films: films(&sizes, &samples)?,
        knobs: &knobs,
    };
    scene_jobs(&request, mesh_folders)
}

/// Leaves the batches of a shard.
fn only_shard(scenes: &mut Vec<SceneJob>, shard: Shard) -> anyhow::Result<()> {
    let batches = scenes.iter().map(|scene| scene.rounds.len()).sum();
    ensure!(
        shard.of as usize <= batches,
        "--shard {shard}: there are no more than {} to deal out: the cells of a batch are \
         measured in turns, so they stay together",
        counted_batches(batches)
    );
    let work: Vec<f64> = (scenes.iter())
        .flat_map(|scene| scene.rounds.iter().map(Round::work))
        .collect();
    let mut kept = shard.of_work(&work).into_iter();
    for scene in scenes.iter_mut() {
        scene.rounds.retain(|_| kept.next() == Some(true));
    }
    scenes.retain(|scene| !scene.rounds.is_empty());
    Ok(())
}

fn counted_batches(n: usize) -> String {
    match n {
        1 => "1 batch".to_owned(),
        n => format!("{n} batches"),
    }
}

/// `dacrt-bins.json` for `bins.json`, `dacrt-bins-2of3.json` for a shard of it; in this folder.
fn default_out(args: &SweepArgs) -> PathBuf {
    let stem = args.file.file_stem().unwrap_or_default().to_string_lossy();
    let shard = args.shard.map(|s| format!("-{}of{}", s.place, s.of));
    PathBuf::from(format!("dacrt-{stem}{}.json", shard.unwrap_or_default()))
}
