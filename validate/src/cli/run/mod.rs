//! `dacrt run`: load, build Embree, make the rays, trace, check, measure, write; batch by batch.

mod answers;
mod cells;
mod contest;
mod progress;
mod reference;
mod report;

use super::Verdict;
use super::args::RunArgs;
use super::engine::Engine;
use super::plan::RunPlan;
use super::source::{SceneSource, View};
use answers::Answers;
use anyhow::Context;
use cells::{BatchKey, enter_times};
use contest::contest;
use dacrt::scene::Scene;
use dacrt::workloads::{Film, RayType, Workload};
use dacrt::{Batch, Method, Tracer, Workspace};
use dacrt_validate::diff::Checker;
use dacrt_validate::embree::{Device, Query};
use dacrt_validate::hash::{hit_hash, ray_hash};
use dacrt_validate::judge::Judge;
use dacrt_validate::machine::{Machine, Software};
use dacrt_validate::results::{Cell, Document, SCHEMA};
use progress::Progress;
use reference::Reference;
use report::Report;

/// Does the whole job; a finding is a wrong hit.
pub fn run(args: &RunArgs) -> anyhow::Result<Verdict> {
    let plan = RunPlan::new(args)?;
    let device = Device::new(1)?;
    let mut document = new_document(&plan, &device);
    if plan.resume {
        document.resume(&plan.out).context("--resume")?;
    }

    let progress = Progress::new(plan.groups());
    plan.warnings.iter().for_each(|w| progress.warn(w));
    let mut report = Report::new(&plan, &progress);
    for (source, view, rays) in &plan.scenes {
        let mut missing = Vec::new();
        for &film in &plan.films {
            for &ray_type in rays {
                let key = batch_key(source, view, film, ray_type);
                let finished: Option<Vec<Cell>> = (plan.contestants.iter())
                    .map(|c| document.finished(&key.cell(c)).cloned())
                    .collect();
                match finished {
                    Some(cells) => {
                        report.section(&key, &cells)?;
                        progress.advance(1);
                    }
                    None => missing.push((film, ray_type, key)),
                }
            }
        }
        if missing.is_empty() {
            continue;
        }
        progress.step(&format!("{}: loading", source.name()));
        let scene = Scene::load(&source.json, &plan.mesh_folders)?;
        let bench = Bench {
            reference: Reference::build(&device, &scene.mesh, plan.repeats, &progress)?,
            judge: Judge::new(&scene.mesh),
            scene: &scene,
            view,
            plan: &plan,
            progress: &progress,
        };
        for by_film in missing.chunk_by(|a, b| a.0 == b.0) {
            let mut workload = bench.workload(by_film[0].0)?;
            for (_, ray_type, key) in by_film {
                let cells = bench.batch(&mut workload, *ray_type, key)?;
                // What there is of this batch is not of this run.
                document.cells.retain(|cell| !key.has(&cell.key));
                document.cells.extend(cells.iter().cloned());
                document.write(&plan.out)?;
                report.section(key, &cells)?;
                progress.advance(1);
            }
        }
    }
    progress.finish();
    report.end()
}

fn new_document(plan: &RunPlan, device: &Device) -> Document {
    Document {
        schema: SCHEMA,
        machine: Machine::here(&plan.engine.isa.to_string()),
        software: Software::this(Some(device.info().into())),
        seed: plan.engine.seed,
        threads: 1,
        // Without the folders before the program's name.
        command: std::iter::once("dacrt".to_owned())
            .chain(std::env::args().skip(1))
            .collect(),
        cells: Vec::new(),
    }
}

fn batch_key(source: &SceneSource, view: &View, film: Film, ray_type: RayType) -> BatchKey {
    BatchKey {
        scene: source.name(),
        camera: view.camera_name.clone(),
        resolution: [film.width(), film.height()],
        spp: film.spp(),
        rays: ray_type.to_string(),
    }
}

/// One scene with all that its batches need.
struct Bench<'a> {
    scene: &'a Scene,
    view: &'a View,
    plan: &'a RunPlan,
    reference: Reference,
    judge: Judge<'a>,
    progress: &'a Progress,
}

impl Bench<'_> {
    fn workload(&self, film: Film) -> anyhow::Result<Workload<'_>> {
        let View { camera, light, .. } = *self.view;
        let seed = self.plan.engine.seed;
        Ok(Workload::new(&self.scene.mesh, camera, film, light, seed)?)
    }

    /// Makes the rays, checks the answers of every contestant, then measures those that are right.
    fn batch(
        &self,
        workload: &mut Workload,
        ray_type: RayType,
        key: &BatchKey,
    ) -> anyhow::Result<Vec<Cell>> {
        let step = |what: &str| {
            self.progress
                .step(&format!("{} {ray_type}: {what}", key.scene))
        };
        let (mesh, any) = (&self.scene.mesh, ray_type.is_any_hit());

        step("making rays");
        let batch = {
            // Always the baseline with its defaults, whatever the run is about.
            let tracer = Tracer::new(Method::Afra2012.parameters());
            let mut engine = Engine::new(tracer, mesh);
            let rays = workload.rays(ray_type, &mut |parents| engine.nearest(parents).0)?;
            rays.batch
        };
        let ray_hash = ray_hash(&batch);

        step("checking");
        let by_embree = |scene| {
            let mut answers = Answers::room(batch.len(), any);
            answers.trace_embree(scene, &batch, Query::Single);
            answers
        };
        let fast = by_embree(self.reference.fast());
        let robust = by_embree(&self.reference.robust);
        let seed = self.plan.engine.seed;
        let mut checker = Checker::new(&self.judge, &batch, fast.view(), robust.view(), seed);
        let mut workspace = Workspace::new(batch.len(), mesh.len());
        let mut cells = Vec::new();
        let mut validated = Vec::new();
        for (place, contestant) in self.plan.contestants.iter().enumerate() {
            let tracer = Tracer::new(contestant.parameters)
                .with_isa(self.plan.engine.isa)
                .with_seed(seed);
            let mut answers = Answers::room(batch.len(), any);
            let audited = tracer.with_audit(true);
            let trace = answers.trace(&audited, mesh, &batch, &mut workspace);
            let hit_hash = hit_hash(&answers.view());
            let diff = checker.check(answers.view(), &hit_hash);
            if diff.is_finding(mesh) {
                self.progress.warn(&format!(
                    "{} {ray_type} {}: {} wrong of {} rays; the offending rays are in {} (`dacrt trace --help` says how to trace them again)",
                    key.scene,
                    contestant.method,
                    diff.unexplained,
                    batch.len(),
                    self.plan.out.display()
                ));
            } else {
                validated.push((place, tracer, answers.clone()));
            }
            cells.push(Cell {
                key: key.cell(contestant),
                triangles: mesh.len(),
                dropped_triangles: mesh.dropped(),
                ray_count: batch.len(),
                invalid_rays: trace.invalid_rays,
                ray_hash: ray_hash.clone(),
                any_hit: any,
                shared_origin: trace.shared_origin,
                samples_ms: None,
                median_ms: None,
                mrays_per_s: None,
                acceleration_ratio: None,
                acceleration_interval: None,
                counters: as_object(&trace.counters)?,
                workspace_bytes: workspace.bytes(),
                hits: answers.hit_count(),
                hit_hash,
                diff,
                embree: None,
                ratio_embree_total: None,
                ratio_embree_total_interval: None,
                ratio_embree_trace: None,
                ratio_embree_trace_interval: None,
            });
        }

        step("measuring");
        self.measure(&batch, any, &validated, &mut workspace, &mut cells);
        Ok(cells)
    }

    fn measure(
        &self,
        batch: &Batch,
        any: bool,
        validated: &[(usize, Tracer, Answers)],
        workspace: &mut Workspace,
        cells: &mut [Cell],
    ) {
        // A batch without rays, or one that nobody gets right, has no times.
        if batch.is_empty() || validated.is_empty() {
            return;
        }
        let tracers: Vec<_> = validated
            .iter()
            .map(|(_, t, answers)| (t, answers))
            .collect();
        let times = contest(
            &self.scene.mesh,
            batch,
            &tracers,
            workspace,
            &self.reference,
            any,
            self.plan.repeats,
        );
        for &place in &times.unstable {
            let method = self.plan.contestants[validated[place].0].method;
            self.progress.warn(&format!(
                "{method}: a timed trace gave other hits than the one that was checked"
            ));
        }
        let passed: Vec<usize> = validated.iter().map(|(place, ..)| *place).collect();
        enter_times(
            cells,
            &passed,
            &self.plan.contestants,
            &times,
            &self.reference,
        );
    }
}

fn as_object(
    counters: &dacrt::Counters,
) -> anyhow::Result<serde_json::Map<String, serde_json::Value>> {
    Ok(serde_json::from_str(&serde_json::to_string(counters)?)?)
}
