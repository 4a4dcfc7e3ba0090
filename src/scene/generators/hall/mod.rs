//! The nave of a church: two rows of columns, ribbed vaults, aisles, pews, lamps and an apse.

mod building;
mod furniture;
mod patches;

use super::zip::zip;
use crate::geometry::Triangle;
use building::{LENGTH, NAVE, SPRING, WIDTH};
use glam::DVec3;
use patches::Patches;
use std::f64::consts::{PI, TAU};

/// Exactly as many triangles as asked for, 10 at least. Curved things get finer with the number,
/// and pews, candles and books more numerous. Below what the nave takes at its coarsest, it is a
/// plain hall with fewer columns and pews. The floor takes what is left over: a thirtieth at
/// least where there is enough.
pub(super) fn hall(triangles: usize, seed: u64) -> Vec<Triangle> {
    let room = triangles - (triangles / 30).max(2);
    let count = |quality: f64| {
        let mut patches = Patches::counting(quality);
        nave(&mut patches, seed);
        patches.count()
    };
    let mut patches;
    if count(0.0) <= room {
        let (mut fits, mut too_fine) = (0.0, 1000.0);
        for _ in 0..40 {
            let middle = (fits + too_fine) / 2.0;
            if count(middle) <= room {
                fits = middle;
            } else {
                too_fine = middle;
            }
        }
        patches = Patches::making(fits, triangles);
        nave(&mut patches, seed);
    } else {
        patches = Patches::making(0.0, triangles);
        plain_hall(&mut patches, room);
    }
    let left = triangles - patches.count();
    floor(&mut patches, left);
    patches.into_triangles()
}

fn nave(patches: &mut Patches, seed: u64) {
    building::building(patches);
    furniture::furniture(patches, seed);
}

/// The floor of nave and aisles in exactly `triangles` triangles (2 at least): rows of nearly
/// square cells, with one segment more in as many rows as it takes.
fn floor(patches: &mut Patches, triangles: usize) {
    let square = (triangles as f64 / 2.0 * (2.0 * WIDTH / LENGTH)).sqrt() as usize;
    let rows = square.max(1);
    let segments = triangles / (2 * rows);
    let left = triangles % (2 * rows);
    // The segments of a line inside count for the rows on both sides, those of the first for one.
    let of_line = |line: usize| {
        segments
            + match line {
                0 => left % 2,
                _ => usize::from(line <= left / 2),
            }
    };
    for row in 0..rows {
        let numbers = [of_line(row), of_line(row + 1)];
        zip(numbers[0], numbers[1], [0, 0], |corners| {
            let [a, b, c] = corners.map(|(side, k)| {
                let z = (row + side) as f64 / rows as f64;
                let x = k as f64 / numbers[side] as f64;
                DVec3::new(LENGTH * x, 0.0, WIDTH * (2.0 * z - 1.0))
            });
            patches.triangle(a, b, c);
        });
    }
}

/// For few triangles: walls and a roof (8 triangles); from 82 on ends, square columns and pews.
fn plain_hall(patches: &mut Patches, room: usize) {
    let arches = (room / 60).clamp(2, 24);
    let roof = |u: f64, v: f64| {
        let (sin, cos) = libm::sincos(PI * (v - 0.5));
        DVec3::new(LENGTH * u, SPRING + NAVE * cos, WIDTH * sin)
    };
    for side in [-1.0, 1.0] {
        let at = |x: f64, y: f64| DVec3::new(x, y, side * WIDTH);
        patches.quad(
            at(0.0, 0.0),
            at(LENGTH, 0.0),
            at(LENGTH, SPRING),
            at(0.0, SPRING),
        );
    }
    patches.grid(1, arches, roof);
    if room < 80 {
        return;
    }
    for u in [0.0, 1.0] {
        let middle = DVec3::new(LENGTH * u, SPRING, 0.0);
        patches.fan(1, arches, |r, v| middle.lerp(roof(u, v), r));
        let at = |y: f64, z: f64| DVec3::new(LENGTH * u, y, z);
        patches.quad(
            at(0.0, -WIDTH),
            at(0.0, WIDTH),
            at(SPRING, WIDTH),
            at(SPRING, -WIDTH),
        );
    }
    // A quarter of the triangles for columns, up to half for pews.
    let columns = (room / 64).clamp(1, 9);
    let sides = (room / 16 / columns).clamp(4, 24);
    let rings = (room / 16 / columns / sides).max(1);
    for column in 0..columns {
        let x = LENGTH * (column as f64 + 0.5) / columns as f64;
        for side in [-1.0, 1.0] {
            patches.grid(rings, sides, |u, v| {
                let foot = DVec3::new(x, SPRING * u, side * (NAVE + 0.4));
                foot + patches::on_circle(0.55, TAU * v)
            });
        }
    }
    let pews = (room / 80).clamp(1, 30);
    for pew in 0..pews {
        let x = 11.0 + 30.0 * pew as f64 / pews as f64;
        for side in [-1.0, 1.0] {
            let foot = DVec3::new(x, 0.0, 3.2 * side);
            patches.block(foot, DVec3::X, DVec3::new(0.4, 0.45, 3.7));
            let back = DVec3::new(x - 0.25, 0.0, 3.2 * side);
            patches.block(back, DVec3::X, DVec3::new(0.08, 0.9, 3.7));
        }
    }
}
