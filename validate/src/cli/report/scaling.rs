//! The acceleration ratio against resolution and against bounces.

use super::Section;
use super::file::File;
use super::words::{camera_rays, camera_rays_in_words, distinct, legend_of, look, plots};
use crate::cli::plot::axes::Axis;
use crate::cli::plot::lines::{Line, panel};
use dacrt_validate::results::{Cell, CellKey};
use dacrt_validate::statistics::geometric_mean;
use maud::html;

const READING: &str = "Above 1 is faster than afra2012 on the same rays in the same run. Pale: each scene and \
                       camera; bold: the geometric mean where all of them have points. Default parameters.";

/// Against the number of rays from the camera, a panel a ray type.
pub fn resolution(files: &[File]) -> anyhow::Result<Option<Section>> {
    let view = View {
        id: "resolution",
        title: "Acceleration ratio against resolution",
        panel: |key| Some(key.rays.clone()),
        x: camera_rays,
        x_in_words: camera_rays_in_words,
        x_title: "rays from the camera",
    };
    view.section(files)
}

/// Against the bounce, a panel a size.
pub fn bounce(files: &[File]) -> anyhow::Result<Option<Section>> {
    let view = View {
        id: "bounce",
        title: "Acceleration ratio against bounces",
        panel: |key| {
            bounce_of(key).map(|_| format!("{} rays from the camera", camera_rays_in_words(key)))
        },
        x: |key| bounce_of(key).unwrap_or_default(),
        x_in_words: |key| bounce_of(key).unwrap_or_default().to_string(),
        x_title: "diffuse bounce",
    };
    view.section(files)
}

/// 1 of `diffuse-1`.
fn bounce_of(key: &CellKey) -> Option<f64> {
    key.rays.strip_prefix("diffuse-")?.parse().ok()
}

/// What is put against what.
struct View {
    id: &'static str,
    title: &'static str,
    /// The panel of a cell, if it has one.
    panel: fn(&CellKey) -> Option<String>,
    x: fn(&CellKey) -> f64,
    x_in_words: fn(&CellKey) -> String,
    x_title: &'static str,
}

/// Ratios of one method, scene and camera.
struct Curve<'a> {
    method: &'a str,
    points: Vec<(f64, f64)>,
}

impl View {
    fn section(&self, files: &[File]) -> anyhow::Result<Option<Section>> {
        let (mut parts, mut methods) = (Vec::new(), Vec::new());
        for file in files {
            let cells: Vec<&Cell> = (file.cells().iter())
                .filter(|cell| cell.acceleration_ratio.is_some() && cell.key.is_preset())
                .filter(|cell| cell.key.method != "afra2012")
                .collect();
            let mut svgs = Vec::new();
            for name in distinct(cells.iter().filter_map(|cell| (self.panel)(&cell.key))) {
                let of_panel = |cell: &&&Cell| (self.panel)(&cell.key).as_ref() == Some(&name);
                let cells: Vec<&Cell> = cells.iter().filter(of_panel).copied().collect();
                let curves = self.curves(&cells);
                if !curves.is_empty() {
                    methods.extend(curves.iter().map(|curve| curve.method));
                    svgs.push(self.draw(&name, &cells, &curves)?);
                }
            }
            if !svgs.is_empty() {
                parts.push((file.name.as_str(), plots(svgs)));
            }
        }
        let introduction = html! { p { (READING) } (legend_of(&methods)) };
        Ok(Section::by_file(self.id, self.title, introduction, parts))
    }

    /// A curve for all cells that differ in x only; those with one point are none.
    fn curves<'a>(&self, cells: &[&'a Cell]) -> Vec<Curve<'a>> {
        let others = |cell: &'a Cell| {
            let key = &cell.key;
            (&key.method, &key.precision, &key.scene, &key.camera)
        };
        let of = |group| {
            let members = cells.iter().filter(|cell| others(cell) == group);
            let mut points: Vec<(f64, f64)> = members
                .filter_map(|cell| Some(((self.x)(&cell.key), cell.acceleration_ratio?)))
                .collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            points.dedup_by_key(|point| point.0);
            Curve {
                method: group.0.as_str(),
                points,
            }
        };
        let groups = distinct(cells.iter().map(|cell| others(cell)));
        groups
            .into_iter()
            .map(of)
            .filter(|curve| curve.points.len() > 1)
            .collect()
    }

    fn draw(&self, name: &str, cells: &[&Cell], curves: &[Curve]) -> anyhow::Result<String> {
        let mut ticks = distinct(cells.iter().map(|cell| {
            let key = &cell.key;
            ((self.x)(key), (self.x_in_words)(key))
        }));
        ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        ticks.dedup_by_key(|tick| tick.0);
        let mut lines: Vec<Line> = Vec::new();
        for method in distinct(curves.iter().map(|curve| curve.method)) {
            let (color, shape) = look(method);
            let of_method = curves.iter().filter(|curve| curve.method == method);
            let of_method: Vec<&Curve> = of_method.collect();
            let line = |points, shape| Line {
                color,
                shape,
                label: String::new(),
                points,
            };
            if of_method.len() > 1 {
                lines.extend(
                    of_method
                        .iter()
                        .map(|curve| line(curve.points.clone(), None)),
                );
            }
            lines.push(line(mean(&of_method), Some(shape)));
        }
        panel(
            name,
            Axis::logarithmic_at(self.x_title, ticks),
            "times as fast as afra2012",
            &lines,
        )
    }
}

/// The geometric mean where all curves have points; if that is one place or none, of the curves that have
/// those of the longest.
fn mean(curves: &[&Curve]) -> Vec<(f64, f64)> {
    let Some(longest) = curves.iter().max_by_key(|curve| curve.points.len()) else {
        return Vec::new();
    };
    let has = |curve: &Curve, x: f64| curve.points.iter().any(|point| point.0 == x);
    let all = || longest.points.iter().map(|point| point.0);
    let common: Vec<f64> = all()
        .filter(|&x| curves.iter().all(|curve| has(curve, x)))
        .collect();
    let xs = if common.len() > 1 {
        common
    } else {
        all().collect()
    };
    let whole = curves
        .iter()
        .filter(|curve| xs.iter().all(|&x| has(curve, x)));
    let whole: Vec<&&Curve> = whole.collect();
    let at = |x: f64| {
        let points = whole.iter().flat_map(|curve| &curve.points);
        let ratios: Vec<f64> = points
            .filter(|point| point.0 == x)
            .map(|point| point.1)
            .collect();
        Some((x, geometric_mean(&ratios)?))
    };
    xs.into_iter().filter_map(at).collect()
}
