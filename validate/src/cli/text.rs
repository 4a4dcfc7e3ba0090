//! Text for people: aligned columns, and output to a pipe that may close early.

use std::io::{self, Write};

/// Writes to standard output. A reader that has gone away (`dacrt scenes | head`) is no error.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => Ok(other?),
    }
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
}
