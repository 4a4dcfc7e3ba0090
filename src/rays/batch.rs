//! All rays of one query.

use glam::Vec3;

/// One ray: `origin + t * direction` for `tmin < t <= tmax`, `t` in units of the direction's length.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Where the ray starts.
    pub origin: Vec3,
    /// Lower end of the interval, exclusive, at least 0.
    pub tmin: f32,
    /// Direction of any length but zero.
    pub direction: Vec3,
    /// Upper end of the interval, inclusive; may be infinite.
    pub tmax: f32,
}

impl Ray {
    /// A ray from `origin` along `direction` for all `t > 0`.
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray {
            origin,
            tmin: 0.0,
            direction,
            tmax: f32::INFINITY,
        }
    }

    /// Whether the ray takes part: finite origin and direction, a direction that is not zero,
    /// `0 <= tmin < tmax`. Any other ray is a miss.
    pub fn is_valid(&self) -> bool {
        // NaN fails every one of these.
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.direction != Vec3::ZERO
            && self.tmin >= 0.0
            && self.tmin < self.tmax
    }
}

/// All rays of one query, structure of arrays. 32 bytes a ray.
#[derive(Clone, Debug, Default)]
pub struct Batch {
    /// Origins: x, y and z.
    pub origin: [Vec<f32>; 3],
    /// Directions: x, y and z.
    pub direction: [Vec<f32>; 3],
    /// Lower ends of the intervals.
    pub tmin: Vec<f32>,
    /// Upper ends of the intervals.
    pub tmax: Vec<f32>,
}

impl Batch {
    /// An empty batch with room for `n` rays.
    pub fn with_capacity(n: usize) -> Batch {
        let room = || Vec::with_capacity(n);
        Batch {
            origin: [room(), room(), room()],
            direction: [room(), room(), room()],
            tmin: room(),
            tmax: room(),
        }
    }

    /// Adds a ray at the end.
    pub fn push(&mut self, ray: Ray) {
        for axis in 0..3 {
            self.origin[axis].push(ray.origin[axis]);
            self.direction[axis].push(ray.direction[axis]);
        }
        self.tmin.push(ray.tmin);
        self.tmax.push(ray.tmax);
    }

    /// Number of rays, invalid ones included.
    pub fn len(&self) -> usize {
        self.tmin.len()
    }

    /// Whether there is no ray at all.
    pub fn is_empty(&self) -> bool {
        self.tmin.is_empty()
    }

    /// The ray at place `i`.
    ///
    /// # Panics
    /// If `i` is not below [`Batch::len`].
    pub fn ray(&self, i: usize) -> Ray {
        Ray {
            origin: Vec3::new(self.origin[0][i], self.origin[1][i], self.origin[2][i]),
            tmin: self.tmin[i],
            direction: Vec3::new(
                self.direction[0][i],
                self.direction[1][i],
                self.direction[2][i],
            ),
            tmax: self.tmax[i],
        }
    }

    /// All rays in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Ray> + '_ {
        (0..self.len()).map(|i| self.ray(i))
    }

    /// The origin that all valid rays have in common to the bit, if they do and there is one.
    pub fn shared_origin(&self) -> Option<Vec3> {
        let bits = |v: Vec3| v.to_array().map(f32::to_bits);
        let mut valid = self.iter().filter(Ray::is_valid);
        let first = valid.next()?.origin;
        valid
            .all(|r| bits(r.origin) == bits(first))
            .then_some(first)
    }
}

impl FromIterator<Ray> for Batch {
    fn from_iter<I: IntoIterator<Item = Ray>>(rays: I) -> Batch {
        let rays = rays.into_iter();
        let mut batch = Batch::with_capacity(rays.size_hint().0);
        rays.for_each(|r| batch.push(r));
        batch
    }
}
