//! What is wrong in a run: wrong hits, and methods that disagree.

use super::cells::BatchKey;
use crate::cli::Verdict;
use crate::cli::progress::Progress;
use dacrt_validate::diff;
use dacrt_validate::results::Cell;

/// What was found so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Findings {
    wrong: bool,
    by_printed_rule: bool,
}

impl Findings {
    /// Looks at the cells of one batch, and warns of what is wrong with them.
    pub fn add(&mut self, key: &BatchKey, cells: &[Cell], progress: &Progress) {
        let BatchKey { scene, rays, .. } = key;
        // Hits by the printed rule are wrong by design: they are nobody's measure.
        let by_printed_rule = |cell: &Cell| cell.printed_rule_wrong.is_some_and(|n| n > 0);
        let ours: Vec<&Cell> = cells.iter().filter(|cell| !by_printed_rule(cell)).collect();
        let mut pairs = ours.iter().flat_map(|a| ours.iter().map(move |b| (a, b)));
        let differ = |(a, b): &(&&Cell, &&Cell)| {
            a.key.precision == b.key.precision && a.hit_hash != b.hit_hash
        };
        if let Some((first, other)) = pairs.find(differ) {
            self.wrong = true;
            progress.warn(&format!(
                "{scene} {rays}: {} and {} have different hits, which no two methods may have",
                name(first),
                name(other)
            ));
        }
        for cell in cells.iter().filter(|cell| cell.is_wrong()) {
            let method = name(cell);
            if by_printed_rule(cell) {
                self.by_printed_rule = true;
                progress.warn(&format!(
                    "{scene} {rays} {method}: {} wrong of {} rays by the printed rule of \
                     termination, which --terminate-as-printed true is there to show",
                    cell.printed_rule_wrong.unwrap_or(0),
                    cell.ray_count
                ));
            } else {
                self.wrong = true;
                progress.warn(&format!(
                    "{scene} {rays} {method}: {} wrong of {} rays; the offending rays are in the \
                     result file (`dacrt trace --help` says how to trace them again)",
                    cell.diff.wrong(),
                    cell.ray_count
                ));
                if let Some(n @ 1..) = cell.diff.not_judged {
                    progress.warn(&format!(
                        "{scene} {rays} {method}: {n} of them were not judged: that is done for {} \
                         rays on which Embree differs",
                        diff::MOST_JUDGED
                    ));
                }
            }
        }
    }

    /// Whether anything was found.
    pub fn verdict(&self) -> Verdict {
        match self.wrong || self.by_printed_rule {
            true => Verdict::Finding,
            false => Verdict::Good,
        }
    }

    /// The last words of a command; empty if all is well.
    pub fn text(&self) -> &'static str {
        match (self.wrong, self.by_printed_rule) {
            (true, _) => "FINDING: there are wrong hits, see the warnings\n",
            (false, true) => {
                "FINDING: there are wrong hits, all by the printed rule of termination: this is \
                 what\n--terminate-as-printed true is for\n"
            }
            (false, false) => "",
        }
    }
}

/// The method, and the precision where it is not the usual one.
fn name(cell: &Cell) -> String {
    match (cell.key.method.as_str(), cell.key.precision.as_str()) {
        (method, "fast") => method.to_owned(),
        (method, precision) => format!("{method} {precision}"),
    }
}
