//! Sweeps: what they write, that they go on where they were killed, shards, and bad input.

mod command;

use command::Folder;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Two scenes, two sizes, two ray types: eight batches of four cells.
const SWEEP: &str = r#"{
  "scenes": ["./tiny.json", "./other.json"],
  "resolution": [8, [16, 8]],
  "rays": ["primary", "diffuse-1"],
  "methods": ["afra2012", "nabata2013"],
  "parameters": { "samples": [20, 40, 100] }
}"#;
const BATCHES: usize = 8;
const CELLS: usize = BATCHES * 4;

fn folder() -> Folder {
    let folder = Folder::new();
    let tiny = std::fs::read_to_string(folder.path("tiny.json")).unwrap();
    folder.write("other.json", tiny.replace("500", "300"));
    folder.write("s.json", SWEEP);
    folder
}

/// All that a cell says but for times, in the order of keys.
fn cells(document: &Value) -> Vec<Value> {
    let timeless = |cell: &Value| {
        let mut cell = cell.clone();
        let keys = cell.as_object_mut().unwrap();
        keys.retain(|key, _| {
            !["ms", "ratio", "interval", "mrays", "embree"]
                .iter()
                .any(|word| key.contains(word))
        });
        cell
    };
    let mut cells: Vec<Value> = document["cells"]
        .as_array()
        .unwrap()
        .iter()
        .map(timeless)
        .collect();
    cells.sort_by_key(Value::to_string);
    cells
}

#[test]
fn a_sweep_measures_the_product_of_its_lists() {
    let folder = folder();
    let run = folder.dacrt("sweep s.json --repeats 2");
    let text = run.exits(0).stdout();
    assert!(text.contains("as fast as with samples=100"), "{text}");
    assert!(text.contains("results: dacrt-s.json"), "{text}");
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    assert_eq!(run.stderr().lines().count(), BATCHES, "{}", run.stderr());
    assert!(
        run.stderr().starts_with("1/8 tiny primary 8x8: 4 cells"),
        "{}",
        run.stderr()
    );

    let document = folder.json("dacrt-s.json");
    assert_eq!(document["cells"].as_array().unwrap().len(), CELLS);
    let sweep: Value = serde_json::from_str(SWEEP).unwrap();
    assert_eq!(document["sweep"]["file"]["parameters"], sweep["parameters"]);
    assert_eq!(document["sweep"]["shard"], Value::Null);

    // The same cells as of `run`, asked for the same.
    folder
        .dacrt(
            "run --scenes ./tiny.json,./other.json --resolution 8,16x8 --rays primary,diffuse-1 \
             --methods afra2012,nabata2013 --samples 20,40,100 --repeats 2 --out run.json",
        )
        .exits(0);
    assert_eq!(cells(&document), cells(&folder.json("run.json")));

    // Nothing is left to do.
    let before = std::fs::read(folder.path("dacrt-s.json")).unwrap();
    let again = folder.dacrt("sweep s.json --repeats 2");
    assert!(
        again
            .exits(0)
            .stdout()
            .contains("(32 cells of an earlier run)")
    );
    assert_eq!(again.stderr(), "");
    assert!(before == std::fs::read(folder.path("dacrt-s.json")).unwrap());
}

/// Killed at moments spread over its whole length, a sweep leaves a whole file or none, and ends
/// with the cells of an undisturbed one.
#[test]
fn a_killed_sweep_goes_on_where_it_was() {
    let folder = folder();
    let sweep = "sweep s.json --repeats 3";
    let start = Instant::now();
    folder.dacrt(&format!("{sweep} --out whole.json")).exits(0);
    let whole = start.elapsed();
    let expected = cells(&folder.json("whole.json"));

    let mut random = fastrand::Rng::with_seed(1);
    let mut kept = 0;
    for _ in 0..20 {
        let mut child = folder
            .command(&format!("{sweep} --out killed.json"))
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_secs_f64(
            whole.as_secs_f64() / 4.0 * random.f64(),
        ));
        child.kill().unwrap();
        child.wait().unwrap();
        if folder.path("killed.json").exists() {
            let cells = folder.json("killed.json")["cells"]
                .as_array()
                .unwrap()
                .len();
            assert!(
                cells >= kept && cells.is_multiple_of(CELLS / BATCHES),
                "{kept} {cells}"
            );
            kept = cells;
        }
    }
    folder.dacrt(&format!("{sweep} --out killed.json")).exits(0);
    assert_eq!(cells(&folder.json("killed.json")), expected);
    let names = std::fs::read_dir(folder.path("")).unwrap();
    let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let left: Vec<String> = names.filter(|name| name.ends_with(".partial")).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn shards_merge_to_the_whole() {
    let folder = folder();
    folder
        .dacrt("sweep s.json --repeats 1 --out whole.json")
        .exits(0);
    for i in 1..=3 {
        folder
            .dacrt(&format!("sweep s.json --repeats 1 --shard {i}/3"))
            .exits(0);
    }
    // In any order.
    let merge = "merge dacrt-s-3of3.json dacrt-s-1of3.json dacrt-s-2of3.json --out merged.json";
    folder.dacrt(merge).exits(0);
    let (merged, whole) = (folder.json("merged.json"), folder.json("whole.json"));
    assert_eq!(cells(&merged), cells(&whole));
    assert_eq!(merged["sweep"]["shard"], Value::Null);
    let pieces = merged["pieces"].as_array().unwrap();
    let sum: u64 = pieces
        .iter()
        .map(|piece| piece["cells"].as_u64().unwrap())
        .sum();
    assert_eq!((pieces.len(), sum as usize), (3, CELLS));
    // A merged file is a result file like others.
    let table = folder.dacrt("table merged.json --over samples");
    assert!(table.exits(0).stdout().contains("as fast as afra2012"));
    folder
        .dacrt("sweep s.json --repeats 1 --out merged.json")
        .exits(0);
}

#[test]
fn shards_that_do_not_fit_are_refused() {
    let folder = folder();
    for (i, n) in [(1, 2), (2, 2), (1, 3)] {
        folder
            .dacrt(&format!("sweep s.json --repeats 1 --shard {i}/{n}"))
            .exits(0);
    }
    folder.write("out.json", "mine");
    let merge = |files: &str| folder.dacrt(&format!("merge {files} --out out.json"));
    merge("dacrt-s-1of2.json").refuses(&["dacrt-s-1of2.json", "shard 2 is missing"]);
    merge("dacrt-s-1of2.json dacrt-s-1of2.json").refuses(&["shard 1 is given twice"]);
    merge("dacrt-s-1of2.json dacrt-s-1of3.json").refuses(&["one of 3 shards"]);

    let changed = |name: &str, change: fn(&mut Value)| {
        let mut document = folder.json("dacrt-s-2of2.json");
        change(&mut document);
        folder.write(name, document.to_string());
    };
    let merge_with = |name: &str| merge(&format!("dacrt-s-1of2.json {name}"));
    changed("seed.json", |d| d["seed"] = json!(2));
    merge_with("seed.json").refuses(&["seed.json", "its seed is 2, there it is 1"]);
    changed("isa.json", |d| d["machine"]["isa"] = json!("sse2"));
    merge_with("isa.json").refuses(&["instruction set is sse2"]);
    changed("schema.json", |d| d["schema"] = json!(2));
    merge_with("schema.json").refuses(&["schema.json", "schema 2", "reads schema 1"]);
    changed("sweep.json", |d| {
        d["sweep"]["file"]["rays"] = json!(["primary"])
    });
    merge_with("sweep.json").refuses(&["shards of two sweeps"]);
    changed("none.json", |d| {
        d.as_object_mut().unwrap().remove("sweep");
    });
    merge_with("none.json").refuses(&["one is a shard of a sweep, the other is not"]);
    folder.write(
        "cut.json",
        &folder.json("dacrt-s-2of2.json").to_string()[..999],
    );
    merge_with("cut.json").refuses(&["cut.json", "column 999"]);
    merge_with("nowhere.json").refuses(&["nowhere.json", "cannot be read"]);
    assert_eq!(
        std::fs::read_to_string(folder.path("out.json")).unwrap(),
        "mine"
    );
}

/// Pieces of runs that are no sweep: cells of one batch must have the same rays.
#[test]
fn pieces_with_other_rays_or_the_same_cells_are_refused() {
    let folder = folder();
    for method in ["afra2012", "nabata2013"] {
        folder
            .dacrt(&format!(
                "run --scenes ./tiny.json --rays primary --resolution 8 --repeats 1 \
                 --methods {method} --out {method}.json"
            ))
            .exits(0);
    }
    folder
        .dacrt("merge afra2012.json nabata2013.json --out both.json")
        .exits(0);
    assert_eq!(
        folder.json("both.json")["cells"].as_array().unwrap().len(),
        2
    );
    folder
        .dacrt("merge both.json afra2012.json --out twice.json")
        .refuses(&[
            "afra2012.json",
            "both.json",
            "tiny/primary/8x8/1/afra2012",
            "give each file once",
        ]);
    let mut other = folder.json("nabata2013.json");
    other["cells"][0]["ray_hash"] = json!("0");
    folder.write("other.json", other.to_string());
    folder
        .dacrt("merge afra2012.json other.json --out rays.json")
        .refuses(&[
            "other.json",
            "other rays than afra2012.json",
            "tiny/primary/8x8/1",
        ]);
    assert!(!folder.path("twice.json").exists() && !folder.path("rays.json").exists());
}

#[test]
fn bad_sweep_files_are_refused() {
    let folder = folder();
    for (from, to, words) in [
        (
            "\"samples\"",
            "\"smaples\"",
            &["parameters.smaples", "did you mean \"samples\""][..],
        ),
        (
            "\"samples\"",
            "\"cone_limit\"",
            &[
                "parameters.cone_limit",
                "no cells",
                "afra2012 and nabata2013",
            ],
        ),
        (
            "[20, 40, 100]",
            "[]",
            &["parameters.samples", "at least one entry"],
        ),
        ("[20, 40, 100]", "[20, 0]", &["parameters.samples", ": 0"]),
        (
            "[20, 40, 100]",
            "[20, \"many\"]",
            &["parameters.samples: many", "expected a whole number"],
        ),
        ("[20, 40, 100]", "20", &["s.json", "line 6", "sequence"]),
        (
            "\"scenes\": [\"./tiny.json\", \"./other.json\"]",
            "\"scenes\": []",
            &["scenes", "no cells"],
        ),
        (
            "\"rays\": [\"primary\", \"diffuse-1\"]",
            "\"rays\": []",
            &["rays", "no cells"],
        ),
        (
            "\"methods\": [\"afra2012\", \"nabata2013\"]",
            "\"methods\": []",
            &["methods", "no cells"],
        ),
        ("[8, [16, 8]]", "[]", &["resolution", "no cells"]),
        ("[8, [16, 8]]", "[8, 0]", &["s.json", "resolution 0x0"]),
        (
            "[8, [16, 8]]",
            "[\"8\"]",
            &["line 3", "expected a number of pixels"],
        ),
        (
            "[8, [16, 8]]",
            "[8], \"spp\": [3]",
            &["spp", "3 is not a square number"],
        ),
        ("\"rays\"", "\"rayz\"", &["s.json", "line 4", "rayz"]),
        ("diffuse-1", "difuse-1", &["did you mean \"diffuse-1\""]),
        (
            "nabata2013\"]",
            "nabata\"]",
            &["did you mean \"nabata2013\""],
        ),
        ("./other.json", "nowhere", &["nowhere"]),
        ("}", "", &["s.json", "line"]),
    ] {
        assert!(SWEEP.contains(from), "{from}");
        folder.write("s.json", SWEEP.replacen(from, to, 1));
        folder.dacrt("sweep s.json").refuses(words);
    }
    folder
        .dacrt("sweep nowhere.json")
        .refuses(&["nowhere.json"]);
    folder.write("s.json", SWEEP);
    folder
        .dacrt("sweep s.json --shard 1/9")
        .refuses(&["no more than 8 batches"]);
    folder.dacrt("sweep s.json --shard 3/2").refuses(&["I/N"]);
    assert!(!folder.path("dacrt-s.json").exists());
}

#[test]
fn a_file_that_is_not_of_the_sweep_is_kept() {
    let folder = folder();
    let sweep = "sweep s.json --repeats 1 --out out.json";
    folder.dacrt(sweep).exits(0);
    let document = folder.json("out.json");
    let refuses_over = |text: String, words: &[&str]| {
        folder.write("out.json", &text);
        folder.dacrt(sweep).refuses(words);
        assert_eq!(
            std::fs::read_to_string(folder.path("out.json")).unwrap(),
            text
        );
    };
    refuses_over("mine".into(), &["out.json", "not a result file", "line 1"]);
    refuses_over(
        "{\"cells\": []}".into(),
        &["out.json", "missing field `schema`"],
    );
    refuses_over(
        document.to_string()[..999].into(),
        &["out.json", "column 999"],
    );
    let changed = |change: fn(&mut Value)| {
        let mut document = document.clone();
        change(&mut document);
        document.to_string()
    };
    refuses_over(
        changed(|d| d["schema"] = json!(2)),
        &["schema 2", "reads schema 1"],
    );
    refuses_over(
        changed(|d| d["seed"] = json!(7)),
        &["its seed is 7", "--out"],
    );
    refuses_over(
        changed(|d| d["sweep"]["shard"] = json!([1, 2])),
        &["shard 1 of 2", "here it is all"],
    );
    refuses_over(
        changed(|d| d["cells"][0]["parameters"]["bins"] = json!(31)),
        &["not of this sweep", "--out"],
    );
    folder.write("out.json", document.to_string());
    folder
        .dacrt("sweep s.json --repeats 2 --out out.json")
        .refuses(&["1 repeat", "--out"]);
    // Wider lists are no other sweep: it goes on.
    folder.write(
        "s.json",
        SWEEP.replace("[20, 40, 100]", "[20, 40, 100, 200]"),
    );
    folder.dacrt(sweep).exits(0);
    let cells = folder.json("out.json")["cells"].as_array().unwrap().len();
    assert_eq!(cells, BATCHES * 5);
}

#[test]
fn many_values_take_several_tables() {
    let folder = folder();
    let bins: Vec<String> = (2..22).map(|n| n.to_string()).collect();
    folder
        .dacrt(&format!(
            "run --scenes ./tiny.json --resolution 8 --rays primary --methods afra2012 \
             --repeats 1 --out r.json --bins {}",
            bins.join(",")
        ))
        .exits(0);
    let text = folder.dacrt("table r.json --over bins").exits(0).stdout();
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    let heads = text.lines().filter(|line| line.starts_with("bins "));
    let heads: Vec<&str> = heads
        .flat_map(|line| line.split_whitespace().skip(1))
        .collect();
    assert_eq!(heads, bins);
}

#[test]
fn tables_of_a_result_file() {
    let folder = folder();
    let run = "run --scenes ./tiny.json,./other.json --resolution 8 --rays primary,diffuse-1 \
               --methods afra2012,nabata2013,mora2011-random --samples 20,100 --repeats 2 --out r.json";
    let printed = folder.dacrt(run);
    let printed = printed.exits(0).stdout();
    let again = folder.dacrt("table r.json");
    let again = again.exits(0).stdout();
    assert_eq!(again, printed.replace("\nresults: r.json\n", ""));

    let over = folder
        .dacrt("table r.json --over samples")
        .exits(0)
        .stdout();
    assert!(
        over.contains("samples") && over.contains("geometric mean"),
        "{over}"
    );
    let methods = folder.dacrt("table r.json --over method").exits(0).stdout();
    assert!(
        methods.contains("nabata2013   mora2011-random"),
        "{methods}"
    );
    folder.dacrt("table r.json --over bins").refuses(&[
        "r.json",
        "--over bins",
        "they do in samples",
    ]);
    folder
        .dacrt("table s.json")
        .refuses(&["s.json", "not a result file"]);

    let text = folder.dacrt("table r.json --csv").exits(0).stdout();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let document = folder.json("r.json");
    let cells = document["cells"].as_array().unwrap();
    assert_eq!(rows.len(), cells.len());
    for (row, cell) in rows.iter().zip(cells) {
        assert_eq!(row[column("method")], *cell["method"].as_str().unwrap());
        assert_eq!(
            row[column("counters.ray_box")],
            cell["counters"]["ray_box"].to_string()
        );
        assert_eq!(row[column("median_ms")], cell["median_ms"].to_string());
        let samples = cell["parameters"].get("samples").map(Value::to_string);
        assert_eq!(
            row[column("parameters.samples")],
            samples.unwrap_or_default()
        );
        assert_eq!(row[column("resolution")], *"8 8");
        assert_eq!(
            row[column("machine.cpu")],
            *document["machine"]["cpu"].as_str().unwrap()
        );
    }
}
