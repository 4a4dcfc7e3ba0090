//! Triangles without much of an area, and with none.

use super::meshes::{inside, on_an_edge};
use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray, Triangle};
use glam::{DVec3, Vec3};

/// Needles (one edge a millionth of the others), slivers (one corner a millionth off the opposite
/// edge), and axis-parallel ones, whose box has no thickness; aimed at, and just past.
pub fn needles(random: &mut Random, rays: usize) -> Vec<Case> {
    const MANY: usize = 500;
    let mut cases = Vec::new();
    for (name, kind) in [("needles", 0), ("slivers", 1), ("flat boxes", 2)] {
        let triangles: Vec<Triangle> = (0..MANY)
            .map(|_| {
                let a = random.point();
                let (mut along, mut off) = (random.direction(), 1e-6 * random.direction());
                if kind == 2 {
                    let axis = random.below(3);
                    (along[axis], off[axis]) = (0.0, 0.0);
                }
                let c = match kind {
                    0 => along + off,
                    1 => random.between(0.2, 0.8) * along + off,
                    _ => random.pick(&[along + off, 0.5 * along + 1e3 * off]),
                };
                let [a, b, c] = [a, a + along, a + c].map(|p| p.as_vec3());
                match kind {
                    // Rounded, the corners would leave the plane.
                    2 => {
                        let axis = (0..3).find(|&k| along[k] == 0.0).expect("the flat axis");
                        let mut flat = [a, b, c];
                        flat.iter_mut().for_each(|p| p[axis] = a[axis]);
                        Triangle::new(flat[0], flat[1], flat[2])
                    }
                    _ => Triangle::new(a, b, c),
                }
            })
            .collect();
        let mut case = Case::new(name, Mesh::new(triangles.clone()));
        for _ in 0..rays / 3 {
            let t = triangles[random.below(MANY)];
            let target = match random.below(4) {
                0 => on_an_edge(random, &triangles),
                1 => (inside(random, &t).as_dvec3() + 1e-6 * random.point()).as_vec3(),
                _ => inside(random, &t),
            };
            let from = (2.0 * random.point()).as_vec3();
            case.push(Ray::new(from, target - from), Expected::Unknown);
        }
        cases.push(case);
    }
    cases
}

/// Points, segments and collinear corners, aimed at: multiples of 2⁻⁸, so that the corners are in
/// one line exactly.
pub fn no_area(random: &mut Random, rays: usize) -> Vec<Case> {
    const MANY: usize = 300;
    let lattice = |random: &mut Random, n: i64| {
        let cell = |_| random.whole(-n, n) as f64 / 256.0;
        DVec3::from_array(std::array::from_fn(cell))
    };
    let triangles: Vec<Triangle> = (0..MANY)
        .map(|i| {
            let (a, step) = (lattice(random, 512), lattice(random, 32));
            let (m, n) = match i % 3 {
                0 => (0, 0),
                1 => (random.whole(0, 1) * 8, 8),
                _ => (random.whole(-9, 9), random.whole(-9, 9)),
            };
            let [a, b, c] = [a, a + m as f64 * step, a + n as f64 * step].map(|p| p.as_vec3());
            Triangle::new(a, b, c)
        })
        .collect();
    let mut own = Case::new("from many points", Mesh::new(triangles.clone()));
    let mut shared = Case::new("from one point", own.mesh.clone());
    let eye = Vec3::new(5.5, -3.25, 4.125);
    for i in 0..rays {
        let t = triangles[random.below(MANY)];
        let target = random.pick(&[t.a, t.b, t.c, (t.a + t.b) / 2.0, (t.b + t.c) / 2.0]);
        if i % 2 == 0 {
            shared.push(Ray::new(eye, target - eye), Expected::Miss);
        } else {
            let from = (4.0 * random.point()).as_vec3();
            own.push(Ray::new(from, target - from), Expected::Miss);
        }
    }
    vec![own, shared]
}
