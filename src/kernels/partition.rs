//! In-place filtering of an index list (Mora 2011, Fig. 3): the indices that pass a test come first.

use crate::simd::{Lanes, MAX_LANES};

/// A test of what indices stand for.
pub(crate) trait Test<L: Lanes> {
    /// Those of the `active` lanes that pass. All of the `L::N` indices at `ids` can be looked up.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; there are `L::N` valid indices at `ids`.
    unsafe fn pass(&mut self, ids: *const u32, active: L::M) -> L::M;

    /// Starts to bring near what [`Test::pass`] will look up for [`MAX_LANES`] indices.
    ///
    /// # Safety
    /// As for [`Test::pass`], but for that number.
    #[inline(always)]
    unsafe fn prefetch(&self, _ids: *const u32) {}
}

/// Indices looked at together, whatever the number of lanes: so the order of the result is the same
/// on every instruction set.
const BLOCK: usize = MAX_LANES;
/// Indices between those that are looked up and those that are fetched for later.
const AHEAD: usize = 6 * BLOCK;

/// The hole that [`partition`] has at either end of the list, and what was there.
struct Ends<'a, L: Lanes, T> {
    ids: *mut u32,
    /// Places before this have indices that passed.
    front: usize,
    /// Places from this on have indices that did not.
    back: usize,
    test: &'a mut T,
    lanes: std::marker::PhantomData<L>,
}

impl<L: Lanes, T: Test<L>> Ends<'_, L, T> {
    /// Tests up to [`BLOCK`] indices and puts each at its end, in order. Where `WIDE`, there is room
    /// for a whole block behind `front`.
    ///
    /// # Safety
    /// The processor has `L`'s instruction set; a whole block of valid indices at `block`, `len` of
    /// which count; room for these at both ends.
    #[inline(always)]
    unsafe fn put<const WIDE: bool>(&mut self, block: *const u32, len: usize) {
        // SAFETY: as promised. All of the block is read before any of it is written.
        unsafe {
            let mut ids = [L::splat_u(0); BLOCK / 4];
            let mut passed = [L::first(0); BLOCK / 4];
            let mut kept = 0;
            for part in 0..len.div_ceil(L::N) {
                let at = block.add(part * L::N);
                ids[part] = L::load_u(at);
                passed[part] = self.test.pass(at, L::first(len - part * L::N));
                kept += L::bits(passed[part]).count_ones() as usize;
            }
            self.back -= len - kept;
            let mut back = self.back;
            for part in 0..len.div_ceil(L::N) {
                let lanes = L::first(len - part * L::N);
                let n = L::bits(passed[part]).count_ones() as usize;
                let (to, v) = (
                    self.ids.add(self.front),
                    L::compress_u(passed[part], ids[part]),
                );
                if WIDE {
                    L::store_u(to, v);
                } else {
                    L::store_first_u(to, v, n);
                }
                self.front += n;
                let failed = L::and_not(lanes, passed[part]);
                let n = L::bits(failed).count_ones() as usize;
                let v = L::compress_u(failed, ids[part]);
                L::store_first_u(self.ids.add(back), v, n);
                back += n;
            }
        }
    }
}

/// Moves the indices that pass to the front, the others behind them; returns how many pass.
///
/// No memory but the list itself: a block from either end is set aside, and the blocks between are
/// read from the end that has less room and written to both ends.
///
/// # Safety
/// The processor has `L`'s instruction set; `ids` is good for `len` indices and whole vectors behind
/// them, which all are valid for the test.
#[inline(always)]
pub(crate) unsafe fn partition<L: Lanes, T: Test<L>>(
    ids: *mut u32,
    len: usize,
    test: &mut T,
) -> usize {
    // SAFETY: as promised; see there for the room.
    unsafe {
        let mut ends = Ends::<L, T> {
            ids,
            front: 0,
            back: len,
            test,
            lanes: std::marker::PhantomData,
        };
        if len < 2 * BLOCK {
            let mut all = [0u32; 2 * BLOCK];
            // What stands behind a list are valid indices.
            std::ptr::copy_nonoverlapping(ids, all.as_mut_ptr(), BLOCK);
            if len > BLOCK {
                let rest = len - BLOCK;
                std::ptr::copy_nonoverlapping(ids.add(BLOCK), all.as_mut_ptr().add(BLOCK), rest);
            }
            ends.put::<false>(all.as_ptr(), len.min(BLOCK));
            if len > BLOCK {
                ends.put::<false>(all.as_ptr().add(BLOCK), len - BLOCK);
            }
            return ends.front;
        }
        let mut aside = [0u32; 3 * BLOCK];
        let aside = aside.as_mut_ptr();
        std::ptr::copy_nonoverlapping(ids, aside, BLOCK);
        std::ptr::copy_nonoverlapping(ids.add(len - BLOCK), aside.add(BLOCK), BLOCK);
        // Not yet read: `from..to`. The holes have 2 blocks in all, so the one that is not read into
        // has at least one, and the other one after the block was read.
        let (mut from, mut to) = (BLOCK, len - BLOCK);
        while to - from >= BLOCK {
            let at = if from - ends.front <= ends.back - to {
                from += BLOCK;
                ends.test.prefetch(ids.add((from + AHEAD).min(len - BLOCK)));
                from - BLOCK
            } else {
                to -= BLOCK;
                ends.test.prefetch(ids.add(to.saturating_sub(AHEAD)));
                to
            };
            ends.put::<true>(ids.add(at), BLOCK);
        }
        let rest = to - from;
        std::ptr::copy_nonoverlapping(ids.add(from), aside.add(2 * BLOCK), rest);
        ends.put::<false>(aside.add(2 * BLOCK), rest);
        ends.put::<false>(aside, BLOCK);
        ends.put::<false>(aside.add(BLOCK), BLOCK);
        ends.front
    }
}

#[cfg(test)]
mod tests;
