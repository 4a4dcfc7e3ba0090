//! An image cell: the batches that make a picture, their times added repeat by repeat, without and
//! with ray sampling.

use super::printed::Column;
use dacrt::Method;
use dacrt::workloads::RayType;
use dacrt_validate::parameters::own_fields;
use dacrt_validate::results::{Cell, CellKey};
use dacrt_validate::statistics::{Ratio, median, paired_ratio};

/// A picture as measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Of all batches.
    pub rays: usize,
    /// Milliseconds of each repeat without and with ray sampling.
    pub samples_ms: [Vec<f64>; 2],
    /// Ray/box tests, those of sample rays among them, without and with.
    pub box_tests: [u64; 2],
    /// Ray/triangle tests without and with.
    pub triangle_tests: [u64; 2],
}

impl Image {
    /// The picture of a column by a camera with so many samples a pixel; `None` if a batch of it is
    /// not there, or has wrong hits.
    pub fn of(cells: &[&Cell], column: &Column, camera: &str, spp: u32) -> Option<Image> {
        Image::by(cells, column, camera, spp, &with_sampling)
    }

    /// The same, where `with` says whose times and tests those with ray sampling are.
    pub fn by(
        cells: &[&Cell],
        column: &Column,
        camera: &str,
        spp: u32,
        with: &dyn Fn(&CellKey) -> bool,
    ) -> Option<Image> {
        let batches = (column.rays.iter())
            .map(|&rays| Image::of_batch(cells, column, rays, camera, spp, with));
        let mut batches = batches.collect::<Option<Vec<_>>>()?.into_iter();
        let first = batches.next()?;
        batches.try_fold(first, Image::and)
    }

    /// One batch of the picture.
    pub fn of_batch(
        cells: &[&Cell],
        column: &Column,
        rays: RayType,
        camera: &str,
        spp: u32,
        with: &dyn Fn(&CellKey) -> bool,
    ) -> Option<Image> {
        let (scene, _) = column.ours?;
        let rays = rays.to_string();
        let find = |who: &dyn Fn(&CellKey) -> bool| {
            let mut cells = cells.iter().filter(|cell| {
                let key = &cell.key;
                (&*key.scene, &*key.camera, key.spp, &key.rays) == (scene, camera, spp, &rays)
            });
            cells.find(|cell| who(&cell.key) && !cell.is_wrong())
        };
        let without = find(&|key| is_preset(key, Method::Afra2012))?;
        Some(Image::batch(without, find(with)?))
    }

    fn batch(without: &Cell, with: &Cell) -> Image {
        let count = |cell: &Cell, names: &[&str]| {
            let counts = names.iter().map(|&name| cell.counters[name].as_u64());
            counts.map(|n| n.unwrap_or(0)).sum()
        };
        let both = [without, with];
        Image {
            rays: without.ray_count,
            samples_ms: both.map(|cell| cell.samples_ms.clone().unwrap_or_default()),
            box_tests: both.map(|cell| count(cell, &["ray_box", "sample_box"])),
            triangle_tests: both.map(|cell| count(cell, &["ray_triangle"])),
        }
    }

    /// Two batches of a picture; `None` if their repeats are not as many.
    fn and(self, other: Image) -> Option<Image> {
        let [a, b] = self.samples_ms;
        let [c, d] = other.samples_ms;
        let each = |a: [u64; 2], b: [u64; 2]| [a[0] + b[0], a[1] + b[1]];
        Some(Image {
            rays: self.rays + other.rays,
            samples_ms: [sum(a, c)?, sum(b, d)?],
            box_tests: each(self.box_tests, other.box_tests),
            triangle_tests: each(self.triangle_tests, other.triangle_tests),
        })
    }

    /// The acceleration ratio; `None` without rays.
    pub fn ratio(&self) -> Option<Ratio> {
        let [without, with] = &self.samples_ms;
        paired_ratio(without, with)
    }

    /// Median milliseconds without and with ray sampling.
    pub fn ms(&self) -> [f64; 2] {
        (self.samples_ms.each_ref()).map(|samples| median(samples).unwrap_or(0.0))
    }
}

/// Whether a cell is of ray sampling as the paper has it.
pub fn with_sampling(key: &CellKey) -> bool {
    is_preset(key, Method::Nabata2013)
}

/// Whether a cell is of the method as the paper has it.
fn is_preset(key: &CellKey, method: Method) -> bool {
    key.method == method.name() && key.parameters == own_fields(method, &method.parameters())
}

/// Sums of two lists of repeats; one of a batch without rays is empty, and takes no time.
fn sum(a: Vec<f64>, b: Vec<f64>) -> Option<Vec<f64>> {
    match (a.len(), b.len()) {
        (_, 0) => Some(a),
        (0, _) => Some(b),
        (n, m) if n == m => Some(a.iter().zip(&b).map(|(a, b)| a + b).collect()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(ms: [&[f64]; 2], tests: [u64; 2]) -> Image {
        Image {
            rays: 10,
            samples_ms: ms.map(<[f64]>::to_vec),
            box_tests: tests,
            triangle_tests: [tests[0] + 1, tests[1] + 1],
        }
    }

    #[test]
    fn batches_of_a_picture_add_up_repeat_by_repeat() {
        let a = image([&[3.0, 4.0], &[1.0, 2.0]], [5, 7]);
        let b = image([&[5.0, 4.0], &[3.0, 2.0]], [1, 2]);
        let none = image([&[], &[]], [0, 0]);
        let both = a.clone().and(b).unwrap();
        assert_eq!(both.samples_ms, [vec![8.0, 8.0], vec![4.0, 4.0]]);
        assert_eq!(
            (both.rays, both.box_tests, both.triangle_tests),
            (20, [6, 9], [8, 11])
        );
        assert_eq!(both.ratio().unwrap().ratio, 2.0);
        assert_eq!(a.clone().and(none).unwrap().samples_ms, a.samples_ms);
        assert_eq!(a.clone().and(image([&[1.0], &[1.0]], [0, 0])), None);
    }
}
