//! Result files: exact round trips, resuming, and messages for what is wrong.

use dacrt_validate::diff::{Diff, Number, Offender, ReferenceDiff};
use dacrt_validate::embree::Mode;
use dacrt_validate::judge::{Answer, Verdict, Wrong};
use dacrt_validate::machine::{Embree, Machine, Software};
use dacrt_validate::results::{Cell, CellKey, Document, EmbreeTimes, SCHEMA};
use serde_json::json;
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::Path;

fn key(method: &str) -> CellKey {
    CellKey {
        scene: "hall".into(),
        camera: "nave".into(),
        resolution: [512, 384],
        spp: 4,
        rays: "diffuse-1".into(),
        method: method.into(),
        precision: "fast".into(),
        parameters: json!({"bins": 32, "lists": "auto", "threshold": 1.5})
            .as_object()
            .unwrap()
            .clone(),
    }
}

fn cell(method: &str) -> Cell {
    let offender = Offender {
        index: 3,
        ray: [
            0.1,
            -0.0,
            1e-45,
            0.0,
            f32::MAX,
            1.0 / 3.0,
            f32::NAN,
            f32::INFINITY,
        ]
        .map(Number),
        ray_bits: [""; 8].map(String::from),
        ours: Answer::Miss,
        embree_fast: Answer::Hit { t: 0.1, prim: 7 },
        embree_robust: Answer::Hit {
            t: f32::NEG_INFINITY,
            prim: 7,
        },
        verdicts: Some([
            Verdict::Wrong(Wrong::Distance {
                t: None,
                bound: None,
            }),
            Verdict::Right,
            Verdict::WithinBounds,
        ]),
    };
    let reference = ReferenceDiff {
        same: 10,
        ..ReferenceDiff::default()
    };
    let times = |x: f64| BTreeMap::from([("high".to_owned(), x)]);
    Cell {
        key: key(method),
        threads: Some(1),
        triangles: 100,
        dropped_triangles: 1,
        ray_count: 10,
        invalid_rays: 0,
        ray_hash: "aa".into(),
        any_hit: false,
        shared_origin: true,
        samples_ms: Some(vec![0.1 + 0.2, 1.0 / 3.0]),
        median_ms: Some(0.3),
        mrays_per_s: Some(33.0),
        acceleration_ratio: None,
        acceleration_interval: None,
        time_over_fast: None,
        time_over_fast_interval: None,
        counters: json!({"nodes": 5, "ray_box": u64::MAX})
            .as_object()
            .unwrap()
            .clone(),
        shade_ms: None,
        workspace_bytes: 1 << 33,
        hits: 9,
        hit_hash: "bb".into(),
        diff: Diff {
            embree_fast: reference.clone(),
            embree_robust: reference,
            exact: None,
            differing: 0,
            judged: 0,
            judged_random: 0,
            out_of_range: 0,
            not_judged: Some(0),
            unexplained: None,
            errors: None,
            offending: vec![offender],
        },
        printed_rule_wrong: None,
        embree: Some(EmbreeTimes {
            mode: Some(Mode::Fast),
            best_ms: 2.0,
            best_trace_ms: 1.0,
            build_ms: times(1.0),
            trace_ms: times(1.0),
            samples_ms: BTreeMap::from([("high".to_owned(), vec![1.0])]),
            trace_prepacked_ms: BTreeMap::from([("high_16".to_owned(), 0.9)]),
            bytes: 1000,
        }),
        ratio_embree_total: Some(6.0),
        ratio_embree_total_interval: None,
        ratio_embree_trace: Some(3.0),
        ratio_embree_trace_interval: None,
        peers: Vec::new(),
        twin: None,
    }
}

fn document() -> Document {
    Document {
        schema: SCHEMA,
        machine: Machine::here("avx2"),
        software: Software::this(Some(Embree {
            version: "4.4.0".into(),
            isa: "avx2".into(),
            library: "libembree4.so.4".into(),
        })),
        seed: 1,
        threads: 1,
        command: vec!["dacrt".into(), "run".into()],
        sweep: None,
        pieces: Vec::new(),
        cells: vec![cell("afra2012"), cell("nabata2013")],
        accepted: vec![],
    }
}

#[test]
fn machine_and_software_are_known() {
    let document = document();
    assert!(document.machine.cores >= 1 && document.machine.memory_bytes > 1 << 28);
    assert!(!document.machine.cpu.is_empty());
    assert!(document.software.rustc.starts_with("rustc 1."));
    // Both from a checkout, or neither.
    let software = &document.software;
    assert_eq!(software.commit.is_some(), software.dirty.is_some());
    assert!(
        software.commit.as_ref().is_none_or(|c| c.len() == 40),
        "{:?}",
        software.commit
    );
}

#[test]
fn files_round_trip_plain_and_gzipped() {
    let folder = tempfile::tempdir().unwrap();
    let (path, zipped) = (
        folder.path().join("r.json"),
        folder.path().join("r.anything"),
    );
    let document = document();
    document.write(&path).unwrap();
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), Default::default());
    gzip.write_all(&fs::read(&path).unwrap()).unwrap();
    fs::write(&zipped, gzip.finish().unwrap()).unwrap();
    for path in [&path, &zipped] {
        let back = Document::read(path).unwrap();
        // Not by `==`, for NaN is not equal to itself.
        assert_eq!(
            serde_json::to_string(&back).unwrap(),
            serde_json::to_string(&document).unwrap()
        );
        let floats = |d: &Document| d.cells[0].diff.offending[0].ray.map(|x| x.0.to_bits());
        assert_eq!(floats(&back), floats(&document));
        assert_eq!(back.cells[0].samples_ms, document.cells[0].samples_ms);
    }
    // As any other file that a program writes, not private as a temporary one.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let plain = folder.path().join("plain");
        fs::write(&plain, "").unwrap();
        let mode = |path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&path), mode(&plain));
    }
}

#[test]
fn every_float32_survives_json() {
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..100_000 {
        let x = f32::from_bits(random.u32(..));
        let text = serde_json::to_string(&Number(x)).unwrap();
        let back: Number = serde_json::from_str(&text).unwrap();
        assert!(
            back.0.to_bits() == x.to_bits() || (x.is_nan() && back.0.is_nan()),
            "{text}"
        );
    }
    let error = serde_json::from_str::<Number>("\"big\"")
        .unwrap_err()
        .to_string();
    assert!(error.contains("found \"big\""), "{error}");
}

#[test]
fn wrong_files_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.json");
    let message = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        Document::read(&path).unwrap_err().to_string()
    };
    let text = serde_json::to_string_pretty(&document()).unwrap();
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (
            b"{\n".to_vec(),
            "r.json: is not a result file as `dacrt run` writes it: EOF while parsing an object at line 2",
        ),
        (text.as_bytes()[..text.len() / 2].to_vec(), "at line "),
        (b"{}".to_vec(), "missing field `schema`"),
        (
            b"{\"schema\": 7}".to_vec(),
            "has schema 7, this program reads schema 1",
        ),
        (
            text.replace("\"seed\"", "\"sead\"").into(),
            "missing field `seed`",
        ),
        (
            vec![0x1f, 0x8b, 8, 0, 1, 2],
            "r.json: is damaged, make or copy it anew: its gzip ends in error after 0 bytes",
        ),
        (vec![0xff; 50], "is not a result file"),
    ];
    for (bytes, expected) in cases {
        let message = message(&bytes);
        assert!(message.contains(expected), "`{message}` lacks `{expected}`");
    }
    let message = Document::read(folder.path()).unwrap_err().to_string();
    assert!(
        message.contains("cannot be read: Is a directory"),
        "{message}"
    );
    let nowhere = folder.path().join("none/r.json");
    let message = document().write(&nowhere).unwrap_err().to_string();
    assert!(
        message.contains("none/r.json: cannot be written: No such file"),
        "{message}"
    );
}

#[test]
fn a_run_resumes_its_finished_cells() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.json");
    let empty = || Document {
        cells: vec![],
        ..document()
    };
    let mut fresh = empty();
    fresh.resume(&path).unwrap();
    assert!(fresh.cells.is_empty());

    Document {
        cells: vec![cell("afra2012")],
        ..document()
    }
    .write(&path)
    .unwrap();
    let mut again = empty();
    again.resume(&path).unwrap();
    assert!(again.finished(&key("afra2012")).is_some());
    assert!(again.finished(&key("nabata2013")).is_none());
    let mut other = key("afra2012");
    other.parameters.insert("bins".into(), 16.into());
    assert!(again.finished(&other).is_none());
}

/// The plan says which variant a method is for, the result which one the rays made it take.
#[test]
fn a_cell_is_found_whatever_variant_it_took() {
    let with = |variant: &str, ray_limit: u32| {
        let parameters = json!({"variant": variant, "ray_limit": ray_limit});
        CellKey {
            parameters: parameters.as_object().unwrap().clone(),
            ..key("mora2011")
        }
    };
    let finished = Cell {
        key: with("random", 20),
        ..cell("mora2011")
    };
    let document = Document {
        cells: vec![finished],
        ..document()
    };
    assert!(document.finished(&with("basic", 20)).is_some());
    assert!(document.finished(&with("basic", 19)).is_none());
    let text = serde_json::to_string(&document).unwrap();
    assert!(text.contains("\"variant\":\"random\"") && !text.contains("printed_rule_wrong"));
}

#[test]
fn cells_of_another_setting_are_not_mixed_in() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.json");
    document().write(&path).unwrap();
    let refused = |change: fn(&mut Document)| {
        let mut here = Document {
            cells: vec![],
            ..document()
        };
        change(&mut here);
        here.resume(&path).unwrap_err().to_string()
    };
    let message = refused(|d| d.seed = 2);
    assert!(
        message.contains("its seed is 1, here it is 2; give another --out"),
        "{message}"
    );
    assert!(refused(|d| d.machine.isa = "portable".into()).contains("instruction set is avx2"));
    assert!(refused(|d| d.software.commit = Some("0".into())).contains("its commit is"));
    assert!(refused(|d| d.software.embree = None).contains("its Embree is 4.4.0 avx2"));
}

/// Files from before there was the parameter `lists` lost their cells of ray sampling in tables.
#[test]
fn parameters_that_came_later_have_the_value_of_then() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../results");
    let old = Document::read(&folder.join("2026-11-22-zen5-mora-1024.json.gz")).unwrap();
    let lists = |cell: &Cell| cell.key.parameters.get("lists").cloned();
    for cell in &old.cells {
        let is_of_lists = ["afra2012", "nabata2013"].contains(&&*cell.key.method);
        assert_eq!(lists(cell), is_of_lists.then(|| "auto".into()));
    }
}
