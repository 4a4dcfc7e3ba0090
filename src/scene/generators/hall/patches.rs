//! The few shapes that the hall is put together from, each cut into triangles as finely as asked.

use crate::geometry::Triangle;
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

/// Adds up triangles: makes them, or only counts them, which is much faster.
pub(super) struct Patches {
    /// Fineness: segments of a radian of radius 1. Grows like the root of the number of triangles.
    pub quality: f64,
    count: usize,
    made: Option<Vec<Triangle>>,
}

impl Patches {
    /// Counts only.
    pub fn counting(quality: f64) -> Patches {
        Patches {
            quality,
            count: 0,
            made: None,
        }
    }

    /// Makes triangles, with room for `capacity` of them.
    pub fn making(quality: f64, capacity: usize) -> Patches {
        Patches {
            made: Some(Vec::with_capacity(capacity)),
            ..Patches::counting(quality)
        }
    }

    /// Number of triangles up to now.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The triangles; none if they were only counted.
    pub fn into_triangles(self) -> Vec<Triangle> {
        self.made.unwrap_or_default()
    }

    /// Segments of an arc: by quality and the root of the radius, which keeps the distance of
    /// chord and arc alike; at least six to the circle.
    pub fn arc(&self, radius: f64, angle: f64) -> usize {
        let least = (angle * 0.95).ceil();
        (self.quality * angle * radius.sqrt()).max(least) as usize
    }

    /// Segments of a straight line: few, as flat things need no more.
    pub fn straight(&self, length: f64) -> usize {
        (self.quality * length / 8.0).max(1.0) as usize
    }

    /// A number of things that grows by `rate` with the quality, within limits.
    pub fn number(&self, rate: f64, least: usize, most: usize) -> usize {
        ((self.quality * rate) as usize).clamp(least, most)
    }

    /// Whether there are triangles enough for round things of this radius.
    pub fn shows(&self, radius: f64) -> bool {
        self.quality * radius >= 0.03
    }

    /// One triangle.
    pub fn triangle(&mut self, a: DVec3, b: DVec3, c: DVec3) {
        self.count += 1;
        if let Some(made) = &mut self.made {
            made.push(Triangle::new(a.as_vec3(), b.as_vec3(), c.as_vec3()));
        }
    }

    /// The surface of `point(u, v)` for u and v from 0 to 1, as `nu` × `nv` cells of two triangles.
    pub fn grid(&mut self, nu: usize, nv: usize, point: impl Fn(f64, f64) -> DVec3) {
        self.cells(nu, nv, false, point);
    }

    /// As [`Patches::grid`], where `point(0, v)` is one point: its row has one triangle a cell.
    pub fn fan(&mut self, nu: usize, nv: usize, point: impl Fn(f64, f64) -> DVec3) {
        self.cells(nu, nv, true, point);
    }

    fn cells(&mut self, nu: usize, nv: usize, pole: bool, point: impl Fn(f64, f64) -> DVec3) {
        self.count += 2 * nu * nv - if pole { nv } else { 0 };
        let Some(made) = &mut self.made else {
            return;
        };
        let row = |i: usize| -> Vec<Vec3> {
            (0..=nv)
                .map(|k| point(i as f64 / nu as f64, k as f64 / nv as f64).as_vec3())
                .collect()
        };
        let mut last = row(0);
        for i in 1..=nu {
            let next = row(i);
            for k in 0..nv {
                if !(pole && i == 1) {
                    made.push(Triangle::new(last[k], last[k + 1], next[k + 1]));
                }
                made.push(Triangle::new(last[k], next[k + 1], next[k]));
            }
            last = next;
        }
    }

    /// A flat or bent four-sided patch with straight sides `ab`, `bc`, `cd` and `da`.
    pub fn quad(&mut self, a: DVec3, b: DVec3, c: DVec3, d: DVec3) {
        let (nu, nv) = (self.straight(a.distance(d)), self.straight(a.distance(b)));
        self.grid(nu, nv, |u, v| a.lerp(b, v).lerp(d.lerp(c, v), u));
    }

    /// A box without a floor, as it stands on something: `size` along the axes `x` (unit, level),
    /// up, and across; `foot` is the middle of the floor.
    pub fn block(&mut self, foot: DVec3, x: DVec3, size: DVec3) {
        let across = x.cross(DVec3::Y);
        let p = |i: f64, j: f64, k: f64| {
            foot + i * size.x / 2.0 * x + j * size.y * DVec3::Y + k * size.z / 2.0 * across
        };
        let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        for side in 0..4 {
            let ((i, k), (l, m)) = (around[side], around[(side + 1) % 4]);
            self.quad(p(i, 0.0, k), p(l, 0.0, m), p(l, 1.0, m), p(i, 1.0, k));
        }
        let [a, b, c, d] = around.map(|(i, k)| p(i, 1.0, k));
        self.quad(a, b, c, d);
    }

    // Round things that the quality does not show are left out, so that a coarse hall has no more
    // than its walls, vaults and columns.

    /// A surface of revolution about the vertical through `axis`: `outline(t)` for t from 0 to 1 is
    /// radius and height over `axis`; `radius` is a typical one.
    pub fn turned(
        &mut self,
        axis: DVec3,
        radius: f64,
        steps: usize,
        outline: impl Fn(f64) -> (f64, f64),
    ) {
        if !self.shows(radius) {
            return;
        }
        let around = self.arc(radius, TAU);
        self.grid(steps, around, |u, v| {
            let (r, y) = outline(u);
            axis + on_circle(r, TAU * v) + DVec3::Y * y
        });
    }

    /// A ball.
    pub fn ball(&mut self, center: DVec3, radius: f64) {
        if !self.shows(radius) {
            return;
        }
        let around = self.arc(radius, TAU);
        let steps = self.arc(radius, PI / 2.0);
        for up in [-1.0, 1.0] {
            self.fan(steps, around, |u, v| {
                let (sin, cos) = libm::sincos(u * PI / 2.0);
                center + on_circle(radius * sin, TAU * v) + DVec3::Y * (up * radius * cos)
            });
        }
    }

    /// A round bar from `a` to `b`, open at both ends.
    pub fn bar(&mut self, a: DVec3, b: DVec3, radius: f64) {
        if !self.shows(radius) {
            return;
        }
        let (m, n) = (b - a).normalize().any_orthonormal_pair();
        let (steps, around) = (self.straight(a.distance(b)), self.arc(radius, TAU));
        self.grid(steps, around, |u, v| {
            let (sin, cos) = libm::sincos(TAU * v);
            a.lerp(b, u) + radius * (cos * m + sin * n)
        });
    }

    /// A round bar bent to a part of an ellipse: `center + a sin(t) x + b cos(t) y` for t from
    /// `from` to `to`; `x` and `y` are unit vectors at right angles.
    pub fn bent_bar(
        &mut self,
        center: DVec3,
        [x, y]: [DVec3; 2],
        [a, b]: [f64; 2],
        [from, to]: [f64; 2],
        radius: f64,
    ) {
        if !self.shows(radius) {
            return;
        }
        let across = x.cross(y);
        let (steps, around) = (self.arc(a.max(b), to - from), self.arc(radius, TAU));
        self.grid(steps, around, |u, v| {
            let (s, c) = libm::sincos(from + (to - from) * u);
            let out = (b * s * x + a * c * y).normalize();
            let (sin, cos) = libm::sincos(TAU * v);
            center + a * s * x + b * c * y + radius * (cos * out + sin * across)
        });
    }
}

/// A point of the level circle of radius `r` about the origin.
pub(super) fn on_circle(r: f64, angle: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(angle);
    DVec3::new(r * cos, 0.0, r * sin)
}
