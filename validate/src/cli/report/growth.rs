//! How time grows with rays and triangles: what `dacrt plot growth` draws.

use super::Section;
use super::file::{Content, File};
use super::words::{legend, plots};
use crate::cli::plot::growth::{SERIES, separate};
use maud::html;

/// The panels of all files of `dacrt bench growth`.
pub fn section(files: &[File]) -> anyhow::Result<Option<Section>> {
    let mut parts = Vec::new();
    for file in files {
        let Content::Growth(document) = &file.content else {
            continue;
        };
        let body = html! {
            (plots(separate(&document.curves)?))
            @if !document.left_out.is_empty() {
                p { "Left out:" }
                ul {
                    @for out in &document.left_out {
                        li { (out.triangles) " triangles, " (out.rays) " rays: " (out.why) }
                    }
                }
            }
        };
        parts.push((file.name.as_str(), body));
    }
    let looks = SERIES
        .iter()
        .map(|&(_, name, color, shape)| (name, color, shape));
    let introduction = html! {
        p {
            "Both axes are logarithmic: a straight line is a power of the number. The grey line is n log n \
             through the last point of best; what is steeper grows faster."
        }
        (legend(looks))
    };
    Ok(Section::by_file(
        "growth",
        "How time grows",
        introduction,
        parts,
    ))
}
