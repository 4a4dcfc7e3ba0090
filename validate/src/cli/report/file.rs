//! The files of a report, told apart by their content.

use anyhow::{Context, bail, ensure};
use dacrt_validate::machine::{Machine, Software};
use dacrt_validate::results::{Cell, Document};
use dacrt_validate::{claims, growth, hard, json_file, throughput};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// A file and what is in it.
pub struct File {
    /// Its name, with its folders where another file has the same name.
    pub name: String,
    pub content: Content,
}

/// What a file can be.
pub enum Content {
    /// Of `dacrt run`, `sweep`, `merge` or `paper`.
    Results(Box<Document>),
    Growth(growth::Document),
    Hard(hard::Document),
    Claims(claims::Document),
}

impl File {
    /// What was traced; of none but results and growth.
    pub fn cells(&self) -> &[Cell] {
        match &self.content {
            Content::Results(document) => &document.cells,
            Content::Growth(document) => &document.cells,
            Content::Hard(_) | Content::Claims(_) => &[],
        }
    }

    /// The results of a run, if it has them.
    pub fn results(&self) -> Option<&Document> {
        match &self.content {
            Content::Results(document) => Some(&**document),
            _ => None,
        }
    }

    /// Which kind of file it is, in words.
    pub fn kind(&self) -> &'static str {
        match &self.content {
            Content::Results(document) if document.sweep.is_some() => "sweep",
            Content::Results(_) => "results",
            Content::Growth(_) => "growth",
            Content::Hard(_) => "hard cases",
            Content::Claims(_) => "claims",
        }
    }

    /// What made it: software and command.
    pub fn origin(&self) -> (&Software, &[String]) {
        match &self.content {
            Content::Results(d) => (&d.software, &d.command),
            Content::Growth(d) => (&d.software, &d.command),
            Content::Hard(d) => (&d.software, &d.command),
            Content::Claims(d) => (&d.software, &d.command),
        }
    }

    /// Where it was measured, each with what of it, if that is a part.
    pub fn machines(&self) -> Vec<(Option<String>, &Machine)> {
        match &self.content {
            Content::Results(d) => vec![(None, &d.machine)],
            Content::Growth(d) => vec![(None, &d.machine)],
            Content::Hard(d) => vec![(None, &d.machine)],
            Content::Claims(d) => (d.machines.iter())
                .map(|on| (Some(on.seeds_in_words()), &on.machine))
                .collect(),
        }
    }

    /// Threads of the run, and its seed, where the file says them.
    pub fn threads_and_seed(&self) -> Option<(usize, u64)> {
        let document = self.results()?;
        Some((document.threads, document.seed))
    }
}

/// Reads all of them.
///
/// # Errors
/// If a file cannot be read, is none that a report takes, or is named twice.
pub fn read(paths: &[PathBuf]) -> anyhow::Result<Vec<File>> {
    for (i, path) in paths.iter().enumerate() {
        ensure!(
            !paths[..i].contains(path),
            "{}: is named twice",
            path.display()
        );
    }
    let short = |path: &Path| {
        path.file_name()
            .map(|name| name.to_string_lossy().into_owned())
    };
    let is_alone = |path: &Path| {
        paths
            .iter()
            .filter(|other| short(other) == short(path))
            .count()
            == 1
    };
    let file = |path: &PathBuf| {
        let whole = path.display().to_string();
        let name = short(path).filter(|_| is_alone(path)).unwrap_or(whole);
        let content = content(path)?;
        Ok(File { name, content })
    };
    paths.iter().map(file).collect()
}

fn content(path: &Path) -> anyhow::Result<Content> {
    let name = path.display();
    let bytes = std::fs::read(path).with_context(|| format!("{name}: cannot be read"))?;
    let text = json_file::text(bytes).map_err(|(byte, error)| {
        anyhow::anyhow!("{name}: its gzip ends in error after {byte} bytes of text: {error}")
    })?;
    #[derive(Deserialize)]
    struct Marks {
        schema: Option<u64>,
        kind: Option<String>,
        scenes: Option<serde::de::IgnoredAny>,
        meshes: Option<serde::de::IgnoredAny>,
    }
    let marks = serde_json::from_slice::<Marks>(&text);
    let marks = marks.with_context(|| format!("{name}: is not a result file"))?;
    let taken = "a report takes files of `dacrt run`, `sweep`, `merge`, `paper`, `bench growth`, \
                 `hard` and `claims`";
    Ok(match marks.kind.as_deref() {
        Some(growth::KIND) => Content::Growth(parsed(path, &text)?),
        Some(hard::KIND) => Content::Hard(parsed(path, &text)?),
        Some(claims::KIND) => Content::Claims(parsed(path, &text)?),
        Some(throughput::KIND) => bail!("{name}: is of `dacrt bench throughput`; {taken}"),
        Some(other) => bail!("{name}: its kind is {other:?}; {taken}"),
        None if marks.schema.is_some() => Content::Results(Box::new(Document::read(path)?)),
        None if marks.scenes.is_some() => bail!("{name}: says what to sweep; {taken}"),
        None if marks.meshes.is_some() => bail!("{name}: describes a scene; {taken}"),
        None => bail!("{name}: has neither schema nor kind; {taken}"),
    })
}

fn parsed<T: DeserializeOwned>(path: &Path, text: &[u8]) -> anyhow::Result<T> {
    serde_json::from_slice(text).with_context(|| format!("{}: is damaged", path.display()))
}
