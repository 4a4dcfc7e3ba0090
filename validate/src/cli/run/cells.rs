//! From what was measured and found on one batch to the cells of the result file.

use super::contest::Times;
use super::reference::Reference;
use crate::cli::plan::Contestant;
use dacrt_validate::embree::{Best, Quality, Query};
use dacrt_validate::parameters::own_fields;
use dacrt_validate::results::{Cell, CellKey, EmbreeTimes};
use dacrt_validate::statistics::{median, paired_ratio};
use std::collections::BTreeMap;

/// One batch: what the cells of all contestants have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchKey {
    pub scene: String,
    pub camera: String,
    pub resolution: [u32; 2],
    pub spp: u32,
    pub rays: String,
}

impl BatchKey {
    /// The key of a contestant's cell.
    pub fn cell(&self, contestant: &Contestant) -> CellKey {
        CellKey {
            scene: self.scene.clone(),
            camera: self.camera.clone(),
            resolution: self.resolution,
            spp: self.spp,
            rays: self.rays.clone(),
            method: contestant.method.name().to_owned(),
            precision: "fast".to_owned(),
            parameters: own_fields(contestant.method, &contestant.parameters),
        }
    }

    /// Whether a cell is one of this batch.
    pub fn has(&self, cell: &CellKey) -> bool {
        let BatchKey {
            scene,
            camera,
            resolution,
            spp,
            rays,
        } = self;
        (&**scene, &**camera, *resolution, *spp, &**rays) == cell.batch()
    }
}

/// Writes the times into the cells whose validation passed: `passed` are their places, in the
/// order of `times.methods`.
pub fn enter_times(
    cells: &mut [Cell],
    passed: &[usize],
    contestants: &[Contestant],
    times: &Times,
    reference: &Reference,
) {
    let embree = Embree::new(times, reference);
    for (place, &cell) in passed.iter().enumerate() {
        if times.unstable.contains(&place) {
            continue;
        }
        let ours = &times.methods[place];
        let against = |samples: &[f64]| paired_ratio(samples, ours);
        let baseline = contestants[cell].baseline;
        let baseline = baseline.and_then(|b| passed.iter().position(|&p| p == b));
        let acceleration = baseline
            .filter(|b| !times.unstable.contains(b))
            .and_then(|b| against(&times.methods[b]));
        let total = against(&embree.best_total_samples);
        let trace = against(&embree.best_trace_samples);
        let cell = &mut cells[cell];
        let median_ms = middle(ours);
        cell.median_ms = Some(median_ms);
        cell.mrays_per_s = Some(cell.ray_count as f64 / median_ms / 1e3);
        cell.samples_ms = Some(ours.clone());
        cell.acceleration_ratio = acceleration.map(|r| r.ratio);
        cell.acceleration_interval = acceleration.map(|r| r.interval);
        cell.ratio_embree_total = total.map(|r| r.ratio);
        cell.ratio_embree_total_interval = total.map(|r| r.interval);
        cell.ratio_embree_trace = trace.map(|r| r.ratio);
        cell.ratio_embree_trace_interval = trace.map(|r| r.interval);
        cell.embree = Some(embree.times.clone());
    }
}

struct Embree {
    times: EmbreeTimes,
    /// Of the combination that is best with its build, the median of the build added to each.
    best_total_samples: Vec<f64>,
    best_trace_samples: Vec<f64>,
}

impl Embree {
    fn new(times: &Times, reference: &Reference) -> Embree {
        let built = reference.contestants.iter();
        let built = built.map(|b| (b.quality.name().to_owned(), b.samples_ms.clone()));
        let traced = times.embree.iter();
        let traced = traced.map(|(quality, query, ms)| (name(*quality, *query), ms.clone()));
        let (built, traced): (BTreeMap<_, _>, BTreeMap<_, _>) = (built.collect(), traced.collect());
        let medians = |samples: &BTreeMap<String, Vec<f64>>| {
            let medians = samples.iter().map(|(name, ms)| (name.clone(), middle(ms)));
            medians.collect()
        };
        let (build_ms, trace_ms) = (medians(&built), medians(&traced));
        let samples_ms: BTreeMap<String, Vec<f64>> = traced.into_iter().chain(built).collect();
        let Best { total, trace } = Best::of(&samples_ms).expect("not all are given up");
        let bytes = reference.contestants.iter();
        let prepacked = times.prepacked.iter();
        Embree {
            best_total_samples: total.traces.iter().map(|ms| total.build_ms + ms).collect(),
            best_trace_samples: trace.traces.to_vec(),
            times: EmbreeTimes {
                best_ms: total.total_ms(),
                best_trace_ms: trace.trace_ms,
                build_ms,
                trace_ms,
                trace_prepacked_ms: prepacked
                    .map(|(quality, query, samples)| (name(*quality, *query), middle(samples)))
                    .collect(),
                bytes: bytes
                    .filter(|b| b.quality.name() == total.quality)
                    .map(|b| b.scene.bytes())
                    .sum(),
                samples_ms,
            },
        }
    }
}

/// `low_1`, `medium_16_coherent`, …
fn name(quality: Quality, query: Query) -> String {
    format!("{}_{}", quality.name(), query.name())
}

fn middle(samples: &[f64]) -> f64 {
    median(samples).unwrap_or(f64::NAN)
}
