//! Scenes before they are loaded: descriptions read, meshes found.

use super::args::MeshArgs;
use super::engine::Engine;
use anyhow::{Context, bail, ensure};
use dacrt::scene::{Description, Lens, MeshSource, SceneError, find, load_meshes, locate, no_such};
use dacrt::workloads::{Camera, GENERATED_CAMERAS, RayType, View, generated_cameras};
use dacrt::{Mesh, Method, Tracer};
use std::path::{Path, PathBuf};

/// Cameras that the program makes are called this, a hyphen, and a number from 1 on.
const GENERATED: &str = "generated";
/// The same with the lens of the first camera that has one.
const GENERATED_LENS: &str = "generated-lens";

/// A scene that is ready to be loaded.
pub struct SceneSource {
    pub json: PathBuf,
    pub description: Description,
}

impl SceneSource {
    /// Reads the description of a scene, by name or by the path of its JSON file.
    pub fn find(name: &str) -> anyhow::Result<SceneSource> {
        // The message of a name that does not exist needs no folder.
        let json = find(name, &scene_folder()).map_err(|error| match error {
            SceneError::Unknown { problem, .. } => {
                anyhow::anyhow!("{problem} (`dacrt scenes` lists them all)")
            }
            other => other.into(),
        })?;
        let description = Description::load(&json)?;
        Ok(SceneSource { json, description })
    }

    /// The name: that of the JSON file.
    pub fn name(&self) -> String {
        let stem = self.json.file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    }

    /// Which mesh file is not to be found, and where it was looked for; none if all are there.
    pub fn missing_mesh(&self, mesh_folders: &[PathBuf]) -> Option<String> {
        let files = self
            .description
            .meshes
            .iter()
            .filter_map(|mesh| match mesh {
                MeshSource::File(file) => Some(file),
                MeshSource::Generator { .. } => None,
            });
        let mut errors = files.filter_map(|file| locate(file, &self.json, mesh_folders).err());
        let error = errors.next()?;
        let name = self.name();
        Some(format!(
            "scene {name}: {error}; --meshes or DACRT_MESHES names more folders"
        ))
    }

    /// The triangles of all meshes.
    pub fn mesh(&self, mesh_folders: &[PathBuf]) -> anyhow::Result<Mesh> {
        if let Some(missing) = self.missing_mesh(mesh_folders) {
            bail!(missing);
        }
        Ok(load_meshes(&self.json, &self.description, mesh_folders)?)
    }

    /// The name of this camera, or of the first.
    pub fn camera_name<'a>(&'a self, name: Option<&'a str>) -> &'a str {
        name.unwrap_or(&self.description.cameras[0].name)
    }

    /// The names of cameras, `generated` and `generated-lens` for all of those; an error if one does
    /// not exist.
    pub fn cameras(&self, names: &[String]) -> anyhow::Result<Vec<String>> {
        let described = self.description.cameras.iter().map(|c| c.name.clone());
        let mut all: Vec<String> = described.collect();
        all.extend(numbered(GENERATED));
        if self.lens().is_some() {
            all.extend(numbered(GENERATED_LENS));
        }
        let mut cameras = Vec::new();
        for name in names {
            let meant = match name.as_str() {
                GENERATED | GENERATED_LENS => numbered(name).collect(),
                _ => vec![name.clone()],
            };
            for name in meant {
                let known: Vec<&str> = all.iter().map(String::as_str).collect();
                ensure!(
                    all.contains(&name),
                    "{}: {}",
                    self.json.display(),
                    no_such("camera", &name, &known)
                );
                if !cameras.contains(&name) {
                    cameras.push(name);
                }
            }
        }
        Ok(cameras)
    }

    /// The lens of the first camera that has one.
    fn lens(&self) -> Option<Lens> {
        let mut lenses = self.description.cameras.iter().filter_map(|c| c.lens);
        lenses.next()
    }

    /// An error if a camera of this name, or the scene, lacks what these rays need.
    pub fn allows(&self, camera: Option<&str>, rays: RayType) -> anyhow::Result<()> {
        let camera = self.camera_name(camera);
        let described = self.described(camera).unwrap_or_else(|| {
            let mut first = self.description.cameras[0].clone();
            first.lens = match camera.starts_with(GENERATED_LENS) {
                true => self.lens(),
                false => None,
            };
            first
        });
        let view = self.description.view(described.camera()?);
        (view.allows(rays)).with_context(|| format!("{}, camera {camera}", self.json.display()))
    }

    fn described(&self, name: &str) -> Option<dacrt::scene::Camera> {
        let mut cameras = self.description.cameras.iter();
        cameras.find(|camera| camera.name == name).cloned()
    }

    /// Whether the description says that the scene is for these rays.
    pub fn is_for(&self, rays: RayType) -> bool {
        self.description.rays.contains(&rays.to_string())
    }
}

/// The views of a scene that is loaded.
pub struct Views<'a> {
    source: &'a SceneSource,
    mesh: &'a Mesh,
    /// Made when they are first asked for.
    generated: Vec<Camera>,
}

impl<'a> Views<'a> {
    pub fn new(source: &'a SceneSource, mesh: &'a Mesh) -> Views<'a> {
        Views {
            source,
            mesh,
            generated: Vec::new(),
        }
    }

    /// The view of a camera, by its name, or of the first.
    pub fn of(&mut self, name: Option<&str>) -> anyhow::Result<View> {
        let SceneSource { json, description } = self.source;
        let name = self.source.camera_name(name);
        let camera = match self.source.described(name) {
            Some(camera) => camera
                .camera()
                .with_context(|| format!("{}, camera {name}", json.display()))?,
            None => self.generated(name)?,
        };
        Ok(description.view(camera))
    }

    fn generated(&mut self, name: &str) -> anyhow::Result<Camera> {
        if self.generated.is_empty() {
            let first = &self.source.description.cameras[0];
            let mut engine = Engine::new(Tracer::new(Method::Afra2012.parameters()), self.mesh);
            self.generated = generated_cameras(
                self.mesh,
                first.eye.into(),
                first.up.into(),
                first.fov_degrees,
                &mut |batch| engine.nearest(batch).0,
            )?;
        }
        let place = |group| numbered(group).position(|known| known == name);
        let with_lens = place(GENERATED_LENS);
        let camera = (with_lens.or_else(|| place(GENERATED)))
            .and_then(|i| self.generated.get(i).copied())
            .with_context(|| {
                format!(
                    "{}: there is no camera {name}; {} could be made",
                    self.source.json.display(),
                    self.generated.len()
                )
            })?;
        match self.source.lens().filter(|_| with_lens.is_some()) {
            Some(Lens { radius, focus }) => {
                Ok(camera.with_lens(dacrt::workloads::Lens { radius, focus })?)
            }
            None => Ok(camera),
        }
    }
}

/// The name of the n-th camera that the program makes, from 1 on.
pub fn generated(n: u32, with_lens: bool) -> String {
    let group = if with_lens { GENERATED_LENS } else { GENERATED };
    format!("{group}-{n}")
}

/// The names of all cameras of a group that the program makes.
fn numbered(group: &str) -> impl Iterator<Item = String> {
    (1..=GENERATED_CAMERAS).map(move |i| format!("{group}-{i}"))
}

/// Where the scene descriptions of this repository are.
pub fn scene_folder() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.parent().unwrap_or(package).join("scenes")
}

/// The folders of `--meshes` or `DACRT_MESHES`.
pub fn mesh_folders(args: &MeshArgs) -> Vec<PathBuf> {
    let list = args.meshes.as_deref().unwrap_or_default();
    let folders = list.split(':').filter(|folder| !folder.is_empty());
    folders.map(PathBuf::from).collect()
}
