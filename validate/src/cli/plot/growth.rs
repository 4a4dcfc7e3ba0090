//! `dacrt plot growth`: time against the number of rays or triangles, both logarithmic.

use super::drawing::{
    Area, Drawn, INK, PANEL, Shape, TOP, chart_on, drawing, marker, mesh, panel_at, style, tick,
    width,
};
use dacrt_validate::growth::{Curve, Grows, Point};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Who is drawn how. Of the last one it is the trace alone.
pub const SERIES: [(&str, &str, RGBColor, Shape); 6] = [
    ("best", "best", RGBColor(0, 114, 178), Shape::Circle),
    (
        "afra2012",
        "afra2012",
        RGBColor(0, 158, 115),
        Shape::Triangle,
    ),
    (
        "nabata2013",
        "nabata2013",
        RGBColor(213, 94, 0),
        Shape::Square,
    ),
    (
        "embree-low",
        "Embree, low",
        RGBColor(130, 130, 130),
        Shape::Ring,
    ),
    (
        "embree-medium",
        "Embree, medium",
        RGBColor(20, 20, 20),
        Shape::Cross,
    ),
    (
        "embree-medium",
        "its trace alone",
        RGBColor(190, 150, 60),
        Shape::Ring,
    ),
];
const TRACE_ALONE: usize = SERIES.len() - 1;
const N_LOG_N: &str = "n log n";
const GUIDE: RGBColor = RGBColor(200, 200, 200);

/// A picture with a panel for each number that grows and each ray type.
pub fn draw(curves: &[Curve]) -> anyhow::Result<String> {
    let (panels, ms) = (panels(curves), milliseconds(curves));
    let down = panels.len().div_ceil(2) as i32;
    let size = ((2 * PANEL.0) as u32, (TOP + down * PANEL.1) as u32);
    drawing(size, |root| {
        legend(root)?;
        for (panel, i) in panels.iter().zip(0..) {
            let at = (i % 2 * PANEL.0, TOP + i / 2 * PANEL.1);
            draw_panel(root, panel, at, ms)?;
        }
        Ok(())
    })
}

/// Each panel as a picture of its own, without a legend.
pub fn separate(curves: &[Curve]) -> anyhow::Result<Vec<String>> {
    let ms = milliseconds(curves);
    let size = (PANEL.0 as u32, PANEL.1 as u32);
    let one = |panel: Vec<&Curve>| drawing(size, |root| draw_panel(root, &panel, (0, 0), ms));
    panels(curves).into_iter().map(one).collect()
}

/// The curves of each number that grows and each ray type.
fn panels(curves: &[Curve]) -> Vec<Vec<&Curve>> {
    let mut panels: Vec<Vec<&Curve>> = Vec::new();
    for curve in curves {
        let same = |panel: &&mut Vec<&Curve>| {
            (panel[0].grows, &panel[0].rays) == (curve.grows, &curve.rays)
        };
        match panels.iter_mut().find(same) {
            Some(panel) => panel.push(curve),
            None => panels.push(vec![curve]),
        }
    }
    panels
}

/// The range of all times.
fn milliseconds(curves: &[Curve]) -> (f64, f64) {
    let points = curves.iter().flat_map(|curve| &curve.points);
    let times: Vec<f64> = points.flat_map(|p| [p.ms, p.trace_ms]).flatten().collect();
    range(&times)
}

/// The least and the greatest, and some room.
fn range(of: &[f64]) -> (f64, f64) {
    let all = of.iter().copied();
    let (least, most) = all.fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    (least / 1.5, most * 1.5)
}

fn legend(root: &Area) -> Drawn {
    let left = style(INK).pos(Pos::new(HPos::Left, VPos::Center));
    let mut x = 24;
    for (_, name, color, shape) in SERIES {
        marker(root, (x, TOP / 2), color, shape)?;
        root.draw_text(name, &left, (x + 10, TOP / 2))?;
        x += 34 + width(name);
    }
    let line = vec![(x - 6, TOP / 2), (x + 14, TOP / 2)];
    root.draw(&PathElement::new(line, GUIDE.stroke_width(3)))?;
    root.draw_text(N_LOG_N, &left, (x + 20, TOP / 2))
}

fn draw_panel(root: &Area, panel: &[&Curve], at: (i32, i32), ms: (f64, f64)) -> Drawn {
    let Curve { grows, rays, .. } = panel[0];
    let all = panel.iter().flat_map(|curve| &curve.points);
    let numbers: Vec<f64> = all.clone().map(|p| p.number(*grows) as f64).collect();
    let n = range(&numbers);
    let fixed = match grows {
        Grows::Rays => format!("{} triangles", tick_of(all.map(|p| p.triangles))),
        Grows::Triangles => format!("{} rays", tick_of(all.map(|p| p.rays))),
    };
    let area = panel_at(root, at);
    let mut chart = chart_on(&area, &format!("{rays}, {fixed}"))
        .build_cartesian_2d((n.0..n.1).log_scale(), (ms.0..ms.1).log_scale())?;
    mesh(&mut chart)
        .x_desc(grows.name())
        .y_desc("milliseconds")
        .x_label_formatter(&|x| tick(*x))
        .y_label_formatter(&|y| tick(*y))
        .draw()?;
    let pixel = |n: f64, ms: f64| chart.backend_coord(&(n, ms));
    if let Some((to, most)) = last_of_first(panel) {
        // Through the last point, as far as it is in the frame.
        let guide = |x: f64| most * (x * x.ln()) / (to * to.ln());
        let steps = (0..=40).map(|i| n.0 * (to / n.0).powf(f64::from(i) / 40.0));
        let inside = steps.filter(|&x| guide(x) > ms.0);
        let line: Vec<(i32, i32)> = inside.map(|x| pixel(x, guide(x))).collect();
        root.draw(&PathElement::new(line, GUIDE.stroke_width(3)))?;
    }
    for (i, (contestant, _, color, shape)) in SERIES.into_iter().enumerate() {
        let Some(curve) = panel.iter().find(|c| c.contestant == contestant) else {
            continue;
        };
        let points = curve.points.iter().filter_map(|point| {
            let ms = if i == TRACE_ALONE {
                point.trace_ms
            } else {
                point.ms
            };
            Some(pixel(point.number(*grows) as f64, ms?))
        });
        let points: Vec<(i32, i32)> = points.collect();
        root.draw(&PathElement::new(points.clone(), color.stroke_width(1)))?;
        for point in points {
            marker(root, point, color, shape)?;
        }
    }
    Ok(())
}

/// The last point of the first of [`SERIES`].
fn last_of_first(panel: &[&Curve]) -> Option<(f64, f64)> {
    let curve = panel.iter().find(|c| c.contestant == SERIES[0].0)?;
    let timed = |point: &Point| Some((point.number(curve.grows) as f64, point.ms?));
    curve.points.iter().rev().find_map(timed)
}

/// The most of some numbers, with commas.
fn tick_of(numbers: impl Iterator<Item = usize>) -> String {
    crate::cli::text::thousands(numbers.max().unwrap_or_default() as u64)
}
