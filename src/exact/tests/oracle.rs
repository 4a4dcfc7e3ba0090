//! Plain rational numbers.

use super::Pair;
use dashu_ratio::RBig;
use glam::Vec3;

pub fn rational(x: f32) -> RBig {
    RBig::try_from(x).unwrap()
}

fn vector(v: Vec3) -> [RBig; 3] {
    v.to_array().map(rational)
}

fn minus(a: &[RBig; 3], b: &[RBig; 3]) -> [RBig; 3] {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

fn dot(a: &[RBig; 3], b: &[RBig; 3]) -> RBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &[RBig; 3], b: &[RBig; 3]) -> [RBig; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

/// t of the line and the plane of the triangle, and the barycentric coordinates of the point, by
/// Cramer's rule for o + t d = a + u ab + v ac; nothing if there is no such point.
fn solve(pair: &Pair) -> Option<[RBig; 3]> {
    let [a, b, c] = [pair.triangle.a, pair.triangle.b, pair.triangle.c].map(vector);
    let (ab, ac) = (minus(&b, &a), minus(&c, &a));
    let d = vector(pair.direction);
    let back = minus(&vector(pair.origin), &a);
    // The columns −d, ab, ac.
    let along = d.clone().map(|x| -x);
    let determinant = dot(&along, &cross(&ab, &ac));
    (determinant != RBig::ZERO).then(|| {
        [
            dot(&back, &cross(&ab, &ac)) / &determinant,
            dot(&along, &cross(&back, &ac)) / &determinant,
            dot(&along, &cross(&ab, &back)) / &determinant,
        ]
    })
}

/// t of the plane, if the line crosses it in one point.
pub fn plane(pair: &Pair) -> Option<RBig> {
    solve(pair).map(|[t, ..]| t)
}

/// t, if the line meets the triangle.
pub fn meet(pair: &Pair) -> Option<RBig> {
    let [t, u, v] = solve(pair)?;
    (u >= RBig::ZERO && v >= RBig::ZERO && u + v <= RBig::ONE).then_some(t)
}

pub fn has_area(pair: &Pair) -> bool {
    let [a, b, c] = [pair.triangle.a, pair.triangle.b, pair.triangle.c].map(vector);
    cross(&minus(&b, &a), &minus(&c, &a)) != [RBig::ZERO; 3]
}

/// Panics unless `rounded` is what t rounds to: of all float32, 2¹²⁸ in place of infinity, none is
/// nearer, and of two as near it is the even one.
pub fn check_rounded(t: &RBig, rounded: f32) {
    let overflow = || RBig::from(2).pow(128);
    let value = |x: f32| match x {
        f32::INFINITY => overflow(),
        f32::NEG_INFINITY => -overflow(),
        _ => rational(x),
    };
    let distance = |x: f32| {
        let difference = t - value(x);
        if difference < RBig::ZERO {
            -difference
        } else {
            difference
        }
    };
    if rounded.is_infinite() && (rounded > 0.0) == (*t > RBig::ZERO) {
        let beyond = if rounded > 0.0 { t.clone() } else { -t };
        if beyond >= overflow() {
            return;
        }
    }
    let neighbours = [rounded.next_down(), rounded.next_up()];
    for other in neighbours {
        if other == rounded {
            continue;
        }
        let (here, there) = (distance(rounded), distance(other));
        let even = rounded.to_bits().is_multiple_of(2);
        assert!(
            here < there || (here == there && even),
            "{t} is nearer to {other:e} than to {rounded:e}"
        );
    }
}
