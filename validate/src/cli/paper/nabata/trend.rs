//! How the acceleration ratio of a picture goes with its size, over cameras.

use super::image::Image;
use dacrt_validate::statistics::{geometric_mean, median};

/// Resamples of a bootstrap.
const RESAMPLES: usize = 2000;

/// A mean over cameras with its 95 % bootstrap interval: cameras are drawn anew, and the repeats of each of
/// their pictures. Of one camera it tells about its repeats only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub mean: f64,
    pub interval: [f64; 2],
}

/// Whether our sign is the paper's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Call {
    AsInThePaper,
    NotAsInThePaper,
    Undecided,
}

impl Call {
    pub fn name(self) -> &'static str {
        match self {
            Call::AsInThePaper => "as in paper",
            Call::NotAsInThePaper => "not as in paper",
            Call::Undecided => "undecided",
        }
    }
}

impl Estimate {
    /// Where the paper's number stands on one side of what would be no change at all: whether ours does,
    /// too.
    pub fn call(&self, paper: f64, no_change: f64) -> Call {
        let [low, high] = self.interval;
        let (above, below) = (low > no_change, high < no_change);
        match paper > no_change {
            true if above => Call::AsInThePaper,
            true if below => Call::NotAsInThePaper,
            false if below => Call::AsInThePaper,
            false if above => Call::NotAsInThePaper,
            _ => Call::Undecided,
        }
    }
}

/// How the ratio goes with the size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trend {
    /// The ratio at the largest size over that at the smallest: the geometric mean.
    pub quotient: Estimate,
    /// Kendall's rank correlation of ratio and size, from -1 to 1: the mean.
    pub rank: Estimate,
}

/// The trend of pictures of each camera, the smallest size first; none of less than two sizes or without
/// rays.
pub fn trend(cameras: &[Vec<Image>]) -> Option<Trend> {
    if cameras.is_empty() || cameras.iter().any(|sizes| sizes.len() < 2) {
        return None;
    }
    let ratios = |image: &Image| image.ratio().map(|ratio| ratio.ratio);
    let measured: Vec<Vec<f64>> = (cameras.iter())
        .map(|sizes| sizes.iter().map(ratios).collect())
        .collect::<Option<_>>()?;
    let mut random = fastrand::Rng::with_seed(1);
    let mut drawn: Vec<[f64; 2]> = (0..RESAMPLES)
        .map(|_| {
            let draw = |_| {
                let sizes = &cameras[random.usize(..cameras.len())];
                sizes
                    .iter()
                    .map(|image| redrawn(image, &mut random))
                    .collect()
            };
            means(&(0..cameras.len()).map(draw).collect::<Vec<_>>())
        })
        .collect();
    let [quotient, rank] = means(&measured);
    let mut estimate = |which: usize, mean| {
        drawn.sort_by(|a, b| a[which].total_cmp(&b[which]));
        let tail = RESAMPLES / 40;
        Estimate {
            mean,
            interval: [drawn[tail][which], drawn[RESAMPLES - 1 - tail][which]],
        }
    };
    Some(Trend {
        quotient: estimate(0, quotient),
        rank: estimate(1, rank),
    })
}

/// The ratio of a picture had its repeats been others.
fn redrawn(image: &Image, random: &mut fastrand::Rng) -> f64 {
    let [without, with] = &image.samples_ms;
    let pairs: Vec<usize> = without
        .iter()
        .map(|_| random.usize(..without.len()))
        .collect();
    let of = |samples: &[f64]| median(&pairs.iter().map(|&i| samples[i]).collect::<Vec<_>>());
    of(without).zip(of(with)).map_or(f64::NAN, |(a, b)| a / b)
}

/// Means of quotient and rank correlation over cameras.
fn means(cameras: &[Vec<f64>]) -> [f64; 2] {
    let quotients: Vec<f64> = cameras.iter().map(|r| r[r.len() - 1] / r[0]).collect();
    let ranks: f64 = cameras.iter().map(|ratios| rank(ratios)).sum();
    [
        geometric_mean(&quotients).unwrap_or(f64::NAN),
        ranks / cameras.len() as f64,
    ]
}

/// Kendall's rank correlation of a list with its order.
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

    fn picture(without: [f64; 3]) -> Image {
        Image {
            rays: 1,
            samples_ms: [without.to_vec(), vec![1.0; 3]],
            box_tests: [1; 2],
            triangle_tests: [1; 2],
        }
    }

    #[test]
    fn ranks_go_from_minus_one_to_one() {
        assert_eq!(rank(&[1.0, 2.0, 3.0]), 1.0);
        assert_eq!(rank(&[3.0, 2.0, 1.0]), -1.0);
        assert_eq!(rank(&[1.0, 1.0]), 0.0);
        // Sponza (c) as printed: five pairs rise, one falls.
        let rank = rank(&super::super::printed::COLUMNS[11].ratios());
        approx::assert_relative_eq!(rank, 4.0 / 6.0, max_relative = 1e-12);
    }

    #[test]
    fn a_clear_rise_is_called_and_noise_is_not() {
        let rising = vec![picture([1.0, 1.01, 0.99]), picture([1.5, 1.49, 1.51])];
        let rise = trend(&[rising.clone(), rising.clone()]).unwrap();
        assert_eq!((rise.quotient.mean, rise.rank.mean), (1.5, 1.0));
        assert_eq!(rise.quotient.call(1.3, 1.0), Call::AsInThePaper);
        assert_eq!(rise.quotient.call(0.9, 1.0), Call::NotAsInThePaper);
        // Two cameras that tell the contrary.
        let falling: Vec<Image> = rising.iter().rev().cloned().collect();
        let mixed = trend(&[rising.clone(), falling]).unwrap();
        approx::assert_relative_eq!(mixed.quotient.mean, 1.0, max_relative = 1e-12);
        assert_eq!(mixed.quotient.call(1.3, 1.0), Call::Undecided);
        assert_eq!(mixed.rank.call(1.0, 0.0), Call::Undecided);
        assert_eq!(trend(&[rising[..1].to_vec()]), None);
        assert_eq!(trend(&[]), None);
    }
}
