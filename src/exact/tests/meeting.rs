//! Meetings beside those of rational numbers.

use super::oracle::{self, check_rounded, rational};
use super::{FAMILIES, Pair, pair};
use crate::Triangle;
use crate::exact::estimate::Estimates;
use crate::exact::{Meeting, meet, whole};
use dashu_ratio::RBig;
use glam::Vec3;
use std::cmp::Ordering;

fn of(pair: &Pair) -> Option<Meeting> {
    meet(pair.origin, pair.direction, &pair.triangle)
}

/// The triangle with its corners in all orders.
fn orders(t: &Triangle) -> [Triangle; 6] {
    let Triangle { a, b, c } = *t;
    [
        (a, b, c),
        (b, c, a),
        (c, a, b),
        (a, c, b),
        (c, b, a),
        (b, a, c),
    ]
    .map(|(a, b, c)| Triangle::new(a, b, c))
}

/// What is wrong with t of a meeting if it is `expected`.
fn check_t(meeting: &Meeting, expected: &RBig, at: &str) {
    let (value, error) = meeting.t();
    if error.is_finite() {
        let distance = RBig::try_from(value).unwrap() - expected;
        let error = RBig::try_from(error).unwrap();
        assert!(distance <= error && -distance <= error, "{at}");
    }
    let rounded = meeting.rounded();
    check_rounded(expected, rounded);
    assert_eq!(meeting.exact().rounded(), rounded, "{at}");
    for end in [
        rounded,
        rounded.next_down(),
        rounded.next_up(),
        0.0,
        1.0,
        f32::MAX,
    ] {
        if end.is_finite() {
            let order = expected.cmp(&rational(end));
            assert_eq!(meeting.cmp_t(end), order, "{at} {end:e}");
            assert_eq!(meeting.exact().cmp_f32(end), order, "{at} {end:e}");
        }
    }
    assert_eq!(meeting.cmp_t(f32::INFINITY), Ordering::Less);
}

#[test]
fn meetings_are_those_of_rational_numbers() {
    for family in 0..FAMILIES {
        let (mut met, mut open) = (0, 0);
        for i in 0..1500 {
            let pair = pair(family, i);
            let at = format!("family {family}, {i}: {pair:?}");
            let expected = oracle::meet(&pair);
            met += usize::from(expected.is_some());
            let Pair {
                origin,
                direction,
                triangle,
            } = pair;
            open += usize::from(
                Estimates::new(origin, direction, &triangle)
                    .meets()
                    .is_none(),
            );
            for triangle in orders(&triangle) {
                let pair = Pair { triangle, ..pair };
                assert_eq!(
                    whole::meets(origin, direction, &triangle),
                    expected.is_some(),
                    "{at}"
                );
                let meeting = of(&pair);
                assert_eq!(meeting.is_some(), expected.is_some(), "{at}");
                let back = meet(origin, -direction, &triangle);
                assert_eq!(back.is_some(), expected.is_some(), "{at}");
            }
            if let (Some(meeting), Some(expected)) = (of(&pair), expected) {
                check_t(&meeting, &expected, &at);
            }
        }
        println!("family {family}: {met} meetings, {open} left open by float64");
        assert!(met > 100, "family {family}: {met}");
        assert!(open > 0 || family == 0, "family {family}");
    }
}

#[test]
fn meetings_of_one_ray_are_ordered_as_rational_numbers() {
    for family in 0..FAMILIES {
        let mut ties = 0;
        for i in 0..150 {
            let ray = pair(family, i);
            // Other planes, the same one, and one that has a corner in common.
            let mut planes = orders(&ray.triangle).to_vec();
            let Triangle { a, b, c } = ray.triangle;
            planes.push(Triangle::new(a, b, b + (b - c)));
            planes.push(Triangle::new(a, c, 0.5 * b));
            planes.extend((0..3).map(|k| pair(family, 1000 * i + k).triangle));
            let known: Vec<(Meeting, RBig)> = planes
                .iter()
                .filter_map(|&triangle| {
                    let pair = Pair { triangle, ..ray };
                    let t = oracle::plane(&pair)?;
                    Some((Meeting::known(ray.origin, ray.direction, &triangle), t))
                })
                .collect();
            for (x, s) in &known {
                for (y, t) in &known {
                    let at = format!("family {family}, {i}: {x:?} {y:?}");
                    assert_eq!(x.cmp(y), s.cmp(t), "{at}");
                    assert_eq!(x.exact().cmp(&y.exact()), s.cmp(t), "{at}");
                    ties += usize::from(s == t);
                }
            }
        }
        assert!(ties > 1000, "family {family}: {ties}");
    }
}

#[test]
fn t_of_float64_stays_within_its_bound() {
    for family in 0..FAMILIES {
        let mut finite = 0;
        for i in 0..15_000 {
            let pair = pair(family, i);
            let (value, error) = Meeting::known(pair.origin, pair.direction, &pair.triangle).t();
            if error.is_finite() {
                // No t only if N·d may be zero, and then the error is infinite.
                let t = oracle::plane(&pair).unwrap();
                let distance = RBig::try_from(value).unwrap() - t;
                let error = RBig::try_from(error).unwrap();
                assert!(
                    distance <= error && -distance <= error,
                    "{family} {i}: {pair:?}"
                );
                finite += 1;
            }
        }
        assert!(finite > 5000, "family {family}: {finite}");
    }
}

const fn triangle() -> Triangle {
    Triangle::new(
        Vec3::ZERO,
        Vec3::new(4.0, 0.0, 0.0),
        Vec3::new(0.0, 4.0, 0.0),
    )
}

#[test]
fn edges_and_corners_are_met_and_planes_are_not() {
    let down = |x: f32, y: f32| meet(Vec3::new(x, y, 3.0), Vec3::NEG_Z, &triangle());
    for (x, y) in [
        (0.0, 0.0),
        (4.0, 0.0),
        (0.0, 4.0),
        (2.0, 2.0),
        (1.0, 0.0),
        (0.0, 1.0),
        (1.0, 1.0),
    ] {
        assert_eq!(down(x, y).unwrap().rounded(), 3.0);
        assert!(down(x, y).unwrap().cmp_t(3.0).is_eq());
    }
    // The least step beyond each edge, and as far beyond each corner.
    let least = f32::from_bits(1);
    let beyond = 4.0f32.next_up();
    for (x, y) in [
        (-least, 1.0),
        (1.0, -least),
        (2.0f32.next_up(), 2.0),
        (beyond, 0.0),
        (0.0, beyond),
        (-least, -least),
    ] {
        assert!(down(x, y).is_none(), "{x} {y}");
    }
    assert!(down(least, least).is_some());
    assert!(meet(Vec3::new(1.0, 1.0, 0.0), Vec3::X, &triangle()).is_none());
    assert!(
        meet(
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::new(1.0, 0.0, least),
            &triangle()
        )
        .is_some()
    );
}

#[test]
fn halves_round_to_even_and_ends_to_zero_and_infinity() {
    // t is z over the direction's z, for one as the triangle's plane is at zero.
    let t = |z: f32, d: f32| {
        let wide = Triangle::new(
            Vec3::new(-1.0, -1.0, 0.0),
            Vec3::new(3.0, -1.0, 0.0),
            Vec3::new(-1.0, 3.0, 0.0),
        );
        meet(Vec3::new(0.0, 0.0, z), Vec3::new(0.0, 0.0, -d), &wide)
            .unwrap()
            .rounded()
    };
    let least = f32::from_bits(1);
    // Half of denormal numbers: 1/2, 3/2, 5/2 of the least one.
    assert_eq!(t(least, 2.0), 0.0);
    assert_eq!(t(3.0 * least, 2.0), 2.0 * least);
    assert_eq!(t(5.0 * least, 2.0), 2.0 * least);
    assert_eq!(t(least, f32::MAX), 0.0);
    assert_eq!(t(3.0 * least, 4.0), least);
    assert_eq!(t(f32::MAX, 1.0), f32::MAX);
    assert_eq!(t(f32::MAX, 0.5), f32::INFINITY);
    assert_eq!(t(f32::MAX, least), f32::INFINITY);
    // Just below and just above MAX and a half of its last place, 2^128 (1 − 2^-25): the plane
    // through z = 2^-25 is that far from z = 1 in units of 2^-128.
    let at = |height: f32, d: f32| {
        let plane = Triangle::new(
            Vec3::new(-1.0, -1.0, height),
            Vec3::new(3.0, -1.0, height),
            Vec3::new(-1.0, 3.0, height),
        );
        let ray = Pair {
            origin: Vec3::Z,
            direction: Vec3::new(0.0, 0.0, -d),
            triangle: plane,
        };
        let meeting = of(&ray).unwrap();
        check_rounded(&oracle::meet(&ray).unwrap(), meeting.rounded());
        meeting.rounded()
    };
    let (half, unit) = (f32::exp2(-25.0), f32::exp2(-128.0));
    assert_eq!(at(half, unit), f32::INFINITY);
    assert_eq!(at(half.next_up(), unit), f32::MAX);
    assert_eq!(at(half.next_down(), unit), f32::INFINITY);
    // 1 − 2^-25 is half-way between 1 − 2^-24 and 1, which is even; 1 − 3·2^-25 is between that
    // and 1 − 2^-23, which is even.
    assert_eq!(at(half, 1.0), 1.0);
    assert_eq!(at(half.next_up(), 1.0), 1.0f32.next_down());
    assert_eq!(at(3.0 * half, 1.0), 1.0 - 4.0 * half);
    assert_eq!(at((3.0 * half).next_down(), 1.0), 1.0 - 2.0 * half);
}
