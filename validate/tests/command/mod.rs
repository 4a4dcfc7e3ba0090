//! Runs the command `dacrt` as a user does, in a folder of its own.

#![allow(dead_code)] // Not every test file uses all of it.

use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

/// A folder of its own for each test, with a scene of 500 triangles.
pub struct Folder(tempfile::TempDir);

/// A small scene.
pub const SCENE: &str = r#"{
  "meshes": [{ "generator": "soup", "triangles": 500, "seed": 1 }],
  "cameras": [{ "name": "front", "eye": [0.5, 0.5, 4], "look_at": [0.5, 0.5, 0.5], "up": [0, 1, 0],
                "fov_degrees": 40 }],
  "lights": [{ "type": "point", "position": [0.5, 4, 0.5] }],
  "rays": ["primary", "shadow-point", "diffuse-1"]
}"#;

impl Folder {
    pub fn new() -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        folder.write("tiny.json", SCENE);
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(self.path(name)).unwrap()).unwrap()
    }

    /// A room of the size of Sibenik's nave with a wall across, under the name of its mesh.
    pub fn write_nave(&self) {
        let mut text = String::new();
        for x in [-20, 20] {
            for y in ["-15.3", "15"] {
                for z in ["-8.5", "8.5"] {
                    text += &format!("v {x} {y} {z}\n");
                }
            }
        }
        text += "v 14 -15.3 -8\nv 14 -15.3 2\nv 14 3 2\nv 14 3 -8\n";
        for quad in [
            "1 2 4 3",
            "5 6 8 7",
            "1 2 6 5",
            "3 4 8 7",
            "1 3 7 5",
            "2 4 8 6",
            "9 10 11 12",
        ] {
            text += &format!("f {quad}\n");
        }
        self.write("sibenik.obj.gz", text);
    }

    /// Two rays, of which the first hits [`TRIANGLE`].
    pub fn write_rays(&self, name: &str) {
        let hit = [0.25f32, 0.25, 1.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY];
        let miss = [0.25f32, 0.25, 1.0, 0.0, 0.0, 0.0, 1.0, f32::INFINITY];
        let bytes: Vec<u8> = ([hit, miss].as_flattened().iter())
            .flat_map(|x| x.to_le_bytes())
            .collect();
        self.write(name, npy("<f4", "False", "(2, 8)", &bytes));
    }

    /// Runs `dacrt` in the folder, the words of the line being its arguments.
    pub fn dacrt(&self, line: &str) -> Run {
        self.dacrt_with(line, &[])
    }

    pub fn dacrt_with(&self, line: &str, env: &[(&str, &str)]) -> Run {
        Run {
            line: line.to_owned(),
            output: self
                .command(line)
                .envs(env.iter().copied())
                .output()
                .unwrap(),
        }
    }

    /// The command, not yet run.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dacrt"));
        command
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .env_remove("DACRT_MESHES")
            .stdin(Stdio::null());
        command
    }
}

/// What became of a command.
pub struct Run {
    pub line: String,
    pub output: Output,
}

impl Run {
    pub fn stdout(&self) -> String {
        String::from_utf8(self.output.stdout.clone()).unwrap()
    }

    pub fn stderr(&self) -> String {
        String::from_utf8(self.output.stderr.clone()).unwrap()
    }

    #[track_caller]
    pub fn exits(&self, code: i32) -> &Run {
        let (out, err) = (self.stdout(), self.stderr());
        assert_eq!(
            self.output.status.code(),
            Some(code),
            "{}\n{out}\n{err}",
            self.line
        );
        assert!(!err.contains("panicked"), "{}\n{err}", self.line);
        self
    }

    /// One message of one line (clap adds the usage) with all these words in it, exit code 2,
    /// nothing on standard output.
    #[track_caller]
    pub fn refuses(&self, words: &[&str]) -> &Run {
        self.exits(2);
        let err = self.stderr();
        assert_eq!(err.matches("error:").count(), 1, "{}\n{err}", self.line);
        assert!(
            err.matches("(os error").count() <= 1,
            "{}\n{err}",
            self.line
        );
        let one_line = err.lines().count() == 1 || err.contains("try '--help'");
        assert!(one_line, "{}\n{err}", self.line);
        for word in words {
            assert!(err.contains(word), "{}: no {word:?} in\n{err}", self.line);
        }
        assert_eq!(self.stdout(), "", "{}", self.line);
        self
    }
}

/// The bytes of an .npy file of version 1.0.
pub fn npy(descr: &str, fortran_order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': {fortran_order}, 'shape': {shape}, }}");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

/// An OBJ file of one triangle.
pub const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
