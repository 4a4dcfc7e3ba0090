//! What is wrong in a run: wrong hits, and methods that disagree.

use super::cells::BatchKey;
use crate::cli::Verdict;
use crate::cli::plan::RunPlan;
use crate::cli::progress::Progress;
use crate::cli::source::scene_folder;
use dacrt_validate::compare::Names;
use dacrt_validate::diff;
use dacrt_validate::results::{Cell, Document};

/// Cells of which a wrong ray is named.
const MOST_REPLAYS: usize = 5;

/// The command that shows a ray.
fn replay(plan: &RunPlan, scene: &str, cell: &str, ray: u32) -> String {
    let mut command = format!(
        "  dacrt replay {} --cell '{cell}' --ray {ray}",
        plan.out.display()
    );
    let source = (plan.scenes.iter().map(|job| &job.source)).find(|s| s.name() == scene);
    if let Some(source) = source.filter(|s| s.json.parent() != Some(&scene_folder())) {
        command += &format!(" --scene {}", source.json.display());
    }
    let folders: Vec<_> = plan
        .mesh_folders
        .iter()
        .map(|f| f.to_string_lossy())
        .collect();
    let folders = folders.join(":");
    if std::env::var("DACRT_MESHES").unwrap_or_default() != folders {
        command += &format!(" --meshes {folders}");
    }
    command + "\n"
}

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
                     result file",
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

    /// The last words of a command, with those that show a wrong hit; empty if all is well.
    pub fn text(&self, document: &Document, plan: &RunPlan) -> String {
        let text = match (self.wrong, self.by_printed_rule) {
            (true, _) => "FINDING: there are wrong hits, see the warnings\n",
            (false, true) => {
                "FINDING: there are wrong hits, all by the printed rule of termination: this is \
                 what\n--terminate-as-printed true is for\n"
            }
            (false, false) => return String::new(),
        };
        let replays = document.cells.iter().filter_map(|cell| {
            let offender = cell.diff.offending.first()?;
            let name = Names::of(&[document]).name(&cell.key);
            Some(replay(plan, &cell.key.scene, &name, offender.index))
        });
        let replays: String = replays.take(MOST_REPLAYS).collect();
        match replays.is_empty() {
            true => text.to_owned(),
            false => format!("a wrong ray, step by step:\n{replays}{text}"),
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
