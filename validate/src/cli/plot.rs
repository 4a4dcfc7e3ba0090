//! `dacrt plot`: time against errors ([`errors`](mod@errors)), growth ([`growth`]), nodes ([`nodes`]); and
//! what only the report draws.

pub mod axes;
pub mod dots;
pub mod drawing;
pub mod errors;
pub mod growth;
pub mod heat_map;
pub mod lines;
mod nodes;

use super::Verdict;
use super::args::{Plot, PlotArgs};
use super::plan::check_writable;
use super::text::{complain, counted, print};
use anyhow::{Context, bail, ensure};
use dacrt_validate::accuracy::batches;
use dacrt_validate::atomic;
use dacrt_validate::growth as measured;
use dacrt_validate::results::Document;
use std::io::Write;

/// Draws and writes.
pub fn plot(args: &PlotArgs) -> anyhow::Result<Verdict> {
    check_writable(&args.out).context("--out")?;
    let (svg, what) = match args.what {
        Plot::Errors => errors(args)?,
        Plot::Growth => growth_of(args)?,
        Plot::Nodes => nodes_of(args)?,
    };
    let path = args.out.display();
    atomic::write(&args.out, |file| file.write_all(svg.as_bytes()))
        .with_context(|| format!("{path}: cannot be written"))?;
    print(&format!("{path}: {what}\n"))?;
    Ok(Verdict::Good)
}

/// Estimates and splits of the nodes of one trace, and how many these are.
fn nodes_of(args: &PlotArgs) -> anyhow::Result<(String, String)> {
    let [file] = &args.files[..] else {
        bail!("`plot nodes` draws one file");
    };
    let rows = dacrt_validate::nodes::read(file)?;
    ensure!(!rows.is_empty(), "{}: has no nodes", file.display());
    Ok((nodes::draw(&rows)?, counted(rows.len() as u64, "node")))
}

/// Time against numbers, and how much that was.
fn growth_of(args: &PlotArgs) -> anyhow::Result<(String, String)> {
    let [file] = &args.files[..] else {
        bail!("`plot growth` draws one file");
    };
    let document = measured::Document::read(file)?;
    let points = document.curves.iter().flat_map(|curve| &curve.points);
    let timed = points.filter(|point| point.ms.is_some()).count() as u64;
    ensure!(timed > 0, "none of the points has times");
    for left_out in &document.left_out {
        complain(&format!(
            "left out: {} triangles, {} rays: {}",
            left_out.triangles, left_out.rays, left_out.why
        ));
    }
    let what = format!(
        "{}, {}",
        counted(document.curves.len() as u64, "curve"),
        counted(timed, "point")
    );
    Ok((growth::draw(&document.curves)?, what))
}

/// Time against errors, and how much that was.
fn errors(args: &PlotArgs) -> anyhow::Result<(String, String)> {
    let documents: Vec<Document> = (args.files.iter())
        .map(|file| Document::read(file))
        .collect::<Result<_, _>>()?;
    let (mut panels, mut drawn) = (Vec::new(), 0);
    for (document, path) in documents.iter().zip(&args.files) {
        let all = batches(document);
        ensure!(
            !all.is_empty(),
            "{}: its errors were not counted; `dacrt run` counts them",
            path.display()
        );
        for batch in &all {
            let left_out = errors::add(&mut panels, batch);
            drawn += 1;
            for who in left_out {
                let (scene, rays) = (&batch.key.scene, &batch.key.rays);
                complain(&format!(
                    "left out, for it has no times: {scene} {rays} {who}"
                ));
            }
        }
    }
    ensure!(
        panels.iter().any(|panel| !panel.chains.is_empty()),
        "none of the cells has times"
    );
    let svg = errors::draw(&panels)?;
    let batches = match drawn {
        1 => "1 batch".to_owned(),
        n => format!("{n} batches"),
    };
    let points = panels.iter().flat_map(|panel| &panel.chains);
    let points = points.map(|chain| chain.points.len() as u64).sum();
    Ok((svg, format!("{batches}, {}", counted(points, "point"))))
}
