//! `dacrt run`: load, build Embree, make the rays, trace, check, measure, write; batch by batch.

mod answers;
mod cells;
mod contest;
mod findings;
mod reference;
mod twin;

use super::args::RunArgs;
use super::engine::{Engine, Workspaces};
use super::plan::{Contestant, Round, RunPlan, SceneJob};
use super::progress::Progress;
use super::shade;
use super::source::{SceneSource, Views};
use super::table::{Many, Report};
use super::text::print;
use super::{Verdict, command_line};
use anyhow::ensure;
use cells::{Peer, enter_times};
use contest::{Entrant, contest};
use dacrt::scene::load_meshes;
use dacrt::workloads::{RayType, Workload};
use dacrt::{Batch, Mesh, Method, Parameters, SpaceParameters, Tracer};
use dacrt_validate::diff::Checker;
use dacrt_validate::embree::{Device, Mode};
use dacrt_validate::hash::{hit_hash, ray_hash};
use dacrt_validate::judge::Judge;
use dacrt_validate::machine::{Machine, Software};
use dacrt_validate::peers;
use dacrt_validate::results::{Cell, CellKey, Document, SCHEMA};
use dacrt_validate::statistics::median;
use reference::PeerTree;
use std::time::Instant;
use twin::Original;

pub use answers::Answers;
pub use cells::BatchKey;
pub use findings::Findings;
pub use reference::Reference;

/// Does the whole job; a finding is a wrong hit.
pub fn run(args: &RunArgs) -> anyhow::Result<Verdict> {
    let plan = RunPlan::new(args)?;
    let progress = plan.progress();
    plan.warnings.iter().for_each(|w| progress.warn(w));
    let first = plan.rounds().next().map(|round| round.film);
    let cameras = |job: &SceneJob| job.rounds.iter().any(|r| r.camera != job.rounds[0].camera);
    let many = Many {
        sizes: plan.rounds().any(|round| Some(round.film) != first),
        cameras: plan.scenes.iter().any(cameras),
    };
    let mut report = Report::new(many, plan.engine.threads);
    let (document, findings) = execute(&plan, &progress, &mut |_, round, cells, _| {
        let labels: Vec<String> = round.contestants.iter().map(|c| c.label.clone()).collect();
        progress.print(&report.section(cells, &labels))
    })?;
    progress.finish();
    let results = format!("\nresults: {}\n", plan.out.display());
    print(&(report.end() + &results + &findings.text(&document, &plan)))?;
    Ok(findings.verdict())
}

/// Where the cells of a batch come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// They stood in the result file.
    Resumed,
    /// They are new.
    Measured,
}

/// Is given each batch as soon as it is finished: its round, and a cell for each contestant.
pub type Listener<'a> = dyn FnMut(&BatchKey, &Round, &[Cell], Origin) -> anyhow::Result<()> + 'a;

/// Does all of the plan under a bar, and says nothing of its batches.
pub fn measure(plan: &RunPlan) -> anyhow::Result<(Document, Findings)> {
    let progress = plan.progress();
    plan.warnings.iter().for_each(|w| progress.warn(w));
    let measured = execute(plan, &progress, &mut |_, _, _, _| Ok(()))?;
    progress.finish();
    Ok(measured)
}

/// Measures and checks all batches of the plan and writes the result file after each. Returns what
/// stands in that file, too.
pub fn execute(
    plan: &RunPlan,
    progress: &Progress,
    listener: &mut Listener,
) -> anyhow::Result<(Document, Findings)> {
    let threads = plan.engine.threads;
    let mut contestants = plan.rounds().flat_map(|round| &round.contestants);
    if threads > 1 && contestants.any(|c| !c.parameters.takes_threads()) {
        progress.warn(&format!(
            "--threads {threads}: all methods but best trace with one thread, Embree with {threads}"
        ));
    }
    let device = Device::new(threads)?;
    let mut document = new_document(plan, &device);
    if plan.resume {
        document.resume(&plan.out)?;
    }
    if plan.sweep.is_some() {
        only_of_this_sweep(&document, plan)?;
    }
    let mut findings = Findings::default();
    let mut finish = |key: &BatchKey, round: &Round, cells: &[Cell], origin| {
        findings.add(key, cells, progress);
        match origin {
            Origin::Resumed => progress.skip(round.work()),
            Origin::Measured => progress.advance(round.work()),
        }
        listener(key, round, cells, origin)
    };
    for job in &plan.scenes {
        let mut missing = Vec::new();
        for round in &job.rounds {
            let key = batch_key(job, round);
            let finished: Option<Vec<Cell>> = (round.contestants.iter())
                .map(|c| document.finished(&key.cell(c)).cloned())
                .map(|cell| cell.filter(|cell| !plan.peers || lacks_no_peers(cell)))
                .collect();
            match finished {
                Some(cells) => finish(&key, round, &cells, Origin::Resumed)?,
                None => missing.push((round, key)),
            }
        }
        if missing.is_empty() {
            continue;
        }
        progress.step(&format!("{}: loading", job.source.name()));
        let SceneSource { json, description } = &job.source;
        let mesh = load_meshes(json, description, &plan.mesh_folders)?;
        let is_timed = |mode: &Mode| {
            let mut rounds = missing.iter().map(|(round, _)| round);
            !plan.qualities.is_empty() && rounds.any(|round| round.is_against(*mode))
        };
        let timed: Vec<Mode> = Mode::ALL.into_iter().filter(is_timed).collect();
        let bench = Bench {
            reference: Reference::build(
                &device,
                &mesh,
                plan.repeats,
                &timed,
                plan.qualities,
                progress,
            )?,
            peers: match plan.peers {
                true => PeerTree::build_all(&mesh, plan.repeats, progress),
                false => Vec::new(),
            },
            judge: Judge::new(&mesh),
            mesh: &mesh,
            plan,
            progress,
        };
        let mut views = Views::new(&job.source, &mesh);
        let is_one_picture = |a: &Round, b: &Round| a.camera == b.camera && a.film == b.film;
        for picture in missing.chunk_by(|a, b| is_one_picture(a.0, b.0)) {
            let (first, _) = picture[0];
            let view = views.of(first.camera.as_deref())?;
            let mut workload = Workload::new(&mesh, view, first.film, plan.engine.seed)?;
            for (round, key) in picture {
                let cells = bench.batch(&mut workload, round, key)?;
                // What there is of this batch is not of this run.
                document.cells.retain(|cell| !key.has(&cell.key));
                document.cells.extend(cells.iter().cloned());
                document.write(&plan.out)?;
                finish(key, round, &cells, Origin::Measured)?;
            }
        }
    }
    Ok((document, findings))
}

/// Whether a cell has the times of other libraries, or no times at all.
fn lacks_no_peers(cell: &Cell) -> bool {
    !cell.peers.is_empty() || cell.samples_ms.is_none()
}

/// A sweep ends with its own cells and no others, all measured alike.
fn only_of_this_sweep(document: &Document, plan: &RunPlan) -> anyhow::Result<()> {
    let planned: Vec<CellKey> = (plan.scenes.iter())
        .flat_map(|job| job.rounds.iter().map(move |round| (job, round)))
        .flat_map(|(job, round)| {
            let batch = batch_key(job, round);
            round.contestants.iter().map(move |c| batch.cell(c))
        })
        .collect();
    let path = plan.out.display();
    for cell in &document.cells {
        let CellKey {
            scene,
            rays,
            method,
            ..
        } = &cell.key;
        ensure!(
            planned.iter().any(|key| key.is(&cell.key)),
            "{path}: has a cell that is not of this sweep ({scene} {rays} {method}); \
             give another --out"
        );
        let repeats = cell
            .samples_ms
            .as_ref()
            .map_or(plan.repeats as usize, Vec::len);
        ensure!(
            repeats == plan.repeats as usize,
            "{path}: has cells of {repeats} repeats, here it is {}; give another --out",
            plan.repeats
        );
    }
    Ok(())
}

fn new_document(plan: &RunPlan, device: &Device) -> Document {
    Document {
        schema: SCHEMA,
        machine: Machine::here(&plan.engine.isa.to_string()),
        software: Software::this(Some(device.info().into())),
        seed: plan.engine.seed,
        threads: plan.engine.threads,
        command: command_line(),
        sweep: plan.sweep.clone(),
        pieces: Vec::new(),
        cells: Vec::new(),
        accepted: Vec::new(),
    }
}

/// What the cells of a round have in common.
pub fn batch_key(job: &SceneJob, round: &Round) -> BatchKey {
    let Round {
        camera, film, rays, ..
    } = round;
    BatchKey {
        scene: job.source.name(),
        camera: job.source.camera_name(camera.as_deref()).to_owned(),
        resolution: [film.width(), film.height()],
        spp: film.spp(),
        rays: rays.to_string(),
    }
}

/// The rays of one type, secondary ones from the hits of their parents: always those of the baseline
/// with its defaults in precision `fast`, whatever is measured.
pub fn make_rays(workload: &mut Workload, ray_type: RayType, mesh: &Mesh) -> anyhow::Result<Batch> {
    let tracer = Tracer::new(Method::Afra2012.parameters());
    let mut engine = Engine::new(tracer, mesh);
    let rays = workload.rays(ray_type, &mut |parents| engine.nearest(parents).0)?;
    Ok(rays.batch)
}

/// One scene with all that its batches need.
struct Bench<'a> {
    mesh: &'a Mesh,
    plan: &'a RunPlan,
    reference: Reference,
    /// Trees of other libraries, where they are asked for.
    peers: Vec<PeerTree>,
    judge: Judge<'a>,
    progress: &'a Progress,
}

impl Bench<'_> {
    /// Makes the rays, checks the answers of every contestant, then measures those that are right.
    fn batch(
        &self,
        workload: &mut Workload,
        round: &Round,
        key: &BatchKey,
    ) -> anyhow::Result<Vec<Cell>> {
        let ray_type = round.rays;
        let step = |what: &str| {
            self.progress
                .step(&format!("{} {ray_type}: {what}", key.scene))
        };
        let (mesh, any) = (self.mesh, ray_type.is_any_hit());

        step("making rays");
        let batch = make_rays(workload, ray_type, mesh)?;
        let ray_hash = ray_hash(&batch);

        step("checking");
        let [fast, robust] = self.reference.answers(&batch, any);
        let seed = self.plan.engine.seed;
        let (fast, robust) = (fast.view(), robust.view());
        let mut checker =
            Checker::new(&self.judge, &batch, fast, robust, self.plan.exact_all, seed);
        let mut workspaces = Workspaces::new(batch.len(), mesh.len(), self.plan.engine.threads);
        let mut cells = Vec::new();
        let mut entrants = Vec::new();
        for (place, contestant) in round.contestants.iter().enumerate() {
            let Contestant {
                parameters,
                precision,
                ..
            } = *contestant;
            let tracer = self.plan.engine.tracer(parameters, precision);
            let mut answers = Answers::room(batch.len(), any);
            let audited = tracer.with_audit(true);
            let workspace = workspaces.of(&parameters);
            let workspace_bytes = workspace.bytes();
            let trace = answers.trace(&audited, mesh, &batch, workspace);
            let printed_rule_wrong = without_printed_rule(&parameters).map(|right| {
                let mut expected = Answers::room(batch.len(), any);
                let right = self.plan.engine.tracer(right, precision);
                expected.trace(&right, mesh, &batch, workspace);
                answers.differing(&expected) as u64
            });
            let hit_hash = hit_hash(&answers.view());
            let diff = checker.check(precision, answers.view(), &hit_hash);
            let mut key = key.cell(contestant);
            if let Some(variant) = trace.variant {
                key.parameters
                    .insert("variant".to_owned(), serde_json::to_value(variant)?);
            }
            let is_finding = diff.wrong() > 0;
            cells.push(Cell {
                key,
                threads: Some(self.plan.engine.threads_of(&parameters)),
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
                time_over_fast: None,
                time_over_fast_interval: None,
                counters: as_object(&trace.counters)?,
                shade_ms: None,
                workspace_bytes,
                hits: answers.hit_count(),
                hit_hash,
                diff,
                printed_rule_wrong,
                embree: None,
                ratio_embree_total: None,
                ratio_embree_total_interval: None,
                ratio_embree_trace: None,
                ratio_embree_trace_interval: None,
                peers: Vec::new(),
                twin: None,
            });
            if !is_finding {
                entrants.push(Entrant {
                    place,
                    parameters,
                    precision,
                    tracer,
                    answers,
                });
            }
        }

        step("measuring");
        self.measure(&batch, round, &entrants, &mut workspaces, &mut cells);
        if self.plan.twins && !batch.is_empty() {
            step("sending rays through stored splits");
            // Rays of a lens are not those that the others start from.
            let primary = match ray_type {
                RayType::Primary | RayType::Dof => None,
                _ => Some(make_rays(workload, RayType::Primary, mesh)?),
            };
            let batches = (&batch, primary.as_ref());
            self.twins(batches, &entrants, &mut workspaces, &mut cells);
        }
        if let (true, Some(entrant)) = (self.plan.shade, entrants.first()) {
            let shade_ms = self.shade(&batch, &entrant.answers);
            let measured = cells.iter_mut().filter(|cell| cell.median_ms.is_some());
            measured.for_each(|cell| cell.shade_ms = shade_ms);
        }
        Ok(cells)
    }

    fn twins(
        &self,
        (batch, primary): (&Batch, Option<&Batch>),
        entrants: &[Entrant],
        workspaces: &mut Workspaces,
        cells: &mut [Cell],
    ) {
        for entrant in entrants {
            let workspace = workspaces.of(&entrant.parameters);
            let original = Original {
                tracer: &entrant.tracer,
                parameters: &entrant.parameters,
                mesh: self.mesh,
                batch,
                answers: &entrant.answers,
                repeats: self.plan.repeats,
            };
            let of_lists = matches!(entrant.parameters, Parameters::Object(_));
            let twin = original.twin(workspace, primary.filter(|_| of_lists));
            if !twin.is_equal() {
                let cell = &cells[entrant.place].key;
                self.progress.warn(&format!(
                    "{} {} {}: other tests or hits by the stored splits",
                    cell.scene, cell.rays, cell.method
                ));
            }
            cells[entrant.place].twin = Some(twin);
        }
    }

    /// Median milliseconds of shading what the rays hit; none of any-hit rays.
    fn shade(&self, batch: &Batch, answers: &Answers) -> Option<f64> {
        let Answers::Nearest(hits) = answers else {
            return None;
        };
        let mut greys = vec![0; batch.len()];
        let samples: Vec<f64> = (0..self.plan.repeats)
            .map(|_| {
                let start = Instant::now();
                shade::flat(self.mesh, batch, hits, &mut greys);
                start.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        median(&samples)
    }

    fn measure(
        &self,
        batch: &Batch,
        round: &Round,
        entrants: &[Entrant],
        workspaces: &mut Workspaces,
        cells: &mut [Cell],
    ) {
        // A batch without rays, or one that nobody gets right, has no times.
        if batch.is_empty() || entrants.is_empty() {
            return;
        }
        let peers = self.check_peers(batch, &entrants[0].answers, round.rays.is_any_hit());
        let trees: Vec<&PeerTree> = peers.iter().map(|peer| peer.built).collect();
        let times = contest(
            self.mesh,
            batch,
            entrants,
            workspaces,
            &self.reference,
            &trees,
            self.plan.repeats,
        );
        for &i in &times.unstable {
            let method = round.contestants[entrants[i].place].method;
            self.progress.warn(&format!(
                "{method}: a timed trace gave other hits than the one that was checked"
            ));
        }
        let passed: Vec<usize> = entrants.iter().map(|entrant| entrant.place).collect();
        enter_times(
            cells,
            &passed,
            &round.contestants,
            &times,
            &self.reference,
            &peers,
        );
    }

    /// Holds the hits of other libraries against ours; leaves out those that panic, and warns.
    fn check_peers(&self, batch: &Batch, ours: &Answers, any: bool) -> Vec<Peer<'_>> {
        let checked = self.peers.iter().filter_map(|built| {
            let PeerTree { peer, tree, .. } = built;
            let mut theirs = Answers::room(batch.len(), any);
            let traced = peers::unless_it_panics(|| theirs.trace_peer(&**tree, batch));
            if traced.is_none() {
                let warning = format!("{} {}: panics, and is left out", peer.name, peer.builder);
                self.progress.warn(&warning);
                return None;
            }
            Some(Peer {
                built,
                differing_rays: peers::differing_rays(ours.view(), theirs.view()),
            })
        });
        checked.collect()
    }
}

/// The same parameters but for the rule of termination as printed, where that is on.
fn without_printed_rule(parameters: &Parameters) -> Option<Parameters> {
    match *parameters {
        Parameters::Space(
            space @ SpaceParameters {
                terminate_as_printed: true,
                ..
            },
        ) => Some(Parameters::Space(SpaceParameters {
            terminate_as_printed: false,
            ..space
        })),
        _ => None,
    }
}

fn as_object(
    counters: &dacrt::Counters,
) -> anyhow::Result<serde_json::Map<String, serde_json::Value>> {
    Ok(serde_json::from_str(&serde_json::to_string(counters)?)?)
}
