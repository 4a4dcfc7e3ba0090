//! The JSON Schemas: the committed ones are those of the types, every committed file keeps to them,
//! and damaged files do not.

mod command;

use command::Folder;
use dacrt::scene::Description;
use dacrt_validate::diff::{Number, Offender};
use dacrt_validate::judge::{Answer, Verdict, Wrong};
use dacrt_validate::schema::KINDS;
use flate2::read::MultiGzDecoder;
use serde_json::{Value, json};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Whether a document keeps to the schema of this name; if not, where and why.
fn check(name: &str, document: &Value) -> Result<(), String> {
    let kind = KINDS.iter().find(|kind| kind.name == name).unwrap();
    let validator = jsonschema::validator_for((kind.schema)().as_value()).unwrap();
    let error = validator.iter_errors(document).next();
    error.map_or(Ok(()), |e| Err(format!("{}: {e}", e.instance_path())))
}

/// The files of a folder whose names end so, with their content.
fn documents(folder: &str, ends: &[&str]) -> Vec<(PathBuf, Value)> {
    let entries = fs::read_dir(repository().join(folder)).unwrap();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| {
        let name = file.file_name().unwrap().to_str().unwrap();
        let is_other = |word| name.contains(word);
        ends.iter().any(|end| name.ends_with(end))
            && !["schema", "claims", "sweep", "growth", "throughput"]
                .into_iter()
                .any(is_other)
    });
    files.sort();
    let read = |file: &PathBuf| {
        let mut bytes = fs::read(file).unwrap();
        if bytes.starts_with(&[0x1f, 0x8b]) {
            let mut plain = Vec::new();
            let mut decoder = MultiGzDecoder::new(&bytes[..]);
            decoder.read_to_end(&mut plain).unwrap();
            bytes = plain;
        }
        serde_json::from_slice(&bytes).unwrap()
    };
    files.iter().map(|f| (f.clone(), read(f))).collect()
}

fn results() -> Vec<(PathBuf, Value)> {
    documents("results", &[".json", ".json.gz"])
}

/// The document without the key, or with another value for it.
fn changed(document: &Value, place: &str, value: Option<Value>) -> Value {
    let mut document = document.clone();
    let (parent, key) = place.rsplit_once('/').unwrap();
    let parent = document.pointer_mut(parent).unwrap();
    match (parent, value) {
        (Value::Object(keys), Some(value)) => drop(keys.insert(key.to_owned(), value)),
        (Value::Object(keys), None) => assert!(keys.remove(key).is_some(), "no {place}"),
        (Value::Array(items), Some(value)) => items[key.parse::<usize>().unwrap()] = value,
        (other, _) => panic!("{place} is in {other}"),
    }
    document
}

#[test]
fn the_committed_schemas_are_those_of_the_types() {
    for kind in KINDS {
        let run = Folder::new().dacrt(&format!("schema {}", kind.name));
        let generated = run.exits(0).stdout();
        assert!(generated.ends_with("}\n"));
        let committed = fs::read_to_string(repository().join(kind.file)).unwrap_or_default();
        assert!(
            committed == generated,
            "{file} is out of date; this rewrites it: scripts/dacrt schema {name} > {file}",
            file = kind.file,
            name = kind.name
        );
        let schema: Value = serde_json::from_str(&generated).unwrap();
        jsonschema::meta::validate(&schema).unwrap();
    }
}

#[test]
fn a_schema_that_there_is_not_is_refused() {
    Folder::new()
        .dacrt("schema pictures")
        .refuses(&["pictures", "results", "scene"]);
}

#[test]
fn every_committed_result_keeps_to_the_schema() {
    let results = results();
    assert!(results.len() >= 10);
    for (file, document) in results {
        check("results", &document).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    }
}

#[test]
fn committed_files_of_benchmarks_can_be_read() {
    let mut read = 0;
    for entry in fs::read_dir(repository().join("results")).unwrap() {
        let file = entry.unwrap().path();
        let name = file.file_name().unwrap().to_str().unwrap();
        if name.ends_with("growth.json.gz") {
            dacrt_validate::growth::Document::read(&file).unwrap();
            read += 1;
        } else if name.ends_with("throughput.json") {
            let text = fs::read_to_string(&file).unwrap();
            serde_json::from_str::<dacrt_validate::throughput::Document>(&text).unwrap();
            read += 1;
        }
    }
    assert!(read >= 2);
}

#[test]
fn every_committed_scene_keeps_to_the_schema() {
    let scenes = documents("scenes", &[".json"]);
    assert!(scenes.len() >= 19);
    for (file, document) in scenes {
        check("scene", &document).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    }
}

#[test]
fn sweeps_keep_to_the_schema_and_damaged_ones_do_not() {
    let sweeps = documents("scripts/sweeps", &[".json"]);
    assert!(sweeps.len() >= 8);
    for (file, document) in &sweeps {
        check("sweep", document).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    }
    let is_bins = |(file, _): &&(PathBuf, Value)| file.ends_with("bins.json");
    let (_, good) = sweeps.iter().find(is_bins).unwrap();
    for (place, value) in [
        ("/scenes", json!([])),
        ("/resolution", json!(512)),
        ("/resolution/0", json!([512])),
        ("/resolution/0", json!(0)),
        ("/rays/0", json!("secondary")),
        ("/methods/0", json!("worst")),
        ("/parameters/bins", json!([])),
        ("/parameters/bins/0", json!("many")),
        ("/parameters/binz", json!([1])),
        ("/more", json!(1)),
    ] {
        let document = changed(good, place, Some(value));
        assert!(check("sweep", &document).is_err(), "{place}");
    }
    for place in ["/scenes", "/resolution", "/rays", "/methods"] {
        let document = changed(good, place, None);
        assert!(check("sweep", &document).is_err(), "without {place}");
    }
}

#[test]
fn damaged_results_do_not_keep_to_the_schema() {
    let (_, good) = results().swap_remove(0);
    let wrong = [
        ("/schema", json!(2)),
        ("/seed", json!(-1)),
        ("/command", json!("dacrt run")),
        ("/machine/load", json!([0.0, 0.0])),
        ("/software/embree/version", json!(4.4)),
        ("/cells/0/resolution", json!([512])),
        ("/cells/0/ray_hash", json!("0123abc")),
        ("/cells/0/any_hit", json!(0)),
        ("/cells/0/samples_ms/0", json!("12 ms")),
        ("/cells/0/counters/ray_box", json!(0.5)),
        ("/cells/0/counters/unheard_of", json!("many")),
        ("/cells/0/parameters/bins", json!("32")),
        ("/cells/0/parameters/axes", json!("shortest")),
        ("/cells/0/diff/embree_fast/same", json!(null)),
        ("/cells/0/embree/bytes", json!(-5)),
    ];
    for (place, value) in wrong {
        let document = changed(&good, place, Some(value));
        assert!(check("results", &document).is_err(), "{place}");
    }
    for place in [
        "/schema",
        "/cells",
        "/machine/cpu",
        "/software/commit",
        "/cells/0/scene",
        "/cells/0/ray_hash",
        "/cells/0/median_ms",
        "/cells/0/diff/differing",
        "/cells/0/embree/best_ms",
    ] {
        let document = changed(&good, place, None);
        assert!(check("results", &document).is_err(), "without {place}");
    }
}

#[test]
fn more_keys_are_welcome_in_results() {
    let (_, good) = results().swap_remove(0);
    for place in [
        "/more",
        "/machine/more",
        "/cells/0/more",
        "/cells/0/parameters/more",
    ] {
        check("results", &changed(&good, place, Some(json!("more")))).unwrap();
    }
    check(
        "results",
        &changed(&good, "/cells/0/counters/more", Some(json!(1))),
    )
    .unwrap();
}

/// Every kind of answer and verdict, and the floats that JSON has no number for.
#[test]
fn offending_rays_keep_to_the_schema() {
    let hit = |t| Answer::Hit { t, prim: 7 };
    let (bound, t) = (None, Some(1.5));
    let wrong = |wrong| Some([Verdict::Right, Verdict::WithinBounds, Verdict::Wrong(wrong)]);
    let cases = [
        ([hit(1.5), hit(f32::INFINITY), hit(f32::NAN)], None),
        (
            [Answer::Miss, Answer::Free, Answer::Occluded],
            wrong(Wrong::NotHit),
        ),
        ([Answer::Miss; 3], wrong(Wrong::Distance { t, bound })),
        ([Answer::Miss; 3], wrong(Wrong::Nearer { prim: 1, t: 0.5 })),
        ([Answer::Miss; 3], wrong(Wrong::NoSuchTriangle)),
        ([Answer::Miss; 3], wrong(Wrong::InvalidRay)),
        ([Answer::Free; 3], wrong(Wrong::NothingHit)),
        ([Answer::Free; 3], Some([Verdict::OutOfRange; 3])),
    ];
    let offending = cases.map(|([ours, embree_fast, embree_robust], verdicts)| Offender {
        index: 3,
        ray: [
            0.0,
            -1.5,
            f32::NAN,
            0.0,
            1e-9,
            0.0,
            f32::NEG_INFINITY,
            f32::INFINITY,
        ]
        .map(Number),
        ray_bits: [const { String::new() }; 8],
        ours,
        embree_fast,
        embree_robust,
        verdicts,
    });
    let place = "/cells/0/diff/offending";
    let (_, good) = results().swap_remove(0);
    let good = changed(&good, place, Some(json!(offending)));
    check("results", &good).unwrap();

    for (key, value) in [
        ("ray/0", json!("infinity")),
        ("ours", json!("hit")),
        ("ours/hit/prim", json!(-1)),
        ("embree_fast", json!({ "miss": {} })),
    ] {
        let document = changed(&good, &format!("{place}/0/{key}"), Some(value));
        assert!(check("results", &document).is_err(), "{key}");
    }
}

#[test]
fn schema_and_loader_of_scenes_agree() {
    let good = json!({
        "meshes": [
            { "file": "a.obj" },
            { "generator": "soup", "triangles": 500, "seed": 1 },
        ],
        "cameras": [{
            "name": "front", "eye": [0, 0, 4], "look_at": [0, 0.5, 0], "up": [0, 1, 0],
            "fov_degrees": 40,
        }],
        "lights": [{ "type": "point", "position": [0, 4, 0] }],
        "rays": ["primary", "shadow-point"],
    });
    let loads = |document: &Value| {
        Description::parse(Path::new("scene.json"), document.to_string().as_bytes()).is_ok()
    };
    let agree = |document: Value, expected: bool, what: &str| {
        let found = check("scene", &document);
        assert_eq!(found.is_ok(), expected, "schema, {what}: {found:?}");
        assert_eq!(loads(&document), expected, "loader, {what}");
    };
    agree(good.clone(), true, "as it is");

    for (place, value, expected) in [
        ("/about", json!("A scene"), true),
        ("/$schema", json!("./scene.schema.json"), true),
        ("/$schema", json!(1), false),
        ("/title", json!("A scene"), false),
        ("/meshes", json!([]), false),
        ("/meshes/0", json!({}), false),
        ("/meshes/0/file", json!(""), false),
        ("/meshes/0/file", json!(5), false),
        ("/meshes/0/seed", json!(5), false),
        ("/meshes/1/file", json!("a.obj"), false),
        ("/meshes/1/generator", json!("castle"), false),
        ("/meshes/1/generator", json!("hall"), true),
        ("/meshes/1/triangles", json!(0), false),
        ("/meshes/1/triangles", json!(4_294_967_294u32), true),
        ("/meshes/1/triangles", json!(4_294_967_295u32), false),
        ("/meshes/1/seed", json!(-1), false),
        ("/cameras", json!([]), false),
        ("/cameras/0/name", json!(""), false),
        ("/cameras/0/eye", json!([0, 0]), false),
        ("/cameras/0/eye", json!([0, 0, "4"]), false),
        ("/cameras/0/eye", json!([1.8e18, 0, 4]), true),
        ("/cameras/0/eye", json!([-1.85e18, 0, 4]), false),
        ("/cameras/0/look_at", json!([0, 1.85e18, 0]), false),
        ("/cameras/0/up", json!([0, 0, 0, 1]), false),
        ("/cameras/0/fov_degrees", json!(0), false),
        ("/cameras/0/fov_degrees", json!(179.9), true),
        ("/cameras/0/fov_degrees", json!(180), false),
        ("/cameras/0/roll", json!(0), false),
        ("/lights", json!([]), true),
        ("/lights/0/type", json!("area"), false),
        ("/lights/0/position", json!([0, 2e18, 0]), false),
        ("/lights/0/power", json!(1), false),
        ("/rays", json!([]), false),
        ("/rays/0", json!("diffuse-9"), false),
        ("/rays/0", json!("diffuse-8"), true),
    ] {
        let what = format!("{place}: {value}");
        agree(changed(&good, place, Some(value)), expected, &what);
    }
    for (place, expected) in [
        ("/meshes", false),
        ("/meshes/1/triangles", false),
        ("/cameras", false),
        ("/cameras/0/up", false),
        ("/lights", true),
        ("/lights/0/position", false),
        ("/rays", false),
    ] {
        agree(
            changed(&good, place, None),
            expected,
            &format!("without {place}"),
        );
    }
}

/// A list of the scenes has no `scene.schema` in it, and there is no scene of this name.
#[test]
fn the_schema_of_scenes_is_no_scene() {
    let folder = Folder::new();
    let list = folder.dacrt("scenes").exits(0).stdout();
    assert!(!list.contains("\nscene.schema"), "{list}");
    let run = folder.dacrt("run --scenes scene.schema --resolution 4");
    run.refuses(&["no scene", "scene.schema"]);
}
