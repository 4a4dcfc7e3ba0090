//! The smallest and the greatest coordinates, where products of float32 under- and overflow.
//! `fast` and `watertight` promise nothing here but to end; `exact` promises all.

use super::meshes::{Shape, on_an_edge};
use super::random::Random;
use super::{Case, Expected};
use dacrt::Ray;
use glam::Vec3;

/// Closed spheres of radius 2⁻¹²⁰ to 2⁻¹³⁵, from the inside, with directions from 1e-38 to 1e38.
pub fn tiny(random: &mut Random, rays: usize) -> Vec<Case> {
    [("2^-120", -120), ("2^-126", -126), ("2^-135", -135)]
        .map(|(name, exponent)| {
            let radius = 2f64.powi(exponent);
            let mesh = Shape::bumpy_sphere(2, 5).map(|p| p * radius).mesh();
            let some = (0..rays / 3).map(|_| {
                let from = (0.4 * radius * random.point()).as_vec3();
                let ray = match random.below(3) {
                    0 => Ray::new(from, on_an_edge(random, mesh.triangles()) - from),
                    1 => Ray::new(
                        from,
                        (random.direction() * random.power(-120, 120)).as_vec3(),
                    ),
                    _ => Ray::new(Vec3::ZERO, random.float_direction()),
                };
                // Of a long direction t may round to zero. It is a hit nevertheless, for the exact t
                // is greater than tmin = 0.
                (ray, Expected::Hit)
            });
            Case::new(name, mesh.clone()).closed().with(some)
        })
        .into()
}

/// Closed spheres of radius 2³⁰, 2⁵⁵ and 2⁶⁰ (coordinates of 1.844e18 = 2⁶⁰·⁷ and more are dropped),
/// from the inside, and from as far as 1e38 through the middle.
pub fn huge(random: &mut Random, rays: usize) -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, exponent) in [("2^30", 30), ("2^55", 55), ("2^60", 60)] {
        let radius = 2f64.powi(exponent);
        let mesh = Shape::bumpy_sphere(2, 6).map(|p| p * radius).mesh();
        let mut case = Case::new(name, mesh.clone()).closed();
        for _ in 0..rays / 3 {
            match random.below(3) {
                0 => {
                    let from = (0.4 * radius * random.point()).as_vec3();
                    let ray = Ray::new(from, on_an_edge(random, mesh.triangles()) - from);
                    case.push(ray, Expected::Hit);
                }
                1 => {
                    let from = (0.4 * radius * random.point()).as_vec3();
                    let length = random.power(-60, 126);
                    let direction = (random.direction() * length).as_vec3();
                    case.push(Ray::new(from, direction), Expected::Hit);
                }
                _ => {
                    // Exactly through the middle from far away.
                    let from = (random.direction() * random.power(61, 126)).as_vec3();
                    case.push(Ray::new(from, -from), Expected::Hit);
                }
            }
        }
        cases.push(case);
    }
    cases
}
