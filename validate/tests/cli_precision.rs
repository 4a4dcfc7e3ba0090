//! Precisions on the command line: cells, baselines, Embree's modes, the table and the plot of errors.

mod command;

use command::{Folder, Run};
use serde_json::Value;

/// The engine may be found wrong: that is for other tests.
fn good_or_finding(run: &Run) {
    let code = run.output.status.code();
    assert!(
        matches!(code, Some(0 | 1)),
        "{}\n{}",
        run.line,
        run.stderr()
    );
}

const RUN: &str = "run --scenes ./tiny.json --resolution 24 --rays primary,shadow-point --repeats 2 \
                   --methods afra2012,nabata2013 --precision fast,watertight,exact --exact-all 500 \
                   --out run.json";

fn cells(document: &Value) -> &[Value] {
    document["cells"].as_array().unwrap()
}

#[test]
fn each_precision_makes_cells_with_a_baseline_and_a_mode_of_its_own() {
    let folder = Folder::new();
    good_or_finding(&folder.dacrt(RUN));
    let document = folder.json("run.json");
    assert_eq!(cells(&document).len(), 2 * 2 * 3);
    for cell in cells(&document) {
        let precision = cell["precision"].as_str().unwrap();
        let errors = &cell["diff"]["errors"];
        let all = cell["ray_count"].as_u64().unwrap();
        assert_eq!(errors["rays"], all.min(500), "{precision}");
        assert!(errors["embree_robust"]["lost"].is_u64());
        if cell["median_ms"].is_null() {
            continue;
        }
        let (mode, over_fast) = match precision {
            "fast" => ("fast", false),
            _ => ("robust", true),
        };
        assert_eq!(cell["embree"]["mode"], mode);
        assert_eq!(cell["time_over_fast"].is_f64(), over_fast, "{precision}");
        let queries = cell["embree"]["trace_prepacked_ms"].as_object().unwrap();
        assert_eq!(queries.len(), 3, "{precision}");
        assert!(cell["ratio_embree_total"].is_f64());
        if cell["method"] == "afra2012" {
            assert_eq!(cell["acceleration_ratio"], 1.0, "{precision}");
        }
    }
    // The same again is all there.
    good_or_finding(&folder.dacrt(&format!("{RUN} --resume")));
    assert_eq!(folder.json("run.json"), document);

    let table = folder.dacrt("table run.json --errors");
    let text = table.exits(0).stdout();
    for word in [
        "tiny primary 24x24: 500 of 576 rays judged",
        "nabata2013 watertight",
        "Embree robust",
        "within  beyond",
        "99.9 % ulps",
    ] {
        assert!(text.contains(word), "no {word} in\n{text}");
    }
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    let text = folder
        .dacrt("table run.json --over precision")
        .exits(0)
        .stdout();
    assert!(text.contains("as fast as with precision=fast"), "{text}");
    let text = folder.dacrt("table run.json").exits(0).stdout();
    assert!(text.contains("precision=watertight"), "{text}");

    let plot = folder.dacrt("plot errors run.json --out errors.svg");
    assert!(
        plot.exits(0)
            .stdout()
            .starts_with("errors.svg: 2 batches, ")
    );
    let svg = std::fs::read_to_string(folder.path("errors.svg")).unwrap();
    for word in [
        "<svg",
        "shadow-point",
        "errors per million rays",
        "tiny",
        "Embree, robust",
    ] {
        assert!(svg.contains(word), "{word}");
    }
}

/// Embree's robust mode is timed only where it is needed.
#[test]
fn only_the_modes_that_are_set_against_are_timed() {
    let folder = Folder::new();
    let run =
        "run --scenes ./tiny.json --resolution 8 --rays primary --repeats 1 --methods nabata2013";
    folder.dacrt(&format!("{run} --out fast.json")).exits(0);
    let document = folder.json("fast.json");
    let cell = &cells(&document)[0];
    assert_eq!(
        (&cell["precision"], &cell["embree"]["mode"]),
        (&"fast".into(), &"fast".into())
    );
    assert_eq!(cell["time_over_fast"], Value::Null);
    let run = folder.dacrt(&format!(
        "{run} --precision watertight --out watertight.json"
    ));
    good_or_finding(&run);
    let document = folder.json("watertight.json");
    let cell = &cells(&document)[0];
    assert_eq!(cell["precision"], "watertight");
    assert!(cell["median_ms"].is_null() || cell["embree"]["mode"] == "robust");
    // Nothing to be set against.
    assert_eq!(cell["time_over_fast"], Value::Null);
}

#[test]
fn a_sweep_has_precisions_too() {
    let folder = Folder::new();
    let sweep = r#"{ "scenes": ["./tiny.json"], "resolution": [8], "rays": ["primary"],
                     "methods": ["nabata2013"], "precision": ["fast", "watertight"] }"#;
    folder.write("s.json", sweep);
    good_or_finding(&folder.dacrt("sweep s.json --repeats 1"));
    let document = folder.json("dacrt-s.json");
    assert_eq!(cells(&document).len(), 2);
    good_or_finding(&folder.dacrt("sweep s.json --repeats 1 --precision exact --out exact.json"));
    let document = folder.json("exact.json");
    assert_eq!(
        document["sweep"]["file"]["precision"],
        serde_json::json!(["exact"])
    );
    assert_eq!(cells(&document)[0]["precision"], "exact");
    folder.write("bad.json", sweep.replace("watertight", "waterproof"));
    (folder.dacrt("sweep bad.json")).refuses(&["bad.json", "\"waterproof\"", "watertight"]);
    folder.write(
        "none.json",
        sweep.replace(r#"["fast", "watertight"]"#, "[]"),
    );
    folder
        .dacrt("sweep none.json")
        .refuses(&["none.json", "precision", "at least one"]);
}

#[test]
fn a_ray_is_traced_and_a_picture_made_in_any_precision() {
    let folder = Folder::new();
    folder.write("m.obj", command::TRIANGLE);
    folder.write_rays("r.npy");
    let trace = "trace --mesh m.obj --rays r.npy --method nabata2013 --out h.npz --precision";
    for precision in ["fast", "watertight", "exact"] {
        let text = folder
            .dacrt(&format!("{trace} {precision}"))
            .exits(0)
            .stdout();
        assert!(text.starts_with("2 rays, 1 hit"), "{precision}: {text}");
    }
    folder
        .dacrt(&format!("{trace} exact,fast"))
        .refuses(&["no precision \"exact,fast\""]);
    let render = "render ./tiny.json --resolution 8 --spp 1 --precision exact --out p.png";
    folder.dacrt(render).exits(0);
}

#[test]
fn what_has_no_errors_to_show_is_refused() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json --resolution 8 --rays primary --repeats 1 --methods nabata2013 \
               --exact-all 0 --out none.json";
    folder.dacrt(run).exits(0);
    folder
        .dacrt("table none.json --errors")
        .refuses(&["none.json", "--errors", "not counted"]);
    (folder.dacrt("plot errors none.json --out p.svg")).refuses(&["none.json", "not counted"]);
    folder
        .dacrt("plot errors none.json --out no/p.svg")
        .refuses(&["--out", "no folder no"]);
    folder
        .dacrt("plot error none.json --out p.svg")
        .refuses(&["'error'", "errors"]);
    folder
        .dacrt("table none.json --errors --csv")
        .refuses(&["--errors", "--csv"]);
}
