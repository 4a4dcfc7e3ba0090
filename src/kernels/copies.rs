//! Copies of a triangle: no plane tells them apart, and only the one with the lowest number is ever hit,
//! so the others are dropped.
//!
//! To find them costs a scene without any nothing to speak of: a few places of a list are compared, and
//! only where two of these hold the same triangle the list is searched. Up to seven triangles with
//! however many copies are always found out.

use super::Item;
use super::lists::TriangleLists;
use crate::geometry::Triangle;
use crate::random;

/// Places of a list that are compared with each other.
const SAMPLE: usize = 8;
/// The search goes on while it drops at least one triangle in so many.
const WORTH: usize = 16;

/// A list of triangles that may have copies.
pub(crate) trait Copies {
    fn len(&self) -> usize;

    /// Whether there are triangles with the same corners in the same order at two places. (With other
    /// orders t is rounded differently.)
    fn same(&self, i: usize, j: usize) -> bool;

    /// Drops all copies of the triangle at a place but the one with the lowest number.
    fn drop_copies_of(&mut self, i: usize);

    /// Drops copies from lists of at least so many, in linear time.
    #[inline]
    fn drop_copies(&mut self, least: usize) {
        while self.len() >= least.max(SAMPLE) {
            let before = self.len();
            let Some(i) = self.repeated() else { return };
            self.drop_copies_of(i);
            if (before - self.len()) * WORTH < before {
                return;
            }
        }
    }

    /// A triangle of the sample that is there twice, by its place: one of each eighth of the list.
    fn repeated(&self) -> Option<usize> {
        let len = self.len();
        let place = |i: usize| {
            let within = random::hash(len as u64, i as u64, 0) as usize % len;
            (i * len + within) / SAMPLE
        };
        let mut places = [0; SAMPLE];
        for i in 0..SAMPLE {
            places[i] = place(i);
            if places[..i].iter().any(|&j| self.same(places[i], j)) {
                return Some(places[i]);
            }
        }
        None
    }
}

/// The items of a node, in file order, and the mesh that they are of.
pub(crate) struct ItemList<'a> {
    pub triangles: &'a [Triangle],
    pub items: &'a mut [Item],
    /// The items that are left, which come first.
    pub len: usize,
}

impl ItemList<'_> {
    fn triangle(&self, i: usize) -> &Triangle {
        &self.triangles[self.items[i].prim() as usize]
    }
}

impl Copies for ItemList<'_> {
    fn len(&self) -> usize {
        self.len
    }

    fn same(&self, i: usize, j: usize) -> bool {
        self.triangle(i) == self.triangle(j)
    }

    fn drop_copies_of(&mut self, i: usize) {
        let copied = *self.triangle(i);
        let (mut kept, mut met) = (0, false);
        for i in 0..self.len {
            let same = *self.triangle(i) == copied;
            if !(same && met) {
                self.items[kept] = self.items[i];
                kept += 1;
            }
            met |= same;
        }
        self.len = kept;
    }
}

/// The first `len` triangles of an index list. What is dropped comes behind them.
pub(crate) struct IndexList<'a> {
    lists: &'a TriangleLists,
    len: usize,
}

impl<'a> IndexList<'a> {
    /// # Safety
    /// The index list has `len` numbers of triangles.
    pub unsafe fn new(lists: &'a TriangleLists, len: usize) -> IndexList<'a> {
        IndexList { lists, len }
    }

    fn prim(&self, i: usize) -> u32 {
        debug_assert!(i < self.len);
        // SAFETY: by the promise of `new`, for no place is looked at from `len` on.
        unsafe { *self.lists.ids.add(i) }
    }

    fn are_same(&self, a: u32, b: u32) -> bool {
        // SAFETY: they are numbers of triangles.
        unsafe { self.lists.same(a, b) }
    }
}

impl Copies for IndexList<'_> {
    fn len(&self) -> usize {
        self.len
    }

    fn same(&self, i: usize, j: usize) -> bool {
        self.are_same(self.prim(i), self.prim(j))
    }

    fn drop_copies_of(&mut self, i: usize) {
        let copied = self.prim(i);
        let all = (0..self.len).map(|i| self.prim(i));
        let lowest = all.filter(|&prim| self.are_same(prim, copied)).min();
        let mut kept = 0;
        for i in 0..self.len {
            let prim = self.prim(i);
            if Some(prim) == lowest || !self.are_same(prim, copied) {
                // SAFETY: both places are within the list.
                unsafe { std::ptr::swap(self.lists.ids.add(kept), self.lists.ids.add(i)) };
                kept += 1;
            }
        }
        self.len = kept;
    }
}
