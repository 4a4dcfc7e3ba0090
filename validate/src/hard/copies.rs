//! Many triangles in one place: the lowest counts, and splitting must come to an end.

use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray, Triangle};
use glam::Vec3;

/// Identical triangles, overlapping ones in one plane, and all centres in one place. Few rays, for
/// each may hit all triangles, and the arbiter looks at every one of them.
pub fn copies(random: &mut Random, rays: usize) -> Vec<Case> {
    vec![
        identical(random, rays / 64),
        coplanar(random, rays / 8),
        concentric(random, rays / 32),
    ]
}

fn identical(random: &mut Random, rays: usize) -> Case {
    let triangle = Triangle::new(
        Vec3::new(-1.0, -1.0, 0.125),
        Vec3::new(1.0, -1.0, 0.25),
        Vec3::new(0.0, 1.0, -0.5),
    );
    let some = (0..rays).map(|_| {
        // Well inside.
        let target = (0.2 * random.point()).truncate().extend(0.0);
        let from = target + (random.point() * 0.1).with_z(3.0);
        let direction = (target - from).as_vec3();
        (Ray::new(from.as_vec3(), direction), Expected::Prim(0))
    });
    Case::new("identical", Mesh::new(vec![triangle; 300])).with(some)
}

/// Triangles of small whole numbers at z = 0, met at t = 1 exactly; which of them are met is decided
/// in whole numbers.
fn coplanar(random: &mut Random, rays: usize) -> Case {
    const SIZE: i64 = 8;
    type Corner = [i64; 2];
    let triangles: Vec<[Corner; 3]> = (0..300)
        .map(|_| std::array::from_fn(|_| std::array::from_fn(|_| random.whole(0, SIZE))))
        .collect();
    let cross = |p: Corner, q: Corner, r: Corner| {
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    let holds = |[a, b, c]: [Corner; 3], p: Corner| {
        let sides = [cross(a, b, p), cross(b, c, p), cross(c, a, p)].map(i64::signum);
        cross(a, b, c) != 0 && (!sides.contains(&1) || !sides.contains(&-1))
    };
    let corner = |p: Corner| Vec3::new(p[0] as f32, p[1] as f32, 0.0);
    let mesh = triangles.iter().map(|t| {
        let [a, b, c] = t.map(corner);
        Triangle::new(a, b, c)
    });
    let case = Case::new("in one plane", Mesh::new(mesh.collect())).without_rounding();
    let some = (0..rays).map(|_| {
        let p: Corner = std::array::from_fn(|_| random.whole(0, SIZE));
        let lowest = triangles.iter().position(|&t| holds(t, p));
        let expected = match lowest {
            Some(prim) => Expected::Is(1.0, prim as u32),
            None => Expected::Miss,
        };
        let slope = [random.whole(-1, 1), random.whole(-1, 1)];
        let direction = Vec3::new(slope[0] as f32, slope[1] as f32, -2.0);
        (Ray::new(corner(p) - direction, direction), expected)
    });
    case.with(some)
}

/// Triangles of all sizes and planes around one centre.
fn concentric(random: &mut Random, rays: usize) -> Case {
    let triangles = (0..500).map(|_| {
        let (a, b) = (random.point(), random.point());
        let size = random.power(-6, 2);
        let [a, b, c] = [a, b, -a - b].map(|p| (size * p).as_vec3());
        Triangle::new(a, b, c)
    });
    let case = Case::new("around one centre", Mesh::new(triangles.collect()));
    let some = (0..rays).map(|_| {
        let from = (6.0 * random.direction()).as_vec3();
        let target = (random.point() * random.power(-6, 0)).as_vec3();
        (Ray::new(from, target - from), Expected::Unknown)
    });
    case.with(some)
}
