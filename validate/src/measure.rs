//! Interleaved timing: contestants take turns, so that a slow spell of the machine hits them all.

/// Runs `contestants` in turn: one warm-up round whose times are thrown away, then `repeats`
/// rounds A B C A B C. Returns all samples of each contestant, in milliseconds, in round order.
///
/// `run(i)` runs contestant `i` and returns the milliseconds that count. After the first measured
/// round `give_up` sees the samples so far and may name contestants that run no more; they keep
/// their one sample.
pub fn interleave<E>(
    contestants: usize,
    repeats: usize,
    mut run: impl FnMut(usize) -> Result<f64, E>,
    give_up: impl FnOnce(&[Vec<f64>]) -> Vec<usize>,
) -> Result<Vec<Vec<f64>>, E> {
    let mut samples = vec![Vec::with_capacity(repeats); contestants];
    let mut active = vec![true; contestants];
    let mut give_up = Some(give_up);
    for i in 0..contestants {
        run(i)?;
    }
    for round in 0..repeats {
        for i in (0..contestants).filter(|&i| active[i]) {
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
            2,
            |i| {
                order.push(i);
                Ok(order.len() as f64)
            },
            |_| vec![],
        )
        .unwrap();
        assert_eq!(order, [0, 1, 2, 0, 1, 2, 0, 1, 2]);
        assert_eq!(samples, [[4.0, 7.0], [5.0, 8.0], [6.0, 9.0]]);
    }

    #[test]
    fn a_contestant_that_gave_up_keeps_its_first_sample() {
        let samples = interleave::<Infallible>(
            3,
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
