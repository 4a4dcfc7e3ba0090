//! Names of cells, as short as tells them apart.

use crate::results::{CellKey, Document};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Names such as `sibenik/primary/512x512/1/nabata2013[samples=50]`: scene, rays, pixels, samples
/// a pixel, method. The camera (`hall@nave/...`) stands there only where a scene has several, and
/// of parameters and precision only what tells a cell from others of its method and batch.
///
/// A user may compare files in which a parameter varies with files in which it does not: names are
/// made over all documents at hand, and each is the name of one cell only.
#[derive(Clone, Debug)]
pub struct Names<'a> {
    /// Scenes that are seen by several cameras.
    several_cameras: BTreeSet<String>,
    /// By method and batch, the parameters of which there is more than one value.
    varied: BTreeMap<Group<'a>, BTreeSet<String>>,
}

impl<'a> Names<'a> {
    /// Names for the cells of these documents.
    pub fn of(documents: &[&'a Document]) -> Names<'a> {
        let keys = || (documents.iter()).flat_map(|d| d.cells.iter().map(|cell| &cell.key));
        let mut cameras: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        let mut first: BTreeMap<Group, BTreeMap<String, Value>> = BTreeMap::new();
        let mut varied: BTreeMap<Group, BTreeSet<String>> = BTreeMap::new();
        for key in keys() {
            cameras.entry(&key.scene).or_default().insert(&key.camera);
            let values = values(key);
            let first = first.entry(group(key)).or_insert_with(|| values.clone());
            let names = values.keys().chain(first.keys());
            let differing = names.filter(|name| values.get(*name) != first.get(*name));
            let varied = varied.entry(group(key)).or_default();
            varied.extend(differing.cloned());
        }
        let several = cameras.into_iter().filter(|(_, cameras)| cameras.len() > 1);
        Names {
            several_cameras: several.map(|(scene, _)| scene.to_owned()).collect(),
            varied,
        }
    }

    /// The name of a cell of one of the documents.
    pub fn name(&self, key: &CellKey) -> String {
        let camera = match self.several_cameras.contains(&key.scene) {
            true => format!("@{}", key.camera),
            false => String::new(),
        };
        let [width, height] = key.resolution;
        let CellKey {
            scene,
            rays,
            spp,
            method,
            ..
        } = key;
        let label = match self.label(key, ",") {
            label if label.is_empty() => label,
            label => format!("[{label}]"),
        };
        format!("{scene}{camera}/{rays}/{width}x{height}/{spp}/{method}{label}")
    }

    /// What tells the cell from others of its method and batch, such as `samples=50`; may be empty.
    pub fn label(&self, key: &CellKey, separator: &str) -> String {
        let values = values(key);
        let varied = self.varied.get(&group(key)).into_iter().flatten();
        let parts: Vec<String> = varied
            .filter_map(|name| {
                Some(match values.get(name)? {
                    Value::String(word) => format!("{name}={word}"),
                    value => format!("{name}={value}"),
                })
            })
            .collect();
        parts.join(separator)
    }
}

/// Batch and method: cells that only parameters and precision tell apart.
pub(super) type Group<'a> = ((&'a str, &'a str, [u32; 2], u32, &'a str), &'a str);

/// Which group a cell belongs to.
pub(super) fn group(key: &CellKey) -> Group<'_> {
    (key.batch(), &key.method)
}

/// Choices and precision.
fn values(key: &CellKey) -> BTreeMap<String, Value> {
    key.choices()
        .map(|(name, value)| (name.clone(), value.clone()))
        .chain([("precision".to_owned(), key.precision.as_str().into())])
        .collect()
}
