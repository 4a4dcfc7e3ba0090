//! What stands and hangs in the hall.

use super::building::{BAY, BAYS, LENGTH, NAVE, SPRING};
use super::patches::{Patches, on_circle};
use crate::random;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const UP: DVec3 = DVec3::Y;

/// Keys of the random numbers.
const KEY_PEW: u64 = 1;
const KEY_BOOK: u64 = 2;
const KEY_CANDLE: u64 = 3;
const KEY_LAMP: u64 = 4;

/// Pews in two blocks, hanging lamps, candle stands in the aisles, and the altar.
pub(super) fn furniture(p: &mut Patches, seed: u64) {
    let rows = p.number(20.0, 4, 30);
    for row in 0..rows {
        let x = 11.0 + 30.0 * row as f64 / rows as f64;
        for side in [-1.0, 1.0] {
            pew(
                p,
                seed,
                2 * row as u64 + u64::from(side > 0.0),
                DVec3::new(x, 0.0, 3.2 * side),
            );
        }
    }
    for bay in 0..BAYS {
        lamp(p, seed, bay as u64, (bay as f64 + 0.5) * BAY);
        for side in [-1.0, 1.0] {
            let stands = p.number(0.25, 1, 4);
            for stand in 0..stands {
                let x = (bay as f64 + (stand as f64 + 0.5) / stands as f64) * BAY;
                let number = ((bay * 4 + stand) * 2) as u64 + u64::from(side > 0.0);
                candle_stand(p, seed, 1000 + number, DVec3::new(x, 0.0, 10.2 * side));
            }
        }
    }
    altar(p, seed);
}

/// A random number from −1 to 1.
fn wobble(seed: u64, key: u64, index: u64) -> f64 {
    2.0 * random::unit_f64(random::hash(seed, key, index)) - 1.0
}

/// A pew that faces east, 3.7 long, and the hymn books on its ledge.
fn pew(p: &mut Patches, seed: u64, number: u64, foot: DVec3) {
    const LONG: f64 = 3.7;
    let x = on_circle(1.0, 0.01 * wobble(seed, KEY_PEW, number));
    let across = x.cross(UP);
    let at = |i: f64, y: f64, k: f64| foot + i * x + y * UP + k * across;
    let seat = DVec3::new(0.42, 0.05, LONG);
    p.block(at(0.2, 0.42, 0.0), x, seat);
    p.block(at(0.2, 0.0, 0.0), x, DVec3::new(0.05, 0.42, LONG));
    p.block(at(-0.04, 0.1, 0.0), x, DVec3::new(0.06, 0.82, LONG));
    p.block(at(-0.16, 0.72, 0.0), x, DVec3::new(0.18, 0.03, LONG));
    p.block(at(-0.45, 0.12, 0.0), x, DVec3::new(0.16, 0.06, LONG));
    p.bar(
        at(-0.04, 0.94, -LONG / 2.0),
        at(-0.04, 0.94, LONG / 2.0),
        0.045,
    );
    for end in [-1.0, 1.0] {
        let k = end * (LONG / 2.0 + 0.03);
        p.block(at(0.15, 0.0, k), x, DVec3::new(0.6, 0.62, 0.06));
        p.block(at(-0.04, 0.62, k), x, DVec3::new(0.2, 0.45, 0.06));
        p.ball(at(-0.04, 1.12, k), 0.07);
    }
    let books = p.number(1.0, 0, 6) as u64;
    for book in 0..books {
        let draw = 16 * number + 2 * book;
        let place = (book as f64 + 0.5 + 0.2 * wobble(seed, KEY_BOOK, draw)) / books as f64 - 0.5;
        let turn = on_circle(1.0, 0.5 * wobble(seed, KEY_BOOK, draw + 1));
        p.block(
            at(-0.16, 0.75, LONG * place),
            turn,
            DVec3::new(0.12, 0.03, 0.17),
        );
    }
}

/// A candle with its flame.
fn candle(p: &mut Patches, seed: u64, number: u64, foot: DVec3) {
    const RADIUS: f64 = 0.03;
    if !p.shows(RADIUS) {
        return;
    }
    let tall = 0.28 + 0.1 * wobble(seed, KEY_CANDLE, number);
    let steps = p.straight(tall);
    p.turned(foot, RADIUS, steps, |t| (RADIUS - 0.004 * t, tall * t));
    let steps = p.arc(0.06, PI) + 1;
    let around = p.arc(RADIUS, TAU);
    p.fan(steps, around, |u, v| {
        // A drop, from its tip down.
        let (sin, cos) = libm::sincos(0.9 * PI * u);
        foot + UP * (tall + 0.09 + 0.06 * cos) + on_circle(0.022 * sin * (0.3 + 0.7 * u), TAU * v)
    });
}

/// A ring of candles on a chain from the vault.
fn lamp(p: &mut Patches, seed: u64, number: u64, x: f64) {
    const RING: f64 = 1.1;
    let hub = DVec3::new(x, 8.4, 0.0);
    let ring = DVec3::new(x, 6.6, 0.0);
    let turn = PI * wobble(seed, KEY_LAMP, number);
    for radius in [RING, 0.45] {
        p.bent_bar(ring, [DVec3::X, DVec3::Z], [radius; 2], [0.0, TAU], 0.045);
    }
    for arm in 0..6 {
        let way = on_circle(1.0, turn + TAU * arm as f64 / 6.0);
        p.bar(ring + 0.45 * way, ring + RING * way, 0.025);
        if arm % 2 == 0 {
            p.bar(ring + RING * way, hub, 0.015);
        }
    }
    p.ball(hub, 0.12);
    chain(p, hub + 0.12 * UP, SPRING + NAVE - 0.4);
    let candles = p.number(1.5, 6, 18);
    for k in 0..candles {
        let way = on_circle(RING, turn + TAU * (k as f64 + 0.5) / candles as f64);
        let foot = ring + way + 0.045 * UP;
        let steps = p.straight(0.1);
        p.turned(foot, 0.07, steps, |t| (0.025 + 0.06 * t, 0.05 * t));
        candle(p, seed, number * 32 + k as u64, foot + 0.02 * UP);
    }
}

/// Straight up from `foot` to the height `top`: a thin bar, with links where there are triangles
/// enough for them.
fn chain(p: &mut Patches, foot: DVec3, top: f64) {
    let height = top - foot.y;
    p.bar(foot, foot + UP * height, 0.012);
    if p.quality < 10.0 {
        return;
    }
    let links = p.number(2.0, 20, 60);
    for link in 0..links {
        let pitch = height / links as f64;
        let middle = foot + UP * (pitch * (link as f64 + 0.5));
        let across = if link % 2 == 0 { DVec3::X } else { DVec3::Z };
        p.bent_bar(middle, [across, UP], [0.05, 0.6 * pitch], [0.0, TAU], 0.012);
    }
}

/// A stand with a tray of candles.
fn candle_stand(p: &mut Patches, seed: u64, number: u64, foot: DVec3) {
    let steps = p.arc(0.3, FRAC_PI_2);
    p.turned(foot, 0.2, steps, |t| {
        (0.03 + 0.25 * (1.0 - t) * (1.0 - t), 0.25 * t)
    });
    p.bar(foot + 0.25 * UP, foot + 1.1 * UP, 0.03);
    p.turned(foot + 1.1 * UP, 0.3, steps, |t| {
        (0.03 + 0.35 * t, 0.08 * t * t)
    });
    let candles = p.number(0.8, 3, 16);
    for k in 0..candles {
        // Spread over the tray like the seeds of a sunflower.
        let radius = 0.32 * ((k as f64 + 0.5) / candles as f64).sqrt();
        let way = on_circle(radius, 2.399_963 * k as f64);
        candle(p, seed, number * 32 + k as u64, foot + way + 1.13 * UP);
    }
}

/// Three steps, a table with six candles, and a cross.
fn altar(p: &mut Patches, seed: u64) {
    let x = LENGTH + 1.6;
    for step in 0..3 {
        let size = DVec3::new(5.0 - 0.9 * step as f64, 0.16, 8.0 - 0.9 * step as f64);
        p.block(DVec3::new(x, 0.16 * step as f64, 0.0), DVec3::X, size);
    }
    let top = DVec3::new(x + 0.3, 0.48, 0.0);
    p.block(top, DVec3::X, DVec3::new(0.9, 0.9, 2.8));
    p.block(top + 0.9 * UP, DVec3::X, DVec3::new(1.2, 0.12, 3.2));
    let cloth = top + 1.02 * UP;
    p.block(cloth, DVec3::X, DVec3::new(0.3, 0.08, 0.5));
    p.block(cloth + 0.08 * UP, DVec3::X, DVec3::new(0.07, 1.3, 0.09));
    p.block(cloth + 0.9 * UP, DVec3::X, DVec3::new(0.08, 0.1, 0.8));
    for k in 0..6 {
        let foot = cloth + DVec3::Z * ([-1.4, -1.0, -0.6, 0.6, 1.0, 1.4][k]);
        let steps = p.arc(0.1, PI);
        p.turned(foot, 0.06, steps, |t| {
            let waist = libm::sin(PI * t);
            (0.1 - 0.07 * waist, 0.4 * t)
        });
        candle(p, seed, 5000 + k as u64, foot + 0.4 * UP);
    }
}
