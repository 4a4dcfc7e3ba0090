//! Float32 numbers and vectors as whole numbers of units of 2⁻¹⁴⁹.

use dashu_int::IBig;
use glam::Vec3;

/// The unit is 2 to the power of minus this: the least positive float32.
pub const UNIT_EXPONENT: usize = 149;

/// x · 2¹⁴⁹, at most 278 bits.
///
/// # Panics
/// If `x` is not finite.
pub fn units(x: f32) -> IBig {
    assert!(x.is_finite(), "{x} is no number of units");
    let bits = x.to_bits();
    let (exponent, fraction) = ((bits >> 23) & 0xff, bits & 0x007f_ffff);
    let size = match exponent {
        0 => IBig::from(fraction),
        _ => IBig::from(fraction | 0x0080_0000) << (exponent - 1) as usize,
    };
    if x.is_sign_negative() { -size } else { size }
}

/// A vector of whole numbers: of units, or of products of units.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vector([IBig; 3]);

impl Vector {
    /// The vector in units.
    ///
    /// # Panics
    /// If a component is not finite.
    pub fn new(v: Vec3) -> Vector {
        Vector(v.to_array().map(units))
    }

    /// The difference `self − other`.
    pub fn minus(&self, other: &Vector) -> Vector {
        Vector(std::array::from_fn(|i| &self.0[i] - &other.0[i]))
    }

    /// The cross product.
    pub fn cross(&self, other: &Vector) -> Vector {
        let (x, y) = (&self.0, &other.0);
        Vector(std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            &x[j] * &y[k] - &x[k] * &y[j]
        }))
    }

    /// The dot product.
    pub fn dot(&self, other: &Vector) -> IBig {
        let products = self.0.iter().zip(&other.0).map(|(x, y)| x * y);
        products.fold(IBig::ZERO, |sum, product| sum + product)
    }

    /// Whether all components are zero.
    pub fn is_zero(&self) -> bool {
        self.0.iter().all(IBig::is_zero)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu_ratio::RBig;

    #[test]
    fn units_are_the_numbers_that_they_came_from() {
        let unit = RBig::from_parts(1.into(), dashu_int::UBig::ONE << UNIT_EXPONENT);
        let mut random = fastrand::Rng::with_seed(1);
        let some = [0.0, -0.0, 1.0, -1.5, 1e-45, -1e-40, f32::MIN_POSITIVE];
        let some = some.into_iter().chain([f32::MAX, f32::MIN]);
        let bits = (0..1000).map(|_| f32::from_bits(random.u32(..)));
        for x in some.chain(bits.filter(|x| x.is_finite())) {
            let exact = RBig::try_from(x).unwrap();
            assert_eq!(RBig::from(units(x)) * &unit, exact, "{x:e}");
        }
    }

    #[test]
    fn a_cross_product_is_perpendicular_to_both() {
        let x = Vector::new(Vec3::new(1.5, -2e20, 1e-30));
        let y = Vector::new(Vec3::new(0.1, 1e-45, 3e38));
        let z = x.cross(&y);
        assert!(!z.is_zero() && z.dot(&x).is_zero() && z.dot(&y).is_zero());
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(Vector::new);
        assert!(axes[0].cross(&axes[1]).dot(&axes[2]) > IBig::ZERO);
    }
}
