//! Scenes before they are loaded: descriptions read, meshes found.

use super::args::MeshArgs;
use anyhow::Context;
use dacrt::scene::{Description, Light, MeshSource, SceneError, find, locate};
use dacrt::workloads::{Camera, RayType};
use glam::{DVec3, Vec3};
use std::path::{Path, PathBuf};

/// A scene that is ready to be loaded.
pub struct SceneSource {
    pub json: PathBuf,
    pub description: Description,
}

/// A view of one scene.
#[derive(Clone, Debug)]
pub struct View {
    pub camera_name: String,
    pub camera: Camera,
    pub light: Option<Vec3>,
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

    /// The first camera and the first light.
    pub fn view(&self) -> anyhow::Result<View> {
        let camera = &self.description.cameras[0];
        let light = self.description.lights.first();
        Ok(View {
            camera_name: camera.name.clone(),
            camera: Camera::new(
                camera.eye.into(),
                camera.look_at.into(),
                camera.up.into(),
                camera.fov_degrees,
            )
            .with_context(|| format!("{}, cameras[0]", self.json.display()))?,
            light: light.map(|Light::Point { position }| DVec3::from(*position).as_vec3()),
        })
    }

    /// Whether the description says that the scene is for these rays.
    pub fn is_for(&self, rays: RayType) -> bool {
        self.description.rays.contains(&rays.to_string())
    }
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
