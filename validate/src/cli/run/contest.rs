//! The timed part: our methods, Embree and other libraries take turns on one batch.

use super::answers::Answers;
use super::reference::{Built, PeerTree, Reference};
use crate::cli::engine::Workspaces;
use dacrt::{Batch, Mesh, Parameters, Precision, Tracer};
use dacrt_validate::embree::{Mode, Quality, Query};
use dacrt_validate::measure::{interleave, milliseconds};
use dacrt_validate::statistics::least;
use std::convert::Infallible;

/// How many combinations of build quality and query of a mode are given up after one measured round.
const GIVE_UP: usize = 2;
/// Rounds of the measurement without Embree's filling and reading back.
const PREPACKED_REPEATS: usize = 3;

/// A tracer whose answers have been validated.
pub struct Entrant {
    /// Its place among the contestants of the round.
    pub place: usize,
    pub parameters: Parameters,
    pub precision: Precision,
    pub tracer: Tracer,
    pub answers: Answers,
}

/// Everything that was measured on one batch, in milliseconds.
pub struct Times {
    /// For each entrant.
    pub methods: Vec<Vec<f64>>,
    /// For each mode, quality and query.
    pub embree: Vec<Traced>,
    /// For each mode and query on the quality that it is fastest on.
    pub prepacked: Vec<Traced>,
    /// For each tree of another library.
    pub peers: Vec<Vec<f64>>,
    /// Entrants whose answers were once not those that had been validated.
    pub unstable: Vec<usize>,
}

/// Traces of Embree.
pub struct Traced {
    pub mode: Mode,
    pub quality: Quality,
    pub query: Query,
    pub samples_ms: Vec<f64>,
}

impl Traced {
    fn new(built: &Built, query: Query, samples_ms: Vec<f64>) -> Traced {
        let &Built { mode, quality, .. } = built;
        Traced {
            mode,
            quality,
            query,
            samples_ms,
        }
    }
}

/// Measures the entrants, the modes of Embree that they are set against, and other libraries.
///
/// # Panics
/// If there are no entrants.
pub fn contest(
    mesh: &Mesh,
    batch: &Batch,
    entrants: &[Entrant],
    workspaces: &mut Workspaces,
    reference: &Reference,
    peers: &[&PeerTree],
    repeats: u32,
) -> Times {
    let any = matches!(entrants[0].answers, Answers::Any(_));
    let ours = entrants.len();
    let against = |mode| (entrants.iter()).any(|e| Mode::against(e.precision) == mode);
    let combinations: Vec<(&Built, Query)> = (reference.contestants.iter())
        .filter(|built| against(built.mode))
        .flat_map(|built| reference.queries.map(|query| (built, query)))
        .collect();
    let mut answers = Answers::room(batch.len(), any);
    let mut unstable = Vec::new();
    let run = |i: usize| -> Result<f64, Infallible> {
        let Some(entrant) = entrants.get(i) else {
            let i = i - ours;
            let trace = || match combinations.get(i) {
                Some((built, query)) => answers.trace_embree(&built.scene, batch, *query),
                None => answers.trace_peer(&*peers[i - combinations.len()].tree, batch),
            };
            return Ok(milliseconds(trace).1);
        };
        let workspace = workspaces.of(&entrant.parameters);
        let (_, ms) = milliseconds(|| answers.trace(&entrant.tracer, mesh, batch, workspace));
        if answers != entrant.answers && !unstable.contains(&i) {
            unstable.push(i);
        }
        Ok(ms)
    };
    let give_up = |first: &[Vec<f64>]| {
        let embree = &first[ours..ours + combinations.len()];
        let embree: Vec<f64> = embree.iter().map(|s| s[0]).collect();
        let of = |&(built, query): &(&Built, Query)| ((built.mode, built.quality), query);
        let combinations: Vec<_> = combinations.iter().map(of).collect();
        let out = hopeless(&embree, &combinations);
        out.into_iter().map(|i| i + ours).collect()
    };
    let all = ours + combinations.len() + peers.len();
    // The entrants are warm from the trace that was checked.
    let Ok(mut samples) = interleave(all, ours..all, repeats as usize, run, give_up);
    let peer_samples = samples.split_off(ours + combinations.len());
    let embree_samples = samples.split_off(ours);

    let mut prepacked = Vec::new();
    for mode in Mode::ALL.into_iter().filter(|&mode| against(mode)) {
        for query in reference.queries {
            let of_query = combinations.iter().zip(&embree_samples);
            let fastest = of_query
                .filter(|((built, q), _)| (built.mode, *q) == (mode, query))
                .min_by(|(_, a), (_, b)| least(a).total_cmp(&least(b)));
            // Embree may only be there to judge.
            let Some((&(built, _), _)) = fastest else {
                continue;
            };
            let mut packed = built.scene.pack(batch, query);
            let times = (0..PREPACKED_REPEATS).map(|_| {
                packed.reset();
                milliseconds(|| built.scene.trace_packed(&mut packed, any)).1
            });
            prepacked.push(Traced::new(built, query, times.collect()));
        }
    }
    let embree = combinations.iter().zip(embree_samples);
    Times {
        methods: samples,
        embree: embree
            .map(|(&(built, query), samples)| Traced::new(built, query, samples))
            .collect(),
        prepacked,
        peers: peer_samples,
        unstable,
    }
}

/// Of each mode the slowest combinations of a build, given by mode and quality, and a query that
/// another query on the same build beats, so that neither Embree's best trace nor its best sum of
/// build and trace can be among them.
fn hopeless(first_ms: &[f64], combinations: &[((Mode, Quality), Query)]) -> Vec<usize> {
    let beaten = |&i: &usize| {
        let same_build = (0..first_ms.len()).filter(|&j| combinations[j].0 == combinations[i].0);
        same_build.into_iter().any(|j| first_ms[j] < first_ms[i])
    };
    let mut slow: Vec<usize> = (0..first_ms.len()).filter(beaten).collect();
    slow.sort_by(|&a, &b| first_ms[b].total_cmp(&first_ms[a]));
    let of_mode = |mode| slow.iter().filter(move |&&i| combinations[i].0.0 == mode);
    let slowest = Mode::ALL
        .into_iter()
        .flat_map(|mode| of_mode(mode).take(GIVE_UP));
    slowest.copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dacrt_validate::embree::Lanes;

    #[test]
    fn only_what_another_query_beats_is_given_up() {
        let all = Query::all(Lanes::Sixteen);
        let of_mode = |mode| {
            Quality::ALL
                .into_iter()
                .flat_map(move |b| all.map(|q| ((mode, b), q)))
        };
        let combinations: Vec<_> = of_mode(Mode::Fast).collect();
        // The first build is the slowest to trace, but its best query stays: it may build fast.
        let ms = [9.0, 8.0, 7.0, 3.0, 2.0, 1.0, 6.0, 5.0, 4.0];
        assert_eq!(hopeless(&ms, &combinations), [0, 1]);
        assert!(hopeless(&[1.0; 9], &combinations).is_empty());
        let both: Vec<_> = combinations
            .into_iter()
            .chain(of_mode(Mode::Robust))
            .collect();
        assert_eq!(
            hopeless(&[ms, ms.map(|x| 2.0 * x)].concat(), &both),
            [0, 1, 9, 10]
        );
    }
}
