//! Comparing two results: what is a regression, what is only shown, and what cannot be compared.

use dacrt::Method;
use dacrt_validate::compare::{
    Against, CompareError, Comparison, Grade, Names, Options, Tolerances, compare,
};
use dacrt_validate::diff::{Diff, ExactDiff, ReferenceDiff};
use dacrt_validate::embree::Mode;
use dacrt_validate::machine::{Embree, Machine, Software};
use dacrt_validate::parameters::own_fields;
use dacrt_validate::results::{Cell, CellKey, Document, EmbreeTimes, SCHEMA};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Milliseconds of five rounds, as quiet as on a good day.
fn rounds(ms: f64) -> Vec<f64> {
    [1.0, 1.01, 0.99, 1.02, 1.0].map(|x| x * ms).to_vec()
}

fn cell(scene: &str, method: Method, ms: f64) -> Cell {
    let reference = ReferenceDiff {
        same: 98,
        tie: 1,
        differing: 1,
        ..ReferenceDiff::default()
    };
    let embree = ["low", "medium", "high"].into_iter().zip([1.0, 2.0, 4.0]);
    let embree = embree.flat_map(|(quality, x)| {
        let trace = |query: &str, ms| (format!("{quality}_{query}"), rounds(ms));
        [
            (quality.to_owned(), rounds(5.0 * x)),
            trace("1", 90.0 / x),
            trace("16", 60.0 / x),
            // Given up after a round.
            (format!("{quality}_16_coherent"), vec![100.0]),
        ]
    });
    Cell {
        key: CellKey {
            scene: scene.into(),
            camera: "front".into(),
            resolution: [512, 384],
            spp: 1,
            rays: "primary".into(),
            method: method.name().into(),
            precision: "fast".into(),
            parameters: own_fields(method, &method.parameters()),
        },
        threads: Some(1),
        triangles: 500,
        dropped_triangles: 0,
        ray_count: 100,
        invalid_rays: 0,
        ray_hash: format!("rays of {scene}"),
        any_hit: false,
        shared_origin: true,
        samples_ms: Some(rounds(ms)),
        median_ms: Some(ms),
        mrays_per_s: Some(0.1),
        // Stored figures are not looked at: these are nonsense.
        acceleration_ratio: Some(99.0),
        acceleration_interval: None,
        time_over_fast: None,
        time_over_fast_interval: None,
        counters: json!({ "nodes": 100, "ray_box": 1000, "leaves": 7, "skips_near": 3 })
            .as_object()
            .unwrap()
            .clone(),
        shade_ms: None,
        workspace_bytes: 4096,
        hits: 50,
        hit_hash: format!("hits of {scene}"),
        diff: Diff {
            embree_fast: reference.clone(),
            embree_robust: reference,
            exact: None,
            differing: 1,
            judged: 100,
            judged_random: 99,
            out_of_range: 0,
            not_judged: Some(0),
            unexplained: None,
            errors: None,
            offending: vec![],
        },
        printed_rule_wrong: None,
        embree: Some(EmbreeTimes {
            mode: Some(Mode::Fast),
            best_ms: 99.0,
            best_trace_ms: 99.0,
            build_ms: BTreeMap::new(),
            trace_ms: BTreeMap::new(),
            samples_ms: embree.collect(),
            trace_prepacked_ms: BTreeMap::new(),
            bytes: 1000,
        }),
        ratio_embree_total: Some(99.0),
        ratio_embree_total_interval: None,
        ratio_embree_trace: Some(99.0),
        ratio_embree_trace_interval: None,
        peers: Vec::new(),
        twin: None,
    }
}

/// Two scenes, three methods each.
fn document() -> Document {
    let methods = [
        (Method::Afra2012, 40.0),
        (Method::Nabata2013, 30.0),
        (Method::Mora2011, 50.0),
    ];
    let cells = ["hall", "soup"].map(|s| methods.map(|(method, ms)| cell(s, method, ms)));
    Document {
        schema: SCHEMA,
        machine: Machine {
            cpu: "a processor".into(),
            isa: "avx2".into(),
            cores: 2,
            memory_bytes: 1 << 30,
            load: [0.0; 3],
            mxcsr: None,
        },
        software: Software {
            commit: Some("0123456789".into()),
            dirty: Some(false),
            rustc: "rustc 1".into(),
            embree: Some(Embree {
                version: "4.4.0".into(),
                isa: "avx2".into(),
                library: "libembree4.so.4".into(),
            }),
        },
        seed: 1,
        threads: 1,
        command: vec![],
        sweep: None,
        pieces: vec![],
        cells: cells.into_iter().flatten().collect(),
        accepted: vec![],
    }
}

const NABATA_IN_HALL: &str = "hall/primary/512x384/1/nabata2013";

fn changed(change: impl FnOnce(&mut Document)) -> Document {
    let mut document = document();
    change(&mut document);
    document
}

fn compared(a: &Document, b: &Document) -> Comparison {
    compare(a, b, &Options::default()).unwrap()
}

fn scaled(cell: &mut Cell, factor: f64) {
    let samples = cell.samples_ms.as_mut().unwrap();
    samples.iter_mut().for_each(|ms| *ms *= factor);
}

/// The cells that are not the same, and what of them, with grades.
fn findings(comparison: &Comparison) -> Vec<(String, String, Grade)> {
    let of = |c: &dacrt_validate::compare::CellComparison| {
        let found = c.findings.iter().map(|f| (f.what.clone(), f.grade));
        let speed = c.speed.iter().map(|s| ("speed".to_owned(), s.grade));
        let name = c.name.clone();
        let all = found
            .chain(speed)
            .filter(|(_, grade)| *grade != Grade::Same);
        all.map(|(what, grade)| (name.clone(), what, grade))
            .collect::<Vec<_>>()
    };
    comparison.cells.iter().flat_map(of).collect()
}

/// Changes the cell of Nabata in the hall and says what was found of it; nothing may be found of
/// other cells.
#[track_caller]
fn found(change: impl FnOnce(&mut Cell)) -> Vec<(String, Grade)> {
    let new = changed(|d| change(&mut d.cells[1]));
    let all = findings(&compared(&document(), &new)).into_iter();
    all.map(|(name, what, grade)| {
        assert_eq!(name, NABATA_IN_HALL);
        (what, grade)
    })
    .collect()
}

fn one(what: &str, grade: Grade) -> Vec<(String, Grade)> {
    vec![(what.to_owned(), grade)]
}

#[test]
fn a_file_is_like_itself() {
    let comparison = compared(&document(), &document());
    assert_eq!(comparison.grade, Grade::Same);
    assert_eq!(comparison.count(Grade::Same), 6);
    assert_eq!(findings(&comparison), []);
}

/// What anybody sent us must stay readable, and must be like itself.
#[test]
fn every_committed_result_is_like_itself() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../results");
    let mut files = 0;
    for file in folder.read_dir().unwrap() {
        let path = file.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let is_result = [".json", ".json.gz"].iter().any(|end| name.ends_with(end))
            && !["schema", "claims", "sweep", "growth", "throughput"]
                .iter()
                .any(|other| name.contains(other));
        if is_result {
            let document = Document::read(&path).unwrap();
            assert_eq!(compared(&document, &document).grade, Grade::Same, "{name}");
            files += 1;
        }
    }
    assert!(files >= 10, "{files}");
}

#[test]
fn other_hits_are_a_regression() {
    let hash = |c: &mut Cell| c.hit_hash = "others".into();
    assert_eq!(found(hash), one("hit_hash", Grade::Regression));
    let not_judged = |c: &mut Cell| c.diff.not_judged = Some(1);
    assert_eq!(found(not_judged), one("diff.not_judged", Grade::Regression));
    let tie = |c: &mut Cell| c.diff.embree_robust.tie = 2;
    assert_eq!(found(tie), one("diff.embree_robust.tie", Grade::Regression));
    // Fewer are a change as well: `--accept` is for it.
    let same = |c: &mut Cell| c.diff.embree_fast.same = 97;
    assert_eq!(found(same), one("diff.embree_fast.same", Grade::Regression));
    let lost = |c: &mut Cell| c.samples_ms = None;
    assert_eq!(found(lost), one("has_times", Grade::Regression));
}

#[test]
fn classes_that_are_null_are_unknown_and_not_judged() {
    assert_eq!(found(|c| c.diff.embree_fast.ours_wrong = Some(5)), []);
    assert_eq!(found(|c| c.printed_rule_wrong = Some(5)), []);
    let known = |ours_wrong, exact| {
        changed(|d| {
            let cell = &mut d.cells[1];
            cell.diff.embree_fast.ours_wrong = Some(ours_wrong);
            cell.diff.unexplained = Some(exact);
            cell.diff.exact = Some(ExactDiff {
                rays: exact,
                classes: ReferenceDiff {
                    // Of more rays there are more.
                    same: exact,
                    both_wrong: Some(exact),
                    ..ReferenceDiff::default()
                },
            });
            cell.printed_rule_wrong = Some(exact);
        })
    };
    let all = findings(&compared(&known(0, 0), &known(1, 2)));
    let what: Vec<&str> = all.iter().map(|(_, what, _)| what.as_str()).collect();
    assert_eq!(
        what,
        [
            "diff.embree_fast.ours_wrong",
            "diff.exact.both_wrong",
            "diff.unexplained",
            "printed_rule_wrong",
            "diff.exact.same"
        ]
    );
    for (_, what, grade) in &all {
        let expected = match &**what {
            "diff.exact.same" => Grade::Changed,
            _ => Grade::Regression,
        };
        assert_eq!(*grade, expected, "{what}");
    }
}

#[test]
fn what_another_embree_answers_is_only_shown() {
    let new = changed(|d| {
        d.software.embree.as_mut().unwrap().isa = "avx512".into();
        d.cells[1].diff.embree_fast.tie = 2;
    });
    let comparison = compared(&document(), &new);
    let why = comparison.embree_not_judged.as_ref().unwrap();
    assert!(
        why.contains("4.4.0 avx2") && why.contains("4.4.0 avx512"),
        "{why}"
    );
    assert_eq!(comparison.grade, Grade::Changed);
    let what = &findings(&comparison)[0].1;
    assert_eq!(what, "diff.embree_fast.tie");

    // Our own hits are judged all the same.
    let new = changed(|d| {
        d.software.embree = None;
        d.cells[1].diff.not_judged = Some(2);
    });
    assert_eq!(compared(&document(), &new).grade, Grade::Regression);
}

#[test]
fn more_work_is_a_regression() {
    let set = |name: &str, n: u64| {
        let name = name.to_owned();
        found(|c| {
            c.counters.insert(name, n.into());
        })
    };
    assert_eq!(
        set("ray_box", 1001),
        one("counters.ray_box", Grade::Regression)
    );
    assert_eq!(
        set("ray_box", 999),
        one("counters.ray_box", Grade::Improvement)
    );
    assert_eq!(set("leaves", 8), one("counters.leaves", Grade::Changed));
    assert_eq!(
        set("skips_near", 2),
        one("counters.skips_near", Grade::Changed)
    );
    assert_eq!(set("cone_box", 2), one("counters.cone_box", Grade::Changed));
    let less_memory = |c: &mut Cell| c.workspace_bytes = 1;
    assert_eq!(found(less_memory), one("workspace_bytes", Grade::Changed));
}

#[test]
fn the_gravest_finding_stands_first() {
    let both = found(|c| {
        c.counters["leaves"] = 9.into();
        c.counters["nodes"] = 99.into();
        c.counters["ray_box"] = 1001.into();
        c.workspace_bytes = 1;
    });
    let what: Vec<&str> = both.iter().map(|(what, _)| what.as_str()).collect();
    let expected = ["ray_box", "nodes", "leaves"].map(|name| format!("counters.{name}"));
    assert_eq!(what[..3], expected);
}

/// Beyond 2⁵³ neighbours are one float64.
#[test]
fn huge_counters_are_compared_as_whole_numbers() {
    let with = |n: u64| changed(|d| d.cells[1].counters["ray_box"] = n.into());
    let comparison = compared(&with(u64::MAX - 1), &with(u64::MAX));
    assert_eq!(comparison.grade, Grade::Regression);
}

#[test]
fn tolerances_are_for_one_counter_or_for_all() {
    let new = changed(|d| {
        d.cells[1].counters["ray_box"] = 1010.into();
        d.cells[2].counters["nodes"] = 103.into();
    });
    let with = |all: f64, of: &[(&str, f64)]| {
        let tolerances = Tolerances {
            all,
            of: of
                .iter()
                .map(|(name, share)| (name.to_string(), *share))
                .collect(),
        };
        let options = Options {
            tolerances,
            ..Options::default()
        };
        compare(&document(), &new, &options).map(|c| c.count(Grade::Regression))
    };
    assert_eq!(with(0.0, &[]), Ok(2));
    assert_eq!(with(0.0, &[("ray_box", 0.01)]), Ok(1));
    assert_eq!(with(0.0, &[("ray_box", 0.0099)]), Ok(2));
    assert_eq!(with(0.02, &[]), Ok(1));
    assert_eq!(with(0.02, &[("nodes", 0.03)]), Ok(0));
    assert_eq!(with(0.03, &[("ray_box", 0.0)]), Ok(1));
    let message = with(0.0, &[("raybox", 0.1)]).unwrap_err().to_string();
    assert!(message.contains("did you mean \"ray_box\""), "{message}");
}

#[test]
fn counters_of_several_threads_are_only_shown() {
    let with = |threads, ray_box: u64| {
        changed(|d| {
            d.threads = threads;
            d.cells[1].threads = Some(threads);
            d.cells[1].counters["ray_box"] = ray_box.into();
        })
    };
    let comparison = compared(&with(2, 1000), &with(2, 2000));
    assert_eq!(comparison.grade, Grade::Same);
    assert_eq!(comparison.cells[1].findings.len(), 1);
    assert!(comparison.counters_not_judged.is_some());
    assert!(comparison.times_not_judged.is_none());
    for (a, b) in [(1, 2), (2, 1)] {
        let comparison = compared(&with(a, 1000), &with(b, 2000));
        // That the threads are others.
        assert_eq!(comparison.grade, Grade::Changed);
        assert!(comparison.counters_not_judged.is_some());
        assert!(comparison.times_not_judged.is_some());
    }
    // A method that takes one thread, whatever the run is told.
    let of_one = |d: &mut Document, ray_box: u64| {
        d.threads = 2;
        d.cells[1].counters["ray_box"] = ray_box.into();
    };
    let (a, b) = (changed(|d| of_one(d, 1000)), changed(|d| of_one(d, 2000)));
    assert_eq!(compared(&a, &b).grade, Grade::Regression);
}

#[test]
fn each_method_that_is_slower_is_found_and_no_other() {
    for method in ["afra2012", "nabata2013", "mora2011"] {
        let of_method = |d: &mut Document, factor| {
            let cells = d.cells.iter_mut().filter(|c| c.key.method == method);
            cells.for_each(|cell| scaled(cell, factor));
        };
        for (factor, grade) in [(1.3, Grade::Regression), (1.0 / 1.3, Grade::Improvement)] {
            let comparison = compared(&document(), &changed(|d| of_method(d, factor)));
            let name = |scene| format!("{scene}/primary/512x384/1/{method}");
            let of = |scene| (name(scene), "speed".to_owned(), grade);
            assert_eq!(findings(&comparison), [of("hall"), of("soup")]);
        }
    }
}

#[test]
fn quotients_come_from_the_samples() {
    let new = changed(|d| scaled(&mut d.cells[1], 1.25));
    let comparison = compared(&document(), &new);
    let speed = comparison.cells[1].speed.as_ref().unwrap();
    let close = |a: f64, b: f64| approx::assert_relative_eq!(a, b, max_relative = 1e-12);
    for quotient in &speed.quotients {
        let [low, high] = quotient.interval.unwrap();
        assert!(low < 0.8 && 0.8 < high && high < 0.84 && low > 0.76);
        close(quotient.quotient, 0.8);
    }
    let reference = |against| {
        let quotients = speed.quotients.iter();
        quotients
            .clone()
            .find(|q| q.against == against)
            .unwrap()
            .reference
    };
    close(reference(Against::Afra2012), 40.0 / 30.0);
    // Build high 20 + trace 15 is more than build medium 10 + trace 30? No: 35 against 40, 65.
    close(reference(Against::EmbreeTotal), 35.0 / 30.0);
    close(reference(Against::EmbreeTrace), 15.0 / 30.0);
    // The baseline is set against the first other method.
    let of_baseline = comparison.cells[0].speed.as_ref().unwrap();
    let other = Against::Cell(NABATA_IN_HALL.to_owned());
    assert!(of_baseline.quotients.iter().any(|q| q.against == other));
}

#[test]
fn a_slower_machine_is_no_slower_method() {
    let new = changed(|d| {
        for cell in &mut d.cells {
            scaled(cell, 2.0);
            let embree = cell.embree.as_mut().unwrap().samples_ms.values_mut();
            embree.flatten().for_each(|ms| *ms *= 2.0);
        }
    });
    assert_eq!(findings(&compared(&document(), &new)), []);
}

/// Memory that others use slows all our methods and not Embree; what breaks them does more.
#[test]
fn what_slows_all_methods_is_found_only_if_it_is_much() {
    let all = |factor| changed(|d| d.cells.iter_mut().for_each(|cell| scaled(cell, factor)));
    assert_eq!(findings(&compared(&document(), &all(1.3))), []);
    let comparison = compared(&document(), &all(1.6));
    assert_eq!(comparison.count(Grade::Regression), 6);
}

/// Where there is nothing else to judge by.
#[test]
fn the_only_method_of_a_batch_is_held_against_embree() {
    let only = |factor| {
        changed(|d| {
            d.cells.retain(|cell| cell.key.method == "nabata2013");
            d.cells.iter_mut().for_each(|cell| scaled(cell, factor));
        })
    };
    let slower = compared(&only(1.0), &only(1.3));
    assert_eq!(slower.count(Grade::Regression), only(1.0).cells.len());
    assert_eq!(findings(&compared(&only(1.0), &only(1.15))), []);
}

#[test]
fn times_of_another_machine_are_only_shown() {
    let slower = |change: fn(&mut Document)| {
        changed(|d| {
            scaled(&mut d.cells[1], 2.0);
            change(d);
        })
    };
    for (new, why) in [
        (slower(|d| d.machine.cpu = "other".into()), "machine.cpu"),
        (slower(|d| d.machine.isa = "avx512".into()), "machine.isa"),
        (slower(|d| d.threads = 2), "threads"),
    ] {
        let comparison = compared(&document(), &new);
        assert!(comparison.times_not_judged.as_ref().unwrap().contains(why));
        assert_eq!(comparison.grade, Grade::Changed);
        assert_eq!(findings(&comparison)[0].1, "speed");
    }
    let options = Options {
        show_times: true,
        ..Options::default()
    };
    let comparison = compare(&document(), &slower(|_| {}), &options).unwrap();
    assert_eq!(comparison.grade, Grade::Changed);
}

#[test]
fn without_the_same_embree_a_method_is_held_against_the_baseline() {
    let new = |slower: usize| {
        changed(|d| {
            d.software.embree.as_mut().unwrap().version = "4.3.0".into();
            scaled(&mut d.cells[slower], 1.3);
        })
    };
    let of_nabata = findings(&compared(&document(), &new(1)));
    assert_eq!(
        of_nabata,
        [(NABATA_IN_HALL.into(), "speed".into(), Grade::Regression)]
    );
    // Of the baseline nobody can say that it is slower; the others seem faster.
    let of_afra = findings(&compared(&document(), &new(0)));
    assert!(
        of_afra
            .iter()
            .all(|(.., grade)| *grade == Grade::Improvement)
    );
}

#[test]
fn one_repeat_is_not_judged() {
    let once = |factor: f64| {
        changed(|d| {
            for cell in &mut d.cells {
                cell.samples_ms.as_mut().unwrap().truncate(1);
                let embree = cell.embree.as_mut().unwrap().samples_ms.values_mut();
                embree.for_each(|samples| samples.truncate(1));
            }
            scaled(&mut d.cells[1], factor);
        })
    };
    let comparison = compared(&once(1.0), &once(10.0));
    assert_eq!(findings(&comparison), []);
    let speed = comparison.cells[1].speed.as_ref().unwrap();
    assert!(speed.quotients.iter().all(|q| q.interval.is_none()));
}

/// What is as fast as ever in one round was disturbed in the others.
#[test]
fn the_least_times_must_say_so_too() {
    let with = |samples: [f64; 5]| changed(|d| d.cells[1].samples_ms = Some(samples.to_vec()));
    let disturbed = with([60.0, 61.0, 29.7, 60.0, 60.0]);
    assert_eq!(findings(&compared(&document(), &disturbed)), []);
    let slower = with([60.0, 61.0, 59.0, 60.0, 60.0]);
    assert_eq!(compared(&document(), &slower).grade, Grade::Regression);
}

/// A merged file may have the methods of one batch from two runs.
#[test]
fn cells_that_did_not_take_turns_are_not_set_against_each_other() {
    let new = changed(|d| {
        let embree = d.cells[1].embree.as_mut().unwrap();
        embree.samples_ms.get_mut("high_16").unwrap()[0] += 1e-9;
        scaled(&mut d.cells[1], 1.1);
    });
    let comparison = compared(&document(), &new);
    assert_eq!(findings(&comparison), []);
    let speed = comparison.cells[1].speed.as_ref().unwrap();
    assert_eq!(speed.quotients.len(), 2);
}

#[test]
fn numbers_of_repeats_may_differ() {
    let new = changed(|d| {
        scaled(&mut d.cells[1], 1.3);
        d.cells[1].samples_ms.as_mut().unwrap().truncate(4);
        d.cells[0].samples_ms.as_mut().unwrap().truncate(3);
    });
    let found = findings(&compared(&document(), &new));
    assert_eq!(
        found,
        [(NABATA_IN_HALL.into(), "speed".into(), Grade::Regression)]
    );
}

/// A machine that others use: each time is up to half as long again, one in twenty twice as long, and
/// each batch has memory of its own speed for our methods.
#[test]
fn noise_is_no_regression() {
    let mut random = fastrand::Rng::with_seed(1);
    let mut noisy = || {
        let mut document = document();
        for batch in document.cells.chunks_mut(3) {
            let memory = 1.0 + 0.2 * random.f64();
            let mut noise = |ms: &mut f64| {
                *ms *= 1.0 + 0.5 * random.f64().powi(2);
                *ms *= if random.u32(..20) == 0 { 2.0 } else { 1.0 };
            };
            for cell in batch {
                scaled(cell, memory);
                cell.samples_ms.iter_mut().flatten().for_each(&mut noise);
                let embree = cell.embree.as_mut().unwrap().samples_ms.values_mut();
                embree.flatten().for_each(&mut noise);
            }
        }
        document
    };
    for _ in 0..100 {
        assert_eq!(findings(&compared(&noisy(), &noisy())), []);
    }
}

#[test]
fn names_have_what_tells_cells_apart() {
    let mut document = document();
    let named = |d: &Document, i: usize| Names::of(&[d]).name(&d.cells[i].key);
    assert_eq!(named(&document, 1), NABATA_IN_HALL);
    let mut other = document.cells[1].clone();
    other.key.parameters["samples"] = 50.into();
    other.key.parameters["cost"] = "sah".into();
    document.cells.push(other);
    let parameters = ["[cost=sampled,samples=100]", "[cost=sah,samples=50]"];
    assert_eq!(
        named(&document, 1),
        format!("{NABATA_IN_HALL}{}", parameters[0])
    );
    assert_eq!(
        named(&document, 6),
        format!("{NABATA_IN_HALL}{}", parameters[1])
    );
    document.cells[6].key.camera = "back".into();
    assert_eq!(
        named(&document, 6),
        NABATA_IN_HALL.replace("hall", "hall@back")
    );
    assert_eq!(named(&document, 4), NABATA_IN_HALL.replace("hall", "soup"));
    // The variant is not chosen, but found.
    let other = changed(|d| d.cells[2].key.parameters["variant"] = "random".into());
    let names = Names::of(&[&document, &other]);
    assert!(names.name(&other.cells[2].key).ends_with("/mora2011"));
}

#[test]
fn what_is_not_the_same_work_is_not_compared() {
    let refused = |change: fn(&mut Document)| {
        let new = changed(change);
        compare(&document(), &new, &Options::default())
            .unwrap_err()
            .to_string()
    };
    let message = refused(|d| d.seed = 2);
    assert!(
        message.contains("1 in the first file, 2 in the second"),
        "{message}"
    );
    let message = refused(|d| {
        d.cells[..2]
            .iter_mut()
            .for_each(|c| c.ray_hash = "?".into())
    });
    assert!(
        message.contains("in 2 cells: hall/") && message.contains(NABATA_IN_HALL),
        "{message}"
    );
    let message = refused(|d| d.cells.truncate(4));
    assert!(
        message.contains("2 cells only in the first file, the first: soup/"),
        "{message}"
    );
    assert!(message.contains("--subset"), "{message}");
    let message = refused(|d| d.cells.push(d.cells[1].clone()));
    assert!(
        message.contains("second file") && message.contains("twice"),
        "{message}"
    );
    let message = refused(|d| d.cells[0].counters["nodes"] = json!(-1.5));
    assert!(
        message.contains("counter nodes") && message.contains("found -1.5"),
        "{message}"
    );
    let message = refused(|d| d.cells.clear());
    assert!(
        message.contains("6 cells only in the first file"),
        "{message}"
    );
    let empty = changed(|d| d.cells.clear());
    let error = compare(&empty, &empty, &Options::default()).unwrap_err();
    assert_eq!(error, CompareError::NothingInCommon(None));
}

#[test]
fn a_subset_is_what_both_have() {
    let a = changed(|d| d.cells.truncate(4));
    let b = changed(|d| drop(d.cells.drain(..3)));
    let options = Options {
        subset: true,
        ..Options::default()
    };
    let comparison = compare(&a, &b, &options).unwrap();
    assert_eq!(comparison.cells.len(), 1);
    assert_eq!(comparison.cells[0].name, "soup/primary/512x384/1/afra2012");
    assert_eq!(
        (
            comparison.only_in_reference.len(),
            comparison.only_in_new.len()
        ),
        (3, 2)
    );
    let a = changed(|d| d.cells.truncate(3));
    let message = compare(&a, &b, &options).unwrap_err().to_string();
    assert!(
        message.contains("no cell in common") && message.contains("soup/"),
        "{message}"
    );
    // Rays must be the same all the same.
    let mut other = b.clone();
    other.cells[1].ray_hash = "?".into();
    assert!(compare(&b, &other, &options).is_err());
}

#[test]
fn a_comparison_is_json() {
    let new = changed(|d| d.cells[1].counters["ray_box"] = 1001.into());
    let json = serde_json::to_value(compared(&document(), &new)).unwrap();
    assert_eq!(json["grade"], "regression");
    let finding = &json["cells"][1]["findings"][0];
    let expected = json!({
        "what": "counters.ray_box", "grade": "regression", "reference": 1000, "new": 1001
    });
    assert_eq!(*finding, expected);
    let against = |cell: usize| {
        let quotients = json["cells"][cell]["speed"]["quotients"]
            .as_array()
            .unwrap();
        quotients
            .iter()
            .map(|q| q["against"].clone())
            .collect::<Vec<Value>>()
    };
    assert_eq!(against(1), ["afra2012", "embree_total", "embree_trace"]);
    assert_eq!(against(0), [NABATA_IN_HALL, "embree_total", "embree_trace"]);
}
