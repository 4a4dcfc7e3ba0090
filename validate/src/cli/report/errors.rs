//! Speed against error: what `dacrt plot errors` draws, of each file.

use super::Section;
use super::file::File;
use super::words::{by_file, legend, plots};
use crate::cli::plot::errors::{Panel, SERIES, add, separate};
use dacrt_validate::accuracy::batches;
use maud::{Markup, html};

/// A panel a ray type; none if no file has judged rays and times.
pub fn section(files: &[File]) -> anyhow::Result<Option<Section>> {
    let mut parts: Vec<(&str, Markup)> = Vec::new();
    for file in files {
        let Some(document) = file.results() else {
            continue;
        };
        let batches = batches(document);
        let mut panels: Vec<Panel> = Vec::new();
        for batch in &batches {
            add(&mut panels, batch);
        }
        panels.retain(|panel| {
            let points = panel.chains.iter().map(|chain| chain.points.len());
            points.sum::<usize>() > 1
        });
        if !panels.is_empty() {
            parts.push((&file.name, plots(separate(&mut panels)?)));
        }
    }
    if parts.is_empty() {
        return Ok(None);
    }
    let body = html! {
        p {
            "Left is faster, down is more exact. A point is a scene by one precision of ours (by the method \
             that is the fastest there) or by one mode of Embree with its build; grey lines join what \
             belongs together. Errors are answers of randomly drawn rays that are not those of exact \
             arithmetic; what has none stands on the line at the bottom. Many scenes have no names."
        }
        (legend(SERIES))
        (by_file(parts))
    };
    Ok(Some(Section {
        id: "errors",
        title: "Speed against error",
        body,
    }))
}
