//! `dacrt bench throughput`: threads that trace a copy of the batch each, beside threads that share
//! one trace.

use super::Verdict;
use super::args::BenchArgs;
use super::bench::short;
use super::command_line;
use super::engine::Workspaces;
use super::plan::{Engine, Request, Round, SceneJob, films, scene_jobs};
use super::progress::Progress;
use super::run::{Answers, Reference, batch_key, make_rays};
use super::size::{Resolution, Spp};
use super::source::{Views, mesh_folders};
use super::text::{columns, complain, counted, print, thousands};
use anyhow::{Context, ensure};
use dacrt::scene::Scene;
use dacrt::workloads::Workload;
use dacrt::{Batch, Isa, Mesh, Method, Precision, Tracer};
use dacrt_validate::diff::{Checker, RANDOM_RAYS};
use dacrt_validate::embree::{Committed, Device, Mode, Quality, Query};
use dacrt_validate::hash::{hit_hash, ray_hash};
use dacrt_validate::judge::Judge;
use dacrt_validate::machine::{Machine, Software};
use dacrt_validate::measure::{interleave, milliseconds};
use dacrt_validate::statistics::{Ratio, least, median, paired_ratio};
use dacrt_validate::throughput::{BatchTimes, Crew, Document, KIND, Scheme, Timing};
use std::convert::Infallible;
use std::iter;
use std::sync::Mutex;

const SEED: u64 = 1;
/// Traces of each combination of quality and query by which Embree's best is found.
const TRIALS: usize = 2;

/// Measures, writes and prints. A finding is a wrong hit, or a thread with other hits.
pub fn throughput(args: &BenchArgs, isas: Vec<Isa>) -> anyhow::Result<Verdict> {
    ensure!(
        args.isa.is_none() || isas.len() == 1,
        "--isa: `bench throughput` takes one instruction set"
    );
    let engine = Engine {
        isa: isas[0],
        seed: SEED,
        threads: 1,
    };
    let typed = &args.throughput;
    let side = if args.quick { 32 } else { 512 };
    let size = Resolution {
        width: side,
        height: side,
    };
    let mesh_folders = mesh_folders(&args.meshes);
    let default_scenes = ["hall".to_owned()];
    let all_methods = Method::ALL.map(|method| method.name().to_owned());
    let request = Request {
        scenes: Some(args.scenes.as_deref().unwrap_or(&default_scenes)),
        cameras: None,
        rays: typed.rays.as_deref(),
        methods: Some(typed.methods.as_deref().unwrap_or(&all_methods)),
        precisions: &[Precision::Fast.name().to_owned()],
        films: films(typed.resolution.as_deref().unwrap_or(&[size]), &[Spp(1)])?,
        knobs: &Default::default(),
    };
    // Its warnings are about ratios to the baseline, of which there are none here.
    let (jobs, _) = scene_jobs(&request, &mesh_folders)?;
    let crews = thread_counts(typed.threads.as_deref()).into_iter();
    let crews: Vec<Crew> = crews.map(Crew::new).collect::<anyhow::Result<_>>()?;

    let device = Device::new(1)?;
    let mut document = Document {
        kind: KIND.to_owned(),
        machine: Machine::here(engine.isa.name()),
        software: Software::this(Some(device.info().into())),
        command: command_line(),
        seed: SEED,
        batches: Vec::new(),
    };
    let path = args.out.display();
    let work = jobs.iter().flat_map(|job| &job.rounds).map(Round::work);
    let progress = Progress::new(&work.collect::<Vec<_>>());
    for job in &jobs {
        progress.step(&format!("{}: loading", job.source.name()));
        let scene = Scene::load(&job.source.json, &mesh_folders)?;
        let bench = Bench {
            mesh: &scene.mesh,
            reference: Reference::build(
                &device,
                &scene.mesh,
                1,
                &[Mode::Fast],
                &Quality::ALL,
                &progress,
            )?,
            judge: Judge::new(&scene.mesh),
            engine,
            crews: &crews,
            repeats: args.repeats as usize,
        };
        for round in &job.rounds {
            let key = batch_key(job, round);
            progress.step(&format!("{} {}", key.scene, key.rays));
            let batch = bench.batch(job, round)?;
            progress.print(&table(&batch))?;
            document.batches.push(batch);
            (document.write(&args.out)).with_context(|| format!("{path}: cannot be written"))?;
            progress.advance(round.work());
        }
    }
    progress.finish();
    print(&format!(
        "\nx one: how many times the rays a second of one thread. one trace: Mrays/s of one by all\n\
         results: {path}\n"
    ))?;
    let findings = document.batches.iter().flat_map(|batch| &batch.findings);
    let verdict = match findings.clone().next() {
        None => Verdict::Good,
        Some(_) => Verdict::Finding,
    };
    findings.for_each(|finding| complain(&format!("finding: {finding}")));
    Ok(verdict)
}

/// The numbers of threads, one among them, in ascending order.
fn thread_counts(typed: Option<&[u32]>) -> Vec<usize> {
    let mut counts: Vec<usize> = match typed {
        Some(typed) => typed.iter().map(|&n| n as usize).chain([1]).collect(),
        None => {
            let all = std::thread::available_parallelism().map_or(1, usize::from);
            let powers = iter::successors(Some(1), |n| Some(2 * n));
            powers.take_while(|n| *n < all).chain([all]).collect()
        }
    };
    counts.sort_unstable();
    counts.dedup();
    counts
}

/// One scene with all that its batches need.
struct Bench<'a> {
    mesh: &'a Mesh,
    reference: Reference,
    judge: Judge<'a>,
    engine: Engine,
    crews: &'a [Crew],
    repeats: usize,
}

/// Who traces, and the answers that have been checked.
struct Contestant<'a> {
    name: String,
    who: Who<'a>,
    expected: Answers,
}

#[derive(Clone, Copy)]
enum Who<'a> {
    Ours(Tracer, dacrt::Parameters),
    Embree(Committed<'a>, Query),
}

/// What a thread has for itself.
struct Worker {
    workspaces: Workspaces,
    answers: Answers,
}

impl Worker {
    fn trace(&mut self, who: &Who, mesh: &Mesh, batch: &Batch) {
        match who {
            Who::Ours(tracer, parameters) => {
                let workspace = self.workspaces.of(parameters);
                self.answers.trace(tracer, mesh, batch, workspace);
            }
            Who::Embree(scene, query) => {
                self.answers.trace_embree_alone(scene, batch, *query);
            }
        }
    }
}

impl Bench<'_> {
    /// Makes the rays, checks the answers of every method, then measures those that are right.
    fn batch(&self, job: &SceneJob, round: &Round) -> anyhow::Result<BatchTimes> {
        let key = batch_key(job, round);
        let (mesh, any) = (self.mesh, round.rays.is_any_hit());
        let view = Views::new(&job.source, mesh).of(round.camera.as_deref())?;
        let mut workload = Workload::new(mesh, view, round.film, SEED)?;
        let batch = make_rays(&mut workload, round.rays, mesh)?;
        let mut times = BatchTimes {
            scene: key.scene,
            camera: key.camera,
            resolution: key.resolution,
            rays: key.rays,
            triangles: mesh.len(),
            ray_count: batch.len(),
            ray_hash: ray_hash(&batch),
            timings: Vec::new(),
            findings: Vec::new(),
        };
        if batch.is_empty() {
            return Ok(times);
        }

        let worker = || Worker {
            workspaces: Workspaces::new(batch.len(), mesh.len(), 1),
            answers: Answers::room(batch.len(), any),
        };
        let mut first = worker();
        let [fast, robust] = self.reference.answers(&batch, any);
        let (fast, robust) = (fast.view(), robust.view());
        let mut checker = Checker::new(&self.judge, &batch, fast, robust, RANDOM_RAYS, SEED);
        let mut contestants = Vec::new();
        for contestant in &round.contestants {
            let tracer = (self.engine).tracer(contestant.parameters, contestant.precision);
            let who = Who::Ours(tracer, contestant.parameters);
            first.trace(&who, mesh, &batch);
            let answers = first.answers.view();
            let diff = checker.check(contestant.precision, answers, &hit_hash(&answers));
            match diff.wrong() {
                0 => contestants.push(Contestant {
                    name: contestant.method.name().to_owned(),
                    who,
                    expected: first.answers.clone(),
                }),
                wrong => times.findings.push(format!(
                    "{} {} {}: {wrong} wrong of {} rays (`dacrt run` shows them)",
                    times.scene,
                    times.rays,
                    contestant.method,
                    thousands(batch.len() as u64)
                )),
            }
        }
        contestants.push(self.best_of_embree(&mut first, &batch));

        let most = self.crews.iter().map(Crew::threads).max().unwrap_or(1);
        let needed = (first.workspaces.bytes() * most) as u64;
        let memory = Machine::here("").memory_bytes;
        ensure!(
            needed <= memory,
            "--threads {most}: workspaces for {} would take {} MB, and this machine has {}",
            counted(batch.len() as u64, "ray"),
            thousands(needed / 1_000_000),
            thousands(memory / 1_000_000)
        );
        let workers: Vec<Mutex<Worker>> = iter::once(first)
            .chain(iter::repeat_with(worker))
            .take(most)
            .map(Mutex::new)
            .collect();
        self.measure(&batch, &contestants, &workers, &mut times);
        Ok(times)
    }

    /// Embree with the quality and the query that trace the batch fastest with one thread.
    fn best_of_embree(&self, worker: &mut Worker, batch: &Batch) -> Contestant<'_> {
        let combinations: Vec<_> = (self.reference.contestants.iter())
            .flat_map(|built| self.reference.queries.map(|query| (built, query)))
            .collect();
        let trace = |i: usize| -> Result<f64, Infallible> {
            let (built, query) = combinations[i];
            let who = Who::Embree(built.scene.committed(), query);
            Ok(milliseconds(|| worker.trace(&who, self.mesh, batch)).1)
        };
        let Ok(samples) = interleave(
            combinations.len(),
            0..combinations.len(),
            TRIALS,
            trace,
            |_| Vec::new(),
        );
        let (&(built, query), _) = (combinations.iter().zip(&samples))
            .min_by(|(_, a), (_, b)| least(a).total_cmp(&least(b)))
            .expect("every quality is built");
        let who = Who::Embree(built.scene.committed(), query);
        worker.trace(&who, self.mesh, batch);
        Contestant {
            name: format!("embree {}_{}", built.quality.name(), query.name()),
            who,
            expected: worker.answers.clone(),
        }
    }

    /// Times all contestants with all numbers of threads, in turns. Who has other answers once than
    /// those that are expected gets no times, but a finding.
    fn measure(
        &self,
        batch: &Batch,
        contestants: &[Contestant],
        workers: &[Mutex<Worker>],
        times: &mut BatchTimes,
    ) {
        let mut entries = Vec::new();
        for contestant in contestants {
            for crew in self.crews {
                entries.push((contestant, Scheme::Throughput, crew));
                if let Who::Ours(_, parameters) = contestant.who
                    && parameters.takes_threads()
                    && crew.threads() > 1
                {
                    entries.push((contestant, Scheme::Latency, crew));
                }
            }
        }
        let lock = |i: usize| workers[i].lock().expect("no trace panics");
        let mut together = Workspaces::new(batch.len(), self.mesh.len(), workers.len());
        let mut wrong: Vec<(&str, String)> = Vec::new();
        let run = |i: usize| -> Result<f64, Infallible> {
            let (contestant, scheme, crew) = entries[i];
            let threads = crew.threads();
            let tracing = match scheme {
                Scheme::Throughput => threads,
                Scheme::Latency => 1,
            };
            (0..tracing).for_each(|i| lock(i).answers.spoil());
            let ms = match (scheme, contestant.who) {
                (Scheme::Latency, Who::Ours(tracer, parameters)) => {
                    let (tracer, worker) = (tracer.with_threads(threads), &mut *lock(0));
                    let workspace = together.of(&parameters);
                    let answers = &mut worker.answers;
                    milliseconds(|| answers.trace(&tracer, self.mesh, batch, workspace)).1
                }
                (_, who) => crew.milliseconds(|i| lock(i).trace(&who, self.mesh, batch)),
            };
            for i in 0..tracing {
                let differing = lock(i).answers.differing(&contestant.expected);
                let known = wrong.iter().any(|(name, _)| *name == contestant.name);
                if differing > 0 && !known {
                    let who = match scheme {
                        Scheme::Throughput => format!("thread {} of {threads}", i + 1),
                        Scheme::Latency => format!("one trace by {threads} threads"),
                    };
                    let finding = format!(
                        "{} {} {}: {who} has other hits than those that were checked, for {}",
                        times.scene,
                        times.rays,
                        contestant.name,
                        counted(differing as u64, "ray")
                    );
                    wrong.push((&contestant.name, finding));
                }
            }
            Ok(ms)
        };
        let Ok(samples) = interleave(entries.len(), 0..entries.len(), self.repeats, run, |_| {
            Vec::new()
        });

        let mut one_thread: &[f64] = &[];
        for ((contestant, scheme, crew), samples) in entries.into_iter().zip(&samples) {
            let threads = crew.threads();
            if threads == 1 {
                one_thread = samples;
            }
            if wrong.iter().any(|(name, _)| *name == contestant.name) {
                continue;
            }
            let batches = match scheme {
                Scheme::Throughput => threads as f64,
                Scheme::Latency => 1.0,
            };
            let over_one = paired_ratio(one_thread, samples).expect("as many samples of each");
            let rays = batches * batch.len() as f64;
            times.timings.push(Timing {
                tracer: contestant.name.clone(),
                scheme,
                threads,
                mrays_per_s: rays / median(samples).expect("a sample of each") / 1e3,
                samples_ms: samples.clone(),
                over_one_thread: Ratio {
                    ratio: batches * over_one.ratio,
                    interval: over_one.interval.map(|x| batches * x),
                },
                hit_hash: hit_hash(&contestant.expected.view()),
            });
        }
        times
            .findings
            .extend(wrong.into_iter().map(|(_, finding)| finding));
    }
}

/// A batch for people, 100 columns at most.
fn table(batch: &BatchTimes) -> String {
    let [width, height] = batch.resolution;
    let head = [
        "",
        "threads",
        "Mrays/s",
        "x one [95 %]",
        "one trace",
        "x one [95 %]",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for timing in &batch.timings {
        let [low, high] = timing.over_one_thread.interval.map(short);
        let ratio = match timing.threads {
            1 => "1".to_owned(),
            _ => format!("{} [{low}, {high}]", short(timing.over_one_thread.ratio)),
        };
        let speed = [short(timing.mrays_per_s), ratio];
        match timing.scheme {
            Scheme::Throughput => {
                let name = [timing.tracer.clone(), timing.threads.to_string()];
                rows.push(name.into_iter().chain(speed).collect());
            }
            // Its throughput stands right before it.
            Scheme::Latency => rows.iter_mut().last().expect("a head").extend(speed),
        }
    }
    format!(
        "\n{} {} {width}x{height}: {}, {}\n{}",
        batch.scene,
        batch.rays,
        counted(batch.ray_count as u64, "ray"),
        counted(batch.triangles as u64, "triangle"),
        columns(&rows, &[1, 2, 3, 4, 5])
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use dacrt::{Ray, Triangle};
    use glam::Vec3;

    #[test]
    fn one_thread_is_always_among_them() {
        assert_eq!(thread_counts(Some(&[4, 2, 4])), [1, 2, 4]);
        let all = thread_counts(None);
        assert!(all.is_sorted() && all[0] == 1);
        let here = std::thread::available_parallelism().map_or(1, usize::from);
        assert_eq!(all.last(), Some(&here));
    }

    /// A method whose threads have other hits than expected gets a finding and no times; the others
    /// keep theirs.
    #[test]
    fn other_hits_are_a_finding() {
        let mesh = Mesh::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)]);
        let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z);
        let batch: Batch = iter::repeat_n(ray, 20).collect();
        let worker = || Worker {
            workspaces: Workspaces::new(20, 1, 1),
            answers: Answers::room(20, false),
        };
        let contestants = [Method::Afra2012, Method::Best].map(|method| {
            let parameters = method.parameters();
            let who = Who::Ours(Tracer::new(parameters), parameters);
            let mut right = worker();
            right.trace(&who, &mesh, &batch);
            if let (Method::Afra2012, Answers::Nearest(hits)) = (method, &mut right.answers) {
                hits.prim[3] = 1;
            }
            Contestant {
                name: method.name().to_owned(),
                who,
                expected: right.answers,
            }
        });
        let device = Device::new(1).unwrap();
        let progress = Progress::new(&[]);
        let bench = Bench {
            mesh: &mesh,
            reference: Reference::build(&device, &mesh, 1, &[], &[], &progress).unwrap(),
            judge: Judge::new(&mesh),
            engine: Engine {
                isa: Isa::best(),
                seed: SEED,
                threads: 1,
            },
            crews: &[1, 2].map(|threads| Crew::new(threads).unwrap()),
            repeats: 1,
        };
        let mut times = BatchTimes {
            scene: "one".to_owned(),
            camera: String::new(),
            resolution: [20, 1],
            rays: "primary".to_owned(),
            triangles: 1,
            ray_count: 20,
            ray_hash: String::new(),
            timings: Vec::new(),
            findings: Vec::new(),
        };
        let workers = [worker(), worker()].map(Mutex::new);
        bench.measure(&batch, &contestants, &workers, &mut times);
        assert_eq!(times.findings.len(), 1);
        assert!(
            times.findings[0].contains("one primary afra2012"),
            "{times:?}"
        );
        assert!(times.findings[0].contains("1 ray"), "{times:?}");
        let of: Vec<_> = (times.timings.iter())
            .map(|timing| (timing.tracer.as_str(), timing.scheme, timing.threads))
            .collect();
        let best = |scheme, threads| ("best", scheme, threads);
        assert_eq!(
            of,
            [
                best(Scheme::Throughput, 1),
                best(Scheme::Throughput, 2),
                best(Scheme::Latency, 2)
            ]
        );
    }
}
