//! Numbers, names and small pieces of markup that several sections have.

use super::file::File;
use crate::cli::plot::drawing::Shape;
use dacrt_validate::results::{Cell, CellKey};
use dacrt_validate::statistics::Ratio;
use maud::{Markup, PreEscaped, html};
use plotters::style::RGBColor;

/// Methods in the order of legends, each with its colour (Okabe and Ito) and its shape.
pub const METHODS: [(&str, RGBColor, Shape); 6] = [
    ("best", RGBColor(0, 114, 178), Shape::Circle),
    ("nabata2013", RGBColor(213, 94, 0), Shape::Square),
    ("afra2012", RGBColor(0, 158, 115), Shape::Triangle),
    ("mora2011-cones", RGBColor(204, 121, 167), Shape::Cross),
    ("mora2011", RGBColor(150, 100, 20), Shape::Ring),
    ("mora2011-random", RGBColor(20, 20, 20), Shape::Ring),
];

/// How a method is drawn; one that this program does not know is grey.
pub fn look(method: &str) -> (RGBColor, Shape) {
    let known = METHODS.iter().find(|(name, ..)| *name == method);
    known.map_or(
        (RGBColor(110, 110, 110), Shape::Ring),
        |&(_, color, shape)| (color, shape),
    )
}

/// Colours, shapes and what they stand for.
pub fn legend<'a>(entries: impl IntoIterator<Item = (&'a str, RGBColor, Shape)>) -> Markup {
    html! {
        p.legend {
            @for (name, color, shape) in entries {
                span { (marker(color, shape)) (name) }
            }
        }
    }
}

/// The legend of those methods that there are.
pub fn legend_of(methods: &[&str]) -> Markup {
    legend(
        METHODS
            .into_iter()
            .filter(|(name, ..)| methods.contains(name)),
    )
}

fn marker(RGBColor(r, g, b): RGBColor, shape: Shape) -> Markup {
    let color = format!("rgb({r},{g},{b})");
    html! {
        svg width="16" height="12" viewBox="-8 -6 16 12" aria-hidden="true" {
            @match shape {
                Shape::Circle => circle r="4" fill=(color) {},
                Shape::Triangle => path d="M0-5 5 4-5 4Z" fill=(color) {},
                Shape::Square => path d="M-4-4H4V4H-4Z" fill=(color) {},
                Shape::Ring => circle r="4" fill="none" stroke=(color) stroke-width="2" {},
                Shape::Cross => path d="M-4-4 4 4M4-4-4 4" stroke=(color) stroke-width="2" {},
            }
        }
    }
}

/// Plots side by side where there is room.
pub fn plots(svgs: Vec<String>) -> Markup {
    html! {
        div.plots {
            @for svg in svgs { figure { (PreEscaped(svg)) } }
        }
    }
}

/// What there is of each file, under its name. Of several files only the first is unfolded.
pub fn by_file(parts: Vec<(&str, Markup)>) -> Markup {
    if let [(name, body)] = &parts[..] {
        return html! { p.file { (name) } (body) };
    }
    html! {
        @for (i, (name, body)) in parts.iter().enumerate() {
            details open[i == 0] {
                summary { (name) }
                (body)
            }
        }
    }
}

/// A table in a box of its own that scrolls sideways. Heads and columns marked in `right` are flush right.
pub fn table(heads: &[&str], right: &[usize], rows: &[Vec<Markup>]) -> Markup {
    let class = |i: usize| right.contains(&i).then_some("n");
    html! {
        div.scroll {
            table {
                thead { tr { @for (i, head) in heads.iter().enumerate() { th class=[class(i)] { (head) } } } }
                tbody {
                    @for row in rows {
                        tr { @for (i, entry) in row.iter().enumerate() { td class=[class(i)] { (entry) } } }
                    }
                }
            }
        }
    }
}

/// The same of plain text.
pub fn text_table(heads: &[&str], right: &[usize], rows: &[Vec<String>]) -> Markup {
    let marked = |row: &Vec<String>| row.iter().map(|text| html! { (text) }).collect();
    table(heads, right, &rows.iter().map(marked).collect::<Vec<_>>())
}

/// `0.85 [0.81, 0.90]`, or without the interval where that has no width.
pub fn ratio(Ratio { ratio, interval }: Ratio) -> String {
    let [low, high] = interval;
    let digits = if ratio.max(high) < 9.995 { 2 } else { 1 };
    match low == high {
        true => format!("{ratio:.digits$}"),
        false => format!("{ratio:.digits$} [{low:.digits$}, {high:.digits$}]"),
    }
}

/// The ratios of a cell, each with its interval.
pub fn acceleration(cell: &Cell) -> Option<Ratio> {
    of(cell.acceleration_ratio, cell.acceleration_interval)
}

/// Likewise, to Embree with its build.
pub fn embree_total(cell: &Cell) -> Option<Ratio> {
    of(cell.ratio_embree_total, cell.ratio_embree_total_interval)
}

/// Likewise, to Embree's trace alone.
pub fn embree_trace(cell: &Cell) -> Option<Ratio> {
    of(cell.ratio_embree_trace, cell.ratio_embree_trace_interval)
}

fn of(ratio: Option<f64>, interval: Option<[f64; 2]>) -> Option<Ratio> {
    let ratio = ratio?;
    let interval = interval.unwrap_or([ratio; 2]);
    Some(Ratio { ratio, interval })
}

/// `512x512`, `512x512 x4` with four samples a pixel.
pub fn size(key: &CellKey) -> String {
    let [width, height] = key.resolution;
    match key.spp {
        1 => format!("{width}x{height}"),
        spp => format!("{width}x{height} x{spp}"),
    }
}

/// Rays that start from the camera.
pub fn camera_rays(key: &CellKey) -> f64 {
    f64::from(key.resolution[0]) * f64::from(key.resolution[1]) * f64::from(key.spp)
}

/// `512²`, or `1280x800` where it is no square.
pub fn camera_rays_in_words(key: &CellKey) -> String {
    let rays = camera_rays(key) as u64;
    match rays.isqrt() {
        side if side * side == rays => format!("{side}²"),
        _ => size(key),
    }
}

/// What tells the batch from others of the file: the camera and the size only where there are several.
pub fn batch_name(file: &File, key: &CellKey) -> String {
    let cells = file.cells();
    let same_scene = |cell: &&Cell| cell.key.scene == key.scene;
    let mut name = format!("{} {}", key.scene, key.rays);
    if cells
        .iter()
        .filter(same_scene)
        .any(|cell| cell.key.camera != key.camera)
    {
        name += &format!(" {}", key.camera);
    }
    if cells.iter().any(|cell| size(&cell.key) != size(key)) {
        name += &format!(" {}", camera_rays_in_words(key));
    }
    name
}

/// Each thing once, in the order in which they come.
pub fn distinct<T: PartialEq>(all: impl IntoIterator<Item = T>) -> Vec<T> {
    let mut distinct = Vec::new();
    for one in all {
        if !distinct.contains(&one) {
            distinct.push(one);
        }
    }
    distinct
}
