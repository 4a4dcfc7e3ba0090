//! `dacrt render`: pictures of a scene.

use super::Verdict;
use super::args::{RenderArgs, What};
use super::engine::Engine;
use super::picture::Picture;
use super::plan::{self, check_writable};
use super::shade;
use super::size::{Resolution, Spp};
use super::source::{SceneSource, Views, mesh_folders};
use super::text::{print, thousands};
use anyhow::{Context, bail, ensure};
use dacrt::scene::Scene;
use dacrt::workloads::{RayType, Workload};
use dacrt::{Batch, Hits, Mesh, Parameters, Precision};
use dacrt_validate::diff::{Checker, Class};
use dacrt_validate::embree::{self, Device, Mode, Quality, Query};
use dacrt_validate::judge::{Answers, Judge};
use std::path::{Path, PathBuf};

/// Traces and writes the pictures; says where they are.
pub fn render(args: &RenderArgs) -> anyhow::Result<Verdict> {
    let method = plan::method(&args.method)?;
    let source = SceneSource::find(&args.scene)?;
    let files = files(args, &source.name())?;
    let job = RenderJob {
        source: &source,
        camera: args.camera.as_deref(),
        resolution: args.resolution,
        spp: args.spp,
        parameters: args.knobs.single(method)?,
        precision: plan::precision(&args.precision)?,
        engine: plan::engine(&args.engine)?,
        mesh_folders: mesh_folders(&args.meshes),
    };
    let mut files = files.into_iter();
    job.pictures(&args.what, &mut |_, picture, note| {
        let (_, file) = files.next().context("a file for each picture")?;
        picture.save(&file)?;
        let note = match note {
            "" => String::new(),
            note => format!(" ({note})"),
        };
        print(&format!("{}{note}\n", file.display()))
    })?;
    Ok(Verdict::Good)
}

/// What pictures are made of, and how.
pub struct RenderJob<'a> {
    pub source: &'a SceneSource,
    /// The first one, if it is not named.
    pub camera: Option<&'a str>,
    pub resolution: Resolution,
    /// Of the shaded picture.
    pub spp: Spp,
    pub parameters: Parameters,
    pub precision: Precision,
    pub engine: plan::Engine,
    pub mesh_folders: Vec<PathBuf>,
}

/// Takes a picture and what is to be known of it, which may be empty.
type Taker<'a> = dyn FnMut(What, Picture, &str) -> anyhow::Result<()> + 'a;

impl RenderJob<'_> {
    /// Makes pictures one after the other.
    ///
    /// # Errors
    /// If a mesh is missing or damaged, the camera is unknown, a picture is too large, or by `take`.
    pub fn pictures(&self, what: &[What], take: &mut Taker) -> anyhow::Result<()> {
        let one_sample = plan::film(self.resolution, Spp(1))?;
        let samples = plan::film(self.resolution, self.spp)?;
        if let Some(missing) = self.source.missing_mesh(&self.mesh_folders) {
            bail!(missing);
        }
        let mesh = Scene::load(&self.source.json, &self.mesh_folders)?.mesh;
        let mut engine = Engine::new(self.engine.tracer(self.parameters, self.precision), &mesh);
        let view = Views::new(self.source, &mesh).of(self.camera)?;
        let workload = |film| Workload::new(&mesh, view.clone(), film, self.engine.seed);

        // All but shaded have one sample a pixel: a mean of two numbers of triangles is none.
        let mut plain = workload(one_sample)?;
        let primary = plain.rays(RayType::Primary, &mut |b| engine.nearest(b).0)?;
        let (hits, _) = engine.nearest(&primary.batch);
        for &what in what {
            let mut note = String::new();
            let picture = match what {
                What::Shaded => {
                    let mut workload = workload(samples)?;
                    shade::shaded(&mut workload, &mesh, &mut engine, &view)?
                }
                What::Depth => shade::depth(one_sample, &hits),
                What::Prim => shade::prim(one_sample, &hits),
                What::Boxes => {
                    let (picture, most) = shade::boxes(one_sample, &primary.batch, &mut engine);
                    note = format!("red: {most:.1} ray/box tests a ray");
                    picture
                }
                What::Diff => {
                    let classes = self.classes(&mesh, &primary.batch, &hits)?;
                    note = told(&classes);
                    shade::diff(one_sample, &mesh, &primary.batch, &hits, &classes)
                }
            };
            take(what, picture, &note)?;
        }
        Ok(())
    }

    /// The class of each hit against Embree.
    fn classes(&self, mesh: &Mesh, batch: &Batch, hits: &Hits) -> anyhow::Result<Vec<Class>> {
        let device = Device::new(1)?;
        let answers = |robust| -> anyhow::Result<Hits> {
            let scene = embree::Scene::build(&device, mesh, Quality::Medium, robust)?;
            let mut answers = Hits::misses(batch.len());
            scene.nearest(batch, Query::Single, &mut answers);
            Ok(answers)
        };
        let (fast, robust) = (answers(false)?, answers(true)?);
        let of = Answers::Nearest;
        let judge = Judge::new(mesh);
        let checker = Checker::new(&judge, batch, of(&fast), of(&robust), 0, self.engine.seed);
        let mode = Mode::against(self.precision);
        Ok(checker.classes(self.precision, of(hits), mode))
    }
}

/// How many rays there are of each class: `same 65,530, edge 6`.
fn told(classes: &[Class]) -> String {
    let count = |class: Class| classes.iter().filter(|&&c| c == class).count() as u64;
    let all = [Class::Same].into_iter().chain(Class::PARTED);
    let counts = all.map(|class| (class.name(), count(class)));
    let there = counts.filter(|(name, n)| *n > 0 || *name == "same");
    let parts = there.map(|(name, n)| format!("{name} {}", thousands(n)));
    parts.collect::<Vec<_>>().join(", ")
}

/// Where each picture goes: all places are proven writable.
fn files(args: &RenderArgs, scene: &str) -> anyhow::Result<Vec<(What, PathBuf)>> {
    let in_folder =
        |folder: &Path, what: &What| (*what, folder.join(format!("{scene}-{}.png", what.name())));
    let files: Vec<(What, PathBuf)> = match &args.out {
        Some(file)
            if file
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("png")) =>
        {
            ensure!(
                args.what.len() == 1,
                "--out {} is one file for {} pictures: name a folder",
                file.display(),
                args.what.len()
            );
            vec![(args.what[0], file.clone())]
        }
        Some(folder) => {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("--out: cannot make the folder {}", folder.display()))?;
            args.what.iter().map(|w| in_folder(folder, w)).collect()
        }
        None => args
            .what
            .iter()
            .map(|w| in_folder(Path::new(""), w))
            .collect(),
    };
    for (_, file) in &files {
        check_writable(file).context("--out")?;
    }
    Ok(files)
}
