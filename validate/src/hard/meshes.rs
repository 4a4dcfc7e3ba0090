//! Meshes that the families are made of.

use super::random::Random;
use dacrt::random::{hash, unit_f64};
use dacrt::{Mesh, Triangle};
use glam::{DVec3, Vec3};

/// Corners of triangles, before they are moved, scaled and rounded. Corners that triangles share
/// have the same bits, so they are still shared afterwards.
#[derive(Clone)]
pub struct Shape(pub Vec<[DVec3; 3]>);

impl Shape {
    /// The unit sphere, closed: an octahedron whose triangles are split in four `levels` times.
    pub fn sphere(levels: u32) -> Shape {
        let corner = |axis: usize, sign: f64| {
            let mut point = DVec3::ZERO;
            point[axis] = sign;
            point
        };
        let mut triangles: Vec<[DVec3; 3]> = (0..8)
            .map(|octant: u32| {
                let sign = |axis: u32| if octant >> axis & 1 == 0 { 1.0 } else { -1.0 };
                [0, 1, 2].map(|axis| corner(axis as usize, sign(axis)))
            })
            .collect();
        for _ in 0..levels {
            let quarters = |[a, b, c]: [DVec3; 3]| {
                // The sum has the same bits whichever end comes first.
                let middle = |p: DVec3, q: DVec3| (p + q) / (p + q).length_squared().sqrt();
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            };
            triangles = triangles.into_iter().flat_map(quarters).collect();
        }
        Shape(triangles)
    }

    /// The sphere with corners between 0.8 and 1 from the middle.
    pub fn bumpy_sphere(levels: u32, seed: u64) -> Shape {
        let height = |p: DVec3| {
            let bits = p.to_array().map(f64::to_bits);
            0.8 + 0.2 * unit_f64(hash(seed, bits[0], hash(0, bits[1], bits[2])))
        };
        Shape::sphere(levels).map(|p| p * height(p))
    }

    /// The cube from −1 to 1, closed: `n` × `n` squares a side, cut along a diagonal.
    pub fn cube(n: u32) -> Shape {
        let mut triangles = Vec::new();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                triangles.extend(Shape::plane(n).0.into_iter().map(|t| {
                    t.map(|p| {
                        let mut turned = DVec3::ZERO;
                        turned[axis] = side;
                        turned[(axis + 1) % 3] = p.x;
                        turned[(axis + 2) % 3] = p.y;
                        turned
                    })
                }));
            }
        }
        Shape(triangles)
    }

    /// The square from −1 to 1 at z = 0: `n` × `n` squares, cut along a diagonal.
    pub fn plane(n: u32) -> Shape {
        let at = |i: u32, j: u32| {
            let place = |k: u32| (2.0 * f64::from(k) - f64::from(n)) / f64::from(n);
            DVec3::new(place(i), place(j), 0.0)
        };
        let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let halves = squares.flat_map(|(i, j)| {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            [[a, b, c], [a, c, d]]
        });
        Shape(halves.collect())
    }

    /// With other corners.
    pub fn map(self, f: impl Fn(DVec3) -> DVec3) -> Shape {
        Shape(self.0.into_iter().map(|t| t.map(&f)).collect())
    }

    /// Rounded to float32.
    pub fn triangles(&self) -> Vec<Triangle> {
        let rounded =
            |&[a, b, c]: &[DVec3; 3]| Triangle::new(a.as_vec3(), b.as_vec3(), c.as_vec3());
        self.0.iter().map(rounded).collect()
    }

    /// Rounded to float32.
    pub fn mesh(&self) -> Mesh {
        Mesh::new(self.triangles())
    }
}

/// A corner, the middle of an edge, or a point at k/2ⁿ of an edge of a random triangle, rounded.
pub fn on_an_edge(random: &mut Random, triangles: &[Triangle]) -> Vec3 {
    let t = triangles[random.below(triangles.len())];
    let corners = [t.a, t.b, t.c].map(|p| p.as_dvec3());
    let first = random.below(3);
    let (p, q) = (corners[first], corners[(first + 1) % 3]);
    let share = match random.below(3) {
        0 => 0.0,
        1 => 0.5,
        _ => {
            let parts = random.power(2, 10);
            random.whole(0, parts as i64) as f64 / parts
        }
    };
    (p + share * (q - p)).as_vec3()
}

/// A random point of a triangle, rounded.
pub fn inside(random: &mut Random, t: &Triangle) -> Vec3 {
    let [a, b, c] = [t.a, t.b, t.c].map(|p| p.as_dvec3());
    let (mut u, mut v) = (random.between(0.0, 1.0), random.between(0.0, 1.0));
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    (a + u * (b - a) + v * (c - a)).as_vec3()
}
