//! `dacrt replay`: each way to name a ray, what it shows, and that findings can be replayed.

mod command;

use command::{Folder, TRIANGLE, npy};
use serde_json::Value;

/// Runs a replay with --json.
#[track_caller]
fn json(folder: &Folder, line: &str, code: i32) -> Value {
    let run = folder.dacrt(&format!("{line} --json"));
    serde_json::from_str(&run.exits(code).stdout()).unwrap()
}

fn of<'v>(replay: &'v Value, event: &str) -> Vec<&'v Value> {
    let steps = replay["steps"].as_array().unwrap().iter();
    steps.filter(|step| step["event"] == event).collect()
}

/// The prims of all leaves.
fn met(replay: &Value) -> Vec<u64> {
    let tests = of(replay, "leaf")
        .into_iter()
        .flat_map(|s| s["tests"].as_array().unwrap());
    tests.map(|test| test["prim"].as_u64().unwrap()).collect()
}

#[test]
fn a_ray_of_a_result_file_is_the_one_of_then() {
    let folder = Folder::new();
    folder
        .dacrt(
            "run --scenes ./tiny.json --resolution 32 --repeats 1 --out out.json \
             --rays primary,shadow-point,diffuse-1 --methods \
             afra2012,nabata2013,mora2011,mora2011-cones,mora2011-random",
        )
        .exits(0);
    let cells = folder.json("out.json")["cells"].take();
    let mut seen = std::collections::BTreeSet::new();
    for cell in cells.as_array().unwrap() {
        let [scene, rays, method] = ["scene", "rays", "method"].map(|k| cell[k].as_str().unwrap());
        let name = format!("{scene}/{rays}/32x32/1/{method}");
        let ray = cell["ray_count"].as_u64().unwrap() / 2;
        let line = format!("replay out.json --scene ./tiny.json --cell {name} --ray {ray}");
        let replay = json(&folder, &line, 0);
        assert_eq!(replay["hits_as_in_file"], true, "{name}");
        assert_eq!(replay["shared_origin"], cell["shared_origin"], "{name}");
        assert_eq!(replay["steps"][0]["depth"], 0, "{name}");
        // What the ray hits it has met in a leaf, with the same t.
        let answer = &replay["answers"][0]["answer"];
        if let Some(hit) = answer.get("hit") {
            assert!(
                met(&replay).contains(&hit["prim"].as_u64().unwrap()),
                "{name}"
            );
            let mut tests = (of(&replay, "leaf").into_iter())
                .flat_map(|step| step["tests"].as_array().unwrap());
            let test = tests.find(|test| test["prim"] == hit["prim"]).unwrap();
            assert_eq!(test["t"], hit["t"], "{name}");
            assert_eq!(replay["exact_hits"][0]["prim"], hit["prim"], "{name}");
        }
        // A rejected box is one that the interval misses, or that is behind the best t.
        for step in replay["steps"].as_array().unwrap() {
            let number = |v: &Value| v.as_f64().unwrap_or(f64::INFINITY);
            let [near, far] = [0, 1].map(|i| number(&step["interval"][i]));
            let meets = near <= far && near <= number(&step["best"]["t"]);
            match step["event"].as_str().unwrap() {
                "kept" if step["depth"] != 0 => assert!(meets, "{name} {step}"),
                "rejected" => assert!(!meets, "{name} {step}"),
                _ => {}
            }
        }
        let events = replay["steps"].as_array().unwrap().iter();
        seen.extend(events.map(|step| step["event"].as_str().unwrap().to_owned()));
        let text = folder.dacrt(&line);
        let text = text.exits(0).stdout();
        for line in text.lines() {
            assert!(line.chars().count() <= 100, "{line}");
        }
        for word in [
            "fast, alone",
            "exact, alone",
            "Embree robust",
            "right",
            "path:",
        ] {
            assert!(text.contains(word), "no {word:?} in\n{text}");
        }
    }
    for event in ["kept", "rejected", "leaf", "terminated"] {
        assert!(seen.contains(event), "{event}: {seen:?}");
    }
}

#[test]
fn a_ray_of_a_scene_needs_no_result_file() {
    let folder = Folder::new();
    let line = "replay --scene ./tiny.json --rays primary --resolution 32 --ray 528";
    let first = json(&folder, line, 0);
    assert_eq!(
        (&first["method"], &first["ray_count"]),
        (&"afra2012".into(), &1024.into())
    );
    assert_eq!(first["hits_as_in_file"], Value::Null);
    let exact = json(
        &folder,
        &format!("{line} --precision exact --method mora2011"),
        0,
    );
    assert_eq!(exact["ray_bits"], first["ray_bits"]);
    assert_eq!(exact["precision"], "exact");
    // Alone, by its bits, it is the same ray with the same answers.
    let bits: Vec<&str> = (first["ray_bits"].as_array().unwrap().iter())
        .map(|b| b.as_str().unwrap())
        .collect();
    let line = format!("replay --scene ./tiny.json --ray {}", bits.join(","));
    let alone = json(&folder, &line, 0);
    assert_eq!(alone["ray_bits"], first["ray_bits"]);
    for i in 1..6 {
        assert_eq!(alone["answers"][i], first["answers"][i]);
    }
}

#[test]
fn rays_are_skipped_and_go_in_cones() {
    let folder = Folder::new();
    let line = "replay --scene ./tiny.json --rays primary --resolution 128 --ray 8300";
    let cones = json(
        &folder,
        &format!("{line} --method mora2011-cones --widest-cone 45"),
        0,
    );
    for event in ["kept_with_cone", "rejected_with_cone", "leaf"] {
        assert!(!of(&cones, event).is_empty(), "{event}");
    }
    let sampled = format!("{line} --method nabata2013 --skip 0.2");
    let skipped = json(&folder, &sampled, 0);
    assert!(of(&skipped, "skipped")[0]["ratio"].as_f64().unwrap() > 0.2);
    assert_eq!(skipped["answers"], {
        let mut answers = cones["answers"].clone();
        answers[0]["who"] = "nabata2013 fast, in the batch".into();
        answers
    });
}

#[test]
fn a_ray_of_ones_own_is_shown_with_its_numbers() {
    let folder = Folder::new();
    folder.write("triangle.obj", TRIANGLE);
    folder.write_rays("rays.npy");
    let line = "replay --mesh triangle.obj --rays rays.npy --ray";
    let hit = json(&folder, &format!("{line} 0"), 0);
    let test = &of(&hit, "leaf")[0]["tests"][0];
    let number = |name: &str| test[name].as_f64().unwrap();
    assert_eq!(["u", "v", "w"].map(number), [0.25, 0.25, 0.5]);
    assert_eq!(["num", "den", "t", "exact_t"].map(number), [1.0; 4]);
    assert_eq!(test["sure"], "hit");
    assert_eq!(hit["exact_hits"][0]["t"], "1e0");
    assert_eq!(hit["exact_hits"][0]["t_bits"], "0x3f800000");
    assert_eq!(
        json(&folder, &format!("{line} 1"), 0)["exact_hits"],
        Value::Array(vec![])
    );

    let text = folder.dacrt("replay --mesh triangle.obj --ray 0.25,0.25,1,0,0,0,-3,0x7f800000");
    let text = text.exits(0).stdout();
    // 1/3
    for word in [
        "3.33333333333333333333333333333…e-1",
        "0x3eaaaaab",
        "right",
        "0xc0400000",
    ] {
        assert!(text.contains(word), "no {word:?} in\n{text}");
    }
    let text = folder.dacrt("replay --mesh triangle.obj --any-hit --ray -1,0.25,1,0,0,0,0,inf");
    let text = text.exits(0).stdout();
    assert!(
        text.contains("invalid, and so a miss: its direction is zero"),
        "{text}"
    );
    assert!(text.contains("free"), "{text}");
}

#[test]
fn a_tie_and_an_edge_are_told_by_exact_arithmetic() {
    let folder = Folder::new();
    // The same triangle twice, and one beside it; the ray hits the edge between them.
    let two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 1 2 3\nf 2 4 3\n";
    folder.write("two.obj", two);
    let line = "replay --mesh two.obj --precision exact --ray 0.25,0.75,1,0,0,0,-1,inf";
    let replay = json(&folder, line, 0);
    let prims: Vec<u64> = (replay["exact_hits"].as_array().unwrap().iter())
        .map(|hit| hit["prim"].as_u64().unwrap())
        .collect();
    assert_eq!(prims, [0, 1, 2]);
    let tests = of(&replay, "leaf")[0]["tests"].as_array().unwrap().clone();
    assert!(tests.iter().any(|test| test["sure"] == "open"), "{tests:?}");
    let text = folder.dacrt(line);
    let text = text.exits(0).stdout();
    assert_eq!(text.matches("as near").count(), 2, "{text}");
    assert!(text.contains("not sure: exactly hit"), "{text}");
}

#[test]
fn the_command_that_a_finding_prints_shows_the_wrong_ray() {
    let folder = Folder::new();
    // The printed rule of termination is wrong by design.
    let run = folder.dacrt(
        "run --scenes hall --resolution 64 --rays primary --repeats 1 --out out.json \
         --methods mora2011 --terminate-as-printed true,false",
    );
    let text = run.exits(1).stdout();
    let command = text
        .lines()
        .find_map(|line| line.trim().strip_prefix("dacrt replay"));
    let command = command.unwrap_or_else(|| panic!("no command in\n{text}"));
    let line = format!("replay{}", command.replace('\'', ""));
    let replay = json(&folder, &line, 1);
    assert_eq!(replay["hits_as_in_file"], true);
    assert_eq!(replay["parameters"]["terminate_as_printed"], true);
    let cells = folder.json("out.json")["cells"].take();
    let offender = &cells[0]["diff"]["offending"][0];
    assert_eq!(replay["ray_bits"], offender["ray_bits"]);
    assert_eq!(replay["answers"][0]["answer"], offender["ours"]);
    assert_eq!(replay["answers"][0]["verdict"], offender["verdicts"][0]);
    assert_eq!(replay["answers"][4]["answer"], offender["embree_fast"]);
    assert!(!of(&replay, "terminated").is_empty());
    let text = folder.dacrt(&line);
    assert!(
        text.exits(1)
            .stdout()
            .contains("FINDING: mora2011 fast, in the batch")
    );
}

#[test]
fn what_cannot_be_replayed_is_refused() {
    let folder = Folder::new();
    folder.write("triangle.obj", TRIANGLE);
    folder.write_rays("rays.npy");
    let run = "run --scenes ./tiny.json --resolution 8 --repeats 1 --out out.json --rays primary";
    folder.dacrt(run).exits(0);
    let of_file = "replay out.json --scene ./tiny.json --cell tiny/primary/8x8/1/afra2012";

    let refuses = |line: &str, words: &[&str]| {
        folder.dacrt(line).refuses(words);
    };
    refuses(&format!("{of_file} --ray 64"), &["--ray 64", "64 rays"]);
    refuses(
        &format!("{of_file} --ray 1,0,0,0,0,0,1,1"),
        &["--ray", "number"],
    );
    refuses(&format!("{of_file} --ray 1 --bins 8"), &["parameters"]);
    refuses(
        &format!("{of_file} --ray 1 --precision exact"),
        &["--precision"],
    );
    refuses(
        "replay out.json --scene ./tiny.json --cell tiny/primary/8x8/1/afra --ray 0",
        &["no cell", "tiny/primary/8x8/1/afra2012"],
    );
    refuses(
        "replay out.json --scene ./tiny.json --ray 0",
        &["5 cells", "--cell"],
    );
    refuses("replay missing.json --ray 0", &["missing.json"]);
    refuses(
        "replay --mesh triangle.obj --rays rays.npy --ray 2",
        &["--ray 2", "2 rays"],
    );
    refuses("replay --mesh triangle.obj --ray 2", &["--rays"]);
    refuses(
        "replay --mesh triangle.obj --rays primary --ray 2",
        &["--scene"],
    );
    refuses("replay --rays rays.npy --ray 1", &["--mesh", "--scene"]);
    refuses(
        "replay --scene ./tiny.json --rays primry --ray 1",
        &["primary"],
    );
    refuses("replay --mesh triangle.obj --ray 1,2,3", &["eight numbers"]);
    refuses(
        "replay --mesh triangle.obj --ray 1,2,3,4,5,6,7,0x12",
        &["0x12"],
    );
    refuses(
        "replay --mesh triangle.obj --rays rays.npy --ray 0 --precision right",
        &["precision", "right"],
    );
    folder.write("bad.npy", npy("<f8", "False", "(0, 8)", &[]));
    refuses(
        "replay --mesh triangle.obj --rays bad.npy --ray 0",
        &["bad.npy"],
    );

    // Another scene than then.
    let other = command::SCENE.replace("\"eye\": [0.5, 0.5, 4]", "\"eye\": [0.5, 0.5, 5]");
    folder.write("tiny.json", other);
    refuses(&format!("{of_file} --ray 1"), &["hash", "camera"]);
}
