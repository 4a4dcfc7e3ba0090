//! Text for people: aligned columns, and output to a pipe that may close early.

use anyhow::Context;
use std::io::{self, Write};

/// No line of a table is longer.
pub const WIDTH: usize = 100;

/// Writes to standard output. A reader that has gone away (`dacrt scenes | head`) is no error.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other.context("cannot write to standard output"),
    }
}

/// Writes a line to standard error, if that can be written to. (`eprintln!` panics if not.)
pub fn complain(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// An error with its causes in one line. A cause that the text before it ends with is left out:
/// some errors quote their cause and name it, too.
pub fn one_line(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for message in error.chain().map(ToString::to_string) {
        if text.is_empty() {
            text = message;
        } else if !text.ends_with(&message) {
            text += &format!(": {message}");
        }
    }
    text
}

/// Pads every column to its longest entry, two spaces between; nothing stands after the last word
/// of a line. Columns whose place is in `right` are flush right.
pub fn columns(rows: &[Vec<String>], right: &[usize]) -> String {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width: Vec<usize> = (0..count)
        .map(|c| {
            let lengths = rows.iter().filter_map(|r| r.get(c));
            lengths.map(|s| s.chars().count()).max().unwrap_or(0)
        })
        .collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (c, entry) in row.iter().enumerate() {
            let gap = if c == 0 { "" } else { "  " };
            let w = width[c];
            line += &if right.contains(&c) {
                format!("{gap}{entry:>w$}")
            } else {
                format!("{gap}{entry:<w$}")
            };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// A count and what is counted: `1 ray`, `2,000 rays`. The plural has an s.
pub fn counted(n: u64, what: &str) -> String {
    let plural = if n == 1 { "" } else { "s" };
    format!("{} {what}{plural}", thousands(n))
}

/// A count with commas between the thousands.
pub fn thousands(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let row = |a: &str, b: &str, c: &str| vec![a.into(), b.into(), c.into()];
        let text = columns(&[row("a", "1", "x"), row("long", "1000", "")], &[1]);
        assert_eq!(text, "a        1  x\nlong  1000\n");
    }

    #[test]
    fn thousands_have_commas() {
        let text = [0, 999, 1_000, 1_234_567].map(thousands);
        assert_eq!(text, ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn one_is_no_plural() {
        let text = [0, 1, 2_000].map(|n| counted(n, "ray"));
        assert_eq!(text, ["0 rays", "1 ray", "2,000 rays"]);
    }

    #[test]
    fn causes_stand_once_in_an_error() {
        let read = anyhow::anyhow!("no such file").context("m.obj: cannot be read: no such file");
        assert_eq!(one_line(&read), "m.obj: cannot be read: no such file");
        let out = anyhow::anyhow!("it is a folder").context("--out");
        assert_eq!(one_line(&out), "--out: it is a folder");
    }
}
