//! Whole numbers of a fixed number of limbs: what cannot be rounded.

use std::cmp::Ordering;

/// Bits of the size of a difference of two finite float32, in units of 2⁻¹⁴⁹: each is a whole
/// number of units below 2²⁷⁷ (2¹²⁸ of 2¹⁴⁹ units).
const DIFFERENCE_BITS: usize = 278;

/// A whole number: a sign, and a size of `LIMBS` times 64 bits.
///
/// All numbers of this module are sums of products of differences. A factor takes five limbs, so
/// that k factors take 5k: 42 bits more a factor than a product needs, and no sum here has more
/// than 2⁷ terms. So nothing overflows. Only the limbs between the lowest and the highest that are
/// not zero are worked on: one to three of five for most differences.
#[derive(Clone, Copy)]
pub(super) struct Wide<const LIMBS: usize> {
    /// The size, least limb first; all zero outside `from..to`.
    limbs: [u64; LIMBS],
    /// Place of the lowest limb that is not zero; 0 for the number 0.
    from: usize,
    /// Place behind the highest limb that is not zero; 0 for the number 0.
    to: usize,
    negative: bool,
}

/// Limbs of one factor.
pub(super) const FACTOR: usize = 5;
/// Bits that a sum of the most terms adds: a determinant has 6, a product of two 36, the difference
/// of two of these 72.
const SUM_BITS: usize = 7;
// For six factors too, as these have six times the room to spare.
const _: () = assert!(DIFFERENCE_BITS + SUM_BITS <= 64 * FACTOR);

impl Wide<FACTOR> {
    /// A finite float32 in units of 2⁻¹⁴⁹.
    pub fn of(x: f32) -> Self {
        debug_assert!(x.is_finite());
        let bits = x.to_bits();
        let (exponent, fraction) = (bits >> 23 & 0xff, u64::from(bits & 0x7f_ffff));
        // Without its hidden bit the least exponent is that of the denormal numbers.
        let size = match exponent {
            0 => Self::shifted(fraction, 0),
            _ => Self::shifted(fraction | 1 << 23, exponent as usize - 1),
        };
        Wide {
            negative: x.is_sign_negative() && size.to != 0,
            ..size
        }
    }

    /// 2^`exponent`, for an exponent from −149 to 128.
    pub fn power(exponent: i32) -> Self {
        Self::shifted(1, (exponent + 149) as usize)
    }

    /// `value << by`, for a value below 2³².
    fn shifted(value: u64, by: usize) -> Self {
        let mut limbs = [0; FACTOR];
        let (limb, bit) = (by / 64, by % 64);
        let wide = u128::from(value) << bit;
        limbs[limb] = wide as u64;
        let to = FACTOR.min(limb + 2);
        limbs[to - 1] |= (wide >> 64) as u64;
        Self::trimmed(limbs, limb, to, false)
    }
}

impl<const LIMBS: usize> Wide<LIMBS> {
    pub const ZERO: Self = Wide {
        limbs: [0; LIMBS],
        from: 0,
        to: 0,
        negative: false,
    };

    /// The number of these limbs, which are zero outside `from..to`.
    fn trimmed(limbs: [u64; LIMBS], mut from: usize, mut to: usize, negative: bool) -> Self {
        while to > from && limbs[to - 1] == 0 {
            to -= 1;
        }
        if to == from {
            return Self::ZERO;
        }
        while limbs[from] == 0 {
            from += 1;
        }
        Wide {
            limbs,
            from,
            to,
            negative,
        }
    }

    /// Less, equal to or greater than zero.
    pub fn sign(&self) -> Ordering {
        match (self.to, self.negative) {
            (0, _) => Ordering::Equal,
            (_, true) => Ordering::Less,
            (_, false) => Ordering::Greater,
        }
    }

    /// The size, least limb first.
    #[cfg(test)]
    pub fn limbs(&self) -> &[u64; LIMBS] {
        &self.limbs
    }

    /// The number without its sign.
    pub fn abs(mut self) -> Self {
        self.negative = false;
        self
    }

    /// The product of two numbers.
    fn product<const A: usize, const B: usize>(x: &Wide<A>, y: &Wide<B>) -> Self {
        const { assert!(A + B <= LIMBS) };
        if x.to == 0 || y.to == 0 {
            return Self::ZERO;
        }
        let mut limbs = [0; LIMBS];
        for i in x.from..x.to {
            let mut carry = 0;
            for j in y.from..y.to {
                let sum = u128::from(x.limbs[i]) * u128::from(y.limbs[j])
                    + u128::from(limbs[i + j])
                    + carry;
                limbs[i + j] = sum as u64;
                carry = sum >> 64;
            }
            limbs[i + y.to] = carry as u64;
        }
        Self::trimmed(
            limbs,
            x.from + y.from,
            x.to + y.to,
            x.negative != y.negative,
        )
    }

    /// Adds `x * y`.
    pub fn add_product<const A: usize, const B: usize>(&mut self, x: &Wide<A>, y: &Wide<B>) {
        self.add(&Self::product(x, y));
    }

    /// Subtracts `x * y`.
    pub fn subtract_product<const A: usize, const B: usize>(&mut self, x: &Wide<A>, y: &Wide<B>) {
        self.subtract(&Self::product(x, y));
    }

    /// Adds a number.
    pub fn add(&mut self, x: &Self) {
        self.accumulate(x, x.negative);
    }

    /// Subtracts a number.
    pub fn subtract(&mut self, x: &Self) {
        self.accumulate(x, !x.negative);
    }

    /// Adds the size of `x` with a sign of its own.
    fn accumulate(&mut self, x: &Self, negative: bool) {
        if x.to == 0 {
            return;
        }
        if self.to == 0 {
            *self = Wide { negative, ..*x };
            return;
        }
        let (from, mut to) = (self.from.min(x.from), self.to.max(x.to));
        let limbs = &mut self.limbs;
        let mut carry = false;
        if self.negative == negative {
            for (limb, &other) in limbs[from..to].iter_mut().zip(&x.limbs[from..to]) {
                let (sum, over) = limb.overflowing_add(other);
                let (sum, more) = sum.overflowing_add(u64::from(carry));
                (*limb, carry) = (sum, over || more);
            }
            if carry {
                limbs[to] = 1;
                to += 1;
            }
        } else {
            for (limb, &other) in limbs[from..to].iter_mut().zip(&x.limbs[from..to]) {
                let (rest, under) = limb.overflowing_sub(other);
                let (rest, more) = rest.overflowing_sub(u64::from(carry));
                (*limb, carry) = (rest, under || more);
            }
            // x is the larger one: what stands there is the complement of the size.
            if carry {
                self.negative = negative;
                let mut one = true;
                for limb in &mut limbs[from..to] {
                    (*limb, one) = (!*limb).overflowing_add(u64::from(one));
                }
            }
        }
        *self = Self::trimmed(self.limbs, from, to, self.negative);
    }

    /// The number in float64, no further from it than 2⁻⁵⁰ of its size. Of at most 15 limbs, so
    /// that it is below 2⁹⁶⁰.
    pub fn to_f64(self) -> f64 {
        const { assert!(LIMBS <= 3 * FACTOR) };
        if self.to == 0 {
            return 0.0;
        }
        let power = |limb: usize| f64::from_bits((1023 + 64 * limb as u64) << 52);
        let top = self.to - 1;
        let mut size = self.limbs[top] as f64 * power(top);
        if top > 0 {
            size += self.limbs[top - 1] as f64 * power(top - 1);
        }
        if self.negative { -size } else { size }
    }
}
