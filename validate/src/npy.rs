//! Rays in and hits out, for users' own tools: NumPy's `.npy` and `.npz`.
//!
//! The header of an `.npy` file is one Python dictionary of three known keys, read here in a few
//! lines: `npyz` panics on a shape whose product overflows and reserves what a header promises,
//! `ndarray-npy` brings an array library along.

use dacrt::{Batch, Hits, Ray};
use glam::Vec3;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;

/// What is wrong with a file of rays, or why hits cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct NpyError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: NpyProblem,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
pub enum NpyProblem {
    /// The operating system refuses.
    #[error("cannot be read: {0}")]
    Read(io::Error),
    /// The operating system refuses.
    #[error("cannot be written: {0}")]
    Write(io::Error),
    /// No magic number at the start.
    #[error(
        "is not an .npy file: expected the bytes \\x93NUMPY at byte 0, found {found}{}",
        if *npz { " (an .npz or zip archive: give one array, saved with numpy.save)" } else { "" }
    )]
    Magic {
        /// The bytes that are there.
        found: String,
        /// Whether they are those of a zip archive.
        npz: bool,
    },
    /// A version of the format that does not exist yet.
    #[error("is of .npy version {0}.{1}; versions 1.0, 2.0 and 3.0 can be read")]
    Version(u8, u8),
    /// The file ends within the header.
    #[error("ends at byte {found} within the header, which should go up to byte {expected}")]
    ShortHeader {
        /// First byte after the header.
        expected: u64,
        /// Length of the file.
        found: u64,
    },
    /// Not the dictionary that should be there.
    #[error("has a header that cannot be understood (bytes {start} to {end}): {reason}")]
    Header {
        /// First byte of the header's text.
        start: u64,
        /// First byte after it.
        end: u64,
        /// What was expected.
        reason: String,
    },
    /// Not float32.
    #[error("holds {found}, expected float32 ('<f4'); save rays.astype(numpy.float32)")]
    Type {
        /// NumPy's name of the type.
        found: String,
    },
    /// Big-endian.
    #[error("is big-endian ('>f4'), expected little-endian ('<f4'); save rays.astype('<f4')")]
    BigEndian,
    /// Columns one after the other.
    #[error("is in Fortran order, expected C order; save numpy.ascontiguousarray(rays)")]
    FortranOrder,
    /// Not eight columns.
    #[error("has shape {found}, expected (N, 8): ox oy oz tmin dx dy dz tmax of each ray")]
    Shape {
        /// The shape as the header has it.
        found: String,
    },
    /// Fewer or more bytes than the shape needs.
    #[error(
        "should be {expected} bytes long ({rays} rays after a header of {header} bytes), but is {found}"
    )]
    Length {
        /// Rays that the header promises.
        rays: u64,
        /// Bytes before the first ray.
        header: u64,
        /// Length that the file should have.
        expected: u128,
        /// Length that it has.
        found: u64,
    },
}

/// Reads rays: float32 `[N, 8]`, little-endian, C order, each ray `ox oy oz tmin dx dy dz tmax`.
///
/// Invalid rays are kept (they miss). Takes memory only for rays that the file really holds.
///
/// # Errors
/// If the file cannot be read or is anything else.
pub fn read_rays(path: &Path) -> Result<Batch, NpyError> {
    let at = |problem| NpyError {
        path: path.to_owned(),
        problem,
    };
    let file = File::open(path).map_err(|e| at(NpyProblem::Read(e)))?;
    let length = file.metadata().map_err(|e| at(NpyProblem::Read(e)))?.len();
    read_rays_from(BufReader::new(file), length).map_err(at)
}

/// Reads rays from a stream of `length` bytes; see [`read_rays`].
///
/// # Errors
/// If the stream cannot be read or is anything else.
pub fn read_rays_from(mut stream: impl Read, length: u64) -> Result<Batch, NpyProblem> {
    let header = Header::read(&mut stream, length)?;
    match header.descr.as_str() {
        "<f4" => {}
        ">f4" => return Err(NpyProblem::BigEndian),
        found => {
            return Err(NpyProblem::Type {
                found: found.to_owned(),
            });
        }
    }
    let rays = match header.shape[..] {
        [n, 8] => n,
        _ => {
            return Err(NpyProblem::Shape {
                found: shape_text(&header.shape),
            });
        }
    };
    if header.fortran_order {
        return Err(NpyProblem::FortranOrder);
    }
    let expected = header.end as u128 + rays as u128 * 32;
    if expected != length as u128 {
        return Err(NpyProblem::Length {
            rays,
            header: header.end,
            expected,
            found: length,
        });
    }
    let mut batch = Batch::with_capacity(rays as usize);
    let mut bytes = [0; 32];
    for _ in 0..rays {
        stream.read_exact(&mut bytes).map_err(NpyProblem::Read)?;
        let (numbers, _) = bytes.as_chunks::<4>();
        let x = |i: usize| f32::from_le_bytes(numbers[i]);
        batch.push(Ray {
            origin: Vec3::new(x(0), x(1), x(2)),
            tmin: x(3),
            direction: Vec3::new(x(4), x(5), x(6)),
            tmax: x(7),
        });
    }
    Ok(batch)
}

/// What an `.npy` header says.
struct Header {
    descr: String,
    fortran_order: bool,
    shape: Vec<u64>,
    /// First byte of the data.
    end: u64,
}

impl Header {
    fn read(stream: &mut impl Read, length: u64) -> Result<Header, NpyProblem> {
        let mut start = Vec::new();
        stream
            .by_ref()
            .take(8)
            .read_to_end(&mut start)
            .map_err(NpyProblem::Read)?;
        let &[0x93, b'N', b'U', b'M', b'P', b'Y', major, minor] = &start[..] else {
            return Err(NpyProblem::Magic {
                found: match &start[..] {
                    [] => "an empty file".to_owned(),
                    start => start.escape_ascii().to_string(),
                },
                npz: start.starts_with(b"PK"),
            });
        };
        let size_bytes = match (major, minor) {
            (1, 0) => 2,
            (2 | 3, 0) => 4,
            _ => return Err(NpyProblem::Version(major, minor)),
        };
        let text_start = 8 + size_bytes as u64;
        let short = |expected| NpyProblem::ShortHeader {
            expected,
            found: length,
        };
        if text_start > length {
            return Err(short(text_start));
        }
        let mut size = [0; 4];
        stream
            .read_exact(&mut size[..size_bytes])
            .map_err(NpyProblem::Read)?;
        let size = u32::from_le_bytes(size);
        let end = text_start + size as u64;
        if end > length {
            return Err(short(end));
        }
        let mut text = vec![0; size as usize];
        stream.read_exact(&mut text).map_err(NpyProblem::Read)?;
        let understood = match str::from_utf8(&text) {
            Ok(text) => parse_dictionary(text),
            Err(_) => Err("it is not text".to_owned()),
        };
        let (descr, fortran_order, shape) = understood.map_err(|reason| NpyProblem::Header {
            start: text_start,
            end,
            reason,
        })?;
        Ok(Header {
            descr,
            fortran_order,
            shape,
            end,
        })
    }
}

/// Reads `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8), }`, keys in any order.
fn parse_dictionary(text: &str) -> Result<(String, bool, Vec<u64>), String> {
    let mut rest = text
        .trim()
        .strip_prefix('{')
        .and_then(|t| t.strip_suffix('}'))
        .ok_or("expected a dictionary in braces")?
        .trim();
    let (mut descr, mut fortran_order, mut shape) = (None, None, None);
    while !rest.is_empty() {
        let (key, value) = quoted(rest)
            .and_then(|(key, rest)| Some((key, rest.trim_start().strip_prefix(':')?.trim_start())))
            .ok_or_else(|| format!("expected a quoted key and a colon at `{}`", start_of(rest)))?;
        rest = match key {
            "descr" => {
                let (value, rest) = if value.starts_with('[') {
                    // A record type: its text will do for the message.
                    value.split_at(closing(value).ok_or("a list without an end")?)
                } else {
                    quoted(value).ok_or_else(|| {
                        format!("expected a type such as '<f4', found `{}`", start_of(value))
                    })?
                };
                descr = Some(value.to_owned());
                rest
            }
            "fortran_order" => {
                let (value, rest) = ["True", "False"]
                    .iter()
                    .find_map(|&word| Some((word, value.strip_prefix(word)?)))
                    .ok_or_else(|| {
                        format!("expected True or False, found `{}`", start_of(value))
                    })?;
                fortran_order = Some(value == "True");
                rest
            }
            "shape" => {
                let (numbers, rest) = value
                    .strip_prefix('(')
                    .and_then(|v| v.split_once(')'))
                    .ok_or_else(|| {
                        format!(
                            "expected a shape such as (100, 8), found `{}`",
                            start_of(value)
                        )
                    })?;
                let numbers = numbers.trim();
                let numbers = numbers.strip_suffix(',').unwrap_or(numbers);
                let sizes: Result<Vec<u64>, _> = match numbers {
                    "" => Ok(vec![]),
                    _ => numbers.split(',').map(|n| n.trim().parse()).collect(),
                };
                shape = Some(sizes.map_err(|e| format!("in the shape ({numbers}): {e}"))?);
                rest
            }
            _ => return Err(format!("unknown key '{}'", start_of(key))),
        }
        .trim_start();
        rest = match rest.strip_prefix(',') {
            Some(rest) => rest.trim_start(),
            None if rest.is_empty() => rest,
            None => return Err(format!("expected a comma at `{}`", start_of(rest))),
        };
    }
    Ok((
        descr.ok_or("the key 'descr' is missing")?,
        fortran_order.ok_or("the key 'fortran_order' is missing")?,
        shape.ok_or("the key 'shape' is missing")?,
    ))
}

/// Splits off a string in single or double quotes (without escapes, which no type name has).
fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
    text[1..].split_once(quote)
}

/// Length of the list that the text starts with.
fn closing(text: &str) -> Option<usize> {
    let mut depth = 0;
    for (i, c) in text.char_indices() {
        match c {
            '[' => depth += 1,
            ']' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(i + 1);
        }
    }
    None
}

/// At most 40 characters, for messages.
fn start_of(text: &str) -> String {
    text.chars().take(40).collect()
}

fn shape_text(shape: &[u64]) -> String {
    match shape {
        [n] => format!("({n},)"),
        _ => {
            let sizes: Vec<String> = shape.iter().map(u64::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// Writes nearest hits: an `.npz` archive with `t` float32 `[N]` and `prim` uint32 `[N]`.
///
/// # Errors
/// If the file cannot be written; an old file of this name then stays as it was.
pub fn write_hits(path: &Path, hits: &Hits) -> Result<(), NpyError> {
    let t = hits.t.iter().map(|x| x.to_le_bytes());
    let prim = hits.prim.iter().map(|x| x.to_le_bytes());
    write_archive(path, |archive| {
        archive.array("t", "<f4", t)?;
        archive.array("prim", "<u4", prim)
    })
}

/// Writes the result of an any-hit query: an `.npz` archive with `occluded` uint8 `[N]`.
///
/// # Errors
/// As [`write_hits`].
pub fn write_occluded(path: &Path, occluded: &[u8]) -> Result<(), NpyError> {
    write_archive(path, |archive| {
        archive.array("occluded", "|u1", occluded.iter().map(|&x| [x]))
    })
}

/// Writes rays as [`read_rays`] reads them.
///
/// # Errors
/// As [`write_hits`].
pub fn write_rays(path: &Path, batch: &Batch) -> Result<(), NpyError> {
    crate::atomic::write(path, |file| {
        let mut file = BufWriter::new(file);
        file.write_all(&header("<f4", &format!("({}, 8)", batch.len())))?;
        for ray in batch.iter() {
            for x in ray_floats(&ray) {
                file.write_all(&x.to_le_bytes())?;
            }
        }
        file.flush()
    })
    .map_err(|e| NpyError {
        path: path.to_owned(),
        problem: NpyProblem::Write(e),
    })
}

/// A ray as the eight floats of a file: ox oy oz tmin dx dy dz tmax.
pub fn ray_floats(ray: &Ray) -> [f32; 8] {
    let (o, d) = (ray.origin, ray.direction);
    [o.x, o.y, o.z, ray.tmin, d.x, d.y, d.z, ray.tmax]
}

/// The start of an `.npy` file of version 1.0; data behind it is aligned to 64 bytes.
fn header(descr: &str, shape: &str) -> Vec<u8> {
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    let padding = 64 - (10 + text.len() + 1) % 64;
    text.extend(std::iter::repeat_n(' ', padding % 64));
    text.push('\n');
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((text.len() as u16).to_le_bytes());
    header.extend(text.as_bytes());
    header
}

/// An `.npz` archive under way.
pub(crate) struct Archive<'a>(zip::ZipWriter<BufWriter<&'a mut File>>);

impl Archive<'_> {
    /// Adds an array of one axis.
    pub fn array<const BYTES: usize>(
        &mut self,
        name: &str,
        descr: &str,
        values: impl ExactSizeIterator<Item = [u8; BYTES]>,
    ) -> io::Result<()> {
        let bytes = values.len() as u64 * BYTES as u64;
        let options = SimpleFileOptions::default()
            .compression_method(zip::CompressionMethod::Stored)
            .large_file(bytes > u32::MAX as u64 / 2);
        self.0.start_file(format!("{name}.npy"), options)?;
        self.0
            .write_all(&header(descr, &format!("({},)", values.len())))?;
        // Every write of the archive computes a checksum, so not one for each value.
        let mut buffer = BufWriter::with_capacity(1 << 16, &mut self.0);
        for value in values {
            buffer.write_all(&value)?;
        }
        buffer.flush()
    }
}

/// Writes an archive in place of an old file of this name.
pub(crate) fn write_archive(
    path: &Path,
    fill: impl FnOnce(&mut Archive) -> io::Result<()>,
) -> Result<(), NpyError> {
    crate::atomic::write(path, |file| {
        let mut archive = Archive(zip::ZipWriter::new(BufWriter::new(file)));
        fill(&mut archive)?;
        archive.0.finish()?.flush()
    })
    .map_err(|e| NpyError {
        path: path.to_owned(),
        problem: NpyProblem::Write(e),
    })
}
