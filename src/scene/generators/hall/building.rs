//! Walls, windows, columns and vaults of the hall. Lengths in metres; the nave runs along x.

use super::patches::{Patches, on_circle};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Bays of the nave, and the length of each.
pub(super) const BAYS: usize = 8;
pub(super) const BAY: f64 = 6.0;
/// From the west wall to the apse.
pub(super) const LENGTH: f64 = BAYS as f64 * BAY;
/// Half the width of nave and apse; also how high the nave's vault rises.
pub(super) const NAVE: f64 = 6.0;
/// Half the width of the whole.
pub(super) const WIDTH: f64 = 11.0;
/// Where the nave's vault begins.
pub(super) const SPRING: f64 = 10.0;
/// Thickness of the wall over the columns.
const WALL: f64 = 0.8;
/// The columns stand in the middle of that wall.
const COLUMNS: f64 = NAVE + WALL / 2.0;
/// Top of a column.
const CAPITAL: f64 = 5.0;
/// Radius of the arches between columns.
const ARCH: f64 = BAY / 2.0 - 0.55;
/// Aisles: middle, half width, where their vault begins and how far it rises.
const AISLE: f64 = (NAVE + WALL + WIDTH) / 2.0;
const AISLE_HALF: f64 = (WIDTH - NAVE - WALL) / 2.0;
const AISLE_SPRING: f64 = 6.0;
const AISLE_RISE: f64 = 2.6;
/// How far walls go on behind a vault, so that no light comes through the joint.
const LAP: f64 = 0.15;

const EAST: DVec3 = DVec3::X;
const UP: DVec3 = DVec3::Y;
const SOUTH: DVec3 = DVec3::Z;

/// The directions in which the bars of an arch across the nave, or along it, are bent.
const ACROSS: [DVec3; 2] = [SOUTH, UP];
const ALONG: [DVec3; 2] = [EAST, UP];
/// From one foot of an arch to the other.
const HALF_TURN: [f64; 2] = [-FRAC_PI_2, FRAC_PI_2];

/// Everything that stands but the floor of the nave and the furniture.
pub(super) fn building(p: &mut Patches) {
    for bay in 0..BAYS {
        let x = (bay as f64 + 0.5) * BAY;
        vault(p, DVec3::new(x, SPRING, 0.0), NAVE, NAVE, 0.14);
        p.ball(DVec3::new(x, SPRING + NAVE - 0.1, 0.0), 0.35);
        for side in [-1.0, 1.0] {
            let aisle = DVec3::new(x, AISLE_SPRING, side * AISLE);
            vault(p, aisle, AISLE_HALF, AISLE_RISE, 0.1);
            arcade(p, x, side);
            clerestory(p, x, side);
            let wall = Wall {
                half: BAY / 2.0,
                top: AISLE_SPRING,
                rise: AISLE_RISE,
                window: [0.9, 2.4, 4.6],
            };
            wall.build(p, |along, y, depth| {
                DVec3::new(x + along, y, side * (WIDTH + depth))
            });
        }
    }
    for row in 0..=BAYS {
        let x = row as f64 * BAY;
        let radius = if row == BAYS { 0.4 } else { 0.22 };
        let top = DVec3::new(x, SPRING, 0.0);
        p.bent_bar(top, ACROSS, [NAVE - 0.05; 2], HALF_TURN, radius);
        for side in [-1.0, 1.0] {
            column(p, DVec3::new(x, 0.0, side * COLUMNS));
            respond(p, DVec3::new(x, CAPITAL, side * NAVE));
            let aisle = DVec3::new(x, AISLE_SPRING, side * AISLE);
            p.bent_bar(aisle, ACROSS, [AISLE_HALF, AISLE_RISE], HALF_TURN, 0.16);
        }
    }
    for side in [-1.0, 1.0] {
        // The ledge under the upper windows.
        let ledge = DVec3::new(0.0, SPRING - 0.1, side * NAVE);
        p.bar(ledge, ledge + LENGTH * EAST, 0.12);
        for x in [0.0, LENGTH] {
            aisle_end(p, x, side);
        }
    }
    west_wall(p);
    apse(p);
}

/// A groin vault over one bay: the space under two crossing half-elliptical barrels of one height,
/// `half` wide to each side and `rise` high over `middle`. Four webs, each from the apex to one
/// side of the bay, and two ribs of radius `rib` where the barrels meet.
fn vault(p: &mut Patches, middle: DVec3, half: f64, rise: f64, rib: f64) {
    let (nu, nv) = (p.arc(rise, FRAC_PI_2), p.arc(half.max(rise), PI));
    for (to_side, sign) in [(false, -1.0), (false, 1.0), (true, -1.0), (true, 1.0)] {
        p.fan(nu, nv, |u, v| {
            let away = libm::sin(u * FRAC_PI_2);
            // Even steps along the arch at the side of the bay, on the level near the apex, where
            // those of the arch would be too narrow for float32 at both ends.
            let (arch, level) = (libm::sin((v - 0.5) * PI), 2.0 * v - 1.0);
            let across = away * (level + (arch - level) * away);
            let height = rise * (1.0 - across * across).max(0.0).sqrt();
            let (i, k) = if to_side {
                (across, sign * away)
            } else {
                (sign * away, across)
            };
            middle + DVec3::new(BAY / 2.0 * i, height, half * k)
        });
    }
    for sign in [-1.0, 1.0] {
        let way = DVec3::new(BAY / 2.0, 0.0, sign * half);
        let axes = [way.length() - rib, rise - rib / 2.0];
        p.bent_bar(middle, [way.normalize(), UP], axes, HALF_TURN, rib);
    }
}

/// The wall over an arch between two columns, both faces, and the arch's underside.
fn arcade(p: &mut Patches, x: f64, side: f64) {
    let steps = p.arc(ARCH, PI);
    let arch = |u: f64| {
        let (sin, cos) = libm::sincos(PI * u);
        (-ARCH * cos, CAPITAL + ARCH * sin)
    };
    let aisle_top = |along: f64| {
        let share = along / (BAY / 2.0);
        AISLE_SPRING + AISLE_RISE * (1.0 - share * share).max(0.0).sqrt() + LAP
    };
    let rows = p.straight(SPRING - CAPITAL);
    for (depth, aisle) in [(0.0, false), (WALL, true)] {
        let at = |along: f64, bottom: f64, v: f64| {
            let top = if aisle { aisle_top(along) } else { SPRING };
            DVec3::new(
                x + along,
                bottom + (top - bottom) * v,
                side * (NAVE + depth),
            )
        };
        p.grid(steps, rows, |u, v| {
            let (along, bottom) = arch(u);
            at(along, bottom, v)
        });
        for end in [-1.0, 1.0] {
            let edge = |u: f64| end * (ARCH + (BAY / 2.0 - ARCH) * u);
            p.grid(1, rows, |u, v| at(edge(u), CAPITAL, v));
        }
    }
    p.grid(steps, 1, |u, v| {
        let (along, y) = arch(u);
        DVec3::new(x + along, y, side * (NAVE + WALL * v))
    });
    // A roll along the edge of the arch.
    let middle = DVec3::new(x, CAPITAL, side * NAVE);
    p.bent_bar(middle, ALONG, [ARCH; 2], HALF_TURN, 0.09);
}

/// The upper window of a bay, in the half-elliptical wall under the vault.
fn clerestory(p: &mut Patches, x: f64, side: f64) {
    let (half, rise) = (BAY / 2.0, NAVE);
    let (width, height) = (0.5 * half, 0.6 * rise);
    let steps = p.arc(rise, PI);
    let at = |a: f64, b: f64, angle: f64, depth: f64| {
        let (sin, cos) = libm::sincos(angle);
        DVec3::new(x + a * sin, SPRING + b * cos, side * (NAVE + depth))
    };
    let angle = |v: f64| (v - 0.5) * PI;
    let rings = p.straight(rise - height);
    p.grid(rings, steps, |u, v| {
        let a = width + (half + LAP - width) * u;
        let b = height + (rise + LAP - height) * u;
        at(a, b, angle(v), 0.0)
    });
    p.grid(1, steps, |u, v| at(width, height, angle(v), WALL * u));
    let rings = p.straight(height);
    p.fan(rings, steps, |u, v| {
        at(u * width, u * height, angle(v), WALL)
    });
    let z = [NAVE, NAVE + WALL].map(|z| side * z);
    let sill = |i: f64, z: f64| DVec3::new(x + i * width, SPRING, z);
    p.quad(
        sill(-1.0, z[0]),
        sill(1.0, z[0]),
        sill(1.0, z[1]),
        sill(-1.0, z[1]),
    );
    for bar in [-1.0, 0.0, 1.0] {
        let foot = DVec3::new(x + bar * width / 2.0, SPRING, side * (NAVE + 0.6 * WALL));
        let top = height * (1.0 - bar * bar / 4.0).sqrt();
        p.bar(foot, foot + UP * top, 0.05);
    }
    let middle = DVec3::new(x, SPRING, side * NAVE);
    p.bent_bar(middle, ALONG, [width, height], HALF_TURN, 0.08);
    p.bent_bar(middle, ALONG, [half, rise - 0.05], HALF_TURN, 0.1);
}

/// A piece of wall with an arched window.
struct Wall {
    /// Half its width.
    half: f64,
    /// Height at its ends, and how much higher it is in the middle.
    top: f64,
    rise: f64,
    /// Half width, sill, and where its arch begins.
    window: [f64; 3],
}

impl Wall {
    /// `at` places a point: along the wall from its middle, height, depth behind its face.
    fn build(&self, p: &mut Patches, at: impl Fn(f64, f64, f64) -> DVec3) {
        let &Wall {
            half,
            top,
            rise,
            window: [width, sill, spring],
        } = self;
        let arch = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            (width * sin, spring + width * cos)
        };
        let head = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            (half * sin, top + rise * cos + LAP)
        };
        let angle = |v: f64| (v - 0.5) * PI;
        let between = |a: (f64, f64), b: (f64, f64), u: f64| {
            at(a.0 + (b.0 - a.0) * u, a.1 + (b.1 - a.1) * u, 0.0)
        };
        let steps = p.arc(half, PI);
        let (out, along, up) = (p.straight(half), p.straight(2.0 * half), p.straight(top));
        p.grid(out, steps, |u, v| {
            between(arch(angle(v)), head(angle(v)), u)
        });
        p.grid(out, along, |u, v| {
            let i = 2.0 * v - 1.0;
            between((i * width, sill), (i * half, 0.0), u)
        });
        const DEPTH: f64 = 0.5;
        for side in [-1.0, 1.0] {
            let jamb = |v: f64| (side * width, sill + (spring - sill) * v);
            p.grid(out, up, |u, v| {
                between(jamb(v), (side * half, (top + LAP) * v), u)
            });
            p.grid(1, up, |u, v| at(jamb(v).0, jamb(v).1, DEPTH * u));
        }
        p.grid(1, steps, |u, v| {
            let (i, y) = arch(angle(v));
            at(i, y, DEPTH * u)
        });
        p.grid(1, along, |u, v| {
            at((2.0 * v - 1.0) * width, sill, DEPTH * u)
        });
        // The pane: the arch, and what is under it.
        let rings = p.straight(width);
        p.fan(rings, steps, |u, v| {
            let (i, y) = arch(angle(v));
            at(u * i, spring + u * (y - spring), DEPTH)
        });
        p.grid(up, along, |u, v| {
            at((2.0 * v - 1.0) * width, sill + (spring - sill) * u, DEPTH)
        });
        p.bar(at(0.0, sill, 0.35), at(0.0, spring + width, 0.35), 0.04);
        p.bar(at(-width, spring, 0.35), at(width, spring, 0.35), 0.04);
    }
}

/// A column on a square block, with a capital.
fn column(p: &mut Patches, foot: DVec3) {
    p.block(foot, EAST, DVec3::new(1.5, 0.25, 1.5));
    let at = |height: f64| foot + UP * height;
    let roll = |p: &mut Patches, height: f64, radius: f64, size: f64| {
        if !p.shows(size) {
            return;
        }
        let steps = p.arc(size, PI);
        p.turned(at(height), radius, steps, |t| {
            let (sin, cos) = libm::sincos(PI * t);
            (radius + size * sin, size * (1.0 - cos))
        });
    };
    roll(p, 0.25, 0.62, 0.1);
    roll(p, 0.45, 0.57, 0.06);
    let steps = p.straight(3.7);
    p.turned(at(0.57), 0.55, steps, |t| (0.55 - 0.06 * t * t, 3.53 * t));
    roll(p, 4.1, 0.49, 0.05);
    let steps = p.arc(0.4, FRAC_PI_2);
    p.turned(at(4.2), 0.6, steps, |t| {
        let (sin, cos) = libm::sincos(FRAC_PI_2 * t);
        (0.49 + 0.2 * (1.0 - cos), 0.55 * sin)
    });
    p.block(at(4.75), EAST, DVec3::new(1.44, 0.25, 1.44));
}

/// The slender shaft that carries the ribs, from a column's capital to the vault.
fn respond(p: &mut Patches, foot: DVec3) {
    p.bar(foot, foot + UP * (SPRING - 0.4 - CAPITAL), 0.18);
    let steps = p.arc(0.3, FRAC_PI_2);
    p.turned(foot + UP * (SPRING - 0.4 - CAPITAL), 0.25, steps, |t| {
        (0.18 + 0.2 * t * t, 0.4 * t)
    });
}

/// What closes an aisle at its end.
fn aisle_end(p: &mut Patches, x: f64, side: f64) {
    let (steps, rows) = (p.arc(AISLE_RISE, PI), p.straight(AISLE_SPRING));
    p.grid(steps, rows, |u, v| {
        let (sin, cos) = libm::sincos((u - 0.5) * PI);
        let top = AISLE_SPRING + AISLE_RISE * cos + LAP;
        DVec3::new(x, top * v, side * (AISLE + AISLE_HALF * sin))
    });
    // Beside the half column.
    let at = |y: f64, z: f64| DVec3::new(x, y, side * z);
    let inner = NAVE + WALL;
    p.quad(
        at(0.0, NAVE),
        at(0.0, inner),
        at(CAPITAL, inner),
        at(CAPITAL, NAVE),
    );
}

/// The west wall of the nave, with a round window.
fn west_wall(p: &mut Patches) {
    const ROSE: f64 = 2.4;
    const DEPTH: f64 = 0.6;
    let circle = |r: f64, angle: f64, depth: f64| {
        let (sin, cos) = libm::sincos(angle);
        DVec3::new(-depth, SPRING + r * sin, r * cos)
    };
    let rings = p.straight(NAVE - ROSE);
    let steps = p.arc(NAVE, PI);
    p.grid(rings, steps, |u, v| {
        circle(ROSE + (NAVE + LAP - ROSE) * u, PI * v, 0.0)
    });
    // Below, from the lower half of the circle to the walls and the floor.
    let rings = p.straight(SPRING);
    for side in [-1.0, 1.0] {
        let steps = p.arc(ROSE, PI / 4.0);
        p.grid(rings, steps, |u, v| {
            let wall = DVec3::new(0.0, SPRING * (1.0 - v), side * NAVE);
            let mut inner = circle(ROSE, -PI / 4.0 * v, 0.0);
            inner.z *= side;
            inner.lerp(wall, u)
        });
    }
    let steps = p.arc(ROSE, PI / 2.0);
    p.grid(rings, steps, |u, v| {
        let floor = DVec3::new(0.0, 0.0, NAVE * (2.0 * v - 1.0));
        circle(ROSE, -PI * (0.75 - 0.5 * v), 0.0).lerp(floor, u)
    });
    let around = p.arc(ROSE, TAU);
    p.grid(1, around, |u, v| circle(ROSE, TAU * v, DEPTH * u));
    let rings = p.straight(ROSE);
    p.fan(rings, around, |u, v| circle(u * ROSE, TAU * v, DEPTH));
    let middle = UP * SPRING - EAST * (DEPTH / 2.0);
    for radius in [ROSE, 0.6] {
        p.bent_bar(middle, ACROSS, [radius; 2], [0.0, TAU], 0.08);
    }
    for spoke in 0..12 {
        let angle = TAU * spoke as f64 / 12.0;
        p.bar(
            circle(0.6, angle, DEPTH / 2.0),
            circle(ROSE, angle, DEPTH / 2.0),
            0.05,
        );
    }
}

/// The round east end: five windows under a half dome.
fn apse(p: &mut Patches) {
    let middle = LENGTH * EAST;
    let sector = PI / 5.0;
    let wall = Wall {
        half: NAVE * sector / 2.0,
        top: SPRING,
        rise: 0.0,
        window: [0.75, 3.2, 7.4],
    };
    for window in 0..5 {
        let angle = (window as f64 - 2.0) * sector;
        wall.build(p, |along, y, depth| {
            middle + on_circle(NAVE + depth, angle + along / NAVE) + UP * y
        });
    }
    let (nu, nv) = (p.arc(NAVE, FRAC_PI_2), p.arc(NAVE, PI));
    p.fan(nu, nv, |u, v| {
        let (sin, cos) = libm::sincos(u * FRAC_PI_2);
        middle + on_circle(NAVE * sin, (v - 0.5) * PI) + UP * (SPRING + NAVE * cos)
    });
    for rib in 0..6 {
        let angle = (rib as f64 - 2.5) * sector;
        let foot = middle + on_circle(NAVE, angle);
        p.bar(foot, foot + UP * SPRING, 0.16);
        let way = on_circle(1.0, angle);
        let axes = [NAVE - 0.05; 2];
        p.bent_bar(
            middle + UP * SPRING,
            [way, UP],
            axes,
            [0.0, FRAC_PI_2],
            0.14,
        );
    }
    let ledge = middle + UP * (SPRING - 0.1);
    p.bent_bar(ledge, [SOUTH, EAST], [NAVE; 2], HALF_TURN, 0.12);
    let rings = p.straight(NAVE);
    p.fan(rings, nv, |u, v| {
        middle + on_circle(u * NAVE, (v - 0.5) * PI)
    });
}
