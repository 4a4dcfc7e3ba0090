//! The ray to be replayed: its mesh, its batch, and how that is traced.

use super::args::{RayChoice, ReplayArgs};
use crate::cli::engine::Engine;
use crate::cli::plan;
use crate::cli::size::{Resolution, Spp};
use crate::cli::source::{SceneSource, Views, mesh_folders};
use anyhow::{Context, bail, ensure};
use dacrt::scene::{load_mesh, no_such};
use dacrt::workloads::{Film, RayType, Workload};
use dacrt::{Batch, Mesh, Method, Parameters, Precision, Ray, Tracer};
use dacrt_validate::compare::Names;
use dacrt_validate::hash::ray_hash;
use dacrt_validate::npy::read_rays;
use dacrt_validate::parameters::fields;
use dacrt_validate::results::{Cell, CellKey, Document};
use glam::Vec3;
use std::path::Path;

/// A ray and all that decides what becomes of it.
pub struct Case {
    pub mesh: Mesh,
    pub batch: Batch,
    pub index: usize,
    pub any_hit: bool,
    pub method: Method,
    pub parameters: Parameters,
    pub precision: Precision,
    pub own_origins: bool,
    pub isa: dacrt::Isa,
    pub seed: u64,
    /// Where the ray is from, in words.
    pub from: String,
    /// The hits that the cell had.
    pub hit_hash: Option<String>,
}

impl Case {
    /// Finds mesh and rays.
    pub fn new(args: &ReplayArgs) -> anyhow::Result<Case> {
        match &args.result {
            Some(path) => of_result(args, path),
            None => of_arguments(args),
        }
    }

    pub fn ray(&self) -> Ray {
        self.batch.ray(self.index)
    }

    pub fn tracer(&self) -> Tracer {
        Tracer::new(self.parameters)
            .with_isa(self.isa)
            .with_precision(self.precision)
            .with_seed(self.seed)
            .with_own_origins(self.own_origins)
    }
}

/// A ray of a cell.
fn of_result(args: &ReplayArgs, path: &Path) -> anyhow::Result<Case> {
    let RayChoice::Number(index) = args.ray else {
        bail!("--ray: of a result file, the number of a ray is expected");
    };
    let document = Document::read(path)?;
    let cell = cell(&document, args.cell.as_deref()).with_context(|| path.display().to_string())?;
    let CellKey {
        scene,
        resolution,
        spp,
        rays,
        method,
        precision,
        camera,
        ..
    } = &cell.key;
    let method = plan::method(method)?;
    ensure!(
        args.knobs.is_empty(),
        "the parameters of {method} stand in the result file"
    );
    let parameters = parameters(method, &cell.key)
        .with_context(|| format!("{}: parameters of {method}", path.display()))?;
    let source = SceneSource::find(args.scene.as_deref().unwrap_or(scene))?;
    let film = plan::film(
        Resolution {
            width: resolution[0],
            height: resolution[1],
        },
        Spp(*spp),
    )?;
    let rays = plan::ray_type(rays)?;
    in_range(index, cell.ray_count)?;
    let (mesh, batch) = workload(args, &source, Some(camera), film, rays, document.seed)?;
    let hash = ray_hash(&batch);
    ensure!(
        hash == cell.ray_hash,
        "{}: the rays of {} are not those of then: their hash is {}, not {}; \
         is it another mesh, camera or light?",
        path.display(),
        Names::of(&[&document]).name(&cell.key),
        short(&hash),
        short(&cell.ray_hash)
    );
    Ok(Case {
        mesh,
        batch,
        index,
        any_hit: rays.is_any_hit(),
        method,
        parameters,
        precision: plan::precision(precision)?,
        own_origins: false,
        isa: isa(args)?,
        seed: document.seed,
        from: format!(
            "{}, {}",
            path.display(),
            Names::of(&[&document]).name(&cell.key)
        ),
        hit_hash: Some(cell.hit_hash.clone()),
    })
}

/// A ray of a scene's rays, of a file, or by its numbers.
fn of_arguments(args: &ReplayArgs) -> anyhow::Result<Case> {
    let method = args
        .method
        .as_deref()
        .map_or(Ok(Method::Afra2012), plan::method)?;
    let parameters = args.knobs.single(method)?;
    let precision = args
        .precision
        .as_deref()
        .map_or(Ok(Precision::Fast), plan::precision)?;
    let isa = isa(args)?;
    let seed = args.seed.unwrap_or(1);
    let (mut any_hit, mut from) = (args.any_hit, String::new());
    let (mesh, batch, index) = match (args.ray, args.rays.as_deref()) {
        (RayChoice::Floats(floats), rays) => {
            ensure!(
                rays.is_none(),
                "--rays: the eight numbers of --ray are a ray already"
            );
            from += "its numbers, a batch of its own";
            let batch = Batch::from_iter([ray(floats)]);
            (some_mesh(args)?, batch, 0)
        }
        (RayChoice::Number(_), None) => bail!(
            "--ray with a number takes --rays with a ray type or an .npy file, or a result file"
        ),
        (RayChoice::Number(index), Some(file)) if file.ends_with(".npy") => {
            let batch = read_rays(Path::new(file))?;
            in_range(index, batch.len())?;
            from += file;
            (some_mesh(args)?, batch, index)
        }
        (RayChoice::Number(index), Some(rays)) => {
            let rays = plan::ray_type(rays)?;
            let Some(scene) = &args.scene else {
                bail!("--rays {rays}: a ray type takes --scene");
            };
            let resolution = args.resolution.unwrap_or(Resolution {
                width: 512,
                height: 512,
            });
            let film = plan::film(resolution, args.spp.unwrap_or(Spp(1)))?;
            let source = SceneSource::find(scene)?;
            let camera = args.camera.as_deref();
            let (mesh, batch) = workload(args, &source, camera, film, rays, seed)?;
            in_range(index, batch.len())?;
            any_hit |= rays.is_any_hit();
            from += &format!("{} {rays} {resolution}", source.name());
            (mesh, batch, index)
        }
    };
    Ok(Case {
        mesh,
        batch,
        index,
        any_hit,
        method,
        parameters,
        precision,
        own_origins: args.own_origins,
        isa,
        seed,
        from,
        hit_hash: None,
    })
}

/// The cell of that name, or the only one.
fn cell<'d>(document: &'d Document, name: Option<&str>) -> anyhow::Result<&'d Cell> {
    let names = Names::of(&[document]);
    let all: Vec<String> = document.cells.iter().map(|c| names.name(&c.key)).collect();
    let place = match (name, all.len()) {
        (_, 0) => bail!("there is no cell in it"),
        (None, 1) => 0,
        (None, n) => bail!(
            "there are {n} cells in it: --cell names one, such as {}",
            all[0]
        ),
        (Some(name), _) => (all.iter().position(|n| n == name))
            .with_context(|| format!("--cell: {}", no_such("cell", name, &all)))?,
    };
    Ok(&document.cells[place])
}

fn in_range(index: usize, rays: usize) -> anyhow::Result<()> {
    ensure!(
        index < rays,
        "--ray {index}: there are {rays} rays, from 0 on"
    );
    Ok(())
}

/// The parameters of a cell: those of the preset, where the cell does not have its own.
fn parameters(method: Method, key: &CellKey) -> anyhow::Result<Parameters> {
    let preset = method.parameters();
    let mut values = fields(&preset);
    let own = key.choices();
    values.extend(own.map(|(name, value)| (name.clone(), value.clone())));
    let values = serde_json::Value::Object(values);
    let parameters = match preset {
        Parameters::Object(_) => Parameters::Object(serde_json::from_value(values)?),
        Parameters::Space(_) => Parameters::Space(serde_json::from_value(values)?),
        Parameters::Best(_) => Parameters::Best(serde_json::from_value(values)?),
    };
    parameters.check()?;
    Ok(parameters)
}

/// The mesh of a scene, and its rays of one type, as `dacrt run` makes them.
fn workload(
    args: &ReplayArgs,
    source: &SceneSource,
    camera: Option<&str>,
    film: Film,
    rays: RayType,
    seed: u64,
) -> anyhow::Result<(Mesh, Batch)> {
    let mesh = source.mesh(&mesh_folders(&args.meshes))?;
    let view = Views::new(source, &mesh).of(camera)?;
    let batch = {
        let mut engine = Engine::new(Tracer::new(Method::Afra2012.parameters()), &mesh);
        let mut workload = Workload::new(&mesh, view, film, seed)?;
        workload
            .rays(rays, &mut |parents| engine.nearest(parents).0)?
            .batch
    };
    Ok((mesh, batch))
}

/// The mesh of --mesh or --scene.
fn some_mesh(args: &ReplayArgs) -> anyhow::Result<Mesh> {
    match (&args.mesh, &args.scene) {
        (Some(file), _) => Ok(load_mesh(file)?),
        (None, Some(scene)) => SceneSource::find(scene)?.mesh(&mesh_folders(&args.meshes)),
        (None, None) => bail!("--mesh or --scene is missing: what may the ray hit?"),
    }
}

fn ray([ox, oy, oz, tmin, dx, dy, dz, tmax]: [f32; 8]) -> Ray {
    Ray {
        origin: Vec3::new(ox, oy, oz),
        tmin,
        direction: Vec3::new(dx, dy, dz),
        tmax,
    }
}

fn isa(args: &ReplayArgs) -> anyhow::Result<dacrt::Isa> {
    args.isa
        .as_deref()
        .map_or(Ok(dacrt::Isa::best()), plan::isa)
}

/// The beginning of a hash.
fn short(hash: &str) -> &str {
    &hash[..hash.len().min(12)]
}
