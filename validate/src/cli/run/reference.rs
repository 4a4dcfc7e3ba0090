//! Embree's scenes of one mesh, and what it took to build them.

use crate::cli::progress::Progress;
use dacrt::Mesh;
use dacrt_validate::embree::{Device, Quality, Scene};

/// A quality whose builds have taken this long together is not built again.
const BUILD_BUDGET_MS: f64 = 5_000.0;
/// Untimed builds before the clock counts: the first two of low quality take up to four times as
/// long as later ones, which would flatter us.
const WARM_UP_BUILDS: u32 = 2;

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
    /// Builds each quality `repeats` times in turn, fewer times where that takes long; the robust
    /// scene once, which is not timed.
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
        let robust = build(Quality::Medium, true)?;
        for _ in 0..WARM_UP_BUILDS {
            build(Quality::Low, false)?;
        }
        let mut contestants = Vec::new();
        for quality in Quality::ALL {
            let scene = build(quality, false)?;
            contestants.push(Built {
                quality,
                samples_ms: vec![milliseconds(&scene)],
                scene,
            });
        }
        for _ in 1..repeats {
            for built in &mut contestants {
                if built.samples_ms.iter().sum::<f64>() < BUILD_BUDGET_MS {
                    let scene = build(built.quality, false)?;
                    built.samples_ms.push(milliseconds(&scene));
                }
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
