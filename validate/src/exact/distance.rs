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

    /// In decimal, cut off after so many significant digits, an `…` behind them if there are more.
    ///
    /// # Panics
    /// If no digit is wanted, or the number is zero or negative.
    pub fn decimal(&self, digits: usize) -> String {
        let (numerator, denominator) = (self.0.numerator(), self.0.denominator());
        let numerator = UBig::try_from(numerator.clone()).expect("a positive number");
        // Of a guessed power of ten, the quotient has a digit more or less at most.
        let mut exponent = self.to_f64().log10().floor() as isize;
        loop {
            let shift = digits as isize - 1 - exponent;
            let power = UBig::from(10u8).pow(shift.unsigned_abs());
            let (over, under) = match shift {
                0.. => (&numerator * power, denominator.clone()),
                _ => (numerator.clone(), denominator * power),
            };
            let text = (&over / &under).to_string();
            match text.len().cmp(&digits) {
                Ordering::Less => exponent -= 1,
                Ordering::Greater => exponent += 1,
                Ordering::Equal => {
                    let rest = if (&over % &under).is_zero() {
                        ""
                    } else {
                        "…"
                    };
                    let (first, others) = text.split_at(1);
                    let others = match rest {
                        "" => others.trim_end_matches('0'),
                        _ => others,
                    };
                    let point = if others.is_empty() { "" } else { "." };
                    return format!("{first}{point}{others}{rest}e{exponent}");
                }
            }
        }
    }

    fn from_f32(x: f32) -> Distance {
        Distance(Relaxed::from_parts(units(x), UBig::ONE << UNIT_EXPONENT))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_cut_off() {
        let of = |a: i64, b: i64| Distance::ratio(a.into(), b.into()).decimal(5);
        assert_eq!(of(1, 3), "3.3333…e-1");
        assert_eq!(of(-2, -3), "6.6666…e-1");
        assert_eq!(of(1, 1), "1e0");
        assert_eq!(of(99_999, 10), "9.9999e3");
        assert_eq!(of(999_999, 1), "9.9999…e5");
        assert_eq!(of(123, 100_000_000), "1.23e-6");
        assert_eq!(of(1_000_000, 1), "1e6");
        let tiny = Distance::from_f32(1e-45).decimal(5);
        assert_eq!(tiny, "1.4012…e-45");
    }
}
