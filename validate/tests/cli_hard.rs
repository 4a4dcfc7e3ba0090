//! `dacrt hard` from outside.

mod command;

use command::Folder;
use dacrt_validate::hard::{Document, FAMILIES, What};
use dacrt_validate::schema::KINDS;

/// All families, small: no finding.
#[test]
fn there_are_no_findings() {
    let folder = Folder::new();
    let text = folder.dacrt("hard --rays 1024").exits(0).stdout();
    assert!(text.contains("no findings"), "{text}");
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let json = folder.json("dacrt-hard.json");
    let kind = KINDS.iter().find(|kind| kind.name == "hard").unwrap();
    let schema = jsonschema::validator_for((kind.schema)().as_value()).unwrap();
    assert!(schema.is_valid(&json));
    let document: Document = serde_json::from_value(json).unwrap();
    assert_eq!(document.kind, "hard");
    assert_eq!(document.command, ["dacrt", "hard", "--rays", "1024"]);
    let names: Vec<&str> = document.families.iter().map(|f| &*f.name).collect();
    assert_eq!(names, FAMILIES.map(|f| f.name));
    for family in &document.families {
        assert_eq!(family.contestants.len(), 7, "{}", family.name);
        assert!(text.lines().any(|line| line.starts_with(&family.name)));
        let exact = family.contestants["exact"];
        assert_eq!(
            (exact.errors(), exact.methods_differ, exact.unexpected),
            (0, 0, 0)
        );
        assert!(!family.findings.iter().any(|f| f.what == What::Arbiter));
    }
    // The cases are hard: Embree's default mode loses rays at edges.
    let edges = &document.families[0].contestants["embree_fast"];
    assert!(edges.lost > 0);
}

#[test]
fn families_may_be_named() {
    let folder = Folder::new();
    let line = "hard --families no-area,interval --rays 128 --seed 7 --out some.json";
    folder.dacrt(line).exits(0);
    let document = folder.json("some.json");
    let names = ["no-area", "interval"].map(|name| name.to_owned());
    for (i, name) in names.iter().enumerate() {
        assert_eq!(document["families"][i]["name"], **name);
    }
    assert_eq!(document["families"].as_array().unwrap().len(), 2);
    assert_eq!(document["seed"], 7);
    #[cfg(target_arch = "x86_64")]
    {
        let plain = document["machine"]["mxcsr"].as_u64().unwrap();
        assert_eq!(document["mxcsr_ftz"], plain | 1 << 15 | 1 << 6);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    for (line, words) in [
        (
            "hard --families edge",
            &["--families", "edge", "edges", "needles"][..],
        ),
        ("hard --rays 0", &["--rays", "64"]),
        ("hard --out no/such.json", &["--out", "no folder"]),
    ] {
        folder.dacrt(line).refuses(words);
    }
}
