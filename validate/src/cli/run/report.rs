//! What `run` prints.

use super::cells::BatchKey;
use super::{Findings, Progress};
use crate::cli::plan::{Round, RunPlan};
use crate::cli::table::{self, Means, Row};
use crate::cli::text::print;
use dacrt_validate::results::Cell;

/// The table as it grows.
pub struct Report<'a> {
    plan: &'a RunPlan,
    progress: &'a Progress,
    means: Means,
    size: Option<([u32; 2], u32)>,
}

impl<'a> Report<'a> {
    pub fn new(plan: &'a RunPlan, progress: &'a Progress) -> Report<'a> {
        Report {
            plan,
            progress,
            means: Means::default(),
            size: None,
        }
    }

    /// Prints the lines of one batch.
    pub fn section(&mut self, key: &BatchKey, round: &Round, cells: &[Cell]) -> anyhow::Result<()> {
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
        let mut rows = Vec::new();
        for (cell, contestant) in cells.iter().zip(&round.contestants) {
            let row = Row::new(cell, &contestant.label);
            self.means.add(&key.rays, &row);
            rows.push(row);
        }
        text += &table::section(&key.scene, &key.rays, &rows);
        self.progress.print(&text)
    }

    /// Prints the means, where the result is, and what is wrong.
    pub fn end(self, findings: &Findings) -> anyhow::Result<()> {
        let mut text = self.means.text();
        text += table::LEGEND;
        text += &format!("\nresults: {}\n", self.plan.out.display());
        text += findings.text();
        print(&text)
    }
}
