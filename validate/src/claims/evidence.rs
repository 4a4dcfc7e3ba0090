//! What was measured for claims: a folder of files.

use crate::json_file;
use crate::results::Document;
use anyhow::{Context, ensure};
use dacrt::NodeRecord;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// Everything that there is.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    /// Result files, one for each seed and kind.
    pub documents: Vec<Document>,
    /// Of each batch whose nodes were written down.
    pub nodes: Vec<NodeStatistics>,
    /// Of each batch whose memory was measured.
    pub memory: Vec<MemoryUse>,
}

/// The nodes of a trace by `nabata2013` that have more than 1,000 rays.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NodeStatistics {
    /// Name of the scene.
    pub scene: String,
    /// Name of the camera.
    pub camera: String,
    /// Pixels a side.
    pub resolution: u32,
    /// Samples a pixel.
    pub spp: u32,
    /// Ray type.
    pub rays: String,
    /// Seed of rays and samples.
    pub seed: u64,
    /// How many were split by a cost function.
    pub splits: usize,
    /// The mean distance of their children's intersection ratios, by all rays, from the ratios of surface
    /// areas; 0 to 1.
    pub area_distance: f64,
    /// Cost by all rays of the splits of the surface area heuristic over that of the best.
    pub area_regret: f64,
    /// How many are leaves.
    pub large_leaves: usize,
}

/// Memory of a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MemoryUse {
    /// Name of the scene.
    pub scene: String,
    /// Method.
    pub method: String,
    /// Rays of the batch.
    pub rays: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Bytes of the workspace.
    pub workspace_bytes: usize,
    /// Bytes of stack that the trace came to use.
    pub stack_bytes: usize,
}

/// Rays that a large node has more of: the paper's limit for sampling.
const LARGE: u32 = 1000;

impl NodeStatistics {
    /// Whether both are of the same batch with the same seed.
    pub fn is_of_batch_of(&self, other: &NodeStatistics) -> bool {
        (&self.scene, &self.camera, &self.rays) == (&other.scene, &other.camera, &other.rays)
            && (self.resolution, self.spp, self.seed) == (other.resolution, other.spp, other.seed)
    }

    /// Fills in all but the names from the nodes of a trace.
    pub fn count(mut self, nodes: &[NodeRecord]) -> NodeStatistics {
        let large = || nodes.iter().filter(|node| node.rays > LARGE);
        let splits = || large().filter_map(|node| node.split.as_ref().filter(|s| s.by_cost));
        let distances: Vec<f64> = splits()
            .flat_map(|split| split.ratios.into_iter().zip(split.areas))
            .map(|(ratio, area)| f64::from((ratio - area).abs()))
            .filter(|distance| distance.is_finite())
            .collect();
        let [by_area, least] = [1, 2].map(|i| splits().map(|s| s.costs[i]).sum::<u64>() as f64);
        self.splits = splits().count();
        self.area_distance = distances.iter().sum::<f64>() / distances.len().max(1) as f64;
        self.area_regret = if least > 0.0 { by_area / least } else { 1.0 };
        self.large_leaves = large().filter(|node| node.split.is_none()).count();
        self
    }
}

impl Evidence {
    /// The file of the cells of a seed.
    pub fn cells(folder: &Path, seed: u64) -> PathBuf {
        folder.join(format!("cells-{seed}.json.gz"))
    }

    /// The file of cells beside Embree's times.
    pub fn embree(folder: &Path, seed: u64) -> PathBuf {
        folder.join(format!("embree-{seed}.json.gz"))
    }

    /// The file of cells with stored splits.
    pub fn twins(folder: &Path, seed: u64) -> PathBuf {
        folder.join(format!("twins-{seed}.json.gz"))
    }

    /// The file of [`NodeStatistics`].
    pub fn nodes(folder: &Path) -> PathBuf {
        folder.join("nodes.json")
    }

    /// The file of [`MemoryUse`].
    pub fn memory(folder: &Path) -> PathBuf {
        folder.join("memory.json")
    }

    /// Reads what there is in a folder; of seeds up to 100.
    ///
    /// # Errors
    /// If there is nothing, or a file is damaged.
    pub fn read(folder: &Path) -> anyhow::Result<Evidence> {
        let mut evidence = Evidence {
            documents: Vec::new(),
            nodes: list(&Evidence::nodes(folder))?,
            memory: list(&Evidence::memory(folder))?,
        };
        for seed in 1..=100 {
            for path in [Evidence::cells, Evidence::embree, Evidence::twins] {
                let path = path(folder, seed);
                if path.exists() {
                    evidence.documents.push(Document::read(&path)?);
                }
            }
        }
        ensure!(
            !evidence.documents.is_empty()
                || !evidence.nodes.is_empty()
                || !evidence.memory.is_empty(),
            "{}: has no files of `dacrt claims` (cells-1.json.gz and such)",
            folder.display()
        );
        Ok(evidence)
    }
}

/// The entries of a file; none if it does not exist.
///
/// # Errors
/// If it is damaged.
pub fn list<T: DeserializeOwned>(path: &Path) -> anyhow::Result<Vec<T>> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let what = || path.display().to_string();
    serde_json::from_slice(&fs::read(path).with_context(what)?).with_context(what)
}

/// Writes such a file.
///
/// # Errors
/// If it cannot be written.
pub fn write_list<T: Serialize>(path: &Path, entries: &[T]) -> anyhow::Result<()> {
    json_file::write(path, &entries).with_context(|| path.display().to_string())
}
