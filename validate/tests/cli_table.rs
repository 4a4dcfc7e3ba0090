//! `dacrt table`: what only some result files have.

mod command;

use command::Folder;

#[test]
fn rays_through_stored_splits_have_the_tests_of_the_trace() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json --rays primary,diffuse-1 --methods afra2012,mora2011,mora2011-cones,best \
               --resolution 32 --repeats 2 --twins --out out.json";
    folder.dacrt(run).exits(0);
    let cells = folder.json("out.json")["cells"].take();
    for cell in cells.as_array().unwrap() {
        let twin = &cell["twin"];
        // Of cones where the origin is shared.
        let is_of_rays = match cell["method"].as_str().unwrap() {
            "best" => false,
            "mora2011-cones" => cell["rays"] != "primary",
            _ => true,
        };
        match is_of_rays {
            true => assert_eq!(twin["ray_box"], twin["one_by_one_ray_box"], "{cell}"),
            false => assert!(twin["one_by_one_ray_box"].is_null(), "{cell}"),
        }
        assert_eq!(twin["differing_rays"], 0, "{cell}");
        // Lists of triangles only, and not for the rays that made them.
        let is_reused = cell["method"] == "afra2012" && cell["rays"] == "diffuse-1";
        assert_eq!(twin["reuse"].is_object(), is_reused, "{cell}");
    }
    let table = folder.dacrt("table out.json --twins").exits(0).stdout();
    for line in table.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let equal = table.lines().filter(|line| line.ends_with(" ="));
    assert_eq!(equal.count(), 8, "{table}");
    let together = table.lines().filter(|line| line.ends_with(" - ="));
    assert_eq!(together.count(), 3, "{table}");
    let none = folder.dacrt("run --scenes ./tiny.json --resolution 8 --repeats 1 --out none.json");
    none.exits(0);
    folder
        .dacrt("table none.json --twins")
        .refuses(&["--twins"]);
}

#[test]
fn an_ablation_has_each_technique_alone_and_left_out() {
    let folder = Folder::new();
    let sweep = r#"{ "scenes": ["./tiny.json"], "resolution": [64], "rays": ["primary"],
        "methods": ["afra2012", "nabata2013"],
        "parameters": { "cost": ["sah", "sampled"], "order": ["one-ray", "sampled"], "skip": [1, 0.5] } }"#;
    folder.write("sweep.json", sweep);
    folder
        .dacrt("sweep sweep.json --repeats 2 --out out.json")
        .exits(0);
    let table = folder.dacrt("table out.json --ablation").exits(0).stdout();
    for line in table.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    for words in ["cost", "order", "skip", "alone", "last"] {
        assert!(table.contains(words), "{words}\n{table}");
    }
}

#[test]
fn a_table_of_several_cameras_says_which() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json --cameras front,generated-1 --rays primary --methods best \
               --resolution 16 --repeats 1 --out out.json";
    let printed = folder.dacrt(run).exits(0).stdout();
    let table = folder.dacrt("table out.json").exits(0).stdout();
    for text in [&printed, &table] {
        let heads: Vec<&str> = text
            .lines()
            .filter(|line| line.contains("camera "))
            .collect();
        assert_eq!(
            heads,
            ["tiny, camera front", "tiny, camera generated-1"],
            "{text}"
        );
    }
}
