//! The timed part: our methods and Embree take turns on one batch.

use super::answers::Answers;
use super::reference::{Built, Reference};
use crate::cli::engine::Workspaces;
use dacrt::{Batch, Mesh, Parameters, Tracer};
use dacrt_validate::embree::{Quality, Query};
use dacrt_validate::measure::{interleave, milliseconds};
use dacrt_validate::statistics::least;
use std::convert::Infallible;

/// How many combinations of build quality and query are given up after one measured round.
const GIVE_UP: usize = 2;
/// Rounds of the measurement without Embree's filling and reading back.
const PREPACKED_REPEATS: usize = 3;

/// A tracer whose answers have been validated.
pub struct Entrant {
    /// Its place among the contestants of the round.
    pub place: usize,
    pub parameters: Parameters,
    pub tracer: Tracer,
    pub answers: Answers,
}

/// Everything that was measured on one batch, in milliseconds.
pub struct Times {
    /// For each entrant.
    pub methods: Vec<Vec<f64>>,
    /// For each quality and query.
    pub embree: Vec<(Quality, Query, Vec<f64>)>,
    /// For each query on the quality that it is fastest on.
    pub prepacked: Vec<(Quality, Query, Vec<f64>)>,
    /// Entrants whose answers were once not those that had been validated.
    pub unstable: Vec<usize>,
}

/// Measures the entrants and all of Embree.
pub fn contest(
    mesh: &Mesh,
    batch: &Batch,
    entrants: &[Entrant],
    workspaces: &mut Workspaces,
    reference: &Reference,
    any: bool,
    repeats: u32,
) -> Times {
    let ours = entrants.len();
    let combinations: Vec<(usize, Query)> = (0..reference.contestants.len())
        .flat_map(|quality| Query::ALL.map(|query| (quality, query)))
        .collect();
    let mut answers = Answers::room(batch.len(), any);
    let mut unstable = Vec::new();
    let run = |i: usize| -> Result<f64, Infallible> {
        let Some(entrant) = entrants.get(i) else {
            let (quality, query) = combinations[i - ours];
            let scene = &reference.contestants[quality].scene;
            return Ok(milliseconds(|| answers.trace_embree(scene, batch, query)).1);
        };
        let workspace = workspaces.of(&entrant.parameters);
        let (_, ms) = milliseconds(|| answers.trace(&entrant.tracer, mesh, batch, workspace));
        if answers != entrant.answers && !unstable.contains(&i) {
            unstable.push(i);
        }
        Ok(ms)
    };
    let give_up = |first: &[Vec<f64>]| {
        let embree: Vec<f64> = first[ours..].iter().map(|s| s[0]).collect();
        let out = hopeless(&embree, &combinations);
        out.into_iter().map(|i| i + ours).collect()
    };
    let Ok(mut samples) = interleave(ours + combinations.len(), repeats as usize, run, give_up);
    let embree_samples = samples.split_off(ours);

    let prepacked = Query::ALL.map(|query| {
        let of_query = combinations.iter().zip(&embree_samples);
        let fastest = of_query
            .filter(|((_, q), _)| *q == query)
            .min_by(|(_, a), (_, b)| least(a).total_cmp(&least(b)));
        let ((quality, _), _) = fastest.expect("every query is measured");
        let Built { quality, scene, .. } = &reference.contestants[*quality];
        let mut packed = scene.pack(batch, query);
        let times = (0..PREPACKED_REPEATS).map(|_| {
            packed.reset();
            milliseconds(|| scene.trace_packed(&mut packed, any)).1
        });
        (*quality, query, times.collect())
    });
    let embree = combinations.iter().zip(embree_samples);
    Times {
        methods: samples,
        embree: embree
            .map(|(&(quality, query), s)| (reference.contestants[quality].quality, query, s))
            .collect(),
        prepacked: prepacked.into(),
        unstable,
    }
}

/// The slowest combinations that another query on the same build beats, so that neither Embree's
/// best trace nor its best sum of build and trace can be among them.
fn hopeless(first_ms: &[f64], combinations: &[(usize, Query)]) -> Vec<usize> {
    let beaten = |&i: &usize| {
        let same_build = (0..first_ms.len()).filter(|&j| combinations[j].0 == combinations[i].0);
        same_build.into_iter().any(|j| first_ms[j] < first_ms[i])
    };
    let mut slow: Vec<usize> = (0..first_ms.len()).filter(beaten).collect();
    slow.sort_by(|&a, &b| first_ms[b].total_cmp(&first_ms[a]));
    slow.truncate(GIVE_UP);
    slow
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_another_query_beats_is_given_up() {
        let all = [Query::Single, Query::Packet16, Query::Packet16Coherent];
        let combinations: Vec<_> = (0..3).flat_map(|b| all.map(|q| (b, q))).collect();
        // The first build is the slowest to trace, but its best query stays: it may build fast.
        let ms = [9.0, 8.0, 7.0, 3.0, 2.0, 1.0, 6.0, 5.0, 4.0];
        assert_eq!(hopeless(&ms, &combinations), [0, 1]);
        assert!(hopeless(&[1.0; 9], &combinations).is_empty());
    }
}
