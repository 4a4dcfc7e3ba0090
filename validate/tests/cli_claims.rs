//! `dacrt claims`: what is measured piece by piece, and what is said of it.

mod command;

use command::Folder;
use serde_json::Value;

const MEASURE: &str =
    "claims --only C13,C16,C17,C23 --cameras 0 --seeds 1 --repeats 2 --meshes . --out claims";

fn findings(text: &Value) -> &Vec<Value> {
    text["findings"].as_array().unwrap()
}

#[test]
fn claims_are_judged_by_what_is_there() {
    let folder = Folder::new();
    folder.write_nave();
    let run = folder.dacrt(MEASURE);
    let text = run.exits(0).stdout();
    assert!(run.stderr().contains("left out: scene conference:"));
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    // Rays sent one by one have the tests of the trace: a count, not a time.
    let supported = text.split("SUPPORTED").last().unwrap();
    assert!(supported.contains("C16"), "{text}");
    assert!(supported.contains("traces with other tests: 0"), "{text}");
    for words in [
        "C13",
        "C17",
        "C23",
        "falsified if",
        "plane test over without",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }

    assert!(text.contains("(seed 1)"), "{text}");

    // Nothing is measured twice, and a part of the claims leaves no verdicts of all.
    let cells = folder.path("claims/cells-1.json.gz");
    let before = std::fs::read(&cells).unwrap();
    assert_eq!(folder.dacrt(MEASURE).exits(0).stdout(), text);
    assert_eq!(std::fs::read(&cells).unwrap(), before);
    assert!(!folder.path("claims/claims.json").exists());

    let all = folder.dacrt("claims --from claims").exits(0).stdout();
    assert!(
        all.contains("not testable") && all.contains("verdicts: claims/claims.json"),
        "{all}"
    );
    let verdicts = folder.json("claims/claims.json");
    let findings = findings(&verdicts);
    assert_eq!(findings.len(), 21);
    let of = |id: &str| findings.iter().find(|f| f["id"] == id).unwrap();
    assert_eq!(of("C16")["verdict"], "supported");
    assert_eq!(of("C16")["effect"]["value"], 0.0);
    assert_eq!(of("C1")["verdict"], "not testable");
    assert!(of("C1")["why"].as_str().unwrap().contains("small"));
    let plane = of("C17");
    assert_eq!((&plane["seeds"], &plane["repeats"]), (&1.into(), &2.into()));
    // What speaks against the papers comes first.
    let rank = |finding: &Value| {
        let order = ["contradicted", "undecided", "not testable", "supported"];
        order
            .iter()
            .position(|name| finding["verdict"] == *name)
            .unwrap()
    };
    assert!(findings.is_sorted_by_key(rank), "{verdicts}");
}

#[test]
fn nodes_are_evidence_too() {
    let folder = Folder::new();
    folder.write_nave();
    let run = "claims --only C6 --quick --repeats 1 --meshes . --out claims";
    let text = folder.dacrt(run).exits(0).stdout();
    assert!(text.contains("distance, diffuse-8"), "{text}");
    let nodes = folder.json("claims/nodes.json");
    // Its own camera and one more, five kinds of rays.
    assert_eq!(nodes.as_array().unwrap().len(), 2 * 5, "{nodes}");
    for node in nodes.as_array().unwrap() {
        let distance = node["area_distance"].as_f64().unwrap();
        assert!((0.0..=1.0).contains(&distance), "{node}");
        assert!(node["area_regret"].as_f64().unwrap() >= 1.0, "{node}");
    }
}

#[test]
fn what_cannot_be_judged_is_refused() {
    let folder = Folder::new();
    let refuses = |line: &str, words: &[&str]| {
        folder.dacrt(line).refuses(words);
    };
    refuses("claims --only C99", &["--only", "C99"]);
    refuses("claims --from nowhere", &["nowhere", "cells-1.json.gz"]);
    refuses("claims --seeds 0", &["--seeds", "from 1 to 100"]);
    refuses("claims --cameras 17", &["--cameras", "from 0 to 16"]);
    std::fs::create_dir(folder.path("claims")).unwrap();
    folder.write("claims/nodes.json", "[1]");
    refuses("claims --from claims", &["nodes.json"]);
}
