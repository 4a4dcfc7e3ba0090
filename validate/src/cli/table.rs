//! The table that `run` prints: a section for each scene and ray type as soon as it is measured,
//! geometric means at the end. 100 columns at most.

use super::text::thousands;
use dacrt_validate::results::Cell;
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
    pub unexplained: u64,
}

impl Row {
    /// The line of a cell; `label` tells it from the other cells of its method.
    pub fn new(cell: &Cell, label: &str) -> Row {
        let acceleration = cell.acceleration_ratio.zip(cell.acceleration_interval);
        Row {
            method: cell.key.method.clone(),
            label: label.to_owned(),
            // Without rays there are no times either.
            wrong: cell.mrays_per_s.is_none() && cell.ray_count > 0,
            mrays_per_s: cell.mrays_per_s,
            acceleration: acceleration.map(|(ratio, interval)| Ratio { ratio, interval }),
            embree_total: cell.ratio_embree_total,
            embree_trace: cell.ratio_embree_trace,
            differing: cell.diff.differing,
            unexplained: cell.diff.unexplained,
        }
    }
}

/// The column heads, to be printed once.
pub fn heads() -> String {
    format!(
        "{:<17}{:<18}{:<11}{:>7}  {:<20}{:>13} {:>11}\n{:<53}  {:<20}{:>7}{:>6} {:>11}\n{}\n",
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
diff: rays whose hit is not shown to be right / rays on which Embree differs, most often by float32
rounding where triangles meet. 0/5 is good, 1/5 a finding. More: dacrt run --help
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
        let acceleration = row.acceleration.map_or("-".into(), |r| {
            let [low, high] = r.interval;
            if low == high {
                return format!("{:.2}", r.ratio);
            }
            let mark = if high < 1.0 { " <" } else { "" };
            format!("{:.2} [{low:.2}, {high:.2}]{mark}", r.ratio)
        });
        let diff = format!(
            "{}/{}",
            thousands(row.unexplained),
            thousands(row.differing)
        );
        text += &format!(
            "{scene:<17}{rays:<18}{:<11}{:>7}  {acceleration:<20}{:>7}{:>6} {diff:>11}",
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
        text += &label_line(&row.label);
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
                "{:<17}{rays:<18}{:<11}{:>7}  {:<20}{:>7}{:>6}\n",
                format!("{} cells", rows.len()),
                rows[0].method,
                mean(|r| r.mrays_per_s),
                mean(|r| r.acceleration.map(|a| a.ratio)),
                mean(|r| r.embree_total),
                mean(|r| r.embree_trace),
            );
            text += &label_line(&rows[0].label);
        }
        text
    }
}

/// The line under a row whose method stands in the table with several parameters.
fn label_line(label: &str) -> String {
    match label {
        "" => String::new(),
        _ => format!("{:35}  {label}\n", ""),
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
            unexplained: 0,
            ..Row::default()
        }
    }

    #[test]
    fn no_line_is_over_100_columns() {
        let wide = Ratio {
            ratio: 10.25,
            interval: [10.12, 10.55],
        };
        let rows = [row("nabata2013", 12_345.6, wide)];
        let text = heads()
            + &section("sanmiguel-tables", "ambient-occlusion", &rows)
            + &section("a name of a user's own", "primary", &rows)
            + LEGEND;
        assert!(text.contains("\nsanmiguel-tables ambient-occlusion nabata2013 "));
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
            unexplained: 3,
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
        assert!(text.contains("0.80 [0.70, 0.90] <"));
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
