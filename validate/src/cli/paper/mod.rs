//! `dacrt paper`: what a paper prints, measured here and set beside it.

mod mora;
mod nabata;

use super::Verdict;
use super::args::{Paper, PaperArgs};

/// Measures through the same path as `run` and prints the paper's tables.
pub fn paper(args: &PaperArgs) -> anyhow::Result<Verdict> {
    match args.paper {
        Paper::Mora2011 => mora::mora2011(args),
        Paper::Nabata2013 => nabata::nabata2013(args),
    }
}

/// Repeats of `--quick`.
const QUICK_REPEATS: u32 = 3;

impl PaperArgs {
    fn repeats(&self) -> u32 {
        match self.quick {
            true => self.repeats.repeats.min(QUICK_REPEATS),
            false => self.repeats.repeats,
        }
    }
}
