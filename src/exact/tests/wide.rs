//! Whole numbers beside rational ones.

use super::oracle::rational;
use crate::exact::wide::{FACTOR, Wide};
use crate::random;
use dashu_ratio::RBig;
use std::cmp::Ordering;

/// A finite float32 of any bits; some are zero, the least, the largest.
fn float(seed: u64, i: u64) -> f32 {
    let bits = random::hash(seed, 0, i);
    match bits % 16 {
        0 => 0.0,
        1 => f32::from_bits(1),
        2 => f32::MAX,
        3 => -f32::MAX,
        4 => -0.0,
        5 => f32::MIN_POSITIVE,
        _ => {
            let x = f32::from_bits((bits >> 32) as u32);
            if x.is_finite() { x } else { 1.0 }
        }
    }
}

/// Compares the sign, and the size, of a number in units of
/// 2^(−149 `factors`).
fn check<const LIMBS: usize>(found: &Wide<LIMBS>, factors: isize, expected: &RBig) {
    assert_eq!(found.sign(), expected.cmp(&RBig::ZERO));
    // Limbs in turn, least first.
    let units = found.limbs().iter().rev().fold(RBig::ZERO, |sum, &limb| {
        sum * RBig::from(2).pow(64) + RBig::from(limb)
    });
    let expected = expected * RBig::from(2).pow(149 * factors);
    assert!(units == expected || units == -expected);
}

#[test]
fn differences_products_and_sums_are_exact() {
    for i in 0..3000 {
        let x = |k: u64| float(k, i);
        let (mut d, mut e) = (Wide::of(x(1)), Wide::of(x(3)));
        d.subtract(&Wide::of(x(2)));
        e.add(&Wide::of(x(4)));
        let (rd, re) = (
            rational(x(1)) - rational(x(2)),
            rational(x(3)) + rational(x(4)),
        );
        check(&d, 1, &rd);
        check(&e, 1, &re);
        let f = Wide::of(x(5));
        let rf = rational(x(5));

        let mut quadratic: Wide<{ 2 * FACTOR }> = Wide::ZERO;
        quadratic.add_product(&d, &e);
        quadratic.subtract_product(&f, &e);
        let rq = &rd * &re - &rf * &re;
        check(&quadratic, 2, &rq);

        let mut cubic: Wide<{ 3 * FACTOR }> = Wide::ZERO;
        cubic.add_product(&quadratic, &d);
        cubic.subtract_product(&quadratic, &f);
        cubic.add_product(&quadratic, &e);
        let rc = &rq * (&rd - &rf + &re);
        check(&cubic, 3, &rc);
        // In units of 2^-447.
        let units = &rc * RBig::from(2).pow(447);
        let near = RBig::try_from(cubic.to_f64()).unwrap();
        let error = &near - &units;
        let (scaled, size) = (&error * RBig::from(2).pow(50), &units);
        assert!(
            &scaled * &scaled <= size * size,
            "{near} is not near {units}"
        );

        // What is to be zero is.
        let mut zero = cubic;
        zero.subtract(&cubic);
        assert_eq!(zero.sign(), Ordering::Equal);
        let mut sextic: Wide<{ 6 * FACTOR }> = Wide::ZERO;
        sextic.add_product(&cubic, &cubic);
        assert_eq!(
            sextic.sign(),
            if rc == RBig::ZERO {
                Ordering::Equal
            } else {
                Ordering::Greater
            }
        );
        sextic.subtract_product(&cubic, &cubic);
        assert_eq!(sextic.sign(), Ordering::Equal);
    }
}

#[test]
fn one_unit_in_the_last_place_is_told_apart() {
    // Sums that differ by the least float32, beside the largest one.
    for k in [0.0, 1.0, 1e-38, 1e38, f32::MAX] {
        let least = f32::from_bits(1);
        let mut sum = Wide::of(k);
        sum.add(&Wide::of(least));
        sum.subtract(&Wide::of(k));
        sum.subtract(&Wide::of(least));
        assert_eq!(sum.sign(), Ordering::Equal);
        sum.subtract(&Wide::of(least));
        assert_eq!(sum.sign(), Ordering::Less);
        let mut sum = Wide::of(-k);
        sum.add(&Wide::of(least));
        sum.add(&Wide::of(k));
        assert_eq!(sum.sign(), Ordering::Greater);
    }
}

#[test]
fn powers_of_two_are_float32_of_the_same_value() {
    for exponent in -149..=127 {
        let mut power = Wide::power(exponent);
        let float = f64::exp2(f64::from(exponent)) as f32;
        power.subtract(&Wide::of(float));
        assert_eq!(power.sign(), Ordering::Equal, "2^{exponent}");
    }
    // One more than float32 has.
    let mut power = Wide::power(128);
    power.subtract(&Wide::of(f32::MAX));
    power.subtract(&Wide::of(f64::exp2(104.0) as f32));
    assert_eq!(power.sign(), Ordering::Equal);
}
