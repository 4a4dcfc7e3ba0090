//! `dacrt paper nabata2013`: the tables of Figs. 4 to 7, both plots of Fig. 8, the rates and the ablation of
//! section 5.

mod image;
mod printed;
pub mod text;
mod trend;

use crate::cli::Verdict;
use crate::cli::args::PaperArgs;
use crate::cli::knobs::KnobLists;
use crate::cli::paper::find_scenes;
use crate::cli::plan::{
    Contestant, Round, RunPlan, add_scene, check_writable, contestants, engine, film, precision,
};
use crate::cli::run;
use crate::cli::size::{Resolution, Spp};
use crate::cli::source::{generated, mesh_folders};
use crate::cli::text::print;
use anyhow::{Context, ensure};
use dacrt::workloads::{Film, RayType};
use dacrt::{Cost, Method, ObjectParameters, Order, Parameters, Precision};
use dacrt_validate::parameters::own_fields;
use dacrt_validate::results::{CellKey, Document};
use printed::{ABLATION, COLUMNS, Column, SAMPLES, SIDE};

const METHODS: [Method; 2] = [Method::Afra2012, Method::Nabata2013];

/// Sizes of `--quick`: 512 x 512 and 1024 x 1024.
const QUICK_SIZES: usize = 2;

/// Measures all pictures whose scene is at hand and prints them beside the paper's.
pub fn nabata2013(args: &PaperArgs) -> anyhow::Result<Verdict> {
    if let Some(path) = &args.from {
        let document = Document::read(path)?;
        let text = text::text(&document.cells)
            .with_context(|| format!("{}: has no whole picture of Figs. 4 to 7", path.display()))?;
        print(&text)?;
        return Ok(Verdict::Good);
    }
    let plan = plan(args)?;
    let (document, findings) = run::measure(&plan)?;
    let results = format!("\nresults: {}\n", plan.out.display());
    let text = text::text(&document.cells).unwrap_or_default();
    print(&(text + &results + &findings.text(&document, &plan)))?;
    Ok(findings.verdict())
}

/// The batches that all pictures are made of, each once.
fn plan(args: &PaperArgs) -> anyhow::Result<RunPlan> {
    let engine = engine(&args.engine)?;
    let precision = precision(&args.precision)?;
    let mesh_folders = mesh_folders(&args.meshes);
    let size = args.resolution.unwrap_or(Resolution {
        width: SIDE,
        height: SIDE,
    });
    let (sizes, cameras) = match args.quick {
        true => (QUICK_SIZES, 0),
        false => (args.sizes, args.cameras),
    };
    let films = SAMPLES[..sizes].iter().map(|&spp| film(size, Spp(spp)));
    let films: Vec<Film> = films.collect::<anyhow::Result<_>>()?;
    let both = contestants(&METHODS, &[precision], &KnobLists::default())?;
    let mut ablation = both.clone();
    ablation.extend(Technique::ALL.map(|technique| technique.contestant(precision)));

    let (sources, left_out) = find_scenes(scene_names(args)?, args, &mesh_folders)?;
    let warnings = left_out.into_iter().map(|(_, why)| why).collect();
    let mut scenes = Vec::new();
    for source in sources {
        let name = source.name();
        let mut rounds: Vec<Round> = Vec::new();
        for (at, column) in COLUMNS.iter().enumerate() {
            let Some((_, own)) = column.ours.filter(|(scene, _)| *scene == name) else {
                continue;
            };
            for camera in 0..=cameras {
                let camera = column.camera(own, camera);
                for &film in &films {
                    let largest = films.last() == Some(&film);
                    let contestants = match at == ABLATION && largest && camera == own {
                        true => &ablation,
                        false => &both,
                    };
                    let new = column.rays.iter().map(|&rays| Round {
                        camera: Some(camera.clone()),
                        film,
                        rays,
                        contestants: contestants.clone(),
                    });
                    for round in new {
                        add_round(&mut rounds, round);
                    }
                }
            }
        }
        // Batches of one picture together, for they share what comes before them.
        rounds.sort_by_key(|round| (round.film.rays(), round.camera.clone()));
        add_scene(&mut scenes, source, rounds)?;
    }
    ensure!(
        !scenes.is_empty(),
        "none of the meshes is there; --meshes or DACRT_MESHES names folders"
    );
    check_writable(&args.out).context("--out")?;
    Ok(RunPlan {
        qualities: &[],
        mesh_folders,
        resume: args.resume,
        warnings,
        ..RunPlan::of(scenes, args.repeats(), engine, args.out.clone())
    })
}

/// The scenes of the paper that we have, each once, or those of them that are asked for.
fn scene_names(args: &PaperArgs) -> anyhow::Result<Vec<&'static str>> {
    let mut all: Vec<&str> = Vec::new();
    for (scene, _) in COLUMNS.iter().filter_map(|column| column.ours) {
        if !all.contains(&scene) {
            all.push(scene);
        }
    }
    let Some(names) = &args.scenes else {
        return Ok(all);
    };
    for name in names {
        ensure!(
            all.contains(&name.as_str()),
            "--scenes: {}",
            dacrt::scene::no_such("scene of the paper", name, &all)
        );
    }
    all.retain(|scene| names.iter().any(|name| name == scene));
    Ok(all)
}

/// Adds a batch; one that is there already gets the contestants that it lacks.
fn add_round(rounds: &mut Vec<Round>, round: Round) {
    let same = |other: &&mut Round| {
        let key = |r: &Round| (r.camera.clone(), r.film, r.rays);
        key(other) == key(&round)
    };
    match rounds.iter_mut().find(same) {
        Some(other) if other.contestants.len() >= round.contestants.len() => {}
        Some(other) => other.contestants = round.contestants,
        None => rounds.push(round),
    }
}

/// A technique of ray sampling, for the ablation.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Technique {
    Cost,
    Order,
    Skip,
}

impl Technique {
    const ALL: [Technique; 3] = [Technique::Cost, Technique::Order, Technique::Skip];

    /// What it does, with what the paper says that it saves, in seconds of [`printed::ABLATION_WITHOUT`].
    fn printed(self) -> (&'static str, f64) {
        match self {
            Technique::Cost => ("cost of eq. 2", 5.3),
            Technique::Order => ("order by samples", 1.3),
            Technique::Skip => ("skipping of filters", 6.0),
        }
    }

    /// Ray sampling with this technique only.
    fn alone(self) -> ObjectParameters {
        let Parameters::Object(all) = Method::Nabata2013.parameters() else {
            unreachable!("ray sampling splits lists of triangles");
        };
        ObjectParameters {
            cost: match self {
                Technique::Cost => all.cost,
                _ => Cost::Sah,
            },
            order: match self {
                Technique::Order => all.order,
                _ => Order::OneRay,
            },
            skip: match self {
                Technique::Skip => all.skip,
                _ => 1.0,
            },
            ..all
        }
    }

    fn contestant(self, precision: Precision) -> Contestant {
        Contestant {
            method: Method::Nabata2013,
            parameters: self.alone().into(),
            precision,
            label: format!("{} alone", self.printed().0),
            baseline: Some(0),
        }
    }

    /// Whether a cell is of ray sampling with this technique only.
    fn is(self, key: &CellKey) -> bool {
        key.method == Method::Nabata2013.name()
            && key.parameters == own_fields(Method::Nabata2013, &self.alone().into())
    }
}

impl Column {
    /// The camera of a place: the first is our own, then come those that the program makes.
    fn camera(&self, own: &str, place: u32) -> String {
        match place {
            0 => own.to_owned(),
            n => generated(n, self.rays.contains(&RayType::Dof)),
        }
    }
}
