//! Ratios with their intervals, a row for each name; the line at 1 stands out.

use super::axes::{Axis, Plane};
use super::drawing::{INK, PANEL, Shape, drawing, marker, width};
use dacrt_validate::statistics::Ratio;
use plotters::prelude::*;

/// A name and what was measured of it.
pub struct Row {
    pub name: String,
    pub dots: Vec<Dot>,
}

/// A ratio as it is drawn.
pub struct Dot {
    pub color: RGBColor,
    pub shape: Shape,
    pub ratio: Ratio,
}

/// Pixels between two rows.
const ROW: i32 = 18;

/// One panel as a picture, the first row on top, with room for `also` on the axis.
pub fn panel(title: &str, x_title: &str, rows: &[Row], also: &[f64]) -> anyhow::Result<String> {
    let names: Vec<String> = rows.iter().rev().map(|row| row.name.clone()).collect();
    let widest = names.iter().map(|name| width(name)).max().unwrap_or(0);
    let height = 34 + ROW * rows.len() as i32 + 50;
    let frame = [widest + 12, 34, PANEL.0 - 14, height - 50];
    let dots = rows.iter().flat_map(|row| &row.dots);
    let ends = dots.flat_map(|dot| dot.ratio.interval);
    let x = Axis::logarithmic(x_title, ends.chain(also.iter().copied()).chain([1.0]));
    drawing((PANEL.0 as u32, height as u32), |root| {
        let plane = Plane::draw(root, title, frame, x, Axis::names("", &names))?;
        let one = plane.pixel(1.0, 0.0).0;
        let ends = vec![(one, frame[1]), (one, frame[3])];
        root.draw(&PathElement::new(ends, INK.stroke_width(2)))?;
        for (row, place) in rows.iter().rev().zip(0..) {
            for dot in &row.dots {
                let [low, high] = dot.ratio.interval;
                let ends = [low, high].map(|x| plane.pixel(x, f64::from(place)));
                root.draw(&PathElement::new(ends, dot.color.stroke_width(1)))?;
                let at = plane.pixel(dot.ratio.ratio, f64::from(place));
                marker(root, at, dot.color, dot.shape)?;
            }
        }
        Ok(())
    })
}
