//! `dacrt trace`: a user's own rays through a user's own mesh.

use super::Verdict;
use super::args::TraceArgs;
use super::plan::{self, check_writable};
use super::source::{SceneSource, mesh_folders};
use super::text::{columns, counted, print, thousands};
use anyhow::Context;
use dacrt::Mesh;
use dacrt::rays::Hits;
use dacrt::scene::load_mesh;
use dacrt_validate::measure::milliseconds;
use dacrt_validate::npy::{read_rays, write_hits, write_occluded};

/// Traces once and writes the answers. No hits are no error.
pub fn trace(args: &TraceArgs) -> anyhow::Result<Verdict> {
    let method = plan::method(&args.method)?;
    let parameters = args.knobs.single(method)?;
    let precision = plan::precision(&args.precision)?;
    let engine = plan::engine(&args.engine)?;
    check_writable(&args.out).context("--out")?;
    let mesh = load(args)?;
    let batch = read_rays(&args.rays)?;

    let tracer = (engine.tracer(parameters, precision)).with_own_origins(args.own_origins);
    let mut workspace = tracer.workspace(batch.len(), mesh.len());
    let (traced, ms, hits) = if args.any_hit {
        let mut occluded = vec![0; batch.len()];
        let (traced, ms) =
            milliseconds(|| tracer.any(&mesh, &batch, &mut workspace, &mut occluded));
        write_occluded(&args.out, &occluded)?;
        (traced, ms, occluded.iter().filter(|&&o| o != 0).count())
    } else {
        let mut hits = Hits::misses(batch.len());
        let (traced, ms) =
            milliseconds(|| tracer.nearest(&mesh, &batch, &mut workspace, &mut hits));
        write_hits(&args.out, &hits)?;
        (traced, ms, hits.hit_count())
    };

    let mut text = format!(
        "{}, {}, {ms:.3} ms, {:.2} Mrays/s\n",
        counted(batch.len() as u64, "ray"),
        match args.any_hit {
            true => format!("{} occluded", thousands(hits as u64)),
            false => counted(hits as u64, "hit"),
        },
        batch.len() as f64 / ms / 1e3,
    );
    if traced.invalid_rays > 0 {
        let rays = counted(traced.invalid_rays, "invalid ray");
        text += &format!("{rays}, taken for a miss\n");
    }
    if mesh.dropped() > 0 {
        let triangles = counted(mesh.dropped() as u64, "invalid triangle");
        text += &format!("{triangles}, never hit\n");
    }
    if args.counters {
        let counters = serde_json::to_value(traced.counters)?;
        let rows: Vec<Vec<String>> = counters
            .as_object()
            .into_iter()
            .flatten()
            .map(|(name, n)| vec![name.clone(), thousands(n.as_u64().unwrap_or(0))])
            .collect();
        text += &columns(&rows, &[1]);
    }
    print(&text)?;
    Ok(Verdict::Good)
}

/// The mesh of --mesh or --scene, one of which is there.
fn load(args: &TraceArgs) -> anyhow::Result<Mesh> {
    if let Some(file) = &args.target.mesh {
        return Ok(load_mesh(file)?);
    }
    let source = SceneSource::find(args.target.scene.as_deref().unwrap_or_default())?;
    source.mesh(&mesh_folders(&args.meshes))
}
