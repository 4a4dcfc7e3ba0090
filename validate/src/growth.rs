//! How time grows with the number of rays and of triangles: curves, their exponents, and the file of
//! `dacrt bench growth`.

use crate::embree::Best;
use crate::json_file;
use crate::machine::{Machine, Software};
use crate::results::{Cell, EmbreeTimes};
use crate::statistics::median;
use anyhow::{Context, ensure};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::Path;

/// What [`Document::kind`] says. There is no `schema`, so no command takes the file for the
/// [results](crate::results) of a run.
pub const KIND: &str = "growth";

/// Embree with its fastest build and with its usual one.
pub const EMBREE: [(&str, &str); 2] = [("embree-low", "low"), ("embree-medium", "medium")];

/// All that was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Document {
    /// [`KIND`].
    pub kind: String,
    /// Where it ran.
    pub machine: Machine,
    /// What ran.
    pub software: Software,
    /// The command line, one string an argument.
    pub command: Vec<String>,
    /// Bytes that a point may take, as estimated before it.
    pub memory_limit_bytes: u64,
    /// Seconds that a point may take, as estimated from the one before it.
    pub seconds_limit: f64,
    /// Points that were not measured, and why.
    pub left_out: Vec<LeftOut>,
    /// Time against numbers, in the order in which they were measured.
    pub curves: Vec<Curve>,
    /// What the curves are made of, as in the results of a run.
    pub cells: Vec<Cell>,
}

/// Which number grows, while the other stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Grows {
    /// That of rays.
    Rays,
    /// That of triangles.
    Triangles,
}

impl Grows {
    /// `rays` or `triangles`.
    pub fn name(self) -> &'static str {
        match self {
            Grows::Rays => "rays",
            Grows::Triangles => "triangles",
        }
    }
}

/// A point that was not measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// The curves that lack it.
    pub grows: Grows,
    /// Triangles that it would have had.
    pub triangles: usize,
    /// Primary rays that it would have had.
    pub rays: usize,
    /// Names of the curves.
    pub contestants: Vec<String>,
    /// `memory` or `time`, with what it would have taken and the limit.
    pub why: String,
}

/// Times of one contestant on rays of one type.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// What grows from point to point.
    pub grows: Grows,
    /// Name of the ray type.
    pub rays: String,
    /// A method, or one of [`EMBREE`].
    pub contestant: String,
    /// With rising numbers.
    pub points: Vec<Point>,
}

/// One batch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Triangles of the scene.
    pub triangles: usize,
    /// Rays of the batch.
    pub rays: usize,
    /// Median milliseconds, of Embree build and trace by the query that is the fastest; `None` if hits
    /// were found wrong.
    pub ms: Option<f64>,
    /// Of Embree, the build in it.
    pub build_ms: Option<f64>,
    /// Of Embree, the trace in it.
    pub trace_ms: Option<f64>,
    /// Workspace of ours; of Embree its scene, known of the build whose total is the best.
    pub bytes: Option<usize>,
    /// p, if the time went with the p-th power of the number since the point before.
    pub exponent: Option<f64>,
    /// Time over n log n, over that of the first point that has a time: above 1 where time has grown
    /// faster than n log n since then.
    pub over_n_log_n: Option<f64>,
}

impl Point {
    /// The number that grows.
    pub fn number(&self, grows: Grows) -> usize {
        match grows {
            Grows::Rays => self.rays,
            Grows::Triangles => self.triangles,
        }
    }
}

/// p, if time goes with the p-th power of n between two points (n, ms).
pub fn exponent(from: (usize, f64), to: (usize, f64)) -> f64 {
    (to.1 / from.1).ln() / (to.0 as f64 / from.0 as f64).ln()
}

/// n log n.
fn n_log_n(n: usize) -> f64 {
    n as f64 * (n as f64).ln()
}

impl Curve {
    /// Fills in exponents and ratios to n log n.
    fn derive(&mut self) {
        let grows = self.grows;
        let (mut first, mut before) = (None, None);
        for point in &mut self.points {
            let n = point.number(grows);
            let Some(ms) = point.ms else { continue };
            let over = ms / n_log_n(n);
            point.over_n_log_n = Some(over / *first.get_or_insert(over));
            point.exponent = before.map(|before| exponent(before, (n, ms)));
            before = Some((n, ms));
        }
    }

    /// The exponent from the first point with a time to the last; `None` if there are not two.
    pub fn exponent(&self) -> Option<f64> {
        let timed = |point: &Point| Some((point.number(self.grows), point.ms?));
        let first = self.points.iter().find_map(timed)?;
        let last = self.points.iter().rev().find_map(timed)?;
        (first.0 != last.0).then(|| exponent(first, last))
    }

    /// The curves of cells, each of which is a point of a curve: for each ray type one for each method
    /// and for each of [`EMBREE`]. Cells stand in rising order of the number that grows.
    pub fn of(grows: Grows, cells: &[Cell]) -> Vec<Curve> {
        let mut curves: Vec<Curve> = Vec::new();
        for (i, cell) in cells.iter().enumerate() {
            let point = Point {
                triangles: cell.triangles,
                rays: cell.ray_count,
                ms: cell.median_ms,
                build_ms: None,
                trace_ms: None,
                bytes: Some(cell.workspace_bytes),
                exponent: None,
                over_n_log_n: None,
            };
            let mut add = |contestant: &str, point: Point| {
                let rays = &cell.key.rays;
                let is_it = |c: &Curve| c.rays == *rays && c.contestant == contestant;
                let place = curves.iter().position(is_it).unwrap_or_else(|| {
                    curves.push(Curve {
                        grows,
                        rays: rays.clone(),
                        contestant: contestant.to_owned(),
                        points: Vec::new(),
                    });
                    curves.len() - 1
                });
                curves[place].points.push(point);
            };
            add(&cell.key.method, point.clone());
            // The times of Embree stand in each cell of a batch that has any; those of the last count.
            let of_batch = |other: &&Cell| other.key.batch() == cell.key.batch();
            if cells[i + 1..].iter().any(|other| of_batch(&other)) {
                continue;
            }
            let times = cells
                .iter()
                .filter(of_batch)
                .find_map(|c| c.embree.as_ref());
            for (name, quality) in EMBREE {
                if times.is_some_and(|times| !times.samples_ms.contains_key(quality)) {
                    continue;
                }
                add(name, of_embree(&point, times, quality));
            }
        }
        curves.iter_mut().for_each(Curve::derive);
        curves
    }
}

/// Embree's point beside one of ours.
fn of_embree(ours: &Point, times: Option<&EmbreeTimes>, quality: &str) -> Point {
    let build_ms = times.and_then(|times| median(times.samples_ms.get(quality)?));
    let trace_ms = times.and_then(|times| {
        let traces = (times.samples_ms.iter())
            .filter(|(name, _)| name.split_once('_').is_some_and(|(of, _)| of == quality));
        // Those that were given up have fewer samples.
        let rounds = traces.clone().map(|(_, samples)| samples.len()).max()?;
        let whole = traces.filter(|(_, samples)| samples.len() == rounds);
        let medians = whole.filter_map(|(_, samples)| median(samples));
        medians.min_by(f64::total_cmp)
    });
    let best = times.and_then(|times| Best::of(&times.samples_ms));
    let is_best = best.is_some_and(|best| best.total.quality == quality);
    Point {
        ms: build_ms.zip(trace_ms).map(|(build, trace)| build + trace),
        build_ms,
        trace_ms,
        bytes: times.filter(|_| is_best).map(|times| times.bytes),
        ..ours.clone()
    }
}

/// Numbers of about half decades from the least to the most, both included.
pub fn half_decades(least: usize, most: usize) -> Vec<usize> {
    /// Numbers that are closer than this are one.
    const CLOSE: f64 = 1.25;
    let step = |i: i32| (least as f64 * 10f64.powf(f64::from(i) / 2.0)).round() as usize;
    let mut numbers: Vec<usize> = (0..)
        .map(step)
        .take_while(|&n| n as f64 * CLOSE <= most as f64)
        .collect();
    numbers.push(most);
    numbers
}

impl Document {
    /// Reads a file, plain or gzip.
    ///
    /// # Errors
    /// If it cannot be read, or is another kind of file.
    pub fn read(path: &Path) -> anyhow::Result<Document> {
        let name = path.display();
        let cannot = || format!("{name}: cannot be read");
        let bytes = std::fs::read(path).with_context(cannot)?;
        let bytes = json_file::text(bytes)
            .map_err(|(_, source)| source)
            .with_context(cannot)?;
        let what = || format!("{name}: is not a file of `dacrt bench growth`");
        let document: Document = serde_json::from_slice(&bytes).with_context(what)?;
        ensure!(document.kind == KIND, what());
        Ok(document)
    }

    /// Writes the file whole or not at all.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        json_file::write(path, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::collections::BTreeMap;

    fn curve(times: &[(usize, Option<f64>)]) -> Curve {
        let point = |&(n, ms): &(usize, Option<f64>)| Point {
            triangles: 7,
            rays: n,
            ms,
            build_ms: None,
            trace_ms: None,
            bytes: None,
            exponent: None,
            over_n_log_n: None,
        };
        let mut curve = Curve {
            grows: Grows::Rays,
            rays: "primary".into(),
            contestant: "best".into(),
            points: times.iter().map(point).collect(),
        };
        curve.derive();
        curve
    }

    #[test]
    fn a_power_has_its_exponent() {
        let ms = |n: usize| Some(0.25 * (n as f64).powf(1.5));
        let curve = curve(&[100, 1000, 5000].map(|n| (n, ms(n))));
        assert_eq!(curve.points[0].exponent, None);
        for point in &curve.points[1..] {
            assert_relative_eq!(point.exponent.unwrap(), 1.5, max_relative = 1e-12);
            assert!(point.over_n_log_n.unwrap() > 1.0);
        }
    }

    #[test]
    fn n_log_n_stays_at_one() {
        let ms = |n: usize| Some(3e-6 * n as f64 * (n as f64).ln());
        let curve = curve(&[100, 1000, 5000].map(|n| (n, ms(n))));
        for point in &curve.points {
            assert_relative_eq!(point.over_n_log_n.unwrap(), 1.0, max_relative = 1e-12);
        }
        // 1000 ln 1000 / (100 ln 100) = 15.
        let exponent = curve.points[1].exponent.unwrap();
        assert_relative_eq!(exponent, 15f64.log10(), max_relative = 1e-12);
    }

    #[test]
    fn a_point_without_time_is_passed_over() {
        let curve = curve(&[
            (10, None),
            (100, Some(1.0)),
            (1000, None),
            (10_000, Some(100.0)),
        ]);
        let exponents: Vec<_> = curve.points.iter().map(|p| p.exponent).collect();
        assert_eq!(exponents, [None, None, None, Some(1.0)]);
        assert_eq!(curve.points[1].over_n_log_n, Some(1.0));
        assert_eq!(curve.points[2].over_n_log_n, None);
        assert_relative_eq!(curve.points[3].over_n_log_n.unwrap(), 0.5);
        assert_eq!(curve.exponent(), Some(1.0));
    }

    #[test]
    fn embree_is_taken_with_its_fastest_query() {
        let samples = [
            ("low", vec![10.0, 12.0, 11.0]),
            ("medium", vec![30.0]),
            ("low_1", vec![9.0, 9.0, 9.0]),
            ("low_16", vec![8.0, 7.0, 7.5]),
            ("low_16_coherent", vec![1.0]),
            ("medium_1", vec![6.0, 5.0, 7.0]),
        ];
        let samples_ms: BTreeMap<String, Vec<f64>> =
            samples.map(|(name, ms)| (name.to_owned(), ms)).into();
        let times = EmbreeTimes {
            mode: None,
            best_ms: 18.5,
            best_trace_ms: 6.0,
            build_ms: BTreeMap::new(),
            trace_ms: BTreeMap::new(),
            samples_ms,
            trace_prepacked_ms: BTreeMap::new(),
            bytes: 4711,
        };
        let ours = &curve(&[(10, Some(1.0))]).points[0];
        let of = |quality| {
            let p = of_embree(ours, Some(&times), quality);
            (p.ms, p.build_ms, p.trace_ms, p.bytes)
        };
        assert_eq!(of("low"), (Some(18.5), Some(11.0), Some(7.5), Some(4711)));
        assert_eq!(of("medium"), (Some(36.0), Some(30.0), Some(6.0), None));
        assert_eq!(of_embree(ours, None, "low").ms, None);
    }

    #[test]
    fn half_decades_end_with_the_most() {
        assert_eq!(half_decades(1000, 30_000), [1000, 3162, 10_000, 30_000]);
        let most = *half_decades(10_000, 16_000_000).last().unwrap();
        assert_eq!(most, 16_000_000);
        assert_eq!(half_decades(1000, 1000), [1000]);
        assert_eq!(half_decades(1000, 3162), [1000, 3162]);
    }
}
