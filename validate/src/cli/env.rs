//! `dacrt env`: what a result of this machine would say about where it comes from.

use super::Verdict;
use super::args::EnvArgs;
use super::source::{mesh_folders, scene_folder};
use super::text::{columns, print};
use dacrt::Isa;
use dacrt_validate::embree::Device;
use dacrt_validate::machine::{Machine, Software};
use serde::Serialize;
use std::path::PathBuf;

/// As JSON, the keys of `machine` and `software` are those of a result file.
#[derive(Serialize)]
struct Env {
    machine: Machine,
    software: Software,
    isa_available: Vec<String>,
    scene_folder: PathBuf,
    mesh_folders: Vec<MeshFolder>,
}

#[derive(Serialize)]
struct MeshFolder {
    path: PathBuf,
    exists: bool,
}

/// Prints it all, as text or JSON.
pub fn env(args: &EnvArgs) -> anyhow::Result<Verdict> {
    let folders = mesh_folders(&args.meshes).into_iter();
    let env = Env {
        machine: Machine::here(&Isa::best().to_string()),
        software: Software::this(Some(Device::new(1)?.info().into())),
        isa_available: Isa::available().map(|i| i.to_string()).collect(),
        scene_folder: scene_folder(),
        mesh_folders: folders
            .map(|path| MeshFolder {
                exists: path.is_dir(),
                path,
            })
            .collect(),
    };
    print(&if args.json {
        serde_json::to_string_pretty(&env)? + "\n"
    } else {
        env.text()
    })?;
    Ok(Verdict::Good)
}

impl Env {
    fn text(&self) -> String {
        let Env {
            machine, software, ..
        } = self;
        let commit = software.commit.as_deref().unwrap_or("unknown");
        let dirty = match software.dirty {
            Some(true) => ", with changes",
            _ => "",
        };
        let embree = software.embree.as_ref();
        let mut lines = vec![
            ("processor", machine.cpu.clone()),
            ("cores", machine.cores.to_string()),
            (
                "memory",
                format!(
                    "{:.1} GiB",
                    machine.memory_bytes as f64 / (1u64 << 30) as f64
                ),
            ),
            ("load", machine.load.map(|l| format!("{l:.2}")).join(" ")),
            (
                "instruction sets",
                format!(
                    "{} (in use: {})",
                    self.isa_available.join(", "),
                    machine.isa
                ),
            ),
            (
                "Embree",
                embree.map_or("none".to_owned(), |e| {
                    format!("{} ({}, {})", e.version, e.isa, e.library)
                }),
            ),
            ("commit", format!("{commit}{dirty}")),
            ("compiler", software.rustc.clone()),
            ("scenes", self.scene_folder.display().to_string()),
        ];
        for folder in &self.mesh_folders {
            let note = if folder.exists {
                ""
            } else {
                " (does not exist)"
            };
            lines.push(("meshes", format!("{}{note}", folder.path.display())));
        }
        if self.mesh_folders.is_empty() {
            lines.push(("meshes", "no folder: set DACRT_MESHES".to_owned()));
        }
        let rows: Vec<Vec<String>> = lines
            .into_iter()
            .map(|(name, value)| vec![name.to_owned(), value])
            .collect();
        columns(&rows, &[])
    }
}
