//! Closed meshes: a ray from the inside hits something, whichever edge or corner it meets.

use super::meshes::{Shape, inside as inside_triangle, on_an_edge};
use super::random::Random;
use super::{Case, Expected};
use dacrt::{Ray, Triangle};
use glam::{DVec3, Vec3};

/// Where Embree's own test puts its meshes.
pub const FAR: DVec3 = DVec3::new(148_376.0, 1234.0, -223_423.0);

/// A segment from `from` to `to`, and on.
fn towards(from: Vec3, to: Vec3) -> Ray {
    Ray::new(from, to - from)
}

/// A point within half the radius of the bumpy sphere: inside.
fn middle(random: &mut Random) -> Vec3 {
    (0.5 * random.between(0.0, 1.0) * random.direction()).as_vec3()
}

/// At edges, from the middle, from inside and from outside.
pub fn edges(random: &mut Random, rays: usize) -> Vec<Case> {
    let mesh = Shape::bumpy_sphere(4, 1).mesh();
    let triangles = mesh.triangles().to_vec();
    let each = rays / 4;

    // A corner seen from the origin is hit at t = 1 exactly, whatever it is: all triangles around
    // it are, and the lowest counts.
    let at_corner = (0..each).map(|i| {
        let t = &triangles[i % triangles.len()];
        let corner = [t.a, t.b, t.c][i / triangles.len() % 3];
        let has = |t: &Triangle| [t.a, t.b, t.c].contains(&corner);
        let lowest = triangles.iter().position(has).expect("its own triangle");
        (
            Ray::new(Vec3::ZERO, corner),
            Expected::Is(1.0, lowest as u32),
        )
    });
    let corners = Case::new("corners from the middle", mesh.clone()).closed();
    let corners = corners.with(at_corner);

    let mut shared = Case::new("from one point inside", mesh.clone()).closed();
    let mut own = Case::new("from points inside", mesh.clone()).closed();
    let mut outside = Case::new("from outside", mesh).closed();
    let eye = middle(random);
    for _ in 0..each {
        let target = on_an_edge(random, &triangles);
        shared.push(towards(eye, target), Expected::Hit);
        let target = on_an_edge(random, &triangles);
        own.push(towards(middle(random), target), Expected::Hit);
        let target = on_an_edge(random, &triangles);
        let from = (random.direction() * random.between(1.1, 4.0)).as_vec3();
        outside.push(towards(from, target), Expected::Unknown);
    }
    vec![corners, shared, own, outside]
}

/// Random and axis-parallel rays from inside a sphere, a bumpy one and a cube.
pub fn inside(random: &mut Random, rays: usize) -> Vec<Case> {
    let meshes = [
        ("sphere", Shape::sphere(4)),
        ("bumpy sphere", Shape::bumpy_sphere(4, 2)),
        ("cube", Shape::cube(8)),
    ];
    meshes
        .into_iter()
        .map(|(name, shape)| {
            let some = (0..rays / 3).map(|_| {
                let direction = match random.below(3) {
                    0 => axis(random),
                    _ => random.float_direction(),
                };
                (Ray::new(middle(random), direction), Expected::Hit)
            });
            Case::new(name, shape.mesh()).closed().with(some)
        })
        .collect()
}

fn axis(random: &mut Random) -> Vec3 {
    let mut direction = Vec3::ZERO;
    direction[random.below(3)] = (random.sign() * random.power(-3, 3)) as f32;
    direction
}

/// The same segment from both ends: corners, origins and directions are multiples of 2⁻¹⁰ of a size
/// below 8, so every difference is exact, and the corner lies exactly halfway.
pub fn reverse(random: &mut Random, rays: usize) -> Vec<Case> {
    let rounded = |p: DVec3| (p * 1024.0).round() / 1024.0;
    let mesh = Shape::bumpy_sphere(3, 3).map(rounded).mesh();
    let triangles = mesh.triangles().to_vec();
    let mut there = Case::new("outwards", mesh.clone()).closed();
    let mut back = Case::new("inwards", mesh).closed();
    for _ in 0..rays / 2 {
        let from = rounded(middle(random).as_dvec3()).as_vec3();
        let t = triangles[random.below(triangles.len())];
        let corner = random.pick(&[t.a, t.b, t.c]);
        let direction = 2.0 * (corner - from);
        let segment = |origin, direction| Ray {
            tmax: 1.0,
            ..Ray::new(origin, direction)
        };
        // The corner is at least 0.8 from the middle and `from` at most 0.5, so the far end is at
        // least 1.1 from it: outside.
        there.push(segment(from, direction), Expected::Hit);
        back.push(segment(from + direction, -direction), Expected::Hit);
    }
    vec![there, back]
}

/// A sphere of radius 2 and a plane far from the origin.
pub fn far(random: &mut Random, rays: usize) -> Vec<Case> {
    let mut cases = far_sphere(random, rays / 2, 1.0);
    let mesh = Shape::plane(16).map(|p| 4.0 * p + FAR).mesh();
    let mut plane = Case::new("plane", mesh.clone());
    let height = |z: f64, p: DVec3| (FAR + DVec3::new(p.x, p.y, z)).as_vec3();
    for _ in 0..rays / 2 {
        let from = height(random.between(0.5, 2.0), random.point());
        let target = match random.below(2) {
            // Half of the plane at most, so that no rounding leads past its rim.
            0 => height(0.0, 2.0 * random.point()),
            _ => loop {
                let target = on_an_edge(random, mesh.triangles());
                let beside = (target.as_dvec3() - FAR).abs();
                if beside.max_element() < 3.0 {
                    break target;
                }
            },
        };
        plane.push(towards(from, target), Expected::Hit);
    }
    cases.push(plane);
    cases
}

/// Far away, times `scale`.
fn far_sphere(random: &mut Random, rays: usize, scale: f64) -> Vec<Case> {
    let at = |p: DVec3| (2.0 * p + FAR) * scale;
    let mesh = Shape::sphere(3).map(at).mesh();
    let triangles = mesh.triangles().to_vec();
    let mut shared = Case::new("sphere from its middle", mesh.clone()).closed();
    let mut own = Case::new("sphere from inside", mesh).closed();
    for i in 0..rays {
        let from = match i % 2 {
            0 => DVec3::ZERO,
            _ => 0.5 * middle(random).as_dvec3(),
        };
        let from = at(from).as_vec3();
        let t = triangles[random.below(triangles.len())];
        let ray = match random.below(4) {
            0 => Ray::new(from, (random.direction() * scale).as_vec3()),
            1 => towards(from, inside_triangle(random, &t)),
            _ => towards(from, on_an_edge(random, &triangles)),
        };
        let case = if i % 2 == 0 { &mut shared } else { &mut own };
        case.push(ray, Expected::Hit);
    }
    vec![shared, own]
}

/// Scaling by a power of two changes no rounding.
pub fn scaled(random: &mut Random, rays: usize) -> Vec<Case> {
    let mut cases = Vec::new();
    for (name, scale) in [("2^20", 2f64.powi(20)), ("2^-20", 2f64.powi(-20))] {
        let by = scale as f32;
        for mut case in edges(random, rays / 4) {
            let scaled = |t: &Triangle| Triangle::new(t.a * by, t.b * by, t.c * by);
            case.mesh = dacrt::Mesh::new(case.mesh.triangles().iter().map(scaled).collect());
            for axis in 0..3 {
                case.batch.origin[axis].iter_mut().for_each(|x| *x *= by);
                case.batch.direction[axis].iter_mut().for_each(|x| *x *= by);
            }
            case.name = name;
            cases.push(case);
        }
        cases.extend(far_sphere(random, rays / 4, scale));
    }
    cases
}
