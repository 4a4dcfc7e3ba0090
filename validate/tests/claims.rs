//! Verdicts on the papers' claims, of cells with made-up times.

use dacrt::Method;
use dacrt_validate::claims::{Claims, Evidence, Finding, Verdict, verdicts};
use dacrt_validate::parameters::own_fields;
use dacrt_validate::results::{Cell, CellKey, Document};
use std::path::Path;

/// Any results, for what does not matter here.
fn template() -> Document {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../results/ci.json.gz");
    Document::read(&path).unwrap()
}

/// The cells of a batch of Sibenik at the largest size, by both methods, so that this is the acceleration
/// ratio; none: without rays.
fn batch(template: &Cell, camera: &str, rays: &str, ratio: Option<f64>) -> Vec<Cell> {
    let of = |(method, ms): (Method, Option<f64>)| Cell {
        key: CellKey {
            scene: "sibenik".to_owned(),
            camera: camera.to_owned(),
            resolution: [512, 512],
            spp: 64,
            rays: rays.to_owned(),
            method: method.name().to_owned(),
            precision: "fast".to_owned(),
            parameters: own_fields(method, &method.parameters()),
        },
        ray_count: ms.map_or(0, |_| 1000),
        samples_ms: ms.map(|ms| vec![ms; 3]),
        median_ms: ms,
        ..template.clone()
    };
    let times = [
        (Method::Afra2012, ratio.map(|ratio| 10.0 * ratio)),
        (Method::Nabata2013, ratio.map(|_| 10.0)),
    ];
    times.map(of).into()
}

/// A picture in which everything has this acceleration ratio.
fn picture(template: &Cell, camera: &str, ratio: f64, reflects: bool) -> Vec<Cell> {
    [
        batch(template, camera, "primary", Some(ratio)),
        batch(template, camera, "reflection", reflects.then_some(ratio)),
        batch(template, camera, "shadow-point", Some(ratio)),
    ]
    .concat()
}

fn finding(id: &str, documents: Vec<Document>) -> Finding {
    let claims = Claims::load(Some(&[id.to_owned()])).unwrap();
    let evidence = Evidence {
        documents,
        ..Evidence::default()
    };
    verdicts(&claims, &evidence).remove(0)
}

/// Seeds 1 to 10, each with the scene's own camera and one of others.
fn seeds(own: f64, others: [f64; 10]) -> Vec<Document> {
    let template = template();
    let cell = &template.cells[0];
    let document = |(i, ratio): (usize, f64)| {
        let other = picture(cell, &format!("generated-{}", i + 1), ratio, false);
        Document {
            seed: i as u64 + 1,
            cells: [picture(cell, "nave", own, true), other].concat(),
            ..template.clone()
        }
    };
    others.into_iter().enumerate().map(document).collect()
}

/// Cameras that see nothing that mirrors were once left out of the range.
#[test]
fn a_picture_without_reflections_is_whole() {
    let others = [1.2, 1.3, 1.4, 1.5, 1.7, 1.6, 1.5, 1.4, 1.3, 1.2];
    let found = finding("C11", seeds(1.45, others));
    assert_eq!(found.verdict, Verdict::Contradicted);
    let [low, high] = found.effect.unwrap().interval.unwrap();
    assert!(low < 1.21 && high > 1.64, "{low} {high}");
}

/// The scene's own camera has all seeds, and once counted as often.
#[test]
fn a_range_over_cameras_has_each_once() {
    let found = finding("C11", seeds(1.9, [1.2; 10]));
    // One of eleven is 1.9: the quantile 0.95 is halfway between it and the next.
    let [low, high] = found.effect.unwrap().interval.unwrap();
    assert!((low - 1.2).abs() < 1e-12 && high < 1.56, "{low} {high}");
}

#[test]
fn a_range_needs_five_cameras_with_whole_pictures() {
    let mut documents = seeds(1.5, [1.5; 10]);
    documents.truncate(3);
    let found = finding("C11", documents);
    assert_eq!(found.verdict, Verdict::NotTestable);
    assert!(found.why.contains("of 4 cameras"), "{}", found.why);
}
