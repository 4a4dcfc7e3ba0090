//! Which of the measured combinations of build quality and query is Embree at its best.

use crate::statistics::median;
use std::collections::BTreeMap;

/// The combinations that others are set against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best<'a> {
    /// Least median build + median trace.
    pub total: Combination<'a>,
    /// Least median trace.
    pub trace: Combination<'a>,
}

/// One build quality with one query; times in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Combination<'a> {
    /// Name of the quality.
    pub quality: &'a str,
    /// Every build of this quality.
    pub builds: &'a [f64],
    /// Their median.
    pub build_ms: f64,
    /// Every trace.
    pub traces: &'a [f64],
    /// Their median.
    pub trace_ms: f64,
}

impl Combination<'_> {
    /// Median build + median trace.
    pub fn total_ms(&self) -> f64 {
        self.build_ms + self.trace_ms
    }
}

impl<'a> Best<'a> {
    /// Picks them from the samples as a result file has them: of builds under the name of the
    /// quality (`low`), of traces under quality and query (`low_16_coherent`). Traces that were
    /// given up have fewer samples than others, and are out of the running. `None` if there is no
    /// trace whose build is there, too.
    pub fn of(samples_ms: &'a BTreeMap<String, Vec<f64>>) -> Option<Best<'a>> {
        let combinations: Vec<Combination> = (samples_ms.iter())
            .filter_map(|(name, traces)| {
                let (quality, _) = name.split_once('_')?;
                let builds = samples_ms.get(quality)?;
                Some(Combination {
                    quality,
                    builds,
                    build_ms: median(builds)?,
                    traces,
                    trace_ms: median(traces)?,
                })
            })
            .collect();
        let rounds = combinations.iter().map(|c| c.traces.len()).max()?;
        let least = |time: fn(&Combination) -> f64| {
            let whole = combinations.iter().filter(|c| c.traces.len() == rounds);
            whole.min_by(|a, b| time(a).total_cmp(&time(b))).copied()
        };
        Some(Best {
            total: least(|c| c.total_ms())?,
            trace: least(|c| c.trace_ms)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(of: &[(&str, &[f64])]) -> BTreeMap<String, Vec<f64>> {
        let own = |(name, samples): &(&str, &[f64])| (name.to_string(), samples.to_vec());
        of.iter().map(own).collect()
    }

    #[test]
    fn the_best_total_may_be_another_than_the_best_trace() {
        let samples = samples(&[
            ("low", &[1.0, 1.0]),
            ("high", &[9.0]),
            ("low_1", &[5.0, 5.0]),
            ("low_16_coherent", &[4.0, 6.0, 5.0]),
            ("high_1", &[3.0, 3.0, 4.0]),
            // Given up after a round, which was a lucky one.
            ("high_16", &[2.0]),
        ]);
        let best = Best::of(&samples).unwrap();
        assert_eq!((best.total.quality, best.total.total_ms()), ("low", 6.0));
        assert_eq!(best.total.traces, [4.0, 6.0, 5.0]);
        assert_eq!((best.trace.quality, best.trace.trace_ms), ("high", 3.0));
    }

    #[test]
    fn nothing_is_best_of_nothing() {
        assert_eq!(Best::of(&samples(&[])), None);
        assert_eq!(Best::of(&samples(&[("low", &[1.0])])), None);
        assert_eq!(Best::of(&samples(&[("low_1", &[1.0])])), None);
    }
}
