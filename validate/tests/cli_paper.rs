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
    let bounces: Vec<String> = (1..=7).map(|n| format!("diffuse-{n}")).collect();
    let of = |scene| {
        let of_fig8 = [
            [scene, "primary", "mora2011"],
            [scene, "primary", "mora2011-cones"],
            [scene, "shadow-point", "mora2011-cones"],
        ];
        let paths = bounces
            .iter()
            .map(|bounce| [scene, bounce.as_str(), "mora2011-random"]);
        of_fig8.into_iter().chain(paths).collect::<Vec<_>>()
    };
    assert_eq!(names, [of("tiny"), of("hall")].concat());
    for (scene, cells) in cells.chunks(10).enumerate() {
        let [basic, cones, light, paths @ ..] = cells else {
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
        let shaded = ms(basic) + basic["shade_ms"].as_f64().unwrap();
        near(number(&text, &format!("{name} basic"), 0, 3), 1e3 / shaded);
        near(
            number(&text, &format!("{name} basic"), 0, 4),
            count(basic, "ray_box"),
        );
        near(number(&text, "cones ", scene, 1), 1e3 / ms(cones));
        near(
            number(&text, "cones ", scene, 6),
            count(cones, "ray_triangle"),
        );
        // Both batches of a picture with shadows together.
        let both = |key| count(cones, key) + count(light, key);
        near(
            number(&text, "cones, 1 light", scene, 3),
            1e3 / (ms(cones) + ms(light)),
        );
        near(number(&text, "cones, 1 light", scene, 6), both("cone_box"));
        near(number(&text, "cones, 1 light", scene, 9), both("nodes"));
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
        // Figs. 6 and 14, whose rows for scenes that the paper does not have come last: `- - - - tiny`,
        // triangles, fps, shaded, `[` and `]` with the ratio.
        for figure in [0, 1] {
            let line = format!("- - - - {name}");
            near(number(&text, &line, figure, 6), 1e3 / ms(cones));
            let theirs = 1.0 / cones["ratio_embree_trace"].as_f64().unwrap();
            let printed = number(&text, &line, figure, 8);
            assert!((printed - theirs).abs() <= 0.0051, "{printed} {theirs}");
        }
        // Fig. 10.
        let sum = |of: &dyn Fn(&Value) -> f64| paths.iter().map(of).sum::<f64>();
        let rays = sum(&|cell| cell["ray_count"].as_f64().unwrap());
        let rate = rays / 1e3 / sum(&|cell| cell["median_ms"].as_f64().unwrap_or(0.0));
        near(number(&text, name, 2, 3), rate);
    }
    assert!(
        text.contains("Fig. 6") && text.contains("Fig. 14"),
        "{text}"
    );
    assert!(text.contains("Erw6"), "{text}");

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

#[test]
fn pictures_are_sums_of_their_batches() {
    const PAPER: &str = "paper nabata2013 --scenes sibenik --resolution 16 --repeats 2 --cameras 1 \
                         --meshes . --out out.json";
    let folder = Folder::new();
    folder.write_nave();
    let run = folder.dacrt(PAPER);
    let text = run.exits(0).stdout();
    assert_eq!(run.stderr(), "");
    for line in text.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
    assert!(
        text.contains("primary, reflection, shadow-area; sibenik, camera aisle and another one"),
        "{text}"
    );
    assert!(
        text.contains("not measured: the paper does not say which scene"),
        "{text}"
    );
    assert!(
        text.contains("not measured: no mesh of conference"),
        "{text}"
    );

    let cells = folder.json("out.json")["cells"].take();
    let cells = cells.as_array().unwrap();
    // Three of ours with three batches each, one made with the four that they have together; four sizes,
    // two methods; the ablation.
    assert_eq!(cells.len(), (3 * 3 + 4) * 4 * 2 + 3 * 3);
    let sum = |camera: &str, spp: u64, method: &str, counters: &[&str]| -> f64 {
        let of_picture = cells.iter().filter(|cell| {
            cell["camera"] == camera && cell["spp"] == spp && cell["method"] == method
        });
        let counts = of_picture.flat_map(|cell| {
            counters
                .iter()
                .map(|&name| cell["counters"][name].as_f64().unwrap())
        });
        counts.sum()
    };
    let boxes = ["ray_box", "sample_box"];
    for (row, spp) in [1, 4, 16].into_iter().enumerate() {
        let of = |method, counters: &[&str]| sum("nave", spp, method, counters);
        let quotient = |counters: &[&str]| of("afra2012", counters) / of("nabata2013", counters);
        let size = (16 << row).to_string();
        let near = |column: usize, exact: f64| {
            let printed = number(&text, &size, 0, column);
            assert!(
                (printed - exact).abs() <= 0.0051,
                "{printed} {exact}\n{text}"
            );
        };
        near(2, [1.41, 1.515, 1.594][row]);
        // `1.41`, `[1.40,` and `1.42]` are three words.
        near(7, quotient(&boxes));
        near(8, quotient(&["ray_triangle"]));
    }
    for words in [
        "cost of eq. 2 alone",
        "order by samples alone",
        "all three",
        "Fig. 4 (c) Sibenik",
    ] {
        assert!(
            text.lines().any(|line| line.starts_with(words)),
            "{words}\n{text}"
        );
    }

    let again = folder.dacrt(&format!("{PAPER} --resume")).exits(0).stdout();
    assert_eq!(again, text);
    let from = folder.dacrt("paper nabata2013 --from out.json");
    let from = from.exits(0).stdout();
    assert!(text.starts_with(&from), "{from}");

    let quick = "paper nabata2013 --quick --resolution 8 --meshes . --out quick.json";
    let run = folder.dacrt(quick);
    let text = run.exits(0).stdout();
    assert!(run.stderr().contains("left out: scene conference:"));
    assert_eq!(number(&text, "16 ", 0, 0), 16.0);
    assert!(!text.contains("another one"), "{text}");
    let cells = folder.json("quick.json")["cells"].take();
    assert_eq!(cells.as_array().unwrap().len(), 3 * 3 * 2 * 2 + 3 * 3);

    let refuses = |line: &str, words: &[&str]| {
        folder.dacrt(line).refuses(words);
    };
    refuses("paper nabata2013 --meshes nowhere", &["none of the meshes"]);
    refuses(
        "paper nabata2013 --scenes hall",
        &["--scenes", "scene of the paper", "hall"],
    );
    refuses(
        "paper nabata2013 --cameras 17",
        &["--cameras", "from 0 to 16"],
    );
    folder
        .dacrt("run --scenes ./tiny.json --rays primary --resolution 8 --repeats 1 --out out.json");
    refuses(
        "paper nabata2013 --from out.json",
        &["out.json", "Figs. 4 to 7"],
    );
}
