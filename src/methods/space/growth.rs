//! A bound on what splitting may cost where it does not help.
//!
//! Where triangles are larger than cells, a split copies them: the naive work (rays × triangles) of
//! two halves may be up to twice that of their cell, again and again, as for rays in the plane
//! of many triangles. The share of a half is its part of its cell's work. A share of up to ½ can be left
//! alone, for two of them are no more than the whole. Larger ones are let pass [`STALLS`] times on
//! the way to a cell; from then on the other half is looked at, too, and the excess of both may
//! multiply to [`MOST`].
//!
//! The naive steps of a trace so test at most 2^[`STALLS`] · 2 [`MOST`] times as many pairs as one naive
//! step over everything: divide each cell's work by what is charged to it and its ancestors (2 for a stall,
//! the excess later, else 1); then two halves never sum to more than their cell.

/// Shares above ½ that are let pass unseen.
const STALLS: u32 = 8;

/// The product of excesses that ends splitting.
const MOST: f32 = 2.0;

/// What splitting has cost on the way to a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Growth {
    stalls: u32,
    excess: f32,
}

impl Growth {
    pub const NONE: Growth = Growth {
        stalls: 0,
        excess: 1.0,
    };

    /// Whether the share of the other half counts for a half with this one.
    pub fn needs_other(&self, share: f32) -> bool {
        share > 0.5 && self.stalls == STALLS
    }

    /// Charges a half with its share, and with that of the other if it counts.
    pub fn charge(&mut self, share: f32, other: f32) {
        if share <= 0.5 {
            return;
        }
        if self.stalls < STALLS {
            self.stalls += 1;
            return;
        }
        // Of a half that is left alone its share is taken from the whole.
        let excess = match other <= 0.5 {
            true => share / (1.0 - other),
            false => share + other,
        };
        self.excess *= excess.max(1.0);
    }

    /// Whether the cell must not be split further.
    pub fn is_too_much(&self) -> bool {
        self.excess > MOST
    }
}
