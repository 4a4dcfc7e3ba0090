//! Reads triangle meshes from files: OBJ and PLY, plain or gzip, all told apart by their content.

mod obj;
mod ply;

use crate::{Mesh, Triangle};
use flate2::read::MultiGzDecoder;
use std::fmt;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Why a mesh could not be loaded. The message is one line: file, place, what was expected and
/// what was found.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The file could not be opened or read.
    #[error("{}: cannot be read: {source}", file.display())]
    Unreadable {
        /// The mesh file.
        file: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The content of the file is not a mesh.
    #[error("{}{place}: {problem}", file.display())]
    Malformed {
        /// The mesh file.
        file: PathBuf,
        /// Where in the file.
        place: Place,
        /// What was expected and what was found.
        problem: String,
    },
}

/// A place in a mesh file; of a gzip file, in its unpacked content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Nowhere in particular.
    File,
    /// A line of text, counted from 1.
    Line(usize),
    /// A byte, counted from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Line(line) => write!(f, ", line {line}"),
            Place::Byte(byte) => write!(f, ", byte {byte}"),
        }
    }
}

/// Loads an OBJ or PLY file, plain or gzip. Only positions and faces are read: no material file is
/// opened, normals, texture coordinates and colours are skipped.
///
/// Triangles come in file order, polygons cut into fans around their first corner. Triangles with
/// NaN, infinite or huge coordinates are no error: they are counted in [`Mesh::dropped`].
///
/// The whole file is held in memory while it is read (unpacked, if it is gzip).
///
/// # Errors
/// If the file cannot be read, breaks its format (faces of fewer than three corners and indices
/// out of range included), or has no triangle or more than `u32::MAX - 1`.
pub fn load_mesh(file: &Path) -> Result<Mesh, MeshError> {
    load_triangles(file).map(Mesh::new)
}

/// As [`load_mesh`], from the bytes of a file; `file` stands in messages only.
///
/// # Errors
/// As [`load_mesh`].
pub fn mesh_from_bytes(file: &Path, bytes: &[u8]) -> Result<Mesh, MeshError> {
    triangles_from_bytes(file, bytes).map(Mesh::new)
}

/// As [`load_mesh`]; never an empty list.
pub(super) fn load_triangles(file: &Path) -> Result<Vec<Triangle>, MeshError> {
    let read = || {
        // A pipe or a device could go on for ever.
        if !std::fs::metadata(file)?.is_file() {
            return Err(io::Error::other("not a regular file"));
        }
        std::fs::read(file)
    };
    let bytes = read().map_err(|source| MeshError::Unreadable {
        file: file.to_owned(),
        source,
    })?;
    triangles_from_bytes(file, &bytes)
}

fn triangles_from_bytes(file: &Path, bytes: &[u8]) -> Result<Vec<Triangle>, MeshError> {
    let parsed = if bytes.starts_with(&[0x1f, 0x8b]) {
        gunzip(bytes).and_then(|unpacked| parse(&unpacked))
    } else {
        parse(bytes)
    };
    parsed.map_err(|Problem { place, text }| MeshError::Malformed {
        file: file.to_owned(),
        place,
        problem: text,
    })
}

fn parse(bytes: &[u8]) -> Result<Vec<Triangle>, Problem> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let is_ply = bytes.starts_with(b"ply") && bytes.get(3).is_some_and(u8::is_ascii_whitespace);
    let triangles = if is_ply {
        ply::parse(bytes)?
    } else {
        obj::parse(bytes)?
    };
    if triangles.is_empty() {
        return Err(Problem::new(
            Place::File,
            if is_ply {
                "expected at least one triangle, found none"
            } else {
                "expected a PLY file (first line \"ply\") or an OBJ file with faces, found no face"
            },
        ));
    }
    Ok(triangles)
}

/// No honest mesh shrinks this much; deflate can reach 1032.
const MOST_EXPANSION: usize = 256;
/// Files that unpack to no more than this are not suspected.
const SMALL: usize = 64 << 20;

fn gunzip(bytes: &[u8]) -> Result<Vec<u8>, Problem> {
    let limit = bytes.len().saturating_mul(MOST_EXPANSION).max(SMALL);
    let mut unpacked = Vec::new();
    MultiGzDecoder::new(bytes)
        .take(limit as u64 + 1)
        .read_to_end(&mut unpacked)
        .map_err(|e| {
            Problem::new(
                Place::Byte(unpacked.len()),
                format!("the gzip data is damaged or cut off from here on ({e})"),
            )
        })?;
    if unpacked.len() > limit {
        return Err(Problem::new(
            Place::Byte(limit),
            format!(
                "the gzip data ({} bytes) unpacks to more than {limit} bytes: no mesh",
                bytes.len()
            ),
        ));
    }
    Ok(unpacked)
}

/// What is wrong with the content of a file, and where.
#[derive(Debug)]
struct Problem {
    place: Place,
    text: String,
}

impl Problem {
    fn new(place: Place, text: impl Into<String>) -> Problem {
        Problem {
            place,
            text: text.into(),
        }
    }
}

/// The most triangles that 32-bit numbers can count, with one number left for "no hit".
pub(super) const MOST_TRIANGLES: usize = u32::MAX as usize - 1;

/// What to say of more.
pub(super) fn too_many_triangles() -> String {
    format!("expected at most {MOST_TRIANGLES} triangles, found more")
}

/// The start of a piece of a file for a message: in quotes, on one line.
fn quote(bytes: &[u8]) -> String {
    const MOST: usize = 60;
    let bytes = bytes.trim_ascii();
    // A character takes at most four bytes.
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * MOST)]);
    match start.char_indices().nth(MOST) {
        None => format!("{start:?}"),
        Some((end, _)) => format!("{:?}…", &start[..end]),
    }
}
