//! The tables for people, 100 columns at most.

use super::Technique;
use super::image::{Image, with_sampling};
use super::printed::{ABLATION, ABLATION_WITHOUT, COLUMNS, Column, RATES, SAMPLES};
use super::trend::{Call, call, trend};
use crate::cli::paper::interval;
use crate::cli::text::columns;
use dacrt_validate::results::{Cell, CellKey};
use dacrt_validate::statistics::{quantile, rank};

/// Fewer cameras than these have no range.
const CAMERAS: usize = 5;
/// The column of Fig. 6 (c), whose rates the paper has.
const RATED: usize = 8;

/// A column as measured.
struct Measured<'a> {
    column: &'static Column,
    cells: &'a [&'a Cell],
    /// Our own camera, and those that the program makes.
    own: &'static str,
    others: Vec<String>,
}

impl<'a> Measured<'a> {
    /// None if no picture of our own camera is whole.
    fn of(column: &'static Column, cells: &'a [&'a Cell]) -> Option<Measured<'a>> {
        let (scene, own) = column.ours?;
        let mut others: Vec<String> = Vec::new();
        for key in cells
            .iter()
            .map(|cell| &cell.key)
            .filter(|key| key.scene == scene)
        {
            if column.has_generated(&key.camera) && !others.contains(&key.camera) {
                others.push(key.camera.clone());
            }
        }
        let measured = Measured {
            column,
            cells,
            own,
            others,
        };
        let any = SAMPLES.iter().any(|&spp| measured.image(spp).is_some());
        any.then_some(measured)
    }

    fn image(&self, spp: u32) -> Option<Image> {
        Image::of(self.cells, self.column, self.own, spp)
    }

    /// The ratios of all cameras that have pictures of this size.
    fn ratios(&self, spp: u32) -> Vec<f64> {
        let cameras = std::iter::once(self.own).chain(self.others.iter().map(String::as_str));
        let images = cameras.filter_map(|camera| Image::of(self.cells, self.column, camera, spp));
        images
            .filter_map(|image| Some(image.ratio()?.ratio))
            .collect()
    }

    /// Places in [`SAMPLES`] of the sizes that our own camera has.
    fn sizes(&self) -> Vec<usize> {
        let places = 0..SAMPLES.len();
        places
            .filter(|&i| self.image(SAMPLES[i]).is_some())
            .collect()
    }

    /// Of each camera that has the sizes of our own, its pictures.
    fn cameras(&self) -> Vec<Vec<Image>> {
        let sizes = self.sizes();
        let cameras = std::iter::once(self.own).chain(self.others.iter().map(String::as_str));
        let of = |camera| {
            let images = sizes.iter();
            images
                .map(|&i| Image::of(self.cells, self.column, camera, SAMPLES[i]))
                .collect()
        };
        cameras.filter_map(of).collect()
    }

    /// How the paper's ratio stands to ours over all cameras.
    fn rows(&self, side: u32) -> Vec<Vec<String>> {
        let mut rows = Vec::new();
        for i in self.sizes() {
            let Some(image) = self.image(SAMPLES[i]) else {
                continue;
            };
            let Some(ratio) = image.ratio() else {
                continue;
            };
            let printed = self.column.ratios()[i];
            let ratios = self.ratios(SAMPLES[i]);
            let range = (ratios.len() >= CAMERAS)
                .then(|| [0.05, 0.95].map(|q| quantile(&ratios, q).unwrap_or(f64::NAN)));
            let (over_cameras, stands) = match range {
                None => ("-".to_owned(), "-"),
                Some([low, high]) => {
                    let stands = match printed {
                        _ if self.column.unsound == Some(i) => "not sound",
                        _ if printed < low => "below",
                        _ if printed > high => "above",
                        _ => "within",
                    };
                    (format!("{low:.2}-{high:.2} of {}", ratios.len()), stands)
                }
            };
            let of_tests = |[without, with]: [u64; 2]| match with {
                0 => "-".to_owned(),
                _ => format!("{:.2}", without as f64 / with as f64),
            };
            rows.push(vec![
                size(side, SAMPLES[i]),
                pair(self.column.ms[i]),
                format!("{printed:.2}"),
                pair(image.ms()),
                interval(&ratio),
                of_tests(image.box_tests),
                of_tests(image.triangle_tests),
                over_cameras,
                stands.to_owned(),
            ]);
        }
        rows
    }
}

/// The cells of pictures, of the size and precision of the first, and the side of the pictures.
fn of_pictures(cells: &[Cell]) -> Option<(Vec<&Cell>, u32)> {
    let known = |cell: &&Cell| COLUMNS.iter().any(|column| column.has(&cell.key));
    let first = &cells.iter().find(known)?.key;
    let [side, _] = first.resolution;
    let like_first = |cell: &&Cell| {
        (cell.key.resolution, &cell.key.precision) == (first.resolution, &first.precision)
    };
    let cells = cells.iter().filter(known).filter(like_first).collect();
    Some((cells, side))
}

/// The heads of [`ratios`].
pub const RATIO_HEADS: [&str; 6] = [
    "picture",
    "size",
    "paper",
    "here [95 %]",
    "5 to 95 % of cameras",
    "paper is",
];

/// A row for each picture: its acceleration ratio in print, here, and over cameras; empty if no picture
/// of a column is whole.
pub fn ratios(cells: &[Cell]) -> Vec<Vec<String>> {
    let Some((cells, side)) = of_pictures(cells) else {
        return Vec::new();
    };
    let of_column = |column| {
        let rows = Measured::of(column, &cells)?.rows(side).into_iter();
        let entries = rows.map(|row| [0, 2, 4, 7, 8].map(|i| row[i].clone()));
        Some(
            entries
                .map(|entries| [&[column.name()], &entries[..]].concat())
                .collect(),
        )
    };
    COLUMNS
        .iter()
        .filter_map(of_column)
        .collect::<Vec<Vec<_>>>()
        .concat()
}

/// All tables; none if no picture of a column is whole.
pub fn text(cells: &[Cell]) -> Option<String> {
    let (cells, side) = of_pictures(cells)?;
    let measured: Vec<Option<Measured>> = (COLUMNS.iter())
        .map(|column| Measured::of(column, &cells))
        .collect();
    measured.iter().find(|column| column.is_some())?;

    let mut text = String::new();
    for (column, measured) in COLUMNS.iter().zip(&measured) {
        text += &pictures(column, measured.as_ref(), side);
    }
    text += NOTES;
    text += &trends(&measured);
    text += &bounces(&measured, side);
    if let Some(measured) = &measured[ABLATION] {
        text += &ablation(measured, side);
    }
    if let Some(measured) = &measured[RATED] {
        text += &rates(measured, side);
    }
    Some(text)
}

/// The table of a column.
fn pictures(column: &Column, measured: Option<&Measured>, side: u32) -> String {
    let mut text = format!("{}\n", column.name());
    let Some(measured) = measured else {
        return text + &format!("  not measured: {}\n\n", column.why_not());
    };
    let (scene, own) = column.ours.unwrap_or_default();
    let rays: Vec<String> = column.rays.iter().map(ToString::to_string).collect();
    let rays = match column.is_of_paths() {
        true => format!("{} to {}", rays[0], rays[rays.len() - 1]),
        false => rays.join(", "),
    };
    text += &format!("  {rays}; {scene}, camera {own}");
    text += &match measured.others.len() {
        0 => "\n".to_owned(),
        1 => " and another one\n".to_owned(),
        n => format!(" and {n} others\n"),
    };
    let head = [
        "  size",
        "paper ms",
        "ratio",
        "here ms",
        "ratio [95 %]",
        "boxes",
        "tris",
        "cameras",
        "paper",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(measured.rows(side));
    text + &columns(&rows, &[0, 1, 2, 3, 4, 5, 6, 7]) + "\n"
}

const NOTES: &str = "\
Milliseconds without/with ray sampling (afra2012/nabata2013), of all batches of a picture; sizes as
in the paper: pictures of one size with 1, 4, 16, 64 samples a pixel. boxes, tris: how many times as
many ray/box tests (those of sample rays counted) and ray/triangle tests without. cameras: 5 to 95 %
of the ratios of so many cameras, and where the paper's ratio stands to that; it prints no camera.

";

/// Whether ratios rise with the size as the paper's do.
fn trends(measured: &[Option<Measured>]) -> String {
    let head = [
        "largest / smallest size",
        "paper",
        "here [95 %]",
        "",
        "rank",
        "here",
        "",
        "of",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for measured in measured.iter().flatten() {
        let (sizes, cameras) = (measured.sizes(), measured.cameras());
        let Some(trend) = trend(&cameras) else {
            continue;
        };
        let printed = measured.column.ratios();
        let printed: Vec<f64> = sizes.iter().map(|&i| printed[i]).collect();
        let quotient = printed[printed.len() - 1] / printed[0];
        let unsound = |i: &usize| measured.column.unsound == Some(*i);
        let ends = [sizes.first(), sizes.last()];
        let unless_unsound = |call: Call, is_sound: bool| match is_sound {
            true => call.name().to_owned(),
            false => "paper unsound".to_owned(),
        };
        let ends_are_sound = !ends.into_iter().flatten().any(unsound);
        let rank_is_sound = !sizes.iter().any(unsound);
        let [low, high] = trend.quotient.interval;
        rows.push(vec![
            measured.column.short_name(),
            format!("{quotient:.2}"),
            format!("{:.2} [{low:.2}, {high:.2}]", trend.quotient.value),
            unless_unsound(call(&trend.quotient, quotient, 1.0), ends_are_sound),
            format!("{:.2}", rank(&printed)),
            format!("{:.2}", trend.rank.value),
            unless_unsound(call(&trend.rank, rank(&printed), 0.0), rank_is_sound),
            cameras.len().to_string(),
        ]);
    }
    match rows.len() {
        1 => String::new(),
        _ => format!(
            "{}Means over as many cameras as have all sizes; the intervals are of cameras and repeats drawn\n\
             anew, of one camera of its repeats alone. rank: Kendall's correlation of ratio and size.\n\n",
            columns(&rows, &[1, 2, 4, 5, 7])
        ),
    }
}

/// Fig. 8 (b): the ratio of each bounce, at the largest size.
fn bounces(measured: &[Option<Measured>], side: u32) -> String {
    let of_paths = measured.iter().flatten();
    let of_paths: Vec<&Measured> = of_paths.filter(|m| m.column.is_of_paths()).collect();
    let mut rows = vec![vec!["Fig. 8 (b): ratio of each batch".to_owned()]];
    let most = of_paths.iter().map(|m| m.column.rays.len()).max();
    for bounce in 0..most.unwrap_or(0) {
        let mut row = vec![match bounce {
            0 => "camera's rays".to_owned(),
            n => format!("bounce {n}"),
        }];
        for measured in &of_paths {
            let spp = measured.sizes().last().map_or(1, |&i| SAMPLES[i]);
            let ratio = (measured.column.rays.get(bounce))
                .and_then(|&rays| {
                    let (cells, column) = (measured.cells, measured.column);
                    Image::of_batch(cells, column, rays, measured.own, spp, &with_sampling)
                })
                .and_then(|batch| batch.ratio());
            row.push(ratio.map_or("-".to_owned(), |ratio| interval(&ratio)));
        }
        rows.push(row);
    }
    for measured in &of_paths {
        let spp = measured.sizes().last().map_or(1, |&i| SAMPLES[i]);
        let scene = measured.column.scene.unwrap_or("");
        rows[0].push(format!("{scene} {}", size(side, spp)));
    }
    match of_paths.is_empty() {
        true => String::new(),
        false => columns(&rows, &[1, 2, 3, 4]) + "\n",
    }
}

/// What each technique saves alone, at the largest size.
fn ablation(measured: &Measured, side: u32) -> String {
    let Some(&largest) = measured.sizes().last() else {
        return String::new();
    };
    let spp = SAMPLES[largest];
    let of = |with: &dyn Fn(&CellKey) -> bool| {
        Image::by(measured.cells, measured.column, measured.own, spp, with)
    };
    let share = |saved: f64, of: f64| format!("{:.1} %", 100.0 * saved / of);
    let head = format!(
        "ablation, {}, {}",
        measured.column.short_name(),
        size(side, spp)
    );
    let titles = ["paper saves", "here saves", "ratio [95 %]", "boxes", "tris"];
    let mut rows = vec![[vec![head], titles.map(str::to_owned).to_vec()].concat()];
    let mut row = |name: &str, printed: f64, image: Option<Image>| {
        let Some((image, ratio)) = image.and_then(|image| Some((image.clone(), image.ratio()?)))
        else {
            return;
        };
        let [without, with] = image.ms();
        let of_tests = |[without, with]: [u64; 2]| format!("{:.2}", without as f64 / with as f64);
        rows.push(vec![
            name.to_owned(),
            share(printed, ABLATION_WITHOUT),
            share(without - with, without),
            interval(&ratio),
            of_tests(image.box_tests),
            of_tests(image.triangle_tests),
        ]);
    };
    for technique in Technique::ALL {
        let (name, saves) = technique.printed();
        row(
            &format!("{name} alone"),
            saves,
            of(&|key| technique.is(key)),
        );
    }
    let all: f64 = Technique::ALL
        .map(|technique| technique.printed().1)
        .iter()
        .sum();
    row("all three", all, measured.image(spp));
    match rows.len() {
        1 => String::new(),
        _ => columns(&rows, &[1, 2, 3, 4, 5]) + "\n",
    }
}

/// Million rays a second of a picture of paths.
fn rates(measured: &Measured, side: u32) -> String {
    let name = measured.column.short_name();
    let mut rows = vec![vec![
        format!("{name}, Mrays/s"),
        "rays".to_owned(),
        "without".to_owned(),
        "with".to_owned(),
    ]];
    for i in measured.sizes() {
        let Some(image) = measured.image(SAMPLES[i]) else {
            continue;
        };
        let [without, with] = image.ms().map(|ms| image.rays as f64 / 1e3 / ms);
        rows.push(vec![
            size(side, SAMPLES[i]),
            format!("{:.1}M", image.rays as f64 / 1e6),
            format!("{without:.2}"),
            format!("{with:.2}"),
        ]);
    }
    let [without, with] = RATES;
    format!(
        "{}Paper: {without} (Áfra 2012, another processor) and {with}. Camera rays count, rays that left the\n\
         scene before do not.\n",
        columns(&rows, &[1, 2, 3])
    )
}

/// `512`, `1024`: the width of the picture whose pixels are the samples.
fn size(side: u32, spp: u32) -> String {
    format!("{}", side * spp.isqrt())
}

/// `415/295`, seconds from a hundred thousand on.
fn pair([without, with]: [f64; 2]) -> String {
    let short = |ms: f64| match ms {
        _ if ms < 9.995 => format!("{ms:.2}"),
        _ if ms < 99.95 => format!("{ms:.1}"),
        _ if ms < 99_999.5 => format!("{ms:.0}"),
        _ => format!("{:.0}k", ms / 1e3),
    };
    format!("{}/{}", short(without), short(with))
}
