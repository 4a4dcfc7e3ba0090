//! `dacrt paper`: what a paper prints, measured here and set beside it.

pub mod mora;
pub mod nabata;

use super::Verdict;
use super::args::{Paper, PaperArgs};
use super::source::SceneSource;
use anyhow::ensure;
use dacrt_validate::statistics::Ratio;
use std::path::PathBuf;

/// Measures through the same path as `run` and prints the paper's tables.
pub fn paper(args: &PaperArgs) -> anyhow::Result<Verdict> {
    match args.paper {
        Paper::Mora2011 => mora::mora2011(args),
        Paper::Nabata2013 => nabata::nabata2013(args),
    }
}

/// Repeats of `--quick`.
const QUICK_REPEATS: u32 = 3;

/// Scenes whose meshes are there, and why the others are left out, with their names.
type Found = (Vec<SceneSource>, Vec<(String, String)>);

/// Looks for scenes; a mesh may only be missing where nobody named the scene.
fn find_scenes<'a>(
    names: impl IntoIterator<Item = &'a str>,
    args: &PaperArgs,
    mesh_folders: &[PathBuf],
) -> anyhow::Result<Found> {
    let (mut found, mut left_out) = (Vec::new(), Vec::new());
    for name in names {
        let source = SceneSource::find(name)?;
        match source.missing_mesh(mesh_folders) {
            None => found.push(source),
            Some(why) => {
                ensure!(args.scenes.is_none(), "{why}");
                left_out.push((source.name(), format!("left out: {why}")));
            }
        }
    }
    Ok((found, left_out))
}

/// `1.23 [1.17, 1.27]`
fn interval(r: &Ratio) -> String {
    let [low, high] = r.interval;
    format!("{:.2} [{low:.2}, {high:.2}]", r.ratio)
}

impl PaperArgs {
    fn repeats(&self) -> u32 {
        match self.quick {
            true => self.repeats.repeats.min(QUICK_REPEATS),
            false => self.repeats.repeats,
        }
    }
}
