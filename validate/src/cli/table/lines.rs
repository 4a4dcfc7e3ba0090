//! The table that `run` prints: a section for each scene and ray type as soon as it is measured,
//! geometric means at the end. 100 columns at most.

use crate::cli::text::thousands;
use dacrt_validate::results::{Cell, PeerTimes};
use dacrt_validate::statistics::{Ratio, geometric_mean};

/// One line: one cell.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub method: String,
    /// Parameter values that tell this cell from its neighbours; may be empty.
    pub label: String,
    /// Whether the validation failed; then there are no times.
    pub wrong: bool,
    pub mrays_per_s: Option<f64>,
    pub acceleration: Option<Ratio>,
    pub embree_total: Option<f64>,
    pub embree_trace: Option<f64>,
    /// Rays on which ours and an Embree mode differ.
    pub differing: u64,
    /// Rays for which our answer is wrong.
    pub bad: u64,
    /// How many rays, and of how many, the printed rule of termination gets wrong, if it was used.
    pub printed_rule: Option<(u64, u64)>,
    /// Other libraries.
    pub peers: Vec<Peer>,
}

/// A library at its best over our method.
#[derive(Clone, Debug, PartialEq)]
pub struct Peer {
    pub name: String,
    /// Least median build + median trace of its builders over our time.
    pub total: f64,
    /// Least median trace over our time.
    pub trace: f64,
}

impl Peer {
    /// All libraries of a cell, in the order of its entries.
    fn all(cell: &Cell) -> Vec<Peer> {
        let Some(ours) = cell.median_ms else {
            return Vec::new();
        };
        let of_name = |builders: &[PeerTimes]| {
            let least = |time: fn(&PeerTimes) -> f64| {
                builders.iter().map(time).fold(f64::INFINITY, f64::min) / ours
            };
            Peer {
                name: builders[0].name.clone(),
                total: least(|peer| peer.build_ms + peer.trace_ms),
                trace: least(|peer| peer.trace_ms),
            }
        };
        let by_name = cell.peers.chunk_by(|a, b| a.name == b.name);
        by_name.map(of_name).collect()
    }
}

impl Row {
    /// The line of a cell; `label` tells it from the other cells of its method.
    pub fn new(cell: &Cell, label: &str) -> Row {
        let acceleration = cell.acceleration_ratio.zip(cell.acceleration_interval);
        Row {
            method: cell.key.method.clone(),
            label: label.to_owned(),
            wrong: cell.is_wrong(),
            mrays_per_s: cell.mrays_per_s,
            acceleration: acceleration.map(|(ratio, interval)| Ratio { ratio, interval }),
            embree_total: cell.ratio_embree_total,
            embree_trace: cell.ratio_embree_trace,
            differing: cell.diff.differing,
            bad: cell.diff.wrong(),
            printed_rule: cell.printed_rule_wrong.map(|n| (n, cell.ray_count as u64)),
            peers: Peer::all(cell),
        }
    }

    /// The lines under the row: what tells it from others of its method, and what was found.
    fn notes(&self) -> String {
        let mut text = label_line(&self.label) + &peer_line(&self.peers);
        if let Some((wrong, rays)) = self.printed_rule {
            let (wrong, rays) = (thousands(wrong), thousands(rays));
            text += &label_line(&format!(
                "wrong by the printed rule: {wrong} of {rays} rays"
            ));
        }
        text
    }
}

/// The column heads, to be printed once.
pub fn heads() -> String {
    format!(
        "{:<17}{:<18}{:<15}{:>7}  {:<18}{:>12}{:>11}\n{:<57}  {:<18}{:>6}{:>6}{:>11}\n{}\n",
        "scene",
        "rays",
        "method",
        "Mrays/s",
        "vs afra2012",
        "vs Embree",
        "diff",
        "",
        "ratio [95 %]",
        "total",
        "trace",
        "bad/differ",
        "-".repeat(100),
    )
}

/// What the columns mean, to be printed under the table.
pub const LEGEND: &str = "
vs afra2012, vs Embree: how many times as fast as that. total: with Embree's build; trace: without.
diff: rays whose hit is wrong / rays on which Embree differs, most often by float32 rounding where
triangles meet. 0/5 is good, 1/5 a finding. More: dacrt run --help
";

/// What the lines of other libraries mean.
pub const PEER_LEGEND: &str = "\
vs another library: how many times as fast as that, at the best of its builders; total: with its
build; trace: without. How many of its hits are not ours is in the result file (`differing_rays`).
";

/// The lines of one batch, slowest method first so that a loss is not overlooked.
pub fn section(scene: &str, rays: &str, rows: &[Row]) -> String {
    let mut order: Vec<&Row> = rows.iter().collect();
    // A cell without times comes before all others.
    order.sort_by(|a, b| {
        let speed = |r: &Row| r.mrays_per_s.unwrap_or(0.0);
        speed(a).total_cmp(&speed(b))
    });
    let scene = shortened(scene);
    let mut text = String::new();
    for row in order {
        let acceleration = row.acceleration.map_or("-".into(), interval);
        let diff = part(row.bad, row.differing);
        text += &format!(
            "{scene:<17}{rays:<18}{:<15}{:>7}  {acceleration:<18}{:>6}{:>6}{diff:>11}",
            row.method,
            if row.wrong {
                "WRONG".into()
            } else {
                number(row.mrays_per_s)
            },
            number(row.embree_total),
            number(row.embree_trace),
        );
        text.push('\n');
        text += &row.notes();
    }
    text
}

/// Geometric means over the cells of each ray type, method and combination of parameters.
#[derive(Default)]
pub struct Means(Vec<(String, Vec<Row>)>);

impl Means {
    /// Takes a cell in.
    pub fn add(&mut self, rays: &str, row: &Row) {
        let same = |(r, rows): &&mut (String, Vec<Row>)| {
            r == rays && (&rows[0].method, &rows[0].label) == (&row.method, &row.label)
        };
        match self.0.iter_mut().find(same) {
            Some((_, rows)) => rows.push(row.clone()),
            None => self.0.push((rays.to_owned(), vec![row.clone()])),
        }
    }

    /// Whether there are other libraries.
    pub fn has_peers(&self) -> bool {
        let mut rows = self.0.iter().flat_map(|(_, rows)| rows);
        rows.any(|row| !row.peers.is_empty())
    }

    /// The lines, in the columns of the table; empty if there is nothing to average over.
    pub fn text(&self) -> String {
        if self.0.iter().all(|(_, rows)| rows.len() < 2) {
            return String::new();
        }
        let mut text = "\ngeometric means\n".to_owned();
        for (rays, rows) in &self.0 {
            let mean = |value: fn(&Row) -> Option<f64>| {
                let values: Vec<f64> = rows.iter().filter_map(value).collect();
                number(geometric_mean(&values))
            };
            text += &format!(
                "{:<17}{rays:<18}{:<15}{:>7}  {:<18}{:>6}{:>6}\n",
                format!("{} cells", rows.len()),
                rows[0].method,
                mean(|r| r.mrays_per_s),
                mean(|r| r.acceleration.map(|a| a.ratio)),
                mean(|r| r.embree_total),
                mean(|r| r.embree_trace),
            );
            text += &label_line(&rows[0].label);
            text += &peer_line(&mean_peers(rows));
        }
        text
    }
}

/// The geometric means of the libraries that all rows have.
fn mean_peers(rows: &[Row]) -> Vec<Peer> {
    let mean = |first: &Peer| {
        let of_name = |row: &Row| row.peers.iter().find(|p| p.name == first.name).cloned();
        let all: Vec<Peer> = rows.iter().map(of_name).collect::<Option<_>>()?;
        let mean =
            |value: fn(&Peer) -> f64| geometric_mean(&all.iter().map(value).collect::<Vec<_>>());
        Some(Peer {
            name: first.name.clone(),
            total: mean(|p| p.total)?,
            trace: mean(|p| p.trace)?,
        })
    };
    rows[0].peers.iter().filter_map(mean).collect()
}

/// `vs obvhs 1.23/0.88, bvh 12.3/9.87` under a row; empty without libraries.
fn peer_line(peers: &[Peer]) -> String {
    if peers.is_empty() {
        return String::new();
    }
    let text = |peer: &Peer| {
        let (total, trace) = (number(Some(peer.total)), number(Some(peer.trace)));
        format!("{} {total}/{trace}", peer.name)
    };
    let texts: Vec<String> = peers.iter().map(text).collect();
    label_line(&format!("vs {} (total/trace)", texts.join(", ")))
}

/// A line under a row.
fn label_line(label: &str) -> String {
    match label {
        "" => String::new(),
        _ => format!("{:35}  {label}\n", ""),
    }
}

/// A ratio, and where its interval lies: `1.23 [1.17, 1.27]`, `<` if below 1. 18 columns.
pub fn interval(r: Ratio) -> String {
    let [low, high] = r.interval;
    // As many digits for all three.
    let digits = match r.ratio.max(high) {
        x if x < 9.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    let show = |x: f64| format!("{x:.digits$}");
    if low == high {
        return show(r.ratio);
    }
    let mark = if high < 1.0 { "<" } else { "" };
    format!("{} [{}, {}]{mark}", show(r.ratio), show(low), show(high))
}

/// A count of a count: `0/1,234`; rounded where that takes more than ten columns: `1.2M/33M`.
fn part(some: u64, all: u64) -> String {
    let exact = format!("{}/{}", thousands(some), thousands(all));
    match exact.len() {
        ..=10 => exact,
        _ => format!("{}/{}", rounded(some), rounded(all)),
    }
}

/// At most four columns below 10⁹: `9999`, `12k`, `1.2M`.
fn rounded(n: u64) -> String {
    match n {
        ..10_000 => n.to_string(),
        10_000..999_500 => format!("{:.0}k", n as f64 / 1e3),
        999_500..9_950_000 => format!("{:.1}M", n as f64 / 1e6),
        _ => format!("{:.0}M", n as f64 / 1e6),
    }
}

/// At most five digits, three that count where there are any.
fn number(x: Option<f64>) -> String {
    match x {
        None => "-".to_owned(),
        Some(x) if x < 0.1 => format!("{x:.3}"),
        Some(x) if x < 100.0 => format!("{x:.2}"),
        Some(x) => format!("{x:.0}"),
    }
}

/// A scene's name, cut to its column: that of a user's own file may be of any length.
fn shortened(scene: &str) -> String {
    match scene.char_indices().nth(16) {
        None => scene.to_owned(),
        Some(_) => scene.chars().take(15).chain(['…']).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: &str, mrays: f64, acceleration: Ratio) -> Row {
        Row {
            method: method.into(),
            mrays_per_s: Some(mrays),
            acceleration: Some(acceleration),
            embree_total: Some(0.123),
            embree_trace: Some(0.1),
            differing: 1_234_567,
            bad: 0,
            ..Row::default()
        }
    }

    fn slow_peer(name: &str) -> Peer {
        Peer {
            name: name.to_owned(),
            total: 12.345,
            trace: 0.0123,
        }
    }

    #[test]
    fn no_line_is_over_100_columns() {
        let wide = Ratio {
            ratio: 10.25,
            interval: [10.12, 10.55],
        };
        let wrong = Row {
            bad: 1_234_567,
            printed_rule: Some((1_234_567, 16_777_216)),
            peers: ["obvhs", "bvh"].map(slow_peer).to_vec(),
            ..row("mora2011-random", 1.0, wide)
        };
        let rows = [row("mora2011-random", 12_345.6, wide), wrong];
        let text = heads()
            + &section("sanmiguel-tables", "ambient-occlusion", &rows)
            + &section("a name of a user's own", "primary", &rows)
            + LEGEND
            + PEER_LEGEND;
        assert!(text.contains("\nsanmiguel-tables ambient-occlusion mora2011-random "));
        assert!(text.contains(" 10.2 [10.1, 10.6] "), "{text}");
        assert!(text.contains(" 1.2M/1.2M\n"), "{text}");
        assert!(text.contains("wrong by the printed rule: 1,234,567 of 16,777,216 rays\n"));
        assert!(text.contains("\na name of a use… primary "));
        for line in text.lines() {
            assert!(line.chars().count() <= 100, "{line}");
        }
    }

    #[test]
    fn wrong_cells_come_first_then_the_slowest() {
        let even = Ratio {
            ratio: 1.0,
            interval: [1.0, 1.0],
        };
        let wrong = Row {
            method: "wrong".into(),
            wrong: true,
            bad: 3,
            ..Row::default()
        };
        let slower = Ratio {
            ratio: 0.8,
            interval: [0.7, 0.9],
        };
        let rows = [row("fast", 2.0, even), wrong, row("slow", 1.0, slower)];
        let text = section("hall", "primary", &rows);
        let order: Vec<_> = text
            .lines()
            .map(|l| l.split_whitespace().nth(2).unwrap())
            .collect();
        assert_eq!(order, ["wrong", "slow", "fast"]);
        assert!(text.lines().next().unwrap().contains("WRONG"));
        assert!(text.contains("0.80 [0.70, 0.90]<"));
    }

    #[test]
    fn counts_are_rounded_only_where_they_are_long() {
        assert_eq!(part(0, 0), "0/0");
        assert_eq!(part(0, 999_999), "0/999,999");
        assert_eq!(part(0, 1_234_567), "0/1.2M");
        assert_eq!(part(12_345, 999_999), "12k/1.0M");
        assert_eq!(part(9_999, 33_000_000), "9999/33M");
    }

    #[test]
    fn a_library_is_at_its_best() {
        let even = Ratio {
            ratio: 1.0,
            interval: [1.0, 1.0],
        };
        let peers = vec![slow_peer("obvhs")];
        let with_peers = Row {
            peers,
            ..row("best", 1.0, even)
        };
        let text = section("hall", "primary", std::slice::from_ref(&with_peers));
        assert!(
            text.ends_with("  vs obvhs 12.35/0.012 (total/trace)\n"),
            "{text}"
        );
        let mut means = Means::default();
        means.add("primary", &with_peers);
        assert!(means.has_peers());
        means.add("primary", &row("best", 1.0, even));
        assert!(!means.text().contains("obvhs"), "not all cells have it");
    }

    #[test]
    fn means_are_geometric() {
        let mut means = Means::default();
        for value in [1.0, 4.0] {
            means.add(
                "primary",
                &row(
                    "nabata2013",
                    value,
                    Ratio {
                        ratio: value,
                        interval: [value, value],
                    },
                ),
            );
        }
        let line = means.text();
        let line = line.lines().last().unwrap();
        assert_eq!(
            line.split_whitespace().collect::<Vec<_>>(),
            [
                "2",
                "cells",
                "primary",
                "nabata2013",
                "2.00",
                "2.00",
                "0.12",
                "0.10"
            ]
        );
    }
}
