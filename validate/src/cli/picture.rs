//! An RGB picture and its PNG file.

use super::color::srgb;
use anyhow::Context;
use dacrt_validate::atomic;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{Rgb, RgbImage};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// 8-bit sRGB pixels, row by row from the top left.
pub struct Picture(RgbImage);

impl Picture {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Picture {
        Picture(RgbImage::new(width, height))
    }

    /// A picture of linear colours, row by row.
    pub fn from_linear(width: u32, height: u32, colors: &[glam::Vec3]) -> Picture {
        let bytes = colors.iter().flat_map(|c| c.to_array().map(srgb));
        let pixels = RgbImage::from_raw(width, height, bytes.collect());
        Picture(pixels.expect("a colour for each pixel"))
    }

    /// Sets the pixel in column `x` and row `y`.
    pub fn set(&mut self, (x, y): (u32, u32), color: [u8; 3]) {
        self.0.put_pixel(x, y, Rgb(color));
    }

    /// Writes a PNG file; what is there stays if that fails.
    pub fn save(&self, path: &Path) -> anyhow::Result<()> {
        atomic::write(path, |file| {
            let mut file = BufWriter::new(file);
            self.encode(&mut file)?;
            file.flush()
        })
        .with_context(|| format!("cannot write {}", path.display()))
    }

    /// The bytes of such a file.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.encode(&mut bytes)?;
        Ok(bytes)
    }

    fn encode(&self, out: impl Write) -> io::Result<()> {
        // The default is fast and makes files that are hardly smaller than the pixels.
        let encoder =
            PngEncoder::new_with_quality(out, CompressionType::Best, FilterType::Adaptive);
        self.0.write_with_encoder(encoder).map_err(io::Error::other)
    }
}
