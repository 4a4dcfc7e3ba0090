//! From what was measured and found on one batch to the cells of the result file.

use super::contest::Times;
use super::reference::{PeerTree, Reference};
use crate::cli::plan::Contestant;
use dacrt::Precision;
use dacrt_validate::embree::{Best, Mode, Quality, Query};
use dacrt_validate::parameters::own_fields;
use dacrt_validate::peers;
use dacrt_validate::results::{Cell, CellKey, EmbreeTimes, PeerTimes};
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
            precision: contestant.precision.name().to_owned(),
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
    peers: &[Peer],
) {
    let peers: Vec<PeerTimes> = (peers.iter().zip(&times.peers))
        .map(|(peer, traces)| peer.times(traces))
        .collect();
    let in_modes = Mode::ALL.map(|mode| (mode, Embree::new(mode, times, reference)));
    for (place, &cell) in passed.iter().enumerate() {
        if times.unstable.contains(&place) {
            continue;
        }
        let ours = &times.methods[place];
        let against = |samples: &[f64]| paired_ratio(samples, ours);
        let contestant = &contestants[cell];
        let samples_of = |other: usize| {
            let place = passed.iter().position(|&p| p == other)?;
            (!times.unstable.contains(&place)).then(|| &*times.methods[place])
        };
        let baseline = contestant.baseline.and_then(samples_of);
        let acceleration = baseline.and_then(against);
        let fast = fast(contestants, contestant).and_then(samples_of);
        let over_fast = fast.and_then(|fast| paired_ratio(ours, fast));
        let mode = Mode::against(contestant.precision);
        let (_, embree) = (in_modes.iter().find(|(m, _)| *m == mode)).expect("both modes");
        let embree = embree.as_ref();
        let total = embree.and_then(|e| against(&e.best_total_samples));
        let trace = embree.and_then(|e| against(&e.best_trace_samples));
        let cell = &mut cells[cell];
        let median_ms = middle(ours);
        cell.median_ms = Some(median_ms);
        cell.mrays_per_s = Some(cell.ray_count as f64 / median_ms / 1e3);
        cell.samples_ms = Some(ours.clone());
        cell.acceleration_ratio = acceleration.map(|r| r.ratio);
        cell.acceleration_interval = acceleration.map(|r| r.interval);
        cell.time_over_fast = over_fast.map(|r| r.ratio);
        cell.time_over_fast_interval = over_fast.map(|r| r.interval);
        cell.ratio_embree_total = total.map(|r| r.ratio);
        cell.ratio_embree_total_interval = total.map(|r| r.interval);
        cell.ratio_embree_trace = trace.map(|r| r.ratio);
        cell.ratio_embree_trace_interval = trace.map(|r| r.interval);
        cell.embree = embree.map(|e| e.times.clone());
        cell.peers = peers.clone();
    }
}

/// A tree of another library that traced the batch without panic.
pub struct Peer<'a> {
    pub built: &'a PeerTree,
    /// Rays whose hit is not ours.
    pub differing_rays: usize,
}

impl Peer<'_> {
    fn times(&self, traces: &[f64]) -> PeerTimes {
        let PeerTree {
            peer,
            tree,
            samples_ms,
        } = self.built;
        PeerTimes {
            name: peer.name.to_owned(),
            version: peer.version.to_owned(),
            builder: peer.builder.to_owned(),
            compiled_for: peers::compiled_for().to_owned(),
            build_ms: middle(samples_ms),
            trace_ms: middle(traces),
            build_samples_ms: samples_ms.clone(),
            trace_samples_ms: traces.to_vec(),
            differing_rays: self.differing_rays,
            bytes: tree.bytes(),
        }
    }
}

/// The place of the contestant that differs by its precision alone, which is `fast`.
fn fast(contestants: &[Contestant], from: &Contestant) -> Option<usize> {
    let is_it = |c: &Contestant| {
        (c.method, c.precision) == (from.method, Precision::Fast) && c.parameters == from.parameters
    };
    let place = contestants.iter().position(is_it);
    place.filter(|_| from.precision != Precision::Fast)
}

struct Embree {
    times: EmbreeTimes,
    /// Of the combination that is best with its build, the median of the build added to each.
    best_total_samples: Vec<f64>,
    best_trace_samples: Vec<f64>,
}

impl Embree {
    /// `None` if this mode was not timed.
    fn new(mode: Mode, times: &Times, reference: &Reference) -> Option<Embree> {
        let of_mode = || reference.contestants.iter().filter(|b| b.mode == mode);
        let built = of_mode().map(|b| (b.quality.name().to_owned(), b.samples_ms.clone()));
        let traced = times.embree.iter().filter(|t| t.mode == mode);
        let traced = traced.map(|t| (name(t.quality, t.query), t.samples_ms.clone()));
        let (built, traced): (BTreeMap<_, _>, BTreeMap<_, _>) = (built.collect(), traced.collect());
        let medians = |samples: &BTreeMap<String, Vec<f64>>| {
            let medians = samples.iter().map(|(name, ms)| (name.clone(), middle(ms)));
            medians.collect()
        };
        let (build_ms, trace_ms) = (medians(&built), medians(&traced));
        let samples_ms: BTreeMap<String, Vec<f64>> = traced.into_iter().chain(built).collect();
        let Best { total, trace } = Best::of(&samples_ms)?;
        let prepacked = times.prepacked.iter().filter(|t| t.mode == mode);
        Some(Embree {
            best_total_samples: total.traces.iter().map(|ms| total.build_ms + ms).collect(),
            best_trace_samples: trace.traces.to_vec(),
            times: EmbreeTimes {
                mode: Some(mode),
                best_ms: total.total_ms(),
                best_trace_ms: trace.trace_ms,
                build_ms,
                trace_ms,
                trace_prepacked_ms: prepacked
                    .map(|t| (name(t.quality, t.query), middle(&t.samples_ms)))
                    .collect(),
                bytes: of_mode()
                    .filter(|b| b.quality.name() == total.quality)
                    .map(|b| b.scene.bytes())
                    .sum(),
                samples_ms,
            },
        })
    }
}

/// `low_1`, `medium_16_coherent`, …
fn name(quality: Quality, query: Query) -> String {
    format!("{}_{}", quality.name(), query.name())
}

fn middle(samples: &[f64]) -> f64 {
    median(samples).unwrap_or(f64::NAN)
}
