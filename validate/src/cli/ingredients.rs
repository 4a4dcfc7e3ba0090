//! `dacrt bench ingredients`: what each numerical ingredient does alone.

use super::Verdict;
use super::args::BenchArgs;
use super::bench::short;
use super::plan::distinct;
use super::progress::Progress;
use super::source::{SceneSource, Views, mesh_folders};
use super::text::{columns, complain, counted, print, thousands};
use anyhow::{Context, bail};
use dacrt::bench::ingredients::BOX_TESTS;
use dacrt::scene::Scene;
use dacrt::workloads::{Film, RayType, Workload};
use dacrt::{Hits, Isa, Method, Tracer};
use dacrt_validate::exact::Arbiter;
use dacrt_validate::ingredients::{
    Document, KIND, Plan, Set, Source, Spread, Times, hard, measure, of_rays, time,
};
use dacrt_validate::machine::{Machine, Software};

const RAYS: [RayType; 2] = [RayType::Primary, RayType::Diffuse(1)];
const SEED: u64 = 1;

/// Measures, writes and prints. A finding is a promise of `watertight` or `exact` that does not hold.
pub fn ingredients(args: &BenchArgs, isas: Vec<Isa>) -> anyhow::Result<Verdict> {
    let isa = isas[0];
    let (side, made_up) = if args.quick {
        (16, 512)
    } else {
        (512, 1 << 19)
    };
    let default = ["hall".to_owned()];
    let names: Vec<&str> = distinct(args.scenes.as_deref().unwrap_or(&default)).collect();
    let scenes = names.iter().map(|name| {
        let scene = SceneSource::find(name)?;
        match scene.missing_mesh(&mesh_folders(&args.meshes)) {
            Some(missing) => bail!(missing),
            None => Ok(scene),
        }
    });
    let scenes: Vec<SceneSource> = scenes.collect::<anyhow::Result<_>>()?;

    let progress = Progress::new(&vec![1.0; scenes.len() + 2]);
    let mut sets = Vec::new();
    for scene in &scenes {
        progress.step(&scene.name());
        for source in of_scene(args, scene, Film::new(side, side, 1)?)? {
            sets.push(measure(&source, isa));
        }
        progress.advance(1.0);
    }
    progress.step("hard pairs");
    sets.extend(hard(made_up, SEED).iter().map(|hard| measure(hard, isa)));
    progress.advance(1.0);
    progress.step("times");
    let times = time(&Plan {
        isas,
        repeats: args.repeats as usize,
        sample_ns: if args.quick { 2e4 } else { 5e6 },
    });
    progress.finish();

    let document = Document {
        kind: KIND.to_owned(),
        machine: Machine::here(isa.name()),
        software: Software::this(None),
        // Without the folders before the program's name.
        command: std::iter::once("dacrt".to_owned())
            .chain(std::env::args().skip(1))
            .collect(),
        isa: isa.name().to_owned(),
        sets,
        times,
    };
    let path = args.out.display();
    (document.write(&args.out)).with_context(|| format!("{path}: cannot be written"))?;
    print(&format!("{}\nresults: {path}\n", text(&document)))?;
    let broken = document.broken_promises();
    for promise in &broken {
        complain(&format!("finding: {promise}"));
    }
    Ok(match broken.is_empty() {
        true => Verdict::Good,
        false => Verdict::Finding,
    })
}

/// The pairs of a scene.
fn of_scene(args: &BenchArgs, scene: &SceneSource, film: Film) -> anyhow::Result<Vec<Source>> {
    let mesh = Scene::load(&scene.json, &mesh_folders(&args.meshes))?.mesh;
    let view = Views::new(scene, &mesh).of(None)?;
    let arbiter = Arbiter::new(&mesh);
    let tracer = Tracer::new(Method::Afra2012.parameters());
    let mut workload = Workload::new(&mesh, view, film, SEED)?;
    let mut sources = Vec::new();
    for ray_type in RAYS {
        let rays = workload.rays(ray_type, &mut |parents| {
            let mut hits = Hits::misses(parents.len());
            let mut workspace = tracer.workspace(parents.len(), mesh.len());
            tracer.nearest(&mesh, parents, &mut workspace, &mut hits);
            hits
        })?;
        let name = format!("{} {ray_type}", scene.name());
        sources.extend(of_rays(&name, &arbiter, &rays.batch, SEED));
    }
    Ok(sources)
}

/// The tables for people.
fn text(document: &Document) -> String {
    let mut text = String::new();
    for set in &document.sets {
        text += &format!(
            "{}: {}, {}\n\n{}\n{}\n",
            set.name,
            counted(set.pairs, "pair"),
            counted(set.hits, "hit"),
            triangles(set),
            boxes(set)
        );
    }
    let Document { isa, times, .. } = document;
    text += &format!("Errors on {isa}. Times in the L1 cache:\n");
    for first in times
        .box_tests
        .iter()
        .filter(|t| t.test == BOX_TESTS[0].name)
    {
        text += &format!("\n{}", in_time(&first.isa, times));
    }
    text
}

fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

fn triangles(set: &Set) -> String {
    let mut rows = vec![row([
        "ray/triangle",
        "lost /M",
        "false /M",
        "ulp: half",
        "99.9 %",
        "most",
        "relative: 99.9 %",
        "most",
    ])];
    for e in &set.triangle_tests {
        let name = match e.record {
            true => format!("precision {}", e.test),
            false => e.test.clone(),
        };
        let of = |spread: &Option<Spread>, show: fn(f64) -> String| match spread {
            None => [const { String::new() }; 3],
            Some(s) => [s.median, s.p999, s.max].map(show),
        };
        let ulps = of(&e.ulps, digits);
        let relative = of(&e.relative, |x| format!("{x:.1e}"));
        rows.push(row([
            &name,
            &per_million(e.lost, set.pairs),
            &per_million(e.false_hits, set.pairs),
            &ulps[0],
            &ulps[1],
            &ulps[2],
            &relative[1],
            &relative[2],
        ]));
    }
    columns(&rows, &[1, 2, 3, 4, 5, 6, 7])
}

fn boxes(set: &Set) -> String {
    let mut rows = vec![row([
        "ray/box",
        "missed /M",
        "t of fast outside /M",
        "exact t outside /M",
    ])];
    for e in &set.box_tests {
        let share = |n| per_million(n, set.box_pairs);
        rows.push(row([
            &e.test,
            &share(e.missed),
            &share(e.fast_t_outside),
            &share(e.exact_t_outside),
        ]));
    }
    columns(&rows, &[1, 2, 3])
}

/// Times on one instruction set.
fn in_time(isa: &str, times: &Times) -> String {
    let mut rows = Vec::new();
    for (what, ours, times) in [
        ("ray/triangle", "x fast [95 %]", &times.triangle_tests),
        ("naive step", "x fast [95 %]", &times.precisions),
        ("ray/box", "x padded [95 %]", &times.box_tests),
    ] {
        rows.push(row([&format!("{isa}: {what}"), "ns [95 %]", ours]));
        for time in times.iter().filter(|t| t.isa == isa) {
            let [ns, ratio] = [&time.ns, &time.over_first].map(|ratio| {
                let [low, high] = ratio.interval.map(short);
                format!("{} [{low}, {high}]", short(ratio.ratio))
            });
            rows.push(row([&time.test, &ns, &ratio]));
        }
    }
    columns(&rows, &[1, 2])
}

/// Exactly, or with three digits that count.
fn per_million(n: u64, of: u64) -> String {
    match (n, of) {
        (0, _) | (_, 0) => "0".to_owned(),
        _ => digits(1e6 * n as f64 / of as f64),
    }
}

/// Three digits that count, or all before the point.
fn digits(x: f64) -> String {
    match x {
        _ if x < 999.5 => short(x),
        _ if x < 1e7 => thousands(x.round() as u64),
        _ => format!("{x:.1e}"),
    }
}
