//! The kernel of record by brute force in plain float32, and random scenes and rays.

#![allow(dead_code)] // Not every test file uses all of it.

use dacrt::MISS;
use dacrt::{Batch, Hits, Mesh, Ray, Triangle};
use fastrand::Rng;
use glam::Vec3;

const PADDING: f32 = 1.0 / (1 << 18) as f32;

/// How the float32 kernel may be written.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    Plain,
    /// U and V for a batch with a shared origin.
    Shared,
    /// Dot and cross products of ray quantities fused.
    Fused,
}

pub const FORMS: [Form; 3] = [Form::Plain, Form::Shared, Form::Fused];

fn cross(x: Vec3, y: Vec3, form: Form) -> Vec3 {
    if let Form::Fused = form {
        let f = |a: f32, b: f32, c: f32, d: f32| a.mul_add(b, -(c * d));
        return Vec3::new(
            f(x.y, y.z, x.z, y.y),
            f(x.z, y.x, x.x, y.z),
            f(x.x, y.y, x.y, y.x),
        );
    }
    Vec3::new(
        x.y * y.z - x.z * y.y,
        x.z * y.x - x.x * y.z,
        x.x * y.y - x.y * y.x,
    )
}

fn dot(x: Vec3, y: Vec3, form: Form) -> f32 {
    match form {
        Form::Fused => x.z.mul_add(y.z, x.y.mul_add(y.y, x.x * y.x)),
        _ => x.x * y.x + x.y * y.y + x.z * y.z,
    }
}

/// The distance at which the kernel of record hits, if it does.
pub fn hit(ray: &Ray, triangle: &Triangle, form: Form) -> Option<f32> {
    let (a, b, c) = (triangle.a, triangle.b, triangle.c);
    let area = |p: Vec3, q: Vec3| p.as_dvec3() - q.as_dvec3();
    if !ray.is_valid() || !triangle.is_valid() || area(b, a).cross(area(c, a)).length() == 0.0 {
        return None;
    }
    let (o, d) = (ray.origin, ray.direction);
    let (e1, e2, to_a) = (a - b, c - a, a - o);
    let n = cross(e2, e1, Form::Plain);
    let den = dot(n, d, form);
    let (u, v) = match form {
        Form::Shared => (
            dot(d, cross(e2, to_a, Form::Plain), form),
            dot(d, cross(e1, to_a, Form::Plain), form),
        ),
        _ => {
            let r = cross(to_a, d, form);
            (dot(r, e2, form), dot(r, e1, form))
        }
    };
    let s = den.signum();
    let (u, v) = (s * u, s * v);
    if !(den != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= den.abs()) {
        return None;
    }
    let t = dot(n, to_a, form) / den;
    let (mut near, mut far) = (ray.tmin, f32::INFINITY);
    let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
    for k in 0..3 {
        let inverse = 1.0 / d[k];
        if inverse.is_finite() {
            let (t0, t1) = ((lo[k] - o[k]) * inverse, (hi[k] - o[k]) * inverse);
            near = near.max(t0.min(t1));
            far = far.min(t0.max(t1));
        } else if o[k] < lo[k] || o[k] > hi[k] {
            return None;
        }
    }
    let in_box = near * (1.0 - PADDING) <= t && t <= far * (1.0 + PADDING);
    (t > ray.tmin && t <= ray.tmax && t < f32::INFINITY && in_box).then_some(t)
}

/// The least (t, prim) over all triangles.
pub fn nearest(mesh: &Mesh, batch: &Batch, form: Form) -> Hits {
    let mut hits = Hits::misses(batch.len());
    for (i, ray) in batch.iter().enumerate() {
        for (prim, triangle) in mesh.triangles().iter().enumerate() {
            if let Some(t) = hit(&ray, triangle, form)
                && t < hits.t[i]
            {
                (hits.t[i], hits.prim[i]) = (t, prim as u32);
            }
        }
    }
    hits
}

/// 1 for each ray that hits anything.
pub fn any(mesh: &Mesh, batch: &Batch, form: Form) -> Vec<u8> {
    let hits = nearest(mesh, batch, form);
    hits.prim.iter().map(|&p| (p != MISS) as u8).collect()
}

/// A point in a cube of edge length 2 around the origin.
pub fn point(random: &mut Rng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| 2.0 * random.f32() - 1.0))
}

/// `n` triangles with edges of about `size` in a cube of edge length 2, scaled, then moved.
pub fn soup(random: &mut Rng, n: usize, size: f32, scale: f32, offset: Vec3) -> Mesh {
    let triangles = (0..n)
        .map(|_| {
            let a = point(random);
            let corner = |p: Vec3| p * scale + offset;
            let (b, c) = (a + size * point(random), a + size * point(random));
            Triangle::new(corner(a), corner(b), corner(c))
        })
        .collect();
    Mesh::new(triangles)
}

/// `n` rays from one point or from random points of the scene of [`soup`], in all directions.
pub fn rays(random: &mut Rng, n: usize, scale: f32, offset: Vec3, form: Form) -> Batch {
    let eye = point(random) * scale + offset;
    (0..n)
        .map(|_| {
            let origin = match form {
                Form::Shared => eye,
                _ => point(random) * scale + offset,
            };
            Ray::new(origin, point(random))
        })
        .collect()
}
