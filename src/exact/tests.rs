//! The answers of this module beside those of plain rational numbers.

mod area;
mod figures;
mod hits;
mod meeting;
mod oracle;
mod wide;

use crate::{Triangle, random};
use glam::Vec3;

/// A ray without an interval, and a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub origin: Vec3,
    pub direction: Vec3,
    pub triangle: Triangle,
}

/// Pair number `i` of a family. Each family has pairs that meet and pairs that do not, and most
/// have some that are degenerate.
pub(super) fn pair(family: u32, i: u64) -> Pair {
    let mut index = 0;
    let mut bits = || {
        index += 1;
        random::hash(u64::from(family), i, index)
    };
    // A number between −1 and 1 times a power of two in a range of exponents.
    let mut scaled = |least: i32, most: i32| {
        let exponent = least + random::below(bits(), (most - least + 1) as u32) as i32;
        let unit = 2.0 * random::unit_f64(bits()) - 1.0;
        (unit * f64::exp2(f64::from(exponent))) as f32
    };
    let (mut corner_range, mut origin_range, mut direction_range) = ((0, 0), (0, 0), (0, 0));
    match family {
        // All of one size.
        0..=2 => {}
        // Mixed scales.
        3 => (corner_range, origin_range, direction_range) = ((-20, 20), (-20, 20), (-20, 20)),
        // Denormal numbers, and small ones.
        4 => {
            (corner_range, origin_range, direction_range) = ((-148, -125), (-148, -125), (-148, 0))
        }
        // Large ones.
        5 => (corner_range, origin_range, direction_range) = ((50, 60), (50, 127), (100, 127)),
        // All at once.
        _ => (corner_range, origin_range, direction_range) = ((-148, 60), (-148, 127), (-148, 127)),
    }
    let mut vector = |(least, most): (i32, i32)| {
        Vec3::new(
            scaled(least, most),
            scaled(least, most),
            scaled(least, most),
        )
    };
    let (mut a, mut b, mut c) = (
        vector(corner_range),
        vector(corner_range),
        vector(corner_range),
    );
    let (mut origin, mut direction) = (vector(origin_range), vector(direction_range));
    match family {
        // A coarse grid: edges, corners, planes and lines are met exactly.
        1 => [&mut a, &mut b, &mut c, &mut origin, &mut direction]
            .into_iter()
            .for_each(|v| *v = (*v * 3.0).round()),
        // Aimed at a point of the triangle or its border: a near tie for every polynomial.
        2..=6 if family < 4 || i.is_multiple_of(2) => {
            let weights = [[1.0, 0.0], [0.5, 0.5], [0.25, 0.75], [0.3, 0.3], [0.0, 1.0]];
            let [u, v] = weights[random::below(bits(), 5) as usize];
            direction = a + u * (b - a) + v * (c - a) - origin;
            if bits().is_multiple_of(4) {
                // A sliver.
                c = a + 0.5 * (b - a);
            }
        }
        _ => {}
    }
    if direction == Vec3::ZERO {
        direction = Vec3::X;
    }
    Pair {
        origin,
        direction,
        triangle: Triangle::new(a, b, c),
    }
}

/// Number of families.
pub(super) const FAMILIES: u32 = 7;
