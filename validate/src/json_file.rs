//! Files of JSON, plain or gzip.

use crate::atomic;
use serde::Serialize;
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;

/// Writes a document as plain JSON, the file whole or not at all.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: &Path, document: &impl Serialize) -> io::Result<()> {
    atomic::write(path, |file| write_text(file, document))
}

/// Writes the text of such a file.
///
/// # Errors
/// If it cannot be written.
pub fn write_text(out: impl Write, document: &impl Serialize) -> io::Result<()> {
    let mut out = BufWriter::new(out);
    serde_json::to_writer_pretty(&mut out, document)?;
    out.write_all(b"\n")?;
    out.flush()
}

/// The text of a file, plain or gzip (told by its first bytes, not by its name).
///
/// # Errors
/// Of gzip that is damaged: how many bytes of text there are before that, and what is wrong.
pub fn text(bytes: Vec<u8>) -> Result<Vec<u8>, (usize, io::Error)> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    match flate2::bufread::MultiGzDecoder::new(&bytes[..]).read_to_end(&mut text) {
        Ok(_) => Ok(text),
        Err(source) => Err((text.len(), source)),
    }
}
