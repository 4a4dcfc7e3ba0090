//! A bumpy closed surface, like a scanned object.

use super::zip::zip;
use crate::geometry::Triangle;
use crate::random;
use glam::{DVec3, Vec3};

/// A ball whose radius varies by fractal noise, cut into rings of even height with a number of
/// segments that goes with their length, so that triangles are nearly equilateral and equal
/// before the bumps. An odd number of triangles is rounded down.
pub(super) fn relief(triangles: usize, seed: u64) -> Vec<Triangle> {
    // Each of the segments of all rings has one triangle above it and one below.
    let segments = triangles / 2;
    // Equilateral triangles of edge a on the unit sphere: 4π = n a² √3/4, and the height of a
    // ring is a √3/2.
    let edge = (16.0 * std::f64::consts::PI / (3f64.sqrt() * triangles as f64)).sqrt();
    let bands = ((std::f64::consts::PI / (edge * 0.75f64.sqrt())).round() as usize).max(2);
    let angle = |ring: usize| std::f64::consts::PI * ring as f64 / bands as f64;

    let total: f64 = (1..bands).map(|ring| libm::sin(angle(ring))).sum();
    let noise = Noise { seed, edge };
    let mut out = Vec::with_capacity(2 * segments);
    let north = noise.displace(DVec3::Y);
    let mut above: Vec<Vec3> = Vec::new();
    let (mut sum, mut used) = (0.0, 0);
    for ring in 1..bands {
        let (sin, cos) = libm::sincos(angle(ring));
        sum += sin;
        // Rounding the running sum makes the total exact.
        let until = match ring + 1 == bands {
            true => segments,
            false => (segments as f64 * (sum / total)).round() as usize,
        };
        let count = until - used;
        used = until;
        let row: Vec<Vec3> = (0..count)
            .map(|k| {
                // Odd rings are turned by half a segment.
                let turn = (2 * k + ring % 2) as f64 / (2 * count) as f64;
                let (s, c) = libm::sincos(std::f64::consts::TAU * turn);
                noise.displace(DVec3::new(sin * c, cos, sin * s))
            })
            .collect();
        if ring == 1 {
            out.extend((0..count).map(|k| Triangle::new(north, row[(k + 1) % count], row[k])));
        } else {
            let rows = [&above, &row];
            zip(above.len(), count, [(ring - 1) % 2, ring % 2], |corners| {
                let [a, b, c] = corners.map(|(r, k)| rows[r][k % rows[r].len()]);
                out.push(Triangle::new(a, b, c));
            });
        }
        above = row;
    }
    let south = noise.displace(DVec3::NEG_Y);
    let n = above.len();
    out.extend((0..n).map(|k| Triangle::new(south, above[k], above[(k + 1) % n])));
    out
}

/// How far the surface stands from the middle.
struct Noise {
    seed: u64,
    /// Edge length of the triangles: bumps smaller than a few of them are left out.
    edge: f64,
}

impl Noise {
    /// The surface point in a direction of unit length.
    fn displace(&self, direction: DVec3) -> Vec3 {
        let mut radius = 1.0;
        let (mut amplitude, mut frequency) = (0.3, 1.5);
        for octave in 0..16 {
            if frequency * self.edge > 0.3 {
                break;
            }
            radius += amplitude * self.gradient(octave, frequency * direction);
            amplitude *= 0.5;
            frequency *= 2.0;
        }
        (radius * direction).as_vec3()
    }

    /// Perlin's gradient noise (2002), from −1 to 1, twice differentiable.
    fn gradient(&self, octave: u64, p: DVec3) -> f64 {
        let cell = p.floor();
        let f = p - cell;
        let ease = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
        let weight = [ease(f.x), ease(f.y), ease(f.z)];
        let mut sum = 0.0;
        for corner in 0..8u32 {
            let bit = |axis: u32| f64::from(corner >> axis & 1);
            let at = DVec3::new(bit(0), bit(1), bit(2));
            let w: f64 = (0..3)
                .map(|axis| match corner >> axis & 1 {
                    0 => 1.0 - weight[axis as usize],
                    _ => weight[axis as usize],
                })
                .product();
            sum += w * slope(self.lattice(octave, cell + at), f - at);
        }
        sum
    }

    /// Random bits of a lattice point.
    fn lattice(&self, octave: u64, point: DVec3) -> u64 {
        let [x, y, z] = point.to_array().map(|v| v as i64 as u64 & 0xf_ffff);
        random::hash(self.seed, octave, x << 40 | y << 20 | z)
    }
}

/// Product of `p` with one of the twelve directions to the middle of a cube's edges.
fn slope(bits: u64, p: DVec3) -> f64 {
    let axes = [(p.x, p.y), (p.y, p.z), (p.z, p.x)];
    let (u, v) = axes[random::below(bits, 3) as usize];
    (if bits & 1 == 0 { u } else { -u }) + if bits & 2 == 0 { v } else { -v }
}
