//! What each technique of ray sampling gives alone, beside the others, and with them.

use super::Section;
use super::file::File;
use super::words::text_table;
use crate::cli::table::ablation::{LEGEND, groups};
use maud::html;

/// The tables of `dacrt table --ablation`; none if no file has all combinations.
pub fn section(files: &[File]) -> Option<Section> {
    let mut parts = Vec::new();
    for file in files {
        let groups = groups(file.results().map_or(&[], |document| &document.cells));
        if groups.is_empty() {
            continue;
        }
        let body = html! {
            @for group in &groups {
                @if let Some((heads, rows)) = group.rows.split_first() {
                    h3 { (group.heading) }
                    @let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
                    (text_table(&heads, &[1, 2, 3, 4], rows))
                }
            }
        };
        parts.push((file.name.as_str(), body));
    }
    let introduction = html! { p { (LEGEND.trim()) } };
    Section::by_file("ablation", "Ablation of ray sampling", introduction, parts)
}
