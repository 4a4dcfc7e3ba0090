//! Steps, answers and verdicts in words.

use dacrt::{Event, MISS, Precision, Ray, Step, Sure, TriangleTest};
use dacrt_validate::judge::{Answer, Verdict, Wrong};

/// Why a ray is not valid.
pub fn why_invalid(ray: &Ray) -> &'static str {
    if !ray.origin.is_finite() {
        "its origin is not finite"
    } else if !ray.direction.is_finite() {
        "its direction is not finite"
    } else if ray.direction == glam::Vec3::ZERO {
        "its direction is zero"
    } else if ray.tmin.is_nan() || ray.tmax.is_nan() {
        "an end of its interval is not a number"
    } else if ray.tmin < 0.0 {
        "its tmin is negative"
    } else {
        "its interval is empty"
    }
}

/// What happened at a box.
pub fn event(step: &Step) -> String {
    let ([near, far], (best, _)) = (step.interval, step.best);
    match step.event {
        Event::Kept => "passes".to_owned(),
        Event::Rejected if near <= far && near > best => "rejected: behind the best t".to_owned(),
        Event::Rejected => "rejected: misses the box".to_owned(),
        Event::Skipped { ratio } => format!("passes untested, ratio {ratio:.2}"),
        Event::KeptWithCone => "passes with its cone".to_owned(),
        Event::RejectedWithCone => "rejected with its cone".to_owned(),
        Event::KeptWithGroup => "passes with its group".to_owned(),
        Event::RejectedWithGroup => "rejected with its group".to_owned(),
        Event::Empty => "no triangle in it".to_owned(),
        Event::Leaf(_) => "leaf".to_owned(),
        Event::Terminated => "done: hits before it leaves".to_owned(),
    }
}

/// What becomes of a triangle in a leaf, by the kernel of record of a precision. Of several hits in
/// one leaf the least counts.
pub fn test(test: &TriangleTest, precision: Precision, ray: &Ray, best: f32) -> String {
    match precision {
        Precision::Fast => by_float32(test, ray, best),
        _ => match (test.sure, test.exact) {
            (Sure::Miss, _) => "surely missed".to_owned(),
            (Sure::Hit, _) => in_time(test.t, ray, best)
                .unwrap_or("surely hit")
                .to_owned(),
            (Sure::Open, None) => "not sure: exactly missed".to_owned(),
            (Sure::Open, Some(t)) => {
                let hit = in_time(t, ray, best).unwrap_or("exactly hit");
                format!("not sure: {hit}")
            }
        },
    }
}

fn by_float32(test: &TriangleTest, ray: &Ray, best: f32) -> String {
    let TriangleTest {
        u,
        v,
        w,
        den,
        t,
        clip: [near, far],
        ..
    } = *test;
    let edges = [(u, "U"), (v, "V"), (w, "W")];
    let outside: Vec<&str> = edges
        .iter()
        .filter(|(x, _)| x.is_nan() || *x < 0.0)
        .map(|e| e.1)
        .collect();
    if den == 0.0 {
        "parallel".to_owned()
    } else if !outside.is_empty() {
        format!("outside {}", outside.join(" "))
    } else if let Some(why) = in_time(t, ray, best) {
        why.to_owned()
    } else if near <= t && t <= far {
        "hit".to_owned()
    } else {
        "t outside its box".to_owned()
    }
}

/// Why a hit does not count, if so.
fn in_time(t: f32, ray: &Ray, best: f32) -> Option<&'static str> {
    if !t.is_finite() {
        Some("t is not finite")
    } else if t <= ray.tmin {
        Some("not behind tmin")
    } else if t > best {
        Some(if t > ray.tmax {
            "behind tmax"
        } else {
            "behind the best t"
        })
    } else {
        None
    }
}

/// An answer, t with its bits.
pub fn answer(answer: Answer) -> String {
    match answer {
        Answer::Miss => "miss".to_owned(),
        Answer::Free => "free".to_owned(),
        Answer::Occluded => "occluded".to_owned(),
        Answer::Hit { t, prim } => format!("{prim}  {}", float(t)),
    }
}

/// What the judge says.
pub fn verdict(verdict: Verdict) -> String {
    match verdict {
        Verdict::Right => "right".to_owned(),
        Verdict::WithinBounds => "not exact, but within the bounds".to_owned(),
        Verdict::OutOfRange => "not judged: products may overflow".to_owned(),
        Verdict::Wrong(wrong) => format!("WRONG: {}", wrong_because(wrong)),
    }
}

fn wrong_because(wrong: Wrong) -> String {
    match wrong {
        Wrong::NoSuchTriangle => "no triangle that can be hit".to_owned(),
        Wrong::InvalidRay => "the ray is invalid".to_owned(),
        Wrong::NotHit => "it does not meet this triangle".to_owned(),
        Wrong::Distance { t: Some(t), .. } => format!("t is {t:e}"),
        Wrong::Distance { t: None, .. } => "parallel to the triangle".to_owned(),
        Wrong::Nearer { prim, t } => format!("{prim} is hit, at {t:e}"),
        Wrong::NothingHit => "nothing is hit".to_owned(),
    }
}

/// Best t, and its triangle.
pub fn best((t, prim): (f32, u32)) -> String {
    match (t, prim) {
        (-1.0, _) => "occluded".to_owned(),
        (t, MISS) => digits(t),
        (t, prim) => format!("{} ({prim})", digits(t)),
    }
}

/// A float32 in the fewest digits that tell it apart, and its bits.
pub fn float(x: f32) -> String {
    format!("{} {:#010x}", digits(x), x.to_bits())
}

/// A float32 in the fewest digits that tell it apart.
pub fn digits(x: f32) -> String {
    let size = x.abs();
    match size == 0.0 || (1e-3..1e6).contains(&size) || !x.is_finite() {
        true => format!("{x}"),
        false => format!("{x:e}"),
    }
}

/// A float32 in five digits.
pub fn five(x: f32) -> String {
    let size = x.abs();
    match x == 0.0 || !x.is_finite() {
        true => format!("{x}"),
        false if (1e-2..1e4).contains(&size) => format!("{x:.4}"),
        false => format!("{x:.4e}"),
    }
}
