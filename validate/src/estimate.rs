//! Numbers over scenes, cameras, seeds and repeats, with bootstrap intervals.

use crate::statistics::{geometric_mean, median, rank};

/// Resamples of a bootstrap: the ends of a 95 % interval have 25 resamples beyond each.
const RESAMPLES: usize = 1000;

/// A number and its 95 % bootstrap interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Of what was measured.
    pub value: f64,
    /// Least and greatest plausible value.
    pub interval: [f64; 2],
}

/// What was measured once.
#[derive(Clone, Debug, PartialEq)]
pub enum Quantity {
    /// Something without noise.
    Number(f64),
    /// Milliseconds of two that took turns; the quotient of their medians.
    Times([Vec<f64>; 2]),
}

/// One way to look at a scene, by a camera with a seed.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Name of the scene.
    pub scene: String,
    /// What was measured there, in the same order in all views.
    pub values: Vec<Quantity>,
}

/// A view with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen<'a> {
    /// Name of the scene.
    pub scene: &'a str,
    /// One for each quantity.
    pub values: Vec<f64>,
}

impl Quantity {
    /// Its number.
    pub fn value(&self) -> f64 {
        match self {
            Quantity::Number(x) => *x,
            Quantity::Times([above, below]) => quotient(above, below),
        }
    }

    /// Its number had the repeats been others.
    fn redrawn(&self, random: &mut fastrand::Rng) -> f64 {
        let Quantity::Times([above, below]) = self else {
            return self.value();
        };
        let pairs: Vec<usize> = above.iter().map(|_| random.usize(..above.len())).collect();
        let drawn = |of: &[f64]| pairs.iter().map(|&i| of[i]).collect::<Vec<_>>();
        quotient(&drawn(above), &drawn(below))
    }
}

fn quotient(above: &[f64], below: &[f64]) -> f64 {
    (median(above).zip(median(below))).map_or(f64::NAN, |(above, below)| above / below)
}

/// Items of the same key together, in the order in which they come.
pub(crate) fn grouped<'t, T, K: PartialEq>(
    items: impl Iterator<Item = &'t T>,
    key: impl Fn(&'t T) -> K,
) -> Vec<Vec<&'t T>> {
    let mut groups: Vec<Vec<&T>> = Vec::new();
    for item in items {
        match groups.iter_mut().find(|group| key(group[0]) == key(item)) {
            Some(group) => group.push(item),
            None => groups.push(vec![item]),
        }
    }
    groups
}

/// A statistic of all views, with its interval: the views of each scene are drawn anew, and the repeats of
/// each time (pairs together); the scenes are those that there are. Of one view a scene the interval tells
/// about repeats only. `None` without views.
pub fn estimate(views: &[View], statistic: impl Fn(&[Seen]) -> f64) -> Option<Estimate> {
    if views.is_empty() {
        return None;
    }
    let scenes = grouped(views.iter(), |view| &view.scene);
    let mut random = fastrand::Rng::with_seed(1);
    let mut drawn: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let mut seen = Vec::with_capacity(views.len());
            for of in &scenes {
                for _ in of {
                    let view = of[random.usize(..of.len())];
                    seen.push(Seen {
                        scene: &view.scene,
                        values: (view.values.iter())
                            .map(|value| value.redrawn(&mut random))
                            .collect(),
                    });
                }
            }
            statistic(&seen)
        })
        .collect();
    drawn.sort_by(f64::total_cmp);
    let tail = RESAMPLES / 40;
    let measured: Vec<Seen> = (views.iter())
        .map(|view| Seen {
            scene: &view.scene,
            values: view.values.iter().map(Quantity::value).collect(),
        })
        .collect();
    Some(Estimate {
        value: statistic(&measured),
        interval: [drawn[tail], drawn[RESAMPLES - 1 - tail]],
    })
}

/// The geometric mean over scenes of those over their views and values: scenes count alike.
pub fn geometric(seen: &[Seen]) -> f64 {
    let mut scenes: Vec<&str> = seen.iter().map(|s| s.scene).collect();
    scenes.sort_unstable();
    scenes.dedup();
    let of = |scene: &str| {
        let views = seen.iter().filter(|s| s.scene == scene);
        let values: Vec<f64> = views.flat_map(|s| s.values.iter().copied()).collect();
        geometric_mean(&values).unwrap_or(f64::NAN)
    };
    let means: Vec<f64> = scenes.into_iter().map(of).collect();
    geometric_mean(&means).unwrap_or(f64::NAN)
}

/// The median of all values.
pub fn middle(seen: &[Seen]) -> f64 {
    let values: Vec<f64> = seen.iter().flat_map(|s| s.values.iter().copied()).collect();
    median(&values).unwrap_or(f64::NAN)
}

/// [Kendall's correlation](rank) of each view's values with their order: the mean over views.
pub fn trend(seen: &[Seen]) -> f64 {
    let ranks: f64 = seen.iter().map(|s| rank(&s.values)).sum();
    ranks / seen.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(scene: &str, above: [f64; 3], below: [f64; 3]) -> View {
        View {
            scene: scene.to_owned(),
            values: vec![Quantity::Times([above.to_vec(), below.to_vec()])],
        }
    }

    #[test]
    fn scenes_count_alike_however_many_views_they_have() {
        let views = [
            view("a", [4.0; 3], [1.0; 3]),
            view("b", [1.0; 3], [1.0; 3]),
            view("b", [1.0; 3], [1.0; 3]),
            view("b", [1.0; 3], [1.0; 3]),
        ];
        let mean = estimate(&views, geometric).unwrap();
        approx::assert_relative_eq!(mean.value, 2.0, max_relative = 1e-12);
        assert_eq!(estimate(&[], geometric), None);
    }

    #[test]
    fn an_interval_knows_of_views_and_of_repeats() {
        let clear = [view("a", [2.0; 3], [1.0; 3]), view("a", [2.0; 3], [1.0; 3])];
        let clear = estimate(&clear, middle).unwrap();
        assert_eq!((clear.value, clear.interval), (2.0, [2.0, 2.0]));
        let views = [view("a", [2.0; 3], [1.0; 3]), view("a", [0.5; 3], [1.0; 3])];
        let [low, high] = estimate(&views, middle).unwrap().interval;
        assert!(low <= 0.5 && high >= 2.0, "{low} {high}");
        let repeats = [view("a", [1.0, 2.0, 3.0], [1.0; 3])];
        let [low, high] = estimate(&repeats, middle).unwrap().interval;
        assert!(low < 2.0 && high > 2.0, "{low} {high}");
    }

    #[test]
    fn trends_are_means_over_views() {
        let view = |values: [f64; 3]| View {
            scene: "a".to_owned(),
            values: values.map(Quantity::Number).to_vec(),
        };
        let falling = estimate(&[view([3.0, 2.0, 1.0])], trend).unwrap();
        assert_eq!(falling.value, -1.0);
        let both = [view([3.0, 2.0, 1.0]), view([1.0, 2.0, 3.0])];
        assert_eq!(estimate(&both, trend).unwrap().value, 0.0);
    }
}
