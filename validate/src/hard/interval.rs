//! Hits at the ends of the interval: `tmin < t <= tmax`.

use super::random::Random;
use super::{Case, Expected};
use dacrt::{Mesh, Ray, Triangle};
use glam::Vec3;

/// Walls at z = 1, 2 … 8, met at t = z / d exactly, with d a power of two; the ends of the interval
/// lie on a wall, one ulp beside one, or anywhere.
pub fn interval(random: &mut Random, rays: usize) -> Vec<Case> {
    const WALLS: usize = 8;
    let wall = |z: f32| {
        let corner = |x: f32, y: f32| Vec3::new(x, y, z);
        Triangle::new(corner(-16.0, -16.0), corner(16.0, -16.0), corner(0.0, 32.0))
    };
    let mesh = Mesh::new((1..=WALLS).map(|z| wall(z as f32)).collect());
    let case = |name| Case::new(name, mesh.clone()).without_rounding();
    let (mut shared, mut own) = (case("from one point"), case("from many points"));
    for i in 0..rays {
        let speed = random.power(-3, 3);
        let end = |random: &mut Random| {
            let t = (random.whole(1, WALLS as i64) as f64 / speed) as f32;
            match random.below(10) {
                0 => t.next_up(),
                1 => t.next_down(),
                2 => 0.0,
                3 => f32::INFINITY,
                4 => f32::MAX,
                5 => random.between(0.0, 9.0 / speed) as f32,
                6 => random.pick(&[-0.0, -t, f32::NAN, f32::NEG_INFINITY, 1e-45]),
                _ => t,
            }
        };
        let tmin = end(random);
        let tmax = match random.below(8) {
            0 => tmin,
            1 => tmin.next_up(),
            _ => end(random),
        };
        let mut origin = Vec3::ZERO;
        if i % 2 == 1 {
            (origin.x, origin.y) = (random.whole(-4, 4) as f32, random.whole(-4, 4) as f32);
        }
        let ray = Ray {
            origin,
            tmin,
            direction: Vec3::new(0.0, 0.0, speed as f32),
            tmax,
        };
        let hit = (0..WALLS).find_map(|prim| {
            let t = ((prim + 1) as f64 / speed) as f32;
            (tmin >= 0.0 && tmin < t && t <= tmax).then_some(Expected::Is(t, prim as u32))
        });
        let case = if i % 2 == 0 { &mut shared } else { &mut own };
        case.push(ray, hit.unwrap_or(Expected::Miss));
    }
    vec![shared, own]
}
