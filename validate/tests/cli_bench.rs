//! `dacrt bench` from outside.

mod command;

use command::Folder;
use dacrt::bench::KERNELS;
use dacrt::bench::ingredients::TRIANGLE_TESTS;
use dacrt::{Isa, Method};
use dacrt_validate::growth::{self, Grows, Point};
use dacrt_validate::kernels::Document;
use dacrt_validate::throughput;

const QUICK: &str = "bench kernels --quick --repeats 2";

#[test]
fn every_kernel_has_a_line_for_each_instruction_set() {
    let folder = Folder::new();
    let text = folder.dacrt(QUICK).exits(0).stdout();
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let bytes = std::fs::read(folder.path("dacrt-bench.json")).unwrap();
    let document: Document = serde_json::from_slice(&bytes).unwrap();
    let isas: Vec<Isa> = Isa::available().collect();
    for kernel in KERNELS {
        let begins = format!("{}  tiny ", kernel.name);
        let begin = |l: &str| l.split_whitespace().collect::<Vec<_>>().join(" ");
        let lines = (text.lines()).filter(|l| begin(l).starts_with(&begin(&begins)));
        assert_eq!(lines.count(), isas.len(), "{}\n{text}", kernel.name);
        for isa in &isas {
            let of = |t: &&dacrt_validate::kernels::Timing| {
                t.kernel == kernel.name && t.isa == isa.name()
            };
            let timings: Vec<_> = document.timings.iter().filter(of).collect();
            assert_eq!(timings.len(), 1, "{}, {isa}", kernel.name);
            assert!(timings[0].ns.ratio > 0.0 && timings[0].samples_ns.len() == 2);
        }
    }
}

#[test]
fn one_instruction_set_may_be_named() {
    let folder = Folder::new();
    let run = folder.dacrt(&format!("{QUICK} --isa portable --out one.json"));
    assert!(!run.exits(0).stdout().contains("avx"), "{}", run.stdout());
    let document = folder.json("one.json");
    assert_eq!(document["kind"], "kernels");
    assert_eq!(document["timings"].as_array().unwrap().len(), KERNELS.len());
    assert_eq!(std::fs::read_dir(folder.path("")).unwrap().count(), 2);
}

/// A file of times of kernels has no cells.
#[test]
fn the_file_is_not_taken_for_a_result() {
    let folder = Folder::new();
    folder
        .dacrt(&format!("{QUICK} --isa portable --out out.json"))
        .exits(0);
    folder
        .dacrt("run --scenes ./tiny.json --resolution 8 --repeats 1 --resume --out out.json")
        .refuses(&["out.json", "is not a result file", "schema"]);
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = Folder::new();
    for (line, words) in [
        ("bench", &["<WHAT>"][..]),
        ("bench kernel", &["kernel", "kernels"]),
        ("bench kernels --isa sse", &["--isa", "sse", "portable"]),
        ("bench kernels --isa portable,sse", &["sse"]),
        ("bench kernels --scenes hall", &["--scenes", "ingredients"]),
        (
            "bench ingredients --threads 2",
            &["--threads", "throughput"],
        ),
        ("bench kernels --rays primary", &["--rays", "throughput"]),
        ("bench throughput --threads 0", &["--threads", "1 to 1024"]),
        ("bench throughput --isa avx2,portable", &["--isa", "one"]),
        ("bench throughput --methods none", &["none", "best"]),
        ("bench ingredients --scenes none", &["none", "dacrt scenes"]),
        ("bench kernels --max-rays 5000", &["bench growth"]),
        (
            "bench growth --max-rays 5000",
            &["--max-rays 5000", "10000"],
        ),
        ("bench growth --max-triangles 5", &["--max-triangles"]),
        ("bench growth --scenes hall", &["--scenes", "ingredients"]),
        ("bench growth --isa avx2,portable", &["--isa", "one"]),
        ("bench kernels --repeats 0", &["--repeats", "1 to 1000"]),
        ("bench kernels --out no/such.json", &["--out", "no folder"]),
    ] {
        folder.dacrt(line).refuses(words);
    }
}

#[test]
fn ingredients_have_errors_and_times() {
    let folder = Folder::new();
    let text = folder
        .dacrt("bench ingredients --quick --repeats 2 --scenes ./tiny.json --out i.json")
        .exits(0)
        .stdout();
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let document = folder.json("i.json");
    assert_eq!(document["kind"], "ingredients");
    let sets = document["sets"].as_array().unwrap();
    let times = document["times"]["triangle_tests"].as_array().unwrap();
    for test in TRIANGLE_TESTS {
        let begins = format!("{} ", test.name);
        let lines = text.lines().filter(|line| line.starts_with(&begins));
        // A line of errors a set, and one of times.
        assert!(lines.count() > sets.len(), "{}", test.name);
        let of_test = times.iter().filter(|time| time["test"] == test.name);
        assert_eq!(of_test.count(), Isa::available().count(), "{}", test.name);
    }
    let exact = sets
        .iter()
        .flat_map(|set| set["triangle_tests"].as_array().unwrap());
    for errors in exact.filter(|errors| errors["test"] == "exact") {
        assert_eq!(
            (&errors["lost"], &errors["false_hits"]),
            (&0.into(), &0.into())
        );
    }
}

#[test]
fn throughput_has_every_method_and_number_of_threads() {
    let folder = Folder::new();
    let text = folder
        .dacrt(
            "bench throughput --quick --repeats 2 --scenes ./tiny.json --threads 2,3 --out t.json",
        )
        .exits(0)
        .stdout();
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let document: throughput::Document = serde_json::from_value(folder.json("t.json")).unwrap();
    assert_eq!(document.kind, throughput::KIND);
    let rays: Vec<&str> = document.batches.iter().map(|b| b.rays.as_str()).collect();
    assert_eq!(rays, ["primary", "shadow-point", "diffuse-1"]);
    for batch in &document.batches {
        let ours = |name: &str| Method::ALL.iter().any(|method| method.name() == name);
        for timing in &batch.timings {
            assert_eq!(timing.samples_ms.len(), 2);
            assert!(timing.mrays_per_s > 0.0 && timing.over_one_thread.ratio > 0.0);
            // The hits of all methods are the same bits.
            let same = timing.hit_hash == batch.timings[0].hit_hash;
            assert!(same || !ours(&timing.tracer), "{}", timing.tracer);
        }
        let with = |scheme, threads| {
            let of = (batch.timings.iter())
                .filter(|timing| (timing.scheme, timing.threads) == (scheme, threads));
            of.map(|timing| timing.tracer.as_str()).collect::<Vec<_>>()
        };
        for threads in [1, 2, 3] {
            let names = with(throughput::Scheme::Throughput, threads);
            let (embree, methods) = names.split_last().unwrap();
            assert!(methods.iter().eq(Method::ALL.map(Method::name).iter()));
            assert!(embree.starts_with("embree "), "{embree}");
            let together = with(throughput::Scheme::Latency, threads);
            assert_eq!(together, if threads == 1 { vec![] } else { vec!["best"] });
        }
    }
}

/// Every contestant has a curve of each kind with all points; the derived numbers are those of the times;
/// the file can be drawn.
#[test]
fn growth_has_a_curve_for_every_contestant() {
    let folder = Folder::new();
    let text = folder
        .dacrt("bench growth --quick --repeats 1 --max-triangles 10000 --out g.json")
        .exits(0)
        .stdout();
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    let document = growth::Document::read(&folder.path("g.json")).unwrap();
    assert_eq!(document.curves.len(), 2 * 2 * 5);
    assert_eq!(document.left_out, []);
    for curve in &document.curves {
        let name = &curve.contestant;
        assert!(text.contains(name), "{name}\n{text}");
        let numbers: Vec<usize> = curve.points.iter().map(|p| p.number(curve.grows)).collect();
        match curve.grows {
            // Square pictures; diffuse rays start where primary rays hit.
            Grows::Rays if curve.rays == "primary" => assert_eq!(numbers, [32 * 32, 56 * 56]),
            Grows::Rays => assert!(numbers[0] > 500 && numbers[1] > 2 * numbers[0]),
            Grows::Triangles => assert_eq!(numbers, [1000, 3162, 10_000]),
        }
        let [first, second] = [&curve.points[0], &curve.points[1]];
        let of = |point: &Point| (point.number(curve.grows), point.ms.unwrap());
        let expected = growth::exponent(of(first), of(second));
        assert_eq!(second.exponent, Some(expected));
        assert_eq!((first.exponent, first.over_n_log_n), (None, Some(1.0)));
        let is_embree = name.starts_with("embree");
        for point in &curve.points {
            let parts = [point.build_ms, point.trace_ms].map(|ms| ms.is_some_and(|ms| ms > 0.0));
            assert_eq!(parts, [is_embree; 2], "{name}");
            assert!(is_embree || point.bytes.is_some_and(|bytes| bytes > 100_000));
        }
    }
    // Of one build or the other.
    let embree = document
        .curves
        .iter()
        .filter(|c| c.contestant.starts_with("embree"));
    let known = embree.flat_map(|c| &c.points).filter(|p| p.bytes.is_some());
    assert_eq!(known.count(), 2 * (2 + 3));
    assert_eq!(document.cells.len(), 2 * (2 + 3) * 3);

    let plot = folder.dacrt("plot growth g.json --out g.svg");
    assert!(plot.exits(0).stdout().contains("20 curves, 50 points"));
    let svg = std::fs::read_to_string(folder.path("g.svg")).unwrap();
    for words in ["nabata2013", "diffuse-1, 10,000 triangles", "n log n"] {
        assert!(svg.contains(words), "{words}");
    }
    folder
        .dacrt("plot growth g.json g.json --out g.svg")
        .refuses(&["one file"]);
    folder.write("other.json", "{}");
    folder
        .dacrt("plot growth other.json --out g.svg")
        .refuses(&["other.json", "bench growth"]);
}
