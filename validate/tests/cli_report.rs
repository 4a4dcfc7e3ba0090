//! `dacrt report`: what is on the page, and what it says of files that it cannot use.

mod command;

use command::Folder;
use serde_json::{Value, json};

/// A result file with two sizes, two bounces and a few methods.
fn measured(folder: &Folder) {
    let run = "run --scenes ./tiny.json --rays primary,diffuse-1,diffuse-2 --resolution 8,16 --repeats 2 \
               --methods afra2012,nabata2013,best --precision fast,watertight --out run.json";
    folder.dacrt(run).exits(0);
}

fn page(folder: &Folder, files: &str) -> String {
    folder
        .dacrt(&format!("report {files} --out page.html"))
        .exits(0);
    std::fs::read_to_string(folder.path("page.html")).unwrap()
}

/// The ids of the sections in their order.
fn sections(page: &str) -> Vec<&str> {
    let parts = page.split("<section id=\"").skip(1);
    parts.map(|part| part.split('"').next().unwrap()).collect()
}

#[test]
fn a_page_needs_nothing_else_and_is_the_same_twice() {
    let folder = Folder::new();
    measured(&folder);
    let first = page(&folder, "run.json");
    let expected = [
        "summary",
        "errors",
        "resolution",
        "bounce",
        "embree",
        "cells",
        "files",
    ];
    assert_eq!(sections(&first), expected);
    for outside in [
        "src=\"http",
        "href=\"http",
        "url(http",
        "@import",
        "<iframe",
        "fetch(",
    ] {
        assert!(!first.contains(outside), "{outside}");
    }
    for link in first.split("href=\"").skip(1) {
        assert!(
            link.starts_with('#') || link.starts_with("data:"),
            "{}",
            &link[..40]
        );
    }
    assert!(
        first.contains("No wrong hit in 36 cells"),
        "{}",
        &first[..4000]
    );
    assert!(first.contains("dacrt run --scenes ./tiny.json"));
    assert_eq!(page(&folder, "run.json"), first);
}

#[test]
fn wrong_hits_come_first_then_lost_cells() {
    let folder = Folder::new();
    measured(&folder);
    let mut document = folder.json("run.json");
    for cell in document["cells"].as_array_mut().unwrap() {
        cell["ratio_embree_total"] = json!(0.5);
        cell["ratio_embree_total_interval"] = json!([0.4, 0.6]);
        cell["acceleration_interval"] = json!([0.9, 1.1]);
    }
    document["cells"][0]["diff"]["exact"]["ours_wrong"] = json!(3);
    folder.write("run.json", document.to_string());
    let page = page(&folder, "run.json");
    let place = |words: &str| page.find(words).unwrap_or_else(|| panic!("no {words:?}"));
    assert!(place("Wrong hits in 1 cell") < place("Lost: our fastest against Embree"));
    assert!(!page.contains("Lost: nabata2013"));
    // Of each batch and precision one.
    assert!(
        page.contains("12 cells with the whole 95 % interval"),
        "{}",
        &page[..6000]
    );
}

#[test]
fn sweeps_are_curves_or_heat_maps() {
    let folder = Folder::new();
    let sweep = |parameters: &str| {
        format!(
            r#"{{ "scenes": ["./tiny.json"], "resolution": [16], "rays": ["primary"],
                 "methods": ["nabata2013"], "parameters": {{ {parameters} }} }}"#
        )
    };
    folder.write("one.json", sweep(r#""bins": [8, 16, 32]"#));
    folder.write(
        "two.json",
        sweep(r#""bins": [8, 32], "samples": [10, 50, 100]"#),
    );
    for name in ["one", "two"] {
        folder
            .dacrt(&format!(
                "sweep {name}.json --repeats 1 --out {name}-out.json"
            ))
            .exits(0);
    }
    let one = page(&folder, "one-out.json");
    assert!(sections(&one).contains(&"sweeps") && one.contains("time over the best"));
    let two = page(&folder, "two-out.json");
    // A field for each of 2 x 3 pairs.
    assert!(two.contains("1.00") && !two.contains("time over the best"));
    assert!(two.contains("samples=50"), "the table has what varies");
    let both = page(&folder, "one-out.json two-out.json");
    assert!(both.matches("<summary>one-out.json</summary>").count() >= 2);
}

/// A file of so many cells, made of one by giving it other names.
fn many(folder: &Folder, count: usize) {
    let mut document = folder.json("run.json");
    let cells = document["cells"].as_array().unwrap().clone();
    let cell = |i: usize| {
        let mut cell = cells[i % cells.len()].clone();
        cell["scene"] = format!("scene-{}", i / cells.len()).into();
        cell
    };
    document["cells"] = (0..count).map(cell).collect();
    folder.write("many.json", document.to_string());
}

#[test]
fn two_thousand_cells_are_below_ten_mebibytes() {
    let folder = Folder::new();
    measured(&folder);
    many(&folder, 2000);
    let page = page(&folder, "many.json");
    assert!(page.len() < 10 << 20, "{}", page.len());
    let data = page.split("type=\"application/json\">").nth(1).unwrap();
    let data: Value = serde_json::from_str(data.split("</script>").next().unwrap()).unwrap();
    let (columns, rows) = (
        data["columns"].as_array().unwrap(),
        data["rows"].as_array().unwrap(),
    );
    assert_eq!(rows.len(), 2000);
    assert!(
        rows.iter()
            .all(|row| row.as_array().unwrap().len() == columns.len())
    );
}

#[test]
fn names_cannot_end_the_data_of_the_table() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes ./tiny.json --resolution 8 --repeats 1 --out run.json")
        .exits(0);
    let mut document = folder.json("run.json");
    document["cells"][0]["scene"] = "</script><b>bold</b>".into();
    folder.write("run.json", document.to_string());
    let page = page(&folder, "run.json");
    assert!(!page.contains("<b>bold"));
    assert!(page.contains("\\u003c/script>"));
}

#[test]
fn files_of_other_commands_stand_beside_results() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes ./tiny.json --resolution 8 --repeats 1 --out run.json")
        .exits(0);
    folder
        .dacrt("hard --families edges --rays 64 --out hard.json")
        .exits(0);
    let run = folder.json("run.json");
    let claims = json!({
        "kind": "claims", "machines": [{ "machine": run["machine"], "seeds": [1, 2] }], "software": run["software"], "command": ["dacrt", "claims"],
        "findings": [finding("C2", "supported"), finding("C1", "contradicted")],
    });
    folder.write("claims.json", claims.to_string());
    let point = |rays: usize| {
        json!({ "triangles": 500, "rays": rays, "ms": 1.5, "build_ms": null,
        "trace_ms": null, "bytes": 1, "exponent": null, "over_n_log_n": null })
    };
    let growth = json!({
        "kind": "growth", "machine": run["machine"], "software": run["software"], "command": ["dacrt", "bench"],
        "memory_limit_bytes": 1, "seconds_limit": 1.0, "left_out": [], "cells": [],
        "curves": [{ "grows": "rays", "rays": "primary", "contestant": "best", "points": [point(10), point(100)] }],
    });
    folder.write("growth.json", growth.to_string());
    let page = page(&folder, "run.json hard.json claims.json growth.json");
    let found = sections(&page);
    for section in ["growth", "claims", "hard", "cells", "files"] {
        assert!(found.contains(&section), "{section}: {found:?}");
    }
    let place = |words: &str| page.find(words).unwrap_or_else(|| panic!("no {words:?}"));
    assert!(place("<b>C1</b>") < place("<b>C2</b>"));
    assert!(page.contains("1 contradicted, 1 supported"));
    assert!(page.contains("seeds 1, 2: "));
}

fn finding(id: &str, verdict: &str) -> Value {
    json!({
        "id": id, "paper": "nabata2013", "place": "section 5", "claim": "it is fast", "measure": "the ratio",
        "falsified_if": "it is slow", "limits": {}, "studies": [], "verdict": verdict,
        "effect": { "name": "ratio", "value": 1.5, "interval": [1.25, 1.75] },
        "parts": [{ "name": "sibenik", "value": 2.0, "interval": null }],
        "cameras": 1, "seeds": 1, "repeats": 5, "batches": 3, "why": "",
    })
}

#[test]
fn pictures_stand_in_the_page_where_they_are_asked_for() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes ./tiny.json --resolution 8 --repeats 1 --out run.json")
        .exits(0);
    let with = page(
        &folder,
        "run.json --pictures ./tiny.json --picture-resolution 16x8",
    );
    assert_eq!(with.matches("src=\"data:image/png;base64,").count(), 3);
    assert!(
        with.contains("tiny: against Embree") && with.contains("same 128"),
        "{}",
        &with[..4000]
    );
    let without = page(&folder, "run.json");
    assert!(!sections(&without).contains(&"pictures") && !without.contains("data:image"));
}

#[test]
fn files_that_cannot_be_used_are_named() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes ./tiny.json --resolution 8 --repeats 1 --out run.json")
        .exits(0);
    folder.write("throughput.json", r#"{ "kind": "throughput" }"#);
    folder.write("sweep.json", r#"{ "scenes": [] }"#);
    folder.write("empty.json", "{}");
    folder.write("text.json", "none");
    folder.write("later.json", r#"{ "schema": 9 }"#);
    folder.write("hard.json", r#"{ "kind": "hard" }"#);
    let refuses = |line: &str, words: &[&str]| {
        folder.dacrt(&format!("report {line}")).refuses(words);
    };
    refuses("none.json", &["none.json", "cannot be read"]);
    refuses(
        "run.json throughput.json",
        &["throughput.json", "bench throughput"],
    );
    refuses("sweep.json", &["sweep.json", "sweep"]);
    refuses("tiny.json", &["tiny.json", "scene"]);
    refuses("empty.json", &["empty.json", "neither schema nor kind"]);
    refuses("text.json", &["text.json", "not a result file"]);
    refuses("later.json", &["later.json", "schema 9"]);
    refuses("hard.json", &["hard.json", "damaged", "machine"]);
    refuses("run.json run.json", &["run.json", "twice"]);
    refuses("run.json --out no/page.html", &["--out", "no/page.html"]);
    refuses("run.json --pictures tinny", &["\"tinny\""]);
    assert!(!folder.path("dacrt-report.html").exists());
}
