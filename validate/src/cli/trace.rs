//! `dacrt trace`: a user's own rays through a user's own mesh.

use super::Verdict;
use super::args::TraceArgs;
use super::plan::{self, check_writable};
use super::text::{columns, print, thousands};
use anyhow::Context;
use dacrt::rays::Hits;
use dacrt::scene::load_mesh;
use dacrt::{Tracer, Workspace};
use dacrt_validate::measure::milliseconds;
use dacrt_validate::npy::{read_rays, write_hits, write_occluded};

/// Traces once and writes the answers. No hits are no error.
pub fn trace(args: &TraceArgs) -> anyhow::Result<Verdict> {
    let method = plan::method(&args.method)?;
    let parameters = args.knobs.single(method)?;
    let engine = plan::engine(&args.engine)?;
    check_writable(&args.out).context("--out")?;
    let mesh = load_mesh(&args.mesh)?;
    let batch = read_rays(&args.rays)?;

    let tracer = Tracer::new(parameters)
        .with_isa(engine.isa)
        .with_seed(engine.seed);
    let mut workspace = Workspace::new(batch.len(), mesh.len());
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

    let count = |n: usize| thousands(n as u64);
    let mut text = format!(
        "{} rays, {} {}, {ms:.3} ms, {:.2} Mrays/s",
        count(batch.len()),
        count(hits),
        if args.any_hit { "occluded" } else { "hits" },
        batch.len() as f64 / ms / 1e3,
    );
    if traced.invalid_rays > 0 {
        text += &format!(", {} invalid rays miss", thousands(traced.invalid_rays));
    }
    if mesh.dropped() > 0 {
        text += &format!(
            ", {} invalid triangles are never hit",
            count(mesh.dropped())
        );
    }
    text.push('\n');
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
