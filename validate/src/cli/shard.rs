//! `--shard i/n`: which batches of a sweep one of many machines takes.

use std::fmt;
use std::str::FromStr;

/// The `place`-th, from 1, of `of` shards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    pub place: u32,
    pub of: u32,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Shard, String> {
        let parts = text.split_once('/');
        let shard = parts.and_then(|(place, of)| {
            let (place, of) = (place.parse().ok()?, of.parse().ok()?);
            Some(Shard { place, of })
        });
        shard
            .filter(|s| (1..=s.of).contains(&s.place))
            .ok_or_else(|| "expected I/N with I from 1 to N, such as 2/3".to_owned())
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.place, self.of)
    }
}

impl Shard {
    /// Which of the batches are this shard's: the largest that is left goes to the shard with the
    /// least work so far, so each shard gets one before any gets two.
    pub fn of_work(self, work: &[f64]) -> Vec<bool> {
        let mut order: Vec<usize> = (0..work.len()).collect();
        order.sort_by(|&a, &b| work[b].total_cmp(&work[a]));
        let mut sums = vec![0.0f64; self.of as usize];
        let mut mine = vec![false; work.len()];
        for batch in order {
            let least = (0..sums.len())
                .min_by(|&a, &b| sums[a].total_cmp(&sums[b]))
                .expect("at least one shard");
            sums[least] += work[batch];
            mine[batch] = least + 1 == self.place as usize;
        }
        mine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!("2/3".parse(), Ok(Shard { place: 2, of: 3 }));
        for bad in ["0/3", "4/3", "1", "1/", "/1", "-1/2", "1/0", "1/2/3", "a/b"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }

    #[test]
    fn each_batch_is_in_one_shard_and_no_shard_is_empty() {
        let work = [8.0, 1.0, 3.0, 3.0, 1.0, 8.0, 2.0];
        for of in 1..=7 {
            let shards = (1..=of).map(|place| Shard { place, of }.of_work(&work));
            let shards: Vec<Vec<bool>> = shards.collect();
            assert!(shards.iter().all(|mine| mine.contains(&true)), "{of}");
            for batch in 0..work.len() {
                assert_eq!(shards.iter().filter(|mine| mine[batch]).count(), 1);
            }
        }
        let mine = Shard { place: 1, of: 2 }.of_work(&work);
        let sum: f64 = (0..7).filter(|&i| mine[i]).map(|i| work[i]).sum();
        assert_eq!(sum, 13.0);
    }
}
