//! Speed against error: a section a batch, a line a method and precision, then Embree's modes.

use super::lines::interval;
use crate::cli::text::{columns, counted, thousands};
use dacrt_validate::accuracy::{Batch, Tracer, batches};
use dacrt_validate::results::Document;

const LEGEND: &str = "
x fast: time over that of fast, of Embree (with its build) over that of its default mode; [95 %].
Answers that are not those of exact arithmetic, per million rays: wrong, a triangle that is not the
nearest; lost, no hit where there is one; false, a hit where there is none. within: those of them
that rounding may lead to, by the bounds of the kernel; beyond: all that it may not, t included.
edge: rays on which ours and that mode of Embree differ and rounding may lead to either answer.
Error of t, relative and in units of the last place (ulps), where the nearest triangle is hit.
";

/// The sections; `None` if the errors of no cell were counted.
pub fn text(document: &Document) -> Option<String> {
    let sections: Vec<String> = batches(document).iter().map(section).collect();
    (!sections.is_empty()).then(|| sections.join("\n") + LEGEND)
}

fn section(batch: &Batch) -> String {
    let key = batch.key;
    let [width, height] = key.resolution;
    let spp = match key.spp {
        1 => String::new(),
        spp => format!(" x{spp}"),
    };
    let judged = match batch.sample == batch.rays {
        true => format!("all {}", counted(batch.rays, "ray")),
        false => format!(
            "{} of {}",
            thousands(batch.sample),
            counted(batch.rays, "ray")
        ),
    };
    let mut text = format!(
        "{} {} {width}x{height}{spp}: {judged} judged; none is at most {} per million (95 %)\n",
        key.scene,
        key.rays,
        rate(batch.none_means()),
    );
    let heads = [
        "", "ms", "x fast", "wrong", "lost", "false", "within", "beyond", "edge",
    ];
    let counts = |tracer: &Tracer| {
        let errors = tracer.errors;
        let per_million = |count: u64| rate(batch.per_million(count));
        let edge = |n: u64| rate(n as f64 * 1e6 / batch.rays as f64);
        vec![
            tracer.who.to_string(),
            tracer.ms.map_or("-".to_owned(), short),
            tracer.over_fast.map_or(String::new(), interval),
            per_million(errors.wrong),
            per_million(errors.lost),
            per_million(errors.false_hits),
            per_million(errors.within_bounds),
            per_million(errors.beyond_bounds),
            tracer.edge.map_or(String::new(), edge),
        ]
    };
    text += &table(
        &heads,
        batch.tracers.iter().map(counts),
        &[1, 3, 4, 5, 6, 7, 8],
    );
    let heads = ["t", "99.9 %", "greatest", "99.9 % ulps", "greatest ulps"];
    let distances = |tracer: &Tracer| {
        let t = &tracer.errors.t;
        Some(vec![
            tracer.who.to_string(),
            format!("{:.1e}", t.p999_relative?),
            format!("{:.1e}", t.max_relative?),
            short(t.p999_ulps?),
            short(t.max_ulps?),
        ])
    };
    let rows: Vec<Vec<String>> = batch.tracers.iter().filter_map(distances).collect();
    if !rows.is_empty() {
        text += &table(&heads, rows.into_iter(), &[1, 2, 3, 4]);
    }
    text
}

fn table(heads: &[&str], rows: impl Iterator<Item = Vec<String>>, right: &[usize]) -> String {
    let heads: Vec<String> = heads.iter().map(|head| head.to_string()).collect();
    let rows: Vec<Vec<String>> = std::iter::once(heads).chain(rows).collect();
    columns(&rows, right)
}

/// A number of a million, at most five columns: `0`, `0.35`, `2.9`, `120`, `2e5`.
fn rate(x: f64) -> String {
    match x {
        0.0 => "0".to_owned(),
        _ if x < 0.995 => format!("{x:.2}"),
        _ if x < 9.95 => format!("{x:.1}"),
        _ if x < 99_999.5 => format!("{x:.0}"),
        _ => format!("{x:.0e}"),
    }
}

/// Three digits that count, at most five columns: `0.500`, `3.25`, `48.1`, `1610`, `1e6`.
fn short(x: f64) -> String {
    match x {
        _ if x < 0.9995 => format!("{x:.3}"),
        _ if x < 9.995 => format!("{x:.2}"),
        _ if x < 99.95 => format!("{x:.1}"),
        _ => rate(x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_five_columns_at_most() {
        let numbers = [0.0, 0.35, 0.9, 2.86, 17.2, 99_999.4, 123_456.0];
        let expected = ["0", "0.35", "0.90", "2.9", "17", "99999", "1e5"];
        assert_eq!(numbers.map(rate), expected);
        let expected = ["0.000", "0.350", "0.900", "2.86", "17.2", "99999", "1e5"];
        assert_eq!(numbers.map(short), expected);
    }
}
