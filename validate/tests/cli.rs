//! The commands from outside: what they print and write when all is well, and their verdicts.

mod command;

use command::{Folder, SCENE, TRIANGLE};
use std::path::Path;

#[test]
fn help_is_there_for_every_command() {
    let folder = Folder::new();
    for command in [
        "", "run", "report", "paper", "bench", "trace", "replay", "render", "scenes", "env",
    ] {
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
fn trace_writes_hits() {
    let folder = Folder::new();
    folder.write("m.obj", TRIANGLE);
    folder.write_rays("r.npy");
    let trace = "trace --mesh m.obj --rays r.npy --method nabata2013";
    let run = folder.dacrt(&format!("{trace} --out h.npz"));
    assert!(
        run.exits(0).stdout().starts_with("2 rays, 1 hit, "),
        "{}",
        run.stdout()
    );
    assert_eq!(run.stdout().lines().count(), 1);
    assert!(contains(&folder.path("h.npz"), b"prim.npy"));
    for method in ["afra2012", "mora2011", "mora2011-cones", "mora2011-random"] {
        let run = folder.dacrt(&format!(
            "trace --mesh m.obj --rays r.npy --method {method} --out other.npz"
        ));
        assert!(run.exits(0).stdout().starts_with("2 rays, 1 hit, "));
        let bytes = ["h.npz", "other.npz"].map(|name| std::fs::read(folder.path(name)).unwrap());
        assert!(bytes[0] == bytes[1], "{method}");
    }

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
fn pictures() {
    let folder = Folder::new();
    let run =
        folder.dacrt("render ./tiny.json --what shaded,depth,prim,boxes,diff --resolution 20x10");
    run.exits(0);
    assert!(
        run.stdout().contains("tiny-diff.png (same 200)"),
        "{}",
        run.stdout()
    );
    for what in ["shaded", "depth", "prim", "boxes", "diff"] {
        let name = format!("tiny-{what}.png");
        assert!(run.stdout().contains(&name), "{}", run.stdout());
        assert_size(&folder.path(&name), 20, 10);
    }
    folder
        .dacrt("render ./tiny.json --resolution 9 --out p/q --what depth")
        .exits(0);
    assert_size(&folder.path("p/q/tiny-depth.png"), 9, 9);
    folder
        .dacrt(
            "render ./tiny.json --resolution 9 --out m --what depth,boxes --method mora2011-cones",
        )
        .exits(0);
    let read = |name| std::fs::read(folder.path(name)).unwrap();
    assert!(read("p/q/tiny-depth.png") == read("m/tiny-depth.png"));
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
    // And no progress bar without a terminal.
    let warning = "warning: no acceleration ratio of best and Mora's methods without an afra2012 \
                   cell with all of its defaults\n";
    assert_eq!(run.stderr(), warning);

    let document = folder.json("out.json");
    assert_eq!(document["schema"], 1);
    assert_eq!(
        document["machine"]["cores"].as_u64().map(|n| n > 0),
        Some(true)
    );
    assert_eq!(document["command"][0], "dacrt");
    let cells = document["cells"].as_array().unwrap();
    // Two sizes; 2 cells of the baseline, 4 of ray sampling, 1 of the fastest; of Mora's methods two
    // for primary rays, and one for diffuse ones, where they are the same.
    assert_eq!(cells.len(), 2 * ((2 + 4 + 1 + 2) + (2 + 4 + 1 + 1)));
    for cell in cells {
        assert_eq!(cell["scene"], "tiny");
        assert_eq!(cell["samples_ms"].as_array().unwrap().len(), 2);
        let method = cell["method"].as_str().unwrap();
        let of_mora = method.starts_with("mora");
        // The baseline with its defaults is not in this run.
        assert_eq!(
            cell["acceleration_ratio"].is_null(),
            of_mora || method == "best"
        );
        assert!(cell["ratio_embree_total"].as_f64().unwrap() > 0.0);
        assert_eq!(cell["diff"]["exact"]["ours_wrong"], 0);
        assert_eq!(cell["embree"]["build_ms"].as_object().unwrap().len(), 3);
        assert_eq!(cell["embree"]["trace_ms"].as_object().unwrap().len(), 9);
        let same_rays = cells.iter().filter(|c| c["ray_hash"] == cell["ray_hash"]);
        let primary = cell["rays"] == "primary";
        assert_eq!(same_rays.clone().count(), if primary { 9 } else { 8 });
        assert!(same_rays.clone().all(|c| c["hit_hash"] == cell["hit_hash"]));
        let is_baseline = method == "afra2012";
        assert_eq!(
            cell["parameters"].get("samples").is_some(),
            method == "nabata2013"
        );
        let variant = cell["parameters"].get("variant");
        assert_eq!(variant.is_some(), of_mora);
        assert!(primary || !of_mora || variant.unwrap() == "random");
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
    let run = "run --scenes ./tiny.json --resolution 8 --repeats 1 --out out.json \
               --methods afra2012,nabata2013 --rays";
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

/// Which variant of Mora's method a batch takes shows only when it is traced.
#[test]
fn resume_knows_a_cell_whatever_variant_it_took() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json --resolution 8 --repeats 1 --out out.json --resume \
               --rays primary,diffuse-1 --methods mora2011,mora2011-cones,mora2011-random";
    folder.dacrt(run).exits(0);
    let first = folder.json("out.json");
    let cells = first["cells"].as_array().unwrap();
    let variants: Vec<_> = (cells.iter().map(|cell| &cell["parameters"]["variant"])).collect();
    assert_eq!(
        variants,
        ["basic", "cones", "random", "random", "random", "random"]
    );
    folder.dacrt(run).exits(0);
    assert_eq!(folder.json("out.json")["cells"], first["cells"]);
}

#[test]
fn the_printed_rule_of_termination_has_its_wrong_rays_counted() {
    let folder = Folder::new();
    let run = folder.dacrt(
        "run --scenes hall --resolution 64 --rays primary --repeats 1 --out out.json \
         --methods nabata2013,mora2011 --terminate-as-printed false,true",
    );
    let text = run.exits(1).stdout();
    let cells = folder.json("out.json")["cells"].take();
    for right in [&cells[0], &cells[1]] {
        assert!(right.get("printed_rule_wrong").is_none());
        assert!(right["median_ms"].as_f64().unwrap() > 0.0);
    }
    let printed = &cells[2];
    assert_eq!(printed["parameters"]["terminate_as_printed"], true);
    let wrong = printed["printed_rule_wrong"].as_u64().unwrap();
    assert!(wrong > 0 && printed["diff"]["exact"]["ours_wrong"].as_u64().unwrap() > 0);
    assert!(printed["median_ms"].is_null());
    let line = format!("wrong by the printed rule: {wrong} of 4,096 rays\n");
    assert_eq!(text.matches(&line).count(), 1, "{text}");
    assert!(
        text.ends_with("--terminate-as-printed true is for\n"),
        "{text}"
    );
    let warnings = run.stderr();
    assert_eq!(warnings.lines().count(), 1, "{warnings}");
    assert!(warnings.contains("--terminate-as-printed"), "{warnings}");
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
        cell["diff"]["exact"]["ours_wrong"] = 3.into();
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
    let shadow = cells.as_array().unwrap().iter();
    let shadow: Vec<_> = shadow.filter(|c| c["rays"] == "shadow-point").collect();
    assert!(!shadow.is_empty());
    for cell in shadow {
        assert_eq!(cell["ray_count"], 0);
        assert!(cell["median_ms"].is_null());
    }
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
