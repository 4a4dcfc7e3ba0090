//! `dacrt compare` on the files of real runs: like themselves, damaged in every way, accepted.

mod command;

use command::{Folder, Run};
use serde_json::{Value, json};
use std::sync::OnceLock;

const RUN: &str = "run --scenes ./tiny.json --resolution 24 --repeats 3";
const NABATA: &str = "tiny/primary/24x24/1/nabata2013";

/// The result of a real run, made once; its times are made those of a quiet machine.
fn result() -> Value {
    static RESULT: OnceLock<Value> = OnceLock::new();
    let result = RESULT.get_or_init(|| {
        let folder = Folder::new();
        folder.dacrt(&format!("{RUN} --out out.json")).exits(0);
        let mut result = folder.json("out.json");
        for cell in result["cells"].as_array_mut().unwrap() {
            quiet(&mut cell["samples_ms"]);
            let embree = cell["embree"]["samples_ms"].as_object_mut().unwrap();
            embree.values_mut().for_each(quiet);
        }
        result
    });
    result.clone()
}

fn quiet(samples: &mut Value) {
    let first = samples[0].as_f64().unwrap();
    let rounds = [1.0, 1.01, 0.99].iter().zip(samples.as_array().unwrap());
    *samples = rounds.map(|(x, _)| first * x).collect();
}

/// A folder with the result as `a.json`, and a changed one as `b.json`.
fn folder(change: impl FnOnce(&mut Value)) -> Folder {
    let folder = Folder::new();
    let mut document = result();
    folder.write("a.json", document.to_string());
    change(&mut document);
    folder.write("b.json", document.to_string());
    folder
}

fn nabata(document: &mut Value) -> &mut Value {
    let cells = document["cells"].as_array_mut().unwrap();
    let is_it = |c: &&mut Value| c["method"] == "nabata2013" && c["rays"] == "primary";
    cells.iter_mut().find(is_it).unwrap()
}

fn more_ray_box(document: &mut Value) {
    let ray_box = &mut nabata(document)["counters"]["ray_box"];
    *ray_box = (ray_box.as_u64().unwrap() + 1).into();
}

fn slower(document: &mut Value) {
    let samples = nabata(document)["samples_ms"].as_array_mut().unwrap();
    let times = |ms: &mut Value| *ms = (1.3 * ms.as_f64().unwrap()).into();
    samples.iter_mut().for_each(times);
}

#[track_caller]
fn shows(run: &Run, words: &[&str]) {
    let text = run.stdout();
    for word in words {
        assert!(text.contains(word), "{}: no {word:?} in\n{text}", run.line);
    }
}

#[test]
fn a_result_is_like_itself() {
    let folder = folder(|_| {});
    let run = folder.dacrt("compare a.json a.json");
    shows(run.exits(0), &["\n14 cells: 14 same\n"]);
    assert_eq!(run.stderr(), "");
    for format in ["markdown", "json", "junit", "bencher"] {
        let line = format!("compare a.json b.json --format {format}");
        folder.dacrt(&line).exits(0);
    }
}

#[test]
fn instruction_sets_give_the_same_hits_and_counters() {
    let folder = Folder::new();
    let sets: Vec<&str> = dacrt::Isa::available().map(dacrt::Isa::name).collect();
    for isa in &sets {
        let line = format!("{RUN} --isa {isa} --out {isa}.json");
        folder.dacrt(&line).exits(0);
    }
    if !sets.contains(&"avx2") {
        println!("notice: no avx2 here, nothing to compare portable code with");
    }
    for isa in sets.iter().filter(|isa| **isa != "portable") {
        let line = format!("compare {isa}.json portable.json --format json");
        let run = folder.dacrt(&line);
        let report: Value = serde_json::from_str(&run.exits(0).stdout()).unwrap();
        let why = report["times_not_judged"].as_str().unwrap();
        assert!(why.contains("machine.isa"), "{why}");
        for cell in report["cells"].as_array().unwrap() {
            assert_eq!(cell["findings"], json!([]), "{cell}");
        }
    }
}

#[test]
fn each_damage_is_found_in_its_cell() {
    type Damage = fn(&mut Value);
    let damages: [(Damage, &[&str]); 7] = [
        (more_ray_box, &["counters.ray_box", "REGRESSION", "+0."]),
        (slower, &["speed / afra2012", "x 0.769 [0.", "Embree trace"]),
        (
            |d| nabata(d)["hit_hash"] = "0123456789abcdef".into(),
            &["hit_hash", "-> 0123456789ab…"],
        ),
        (
            |d| nabata(d)["diff"]["embree_robust"]["tie"] = 99.into(),
            &["diff.embree_robust.tie", "-> 99"],
        ),
        (
            |d| nabata(d)["diff"]["not_judged"] = 1.into(),
            &["diff.not_judged", "0  -> 1"],
        ),
        (
            |d| nabata(d)["diff"]["embree_fast"]["ours_wrong"] = 1.into(),
            &["diff.embree_fast.ours_wrong"],
        ),
        (
            |d| nabata(d)["samples_ms"] = Value::Null,
            &["has_times", "true  -> false"],
        ),
    ];
    for (damage, words) in damages {
        let folder = folder(damage);
        let run = folder.dacrt("compare a.json b.json");
        shows(run.exits(1), words);
        let expected = format!("\nREGRESSIONS\n{NABATA}\n");
        shows(&run, &[&expected, "\n14 cells: 13 same, 1 regression\n"]);
        let text = run.stdout();
        assert!(
            text.lines().all(|line| line.chars().count() <= 100),
            "{text}"
        );
        assert_eq!(
            text.matches("14 cells").count() + text.matches(NABATA).count(),
            2
        );
    }
}

#[test]
fn a_slower_method_is_no_regression_where_times_are_shown() {
    let folder = folder(slower);
    let run = folder.dacrt("compare a.json b.json --times shown");
    shows(
        run.exits(0),
        &["Times are shown and not judged", "Changed\n", "x 0.769"],
    );
}

#[test]
fn tolerances_are_typed_as_lists() {
    let folder = folder(more_ray_box);
    let with = |list: &str| folder.dacrt(&format!("compare a.json b.json --tolerance {list}"));
    with("ray_box=0.5").exits(0);
    with("nodes=0.1,all=1").exits(0);
    with("nodes=0.1").exits(1);
    with("rays_box=0.5").refuses(&["--tolerance", "\"rays_box\"", "did you mean \"ray_box\""]);
    with("ray_box").refuses(&["expected NAME=SHARE"]);
    with("ray_box=-1").refuses(&["expected a share of 0 or more"]);
    with("ray_box=nan").refuses(&["expected a share of 0 or more"]);
}

#[test]
fn every_format_says_what_is_worse() {
    let folder = folder(|d| {
        more_ray_box(d);
        slower(d);
    });
    let output = |format: &str, code| {
        let run = folder.dacrt(&format!("compare a.json b.json --format {format}"));
        run.exits(code).stdout()
    };
    let markdown = output("markdown", 1);
    let row = format!("| `{NABATA}` | `counters.ray_box` | ");
    for part in [
        "### dacrt compare: 1 regression in 14 cells\n",
        &row,
        "| `speed / afra2012` |",
        "<details><summary>What was compared</summary>",
    ] {
        assert!(markdown.contains(part), "{markdown}");
    }
    let report: Value = serde_json::from_str(&output("json", 1)).unwrap();
    assert_eq!(report["grade"], "regression");

    let junit = output("junit", 1);
    let junit = quick_junit::Report::deserialize_from_str(&junit).unwrap();
    let suite = &junit.test_suites[0];
    assert_eq!((suite.tests, suite.failures), (14, 1));
    let failed = |c: &&quick_junit::TestCase| {
        matches!(c.status, quick_junit::TestCaseStatus::NonSuccess { .. })
    };
    let case = suite.test_cases.iter().find(failed).unwrap();
    assert_eq!(case.name.as_str(), NABATA);

    let bencher: Value = serde_json::from_str(&output("bencher", 1)).unwrap();
    assert_eq!(bencher.as_object().unwrap().len(), 14);
    let cell = &bencher[NABATA];
    for name in [
        "acceleration_ratio",
        "embree_total_ratio",
        "embree_trace_ratio",
    ] {
        let [value, low, high] =
            ["value", "lower_value", "upper_value"].map(|key| cell[name][key].as_f64().unwrap());
        assert!(low < value && value < high, "{name}: {cell}");
    }
    let mut b = folder.json("b.json");
    assert_eq!(
        cell["ray_box"]["value"].as_f64(),
        nabata(&mut b)["counters"]["ray_box"].as_f64()
    );
    assert!(cell.get("median_ms").is_none());
}

#[test]
fn files_of_other_work_are_refused() {
    let refuses = |change: fn(&mut Value), words: &[&str]| {
        let folder = folder(change);
        let before = std::fs::read(folder.path("a.json")).unwrap();
        let mut words = words.to_vec();
        words.extend(["a.json", "b.json"]);
        folder.dacrt("compare a.json b.json").refuses(&words);
        // Nor are they accepted.
        let mut command = folder.command("compare a.json b.json --accept");
        let status = command.arg("a note").output().unwrap().status;
        assert_eq!(status.code(), Some(2));
        assert_eq!(std::fs::read(folder.path("a.json")).unwrap(), before);
    };
    refuses(
        |d| d["seed"] = 2.into(),
        &["seeds differ: 1", "2 in the second", "--seed"],
    );
    refuses(
        |d| nabata(d)["ray_hash"] = "other".into(),
        &["ray_hash", "in 1 cell", NABATA],
    );
    refuses(
        |d| drop(d["cells"].as_array_mut().unwrap().remove(1)),
        &["nabata2013"],
    );
    refuses(
        |d| {
            let cells = d["cells"].as_array_mut().unwrap();
            cells.push(cells[1].clone());
        },
        &["second file", "twice", NABATA],
    );
    refuses(
        |d| nabata(d)["counters"]["ray_box"] = "many".into(),
        &["second file is damaged", NABATA, "ray_box", "\"many\""],
    );
}

#[test]
fn a_subset_is_asked_for() {
    let folder = folder(|d| drop(d["cells"].as_array_mut().unwrap().drain(1..4)));
    folder.dacrt("compare a.json b.json").refuses(&[
        "3 cells only in the first file, the first: tiny/primary/24x24/1/nabata2013",
        "--subset",
    ]);
    let run = folder.dacrt("compare a.json b.json --subset");
    shows(
        run.exits(0),
        &[
            "\nOnly in the reference\ntiny/",
            "11 cells: 11 same, 3 more only in the reference",
        ],
    );
    let run = folder.dacrt("compare b.json a.json --subset --format junit");
    shows(run.exits(0), &["skipped=\"3\"", "only in the new file"]);
    let mut empty = result();
    empty["cells"] = json!([]);
    folder.write("empty.json", empty.to_string());
    let none = folder.dacrt("compare a.json empty.json --subset");
    none.refuses(&["a.json and empty.json: they have no cell in common"]);
}

#[test]
fn what_is_no_result_is_refused_with_its_place() {
    let folder = folder(|_| {});
    let text = serde_json::to_string_pretty(&result()).unwrap();
    folder.write("half.json", &text[..text.len() / 2]);
    folder.write("foreign.json", "{\n\"schema\": 1,\n\"benchmarks\": []\n}");
    folder.write(
        "newer.json",
        text.replace("\"schema\": 1,", "\"schema\": 2,"),
    );
    folder.write("text.json", "ray tracing");
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), Default::default());
    std::io::Write::write_all(&mut gzip, text.as_bytes()).unwrap();
    let gzip = gzip.finish().unwrap();
    folder.write("half.json.gz", &gzip[..gzip.len() / 2]);
    let files: [(&str, &[&str]); 6] = [
        ("half.json", &["is not a result file", " at line "]),
        ("half.json.gz", &["damaged", "bytes of text", "anew"]),
        (
            "foreign.json",
            &["missing field `machine` at line 4", "dacrt run"],
        ),
        (
            "newer.json",
            &["has schema 2, this program reads schema 1", "use the dacrt"],
        ),
        ("text.json", &["expected value at line 1 column 1"]),
        ("none.json", &["cannot be read: No such file"]),
    ];
    for (file, words) in files {
        for line in [
            format!("compare a.json {file}"),
            format!("compare {file} b.json"),
        ] {
            folder.dacrt(&line).refuses(&[&[file], words].concat());
        }
    }
}

/// `dacrt` with one more argument, which may have spaces in it.
fn accept(folder: &Folder, line: &str, note: &str) -> Run {
    Run {
        line: format!("{line} --accept '{note}'"),
        output: (folder.command(line).arg("--accept").arg(note))
            .output()
            .unwrap(),
    }
}

#[test]
fn an_accepted_change_is_the_new_reference() {
    let folder = folder(|d| {
        more_ray_box(d);
        d["software"]["commit"] = "the second".into();
    });
    folder.dacrt("compare a.json b.json").exits(1);
    let from = folder.json("a.json")["software"]["commit"].clone();
    let run = accept(&folder, "compare a.json b.json", " bins from centres ");
    shows(run.exits(0), &["14 cells: 13 same, 1 regression"]);
    let words = "accepted: a.json now has the results of b.json (1 change): bins from centres";
    assert_eq!(run.stderr().trim_end(), words);
    folder.dacrt("compare a.json b.json").exits(0);

    let mut expected = folder.json("b.json");
    let finding = folder.json("a.json")["accepted"][0]["findings"][0].clone();
    let finding = finding.as_str().unwrap();
    assert!(
        finding.starts_with(&format!("{NABATA}: counters.ray_box ")),
        "{finding}"
    );
    expected["accepted"] = json!([{
        "note": "bins from centres", "from_commit": from, "to_commit": "the second",
        "findings": [finding],
    }]);
    assert_eq!(folder.json("a.json"), expected);

    // The history stays; a new cell is no obstacle; the report is for programs.
    let mut wider = folder.json("b.json");
    let mut cell = wider["cells"][0].clone();
    cell["rays"] = "random".into();
    wider["cells"].as_array_mut().unwrap().push(cell);
    folder.write("c.json", wider.to_string());
    let run = accept(
        &folder,
        "compare a.json c.json --format json",
        "random rays",
    );
    serde_json::from_str::<Value>(&run.exits(0).stdout()).unwrap();
    let accepted = folder.json("a.json")["accepted"].clone();
    assert_eq!(accepted.as_array().unwrap().len(), 2);
    assert_eq!(
        accepted[1]["findings"],
        json!(["tiny/random/24x24/1/afra2012: new"])
    );
}

#[test]
fn a_gzipped_reference_stays_gzipped() {
    let folder = folder(more_ray_box);
    let text = std::fs::read(folder.path("a.json")).unwrap();
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), Default::default());
    std::io::Write::write_all(&mut gzip, &text).unwrap();
    folder.write("a.json.gz", gzip.finish().unwrap());
    accept(&folder, "compare a.json.gz b.json", "why not").exits(0);
    let bytes = std::fs::read(folder.path("a.json.gz")).unwrap();
    assert!(bytes.starts_with(&[0x1f, 0x8b]));
    folder.dacrt("compare a.json.gz b.json").exits(0);
}

#[test]
fn not_everything_can_be_accepted() {
    let folder = folder(|d| drop(d["cells"].as_array_mut().unwrap().remove(1)));
    let before = std::fs::read(folder.path("a.json")).unwrap();
    let line = "compare a.json b.json --subset";
    let missing = accept(&folder, line, "fewer cells");
    missing.refuses(&["--accept: b.json lacks 1 cell of a.json", NABATA]);
    for note in ["", "  "] {
        accept(&folder, "compare b.json b.json", note).refuses(&["--accept", "note"]);
    }
    assert_eq!(std::fs::read(folder.path("a.json")).unwrap(), before);
}

#[test]
fn a_run_writes_gzip_by_name() {
    let folder = Folder::new();
    let run =
        "run --scenes ./tiny.json --rays primary --resolution 8 --repeats 1 --out out.json.gz";
    folder.dacrt(run).exits(0);
    let bytes = std::fs::read(folder.path("out.json.gz")).unwrap();
    assert!(bytes.starts_with(&[0x1f, 0x8b]));
    folder.dacrt(&format!("{run} --resume")).exits(0);
    folder.dacrt("compare out.json.gz out.json.gz").exits(0);
}
