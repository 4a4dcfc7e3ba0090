//! Speed against error: what `dacrt plot errors` draws, of each file.

use super::Section;
use super::file::File;
use super::words::{by_file, legend, plots};
use crate::cli::plot::errors::{Panel, SERIES, add, separate};
use crate::cli::text::counted;
use dacrt_validate::accuracy::{Batch, batches};
use maud::{Markup, html};

/// A panel a ray type for files with errors, a sentence for those without; none if no file has judged rays.
pub fn section(files: &[File]) -> anyhow::Result<Option<Section>> {
    let mut parts: Vec<(&str, Markup)> = Vec::new();
    let mut clean: Vec<String> = Vec::new();
    for file in files {
        let batches = file.results().map(batches).unwrap_or_default();
        if batches.is_empty() {
            continue;
        }
        let has_errors = |batch: &Batch| batch.tracers.iter().any(|who| who.errors.all() > 0);
        let panels = panels(&batches);
        if !batches.iter().any(has_errors) {
            let sample: u64 = batches.iter().map(|batch| batch.sample).sum();
            clean.push(format!("{} ({})", file.name, counted(sample, "judged ray")));
        } else if !panels.is_empty() {
            parts.push((&file.name, plots(separate(panels)?)));
        }
    }
    if parts.is_empty() && clean.is_empty() {
        return Ok(None);
    }
    let body = html! {
        @if !clean.is_empty() {
            p {
                "Neither ours nor Embree's modes have an answer that is not that of exact arithmetic among the \
                 randomly drawn rays of " (clean.join(", ")) "."
            }
        }
        @if !parts.is_empty() { (drawn(parts)) }
    };
    Ok(Some(Section {
        id: "errors",
        title: "Speed against error",
        body,
    }))
}

/// Those with more than one point, and of these those with errors if any has.
fn panels(batches: &[Batch]) -> Vec<Panel> {
    let mut panels: Vec<Panel> = Vec::new();
    for batch in batches {
        add(&mut panels, batch);
    }
    panels.retain(|panel| {
        let points = panel.chains.iter().map(|chain| chain.points.len());
        points.sum::<usize>() > 1
    });
    let has_errors = |panel: &Panel| {
        let mut points = panel.chains.iter().flat_map(|chain| &chain.points);
        points.any(|&(_, _, errors)| errors > 0.0)
    };
    if panels.iter().any(has_errors) {
        panels.retain(has_errors);
    }
    panels
}

fn drawn(parts: Vec<(&str, Markup)>) -> Markup {
    html! {
        p {
            "Left is faster, down is more exact. A point is a scene by one precision of ours (by the method \
             that is the fastest there) or by one mode of Embree with its build; grey lines join what \
             belongs together. Errors are answers of randomly drawn rays that are not those of exact \
             arithmetic; what has none stands on the line at the bottom. Where there are many scenes, they \
             have no names; ray types without any error are left out."
        }
        (legend(SERIES))
        (by_file(parts))
    }
}
