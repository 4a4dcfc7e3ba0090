//! Times over the best for each pair of values of two parameters.

use super::axes::{Axis, Plane};
use super::drawing::{INK, PANEL, drawing, style, width};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A field this many times as slow as the best is as dark as can be.
const DARKEST: f64 = 2.0;

/// One panel as a picture. `names` and `values` are those of the parameters along x and y; `field` gives
/// the number of a pair, at least 1; `None` where there is none.
pub fn panel(
    title: &str,
    names: [&str; 2],
    values: [&[String]; 2],
    field: &dyn Fn(usize, usize) -> Option<f64>,
) -> anyhow::Result<String> {
    const ROW: i32 = 30;
    let widest = values[1].iter().map(|name| width(name)).max().unwrap_or(0);
    let height = 34 + ROW * values[1].len() as i32 + 50;
    let frame = [widest + 36, 34, PANEL.0 - 14, height - 50];
    let [x, y] = [0, 1].map(|i| Axis::names(names[i], values[i]));
    drawing((PANEL.0 as u32, height as u32), |root| {
        let plane = Plane::draw(root, title, frame, x, y)?;
        for i in 0..values[0].len() {
            for j in 0..values[1].len() {
                let Some(number) = field(i, j) else { continue };
                let (x, y) = (i as f64, j as f64);
                let corners = [plane.pixel(x - 0.5, y + 0.5), plane.pixel(x + 0.5, y - 0.5)];
                let (color, ink) = shade(number);
                root.draw(&Rectangle::new(corners, color.filled()))?;
                let centred = style(ink).pos(Pos::new(HPos::Center, VPos::Center));
                root.draw_text(&format!("{number:.2}"), &centred, plane.pixel(x, y))?;
            }
        }
        Ok(())
    })
}

/// From almost white for 1 to dark blue, and a text colour that can be read on it.
fn shade(number: f64) -> (RGBColor, RGBColor) {
    let share = (number.ln() / DARKEST.ln()).clamp(0.0, 1.0);
    let mix = |from: u8, to: u8| (f64::from(from) * (1.0 - share) + f64::from(to) * share) as u8;
    let color = RGBColor(mix(240, 8), mix(247, 48), mix(255, 107));
    (color, if share > 0.5 { WHITE } else { INK })
}
