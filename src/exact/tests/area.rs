//! Areas beside those of rational numbers.

use super::{FAMILIES, Pair, oracle, pair};
use crate::Triangle;
use crate::exact::{has_area, whole};
use glam::Vec3;

fn check(triangle: Triangle) -> bool {
    let pair = Pair {
        origin: Vec3::ZERO,
        direction: Vec3::X,
        triangle,
    };
    let expected = oracle::has_area(&pair);
    let Triangle { a, b, c } = triangle;
    for (a, b, c) in [
        (a, b, c),
        (b, c, a),
        (c, a, b),
        (a, c, b),
        (c, b, a),
        (b, a, c),
    ] {
        let triangle = Triangle::new(a, b, c);
        assert_eq!(has_area(&triangle), expected, "{triangle:?}");
        assert_eq!(whole::has_area(&triangle), expected, "{triangle:?}");
    }
    expected
}

#[test]
fn areas_are_those_of_rational_numbers() {
    for family in 0..FAMILIES {
        let mut with = 0;
        for i in 0..1000 {
            let Triangle { a, b, c } = pair(family, i).triangle;
            with += usize::from(check(Triangle::new(a, b, c)));
            // Corners in one line, exactly or nearly.
            let middle = 0.5 * a + 0.5 * b;
            check(Triangle::new(a, b, middle));
            check(Triangle::new(a, 0.5 * a, 0.25 * a));
            check(Triangle::new(a, b, a));
            check(Triangle::new(a, b, b));
        }
        assert!(with > 500, "family {family}: {with}");
    }
}

#[test]
fn the_area_that_float64_rounds_away_is_there() {
    // The exact products of the edges differ by 1 in 2^60 or so, and 1 + 2^-60 rounds to 1.
    let tiny = f32::exp2(-60.0);
    let (a, b) = (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0));
    assert!(check(Triangle::new(a, b, Vec3::new(2.0, 2.0, tiny))));
    assert!(check(Triangle::new(Vec3::new(tiny, 0.0, 0.0), b, 2.0 * b)));
    assert!(!check(Triangle::new(a, b, 2.0 * b)));
    let tiny = f32::from_bits(1);
    assert!(check(Triangle::new(
        Vec3::new(tiny, 0.0, 0.0),
        b * 1e18,
        0.5e18 * b
    )));
    assert!(!check(Triangle::new(a, tiny * b, 3.0 * tiny * b)));
}
