//! `dacrt scenes`: which scenes there are and where their meshes are.

use super::Verdict;
use super::args::ScenesArgs;
use super::source::{SceneSource, mesh_folders, scene_folder};
use super::text::{columns, print, thousands};
use dacrt::scene::{MeshSource, Scene, locate, names};
use std::path::PathBuf;

/// Prints the table. A scene whose mesh is missing is no error here.
pub fn scenes(args: &ScenesArgs) -> anyhow::Result<Verdict> {
    let folders = mesh_folders(&args.meshes);
    let head = ["scene", "triangles", "cameras", "mesh"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    let mut missing = 0;
    for name in names(&scene_folder())? {
        let source = SceneSource::find(&name)?;
        let is_there = source.missing_mesh(&folders).is_none();
        missing += usize::from(!is_there);
        let triangles = match is_there && args.load {
            true => thousands(Scene::load(&source.json, &folders)?.mesh.len() as u64),
            false => generated_triangles(&source).map_or("-".to_owned(), |n| format!("~{n}")),
        };
        let cameras = source.description.cameras.iter().map(|c| c.name.as_str());
        let cameras = cameras.collect::<Vec<_>>().join(", ");
        for (i, mesh) in source.description.meshes.iter().enumerate() {
            let mesh = mesh_place(mesh, &source, &folders);
            rows.push(match i {
                0 => vec![name.clone(), triangles.clone(), cameras.clone(), mesh],
                _ => vec![String::new(), String::new(), String::new(), mesh],
            });
        }
    }
    let mut text = columns(&rows, &[1]);
    if missing > 0 {
        let list: Vec<String> = folders.iter().map(|f| f.display().to_string()).collect();
        text += &format!(
            "\n{missing} not found: looked in {}{}. More folders: --meshes or DACRT_MESHES.\n",
            scene_folder().display(),
            list.iter().map(|f| format!(", {f}")).collect::<String>()
        );
    }
    print(&text)?;
    Ok(Verdict::Good)
}

/// About how many triangles there are, if no file has to be read for that.
fn generated_triangles(source: &SceneSource) -> Option<String> {
    let counts = source.description.meshes.iter().map(|mesh| match mesh {
        MeshSource::Generator { triangles, .. } => Some(*triangles as u64),
        MeshSource::File(_) => None,
    });
    Some(thousands(counts.sum::<Option<u64>>()?))
}

fn mesh_place(mesh: &MeshSource, source: &SceneSource, folders: &[PathBuf]) -> String {
    match mesh {
        MeshSource::Generator { name, .. } => format!("generated ({name})"),
        MeshSource::File(file) => match locate(file, &source.json, folders) {
            Ok(path) => path.display().to_string(),
            Err(_) => format!("{} not found", file.display()),
        },
    }
}
