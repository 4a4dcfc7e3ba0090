//! The polynomials of a ray and a triangle in whole numbers.

use super::wide::{FACTOR, Wide};
use crate::Triangle;
use glam::Vec3;
use std::cmp::Ordering;

type Vector<const LIMBS: usize> = [Wide<LIMBS>; 3];
/// Difference of two float32, or one.
pub(super) type Linear = Wide<FACTOR>;
type Quadratic = Wide<{ 2 * FACTOR }>;
type Cubic = Wide<{ 3 * FACTOR }>;
type Quartic = Wide<{ 4 * FACTOR }>;
type Sextic = Wide<{ 6 * FACTOR }>;

fn vector(a: Vec3) -> Vector<FACTOR> {
    [Wide::of(a.x), Wide::of(a.y), Wide::of(a.z)]
}

/// a − b.
fn difference(a: Vec3, b: Vec3) -> Vector<FACTOR> {
    let (mut difference, b) = (vector(a), vector(b));
    for axis in 0..3 {
        difference[axis].subtract(&b[axis]);
    }
    difference
}

fn cross(a: &Vector<FACTOR>, b: &Vector<FACTOR>) -> [Quadratic; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let mut component = Wide::ZERO;
        component.add_product(&a[i], &b[j]);
        component.subtract_product(&a[j], &b[i]);
        component
    })
}

fn dot(a: &[Quadratic; 3], b: &Vector<FACTOR>) -> Cubic {
    let mut sum = Wide::ZERO;
    for axis in 0..3 {
        sum.add_product(&a[axis], &b[axis]);
    }
    sum
}

/// Whether the corners of the triangle are not in one line.
#[cold]
pub(super) fn has_area(triangle: &Triangle) -> bool {
    let (ab, ac) = edges(triangle);
    cross(&ab, &ac)
        .iter()
        .any(|component| component.sign() != Ordering::Equal)
}

/// b − a and c − a.
fn edges(triangle: &Triangle) -> (Vector<FACTOR>, Vector<FACTOR>) {
    let &Triangle { a, b, c } = triangle;
    (difference(b, a), difference(c, a))
}

/// Whether the line of the ray meets the triangle: in one point, edges and corners included.
#[cold]
pub(super) fn meets(origin: Vec3, direction: Vec3, triangle: &Triangle) -> bool {
    let (ab, ac) = edges(triangle);
    let direction = vector(direction);
    let determinant = dot(&cross(&ab, &ac), &direction);
    if determinant.sign() == Ordering::Equal {
        return false;
    }
    // The point is a + (u ab + v ac) / determinant.
    let moment = cross(&difference(triangle.a, origin), &direction);
    let u = dot(&moment, &ac);
    let minus_v = dot(&moment, &ab);
    let mut rest = determinant;
    rest.subtract(&u);
    rest.add(&minus_v);
    let inside = determinant.sign();
    let on_or = |sign: Ordering| sign == inside || sign == Ordering::Equal;
    on_or(u.sign()) && on_or(minus_v.sign().reverse()) && on_or(rest.sign())
}

/// Where a line meets a plane: t = numerator / denominator, and the denominator is not zero.
pub(super) struct Fraction {
    numerator: Cubic,
    denominator: Cubic,
}

impl Fraction {
    /// The t of a line that meets the plane of a triangle in one point.
    #[cold]
    pub fn new(origin: Vec3, direction: Vec3, triangle: &Triangle) -> Fraction {
        let (ab, ac) = edges(triangle);
        let normal = cross(&ab, &ac);
        Fraction {
            numerator: dot(&normal, &difference(triangle.a, origin)),
            denominator: dot(&normal, &vector(direction)),
        }
    }

    /// How this t compares with another.
    pub fn cmp(&self, other: &Fraction) -> Ordering {
        let mut difference: Sextic = Wide::ZERO;
        difference.add_product(&self.numerator, &other.denominator);
        difference.subtract_product(&other.numerator, &self.denominator);
        // The difference of the two t times both denominators.
        let flipped = self.denominator.sign() != other.denominator.sign();
        signed(difference.sign(), flipped)
    }

    /// How t compares with a finite float32.
    pub fn cmp_f32(&self, t: f32) -> Ordering {
        self.cmp_scaled(&Wide::power(0), &Wide::of(t))
    }

    /// How `t * factor` compares with `other`.
    fn cmp_scaled(&self, factor: &Linear, other: &Linear) -> Ordering {
        let mut difference: Quartic = Wide::ZERO;
        difference.add_product(&self.numerator, factor);
        difference.subtract_product(&self.denominator, other);
        signed(difference.sign(), self.denominator.sign() == Ordering::Less)
    }

    /// t rounded to nearest even.
    pub fn rounded(&self) -> f32 {
        // Both numbers to 2^-50 and the quotient rounded: within 2^-48 of t. They are between 1
        // and 2^837 in size, and so far from the ends of float64.
        let size = self.numerator.to_f64().abs() / self.denominator.to_f64().abs();
        let slack = size * f64::exp2(-48.0);
        let (below, above) = ((size - slack) as f32, (size + slack) as f32);
        let rounded = if below == above {
            below
        } else {
            // Two neighbours; twice t beside their sum decides.
            let mut sum = Wide::of(below);
            sum.add(&if above.is_finite() {
                Wide::of(above)
            } else {
                Wide::power(128)
            });
            let size = Fraction {
                numerator: self.numerator.abs(),
                denominator: self.denominator.abs(),
            };
            match size.cmp_scaled(&Wide::power(1), &sum) {
                Ordering::Less => below,
                Ordering::Greater => above,
                Ordering::Equal if below.to_bits().is_multiple_of(2) => below,
                Ordering::Equal => above,
            }
        };
        let signs = [&self.numerator, &self.denominator].map(Wide::sign);
        if signs == [Ordering::Less, Ordering::Greater]
            || signs == [Ordering::Greater, Ordering::Less]
        {
            -rounded
        } else {
            rounded
        }
    }
}

/// A sign, flipped or not.
fn signed(sign: Ordering, flipped: bool) -> Ordering {
    if flipped { sign.reverse() } else { sign }
}
