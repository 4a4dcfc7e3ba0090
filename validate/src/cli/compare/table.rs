//! The report at a terminal: at most 100 columns, what is worse first.

use super::{Report, words};
use crate::cli::text::{WIDTH, columns};
use dacrt_validate::compare::Grade;

/// The whole report.
pub fn table(report: &Report) -> String {
    let comparison = &report.comparison;
    let mut text = String::new();
    for (which, path, origin) in [
        ("reference", &report.args.reference, &comparison.reference),
        ("new", &report.args.new, &comparison.new),
    ] {
        text += &format!("{which:<9}  {}\n", path.display());
        text += &wrapped(&words::origin(origin), "           ", " ");
    }
    for reason in words::not_judged(comparison) {
        text += &wrapped(&reason, "", " ");
    }
    for (head, grade) in [
        ("REGRESSIONS", Grade::Regression),
        ("Improvements", Grade::Improvement),
        ("Changed", Grade::Changed),
    ] {
        if comparison.count(grade) > 0 {
            text += &format!("\n{head}\n");
        }
        for cell in comparison.of(grade) {
            text += &wrapped(&cell.name, "", ",");
            let rows = words::rows(cell).into_iter();
            let rows: Vec<Vec<String>> = rows
                .map(|[what, before, after, change]| {
                    vec![
                        format!("    {}", shortened(&what)),
                        before,
                        format!("-> {after}"),
                        change,
                    ]
                })
                .collect();
            text += &columns(&rows, &[1]);
        }
    }
    for (file, names) in [
        ("reference", &comparison.only_in_reference),
        ("new file", &comparison.only_in_new),
    ] {
        if !names.is_empty() {
            text += &format!("\nOnly in the {file}\n");
        }
        text.extend(names.iter().map(|name| wrapped(name, "", ",")));
    }
    format!("{text}\n{}\n", words::counts(comparison))
}

/// What was found, cut to what leaves room for figures: it may have the name of a cell in it.
fn shortened(what: &str) -> String {
    const MOST: usize = 40;
    match what.char_indices().nth(MOST) {
        None => what.to_owned(),
        Some((end, _)) => format!("{}…", &what[..end]),
    }
}

/// Lines of at most [`WIDTH`] columns, broken behind a separator, `indent` before each and four
/// more spaces before all but the first.
fn wrapped(text: &str, indent: &str, separator: &str) -> String {
    let mut lines = vec![indent.to_owned()];
    for word in text.split_inclusive(separator) {
        let line = lines.last_mut().expect("there is one");
        let width = (line.chars().count()) + word.trim_end().chars().count();
        if width <= WIDTH || line.trim().is_empty() {
            *line += word;
        } else {
            lines.push(format!("{indent}    {word}"));
        }
    }
    lines
        .iter()
        .map(|line| line.trim_end().to_owned() + "\n")
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_broken_at_commas() {
        let name = format!("scene/primary[{}]", ["parameter=1.25"; 12].join(","));
        let text = wrapped(&name, "", ",");
        assert!(
            text.lines().all(|line| line.len() <= WIDTH) && text.lines().count() == 3,
            "{text}"
        );
        assert_eq!(text.replace("\n    ", "").trim_end(), name);
        assert_eq!(wrapped("a b", "  ", " "), "  a b\n");
    }
}
