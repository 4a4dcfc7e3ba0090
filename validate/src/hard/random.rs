//! Random numbers for the generators: the stream of a seed and a family's name.

use dacrt::random::{below, hash, unit_f64};
use glam::{DVec3, Vec3};

/// A stream of random numbers, the same on every machine.
pub struct Random {
    seed: u64,
    key: u64,
    index: u64,
}

impl Random {
    /// The stream of a family.
    pub fn new(seed: u64, family: &str) -> Random {
        let key = family
            .bytes()
            .fold(0, |key, byte| hash(key, byte.into(), 0));
        Random {
            seed,
            key,
            index: 0,
        }
    }

    fn bits(&mut self) -> u64 {
        self.index += 1;
        hash(self.seed, self.key, self.index)
    }

    /// A number in `0..n`.
    pub fn below(&mut self, n: usize) -> usize {
        below(self.bits(), n as u32) as usize
    }

    /// A whole number from `low` to `high`.
    pub fn whole(&mut self, low: i64, high: i64) -> i64 {
        low + self.below((high - low + 1) as usize) as i64
    }

    /// One of them.
    pub fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    /// A number from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * unit_f64(self.bits())
    }

    /// Plus or minus one.
    pub fn sign(&mut self) -> f64 {
        self.pick(&[1.0, -1.0])
    }

    /// A power of two with an exponent from `low` to `high`.
    pub fn power(&mut self, low: i32, high: i32) -> f64 {
        2f64.powi(self.whole(low.into(), high.into()) as i32)
    }

    /// A point in the cube from −1 to 1.
    pub fn point(&mut self) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|_| self.between(-1.0, 1.0)))
    }

    /// A point on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.point();
            let square = point.length_squared();
            if (1e-4..=1.0).contains(&square) {
                return point / square.sqrt();
            }
        }
    }

    /// A direction of some length, as a user of float32 has it.
    pub fn float_direction(&mut self) -> Vec3 {
        (self.direction() * self.power(-3, 3)).as_vec3()
    }
}
