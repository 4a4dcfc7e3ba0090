//! Single rays from bug reports, as far as their numbers are public in text.
//!
//! Rebuilt with the reported numbers: embree#298 (coplanar ray), pbrt-v4's `Triangle.BadCases`
//! (a collinear triangle), libigl-python-bindings#78 (a unit cube), trimesh#1766 (a ray through
//! the diagonal of a square), trimesh#1496 (two cubes, rays to the corners of the greater),
//! svenstaro/bvh#140 (a box that is a point with a denormal coordinate, as a small triangle there).
//!
//! Not rebuilt, for mesh or numbers are in an attachment, or only in part in the text: embree#109,
//! #174, #181, #387, #423, mitsuba3#1149, tinybvh#168. What they describe is in the families
//! `edges`, `needles` and `grazing`; embree#387's lengths and angles are those of `grazing`.

use super::meshes::Shape;
use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray, Triangle};
use glam::Vec3;

const fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// All of them, each once.
pub fn issues(_: &mut Random, _: usize) -> Vec<Case> {
    vec![
        coplanar(),
        collinear(),
        unit_cube(),
        diagonal(),
        two_cubes(),
        point_box(),
    ]
}

fn coplanar() -> Case {
    let mesh = Mesh::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)]);
    let ray = Ray::new(v(-1.0, 0.5, 0.0), Vec3::X);
    let case = Case::new("embree#298", mesh).without_rounding();
    case.with([(ray, Expected::Miss)])
}

fn collinear() -> Case {
    let corner = |y| v(-1_113.454_6, y, -56.243_19);
    let triangle = Triangle::new(corner(-79.049_614), corner(-87.092_27), corner(-79.209_015));
    let ray = Ray {
        tmax: 0.9999,
        ..Ray::new(
            v(-1_081.479_2, 99.999_954, 87.770_11),
            v(-32.107_3, -183.355_87, -144.607_64),
        )
    };
    let case = Case::new("pbrt-v4 Triangle.BadCases", Mesh::new(vec![triangle]));
    case.with([(ray, Expected::Miss)])
}

fn unit_cube() -> Case {
    let corner = |i: u32| v((i >> 2 & 1) as f32, (i >> 1 & 1) as f32, (i & 1) as f32);
    let faces = [
        [0, 6, 4],
        [0, 2, 6],
        [0, 3, 2],
        [0, 1, 3],
        [2, 7, 6],
        [2, 3, 7],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [1, 5, 7],
        [1, 7, 3],
    ];
    let triangles = faces.map(|f| {
        let [a, b, c] = f.map(corner);
        Triangle::new(a, b, c)
    });
    let ray = Ray::new(v(0.5, 0.1, 10.0), v(0.0, 0.0, -1.0));
    let case = Case::new("libigl-python-bindings#78", Mesh::new(triangles.into())).closed();
    case.with([(ray, Expected::Is(9.0, 10))])
}

fn diagonal() -> Case {
    let corners = [
        v(-1.0, -1.0, 0.0),
        v(-1.0, 1.0, 0.0),
        v(1.0, 1.0, 0.0),
        v(1.0, -1.0, 0.0),
    ];
    let [a, b, c, d] = corners;
    let mesh = Mesh::new(vec![Triangle::new(a, b, c), Triangle::new(c, d, a)]);
    let ray = Ray::new(Vec3::Z, -Vec3::Z);
    let case = Case::new("trimesh#1766", mesh).without_rounding();
    case.with([(ray, Expected::Is(1.0, 0))])
}

fn two_cubes() -> Case {
    let mut triangles = Shape::cube(2).map(|p| 20.0 * p).triangles();
    let great = Shape::cube(4).map(|p| 30.0 * p).triangles();
    triangles.extend(&great);
    let mut case = Case::new("trimesh#1496", Mesh::new(triangles)).closed();
    for t in &great {
        // The inner cube is two thirds of the outer one.
        for corner in [t.a, t.b, t.c] {
            let ray = Ray::new(Vec3::ZERO, corner);
            case.push(ray, Expected::At(2.0 / 3.0));
        }
    }
    case
}

fn point_box() -> Case {
    let at = v(5.693_442e-39, -5000.0, 5000.0);
    let triangle = Triangle::new(at, at.with_x(-1e-40), at.with_z(5000.0f32.next_up()));
    let (o, half) = (v(-5000.0, -5000.0, 5000.0), std::f32::consts::FRAC_1_SQRT_2);
    let mut case = Case::new("svenstaro/bvh#140", Mesh::new(vec![triangle]));
    case.push(Ray::new(o, v(half, half, 0.0)), Expected::Miss);
    // In the plane y = -5000 of the triangle.
    case.push(Ray::new(o, Vec3::X), Expected::Miss);
    case
}
