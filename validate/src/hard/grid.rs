//! Small whole numbers: float32 makes no rounding error but in the final division, and the hit can
//! be found in 64-bit whole numbers, without the arbiter.

use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray, Triangle};
use glam::Vec3;

type Point = [i64; 3];

/// Triangles with corners in 0 … 4, rays from such points (some from one), with components of the
/// direction that are zero or powers of two, so that quotients of them are exact.
pub fn grid(random: &mut Random, rays: usize) -> Vec<Case> {
    let mut cases = Vec::new();
    for _ in 0..4 {
        let lattice =
            |random: &mut Random| -> Point { std::array::from_fn(|_| random.whole(0, 4)) };
        let triangles: Vec<[Point; 3]> = (0..40)
            .map(|_| std::array::from_fn(|_| lattice(random)))
            .collect();
        let solid = triangles.iter().map(|t| {
            let [a, b, c] = t.map(float);
            Triangle::new(a, b, c)
        });
        let mesh = Mesh::new(solid.collect());
        for name in ["from one point", "from many points"] {
            let eye = lattice(random);
            let some = (0..rays / 8).map(|_| {
                let origin = if name == "from one point" {
                    eye
                } else {
                    lattice(random)
                };
                let direction: Point = std::array::from_fn(|_| random.pick(&[0, 1, -1, 2, -2, 4]));
                let expected = nearest(&triangles, origin, direction);
                (Ray::new(float(origin), float(direction)), expected)
            });
            cases.push(Case::new(name, mesh.clone()).without_rounding().with(some));
        }
    }
    cases
}

fn float(p: Point) -> Vec3 {
    Vec3::from_array(p.map(|x| x as f32))
}

/// The hit with t > 0, decided in whole numbers.
fn nearest(triangles: &[[Point; 3]], origin: Point, direction: Point) -> Expected {
    let mut best: Option<(i64, i64, usize)> = None;
    for (prim, t) in triangles.iter().enumerate() {
        // Signed volumes of the ray with each edge.
        let [a, b, c] = t.map(|p| minus(p, origin));
        let volumes = [(a, b), (b, c), (c, a)].map(|(p, q)| dot(cross(p, q), direction));
        let signs = volumes.map(i64::signum);
        let den: i64 = volumes.iter().sum();
        if den == 0 || signs.contains(&1) && signs.contains(&-1) {
            continue;
        }
        let normal = cross(minus(b, a), minus(c, a));
        let (num, den) = (dot(normal, a) * den.signum(), den.abs());
        if num > 0 && best.is_none_or(|(n, d, _)| num * d < n * den) {
            best = Some((num, den, prim));
        }
    }
    match best {
        Some((num, den, prim)) => Expected::Is(num as f32 / den as f32, prim as u32),
        None => Expected::Miss,
    }
}

fn minus(p: Point, q: Point) -> Point {
    std::array::from_fn(|k| p[k] - q[k])
}

fn cross(p: Point, q: Point) -> Point {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        p[i] * q[j] - p[j] * q[i]
    })
}

fn dot(p: Point, q: Point) -> i64 {
    (0..3).map(|k| p[k] * q[k]).sum()
}
