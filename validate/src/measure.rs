//! Interleaved timing: contestants take turns, so that a slow spell of the machine hits them all.

use fastrand::Rng;
use std::ops::Range;

/// Runs `contestants` in turn: those that are `cold` once to warm up, whose times are thrown away, then
/// all in `repeats` rounds, each in another order, for who runs after a contestant that leaves the caches
/// or the clock in a bad state is slower. Returns all samples of each contestant, in milliseconds, in
/// round order.
///
/// `run(i)` runs contestant `i` and returns the milliseconds that count. After the first measured
/// round `give_up` sees the samples so far and may name contestants that run no more; they keep
/// their one sample.
pub fn interleave<E>(
    contestants: usize,
    cold: Range<usize>,
    repeats: usize,
    mut run: impl FnMut(usize) -> Result<f64, E>,
    give_up: impl FnOnce(&[Vec<f64>]) -> Vec<usize>,
) -> Result<Vec<Vec<f64>>, E> {
    let mut samples = vec![Vec::with_capacity(repeats); contestants];
    let mut active = vec![true; contestants];
    let mut give_up = Some(give_up);
    let mut order: Vec<usize> = (0..contestants).collect();
    let mut random = Rng::with_seed(contestants as u64);
    for i in cold {
        run(i)?;
    }
    for round in 0..repeats {
        random.shuffle(&mut order);
        for &i in order.iter().filter(|&&i| active[i]) {
            samples[i].push(run(i)?);
        }
        if round == 0 {
            for i in give_up.take().into_iter().flat_map(|f| f(&samples)) {
                active[i] = false;
            }
        }
    }
    Ok(samples)
}

/// Runs `work` and returns what it returns and the milliseconds it took.
pub fn milliseconds<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = std::time::Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64() * 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn contestants_take_turns_and_the_warm_up_is_not_kept() {
        let mut order = Vec::new();
        let samples = interleave::<Infallible>(
            3,
            1..3,
            9,
            |i| {
                order.push(i);
                Ok(order.len() as f64)
            },
            |_| vec![],
        )
        .unwrap();
        assert_eq!(order[..2], [1, 2]);
        let rounds = order[2..].chunks(3);
        let mut rounds: Vec<Vec<usize>> = rounds.map(<[usize]>::to_vec).collect();
        assert_eq!(rounds.len(), 9);
        for (i, samples) in samples.iter().enumerate() {
            let when = (2..order.len()).filter(|&at| order[at] == i);
            let when: Vec<f64> = when.map(|at| (at + 1) as f64).collect();
            assert_eq!(*samples, when);
        }
        rounds.sort();
        rounds.dedup();
        assert!(rounds.len() > 2, "always in the same order: {rounds:?}");
        for mut round in rounds {
            round.sort();
            assert_eq!(round, [0, 1, 2]);
        }
    }

    #[test]
    fn a_contestant_that_gave_up_keeps_its_first_sample() {
        let samples = interleave::<Infallible>(
            3,
            0..3,
            3,
            |i| Ok(i as f64),
            |first| {
                assert_eq!(first, [[0.0], [1.0], [2.0]]);
                vec![1]
            },
        )
        .unwrap();
        assert_eq!(samples.iter().map(Vec::len).collect::<Vec<_>>(), [3, 1, 3]);
    }

    #[test]
    fn the_first_error_ends_the_measurement() {
        let mut runs = 0;
        let result = interleave(
            2,
            0..2,
            5,
            |i| {
                runs += 1;
                if i == 1 { Err("no") } else { Ok(0.0) }
            },
            |_| vec![],
        );
        assert_eq!(result, Err("no"));
        assert_eq!(runs, 2);
    }
}
