//! `--threads`: the same hits as with one thread, and what the result file says of them.

mod command;

use command::{Folder, TRIANGLE};
use serde_json::Value;

const RUN: &str = "run --scenes ./tiny.json --resolution 96 --rays primary,shadow-point,diffuse-1 \
                   --methods afra2012,best --precision fast,watertight,exact --repeats 2";

fn cells(document: &Value) -> &Vec<Value> {
    document["cells"].as_array().unwrap()
}

#[test]
fn two_threads_find_the_hits_of_one() {
    let folder = Folder::new();
    let one = folder.dacrt(&format!("{RUN} --threads 1 --out one.json"));
    assert_eq!(one.exits(0).stderr().matches("thread").count(), 0);
    let two = folder.dacrt(&format!("{RUN} --threads 2 --out two.json"));
    let warning = "--threads 2: all methods but best trace with one thread, Embree with 2";
    assert!(two.exits(0).stderr().contains(warning), "{}", two.stderr());
    let [one, two] = ["one.json", "two.json"].map(|name| folder.json(name));
    assert_eq!([&one["threads"], &two["threads"]], [1, 2]);
    assert_eq!(cells(&one).len(), 18);
    for (a, b) in cells(&one).iter().zip(cells(&two)) {
        for key in [
            "method",
            "precision",
            "rays",
            "ray_hash",
            "hit_hash",
            "hits",
        ] {
            assert_eq!(a[key], b[key]);
        }
        let is_best = a["method"] == "best";
        assert_eq!(a["threads"], 1);
        assert_eq!(b["threads"], if is_best { 2 } else { 1 });
        let bytes = |cell: &Value| cell["workspace_bytes"].as_u64().unwrap();
        assert_eq!(bytes(b) > bytes(a), is_best);
        if !is_best {
            assert_eq!(a["counters"], b["counters"]);
        }
        assert!(b["median_ms"].as_f64().unwrap() > 0.0);
        assert!(b["embree"]["best_trace_ms"].as_f64().unwrap() > 0.0);
    }

    // Times and counters of other threads are not judged.
    let compared = folder.dacrt("compare one.json two.json");
    let text = compared.exits(0).stdout();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains("9 of 18 cells have more"), "{text}");
    assert!(text.contains("threads is 1"), "{text}");
    let again = "compare two.json two.json";
    assert!(folder.dacrt(again).exits(0).stdout().contains("18 same"));

    // Cells of another number of threads are not kept.
    let resumed = folder.dacrt(&format!("{RUN} --threads 2 --resume --out one.json"));
    let error = resumed.exits(2).stderr();
    assert!(error.contains("number of threads is 1, here it is 2"));
    folder
        .dacrt("merge one.json two.json --out both.json")
        .refuses(&["number of threads"]);

    let csv = folder.dacrt("table two.json --csv");
    let text = csv.exits(0).stdout();
    let heads: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    for head in ["threads", "embree.threads"] {
        assert_eq!(heads.iter().filter(|h| **h == head).count(), 1, "{head}");
    }
}

#[test]
fn a_sweep_takes_threads() {
    let folder = Folder::new();
    let sweep = r#"{ "scenes": ["./tiny.json"], "resolution": [64], "rays": ["primary"],
                     "methods": ["best"] }"#;
    folder.write("s.json", sweep);
    let run = folder.dacrt("sweep s.json --repeats 1 --threads 0");
    assert!(!run.exits(0).stderr().contains("one thread"));
    let all = std::thread::available_parallelism().unwrap().get();
    let document = folder.json("dacrt-s.json");
    assert_eq!(document["threads"], all);
    assert_eq!(document["cells"][0]["threads"], all);
    folder
        .dacrt(&format!("sweep s.json --repeats 1 --threads {}", all + 1))
        .refuses(&["number of threads"]);
}

#[test]
fn trace_and_render_take_threads() {
    let folder = Folder::new();
    folder.write("m.obj", TRIANGLE);
    folder.write_rays("r.npy");
    let trace = "trace --mesh m.obj --rays r.npy --method best";
    for any_hit in ["", "--any-hit"] {
        for threads in [1, 0, 3] {
            folder
                .dacrt(&format!(
                    "{trace} {any_hit} --threads {threads} --out h{threads}.npz"
                ))
                .exits(0);
        }
        let read = |name| std::fs::read(folder.path(name)).unwrap();
        assert!(read("h1.npz") == read("h3.npz") && read("h1.npz") == read("h0.npz"));
    }
    for threads in [1, 2] {
        folder
            .dacrt(&format!(
                "render ./tiny.json --resolution 80 --spp 1 --method best --threads {threads} \
                 --out p{threads}.png"
            ))
            .exits(0);
    }
    let read = |name| std::fs::read(folder.path(name)).unwrap();
    assert!(read("p1.png") == read("p2.png"));
}
