//! What is not a number, or not a ray.

use super::meshes::Shape;
use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray, Triangle};
use glam::Vec3;

const BAD: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// Half of the rays invalid, half of the triangles, or both. What is valid is a cube around the
/// origins.
pub fn invalid(random: &mut Random, rays: usize) -> Vec<Case> {
    let cube = Shape::cube(4).triangles();
    let mut spoiled = Vec::new();
    for t in &cube {
        // Nearer than the good one, and before it.
        let mut corners = [t.a / 2.0, t.b / 2.0, t.c / 2.0];
        let bad = random.pick(&[BAD[0], BAD[1], BAD[2], 1.9e18, f32::MAX]);
        corners[random.below(3)][random.below(3)] = bad;
        spoiled.push(Triangle::new(corners[0], corners[1], corners[2]));
        spoiled.push(*t);
    }
    let hopeless = |_: &Triangle| Triangle::new(Vec3::NAN, Vec3::INFINITY, Vec3::NEG_INFINITY);
    let nothing = cube.iter().map(hopeless).collect();
    [
        ("bad rays", cube.clone(), Expected::Hit),
        ("bad rays and triangles", spoiled, Expected::Hit),
        ("no good triangle", nothing, Expected::Miss),
    ]
    .map(|(name, triangles, valid)| {
        let some = (0..rays / 3).map(|i| {
            let good = Ray::new((0.5 * random.point()).as_vec3(), random.float_direction());
            let ray = if i % 2 == 0 {
                good
            } else {
                bad_ray(random, good)
            };
            let expected = if i % 2 == 0 { valid } else { Expected::Miss };
            (ray, expected)
        });
        Case::new(name, Mesh::new(triangles)).with(some)
    })
    .into()
}

fn bad_ray(random: &mut Random, good: Ray) -> Ray {
    let mut ray = good;
    let axis = random.below(3);
    match random.below(6) {
        0 => ray.origin[axis] = random.pick(&BAD),
        1 => ray.direction[axis] = random.pick(&BAD),
        2 => ray.direction = Vec3::ZERO,
        3 => ray.tmin = random.pick(&[f32::NAN, -1.0, f32::INFINITY, f32::NEG_INFINITY]),
        4 => ray.tmax = random.pick(&[f32::NAN, -1.0, 0.0, f32::NEG_INFINITY]),
        _ => {
            ray.origin = Vec3::from_array(std::array::from_fn(|_| random.pick(&BAD)));
            ray.direction = Vec3::from_array(std::array::from_fn(|_| random.pick(&BAD)));
        }
    }
    ray
}
