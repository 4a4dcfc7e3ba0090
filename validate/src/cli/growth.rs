//! `dacrt bench growth`: time against the number of rays and of triangles.

use super::args::BenchArgs;
use super::bench::short;
use super::plan::{Engine, Round, RunPlan, SceneJob, contestants};
use super::progress::Progress;
use super::run::execute;
use super::source::SceneSource;
use super::text::{columns, print, thousands};
use super::{Verdict, command_line};
use anyhow::{Context, ensure};
use dacrt::scene::MeshSource;
use dacrt::workloads::{Film, RayType};
use dacrt::{Isa, Method, Precision, Workspace};
use dacrt_validate::embree::{Device, Quality};
use dacrt_validate::growth::{Curve, Document, EMBREE, Grows, KIND, LeftOut, Point, half_decades};
use dacrt_validate::machine::{Machine, Software, available_memory};
use dacrt_validate::results::Cell;
use std::path::Path;
use std::time::Instant;

/// The generated scene, and its triangles where they do not grow.
const SCENE: &str = "hall";
const TRIANGLES: usize = 200_000;
/// Primary rays where they do not grow.
const RAYS: usize = 1_000_000;
const RAY_TYPES: [RayType; 2] = [RayType::Primary, RayType::Diffuse(1)];
const SEED: u64 = 1;

/// Seconds that a point may take.
const SECONDS: f64 = 1800.0;
/// Share of the free memory that a point may take.
const SHARE: f64 = 0.8;
/// Bytes of a triangle but for workspaces and Embree: the mesh and the arbiter's tree.
const BYTES_A_TRIANGLE: usize = 60;
/// Bytes of a triangle in a scene of Embree.
const BYTES_OF_EMBREE: usize = 145;
/// Bytes of a ray but for workspaces: the batch and the one before it, answers, Embree's structures.
const BYTES_A_RAY: usize = 400;

/// Those who are measured at a point.
struct Lineup {
    methods: &'static [Method],
    /// Builds of Embree. The slowest is never among them: it takes the most time and memory of all.
    qualities: &'static [Quality],
}

/// All, and what is left where they would not fit into memory together.
const LINEUPS: [Lineup; 2] = [
    Lineup {
        methods: &[Method::Best, Method::Afra2012, Method::Nabata2013],
        qualities: &[Quality::Low, Quality::Medium],
    },
    Lineup {
        methods: &[Method::Best],
        qualities: &[Quality::Medium],
    },
];

/// Measures, writes and prints. A finding is a wrong hit.
pub fn growth(args: &BenchArgs) -> anyhow::Result<Verdict> {
    ensure!(
        args.scenes.is_none(),
        "--scenes is for `bench ingredients`: the scenes of growth are generated"
    );
    let isa = match args.isa.as_deref() {
        None => Isa::best(),
        Some([name]) => super::plan::isa(name)?,
        Some(_) => anyhow::bail!("--isa: `bench growth` takes one instruction set"),
    };
    let steps = steps(args)?;
    let mut growth = Growth {
        isa,
        repeats: args.repeats,
        document: Document {
            kind: KIND.to_owned(),
            machine: Machine::here(isa.name()),
            software: Software::this(Some(Device::new(1)?.info().into())),
            command: command_line(),
            memory_limit_bytes: (available_memory() as f64 * SHARE) as u64,
            seconds_limit: SECONDS,
            left_out: Vec::new(),
            curves: Vec::new(),
            cells: Vec::new(),
        },
        is_finding: false,
    };
    let path = args.out.display();
    let mut work = Vec::new();
    for step in &steps {
        work.extend(step.rounds(&LINEUPS[0])?.iter().map(Round::work));
    }
    let progress = Progress::new(&work);
    for of_curve in steps.chunk_by(|a, b| a.grows == b.grows) {
        let mut cells = Vec::new();
        let done = growth.document.curves.len();
        // How big the point before was, and the seconds that it took.
        let mut before = None;
        for step in of_curve {
            let limit = growth.document.memory_limit_bytes;
            let too_long = step.too_long(before);
            let fits = |lineup: &&Lineup| step.too_big(lineup, limit).is_none();
            let lineup = (LINEUPS.iter().find(fits)).filter(|_| too_long.is_none());
            if let Some(why) = too_long.or(step.too_big(&LINEUPS[0], limit)) {
                let contestants = left_out_of(lineup);
                let who = contestants.join(", ");
                progress.warn(&format!("{}: left out: {who}: {why}", step.name()));
                growth.document.left_out.push(LeftOut {
                    grows: step.grows,
                    triangles: step.triangles,
                    rays: step.film.rays(),
                    contestants,
                    why,
                });
            }
            if let Some(lineup) = lineup {
                let start = Instant::now();
                cells.extend(growth.measure(step, lineup, &progress)?);
                before = Some((step.number(), start.elapsed().as_secs_f64()));
                growth.document.curves.truncate(done);
                (growth.document.curves).extend(Curve::of(step.grows, &cells));
            } else {
                for round in step.rounds(&LINEUPS[0])? {
                    progress.skip(round.work());
                }
            }
            // A run that is stopped leaves the points that it had.
            (growth.document.write(&args.out))
                .with_context(|| format!("{path}: cannot be written"))?;
        }
    }
    progress.finish();
    let mut last = format!("results: {path}\n");
    if growth.is_finding {
        last += "FINDING: there are wrong hits, see the warnings\n";
    }
    print(&(text(&growth.document) + &last))?;
    Ok(match growth.is_finding {
        true => Verdict::Finding,
        false => Verdict::Good,
    })
}

/// One scene and size, with rays of all types: a point of each curve.
struct Step {
    grows: Grows,
    triangles: usize,
    film: Film,
}

/// What was asked for.
fn steps(args: &BenchArgs) -> anyhow::Result<Vec<Step>> {
    let (least_rays, least_triangles) = match args.quick {
        true => (1_000, 1_000),
        false => (10_000, 1_000),
    };
    let default = |most: usize| if args.quick { 3_162 } else { most };
    let most_rays = args.max_rays.unwrap_or(default(16_000_000));
    let most_triangles = args.max_triangles.unwrap_or(default(30_000_000));
    ensure!(
        most_rays >= least_rays,
        "--max-rays {most_rays}: expected {least_rays} or more"
    );
    // Pictures are square.
    let film = |rays: usize| {
        let side = (rays as f64).sqrt().round() as u32;
        Film::new(side, side, 1)
    };
    let mut steps = Vec::new();
    for rays in half_decades(least_rays, most_rays) {
        steps.push(Step {
            grows: Grows::Rays,
            triangles: TRIANGLES.min(most_triangles),
            film: film(rays)?,
        });
    }
    for triangles in half_decades(least_triangles, most_triangles) {
        steps.push(Step {
            grows: Grows::Triangles,
            triangles,
            film: film(RAYS.min(most_rays))?,
        });
    }
    Ok(steps)
}

impl Step {
    fn name(&self) -> String {
        let [triangles, rays] = [self.triangles, self.film.rays()].map(|n| thousands(n as u64));
        format!("{SCENE}, {triangles} triangles, {rays} rays")
    }

    fn number(&self) -> usize {
        match self.grows {
            Grows::Rays => self.film.rays(),
            Grows::Triangles => self.triangles,
        }
    }

    fn rounds(&self, lineup: &Lineup) -> anyhow::Result<Vec<Round>> {
        let of = |rays| {
            Ok(Round {
                camera: None,
                film: self.film,
                rays,
                contestants: contestants(lineup.methods, &[Precision::Fast], &Default::default())?,
            })
        };
        RAY_TYPES.into_iter().map(of).collect()
    }

    /// Bytes that it takes, about.
    fn bytes(&self, lineup: &Lineup) -> u64 {
        let (rays, triangles) = (self.film.rays(), self.triangles);
        // The two methods that split lists of triangles have one workspace.
        let workspaces: usize = [Method::Best, Method::Afra2012]
            .iter()
            .filter(|method| lineup.methods.contains(method))
            .map(|method| Workspace::bytes_for(&method.parameters(), rays, triangles, 1))
            .sum();
        // Hits are judged by one scene more.
        let scenes = lineup.qualities.len() + 1;
        let bytes = BYTES_A_TRIANGLE + scenes * BYTES_OF_EMBREE;
        (workspaces + triangles * bytes + rays * BYTES_A_RAY) as u64
    }

    /// Why there is no room to measure it, if so.
    fn too_big(&self, lineup: &Lineup, limit: u64) -> Option<String> {
        let bytes = self.bytes(lineup);
        let [gib, most] = [bytes, limit].map(|b| b as f64 / (1u64 << 30) as f64);
        (bytes > limit)
            .then(|| format!("memory: all would take about {gib:.1} GiB, and may take {most:.1}"))
    }

    /// Why there is no time to measure it, if so, given the number and the seconds of the point before.
    fn too_long(&self, before: Option<(usize, f64)>) -> Option<String> {
        let (n, seconds) = before?;
        let seconds = seconds * self.number() as f64 / n as f64;
        (seconds > SECONDS)
            .then(|| format!("time: it would take about {seconds:.0} s, and may take {SECONDS:.0}"))
    }
}

struct Growth {
    isa: Isa,
    repeats: u32,
    document: Document,
    is_finding: bool,
}

impl Growth {
    /// Measures and checks a point as `dacrt run` does; adds its cells to the document, and returns them.
    fn measure(
        &mut self,
        step: &Step,
        lineup: &Lineup,
        progress: &Progress,
    ) -> anyhow::Result<Vec<Cell>> {
        // The file of a run, which is not kept.
        let folder = tempfile::tempdir().context("no temporary folder")?;
        let engine = Engine {
            isa: self.isa,
            seed: SEED,
            threads: 1,
        };
        let out = folder.path().join("point.json");
        let plan = RunPlan {
            qualities: lineup.qualities,
            ..RunPlan::of(vec![scene(step, lineup)?], self.repeats, engine, out)
        };
        let (run, findings) = execute(&plan, progress, &mut |_, _, _, _| Ok(()))?;
        self.is_finding |= findings.verdict() == Verdict::Finding;
        self.document.cells.extend(run.cells.iter().cloned());
        Ok(run.cells)
    }
}

/// The scene with another number of triangles; there is no file of it.
fn scene(step: &Step, lineup: &Lineup) -> anyhow::Result<SceneJob> {
    let mut source = SceneSource::find(SCENE)?;
    source.json = Path::new(&format!("{SCENE}-{}", step.triangles)).into();
    for mesh in &mut source.description.meshes {
        if let MeshSource::Generator { triangles, .. } = mesh {
            *triangles = step.triangles;
        }
    }
    Ok(SceneJob {
        source,
        rounds: step.rounds(lineup)?,
    })
}

/// Names of those who are not in a lineup, or of all.
fn left_out_of(lineup: Option<&Lineup>) -> Vec<String> {
    let is_in = |method: &Method| lineup.is_some_and(|lineup| lineup.methods.contains(method));
    let methods = LINEUPS[0].methods.iter().filter(|method| !is_in(method));
    let built = |quality: &str| {
        lineup.is_some_and(|lineup| lineup.qualities.iter().any(|q| q.name() == quality))
    };
    let embree = EMBREE.iter().filter(|(_, quality)| !built(quality));
    (methods.map(|method| method.name()))
        .chain(embree.map(|(name, _)| *name))
        .map(str::to_owned)
        .collect()
}

/// The table for people: a line for each curve.
fn text(document: &Document) -> String {
    let mut text = String::new();
    let same = |a: &Curve, b: &Curve| a.grows == b.grows && a.rays == b.rays;
    let mut curves = document.curves.clone();
    curves.sort_by_key(|curve| (curve.grows == Grows::Triangles, curve.rays != "primary"));
    for panel in curves.chunk_by(same) {
        let Curve { grows, rays, .. } = &panel[0];
        let numbers = panel[0].points.iter().map(|point| point.number(*grows));
        let [from, to] =
            [numbers.clone().min(), numbers.max()].map(|n| thousands(n.unwrap_or_default() as u64));
        text += &format!("{rays}: {from} to {to} {}\n\n", grows.name());
        let heads = [
            [
                "contestant",
                "ms",
                "",
                "exponent",
                "",
                "",
                "over n log n",
                "",
                "MiB",
            ],
            [
                "", "first", "last", "all", "most", "last", "most", "last", "last",
            ],
        ];
        let mut rows: Vec<Vec<String>> = heads.map(|row| row.map(str::to_owned).to_vec()).into();
        rows.extend(panel.iter().map(row));
        text += &columns(&rows, &[1, 2, 3, 4, 5, 6, 7, 8]);
        text += "\n";
    }
    for LeftOut {
        triangles,
        rays,
        contestants,
        why,
        ..
    } in &document.left_out
    {
        let [triangles, rays] = [*triangles, *rays].map(|n| thousands(n as u64));
        let who = contestants.join(", ");
        text += &format!("left out: {triangles} triangles, {rays} rays: {who}\n          {why}\n");
    }
    text
}

fn row(curve: &Curve) -> Vec<String> {
    let all = |of: fn(&Point) -> Option<f64>| -> Vec<f64> {
        curve.points.iter().filter_map(of).collect()
    };
    let number = |x: Option<f64>| x.map_or(String::new(), short);
    let most = |of: &[f64]| number(of.iter().copied().max_by(f64::total_cmp));
    let last = |of: &[f64]| number(of.last().copied());
    let (ms, exponents) = (all(|p| p.ms), all(|p| p.exponent));
    let over = all(|p| p.over_n_log_n);
    let bytes = curve.points.last().and_then(|p| p.bytes);
    vec![
        curve.contestant.clone(),
        number(ms.first().copied()),
        last(&ms),
        number(curve.exponent()),
        most(&exponents),
        last(&exponents),
        most(&over),
        last(&over),
        bytes.map_or(String::new(), |bytes| short(bytes as f64 / 1048576.0)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(triangles: usize, side: u32) -> Step {
        Step {
            grows: Grows::Triangles,
            triangles,
            film: Film::new(side, side, 1).unwrap(),
        }
    }

    #[test]
    fn what_does_not_fit_says_so() {
        let step = step(1_000_000, 100);
        let [all, few] = &LINEUPS;
        assert_eq!(step.too_big(all, 1 << 40), None);
        assert!(step.too_big(all, 1 << 20).unwrap().starts_with("memory"));
        let between = (step.bytes(few) + step.bytes(all)) / 2;
        assert!(step.too_big(all, between).is_some() && step.too_big(few, between).is_none());
        assert_eq!(
            left_out_of(Some(few)),
            ["afra2012", "nabata2013", "embree-low"]
        );
        assert_eq!(left_out_of(None).len(), 5);
        assert_eq!(step.too_long(None), None);
        assert_eq!(step.too_long(Some((500_000, 800.0))), None);
        let why = step.too_long(Some((500_000, 1000.0))).unwrap();
        assert!(why.starts_with("time") && why.contains("2000 s"), "{why}");
    }

    #[test]
    fn the_scene_has_the_triangles_that_it_should() {
        let job = scene(&step(12_345, 10), &LINEUPS[0]).unwrap();
        assert_eq!(job.source.name(), "hall-12345");
        let [MeshSource::Generator { triangles, .. }] = job.source.description.meshes[..] else {
            panic!("a generated scene");
        };
        assert_eq!(triangles, 12_345);
    }
}
