//! The three techniques of ray sampling as a full factorial: what each gives alone, beside the other two, and
//! how they act on each other, in time and in box tests.

use crate::cli::text::columns;
use dacrt_validate::results::{Cell, CellKey};
use dacrt_validate::statistics::{geometric_mean, median};
use serde_json::{Map, Value};

/// The techniques: the parameter, and its value without; any other is with it.
const TECHNIQUES: [(&str, &str); 3] = [("cost", "sah"), ("order", "one-ray"), ("skip", "1")];
/// All combinations; a bit for each technique.
const ALL: usize = 1 << TECHNIQUES.len();

/// What the rows mean.
pub const LEGEND: &str = "
How many times as fast, and how many times fewer ray/box tests (those of sample rays counted), for a
technique: alone: it against none; last: all three against the other two; mean: over all four pairs
that differ in it only. A pair: the gain of one where the other is there over that where it is not;
1 is none on each other. Geometric means over scenes and ray types, with the least and the greatest.
";

/// One batch by all combinations that have the other parameters in common.
struct Factorial {
    /// The columns that tell it from others: size, and other parameters that differ.
    group: (u64, String),
    /// Median milliseconds and box tests of each combination.
    times: [f64; ALL],
    tests: [f64; ALL],
}

/// What batches of one size have in common.
pub struct Group {
    /// `1024^2 rays a picture, 3 batches`.
    pub heading: String,
    /// The heads, then a row for each effect.
    pub rows: Vec<Vec<String>>,
}

/// The table; none without a batch that has all combinations.
pub fn text(cells: &[Cell]) -> Option<String> {
    let text = |group: Group| {
        format!(
            "{}\n{}\n",
            group.heading,
            columns(&group.rows, &[1, 2, 3, 4])
        )
    };
    let text: String = groups(cells).into_iter().map(text).collect();
    (!text.is_empty()).then(|| text.trim_end().to_owned() + "\n" + LEGEND)
}

/// The same for other tables; empty without a batch that has all combinations.
pub fn groups(cells: &[Cell]) -> Vec<Group> {
    let factorials = factorials(cells);
    let mut groups: Vec<&(u64, String)> = factorials.iter().map(|f| &f.group).collect();
    groups.sort();
    groups.dedup();
    let group = |group: &(u64, String)| {
        let of_group = factorials.iter().filter(|f| f.group == *group);
        let of_group: Vec<&Factorial> = of_group.collect();
        let (rays, others) = group;
        let heading = format!("{}^2 rays a picture {others}", rays.isqrt());
        Group {
            heading: format!("{}, {} batches", heading.trim_end(), of_group.len()),
            rows: rows(&of_group),
        }
    };
    groups.into_iter().map(group).collect()
}

/// The rows of one group.
fn rows(of_group: &[&Factorial]) -> Vec<Vec<String>> {
    let head = ["", "time", "[least, most]", "box tests", "[least, most]"].map(str::to_owned);
    let mut rows = vec![head.to_vec()];
    let mut row = |name: String, effect: &dyn Fn(&[f64; ALL]) -> f64| {
        let times: Vec<f64> = of_group.iter().map(|f| effect(&f.times)).collect();
        let tests: Vec<f64> = of_group.iter().map(|f| effect(&f.tests)).collect();
        let mut row = vec![name];
        for values in [times, tests] {
            let mean = geometric_mean(&values).unwrap_or(f64::NAN);
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let most = values.iter().copied().fold(0.0, f64::max);
            row.extend([format!("{mean:.2}"), format!("[{least:.2}, {most:.2}]")]);
        }
        rows.push(row);
    };
    let names = TECHNIQUES.map(|(name, _)| name);
    for (i, name) in names.iter().enumerate() {
        row(format!("{name} alone"), &|of| of[0] / of[1 << i]);
    }
    for (i, name) in names.iter().enumerate() {
        row(format!("{name} last"), &|of| {
            of[ALL - 1 - (1 << i)] / of[ALL - 1]
        });
    }
    for (i, name) in names.iter().enumerate() {
        row(format!("{name} mean"), &|of| main_effect(of, i));
    }
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        let name = format!("{} with {}", names[i], names[j]);
        row(name, &|of| interaction(of, i, j));
    }
    row("all three".to_owned(), &|of| of[0] / of[ALL - 1]);
    rows
}

/// The gain of technique `i`, whatever the others are: the geometric mean.
fn main_effect(of: &[f64; ALL], i: usize) -> f64 {
    let without = (0..ALL).filter(|set| set & 1 << i == 0);
    let gains: Vec<f64> = without.map(|set| of[set] / of[set | 1 << i]).collect();
    geometric_mean(&gains).unwrap_or(f64::NAN)
}

/// The gain of technique `i` with `j` over that without `j`: the geometric mean.
fn interaction(of: &[f64; ALL], i: usize, j: usize) -> f64 {
    let neither = (0..ALL).filter(|set| set & (1 << i | 1 << j) == 0);
    let gain = |set: usize| of[set] / of[set | 1 << i];
    let quotients: Vec<f64> = neither.map(|set| gain(set | 1 << j) / gain(set)).collect();
    geometric_mean(&quotients).unwrap_or(f64::NAN)
}

/// Batches with all combinations, of cells of ray sampling whose hits are right.
fn factorials(cells: &[Cell]) -> Vec<Factorial> {
    let is_measured = |cell: &&Cell| cell.key.method == "nabata2013" && cell.samples_ms.is_some();
    let cells: Vec<&Cell> = cells.iter().filter(is_measured).collect();
    let mut factorials: Vec<Factorial> = Vec::new();
    let none = cells.iter().filter(|cell| combination(&cell.key) == 0);
    for first in none {
        let like_first = |cell: &&&Cell| {
            cell.key.batch() == first.key.batch()
                && cell.key.precision == first.key.precision
                && others(&cell.key) == others(&first.key)
        };
        let mut found: [Option<&Cell>; ALL] = [None; ALL];
        for cell in cells.iter().filter(like_first) {
            found[combination(&cell.key)].get_or_insert(cell);
        }
        let Some(found) = all(found) else {
            continue;
        };
        let ms = |cell: &Cell| median(cell.samples_ms.as_deref().unwrap_or_default());
        let Some(times) = all(found.map(ms)) else {
            continue;
        };
        let [width, height] = first.key.resolution;
        let count = |cell: &Cell, name: &str| cell.counters[name].as_f64().unwrap_or(f64::NAN);
        let varied = cells
            .iter()
            .any(|cell| others(&cell.key) != others(&first.key));
        factorials.push(Factorial {
            group: (
                u64::from(width) * u64::from(height) * u64::from(first.key.spp),
                if varied {
                    lists(&first.key)
                } else {
                    String::new()
                },
            ),
            times,
            tests: found.map(|cell| count(cell, "ray_box") + count(cell, "sample_box")),
        });
    }
    factorials
}

/// All of them, if each is there.
fn all<T: Copy>(of: [Option<T>; ALL]) -> Option<[T; ALL]> {
    let all: Option<Vec<T>> = of.into_iter().collect();
    all?.try_into().ok()
}

/// Which techniques a cell has.
fn combination(key: &CellKey) -> usize {
    let with = |(name, without): &(&str, &str)| match key.parameters.get(*name) {
        Some(Value::String(word)) => word != without,
        Some(number) => number.as_f64() != without.parse().ok(),
        None => false,
    };
    let bits = TECHNIQUES.iter().enumerate();
    bits.map(|(i, technique)| (with(technique) as usize) << i)
        .sum()
}

/// The other parameters.
fn others(key: &CellKey) -> Map<String, Value> {
    let mut all = key.parameters.clone();
    all.retain(|name, _| TECHNIQUES.iter().all(|(technique, _)| name != technique));
    all
}

/// What the lists are, where cells differ in more than techniques.
fn lists(key: &CellKey) -> String {
    match key.parameters.get("lists") {
        Some(Value::String(lists)) => format!("(lists {lists})"),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time without, over a factor for each technique, one more for the first two together.
    fn made_up() -> [f64; ALL] {
        std::array::from_fn(|set| {
            let gain = |bits: usize, gain: f64| if set & bits == bits { gain } else { 1.0 };
            100.0 / gain(1, 2.0) / gain(2, 0.5) / gain(4, 1.25) / gain(3, 1.5)
        })
    }

    #[test]
    fn effects_of_a_product_are_its_factors() {
        let of = made_up();
        let near = |a: f64, b: f64| approx::assert_relative_eq!(a, b, max_relative = 1e-12);
        near(main_effect(&of, 2), 1.25);
        // Half of the pairs have both.
        near(main_effect(&of, 0), 2.0 * 1.5f64.sqrt());
        near(interaction(&of, 0, 1), 1.5);
        near(interaction(&of, 1, 0), 1.5);
        near(interaction(&of, 0, 2), 1.0);
    }

    #[test]
    fn a_group_has_all_kinds_of_rows() {
        let factorial = Factorial {
            group: (1 << 18, String::new()),
            times: made_up(),
            tests: [1.0; ALL],
        };
        let text = columns(&rows(&[&factorial]), &[1, 2, 3, 4]);
        let time = |name: &str| {
            let line = text.lines().find(|line| line.starts_with(name)).unwrap();
            line[name.len()..]
                .split_whitespace()
                .next()
                .unwrap()
                .to_owned()
        };
        let names = [
            "cost alone",
            "cost last",
            "order alone",
            "cost with order",
            "all three",
        ];
        assert_eq!(names.map(time), ["2.00", "3.00", "0.50", "1.50", "1.88"]);
        assert_eq!(text.lines().count(), 14, "{text}");
    }
}
