//! Rays that start on a surface, as all secondary rays do.

use super::meshes::inside;
use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray, Triangle};
use glam::DVec3;

/// Triangles whose coordinates have sizes from 2⁻¹³ to 2¹³, one by one. Rays start at a point of
/// one, rounded to float32, which is on either side of it or in its plane.
pub fn leaving(random: &mut Random, rays: usize) -> Vec<Case> {
    const MANY: usize = 300;
    let corner = |random: &mut Random| {
        DVec3::from_array(std::array::from_fn(|_| {
            random.sign() * random.power(-13, 13) * random.between(1.0, 2.0)
        }))
        .as_vec3()
    };
    let triangles: Vec<Triangle> = (0..MANY)
        .map(|_| Triangle::new(corner(random), corner(random), corner(random)))
        .collect();
    let case = Case::new("from a surface", Mesh::new(triangles.clone()));
    let some = (0..rays).map(|_| {
        let t = triangles[random.below(MANY)];
        let from = inside(random, &t);
        (Ray::new(from, random.float_direction()), Expected::Unknown)
    });
    vec![case.with(some)]
}
