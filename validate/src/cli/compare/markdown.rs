//! The report as a comment on a pull request.

use super::{Report, words};
use crate::cli::text::counted;
use dacrt_validate::compare::{CellComparison, Grade};

/// Rows of one table: GitHub takes no comment of more than 65,536 characters.
const MOST_ROWS: usize = 100;

/// A headline, the regressions, and the rest to unfold.
pub fn markdown(report: &Report) -> String {
    let comparison = &report.comparison;
    let regressions = comparison.count(Grade::Regression);
    let cells = counted(comparison.cells.len() as u64, "cell");
    let mut text = match regressions {
        0 => format!("### dacrt compare: no regression in {cells}\n\n"),
        n => format!(
            "### dacrt compare: {} in {cells}\n\n",
            counted(n as u64, "regression")
        ),
    };
    text += &format!("{}\n\n", words::counts(comparison));
    if regressions > 0 {
        text += &table(comparison.of(Grade::Regression));
    }
    let others = [
        (Grade::Improvement, "Improvements"),
        (Grade::Changed, "Other changes"),
    ];
    for (grade, head) in others {
        let n = comparison.count(grade);
        if n > 0 {
            text += &details(&format!("{head} ({n})"), &table(comparison.of(grade)));
        }
    }
    let only = [
        ("reference", &comparison.only_in_reference),
        ("new file", &comparison.only_in_new),
    ];
    for (file, names) in only.into_iter().filter(|(_, names)| !names.is_empty()) {
        let list = names
            .iter()
            .take(MOST_ROWS)
            .map(|name| format!("- {}\n", code(name)));
        let head = format!("Only in the {file} ({})", names.len());
        text += &details(&head, &(list.collect::<String>() + &more(names.len())));
    }
    let mut about = String::new();
    for (which, origin) in [
        ("Reference", &comparison.reference),
        ("New", &comparison.new),
    ] {
        about += &format!("- {which}: {}\n", escaped(&words::origin(origin)));
    }
    let reasons = words::not_judged(comparison).into_iter();
    about.extend(reasons.map(|reason| format!("- {}\n", escaped(&reason))));
    text + &details("What was compared", &about)
}

fn table<'a>(cells: impl Iterator<Item = &'a CellComparison>) -> String {
    let rows: Vec<String> = cells
        .flat_map(|cell| words::rows(cell).into_iter().map(move |row| (cell, row)))
        .map(|(cell, [what, before, after, change])| {
            let name = code(&cell.name);
            let change = escaped(&change);
            format!(
                "| {name} | {} | {before} | {after} | {change} |\n",
                code(&what)
            )
        })
        .collect();
    let head = "| cell | what | reference | new | change |\n|---|---|---:|---:|---|\n";
    let shown: String = rows.iter().take(MOST_ROWS).map(String::as_str).collect();
    format!("{head}{shown}{}\n", more(rows.len()))
}

fn more(rows: usize) -> String {
    match rows.saturating_sub(MOST_ROWS) {
        0 => String::new(),
        n => format!("\n… and {n} more\n"),
    }
}

fn details(head: &str, content: &str) -> String {
    format!("<details><summary>{head}</summary>\n\n{content}\n</details>\n\n")
}

/// As code within a table, whatever is in it.
fn code(text: &str) -> String {
    let plain = text.replace('`', "'").replace(['\n', '\r'], " ");
    format!("`{}`", plain.replace('|', "\\|"))
}

/// As plain text within a table.
fn escaped(text: &str) -> String {
    let mut plain = String::new();
    for c in text.chars() {
        match c {
            '\n' | '\r' => plain.push(' '),
            '<' => plain += "&lt;",
            '|' | '*' | '_' | '`' | '[' | ']' | '\\' => plain.extend(['\\', c]),
            c => plain.push(c),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_a_table() {
        assert_eq!(code("a|b`c\nd"), "`a\\|b'c d`");
        assert_eq!(escaped("x_y <b> [1]"), "x\\_y &lt;b> \\[1\\]");
    }

    #[test]
    fn long_tables_are_cut() {
        assert_eq!(more(MOST_ROWS), "");
        assert_eq!(more(MOST_ROWS + 7), "\n… and 7 more\n");
    }
}
