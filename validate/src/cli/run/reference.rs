//! Embree's scenes of one mesh, and what it took to build them.

use super::Progress;
use dacrt::Mesh;
use dacrt_validate::embree::{Device, Quality, Scene};

/// Builds that take longer than this together are not repeated.
const BUILD_BUDGET_MS: f64 = 5_000.0;

/// One mesh in Embree: the contestants in default mode, and a robust scene to be judged by.
pub struct Reference {
    /// In the order of [`Quality::ALL`].
    pub contestants: Vec<Built>,
    pub robust: Scene,
}

/// A scene and the times of all builds of its quality.
pub struct Built {
    pub quality: Quality,
    pub scene: Scene,
    pub samples_ms: Vec<f64>,
}

impl Reference {
    /// Builds each quality `repeats` times in turn; only once more than that of the robust scene,
    /// which is not timed, and fewer times where one round takes seconds.
    pub fn build(
        device: &Device,
        mesh: &Mesh,
        repeats: u32,
        progress: &Progress,
    ) -> anyhow::Result<Reference> {
        let build = |quality: Quality, robust| {
            progress.step(&format!("Embree builds ({})", quality.name()));
            Scene::build(device, mesh, quality, robust)
        };
        // First, so that Embree is warm when the clock counts.
        let robust = build(Quality::Medium, true)?;
        let mut contestants = Vec::new();
        for quality in Quality::ALL {
            let scene = build(quality, false)?;
            contestants.push(Built {
                quality,
                samples_ms: vec![milliseconds(&scene)],
                scene,
            });
        }
        let round: f64 = contestants.iter().map(|b| b.samples_ms[0]).sum();
        let affordable = (BUILD_BUDGET_MS / round) as u32;
        for _ in 1..repeats.min(affordable) {
            for built in &mut contestants {
                let scene = build(built.quality, false)?;
                built.samples_ms.push(milliseconds(&scene));
            }
        }
        Ok(Reference {
            contestants,
            robust,
        })
    }

    /// The scene in default mode that hits are judged by.
    pub fn fast(&self) -> &Scene {
        let medium = |b: &&Built| b.quality == Quality::Medium;
        let built = self.contestants.iter().find(medium);
        &built.expect("all qualities are built").scene
    }
}

fn milliseconds(scene: &Scene) -> f64 {
    scene.build_time().as_secs_f64() * 1e3
}
