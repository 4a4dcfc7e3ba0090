//! The cells of a claim's studies, batch by batch.

use super::{Claim, Claims, Evidence, Kind, MemoryUse, NodeStatistics, Study};
use crate::estimate::{Quantity, View, grouped};
use crate::parameters::own_fields;
use crate::results::{Cell, CellKey};
use crate::statistics::geometric_mean;
use dacrt::Method;
use serde_json::{Map, Value};
use std::collections::BTreeSet;

/// What a claim is judged by.
pub struct Pool<'a> {
    pub studies: Vec<&'a Study>,
    pub batches: Vec<Batch<'a>>,
    /// Batches without rays, and their seeds.
    empty: Vec<(u64, &'a CellKey)>,
    pub nodes: Vec<&'a NodeStatistics>,
    pub memory: &'a [MemoryUse],
}

/// The cells of a batch of rays with a seed; never wrong ones, nor ones without rays.
pub struct Batch<'a> {
    pub seed: u64,
    pub key: &'a CellKey,
    pub rays: usize,
    pub cells: Vec<&'a Cell>,
    /// Place of the ray type in its study, for the order within a view.
    place: usize,
}

/// How much was measured.
pub struct Extent {
    pub cameras: usize,
    pub seeds: usize,
    pub repeats: usize,
    pub batches: usize,
}

/// A method with the paper's parameters but for some.
pub struct Who {
    method: Method,
    parameters: Map<String, Value>,
}

/// A method as the paper has it.
pub fn preset(method: Method) -> Who {
    Who {
        method,
        parameters: own_fields(method, &method.parameters()),
    }
}

impl Who {
    /// With another value of a parameter.
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Who {
        self.parameters.insert(name.to_owned(), value.into());
        self
    }

    fn is(&self, cell: &Cell) -> bool {
        let own = self
            .parameters
            .iter()
            .filter(|(name, _)| *name != "variant");
        cell.key.method == self.method.name() && cell.key.choices().eq(own)
    }
}

impl Batch<'_> {
    /// The cell of a contestant.
    pub fn cell(&self, who: &Who) -> Option<&Cell> {
        self.cells.iter().copied().find(|cell| who.is(cell))
    }

    /// Times of two contestants.
    pub fn times(&self, above: &Who, below: &Who) -> Option<Quantity> {
        let samples = |who| self.cell(who)?.samples_ms.clone();
        let [above, below] = [samples(above)?, samples(below)?];
        (above.len() == below.len()).then_some(Quantity::Times([above, below]))
    }

    /// Pixels a side and samples a pixel.
    pub fn size(&self) -> [u32; 2] {
        [self.key.resolution[0], self.key.spp]
    }

    fn view(&self) -> (u64, &str, &str) {
        (self.seed, &self.key.scene, &self.key.camera)
    }
}

/// One of a cell's counters.
pub fn counter(cell: &Cell, name: &str) -> f64 {
    cell.counters
        .get(name)
        .and_then(Value::as_f64)
        .unwrap_or(0.0)
}

impl<'a> Pool<'a> {
    pub fn new(claims: &'a Claims, claim: &Claim, evidence: &'a Evidence) -> Pool<'a> {
        let studies: Vec<&Study> = (claim.studies.iter())
            .map(|name| &claims.studies[name])
            .collect();
        let (mut batches, mut empty) = (Vec::<Batch>::new(), Vec::new());
        for document in &evidence.documents {
            for cell in &document.cells {
                let is_in = |study: &&&Study| takes(study, cell);
                let Some(study) = studies.iter().find(is_in) else {
                    continue;
                };
                if cell.ray_count == 0 {
                    empty.push((document.seed, &cell.key));
                    continue;
                }
                let same = |batch: &&mut Batch| {
                    batch.seed == document.seed && batch.key.batch() == cell.key.batch()
                };
                match batches.iter_mut().find(same) {
                    Some(batch) => batch.cells.push(cell),
                    None => batches.push(Batch {
                        seed: document.seed,
                        key: &cell.key,
                        rays: cell.ray_count,
                        cells: vec![cell],
                        place: place(&study.rays, &cell.key.rays),
                    }),
                }
            }
        }
        batches.sort_by_key(|batch| batch.place);
        let of_nodes = |nodes: &&NodeStatistics| {
            studies.iter().any(|study| {
                study.kind == Kind::Nodes
                    && study.scenes.contains(&nodes.scene)
                    && study.rays.contains(&nodes.rays)
                    && study.has_size([nodes.resolution, nodes.spp])
            })
        };
        let has_memory = studies.iter().any(|study| study.kind == Kind::Memory);
        Pool {
            nodes: evidence.nodes.iter().filter(of_nodes).collect(),
            memory: if has_memory { &evidence.memory } else { &[] },
            studies,
            batches,
            empty,
        }
    }

    /// How many ray types of a batch's picture have no rays: nothing that mirrors is in sight.
    pub fn empty_beside(&self, batch: &Batch) -> usize {
        let picture = |key: &CellKey| {
            (
                key.scene.clone(),
                key.camera.clone(),
                key.resolution,
                key.spp,
            )
        };
        let beside = (self.empty.iter())
            .filter(|(seed, key)| *seed == batch.seed && picture(key) == picture(batch.key));
        let rays: BTreeSet<&str> = beside.map(|(_, key)| key.rays.as_str()).collect();
        rays.len()
    }

    /// The views of some batches: of each camera with each seed what `values` makes of its batches, in the
    /// order of the ray types in the study; those of which it makes nothing are left out.
    pub fn views(
        &self,
        some: impl Fn(&Batch) -> bool,
        values: impl Fn(&[&Batch]) -> Option<Vec<Quantity>>,
    ) -> Vec<View> {
        let some = self.batches.iter().filter(|batch| some(batch));
        let view = |batches: &Vec<&Batch>| {
            Some(View {
                scene: batches[0].key.scene.clone(),
                values: values(batches).filter(|values| !values.is_empty())?,
            })
        };
        (grouped(some, |batch| batch.view()).iter())
            .filter_map(view)
            .collect()
    }

    /// Likewise, with a value for each batch that has one.
    pub fn each(
        &self,
        some: impl Fn(&Batch) -> bool,
        value: impl Fn(&Batch) -> Option<Quantity>,
    ) -> Vec<View> {
        self.views(some, |batches| {
            Some(batches.iter().filter_map(|batch| value(batch)).collect())
        })
    }

    /// Of each camera the geometric mean over its seeds of what `value` makes of its batches.
    pub fn by_camera(
        &self,
        some: impl Fn(&Batch) -> bool,
        value: impl Fn(&[&Batch]) -> Option<Quantity>,
    ) -> Vec<f64> {
        let some = self.batches.iter().filter(|batch| some(batch));
        let cameras = grouped(some, |batch| (&batch.key.scene, &batch.key.camera));
        let mean = |batches: &Vec<&Batch>| {
            let seeds = grouped(batches.iter().copied(), |batch| batch.seed);
            let values = seeds.iter().filter_map(|of| Some(value(of)?.value()));
            geometric_mean(&values.collect::<Vec<f64>>())
        };
        cameras.iter().filter_map(mean).collect()
    }

    /// The views of node statistics.
    pub fn node_views(
        &self,
        values: impl Fn(&[&NodeStatistics]) -> Option<Vec<Quantity>>,
    ) -> Vec<View> {
        let view = |nodes: &Vec<&NodeStatistics>| {
            Some(View {
                scene: nodes[0].scene.clone(),
                values: values(nodes)?,
            })
        };
        let key = |nodes: &NodeStatistics| (nodes.scene.clone(), nodes.camera.clone(), nodes.seed);
        (grouped(self.nodes.iter().copied(), key).iter())
            .filter_map(view)
            .collect()
    }

    /// Times of two contestants in all batches that have both.
    pub fn times(&self, above: &Who, below: &Who) -> Vec<View> {
        self.each(|_| true, |batch| batch.times(above, below))
    }

    /// Names of the scenes that there are batches of.
    pub fn scenes(&self) -> Vec<&'a str> {
        let mut scenes: Vec<&str> = self.batches.iter().map(|b| b.key.scene.as_str()).collect();
        scenes.extend(self.nodes.iter().map(|nodes| nodes.scene.as_str()));
        scenes.sort_unstable();
        scenes.dedup();
        scenes
    }

    pub fn extent(&self) -> Extent {
        let distinct = |mut all: Vec<String>| {
            all.sort_unstable();
            all.dedup();
            all.len()
        };
        let camera = |scene: &str, camera: &str| format!("{scene} {camera}");
        let mut cameras: Vec<String> = (self.batches.iter())
            .map(|batch| camera(&batch.key.scene, &batch.key.camera))
            .collect();
        cameras.extend(self.nodes.iter().map(|n| camera(&n.scene, &n.camera)));
        let mut seeds: Vec<String> = self.batches.iter().map(|b| b.seed.to_string()).collect();
        seeds.extend(self.nodes.iter().map(|nodes| nodes.seed.to_string()));
        let cells = self.batches.iter().flat_map(|batch| &batch.cells);
        let repeats = cells.filter_map(|cell| Some(cell.samples_ms.as_ref()?.len()));
        Extent {
            cameras: distinct(cameras),
            seeds: distinct(seeds),
            repeats: repeats.min().unwrap_or(0),
            batches: self.batches.len() + self.nodes.len(),
        }
    }
}

fn place(rays: &[String], of: &str) -> usize {
    let place = rays.iter().position(|rays| rays == of);
    place.unwrap_or(rays.len())
}

/// Whether a cell belongs to a study.
fn takes(study: &Study, cell: &Cell) -> bool {
    let key = &cell.key;
    let kind = match study.kind {
        Kind::Cells => cell.twin.is_none(),
        Kind::Embree => cell.twin.is_none() && cell.embree.is_some(),
        Kind::Twins => cell.twin.is_some(),
        Kind::Nodes | Kind::Memory => false,
    };
    let [width, height] = key.resolution;
    kind && width == height
        && !cell.is_wrong()
        && study.scenes.contains(&key.scene)
        && study.rays.contains(&key.rays)
        && study.methods.contains_key(&key.method)
        && study.has_size([width, key.spp])
        && !(study.own_camera && key.camera.starts_with("generated"))
}
