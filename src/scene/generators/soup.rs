//! Random triangles of mixed sizes.

use crate::geometry::Triangle;
use crate::random;
use glam::DVec3;

/// Radius of the largest triangles, and what sets the density: the radius if `n` were 1.
const LARGEST: f64 = 0.6;
const DENSITY: f64 = 1.5;

/// Centres uniform in the cube from −1 to 1, corners uniform in a ball about the centre. The ball's
/// radius is d / √((d / 0.6)² + u (n − 1)) for uniform u and d = 1.5: every halving of the size has
/// the same total area, so sizes spread from 0.6 down to about 1.5 / √n, and there is as much to
/// see of the large ones as of the small ones.
pub(super) fn soup(triangles: usize, seed: u64) -> Vec<Triangle> {
    (0..triangles as u64)
        .map(|number| {
            let mut index = 0;
            let mut next = || {
                index += 1;
                random::unit_f64(random::hash(seed, number, index))
            };
            let mut in_cube = || DVec3::new(next(), next(), next()) * 2.0 - 1.0;
            let center = in_cube();
            let mut in_ball = || {
                loop {
                    let p = in_cube();
                    if p.length_squared() <= 1.0 {
                        return p;
                    }
                }
            };
            let corners = [in_ball(), in_ball(), in_ball()];
            let spread = (DENSITY / LARGEST) * (DENSITY / LARGEST);
            let radius = DENSITY / (spread + next() * (triangles - 1) as f64).sqrt();
            let [a, b, c] = corners.map(|p| (center + radius * p).as_vec3());
            Triangle::new(a, b, c)
        })
        .collect()
}
