//! Scenes: a description in a JSON file, and the triangles that it names.

pub mod description;
pub mod generators;
mod loaders;
mod nearest;

pub use description::{Camera, Description, Lens, Light, MeshSource, Mirror};
pub use loaders::{MeshError, Place, load_mesh, mesh_from_bytes};
pub use nearest::no_such;

use crate::{Mesh, Triangle};
use std::io;
use std::path::{Path, PathBuf};

/// A scene ready to be traced.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The name of its JSON file, without folder and `.json`.
    pub name: String,
    /// What the JSON file says.
    pub description: Description,
    /// The triangles of all meshes, one mesh after the other.
    pub mesh: Mesh,
}

impl Scene {
    /// Loads the scene of a JSON file (see [`find`]); its meshes are looked for as [`locate`] says.
    ///
    /// # Errors
    /// All of [`SceneError`] but [`SceneError::Unknown`].
    pub fn load(json: &Path, mesh_folders: &[PathBuf]) -> Result<Scene, SceneError> {
        let description = Description::load(json)?;
        let mesh = load_meshes(json, &description, mesh_folders)?;
        let name = json.file_stem().unwrap_or_default();
        Ok(Scene {
            name: name.to_string_lossy().into_owned(),
            description,
            mesh,
        })
    }
}

/// Loads or makes the meshes of a description, one after the other; `json` is the file that the
/// description is from.
///
/// # Errors
/// [`SceneError::MissingMesh`], [`SceneError::Mesh`], or [`SceneError::Invalid`] if there are more
/// than `u32::MAX - 1` triangles in all.
pub fn load_meshes(
    json: &Path,
    description: &Description,
    mesh_folders: &[PathBuf],
) -> Result<Mesh, SceneError> {
    let invalid = |key: String, problem: String| SceneError::Invalid {
        file: json.to_owned(),
        key,
        problem,
    };
    let mut all: Vec<Triangle> = Vec::new();
    for (i, source) in description.meshes.iter().enumerate() {
        let triangles = match source {
            MeshSource::File(file) => loaders::load_triangles(&locate(file, json, mesh_folders)?)?,
            MeshSource::Generator {
                name,
                triangles,
                seed,
            } => {
                let made = generators::generate(name, *triangles, *seed).ok_or_else(|| {
                    let problem = no_such("generator", name, &generators::NAMES);
                    invalid(format!("meshes[{i}].generator"), problem)
                })?;
                made.into_triangles()
            }
        };
        if all.is_empty() {
            all = triangles;
        } else {
            all.extend(triangles);
        }
        if all.len() > loaders::MOST_TRIANGLES {
            return Err(invalid(
                format!("meshes[{i}]"),
                loaders::too_many_triangles(),
            ));
        }
    }
    Ok(Mesh::new(all))
}

/// Finds a mesh file beside the JSON file that names it, or else in the mesh folders, in their
/// order. An absolute path is taken as it is.
///
/// # Errors
/// [`SceneError::MissingMesh`], with the folders searched.
pub fn locate(file: &Path, json: &Path, mesh_folders: &[PathBuf]) -> Result<PathBuf, SceneError> {
    let beside = match json.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let folders = || std::iter::once(beside).chain(mesh_folders.iter().map(PathBuf::as_path));
    folders()
        .map(|folder| folder.join(file))
        .find(|path| path.exists())
        .ok_or_else(|| SceneError::MissingMesh {
            file: file.to_owned(),
            searched: folders().map(Path::to_owned).collect(),
        })
}

/// The JSON file of a scene: `scene_folder/NAME.json`, or the file itself if `name` is a path (it
/// has a slash or ends in `.json`).
///
/// # Errors
/// [`SceneError::Unknown`] with the nearest name that exists.
pub fn find(name: &str, scene_folder: &Path) -> Result<PathBuf, SceneError> {
    if name.contains('/') || name.ends_with(".json") {
        return Ok(PathBuf::from(name));
    }
    let json = scene_folder.join(format!("{name}.json"));
    if json.is_file() && !is_schema(&json) {
        return Ok(json);
    }
    Err(SceneError::Unknown {
        folder: scene_folder.to_owned(),
        problem: no_such("scene", name, &names(scene_folder)?),
    })
}

/// Whether it is the JSON Schema of scene descriptions, which stands beside them.
fn is_schema(json: &Path) -> bool {
    json.to_string_lossy().ends_with(".schema.json")
}

/// The names of the scenes in a folder, sorted.
///
/// # Errors
/// [`SceneError::Unreadable`] if the folder cannot be listed.
pub fn names(scene_folder: &Path) -> Result<Vec<String>, SceneError> {
    let list = || -> io::Result<Vec<String>> {
        let mut names = Vec::new();
        for entry in std::fs::read_dir(scene_folder)? {
            let path = entry?.path();
            if path.extension().is_some_and(|e| e == "json")
                && !is_schema(&path)
                && let Some(stem) = path.file_stem()
            {
                names.push(stem.to_string_lossy().into_owned());
            }
        }
        names.sort();
        Ok(names)
    };
    list().map_err(|source| SceneError::Unreadable {
        file: scene_folder.to_owned(),
        source,
    })
}

/// Why a scene could not be loaded. The message is one line: file, place, what was expected and
/// what was found.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// There is no scene of this name.
    #[error("{}: {problem}", folder.display())]
    Unknown {
        /// The folder of the scenes.
        folder: PathBuf,
        /// Which name there is not, and which is near.
        problem: String,
    },
    /// The JSON file, or the folder of such files, could not be read.
    #[error("{}: cannot be read: {source}", file.display())]
    Unreadable {
        /// The file or folder.
        file: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file is no JSON, or has a key that is unknown, missing or of the wrong type.
    #[error("{}, line {line}, column {column}: {problem}", file.display())]
    Json {
        /// The JSON file.
        file: PathBuf,
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What was expected and what was found.
        problem: String,
    },
    /// A value in the JSON file makes no sense.
    #[error("{}, {key}: {problem}", file.display())]
    Invalid {
        /// The JSON file.
        file: PathBuf,
        /// The key, for example `cameras[0].up`.
        key: String,
        /// What was expected and what was found.
        problem: String,
    },
    /// A mesh file is in none of the folders: the one error that a run over all scenes passes over.
    #[error("mesh {} not found, looked in {}", file.display(), list(searched))]
    MissingMesh {
        /// As the JSON file names it.
        file: PathBuf,
        /// The folders searched, in this order.
        searched: Vec<PathBuf>,
    },
    /// A mesh file is there but cannot be loaded.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl SceneError {
    fn json(file: &Path, error: &serde_json::Error) -> SceneError {
        let (line, column) = (error.line(), error.column());
        let text = error.to_string();
        let place = format!(" at line {line} column {column}");
        SceneError::Json {
            file: file.to_owned(),
            line,
            column,
            // It may quote a key with a line break in it.
            problem: (text.strip_suffix(&place).unwrap_or(&text)).replace(char::is_control, " "),
        }
    }
}

fn list(folders: &[PathBuf]) -> String {
    let names: Vec<String> = folders.iter().map(|f| f.display().to_string()).collect();
    names.join(", ")
}
