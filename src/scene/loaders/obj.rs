//! OBJ files. `tobj` reads the numbers, resolves the indices and cuts the fans; before it stands a
//! filter that hands it nothing but clean `v` and `f` lines, because `tobj` by itself
//!
//! * does not say in which line an error is,
//! * reads polylines (`l`) of three and more points as faces, skips faces of one and two corners,
//! * divides positions by a fourth number, and refuses a file over its texture coordinates,
//!   normals, colours, names or comments, which are no concern of a triangle soup,
//! * knows neither line continuation, nor comments at the end of a line, nor text in Latin-1.

use super::{MOST_TRIANGLES, Place, Problem, quote, too_many_triangles};
use crate::Triangle;
use glam::Vec3;
use std::io::{self, BufRead, Read};
use tobj::LoadError;

const OPTIONS: tobj::LoadOptions = tobj::LoadOptions {
    single_index: false,
    triangulate: true,
    ignore_points: true,
    ignore_lines: true,
};

pub(super) fn parse(bytes: &[u8]) -> Result<Vec<Triangle>, Problem> {
    let mut lines = CleanLines::new(bytes);
    // The filter lets no `mtllib` line pass, so no material is ever asked for.
    let no_materials = |_: &std::path::Path| Err(LoadError::OpenFileFailed);
    let models = match tobj::load_obj_buf(&mut lines, &OPTIONS, no_materials) {
        Ok((models, _)) => models,
        Err(error) => return Err(explain(error, lines, bytes)),
    };
    // One model: the filter lets no group, object or material line pass either.
    let mut triangles = Vec::with_capacity(lines.triangles);
    for tobj::Model { mesh, .. } in &models {
        let position = |i: u32| Vec3::from_slice(&mesh.positions[3 * i as usize..]);
        triangles.extend(
            mesh.indices
                .chunks_exact(3)
                .map(|t| Triangle::new(position(t[0]), position(t[1]), position(t[2]))),
        );
    }
    Ok(triangles)
}

/// Says where and why `tobj` gave up.
fn explain(error: LoadError, lines: CleanLines, bytes: &[u8]) -> Problem {
    if let Some(problem) = lines.problem {
        return problem;
    }
    let found = quote(lines.raw);
    let text = match error {
        LoadError::FaceVertexOutOfBounds => return first_bad_index(bytes, lines.vertices),
        LoadError::PositionParseError => {
            format!("expected three numbers after \"v\", found {found}")
        }
        LoadError::FaceParseError => {
            format!("expected whole numbers as vertex indices, found {found}")
        }
        other => format!("{other}, found {found}"),
    };
    Problem::new(Place::Line(lines.line), text)
}

/// The first face with an index out of range, in a file known to have one.
fn first_bad_index(bytes: &[u8], vertices: usize) -> Problem {
    let mut lines = CleanLines::new(bytes);
    while matches!(lines.advance(), Ok(true)) {
        let Some(corners) = lines.clean.strip_prefix(b"f") else {
            continue;
        };
        let numbers = std::str::from_utf8(corners).unwrap_or_default();
        for number in numbers.split_ascii_whitespace() {
            let in_range = match number.parse::<i64>() {
                Ok(n) if n > 0 => n as u64 <= vertices as u64,
                Ok(n) if n < 0 => n.unsigned_abs() <= lines.vertices as u64,
                _ => false,
            };
            if !in_range {
                let expected = if number.starts_with('-') {
                    format!(
                        "-{} to -1, for so many vertices stand before",
                        lines.vertices
                    )
                } else {
                    format!("1 to {vertices}, the number of vertices")
                };
                return Problem::new(
                    Place::Line(lines.line),
                    format!("expected a vertex index from {expected}, found {number}"),
                );
            }
        }
    }
    Problem::new(Place::File, "a vertex index is out of range")
}

/// The `v` and `f` lines of an OBJ file as a reader: three words after `v`; of each corner only
/// the vertex index; comments cut off, continued lines joined.
struct CleanLines<'a> {
    rest: &'a [u8],
    /// Lines of `rest` start after this many.
    lines_taken: usize,
    /// Number of the line that `clean` is made from, and that line as it stands in the file.
    line: usize,
    raw: &'a [u8],
    clean: Vec<u8>,
    /// So much of `clean` has been read.
    consumed: usize,
    vertices: usize,
    triangles: usize,
    problem: Option<Problem>,
}

impl<'a> CleanLines<'a> {
    fn new(bytes: &'a [u8]) -> CleanLines<'a> {
        CleanLines {
            rest: bytes,
            lines_taken: 0,
            line: 0,
            raw: &[],
            clean: Vec::new(),
            consumed: 0,
            vertices: 0,
            triangles: 0,
            problem: None,
        }
    }

    /// Takes a line, ended by LF, CR LF or CR.
    fn take_line(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let rest = self.rest;
        let end = rest
            .iter()
            .position(|b| matches!(b, b'\n' | b'\r'))
            .unwrap_or(rest.len());
        let skip = match &rest[end..] {
            [b'\r', b'\n', ..] => 2,
            [] => 0,
            _ => 1,
        };
        self.rest = &rest[end + skip..];
        self.lines_taken += 1;
        Some(&rest[..end])
    }

    /// Puts the next `v` or `f` line into `clean`; false at the end of the file.
    fn advance(&mut self) -> Result<bool, Problem> {
        self.clean.clear();
        self.consumed = 0;
        while let Some(line) = self.take_line() {
            let line = line.trim_ascii_start();
            let is_vertex = match line {
                [b'v', b, ..] if b.is_ascii_whitespace() => true,
                [b'f', b, ..] if b.is_ascii_whitespace() => false,
                b"v" | b"v\\" => true,
                b"f" | b"f\\" => false,
                _ => continue,
            };
            self.line = self.lines_taken;
            self.raw = line;
            let joined;
            let mut content = without_comment(line);
            if content.ends_with(b"\\") {
                joined = self.join(content);
                content = &joined;
            }
            let words = content[1..]
                .split(u8::is_ascii_whitespace)
                .filter(|w| !w.is_empty());
            if is_vertex {
                self.clean_vertex(words)?;
            } else {
                self.clean_face(words)?;
            }
            self.clean.push(b'\n');
            return Ok(true);
        }
        Ok(false)
    }

    /// A line that ends in a backslash, and those that it goes on in.
    fn join(&mut self, first: &[u8]) -> Vec<u8> {
        let mut joined = first.to_vec();
        while joined.last() == Some(&b'\\') {
            joined.pop();
            joined.push(b' ');
            match self.take_line() {
                Some(line) => joined.extend_from_slice(without_comment(line)),
                None => break,
            }
        }
        joined
    }

    fn clean_vertex<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) -> Result<(), Problem> {
        self.vertices += 1;
        self.clean.push(b'v');
        for (i, word) in words.enumerate() {
            if i < 3 {
                self.push(word)?;
            } else if str_of(word).is_none_or(|w| w.parse::<f32>().is_err()) {
                // A weight or a colour is passed over, but it must be one.
                return Err(self.problem(format!("expected a number, found {}", quote(word))));
            }
        }
        Ok(())
    }

    fn clean_face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) -> Result<(), Problem> {
        self.clean.push(b'f');
        let mut corners = 0;
        for word in words {
            let index = word.split(|&b| b == b'/').next().unwrap_or_default();
            if index.is_empty() {
                return Err(self.problem(format!(
                    "expected a vertex index in front of the slash, found {}",
                    quote(word)
                )));
            }
            self.push(index)?;
            corners += 1;
        }
        if corners < 3 {
            return Err(self.problem(format!(
                "expected a face of three corners or more, found {corners} in {}",
                quote(self.raw)
            )));
        }
        self.triangles += corners - 2;
        if self.triangles > MOST_TRIANGLES {
            return Err(self.problem(too_many_triangles()));
        }
        Ok(())
    }

    fn push(&mut self, word: &[u8]) -> Result<(), Problem> {
        // Whatever `tobj` may take for white space must not be inside a word.
        let Some(word) = str_of(word) else {
            return Err(self.problem(format!("expected plain text, found {}", quote(word))));
        };
        self.clean.push(b' ');
        self.clean.extend_from_slice(word.as_bytes());
        Ok(())
    }

    fn problem(&self, text: String) -> Problem {
        Problem::new(Place::Line(self.line), text)
    }
}

/// The word, if it is of printable ASCII characters.
fn str_of(word: &[u8]) -> Option<&str> {
    let plain = word.iter().all(u8::is_ascii_graphic);
    plain.then(|| std::str::from_utf8(word).ok()).flatten()
}

fn without_comment(line: &[u8]) -> &[u8] {
    let end = line.iter().position(|&b| b == b'#').unwrap_or(line.len());
    line[..end].trim_ascii_end()
}

impl BufRead for CleanLines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.consumed == self.clean.len()
            && let Err(problem) = self.advance()
        {
            self.problem = Some(problem);
            return Err(io::Error::from(io::ErrorKind::InvalidData));
        }
        Ok(&self.clean[self.consumed..])
    }

    fn consume(&mut self, bytes: usize) {
        self.consumed += bytes;
    }
}

impl Read for CleanLines<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let bytes = self.fill_buf()?.read(out)?;
        self.consume(bytes);
        Ok(bytes)
    }
}
