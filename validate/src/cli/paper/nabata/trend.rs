//! How the acceleration ratio of a picture goes with its size, over cameras.

use super::image::Image;
use dacrt_validate::estimate::{self, Estimate, Quantity, View, estimate};
use dacrt_validate::statistics::geometric_mean;

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

/// Where the paper's number stands on one side of what would be no change at all: whether ours does, too.
pub fn call(ours: &Estimate, paper: f64, no_change: f64) -> Call {
    let [low, high] = ours.interval;
    let (above, below) = (low > no_change, high < no_change);
    match paper > no_change {
        true if above => Call::AsInThePaper,
        true if below => Call::NotAsInThePaper,
        false if below => Call::AsInThePaper,
        false if above => Call::NotAsInThePaper,
        _ => Call::Undecided,
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
/// rays. Of one camera the intervals tell about its repeats only.
pub fn trend(cameras: &[Vec<Image>]) -> Option<Trend> {
    let has_rays = |image: &Image| image.ratio().is_some();
    let whole = |sizes: &Vec<Image>| sizes.len() >= 2 && sizes.iter().all(has_rays);
    if !cameras.iter().all(whole) {
        return None;
    }
    let view = |sizes: &Vec<Image>| View {
        scene: String::new(),
        values: (sizes.iter())
            .map(|image| Quantity::Times(image.samples_ms.clone()))
            .collect(),
    };
    let views: Vec<View> = cameras.iter().map(view).collect();
    let quotient = estimate(&views, |seen| {
        let quotients = seen
            .iter()
            .map(|s| s.values[s.values.len() - 1] / s.values[0]);
        geometric_mean(&quotients.collect::<Vec<_>>()).unwrap_or(f64::NAN)
    });
    Some(Trend {
        quotient: quotient?,
        rank: estimate(&views, estimate::trend)?,
    })
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
    fn a_clear_rise_is_called_and_noise_is_not() {
        let rising = vec![picture([1.0, 1.01, 0.99]), picture([1.5, 1.49, 1.51])];
        let rise = trend(&[rising.clone(), rising.clone()]).unwrap();
        assert_eq!((rise.quotient.value, rise.rank.value), (1.5, 1.0));
        assert_eq!(call(&rise.quotient, 1.3, 1.0), Call::AsInThePaper);
        assert_eq!(call(&rise.quotient, 0.9, 1.0), Call::NotAsInThePaper);
        // Two cameras that tell the contrary.
        let falling: Vec<Image> = rising.iter().rev().cloned().collect();
        let mixed = trend(&[rising.clone(), falling]).unwrap();
        approx::assert_relative_eq!(mixed.quotient.value, 1.0, max_relative = 1e-12);
        assert_eq!(call(&mixed.quotient, 1.3, 1.0), Call::Undecided);
        assert_eq!(call(&mixed.rank, 1.0, 0.0), Call::Undecided);
        assert_eq!(trend(&[rising[..1].to_vec()]), None);
        assert_eq!(trend(&[]), None);
    }
}
