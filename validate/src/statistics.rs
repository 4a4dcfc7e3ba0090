//! Medians, ratios of interleaved measurements with their uncertainty, geometric means.

use serde::{Deserialize, Serialize};

/// Resamples of a bootstrap: the ends of a 95 % interval then have 50 resamples beyond each.
const RESAMPLES: usize = 2000;

/// A ratio of medians and its 95 % bootstrap interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ratio {
    /// Median of the numerators over median of the denominators.
    pub ratio: f64,
    /// Least and greatest plausible value.
    pub interval: [f64; 2],
}

/// The middle value, or the mean of the two middle values; `None` of nothing.
pub fn median(samples: &[f64]) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[half]),
        _ => Some((sorted[half - 1] + sorted[half]) / 2.0),
    }
}

/// The value below which this share of the samples is, between two of them by a straight line; `None` of
/// nothing.
pub fn quantile(samples: &[f64], share: f64) -> Option<f64> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = share.clamp(0.0, 1.0) * sorted.len().checked_sub(1)? as f64;
    let (below, above) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    Some(below + (above - below) * place.fract())
}

/// The least value; infinite of nothing.
pub fn least(samples: &[f64]) -> f64 {
    samples.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Ratio of the medians of two lists whose samples were taken in turns: the i-th of one right
/// before or after the i-th of the other.
///
/// Pairs are resampled together, so what slowed both down at one time does not widen the interval
/// (percentile bootstrap; the seed is fixed, so equal samples give equal intervals). With few
/// repeats it is narrower than it should be: of 3 pairs there are only 10 different resamples.
/// `None` if the lists are empty or differ in length.
pub fn paired_ratio(numerators: &[f64], denominators: &[f64]) -> Option<Ratio> {
    let n = numerators.len();
    if n != denominators.len() {
        return None;
    }
    let ratio = median(numerators)? / median(denominators)?;
    let mut random = fastrand::Rng::with_seed(1);
    let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
    let mut ratios: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            for k in 0..n {
                let i = random.usize(..n);
                (x[k], y[k]) = (numerators[i], denominators[i]);
            }
            median(&x).unwrap_or(f64::NAN) / median(&y).unwrap_or(f64::NAN)
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let tail = RESAMPLES / 40;
    Some(Ratio {
        ratio,
        interval: [ratios[tail], ratios[RESAMPLES - 1 - tail]],
    })
}

/// How far single measurements stray from their medians, relative to them: a pool over contestants
/// that took turns on one machine.
///
/// Three or five samples of one contestant say little about how far off their median may be: they
/// may happen to agree. Whoever takes turns with it has the same disturbances, so the deviations of
/// all are taken together, as logarithms of sample over median.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise(Vec<f64>);

impl Noise {
    /// The pool over the samples of each contestant; those with a single one tell nothing. `None`
    /// if no contestant has two.
    pub fn of<'a>(contestants: impl IntoIterator<Item = &'a [f64]>) -> Option<Noise> {
        let mut pool = Vec::new();
        for samples in contestants.into_iter().filter(|s| s.len() > 1) {
            let n = samples.len() as f64;
            // The samples are nearer to their own median than to the true one.
            let correction = (n / (n - 1.0)).sqrt();
            let middle = median(samples)?;
            pool.extend(samples.iter().map(|x| correction * (x / middle).ln()));
        }
        (!pool.is_empty()).then_some(Noise(pool))
    }

    /// What chance may make of the median of so many samples: a factor.
    pub fn of_median(&self, samples: usize, random: &mut fastrand::Rng) -> f64 {
        let mut drawn: Vec<f64> = (0..samples)
            .map(|_| self.0[random.usize(..self.0.len())])
            .collect();
        drawn.sort_by(f64::total_cmp);
        let half = samples / 2;
        match samples % 2 {
            0 => (drawn[half - 1] + drawn[half]) / 2.0,
            _ => drawn[half],
        }
        .exp()
    }
}

/// The geometric mean of positive numbers; `None` of nothing.
pub fn geometric_mean(values: &[f64]) -> Option<f64> {
    let logarithms: f64 = values.iter().map(|x| x.ln()).sum();
    (!values.is_empty()).then(|| (logarithms / values.len() as f64).exp())
}

/// Kendall's rank correlation of a list with its order, from -1 (it falls) to 1 (it rises).
pub fn rank(values: &[f64]) -> f64 {
    let pairs = (1..values.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let (mut sum, mut count) = (0.0, 0);
    for (i, j) in pairs {
        sum += match values[j].total_cmp(&values[i]) {
            std::cmp::Ordering::Greater => 1.0,
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Less => -1.0,
        };
        count += 1;
    }
    sum / f64::from(count.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[5.0, 1.0, 3.0]), Some(3.0));
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), Some(2.5));
    }

    #[test]
    fn quantiles_are_between_samples() {
        let samples = [5.0, 1.0, 3.0];
        let quantiles = [0.0, 0.25, 0.5, 1.0].map(|share| quantile(&samples, share).unwrap());
        assert_eq!(quantiles, [1.0, 2.0, 3.0, 5.0]);
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn interval_of_a_constant_ratio_is_a_point() {
        // Load that doubles both times of a pair changes no ratio within the pair.
        let slow = [2.0, 4.0, 2.0, 2.0, 4.0];
        let fast = slow.map(|x| x / 2.0);
        let r = paired_ratio(&slow, &fast).unwrap();
        assert_eq!((r.ratio, r.interval), (2.0, [2.0, 2.0]));
    }

    #[test]
    fn interval_holds_the_ratio_and_repeats() {
        let x = [1.0, 1.1, 0.9, 1.3, 1.05, 0.97, 1.2];
        let y = [0.8, 0.7, 0.9, 0.75, 0.81, 0.79, 0.72];
        let r = paired_ratio(&x, &y).unwrap();
        assert!(r.interval[0] < r.ratio && r.ratio < r.interval[1], "{r:?}");
        // No resample can lie outside these.
        assert!(
            r.interval[0] > 0.9 / 0.9 && r.interval[1] < 1.3 / 0.7,
            "{r:?}"
        );
        assert_eq!(paired_ratio(&x, &y), Some(r));
    }

    /// Coverage over many lists of 11 pairs with a known ratio of medians.
    #[test]
    fn interval_covers_about_95_percent() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut sample = |scale: f64| -> Vec<f64> {
            (0..11)
                .map(|_| scale * (1.0 + 0.1 * random.f64()))
                .collect()
        };
        let covered = (0..300)
            .filter(|_| {
                let r = paired_ratio(&sample(1.5), &sample(1.0)).unwrap();
                r.interval[0] <= 1.5 && 1.5 <= r.interval[1]
            })
            .count();
        assert!((270..300).contains(&covered), "{covered} of 300");
    }

    #[test]
    fn contestants_that_happen_to_agree_share_the_noise_of_the_others() {
        let (calm, wild) = ([1.0, 1.0, 1.0], [10.0, 20.0, 40.0]);
        assert_eq!(Noise::of([&calm[..1], &wild[..0]]), None);
        let of_calm = Noise::of([&calm[..]]).unwrap();
        let noise = Noise::of([&calm[..], &wild[..], &wild[..1]]).unwrap();
        let mut random = fastrand::Rng::with_seed(1);
        let mut least_and_most = |noise: &Noise, samples| {
            let draws = (0..1000).map(|_| noise.of_median(samples, &mut random));
            draws.fold((1.0, 1.0), |(a, b): (f64, f64), x| (a.min(x), b.max(x)))
        };
        assert_eq!(least_and_most(&of_calm, 3), (1.0, 1.0));
        // Twice or half the median, and half as much again in the exponent for 3 samples.
        let (least, most) = least_and_most(&noise, 1);
        let expected = 2f64.powf(1.5f64.sqrt());
        approx::assert_relative_eq!(most, expected, max_relative = 1e-12);
        approx::assert_relative_eq!(least, 1.0 / expected, max_relative = 1e-12);
        let (least, most) = least_and_most(&noise, 21);
        assert!(least > 0.7 && most < 1.4, "{least} {most}");
    }

    #[test]
    fn ranks_go_from_minus_one_to_one() {
        assert_eq!(rank(&[1.0, 2.0, 3.0]), 1.0);
        assert_eq!(rank(&[3.0, 2.0, 1.0]), -1.0);
        assert_eq!(rank(&[1.0, 1.0]), 0.0);
        // Five pairs rise, one falls.
        let rank = rank(&[1.22, 1.2, 1.3, 1.4]);
        approx::assert_relative_eq!(rank, 4.0 / 6.0, max_relative = 1e-12);
    }

    #[test]
    fn no_ratio_of_lists_that_do_not_pair() {
        assert_eq!(paired_ratio(&[1.0], &[1.0, 2.0]), None);
        assert_eq!(paired_ratio(&[], &[]), None);
    }

    #[test]
    fn geometric_means() {
        assert_eq!(geometric_mean(&[]), None);
        let mean = geometric_mean(&[2.0, 8.0]).unwrap();
        approx::assert_relative_eq!(mean, 4.0, max_relative = 1e-12);
    }
}
