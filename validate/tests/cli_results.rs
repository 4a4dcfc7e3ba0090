//! The result file of a real run: the keys that bind, and what stands in them.

mod command;

use command::Folder;
use dacrt_validate::embree::{Device, Query};
use serde_json::{Value, json};

/// The shape of the document. A key may be null where its value here is; an array here stands for
/// arrays whose items are all like its only item; what is no object or array here is only the type.
/// More keys are welcome.
fn shape() -> Value {
    let counters = json!({
        "nodes": 0, "leaves": 0, "ray_box": 0, "group_box": 0, "cone_box": 0, "triangle_box": 0,
        "ray_triangle": 0, "binned_triangles": 0, "sample_box": 0, "sampled_nodes": 0,
        "sah_nodes": 0, "middle_nodes": 0, "skips_near": 0, "skips_far": 0,
        "skipped_rays_that_miss": 0, "terminated_rays": 0, "duplicates": 0, "peak_list": 0,
    });
    let diff = json!({
        "same": 0, "t_drift": 0, "tie": 0, "edge": 0, "ours_wrong": 0, "reference_wrong": 0,
        "both_wrong": 0, "max_relative_t_error": 0.0, "p999_relative_t_error": 0.0, "differing": 0,
    });
    let mut exact = diff.clone();
    exact["rays"] = 0.into();
    let qualities = |item: Value| json!({ "low": item, "medium": item, "high": item });
    let each = |item: Value| {
        let queries = Device::new(1).unwrap().queries().map(Query::name);
        let names = ["low", "medium", "high"].into_iter();
        let names = names.flat_map(|q| queries.map(|n| (format!("{q}_{n}"), item.clone())));
        Value::Object(names.collect())
    };
    let mut samples = each(json!([0.0]));
    samples
        .as_object_mut()
        .unwrap()
        .extend(qualities(json!([0.0])).as_object().unwrap().clone());
    json!({
        "schema": 1,
        "machine": { "cpu": "", "isa": "", "cores": 0, "memory_bytes": 0, "load": [0.0] },
        "software": {
            "commit": "", "dirty": false, "rustc": "",
            "embree": { "version": "", "isa": "", "library": "" },
        },
        "seed": 0,
        "threads": 0,
        "command": [""],
        "cells": [{
            "scene": "", "triangles": 0, "dropped_triangles": 0, "camera": "", "resolution": [0],
            "spp": 0, "rays": "", "ray_count": 0, "ray_hash": "", "any_hit": false, "method": "",
            "precision": "", "parameters": {},
            "samples_ms": [0.0], "median_ms": 0.0, "mrays_per_s": 0.0, "acceleration_ratio": 0.0,
            "acceleration_interval": [0.0], "counters": counters, "workspace_bytes": 0, "hits": 0,
            "hit_hash": "",
            "diff": {
                "embree_fast": diff, "embree_robust": diff, "exact": exact, "offending": [],
            },
            "shared_origin": false,
            "embree": {
                "best_ms": 0.0, "best_trace_ms": 0.0, "build_ms": qualities(json!(0.0)),
                "trace_ms": each(json!(0.0)), "samples_ms": samples, "trace_prepacked_ms": {},
                "bytes": 0,
            },
            "ratio_embree_total": 0.0, "ratio_embree_trace": 0.0,
        }],
    })
}

/// Checks `value` against a shape; `place` is for messages.
fn check(place: &str, value: &Value, shape: &Value) {
    match (shape, value) {
        (Value::Object(keys), Value::Object(_)) => {
            for (key, shape) in keys {
                let value = value
                    .get(key)
                    .unwrap_or_else(|| panic!("{place} has no key {key}"));
                check(&format!("{place}.{key}"), value, shape);
            }
        }
        (Value::Array(shape), Value::Array(items)) => {
            for (item, i) in items.iter().zip(0..) {
                let shape = shape
                    .first()
                    .unwrap_or_else(|| panic!("{place} is not empty"));
                check(&format!("{place}[{i}]"), item, shape);
            }
        }
        (Value::Number(shape), Value::Number(number)) => {
            assert!(shape.is_f64() || number.is_u64(), "{place} is {number}");
        }
        // Any hit has no distances.
        (Value::Number(_), Value::Null) if place.ends_with("relative_t_error") => {}
        // Built outside a checkout.
        (_, Value::Null)
            if ["document.software.commit", "document.software.dirty"].contains(&place) => {}
        _ => assert_eq!(
            std::mem::discriminant(value),
            std::mem::discriminant(shape),
            "{place} is {value}"
        ),
    }
}

#[test]
fn a_run_writes_all_keys_that_bind() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json,hall --resolution 32 --repeats 2 --out out.json";
    folder.dacrt(run).exits(0);
    let document = folder.json("out.json");
    check("document", &document, &shape());
    assert_eq!(document["cells"].as_array().unwrap().len(), 2 * (5 + 5 + 4));

    let command: Vec<&str> = std::iter::once("dacrt").chain(run.split(' ')).collect();
    assert_eq!(document["command"], json!(command));
    let machine = &document["machine"];
    assert_eq!(machine["load"].as_array().unwrap().len(), 3);
    assert!(machine["memory_bytes"].as_u64().unwrap() > 1 << 28);
    assert_ne!(machine["cpu"], "unknown");
    let library = document["software"]["embree"]["library"].as_str().unwrap();
    assert!(
        library.starts_with("libembree4") && !library.contains('/'),
        "{library}"
    );
    for cell in document["cells"].as_array().unwrap() {
        let place = format!("parameters of {}", cell["method"]);
        let parameters = match cell["method"].as_str().unwrap() {
            "best" => json!({ "block": 0, "window": 0, "sort": "" }),
            "afra2012" | "nabata2013" => json!({ "bins": 0, "leaf_triangles": 0, "leaf_rays": 0 }),
            _ => json!({ "variant": "", "ray_limit": 0, "triangle_limit": 0 }),
        };
        check(&place, &cell["parameters"], &parameters);
        let number = |key: &str| cell[key].as_f64().unwrap();
        let per_s = number("ray_count") / number("median_ms") / 1e3;
        approx::assert_relative_eq!(number("mrays_per_s"), per_s, max_relative = 1e-12);
        for hash in ["ray_hash", "hit_hash"] {
            assert_eq!(cell[hash].as_str().unwrap().len(), 64, "{hash}");
        }
        for mode in ["embree_fast", "embree_robust"] {
            let diff = &cell["diff"][mode];
            let counts = ["same", "tie", "differing"].map(|key| diff[key].as_u64().unwrap());
            assert_eq!(
                counts.iter().sum::<u64>(),
                cell["ray_count"],
                "{mode}: {diff}"
            );
        }
    }
}

/// A result may be shown to anybody: it has no more of this machine's folders than was typed.
#[test]
fn no_folder_of_this_machine_stands_in_a_result() {
    let folder = Folder::new();
    folder
        .dacrt("run --scenes ./tiny.json --resolution 8 --repeats 1 --out out.json")
        .exits(0);
    let text = std::fs::read_to_string(folder.path("out.json")).unwrap();
    let temporary = folder.path("");
    for place in [
        temporary.to_str().unwrap(),
        env!("CARGO_MANIFEST_DIR"),
        "/home",
        "/root",
    ] {
        assert!(!text.contains(place), "{place}");
    }
}
