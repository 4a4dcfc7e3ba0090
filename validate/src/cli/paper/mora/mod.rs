//! `dacrt paper mora2011`: Figs. 6, 8, 10 and 14.

pub mod fig8;
mod frames;
mod paths;

use crate::cli::Verdict;
use crate::cli::args::PaperArgs;
use crate::cli::knobs::KnobLists;
use crate::cli::paper::find_scenes;
use crate::cli::plan::{
    Round, RunPlan, add_scene, check_writable, contestants, distinct, engine, film, precision,
};
use crate::cli::run;
use crate::cli::size::{Resolution, Spp};
use crate::cli::source::mesh_folders;
use crate::cli::text::print;
use anyhow::{Context, ensure};
use dacrt::Method;
use dacrt::workloads::{Film, RayType};
use dacrt_validate::results::{Cell, Document};
use fig8::Figure;

/// Interiors and scans whose meshes are at hand. Of Mora's own scenes these are Bunny and Dragon; Conference
/// is another version, the last three have fewer triangles.
const SCENES: [&str; 8] = [
    "sibenik",
    "conference",
    "sponza",
    "bunny",
    "dragon",
    "armadillo",
    "buddha",
    "lucy",
];

/// Measures through the same path as `run` and prints the paper's tables.
pub fn mora2011(args: &PaperArgs) -> anyhow::Result<Verdict> {
    if let Some(path) = &args.from {
        let document = Document::read(path)?;
        ensure!(
            !Figure::of(&document.cells).is_empty(),
            "{}: has no scene with primary rays by mora2011 and mora2011-cones, and shadow-point \
             rays by mora2011-cones",
            path.display()
        );
        print(&text(&document.cells, &[]))?;
        return Ok(Verdict::Good);
    }
    let (plan, missing) = plan(args)?;
    let (document, findings) = run::measure(&plan)?;
    let results = format!("\nresults: {}\n", plan.out.display());
    print(&(text(&document.cells, &missing) + &results + &findings.text(&document, &plan)))?;
    Ok(findings.verdict())
}

/// All figures of which there is something; `missing` are scenes without a mesh.
fn text(cells: &[Cell], missing: &[String]) -> String {
    let of_frames = frames::FIGURES
        .iter()
        .filter_map(|figure| figure.text(cells));
    let mut figures = vec![Figure::of(cells).text(missing)];
    figures.extend(of_frames);
    figures.extend(paths::text(cells));
    figures.join("\n")
}

/// The batches that the figures are made of, and the scenes whose meshes are missing.
fn plan(args: &PaperArgs) -> anyhow::Result<(RunPlan, Vec<String>)> {
    let engine = engine(&args.engine)?;
    let precision = precision(&args.precision)?;
    let mesh_folders = mesh_folders(&args.meshes);
    let names: Vec<&str> = match &args.scenes {
        Some(names) => distinct(names).collect(),
        None => SCENES.to_vec(),
    };
    let film = |[width, height]: [u32; 2]| {
        film(
            args.resolution.unwrap_or(Resolution { width, height }),
            Spp(1),
        )
    };
    let round = |film, rays, methods: &[Method]| -> anyhow::Result<Round> {
        let contestants = contestants(methods, &[precision], &KnobLists::default())?;
        Ok(Round {
            camera: None,
            film,
            rays,
            contestants,
        })
    };
    let mut rounds: Vec<Round> = Vec::new();
    let of_fig8 = film(fig8::SIZE)?;
    let basic = [Method::Mora2011, Method::Mora2011Cones];
    rounds.push(round(of_fig8, RayType::Primary, &basic)?);
    rounds.push(round(of_fig8, RayType::ShadowPoint, &basic[1..])?);
    for figure in &frames::FIGURES {
        rounds.push(round(film(figure.size)?, RayType::Primary, &basic[1..])?);
    }
    for bounce in paths::BOUNCES {
        let film = film(paths::SIZE)?;
        rounds.push(round(
            film,
            RayType::Diffuse(bounce),
            &[Method::Mora2011Random],
        )?);
    }
    let rounds = distinct_batches(rounds);

    let (sources, left_out) = find_scenes(names, args, &mesh_folders)?;
    let (missing, warnings) = left_out.into_iter().unzip();
    let mut scenes = Vec::new();
    for source in sources {
        add_scene(&mut scenes, source, rounds.clone())?;
    }
    ensure!(
        !scenes.is_empty(),
        "none of the meshes of {} is there; --meshes or DACRT_MESHES names folders, and \
         --scenes hall measures a generated scene",
        SCENES.join(", ")
    );
    check_writable(&args.out).context("--out")?;
    let plan = RunPlan {
        mesh_folders,
        resume: args.resume,
        shade: true,
        warnings,
        ..RunPlan::of(scenes, args.repeats(), engine, args.out.clone())
    };
    Ok((plan, missing))
}

/// Each batch once, with the contestants of the first.
fn distinct_batches(rounds: Vec<Round>) -> Vec<Round> {
    let mut distinct: Vec<Round> = Vec::new();
    let batch = |round: &Round| -> (Film, RayType) { (round.film, round.rays) };
    for round in rounds {
        if !distinct.iter().any(|other| batch(other) == batch(&round)) {
            distinct.push(round);
        }
    }
    distinct
}

/// The size of a figure if there are such cells, else that of the first.
fn size_of(cells: &[&Cell], size: [u32; 2]) -> [u32; 2] {
    let has = |cell: &&Cell| cell.key.resolution == size;
    let first = cells.first().map_or(size, |cell| cell.key.resolution);
    if cells.iter().any(has) { size } else { first }
}
