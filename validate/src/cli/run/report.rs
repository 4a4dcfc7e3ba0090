//! What `run` prints, and its verdict.

use super::Progress;
use super::cells::BatchKey;
use crate::cli::Verdict;
use crate::cli::plan::RunPlan;
use crate::cli::table::{self, Means, Row};
use crate::cli::text::print;
use dacrt_validate::results::Cell;

/// The table as it grows, and the verdict at its end.
pub struct Report<'a> {
    plan: &'a RunPlan,
    progress: &'a Progress,
    means: Means,
    size: Option<([u32; 2], u32)>,
    verdict: Verdict,
}

impl<'a> Report<'a> {
    pub fn new(plan: &'a RunPlan, progress: &'a Progress) -> Report<'a> {
        Report {
            plan,
            progress,
            means: Means::default(),
            size: None,
            verdict: Verdict::Good,
        }
    }

    /// Prints the lines of one batch.
    pub fn section(&mut self, key: &BatchKey, cells: &[Cell]) -> anyhow::Result<()> {
        let mut text = String::new();
        if self.size.is_none() {
            text += &table::heads();
        }
        let size = (key.resolution, key.spp);
        if self.size != Some(size) && self.plan.films.len() > 1 {
            let plural = if size.1 == 1 { "" } else { "s" };
            text += &format!(
                "{}x{}, {} sample{plural} a pixel\n",
                size.0[0], size.0[1], size.1
            );
        }
        self.size = Some(size);
        let differ = |cell: &&Cell| cell.hit_hash != cells[0].hit_hash;
        if let Some(cell) = cells.iter().find(differ) {
            self.verdict = Verdict::Finding;
            self.progress.warn(&format!(
                "{} {}: {} and {} have different hits, which no two methods may have",
                key.scene, key.rays, cells[0].key.method, cell.key.method
            ));
        }
        let mut rows = Vec::new();
        for (cell, contestant) in cells.iter().zip(&self.plan.contestants) {
            let row = Row::new(cell, &contestant.label);
            if row.wrong {
                self.verdict = Verdict::Finding;
            }
            self.means.add(&key.rays, &row);
            rows.push(row);
        }
        text += &table::section(&key.scene, &key.rays, &rows);
        self.progress.print(&text)
    }

    /// Prints the means and where the result is.
    pub fn end(self) -> anyhow::Result<Verdict> {
        let mut text = self.means.text();
        text += table::LEGEND;
        text += &format!("\nresults: {}\n", self.plan.out.display());
        if self.verdict == Verdict::Finding {
            text += "FINDING: there are wrong hits, see the warnings\n";
        }
        print(&text)?;
        Ok(self.verdict)
    }
}
