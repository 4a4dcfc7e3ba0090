//! What the pictures of `render` show, made of nothing but batches through our own tracer.

use super::color::{self, hash, heat};
use super::engine::Engine;
use super::picture::Picture;
use dacrt::rays::MISS;
use dacrt::workloads::{Film, RayType, Rays, TILE, View, Workload, WorkloadError};
use dacrt::{Batch, Hits, Mesh};
use dacrt_validate::diff::Class;
use glam::Vec3;

/// Grey surfaces: a headlight, the point light with shadows, and a sky that shines into corners by
/// ambient occlusion, one ray of each kind a sample. Mixed in linear light.
pub fn shaded(
    workload: &mut Workload,
    mesh: &Mesh,
    engine: &mut Engine,
    view: &View,
) -> Result<Picture, WorkloadError> {
    const ALBEDO: f32 = 0.75;
    const HEADLIGHT: Vec3 = Vec3::splat(0.10);
    const SKY: Vec3 = Vec3::new(0.20, 0.23, 0.28);
    const LIGHT: Vec3 = Vec3::new(0.58, 0.53, 0.43);
    const BACKGROUND: Vec3 = Vec3::new(0.02, 0.025, 0.035);

    let film = workload.film();
    let primary = workload.rays(view.camera_rays(), &mut |b| engine.nearest(b).0)?;
    let (hits, _) = engine.nearest(&primary.batch);
    let normals: Vec<Vec3> = (0..hits.len())
        .map(|i| facing_normal(mesh, &primary.batch, &hits, i))
        .collect();

    let mut colors: Vec<Vec3> = (0..hits.len())
        .map(|i| match hits.prim[i] {
            MISS => BACKGROUND,
            _ => {
                let view = -primary.batch.ray(i).direction.normalize();
                ALBEDO * HEADLIGHT * normals[i].dot(view).max(0.0)
            }
        })
        .collect();

    let sky = workload.rays(RayType::AmbientOcclusion, &mut |b| engine.nearest(b).0)?;
    for_unoccluded(engine, &sky, |_, i| colors[i] += ALBEDO * SKY);
    if view.point_light.is_some() {
        let light = workload.rays(RayType::ShadowPoint, &mut |b| engine.nearest(b).0)?;
        for_unoccluded(engine, &light, |ray, i| {
            let to_light = -light.batch.ray(ray).direction.normalize_or_zero();
            colors[i] += ALBEDO * LIGHT * normals[i].dot(to_light).max(0.0);
        });
    }

    let mut pixels = vec![Vec3::ZERO; film.width() as usize * film.height() as usize];
    for (i, color) in colors.iter().enumerate() {
        let (x, y) = film.pixel(i);
        pixels[(y * film.width() + x) as usize] += *color / film.spp() as f32;
    }
    Ok(Picture::from_linear(film.width(), film.height(), &pixels))
}

/// Calls `light(ray, primary ray)` for each ray that nothing is in the way of.
fn for_unoccluded(engine: &mut Engine, rays: &Rays, mut light: impl FnMut(usize, usize)) {
    for (ray, occluded) in engine.any(&rays.batch).into_iter().enumerate() {
        if occluded == 0 {
            light(ray, rays.primary(ray));
        }
    }
}

/// The unit normal of what ray `i` hits, on the side that the ray comes from; zero for a miss.
fn facing_normal(mesh: &Mesh, batch: &Batch, hits: &Hits, i: usize) -> Vec3 {
    let Some(triangle) = mesh.triangles().get(hits.prim[i] as usize) else {
        return Vec3::ZERO;
    };
    let n = (triangle.b - triangle.a).cross(triangle.c - triangle.a);
    let n = n.normalize_or_zero();
    if n.dot(batch.ray(i).direction) > 0.0 {
        -n
    } else {
        n
    }
}

/// A grey for each ray, by the angle between it and what it hits; a miss is black.
pub fn flat(mesh: &Mesh, batch: &Batch, hits: &Hits, greys: &mut [u8]) {
    for (i, grey) in greys.iter_mut().enumerate() {
        let normal = facing_normal(mesh, batch, hits, i);
        let view = -batch.ray(i).direction.normalize_or_zero();
        *grey = (255.0 * normal.dot(view).clamp(0.0, 1.0)) as u8;
    }
}

/// Distance: the nearest hit is white, the farthest dark grey, a miss black.
pub fn depth(film: Film, hits: &Hits) -> Picture {
    let found = || hits.t.iter().copied().filter(|t| t.is_finite());
    let near = found().fold(f32::INFINITY, f32::min);
    let far = found().fold(0.0, f32::max);
    paint(film, |ray| match hits.t[ray] {
        t if t.is_finite() => {
            let share = (far - t) / (far - near).max(f32::MIN_POSITIVE);
            [(40.0 + 215.0 * share) as u8; 3]
        }
        _ => [0; 3],
    })
}

/// A colour for each triangle; a miss is black.
pub fn prim(film: Film, hits: &Hits) -> Picture {
    paint(film, |ray| match hits.prim[ray] {
        MISS => [0; 3],
        prim => hash(prim),
    })
}

/// Ray/box tests per ray of each tile, in false colour, and the most that a tile has.
pub fn boxes(film: Film, batch: &Batch, engine: &mut Engine) -> (Picture, f64) {
    let tile_of = |ray| {
        let (x, y) = film.pixel(ray);
        (x / TILE, y / TILE)
    };
    let rays: Vec<usize> = (0..batch.len()).collect();
    let tests: Vec<(&[usize], f64)> = rays
        .chunk_by(|a, b| tile_of(*a) == tile_of(*b))
        .map(|tile| {
            let part: Batch = tile.iter().map(|&i| batch.ray(i)).collect();
            let (_, trace) = engine.nearest(&part);
            (tile, trace.counters.ray_box as f64 / tile.len() as f64)
        })
        .collect();
    let most = tests.iter().map(|(_, n)| *n).fold(0.0, f64::max);
    let mut picture = Picture::new(film.width(), film.height());
    for (tile, n) in tests {
        let color = heat((n / most.max(f64::MIN_POSITIVE)) as f32);
        for &ray in tile {
            picture.set(film.pixel(ray), color);
        }
    }
    (picture, most)
}

/// The class of each ray; where both agree, a dark grey by the angle at which the surface is seen.
pub fn diff(film: Film, mesh: &Mesh, batch: &Batch, hits: &Hits, classes: &[Class]) -> Picture {
    let mut greys = vec![0; film.rays()];
    flat(mesh, batch, hits, &mut greys);
    paint(film, |ray| match classes[ray] {
        Class::Same => [greys[ray] / 3; 3],
        class => color::class(class),
    })
}

/// A picture with one ray a pixel.
fn paint(film: Film, color: impl Fn(usize) -> [u8; 3]) -> Picture {
    let mut picture = Picture::new(film.width(), film.height());
    for ray in 0..film.rays() {
        picture.set(film.pixel(ray), color(ray));
    }
    picture
}
