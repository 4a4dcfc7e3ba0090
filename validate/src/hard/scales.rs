//! Sizes from 1e-6 to 1e6 in one scene.

use super::meshes::{Shape, inside, on_an_edge};
use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray};
use glam::DVec3;

/// Bumpy spheres of radius 1e-6 to 1e6, none of which meets another: the largest around all, the
/// middle of each other one 2.5 radii from the origin. From inside one of them to any.
pub fn scales(random: &mut Random, rays: usize) -> Vec<Case> {
    let mut triangles = Vec::new();
    let mut spheres = Vec::new();
    for decade in -6i32..=6 {
        // Not a power of ten by `powi`, whose rounding depends on the platform.
        let ten = (0..decade.abs()).fold(1.0, |ten, _| 10.0 * ten);
        let radius = if decade < 0 { 1.0 / ten } else { ten };
        let centre = match decade {
            6 => DVec3::ZERO,
            _ => 2.5 * radius * random.direction(),
        };
        let shape = Shape::bumpy_sphere(2, decade as u64).map(|p| radius * p + centre);
        let first = triangles.len();
        triangles.extend(shape.triangles());
        spheres.push((radius, centre, first..triangles.len()));
    }
    let mesh = Mesh::new(triangles);
    let mut own = Case::new("from inside one to any", mesh.clone()).closed();
    let mut shared = Case::new("from the smallest to any", mesh.clone()).closed();
    for i in 0..rays {
        let (radius, centre, _) = &spheres[if i % 2 == 0 {
            0
        } else {
            random.below(spheres.len())
        }];
        let beside = if i % 2 == 0 {
            0.0
        } else {
            random.between(0.0, 0.4)
        };
        let from = (centre + radius * beside * random.direction()).as_vec3();
        let (_, _, range) = spheres[random.below(spheres.len())].clone();
        let of = &mesh.triangles()[range];
        let target = match random.below(2) {
            0 => on_an_edge(random, of),
            _ => {
                let t = of[random.below(of.len())];
                inside(random, &t)
            }
        };
        // The way from one sphere to another may be so short beside them that it rounds to none.
        let ray = Ray::new(from, target - from);
        let expected = if ray.is_valid() {
            Expected::Hit
        } else {
            Expected::Miss
        };
        let case = if i % 2 == 0 { &mut shared } else { &mut own };
        case.push(ray, expected);
    }
    vec![own, shared]
}
