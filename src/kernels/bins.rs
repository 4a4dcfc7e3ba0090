//! Binning and partitioning of triangles (Nabata 2013, section 4.1, after Wald 2007): K equal slabs
//! of the node's box, triangles by the centre of their box.

use crate::geometry::{Aabb, Triangle};
use crate::simd::Lanes;
use glam::{BVec4A, Vec3, Vec4};

/// The most bins that a node may have.
pub(crate) const MAX_BINS: usize = 256;

/// What divides of a triangle: its box and its number, in one vector of eight. The upper corner is
/// stored negated, so that one `min` unites two boxes.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Item([f32; 8]);

/// A box in the same layout: lanes 3 and 7 mean nothing.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct BinBox([f32; 8]);

impl Item {
    pub const ZERO: Item = Item([0.0; 8]);

    #[inline(always)]
    pub fn new(triangle: &Triangle, prim: u32) -> Item {
        let Aabb { min, max } = triangle.bounds();
        let number = f32::from_bits(prim);
        Item([
            min.x,
            min.y,
            min.z,
            number,
            -max.x,
            -max.y,
            -max.z,
            f32::from_bits(1),
        ])
    }

    /// As [`Item::new`], of corners whose fourth lanes mean nothing, in two vectors.
    #[inline(always)]
    pub fn halves([a, b, c]: [Vec4; 3], prim: u32) -> [Vec4; 2] {
        let with_bits = |v: Vec4, bits| {
            let coordinates = BVec4A::new(true, true, true, false);
            Vec4::select(coordinates, v, Vec4::splat(f32::from_bits(bits)))
        };
        let (least, greatest) = (a.min(b).min(c), a.max(b).max(c));
        [with_bits(least, prim), with_bits(-greatest, 1)]
    }

    #[inline(always)]
    pub fn of_halves(halves: [Vec4; 2]) -> Item {
        Item(BinBox::of_halves(halves).0)
    }

    /// A cluster of `weight` triangles.
    pub fn cluster(bounds: BinBox, number: u32, weight: u32) -> Item {
        let mut item = bounds.0;
        item[3] = f32::from_bits(number);
        item[7] = f32::from_bits(weight);
        Item(item)
    }

    /// How many triangles it stands for.
    #[inline(always)]
    pub fn weight(&self) -> u32 {
        self.0[7].to_bits()
    }

    #[inline(always)]
    pub fn doubled_center(&self, axis: usize) -> f32 {
        self.0[axis] - self.0[axis + 4]
    }

    #[inline(always)]
    pub fn prim(&self) -> u32 {
        self.0[3].to_bits()
    }

    #[cfg(test)]
    pub fn bounds(&self) -> Aabb {
        BinBox(self.0).bounds()
    }
}

impl BinBox {
    pub const EMPTY: BinBox = BinBox([f32::INFINITY; 8]);

    #[inline(always)]
    pub fn of_halves([lower, upper]: [Vec4; 2]) -> BinBox {
        let mut numbers = [0.0; 8];
        lower.write_to_slice(&mut numbers[..4]);
        upper.write_to_slice(&mut numbers[4..]);
        BinBox(numbers)
    }

    /// # Safety
    /// The processor has `L`'s instruction set.
    #[inline(always)]
    pub unsafe fn add<L: Lanes>(&mut self, item: &Item) {
        // SAFETY: as promised.
        unsafe { L::min8(&mut self.0, &item.0) }
    }

    pub fn is_empty(&self) -> bool {
        self.0[0] == f32::INFINITY
    }

    #[inline(always)]
    pub fn merged(mut self, other: &BinBox) -> BinBox {
        for (a, &b) in self.0.iter_mut().zip(&other.0) {
            *a = if b < *a { b } else { *a };
        }
        self
    }

    #[inline(always)]
    pub fn bounds(&self) -> Aabb {
        let b = &self.0;
        Aabb {
            min: Vec3::new(b[0], b[1], b[2]),
            max: Vec3::new(-b[4], -b[5], -b[6]),
        }
    }
}

/// K equal slabs of a box along one axis.
#[derive(Clone, Copy)]
pub(crate) struct Binning {
    pub axis: usize,
    /// Twice the lower plane of the box.
    base: f32,
    /// Bins per doubled length.
    scale: f32,
    last: f32,
}

impl Binning {
    /// `bins` from 2 to [`MAX_BINS`].
    pub fn new(node: &Aabb, axis: usize, bins: usize) -> Binning {
        let (lo, hi) = (node.min[axis], node.max[axis]);
        Binning {
            axis,
            base: 2.0 * lo,
            scale: bins as f32 / (2.0 * (hi - lo)),
            last: (bins - 1) as f32,
        }
    }

    /// Number of bins.
    pub fn bins(&self) -> usize {
        self.last as usize + 1
    }

    #[inline(always)]
    fn bin(&self, item: &Item) -> usize {
        let x = (item.doubled_center(self.axis) - self.base) * self.scale;
        // NaN (a box without extent) falls into the last bin.
        let x = if x < self.last { x } else { self.last };
        let x = if x > 0.0 { x } else { 0.0 };
        // SAFETY: 0 <= x <= MAX_BINS - 1.
        unsafe { x.to_int_unchecked::<i32>() as usize }
    }
}

/// The bins of one axis.
pub(crate) struct Bins {
    pub boxes: [BinBox; MAX_BINS],
    pub counts: [u32; MAX_BINS],
}

impl Bins {
    pub const EMPTY: Bins = Bins {
        boxes: [BinBox::EMPTY; MAX_BINS],
        counts: [0; MAX_BINS],
    };

    /// Empties the first `n` bins.
    #[inline(always)]
    fn clear(&mut self, n: usize) {
        self.boxes[..n].fill(BinBox::EMPTY);
        self.counts[..n].fill(0);
    }

    /// # Safety
    /// The processor has `L`'s instruction set; `bin` is below [`MAX_BINS`].
    #[inline(always)]
    unsafe fn add<L: Lanes>(&mut self, bin: usize, item: &Item) {
        // SAFETY: as promised.
        unsafe {
            self.boxes.get_unchecked_mut(bin).add::<L>(item);
            *self.counts.get_unchecked_mut(bin) += item.weight();
        }
    }
}

/// Adds every item to its bin of one axis, or of all three at once.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn bin<L: Lanes>(items: &[Item], axes: &[Binning], bins: &mut [Bins; 3]) {
    for (binning, bins) in axes.iter().zip(bins.iter_mut()) {
        bins.clear(binning.bins());
    }
    // SAFETY: `Binning::bin` is below MAX_BINS.
    unsafe {
        match axes {
            [x, y, z] => {
                let [of_x, of_y, of_z] = bins;
                for item in items {
                    of_x.add::<L>(x.bin(item), item);
                    of_y.add::<L>(y.bin(item), item);
                    of_z.add::<L>(z.bin(item), item);
                }
            }
            [axis] => {
                // Neighbours often share a bin, and each would wait for the one before: every other
                // item goes to a second set.
                let [bins, others, _] = bins;
                others.clear(axis.bins());
                for pair in items.chunks(2) {
                    bins.add::<L>(axis.bin(&pair[0]), &pair[0]);
                    if let Some(item) = pair.get(1) {
                        others.add::<L>(axis.bin(item), item);
                    }
                }
                for i in 0..axis.bins() {
                    L::min8(&mut bins.boxes[i].0, &others.boxes[i].0);
                    bins.counts[i] += others.counts[i];
                }
            }
            _ => unreachable!("one axis or all three"),
        }
    }
}

/// Moves the items of bins up to `last_left` to the front, both sides in their old order; returns
/// how many there are.
#[inline(always)]
pub(crate) fn partition(
    items: &mut [Item],
    scratch: &mut [Item],
    binning: &Binning,
    last_left: usize,
) -> usize {
    assert!(scratch.len() >= items.len());
    let (mut left, mut right) = (0, 0);
    for i in 0..items.len() {
        let item = items[i];
        let goes_right = (binning.bin(&item) > last_left) as usize;
        // Both sides are written and one pointer moves, so there is no branch to mispredict.
        // SAFETY: left <= i and right <= i, and both slices are longer than i.
        unsafe {
            *items.get_unchecked_mut(left) = item;
            *scratch.get_unchecked_mut(right) = item;
        }
        left += 1 - goes_right;
        right += goes_right;
    }
    items[left..].copy_from_slice(&scratch[..right]);
    left
}

/// The box around items.
///
/// # Safety
/// The processor has `L`'s instruction set.
#[inline(always)]
pub(crate) unsafe fn unite<L: Lanes>(items: &[Item]) -> BinBox {
    let mut bounds = BinBox::EMPTY;
    for item in items {
        // SAFETY: as promised.
        unsafe { bounds.add::<L>(item) };
    }
    bounds
}

/// The extent of the triangles' centres (those of their boxes), doubled.
#[inline(always)]
pub(crate) fn spread_of_centers(items: &[Item]) -> Vec3 {
    let mut lo = [f32::INFINITY; 4];
    let mut hi = [f32::NEG_INFINITY; 4];
    for item in items {
        for axis in 0..4 {
            let c = item.0[axis] - item.0[axis + 4];
            lo[axis] = if c < lo[axis] { c } else { lo[axis] };
            hi[axis] = if c > hi[axis] { c } else { hi[axis] };
        }
    }
    Vec3::new(hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2])
}
