//! Rays nearly, or exactly, in the plane of a triangle.

use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray, Triangle};
use glam::{DVec3, Vec3};

/// Triangles as in embree#387 (edges of about 11.2, 9.7 and 1.4), some hundreds from the origin of
/// the ray, which meets their plane at an angle from 6e-5 to 1 degree: in the triangle, at its rim,
/// and up to some lengths beside it.
pub fn grazing(random: &mut Random, rays: usize) -> Vec<Case> {
    const MANY: usize = 200;
    let mut shapes = Vec::new();
    for _ in 0..MANY {
        let x = random.direction();
        let y = x.cross(random.direction()).normalize();
        let at = 300.0 * random.point();
        // The third corner is 11.2 from the first and 1.4 from the second at most.
        let (b, c) = (9.8 * x, 11.1 * x + random.between(0.3, 0.6) * y);
        shapes.push(([at, at + b, at + c], x, y));
    }
    let rounded = |&([a, b, c], _, _): &([DVec3; 3], DVec3, DVec3)| {
        Triangle::new(a.as_vec3(), b.as_vec3(), c.as_vec3())
    };
    let mesh = Mesh::new(shapes.iter().map(rounded).collect());
    let case = Case::new("skinny", mesh);
    let some = (0..rays).map(|_| {
        let (corners, x, y) = shapes[random.below(MANY)];
        let target = match random.below(3) {
            0 => random.pick(&corners),
            1 => {
                let (u, v) = (random.between(0.0, 0.5), random.between(0.0, 0.5));
                corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0])
            }
            _ => corners[0] + random.between(-20.0, 20.0) * x + random.between(-2.0, 2.0) * y,
        };
        let turn = random.direction();
        let in_plane = (x * turn.x + y * turn.y).normalize();
        let angle = (random.power(-13, 0) * random.between(0.5, 1.0)).to_radians();
        let normal = x.cross(y);
        let way = in_plane + random.sign() * angle * normal;
        let from = (target - way * random.between(5.0, 600.0)).as_vec3();
        (Ray::new(from, target.as_vec3() - from), Expected::Unknown)
    });
    vec![case.with(some)]
}

/// Rays exactly in the plane of triangles of small whole numbers: through them and beside them.
pub fn in_plane(random: &mut Random, rays: usize) -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, scale) in [("whole numbers", 1.0), ("times 1e-3", 1e-3f32)] {
        // A plane has whole multiples of two vectors; a batch has one plane and many triangles.
        for _ in 0..8 {
            let [p, q] = [(); 2]
                .map(|()| DVec3::from_array(std::array::from_fn(|_| random.whole(-4, 4) as f64)));
            let in_plane = |random: &mut Random, n: i64| {
                (random.whole(-n, n) as f64 * p + random.whole(-n, n) as f64 * q).as_vec3()
            };
            let triangles = (0..60).map(|_| {
                let [a, b, c] = [(); 3].map(|()| in_plane(random, 6));
                Triangle::new(a, b, c)
            });
            let triangles: Vec<Triangle> = triangles.collect();
            let scaled = |t: &Triangle| Triangle::new(t.a * scale, t.b * scale, t.c * scale);
            let mut case = Case::new(name, Mesh::new(triangles.iter().map(scaled).collect()));
            for _ in 0..rays / 16 {
                let (origin, direction): (Vec3, Vec3) = (in_plane(random, 12), in_plane(random, 4));
                // Scaled by what is no power of two, corners leave the plane.
                let expected = match scale {
                    1.0 => Expected::Miss,
                    _ => Expected::Unknown,
                };
                case.push(Ray::new(origin * scale, direction), expected);
            }
            cases.push(case);
        }
    }
    cases
}
