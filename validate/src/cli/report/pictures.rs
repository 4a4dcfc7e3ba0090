//! Pictures made for the page: how a scene looks, what a ray costs, and where Embree differs.

use super::Section;
use crate::cli::args::{ReportArgs, What};
use crate::cli::color;
use crate::cli::plan;
use crate::cli::render::RenderJob;
use crate::cli::size::Spp;
use crate::cli::source::{SceneSource, mesh_folders};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use dacrt::{Method, Precision};
use dacrt_validate::diff::Class;
use maud::{Markup, html};

/// Samples a pixel of the shaded picture.
const SAMPLES: Spp = Spp(16);
const WHAT: [(What, &str); 3] = [
    (What::Shaded, "render"),
    (What::Boxes, "ray/box tests"),
    (What::Diff, "against Embree"),
];

/// Three pictures for each scene that is asked for; none if nothing is.
pub fn section(args: &ReportArgs) -> anyhow::Result<Option<Section>> {
    let Some(names) = &args.pictures else {
        return Ok(None);
    };
    // All names first, for a picture may take minutes.
    let sources = plan::distinct(names).map(SceneSource::find);
    let sources: Vec<SceneSource> = sources.collect::<anyhow::Result<_>>()?;
    let scenes: Vec<Markup> = (sources.iter())
        .map(|source| of_scene(source, args))
        .collect::<anyhow::Result<_>>()?;
    let body = html! {
        p {
            "Made with this page by nabata2013 in precision fast, first camera. Ray/box tests: of each tile of \
             8 x 8 pixels traced as a batch of its own, from black (none) over blue, green and yellow to red. \
             Against Embree's default mode: grey where both agree; "
            @for class in Class::PARTED {
                @let [r, g, b] = color::class(class);
                span.class { span.swatch style=(format!("background:rgb({r},{g},{b})")) {} (class.name()) } " "
            }
        }
        @for scene in scenes { (scene) }
    };
    Ok(Some(Section {
        id: "pictures",
        title: "Pictures",
        body,
    }))
}

fn of_scene(source: &SceneSource, args: &ReportArgs) -> anyhow::Result<Markup> {
    let job = RenderJob {
        source,
        camera: None,
        resolution: args.picture_resolution,
        spp: SAMPLES,
        parameters: Method::Nabata2013.parameters(),
        precision: Precision::Fast,
        engine: plan::Engine {
            isa: dacrt::Isa::best(),
            seed: 1,
            threads: 1,
        },
        mesh_folders: mesh_folders(&args.meshes),
    };
    let mut pictures = Vec::new();
    job.pictures(&WHAT.map(|(what, _)| what), &mut |what, picture, note| {
        let data = format!(
            "data:image/png;base64,{}",
            BASE64_STANDARD.encode(picture.png()?)
        );
        let named = WHAT.iter().find(|(of, _)| *of == what);
        let name = named.map_or(what.name(), |(_, name)| name);
        pictures.push((name, note.to_owned(), data));
        Ok(())
    })?;
    let scene = source.name();
    Ok(html! {
        h3 { (scene) }
        div.pictures {
            @for (name, note, data) in pictures {
                figure {
                    img src=(data) alt=(format!("{scene}: {name}"))
                        width=(args.picture_resolution.width) height=(args.picture_resolution.height);
                    figcaption { (name) @if !note.is_empty() { ": " (note) } }
                }
            }
        }
    })
}
