//! An RGB picture and its PNG file.

use super::color::srgb;
use anyhow::Context;
use dacrt_validate::atomic;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// 8-bit sRGB pixels, row by row from the top left.
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Picture {
        Picture {
            width,
            height,
            pixels: vec![[0; 3]; width as usize * height as usize],
        }
    }

    /// A picture of linear colours, row by row.
    pub fn from_linear(width: u32, height: u32, colors: &[glam::Vec3]) -> Picture {
        Picture {
            width,
            height,
            pixels: colors.iter().map(|c| c.to_array().map(srgb)).collect(),
        }
    }

    /// Sets the pixel in column `x` and row `y`.
    pub fn set(&mut self, (x, y): (u32, u32), color: [u8; 3]) {
        self.pixels[y as usize * self.width as usize + x as usize] = color;
    }

    /// Writes a PNG file; what is there stays if that fails.
    pub fn save(&self, path: &Path) -> anyhow::Result<()> {
        let write = |file: &mut File| {
            let mut encoder = png::Encoder::new(BufWriter::new(file), self.width, self.height);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_depth(png::BitDepth::Eight);
            encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
            let mut writer = encoder.write_header()?;
            writer.write_image_data(self.pixels.as_flattened())?;
            Ok(writer.finish()?)
        };
        atomic::write(path, write).with_context(|| format!("cannot write {}", path.display()))
    }
}
