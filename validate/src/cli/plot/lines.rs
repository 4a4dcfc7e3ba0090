//! Curves in a frame, such as a ratio against a size; the line at 1 stands out.

use super::axes::{Axis, Plane};
use super::drawing::{INK, PANEL, Shape, drawing, marker, place, style, width};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A curve.
pub struct Line {
    pub color: RGBColor,
    /// How its points are drawn; a curve without is thin and pale.
    pub shape: Option<Shape>,
    /// What stands at its end.
    pub label: String,
    pub points: Vec<(f64, f64)>,
}

/// One panel as a picture, pale curves below the others; `y` is a logarithmic axis with room for 1.
pub fn panel(title: &str, x: Axis, y_title: &str, lines: &[Line]) -> anyhow::Result<String> {
    let (w, h) = PANEL;
    let frame = [62, 34, w - 14, h - 50];
    let numbers = lines.iter().flat_map(|line| &line.points);
    let y = Axis::logarithmic(y_title, numbers.map(|point| point.1).chain([1.0]));
    drawing((w as u32, h as u32), |root| {
        let plane = Plane::draw(root, title, frame, x, y)?;
        let one = plane.pixel(1.0, 1.0).1;
        let ends = vec![(frame[0], one), (frame[2], one)];
        root.draw(&PathElement::new(ends, INK.stroke_width(1)))?;
        let pixels = |line: &Line| -> Vec<(i32, i32)> {
            line.points
                .iter()
                .map(|&(x, y)| plane.pixel(x, y))
                .collect()
        };
        for line in lines.iter().filter(|line| line.shape.is_none()) {
            let pale = line.color.mix(0.3).stroke_width(1);
            root.draw(&PathElement::new(pixels(line), pale))?;
        }
        let mut taken = Vec::new();
        for line in lines {
            let Some(shape) = line.shape else { continue };
            root.draw(&PathElement::new(pixels(line), line.color.stroke_width(2)))?;
            for (x, y) in pixels(line) {
                marker(root, (x, y), line.color, shape)?;
                taken.push([x - 6, y - 6, x + 6, y + 6]);
            }
        }
        for line in lines.iter().filter(|line| !line.label.is_empty()) {
            let Some(&last) = pixels(line).last() else {
                continue;
            };
            let label = place(last, width(&line.label), frame, &taken);
            taken.push(label);
            let left = style(line.color).pos(Pos::new(HPos::Left, VPos::Center));
            let at = (label[0] + 1, (label[1] + label[3]) / 2);
            root.draw_text(&line.label, &left, at)?;
        }
        Ok(())
    })
}
