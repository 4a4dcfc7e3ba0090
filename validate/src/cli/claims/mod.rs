//! `dacrt claims`: the papers' claims, each judged by what is measured for it.

mod plan;
pub mod text;

use super::args::ClaimsArgs;
use super::plan::Engine;
use super::run::{self, Answers, make_rays};
use super::source::{SceneSource, Views, mesh_folders};
use super::text::{complain, print};
use super::{Verdict, command_line};
use anyhow::Context;
use dacrt::workloads::{Film, Workload};
use dacrt::{Isa, Method, Precision};
use dacrt_validate::claims::{
    Claims, Document, Evidence, KIND, Kind, MemoryUse, NodeStatistics, SeedsOn, Study, list,
    verdicts, write_list,
};
use dacrt_validate::machine::Software;
use dacrt_validate::stack;
use plan::Extent;
use std::fs;
use std::path::Path;

/// Measures what is not there yet, and prints the verdicts.
pub fn claims(args: &ClaimsArgs) -> anyhow::Result<Verdict> {
    let claims = Claims::load(args.only.as_deref())?;
    let (folder, verdict) = match &args.from {
        Some(folder) => (folder, Verdict::Good),
        None => (&args.out, measure(args, &claims)?),
    };
    let evidence = Evidence::read(folder)?;
    let first = evidence.documents.first();
    let document = Document {
        kind: KIND.to_owned(),
        machines: SeedsOn::of(&evidence),
        software: first.map_or_else(|| Software::this(None), |d| d.software.clone()),
        command: command_line(),
        findings: verdicts(&claims, &evidence),
    };
    let mut all = text::text(&document, args.only.is_some());
    // A part of the claims is for looking at, not the folder's verdicts.
    if args.only.is_none() {
        let out = folder.join("claims.json");
        document
            .write(&out)
            .with_context(|| format!("cannot write {}", out.display()))?;
        all += &format!("\nverdicts: {}\n", out.display());
    }
    print(&all)?;
    Ok(verdict)
}

/// Measures all studies, seed by seed.
fn measure(args: &ClaimsArgs, claims: &Claims) -> anyhow::Result<Verdict> {
    let folder = &args.out;
    fs::create_dir_all(folder).with_context(|| format!("--out: {}", folder.display()))?;
    let mesh_folders = mesh_folders(&args.meshes);
    let mut verdict = Verdict::Good;
    let seeds = if args.quick { 1 } else { args.seeds };
    for seed in args.first_seed..args.first_seed + seeds {
        let extent = Extent {
            quick: args.quick,
            cameras: if args.quick { 1 } else { args.cameras },
            repeats: args.repeats,
            engine: Engine {
                isa: Isa::best(),
                seed,
                threads: 1,
            },
            mesh_folders: &mesh_folders,
        };
        let files = [
            (Kind::Cells, Evidence::cells(folder, seed)),
            (Kind::Embree, Evidence::embree(folder, seed)),
            (Kind::Twins, Evidence::twins(folder, seed)),
        ];
        for (kind, out) in files {
            if let Some(plan) = extent.plan(claims, kind, &out)? {
                complain(&format!("seed {seed}: {}", out.display()));
                let (document, findings) = run::measure(&plan)?;
                if findings.verdict() == Verdict::Finding {
                    print(&findings.text(&document, &plan))?;
                    verdict = Verdict::Finding;
                }
            }
        }
        for study in claims.studies.values() {
            match study.kind {
                Kind::Cells | Kind::Embree | Kind::Twins => {}
                Kind::Nodes => nodes(&extent, study, &Evidence::nodes(folder))?,
                Kind::Memory if seed > 1 => {}
                Kind::Memory => memory(&extent, study, &Evidence::memory(folder))?,
            }
        }
    }
    Ok(verdict)
}

/// Writes down what is to be known of the nodes of each batch.
fn nodes(extent: &Extent, study: &Study, out: &Path) -> anyhow::Result<()> {
    let mut all: Vec<NodeStatistics> = list(out)?;
    let seed = extent.engine.seed;
    for source in extent.sources(study)? {
        let cameras = extent.cameras(study);
        let name = |camera: &Option<String>| source.camera_name(camera.as_deref()).to_owned();
        let (mut batches, mut missing) = (Vec::new(), false);
        for camera in &cameras {
            for [side, spp] in study.sizes(extent.quick) {
                for rays in &study.rays {
                    let entry = NodeStatistics {
                        scene: source.name(),
                        camera: name(camera),
                        resolution: side,
                        spp,
                        rays: rays.clone(),
                        seed,
                        ..Default::default()
                    };
                    missing |= !all.iter().any(|other| other.is_of_batch_of(&entry));
                    batches.push((camera, entry));
                }
            }
        }
        if !missing {
            continue;
        }
        complain(&format!("seed {seed}: nodes of {}", source.name()));
        let mesh = source.mesh(extent.mesh_folders)?;
        let mut views = Views::new(&source, &mesh);
        for (camera, entry) in batches {
            let film = Film::new(entry.resolution, entry.resolution, entry.spp)?;
            let mut workload = Workload::new(&mesh, views.of(camera.as_deref())?, film, seed)?;
            let rays = super::plan::ray_type(&entry.rays)?;
            let batch = make_rays(&mut workload, rays, &mesh)?;
            let parameters = Method::Nabata2013.parameters();
            let tracer = extent.engine.tracer(parameters, Precision::Fast);
            let mut workspace = tracer.workspace(batch.len(), mesh.len());
            let mut answers = Answers::room(batch.len(), rays.is_any_hit());
            let (_, records) = answers.log(&tracer, &mesh, &batch, &mut workspace);
            let entry = entry.count(&records);
            all.retain(|other| !other.is_of_batch_of(&entry));
            all.push(entry);
        }
        write_list(out, &all)?;
    }
    Ok(())
}

/// Measures workspace and stack of each batch.
fn memory(extent: &Extent, study: &Study, out: &Path) -> anyhow::Result<()> {
    if out.exists() {
        return Ok(());
    }
    let mut all = Vec::new();
    for source in extent.sources(study)? {
        complain(&format!("memory of {}", source.name()));
        let mesh = source.mesh(extent.mesh_folders)?;
        let mut views = Views::new(&source, &mesh);
        for [side, spp] in study.sizes(extent.quick) {
            let film = Film::new(side, side, spp)?;
            for rays in &study.rays {
                let rays = super::plan::ray_type(rays)?;
                let mut workload = Workload::new(&mesh, views.of(None)?, film, extent.engine.seed)?;
                let batch = make_rays(&mut workload, rays, &mesh)?;
                for method in study.methods.keys() {
                    let method = super::plan::method(method)?;
                    let tracer = extent.engine.tracer(method.parameters(), Precision::Fast);
                    let mut workspace = tracer.workspace(batch.len(), mesh.len());
                    let mut answers = Answers::room(batch.len(), rays.is_any_hit());
                    let trace = || {
                        answers.trace(&tracer, &mesh, &batch, &mut workspace);
                    };
                    let stack_bytes = stack::bytes(trace).context("size of the stack")?;
                    all.push(MemoryUse {
                        scene: source.name(),
                        method: method.to_string(),
                        rays: batch.len(),
                        triangles: mesh.len(),
                        workspace_bytes: workspace.bytes(),
                        stack_bytes,
                    });
                }
            }
        }
    }
    write_list(out, &all)
}

impl Extent<'_> {
    /// The scenes of a study whose meshes are there.
    fn sources(&self, study: &Study) -> anyhow::Result<Vec<SceneSource>> {
        let mut sources = Vec::new();
        for name in &study.scenes {
            let source = SceneSource::find(name)?;
            match source.missing_mesh(self.mesh_folders) {
                None => sources.push(source),
                Some(missing) => complain(&format!("warning: left out: {missing}")),
            }
        }
        Ok(sources)
    }
}
