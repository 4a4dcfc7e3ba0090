//! An exact distance along a ray.

use super::dyadic::{UNIT_EXPONENT, units};
use dashu_int::{IBig, Sign, UBig};
use dashu_ratio::Relaxed;
use std::cmp::Ordering;

/// Where a ray meets a plane, in units of the direction's length; ordered by size.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Distance(Relaxed);

impl Distance {
    /// The ratio of two whole numbers.
    ///
    /// # Panics
    /// If the denominator is zero.
    pub fn ratio(numerator: IBig, denominator: IBig) -> Distance {
        let (sign, size) = denominator.into_parts();
        let numerator = match sign {
            Sign::Positive => numerator,
            Sign::Negative => -numerator,
        };
        Distance(Relaxed::from_parts(numerator, size))
    }

    /// How it compares with a float32.
    ///
    /// # Panics
    /// If `x` is NaN.
    pub fn cmp_f32(&self, x: f32) -> Ordering {
        match x {
            f32::INFINITY => Ordering::Less,
            f32::NEG_INFINITY => Ordering::Greater,
            _ => self.cmp(&Distance::from_f32(x)),
        }
    }

    /// The same as a float32, which is infinite if it is beyond [`f32::MAX`] by half a last digit.
    pub fn to_f32(&self) -> f32 {
        self.0.to_f32().value()
    }

    /// Rounded to the nearest float64.
    pub fn to_f64(&self) -> f64 {
        self.0.to_f64().value()
    }

    fn from_f32(x: f32) -> Distance {
        Distance(Relaxed::from_parts(units(x), UBig::ONE << UNIT_EXPONENT))
    }
}
