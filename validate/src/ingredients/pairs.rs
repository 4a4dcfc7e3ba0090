//! Pairs of a ray and a triangle: of scenes, and hard ones.

use crate::exact::Arbiter;
use dacrt::random::{hash, unit_f64};
use dacrt::{Batch, Ray, Triangle};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Pairs of one kind.
pub struct Source {
    /// Of which kind.
    pub name: String,
    /// Rays that are valid, triangles that are valid.
    pub pairs: Vec<(Ray, Triangle)>,
}

/// The rays with what they hit in exact arithmetic and with one of its neighbours; and rays from the
/// same origins to edges and corners of what was hit, with the same two triangles.
///
/// A neighbour shares a corner. Costs about 10 µs a ray and core.
pub fn of_rays(name: &str, arbiter: &Arbiter, rays: &Batch, seed: u64) -> [Source; 2] {
    let triangles = arbiter.mesh().triangles();
    let mut at_corner: HashMap<[u32; 3], Vec<u32>> = HashMap::new();
    for (prim, triangle) in (0..).zip(triangles) {
        for corner in corners(triangle) {
            at_corner.entry(bits(corner)).or_default().push(prim);
        }
    }
    let both = (0..rays.len()).into_par_iter().filter_map(|i| {
        let ray = rays.ray(i);
        let prim = arbiter.nearest(&ray)?.prim;
        let number = |k| hash(seed, i as u64, k);
        let hit = triangles[prim as usize];
        let around = &at_corner[&bits(corners(&hit)[number(0) as usize % 3])];
        let neighbour = around[number(1) as usize % around.len()];
        let neighbour = triangles[neighbour as usize];
        let aimed = Ray {
            direction: on_an_edge(&hit, &number) - ray.origin,
            ..ray
        };
        let pairs = [(ray, hit), (ray, neighbour)];
        let aimed = [(aimed, hit), (aimed, neighbour)];
        Some((pairs, aimed))
    });
    let (pairs, aimed): (Vec<_>, Vec<_>) = both.unzip();
    let source = |name: String, pairs: Vec<[(Ray, Triangle); 2]>| Source {
        name,
        pairs: pairs.into_iter().flatten().filter(can_meet).collect(),
    };
    [
        source(name.to_owned(), pairs),
        source(format!("{name}, at edges and corners"), aimed),
    ]
}

fn corners(triangle: &Triangle) -> [Vec3; 3] {
    [triangle.a, triangle.b, triangle.c]
}

/// The same for 0 and −0.
fn bits(v: Vec3) -> [u32; 3] {
    (v + Vec3::ZERO).to_array().map(f32::to_bits)
}

fn can_meet((ray, triangle): &(Ray, Triangle)) -> bool {
    ray.is_valid() && triangle.is_valid()
}

/// A point of an edge, or a corner.
fn on_an_edge(triangle: &Triangle, number: &impl Fn(u64) -> u64) -> Vec3 {
    let corners = corners(triangle);
    let i = number(2) as usize % 3;
    let (from, to) = (corners[i].as_dvec3(), corners[(i + 1) % 3].as_dvec3());
    let along = match number(3) % 4 {
        0 => 0.0,
        1 => 0.5,
        _ => unit_f64(number(4)),
    };
    (from + along * (to - from)).as_vec3()
}

/// The kinds of hard pairs: what they are called, and how far from the triangle the ray starts, how
/// thin the triangle is, how steep the ray, where the triangle lies, and whether the ray goes to an
/// edge.
struct Kind {
    name: &'static str,
    /// The least power of ten that a height of the triangle is of its length.
    thinnest: f64,
    /// The least power of ten of the angle between ray and plane.
    flattest: f64,
    /// Where the triangle is moved; the ray stays.
    away: DVec3,
    at_edges: bool,
    /// Whether the triangle is in a plane of two axes, so that its box is flat.
    flat: bool,
}

const PLAIN: Kind = Kind {
    name: "",
    thinnest: 0.0,
    flattest: 0.0,
    away: DVec3::ZERO,
    at_edges: false,
    flat: false,
};

/// Where Embree's own tests of watertightness put things.
const FAR: DVec3 = DVec3::new(148_376.0, 1234.0, -223_423.0);

const KINDS: [Kind; 6] = [
    Kind {
        name: "at edges and corners",
        at_edges: true,
        ..PLAIN
    },
    Kind {
        name: "flat boxes",
        flat: true,
        ..PLAIN
    },
    Kind {
        name: "far: triangles at (148376, 1234, -223423)",
        away: FAR,
        ..PLAIN
    },
    Kind {
        name: "far, at edges and corners",
        away: FAR,
        at_edges: true,
        ..PLAIN
    },
    Kind {
        name: "grazing: 0.06 to 0.00006 degrees",
        flattest: -6.0,
        ..PLAIN
    },
    Kind {
        name: "needles: 1 to 1e6 times as long as wide",
        thinnest: -6.0,
        ..PLAIN
    },
];

/// Made-up pairs, `n` of each kind: triangles of the size of the unit cube and rays from around it,
/// about half of which hit.
pub fn hard(n: usize, seed: u64) -> Vec<Source> {
    let sources = (1u64..).zip(&KINDS).map(|(key, kind)| Source {
        name: kind.name.to_owned(),
        pairs: (0..n as u64)
            .map(|i| pair(kind, seed.wrapping_add(key), i))
            .filter(can_meet)
            .collect(),
    });
    sources.collect()
}

fn pair(kind: &Kind, seed: u64, i: u64) -> (Ray, Triangle) {
    let number = |k| hash(seed, i, k);
    let unit = |k| unit_f64(number(k));
    let point = |k| DVec3::new(unit(k), unit(k + 1), unit(k + 2)) * 2.0 - 1.0;
    let (a, b) = (point(10), point(13));
    let third = (a + b) / 2.0 + 0.5 * point(16);
    let third = a
        .lerp(b, unit(19))
        .lerp(third, 10f64.powf(kind.thinnest * unit(20)));
    let axis = number(29) as usize % 3;
    let rounded = |mut v: DVec3| {
        if kind.flat {
            v[axis] = a[axis];
        }
        (v + kind.away).as_vec3()
    };
    let triangle = Triangle::new(rounded(a), rounded(b), rounded(third));
    let [a, b, c] = corners(&triangle).map(|v| v.as_dvec3());

    let target = match kind.at_edges {
        true => on_an_edge(&triangle, &number).as_dvec3(),
        // In the triangle or beyond its longest edge.
        false => {
            let (u, v) = (unit(21), unit(22));
            a + u * (b - a) + v * (c - a)
        }
    };
    let origin = if kind.flattest < 0.0 {
        let within = (b - a) * (unit(23) - 0.5) + (c - a) * (unit(24) - 0.5);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let slope = 10f64.powf(-3.0 + (kind.flattest + 3.0) * unit(25));
        target + 3.0 * within.normalize_or_zero() + 3.0 * slope * normal
    } else {
        2.0 * point(26)
    };
    let origin = origin.as_vec3();
    let direction = (target - origin.as_dvec3()).as_vec3();
    (Ray::new(origin, direction), triangle)
}
