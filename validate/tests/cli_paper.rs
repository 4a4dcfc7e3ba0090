//! `dacrt paper`: the figures of a paper, and a result file as `run` writes it.

mod command;

use command::{Folder, SCENE};
use serde_json::Value;

const PAPER: &str = "paper mora2011 --scenes ./tiny.json,hall --resolution 64x40 --repeats 2 \
                     --out out.json";

/// The number in a column of the n-th line that begins with these words, `k` and `M` expanded.
fn number(text: &str, words: &str, nth: usize, column: usize) -> f64 {
    let matches = |line: &&str| {
        let line: Vec<&str> = line.split_whitespace().collect();
        line.join(" ").starts_with(words)
    };
    let line = text.lines().filter(matches).nth(nth).expect("a line");
    let entry = line.split_whitespace().nth(column).expect("a column");
    let (digits, factor) = match entry.split_at(entry.len() - 1) {
        (digits, "k") => (digits, 1e3),
        (digits, "M") => (digits, 1e6),
        _ => (entry, 1.0),
    };
    factor * digits.parse::<f64>().expect(line)
}

#[test]
fn figure_8_is_measured_and_printed() {
    let folder = Folder::new();
    let run = folder.dacrt(PAPER);
    let text = run.exits(0).stdout();
    assert_eq!(run.stderr(), "");
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    assert!(
        text.contains("64 x 40 pixels (Mora 2011: 1280 x 800)"),
        "{text}"
    );
    assert!(
        text.contains("27.5M-66.5M") && text.contains("3.81-26.8"),
        "{text}"
    );
    assert!(text.contains("not targets"), "{text}");

    let cells = folder.json("out.json")["cells"].take();
    let cells = cells.as_array().unwrap();
    let names: Vec<[&str; 3]> = (cells.iter())
        .map(|cell| ["scene", "rays", "method"].map(|key| cell[key].as_str().unwrap()))
        .collect();
    let of = |scene| {
        [
            [scene, "primary", "mora2011"],
            [scene, "primary", "mora2011-cones"],
            [scene, "shadow-point", "mora2011-cones"],
        ]
    };
    assert_eq!(names, [of("tiny"), of("hall")].concat());
    for (scene, cells) in cells.chunks(3).enumerate() {
        let [basic, cones, light] = cells else {
            panic!()
        };
        assert_eq!(basic["diff"]["exact"]["ours_wrong"], 0);
        let count = |cell: &Value, key: &str| cell["counters"][key].as_f64().unwrap();
        let ms = |cell: &Value| cell["median_ms"].as_f64().unwrap();
        let near = |printed: f64, exact: f64| {
            let digit = 0.006 * exact.max(0.01);
            assert!(
                (printed - exact).abs() <= digit,
                "{printed} {exact}\n{text}"
            );
        };
        let name = ["tiny", "hall"][scene];
        near(
            number(&text, &format!("{name} basic"), 0, 2),
            1e3 / ms(basic),
        );
        near(
            number(&text, &format!("{name} basic"), 0, 3),
            count(basic, "ray_box"),
        );
        near(number(&text, "cones ", scene, 1), 1e3 / ms(cones));
        near(
            number(&text, "cones ", scene, 5),
            count(cones, "ray_triangle"),
        );
        // Both batches of a picture with shadows together.
        let both = |key| count(cones, key) + count(light, key);
        near(
            number(&text, "cones, 1 light", scene, 3),
            1e3 / (ms(cones) + ms(light)),
        );
        near(number(&text, "cones, 1 light", scene, 5), both("cone_box"));
        near(number(&text, "cones, 1 light", scene, 8), both("nodes"));
        // What the cones save: the second line of the scene that begins with its name.
        let tests = |cell| count(cell, "ray_box") + count(cell, "cone_box");
        near(number(&text, name, 1, 1), tests(basic) / tests(cones));
        // It has two decimals, however little it is.
        let ratio = ms(basic) / ms(cones);
        let printed = number(&text, name, 1, 2);
        assert!((printed - ratio).abs() <= 0.0051, "{printed} {ratio}");
        let rays = basic["ray_count"].as_f64().unwrap();
        near(number(&text, name, 1, 5), count(basic, "ray_box") / rays);
        near(
            number(&text, name, 1, 6),
            basic["triangles"].as_f64().unwrap() / rays,
        );
    }

    // Nothing is measured twice, and the figure is the same.
    let again = folder.dacrt(&format!("{PAPER} --resume")).exits(0).stdout();
    assert_eq!(again, text);
    let file = &text[text.find("results: ").unwrap() + 9..].trim_end();
    let from = folder.dacrt(&format!("paper mora2011 --from {file}"));
    assert_eq!(
        from.exits(0).stdout(),
        text.replace(&format!("\nresults: {file}\n"), "")
    );
}

#[test]
fn a_result_without_the_cells_of_the_figure_is_refused() {
    let folder = Folder::new();
    let run = "run --scenes ./tiny.json --rays primary --resolution 8 --repeats 1 --out out.json";
    folder.dacrt(run).exits(0);
    folder
        .dacrt("paper mora2011 --from out.json")
        .refuses(&["out.json", "shadow-point rays"]);
}

#[test]
fn a_missing_mesh_is_a_row_that_says_so() {
    let folder = Folder::new();
    folder.write("bunny.obj.gz", command::TRIANGLE);
    let run = folder.dacrt("paper mora2011 --resolution 8 --repeats 1 --meshes . --out out.json");
    let text = run.exits(0).stdout();
    for scene in ["sibenik", "conference", "sponza"] {
        let words = [scene, "no", "mesh"];
        let says_so = |line: &&str| line.split_whitespace().eq(words);
        assert_eq!(text.lines().filter(says_so).count(), 2, "{text}");
        assert!(run.stderr().contains(&format!("left out: scene {scene}:")));
    }
    assert!(number(&text, "bunny basic", 0, 2) > 0.0);
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
}

#[test]
fn what_cannot_be_measured_is_refused() {
    let folder = Folder::new();
    let refuses = |line: &str, words: &[&str]| {
        folder.dacrt(line).refuses(words);
    };
    refuses("paper", &["<PAPER>"]);
    refuses("paper mora2012", &["mora2012", "mora2011"]);
    refuses(
        "paper mora2011 --scenes bunny --meshes nowhere",
        &["bunny.obj.gz", "nowhere"],
    );
    refuses(
        "paper mora2011 --meshes nowhere",
        &["none of the meshes", "hall"],
    );
    refuses("paper mora2011 --scenes hal", &["\"hall\""]);
    refuses(
        "paper mora2011 --scenes ./tiny.json --out .",
        &["--out", "folder"],
    );
    refuses(
        "paper mora2011 --repeats 0",
        &["--repeats", "from 1 to 1000"],
    );
    folder.write(
        "dark.json",
        SCENE.replace("{ \"type\": \"point\", \"position\": [0.5, 4, 0.5] }", ""),
    );
    refuses(
        "paper mora2011 --scenes ./dark.json",
        &["dark.json", "point light"],
    );
}

/// A picture in which nothing is hit has no shadow rays, which take no time.
#[test]
fn a_view_of_nothing_is_no_finding() {
    let folder = Folder::new();
    folder.write(
        "away.json",
        SCENE.replace("[0.5, 0.5, 0.5]", "[0.5, 0.5, 9]"),
    );
    let run = folder.dacrt("paper mora2011 --scenes ./away.json --resolution 8 --repeats 1");
    let text = run.exits(0).stdout();
    assert!(!text.contains("WRONG"), "{text}");
    let fps = |words| number(&text, words, 0, if words == "cones " { 1 } else { 3 });
    assert_eq!(fps("cones "), fps("cones, 1 light"));
}
