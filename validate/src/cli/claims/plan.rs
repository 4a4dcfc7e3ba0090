//! The batches that studies need: each once, with all contestants of all studies that have it.

use crate::cli::knobs::KnobLists;
use crate::cli::plan::{
    Contestant, Engine, Round, RunPlan, add_scene, contestants, film, method, ray_type,
    set_baselines,
};
use crate::cli::size::{Resolution, Spp};
use crate::cli::source::{SceneSource, generated};
use dacrt::Precision;
use dacrt_validate::claims::{Claims, Kind, Study};
use dacrt_validate::embree::Quality;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The cameras that the program makes are dealt out to so many seeds.
const SEEDS: u64 = 10;

/// How much is measured with a seed.
pub struct Extent<'a> {
    pub quick: bool,
    /// Cameras besides the scene's own, over all seeds.
    pub cameras: u32,
    pub repeats: u32,
    pub engine: Engine,
    pub mesh_folders: &'a [PathBuf],
}

impl Extent<'_> {
    /// The cameras of a study: the scene's own, and those that this seed has.
    pub fn cameras(&self, study: &Study) -> Vec<Option<String>> {
        let count = if study.own_camera { 0 } else { self.cameras };
        let mine = |n: &u32| u64::from(n - 1) % SEEDS == (self.engine.seed - 1) % SEEDS;
        let made = (1..=count).filter(mine).map(|n| Some(generated(n, false)));
        std::iter::once(None).chain(made).collect()
    }

    /// What the studies of a kind need; none if there are no such studies, or no meshes.
    pub fn plan(&self, claims: &Claims, kind: Kind, out: &Path) -> anyhow::Result<Option<RunPlan>> {
        let studies: Vec<&Study> = claims.studies.values().filter(|s| s.kind == kind).collect();
        let mut rounds: BTreeMap<&str, Vec<Round>> = BTreeMap::new();
        for study in studies {
            for scene in &study.scenes {
                let rounds = rounds.entry(scene).or_default();
                for round in self.rounds(study)? {
                    add_round(rounds, round);
                }
            }
        }
        let (mut scenes, mut warnings) = (Vec::new(), Vec::new());
        for (name, mut rounds) in rounds {
            let source = SceneSource::find(name)?;
            if let Some(missing) = source.missing_mesh(self.mesh_folders) {
                warnings.push(format!("left out: {missing}"));
                continue;
            }
            // Batches of one picture together, for they share what comes before them.
            rounds.sort_by_key(|round| (round.film.rays(), round.film.spp(), round.camera.clone()));
            add_scene(&mut scenes, source, rounds)?;
        }
        Ok((!scenes.is_empty()).then(|| RunPlan {
            qualities: match kind {
                Kind::Embree => &Quality::ALL,
                _ => &[],
            },
            mesh_folders: self.mesh_folders.to_vec(),
            resume: true,
            twins: kind == Kind::Twins,
            warnings,
            ..RunPlan::of(scenes, self.repeats, self.engine, out.to_owned())
        }))
    }

    fn rounds(&self, study: &Study) -> anyhow::Result<Vec<Round>> {
        let contestants = one_at_a_time(study)?;
        let mut rounds = Vec::new();
        for camera in self.cameras(study) {
            for [side, spp] in study.sizes(self.quick) {
                let size = Resolution {
                    width: side,
                    height: side,
                };
                let film = film(size, Spp(spp))?;
                for rays in &study.rays {
                    rounds.push(Round {
                        camera: camera.clone(),
                        film,
                        rays: ray_type(rays)?,
                        contestants: contestants.clone(),
                    });
                }
            }
        }
        Ok(rounds)
    }
}

/// The methods of a study as the paper has them, then with each other value of a parameter.
fn one_at_a_time(study: &Study) -> anyhow::Result<Vec<Contestant>> {
    let mut all: Vec<Contestant> = Vec::new();
    for (name, variants) in &study.methods {
        let methods = [method(name)?];
        let lists = std::iter::once(BTreeMap::new()).chain(
            (variants.iter())
                .map(|(name, values)| BTreeMap::from([(name.clone(), values.clone())])),
        );
        for list in lists {
            let knobs = KnobLists::of_sweep(&list, &methods)?;
            for contestant in contestants(&methods, &[Precision::Fast], &knobs)? {
                add_contestant(&mut all, contestant);
            }
        }
    }
    Ok(all)
}

fn add_contestant(all: &mut Vec<Contestant>, new: Contestant) {
    let same = |c: &Contestant| (c.method, c.parameters) == (new.method, new.parameters);
    if !all.iter().any(same) {
        all.push(new);
    }
    set_baselines(all);
}

/// Adds a batch, or to one that is there already the contestants that it lacks.
fn add_round(rounds: &mut Vec<Round>, new: Round) {
    let same = |round: &&mut Round| {
        (&round.camera, round.film, round.rays) == (&new.camera, new.film, new.rays)
    };
    match rounds.iter_mut().find(same) {
        Some(round) => {
            for contestant in new.contestants {
                add_contestant(&mut round.contestants, contestant);
            }
        }
        None => rounds.push(new),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dacrt::Isa;

    fn extent(seed: u64, cameras: u32) -> Extent<'static> {
        Extent {
            quick: false,
            cameras,
            repeats: 3,
            engine: Engine {
                isa: Isa::Portable,
                seed,
                threads: 1,
            },
            mesh_folders: &[],
        }
    }

    #[test]
    fn ten_seeds_have_all_cameras_between_them() {
        let claims = Claims::load(None).unwrap();
        let study = &claims.studies["few-rays"];
        let mut made: Vec<String> = (1..=10)
            .flat_map(|seed| extent(seed, 16).cameras(study).into_iter().flatten())
            .collect();
        made.sort();
        made.dedup();
        assert_eq!(made.len(), 16);
        assert_eq!(extent(1, 0).cameras(study), [None]);
        assert_eq!(extent(1, 16).cameras(&claims.studies["samples"]), [None]);
    }

    #[test]
    fn every_study_has_contestants_and_rays_that_exist() {
        let claims = Claims::load(None).unwrap();
        for (name, study) in &claims.studies {
            let rounds = extent(1, 16).rounds(study).unwrap();
            assert!(!rounds.is_empty(), "{name}");
            let variants = study.methods.values().flat_map(|v| v.values());
            let others: usize = variants.map(Vec::len).sum();
            let expected = study.methods.len() + others;
            assert_eq!(
                rounds[0].contestants.len(),
                expected,
                "{name}: a value is the paper's"
            );
            for scene in &study.scenes {
                SceneSource::find(scene).unwrap();
            }
        }
    }

    #[test]
    fn a_batch_of_two_studies_is_measured_once() {
        let claims = Claims::load(None).unwrap();
        let extent = extent(1, 0);
        let mut rounds = Vec::new();
        for study in [&claims.studies["values"], &claims.studies["cells"]] {
            for round in extent.rounds(study).unwrap() {
                add_round(&mut rounds, round);
            }
        }
        let primary: Vec<&Round> = (rounds.iter())
            .filter(|round| round.rays == dacrt::workloads::RayType::Primary)
            .collect();
        assert_eq!(primary.len(), 1);
        let methods: Vec<_> = primary[0].contestants.iter().map(|c| c.method).collect();
        assert!(methods.contains(&dacrt::Method::Mora2011));
        assert!(methods.contains(&dacrt::Method::Nabata2013));
    }
}
