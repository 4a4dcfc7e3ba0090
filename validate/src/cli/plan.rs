//! What the arguments mean: names looked up, descriptions read, meshes found, files proven
//! writable, before any work starts.

use super::args::{EngineArgs, RunArgs};
use super::knobs::KnobLists;
use super::progress::Progress;
use super::size::{Resolution, Spp};
use super::source::{SceneSource, mesh_folders};
use super::text::thousands;
use anyhow::{Context, bail, ensure};
use dacrt::scene::no_such;
use dacrt::workloads::{Film, RayType};
use dacrt::{Isa, Method, Parameters, Precision, Tracer};
use dacrt_validate::diff::RANDOM_RAYS;
use dacrt_validate::embree::{Lanes, Mode, Quality, Query};
use dacrt_validate::machine::Machine;
use dacrt_validate::parameters::{is_baseline, own_fields};
use dacrt_validate::peers;
use dacrt_validate::sweep::SweepRun;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What `run` traces when it is not told, as far as the meshes are there.
const DEFAULT_SCENES: [&str; 6] = ["hall", "relief", "soup", "sibenik", "conference", "sponza"];
const DEFAULT_RAYS: [RayType; 3] = [RayType::Primary, RayType::ShadowPoint, RayType::Diffuse(1)];

/// How the engine works.
#[derive(Clone, Copy, Debug)]
pub struct Engine {
    pub isa: Isa,
    pub seed: u64,
    /// Threads of Embree, and of the methods that take more than one; at least 1.
    pub threads: usize,
}

impl Engine {
    /// Threads that a trace with these parameters takes.
    pub fn threads_of(&self, parameters: &Parameters) -> usize {
        match parameters.takes_threads() {
            true => self.threads,
            false => 1,
        }
    }

    /// What traces with these parameters.
    pub fn tracer(&self, parameters: Parameters, precision: Precision) -> Tracer {
        Tracer::new(parameters)
            .with_precision(precision)
            .with_isa(self.isa)
            .with_seed(self.seed)
            .with_threads(self.threads_of(&parameters))
    }
}

/// A method with its parameters and precision.
#[derive(Clone, Debug, PartialEq)]
pub struct Contestant {
    pub method: Method,
    pub parameters: Parameters,
    pub precision: Precision,
    /// Tells it from others of the same method; may be empty.
    pub label: String,
    /// The place of the contestant that the acceleration ratio is against.
    pub baseline: Option<usize>,
}

/// One batch of rays and who traces it.
#[derive(Clone)]
pub struct Round {
    /// The name of the camera; none is the scene's first.
    pub camera: Option<String>,
    pub film: Film,
    pub rays: RayType,
    pub contestants: Vec<Contestant>,
}

impl Round {
    /// About how much there is to do, in rays traced by somebody: each contestant traces all rays,
    /// and so do the combinations of Embree.
    pub fn work(&self) -> f64 {
        const A_MODE: usize = Quality::ALL.len() * Query::all(Lanes::Sixteen).len();
        let modes = Mode::ALL.into_iter().filter(|&mode| self.is_against(mode));
        (self.film.rays() * (self.contestants.len() + A_MODE * modes.count())) as f64
    }

    /// Whether a contestant is set against this mode of Embree.
    pub fn is_against(&self, mode: Mode) -> bool {
        let mut precisions = self.contestants.iter().map(|c| c.precision);
        precisions.any(|precision| Mode::against(precision) == mode)
    }
}

/// A scene and its batches.
pub struct SceneJob {
    pub source: SceneSource,
    pub rounds: Vec<Round>,
}

/// What to measure, as typed or as it stands in a sweep file; lists that are not given are for the
/// plan to choose.
pub struct Request<'a> {
    pub scenes: Option<&'a [String]>,
    pub cameras: Option<&'a [String]>,
    pub rays: Option<&'a [String]>,
    pub methods: Option<&'a [String]>,
    pub precisions: &'a [String],
    pub films: Vec<Film>,
    pub knobs: &'a KnobLists,
}

/// All that `run` has to do.
pub struct RunPlan {
    pub scenes: Vec<SceneJob>,
    pub repeats: u32,
    /// Builds of Embree that are timed, medium quality among them; if none, Embree only judges.
    pub qualities: &'static [Quality],
    /// How many random rays of a cell are judged.
    pub exact_all: u32,
    pub engine: Engine,
    pub mesh_folders: Vec<PathBuf>,
    pub out: PathBuf,
    pub resume: bool,
    /// Whether other libraries are timed, too.
    pub peers: bool,
    /// Whether a pass that shades what the rays hit is timed, too.
    pub shade: bool,
    /// Whether rays are sent through the stored splits of traces, too.
    pub twins: bool,
    /// The sweep that this is, or is a shard of.
    pub sweep: Option<SweepRun>,
    pub warnings: Vec<String>,
}

impl RunPlan {
    /// The traces and Embree's builds alone, of scenes that need no mesh file, from the beginning.
    pub fn of(scenes: Vec<SceneJob>, repeats: u32, engine: Engine, out: PathBuf) -> RunPlan {
        RunPlan {
            scenes,
            repeats,
            qualities: &Quality::ALL,
            exact_all: RANDOM_RAYS,
            engine,
            mesh_folders: Vec::new(),
            out,
            resume: false,
            peers: false,
            shade: false,
            twins: false,
            sweep: None,
            warnings: Vec::new(),
        }
    }

    /// Makes sense of what was typed.
    pub fn new(args: &RunArgs) -> anyhow::Result<RunPlan> {
        ensure!(
            !args.peers || !peers::ALL.is_empty(),
            "--peers: this dacrt was built without other libraries; build it by \
             `cargo build --release -p dacrt-validate --features peers`"
        );
        let engine = engine(&args.engine)?;
        let mesh_folders = mesh_folders(&args.meshes);
        let request = Request {
            scenes: args.scenes.as_deref(),
            cameras: args.cameras.as_deref(),
            rays: args.rays.as_deref(),
            methods: args.methods.as_deref(),
            precisions: &args.precision,
            films: films(&args.resolution, &args.spp)?,
            knobs: &args.knobs,
        };
        let (scenes, warnings) = scene_jobs(&request, &mesh_folders)?;
        check_writable(&args.out).context("--out")?;
        let repeats = args
            .repeats
            .unwrap_or(if args.scenes.is_some() { 5 } else { 3 });
        Ok(RunPlan {
            exact_all: args.exact_all,
            mesh_folders,
            resume: args.resume,
            peers: args.peers,
            twins: args.twins,
            warnings,
            ..RunPlan::of(scenes, repeats, engine, args.out.clone())
        })
    }

    /// A bar for the batches.
    pub fn progress(&self) -> Progress {
        Progress::new(&self.rounds().map(Round::work).collect::<Vec<_>>())
    }

    /// All batches, in the order in which they are measured.
    pub fn rounds(&self) -> impl Iterator<Item = &Round> {
        self.scenes.iter().flat_map(|scene| &scene.rounds)
    }
}

/// The batches of each scene, and warnings. A scene that was named and lacks a mesh is an error.
pub fn scene_jobs(
    request: &Request,
    mesh_folders: &[PathBuf],
) -> anyhow::Result<(Vec<SceneJob>, Vec<String>)> {
    let mut warnings = Vec::new();
    let methods = request.methods.map(|names| {
        let methods = distinct(names).map(method);
        methods.collect::<anyhow::Result<Vec<_>>>()
    });
    let methods = methods.transpose()?;
    let precisions: Vec<Precision> = distinct(request.precisions)
        .map(precision)
        .collect::<anyhow::Result<_>>()?;
    let rays = request.rays.map(|names| {
        let rays = distinct(names).map(ray_type);
        rays.collect::<anyhow::Result<Vec<_>>>()
    });
    let rays = rays.transpose()?;
    let names = match request.scenes {
        Some(names) => distinct(names).collect(),
        None => DEFAULT_SCENES.to_vec(),
    };
    let mut scenes = Vec::new();
    let mut left_out = Vec::new();
    for name in names {
        let source = SceneSource::find(name)?;
        if let Some(missing) = source.missing_mesh(mesh_folders) {
            ensure!(request.scenes.is_none(), "{missing}");
            left_out.push(format!("left out: {missing}"));
            continue;
        }
        let rays = rays.clone().unwrap_or_else(|| {
            let rays = DEFAULT_RAYS.into_iter();
            rays.filter(|r| source.is_for(*r)).collect()
        });
        let cameras = match request.cameras {
            Some(names) => source.cameras(names)?.into_iter().map(Some).collect(),
            None => vec![None],
        };
        let pictures = (cameras.iter())
            .flat_map(|camera| request.films.iter().map(move |&film| (camera, film)));
        let mut rounds = Vec::new();
        for (camera, film) in pictures {
            for &rays in &rays {
                let methods = methods.as_deref().unwrap_or_else(|| default_methods(rays));
                let contestants = contestants(methods, &precisions, request.knobs)?;
                for warning in missing_baselines(&contestants) {
                    if !warnings.contains(&warning) {
                        warnings.push(warning);
                    }
                }
                rounds.push(Round {
                    camera: camera.clone(),
                    film,
                    rays,
                    contestants,
                });
            }
        }
        add_scene(&mut scenes, source, rounds)?;
    }
    warnings.append(&mut left_out);
    Ok((scenes, warnings))
}

/// Each combination of a size and a number of samples, once.
pub fn films(sizes: &[Resolution], samples: &[Spp]) -> anyhow::Result<Vec<Film>> {
    let mut films = Vec::new();
    for &size in sizes {
        for &spp in samples {
            let film = film(size, spp)?;
            if !films.contains(&film) {
                films.push(film);
            }
        }
    }
    Ok(films)
}

/// Adds a scene whose meshes are there; an error if it lacks what the rays need, or has the name of
/// another.
pub fn add_scene(
    scenes: &mut Vec<SceneJob>,
    source: SceneSource,
    rounds: Vec<Round>,
) -> anyhow::Result<()> {
    for round in &rounds {
        source.allows(round.camera.as_deref(), round.rays)?;
    }
    if let Some(other) = scenes.iter().find(|s| s.source.name() == source.name()) {
        bail!(
            "--scenes: {} and {} would have the same name in the result",
            other.source.json.display(),
            source.json.display()
        );
    }
    scenes.push(SceneJob { source, rounds });
    Ok(())
}

/// What `run` traces these rays by when it is not told: of Mora's methods each that does what no
/// other does.
fn default_methods(rays: RayType) -> &'static [Method] {
    match rays {
        RayType::Primary | RayType::ShadowPoint => &[
            Method::Afra2012,
            Method::Nabata2013,
            Method::Mora2011,
            Method::Mora2011Cones,
            Method::Best,
        ],
        // Without a shared origin, Mora's are all the one for random rays.
        _ => &[
            Method::Afra2012,
            Method::Nabata2013,
            Method::Mora2011Random,
            Method::Best,
        ],
    }
}

/// A contestant for each method, combination of parameters and precision, each with its baseline.
pub fn contestants(
    methods: &[Method],
    precisions: &[Precision],
    knobs: &KnobLists,
) -> anyhow::Result<Vec<Contestant>> {
    let mut contestants: Vec<Contestant> = Vec::new();
    for &method in methods {
        for parameters in knobs.grid(method)? {
            let label = knobs.label(method, &parameters);
            for &precision in precisions {
                let of_precision = format!("{label} precision={precision}");
                contestants.push(Contestant {
                    method,
                    parameters,
                    precision,
                    label: match precisions.len() {
                        1 => label.clone(),
                        _ => of_precision.trim_start().to_owned(),
                    },
                    baseline: None,
                });
            }
        }
    }
    set_baselines(&mut contestants);
    Ok(contestants)
}

/// Sets each against the contestant that is its baseline, if there is one.
pub fn set_baselines(contestants: &mut [Contestant]) {
    for i in 0..contestants.len() {
        let own = |c: &Contestant| own_fields(c.method, &c.parameters);
        let parameters = own(&contestants[i]);
        let precision = contestants[i].precision;
        let is_it = |b: &Contestant| {
            (b.method, b.precision) == (Method::Afra2012, precision)
                && is_baseline(&own(b), &parameters)
        };
        contestants[i].baseline = contestants.iter().position(is_it);
    }
}

/// Why some have no acceleration ratio, though the baseline is among them.
fn missing_baselines(contestants: &[Contestant]) -> Vec<String> {
    let any_baseline = contestants.iter().any(|c| c.method == Method::Afra2012);
    let lacks = |object: bool| {
        let without = |c: &&Contestant| c.baseline.is_none();
        let mut without = contestants.iter().filter(without);
        any_baseline && without.any(|c| matches!(c.parameters, Parameters::Object(_)) == object)
    };
    let mut warnings = Vec::new();
    if lacks(true) {
        let why = "no acceleration ratio without an afra2012 cell with its default of --sah-ratio";
        warnings.push(why.to_owned());
    }
    if lacks(false) {
        let why = "no acceleration ratio of best and Mora's methods without an afra2012 cell with all of its \
                   defaults";
        warnings.push(why.to_owned());
    }
    warnings
}

/// The instruction set, the seed, and how many threads that is.
pub fn engine(args: &EngineArgs) -> anyhow::Result<Engine> {
    let isa = args.isa.as_deref().map_or(Ok(Isa::best()), isa)?;
    Ok(Engine {
        isa,
        seed: args.seed,
        threads: match args.threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            n => n as usize,
        },
    })
}

/// An instruction set that this processor has.
pub fn isa(name: &str) -> anyhow::Result<Isa> {
    let isa = Isa::from_str(name).ok();
    let names = Isa::ALL.map(Isa::name);
    let isa =
        isa.with_context(|| format!("--isa: {}", no_such("instruction set", name, &names)))?;
    let available: Vec<Isa> = Isa::available().collect();
    check_available(isa, &available)?;
    Ok(isa)
}

fn check_available(isa: Isa, available: &[Isa]) -> anyhow::Result<()> {
    let names: Vec<&str> = available.iter().map(|i| i.name()).collect();
    ensure!(
        available.contains(&isa),
        "--isa {isa}: this processor does not have it; it has {}",
        names.join(", ")
    );
    Ok(())
}

/// The pixels and samples; an error if the machine has too little memory for so many rays.
pub fn film(size: Resolution, spp: Spp) -> anyhow::Result<Film> {
    /// Rays, workspace, several lists of answers, and the rays in Embree's structures.
    const BYTES_A_RAY: u64 = 400;
    let what = || format!("resolution {size}, spp {}", spp.0);
    let film = Film::new(size.width, size.height, spp.0).with_context(what)?;
    let needed = film.rays() as u64 * BYTES_A_RAY;
    let memory = Machine::here("").memory_bytes;
    let gib = |bytes: u64| bytes as f64 / (1u64 << 30) as f64;
    ensure!(
        needed <= memory,
        "{}: {} rays need about {:.0} GiB, and this machine has {:.1}",
        what(),
        thousands(film.rays() as u64),
        gib(needed),
        gib(memory)
    );
    Ok(film)
}

/// A method by its name.
pub fn method(name: &str) -> anyhow::Result<Method> {
    let found = Method::ALL.into_iter().find(|m| m.name() == name);
    found.with_context(|| no_such("method", name, &Method::ALL.map(Method::name)))
}

/// A precision by its name.
pub fn precision(name: &str) -> anyhow::Result<Precision> {
    let names = Precision::ALL.map(Precision::name);
    Precision::from_str(name).map_err(|_| anyhow::anyhow!(no_such("precision", name, &names)))
}

/// A ray type by its name.
pub fn ray_type(name: &str) -> anyhow::Result<RayType> {
    let known = RayType::ALL.map(|r| r.to_string());
    RayType::from_str(name).map_err(|_| anyhow::anyhow!(no_such("ray type", name, &known)))
}

/// An error if no file can be written there. What is there already stays as it is.
pub fn check_writable(path: &Path) -> anyhow::Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    ensure!(!path.is_dir(), "{}: it is a folder", cannot());
    ensure!(
        !path.exists() || path.is_file(),
        "{}: it is not a plain file",
        cannot()
    );
    // Files are written beside their place and renamed, so it is the folder that counts.
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    ensure!(
        folder.is_dir(),
        "{}: there is no folder {}",
        cannot(),
        folder.display()
    );
    tempfile::tempfile_in(folder).with_context(cannot)?;
    Ok(())
}

/// Every name once, in the order typed.
pub fn distinct(names: &[String]) -> impl Iterator<Item = &str> {
    let first = |(i, name): &(usize, &String)| !names[..*i].contains(name);
    let names = names.iter().enumerate();
    names.filter(first).map(|(_, name)| name.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instruction_set_that_the_processor_lacks() {
        let error = check_available(Isa::Avx512, &[Isa::Avx2, Isa::Portable]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "--isa avx512: this processor does not have it; it has avx2, portable"
        );
    }
}
