//! The pixels of a picture and the order in which their rays stand in a batch.

use super::WorkloadError;

/// Edge length of a tile of pixels.
pub const TILE: u32 = 8;

/// A grid of pixels with n × n samples each.
///
/// Primary rays are ordered by tiles of [`TILE`] × [`TILE`] pixels, row by row from the top left;
/// within a tile by pixels, row by row; within a pixel by sub-pixels, row by row. Tiles at the
/// right and lower border hold what is left. The sample is the middle of its sub-pixel, so 512²
/// pixels with 64 samples and 4096² pixels with one have the same rays in another order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Film {
    width: u32,
    height: u32,
    /// Samples along an edge of a pixel.
    strata: u32,
}

impl Film {
    /// A picture of `width` × `height` pixels with `spp` samples each.
    ///
    /// # Errors
    /// A width or height of 0, an `spp` that is 0 or no square number, 2³² − 1 rays or more.
    pub fn new(width: u32, height: u32, spp: u32) -> Result<Film, WorkloadError> {
        if width == 0 || height == 0 {
            return Err(WorkloadError::Resolution(width, height));
        }
        let strata = spp.isqrt();
        if spp == 0 || strata * strata != spp {
            return Err(WorkloadError::Samples(spp));
        }
        let rays = u128::from(width) * u128::from(height) * u128::from(spp);
        if rays >= u128::from(u32::MAX) {
            return Err(WorkloadError::TooMany(rays));
        }
        Ok(Film {
            width,
            height,
            strata,
        })
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels in a column.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Samples in a pixel: a square number.
    pub fn spp(&self) -> u32 {
        self.strata * self.strata
    }

    /// Number of primary rays.
    pub fn rays(&self) -> usize {
        self.width as usize * self.height as usize * self.spp() as usize
    }

    /// Column (from the left) and row (from the top) of the pixel that a primary ray belongs to.
    ///
    /// # Panics
    /// In debug builds, if `ray` is not below [`Film::rays`].
    pub fn pixel(&self, ray: usize) -> (u32, u32) {
        debug_assert!(ray < self.rays());
        let (tile, width, height) = (TILE as usize, self.width as usize, self.height as usize);
        let place = ray / self.spp() as usize;
        let top = place / (tile * width) * tile;
        let place = place - top * width;
        let tile_height = tile.min(height - top);
        let left = place / (tile * tile_height) * tile;
        let place = place - left * tile_height;
        let tile_width = tile.min(width - left);
        (
            (left + place % tile_width) as u32,
            (top + place / tile_width) as u32,
        )
    }

    /// Where in the picture a primary ray goes: `x` from 0 at the left to 1 at the right, `y` from
    /// 0 at the top to 1 at the bottom.
    pub(super) fn place(&self, ray: usize) -> [f64; 2] {
        let (column, row) = self.pixel(ray);
        let sample = (ray % self.spp() as usize) as u32;
        // The middle of a sub-pixel in units of half a sub-pixel: exact, then rounded once.
        let middle = |pixel: u32, sub: u32, pixels: u32| {
            let halves = 2 * (u64::from(pixel) * u64::from(self.strata) + u64::from(sub)) + 1;
            halves as f64 / (2 * u64::from(pixels) * u64::from(self.strata)) as f64
        };
        [
            middle(column, sample % self.strata, self.width),
            middle(row, sample / self.strata, self.height),
        ]
    }
}
