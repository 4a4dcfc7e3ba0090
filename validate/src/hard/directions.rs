//! Directions with components of all sizes, and rays along planes of boxes.

use super::meshes::{Shape, on_an_edge};
use super::random::Random;
use super::{Case, Expected};
use dacrt::Ray;
use glam::{DVec3, Vec3};

/// Axis-parallel rays on a lattice of whole numbers, through a cube whose squares have their
/// corners there: the origin lies on planes of boxes, and the ray runs along others. A zero may be a
/// negative one.
pub fn box_planes(random: &mut Random, rays: usize) -> Vec<Case> {
    const HALF: i64 = 4;
    let mesh = Shape::cube(HALF as u32).map(|p| HALF as f64 * p).mesh();
    let mut within = Case::new("inside", mesh.clone())
        .closed()
        .without_rounding();
    let mut shared = Case::new("inside, one origin", mesh.clone())
        .closed()
        .without_rounding();
    let mut outside = Case::new("outside", mesh).closed().without_rounding();
    let lattice = |random: &mut Random, half: i64| {
        DVec3::from_array(std::array::from_fn(|_| random.whole(-half, half) as f64))
    };
    let along = |random: &mut Random, axis: usize, length: f64| {
        let mut direction = Vec3::from_array(std::array::from_fn(|_| 0.0 * random.sign() as f32));
        direction[axis] = length as f32;
        direction
    };
    let eye = lattice(random, HALF - 1);
    for i in 0..rays / 2 {
        let axis = random.below(3);
        let length = random.sign() * random.power(-2, 2);
        let origin = if i % 2 == 0 {
            eye
        } else {
            lattice(random, HALF - 1)
        };
        let distance = (HALF as f64 - length.signum() * origin[axis]) / length.abs();
        let ray = Ray::new(origin.as_vec3(), along(random, axis, length));
        let case = if i % 2 == 0 { &mut shared } else { &mut within };
        case.push(ray, Expected::At(distance as f32));

        // Rays along the faces themselves graze two of them, and hit those at the ends.
        let mut origin = lattice(random, HALF + 1);
        origin[axis] = -length.signum() * (HALF + 1 + random.whole(0, 3)) as f64;
        let ray = Ray::new(origin.as_vec3(), along(random, axis, length));
        let mut across = origin;
        across[axis] = 0.0;
        let expected = match across.abs().max_element() <= HALF as f64 {
            true => Expected::At(((origin[axis].abs() - HALF as f64) / length.abs()) as f32),
            false => Expected::Miss,
        };
        outside.push(ray, expected);
    }
    vec![within, shared, outside]
}

/// All mixtures of zeros, denormal and huge components, from inside a cube and a bumpy sphere.
pub fn directions(random: &mut Random, rays: usize) -> Vec<Case> {
    let sizes = [
        0.0, 1e-45, 1e-40, 1e-38, 1e-30, 1e-10, 1.0, 1e10, 1e30, 1e38, 3e38,
    ];
    let meshes = [
        ("cube", Shape::cube(4)),
        ("bumpy sphere", Shape::bumpy_sphere(3, 4)),
    ];
    let mut cases = Vec::new();
    for (name, shape) in meshes {
        let mesh = shape.mesh();
        let mut case = Case::new(name, mesh.clone()).closed();
        for _ in 0..rays / 4 {
            let direction: [f32; 3] = std::array::from_fn(|_| {
                let size: f64 = random.pick(&sizes);
                let vary = if size < 1e38 {
                    random.between(1.0, 2.0)
                } else {
                    1.0
                };
                (random.sign() * size * vary) as f32
            });
            let direction = Vec3::from_array(direction);
            let origin = (0.5 * random.direction() * random.between(0.0, 1.0)).as_vec3();
            // Of a zero direction there is no hit; if it is shorter than 1e-38, t is 2e38 and more,
            // and may not be finite.
            let expected = match direction.abs().max_element() {
                0.0 => Expected::Miss,
                length if length >= 1e-38 => Expected::Hit,
                _ => Expected::Unknown,
            };
            case.push(Ray::new(origin, direction), expected);
        }
        cases.push(case);

        // To edges, unnormalised: any length from 2⁻¹⁰⁰ to 2¹⁰⁰.
        let mut case = Case::new("unnormalised", mesh.clone()).closed();
        for _ in 0..rays / 4 {
            let target = on_an_edge(random, mesh.triangles());
            let length = random.power(-100, 100) as f32;
            case.push(Ray::new(Vec3::ZERO, target * length), Expected::Hit);
        }
        cases.push(case);
    }
    cases
}
