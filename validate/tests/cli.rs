//! The command line from outside: exit codes, messages, files.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder of its own for each test, with a scene of 500 triangles.
struct Folder(tempfile::TempDir);

const SCENE: &str = r#"{
  "meshes": [{ "generator": "soup", "triangles": 500, "seed": 1 }],
  "cameras": [{ "name": "front", "eye": [0.5, 0.5, 4], "look_at": [0.5, 0.5, 0.5], "up": [0, 1, 0],
                "fov_degrees": 40 }],
  "lights": [{ "type": "point", "position": [0.5, 4, 0.5] }],
  "rays": ["primary", "shadow-point", "diffuse-1"]
}"#;

impl Folder {
    fn new() -> Folder {
        let folder = Folder(tempfile::tempdir().unwrap());
        folder.write("tiny.json", SCENE);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(self.path(name)).unwrap()).unwrap()
    }

    fn write_rays(&self, name: &str) {
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 8), }";
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        let hit = [0.25f32, 0.25, 1.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY];
        let miss = [0.25f32, 0.25, 1.0, 0.0, 0.0, 0.0, 1.0, f32::INFINITY];
        bytes.extend(
            [hit, miss]
                .as_flattened()
                .iter()
                .flat_map(|x| x.to_le_bytes()),
        );
        self.write(name, bytes);
    }

    /// Runs `dacrt` in the folder, the words of the line being its arguments.
    fn dacrt(&self, line: &str) -> Run {
        self.dacrt_with(line, &[])
    }

    fn dacrt_with(&self, line: &str, env: &[(&str, &str)]) -> Run {
        let output = Command::new(env!("CARGO_BIN_EXE_dacrt"))
            .args(line.split_whitespace())
            .current_dir(self.0.path())
            .env_remove("DACRT_MESHES")
            .envs(env.iter().copied())
            .output()
            .unwrap();
        Run {
            line: line.to_owned(),
            output,
        }
    }
}

struct Run {
    line: String,
    output: Output,
}

impl Run {
    fn stdout(&self) -> String {
        String::from_utf8(self.output.stdout.clone()).unwrap()
    }

    fn stderr(&self) -> String {
        String::from_utf8(self.output.stderr.clone()).unwrap()
    }

    #[track_caller]
    fn exits(&self, code: i32) -> &Run {
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

    /// A usage error: one message with all these words in it, exit code 2, nothing on standard
    /// output.
    #[track_caller]
    fn refuses(&self, words: &[&str]) -> &Run {
        self.exits(2);
        let err = self.stderr();
        assert_eq!(err.matches("error:").count(), 1, "{}\n{err}", self.line);
        for word in words {
            assert!(err.contains(word), "{}: no {word:?} in\n{err}", self.line);
        }
        assert_eq!(self.stdout(), "", "{}", self.line);
        self
    }
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn help_is_there_for_every_command() {
    let folder = Folder::new();
    for command in ["", "run", "trace", "render", "scenes", "env"] {
        let help = folder.dacrt(&format!("{command} --help"));
        let text = help.exits(0).stdout();
        assert!(text.contains("Usage: dacrt"), "{text}");
        for line in text.lines() {
            assert!(line.chars().count() <= 100, "{command}: {line}");
        }
    }
    folder.dacrt("--version").exits(0);
}

#[test]
fn usage_errors() {
    let folder = Folder::new();
    let refuses = |line: &str, words: &[&str]| {
        folder.dacrt(line).refuses(words);
    };
    folder.dacrt("").exits(2);
    refuses("tracee", &["tracee", "trace"]);
    refuses(
        "run --scenes sibenick",
        &["no scene \"sibenick\"", "\"sibenik\""],
    );
    refuses("run --scenes zzz", &["no scene \"zzz\"", "sponza", "hall"]);
    refuses("run --scenes ./nowhere.json", &["./nowhere.json"]);
    refuses(
        "run --methods nabata",
        &["no method \"nabata\"", "\"nabata2013\""],
    );
    refuses(
        "run --rays primry",
        &["no ray type \"primry\"", "\"primary\""],
    );
    refuses(
        "run --rays diffuse-9",
        &["no ray type \"diffuse-9\"", "\"diffuse-"],
    );
    refuses("run --isa avx3", &["\"avx3\"", "\"avx2\""]);
    refuses("run --precision exact", &["exact", "fast"]);
    refuses("run --precision fats", &["\"fast\""]);
    refuses("run --threads 0", &["--threads 0", "one thread"]);
    refuses("run --threads 4", &["--threads 4", "one thread"]);
    refuses(
        "run --resolution 0",
        &["--resolution", "at least one pixel"],
    );
    refuses(
        "run --resolution 10x0",
        &["--resolution", "at least one pixel"],
    );
    refuses("run --resolution big", &["--resolution", "WxH"]);
    refuses(
        "run --scenes ./tiny.json --resolution 100000",
        &["--resolution 100000x100000"],
    );
    refuses(
        "run --scenes ./tiny.json --resolution 40000",
        &["--resolution 40000x40000", "GiB"],
    );
    refuses(
        "run --scenes ./tiny.json,tiny.json",
        &["--scenes", "same name"],
    );
    refuses("run --spp 5", &["--spp", "4 and 9"]);
    refuses("run --spp 0", &["--spp"]);
    refuses("run --repeats 0", &["--repeats"]);
    refuses("run --bins 1", &["--bins", "2 to 256"]);
    refuses("run --samples 0", &["--samples"]);
    refuses("run --skip 1.5", &["--skip"]);
    refuses("run --axes both", &["--axes", "longest"]);
    refuses("run --scenes", &["--scenes"]);
    refuses("render sibenick", &["\"sibenik\""]);
    refuses("render ./tiny.json --bins 8,16", &["--bins", "one value"]);
    refuses(
        "render ./tiny.json --method afra2012 --skip 0.5",
        &["afra2012", "--skip"],
    );
}

#[test]
fn places_that_cannot_be_written_are_refused_before_the_work() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes ./tiny.json --out nowhere/out.json")
        .refuses(&["nowhere", "folder"]);
    folder
        .dacrt("run --scenes ./tiny.json --out .")
        .refuses(&["folder"]);
    folder
        .dacrt("run --scenes ./tiny.json --out /dev/null")
        .refuses(&["/dev/null", "plain file"]);
    folder
        .dacrt("render ./tiny.json --out nowhere/picture.png")
        .refuses(&["nowhere", "folder"]);
    folder
        .dacrt("render ./tiny.json --out tiny.json/pictures")
        .refuses(&["tiny.json/pictures"]);
    folder
        .dacrt("render ./tiny.json --what depth,prim --out one.png")
        .refuses(&["one.png", "2 pictures"]);
    folder.write("m.obj", TRIANGLE);
    folder.write_rays("r.npy");
    folder
        .dacrt("trace --mesh m.obj --rays r.npy --method afra2012 --out nowhere/h.npz")
        .refuses(&["nowhere", "folder"]);
}

#[test]
fn a_missing_mesh_that_was_asked_for() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes sibenik --meshes some:other")
        .refuses(&["sibenik.obj.gz", "some", "other", "DACRT_MESHES"]);
    folder
        .dacrt_with("render sibenik", &[("DACRT_MESHES", "here")])
        .refuses(&["sibenik.obj.gz", "here", "DACRT_MESHES"]);
}

#[test]
fn scene_descriptions_that_make_no_sense() {
    let folder = Folder::new();
    let refuses = |from: &str, to: &str, words: &[&str]| {
        let text = SCENE.replace(from, to);
        assert_ne!(text, SCENE);
        folder.write("bad.json", text);
        let run = folder.dacrt("run --scenes ./bad.json --resolution 4");
        run.refuses(words).refuses(&["bad.json"]);
    };
    refuses("\"lights\"", "\"lihgts\"", &["lihgts", "line"]);
    refuses(
        "[0.5, 0.5, 0.5]",
        "[0.5, 0.5, 4]",
        &["cameras[0]", "eye", "look-at"],
    );
    refuses(
        "\"up\": [0, 1, 0]",
        "\"up\": [0, 0, 2]",
        &["up", "parallel"],
    );
    refuses("40", "180", &["cameras[0]", "field of view", "180"]);
    refuses("40", "-1", &["cameras[0]", "field of view", "-1"]);
    refuses("\"soup\"", "\"soop\"", &["soup"]);
}

#[test]
fn trace_writes_hits() {
    let folder = Folder::new();
    folder.write("m.obj", TRIANGLE);
    folder.write_rays("r.npy");
    let trace = "trace --mesh m.obj --rays r.npy --method nabata2013";
    let run = folder.dacrt(&format!("{trace} --out h.npz"));
    assert!(
        run.exits(0).stdout().starts_with("2 rays, 1 hits, "),
        "{}",
        run.stdout()
    );
    assert_eq!(run.stdout().lines().count(), 1);
    assert!(contains(&folder.path("h.npz"), b"prim.npy"));

    let run = folder.dacrt(&format!(
        "{trace} --any-hit --isa portable --counters --out o.npz"
    ));
    assert!(
        run.exits(0).stdout().starts_with("2 rays, 1 occluded, "),
        "{}",
        run.stdout()
    );
    assert!(run.stdout().contains("ray_triangle"));
    assert!(contains(&folder.path("o.npz"), b"occluded.npy"));

    folder.write(
        "far.obj",
        TRIANGLE
            .replace("v 0 0 0", "v 9 9 9")
            .replace("v 1 0 0", "v 9 8 9"),
    );
    let run = folder.dacrt("trace --mesh far.obj --rays r.npy --method afra2012 --out n.npz");
    assert!(
        run.exits(0).stdout().starts_with("2 rays, 0 hits, "),
        "{}",
        run.stdout()
    );
}

fn contains(file: &Path, bytes: &[u8]) -> bool {
    std::fs::read(file)
        .unwrap()
        .windows(bytes.len())
        .any(|w| w == bytes)
}

#[test]
fn trace_refuses_bad_input() {
    let folder = Folder::new();
    folder.write("m.obj", TRIANGLE);
    folder.write_rays("r.npy");
    let refuses = |line: &str, words: &[&str]| {
        let line = format!("trace --out h.npz {line}");
        folder.dacrt(&line).refuses(words);
        assert!(!folder.path("h.npz").exists(), "{line}");
    };
    refuses("--mesh m.obj --rays r.npy", &["--method"]);
    refuses("--mesh m.obj --rays r.npy --method afra", &["\"afra2012\""]);
    refuses(
        "--mesh m.obj --rays r.npy --method afra2012 --bins 8,9",
        &["--bins", "one value"],
    );
    refuses("--mesh no.obj --rays r.npy --method afra2012", &["no.obj"]);
    refuses("--mesh m.obj --rays no.npy --method afra2012", &["no.npy"]);
    refuses(
        "--mesh m.obj --rays m.obj --method afra2012",
        &["m.obj", "byte 0"],
    );
    folder.write("edge.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n");
    refuses(
        "--mesh edge.obj --rays r.npy --method afra2012",
        &["edge.obj", "line 3"],
    );
    folder.write("range.obj", "v 0 0 0\nf 1 2 3\n");
    refuses(
        "--mesh range.obj --rays r.npy --method afra2012",
        &["range.obj", "line 2"],
    );
    folder.write("empty.obj", "");
    refuses(
        "--mesh empty.obj --rays r.npy --method afra2012",
        &["empty.obj"],
    );
    let mut rays = std::fs::read(folder.path("r.npy")).unwrap();
    rays.pop();
    folder.write("short.npy", rays);
    refuses(
        "--mesh m.obj --rays short.npy --method afra2012",
        &["short.npy", "bytes"],
    );
}

#[test]
fn pictures() {
    let folder = Folder::new();
    let run = folder.dacrt("render ./tiny.json --what shaded,depth,prim,boxes --resolution 20x10");
    run.exits(0);
    for what in ["shaded", "depth", "prim", "boxes"] {
        let name = format!("tiny-{what}.png");
        assert!(run.stdout().contains(&name), "{}", run.stdout());
        assert_size(&folder.path(&name), 20, 10);
    }
    folder
        .dacrt("render ./tiny.json --resolution 9 --out p/q --what depth")
        .exits(0);
    assert_size(&folder.path("p/q/tiny-depth.png"), 9, 9);
    folder
        .dacrt("render ./tiny.json --resolution 9 --out x.png --spp 1")
        .exits(0);
    assert_size(&folder.path("x.png"), 9, 9);
}

/// The width and height of a PNG file stand at bytes 16 and 20.
#[track_caller]
fn assert_size(file: &Path, width: u32, height: u32) {
    let bytes = std::fs::read(file).unwrap();
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    let size = [&bytes[16..20], &bytes[20..24]].map(|b| u32::from_be_bytes(b.try_into().unwrap()));
    assert_eq!(size, [width, height]);
}

#[test]
fn run_measures_and_writes_every_cell() {
    let folder = Folder::new();
    let run = folder.dacrt(
        "run --scenes ./tiny.json --resolution 16,8x4 --spp 4 --rays primary,diffuse-1 \
         --bins 8,16 --samples 20,40 --repeats 2 --out out.json",
    );
    let text = run.exits(0).stdout();
    assert!(
        text.contains("samples=40") && text.contains("geometric means"),
        "{text}"
    );
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    assert_eq!(run.stderr(), "", "no progress bar without a terminal");

    let document = folder.json("out.json");
    assert_eq!(document["schema"], 1);
    assert_eq!(
        document["machine"]["cores"].as_u64().map(|n| n > 0),
        Some(true)
    );
    assert_eq!(document["command"][0], "dacrt");
    let cells = document["cells"].as_array().unwrap();
    // Two sizes, two ray types; 2 cells of the baseline, 4 of ray sampling.
    assert_eq!(cells.len(), 2 * 2 * (2 + 4));
    for cell in cells {
        assert_eq!(cell["scene"], "tiny");
        assert_eq!(cell["samples_ms"].as_array().unwrap().len(), 2);
        assert!(cell["acceleration_ratio"].as_f64().unwrap() > 0.0);
        assert!(cell["ratio_embree_total"].as_f64().unwrap() > 0.0);
        assert_eq!(cell["diff"]["unexplained"], 0);
        assert_eq!(cell["embree"]["build_ms"].as_object().unwrap().len(), 3);
        assert_eq!(cell["embree"]["trace_ms"].as_object().unwrap().len(), 9);
        let same_rays = cells.iter().filter(|c| c["ray_hash"] == cell["ray_hash"]);
        assert_eq!(same_rays.clone().count(), 6);
        assert!(same_rays.clone().all(|c| c["hit_hash"] == cell["hit_hash"]));
        let is_baseline = cell["method"] == "afra2012";
        assert_eq!(cell["parameters"].get("samples").is_none(), is_baseline);
        assert_eq!(cell["parameters"].get("sah_ratio").is_some(), is_baseline);
    }
    assert_eq!(cells[0]["ray_count"], 16 * 16 * 4);
}

#[test]
fn without_the_baseline_there_is_no_acceleration_ratio() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json --resolution 8 --rays primary --repeats 1 --out out.json";
    folder
        .dacrt(&format!("{run} --methods nabata2013"))
        .exits(0);
    let cells = folder.json("out.json")["cells"].take();
    assert_eq!(cells.as_array().unwrap().len(), 1);
    assert!(cells[0]["acceleration_ratio"].is_null());
    // The baseline's defaults are not in this run either.
    let other = folder.dacrt(&format!("{run} --sah-ratio 3"));
    assert!(
        other.exits(0).stderr().contains("no acceleration ratio"),
        "{}",
        other.stderr()
    );
    assert!(folder.json("out.json")["cells"][1]["acceleration_ratio"].is_null());
}

#[test]
fn resume_keeps_what_is_finished() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json --resolution 8 --repeats 1 --out out.json --rays";
    folder.dacrt(&format!("{run} primary")).exits(0);
    let first = folder.json("out.json")["cells"].take();
    let again = folder.dacrt(&format!("{run} primary,random --resume"));
    assert_eq!(again.exits(0).stdout().matches("random").count(), 2);
    let both = folder.json("out.json")["cells"].take();
    assert_eq!(both.as_array().unwrap()[..2], first.as_array().unwrap()[..]);
    assert_eq!(both.as_array().unwrap().len(), 4);
    // Ratios are within one run: a batch of which a cell is missing is measured anew.
    folder
        .dacrt(&format!("{run} primary --resume --samples 10,100"))
        .exits(0);
    let more = folder.json("out.json")["cells"].take();
    assert_eq!(more.as_array().unwrap().len(), 2 + 3);

    folder
        .dacrt(&format!("{run} primary --resume --seed 7"))
        .refuses(&["out.json", "seed"]);
    folder.write("out.json", "{");
    folder
        .dacrt(&format!("{run} primary --resume"))
        .refuses(&["out.json"]);
    folder.dacrt(&format!("{run} primary")).exits(0);
}

#[test]
fn a_wrong_hit_is_a_finding() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json --resolution 8 --repeats 1 --out out.json --rays primary";
    folder.dacrt(run).exits(0);
    // No hit of ours is wrong, so a finished cell is made to look as if.
    let good = folder.json("out.json");
    let resumed = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut document = good.clone();
        change(&mut document["cells"][1]);
        folder.write("out.json", document.to_string());
        folder.dacrt(&format!("{run} --resume"))
    };
    let wrong = resumed(&|cell| {
        for key in [
            "samples_ms",
            "median_ms",
            "mrays_per_s",
            "acceleration_ratio",
            "embree",
        ] {
            cell[key] = serde_json::Value::Null;
        }
        cell["diff"]["unexplained"] = 3.into();
    });
    let text = wrong.exits(1).stdout();
    assert!(text.contains("WRONG") && text.contains("FINDING"), "{text}");
    let differing = resumed(&|cell| cell["hit_hash"] = "0".into());
    assert!(
        differing.exits(1).stderr().contains("different hits"),
        "{}",
        differing.stderr()
    );
    resumed(&|_| {}).exits(0);
}

#[test]
fn without_scenes_a_missing_mesh_is_a_warning() {
    let folder = Folder::new();
    let run = "run --resolution 4 --repeats 1 --rays primary --methods afra2012 --out out.json";
    let run = folder.dacrt(&format!("{run} --meshes nowhere"));
    let warnings = run.exits(0).stderr();
    for scene in ["sibenik", "conference", "sponza"] {
        let line = warnings
            .lines()
            .find(|l| l.contains(&format!("scene {scene}:")));
        let line = line.unwrap_or_else(|| panic!("{scene}: {warnings}"));
        assert!(
            line.starts_with("warning:") && line.contains("nowhere"),
            "{line}"
        );
    }
    let cells = folder.json("out.json")["cells"].take();
    let scenes: Vec<_> = cells
        .as_array()
        .unwrap()
        .iter()
        .map(|c| c["scene"].clone())
        .collect();
    assert_eq!(scenes, ["hall", "relief", "soup"]);
}

#[test]
fn a_view_of_nothing_is_no_finding() {
    let folder = Folder::new();
    folder.write(
        "away.json",
        SCENE.replace("[0.5, 0.5, 0.5]", "[0.5, 0.5, 9]"),
    );
    let run = folder.dacrt("run --scenes ./away.json --resolution 8 --repeats 1 --out out.json");
    assert!(!run.exits(0).stdout().contains("WRONG"), "{}", run.stdout());
    let cells = folder.json("out.json")["cells"].take();
    assert_eq!(cells[0]["hits"], 0);
    assert_eq!(cells[2]["ray_count"], 0);
    assert!(cells[2]["median_ms"].is_null());
}

#[test]
fn scenes_lists_all_and_says_what_is_missing() {
    let folder = Folder::new();
    let text = folder.dacrt("scenes --meshes nowhere").exits(0).stdout();
    for name in ["hall", "relief", "soup", "sibenik", "sanmiguel-tables"] {
        assert!(
            text.lines()
                .any(|l| l.split_whitespace().next() == Some(name)),
            "{name}\n{text}"
        );
    }
    assert!(text.contains("sibenik.obj.gz not found"), "{text}");
    assert!(
        text.contains("nowhere") && text.contains("DACRT_MESHES"),
        "{text}"
    );
}

#[test]
fn env_as_text_and_json() {
    let folder = Folder::new();
    let text = folder.dacrt("env --meshes nowhere").exits(0).stdout();
    assert!(
        text.contains("Embree") && text.contains("nowhere (does not exist)"),
        "{text}"
    );
    let json: serde_json::Value =
        serde_json::from_str(&folder.dacrt("env --json").exits(0).stdout()).unwrap();
    assert!(
        json["software"]["embree"]["version"]
            .as_str()
            .unwrap()
            .starts_with("4.")
    );
    assert_eq!(
        json["isa_available"].as_array().unwrap().last().unwrap(),
        "portable"
    );
}
