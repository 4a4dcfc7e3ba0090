//! `dacrt nodes`: the nodes of a trace as a table, and their plot.

mod command;

use command::Folder;
use std::collections::HashMap;

type Row = HashMap<String, String>;

fn rows(folder: &Folder, file: &str) -> Vec<Row> {
    let mut csv = csv::Reader::from_path(folder.path(file)).unwrap();
    csv.deserialize().collect::<Result<_, _>>().unwrap()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column]
        .parse()
        .unwrap_or_else(|_| panic!("{column}: {row:?}"))
}

#[test]
fn nodes_are_those_of_the_trace() {
    let folder = Folder::new();
    let nodes = "nodes ./tiny.json --resolution 64 --min-rays 100 --out nodes.csv";
    let text = folder.dacrt(nodes).exits(0).stdout();
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    let rows = rows(&folder, "nodes.csv");
    let run = "run --scenes ./tiny.json --rays primary --methods nabata2013 --resolution 64 \
               --min-rays 100 --repeats 1 --out out.json";
    folder.dacrt(run).exits(0);
    let counters = folder.json("out.json")["cells"][0]["counters"].take();
    let counted = |name: &str| counters[name].as_f64().unwrap();
    let sum = |column: &str| -> f64 {
        let cells = rows
            .iter()
            .map(|row| &row[column])
            .filter(|text| !text.is_empty());
        cells.map(|text| text.parse::<f64>().unwrap()).sum()
    };
    let of_regime = |regime: &str| rows.iter().filter(|row| row["regime"] == regime).count() as f64;
    assert_eq!(rows.len() as f64, counted("nodes"));
    assert_eq!(of_regime("leaf"), counted("leaves"));
    assert_eq!(of_regime("cost-sampled"), counted("sampled_nodes"));
    assert!(of_regime("cost-sampled") > 0.0, "{text}");
    assert_eq!(sum("ray_box"), counted("ray_box"));
    assert_eq!(sum("sample_box"), counted("sample_box"));
    let skips = counted("skips_near") + counted("skips_far");
    assert_eq!(sum("skipped_left") + sum("skipped_right"), skips);

    let by_path: HashMap<&str, &Row> = rows.iter().map(|row| (&*row["path"], row)).collect();
    assert_eq!(by_path.len(), rows.len());
    assert_eq!(number(by_path[""], "rays"), 64.0 * 64.0);
    for row in rows.iter().filter(|row| row["regime"] != "leaf") {
        assert!(number(row, "regret") >= 1.0 && number(row, "regret_by_area") >= 1.0);
        let [first, second] = match &*row["left_first"] {
            "1" => ["left", "right"],
            _ => ["right", "left"],
        };
        let child = |side: &str| format!("{}{}", row["path"], side[..1].to_uppercase());
        // Nothing has happened before the first child; rays only get lost before the second.
        let ratio = number(row, &format!("true_{first}"));
        let kept = (ratio * number(row, "rays")).round();
        let (skipped, first) = (&row[&format!("skipped_{first}")], child(first));
        match by_path.get(&*first) {
            Some(child) if skipped == "0" => assert_eq!(number(child, "rays"), kept),
            Some(child) => assert_eq!(number(child, "rays"), number(row, "rays")),
            None => assert_eq!(kept, 0.0),
        }
        assert!(number(row, "true_second") <= number(row, &format!("true_{second}")));
        // Of the samples 100 were drawn.
        if row["regime"] == "cost-sampled" {
            let estimated = 100.0 * number(row, "estimated_left");
            assert!((estimated - estimated.round()).abs() < 1e-3, "{row:?}");
        }
    }

    let plot = folder.dacrt("plot nodes nodes.csv --out nodes.svg");
    assert!(plot.exits(0).stdout().contains("nodes.svg"));
    let svg = std::fs::read_to_string(folder.path("nodes.svg")).unwrap();
    assert!(svg.contains("wrong decisions to skip") && svg.contains("<circle"));

    folder
        .dacrt("nodes ./tiny.json --resolution 64 --out nodes.npz")
        .exits(0);
    let archive = std::fs::File::open(folder.path("nodes.npz")).unwrap();
    let archive = zip::ZipArchive::new(archive).unwrap();
    let names: Vec<String> = (archive.file_names())
        .map(|name| name.unwrap().into())
        .collect();
    let has = |name: &str| names.iter().any(|other| other == name);
    assert!(has("regret.npy") && has("regime.npy"), "{names:?}");
    // The baseline and rays that stop at any hit have nodes, too.
    let of_shadows = "nodes ./tiny.json --rays shadow-point --method afra2012 --resolution 16";
    folder.dacrt(of_shadows).exits(0);
}

#[test]
fn what_has_no_nodes_is_refused() {
    let folder = Folder::new();
    let refuses = |line: &str, words: &[&str]| {
        folder.dacrt(line).refuses(words);
    };
    refuses(
        "nodes ./tiny.json --method mora2011",
        &["--method mora2011", "afra2012"],
    );
    refuses(
        "nodes ./tiny.json --out nodes.txt",
        &["--out", ".csv or .npz"],
    );
    refuses("nodes ./tiny.json --rays sideways", &["ray type"]);
    refuses("nodes ./tiny.json --camera back", &["camera", "back"]);
    folder.write("empty.csv", "");
    refuses(
        "plot nodes empty.csv --out a.svg",
        &["empty.csv", "no nodes"],
    );
    folder.write("other.csv", "a,b\n1,2\n");
    refuses(
        "plot nodes other.csv --out a.svg",
        &["other.csv", "row 1", "table of nodes"],
    );
}
