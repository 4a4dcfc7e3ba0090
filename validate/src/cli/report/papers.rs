//! The papers' figures beside ours, of files of `dacrt paper`.

use super::Section;
use super::file::File;
use super::words::text_table;
use crate::cli::paper::mora::fig8::Figure;
use crate::cli::paper::nabata::text::{RATIO_HEADS, ratios};
use dacrt_validate::results::{Cell, Document};
use maud::{Markup, html};

/// Acceleration ratios of Nabata's pictures and what Mora's cones save.
pub fn section(files: &[File]) -> Option<Section> {
    let documents = files
        .iter()
        .filter_map(|file| Some((file, file.results()?)));
    let of_papers = documents.filter(|(_, document)| is_of_paper(document));
    let parts: Vec<(&str, Markup)> = of_papers
        .filter_map(|(file, document)| Some((file.name.as_str(), tables(&document.cells)?)))
        .collect();
    let introduction = html! {
        p {
            "Processors, cameras and some scenes are not those of the papers, so ratios can be held against \
             each other, times cannot."
        }
    };
    Section::by_file("papers", "The papers' figures", introduction, parts)
}

/// Whether it or a piece of it is of `dacrt paper`.
fn is_of_paper(document: &Document) -> bool {
    let pieces = document.pieces.iter().map(|piece| &piece.command);
    let mut commands = pieces.chain([&document.command]);
    commands.any(|command| command.iter().any(|word| word == "paper"))
}

fn tables(cells: &[Cell]) -> Option<Markup> {
    let nabata = ratios(cells);
    let figure = Figure::of(cells);
    if nabata.is_empty() && figure.is_empty() {
        return None;
    }
    Some(html! {
        @if !nabata.is_empty() {
            h3 { "Nabata 2013, Figs. 4 to 7: time without ray sampling over time with it" }
            (text_table(&RATIO_HEADS, &[1, 2, 3, 4], &nabata))
        }
        @if !figure.is_empty() {
            h3 { "Mora 2011, Fig. 8: what rays in cones save, primary rays" }
            @let rows = [figure.cuts(), vec![Figure::printed_cuts()]].concat();
            (text_table(
                &["scene", "box tests, basic/cones", "time, basic/cones [95 %]", "ray/box a ray, basic",
                  "triangles a pixel"],
                &[1, 2, 3, 4],
                &rows,
            ))
        }
    })
}
