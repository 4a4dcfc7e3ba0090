//! The page around the sections. Style and script stand in it, so that it needs nothing else.

use super::Section;
use super::file::File;
use crate::cli::text::counted;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The whole page.
pub fn html(files: &[File], sections: &[Section]) -> Markup {
    let title = match files {
        [file] => file.name.clone(),
        files => counted(files.len() as u64, "file"),
    };
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                // Else a browser asks for one.
                link rel="icon" href="data:,";
                title { "dacrt: " (title) }
                style { (PreEscaped(include_str!("report.css"))) }
            }
            body {
                header {
                    h1 { "dacrt: " (title) }
                    nav { @for section in sections { a href={ "#" (section.id) } { (section.title) } } }
                }
                main {
                    @for section in sections {
                        section id=(section.id) {
                            h2 { (section.title) }
                            (section.body)
                        }
                    }
                }
                script { (PreEscaped(include_str!("report.js"))) }
            }
        }
    }
}
