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

use super::cell::Cell;
use super::divide::{Divide, Part};
use crate::kernels::{Range, Side};

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
    fn needs_other(&self, share: f32) -> bool {
        share > 0.5 && self.stalls == STALLS
    }

    /// Charges a half with its share, and with that of the other if it counts.
    fn charge(&mut self, share: f32, other: f32) {
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

/// What finds the part of a subproblem that is in a half on one side of its cell.
type Filter<'a> = fn(&mut Divide<'a>, &Cell, Side, Part) -> Part;

impl<'a> Divide<'a> {
    /// The half of a cell on one side, charged with its share of the work, and what of the subproblem
    /// is in it; none if that is nothing. `all` are the subproblem's rays or cones; the share of the
    /// first half is handed on to the second.
    pub(super) fn enter(
        &mut self,
        cell: &Cell,
        side: Side,
        part: Part,
        all: Range,
        filter: Filter<'a>,
        first_share: &mut Option<f32>,
    ) -> Option<(Cell, Part)> {
        let share = |inside: Part| {
            let rays = (inside.rays - all.from) as f32 / all.len() as f32;
            rays * (inside.triangles as f32 / part.triangles as f32)
        };
        let mut half = cell.half(side);
        let inside = filter(self, &half, side, part);
        if inside.rays == all.from || inside.triangles == 0 {
            *first_share = Some(0.0);
            return None;
        }
        let own = share(inside);
        let other = first_share.unwrap_or_else(|| {
            if !half.growth.needs_other(own) {
                return 0.0;
            }
            // Filtering for the other half reorders the lists.
            let across = side.opposite();
            let other = share(filter(self, &cell.half(across), across, part));
            filter(self, &half, side, part);
            other
        });
        half.growth.charge(own, other);
        *first_share = Some(own);
        Some((half, inside))
    }
}
