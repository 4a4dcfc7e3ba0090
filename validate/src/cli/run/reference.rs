//! The scenes of Embree and the trees of other libraries of one mesh, and what it took to build
//! them.

use super::answers::Answers;
use crate::cli::progress::Progress;
use dacrt::{Batch, Mesh};
use dacrt_validate::embree::{Device, Mode, Quality, Query, Scene};
use dacrt_validate::peers::{self, Peer, Tree};

/// A quality whose builds have taken this long together is not built again.
const BUILD_BUDGET_MS: f64 = 5_000.0;
/// Untimed builds before the clock counts: the first two of low quality take up to four times as
/// long as later ones, which would flatter us.
const WARM_UP_BUILDS: u32 = 2;

/// One mesh in Embree: contestants, and a scene in each mode to be judged by.
pub struct Reference {
    /// Of each mode that is timed its qualities, in the order in which they were asked for.
    pub contestants: Vec<Built>,
    /// Those that each of them is traced by.
    pub queries: [Query; 3],
    /// In the modes that are not timed.
    judges: Vec<(Mode, Scene)>,
}

/// A scene and the times of all builds of its mode and quality.
pub struct Built {
    pub mode: Mode,
    pub quality: Quality,
    pub scene: Scene,
    pub samples_ms: Vec<f64>,
}

impl Reference {
    /// Builds each quality of the modes that are timed `repeats` times in turn, fewer times where
    /// that takes long; of other modes one scene, which is not timed. Medium quality is among them.
    pub fn build(
        device: &Device,
        mesh: &Mesh,
        repeats: u32,
        timed: &[Mode],
        qualities: &[Quality],
        progress: &Progress,
    ) -> anyhow::Result<Reference> {
        let build = |quality: Quality, mode| {
            progress.step(&format!("Embree builds ({})", quality.name()));
            Scene::build(device, mesh, quality, mode == Mode::Robust)
        };
        let mut judges = Vec::new();
        for mode in Mode::ALL {
            if !timed.contains(&mode) {
                judges.push((mode, build(Quality::Medium, mode)?));
            }
        }
        let mut contestants = Vec::new();
        for &mode in timed {
            for _ in 0..WARM_UP_BUILDS {
                build(Quality::Low, mode)?;
            }
            for &quality in qualities {
                let scene = build(quality, mode)?;
                contestants.push(Built {
                    mode,
                    quality,
                    samples_ms: vec![milliseconds(&scene)],
                    scene,
                });
            }
        }
        for _ in 1..repeats {
            for built in &mut contestants {
                if built.samples_ms.iter().sum::<f64>() < BUILD_BUDGET_MS {
                    let scene = build(built.quality, built.mode)?;
                    built.samples_ms.push(milliseconds(&scene));
                }
            }
        }
        Ok(Reference {
            contestants,
            queries: device.queries(),
            judges,
        })
    }

    /// The scene of medium quality that hits are judged by.
    pub fn scene(&self, mode: Mode) -> &Scene {
        let contestants = self.contestants.iter();
        let timed = contestants.filter(|b| b.quality == Quality::Medium);
        let timed = timed.map(|b| (b.mode, &b.scene));
        let mut all = timed.chain(self.judges.iter().map(|(mode, scene)| (*mode, scene)));
        let scene = all.find(|(m, _)| *m == mode);
        scene.expect("each mode is built").1
    }

    /// What the scenes that hits are judged by answer, for each of [`Mode::ALL`].
    pub fn answers(&self, batch: &Batch, any: bool) -> [Answers; 2] {
        Mode::ALL.map(|mode| {
            let mut answers = Answers::room(batch.len(), any);
            answers.trace_embree_untimed(self.scene(mode), batch);
            answers
        })
    }
}

/// A tree of another library and the times of all its builds.
pub struct PeerTree {
    pub peer: Peer,
    pub tree: Box<dyn Tree>,
    pub samples_ms: Vec<f64>,
}

impl PeerTree {
    /// Builds each `repeats` times in turn, fewer times where that takes long, after one build that
    /// is not timed. Without those that panic, and warns of them.
    pub fn build_all(mesh: &Mesh, repeats: u32, progress: &Progress) -> Vec<PeerTree> {
        let build = |peer: &Peer| {
            progress.step(&format!("{} builds ({})", peer.name, peer.builder));
            peer.build(mesh)
        };
        let mut trees = Vec::new();
        for peer in peers::ALL {
            if let Some((tree, _)) = build(peer) {
                trees.push(PeerTree {
                    peer: *peer,
                    tree,
                    samples_ms: Vec::new(),
                });
            } else if !mesh.is_empty() {
                progress.warn(&format!("{} {}: no tree", peer.name, peer.builder));
            }
        }
        for _ in 0..repeats {
            for built in &mut trees {
                if built.samples_ms.iter().sum::<f64>() < BUILD_BUDGET_MS
                    && let Some((tree, ms)) = build(&built.peer)
                {
                    built.tree = tree;
                    built.samples_ms.push(ms);
                }
            }
        }
        trees
    }
}

fn milliseconds(scene: &Scene) -> f64 {
    scene.build_time().as_secs_f64() * 1e3
}
